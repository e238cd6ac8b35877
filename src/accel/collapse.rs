//! Collapses the binary tree into nodes of eight children, minimising the expected cost of a ray (Ylitie, Karras and
//! Laine 2017, section 3.1).
//!
//! A wide node has up to eight children; a wide subtree is a packet of triangles, or a wide node with all below it.
//! First, `costs` computes for each binary subtree the minimum expected cost of representing it by one to seven wide
//! subtrees. Then this module follows the optimal choices from the root down and writes the wide nodes.
//!
//! For parallel work, the tree is cut near its root into parts. The cut depends on the tree alone, not on the number
//! of threads.

use super::cache_lines::{Draft, Lines};
use super::costs::{Branch, Content, CostedPart, Source, distribute};
use super::node::{Child, Node};
use super::packet::{Packet, WIDTH};
use super::tree::{Tree, half_area};
use super::{pages, traverse::Accel};
use crate::error::{Error, ErrorKind, Result};
use crate::job::Job;
use glam::Vec3;
use rayon::prelude::*;
use std::collections::{BinaryHeap, HashMap};

/// A large tree is cut into `PARTS` parts, a smaller tree into one part per `PART_LEAVES` leaves. A tree that would
/// have fewer than `MIN_PARTS` parts is not cut.
const PARTS: usize = 256;
const PART_LEAVES: usize = 128;
const MIN_PARTS: usize = 8;
/// Cache lines in a page of memory. A step to another node in the same page needs no new page-table lookup.
const PAGE_LINES: usize = 64;

/// Collapses the tree of `source` and stores the nodes and packets in `accel`.
pub(super) fn run(source: &Source, accel: &mut Accel, job: Job) -> Result<()> {
    // Compute the costs of the parts in parallel, then the costs of the tree above the parts.
    let cut = source.cut();
    let cost_part = |&root: &u32| CostedPart::new(source, root, &HashMap::new(), &[], job);
    let mut parts: Vec<CostedPart> = cut.par_iter().map(cost_part).collect::<Result<_>>()?;
    let places: HashMap<u32, u32> = cut.iter().enumerate().map(|(i, &node)| (node, i as u32)).collect();
    parts.push(CostedPart::new(source, Tree::ROOT, &places, &parts, job)?);
    // First write the nodes above the parts. Then write the subtrees below these nodes in parallel.
    let choice = Choice { source, parts: &parts, job };
    let mut top = choice.widen((cut.len(), 0), true)?;
    let tasks = std::mem::take(&mut top.deferred);
    let below = |task: &DeferredChild| choice.widen(task.at, false);
    let mut done: Vec<Wide> = tasks.par_iter().map(below).collect::<Result<_>>()?;
    drop(parts);

    // Determine the final positions of all nodes in the list of cache lines: the top first, then one block per
    // subtree. Store the position of each subtree's root in its parent node.
    let mut len = top.lines.len();
    let mut bases = Vec::with_capacity(tasks.len());
    for (task, wide) in tasks.iter().zip(&done) {
        top.lines.get_mut::<Node>(task.node).children[task.lane] = wide.root.moved(len).bits();
        top.stack_need = top.stack_need.max(task.stack_depth + wide.stack_need);
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
    let drafts: Vec<Draft> = done.into_iter().map(|wide| wide.lines).collect();
    accel.lines = Lines::join(&drafts, job)?;
    Ok(())
}

impl Source<'_> {
    /// Divides the tree into parts, for parallel work, by repeatedly splitting the node with the largest box. Returns
    /// the roots of the parts; empty for a small tree.
    fn cut(&self) -> Vec<u32> {
        let parts = (self.tree.pairs.len() / PART_LEAVES).min(PARTS);
        if parts < MIN_PARTS {
            return Vec::new();
        }
        // Compare areas by their bits: non-negative floats sort as their bits do.
        let entry = |index: u32| (half_area(self.tree[index].aabb()).to_bits(), index);
        let mut open = BinaryHeap::from([entry(Tree::ROOT)]);
        let mut leaves = Vec::new();
        while open.len() + leaves.len() < parts
            && let Some((_, index)) = open.pop()
        {
            let node = &self.tree[index];
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

/// A branch (subtree) of the binary tree: the index of its part, and its index within that part.
type Place = (usize, usize);

/// The wide nodes and packets written for one subtree.
#[derive(Default)]
struct Wide {
    lines: Draft,
    root: Child,
    /// For each node, the index of its first cache line in `lines`.
    nodes: Vec<usize>,
    stack_need: usize,
    deferred: Vec<DeferredChild>,
}

impl Wide {
    /// Moves all nodes and packets by `lines` cache lines: adds this number to all references to children.
    fn move_by(&mut self, lines: usize) {
        for &node in &self.nodes {
            let children = &mut self.lines.get_mut::<Node>(node).children;
            children.iter_mut().for_each(|c| *c = Child::from_bits(*c).moved(lines).bits());
        }
    }
}

/// A branch that will become a wide node.
struct Open {
    place: Place,
    area: f32,
    /// Index of the parent node in [`Wide::lines`], and the lane of that node which holds this child; `None` for the
    /// root.
    parent: Option<(usize, usize)>,
    /// Maximum number of entries on the traversal stack when a ray visits this node.
    stack_depth: usize,
}

/// A child that another task will write. The reference to it belongs in lane `lane` of the parent, whose index in
/// [`Wide::lines`] is `node`.
struct DeferredChild {
    at: Place,
    node: usize,
    lane: usize,
    /// Maximum number of entries on the traversal stack when a ray visits this child.
    stack_depth: usize,
}

/// Writes wide nodes from the root down, and represents each branch by the wide subtrees of minimum cost.
struct Choice<'a> {
    source: &'a Source<'a>,
    parts: &'a [CostedPart],
    job: Job<'a>,
}

impl Choice<'_> {
    fn branch(&self, (part, at): Place) -> &Branch {
        &self.parts[part].branches[at]
    }

    /// Writes the wide subtree below a branch. If `leave` is true, children that lie in other parts are left to other
    /// tasks and listed in [`Wide::deferred`].
    fn widen(&self, root: Place, leave: bool) -> Result<Wide> {
        let mut wide = Wide { lines: Draft::with_capacity(self.branch(root).lines())?, ..Wide::default() };
        if self.is_packet(root) {
            wide.root = Child::of_packet(wide.lines.push(&self.packet(&self.triangles(root)))?);
            return Ok(wide);
        }
        // Fill each page of memory with nodes that a ray is likely to visit together. Start with one node. Of the
        // children of nodes in the page, repeatedly add the child of largest area. Children that do not fit start new
        // pages.
        let mut roots = vec![Open { place: root, area: 0.0, parent: None, stack_depth: 0 }];
        let mut open = Vec::new();
        while let Some(next) = roots.pop() {
            self.job.check()?;
            let end = wide.lines.len() + PAGE_LINES;
            open.push(next);
            while wide.lines.len() < end
                && let Some(largest) = (0..open.len()).max_by(|&a, &b| open[a].area.total_cmp(&open[b].area))
            {
                let next = open.swap_remove(largest);
                self.make_node(&next, root, leave, &mut wide, &mut open)?;
            }
            roots.append(&mut open);
        }
        Ok(wide)
    }

    /// Creates a node and the packets below it. Appends to `open` the child nodes that are still to be written.
    fn make_node(&self, this: &Open, root: Place, leave: bool, wide: &mut Wide, open: &mut Vec<Open>) -> Result<()> {
        let node = wide.lines.push(&Node::empty())?;
        wide.nodes.push(node);
        match this.parent {
            Some((parent, lane)) => wide.lines.get_mut::<Node>(parent).children[lane] = Child::of_node(node).bits(),
            None => wide.root = Child::of_node(node),
        }
        let mut members = [root; 8];
        let len = self.members(this.place, &mut members);
        let mut ranked = members.map(|at| (0.0, at));
        ranked[..len].iter_mut().for_each(|(benefit, at)| *benefit = self.benefit(*at));
        ranked[..len].sort_by(|a, b| a.0.total_cmp(&b.0));
        // Find and prefetch the triangles of all packets before any packet is written, so that the memory accesses
        // overlap.
        let packets = ranked.map(|(_, at)| self.is_packet(at).then(|| self.triangles(at)));
        wide.stack_need = wide.stack_need.max(this.stack_depth + len);
        let stack_depth = this.stack_depth + len - 1;
        let unscale = 1.0 / self.source.scale;
        for (lane, &(_, at)) in ranked[..len].iter().enumerate() {
            let mut child = Child::EMPTY;
            if leave && at.0 != root.0 {
                wide.deferred.push(DeferredChild { at, node, lane, stack_depth });
            } else if let Some(ids) = &packets[lane] {
                child = Child::of_packet(wide.lines.push(&self.packet(ids))?);
            } else {
                open.push(Open { place: at, area: self.branch(at).area, parent: Some((node, lane)), stack_depth });
            }
            let branch = self.branch(at);
            let [low, high] = [branch.shape.min, branch.shape.max].map(|p| Vec3::from(p * unscale));
            wide.lines.get_mut::<Node>(node).set(lane, low, high, child);
        }
        Ok(())
    }

    /// Expected benefit of a child for an any-hit query: surface area of its leaves per unit of traversal cost. The
    /// children of a node are sorted by ascending benefit, because any-hit queries visit the last lane first.
    fn benefit(&self, place: Place) -> f32 {
        let branch = self.branch(place);
        branch.surface / branch.cost[0]
    }

    fn is_packet(&self, (part, at): Place) -> bool {
        self.parts[part].is_packet(at)
    }

    /// Collects the up to eight children of a branch that becomes a wide node; returns their number.
    fn members(&self, node: Place, members: &mut [Place; 8]) -> usize {
        let mut len = 0;
        // Stack of branches, each with the maximum number of wide subtrees that may represent it. These numbers add up
        // to at most 8, so the stack needs no more than 8 entries.
        let mut open = [(node, 8); 8];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let ((part, at), mut roots) = open[waiting];
            let branch = self.branch((part, at));
            // The branch may become up to `roots` wide subtrees. Choose fewer wide subtrees if the cost is the same.
            // The branch of the node itself (`roots` = 8) is always divided.
            while roots < 8 && roots > 1 && branch.cost[roots - 2] <= branch.cost[roots - 1] {
                roots -= 1;
            }
            match branch.content {
                Content::Halves(first) if roots > 1 => {
                    let (l, r) = ((part, first as usize), (part, first as usize + 1));
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
                    members[len] = (part, at);
                    len += 1;
                }
            }
        }
        len
    }

    /// Returns the indices of the triangles below a branch with at most [`WIDTH`] triangles, and their number. Also
    /// prefetches these triangles. The branch may extend into other parts of the tree.
    fn triangles(&self, at: Place) -> ([u32; WIDTH], usize) {
        let mut ids = [0; WIDTH];
        let mut len = 0;
        let mut open = [at; WIDTH];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let (part, at) = open[waiting];
            match self.branch((part, at)).content {
                Content::Halves(first) => {
                    open[waiting] = (part, first as usize + 1);
                    open[waiting + 1] = (part, first as usize);
                    waiting += 2;
                }
                Content::Part(part) => {
                    open[waiting] = (part as usize, 0);
                    waiting += 1;
                }
                Content::Leaf(first) => {
                    for id in self.branch((part, at)).triangles(first) {
                        pages::prefetch(&raw const self.source.triangles[id as usize], 1);
                        ids[len] = id;
                        len += 1;
                    }
                }
            }
        }
        (ids, len)
    }

    fn packet(&self, &(ids, len): &([u32; WIDTH], usize)) -> Packet {
        Packet::new(self.source.triangles, &ids[..len])
    }
}
