//! Placement
//!
//! Finds where to place a texture on an emitting surface so that a target receives the most light, the least light, or
//! a given radiance. The search is a gradient descent on the map that a luxfer_importance has traced; it traces no
//! paths itself.

use super::guard::enter;
use super::handle::{self, Owned};
use super::image::luxfer_image;
use super::importance::{Traced, luxfer_importance};
use super::job::luxfer_job;
use super::params::{self, Report, Versioned, versioned};
use super::status::luxfer_status;
use crate::error::{Error, ErrorKind, Result};
use crate::relight::{Aim, PlacementParams, Pose};
use glam::{DVec2, Vec3};

/// Objective of a placement: a LUXFER_AIM_ value.
pub type luxfer_aim = i32;
/// Make the luminance of the target as large as possible.
pub const LUXFER_AIM_MAX_LUMINANCE: luxfer_aim = 0;
/// Make the luminance of the target as small as possible.
pub const LUXFER_AIM_MIN_LUMINANCE: luxfer_aim = 1;
/// Bring the mean radiance of the target, under the texture and all other light, as near as possible to
/// luxfer_placement_params.radiance.
pub const LUXFER_AIM_RADIANCE: luxfer_aim = 2;

/// Objective and bounds of a placement. A placement scales the texture coordinates of the surface about their centre
/// (0.5, 0.5), then rotates them about this centre, and then shifts them. Fill it with luxfer_placement_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_placement_params {
    /// sizeof(luxfer_placement_params), set by luxfer_placement_params_init.
    pub struct_size: u32,
    /// Objective: a LUXFER_AIM_ value; default LUXFER_AIM_MAX_LUMINANCE.
    pub aim: luxfer_aim,
    /// Wanted mean radiance of the target for LUXFER_AIM_RADIANCE, in cd/m² per channel, each finite and >= 0; default
    /// 0.
    pub radiance: [f32; 3],
    /// Number of placements that are tried first, in [1, 4096]; default 64. The search then descends from the best of
    /// these placements.
    pub starts: u32,
    /// Smallest offset along u and v of the texture, in periods of the texture, in [-16, 16]; default -0.5.
    pub min_offset: [f64; 2],
    /// Largest offset along u and v, in periods, in [-16, 16]; default 0.5. A range of one period, such as the default,
    /// allows every offset. If min_offset and max_offset are equal, the offset is fixed; in the same way, equal bounds
    /// fix the scale and the rotation.
    pub max_offset: [f64; 2],
    /// Smallest number of repetitions of the texture along the surface's u and v, in [1/64, 64]; default 1.
    pub min_scale: [f64; 2],
    /// Largest number of repetitions along u and v, in [1/64, 64]; default 1.
    pub max_scale: [f64; 2],
    /// Smallest rotation of the texture coordinates from u towards v in radians, in [-2 pi, 2 pi]; default 0.
    pub min_rotation: f64,
    /// Largest rotation in radians, in [-2 pi, 2 pi]; default 0.
    pub max_rotation: f64,
    /// Seed of the starting placements; default 1.
    pub seed: u64,
}

versioned!(luxfer_placement_params, [112], {
    let d = PlacementParams::default();
    Self {
        struct_size: 112,
        aim: LUXFER_AIM_MAX_LUMINANCE,
        radiance: [0.0; 3],
        starts: d.starts as u32,
        min_offset: d.min.offset.to_array(),
        max_offset: d.max.offset.to_array(),
        min_scale: d.min.scale.to_array(),
        max_scale: d.max.scale.to_array(),
        min_rotation: d.min.rotation,
        max_rotation: d.max.rotation,
        seed: d.seed,
    }
});

impl luxfer_placement_params {
    fn params(&self) -> Result<PlacementParams> {
        let pose = |offset: [f64; 2], scale: [f64; 2], rotation| Pose {
            offset: DVec2::from_array(offset),
            scale: DVec2::from_array(scale),
            rotation,
        };
        Ok(PlacementParams {
            aim: match self.aim {
                LUXFER_AIM_MAX_LUMINANCE => Aim::Brightest,
                LUXFER_AIM_MIN_LUMINANCE => Aim::Darkest,
                LUXFER_AIM_RADIANCE => Aim::Radiance(Vec3::from_array(self.radiance)),
                other => return Err(Error::argument(format!("aim is {other}; it must be a LUXFER_AIM_ value"))),
            },
            min: pose(self.min_offset, self.min_scale, self.min_rotation),
            max: pose(self.max_offset, self.max_scale, self.max_rotation),
            starts: self.starts as usize,
            seed: self.seed,
        })
    }
}

/// The best placement, and the light that the target then receives.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_placement {
    /// sizeof(luxfer_placement), set by the function that fills the struct.
    pub struct_size: u32,
    /// Reserved; always 0.
    pub reserved: u32,
    /// The placement of the texture on the surface: a 3 x 3 matrix, row by row, like the argument placement of
    /// luxfer_importance_respond.
    pub placement: [f64; 9],
    /// Offset of the placement along u and v of the texture, in periods.
    pub offset: [f64; 2],
    /// Number of repetitions of the texture along u and v of the surface.
    pub scale: [f64; 2],
    /// Rotation of the placement in radians, from u towards v.
    pub rotation: f64,
    /// Mean radiance of the target from the texture alone, in cd/m² per channel.
    pub response: [f64; 3],
    /// Half-widths of the 95 % confidence intervals of the field response, in cd/m².
    pub half_width: [f64; 3],
    /// The result for a map whose cells are twice as wide and high, minus the value in response, in cd/m² per channel.
    /// About a third of this difference is the error of response that comes from the size of the cells. The difference
    /// also contains noise.
    pub resolution_difference: [f64; 3],
}

versioned!(luxfer_placement, [192], {
    Self {
        struct_size: 192,
        reserved: 0,
        placement: [0.0; 9],
        offset: [0.0; 2],
        scale: [0.0; 2],
        rotation: 0.0,
        response: [0.0; 3],
        half_width: [0.0; 3],
        resolution_difference: [0.0; 3],
    }
});

/// Starts a job that finds the best placement of a texture for the target. The texture is linear, in cd/m², and
/// repeats. params may be NULL for the defaults. The caller releases *job. Any thread.
/// LUXFER_NOT_READY before a map has been traced, LUXFER_INVALID_OPERATION if a job is already running. The job may
/// end with LUXFER_INVALID_ARGUMENT if a setting is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_importance_start_placement(
    importance: *mut luxfer_importance,
    texture: *mut luxfer_image,
    params: *const luxfer_placement_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(importance, |stage| {
        let params = params::read(params)?.params()?;
        let texture = handle::borrow_in(stage.context(), texture, "texture")?;
        stage.output()?;
        stage.start(job, move |_, stage, job| {
            let map = stage.output()?.map.clone();
            let placement = map.place(texture.image(), &params, job)?;
            Ok(Traced { map, placement: Some(placement) })
        })
    })
}

/// Gets the placement that was found. size is sizeof *placement. Any thread.
/// LUXFER_NOT_READY before a job of luxfer_importance_start_placement has succeeded with the current map.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_importance_get_placement(
    importance: *mut luxfer_importance,
    placement: *mut luxfer_placement,
    size: usize,
) -> luxfer_status {
    enter(importance, |stage| {
        let out = Report::new(placement, size)?;
        let output = stage.output()?;
        let best = output.placement.as_ref().ok_or_else(|| {
            Error::new(
                ErrorKind::NotReady,
                "no placement has been looked for on this map: call luxfer_importance_start_placement first",
            )
        })?;
        let light = best.response.light;
        out.set(luxfer_placement {
            placement: best.pose.matrix().transpose().to_cols_array(),
            offset: best.pose.offset.to_array(),
            scale: best.pose.scale.to_array(),
            rotation: best.pose.rotation,
            response: light.mean.to_array(),
            half_width: light.half_width().to_array(),
            resolution_difference: best.response.resolution_difference.to_array(),
            ..luxfer_placement::defaults()
        });
        Ok(())
    })
}
