//! Acceleration structure over triangles: nearest hits and occlusion.
//!
//! Triangles are sorted along a curve through space (`leaves`) and clustered into a binary tree (`cluster`: Benthin et al.
//! 2024), whose nodes are those of obvhs. It is improved by reinsertion (`reinsert`: Meister and Bittner 2018) and collapsed
//! into nodes of eight children (`costs`, `collapse`: Ylitie et al. 2017) whose leaves hold up to eight triangles, tested at
//! once.
//!
//! The triangle test is watertight (Woop, Benthin and Wald 2013), the box test conservative to match it: a ray never
//! slips through a shared edge or vertex. The nearest hit is a function of the triangles alone: equal distances are
//! decided by the lower triangle index, so neither the shape of the tree nor the processor's vector width shows.
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

/// A half-line; distances are in units of `direction`, which need not be of unit length.
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
    /// Index into the triangles the structure was built from.
    pub triangle: u32,
    /// Barycentric coordinates of corners 1 and 2.
    pub u: f32,
    pub v: f32,
}

/// The built structure; it keeps its own copy of the triangles.
pub struct Accel {
    lines: Lines,
    root: Child,
    low: Vec3,
    high: Vec3,
    /// The largest absolute coordinate per axis.
    largest: Vec4,
    /// The most entries a traversal can have waiting.
    stack_need: usize,
    dropped: usize,
    level: Level,
}

/// Waiting children kept on the thread's own stack; deeper trees take theirs from the heap.
const SHORT_STACK: usize = 128;

impl Accel {
    /// Builds the structure. Triangles of no area (or of corners that are not finite) cannot be hit; they are left out
    /// and counted. To be called on the library's own pool: the builder uses the pool it finds itself on.
    pub fn build(triangles: &[[Vec3; 3]], job: Job) -> Result<Self> {
        build::build(triangles, job)
    }

    /// The nearest hit that `accept` does not refuse.
    pub fn closest(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        self.search::<false>(ray, &mut accept)
    }

    /// Whether anything that `accept` does not refuse lies between the origin and `t_max`.
    pub fn occluded(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> bool {
        self.search::<true>(ray, &mut accept).is_some()
    }

    /// Corners of the bounding box; both zero where there is nothing.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        (self.low, self.high)
    }

    /// Triangles of no area that were left out.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        self.lines.bytes()
    }

    /// The nearest hit, or, if `ANY`, the first that is found.
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
            // SAFETY: the processor has the instructions of its level.
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => unsafe { self.traverse_avx512::<ANY>(ray, accept, stack) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => unsafe { self.traverse_avx2::<ANY>(ray, accept, stack) },
            Level::Baseline => self.traverse::<Baseline, ANY>(ray, accept, stack),
        }
    }

    /// The same instructions in the encoding of AVX-512, with its 32 registers and operands that are spread as they are
    /// read: a little faster. Its wider registers and its masks are not: both bounds of a node's boxes in one register
    /// of sixteen, leaves of sixteen triangles, and children sorted in a register have all been slower than this.
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

    /// Visits boxes nearest first; if `ANY`, from the last lane to the first, which is how they promise most.
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
                // Test eight triangles; only a hit that is accepted shortens the ray.
                // SAFETY: children tell where nodes and packets were put.
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
                // Test eight boxes; go on with one of those that are hit, the nearest if that matters.
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
            // Take the next child that could still hold a nearer hit, or an equal one of lower index.
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

    /// Asks memory for the child that is next.
    #[inline(always)]
    fn prefetch(&self, stack: &Stack) {
        if let Some((_, next)) = stack.top() {
            self.lines.prefetch(next.line());
        }
    }
}

/// The lowest lane of a mask that is not empty, which is then taken from it.
#[inline(always)]
fn take_lowest(mask: &mut u32) -> usize {
    let lane = mask.trailing_zeros() as usize & 7;
    *mask &= *mask - 1;
    lane
}

/// The highest lane of a mask that is not empty, which is then taken from it.
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
