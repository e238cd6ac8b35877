//! Planning of stylisations
//!
//! Chooses the settings of a stylisation for a given time or error. A plan tries settings from fast to slow on the
//! actual input at reduced resolution. These trials take a small share of the time of a stylisation with
//! LUXFER_STYLIZE_FULL; the share falls with the size of the target.

use super::guard::enter;
use super::handle::{self, Owned};
use super::job::luxfer_job;
use super::params::{self, Report};
use super::plan::{Output, luxfer_plan, luxfer_plan_params};
use super::status::luxfer_status;
use super::stylize::luxfer_stylize;
use super::stylize_params::luxfer_stylize_params;
use crate::plan;

/// Starts a job that plans a stylisation of the whole target with the current artwork, guides and masks of stylize.
/// The plan chooses only the numbers of rounds and search iterations (the fields iterations, coarse_iterations,
/// finest_iterations, polish and search_iterations). The resolution and all other values come from settings, where NULL
/// stands for the defaults. params gives the goal, a time or an error. If no settings reach the goal, the plan gives
/// the settings that come nearest to it. The caller releases *job. Any thread.
///
/// The error is the square root of luxfer_stylize_report.energy: the root mean square difference of matched patches in
/// colours and guides, whose values are in [0, 1].
/// LUXFER_INVALID_ARGUMENT if params is NULL or does not set exactly one goal, or if a setting is out of range;
/// LUXFER_INVALID_OPERATION if artwork or guides are missing or a job is already running. The job may end with any
/// status with which a job of luxfer_stylize_start may end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_plan_start_stylize(
    plan: *mut luxfer_plan,
    stylize: *mut luxfer_stylize,
    settings: *const luxfer_stylize_params,
    params: *const luxfer_plan_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(plan, |stage| {
        let inputs = handle::borrow_in(stage.context(), stylize, "stylize")?.inputs();
        inputs.check()?;
        let settings = params::read(settings)?;
        let keep_for_update = params::flag(settings.keep_for_update, "keep_for_update")?;
        let settings = settings.params()?;
        let goal = params::read_required(params)?.goal()?;
        stage.start(job, move |(), _, job| {
            let planned = inputs.with_input(|input| plan::stylisation(input, &settings, goal, &plan::wall(), job))?;
            Ok(Output::of_stylisation(planned, keep_for_update))
        })
    })
}

/// Gets the settings to stylise with: the settings given at the start, except the numbers of rounds and search
/// iterations, which the plan has chosen. size is sizeof *params. Any thread.
/// LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND unless the plan is of a stylisation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_plan_get_stylize_params(
    plan: *mut luxfer_plan,
    params: *mut luxfer_stylize_params,
    size: usize,
) -> luxfer_status {
    enter(plan, |stage| {
        let out = Report::new(params, size)?;
        let made = stage.output()?;
        let planned = made.stylize()?;
        out.set(luxfer_stylize_params {
            keep_for_update: planned.keep_for_update.into(),
            ..luxfer_stylize_params::of(&planned.params)
        });
        Ok(())
    })
}
