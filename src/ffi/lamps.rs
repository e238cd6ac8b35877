//! Lamps
//!
//! Finds the powers of the lamps of an emission with which a scene comes nearest to several goals. The power of a lamp
//! is a factor for its emission, within bounds. A goal is a surface or a calculation grid that should receive a given
//! light. One set of paths per goal measures the light from all lamps at once, even from thousands.

use super::context::luxfer_context;
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::job::luxfer_job;
use super::params::{self, versioned};
use super::pointer::Out;
use super::query::LUXFER_NONE;
use super::scene::{SceneObject, luxfer_scene, missing};
use super::stage::{Stage, need};
use super::status::luxfer_status;
use super::stored_goal::StoredGoal;
use crate::error::{Error, ErrorKind, Result};
use crate::relight::{
    self, Colour, EmissionLamps, Goal, GroupParams, GroupSolution, Quantity, Responses, lamp_responses, solve_groups,
};
use crate::scene::Scene;
use glam::Vec3;
use std::sync::Arc;

/// A solver for the powers of lamps. See luxfer_lamps_create.
pub struct luxfer_lamps {
    _opaque: [u8; 0],
}

/// Groups of lamps that share one power: a LUXFER_GROUP_ value. A lamp is a connected region of the emission texture; a
/// connected piece of the meshes if the emission has no texture; or a punctual light if the material is LUXFER_NONE.
pub type luxfer_group = i32;
/// All lamps form one group.
pub const LUXFER_GROUP_ALL: luxfer_group = 0;
/// Each lamp is a group of its own.
pub const LUXFER_GROUP_EACH: luxfer_group = 1;
/// Each row of lamps is a group. The lamps are sorted by the x coordinates of their centres; a new row begins where two
/// successive lamps differ by more than row_tolerance. If the emission has a texture, the texture coordinate u replaces
/// x.
pub const LUXFER_GROUP_BY_X: luxfer_group = 2;
/// Each row of lamps is a group. The lamps are sorted by the y coordinates of their centres; a new row begins where two
/// successive lamps differ by more than row_tolerance. If the emission has a texture, the texture coordinate v replaces
/// y.
pub const LUXFER_GROUP_BY_Y: luxfer_group = 3;
/// Each row of lamps is a group. The lamps are sorted by the z coordinates of their centres; a new row begins where two
/// successive lamps differ by more than row_tolerance. If the emission has a texture, all lamps form one group.
pub const LUXFER_GROUP_BY_Z: luxfer_group = 4;
/// Lamps of about equal area form a group: in the order of their areas, a new group begins where the area grows by more
/// than 25 % from one lamp to the next. Among punctual lights, each kind (point, spot, directional) forms one group,
/// and all luminaires with one distribution form one group.
pub const LUXFER_GROUP_BY_TYPE: luxfer_group = 5;

/// Settings of the solver for lamps. Fill them with luxfer_lamps_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_lamps_params {
    /// sizeof(luxfer_lamps_params), set by luxfer_lamps_params_init.
    pub struct_size: u32,
    /// Lamps that share one power: a LUXFER_GROUP_ value; default LUXFER_GROUP_EACH.
    pub group: luxfer_group,
    /// Largest gap between neighbouring lamps in one row, for LUXFER_GROUP_BY_X, _Y and _Z: the difference of the
    /// coordinates by which the lamps are grouped, in metres or as a texture coordinate, >= 0; default 0.01. A larger
    /// gap starts a new row.
    pub row_tolerance: f32,
    /// 1: solve for one power for each colour channel of a group. All goals must then come from luxfer_lamps_add_mesh,
    /// because luxfer_lamps_add_grid states no channels. 0, the default: solve for one power for all channels of a
    /// group, which keeps the colour.
    pub free_colour: u32,
    /// Largest power of a group, that is, the largest factor for its emission, >= 0; default infinity.
    pub max_scale: f64,
    /// Weight of the regularisation, which pulls all powers towards the equal power that meets the goals best, in
    /// [1e-9, 1e3]; default 1e-6. With a small weight the goals are met, with a large weight the powers are nearly
    /// equal.
    pub regularisation: f64,
    /// Tolerance of the goals, in [1e-6, 1]; default 0.01. A goal counts as met if its light misses the target by at
    /// most tolerance times the target's brightest channel, plus the half-width of the 95 % confidence interval of the
    /// light.
    pub tolerance: f64,
    /// Maximum number of paths for each goal, in [1024, 2^30]; default 2^20.
    pub paths: u32,
    /// Stop tracing when, for every goal, the light from all lamps together is known to this relative error, in [0, 1];
    /// default 0.01; 0: do not stop for this reason. The error is the half-width of the 95 % confidence interval
    /// divided by the mean, in the worst channel.
    pub target_error: f32,
    /// Stop tracing after this number of milliseconds; default 0: no limit.
    pub time_budget_ms: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Seed of the paths; default 1.
    pub seed: u64,
}

versioned!(luxfer_lamps_params, [64], {
    let (tracing, groups) = (relight::Params::default(), GroupParams::default());
    Self {
        struct_size: 64,
        group: LUXFER_GROUP_EACH,
        row_tolerance: 0.01,
        free_colour: 0,
        max_scale: f64::INFINITY,
        regularisation: groups.regularisation,
        tolerance: groups.tolerance,
        paths: tracing.paths,
        target_error: tracing.target_error,
        time_budget_ms: tracing.time_budget_ms,
        reserved: 0,
        seed: tracing.seed,
    }
});

#[derive(Clone, Default)]
pub(super) struct Inputs {
    /// The scene, and the index of the emitting material; `None` in place of the index if the lamps are the punctual
    /// lights.
    pub emission: Option<(Arc<SceneObject>, Option<u32>)>,
    pub goals: Vec<StoredGoal>,
    /// Dimming levels of the drivers; empty for drivers without steps.
    pub levels: Vec<f64>,
}

pub(super) struct Output {
    pub scene: Arc<Scene>,
    /// Index of the emitting material whose regions are the lamps; `None` if the lamps are the punctual lights.
    pub material: Option<usize>,
    pub lamps: EmissionLamps,
    pub group_of: Vec<u32>,
    pub responses: Responses,
    pub targets: Vec<Vec3>,
    pub quantities: Vec<Quantity>,
    pub solution: GroupSolution,
}

impl Handle for luxfer_lamps {
    type Object = Stage<Inputs, Output>;
    const TAG: u64 = tag(b"lux.lamp");
    const NAME: &'static str = "luxfer_lamps";
}

/// Creates a solver for the powers of lamps. It has no inputs yet. The caller releases *lamps. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_lamps_create(
    context: *mut luxfer_context,
    lamps: *mut *mut luxfer_lamps,
) -> luxfer_status {
    enter(context, |object| {
        Out::new(lamps, "lamps")?.set(handle::give(Stage::new(object.context(), Inputs::default())));
        Ok(())
    })
}

/// Sets the scene, and the material whose lamps are solved for. The solution is a factor for the emission that each
/// lamp has in the scene. If material is LUXFER_NONE, the lamps are the punctual lights of the scene, numbered by the
/// indices of luxfer_scene_add_light and luxfer_scene_add_luminaire. The call removes all goals. Any thread.
/// LUXFER_NOT_FOUND if the scene has no such material.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_lamps_set_scene(
    lamps: *mut luxfer_lamps,
    scene: *mut luxfer_scene,
    material: u32,
) -> luxfer_status {
    enter(lamps, |stage| {
        let scene = handle::borrow_in(stage.context(), scene, "scene")?;
        let materials = scene.snapshot().materials.len();
        let material = (material != LUXFER_NONE).then_some(material);
        if let Some(material) = material.filter(|m| *m as usize >= materials) {
            return Err(missing("material", material, materials));
        }
        stage.change(|inputs| {
            inputs.emission = Some((scene, material));
            inputs.goals.clear();
            Ok(())
        })
    })
}

/// Starts a job that measures how much light each lamp sends to each goal, and solves for the powers. If the goals
/// cannot be met, the job succeeds with the powers that come nearest within the bounds. params may be NULL for the
/// defaults. The caller releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if the scene or a goal is missing or a job is already running. The job may end with
/// LUXFER_UNREACHABLE if no goal receives light from any lamp; LUXFER_DEGENERATE if the surface of a goal has no area;
/// LUXFER_INVALID_ARGUMENT if the scene is not valid, the emission has no lamp, there are more than 64 goals, goals
/// times lamps exceed 2^20, or a setting is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_lamps_start(
    lamps: *mut luxfer_lamps,
    params: *const luxfer_lamps_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(lamps, |stage| {
        let params = params::read(params)?;
        params.check()?;
        params.tracing().check()?;
        let inputs = stage.inputs();
        let (object, material) = need(&inputs.emission, "luxfer_lamps_set_scene")?.clone();
        if inputs.goals.is_empty() {
            return Err(Error::new(
                ErrorKind::InvalidOperation,
                "there is no goal: call luxfer_lamps_add_mesh or luxfer_lamps_add_grid before the start",
            ));
        }
        let scene = object.snapshot();
        stage.start(job, move |inputs, _, job| {
            let world = object.world(&scene, job.part(0.0, 0.1))?;
            let material = material.map(|m| m as usize);
            let lamps = lamps_of(&scene, material)?;
            let (group_of, groups) = params.groups(&lamps);
            let triangles = inputs.goals.iter().map(|aim| aim.triangles(&scene)).collect::<Result<Vec<_>>>()?;
            let goals: Vec<Goal> = inputs.goals.iter().zip(&triangles).map(|(aim, t)| aim.goal(t)).collect();
            let tracing = params.tracing();
            let emitter = material.unwrap_or(usize::MAX);
            let responses = lamp_responses(&world, emitter, &lamps, &goals, &tracing, job.part(0.1, 0.95))?;
            let solution = solve_groups(
                &responses.grouped(&group_of, groups)?,
                &goals,
                &params.solving(groups, inputs.levels.clone()),
                job.part(0.95, 1.0),
            )?;
            let targets = inputs.goals.iter().map(|aim| aim.target).collect();
            let quantities = inputs.goals.iter().map(|aim| aim.quantity).collect();
            Ok(Output { scene, material, lamps, group_of, responses, targets, quantities, solution })
        })
    })
}

fn lamps_of(scene: &Scene, material: Option<usize>) -> Result<EmissionLamps> {
    let Some(material) = material else { return EmissionLamps::of_lights(scene) };
    match scene.materials[material].emission_texture {
        Some(map) => EmissionLamps::of_texture(&scene.textures[map.texture].image),
        None => EmissionLamps::of_meshes(scene, material),
    }
}

impl luxfer_lamps_params {
    fn check(&self) -> Result<()> {
        if self.free_colour > 1 || self.reserved != 0 {
            return Err(Error::argument("free_colour must be 0 or 1, and reserved 0"));
        }
        if !(LUXFER_GROUP_ALL..=LUXFER_GROUP_BY_TYPE).contains(&self.group) {
            return Err(Error::argument(format!("group is {}; it must be a LUXFER_GROUP_ value", self.group)));
        }
        if !(self.row_tolerance >= 0.0) {
            return Err(Error::argument(format!("row_tolerance is {}; it must not be negative", self.row_tolerance)));
        }
        Ok(())
    }

    fn groups(&self, lamps: &EmissionLamps) -> (Vec<u32>, usize) {
        match self.group {
            LUXFER_GROUP_ALL => lamps.together(),
            LUXFER_GROUP_EACH => lamps.each(),
            LUXFER_GROUP_BY_TYPE => lamps.types(),
            other => lamps.rows((other - LUXFER_GROUP_BY_X) as usize, self.row_tolerance),
        }
    }

    fn tracing(&self) -> relight::Params {
        relight::Params {
            paths: self.paths,
            target_error: self.target_error,
            time_budget_ms: self.time_budget_ms,
            seed: self.seed,
            ..relight::Params::default()
        }
    }

    fn solving(&self, groups: usize, levels: Vec<f64>) -> GroupParams {
        GroupParams {
            colour: if self.free_colour == 1 { Colour::PerChannel } else { Colour::Common },
            max_scale: vec![self.max_scale; groups],
            levels,
            regularisation: self.regularisation,
            tolerance: self.tolerance,
        }
    }
}
