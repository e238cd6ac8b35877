//! Expected traversal cost of each subtree of the binary tree when it is represented by one to seven wide subtrees. A
//! wide subtree is a packet of triangles, or a node of eight children with all below it.
//!
//! By the surface area heuristic, a ray that hits a parent's box also hits a child's box with the probability a / A.
//! Here a and A are the surface areas of the child's and of the parent's box. The costs of a subtree follow from the
//! costs of its two halves (Ylitie et al. 2017, section 3.1).

use super::packet::WIDTH;
use super::pages;
use super::tree::{Tree, half_area};
use crate::error::Result;
use crate::image::reserve_capacity;
use crate::job::Job;
use glam::Vec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use std::collections::HashMap;
use std::ops::Range;

/// Expected cost of intersecting a packet of triangles, relative to the cost of a node.
/// [convention: Embree's builders give both equal costs]
const PACKET_COST: f32 = 1.0;

/// Number of branches processed between two checks for cancellation. One check per part would be too few, because one
/// part may hold nearly the whole tree.
const CHUNK: usize = 1 << 14;

pub(super) struct Source<'a> {
    pub triangles: &'a [[Vec3; 3]],
    pub tree: &'a Tree,
    /// Factor from the scene's units to the units of the tree's boxes.
    pub scale: f32,
}

#[derive(Clone, Copy)]
pub(super) enum Content {
    /// An inner node: index of its first half; the second half follows it.
    Halves(u32),
    /// A leaf of one or two triangles: index of the first.
    Leaf(u32),
    /// The root of another part: index of that part. (The tree is cut into parts for parallel work.)
    Part(u32),
}

#[derive(Clone, Copy)]
pub(super) struct Branch {
    pub shape: Aabb,
    pub content: Content,
    /// Number of triangles below this branch.
    count: u32,
    /// Half the surface area of this branch's box.
    pub area: f32,
    /// Half the total surface area of all leaf boxes below this branch. It approximates the area of the leaves'
    /// triangles, because most leaf boxes are flat.
    pub surface: f32,
    /// `cost[i]` is the minimum expected cost of this branch when at most `i + 1` wide subtrees represent it. A node
    /// costs half the area of its box; a packet costs [`PACKET_COST`] times half the area of its box. The common
    /// divisor, half the area of the scene's box, is left out.
    pub cost: [f32; 7],
}

impl Branch {
    fn new(node: &Bvh2Node, content: Content) -> Self {
        let shape = *node.aabb();
        let area = half_area(&shape);
        Self { shape, content, count: node.prim_count, area, surface: area, cost: [area * PACKET_COST; 7] }
    }

    /// Estimated number of cache lines for this branch's packets and nodes. Full packets would fill 5 lines for every
    /// 8 triangles; the estimate is twice as much, because packets are rarely full and nodes need lines too.
    pub fn lines(&self) -> usize {
        self.count as usize * 5 / 4 + 8
    }

    /// Returns the indices of a leaf's triangles. `first` is the index of its first triangle.
    pub fn triangles(&self, first: u32) -> Range<u32> {
        first..first + self.count
    }
}

/// The branches (subtrees) of one part of the binary tree in breadth-first order, with their costs.
pub(super) struct CostedPart {
    pub branches: Vec<Branch>,
}

impl CostedPart {
    pub fn new(source: &Source, root: u32, cut: &HashMap<u32, u32>, parts: &[CostedPart], job: Job) -> Result<Self> {
        let mut branches = Vec::new();
        // The nodes are scattered over memory. In breadth-first order their indices are known long before use, so many
        // nodes can be prefetched at once.
        let mut indices = vec![root];
        let mut at = 0;
        while at < indices.len() {
            if at % CHUNK == 0 {
                job.check()?;
            }
            reserve_capacity(&mut branches, 1)?;
            reserve_capacity(&mut indices, 2)?;
            let index = indices[at];
            let node = &source.tree[index];
            branches.push(if let Some(&part) = cut.get(&index) {
                Branch { content: Content::Part(part), ..parts[part as usize].branches[0] }
            } else if node.is_leaf() {
                Branch::new(node, Content::Leaf(node.first_index))
            } else {
                let first = indices.len() as u32;
                indices.extend([node.first_index, node.first_index + 1]);
                pages::prefetch(&raw const source.tree[node.first_index], 1);
                Branch::new(node, Content::Halves(first))
            });
            at += 1;
        }
        let mut this = Self { branches };
        for at in (0..this.branches.len()).rev() {
            if at % CHUNK == 0 {
                job.check()?;
            }
            if let Content::Halves(first) = this.branches[at].content {
                this.compute_costs(at, first as usize);
            }
        }
        Ok(this)
    }

    /// Computes the costs of branch `at` from the costs of its two halves, the first of which is branch `first`.
    fn compute_costs(&mut self, at: usize, first: usize) {
        let (l, r) = (&self.branches[first], &self.branches[first + 1]);
        let (count, surface, area) = (l.count + r.count, l.surface + r.surface, self.branches[at].area);
        // `halves[i]` is the cost if at most `i + 2` wide subtrees in total represent the two halves. A half that is a
        // leaf takes one of them, and the other half takes the remaining `i + 1`.
        let halves = match (l.content, r.content) {
            (Content::Leaf(_), _) => r.cost.map(|cost| cost + l.cost[0]),
            (_, Content::Leaf(_)) => l.cost.map(|cost| cost + r.cost[0]),
            _ => min_cost_of_halves(&l.cost, &r.cost),
        };
        let mut cost = [area + halves[6]; 7];
        if count <= WIDTH as u32 {
            cost[0] = min(cost[0], area * PACKET_COST);
        }
        for more in 1..7 {
            cost[more] = min(cost[more - 1], halves[more - 1]);
        }
        let branch = &mut self.branches[at];
        (branch.count, branch.surface, branch.cost) = (count, surface, cost);
    }

    /// Whether the branch becomes a packet of triangles if it is represented by a single wide subtree. A leaf always
    /// does. Any other branch does if it has at most eight triangles, and if a packet costs at most as much as a node.
    pub fn is_packet(&self, at: usize) -> bool {
        let branch = &self.branches[at];
        branch.count <= WIDTH as u32
            && (matches!(branch.content, Content::Leaf(_)) || branch.cost[0] >= branch.area * PACKET_COST)
    }
}

/// Returns the minimum cost of two halves; entry `i` is for `i + 2` wide subtrees in total. The code has no conditional
/// jumps, because the processor could not predict them.
fn min_cost_of_halves(left: &[f32; 7], right: &[f32; 7]) -> [f32; 7] {
    let mut best = [f32::INFINITY; 7];
    for l in 0..7 {
        for r in 0..7 - l {
            best[l + r] = min(best[l + r], left[l] + right[r]);
        }
    }
    best
}

/// Returns the smaller cost in a single instruction, unlike `f32::min`. Costs are never NaN.
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Divides `roots` wide subtrees between two halves at minimum cost. Returns this cost and the number of wide subtrees
/// for the left half.
pub(super) fn distribute(left: &[f32; 7], right: &[f32; 7], roots: usize) -> (f32, usize) {
    let mut best = (left[0] + right[(roots - 2).min(6)], 1);
    for k in 2..roots {
        let cost = left[k - 1] + right[roots - k - 1];
        if cost < best.0 {
            best = (cost, k);
        }
    }
    best
}
