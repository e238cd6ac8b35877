//! Acceleration structure over triangles: nearest hits and occlusion.
//!
//! Triangles are sorted along a space-filling curve (`leaves`) and clustered into a binary tree (`cluster`: Benthin et
//! al. 2024) with the nodes of obvhs. The tree is optimised by reinsertion (`reinsert`: Meister and Bittner 2018) and
//! collapsed into nodes of eight children (`costs`, `collapse`: Ylitie et al. 2017), whose leaves hold up to eight
//! triangles that are tested together.
//!
//! The triangle test is watertight (Woop, Benthin and Wald 2013), and the box test is conservative to match it: a ray
//! never slips through a shared edge or vertex. The nearest hit depends on the triangles alone: ties in distance are
//! resolved by the lower triangle index, so neither the shape of the tree nor the processor's vector width affects it.
//!
//! Not modelled: motion, instancing, curves.

mod aligned;
mod build;
mod cluster;
mod collapse;
mod costs;
mod lanes;
mod leaves;
mod lines;
mod node;
mod packet;
mod pages;
mod reinsert;
mod stack;
mod tree;

use crate::error::Result;
use crate::job::Job;
use crate::simd::Level;
use aligned::Aligned;
use glam::{Vec3, Vec4};
use lanes::{Baseline, Lanes};
use lines::Lines;
use node::{Child, Node, NodeRay};
use packet::{Packet, TriangleRay};
use stack::{SLACK, Stack, Waiting};
use std::mem::MaybeUninit;

/// A half-line; distances are in units of `direction`, which need not have unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    pub origin: Vec3,
    pub direction: Vec3,
    /// Hits lie at distances in `(0, t_max)`.
    pub t_max: f32,
}

impl Ray {
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_max: f32::INFINITY }
    }

    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    pub t: f32,
    /// Index into the list of triangles the structure was built from.
    pub triangle: u32,
    /// Barycentric coordinates of corners 1 and 2.
    pub u: f32,
    pub v: f32,
}

/// The built structure; it holds its own copy of the triangles.
pub struct Accel {
    lines: Lines,
    root: Child,
    low: Vec3,
    high: Vec3,
    /// The largest absolute coordinate per axis.
    largest: Vec4,
    /// Maximum number of entries on the traversal stack.
    stack_need: usize,
    dropped: usize,
    level: Level,
}

/// Traversal stack entries kept on the thread's stack; deeper trees allocate theirs on the heap.
const SHORT_STACK: usize = 128;

impl Accel {
    /// Builds the structure. Degenerate triangles (without area or with non-finite corners) cannot be hit; they are
    /// left out and counted. Call it on the library's own pool: the builder uses the current pool.
    pub fn build(triangles: &[[Vec3; 3]], job: Job) -> Result<Self> {
        build::build(triangles, job)
    }

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
        let mut best: Option<Hit> = None;
        let mut t_max = ray.t_max;
        let mut stack = Stack::new(stack);
        let mut child = self.root;
        loop {
            if child.is_packet() {
                // Test eight triangles; only an accepted hit shortens the ray.
                // SAFETY: children store the lines at which nodes and packets were written.
                let packet = unsafe { self.lines.get::<Packet>(child.line()) };
                let (mut mask, hits) = packet.intersect::<L>(&triangle_ray, t_max);
                if mask != 0 {
                    let hits = hits.store();
                    while mask != 0 {
                        let hit = hits.lane(take_lowest(&mut mask), packet);
                        if is_better(&hit, best.as_ref(), ray.t_max) && accept(&hit) {
                            if ANY {
                                return Some(hit);
                            }
                            t_max = hit.t;
                            best = Some(hit);
                        }
                    }
                }
            } else {
                // Test eight boxes and descend into one of those hit, the nearest unless `ANY`.
                // SAFETY: as above.
                let node = unsafe { self.lines.get::<Node>(child.line()) };
                let (mut mask, near) = node.intersect(&node_ray, t_max);
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
                let Some((near, next)) = stack.pop() else { return best };
                if ANY || near <= t_max {
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

/// Removes and returns the lowest lane of a non-empty mask.
#[inline(always)]
fn take_lowest(mask: &mut u32) -> usize {
    let lane = mask.trailing_zeros() as usize & 7;
    *mask &= *mask - 1;
    lane
}

/// Removes and returns the highest lane of a non-empty mask.
#[inline(always)]
fn take_highest(mask: &mut u32) -> usize {
    let lane = mask.ilog2() as usize & 7;
    *mask ^= 1 << lane;
    lane
}

fn is_better(hit: &Hit, best: Option<&Hit>, t_max: f32) -> bool {
    match best {
        None => hit.t < t_max,
        Some(best) => hit.t < best.t || (hit.t == best.t && hit.triangle < best.triangle),
    }
}

#[cfg(test)]
mod tests;
