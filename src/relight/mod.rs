//! Relighting: solves for colour and intensity of the emission so that light transport matches the photo
//! ("Single-Exemplar Lighting Style Transfer", §7).
//!
//! Radiance is linear in the emission, so no search is needed. In each colour channel, two means over the target are
//! measured once: its radiance `r` under the current emission, and its radiance `b` under all other light. The
//! emission must be multiplied by `(target - b) / r`. Because both means are Monte Carlo estimates, the solution has a
//! confidence interval.
//!
//! Several emissive surfaces light each other's targets. [`run_together`] measures the response of each target to each
//! of them, and solves for all scales at once.
//!
//! The light of the same paths can also be sorted by its source (`bins`):
//!
//! - By lamp: this gives the responses of several targets to thousands of lamps ([`lamp_responses`]). A small convex
//!   problem then gives the powers of groups of lamps, within bounds or at dimming levels ([`solve_groups`]).
//! - By cell of the emissive surface: this gives an importance map ([`Importance`]). The dot product of the map and a
//!   texture is the response to this texture. The gradient of the response with respect to the placement of the
//!   texture leads to the best placement ([`Importance::place`]).
//!
//! Independently of light transport, [`mix_primaries`] mixes a colour from LEDs.
//!
//! Not modelled here: the photo's camera response beyond sRGB, and fluorescence (a channel never feeds another).

mod band;
mod bins;
mod bounded;
mod clipping;
mod coupled;
mod descent;
mod dimming;
mod emission_lamps;
mod estimate;
mod groups;
mod importance;
mod line_search;
mod params;
mod photo_colour;
mod placement;
mod primaries;
mod responses;
mod several;
mod sided;
mod solution;
mod solve;
mod target;
mod transport;
mod warnings;

pub use emission_lamps::EmissionLamps;
pub use estimate::BATCHES;
pub use groups::{Colour, GroupParams, GroupSolution, MAX_LEVELS, MAX_WEIGHT, Outcome, solve_groups};
pub use importance::{Importance, ImportanceParams, Response};
pub use params::{EmitterTarget, Fit, Params, Quantity, TargetGeometry};
pub use photo_colour::{PhotoColour, TargetColour, photo_colour};
pub use placement::{Aim, Placement, PlacementParams, Pose};
pub use primaries::{MAX_PRIMARIES, Mixture, mix_primaries};
pub use responses::{Aspect, Estimate, Goal, Responses, lamp_responses};
pub use several::{MAX_EMITTERS, run_together};
pub use sided::Constraint;
pub use solution::{Solution, TargetStatus};
pub use transport::{FIRST_ROUND, FORECAST_MARGIN};

#[cfg(test)]
mod tests;

use crate::error::{Result, check_range};
use crate::job::Job;
use crate::render::World;
use bins::{Bins, Partition};
use glam::Vec3;
use transport::{Batches, Stop};

#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The scene with the emission in place; the solution multiplies this emission.
    pub world: &'a World,
    /// Index of the emitting material to solve for.
    pub emitter: usize,
    /// The triangles of the target surface, each as (mesh, triangle). Light is measured on the side from which the
    /// triangles wind counter-clockwise.
    pub target_triangles: &'a [(usize, usize)],
    /// Mean radiance of the target to achieve, in cd/m² per channel, ≥ 0. For [`Quantity::Incident`], it is the
    /// radiance of a white surface in the same light, illuminance / π.
    pub target: Vec3,
}

/// Solves for the scale of the emission. Returns [`crate::error::ErrorKind::Unreachable`] if no channel can be solved.
pub fn run(input: &Input, params: &Params, job: Job) -> Result<Solution> {
    params.check()?;
    for channel in input.target.to_array() {
        check_range("target", channel, 0.0, f32::MAX)?;
    }
    let scene = input.world.scene();
    let points = target::Sampler::new(scene, TargetGeometry::Surface(input.target_triangles), params.quantity)?;
    let bins = Bins::new(input.world, input.emitter, Partition::Whole);
    let mut batches = Batches::new(input.world, &points, bins, params.seed)?;
    if params.fit == Fit::LeastSquares {
        batches = batches.in_pairs();
    }
    let stop = Stop::new(params);
    let mut growth = f64::INFINITY;
    loop {
        batches.trace_round(growth, stop.max_paths, job)?;
        let solution = solve::run(&whole(&batches, params.fit), input.target.as_dvec3(), params.constraint);
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

/// Returns the response of the target to the whole emission, in batches.
fn whole(batches: &Batches, fit: Fit) -> solve::BatchMeasurements {
    let means = batches.means();
    solve::BatchMeasurements {
        response: means.iter().map(|m| m.bins[0]).collect(),
        background: means.iter().map(|m| m.others).collect(),
        pairs: (fit == Fit::LeastSquares).then(|| means.iter().map(|m| m.pairs).collect()),
        paths: batches.paths(),
    }
}
