//! Light transport: traces paths from the target and sums their light by bin, in independent batches of paths.

use super::bins::{Bins, Sorter};
use super::estimate::BATCHES;
use super::params::Params;
use super::target::Sampler;
use crate::error::Result;
use crate::exec;
use crate::image::try_vec;
use crate::job::Job;
use crate::maths;
use crate::render::World;
use crate::rng::{Rng, hash};
use glam::DVec3;
use rayon::prelude::*;
use std::time::Instant;

/// Number of paths per batch in the first round. Rounds follow until a stopping condition holds. The sizes of the
/// rounds only determine how many more paths are traced than necessary. \[convention\]
pub const FIRST_ROUND: u32 = 64;
/// Smallest and largest growth factor of the number of paths in later rounds. Like `FIRST_ROUND`, they change only the
/// number of rounds and the overshoot. [convention]
const GROWTH: [f64; 2] = [1.25, 4.0];
/// Safety factor on the predicted number of paths: with 32 batches, the error is known only to within 1 / √62 = 13 %.
/// If the forecast is too low, another round follows, so any value from 1 to 1.3 reaches the target error.
/// \[convention\]
pub const FORECAST_MARGIN: f64 = 1.1;

/// Stopping conditions: target error, time budget, and number of paths.
pub(super) struct Stop {
    clock: Instant,
    /// Time budget in seconds; may be infinite.
    budget: f64,
    /// Relative half-width of the confidence interval at which tracing stops; 0 if there is no target.
    target_error: f64,
    pub max_paths: u32,
}

impl Stop {
    pub fn new(params: &Params) -> Self {
        let milliseconds = f64::from(params.time_budget_ms);
        let budget = if milliseconds > 0.0 { milliseconds / 1e3 } else { f64::INFINITY };
        Self { clock: Instant::now(), budget, target_error: f64::from(params.target_error), max_paths: params.paths }
    }

    /// Returns the factor by which the number of paths should grow in the next round. `error` is the current relative
    /// half-width of the confidence interval, `paths` the current number of paths. Returns `None` if tracing must
    /// stop.
    pub fn growth(&self, error: f64, paths: u32) -> Option<f64> {
        let spent = self.clock.elapsed().as_secs_f64().max(1e-6);
        if error <= self.target_error && self.target_error > 0.0 || spent >= self.budget || paths >= self.max_paths {
            return None;
        }
        let forecast = if self.target_error > 0.0 {
            FORECAST_MARGIN * maths::powi(error / self.target_error, 2)
        } else {
            f64::INFINITY
        };
        Some(forecast.min(self.budget / spent))
    }
}

/// Number of paths between two checks for cancellation. [convention]
const CHUNK: u32 = 256;

/// The sums of one batch.
#[derive(Clone)]
struct Batch {
    /// Sum of the light of each bin.
    bins: Vec<DVec3>,
    /// Sum of the light that belongs to no bin.
    others: DVec3,
    /// Sums over pairs of paths from the same point; each term is the product of one path's light and the other's.
    pairs: Pairs,
    /// Number of paths summed; target points on lamps start no path.
    count: u32,
}

/// Second moments of the light at target points, estimated by the product of the light of two independent paths from
/// the same point. This product is unbiased; the square of one path's light would add the path's variance.
#[derive(Clone, Copy, Default)]
pub(super) struct Pairs {
    /// The square of the response, which is the light of the single bin.
    pub own: DVec3,
    /// The product of the response and the background (all other light).
    pub cross: DVec3,
}

/// Means over the paths of one batch.
pub(super) struct Means {
    pub bins: Vec<DVec3>,
    pub others: DVec3,
    /// Zero unless paths are traced in pairs.
    pub pairs: Pairs,
}

pub(super) struct Batches<'a> {
    world: &'a World,
    points: &'a Sampler<'a>,
    bins: Bins<'a>,
    seed: u64,
    paired: bool,
    batches: Vec<Batch>,
    /// Number of paths traced per batch.
    traced: u32,
}

impl<'a> Batches<'a> {
    pub fn new(world: &'a World, points: &'a Sampler<'a>, bins: Bins<'a>, seed: u64) -> Result<Self> {
        let mut batches = Vec::with_capacity(BATCHES);
        for _ in 0..BATCHES {
            let (others, pairs) = (DVec3::ZERO, Pairs::default());
            batches.push(Batch { bins: try_vec(bins.count(), DVec3::ZERO)?, others, pairs, count: 0 });
        }
        Ok(Self { world, points, bins, seed, paired: false, batches, traced: 0 })
    }

    /// Switches to tracing two paths from each point, which a least squares fit needs. Allowed only with a single bin.
    pub fn in_pairs(self) -> Self {
        Self { paired: true, ..self }
    }

    /// Number of paths traced so far.
    pub fn paths(&self) -> u32 {
        self.traced.saturating_mul(BATCHES as u32)
    }

    /// Traces paths until each batch has `growth` times its current number of paths, at least [`FIRST_ROUND`].
    /// `growth` is clamped to the range [`GROWTH`]. All batches together get at most about `limit` paths.
    pub fn trace_round(&mut self, growth: f64, limit: u32, job: Job) -> Result<()> {
        let max_per_batch = limit.div_ceil(BATCHES as u32);
        let wanted_paths = f64::from(self.traced) * growth.clamp(GROWTH[0], GROWTH[1]);
        let (first, last) = (self.traced, (wanted_paths as u32).max(FIRST_ROUND).min(max_per_batch));
        let part = job.part(f64::from(first) / f64::from(max_per_batch), f64::from(last) / f64::from(max_per_batch));
        let (world, points, bins) = (self.world, self.points, &self.bins);
        let (seed, paired) = (self.seed, self.paired);
        // Let one thread process a whole batch. The order of the additions in a batch, and so its rounded sums, then do
        // not depend on the number of threads.
        exec::for_rows(&mut self.batches, 1, part, |index, batch| {
            let seed = hash(seed, &[index as u64]);
            if paired {
                // Pair i consists of paths 2 i and 2 i + 1. Trace the pairs whose first path is new in this round.
                batch[0].extend_pairs(world, points, bins, seed, first.div_ceil(2)..last.div_ceil(2), job);
            } else {
                batch[0].extend(world, points, bins, seed, first..last, job);
            }
        })?;
        job.check()?;
        self.traced = last;
        Ok(())
    }

    /// Returns the light in each bin, as a mean over the paths of one batch.
    pub fn mean_of_bins(&self, batch: usize) -> impl Iterator<Item = DVec3> {
        let batch = &self.batches[batch];
        batch.bins.iter().map(|sum| sum / f64::from(batch.count.max(1)))
    }

    /// Returns the means over the paths of each batch: the light in each bin, and the light that belongs to no bin.
    pub fn means(&self) -> Vec<Means> {
        self.batches.iter().cloned().map(Batch::into_means).collect()
    }

    /// Like [`Self::means`], but consumes the batches.
    pub fn into_means(self) -> Vec<Means> {
        self.batches.into_par_iter().map(Batch::into_means).collect()
    }
}

impl Batch {
    fn into_means(self) -> Means {
        let Self { mut bins, others, pairs: Pairs { own, cross }, count } = self;
        let n = f64::from(count.max(1));
        bins.iter_mut().for_each(|sum| *sum /= n);
        Means { bins, others: others / n, pairs: Pairs { own: own / (n / 2.0), cross: cross / (n / 2.0) } }
    }

    fn extend(
        &mut self,
        world: &World,
        points: &Sampler,
        bins: &Bins,
        seed: u64,
        paths: std::ops::Range<u32>,
        job: Job,
    ) {
        let mut rng = Rng::new(seed, &[]);
        let shift = [rng.next_f64(), rng.next_f64()];
        for index in paths {
            if index % CHUNK == 0 && job.is_cancelled() {
                return;
            }
            let Some(target) = points.point(index, shift) else { continue };
            let mut sorter = Sorter::new(bins, target.factor, &mut self.bins, &mut self.others);
            target.gather(world, seed, index, &mut sorter);
            self.count += 1;
        }
    }

    /// Traces pairs of paths, both from the same point, and adds them to the batch.
    fn extend_pairs(
        &mut self,
        world: &World,
        points: &Sampler,
        bins: &Bins,
        seed: u64,
        pairs: std::ops::Range<u32>,
        job: Job,
    ) {
        let mut rng = Rng::new(seed, &[]);
        let shift = [rng.next_f64(), rng.next_f64()];
        let seeds = [seed, hash(seed, &[1])];
        for index in pairs {
            if index % CHUNK == 0 && job.is_cancelled() {
                return;
            }
            let Some(target) = points.point(index, shift) else { continue };
            let [a, b] = seeds.map(|seed| {
                let (mut response, mut background) = (DVec3::ZERO, DVec3::ZERO);
                let sums = std::slice::from_mut(&mut response);
                target.gather(world, seed, index, &mut Sorter::new(bins, target.factor, sums, &mut background));
                (response, background)
            });
            self.bins[0] += a.0 + b.0;
            self.others += a.1 + b.1;
            self.pairs.own += a.0 * b.0;
            self.pairs.cross += 0.5 * (a.0 * b.1 + b.0 * a.1);
            self.count += 2;
        }
    }
}
