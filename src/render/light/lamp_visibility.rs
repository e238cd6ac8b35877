//! Learns during a render which lights reach the surfaces in view, and samples the remaining lights rarely.
//!
//! In a building, walls hide most lamps from the surfaces in view, and light samples of hidden lamps are wasted: to
//! render one room of a building of 225 rooms takes 30 times as many paths as to render that room alone. The first
//! passes of a render therefore count, for each light, how many samples are drawn and how many arrive
//! ([`super::survey`]). A sample arrives if nothing occludes it. A light is *likely* if one of its samples has arrived,
//! or if the estimated probability that its next sample arrives is at least [`MIN_ARRIVAL`]. Otherwise it is
//! *unlikely*.
//!
//! Likely and unlikely lights have a selector each. The unlikely lights together get a small share of the light
//! samples ([`unlikely_share`]), and the likely lights get the rest. Every light keeps a positive probability, so the
//! estimate remains unbiased (a defensive mixture; Hesterberg 1995, "Weighted average importance sampling and
//! defensive mixture distributions"). If a sample of an unlikely light arrives after all, its contribution is larger
//! than with one selector for all lights, by a factor of at most about 1 / share. The next decision
//! ([`super::learning`]) then makes the light likely.
//!
//! Before a light has samples of its own, the probability that its samples arrive is estimated from its neighbours in
//! the light tree: if many of them are hidden, the light is probably hidden too. A neighbour counts as at most
//! [`MAX_NEIGHBOUR_SAMPLES`] samples, because a bright light with many samples says little about a dim light without
//! samples.
//!
//! A render that wastes few light samples on hidden lights keeps the selector of all lights. Its image is then the
//! same, bit for bit, as without learning.

use super::selector::{Inventory, Selector};
use super::survey::SampleCounts;
use super::tree::{Child, LightTree};
use crate::error::Result;
use crate::image::try_vec;
use crate::maths;
use crate::render::bounds::Receiver;

/// A light is unlikely if none of its samples has arrived and the estimated probability that the next one arrives is
/// below this value. [judged on 3 scenes]
const MIN_ARRIVAL: f64 = 0.003;
/// Share of the light samples that all unlikely lights together get: `UNLIKELY_ROOT` / √n, clamped to the range
/// `UNLIKELY_SHARES`. Here n is the number of samples already drawn from these lights, and √n is rounded down to a
/// power of two. [judged on 3 scenes]
const UNLIKELY_SHARES: [f64; 2] = [0.03, 0.1];
const UNLIKELY_ROOT: f64 = 4.0;
/// The probability that a light's samples arrive is estimated from the samples of its neighbours in the light tree.
/// Each neighbour counts as at most this many samples: if a neighbour has more, its numbers of drawn and of arrived
/// samples are scaled down by the same factor. [judged on 3 scenes]
const MAX_NEIGHBOUR_SAMPLES: f64 = 16.0;
/// The importance of a likely light is multiplied by the square root of the probability that a sample of the light
/// arrives. This factor is rounded to a power of two and is at least this value. [judged on 3 scenes]
const MIN_WEIGHT: f64 = 0.125;
/// Bit that marks an unlikely light in an entry of [`Split::places`].
const UNLIKELY: u32 = 1 << 31;

/// What a render has learned about which lamps reach the surfaces in view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LampVisibility {
    /// Number of all lamps of the scene that emit: connected luminous surfaces, punctual lights, and the environment.
    pub lamps: usize,
    /// Number of hidden lamps. A lamp is hidden if no light sample of it has arrived at a vertex of a path so far, and
    /// later samples are unlikely to arrive.
    pub hidden: usize,
    /// Number of light samples on which `hidden` is based.
    pub samples: u64,
}

impl LampVisibility {
    /// Returns a sentence for the user: how many lamps are hidden, and that these lamps get few of the further light
    /// samples.
    pub fn sentence(&self) -> String {
        let [hidden, lamps, samples] = [self.hidden, self.lamps, self.samples as usize].map(grouped);
        format!(
            "{hidden} of {lamps} lamps cannot be reached from here, as {samples} light samples show: they get few more."
        )
    }
}

/// Formats a number with commas between groups of three digits.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let is_start = |i: usize| i > 0 && (digits.len() - i).is_multiple_of(3);
    digits.chars().enumerate().flat_map(|(i, digit)| is_start(i).then_some(',').into_iter().chain([digit])).collect()
}

/// The lights of a scene, divided by whether their samples are likely or unlikely to arrive unoccluded.
pub struct Split {
    pub likely: Selector,
    pub unlikely: Selector,
    /// Share of the light samples for the likely lights, and share for the unlikely lights; their sum is 1.
    pub shares: [f64; 2],
    /// For each light at a finite distance, its index in the tree of the selector that holds it. The bit [`UNLIKELY`]
    /// is set if that is the selector `unlikely`.
    places: Vec<u32>,
    /// Factor on the importance of each light, indexed by the light's number in the [`Inventory`]; 0 for unlikely
    /// lights.
    pub weights: Vec<f32>,
}

impl Split {
    /// Divides the lights: lights with a positive weight are likely, lights with weight 0 are unlikely. Returns `None`
    /// if one of the two selectors would have no light.
    pub fn new(lights: &Inventory, weights: Vec<f32>, unlikely_share: f64) -> Result<Option<Self>> {
        let likely = Selector::of_some(lights, |light| weights[light])?;
        let unlikely = Selector::of_some(lights, |light| if weights[light] > 0.0 { 0.0 } else { 1.0 })?;
        if [&likely, &unlikely].iter().any(|s| s.groups.iter().all(|&p| p == 0.0)) {
            return Ok(None);
        }
        let mut places = try_vec(lights.bounds.len(), 0)?;
        for (members, flag) in [(likely.members(), 0), (unlikely.members(), UNLIKELY)] {
            members.iter().zip(0..).for_each(|(&light, index)| places[light as usize] = flag | index);
        }
        Ok(Some(Self { likely, unlikely, shares: [1.0 - unlikely_share, unlikely_share], places, weights }))
    }

    /// Returns the probability with which a piece of an emissive surface is selected for a receiver.
    pub fn pmf(&self, receiver: &Receiver, piece: usize) -> f32 {
        let place = self.places[piece];
        let (selector, share) = match place & UNLIKELY {
            0 => (&self.likely, self.shares[0]),
            _ => (&self.unlikely, self.shares[1]),
        };
        selector.tree.pmf(receiver, (place & !UNLIKELY) as usize) * (selector.groups[0] * share) as f32
    }

    /// Returns the probability with which the environment is selected.
    pub fn environment(&self) -> f64 {
        self.likely.groups[2] * self.shares[0] + self.unlikely.groups[2] * self.shares[1]
    }

    /// Whether exactly the present unlikely lights have the weight 0 in `weights`. A new split by `weights` would then
    /// have the same likely and unlikely lights as `self`.
    pub fn is_same(&self, weights: &[f32]) -> bool {
        self.weights.iter().zip(weights).all(|(&a, &b)| (a > 0.0) == (b > 0.0))
    }
}

/// Returns the share of the light samples that the unlikely lights get together, within `UNLIKELY_SHARES`. `samples` is
/// the number of samples already drawn from these lights; no such sample has arrived.
///
/// Let p be the probability that a sample of these lights arrives. The variance of the image is smallest if the share
/// is proportional to √p. As none of `samples` samples has arrived, p is at most about 1 / `samples`.
pub fn unlikely_share(samples: u64) -> f64 {
    let [min, max] = UNLIKELY_SHARES;
    let root = maths::exp2(f64::from(samples.max(1).ilog2() / 2));
    (UNLIKELY_ROOT / root).clamp(min, max)
}

/// Returns the factor on each light's importance: √p, where p is the probability that a sample of the light arrives,
/// or 0 if the light is unlikely.
///
/// - p is estimated from the light's own samples and a prior, which counts as one further sample.
/// - √p minimises the variance of the estimate if p is the same for all receivers.
/// - √p is rounded to a power of two and is at least [`MIN_WEIGHT`]. Due to the rounding, one sample more or less
///   seldom changes the factors, and lights whose samples nearly all arrive keep the factor 1.
pub fn weights(lights: &Inventory, tree: &LightTree, sample_counts: &[SampleCounts]) -> Result<Vec<f32>> {
    let mut priors = try_vec(lights.len(), 1.0)?;
    neighbour_priors(tree, sample_counts, &mut priors)?;
    let mut weights = try_vec(lights.len(), 0.0)?;
    for ((weight, prior), own) in weights.iter_mut().zip(priors).zip(sample_counts) {
        let arrival = (own.arrived as f64 + prior) / (own.drawn as f64 + 1.0);
        if own.arrived > 0 || arrival >= MIN_ARRIVAL {
            *weight = maths::exp2(maths::log2(arrival.sqrt()).round()).clamp(MIN_WEIGHT, 1.0) as f32;
        }
    }
    Ok(weights)
}

/// Sets the prior of each light of a tree: an estimate of the probability that a sample of the light arrives, from the
/// samples of other lights near it in the tree. Priors are passed down from the root. A child of a cluster gets the
/// prior (a + q) / (d + 1). Here q is the prior of the cluster, and d and a are the numbers of drawn and of arrived
/// samples of the cluster's other children. Each of these children counts as at most [`MAX_NEIGHBOUR_SAMPLES`]
/// samples.
fn neighbour_priors(tree: &LightTree, sample_counts: &[SampleCounts], priors: &mut [f64]) -> Result<()> {
    // Add up the samples of each cluster, from the last cluster to the first, because a cluster has a lower index than
    // the clusters within it. A child counts as at most `MAX_NEIGHBOUR_SAMPLES` samples.
    let mut cluster_counts = try_vec(tree.clusters(), [0.0; 2])?;
    let of_child = |cluster_counts: &[[f64; 2]], child: Child| {
        let [drawn, arrived] = match child {
            Child::Cluster(cluster) => cluster_counts[cluster],
            Child::Light(light) => [sample_counts[light].drawn as f64, sample_counts[light].arrived as f64],
        };
        let scale = MAX_NEIGHBOUR_SAMPLES.min(drawn) / drawn.max(1.0);
        [drawn * scale, arrived * scale]
    };
    for cluster in (0..tree.clusters()).rev() {
        let [mut drawn, mut arrived] = [0.0; 2];
        for child in tree.children(cluster) {
            let counts = of_child(&cluster_counts, child);
            (drawn, arrived) = (drawn + counts[0], arrived + counts[1]);
        }
        cluster_counts[cluster] = [drawn, arrived];
    }
    // Compute the prior of each child of a cluster from the prior of the cluster and the samples of the other
    // children.
    let mut of_clusters = try_vec(tree.clusters(), 1.0)?;
    for cluster in 0..tree.clusters() {
        let ([drawn, arrived], prior) = (cluster_counts[cluster], of_clusters[cluster]);
        for child in tree.children(cluster) {
            let own = of_child(&cluster_counts, child);
            let others = (arrived - own[1] + prior) / (drawn - own[0] + 1.0);
            match child {
                Child::Cluster(child) => of_clusters[child] = others.clamp(0.0, 1.0),
                Child::Light(light) => priors[light] = others.clamp(0.0, 1.0),
            }
        }
    }
    Ok(())
}
