//! Placement
//!
//! Where a texture should lie on a surface, so that its target gets most light, least, or just as much as it should: found by
//! gradient on the map of luxfer_importance, without tracing a path.

use super::guard::{enter, guard};
use super::handle::{self, Owned};
use super::image::luxfer_image;
use super::importance::{Traced, luxfer_importance};
use super::job::luxfer_job;
use super::params::{self, Report, Versioned};
use super::status::luxfer_status;
use crate::error::{Error, ErrorKind, Result};
use crate::relight::{Aim, PlaceParams, Pose};
use glam::{DVec2, Vec3};

/// What a placement should do: a LUXFER_AIM_ value.
pub type luxfer_aim = i32;
/// As much luminance for the target as possible.
pub const LUXFER_AIM_MOST: luxfer_aim = 0;
/// As little.
pub const LUXFER_AIM_LEAST: luxfer_aim = 1;
/// The mean radiance of the target that is given, all other light included.
pub const LUXFER_AIM_RADIANCE: luxfer_aim = 2;

/// What may be, and what is best. A texture is scaled and then turned about the centre of the surface's texture coordinates,
/// and shifted. Fill it with luxfer_placement_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_placement_params {
    /// sizeof(luxfer_placement_params), set by luxfer_placement_params_init.
    pub struct_size: u32,
    /// LUXFER_AIM_ value; default LUXFER_AIM_MOST.
    pub aim: luxfer_aim,
    /// The radiance to aim at, in cd/m² per channel, each finite and >= 0; default 0.
    pub radiance: [f32; 3],
    /// Places the search starts from, in [1, 4096]; default 64.
    pub starts: u32,
    /// Smallest offset along u and v of the texture, which has period 1, in [-16, 16]; default -0.5.
    pub least_offset: [f64; 2],
    /// Largest; default 0.5. Where smallest and largest are the same, here and below, nothing changes.
    pub most_offset: [f64; 2],
    /// How often the texture repeats along the surface's u and v, at least, in [1/64, 64]; default 1.
    pub least_scale: [f64; 2],
    /// At most; default 1.
    pub most_scale: [f64; 2],
    /// Smallest rotation in radians, in [-2 pi, 2 pi]; default 0.
    pub least_rotation: f64,
    /// Largest; default 0.
    pub most_rotation: f64,
    /// Seed of the places; default 1.
    pub seed: u64,
}

// SAFETY: plain numbers.
unsafe impl Versioned for luxfer_placement_params {
    const NAME: &'static str = "luxfer_placement_params";
    const SIZES: &'static [usize] = &[112];
    fn defaults() -> Self {
        let d = PlaceParams::default();
        Self {
            struct_size: 112,
            aim: LUXFER_AIM_MOST,
            radiance: [0.0; 3],
            starts: d.starts as u32,
            least_offset: d.min.offset.to_array(),
            most_offset: d.max.offset.to_array(),
            least_scale: d.min.scale.to_array(),
            most_scale: d.max.scale.to_array(),
            least_rotation: d.min.rotation,
            most_rotation: d.max.rotation,
            seed: d.seed,
        }
    }
}

impl luxfer_placement_params {
    fn params(&self) -> Result<PlaceParams> {
        let pose = |offset: [f64; 2], scale: [f64; 2], rotation| Pose {
            offset: DVec2::from_array(offset),
            scale: DVec2::from_array(scale),
            rotation,
        };
        Ok(PlaceParams {
            aim: match self.aim {
                LUXFER_AIM_MOST => Aim::Brightest,
                LUXFER_AIM_LEAST => Aim::Darkest,
                LUXFER_AIM_RADIANCE => Aim::Radiance(Vec3::from_array(self.radiance)),
                other => return Err(Error::argument(format!("aim is {other}; it must be a LUXFER_AIM_ value"))),
            },
            min: pose(self.least_offset, self.least_scale, self.least_rotation),
            max: pose(self.most_offset, self.most_scale, self.most_rotation),
            starts: self.starts as usize,
            seed: self.seed,
        })
    }
}

/// The best placement, and what it means to the target. Set struct_size before the call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_placement {
    /// sizeof(luxfer_placement), set by the caller.
    pub struct_size: u32,
    /// 0.
    pub reserved: u32,
    /// From the surface's texture coordinates to those of the texture, as luxfer_importance_respond takes it.
    pub placement: [f64; 9],
    /// Its offset along u and v.
    pub offset: [f64; 2],
    /// Its scale along u and v.
    pub scale: [f64; 2],
    /// Its rotation in radians.
    pub rotation: f64,
    /// Mean radiance of the target under the texture alone, in cd/m² per channel.
    pub response: [f64; 3],
    /// Half-widths of the 95 % confidence intervals of response.
    pub half_width: [f64; 3],
    /// What cells of twice the side change, noise included; the cells themselves are off by about a third of it.
    pub band_error: [f64; 3],
}

// SAFETY: plain numbers.
unsafe impl Versioned for luxfer_placement {
    const NAME: &'static str = "luxfer_placement";
    const SIZES: &'static [usize] = &[192];
    fn defaults() -> Self {
        Self {
            struct_size: 192,
            reserved: 0,
            placement: [0.0; 9],
            offset: [0.0; 2],
            scale: [0.0; 2],
            rotation: 0.0,
            response: [0.0; 3],
            half_width: [0.0; 3],
            band_error: [0.0; 3],
        }
    }
}

/// Fills *params with the defaults: any offset, at the scale and rotation there are; size is sizeof *params.
/// LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_placement_params_init(
    params: *mut luxfer_placement_params,
    size: usize,
) -> luxfer_status {
    guard(|| params::init(params, size))
}

/// Starts a job that finds the placement of a texture (linear, in cd/m²; it repeats) that is best for the target. params may
/// be NULL for the defaults. The caller releases *job. Any thread.
/// LUXFER_NOT_READY before a map has been traced, LUXFER_INVALID_OPERATION if a job runs already. The job may end with
/// LUXFER_INVALID_ARGUMENT if a setting is out of range.
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

/// Gets the placement that was found. Any thread.
/// LUXFER_NOT_READY before a job of luxfer_importance_start_placement has succeeded, and again when another map is traced.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_importance_get_placement(
    importance: *mut luxfer_importance,
    placement: *mut luxfer_placement,
) -> luxfer_status {
    enter(importance, |stage| {
        let out = Report::new(placement)?;
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
            band_error: best.response.band_error.to_array(),
            ..luxfer_placement::defaults()
        });
        Ok(())
    })
}
