//! Importance
//!
//! An importance map holds, for each point of an emitting surface, the light that the point would send to a target.
//! The map is traced once. From the map, the light that the target receives from any emissive texture on that surface,
//! at any scale, rotation and offset, is computed within milliseconds and with a confidence interval.

use super::context::luxfer_context;
use super::geometry::numbers;
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::image::{Pixels, luxfer_image};
use super::job::luxfer_job;
use super::params::{self, Report, Versioned, versioned};
use super::pointer::Out;
use super::relight::{Emitter, LUXFER_QUANTITY_OUTGOING, luxfer_quantity, luxfer_relight_report, quantity};
use super::scene::{luxfer_scene, read_colour};
use super::stage::{Stage, need};
use super::status::luxfer_status;
use crate::error::{Error, Result};
use crate::relight::{self, Goal, Importance, ImportanceParams, Placement, TargetGeometry};
use crate::scene::Texture;
use glam::{DMat3, Mat3, Vec3};
use std::sync::Arc;

/// An importance map of an emitting surface. See luxfer_importance_create.
pub struct luxfer_importance {
    _opaque: [u8; 0],
}

/// Settings of an importance map. Fill them with luxfer_importance_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_importance_params {
    /// sizeof(luxfer_importance_params), set by luxfer_importance_params_init.
    pub struct_size: u32,
    /// Number of cells of the map along the texture coordinate u of the surface, in [1, 512]; default 64.
    pub width: u32,
    /// Number of cells of the map along the texture coordinate v of the surface, in [1, 512]; default 64.
    pub height: u32,
    /// Quantity of the target that the map predicts: a LUXFER_QUANTITY_ value; default LUXFER_QUANTITY_OUTGOING.
    pub quantity: luxfer_quantity,
    /// Maximum number of paths, in [1024, 2^30]; default 2^20.
    pub paths: u32,
    /// Stop when the light that the target would receive from a uniform emission is known to this relative error, in
    /// [0, 1]; default 0.01; 0: do not stop for this reason. The error is the half-width of the 95 % confidence
    /// interval divided by the mean, in the worst channel.
    pub target_error: f32,
    /// Stop after this number of milliseconds; default 0: no limit.
    pub time_budget_ms: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Seed of the paths; default 1.
    pub seed: u64,
}

versioned!(luxfer_importance_params, [40], {
    let d = ImportanceParams::default();
    Self {
        struct_size: 40,
        width: d.width as u32,
        height: d.height as u32,
        quantity: LUXFER_QUANTITY_OUTGOING,
        paths: d.tracing.paths,
        target_error: d.tracing.target_error,
        time_budget_ms: d.tracing.time_budget_ms,
        reserved: 0,
        seed: d.tracing.seed,
    }
});

/// The light that the target receives from a texture: the result of luxfer_importance_respond.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_importance_report {
    /// sizeof(luxfer_importance_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of paths that were traced for the map.
    pub paths: u32,
    /// Mean radiance of the target from the texture alone, in cd/m² per channel.
    pub response: [f64; 3],
    /// Half-widths of the 95 % confidence intervals of the field response, in cd/m².
    pub half_width: [f64; 3],
    /// The result for a map whose cells are twice as wide and high, minus the value in response, in cd/m² per channel.
    /// About a third of this difference is the error of response that comes from the size of the cells. The difference
    /// also contains noise.
    pub resolution_difference: [f64; 3],
}

versioned!(luxfer_importance_report, [80], {
    Self { struct_size: 80, paths: 0, response: [0.0; 3], half_width: [0.0; 3], resolution_difference: [0.0; 3] }
});

#[derive(Clone, Default)]
pub(super) struct Inputs {
    emitter: Option<Emitter>,
}

/// The importance map, and the best placement of a texture if a job has searched for one.
pub(super) struct Traced {
    pub map: Arc<Importance>,
    pub placement: Option<Placement>,
}

impl Handle for luxfer_importance {
    type Object = Stage<Inputs, Traced>;
    const TAG: u64 = tag(b"lux.impo");
    const NAME: &'static str = "luxfer_importance";
}

/// Creates an importance map. It has no inputs yet. The caller releases *importance. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_importance_create(
    context: *mut luxfer_context,
    importance: *mut *mut luxfer_importance,
) -> luxfer_status {
    enter(context, |object| {
        let out = Out::new(importance, "importance")?;
        out.set(handle::give(Stage::new(object.context(), Inputs::default())));
        Ok(())
    })
}

/// Sets the scene, the material of the surfaces that will emit, and the mesh that is the target. The surfaces need
/// texture coordinates. The current emission of the material is ignored. Any thread.
/// LUXFER_NOT_FOUND if the scene has no such material or mesh.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_importance_set_scene(
    importance: *mut luxfer_importance,
    scene: *mut luxfer_scene,
    material: u32,
    mesh: u32,
) -> luxfer_status {
    enter(importance, |stage| {
        let emitter = Emitter::new(stage.context(), scene, material, mesh)?;
        stage.change(|inputs| {
            inputs.emitter = Some(emitter);
            Ok(())
        })
    })
}

/// Starts a job that traces the map. The new map replaces the earlier map and the placement that was found with it.
/// params may be NULL for the defaults. The caller releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if the scene is missing or a job is already running; LUXFER_INVALID_ARGUMENT if a setting
/// is out of range. The job may end with LUXFER_INVALID_ARGUMENT if the scene is not valid or the surfaces have no
/// texture coordinates; LUXFER_DEGENERATE if the target has no area.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_importance_start(
    importance: *mut luxfer_importance,
    params: *const luxfer_importance_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(importance, |stage| {
        let p = params::read(params)?;
        if p.reserved != 0 {
            return Err(Error::argument(format!("reserved is {}; it must be 0", p.reserved)));
        }
        let quantity = quantity(p.quantity)?;
        let tracing = relight::Params {
            quantity,
            paths: p.paths,
            target_error: p.target_error,
            time_budget_ms: p.time_budget_ms,
            seed: p.seed,
            ..relight::Params::default()
        };
        let params = ImportanceParams { width: p.width as usize, height: p.height as usize, tracing };
        params.check()?;
        let emitter = need(&stage.inputs().emitter, "luxfer_importance_set_scene")?.clone();
        let scene = emitter.scene.snapshot();
        let triangles = emitter.triangles(&scene)?;
        stage.start(job, move |_, _, job| {
            let goal = Goal {
                geometry: TargetGeometry::Surface(&triangles),
                quantity,
                target: Vec3::ONE,
                aspect: relight::Aspect::Colour,
                constraint: [relight::Constraint::Exactly; 3],
                weight: 1.0,
            };
            let map = Importance::trace(&scene, emitter.material as usize, &goal, &params, job)?;
            Ok(Traced { map: Arc::new(map), placement: None })
        })
    })
}

/// Gets the map as an image of 3 channels. Each cell holds the mean radiance of the target, per channel, if only this
/// cell emitted light, with a radiance of 1 cd/m². The caller releases *image. Any thread.
/// LUXFER_NOT_READY before a job has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_importance_get_image(
    importance: *mut luxfer_importance,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(importance, |stage| {
        let out = Out::new(image, "image")?;
        let map = stage.output()?.map.clone();
        let (width, height) = map.size();
        out.set(handle::give(Pixels::counted(stage.context(), width, height, 3, || map.image())?));
        Ok(())
    })
}

/// Computes the light that the target receives from a texture. The texture is linear, in cd/m², and repeats. placement
/// is a 3 x 3 matrix M, row by row, with the last row 0 0 1. The surface shows at its texture coordinates (u, v) the
/// point (s, t) of the texture, where (s, t, 1) = M (u, v, 1); s and t are in widths and heights of the texture. NULL
/// is the identity. The call takes a few milliseconds. size is sizeof *report. Any thread.
/// LUXFER_NOT_READY before a job has succeeded, LUXFER_INVALID_ARGUMENT if placement is not finite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_importance_respond(
    importance: *mut luxfer_importance,
    texture: *mut luxfer_image,
    placement: *const f64,
    report: *mut luxfer_importance_report,
    size: usize,
) -> luxfer_status {
    enter(importance, |stage| {
        let out = Report::new(report, size)?;
        let (map, response) = respond(stage, texture, placement)?;
        out.set(luxfer_importance_report {
            paths: map.paths,
            response: response.light.mean.to_array(),
            half_width: response.light.half_width().to_array(),
            resolution_difference: response.resolution_difference.to_array(),
            ..luxfer_importance_report::defaults()
        });
        Ok(())
    })
}

/// Solves for the factor, per channel, by which to multiply a texture so that the mean radiance of the target becomes
/// rgb in cd/m², each channel in [0, 1e15]. *report receives the solution, with an outcome for each channel. This call
/// uses the map; luxfer_relight solves this problem by tracing new paths. texture and placement are as for
/// luxfer_importance_respond. size is sizeof *report. Any thread.
/// LUXFER_NOT_READY before a job has succeeded; LUXFER_UNREACHABLE if no channel has a solution: no light of the
/// channel reaches the target from the texture, or the other lights alone exceed rgb; LUXFER_INVALID_ARGUMENT if
/// placement is not finite or rgb is out of range.
/// cbindgen:ptrs-as-arrays=[[rgb; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_importance_solve(
    importance: *mut luxfer_importance,
    texture: *mut luxfer_image,
    placement: *const f64,
    rgb: *const f32,
    report: *mut luxfer_relight_report,
    size: usize,
) -> luxfer_status {
    enter(importance, |stage| {
        let out = Report::new(report, size)?;
        let target = read_colour(rgb)?;
        let (map, response) = respond(stage, texture, placement)?;
        out.set(luxfer_relight_report::new(&map.solve(&response, target)?));
        Ok(())
    })
}

fn respond(
    stage: &Stage<Inputs, Traced>,
    texture: *mut luxfer_image,
    placement: *const f64,
) -> Result<(Arc<Importance>, relight::Response)> {
    let map = stage.output()?.map.clone();
    let image = handle::borrow_in(stage.context(), texture, "texture")?;
    let placement = if placement.is_null() {
        Mat3::IDENTITY
    } else {
        DMat3::from_cols_array(&numbers(placement, "placement")?).transpose().as_mat3()
    };
    let texture = Texture::new("texture", image.image().clone());
    let monitor = stage.context().monitor();
    let response = stage.context().quick.run(|| map.respond(&texture, &placement, monitor.job()))?;
    Ok((map, response))
}
