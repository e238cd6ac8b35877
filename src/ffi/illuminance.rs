//! Illuminance
//!
//! Computes the illuminance in lux at the points of a calculation grid, or at texels of a mesh. The results are an
//! image of the illuminances, an image of their standard errors, and a report with the mean, the minimum and the
//! maximum.

use super::context::luxfer_context;
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::image::{Pixels, luxfer_image};
use super::job::luxfer_job;
use super::params::{self, Report, Versioned, versioned};
use super::pointer::Out;
use super::scene::{SceneObject, luxfer_scene};
use super::stage::{Stage, need};
use super::status::luxfer_status;
use crate::error::{Error, Result};
use crate::image::Image;
use crate::render::illuminance::{self, CalculationPoints, Output};
use glam::Vec3;
use std::sync::Arc;

/// A calculation of illuminance. See luxfer_illuminance_create.
pub struct luxfer_illuminance {
    _opaque: [u8; 0],
}

/// An image of an illuminance calculation: a LUXFER_ILLUMINANCE_ value.
pub type luxfer_illuminance_image = i32;
/// Illuminance in lux; 1 channel; NaN in texels that the mesh does not cover.
pub const LUXFER_ILLUMINANCE_LUX: luxfer_illuminance_image = 0;
/// Standard error of each illuminance, in lux; 1 channel; NaN in texels that the mesh does not cover.
pub const LUXFER_ILLUMINANCE_ERROR: luxfer_illuminance_image = 1;

/// Settings of an illuminance calculation. Fill them with luxfer_illuminance_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_illuminance_params {
    /// sizeof(luxfer_illuminance_params), set by luxfer_illuminance_params_init.
    pub struct_size: u32,
    /// Number of points along the first edge of a grid, or along u of a mesh, in [1, 65536]; default 32.
    pub columns: u32,
    /// Number of points along the second edge of a grid, or along v of a mesh, in [1, 65536]; default 32.
    pub rows: u32,
    /// Paths per point, in [16, 16777216], rounded up to a multiple of 16; default 1024.
    pub samples: u32,
    /// Seed of the paths; default 1.
    pub seed: u64,
}

versioned!(luxfer_illuminance_params, [24], {
    let d = illuminance::Params::default();
    Self { struct_size: 24, columns: d.columns as u32, rows: d.rows as u32, samples: d.samples, seed: d.seed }
});

/// A calculation grid: a parallelogram of columns x rows cells, with a point at the centre of each cell. Fill it with
/// luxfer_illuminance_grid_init. The default is a square metre at the origin that faces up.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_illuminance_grid {
    /// sizeof(luxfer_illuminance_grid), set by luxfer_illuminance_grid_init.
    pub struct_size: u32,
    /// Corner of the grid, in metres; default (0, 0, 0).
    pub origin: [f32; 3],
    /// First edge of the grid, a vector from origin in metres; it is divided into columns. Default (1, 0, 0).
    pub across: [f32; 3],
    /// Second edge of the grid, a vector from origin in metres; it is divided into rows. Default (0, 0, 1).
    pub down: [f32; 3],
    /// Normal of the side that receives the light; any length but 0; default (0, 1, 0).
    pub normal: [f32; 3],
    /// Must be 0.
    pub reserved: u32,
}

versioned!(luxfer_illuminance_grid, [56], {
    Self {
        struct_size: 56,
        origin: [0.0; 3],
        across: [1.0, 0.0, 0.0],
        down: [0.0, 0.0, 1.0],
        normal: [0.0, 1.0, 0.0],
        reserved: 0,
    }
});

impl luxfer_illuminance_grid {
    /// Returns `origin`, `across`, `down` and `normal` as vectors; an error if `reserved` is not 0.
    pub(super) fn vectors(&self) -> Result<[Vec3; 4]> {
        if self.reserved != 0 {
            return Err(Error::argument(format!("grid.reserved is {}; it must be 0", self.reserved)));
        }
        Ok([self.origin, self.across, self.down, self.normal].map(Vec3::from_array))
    }
}

/// Summary of the illuminance, in lux.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_illuminance_report {
    /// sizeof(luxfer_illuminance_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of points with a value: on a mesh, the number of texels that the mesh covers. If it is 0, the other
    /// values are 0.
    pub points: u32,
    /// Smallest illuminance. The uniformity U0 is minimum / mean.
    pub minimum: f64,
    /// Mean illuminance.
    pub mean: f64,
    /// Largest illuminance.
    pub maximum: f64,
    /// Standard error of the mean.
    pub mean_error: f64,
}

versioned!(luxfer_illuminance_report, [40], {
    Self { struct_size: 40, points: 0, minimum: 0.0, mean: 0.0, maximum: 0.0, mean_error: 0.0 }
});

impl Handle for luxfer_illuminance {
    type Object = Stage<Inputs, Output>;
    const TAG: u64 = tag(b"lux.illu");
    const NAME: &'static str = "luxfer_illuminance";
}

#[derive(Clone, Default)]
pub(super) struct Inputs {
    scene: Option<Arc<SceneObject>>,
}

/// Creates an object that computes illuminance. It has no inputs yet. The caller releases *illuminance. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_illuminance_create(
    context: *mut luxfer_context,
    illuminance: *mut *mut luxfer_illuminance,
) -> luxfer_status {
    enter(context, |object| {
        let out = Out::new(illuminance, "illuminance")?;
        out.set(handle::give(Stage::new(object.context(), Inputs::default())));
        Ok(())
    })
}

/// Sets the scene; each job uses the scene as it is when the job starts. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_illuminance_set_scene(
    illuminance: *mut luxfer_illuminance,
    scene: *mut luxfer_scene,
) -> luxfer_status {
    enter(illuminance, |stage| {
        let scene = handle::borrow_in(stage.context(), scene, "scene")?;
        stage.change(|inputs| {
            inputs.scene = Some(scene);
            Ok(())
        })
    })
}

/// Starts a job that computes the illuminance on a grid. grid and params may be NULL for their defaults. The caller
/// releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if the scene is missing or a job is already running. The job may end with
/// LUXFER_INVALID_ARGUMENT if the scene is not valid, the normal of the grid is 0, or a setting is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_illuminance_start_grid(
    illuminance: *mut luxfer_illuminance,
    grid: *const luxfer_illuminance_grid,
    params: *const luxfer_illuminance_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(illuminance, |stage| {
        let [origin, across, down, normal] = params::read(grid)?.vectors()?;
        start(stage, CalculationPoints::Grid { origin, across, down, normal }, params, job)
    })
}

/// Starts a job that computes the illuminance on a mesh. The first set of texture coordinates maps the mesh to an image
/// of columns x rows texels: columns divide u, rows divide v. Each texel gets the illuminance at the surface point of
/// its centre. back is 0 for the front side of the triangles, from which they wind counter-clockwise, and 1 for the
/// back side. params may be NULL for the defaults. The caller releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if the scene is missing or a job is already running. The job may end with
/// LUXFER_INVALID_ARGUMENT if the scene is not valid or has no such mesh, if the mesh has no texture coordinates, or if
/// a setting is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_illuminance_start_mesh(
    illuminance: *mut luxfer_illuminance,
    mesh: u32,
    back: u32,
    params: *const luxfer_illuminance_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(illuminance, |stage| {
        if back > 1 {
            return Err(Error::argument(format!("back is {back}; it must be 0 or 1")));
        }
        start(stage, CalculationPoints::Mesh { mesh: mesh as usize, front: back == 0 }, params, job)
    })
}

fn start(
    stage: &Arc<Stage<Inputs, Output>>,
    place: CalculationPoints,
    params: *const luxfer_illuminance_params,
    job: *mut *mut luxfer_job,
) -> Result<()> {
    let p = params::read(params)?;
    let params =
        illuminance::Params { columns: p.columns as usize, rows: p.rows as usize, samples: p.samples, seed: p.seed };
    let object = need(&stage.inputs().scene, "luxfer_illuminance_set_scene")?.clone();
    let scene = object.snapshot();
    stage.start(job, move |_, _, job| {
        let world = object.world(&scene, job.part(0.0, 0.05))?;
        illuminance::run(&world, &place, &params, job.part(0.05, 1.0))
    })
}

/// Gets the image that a LUXFER_ILLUMINANCE_ value selects: the illuminances or their errors. The caller releases
/// *image. Any thread.
/// LUXFER_NOT_READY before a job has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_illuminance_get_image(
    illuminance: *mut luxfer_illuminance,
    kind: luxfer_illuminance_image,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(illuminance, |stage| {
        let out = Out::new(image, "image")?;
        let pick: fn(&Output) -> &Image = match kind {
            LUXFER_ILLUMINANCE_LUX => |o| &o.lux,
            LUXFER_ILLUMINANCE_ERROR => |o| &o.error,
            _ => return Err(Error::argument(format!("kind is {kind}; it must be a LUXFER_ILLUMINANCE_ value"))),
        };
        out.set(handle::give(Pixels::part(stage.context(), stage.output()?, pick)));
        Ok(())
    })
}

/// Gets the summary of the illuminance. size is sizeof *report. Any thread.
/// LUXFER_NOT_READY before a job has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_illuminance_get_report(
    illuminance: *mut luxfer_illuminance,
    report: *mut luxfer_illuminance_report,
    size: usize,
) -> luxfer_status {
    enter(illuminance, |stage| {
        let out = Report::new(report, size)?;
        let output = stage.output()?;
        out.set(luxfer_illuminance_report {
            points: output.points as u32,
            minimum: output.min,
            mean: output.mean,
            maximum: output.max,
            mean_error: output.mean_error,
            ..luxfer_illuminance_report::defaults()
        });
        Ok(())
    })
}
