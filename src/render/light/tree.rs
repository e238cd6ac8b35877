//! A light tree: a hierarchy of light clusters. Sampling descends the tree from the root with a single random number;
//! at each node, it selects a child in proportion to the child's importance for the receiver.
//!
//! Nodes have up to eight children, whose importances are computed together. Compared with binary nodes, wide nodes
//! need fewer steps and rely less on the coarse bounds of large clusters. Splits minimise the surface area orientation
//! heuristic of Conty Estevez and Kulla (2018, section 4.4), with two replacements. The squared diagonal replaces the
//! surface area, because it is positive also for lamps in one line. The length of the mean emission direction replaces
//! the solid angle.

use crate::error::Result;
use crate::image::{try_collect, try_vec};
use crate::maths;
use crate::render::bounds::{Bounds, BoundsLanes, LANES, Receiver};
use glam::{Vec3, Vec3A};

/// Number of bins per axis; their borders are the candidate splits. [convention]
const BINS: usize = 12;
/// From this depth on, splits halve the number of lights instead of minimising the heuristic. This limits the depth of
/// the tree. [convention]
const MAX_HEURISTIC_DEPTH: u32 = 48;
/// Costs count as equal if their relative difference is less than this value. Of splits of equal cost, the last one is
/// chosen (in the order of axes and borders). When the children of a node are formed, the first one of several parts of
/// equal cost is divided. Regular patterns of lamps often have equal costs, which differ only by rounding when
/// computed. Rounding must not decide, so that a scaled scene gets the same tree, and thus the same image. [rounding]
const TIE: f32 = 1e-4;
/// Offset, in bins, that is added to a position. A light on the border of two bins then falls into the upper bin,
/// whichever way its position is rounded. [rounding]
const BORDER: f32 = 1e-3;
/// Clusters of at least this many lights are split in parallel.
/// [convention: Embree's builders have the same threshold]
const PARALLEL_FROM: usize = 1024;
/// Index that stands for "no parent" or "no child".
const NONE: u32 = u32::MAX;
/// Bit that marks the index of a child as the index of a light.
const LIGHT: u32 = 1 << 31;

pub struct LightTree {
    /// Selection probabilities of the lights if the tree has no nodes; all are positive. A tree has no nodes if it has
    /// at most eight lights and their relative importance does not depend on the receiver. Examples are a single
    /// light, and lights whose bounds differ only in intensity, such as the two triangles of a rectangle.
    fixed: Vec<f64>,
    nodes: Vec<Node>,
    /// Slot of each light: 8 × the index of the node that holds it, plus its lane there.
    slots: Vec<u32>,
    /// Squared distances count as at least this value; see [`BoundsLanes::importance`].
    nearest: f32,
}

#[derive(Clone)]
struct Node {
    bounds: BoundsLanes,
    /// Children: the index of a node, or the index of a light with the bit `LIGHT` set; `NONE` for unused lanes.
    children: [u32; LANES],
    /// Slot of this node: 8 × the index of its parent node, plus its lane there; `NONE` for the root.
    parent_slot: u32,
}

/// A light, with the data needed while the tree is built.
struct Item {
    bounds: Bounds,
    extent: ClusterSums,
    centre: Vec3A,
    light: u32,
}

/// A cluster of at least two lights, divided into two parts. Its index in the list of clusters is the index of the
/// first light of its second part; no other cluster has this index.
#[derive(Clone, Copy, Default)]
struct Cluster {
    /// Value of the split heuristic for the undivided cluster.
    cost: f32,
    /// Indices of the two parts in the list of clusters. For a part that is a single light: the light's index, with
    /// the bit `LIGHT` set.
    parts: [u32; 2],
}

/// A child of a cluster, by its index: another cluster, or a light.
#[derive(Clone, Copy)]
pub enum Child {
    Cluster(usize),
    Light(usize),
}

impl LightTree {
    /// Builds the tree. There must be fewer than 2^31 lights, each of positive intensity.
    pub fn build(lights: &[Bounds]) -> Result<Self> {
        let mut tree = Self { fixed: Vec::new(), nodes: Vec::new(), slots: Vec::new(), nearest: f32::MIN_POSITIVE };
        if lights.len() <= LANES && lights.windows(2).all(|pair| pair[0].differs_only_in_intensity(&pair[1])) {
            let sum: f64 = lights.iter().map(|b| f64::from(b.intensity)).sum();
            tree.fixed = lights.iter().map(|b| f64::from(b.intensity) / sum).collect();
            return Ok(tree);
        }
        let item = |(bounds, light): (&Bounds, u32)| Item {
            bounds: *bounds,
            extent: ClusterSums::of(bounds),
            centre: bounds.centre().into(),
            light,
        };
        let mut items = try_collect(lights.iter().zip(0..).map(item))?;
        let mut clusters = try_vec(lights.len(), Cluster::default())?;
        let root = divide(&mut items, &mut clusters, 0, 0);
        tree.slots = try_vec(lights.len(), NONE)?;
        // Scale intensities by their sum, so that importances cannot overflow. For the same reason, distances count as
        // at least 1e-9 times the radius of the bounds of all lights, and as at least 1e-15.
        let whole = Bounds::union(lights);
        tree.nearest = maths::powi(whole.radius() * 1e-9, 2).max(1e-30);
        tree.add(&items, &clusters, root, NONE, 1.0 / whole.intensity.max(f32::MIN_POSITIVE));
        Ok(tree)
    }

    /// Appends the nodes of a cluster, parents before children. `slot` is the slot of the cluster in its parent node,
    /// as in [`Node::parent_slot`]; `scale` is the factor on all intensities. Returns the entry for [`Node::children`],
    /// and the bounds of the cluster.
    fn add(&mut self, items: &[Item], clusters: &[Cluster], cluster: u32, slot: u32, scale: f32) -> (u32, Bounds) {
        if cluster & LIGHT != 0 {
            let item = &items[(cluster & !LIGHT) as usize];
            self.slots[item.light as usize] = slot;
            return (LIGHT | item.light, item.bounds);
        }
        // Divide the part with the largest split heuristic in two. Repeat this until there are eight parts, or all
        // parts are single lights.
        let mut parts = vec![cluster];
        while parts.len() < LANES {
            let divisible = (0..parts.len()).filter(|&i| parts[i] & LIGHT == 0);
            let cost = |i: usize| clusters[parts[i] as usize].cost;
            let costlier = |best: usize, i: usize| if cost(i) > cost(best) * (1.0 + TIE) { i } else { best };
            let Some(costliest) = divisible.reduce(costlier) else { break };
            let two = clusters[parts[costliest] as usize].parts;
            parts.splice(costliest..=costliest, two);
        }
        let index = self.nodes.len();
        let mut children = [NONE; LANES];
        self.nodes.push(Node { bounds: BoundsLanes::new([], scale), children, parent_slot: slot });
        let mut bounds = Vec::with_capacity(LANES);
        for (lane, part) in parts.into_iter().enumerate() {
            let (child, of_child) = self.add(items, clusters, part, (index * LANES + lane) as u32, scale);
            children[lane] = child;
            bounds.push(of_child);
        }
        let node = &mut self.nodes[index];
        (node.children, node.bounds) = (children, BoundsLanes::new(bounds.iter().copied(), scale));
        (index as u32, Bounds::union(&bounds))
    }

    /// Returns the number of clusters. A tree that has lights but no nodes counts as one cluster; a tree without lights
    /// has no cluster. A cluster has a lower index than the clusters within it.
    pub fn clusters(&self) -> usize {
        self.nodes.len().max(usize::from(!self.fixed.is_empty()))
    }

    /// Returns the clusters and lights directly within a cluster.
    pub fn children(&self, cluster: usize) -> impl Iterator<Item = Child> {
        let of_node = self.nodes.get(cluster).into_iter().flat_map(|node| node.children).filter(|&c| c != NONE);
        let parts = of_node.map(|child| match child & LIGHT {
            0 => Child::Cluster(child as usize),
            _ => Child::Light((child & !LIGHT) as usize),
        });
        parts.chain((0..self.fixed.len()).map(Child::Light))
    }

    /// Samples a light in proportion to its importance for the receiver. Returns the light, its pmf, and the relative
    /// position of `u` in the interval that selects the light, in `[0, 1)`. Returns `None` if no light can reach the
    /// receiver.
    #[inline]
    pub fn sample(&self, receiver: &Receiver, u: f64) -> Option<(usize, f32, f64)> {
        let (mut pmf, mut u) = (1.0, u);
        for (light, &share) in self.fixed.iter().enumerate() {
            if u < share || light + 1 == self.fixed.len() {
                return Some((light, share as f32, (u / share).min(1.0 - f64::EPSILON)));
            }
            u -= share;
        }
        let mut node = self.nodes.first()?;
        loop {
            let importance = node.bounds.importance(receiver, self.nearest);
            let sum: f32 = importance.iter().sum();
            if !(sum > 0.0) {
                return None;
            }
            // Find the lane whose interval of the cumulative importance contains the target.
            let target = u * f64::from(sum);
            let (mut lane, mut below, mut running) = (0, 0.0, 0.0);
            for (i, &share) in importance.iter().enumerate() {
                if share > 0.0 && running <= target {
                    (lane, below) = (i, running);
                }
                running += f64::from(share);
            }
            let share = importance[lane];
            u = ((target - below) / f64::from(share)).clamp(0.0, 1.0 - f64::EPSILON);
            pmf *= share / sum;
            match node.children[lane] {
                NONE => return None,
                child if child & LIGHT != 0 => return Some(((child & !LIGHT) as usize, pmf, u)),
                child => node = &self.nodes[child as usize],
            }
        }
    }

    /// Returns the pmf with which [`LightTree::sample`] selects a light; 0 if the light cannot reach the receiver.
    pub fn pmf(&self, receiver: &Receiver, light: usize) -> f32 {
        if let Some(&share) = self.fixed.get(light) {
            return share as f32;
        }
        let mut pmf = 1.0;
        let mut slot = self.slots[light];
        while slot != NONE {
            let node = &self.nodes[slot as usize / LANES];
            let importance = node.bounds.importance(receiver, self.nearest);
            let sum: f32 = importance.iter().sum();
            let share = importance[slot as usize % LANES];
            if !(share > 0.0) {
                return 0.0;
            }
            pmf *= share / sum;
            slot = node.parent_slot;
        }
        pmf
    }
}

/// Divides the cluster of the lights `items` recursively, down to single lights; large clusters are divided in parallel
/// ([`PARALLEL_FROM`]). `clusters` is the slice of the list of clusters that belongs to these lights; the slice starts
/// at index `first` of the list. Returns the index of the cluster in the list; for a single light, returns the index
/// `first` with the bit `LIGHT` set.
fn divide(items: &mut [Item], clusters: &mut [Cluster], first: usize, depth: u32) -> u32 {
    if items.len() == 1 {
        return LIGHT | first as u32;
    }
    let extent = ClusterSums::of_all(items);
    let at = if depth < MAX_HEURISTIC_DEPTH { split(items) } else { items.len() / 2 };
    let in_parallel = items.len() >= PARALLEL_FROM;
    let (left, right) = items.split_at_mut(at);
    let (clusters_left, clusters_right) = clusters.split_at_mut(at);
    let mut divide_left = || divide(left, clusters_left, first, depth + 1);
    let mut divide_right = || divide(right, clusters_right, first + at, depth + 1);
    let parts = if in_parallel { rayon::join(divide_left, divide_right) } else { (divide_left(), divide_right()) };
    clusters_right[0] = Cluster { cost: extent.cost(), parts: parts.into() };
    (first + at) as u32
}

/// Sums over the lights of a cluster; the split heuristic is computed from them.
#[derive(Clone, Copy)]
struct ClusterSums {
    low: Vec3A,
    high: Vec3A,
    /// Sum of the emission axes, weighted by intensity. The axes of two-sided lights are flipped into one half-space.
    direction: Vec3A,
    intensity: f32,
    count: u32,
}

impl ClusterSums {
    const NOTHING: Self =
        Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY, direction: Vec3A::ZERO, intensity: 0.0, count: 0 };

    fn of(b: &Bounds) -> Self {
        let turned = b.two_sided && b.axis.dot(Vec3::new(1.0, 0.7, 0.4)) < 0.0;
        Self {
            low: b.low.into(),
            high: b.high.into(),
            direction: (if turned { -b.axis } else { b.axis } * b.intensity).into(),
            intensity: b.intensity,
            count: 1,
        }
    }

    fn of_all(items: &[Item]) -> Self {
        let mut extent = Self::NOTHING;
        items.iter().for_each(|item| extent.merge(&item.extent));
        extent
    }

    fn merge(&mut self, other: &Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
        self.direction += other.direction;
        self.intensity += other.intensity;
        self.count += other.count;
    }

    /// Returns the split heuristic: intensity × squared diagonal × a factor for the spread of directions, from 1 (all
    /// parallel) to 4 (all directions). Returns 0 without lights.
    fn cost(&self) -> f32 {
        if self.count == 0 {
            return 0.0;
        }
        let alike = self.direction.length() / self.intensity.max(f32::MIN_POSITIVE);
        self.intensity * (4.0 - 3.0 * alike.min(1.0)) * (self.high - self.low).length_squared()
    }
}

/// Splits a cluster of at least two lights by reordering `items`. Returns the size of the first part. Neither part is
/// empty: if no border of bins separates the lights, the first part is the first half of `items`.
fn split(items: &mut [Item]) -> usize {
    let low = items.iter().fold(Vec3A::INFINITY, |a, i| a.min(i.centre));
    let high = items.iter().fold(Vec3A::NEG_INFINITY, |a, i| a.max(i.centre));
    let binning = [0, 1, 2].map(|axis| Binning::new(low[axis], high[axis]));
    let mut bins = [[ClusterSums::NOTHING; BINS]; 3];
    // Skip axes without extent, such as the vertical for the lamps of a flat ceiling.
    let axes = (0..3).filter(|&axis| binning[axis].scale > 0.0);
    for item in items.iter() {
        for axis in axes.clone() {
            bins[axis][binning[axis].bin(item.centre[axis])].merge(&item.extent);
        }
    }
    let mut best = (f32::INFINITY, 0, 0);
    for axis in axes {
        let bins = &bins[axis];
        // For each border between two bins, compute the cost of the lights above the border, then add the cost of the
        // lights below it.
        let mut above = [0.0; BINS];
        let mut extent = ClusterSums::NOTHING;
        for i in (1..BINS).rev() {
            extent.merge(&bins[i]);
            above[i] = extent.cost();
        }
        let mut extent = ClusterSums::NOTHING;
        for i in 1..BINS {
            extent.merge(&bins[i - 1]);
            let cost = extent.cost() + above[i];
            if extent.count > 0 && (extent.count as usize) < items.len() && cost <= best.0 * (1.0 + TIE) {
                best = (cost, axis, i);
            }
        }
    }
    let (cost, axis, bin) = best;
    if cost < f32::INFINITY {
        return partition(items, |item| binning[axis].bin(item.centre[axis]) < bin);
    }
    items.len() / 2
}

/// Equal bins over an interval. If the interval is empty, all values fall into the first bin.
struct Binning {
    low: f32,
    scale: f32,
}

impl Binning {
    fn new(low: f32, high: f32) -> Self {
        let scale = BINS as f32 / (high - low);
        Self { low, scale: if scale.is_finite() { scale } else { 0.0 } }
    }

    fn bin(&self, x: f32) -> usize {
        (((x - self.low) * self.scale + BORDER) as usize).min(BINS - 1)
    }
}

/// Moves the items for which `first` is true to the front. Returns their number.
fn partition(items: &mut [Item], first: impl Fn(&Item) -> bool) -> usize {
    let mut count = 0;
    for i in 0..items.len() {
        if first(&items[i]) {
            items.swap(count, i);
            count += 1;
        }
    }
    count
}
