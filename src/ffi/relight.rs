//! Relighting
//!
//! Solves for the colour and intensity of an emission with which a surface of the scene, the target, has the same
//! colour as in the photo. The solution is a factor for the emission, per channel, with a confidence interval.

use super::context::{Context, luxfer_context};
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::job::luxfer_job;
use super::params::{self, Report, Versioned, versioned};
use super::pointer::{Out, bytes, integers};
use super::scene::{SceneObject, luxfer_scene, missing, read_colour};
use super::stage::{Stage, need};
use super::status::luxfer_status;
use crate::error::{Error, Result};
use crate::image::try_collect;
use crate::relight::{self, Constraint, Fit, Quantity, Solution, TargetStatus};
use crate::scene::Scene;
use glam::Vec3;
use std::sync::Arc;

/// A relighting: a solver for the emission of one material. See luxfer_relight_create.
pub struct luxfer_relight {
    _opaque: [u8; 0],
}

/// The quantity of the target surface that should match the photo: a LUXFER_QUANTITY_ value.
pub type luxfer_quantity = i32;
/// Light that the target surface reflects diffusely, its albedo included: the radiance that a photo shows of a matt
/// surface.
pub const LUXFER_QUANTITY_OUTGOING: luxfer_quantity = 0;
/// Light that arrives at the target surface, as the radiance of a white surface in this light: illuminance / pi.
pub const LUXFER_QUANTITY_INCIDENT: luxfer_quantity = 1;

/// How the light of the target surface is compared with its target value: a LUXFER_FIT_ value.
pub type luxfer_fit = i32;
/// The mean of the light over the target surface should equal the target value.
pub const LUXFER_FIT_MEAN: luxfer_fit = 0;
/// The sum, over all points of the target surface, of the squared difference between light and target value should be
/// smallest. A gradient descent on the texels of the emission would minimise this sum too. Bright points count more, so
/// the emission is dimmer than with LUXFER_FIT_MEAN. Without other light it is dimmer by the factor 1/(1+CV²), where CV
/// is the coefficient of variation (standard deviation divided by mean) of the light over the target surface.
pub const LUXFER_FIT_LEAST_SQUARES: luxfer_fit = 1;

/// Whether light should equal its target value, or stay above or below it: a LUXFER_CONSTRAINT_ value.
pub type luxfer_constraint = i32;
/// The light should equal its target value.
pub const LUXFER_CONSTRAINT_EQUAL: luxfer_constraint = 0;
/// The light should be at least its target value, for example because a standard requires it on a desk, or because the
/// photo clips this channel.
pub const LUXFER_CONSTRAINT_AT_LEAST: luxfer_constraint = 1;
/// The light should be at most its target value, for example to limit glare.
pub const LUXFER_CONSTRAINT_AT_MOST: luxfer_constraint = 2;

/// Whether the target is met in a colour channel, and if not, the reason: a LUXFER_OUTCOME_ value.
pub type luxfer_outcome = i32;
/// The target, or its limit, is met.
pub const LUXFER_OUTCOME_SATISFIED: luxfer_outcome = 0;
/// The other lights alone exceed the target, so the emission is 0 in this channel; or, for a luxfer_lamps and for
/// luxfer_transfer_start_all, two targets contradict each other.
pub const LUXFER_OUTCOME_TOO_BRIGHT: luxfer_outcome = 1;
/// No light of this channel reaches the target: the channel gets the mean scale of the channels that meet the target.
pub const LUXFER_OUTCOME_DARK: luxfer_outcome = 2;
/// All lamps at their largest power are too weak, or two goals contradict each other. Occurs only for a luxfer_lamps,
/// and for transfers whose light luxfer_transfer_start_all solves for together.
pub const LUXFER_OUTCOME_TOO_DIM: luxfer_outcome = 3;

/// Settings of a relighting. Fill them with luxfer_relight_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_relight_params {
    /// sizeof(luxfer_relight_params), set by luxfer_relight_params_init.
    pub struct_size: u32,
    /// Quantity to match: a LUXFER_QUANTITY_ value; default LUXFER_QUANTITY_OUTGOING.
    pub quantity: luxfer_quantity,
    /// Maximum number of paths, in [1024, 2^30]; default 2^20.
    pub paths: u32,
    /// Stop when luxfer_relight_report.error is at most this value, in [0, 1]; default 0.01; 0: do not stop for this
    /// reason.
    pub target_error: f32,
    /// Stop after this number of milliseconds; default 0: no limit.
    pub time_budget_ms: u32,
    /// How the light of the target is compared with its target value: a LUXFER_FIT_ value; default LUXFER_FIT_MEAN.
    pub fit: luxfer_fit,
    /// Seed of the paths; default 1.
    pub seed: u64,
}

versioned!(luxfer_relight_params, [32], { Self::of(&relight::Params::default()) });

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

/// The solution of a relighting and its confidence.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_relight_report {
    /// sizeof(luxfer_relight_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of traced paths.
    pub paths: u32,
    /// Factor for the emission, per channel, >= 0.
    pub scale: [f64; 3],
    /// Half-widths of the 95 % confidence intervals of the field scale.
    pub half_width: [f64; 3],
    /// Mean radiance of the target from the emission at scale 1, in cd/m² per channel.
    pub response: [f64; 3],
    /// Mean radiance of the target from all other light, in cd/m² per channel.
    pub background: [f64; 3],
    /// Whether each channel meets its target: a LUXFER_OUTCOME_ value.
    pub outcome: [luxfer_outcome; 3],
    /// Reserved; always 0.
    pub reserved: u32,
    /// The largest relative half-width (half_width / scale) among the channels that meet their target; 0 without such
    /// channels.
    pub error: f64,
    /// Uncertainty of the target's colour under the solution. With a probability of 95 %, the CIEDE2000 difference
    /// between the actual and the wanted colour is below this value. Both colours are taken at the exposure that shows
    /// the target as middle grey.
    pub delta_e: f64,
}

versioned!(luxfer_relight_report, [136], {
    Self {
        struct_size: 136,
        paths: 0,
        scale: [0.0; 3],
        half_width: [0.0; 3],
        response: [0.0; 3],
        background: [0.0; 3],
        outcome: [0; 3],
        reserved: 0,
        error: 0.0,
        delta_e: 0.0,
    }
});

pub(super) fn quantity(value: luxfer_quantity) -> Result<Quantity> {
    match value {
        LUXFER_QUANTITY_OUTGOING => Ok(Quantity::Outgoing),
        LUXFER_QUANTITY_INCIDENT => Ok(Quantity::Incident),
        other => Err(Error::argument(format!("quantity is {other}; it must be a LUXFER_QUANTITY_ value"))),
    }
}

/// Reads the argument `constraint` of a call: a value for each channel.
pub(super) fn read_constraints(place: *const luxfer_constraint) -> Result<[Constraint; 3]> {
    let bytes = bytes(place.cast(), size_of::<[luxfer_constraint; 3]>(), "constraint")?;
    let [red, green, blue] = integers(bytes);
    Ok([constraint(red)?, constraint(green)?, constraint(blue)?])
}

fn constraint(value: luxfer_constraint) -> Result<Constraint> {
    match value {
        LUXFER_CONSTRAINT_EQUAL => Ok(Constraint::Exactly),
        LUXFER_CONSTRAINT_AT_LEAST => Ok(Constraint::AtLeast),
        LUXFER_CONSTRAINT_AT_MOST => Ok(Constraint::AtMost),
        other => Err(Error::argument(format!("the constraint is {other}; it must be a LUXFER_CONSTRAINT_ value"))),
    }
}

pub(super) fn outcome_value(status: TargetStatus) -> luxfer_outcome {
    match status {
        TargetStatus::Met => LUXFER_OUTCOME_SATISFIED,
        TargetStatus::TooBright => LUXFER_OUTCOME_TOO_BRIGHT,
        TargetStatus::Dark => LUXFER_OUTCOME_DARK,
        TargetStatus::TooDim => LUXFER_OUTCOME_TOO_DIM,
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
            outcome: solution.status.map(outcome_value),
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
    constraint: [Constraint; 3],
}

/// The scene, the emitting material and the target mesh, as the host has set them.
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

/// Creates a relighting. It has no inputs yet. The caller releases *relight. Any thread.
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

/// Sets the scene, the emitting material to solve for, and the target mesh, whose mean colour should match. Points of
/// the mesh that emit light are left out. The solution is a factor for the emission that the material has in the scene.
/// luxfer_scene_place_emission returns the index of such a material, and the index of a mesh that can serve as the
/// target. Any thread.
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

/// Sets rgb, the mean radiance that the target mesh should have, in cd/m² per channel, each in [0, 1e15]. For
/// LUXFER_QUANTITY_INCIDENT, rgb is the radiance that a white surface would have in place of the target: illuminance /
/// pi. Any thread.
/// LUXFER_INVALID_ARGUMENT if a channel is out of range.
/// cbindgen:ptrs-as-arrays=[[rgb; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_relight_set_target(relight: *mut luxfer_relight, rgb: *const f32) -> luxfer_status {
    enter(relight, |stage| {
        let target = read_colour(rgb)?;
        stage.change(|inputs| {
            inputs.target = Some(target);
            Ok(())
        })
    })
}

/// Makes the target a lower or upper limit; constraint holds a LUXFER_CONSTRAINT_ value for each channel: red, green,
/// blue. A channel that the photo clips should be LUXFER_CONSTRAINT_AT_LEAST. A channel with a limit gets the mean
/// scale of the channels without a limit, if this scale respects the limit; else the scale that just reaches the limit.
/// Any thread.
/// LUXFER_INVALID_ARGUMENT if a value is not a LUXFER_CONSTRAINT_ value.
/// cbindgen:ptrs-as-arrays=[[constraint; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_relight_set_constraint(
    relight: *mut luxfer_relight,
    constraint: *const luxfer_constraint,
) -> luxfer_status {
    enter(relight, |stage| {
        let constraints = read_constraints(constraint)?;
        stage.change(|inputs| {
            inputs.constraint = constraints;
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

    /// Returns the indices (mesh, triangle) of each triangle of the target mesh.
    pub(super) fn triangles(&self, scene: &Scene) -> Result<Vec<(usize, usize)>> {
        if self.material as usize >= scene.materials.len() {
            return Err(missing("material", self.material, scene.materials.len()));
        }
        let mesh = scene.meshes.get(self.mesh as usize);
        let mesh = mesh.ok_or_else(|| missing("mesh", self.mesh, scene.meshes.len()))?;
        try_collect((0..mesh.triangles.len()).map(|t| (self.mesh as usize, t)))
    }
}

/// Starts a job that solves for the factor by which to multiply the emission. params may be NULL for the defaults. The
/// caller releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if the scene or the target is missing or a job is already running; LUXFER_INVALID_ARGUMENT
/// if a setting is out of range. The job may end with LUXFER_UNREACHABLE if no channel has a solution: no emitted light
/// of the channel reaches the target, or the other lights alone exceed it; LUXFER_DEGENERATE if the target has no area;
/// LUXFER_INVALID_ARGUMENT if the scene is not valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_relight_start(
    relight: *mut luxfer_relight,
    params: *const luxfer_relight_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(relight, |stage| {
        let inputs = stage.inputs();
        let params = relight::Params { constraint: inputs.constraint, ..params::read(params)?.params()? };
        params.check()?;
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

/// Gets the solution and its confidence. size is sizeof *report. Any thread.
/// LUXFER_NOT_READY before a job has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_relight_get_report(
    relight: *mut luxfer_relight,
    report: *mut luxfer_relight_report,
    size: usize,
) -> luxfer_status {
    enter(relight, |stage| {
        let out = Report::new(report, size)?;
        out.set(luxfer_relight_report::new(&*stage.output()?));
        Ok(())
    })
}
