//! Learns during a render which lights reach the surfaces in view, and samples the others rarely.
//!
//! In a building most lamps are behind walls. Light samples of them bring nothing, and a single room in a building of
//! 225 rooms takes 30 times the paths of that room alone. The first passes of a render therefore count, for each
//! light, its samples and those that arrive ([`super::survey`]). A light is *unlikely* if the posterior probability that its
//! next sample arrives is below [`MIN_ARRIVAL`], else *likely*. Two selectors share the samples: the unlikely lights
//! together get a small share ([`unlikely_share`]), the likely lights the rest. Every light keeps a positive
//! probability (a defensive mixture; Hesterberg 1995, "Weighted average importance sampling and defensive mixture
//! distributions"), so the estimate remains unbiased, and the contribution of an unlikely light grows at most by the
//! reciprocal of the share. An unlikely light whose sample arrives after all becomes likely with the next pass.
//!
//! The prior of a light comes from its neighbours in the light tree: if many of them are hidden, it is probably hidden
//! too. A neighbour counts as at most [`MAX_WITNESS`] samples, because a bright light with many samples says little
//! about a dim one that has none.
//!
//! A render that wastes few light samples on hidden lights keeps the selector of all lights, and with it every bit of
//! its image.

use super::bounds::Receiver;
use super::selector::{Inventory, Selector};
use super::survey::Evidence;
use super::tree::{Child, LightTree};
use crate::error::Result;
use crate::image::try_vec;

/// A light is unlikely below this posterior probability that a sample of it arrives. [judged on 3 scenes]
const MIN_ARRIVAL: f64 = 0.003;
/// Smallest and largest share of the light samples for the unlikely lights, and its product with the root of the number
/// of their samples without effect. [judged on 3 scenes]
const UNLIKELY_SHARES: [f64; 2] = [0.05, 0.1];
const UNLIKELY_ROOT: f64 = 4.0;
/// Largest number of samples as which a neighbour in the tree counts. [judged on 3 scenes]
const MAX_WITNESS: f64 = 16.0;
/// The importance of a likely light is multiplied by the root of its probability of arrival, at least by this factor.
/// [judged on 3 scenes]
const MIN_WEIGHT: f64 = 0.1;
/// Marks the place of an unlikely light.
const UNLIKELY: u32 = 1 << 31;

/// Which lights reach the surfaces in view, as far as a render has learned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reach {
    /// Number of lamps: connected luminous surfaces, punctual lights, and the environment.
    pub lamps: usize,
    /// Number of lamps from which no light sample arrived at any surface of any path, and hardly any will.
    pub hidden: usize,
    /// Number of light samples that showed it.
    pub samples: u64,
}

impl Reach {
    /// The result in words, for a person who wonders where the time goes.
    pub fn sentence(&self) -> String {
        let [hidden, lamps, samples] = [self.hidden, self.lamps, self.samples as usize].map(grouped);
        format!(
            "{hidden} of {lamps} lamps cannot be reached from here, as {samples} light samples show: they get few more."
        )
    }
}

/// A number with a comma between groups of three digits.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let is_start = |i: usize| i > 0 && (digits.len() - i).is_multiple_of(3);
    digits.chars().enumerate().flat_map(|(i, digit)| is_start(i).then_some(',').into_iter().chain([digit])).collect()
}

/// The likely and the unlikely lights.
pub struct Split {
    pub likely: Selector,
    pub unlikely: Selector,
    /// Shares of the samples of both.
    pub shares: [f64; 2],
    /// For each light at a finite distance its index in the tree of its selector, with the flag `UNLIKELY`.
    places: Vec<u32>,
    /// The weight of each light; 0 for unlikely lights.
    pub weights: Vec<f32>,
}

impl Split {
    /// Splits lights by their weights; `None` if all are likely or all are unlikely.
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

    /// Probability with which a piece is selected.
    pub fn pmf(&self, receiver: &Receiver, piece: usize) -> f32 {
        let place = self.places[piece];
        let (selector, share) = match place & UNLIKELY {
            0 => (&self.likely, self.shares[0]),
            _ => (&self.unlikely, self.shares[1]),
        };
        selector.tree.pmf(receiver, (place & !UNLIKELY) as usize) * (selector.groups[0] * share) as f32
    }

    /// Probability with which the environment is selected.
    pub fn environment(&self) -> f64 {
        self.likely.groups[2] * self.shares[0] + self.unlikely.groups[2] * self.shares[1]
    }

    /// Whether two lists of weights have the same unlikely lights.
    pub fn is_same(&self, weights: &[f32]) -> bool {
        self.weights.iter().zip(weights).all(|(&a, &b)| (a > 0.0) == (b > 0.0))
    }
}

/// Share of the samples for the unlikely lights, after this number of their samples without effect. The variance is
/// smallest at the root of the probability that a sample arrives, which is about the reciprocal of that number.
pub fn unlikely_share(samples: u64) -> f64 {
    let [min, max] = UNLIKELY_SHARES;
    (UNLIKELY_ROOT / (samples.max(1) as f64).sqrt()).clamp(min, max)
}

/// The weight of each light: the root of the probability that a sample of it arrives, or 0 if it is unlikely. The root
/// minimises the variance if each sample arrives with that probability, independently of the receiver.
pub fn weights(lights: &Inventory, tree: &LightTree, evidence: &[Evidence]) -> Result<Vec<f32>> {
    let mut priors = try_vec(lights.len(), 1.0)?;
    neighbour_priors(tree, evidence, &mut priors)?;
    let mut weights = try_vec(lights.len(), 0.0)?;
    for ((weight, prior), own) in weights.iter_mut().zip(priors).zip(evidence) {
        let arrival = (own.arrived as f64 + prior) / (own.drawn as f64 + 1.0);
        if own.arrived > 0 || arrival >= MIN_ARRIVAL {
            *weight = arrival.sqrt().clamp(MIN_WEIGHT, 1.0) as f32;
        }
    }
    Ok(weights)
}

/// Sets the prior of each light of a tree, that a sample of it arrives, from the evidence of the other clusters on its
/// way from the root.
fn neighbour_priors(tree: &LightTree, evidence: &[Evidence], priors: &mut [f64]) -> Result<()> {
    // Add up the evidence of the clusters: parents come before their children.
    let mut witnesses = try_vec(tree.clusters(), [0.0; 2])?;
    let of_child = |witnesses: &[[f64; 2]], child: Child| {
        let [drawn, arrived] = match child {
            Child::Cluster(cluster) => witnesses[cluster],
            Child::Light(light) => [evidence[light].drawn as f64, evidence[light].arrived as f64],
        };
        let scale = MAX_WITNESS.min(drawn) / drawn.max(1.0);
        [drawn * scale, arrived * scale]
    };
    for cluster in (0..tree.clusters()).rev() {
        let [mut drawn, mut arrived] = [0.0; 2];
        for child in tree.children(cluster) {
            let witness = of_child(&witnesses, child);
            (drawn, arrived) = (drawn + witness[0], arrived + witness[1]);
        }
        witnesses[cluster] = [drawn, arrived];
    }
    // Hand the priors down.
    let mut of_clusters = try_vec(tree.clusters(), 1.0)?;
    for cluster in 0..tree.clusters() {
        let ([drawn, arrived], prior) = (witnesses[cluster], of_clusters[cluster]);
        for child in tree.children(cluster) {
            let own = of_child(&witnesses, child);
            let others = (arrived - own[1] + prior) / (drawn - own[0] + 1.0);
            match child {
                Child::Cluster(child) => of_clusters[child] = others.clamp(0.0, 1.0),
                Child::Light(light) => priors[light] = others.clamp(0.0, 1.0),
            }
        }
    }
    Ok(())
}
