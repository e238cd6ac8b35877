//! Planning of stylisations
//!
//! How careful a stylisation can be in a time, or has to be for an error. A plan tries settings from quick to careful on the very
//! input at a part of its resolution, which takes a small part of the time of LUXFER_STYLIZE_FULL, less of larger targets.

use super::guard::enter;
use super::handle::{self, Owned};
use super::job::luxfer_job;
use super::params::{self, Report};
use super::plan::{Made, luxfer_plan, luxfer_plan_params};
use super::status::luxfer_status;
use super::stylize::luxfer_stylize;
use super::stylize_params::luxfer_stylize_params;
use crate::plan;

/// Starts a job that plans a stylisation, of all of the target, with the artwork, guides and masks that stylize has now.
/// settings give all that is kept, the preset's resolution with it: only numbers of rounds and sweeps are chosen; NULL for the
/// defaults. params says what for; the error is the root of luxfer_stylize_report.energy: how far matched patches differ,
/// root mean square, in colours and guides in [0, 1]. A goal out of reach gives the settings nearest to it. The caller
/// releases *job. Any thread.
/// LUXFER_INVALID_ARGUMENT if params is NULL, or has not one of its fields set, or a setting is out of range;
/// LUXFER_INVALID_OPERATION if artwork or guides are missing or a job runs already. The job may end as that of
/// luxfer_stylize_start.
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
            Ok(Made::of_stylisation(planned, keep_for_update))
        })
    })
}

/// Gets the settings to stylise with: those given, with what the plan has chosen. Set params->struct_size before. Any thread.
/// LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND in a plan of something else.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_plan_get_stylize_params(
    plan: *mut luxfer_plan,
    params: *mut luxfer_stylize_params,
) -> luxfer_status {
    enter(plan, |stage| {
        let out = Report::new(params)?;
        let made = stage.output()?;
        let planned = made.stylize()?;
        out.set(luxfer_stylize_params {
            keep_for_update: planned.keep_for_update.into(),
            ..luxfer_stylize_params::of(&planned.params)
        });
        Ok(())
    })
}
