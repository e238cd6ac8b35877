//! Relighting of several emitters together: each has a target of its own, and all targets see the light of all
//! emitters.

use super::bins::Bins;
use super::coupled::Coupled;
use super::params::{EmitterTarget, Fit, Params, TargetGeometry};
use super::solution::Solution;
use super::target::Sampler;
use super::transport::{Batches, Stop};
use crate::error::{Error, Result, check_range};
use crate::job::Job;
use crate::render::World;

/// Maximum number of emitters that are solved for together: the responses of each target to each emitter are measured.
/// \[convention\]
pub const MAX_EMITTERS: usize = 16;

/// Solves for the scales of several emitters, so that each target has its light from all of them. The result does not
/// depend on the order of the planes, apart from rounding. `params.constraint` is ignored.
///
/// # Errors
/// `InvalidArgument`: no plane, more than [`MAX_EMITTERS`], two planes with one emitter, [`Fit::LeastSquares`], or a
/// parameter out of range. `Unreachable`: no channel of any target can be met.
pub fn run_together(world: &World, planes: &[EmitterTarget], params: &Params, job: Job) -> Result<Vec<Solution>> {
    check(planes, params)?;
    let scene = world.scene();
    let emitters: Vec<usize> = planes.iter().map(|plane| plane.emitter).collect();
    let samplers: Vec<Sampler> = planes
        .iter()
        .map(|plane| Sampler::new(scene, TargetGeometry::Surface(plane.target_triangles), params.quantity))
        .collect::<Result<_>>()?;
    let mut batches: Vec<Batches> = samplers
        .iter()
        .map(|points| Batches::new(world, points, Bins::of_emitters(world, &emitters), params.seed))
        .collect::<Result<_>>()?;
    let stop = Stop::new(params);
    let share = 1.0 / planes.len() as f64;
    let mut growth = f64::INFINITY;
    loop {
        for (i, batch) in batches.iter_mut().enumerate() {
            let part = job.part(share * i as f64, (share * (i + 1) as f64).min(1.0));
            batch.trace_round(growth, stop.max_paths, part)?;
        }
        let paths = batches[0].paths();
        let measured: Vec<_> = batches.iter().map(Batches::means).collect();
        let solutions = Coupled { planes, measured: &measured, paths }.solve();
        let error = |all: &Vec<Solution>| all.iter().map(Solution::error).fold(0.0, f64::max);
        match stop.growth(solutions.as_ref().map_or(f64::INFINITY, error), paths) {
            Some(more) => growth = more,
            None => {
                job.report(1.0);
                return solutions;
            }
        }
    }
}

fn check(planes: &[EmitterTarget], params: &Params) -> Result<()> {
    params.check()?;
    if planes.is_empty() || planes.len() > MAX_EMITTERS {
        return Err(Error::argument(format!("there are {} planes; there must be 1 to {MAX_EMITTERS}", planes.len())));
    }
    if params.fit == Fit::LeastSquares {
        return Err(Error::argument("fit is least squares; several planes can only be fitted by their means"));
    }
    for (i, plane) in planes.iter().enumerate() {
        if planes[..i].iter().any(|before| before.emitter == plane.emitter) {
            return Err(Error::argument(format!("two planes have the emitting material {}", plane.emitter)));
        }
        for channel in plane.target.to_array() {
            check_range("target", channel, 0.0, f32::MAX)?;
        }
    }
    Ok(())
}
