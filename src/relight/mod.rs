//! Relighting: solves for colour and intensity of the emission so that light transport matches the photo
//! ("Single-Exemplar Lighting Style Transfer", §7).
//!
//! Radiance is linear in the emission, so no search is needed. Per colour channel, the mean radiance `r` of the target
//! under the current emission and its mean radiance `b` under all other light are measured once; the solution is
//! `(target - b) / r`. The measurement is a Monte Carlo estimate, so the solution has a confidence interval.
//!
//! Sorting the same paths by light source (`bins`) yields more. By lamp, they give the responses of several targets to
//! thousands of lamps ([`lamp_responses`]), and a small convex problem gives the powers of groups of lamps within
//! bounds ([`solve_groups`]) or at dimming levels. [`mix_primaries`] mixes a colour from LEDs. By cell of a surface,
//! they give its [`Importance`]: the response to any texture there for one dot product, and, by its gradient, the best
//! placement of a texture ([`Importance::place`]).
//!
//! Not modelled here: the photo's camera response beyond sRGB, and fluorescence (a channel never feeds another).

mod band;
mod bins;
mod bounded;
mod descent;
mod estimate;
mod groups;
mod importance;
mod lamps;
mod line_search;
mod placement;
mod primaries;
mod responses;
mod sided;
mod solve;
mod steps;
mod target;
mod transport;

pub use estimate::BATCHES;
pub use groups::{Colour, GroupParams, GroupSolution, MAX_LEVELS, Outcome, solve_groups};
pub use importance::{Importance, MapParams, Response};
pub use lamps::Lamps;
pub use placement::{Aim, PlaceParams, Placement, Pose};
pub use primaries::{MAX_PRIMARIES, Mixture, mix_primaries};
pub use responses::{Aspect, Estimate, Goal, Responses, lamp_responses};
pub use sided::Sense;

#[cfg(test)]
mod tests;

use crate::error::{Result, check_range};
use crate::job::Job;
use crate::render::World;
use bins::{Bins, Division};
use glam::{DVec3, Vec3};
use transport::{Batches, Stop};

/// The quantity of the target to match with the photo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Outgoing diffuse light of the target, its albedo included, as a photo shows it.
    Outgoing,
    /// Incident light, as reflected by a white target.
    Incident,
}

/// How a target of many points is matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// By its mean, as in the paper: a single colour.
    Mean,
    /// Point by point in the least squares sense, the limit of gradient descent on texels (Lipp et al. 2024). Bright
    /// points have more weight: without other light, the solution is dimmer by `1 / (1 + CV²)`, where CV is the
    /// coefficient of variation of the response over the target.
    LeastSquares,
}

/// Whether the target is met in one colour channel, and if not, why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TargetStatus {
    /// The target is met.
    Met,
    /// Other lights alone exceed the target: the emission is off in this channel.
    TooBright,
    /// All lamps at their upper bounds are too dim, or goals contradict each other.
    TooDim,
    /// No light of this channel reaches the target, so the channel cannot be solved; it gets the mean scale of the
    /// solved channels.
    Dark,
}

/// The geometry of a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place<'a> {
    /// A surface: (mesh, triangle) of each of its triangles, whose winding faces the side to match. Its lamps are
    /// excluded.
    Surface(&'a [(usize, usize)]),
    /// A calculation grid: a parallelogram of a corner and two edges, on the side of `normal`. Its light is that of a
    /// white surface there, illuminance / π.
    Grid { origin: Vec3, across: Vec3, down: Vec3, normal: Vec3 },
}

#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The scene with the emission in place; the solution multiplies this emission.
    pub world: &'a World,
    /// Index of the emitting material to solve for.
    pub emitter: usize,
    /// The target surface: (mesh, triangle) of each of its triangles, whose winding faces the side to match.
    pub target_triangles: &'a [(usize, usize)],
    /// Mean radiance of the target to achieve, in cd/m² per channel, ≥ 0; for [`Quantity::Incident`] that of a white
    /// surface in the same light, illuminance / π.
    pub target: Vec3,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    pub quantity: Quantity,
    /// Used by [`run`] only, like `sense`.
    pub fit: Fit,
    /// Whether the target of each channel is exact or a limit; clipped pixels of a photo give lower limits. A channel
    /// with a limit gets the mean scale of the exact channels if that satisfies the limit, and its limit otherwise.
    pub sense: [Sense; 3],
    /// Largest number of paths, in `[1024, 1 << 30]`.
    pub paths: u32,
    /// Stop when the largest relative half-width of the 95 % intervals is below this value, in `[0, 1]`; 0 = never.
    pub target_error: f32,
    /// Stop after this many milliseconds; 0 = never.
    pub time_budget_ms: u32,
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            quantity: Quantity::Outgoing,
            fit: Fit::Mean,
            sense: [Sense::Exactly; 3],
            paths: 1 << 20,
            target_error: 0.01,
            time_budget_ms: 0,
            seed: 1,
        }
    }
}

impl Params {
    /// Checks that every setting is in its range.
    pub fn check(&self) -> Result<()> {
        check_range("paths", self.paths, 1024, 1 << 30)?;
        check_range("target_error", self.target_error, 0.0, 1.0)?;
        Ok(())
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Multiplier of the emission per channel, ≥ 0.
    pub scale: DVec3,
    /// Half-widths of the 95 % confidence intervals of `scale`.
    pub half_width: DVec3,
    pub status: [TargetStatus; 3],
    /// Mean radiance of the target under the unscaled emission, in cd/m².
    pub response: DVec3,
    /// Mean radiance of the target under all other light, in cd/m².
    pub background: DVec3,
    /// Colour error of the target: the CIEDE2000 difference that 95 % of errors stay below, at the exposure that shows
    /// the target as a middle grey.
    pub delta_e: f64,
    /// Number of paths traced.
    pub paths: u32,
}

impl Solution {
    /// The largest relative half-width among the channels that met their target; 0 without such channels.
    pub fn error(&self) -> f64 {
        (0..3)
            .filter(|&c| self.status[c] == TargetStatus::Met && self.scale[c] > 0.0)
            .map(|c| self.half_width[c] / self.scale[c])
            .fold(0.0, f64::max)
    }
}

/// Solves for the scale of the emission. Returns [`crate::error::ErrorKind::Unreachable`] if no channel can be solved.
pub fn run(input: &Input, params: &Params, job: Job) -> Result<Solution> {
    params.check()?;
    for channel in input.target.to_array() {
        check_range("target", channel, 0.0, f32::MAX)?;
    }
    let scene = input.world.scene();
    let points = target::Sampler::new(scene, Place::Surface(input.target_triangles), params.quantity)?;
    let bins = Bins::new(input.world, input.emitter, Division::Whole);
    let mut batches = Batches::new(input.world, &points, bins, params.seed)?;
    if params.fit == Fit::LeastSquares {
        batches = batches.in_pairs();
    }
    let stop = Stop::new(params);
    let mut growth = f64::INFINITY;
    loop {
        batches.trace_round(growth, stop.max_paths, job)?;
        let solution = solve::run(&whole(&batches, params.fit), input.target.as_dvec3(), params.sense);
        let error = solution.as_ref().map_or(f64::INFINITY, Solution::error);
        match stop.growth(error, batches.paths()) {
            Some(more) => growth = more,
            None => {
                job.report(1.0);
                return solution;
            }
        }
    }
}

/// The response of the target to the whole emission.
fn whole(batches: &Batches, fit: Fit) -> solve::Measured {
    let means = batches.means();
    solve::Measured {
        response: means.iter().map(|m| m.bins[0]).collect(),
        background: means.iter().map(|m| m.others).collect(),
        pairs: (fit == Fit::LeastSquares).then(|| means.iter().map(|m| m.pairs).collect()),
        paths: batches.paths(),
    }
}
