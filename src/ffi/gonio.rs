//! Distributions of bodies
//!
//! A goniophotometer for the meshes of a scene: computes the luminous intensity that emissive bodies have in all
//! directions, far away from them, as a distribution that can be saved as a luminaire file.

use super::distribution::{Distribution, luxfer_distribution};
use super::guard::enter;
use super::handle::{self, Owned};
use super::params::{self, Report, Versioned, versioned};
use super::pointer::{Out, bytes, integers};
use super::scene::luxfer_scene;
use super::scene_lights::axes;
use super::status::luxfer_status;
use crate::error::Result;
use crate::image::try_collect;
use crate::photometry::File;
use crate::render::gonio::{self, Output};

/// Settings of luxfer_scene_get_distribution: the directions, the paths and the axes of the luminaire. Fill them with
/// luxfer_gonio_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_gonio_params {
    /// sizeof(luxfer_gonio_params), set by luxfer_gonio_params_init.
    pub struct_size: u32,
    /// Number of C planes, in [1, 360], at equal angles around the axis; default 24. A single plane, C = 0, holds for
    /// all directions around the axis.
    pub planes: u32,
    /// Number of vertical angles gamma in each C plane, in [2, 361], at equal angles from 0 to 180 degrees; default 73.
    pub angles: u32,
    /// Paths per direction, in [16, 16777216], rounded up to a multiple of 16; default 1024.
    pub samples: u32,
    /// Seed of the paths; default 1.
    pub seed: u64,
    /// Direction of the luminaire's axis, in which gamma is 0; any length but 0; default (0, -1, 0): down.
    pub axis: [f32; 3],
    /// Direction of the half-plane C = 0; it must not be parallel to axis, and only its component perpendicular to
    /// axis counts. Default (1, 0, 0). For an axis that points down, C grows anticlockwise as seen from above.
    pub c0: [f32; 3],
}

versioned!(luxfer_gonio_params, [48], {
    let d = gonio::Params::default();
    Self {
        struct_size: 48,
        planes: d.planes,
        angles: d.angles,
        samples: d.samples,
        seed: d.seed,
        axis: d.axis.to_array(),
        c0: d.c0.to_array(),
    }
});

/// Errors of a distribution that luxfer_scene_get_distribution has measured, and the place of its luminaire.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_gonio_report {
    /// sizeof(luxfer_gonio_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Centre of the luminous opening in metres, in the coordinates of the scene: a luminaire with this position, and
    /// with the axis and c0 of the settings, takes the place of the meshes.
    pub position: [f32; 3],
    /// Luminous flux in lumens.
    pub flux: f64,
    /// Standard error of the flux, in lumens.
    pub flux_error: f64,
    /// Largest standard error of an intensity, in candela.
    pub intensity_error: f64,
}

versioned!(luxfer_gonio_report, [40], {
    Self { struct_size: 40, position: [0.0; 3], flux: 0.0, flux_error: 0.0, intensity_error: 0.0 }
});

/// Measures the distribution of count meshes of a scene, whose indices are in the array meshes. If count is 0, the call
/// measures all meshes of the scene, and meshes may be NULL. The intensities account for the light that the meshes
/// block, reflect and transmit. Other meshes, lights, luminaires and the environment count as absent. params may be
/// NULL for the defaults.
///
/// The new distribution has absolute photometry, states no power and no colour, and has the name of the first mesh that
/// has a name. Its luminous opening is the box, the cylinder along the axis or the ellipsoid that agrees best with the
/// parts that emit. If the light leaves through a translucent shade or from a reflector, this opening is too small: the
/// intensities, which hold far from the luminaire, are right, but its glare, its pictures and the light close to it are
/// wrong.
///
/// Intensities between the angles are interpolated linearly; the stated errors contain the noise of the paths only. The
/// caller releases *distribution. report may be NULL; size is sizeof *report. The call is synchronous; its time is
/// proportional to planes times angles times samples, and is a few seconds with the defaults. luxfer_job_start runs it
/// as a job. Any thread.
/// LUXFER_DEGENERATE if no mesh emits light, or if no light leaves the meshes, as from a closed room;
/// LUXFER_INVALID_ARGUMENT if a mesh does not exist, a setting is out of range, or the scene is not valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_distribution(
    scene: *mut luxfer_scene,
    meshes: *const u32,
    count: usize,
    params: *const luxfer_gonio_params,
    distribution: *mut *mut luxfer_distribution,
    report: *mut luxfer_gonio_report,
    size: usize,
) -> luxfer_status {
    enter(scene, |object| {
        let out = Out::new(distribution, "distribution")?;
        let report = if report.is_null() { None } else { Some(Report::new(report, size)?) };
        let (params, meshes) = (params::read(params)?.params()?, indices(meshes, count)?);
        let (context, scene) = (object.context(), object.snapshot());
        let monitor = context.monitor();
        let output = context.quick.run(|| gonio::measure(&scene, &meshes, &params, monitor.job()))?;
        if let Some(report) = report {
            report.set(luxfer_gonio_report::new(&output));
        }
        let file = File { luminaire: output.luminaire, variants: 1, emitters: 1 };
        out.set(handle::give(Distribution::new(context, file)));
        Ok(())
    })
}

/// Reads a list of `count` indices, which may be empty, from the caller's memory.
fn indices(place: *const u32, count: usize) -> Result<Vec<u32>> {
    if count == 0 {
        return Ok(Vec::new());
    }
    let raw = bytes(place.cast(), count.saturating_mul(size_of::<u32>()), "meshes")?;
    try_collect(raw.chunks_exact(size_of::<u32>()).map(|index| {
        let [index] = integers(index);
        index as u32
    }))
}

impl luxfer_gonio_params {
    fn params(&self) -> Result<gonio::Params> {
        let [axis, c0] = axes("", self.axis, self.c0)?;
        let Self { planes, angles, samples, seed, .. } = *self;
        Ok(gonio::Params { planes, angles, samples, seed, axis, c0 })
    }
}

impl luxfer_gonio_report {
    fn new(output: &Output) -> Self {
        Self {
            position: output.position.to_array(),
            flux: output.luminaire.flux(),
            flux_error: output.flux_error,
            intensity_error: output.intensity_error,
            ..Self::defaults()
        }
    }
}
