//! Plans the stages after the emissive texture in a lighting transfer: the solution for the strength of the emission,
//! and the picture.

use super::curve::allocate;
use super::picture::{Picture, Rendering};
use super::strength::Strength;
use super::{Clock, Expected, Goal, timed};
use crate::error::{Error, ErrorKind, Result};
use crate::job::Job;
use crate::maths;
use crate::relight;
use crate::render::{self, World};
use crate::transfer::{LitScene, Stage, Transfer};
use std::sync::Arc;

/// Settings and expectations of the last two stages of a transfer.
#[derive(Clone, Debug, PartialEq)]
pub struct Lighting {
    pub relight: relight::Params,
    pub render: render::Params,
    /// Expected time and error of [`Stage::Relight`]. The error is the relative half-width of the solution's
    /// confidence interval.
    pub solving: Expected,
    /// Expected time and error of [`Stage::Render`]. The error is the picture's sampling error alone.
    pub rendering: Expected,
    /// Expected time and error of both stages together. The error is the expected error of the resulting picture.
    pub whole: Expected,
}

/// Plans the stages RELIGHT and RENDER of a transfer whose stage EMISSION has run. Settings that do not affect quality
/// are kept.
///
/// # Errors
/// A goal or a setting out of range; no result of the stage EMISSION; no light path from the emission to the target;
/// cancellation.
pub fn lighting(transfer: &Transfer, goal: Goal, clock: Clock, job: Job) -> Result<Lighting> {
    let lit = check(transfer, goal)?;
    let (building, world) = timed(clock, || World::build(lit.scene.clone(), job.part(0.0, 0.2)));
    let world = world?;
    let triangles = lit.triangles();
    let camera = transfer.viewpoint(&world, &lit);
    let strength =
        Strength::new((&world, lit.placed.material, &triangles), &transfer.params.relight, clock, job.part(0.2, 0.5))?;
    let picture = Picture::new(&world, &camera, &transfer.params.render, clock, job.part(0.5, 1.0))?;

    // Both stages build the acceleration structure of the scene. For a goal in seconds, subtract twice the time of
    // building it. Allocate the remaining time to the stages along their error curves.
    let light = match goal {
        Goal::Seconds(budget) => Goal::Seconds((budget - 2.0 * building).max(0.0)),
        Goal::Error(_) => goal,
    };
    let contrast = picture.contrast();
    let seconds = allocate(&[strength.curve(contrast), picture.curve()], light);
    let (relight, mut solving) = strength.plan(&transfer.params.relight, goal, seconds[0]);
    let Rendering { params: render, expected: mut rendering } = picture.plan(&transfer.params.render, goal, seconds[1]);
    let error = maths::hypot(Strength::contribution(solving.error, contrast), rendering.error);
    solving.seconds += building;
    rendering.seconds += building;
    let whole = Expected { seconds: solving.seconds + rendering.seconds, error };
    job.report(1.0);
    Ok(Lighting { relight, render, solving, rendering, whole })
}

/// Checks the preconditions of a plan; this takes negligible time. Returns the scene with the lamps whose strength is
/// to be solved for.
pub fn check(transfer: &Transfer, goal: Goal) -> Result<Arc<LitScene>> {
    goal.check()?;
    transfer.params.check(Stage::Relight)?;
    transfer.params.check(Stage::Render)?;
    transfer.results.unsolved.clone().ok_or_else(|| {
        Error::new(ErrorKind::InvalidOperation, "run stage Emission first: a plan measures the light of its lamps")
    })
}
