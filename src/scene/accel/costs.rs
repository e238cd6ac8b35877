//! What a ray is expected to cost in each subtree of the binary tree, as one to seven wide subtrees.
//!
//! A ray that meets the box of a parent meets the box of a child in proportion to their surface areas. The costs of a
//! subtree follow from those of its two halves.

use super::packet::WIDTH;
use super::pages;
use super::units::Unit;
use crate::error::Result;
use glam::Vec3;
use obvhs::bvh2::Bvh2;
use std::collections::HashMap;

/// Expected cost of testing a packet of triangles, in units of that of testing a node.
const PACKET_COST: f32 = 1.0;
/// Branches that memory is asked for ahead of time.
const AHEAD: usize = 12;

pub(super) struct Source<'a> {
    pub triangles: &'a [[Vec3; 3]],
    pub units: &'a [Unit],
    pub tree: &'a Bvh2,
}

/// Areas in units of the whole scene's, computed so that no size overflows.
#[derive(Clone, Copy)]
pub(super) struct Scale {
    area: f64,
    length: f32,
}

impl Scale {
    pub fn of(low: Vec3, high: Vec3) -> Self {
        let area = 1.0 / half_area(low, high).max(f64::MIN_POSITIVE);
        Self { area, length: area.sqrt() as f32 }
    }

    /// Of one side of a triangle.
    fn triangle(self, [a, b, c]: [Vec3; 3]) -> f32 {
        0.5 * ((b - a) * self.length).cross((c - a) * self.length).length()
    }

    pub fn area(self, low: Vec3, high: Vec3) -> f32 {
        (half_area(low, high) * self.area) as f32
    }
}

fn half_area(low: Vec3, high: Vec3) -> f64 {
    let d = high.as_dvec3() - low.as_dvec3();
    d.x * d.y + d.y * d.z + d.z * d.x
}

#[derive(Clone, Copy)]
pub(super) enum Content {
    /// Index of the first half; the other one comes right after it.
    Halves(u32),
    /// Index of a unit.
    Unit(u32),
    /// The root of another part.
    Part(u32),
}

#[derive(Clone, Copy)]
pub(super) struct Branch {
    pub low: Vec3,
    pub high: Vec3,
    pub content: Content,
    /// Triangles below.
    count: u32,
    /// Their area together, in units of the scene's.
    pub surface: f32,
    /// `cost[i]`: the least expected cost as at most `i + 1` wide subtrees.
    pub cost: [f32; 7],
}

impl Branch {
    const EMPTY: Self = Self {
        low: Vec3::INFINITY,
        high: Vec3::NEG_INFINITY,
        content: Content::Halves(0),
        count: 0,
        surface: 0.0,
        cost: [0.0; 7],
    };

    /// Lines of memory that it will take, about: packets are rarely full, and nodes add a tenth.
    pub fn lines(&self) -> usize {
        self.count as usize * 5 / 4 + 8
    }

    /// Bounds and costs of a unit.
    fn measure(&mut self, source: &Source, unit: u32, scale: Scale) {
        for id in source.units[unit as usize].ids() {
            let [a, b, c] = source.triangles[id as usize];
            self.low = self.low.min(a).min(b).min(c);
            self.high = self.high.max(a).max(b).max(c);
            self.surface += scale.triangle([a, b, c]);
            self.count += 1;
        }
        self.cost = [scale.area(self.low, self.high) * PACKET_COST; 7];
    }
}

/// A part of the binary tree, level by level, with its costs.
pub(super) struct Binary {
    pub branches: Vec<Branch>,
    pub scale: Scale,
}

impl Binary {
    pub fn new(source: &Source, root: u32, cut: &HashMap<u32, u32>, parts: &[Binary], scale: Scale) -> Result<Self> {
        let mut this = Self { branches: Vec::new(), scale };
        // Nodes and triangles lie all over memory. Level by level, and the triangles after all nodes, it is known early which
        // will be needed, so that memory can be asked for many at once.
        let mut indices = vec![root];
        let mut at = 0;
        while at < indices.len() {
            pages::make_room(&mut this.branches, 1)?;
            pages::make_room(&mut indices, 2)?;
            let index = indices[at];
            let node = &source.tree.nodes[index as usize];
            this.branches.push(if let Some(&part) = cut.get(&index) {
                Branch { content: Content::Part(part), ..parts[part as usize].branches[0] }
            } else if node.is_leaf() {
                pages::prefetch(&raw const source.units[node.first_index as usize], 1);
                Branch { content: Content::Unit(node.first_index), ..Branch::EMPTY }
            } else {
                let first = indices.len() as u32;
                indices.extend([node.first_index, node.first_index + 1]);
                pages::prefetch(&raw const source.tree.nodes[node.first_index as usize], 3);
                Branch { content: Content::Halves(first), ..Branch::EMPTY }
            });
            at += 1;
        }
        for at in 0..this.branches.len() {
            if let Some(&Branch { content: Content::Unit(unit), .. }) = this.branches.get(at + AHEAD) {
                for id in source.units[unit as usize].ids() {
                    pages::prefetch(&raw const source.triangles[id as usize], 1);
                }
            }
            let branch = &mut this.branches[at];
            if let Content::Unit(unit) = branch.content {
                branch.measure(source, unit, scale);
            }
        }
        for at in (0..this.branches.len()).rev() {
            if let Content::Halves(first) = this.branches[at].content {
                this.weigh(at, first as usize);
            }
        }
        Ok(this)
    }

    /// Costs of a branch from those of its halves.
    fn weigh(&mut self, at: usize, first: usize) {
        let (l, r) = (&self.branches[first], &self.branches[first + 1]);
        let (low, high, count) = (l.low.min(r.low), l.high.max(r.high), l.count + r.count);
        let surface = l.surface + r.surface;
        let area = self.scale.area(low, high);
        // A unit costs the same as any number of subtrees.
        let halves = match (l.content, r.content) {
            (Content::Unit(_), _) => r.cost.map(|cost| cost + l.cost[0]),
            (_, Content::Unit(_)) => l.cost.map(|cost| cost + r.cost[0]),
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
        *branch = Branch { low, high, content: branch.content, count, surface, cost };
    }

    /// Whether a branch, as one wide subtree, is best a packet.
    pub fn is_packet(&self, at: usize) -> bool {
        let branch = &self.branches[at];
        let as_packet = || self.scale.area(branch.low, branch.high) * PACKET_COST;
        branch.count <= WIDTH as u32 && (matches!(branch.content, Content::Unit(_)) || branch.cost[0] >= as_packet())
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
