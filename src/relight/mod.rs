//! Relighting: colour and intensity of the emission, solved against the photo through light transport
//! ("Single-Exemplar Lighting Style Transfer", §7).
//!
//! Radiance is linear in emission, so nothing is searched: per colour channel the mean light `r` that the target surface
//! sends back under the emission as it stands, and the light `b` of everything else, are measured once; the answer is
//! `(target - b) / r`. The measurement is Monte Carlo, so the answer carries a confidence interval.
//!
//! The same paths tell more when their light is sorted by where it came from (`bins`). By lamp, they give the response of
//! several targets to each of thousands of lamps ([`lamp_responses`]), and a small convex problem gives the powers of
//! groups of lamps within bounds ([`solve_groups`]), or in steps that they can be dimmed by. [`mix_primaries`] makes a
//! colour from the LEDs there are. By cell of a surface, they give its [`Importance`]: what any texture
//! laid there would mean to the target, for one dot product, and by its gradient where it should lie ([`Importance::place`]).
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
mod warnings;

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

/// What should match the photo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The light the target surface sends back, its albedo included: what a photo shows of it.
    Outgoing,
    /// The light that arrives at it, as if it were white.
    Incident,
}

/// What of the target counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// Its mean: what the paper asks for, a single colour.
    Mean,
    /// Every point of it, by least squares: what gradient descent on texels comes to (Lipp et al. 2024). Bright points count
    /// more, so the answer is dimmer than that of the mean by `1 / (1 + CV²)` without other light, where CV is the spread
    /// of the response over the target relative to its mean.
    LeastSquares,
}

/// How far an answer could go to meet the target in one colour channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// The target is met.
    Met,
    /// Other lights alone exceed the target: the emission is off in this channel.
    TooBright,
    /// All lamps at their upper bounds do not suffice, or one target asks for what another forbids.
    TooDim,
    /// No light of this channel finds its way to the target, so nothing can be said about it: the emission keeps the
    /// mean scale of the channels that could be solved.
    Dark,
}

/// What is to have the light that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place<'a> {
    /// A surface: (mesh, triangle) of each of its triangles, their winding facing the side to match. Lamps in it are left
    /// out.
    Surface(&'a [(usize, usize)]),
    /// A calculation grid: the parallelogram of a corner and two edges, as seen from the side of `normal`. Its light is
    /// that of a white surface there, illuminance / π.
    Grid { origin: Vec3, across: Vec3, down: Vec3, normal: Vec3 },
}

#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The scene with the emission in place, at the strength the solution will multiply.
    pub world: &'a World,
    /// Index of the emitting material to solve for.
    pub emitter: usize,
    /// The target surface: (mesh, triangle) of each of its triangles, their winding facing the side to match.
    pub target_triangles: &'a [(usize, usize)],
    /// Mean radiance the target surface should have, in cd/m² per channel, ≥ 0; for [`Quantity::Incident`] that of a
    /// white surface in the same light, illuminance / π.
    pub target: Vec3,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    pub quantity: Quantity,
    /// Used by [`run`] alone, as is the next.
    pub fit: Fit,
    /// On which side of the target each channel should be: clipped pixels of a photo say "at least". Such a channel keeps the
    /// mean scale of those that are to be at theirs, as far as that is on its side, and goes to its limit if not.
    pub sense: [Sense; 3],
    /// Most paths to trace, in `[1024, 1 << 30]`.
    pub paths: u32,
    /// Stop when the half-width of the widest 95 % interval is below this share of its answer, in `[0, 1]`; 0 = never.
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
    /// What to multiply the emission with, per channel, ≥ 0.
    pub scale: DVec3,
    /// Half-widths of the 95 % confidence intervals of `scale`.
    pub half_width: DVec3,
    pub reach: [Reach; 3],
    /// On which side of the target each channel had to be.
    pub sense: [Sense; 3],
    /// Mean radiance of the target under the emission at scale 1, in cd/m².
    pub response: DVec3,
    /// Mean radiance of the target under all other light, in cd/m².
    pub background: DVec3,
    /// How far the colour of the target may be off: 95 % of errors are below this CIEDE2000 difference, seen at the
    /// exposure that shows the target as a middle grey.
    pub delta_e: f64,
    /// Paths traced.
    pub paths: u32,
}

impl Solution {
    /// The widest relative half-width among the channels that met their target; 0 if none did.
    pub fn error(&self) -> f64 {
        (0..3)
            .filter(|&c| self.reach[c] == Reach::Met && self.scale[c] > 0.0)
            .map(|c| self.half_width[c] / self.scale[c])
            .fold(0.0, f64::max)
    }
}

/// Solves for the scale of the emission. [`crate::error::ErrorKind::Unreachable`] where no channel can be solved.
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
        batches.trace_round(growth, stop.most, job)?;
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

/// The response of the target to all of the emission.
fn whole(batches: &Batches, fit: Fit) -> solve::Measured {
    let means = batches.means();
    solve::Measured {
        response: means.iter().map(|m| m.bins[0]).collect(),
        background: means.iter().map(|m| m.others).collect(),
        pairs: (fit == Fit::LeastSquares).then(|| means.iter().map(|m| m.pairs).collect()),
        paths: batches.paths(),
    }
}
