//! Acceleration structure over triangles: nearest hits and occlusion.
//!
//! A binary tree is built by obvhs (parallel locally-ordered clustering, Meister and Bittner 2018, with reinsertion,
//! 2022) and collapsed into nodes of eight children whose leaves hold up to four triangles, each four tested at once.
//!
//! The triangle test is watertight (Woop, Benthin and Wald 2013), the box test conservative to match it: a ray never
//! slips through a shared edge or vertex. The nearest hit is a function of the triangles alone: equal distances are
//! decided by the lower triangle index, so neither the shape of the tree nor the processor's vector width shows.
//!
//! Not modelled: motion, instancing, curves.

mod build;
mod node;
mod packet;

use crate::error::Result;
use crate::job::Job;
use glam::Vec3;
use node::{Child, Node, NodeRay};
use packet::{Packet, TriangleRay};

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

    fn is_usable(&self) -> bool {
        self.origin.is_finite() && self.direction.is_finite() && self.direction != Vec3::ZERO && self.t_max > 0.0
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
    nodes: Vec<Node>,
    packets: Vec<Packet>,
    root: Child,
    low: Vec3,
    high: Vec3,
    /// The most entries a traversal can have waiting.
    stack_need: usize,
    dropped: usize,
    wide_vectors: bool,
}

/// A child that waits to be visited, and where the ray enters its box.
#[derive(Clone, Copy)]
struct Waiting {
    near: f32,
    child: Child,
}

/// Waiting children kept on the thread's own stack; deeper trees take theirs from the heap.
const SHORT_STACK: usize = 128;

/// Whether a traversal goes on after a hit.
#[derive(Clone, Copy, PartialEq)]
enum Search {
    Closest,
    Any,
}

impl Accel {
    /// Builds the structure. Triangles of no area (or of corners that are not finite) cannot be hit; they are left out
    /// and counted. To be called on the library's own pool: the builder uses the pool it finds itself on.
    pub fn build(triangles: &[[Vec3; 3]], job: Job) -> Result<Self> {
        build::build(triangles, job)
    }

    /// The nearest hit that `accept` does not refuse.
    pub fn closest(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        self.search(ray, Search::Closest, &mut accept)
    }

    /// Whether anything that `accept` does not refuse lies between the origin and `t_max`.
    pub fn occluded(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> bool {
        self.search(ray, Search::Any, &mut accept).is_some()
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
        self.nodes.len() * size_of::<Node>() + self.packets.len() * size_of::<Packet>()
    }

    fn search(&self, ray: &Ray, search: Search, accept: &mut impl FnMut(&Hit) -> bool) -> Option<Hit> {
        if self.root.is_empty() || !ray.is_usable() {
            return None;
        }
        let nothing = Waiting { near: 0.0, child: Child::EMPTY };
        if self.stack_need <= SHORT_STACK {
            self.search_with(ray, search, accept, &mut [nothing; SHORT_STACK])
        } else {
            self.search_with(ray, search, accept, &mut vec![nothing; self.stack_need])
        }
    }

    fn search_with(
        &self,
        ray: &Ray,
        search: Search,
        accept: &mut impl FnMut(&Hit) -> bool,
        stack: &mut [Waiting],
    ) -> Option<Hit> {
        #[cfg(target_arch = "x86_64")]
        if self.wide_vectors {
            // SAFETY: `wide_vectors` is set only where the processor reports AVX2 and FMA.
            return unsafe { self.traverse_avx2(ray, search, accept, stack) };
        }
        self.traverse(ray, search, accept, stack, Node::intersect)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn traverse_avx2(
        &self,
        ray: &Ray,
        search: Search,
        accept: &mut impl FnMut(&Hit) -> bool,
        stack: &mut [Waiting],
    ) -> Option<Hit> {
        self.traverse(ray, search, accept, stack, |node, ray, t_max| node.intersect_avx2(ray, t_max))
    }

    /// Visits boxes nearest first. `intersect` gives the mask of the children that are hit, and where.
    #[inline(always)]
    fn traverse(
        &self,
        ray: &Ray,
        search: Search,
        accept: &mut impl FnMut(&Hit) -> bool,
        stack: &mut [Waiting],
        intersect: impl Fn(&Node, &NodeRay, f32) -> (u32, [f32; 8]),
    ) -> Option<Hit> {
        let node_ray = NodeRay::new(ray, self.low, self.high);
        let triangle_ray = TriangleRay::new(ray);
        let mut best: Option<Hit> = None;
        let mut t_max = ray.t_max;
        let mut waiting = 0;
        let mut child = self.root;
        loop {
            if let Some(index) = child.packet() {
                // Test four triangles; only a hit that is accepted shortens the ray.
                let packet = &self.packets[index];
                let (mut mask, hits) = packet.intersect(&triangle_ray, t_max);
                while mask != 0 {
                    let lane = mask.trailing_zeros() as usize;
                    mask &= mask - 1;
                    let hit = hits.lane(lane, packet);
                    if is_better(&hit, best.as_ref(), ray.t_max) && accept(&hit) {
                        if search == Search::Any {
                            return Some(hit);
                        }
                        t_max = hit.t;
                        best = Some(hit);
                    }
                }
            } else {
                // Test eight boxes; go on with the nearest, let the others wait, nearest on top.
                let node = &self.nodes[child.node()];
                let (mut mask, near) = intersect(node, &node_ray, t_max);
                if mask != 0 {
                    let first = waiting;
                    while mask != 0 {
                        let lane = mask.trailing_zeros() as usize;
                        mask &= mask - 1;
                        let entry = Waiting { near: near[lane], child: node.children[lane] };
                        let mut place = waiting;
                        while place > first && stack[place - 1].near < entry.near {
                            stack[place] = stack[place - 1];
                            place -= 1;
                        }
                        stack[place] = entry;
                        waiting += 1;
                    }
                    waiting -= 1;
                    child = stack[waiting].child;
                    continue;
                }
            }
            // Take the next child that could still hold a nearer hit, or an equal one of lower index.
            loop {
                if waiting == 0 {
                    return best;
                }
                waiting -= 1;
                if stack[waiting].near <= t_max {
                    child = stack[waiting].child;
                    break;
                }
            }
        }
    }
}

fn is_better(hit: &Hit, best: Option<&Hit>, t_max: f32) -> bool {
    match best {
        None => hit.t < t_max,
        Some(best) => hit.t < best.t || (hit.t == best.t && hit.triangle < best.triangle),
    }
}

#[cfg(test)]
mod tests;
