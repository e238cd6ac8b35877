//! Optimisation of the binary tree by reinsertion (Meister and Bittner 2018, "Parallel Reinsertion for Bounding Volume
//! Hierarchy Optimization"): subtrees are moved to where the total surface area of all boxes is smallest.
//!
//! Each round has two steps:
//!
//! 1. In the unchanged tree, search in parallel for the best new position of many subtrees.
//! 2. Make these moves one after another, largest gain first. Skip a move if an earlier move of the round has changed
//!    one of its nodes.
//!
//! The search order differs from the paper: of two children, the child with the larger possible gain is searched first.
//! A child below which no position can beat the best one so far is skipped.

use super::pages;
use super::tree::{Pair, Tree, half_area};
use crate::error::Result;
use crate::image::try_collect;
use crate::job::Job;
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;
use std::cmp::Reverse;

/// Number of pairs of nodes per unit of parallel search, and of moves made between two checks for cancellation.
const CHUNK: usize = 256;
/// Number of pairs of nodes per unit of parallel work on the histogram of areas.
const COUNT_CHUNK: usize = 1 << 15;
/// Number of highest bits of an area, after the sign bit, that select its histogram bin: the exponent and four bits of
/// the mantissa.
const AREA_BIN_BITS: u32 = 8 + 4;

/// A move of the subtree `from` to a new position as the sibling of `to`. `gain` is the decrease of the total half
/// area of all boxes.
#[derive(Clone, Copy)]
struct Move {
    from: u32,
    to: u32,
    gain: f32,
}

pub(super) struct Reinsertion<'a> {
    tree: &'a mut Tree,
    touched: Vec<bool>,
}

fn pair(node: u32) -> usize {
    node as usize / 2
}

/// Returns the histogram bin of an area. Bins are ordered like areas, because non-negative floats sort as their bits
/// do.
fn area_bin(area: f32) -> usize {
    (area.to_bits() >> (31 - AREA_BIN_BITS)) as usize
}

fn sibling(node: u32) -> u32 {
    node ^ 1
}

impl<'a> Reinsertion<'a> {
    pub fn new(tree: &'a mut Tree, job: Job) -> Result<Self> {
        let touched = pages::filled(tree.len(), false, job)?;
        Ok(Self { tree, touched })
    }

    /// Returns one threshold for each of `shares`. At most this share of all nodes have a box whose half surface area
    /// reaches the threshold. The actual share can be smaller, because thresholds are boundaries of histogram bins.
    pub fn area_thresholds<const N: usize>(&self, shares: [f32; N]) -> [f32; N] {
        let count = |pairs: &[Pair]| {
            let mut counts = vec![0; 1 << AREA_BIN_BITS];
            pairs.iter().flat_map(|pair| &pair.0).for_each(|node| counts[area_bin(half_area(node.aabb()))] += 1);
            counts
        };
        let add = |mut a: Vec<u32>, b: Vec<u32>| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
            a
        };
        let counts = self.tree.pairs.par_chunks(COUNT_CHUNK).map(count).reduce_with(add).unwrap_or_default();
        let largest = area_bin(half_area(self.aabb(Tree::ROOT)));
        shares.map(|share| {
            let mut left = (share * self.tree.len() as f32) as u32;
            let is_full = |&count: &u32| left.checked_sub(count).map(|less| left = less).is_none();
            let smallest = counts[..=largest].iter().rposition(is_full).map_or(0, |bin| bin + 1);
            f32::from_bits((smallest as u32) << (31 - AREA_BIN_BITS))
        })
    }

    /// Finds the best move of each node whose half area is at least `min_area`. Makes the moves, largest gain first,
    /// and skips a move if an earlier one has changed one of its nodes.
    pub fn round(&mut self, min_area: f32, job: Job) -> Result<()> {
        let search = |(i, pairs): (usize, &[Pair])| {
            job.check()?;
            let (mut moves, mut stack) = (Vec::new(), Vec::new());
            let first = (2 * CHUNK * i) as u32;
            for (from, node) in (first..).zip(pairs.iter().flat_map(|pair| &pair.0)) {
                if from > Tree::ROOT && half_area(node.aabb()) >= min_area {
                    let this = self.best_move(from, &mut stack);
                    if this.gain > 0.0 {
                        moves.push(this);
                    }
                }
            }
            Ok(moves)
        };
        let found: Vec<Vec<Move>> = self.tree.pairs.par_chunks(CHUNK).enumerate().map(search).collect::<Result<_>>()?;
        let mut moves = try_collect(found.into_iter().flatten())?;
        moves.par_sort_unstable_by_key(|m| (Reverse(m.gain.to_bits()), m.from));
        for moves in moves.chunks(CHUNK) {
            job.check()?;
            moves.iter().for_each(|&this| self.make(this));
        }
        self.touched.fill(false);
        Ok(())
    }

    fn parent(&self, node: u32) -> u32 {
        self.tree.parents[pair(node)]
    }

    fn aabb(&self, node: u32) -> &Aabb {
        self.tree[node].aabb()
    }

    /// Finds the best new position of a subtree. The gain is 0 if no move makes the total area smaller. Removing the
    /// subtree deletes its parent and shrinks the boxes above; inserting it makes the boxes above the new position
    /// grow.
    fn best_move(&self, from: u32, candidates: &mut Vec<Candidate>) -> Move {
        let this = self.aabb(from);
        let best = Move { from, to: 0, gain: 0.0 };
        let mut search = Search { tree: self.tree, this, area: half_area(this), best, candidates };
        let parent = self.parent(from);
        let (mut pivot, mut beside) = (parent, sibling(from));
        // `gained` is the half area saved by removing the subtree, summed over the boxes from its parent up to
        // `pivot`. `rest` is the box of all nodes below `pivot` except the subtree. It becomes `None` once a box on
        // the way up does not shrink, because then no box above shrinks either.
        let mut gained = half_area(self.aabb(parent));
        let mut rest = Some(*self.aabb(beside));
        loop {
            search.search_subtree(gained, beside);
            if pivot != parent
                && let Some(smaller) = rest
            {
                let smaller = smaller.union(self.aabb(beside));
                let less = half_area(self.aabb(pivot)) - half_area(&smaller);
                gained += less;
                rest = (less > 0.0).then_some(smaller);
            }
            // The next search examines the positions beside `sibling(pivot)` and below it. Stop if none of them can be
            // better: the new parent costs at least the area of the subtree.
            if pivot == Tree::ROOT || gained - search.area <= search.best.gain {
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
        // Rewrite three slots. The sibling of the subtree `from` moves up into the slot of their parent. The node at
        // `to` moves into the sibling's old slot, next to the subtree. A new node at `to` becomes the parent of the
        // moved node and the subtree.
        let stays = self.tree[beside];
        let joined = self.tree[to];
        self.put(parent, stays);
        self.put(beside, joined);
        self.put(to, Bvh2Node::new(joined.aabb().union(self.aabb(from)), 0, from.min(beside)));
        self.refit_above(to);
        self.refit_above(parent);
    }

    fn put(&mut self, at: u32, node: Bvh2Node) {
        self.tree[at] = node;
        if !node.is_leaf() {
            self.tree.parents[pair(node.first_index)] = at;
        }
    }

    /// Refits the boxes of the ancestors of a node, upwards until a box no longer changes.
    fn refit_above(&mut self, mut node: u32) {
        while node != Tree::ROOT {
            node = self.parent(node);
            let first = self.tree[node].first_index;
            let union = self.aabb(first).union(self.aabb(first + 1));
            if union == *self.aabb(node) {
                return;
            }
            self.tree[node].set_aabb(union);
        }
    }
}

/// A pair of siblings beside which the subtree may be placed. The first number is the decrease of the total half area
/// if the subtree moves beside either sibling, with the box of the new parent left out. The second number is the index
/// of the first sibling.
type Candidate = (f32, u32);

/// The search for the best position of one subtree.
struct Search<'a> {
    tree: &'a Tree,
    this: &'a Aabb,
    area: f32,
    best: Move,
    candidates: &'a mut Vec<Candidate>,
}

impl Search<'_> {
    /// Examines all positions beside `node` or below it. `gained` is the decrease of the total half area of all boxes
    /// if the subtree moves beside `node`, with the box of the new parent left out.
    fn search_subtree(&mut self, gained: f32, node: u32) {
        self.try_sibling_of(gained, node);
        while let Some((gained, first)) = self.candidates.pop() {
            // Skip the pair if no position in it can beat the best one, which may have improved since the pair was
            // pushed.
            if gained - self.area <= self.best.gain {
                continue;
            }
            let len = self.candidates.len();
            self.try_sibling_of(gained, first);
            self.try_sibling_of(gained, first + 1);
            // Put the pair with the larger possible gain on top, so that it is examined next.
            if let [.., a, b] = &mut self.candidates[len..]
                && a.0 > b.0
            {
                std::mem::swap(a, b);
            }
        }
    }

    /// Examines the position beside the node `to`, with `gained` as in [`Self::search_subtree`]. Pushes the children of
    /// `to` if a position beside one of them could be better than the best one. Such a position costs at least the area
    /// of the subtree, because the new parent contains the subtree.
    #[inline(always)]
    fn try_sibling_of(&mut self, gained: f32, to: u32) {
        let node = &self.tree[to];
        let gain = gained - half_area(&node.aabb().union(self.this));
        if gain > self.best.gain {
            (self.best.to, self.best.gain) = (to, gain);
        }
        let below = gain + half_area(node.aabb());
        if !node.is_leaf() && below - self.area > self.best.gain {
            pages::prefetch(&raw const self.tree[node.first_index], 1);
            self.candidates.push((below, node.first_index));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;
    use crate::rng::Rng;
    use obvhs::bvh2::Bvh2;
    use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
    use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

    /// Converts a tree of obvhs, whose root is node 0, to a [`Tree`], whose root is node 1.
    fn tree_of(bvh: &Bvh2) -> Tree {
        let mut nodes = vec![Bvh2Node::default()];
        nodes.extend(&bvh.nodes);
        let mut parents = vec![Tree::ROOT; nodes.len() / 2];
        for (at, node) in (0..).zip(&mut nodes).skip(1).filter(|(_, node)| !node.is_leaf()) {
            node.first_index += 1;
            parents[pair(node.first_index)] = at;
        }
        let (pairs, _) = nodes.as_chunks();
        Tree { pairs: pairs.iter().map(|&pair| Pair(pair)).collect(), parents }
    }

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
        let mut peer = builder.build(PlocSearchDistance::Minimum, &boxes, indices, SortPrecision::U64, 0);
        let mut tree = tree_of(&peer);
        let area_of_all = |nodes: &[Bvh2Node]| nodes.iter().map(|node| node.aabb().half_area()).sum::<f32>();
        let before = area_of_all(&peer.nodes);
        // Optimise the same nodes with the implementation of obvhs, which visits children in another order.
        ReinsertionOptimizer::default().run(&mut peer, 0.5, Some(vec![1.0, 0.2, 0.1, 0.0]));
        let monitor = Monitor::default();
        let mut reinsertion = Reinsertion::new(&mut tree, monitor.job()).unwrap();
        for min_area in reinsertion.area_thresholds([0.5, 0.1, 0.05, 0.0]) {
            reinsertion.round(min_area, monitor.job()).unwrap();
        }
        let nodes: Vec<Bvh2Node> = tree.pairs.iter().flat_map(|pair| pair.0).collect();
        let (after, after_peer) = (area_of_all(&nodes), area_of_all(&peer.nodes));
        assert!(after_peer < before && after < 1.003 * after_peer, "{before}: {after}, {after_peer}");
        let (mut seen, mut open) = ([false; LEAVES], vec![Tree::ROOT]);
        while let Some(at) = open.pop() {
            let node = &tree[at];
            let first = node.first_index;
            if node.is_leaf() {
                assert!(!seen[first as usize] && *node.aabb() == boxes[first as usize]);
                seen[first as usize] = true;
            } else {
                assert!(*node.aabb() == tree[first].aabb().union(tree[first + 1].aabb()));
                assert!(tree.parents[pair(first)] == at);
                open.extend([first, first + 1]);
            }
        }
        assert!(seen.iter().all(|&seen| seen));
    }
}
