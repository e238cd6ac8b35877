//! Planning
//!
//! Chooses the settings of relighting and rendering, or of a stylisation, for a given error or a given time, before
//! anything is rendered. A plan also predicts the time and the error of each stage. The cost of a path and the noise
//! depend on the scene, so a plan measures them on a small part of the actual work; this takes a few tenths of a
//! second, besides the preparation of the scene. A plan assumes that other programs keep the machine as busy as they
//! do now.
//!
//! The error of a picture is the root mean square error over its pixels, divided by its mean. It includes the noise
//! and the error in brightness that comes from the solution of the emission. luxfer_plan_start_stylize defines the
//! error of a stylisation.

use super::context::luxfer_context;
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::job::luxfer_job;
use super::params::{self, Report, Versioned, versioned};
use super::pointer::Out;
use super::relight::luxfer_relight_params;
use super::render::{luxfer_render, luxfer_render_params};
use super::stage::Stage;
use super::status::luxfer_status;
use super::transfer::{luxfer_transfer, luxfer_transfer_params};
use crate::error::{Error, ErrorKind, Result};
use crate::plan::{self, Expected, Goal};
use crate::relight;
use crate::render;
#[cfg(feature = "stylize")]
use crate::stylize;

/// A plan: the settings with which work reaches a given error, or ends within a given time. See luxfer_plan_create.
pub struct luxfer_plan {
    _opaque: [u8; 0],
}

/// Goal of a plan, a time or an error: set exactly one of time_budget_ms and target_error. Fill it with
/// luxfer_plan_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_plan_params {
    /// sizeof(luxfer_plan_params), set by luxfer_plan_params_init.
    pub struct_size: u32,
    /// Time for all planned work in milliseconds, in [1, 1e9]; 0 (the default) if the goal is target_error.
    pub time_budget_ms: u32,
    /// Error of the picture, or of the stylisation, in [1e-5, 1]; 0 (the default) if the goal is time_budget_ms.
    pub target_error: f32,
    /// Must be 0.
    pub reserved: u32,
}

versioned!(luxfer_plan_params, [16], { Self { struct_size: 16, time_budget_ms: 0, target_error: 0.0, reserved: 0 } });

impl luxfer_plan_params {
    pub(super) fn goal(&self) -> Result<Goal> {
        if self.reserved != 0 {
            return Err(Error::argument(format!("plan.reserved is {}; it must be 0", self.reserved)));
        }
        let goal = match (self.time_budget_ms, self.target_error) {
            (0, error) if error != 0.0 => Goal::Error(error.into()),
            (milliseconds, 0.0) if milliseconds > 0 => Goal::Seconds(f64::from(milliseconds) / 1e3),
            (milliseconds, error) => {
                return Err(Error::argument(format!(
                    "plan.time_budget_ms is {milliseconds} and plan.target_error is {error}; one of them must be above 0, the other 0"
                )));
            }
        };
        goal.check()?;
        Ok(goal)
    }
}

/// Times and errors that a plan predicts.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_plan_report {
    /// sizeof(luxfer_plan_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// 1 for a plan of a transfer, which includes relighting; 0 for a plan of a rendering or a stylisation.
    pub relights: u32,
    /// Predicted seconds for all planned work.
    pub seconds: f64,
    /// Predicted error of the picture or of the stylisation.
    pub error: f64,
    /// Predicted seconds for relighting, including the preparation of the scene; 0 unless the plan is of a transfer.
    pub relight_seconds: f64,
    /// Predicted value of luxfer_relight_report.error; 0 unless the plan is of a transfer.
    pub relight_error: f64,
    /// Predicted seconds for rendering. In a plan of a transfer, they include the preparation of the scene; in a plan
    /// of a rendering they do not, because the plan has already prepared it. 0 in a plan of a stylisation.
    pub render_seconds: f64,
    /// Predicted value of luxfer_render_report.error; 0 in a plan of a stylisation.
    pub render_error: f64,
}

versioned!(luxfer_plan_report, [56], {
    Self {
        struct_size: 56,
        relights: 0,
        seconds: 0.0,
        error: 0.0,
        relight_seconds: 0.0,
        relight_error: 0.0,
        render_seconds: 0.0,
        render_error: 0.0,
    }
});

/// The result of a plan: the settings, and the predicted time and error, of each planned stage.
#[derive(Default)]
pub(super) struct Output {
    whole: Expected,
    render: Option<(render::Params, Expected)>,
    relight: Option<(relight::Params, Expected)>,
    #[cfg(feature = "stylize")]
    stylize: Option<Stylisation>,
}

impl From<plan::Rendering> for Output {
    fn from(plan: plan::Rendering) -> Self {
        Self { whole: plan.expected, render: Some((plan.params, plan.expected)), ..Self::default() }
    }
}

impl From<plan::Lighting> for Output {
    fn from(plan: plan::Lighting) -> Self {
        let plan::Lighting { relight, render, solving, rendering, whole } = plan;
        Self { whole, render: Some((render, rendering)), relight: Some((relight, solving)), ..Self::default() }
    }
}

/// Settings of a planned stylisation, and whether to keep the data for updates.
#[cfg(feature = "stylize")]
pub(super) struct Stylisation {
    pub params: stylize::Params,
    pub keep_for_update: bool,
}

#[cfg(feature = "stylize")]
impl Output {
    pub(super) fn of_stylisation(plan: plan::Stylisation, keep_for_update: bool) -> Self {
        let stylize = Stylisation { params: plan.params, keep_for_update };
        Self { whole: plan.expected, stylize: Some(stylize), ..Self::default() }
    }

    pub(super) fn stylize(&self) -> Result<&Stylisation> {
        planned(&self.stylize, "stylises")
    }
}

/// Returns the part of a plan for one stage; an error if the plan does not cover the stage.
fn planned<'a, T>(part: &'a Option<T>, does: &str) -> Result<&'a T> {
    part.as_ref().ok_or_else(|| Error::new(ErrorKind::NotFound, format!("the plan is of nothing that {does}")))
}

impl Handle for luxfer_plan {
    type Object = Stage<(), Output>;
    const TAG: u64 = tag(b"lux.plan");
    const NAME: &'static str = "luxfer_plan";
}

/// Creates a plan without a result. The caller releases *plan. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_plan_create(
    context: *mut luxfer_context,
    plan: *mut *mut luxfer_plan,
) -> luxfer_status {
    enter(context, |object| {
        Out::new(plan, "plan")?.set(handle::give(Stage::new(object.context(), ())));
        Ok(())
    })
}

/// Starts a job that plans a rendering with the scene and the camera of render. settings gives the size of the picture
/// and the other settings that do not affect quality; NULL stands for the defaults. params gives the goal. The caller
/// releases *job. Any thread.
/// LUXFER_INVALID_ARGUMENT if params is NULL or does not set exactly one goal, or if a setting is out of range;
/// LUXFER_INVALID_OPERATION if the scene is missing or a job is already running; LUXFER_NOT_FOUND if no camera is set
/// and the scene has no camera.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_plan_start_render(
    plan: *mut luxfer_plan,
    render: *mut luxfer_render,
    settings: *const luxfer_render_params,
    params: *const luxfer_plan_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(plan, |stage| {
        let (object, scene, camera) = handle::borrow_in(stage.context(), render, "render")?.inputs().view()?;
        let settings = params::read(settings)?.params()?;
        settings.check()?;
        let goal = params::read_required(params)?.goal()?;
        stage.start(job, move |(), _, job| {
            let world = object.world(&scene, job.part(0.0, 0.3))?;
            plan::rendering(&world, &camera, &settings, goal, &plan::wall(), job.part(0.3, 1.0)).map(Output::from)
        })
    })
}

/// Starts a job that plans the stages RELIGHT and RENDER of a transfer, with the lamps that its stage EMISSION has
/// made. settings is the struct with which the transfer will be started; NULL stands for the defaults. params gives
/// the goal. The caller releases *job. Any thread.
///
/// After the job, get the planned settings by luxfer_plan_get_relight_params and luxfer_plan_get_render_params, and
/// let the fields relight and render of settings point to them.
/// LUXFER_INVALID_ARGUMENT if params is NULL or does not set exactly one goal, or if a setting is out of range;
/// LUXFER_INVALID_OPERATION before the stage EMISSION has a result, or if a job is already running. The job may end
/// with LUXFER_UNREACHABLE if no light of the lamps is reflected back to their surface.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_plan_start_transfer(
    plan: *mut luxfer_plan,
    transfer: *mut luxfer_transfer,
    settings: *const luxfer_transfer_params,
    params: *const luxfer_plan_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(plan, |stage| {
        let transfer = handle::borrow_in(stage.context(), transfer, "transfer")?;
        let planned = super::transfer::snapshot(&transfer, params::read(settings)?)?;
        let goal = params::read_required(params)?.goal()?;
        plan::check(&planned, goal)?;
        stage.start(job, move |(), _, job| plan::lighting(&planned, goal, &plan::wall(), job).map(Output::from))
    })
}

/// Gets the predictions of the plan. size is sizeof *report. Any thread.
/// LUXFER_NOT_READY before a job has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_plan_get_report(
    plan: *mut luxfer_plan,
    report: *mut luxfer_plan_report,
    size: usize,
) -> luxfer_status {
    enter(plan, |stage| {
        let out = Report::new(report, size)?;
        let made = stage.output()?;
        let [solving, rendering] =
            [made.relight.as_ref().map(|r| r.1), made.render.as_ref().map(|r| r.1)].map(Option::unwrap_or_default);
        out.set(luxfer_plan_report {
            relights: u32::from(made.relight.is_some()),
            seconds: made.whole.seconds,
            error: made.whole.error,
            relight_seconds: solving.seconds,
            relight_error: solving.error,
            render_seconds: rendering.seconds,
            render_error: rendering.error,
            ..luxfer_plan_report::defaults()
        });
        Ok(())
    })
}

/// Gets the settings to render with: the settings given at the start, except the settings of quality, which the plan
/// has chosen. size is sizeof *params. Any thread.
///
/// If the goal is an error, rendering stops when it reaches the error; if few paths suffice, the plan sets a fixed
/// number of paths instead. If the goal is a time, the plan sets the number of paths, so that repeated renderings give
/// equal pictures. It also sets time_budget_ms to 1.25 times the predicted time. This limit ends a rendering early only
/// if the machine becomes slower.
/// LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND in a plan of a stylisation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_plan_get_render_params(
    plan: *mut luxfer_plan,
    params: *mut luxfer_render_params,
    size: usize,
) -> luxfer_status {
    enter(plan, |stage| {
        let out = Report::new(params, size)?;
        let made = stage.output()?;
        out.set(luxfer_render_params::of(&planned(&made.render, "renders")?.0));
        Ok(())
    })
}

/// Gets the settings to relight with: the settings given at the start, except the settings of quality, which the
/// plan has chosen. size is sizeof *params. Any thread.
/// LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND unless the plan is of a transfer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_plan_get_relight_params(
    plan: *mut luxfer_plan,
    params: *mut luxfer_relight_params,
    size: usize,
) -> luxfer_status {
    enter(plan, |stage| {
        let out = Report::new(params, size)?;
        let made = stage.output()?;
        out.set(luxfer_relight_params::of(&planned(&made.relight, "relights")?.0));
        Ok(())
    })
}
