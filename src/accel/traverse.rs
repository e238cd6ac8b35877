//! Traversal of the acceleration structure: finds the nearest hit of a ray, or whether there is any hit.

use super::cache_lines::Lines;
use super::lanes::{Baseline, Lanes, take_highest, take_lowest};
use super::node::{Child, Node, NodeRay};
use super::packet::{Packet, TriangleRay};
use super::prepared_ray::PreparedRay;
use super::ray::{Hit, Ray};
use super::stack::{SLACK, Stack, Waiting};
use crate::simd::Level;
use glam::{Vec3, Vec4};
use std::mem::MaybeUninit;

/// The finished acceleration structure. It holds its own copy of the triangles.
pub struct Accel {
    pub(super) lines: Lines,
    pub(super) root: Child,
    pub(super) low: Vec3,
    pub(super) high: Vec3,
    /// Largest absolute coordinate of all triangles, per axis.
    pub(super) largest: Vec4,
    /// Maximum number of entries that a ray needs on the traversal stack.
    pub(super) stack_need: usize,
    pub(super) dropped: usize,
    pub(super) level: Level,
}

/// Capacity, in entries, of a traversal stack on the thread's own stack. Traversal of a deeper tree allocates its stack
/// on the heap.
pub(super) const SHORT_STACK: usize = 128;

impl Accel {
    /// Returns the nearest hit for which `accept` returns `true`.
    pub fn closest(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        self.search::<false>(ray, &mut accept)
    }

    /// Whether a hit for which `accept` returns `true` lies between the origin of the ray and `t_max`.
    pub fn occluded(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> bool {
        self.search::<true>(ray, &mut accept).is_some()
    }

    /// Returns the corners of the bounding box, both zero if there are no triangles.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        (self.low, self.high)
    }

    /// Number of degenerate triangles, which the structure leaves out.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// Memory of the structure in bytes.
    pub fn bytes(&self) -> usize {
        self.lines.bytes()
    }

    /// Returns the nearest accepted hit or, with `ANY`, the first accepted hit found.
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
            // SAFETY: the processor supports the instruction set that `level` names.
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => unsafe { self.traverse_avx512::<ANY>(ray, accept, stack) },
            // SAFETY: the processor supports the instruction set that `level` names.
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => unsafe { self.traverse_avx2::<ANY>(ray, accept, stack) },
            Level::Baseline => self.traverse::<Baseline, ANY>(ray, accept, stack),
        }
    }

    /// The AVX2 code compiled with AVX-512 encoding, whose 32 registers and broadcast operands make it slightly faster.
    /// Code that computes in 512-bit registers was no faster (docs/notes/rays.md).
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    fn traverse_avx512<const ANY: bool>(
        &self,
        ray: &Ray,
        accept: &mut impl FnMut(&Hit) -> bool,
        stack: &mut [MaybeUninit<Waiting>],
    ) -> Option<Hit> {
        self.traverse::<super::lanes::Avx2, ANY>(ray, accept, stack)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn traverse_avx2<const ANY: bool>(
        &self,
        ray: &Ray,
        accept: &mut impl FnMut(&Hit) -> bool,
        stack: &mut [MaybeUninit<Waiting>],
    ) -> Option<Hit> {
        self.traverse::<super::lanes::Avx2, ANY>(ray, accept, stack)
    }

    /// Traverses the tree, and visits the nearest child first. With `ANY`, visits the child in the last lane first,
    /// because later lanes are more likely to end the search (`collapse` sorts the children).
    #[inline(always)]
    fn traverse<L: Lanes, const ANY: bool>(
        &self,
        ray: &Ray,
        accept: &mut impl FnMut(&Hit) -> bool,
        stack: &mut [MaybeUninit<Waiting>],
    ) -> Option<Hit> {
        let prepared = PreparedRay::new(ray)?;
        let node_ray = NodeRay::<L>::new(&prepared, self.largest);
        let triangle_ray = TriangleRay::new(&prepared);
        let mut best = Best { hit: None, t_max: ray.t_max, ray_t_max: ray.t_max };
        let mut stack = Stack::new(stack);
        let mut child = self.root;
        loop {
            if child.is_packet() {
                // SAFETY: children refer to the lines at which nodes and packets were written.
                let packet = unsafe { self.lines.get::<Packet>(child.line()) };
                if best.update::<L, ANY>(packet, &triangle_ray, accept) {
                    return best.hit;
                }
            } else {
                // Test the eight boxes and descend into one that the ray hits: the nearest or, with `ANY`, the one in
                // the last lane. SAFETY: children refer to the lines at which nodes and packets were written.
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
            // Pop the next child that could hold a nearer hit, or a hit at the same distance with a lower triangle
            // index.
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

    /// Prefetches the node or packet on top of the stack.
    #[inline(always)]
    fn prefetch(&self, stack: &Stack) {
        if let Some((_, next)) = stack.top() {
            self.lines.prefetch(next.line());
        }
    }
}

/// The nearest accepted hit so far, and the maximum distance of further hits.
struct Best {
    hit: Option<Hit>,
    /// Maximum distance of further hits: the distance of the best hit, or `ray_t_max` before the first hit.
    t_max: f32,
    ray_t_max: f32,
}

impl Best {
    /// Tests the triangles of a packet and keeps the nearest accepted hit, which limits the distance of further hits.
    /// Returns `true` if the traversal can stop: with `ANY`, after an accepted hit.
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
