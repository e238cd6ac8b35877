//! Collapses the binary tree to nodes of eight children, minimising the expected cost of rays (Ylitie, Karras and
//! Laine 2017, section 3.1).
//!
//! For each binary subtree, the minimum expected cost of representing it by one to seven wide subtrees is computed;
//! then the optimal choices are followed from the root down.
//!
//! The tree is cut near its root into parts, which are processed in parallel. The cut depends on the tree alone.

use super::costs::{Binary, Branch, Content, Source, distribute};
use super::lines::{Draft, Lines};
use super::node::{Child, Node};
use super::packet::{Packet, WIDTH};
use super::tree::{Tree, half_area};
use super::{pages, traverse::Accel};
use crate::error::{Error, ErrorKind, Result};
use crate::job::Job;
use glam::Vec3;
use rayon::prelude::*;
use std::collections::{BinaryHeap, HashMap};

/// Number of parts of a large tree; number of leaves per part of smaller trees; and minimum number of parts worth
/// cutting.
const PARTS: usize = 256;
const PART_LEAVES: usize = 128;
const MIN_PARTS: usize = 8;
/// Lines in a page of memory: a step to a node within it needs no new page-table lookup.
const PAGE_LINES: usize = 64;

/// Builds the nodes and packets of `accel`.
pub(super) fn run(source: &Source, accel: &mut Accel, job: Job) -> Result<()> {
    // Compute the costs of the parts in parallel, then the costs above them.
    let cut = source.cut();
    let part = |&root: &u32| Binary::new(source, root, &HashMap::new(), &[], job);
    let mut binaries: Vec<Binary> = cut.par_iter().map(part).collect::<Result<_>>()?;
    let places: HashMap<u32, u32> = cut.iter().enumerate().map(|(i, &node)| (node, i as u32)).collect();
    binaries.push(Binary::new(source, Tree::ROOT, &places, &binaries, job)?);
    // Follow the choices above the parts first; then process the remaining subtrees in parallel.
    let choice = Choice { source, binaries: &binaries, job };
    let mut top = choice.widen((cut.len(), 0), true)?;
    let tasks = std::mem::take(&mut top.left);
    let below = |task: &Left| choice.widen(task.at, false);
    let mut done: Vec<Wide> = tasks.par_iter().map(below).collect::<Result<_>>()?;
    drop(binaries);

    // Determine the final position of each part, the top first, and store it in its parent.
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
    let drafts: Vec<Draft> = done.into_iter().map(|wide| wide.lines).collect();
    accel.lines = Lines::join(&drafts, job)?;
    Ok(())
}

impl Source<'_> {
    /// Roots of the parts: the tree is opened repeatedly at the largest box. Empty for a small tree.
    fn cut(&self) -> Vec<u32> {
        let parts = (self.tree.pairs.len() / PART_LEAVES).min(PARTS);
        if parts < MIN_PARTS {
            return Vec::new();
        }
        // Non-negative floats sort as their bits do.
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

/// A branch of one of the binary parts: (part, branch).
type Place = (usize, usize);

/// Wide nodes of a subtree.
#[derive(Default)]
struct Wide {
    lines: Draft,
    root: Child,
    /// Line of each node.
    nodes: Vec<usize>,
    stack_need: usize,
    left: Vec<Left>,
}

impl Wide {
    /// Shifts the line numbers of all children.
    fn move_by(&mut self, lines: usize) {
        for &node in &self.nodes {
            let children = &mut self.lines.get_mut::<Node>(node).children;
            children.iter_mut().for_each(|c| *c = Child::from_bits(*c).moved(lines).bits());
        }
    }
}

/// A branch that is to become a node.
struct Open {
    place: Place,
    area: f32,
    /// The parent node, and the lane of this child.
    parent: Option<(usize, usize)>,
    /// Number of entries on the stack when a ray visits it.
    waiting: usize,
}

/// A child left to another task, and its position in its parent.
struct Left {
    at: Place,
    node: usize,
    lane: usize,
    /// Number of entries on the stack when a ray visits it.
    waiting: usize,
}

/// Follows the choices of minimum cost down the tree.
struct Choice<'a> {
    source: &'a Source<'a>,
    binaries: &'a [Binary],
    job: Job<'a>,
}

impl Choice<'_> {
    fn branch(&self, (binary, at): Place) -> &Branch {
        &self.binaries[binary].branches[at]
    }

    /// The wide subtree of a branch; with `leave`, children in other parts are left to other tasks.
    fn widen(&self, root: Place, leave: bool) -> Result<Wide> {
        let mut wide = Wide { lines: Draft::with_capacity(self.branch(root).lines())?, ..Wide::default() };
        if self.is_packet(root) {
            wide.root = Child::of_packet(wide.lines.push(&self.packet(&self.triangles(root)))?);
            return Ok(wide);
        }
        // Fill each page with the nodes most likely to be visited together: a root, then repeatedly the largest node
        // below the nodes present. Nodes that do not fit start new pages.
        let mut roots = vec![Open { place: root, area: 0.0, parent: None, waiting: 0 }];
        let mut open = Vec::new();
        while let Some(next) = roots.pop() {
            self.job.check()?;
            let end = wide.lines.len() + PAGE_LINES;
            open.push(next);
            while wide.lines.len() < end
                && let Some(largest) = (0..open.len()).max_by(|&a, &b| open[a].area.total_cmp(&open[b].area))
            {
                let next = open.swap_remove(largest);
                self.make_node(next, root, leave, &mut wide, &mut open)?;
            }
            roots.append(&mut open);
        }
        Ok(wide)
    }

    /// Creates a node and its packets; appends the nodes below it to `open`.
    fn make_node(&self, this: Open, root: Place, leave: bool, wide: &mut Wide, open: &mut Vec<Open>) -> Result<()> {
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
        // Determine and prefetch all triangles before the first is used.
        let packets = ranked.map(|(_, at)| self.is_packet(at).then(|| self.triangles(at)));
        wide.stack_need = wide.stack_need.max(this.waiting + len);
        let waiting = this.waiting + len - 1;
        let unscale = 1.0 / self.source.scale;
        for (lane, &(_, at)) in ranked[..len].iter().enumerate() {
            let mut child = Child::EMPTY;
            if leave && at.0 != root.0 {
                wide.left.push(Left { at, node, lane, waiting });
            } else if let Some(ids) = &packets[lane] {
                child = Child::of_packet(wide.lines.push(&self.packet(ids))?);
            } else {
                open.push(Open { place: at, area: self.branch(at).area, parent: Some((node, lane)), waiting });
            }
            let branch = self.branch(at);
            let [low, high] = [branch.shape.min, branch.shape.max].map(|p| Vec3::from(p * unscale));
            wide.lines.get_mut::<Node>(node).set(lane, low, high, child);
        }
        Ok(())
    }

    /// Expected benefit of a child to an any-hit query, which visits the last lane first: surface area hit per cost.
    fn benefit(&self, place: Place) -> f32 {
        let branch = self.branch(place);
        branch.surface / branch.cost[0]
    }

    fn is_packet(&self, (binary, at): Place) -> bool {
        self.binaries[binary].is_packet(at)
    }

    /// The children of a branch that becomes a node.
    fn members(&self, node: Place, members: &mut [Place; 8]) -> usize {
        let mut len = 0;
        // A stack of (branch, maximum number of wide subtrees); at most one right half per level is pending.
        let mut open = [(node, 8); 8];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let ((binary, at), mut roots) = open[waiting];
            let branch = self.branch((binary, at));
            // Use fewer subtrees if they cost the same; the node itself must be divided.
            while roots < 8 && roots > 1 && branch.cost[roots - 2] <= branch.cost[roots - 1] {
                roots -= 1;
            }
            match branch.content {
                Content::Halves(first) if roots > 1 => {
                    let (l, r) = ((binary, first as usize), (binary, first as usize + 1));
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

    /// The triangles of a branch, which may extend into another part; prefetches them.
    fn triangles(&self, at: Place) -> ([u32; WIDTH], usize) {
        let mut ids = [0; WIDTH];
        let mut len = 0;
        let mut open = [at; WIDTH];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let (binary, at) = open[waiting];
            match self.branch((binary, at)).content {
                Content::Halves(first) => {
                    open[waiting] = (binary, first as usize + 1);
                    open[waiting + 1] = (binary, first as usize);
                    waiting += 2;
                }
                Content::Part(part) => {
                    open[waiting] = (part as usize, 0);
                    waiting += 1;
                }
                Content::Leaf(first) => {
                    for id in self.branch((binary, at)).triangles(first) {
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
