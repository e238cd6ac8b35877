//! Optimisation of the binary tree by reinsertion (Meister and Bittner 2018, "Parallel Reinsertion for Bounding Volume
//! Hierarchy Optimization"): a subtree is taken out and put where the boxes of the tree have the least area together.
//!
//! The best places are searched for in parallel, in the tree as it is; then the moves are made one after the other, those
//! that gain most first, but for those that touch what another has changed. The order of the search differs from the
//! paper's: of two children the one that promises more is entered first, and neither that can promise no gain.

use super::pages;
use crate::error::{Error, Result};
use crate::job::Job;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;
use std::cmp::Reverse;

/// Searches made by one piece of parallel work.
const CHUNK: usize = 64;

/// A subtree, the node beside which it is better, and the area by which all boxes together shrink.
#[derive(Clone, Copy)]
struct Move {
    from: u32,
    to: u32,
    gain: f32,
}

pub(super) struct Reinsertion<'a> {
    nodes: &'a mut [Bvh2Node],
    /// Of each pair of siblings: nodes `2 * i + 1` and `2 * i + 2`.
    parents: Vec<u32>,
    touched: Vec<bool>,
    moves: Vec<Move>,
}

fn pair(node: u32) -> usize {
    (node as usize - 1) / 2
}

fn sibling(node: u32) -> u32 {
    ((node - 1) ^ 1) + 1
}

impl<'a> Reinsertion<'a> {
    /// The root is node 0, and siblings are next to each other from node 1 on.
    pub fn new(tree: &'a mut Bvh2) -> Result<Self> {
        let nodes = tree.nodes.as_mut_slice();
        let mut parents = pages::reserve(nodes.len() / 2)?;
        parents.resize(nodes.len() / 2, 0);
        for (at, node) in nodes.iter().enumerate().filter(|(_, node)| !node.is_leaf()) {
            parents[pair(node.first_index)] = at as u32;
        }
        let mut touched = pages::reserve(nodes.len())?;
        touched.resize(nodes.len(), false);
        Ok(Self { nodes, parents, touched, moves: Vec::new() })
    }

    /// Tries to move a number of the largest nodes. The builder puts these first, about, so only twice as many are looked at.
    pub fn round(&mut self, count: usize, job: Job) -> Result<()> {
        let seen = (2 * count).min(self.nodes.len());
        let mut largest: Vec<u64> = pages::reserve(seen)?;
        // Areas are not negative: their bits sort as they do.
        let key = |at: usize| u64::from(self.nodes[at].aabb().half_area().to_bits()) << 32 | at as u64;
        largest.extend((1..seen).map(key));
        if count < largest.len() {
            largest.select_nth_unstable_by_key(count, |&key| Reverse(key));
            largest.truncate(count);
        }
        let mut moves = std::mem::take(&mut self.moves);
        moves.clear();
        pages::make_room(&mut moves, largest.len())?;
        moves.extend(largest.iter().map(|&key| Move { from: key as u32, to: 0, gain: 0.0 }));
        moves.par_chunks_mut(CHUNK).try_for_each(|moves| {
            job.check()?;
            let mut stack = Vec::new();
            moves.iter_mut().for_each(|this| *this = self.best_move(this.from, &mut stack));
            Ok::<_, Error>(())
        })?;
        moves.retain(|m| m.gain > 0.0);
        moves.par_sort_unstable_by_key(|m| (Reverse(m.gain.to_bits()), m.from));
        for &this in &moves {
            self.make(this);
        }
        self.touched.fill(false);
        self.moves = moves;
        Ok(())
    }

    fn parent(&self, node: u32) -> u32 {
        self.parents[pair(node)]
    }

    fn aabb(&self, node: u32) -> &Aabb {
        self.nodes[node as usize].aabb()
    }

    /// Where a subtree is best: its parent goes, the boxes on the way up shrink, and those on the way down grow.
    fn best_move(&self, from: u32, waiting: &mut Vec<Waiting>) -> Move {
        let this = self.aabb(from);
        let best = Move { from, to: 0, gain: 0.0 };
        let mut search = Search { nodes: self.nodes, this, area: this.half_area(), best, waiting };
        let parent = self.parent(from);
        let (mut pivot, mut beside) = (parent, sibling(from));
        // What is gained on the way up to the pivot, and the box of what stays below it.
        let mut gained = self.aabb(parent).half_area();
        let mut rest = *self.aabb(beside);
        loop {
            search.below(gained, beside);
            if pivot != parent {
                rest = rest.union(self.aabb(beside));
                gained += self.aabb(pivot).half_area() - rest.half_area();
            }
            if pivot == 0 {
                return search.best;
            }
            beside = sibling(pivot);
            pivot = self.parent(pivot);
        }
    }

    fn make(&mut self, Move { from, to, .. }: Move) {
        let (beside, parent) = (sibling(from), self.parent(from));
        let changed = [to, from, beside, self.parent(to), parent];
        if changed.iter().any(|&node| self.touched[node as usize]) {
            return;
        }
        changed.iter().for_each(|&node| self.touched[node as usize] = true);
        // The sibling takes the parent's place, the node at the new place the sibling's, and a new parent of both its.
        let stays = self.nodes[beside as usize];
        let joined = self.nodes[to as usize];
        self.put(parent, stays);
        self.put(beside, joined);
        self.put(to, Bvh2Node::new(joined.aabb().union(self.aabb(from)), 0, from.min(beside)));
        self.refit_above(to);
        self.refit_above(parent);
    }

    fn put(&mut self, at: u32, node: Bvh2Node) {
        self.nodes[at as usize] = node;
        if !node.is_leaf() {
            self.parents[pair(node.first_index)] = at;
        }
    }

    /// Boxes from a node up, as far as they change.
    fn refit_above(&mut self, mut node: u32) {
        while node != 0 {
            node = self.parent(node);
            let first = self.nodes[node as usize].first_index;
            let union = self.aabb(first).union(self.aabb(first + 1));
            if union == *self.aabb(node) {
                return;
            }
            self.nodes[node as usize].set_aabb(union);
        }
    }
}

/// What is gained above two siblings, and the first of them.
type Waiting = (f32, u32);

/// The search for the best place of a subtree.
struct Search<'a> {
    nodes: &'a [Bvh2Node],
    this: &'a Aabb,
    area: f32,
    best: Move,
    waiting: &'a mut Vec<Waiting>,
}

impl Search<'_> {
    /// All places beside a node or below it.
    fn below(&mut self, gained: f32, node: u32) {
        self.beside(gained, node);
        while let Some((gained, first)) = self.waiting.pop() {
            // Better places may have been found since.
            if gained - self.area <= self.best.gain {
                continue;
            }
            let len = self.waiting.len();
            self.beside(gained, first);
            self.beside(gained, first + 1);
            // What promises more is next.
            if let [.., a, b] = &mut self.waiting[len..]
                && a.0 > b.0
            {
                std::mem::swap(a, b);
            }
        }
    }

    /// The place beside a node; those below it wait, if any could be better than the best. A parent there has at least the
    /// area of the subtree.
    #[inline(always)]
    fn beside(&mut self, gained: f32, to: u32) {
        let node = &self.nodes[to as usize];
        let gain = gained - node.aabb().union(self.this).half_area();
        if gain > self.best.gain {
            (self.best.to, self.best.gain) = (to, gain);
        }
        let below = gain + node.aabb().half_area();
        if !node.is_leaf() && below - self.area > self.best.gain {
            pages::prefetch(&raw const self.nodes[node.first_index as usize], 2);
            self.waiting.push((below, node.first_index));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;
    use crate::rng::Rng;
    use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
    use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

    #[test]
    fn boxes_shrink_stay_tight_and_lose_no_leaf() {
        const LEAVES: usize = 3000;
        let mut rng = Rng::new(1, &[]);
        let mut random = || glam::Vec3A::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
        let mut random_box = || {
            let low = random();
            Aabb::new(low, low + random() * 0.1)
        };
        let boxes: Vec<Aabb> = (0..LEAVES).map(|_| random_box()).collect();
        let indices = (0..LEAVES as u32).collect();
        let builder = &mut PlocBuilder::with_capacity(LEAVES);
        let mut tree = builder.build(PlocSearchDistance::Minimum, &boxes, indices, SortPrecision::U64, 0);
        let area = |tree: &Bvh2| tree.nodes.iter().map(|node| node.aabb().half_area()).sum::<f32>();
        let before = area(&tree);
        // The builder's own implementation, which does not order its search, on the same nodes.
        let mut peer = tree.clone();
        let (share, rounds) = (0.5, [1.0, 0.2, 0.1, 0.0]);
        ReinsertionOptimizer::default().run(&mut peer, share, Some(rounds.to_vec()));
        let nodes = tree.nodes.len() as f32;
        let mut reinsertion = Reinsertion::new(&mut tree).unwrap();
        for round in rounds {
            reinsertion.round((nodes * share * round) as usize, Monitor::default().job()).unwrap();
        }
        assert!(
            area(&peer) < before && area(&tree) < 1.003 * area(&peer),
            "{before}: {}, {}",
            area(&tree),
            area(&peer)
        );
        let (mut seen, mut open) = ([false; LEAVES], vec![0]);
        while let Some(at) = open.pop() {
            let node = &tree.nodes[at];
            let first = node.first_index as usize;
            if node.is_leaf() {
                assert!(!seen[first] && *node.aabb() == boxes[first]);
                seen[first] = true;
            } else {
                assert!(*node.aabb() == tree.nodes[first].aabb().union(tree.nodes[first + 1].aabb()));
                open.extend([first, first + 1]);
            }
        }
        assert!(seen.iter().all(|&seen| seen));
    }
}
