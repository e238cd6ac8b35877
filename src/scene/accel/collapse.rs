//! From a binary tree to nodes of eight children, by the cost rays are expected to meet (Ylitie, Karras and Laine 2017,
//! section 3.1).
//!
//! A ray that meets the box of a parent meets the box of a child in proportion to their surface areas. For each binary
//! subtree the least expected cost is found of turning it into one to seven wide subtrees, from those of its two halves;
//! then the choices are followed from the root down.
//!
//! The tree is cut into parts near its root, which are done in parallel. Where it is cut depends on the tree alone.

use super::lines::Lines;
use super::node::{Child, Node};
use super::packet::{Packet, WIDTH};
use super::units::Unit;
use super::{Accel, pages};
use crate::error::{Error, ErrorKind, Result};
use crate::job::Job;
use glam::Vec3;
use obvhs::bvh2::Bvh2;
use rayon::prelude::*;
use std::collections::{BinaryHeap, HashMap};

/// Expected cost of testing a packet of triangles, in units of that of testing a node.
const PACKET_COST: f32 = 1.0;
/// Parts a large tree is cut into.
const PARTS: usize = 256;
/// Leaves of a tree that is not worth cutting.
const SMALL: usize = 4096;

pub(super) struct Source<'a> {
    pub triangles: &'a [[Vec3; 3]],
    pub units: &'a [Unit],
    pub tree: &'a Bvh2,
}

/// Builds the nodes and packets of `accel`.
pub(super) fn run(source: &Source, accel: &mut Accel, job: Job) -> Result<()> {
    let scale = Scale::of(accel.low, accel.high);
    // Costs: of the parts in parallel, then of what lies above them.
    let cut = source.cut();
    let part = |&root: &u32| job.check().map(|()| Binary::new(source, root, &HashMap::new(), &[], scale));
    let mut binaries: Vec<Binary> = cut.par_iter().map(part).collect::<Result<_>>()?;
    let places: HashMap<u32, u32> = cut.iter().enumerate().map(|(i, &node)| (node, i as u32)).collect();
    binaries.push(Binary::new(source, 0, &places, &binaries, scale));
    // Choices: those above the parts first; they leave subtrees of parts, which are done in parallel.
    let choice = Choice { source, binaries: &binaries };
    let mut top = choice.widen((cut.len(), 0), true);
    let tasks = std::mem::take(&mut top.left);
    let below = |task: &Left| job.check().map(|()| choice.widen(task.at, false));
    let mut done: Vec<Wide> = tasks.par_iter().map(below).collect::<Result<_>>()?;
    drop(binaries);
    // Find where each comes to lie, the top first, and tell it.
    let mut len = top.lines.len();
    let mut bases = Vec::with_capacity(tasks.len());
    for (task, wide) in tasks.iter().zip(&done) {
        top.lines.get_mut::<Node>(task.node).children[task.lane] = wide.root.moved(len).bits();
        top.stack_need = top.stack_need.max(task.waiting + wide.stack_need);
        bases.push(len);
        len += wide.lines.len();
        if len > Child::LINES {
            let message = "the scene's acceleration structure would be larger than 128 GiB";
            return Err(Error::new(ErrorKind::OutOfMemory, message));
        }
    }
    done.par_iter_mut().zip(bases).for_each(|(wide, base)| wide.move_by(base));
    accel.root = top.root;
    accel.stack_need = accel.stack_need.max(top.stack_need);
    done.insert(0, top);
    let parts: Vec<_> = done.iter().map(|wide| wide.lines.as_slice()).collect();
    accel.lines = Lines::of(pages::join(&parts)?);
    Ok(())
}

impl Source<'_> {
    /// Roots of the parts: the tree is opened where its boxes are largest. Empty for a small tree.
    fn cut(&self) -> Vec<u32> {
        if self.units.len() < SMALL {
            return Vec::new();
        }
        let nodes = &self.tree.nodes;
        let entry = |index: u32| (ordered(nodes[index as usize].aabb().half_area()), index);
        let mut open = BinaryHeap::from([entry(0)]);
        let mut leaves = Vec::new();
        while open.len() + leaves.len() < PARTS
            && let Some((_, index)) = open.pop()
        {
            let node = &nodes[index as usize];
            if node.is_leaf() {
                leaves.push(index);
            } else {
                open.extend([entry(node.first_index), entry(node.first_index + 1)]);
            }
        }
        leaves.extend(open.into_iter().map(|(_, index)| index));
        leaves.sort_unstable();
        leaves
    }
}

/// Areas are not negative: their bits sort as they do.
fn ordered(area: f32) -> u32 {
    area.to_bits()
}

/// Areas in units of the whole scene's, computed so that no size overflows.
#[derive(Clone, Copy)]
struct Scale(f64);

impl Scale {
    fn of(low: Vec3, high: Vec3) -> Self {
        Self(1.0 / half_area(low, high).max(f64::MIN_POSITIVE))
    }

    fn area(self, low: Vec3, high: Vec3) -> f32 {
        (half_area(low, high) * self.0) as f32
    }
}

fn half_area(low: Vec3, high: Vec3) -> f64 {
    let d = high.as_dvec3() - low.as_dvec3();
    d.x * d.y + d.y * d.z + d.z * d.x
}

#[derive(Clone, Copy)]
enum Content {
    /// Index of the right half; the left one comes right after its parent.
    Halves(u32),
    Unit(Unit),
    /// The root of another part.
    Part(u32),
}

#[derive(Clone, Copy)]
struct Branch {
    low: Vec3,
    high: Vec3,
    content: Content,
    /// Triangles below.
    count: u32,
    /// `cost[i]`: the least expected cost as at most `i + 1` wide subtrees.
    cost: [f32; 7],
}

/// A part of the binary tree, parents before children, with its costs.
struct Binary {
    branches: Vec<Branch>,
    scale: Scale,
}

impl Binary {
    fn new(source: &Source, root: u32, cut: &HashMap<u32, u32>, parts: &[Binary], scale: Scale) -> Self {
        let mut this = Self { branches: Vec::new(), scale };
        let mut open = vec![(root, None)];
        while let Some((index, parent)) = open.pop() {
            let at = this.branches.len();
            if let Some(parent) = parent {
                this.branches[parent as usize].content = Content::Halves(at as u32);
            }
            let node = &source.tree.nodes[index as usize];
            let mut branch = Branch {
                low: Vec3::INFINITY,
                high: Vec3::NEG_INFINITY,
                content: Content::Halves(0),
                count: 0,
                cost: [0.0; 7],
            };
            if let Some(&part) = cut.get(&index) {
                branch = Branch { content: Content::Part(part), ..parts[part as usize].branches[0] };
            } else if node.is_leaf() {
                let unit = source.units[source.tree.primitive_indices[node.first_index as usize] as usize];
                for corner in unit.ids().flat_map(|id| source.triangles[id as usize]) {
                    branch.low = branch.low.min(corner);
                    branch.high = branch.high.max(corner);
                }
                branch.content = Content::Unit(unit);
                branch.count = unit.ids().count() as u32;
                branch.cost = [scale.area(branch.low, branch.high) * PACKET_COST; 7];
            } else {
                // The left half follows next; the right one is told where its parent is.
                open.push((node.first_index + 1, Some(at as u32)));
                open.push((node.first_index, None));
            }
            this.branches.push(branch);
        }
        for at in (0..this.branches.len()).rev() {
            if let Content::Halves(right) = this.branches[at].content {
                this.weigh(at, right as usize);
            }
        }
        this
    }

    /// Costs of a branch from those of its halves.
    fn weigh(&mut self, at: usize, right: usize) {
        let (l, r) = (&self.branches[at + 1], &self.branches[right]);
        let (low, high, count) = (l.low.min(r.low), l.high.max(r.high), l.count + r.count);
        let area = self.scale.area(low, high);
        let mut cost = [0.0; 7];
        cost[0] = area + distribute(&l.cost, &r.cost, 8).0;
        if count <= WIDTH as u32 {
            cost[0] = cost[0].min(area * PACKET_COST);
        }
        for roots in 2..8 {
            cost[roots - 1] = cost[roots - 2].min(distribute(&l.cost, &r.cost, roots).0);
        }
        let branch = &mut self.branches[at];
        (branch.low, branch.high, branch.count, branch.cost) = (low, high, count, cost);
    }

    /// Whether a branch, as one wide subtree, is best a packet.
    fn is_packet(&self, at: usize) -> bool {
        let branch = &self.branches[at];
        let as_packet = || self.scale.area(branch.low, branch.high) * PACKET_COST;
        branch.count <= WIDTH as u32 && (matches!(branch.content, Content::Unit(_)) || branch.cost[0] >= as_packet())
    }
}

/// A branch of one of the binary parts.
type Place = (usize, usize);

/// Wide nodes of a subtree.
#[derive(Default)]
struct Wide {
    lines: Lines,
    root: Child,
    /// Where each node is.
    nodes: Vec<usize>,
    stack_need: usize,
    left: Vec<Left>,
}

impl Wide {
    /// Where the lines come to lie a number of lines later.
    fn move_by(&mut self, lines: usize) {
        for &node in &self.nodes {
            let children = &mut self.lines.get_mut::<Node>(node).children;
            children.iter_mut().for_each(|c| *c = Child::from_bits(*c).moved(lines).bits());
        }
    }
}

/// A child that is left to be done, and where it belongs.
struct Left {
    at: Place,
    node: usize,
    lane: usize,
    /// Entries that wait when it is visited.
    waiting: usize,
}

/// Follows the least costs down.
struct Choice<'a> {
    source: &'a Source<'a>,
    binaries: &'a [Binary],
}

impl Choice<'_> {
    fn branch(&self, (binary, at): Place) -> &Branch {
        &self.binaries[binary].branches[at]
    }

    /// The wide subtree of a place; within other parts than its own, children are left to be done if `leave`.
    fn widen(&self, root: Place, leave: bool) -> Wide {
        let mut wide = Wide::default();
        if self.is_packet(root) {
            wide.root = Child::of_packet(wide.lines.push(self.packet(root)));
            return wide;
        }
        // Nodes to be made: the place, whose child it is, and the entries that wait when it is visited.
        let mut open = vec![(root, None, 0)];
        while let Some((place, parent, waiting)) = open.pop() {
            let node = wide.lines.push(Node::empty());
            wide.nodes.push(node);
            match parent {
                Some((parent, lane)) => wide.lines.get_mut::<Node>(parent).children[lane] = Child::of_node(node).bits(),
                None => wide.root = Child::of_node(node),
            }
            let mut members = [root; 8];
            let len = self.members(place, &mut members);
            members[..len].sort_by(|&a, &b| self.promise(a).total_cmp(&self.promise(b)));
            wide.stack_need = wide.stack_need.max(waiting + len);
            let waiting = waiting + len - 1;
            for (lane, &at) in members[..len].iter().enumerate() {
                let mut child = Child::EMPTY;
                if leave && at.0 != root.0 {
                    wide.left.push(Left { at, node, lane, waiting });
                } else if self.is_packet(at) {
                    child = Child::of_packet(wide.lines.push(self.packet(at)));
                } else {
                    open.push((at, Some((node, lane)), waiting));
                }
                let branch = self.branch(at);
                wide.lines.get_mut::<Node>(node).set(lane, branch.low, branch.high, child);
            }
        }
        wide
    }

    /// What a search for any hit may expect of a child, which visits the last lane first: large boxes are met more often,
    /// and a packet ends the search where a node only goes on with it.
    fn promise(&self, place: Place) -> f32 {
        let branch = self.branch(place);
        let area = self.binaries[place.0].scale.area(branch.low, branch.high);
        if self.is_packet(place) { 2.0 * area } else { area }
    }

    fn is_packet(&self, (binary, at): Place) -> bool {
        self.binaries[binary].is_packet(at)
    }

    /// The children of a branch that becomes a node.
    fn members(&self, node: Place, members: &mut [Place; 8]) -> usize {
        let mut len = 0;
        // (place, wide subtrees it may become); a stack of at most one right half per level that is divided.
        let mut open = [(node, 8); 8];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let ((binary, at), mut roots) = open[waiting];
            let branch = self.branch((binary, at));
            // Fewer will do where they cost the same; the node itself has to be divided.
            while roots < 8 && roots > 1 && branch.cost[roots - 2] <= branch.cost[roots - 1] {
                roots -= 1;
            }
            match branch.content {
                Content::Halves(right) if roots > 1 => {
                    let (l, r) = ((binary, at + 1), (binary, right as usize));
                    let (_, left) = distribute(&self.branch(l).cost, &self.branch(r).cost, roots);
                    open[waiting] = (r, roots - left);
                    open[waiting + 1] = (l, left);
                    waiting += 2;
                }
                Content::Part(part) if roots > 1 => {
                    open[waiting] = ((part as usize, 0), roots);
                    waiting += 1;
                }
                Content::Part(part) => {
                    members[len] = (part as usize, 0);
                    len += 1;
                }
                _ => {
                    members[len] = (binary, at);
                    len += 1;
                }
            }
        }
        len
    }

    /// The triangles of a branch, which may reach into another part.
    fn packet(&self, at: Place) -> Packet {
        let mut ids = [0; WIDTH];
        let mut len = 0;
        let mut open = [at; WIDTH];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let (binary, at) = open[waiting];
            match self.branch((binary, at)).content {
                Content::Halves(right) => {
                    open[waiting] = (binary, right as usize);
                    open[waiting + 1] = (binary, at + 1);
                    waiting += 2;
                }
                Content::Part(part) => {
                    open[waiting] = (part as usize, 0);
                    waiting += 1;
                }
                Content::Unit(unit) => {
                    for id in unit.ids() {
                        ids[len] = id;
                        len += 1;
                    }
                }
            }
        }
        Packet::new(self.source.triangles, &ids[..len])
    }
}

/// The least cost of two halves as `roots` wide subtrees together, and how many of them the left half becomes.
fn distribute(left: &[f32; 7], right: &[f32; 7], roots: usize) -> (f32, usize) {
    let mut best = (left[0] + right[(roots - 2).min(6)], 1);
    for k in 2..roots {
        let cost = left[k - 1] + right[roots - k - 1];
        if cost < best.0 {
            best = (cost, k);
        }
    }
    best
}
