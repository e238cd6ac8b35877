//! Traversal: the nearest hit of a ray, or whether there is any.

use super::aligned::Aligned;
use super::lanes::{self, Baseline, Lanes, take_highest, take_lowest};
use super::lines::Lines;
use super::node::{Child, Node, NodeRay};
use super::packet::{Packet, TriangleRay};
use super::ray::{Hit, Ray};
use super::stack::{SLACK, Stack, Waiting};
use crate::simd::Level;
use glam::{Vec3, Vec4};
use std::mem::MaybeUninit;

/// The built structure; it holds its own copy of the triangles.
pub struct Accel {
    pub(super) lines: Lines,
    pub(super) root: Child,
    pub(super) low: Vec3,
    pub(super) high: Vec3,
    /// The largest absolute coordinate per axis.
    pub(super) largest: Vec4,
    /// Maximum number of entries on the traversal stack.
    pub(super) stack_need: usize,
    pub(super) dropped: usize,
    pub(super) level: Level,
}

/// Traversal stack entries kept on the thread's stack; deeper trees allocate theirs on the heap.
pub(super) const SHORT_STACK: usize = 128;

impl Accel {
    /// The nearest hit that `accept` approves.
    pub fn closest(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        self.search::<false>(ray, &mut accept)
    }

    /// Whether any surface that `accept` approves lies between the origin and `t_max`.
    pub fn occluded(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> bool {
        self.search::<true>(ray, &mut accept).is_some()
    }

    /// Corners of the bounding box; both zero if there are no triangles.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        (self.low, self.high)
    }

    /// Number of degenerate triangles that were left out.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// Memory used, in bytes.
    pub fn bytes(&self) -> usize {
        self.lines.bytes()
    }

    /// The nearest hit, or, with `ANY`, the first one found.
    #[inline(always)]
    fn search<const ANY: bool>(&self, ray: &Ray, accept: &mut impl FnMut(&Hit) -> bool) -> Option<Hit> {
        if self.root.is_empty() {
            return None;
        }
        if self.stack_need <= SHORT_STACK {
            self.search_with::<ANY>(ray, accept, &mut [MaybeUninit::uninit(); SHORT_STACK + SLACK])
        } else {
            self.search_with::<ANY>(ray, accept, &mut vec![MaybeUninit::uninit(); self.stack_need + SLACK])
        }
    }

    #[inline(always)]
    fn search_with<const ANY: bool>(
        &self,
        ray: &Ray,
        accept: &mut impl FnMut(&Hit) -> bool,
        stack: &mut [MaybeUninit<Waiting>],
    ) -> Option<Hit> {
        match self.level {
            // SAFETY: the processor supports its level.
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => unsafe { self.traverse_avx512::<ANY>(ray, accept, stack) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => unsafe { self.traverse_avx2::<ANY>(ray, accept, stack) },
            Level::Baseline => self.traverse::<Baseline, ANY>(ray, accept, stack),
        }
    }

    /// The same instructions in AVX-512 encoding, with its 32 registers and broadcast operands: slightly faster. Its
    /// wider registers and masks are not: both bounds of a node's boxes in one register of sixteen, leaves of sixteen
    /// triangles, and children sorted in a register were all measured to be slower.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    fn traverse_avx512<const ANY: bool>(
        &self,
        ray: &Ray,
        accept: &mut impl FnMut(&Hit) -> bool,
        stack: &mut [MaybeUninit<Waiting>],
    ) -> Option<Hit> {
        self.traverse::<lanes::Avx2, ANY>(ray, accept, stack)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn traverse_avx2<const ANY: bool>(
        &self,
        ray: &Ray,
        accept: &mut impl FnMut(&Hit) -> bool,
        stack: &mut [MaybeUninit<Waiting>],
    ) -> Option<Hit> {
        self.traverse::<lanes::Avx2, ANY>(ray, accept, stack)
    }

    /// Visits boxes nearest first; with `ANY`, from the last lane to the first, in order of falling benefit.
    #[inline(always)]
    fn traverse<L: Lanes, const ANY: bool>(
        &self,
        ray: &Ray,
        accept: &mut impl FnMut(&Hit) -> bool,
        stack: &mut [MaybeUninit<Waiting>],
    ) -> Option<Hit> {
        let aligned = Aligned::new(ray)?;
        let node_ray = NodeRay::<L>::new(&aligned, self.largest);
        let triangle_ray = TriangleRay::new(&aligned);
        let mut best = Best { hit: None, t_max: ray.t_max, ray_t_max: ray.t_max };
        let mut stack = Stack::new(stack);
        let mut child = self.root;
        loop {
            if child.is_packet() {
                // SAFETY: children store the lines at which nodes and packets were written.
                let packet = unsafe { self.lines.get::<Packet>(child.line()) };
                if best.update::<L, ANY>(packet, &triangle_ray, accept) {
                    return best.hit;
                }
            } else {
                // Test eight boxes and descend into one of those hit, the nearest unless `ANY`.
                // SAFETY: as above.
                let node = unsafe { self.lines.get::<Node>(child.line()) };
                let (mut mask, near) = node.intersect(&node_ray, best.t_max);
                if mask != 0 {
                    child = if ANY {
                        let first = take_highest(&mut mask);
                        stack.push_all::<L>(&node.children, mask);
                        node.child(first)
                    } else {
                        let first = take_lowest(&mut mask);
                        if mask == 0 {
                            child = node.child(first);
                            continue;
                        }
                        stack.push_all_but_nearest(&near.store(), &node.children, first, mask)
                    };
                    self.prefetch(&stack);
                    continue;
                }
            }
            // Pop the next child that could hold a nearer hit, or an equal one of lower index.
            child = loop {
                let Some((near, next)) = stack.pop() else { return best.hit };
                if ANY || near <= best.t_max {
                    break next;
                }
            };
            if ANY {
                self.prefetch(&stack);
            }
        }
    }

    /// Prefetches the child on top of the stack.
    #[inline(always)]
    fn prefetch(&self, stack: &Stack) {
        if let Some((_, next)) = stack.top() {
            self.lines.prefetch(next.line());
        }
    }
}

/// The nearest accepted hit so far.
struct Best {
    hit: Option<Hit>,
    /// Maximum distance of a nearer hit.
    t_max: f32,
    ray_t_max: f32,
}

impl Best {
    /// Tests eight triangles; only an accepted hit shortens the ray. Returns whether the search ends, which needs
    /// `ANY`.
    #[inline(always)]
    fn update<L: Lanes, const ANY: bool>(
        &mut self,
        packet: &Packet,
        ray: &TriangleRay,
        accept: &mut impl FnMut(&Hit) -> bool,
    ) -> bool {
        let (mut mask, hits) = packet.intersect::<L>(ray, self.t_max);
        if mask == 0 {
            return false;
        }
        let hits = hits.store();
        while mask != 0 {
            let hit = hits.lane(take_lowest(&mut mask), packet);
            if is_better(&hit, self.hit.as_ref(), self.ray_t_max) && accept(&hit) {
                self.hit = Some(hit);
                if ANY {
                    return true;
                }
                self.t_max = hit.t;
            }
        }
        false
    }
}

pub(super) fn is_better(hit: &Hit, best: Option<&Hit>, t_max: f32) -> bool {
    match best {
        None => hit.t < t_max,
        Some(best) => hit.t < best.t || (hit.t == best.t && hit.triangle < best.triangle),
    }
}
