//! What a ray is expected to cost in each subtree of the binary tree, as one to seven wide subtrees.
//!
//! A ray that meets the box of a parent meets the box of a child in proportion to their surface areas. The costs of a
//! subtree follow from those of its two halves.

use super::packet::WIDTH;
use super::pages;
use super::tree::{Tree, half_area};
use crate::error::Result;
use crate::image::make_room;
use crate::job::Job;
use glam::Vec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use std::collections::HashMap;
use std::ops::Range;

/// Expected cost of testing a packet of triangles, in units of that of testing a node.
const PACKET_COST: f32 = 1.0;

/// Branches made or weighed between two looks at the job: a part may hold nearly the whole tree.
const CHUNK: usize = 1 << 14;

pub(super) struct Source<'a> {
    pub triangles: &'a [[Vec3; 3]],
    pub tree: &'a Tree,
    /// Units of the tree's boxes.
    pub scale: f32,
}

#[derive(Clone, Copy)]
pub(super) enum Content {
    /// Index of the first half; the other one comes right after it.
    Halves(u32),
    /// One triangle or two, from this index on.
    Leaf(u32),
    /// The root of another part.
    Part(u32),
}

#[derive(Clone, Copy)]
pub(super) struct Branch {
    pub shape: Aabb,
    pub content: Content,
    /// Triangles below.
    count: u32,
    /// Half the area of its box.
    pub area: f32,
    /// The same of all leaves below together: about the area of their triangles, as most of those are flat boxes.
    pub surface: f32,
    /// `cost[i]`: the least expected cost as at most `i + 1` wide subtrees.
    pub cost: [f32; 7],
}

impl Branch {
    fn new(node: &Bvh2Node, content: Content) -> Self {
        let shape = *node.aabb();
        let area = half_area(&shape);
        Self { shape, content, count: node.prim_count, area, surface: area, cost: [area * PACKET_COST; 7] }
    }

    /// Lines of memory that it will take, about: packets are rarely full, and nodes add a tenth.
    pub fn lines(&self) -> usize {
        self.count as usize * 5 / 4 + 8
    }

    /// The triangles of a leaf.
    pub fn triangles(&self, first: u32) -> Range<u32> {
        first..first + self.count
    }
}

/// A part of the binary tree, level by level, with its costs.
pub(super) struct Binary {
    pub branches: Vec<Branch>,
}

impl Binary {
    pub fn new(source: &Source, root: u32, cut: &HashMap<u32, u32>, parts: &[Binary], job: Job) -> Result<Self> {
        let mut branches = Vec::new();
        // Nodes lie all over memory. Level by level it is known early which will be needed, so that memory can be asked for
        // many at once.
        let mut indices = vec![root];
        let mut at = 0;
        while at < indices.len() {
            if at % CHUNK == 0 {
                job.check()?;
            }
            make_room(&mut branches, 1)?;
            make_room(&mut indices, 2)?;
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
                this.weigh(at, first as usize);
            }
        }
        Ok(this)
    }

    /// Costs of a branch from those of its halves.
    fn weigh(&mut self, at: usize, first: usize) {
        let (l, r) = (&self.branches[first], &self.branches[first + 1]);
        let (count, surface, area) = (l.count + r.count, l.surface + r.surface, self.branches[at].area);
        // A leaf costs the same as any number of subtrees.
        let halves = match (l.content, r.content) {
            (Content::Leaf(_), _) => r.cost.map(|cost| cost + l.cost[0]),
            (_, Content::Leaf(_)) => l.cost.map(|cost| cost + r.cost[0]),
            _ => combine(&l.cost, &r.cost),
        };
        let mut cost = [area + halves[6]; 7];
        if count <= WIDTH as u32 {
            cost[0] = least(cost[0], area * PACKET_COST);
        }
        for more in 1..7 {
            cost[more] = least(cost[more - 1], halves[more - 1]);
        }
        let branch = &mut self.branches[at];
        (branch.count, branch.surface, branch.cost) = (count, surface, cost);
    }

    /// Whether a branch, as one wide subtree, is best a packet.
    pub fn is_packet(&self, at: usize) -> bool {
        let branch = &self.branches[at];
        branch.count <= WIDTH as u32
            && (matches!(branch.content, Content::Leaf(_)) || branch.cost[0] >= branch.area * PACKET_COST)
    }
}

/// `[i]`: the least cost of two halves as `i + 2` wide subtrees together. Without branches, which nothing could predict.
fn combine(left: &[f32; 7], right: &[f32; 7]) -> [f32; 7] {
    let mut best = [f32::INFINITY; 7];
    for l in 0..7 {
        for r in 0..7 - l {
            best[l + r] = least(best[l + r], left[l] + right[r]);
        }
    }
    best
}

/// One instruction, unlike `f32::min`: no cost is NaN.
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The least cost of two halves as `roots` wide subtrees together, and how many of them the left half becomes.
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
