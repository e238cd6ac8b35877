//! Bottom-up construction of the binary tree: hierarchical, parallel, locally-ordered clustering (Benthin, Meister,
//! Barczak, Mehalwal, Tsakok and Kensler 2024, "H-PLOC").
//!
//! The leaves arrive sorted by Morton code. Their list is split recursively at the highest bit in which the codes
//! differ, that is, between the two halves of a cell of space. On the way back up, the clusters of two neighbouring
//! ranges are merged until at most [`FEW_CLUSTERS`] are left. The best partner of a cluster is the cluster with which
//! it forms the box of smallest area. Two clusters merge if each is the best partner of the other.
//!
//! On regular grids, such as tessellated walls, many candidate partners form boxes of equal area. In such a tie,
//! cluster `i` prefers the partner `j` with the smallest `i XOR j`. This preference is mutual, so a row of equal
//! clusters merges in pairs: 0 with 1, 2 with 3, and so on. (If every cluster preferred the first equal partner,
//! hardly any two would choose each other.)

use super::lanes::{Baseline, Lanes};
use super::leaves::Leaves;
use super::pages;
use super::tree::{Pair, Tree};
use crate::error::Result;
use crate::job::Job;
use crate::simd::Level;
use obvhs::bvh2::node::Bvh2Node;

/// The clusters of a range are merged until at most this many are left; then the range is combined with its neighbour.
const FEW_CLUSTERS: usize = 32;
/// A cluster chooses its partner among this many clusters before it and as many after it in the list.
const SEARCH_RADIUS: usize = 8;
/// Number of clusters within the search radius of a cluster, including the cluster itself.
const WINDOW: usize = 2 * SEARCH_RADIUS + 1;
/// A range of at most this many leaves is processed by one thread; a longer range is divided between threads.
const SERIAL: usize = 1024;
const LANES: usize = 8;
/// Mask of the low bits that `i XOR j` replaces in a float. The float is half the surface area of the box that encloses
/// two clusters `i` and `j`. From these bits, cluster `i` recovers the index `j` of its partner.
const PARTNER_BITS: u32 = 2 * FEW_CLUSTERS as u32 - 1;

/// Builds the tree over all leaves. There must be at least one leaf.
pub(super) fn binary_tree(leaves: &Leaves, level: Level, job: Job) -> Result<Tree> {
    let mut clusters = pages::filled(leaves.order.len(), Cluster::default(), job)?;
    // Reserve pair 0 for the root.
    let len = leaves.order.len() + 1;
    let mut tree =
        Tree { pairs: pages::filled(len, Pair::default(), job)?, parents: pages::filled(len, Tree::ROOT, job)? };
    let new = NewPairs { pairs: &mut tree.pairs[1..], parents: &mut tree.parents[1..], first: 1 };
    let mut all = Range { leaves: &leaves.list, order: &leaves.order, clusters: &mut clusters, new, level };
    let left = all.merge(job)?;
    let left = merge_nearest(&mut all.clusters[..left], &mut all.new, 1, level);
    debug_assert_eq!(left, 1);
    tree.pairs[0].0[1] = clusters[0].node;
    tree.pairs.pop();
    tree.parents.pop();
    Ok(tree)
}

/// A finished subtree that still needs a sibling.
#[derive(Clone, Copy, Default)]
struct Cluster {
    node: Bvh2Node,
    /// Index of an unused pair in [`Tree::pairs`], reserved for joining this cluster with its sibling.
    pair: u32,
}

/// The pairs of the tree that a range of leaves may fill.
struct NewPairs<'a> {
    pairs: &'a mut [Pair],
    parents: &'a mut [u32],
    /// Index of the first of these pairs in [`Tree::pairs`].
    first: u32,
}

impl NewPairs<'_> {
    fn split_at(&mut self, middle: usize) -> (NewPairs<'_>, NewPairs<'_>) {
        let (left_pairs, pairs) = self.pairs.split_at_mut(middle);
        let (left_parents, parents) = self.parents.split_at_mut(middle);
        let left = NewPairs { pairs: left_pairs, parents: left_parents, first: self.first };
        (left, NewPairs { pairs, parents, first: self.first + middle as u32 })
    }

    /// Merges two clusters: makes their nodes siblings. The nodes fill one of the two pairs reserved for the clusters;
    /// the merged cluster keeps the other pair in reserve.
    fn join(&mut self, a: &Cluster, b: &Cluster) -> Cluster {
        let (pair, free) = (a.pair.min(b.pair), a.pair.max(b.pair));
        self.pairs[(pair - self.first) as usize] = Pair([a.node, b.node]);
        for (node, child) in [(2 * pair, &a.node), (2 * pair + 1, &b.node)] {
            if !child.is_leaf() {
                self.parents[(child.first_index / 2 - self.first) as usize] = node;
            }
        }
        Cluster { node: Bvh2Node::new(a.node.aabb().union(b.node.aabb()), 0, 2 * pair), pair: free }
    }
}

/// A range of leaves along the space-filling curve, with its clusters. It owns one unfilled pair per leaf. Joining all
/// n leaves fills n - 1 of these pairs; the last cluster keeps the remaining one in reserve.
struct Range<'a> {
    leaves: &'a [Bvh2Node],
    order: &'a [(u64, u32)],
    clusters: &'a mut [Cluster],
    new: NewPairs<'a>,
    level: Level,
}

impl Range<'_> {
    /// Merges the leaves of the range to at most [`FEW_CLUSTERS`] clusters, stored at the front; returns their number.
    fn merge(&mut self, job: Job) -> Result<usize> {
        let len = self.order.len();
        if len <= FEW_CLUSTERS {
            for (i, (cluster, &(_, leaf))) in self.clusters.iter_mut().zip(self.order).enumerate() {
                *cluster = Cluster { node: self.leaves[leaf as usize], pair: self.new.first + i as u32 };
            }
            return Ok(len);
        }
        let middle = self.middle();
        let (mut left, mut right) = self.halves(middle);
        let (left, right) = if len > SERIAL {
            job.check()?;
            rayon::join(|| left.merge(job), || right.merge(job))
        } else {
            (left.merge(job), right.merge(job))
        };
        let (left, right) = (left?, right?);
        self.clusters.copy_within(middle..middle + right, left);
        Ok(merge_nearest(&mut self.clusters[..left + right], &mut self.new, FEW_CLUSTERS, self.level))
    }

    /// Returns the position at which to split the range: the first leaf with a 1 in the highest bit in which the
    /// Morton codes of the range differ. A range of equal codes is halved.
    fn middle(&self) -> usize {
        let (first, last) = (self.order[0].0, self.order[self.order.len() - 1].0);
        if first == last {
            return self.order.len() / 2;
        }
        let bit = 1 << (first ^ last).ilog2();
        self.order.partition_point(|(code, _)| code & bit == 0)
    }

    fn halves(&mut self, middle: usize) -> (Range<'_>, Range<'_>) {
        let Self { leaves, level, .. } = *self;
        let (left_order, order) = self.order.split_at(middle);
        let (left_clusters, clusters) = self.clusters.split_at_mut(middle);
        let (left_new, new) = self.new.split_at(middle);
        let left = Range { leaves, order: left_order, clusters: left_clusters, new: left_new, level };
        (left, Range { leaves, order, clusters, new, level })
    }
}

/// Merges the clusters until at most `few` are left, stored at the front; returns their number.
fn merge_nearest(clusters: &mut [Cluster], new: &mut NewPairs, few: usize, level: Level) -> usize {
    let mut len = clusters.len();
    if len <= few {
        return len;
    }
    let mut boxes = Boxes::of(clusters);
    while len > few {
        let choices = boxes.choose(len, level);
        let partner = |i: usize| i ^ (choices[i].to_bits() & PARTNER_BITS) as usize;
        let mut kept = 0;
        for i in 0..len {
            let other = partner(i);
            if partner(other) != i {
                clusters[kept] = clusters[i];
                kept += 1;
            } else if i < other {
                clusters[kept] = new.join(&clusters[i], &clusters[other]);
                kept += 1;
            }
        }
        boxes.update(&clusters[..kept], len);
        len = kept;
    }
    len
}

const BOX_CAPACITY: usize = 2 * FEW_CLUSTERS + 2 * SEARCH_RADIUS;

/// Bounds of the clusters' boxes in SoA layout: three rows of lower and three rows of upper bounds. Before the first
/// and after the last cluster lie sentinel boxes, which are too large to be chosen as partners.
struct Boxes([[f32; BOX_CAPACITY]; 6]);

/// Half the side of a sentinel box. It is larger than any coordinate: boxes are scaled ([`Leaves::scale`]) so that the
/// scene has an extent of about 1, and they lie at most about 2^24 from the origin. [convention]
const SENTINEL: f32 = 1e15;

/// The entry `[i / LANES][k][i % LANES]` holds the low bits ([`PARTNER_BITS`]) of `i XOR j`. Here
/// `j = i - SEARCH_RADIUS + k` is the index of a neighbour of cluster `i`.
static INDEX_DIFFERENCE: [[[u32; LANES]; WINDOW]; 2 * FEW_CLUSTERS / LANES] = {
    let mut table = [[[0; LANES]; WINDOW]; 2 * FEW_CLUSTERS / LANES];
    let mut i = 0;
    while i < 2 * FEW_CLUSTERS {
        let mut k = 0;
        while k < WINDOW {
            table[i / LANES][k][i % LANES] = (i ^ (i + k).wrapping_sub(SEARCH_RADIUS)) as u32 & PARTNER_BITS;
            k += 1;
        }
        i += 1;
    }
    table
};

impl Boxes {
    fn of(clusters: &[Cluster]) -> Self {
        let (low, high) = ([-SENTINEL; BOX_CAPACITY], [SENTINEL; BOX_CAPACITY]);
        let mut boxes = Self([low, low, low, high, high, high]);
        boxes.update(clusters, 0);
        boxes
    }

    /// Loads the boxes of `clusters`. `before` is the number of clusters loaded by the previous call; boxes beyond the
    /// new clusters become sentinels.
    fn update(&mut self, clusters: &[Cluster], before: usize) {
        for (i, cluster) in clusters.iter().enumerate() {
            self.set(i, cluster.node.min.into(), cluster.node.max.into());
        }
        (clusters.len()..before).for_each(|i| self.set(i, [-SENTINEL; 3], [SENTINEL; 3]));
    }

    fn set(&mut self, i: usize, low: [f32; 3], high: [f32; 3]) {
        for axis in 0..3 {
            self.0[axis][SEARCH_RADIUS + i] = low[axis];
            self.0[3 + axis][SEARCH_RADIUS + i] = high[axis];
        }
    }

    /// Chooses for each cluster the neighbour with which it forms the smallest box. Returns half the area of that box
    /// as a float whose low bits ([`PARTNER_BITS`]) hold the XOR of the two indices. Non-negative floats sort as their
    /// bits do, so the smaller XOR wins if two areas agree in all higher bits.
    fn choose(&self, len: usize, level: Level) -> [f32; 2 * FEW_CLUSTERS] {
        match level {
            // SAFETY: the processor supports this level and all levels below it.
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 | Level::Avx512 => unsafe { self.choose_avx2(len) },
            Level::Baseline => self.choose_with::<Baseline>(len),
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn choose_avx2(&self, len: usize) -> [f32; 2 * FEW_CLUSTERS] {
        self.choose_with::<super::lanes::Avx2>(len)
    }

    #[inline(always)]
    fn choose_with<L: Lanes>(&self, len: usize) -> [f32; 2 * FEW_CLUSTERS] {
        let mut choices = [0.0; 2 * FEW_CLUSTERS];
        let rows = |at: usize| -> [L; 6] {
            std::array::from_fn(|k| L::load_from(self.0[k][at..at + LANES].first_chunk().unwrap_or(&[0.0; LANES])))
        };
        for (i, choices) in choices.chunks_exact_mut(LANES).enumerate().take(len.div_ceil(LANES)) {
            let own = rows(SEARCH_RADIUS + LANES * i);
            let mut best = L::splat(f32::MAX);
            for k in (0..SEARCH_RADIUS).chain(SEARCH_RADIUS + 1..WINDOW) {
                let other = rows(LANES * i + k);
                let extent = |axis: usize| own[3 + axis].max(other[3 + axis]).sub(own[axis].min(other[axis]));
                let [x, y, z] = [extent(0), extent(1), extent(2)];
                let area = x.add(y).mul(z).add(x.mul(y));
                best = best.min(area.with_bits(PARTNER_BITS, &INDEX_DIFFERENCE[i][k]));
            }
            choices.copy_from_slice(&best.store().0);
        }
        choices
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::leaves;
    use crate::job::Monitor;
    use crate::simd::forced;
    use glam::Vec3;

    fn depth(tree: &Tree, node: u32) -> u32 {
        match &tree[node] {
            node if node.is_leaf() => 0,
            node => 1 + depth(tree, node.first_index).max(depth(tree, node.first_index + 1)),
        }
    }

    #[test]
    fn equal_merges_make_a_balanced_tree() {
        // One triangle in every second square of a grid along x and along y. The gaps between the boxes of the
        // triangles keep any two of them from sharing a leaf.
        let square = |i: u32, j: u32| {
            let corner = |x, y| Vec3::new((2 * i) as f32 + x, (2 * j) as f32 + y, 0.0);
            [corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)]
        };
        let triangles: Vec<[Vec3; 3]> = (0..64).flat_map(|i| (0..64).map(move |j| square(i, j))).collect();
        let monitor = Monitor::default();
        let leaves = leaves::gather(&triangles, monitor.job()).unwrap();
        assert_eq!(leaves.list.len(), 64 * 64);
        let tree = binary_tree(&leaves, Level::Baseline, monitor.job()).unwrap();
        assert!((12..=14).contains(&depth(&tree, Tree::ROOT)), "{}", depth(&tree, Tree::ROOT));
        for level in forced::levels() {
            assert!(binary_tree(&leaves, level, monitor.job()).unwrap().parents == tree.parents, "{level:?}");
        }
    }
}
