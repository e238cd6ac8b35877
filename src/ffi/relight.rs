//! Relighting
//!
//! Solves for the colour and intensity of an emission, so that a surface of the scene gets the colour it has in the photo:
//! what to multiply the emission with, per channel, with a confidence interval.

use super::context::{Context, luxfer_context};
use super::guard::{enter, guard};
use super::handle::{self, Handle, Owned, tag};
use super::job::luxfer_job;
use super::params::{self, Report, Versioned};
use super::pointer::Out;
use super::scene::{SceneObject, colour, luxfer_scene, missing};
use super::stage::{Stage, need};
use super::status::luxfer_status;
use crate::error::{Error, Result};
use crate::image::try_collect;
use crate::relight::{self, Fit, Quantity, Sense, Solution, TargetStatus};
use crate::scene::Scene;
use glam::Vec3;
use std::sync::Arc;

/// A relighting of a scene. See luxfer_relight_create.
pub struct luxfer_relight {
    _opaque: [u8; 0],
}

/// What should match the photo: a LUXFER_QUANTITY_ value.
pub type luxfer_quantity = i32;
/// The light the target surface sends back, its albedo included: what a photo shows of it.
pub const LUXFER_QUANTITY_OUTGOING: luxfer_quantity = 0;
/// The light that arrives at it, as if it were white.
pub const LUXFER_QUANTITY_INCIDENT: luxfer_quantity = 1;

/// What of the target counts: a LUXFER_FIT_ value.
pub type luxfer_fit = i32;
/// Its mean.
pub const LUXFER_FIT_MEAN: luxfer_fit = 0;
/// Every point of it, by least squares: what gradient descent on texels comes to. Bright points count more, so the answer is
/// dimmer than that of the mean, by 1 / (1 + CV²) without other light, where CV is the spread of the response over the target
/// relative to its mean.
pub const LUXFER_FIT_LEAST_SQUARES: luxfer_fit = 1;

/// On which side of its value light should be: a LUXFER_SENSE_ value.
pub type luxfer_sense = i32;
/// At it.
pub const LUXFER_SENSE_EXACTLY: luxfer_sense = 0;
/// At it or above: what a standard asks of a desk, or what a clipped channel of a photo says.
pub const LUXFER_SENSE_AT_LEAST: luxfer_sense = 1;
/// At it or below: a limit against glare.
pub const LUXFER_SENSE_AT_MOST: luxfer_sense = 2;

/// How far the answer goes to meet the target in one colour channel: a LUXFER_REACH_ value.
pub type luxfer_reach = i32;
/// The target is met.
pub const LUXFER_REACH_MET: luxfer_reach = 0;
/// Other lights alone exceed the target: the emission is off in this channel.
pub const LUXFER_REACH_TOO_BRIGHT: luxfer_reach = 1;
/// No light of this channel reaches the target: the emission keeps the mean scale of the other channels.
pub const LUXFER_REACH_DARK: luxfer_reach = 2;
/// All lamps at their largest power do not suffice, or one goal asks for what another forbids.
pub const LUXFER_REACH_TOO_DIM: luxfer_reach = 3;

/// Settings of a relighting. Fill them with luxfer_relight_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_relight_params {
    /// sizeof(luxfer_relight_params), set by luxfer_relight_params_init.
    pub struct_size: u32,
    /// LUXFER_QUANTITY_ value; default LUXFER_QUANTITY_OUTGOING.
    pub quantity: luxfer_quantity,
    /// Most paths to trace, in [1024, 2^30]; default 2^20.
    pub paths: u32,
    /// Stop when the half-width of the widest 95 % interval is below this share of its answer, in [0, 1]; default 0.01; 0 =
    /// never.
    pub target_error: f32,
    /// Stop after this many milliseconds; default 0: never.
    pub time_budget_ms: u32,
    /// LUXFER_FIT_ value; default LUXFER_FIT_MEAN.
    pub fit: luxfer_fit,
    /// Seed of the paths; default 1.
    pub seed: u64,
}

// SAFETY: plain numbers.
unsafe impl Versioned for luxfer_relight_params {
    const NAME: &'static str = "luxfer_relight_params";
    const SIZES: &'static [usize] = &[32];
    fn defaults() -> Self {
        Self::of(&relight::Params::default())
    }
}

impl luxfer_relight_params {
    pub(super) fn of(d: &relight::Params) -> Self {
        Self {
            struct_size: 32,
            quantity: match d.quantity {
                Quantity::Outgoing => LUXFER_QUANTITY_OUTGOING,
                Quantity::Incident => LUXFER_QUANTITY_INCIDENT,
            },
            paths: d.paths,
            target_error: d.target_error,
            time_budget_ms: d.time_budget_ms,
            fit: match d.fit {
                Fit::Mean => LUXFER_FIT_MEAN,
                Fit::LeastSquares => LUXFER_FIT_LEAST_SQUARES,
            },
            seed: d.seed,
        }
    }

    pub(super) fn params(&self) -> Result<relight::Params> {
        Ok(relight::Params {
            quantity: quantity(self.quantity)?,
            fit: match self.fit {
                LUXFER_FIT_MEAN => Fit::Mean,
                LUXFER_FIT_LEAST_SQUARES => Fit::LeastSquares,
                other => return Err(Error::argument(format!("fit is {other}; it must be a LUXFER_FIT_ value"))),
            },
            paths: self.paths,
            target_error: self.target_error,
            time_budget_ms: self.time_budget_ms,
            seed: self.seed,
            ..relight::Params::default()
        })
    }
}

/// The solution and how sure it is. Set struct_size before the call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_relight_report {
    /// sizeof(luxfer_relight_report), set by the caller.
    pub struct_size: u32,
    /// Paths traced.
    pub paths: u32,
    /// What to multiply the emission with, per channel, >= 0.
    pub scale: [f64; 3],
    /// Half-widths of the 95 % confidence intervals of scale.
    pub half_width: [f64; 3],
    /// Mean radiance of the target under the emission at scale 1, in cd/m².
    pub response: [f64; 3],
    /// Mean radiance of the target under all other light, in cd/m².
    pub background: [f64; 3],
    /// LUXFER_REACH_ value of each channel.
    pub reach: [luxfer_reach; 3],
    /// 0.
    pub reserved: u32,
    /// The widest relative half-width among the channels that met their target.
    pub error: f64,
    /// How far the target's colour may be off: 95 % of errors are below this CIEDE2000 difference, seen at the exposure
    /// that shows the target as a middle grey.
    pub delta_e: f64,
}

// SAFETY: plain numbers.
unsafe impl Versioned for luxfer_relight_report {
    const NAME: &'static str = "luxfer_relight_report";
    const SIZES: &'static [usize] = &[136];
    fn defaults() -> Self {
        Self {
            struct_size: 136,
            paths: 0,
            scale: [0.0; 3],
            half_width: [0.0; 3],
            response: [0.0; 3],
            background: [0.0; 3],
            reach: [0; 3],
            reserved: 0,
            error: 0.0,
            delta_e: 0.0,
        }
    }
}

pub(super) fn quantity(value: luxfer_quantity) -> Result<Quantity> {
    match value {
        LUXFER_QUANTITY_OUTGOING => Ok(Quantity::Outgoing),
        LUXFER_QUANTITY_INCIDENT => Ok(Quantity::Incident),
        other => Err(Error::argument(format!("quantity is {other}; it must be a LUXFER_QUANTITY_ value"))),
    }
}

pub(super) fn sense(value: luxfer_sense) -> Result<Sense> {
    match value {
        LUXFER_SENSE_EXACTLY => Ok(Sense::Exactly),
        LUXFER_SENSE_AT_LEAST => Ok(Sense::AtLeast),
        LUXFER_SENSE_AT_MOST => Ok(Sense::AtMost),
        other => Err(Error::argument(format!("sense is {other}; it must be a LUXFER_SENSE_ value"))),
    }
}

pub(super) fn reach_value(status: TargetStatus) -> luxfer_reach {
    match status {
        TargetStatus::Met => LUXFER_REACH_MET,
        TargetStatus::TooBright => LUXFER_REACH_TOO_BRIGHT,
        TargetStatus::Dark => LUXFER_REACH_DARK,
        TargetStatus::TooDim => LUXFER_REACH_TOO_DIM,
    }
}

impl luxfer_relight_report {
    pub(super) fn new(solution: &Solution) -> Self {
        Self {
            paths: solution.paths,
            scale: solution.scale.to_array(),
            half_width: solution.half_width.to_array(),
            response: solution.response.to_array(),
            background: solution.background.to_array(),
            reach: solution.status.map(reach_value),
            error: solution.error(),
            delta_e: solution.delta_e,
            ..Self::defaults()
        }
    }
}

#[derive(Clone, Default)]
pub(super) struct Inputs {
    emitter: Option<Emitter>,
    target: Option<Vec3>,
    sense: [Sense; 3],
}

/// A scene, its material that emits, and its mesh that is the target, as a host has named them.
#[derive(Clone)]
pub(super) struct Emitter {
    pub scene: Arc<SceneObject>,
    pub material: u32,
    mesh: u32,
}

impl Handle for luxfer_relight {
    type Object = Stage<Inputs, Solution>;
    const TAG: u64 = tag(b"lux.reli");
    const NAME: &'static str = "luxfer_relight";
}

/// Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_relight_params_init(params: *mut luxfer_relight_params, size: usize) -> luxfer_status {
    guard(|| params::init(params, size))
}

/// Creates the stage. The caller releases *relight. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_relight_create(
    context: *mut luxfer_context,
    relight: *mut *mut luxfer_relight,
) -> luxfer_status {
    enter(context, |object| {
        Out::new(relight, "relight")?.set(handle::give(Stage::new(object.context(), Inputs::default())));
        Ok(())
    })
}

/// Sets the scene, the emitting material to solve for, and the mesh whose mean colour is to match: both as
/// luxfer_scene_place_emission has told them. The emission has the strength that the solution will multiply. Any thread.
/// LUXFER_NOT_FOUND if the scene has no such material or mesh.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_relight_set_scene(
    relight: *mut luxfer_relight,
    scene: *mut luxfer_scene,
    material: u32,
    mesh: u32,
) -> luxfer_status {
    enter(relight, |stage| {
        let emitter = Emitter::new(stage.context(), scene, material, mesh)?;
        stage.change(|inputs| {
            inputs.emitter = Some(emitter);
            Ok(())
        })
    })
}

/// Sets the mean radiance the mesh should have, in cd/m² per channel, each finite and >= 0; for LUXFER_QUANTITY_INCIDENT
/// that of a white surface in the same light, illuminance / pi. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_relight_set_target(
    relight: *mut luxfer_relight,
    red: f32,
    green: f32,
    blue: f32,
) -> luxfer_status {
    enter(relight, |stage| {
        let target = colour("target", red, green, blue)?;
        stage.change(|inputs| {
            inputs.target = Some(target);
            Ok(())
        })
    })
}

/// Makes the target a limit, in each channel for itself: LUXFER_SENSE_ values. What a photo clips is "at least". A limited
/// channel keeps the mean scale of those that are to be at their target, as far as that is on its side, and goes to its
/// limit if not. Any thread. LUXFER_INVALID_ARGUMENT if a value is none of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_relight_set_sense(
    relight: *mut luxfer_relight,
    red: luxfer_sense,
    green: luxfer_sense,
    blue: luxfer_sense,
) -> luxfer_status {
    enter(relight, |stage| {
        let senses = [sense(red)?, sense(green)?, sense(blue)?];
        stage.change(|inputs| {
            inputs.sense = senses;
            Ok(())
        })
    })
}

impl Emitter {
    pub(super) fn new(context: &Arc<Context>, scene: *mut luxfer_scene, material: u32, mesh: u32) -> Result<Self> {
        let scene = handle::borrow_in(context, scene, "scene")?;
        let emitter = Self { scene, material, mesh };
        emitter.triangles(&emitter.scene.snapshot())?;
        Ok(emitter)
    }

    /// The target's triangles.
    pub(super) fn triangles(&self, scene: &Scene) -> Result<Vec<(usize, usize)>> {
        if self.material as usize >= scene.materials.len() {
            return Err(missing("material", self.material, scene.materials.len()));
        }
        let mesh = scene.meshes.get(self.mesh as usize);
        let mesh = mesh.ok_or_else(|| missing("mesh", self.mesh, scene.meshes.len()))?;
        try_collect((0..mesh.triangles.len()).map(|t| (self.mesh as usize, t)))
    }
}

/// Starts a job that solves. params may be NULL for the defaults. The caller releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if the scene or the target is missing or a job runs already. The job may end with
/// LUXFER_UNREACHABLE if no light of the emission can reach the target, LUXFER_INVALID_ARGUMENT if the scene is not valid or
/// a setting is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_relight_start(
    relight: *mut luxfer_relight,
    params: *const luxfer_relight_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(relight, |stage| {
        let inputs = stage.inputs();
        let params = relight::Params { sense: inputs.sense, ..params::read(params)?.params()? };
        let emitter = need(&inputs.emitter, "luxfer_relight_set_scene")?.clone();
        let target = *need(&inputs.target, "luxfer_relight_set_target")?;
        let scene = emitter.scene.snapshot();
        let triangles = emitter.triangles(&scene)?;
        stage.start(job, move |_, _, job| {
            let world = emitter.scene.world(&scene, job.part(0.0, 0.1))?;
            let input = relight::Input {
                world: &world,
                emitter: emitter.material as usize,
                target_triangles: &triangles,
                target,
            };
            relight::run(&input, &params, job.part(0.1, 1.0))
        })
    })
}

/// Tells the solution and how sure it is. Any thread.
/// LUXFER_NOT_READY before a job has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_relight_get_report(
    relight: *mut luxfer_relight,
    report: *mut luxfer_relight_report,
) -> luxfer_status {
    enter(relight, |stage| {
        let out = Report::new(report)?;
        out.set(luxfer_relight_report::new(&*stage.output()?));
        Ok(())
    })
}

/// Adds a reference. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_relight_retain(relight: *mut luxfer_relight) -> luxfer_status {
    handle::retain(relight)
}

/// Gives a reference back; a job that runs goes on. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_relight_release(relight: *mut luxfer_relight) -> luxfer_status {
    handle::release(relight)
}
