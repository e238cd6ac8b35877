//! Transfer
//!
//! The lighting transfer from end to end: from a photo, a few strokes and a scene to that scene lit as in the photo. It
//! runs the stages in order. Every result can be read as soon as its stage has ended, replaced by the caller's own, and the
//! run taken up again from any stage.

use super::context::luxfer_context;
use super::features::{depth_kind, luxfer_depth_kind, luxfer_features, luxfer_features_params};
use super::emission::luxfer_emission_params;
use super::guard::{enter, guard};
use super::handle::{self, Handle, Owned, tag};
use super::image::{Pixels, luxfer_image};
use super::job::luxfer_job;
use super::params::{self, Report, Versioned};
use super::pointer::{Out, text};
use super::rectify::{luxfer_rectify, luxfer_rectify_params};
use super::relight::{luxfer_relight_params, luxfer_relight_report};
use super::render::luxfer_render_params;
use super::scene::{SceneObject, luxfer_scene, missing};
use super::scene_parts::luxfer_camera_params;
use super::segment::{self, LUXFER_PHASE_LIGHTS, LUXFER_PHASE_PLANE, luxfer_phase, luxfer_segment, luxfer_segment_params};
use super::stage::{Stage as Runner, need};
use super::status::luxfer_status;
use crate::error::{Error, ErrorKind, Result};
use crate::features::DepthKind;
use crate::scene::Camera;
use crate::segment::{StrokeSet, strokes};
use crate::transfer::{self, Results, STAGES, Stage, TargetColour, Transfer};
use std::ffi::c_char;
use std::sync::Arc;

/// A lighting transfer. See luxfer_transfer_create.
pub struct luxfer_transfer {
    _opaque: [u8; 0],
}

/// A stage of the transfer: a LUXFER_STAGE_ value, in the order they run.
pub type luxfer_stage = i32;
/// Lines, vanishing points and the photo's camera.
pub const LUXFER_STAGE_VIEW: luxfer_stage = 0;
/// Ten channels for each pixel.
pub const LUXFER_STAGE_FEATURES: luxfer_stage = 1;
/// The mask of the plane that carries the lights.
pub const LUXFER_STAGE_PLANE: luxfer_stage = 2;
/// The mask of the lights in it.
pub const LUXFER_STAGE_LIGHTS: luxfer_stage = 3;
/// The plane seen straight on.
pub const LUXFER_STAGE_UNWARP: luxfer_stage = 4;
/// The emissive texture, laid onto the scene's surface.
pub const LUXFER_STAGE_EMISSION: luxfer_stage = 5;
/// Its colour and intensity.
pub const LUXFER_STAGE_RELIGHT: luxfer_stage = 6;
/// The picture.
pub const LUXFER_STAGE_RENDER: luxfer_stage = 7;

/// An image of the transfer: a LUXFER_TRANSFER_ value.
pub type luxfer_transfer_image = i32;
/// The ten channels of the features.
pub const LUXFER_TRANSFER_FEATURES: luxfer_transfer_image = 0;
/// 1 on the plane, else 0; 1 channel.
pub const LUXFER_TRANSFER_PLANE_MASK: luxfer_transfer_image = 1;
/// Probability that a pixel is on the plane; 1 channel.
pub const LUXFER_TRANSFER_PLANE_CONFIDENCE: luxfer_transfer_image = 2;
/// 1 on lights, else 0; 1 channel.
pub const LUXFER_TRANSFER_LIGHTS_MASK: luxfer_transfer_image = 3;
/// Probability that a pixel is a light; 1 channel.
pub const LUXFER_TRANSFER_LIGHTS_CONFIDENCE: luxfer_transfer_image = 4;
/// The plane seen straight on, linear RGB.
pub const LUXFER_TRANSFER_UNWARPED: luxfer_transfer_image = 5;
/// 1 where the photo shows the plane, else 0; 1 channel.
pub const LUXFER_TRANSFER_UNWARPED_VALID: luxfer_transfer_image = 6;
/// The emissive texture, linear RGB relative to the photo's white.
pub const LUXFER_TRANSFER_EMISSION: luxfer_transfer_image = 7;
/// 1 on lamps of the texture, else 0; 1 channel.
pub const LUXFER_TRANSFER_EMISSION_MASK: luxfer_transfer_image = 8;
/// The scene in its new light, linear RGB in cd/m²; while it is being rendered, as far as it is.
pub const LUXFER_TRANSFER_RENDER: luxfer_transfer_image = 9;
/// Variance of the rendering; 3 channels.
pub const LUXFER_TRANSFER_RENDER_VARIANCE: luxfer_transfer_image = 10;

/// A scene of the transfer: a LUXFER_SCENE_ value.
pub type luxfer_transfer_scene = i32;
/// With the emission at the photo's own strength, before it is solved for.
pub const LUXFER_SCENE_UNSOLVED: luxfer_transfer_scene = 0;
/// With the solved emission: the result.
pub const LUXFER_SCENE_LIT: luxfer_transfer_scene = 1;
/// As LUXFER_SCENE_LIT, the light's colour taken away and its luminance kept.
pub const LUXFER_SCENE_WHITE: luxfer_transfer_scene = 2;

/// What part of the photo gives the colour to match: a LUXFER_TARGET_ value.
pub type luxfer_target = i32;
/// The plane that carries the lights, without them and their halo.
pub const LUXFER_TARGET_SURFACE: luxfer_target = 0;
/// The whole photo.
pub const LUXFER_TARGET_WHOLE_IMAGE: luxfer_target = 1;

/// Settings of a transfer. Fill them with luxfer_transfer_params_init. The structs pointed to are read during the call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_transfer_params {
    /// sizeof(luxfer_transfer_params), set by luxfer_transfer_params_init.
    pub struct_size: u32,
    /// Longest side of the emissive texture in texels, in [1, 16384]; default 2048.
    pub max_texels: u32,
    /// Distance of the photo's camera from the lit plane in metres, in [0.01, 1e4]; default 1.2. It sets the scale of the
    /// pattern.
    pub plane_distance: f64,
    /// Luminance that the photo's white stands for, in cd/m², in [1e-6, 1e9]; default 100.
    pub white_luminance: f32,
    /// LUXFER_TARGET_ value; default LUXFER_TARGET_SURFACE.
    pub target: luxfer_target,
    /// Settings of the stages VIEW and UNWARP; NULL, the default, for their defaults.
    pub rectify: *const luxfer_rectify_params,
    /// Settings of the stage FEATURES; NULL, the default, for their defaults.
    pub features: *const luxfer_features_params,
    /// Settings of the stages PLANE and LIGHTS; NULL, the default, for their defaults.
    pub segment: *const luxfer_segment_params,
    /// Settings of the stage EMISSION, whose width, height and scale the transfer sets; NULL, the default, for their
    /// defaults.
    pub emission: *const luxfer_emission_params,
    /// Settings of the stage RELIGHT; NULL, the default, for their defaults.
    pub relight: *const luxfer_relight_params,
    /// Settings of the stage RENDER; NULL, the default, for their defaults.
    pub render: *const luxfer_render_params,
}

const PARAMS_SIZE: usize = 24 + 6 * size_of::<usize>();

// SAFETY: numbers, and pointers that are checked before use.
unsafe impl Versioned for luxfer_transfer_params {
    const NAME: &'static str = "luxfer_transfer_params";
    const SIZES: &'static [usize] = &[PARAMS_SIZE];
    fn defaults() -> Self {
        let d = transfer::Params::default();
        Self {
            struct_size: PARAMS_SIZE as u32,
            max_texels: d.max_texels as u32,
            plane_distance: d.plane_distance,
            white_luminance: d.white_luminance,
            target: LUXFER_TARGET_SURFACE,
            rectify: std::ptr::null(),
            features: std::ptr::null(),
            segment: std::ptr::null(),
            emission: std::ptr::null(),
            relight: std::ptr::null(),
            render: std::ptr::null(),
        }
    }
}

impl luxfer_transfer_params {
    fn params(&self) -> Result<transfer::Params> {
        let target = match self.target {
            LUXFER_TARGET_SURFACE => TargetColour::Surface,
            LUXFER_TARGET_WHOLE_IMAGE => TargetColour::WholeImage,
            other => return Err(Error::argument(format!("target is {other}; it must be a LUXFER_TARGET_ value"))),
        };
        let (rectify, unwarp) = params::read(self.rectify)?.params()?;
        Ok(transfer::Params {
            rectify,
            unwarp,
            features: params::read(self.features)?.params(),
            segment: params::read(self.segment)?.params(),
            emission: params::read(self.emission)?.params(),
            plane_distance: self.plane_distance,
            max_texels: self.max_texels as usize,
            target,
            white_luminance: self.white_luminance,
            relight: params::read(self.relight)?.params()?,
            render: params::read(self.render)?.params(),
        })
    }
}

/// What each stage took and how good its result is. Set struct_size before the call. Errors of stages without a result are
/// NaN.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_transfer_report {
    /// sizeof(luxfer_transfer_report), set by the caller.
    pub struct_size: u32,
    /// Number of fixtures; see luxfer_transfer_get_fixture. 0 before the stage RELIGHT has ended.
    pub fixtures: u32,
    /// Seconds each stage took when it last ran, by LUXFER_STAGE_ value.
    pub seconds: [f64; 8],
    /// Largest standard deviation of a vanishing point's direction, in radians.
    pub view_error: f64,
    /// Mean trust in the depth of the features, in [0, 1].
    pub depth_confidence: f64,
    /// Expected share of wrong pixels in the mask of the plane.
    pub plane_error: f64,
    /// Expected share of wrong pixels in the mask of the lights.
    pub lights_error: f64,
    /// Largest expected error of a corner of the unwarped image, in unwarped pixels.
    pub unwarp_error: f64,
    /// Relative difference between texture and photo in the share of lit area.
    pub emission_error: f64,
    /// Widest relative half-width of the solution's 95 % intervals.
    pub relight_error: f64,
    /// Mean relative standard error of the picture.
    pub render_error: f64,
    /// Size of a texel of the emission in metres.
    pub texel_size: f64,
    /// Mean colour the surface is to have, relative to the photo's white.
    pub target: [f32; 3],
    /// 0.
    pub reserved: u32,
}

const REPORT_SIZE: usize = 8 + 64 + 72 + 16;

// SAFETY: plain numbers.
unsafe impl Versioned for luxfer_transfer_report {
    const NAME: &'static str = "luxfer_transfer_report";
    const SIZES: &'static [usize] = &[REPORT_SIZE];
    fn defaults() -> Self {
        Self {
            struct_size: REPORT_SIZE as u32,
            fixtures: 0,
            seconds: [0.0; 8],
            view_error: f64::NAN,
            depth_confidence: f64::NAN,
            plane_error: f64::NAN,
            lights_error: f64::NAN,
            unwarp_error: f64::NAN,
            emission_error: f64::NAN,
            relight_error: f64::NAN,
            render_error: f64::NAN,
            texel_size: f64::NAN,
            target: [f32::NAN; 3],
            reserved: 0,
        }
    }
}

impl luxfer_transfer_report {
    fn new(results: &Results) -> Self {
        let or_nan = |error: Option<f64>| error.unwrap_or(f64::NAN);
        let largest = |errors: &[f64]| errors.iter().copied().fold(0.0, f64::max);
        let lit = results.lit.as_ref();
        Self {
            fixtures: match (lit, &results.emission) {
                (Some(_), Some(emission)) => u32::try_from(emission.luminaires.len()).unwrap_or(u32::MAX),
                _ => 0,
            },
            seconds: results.seconds,
            view_error: or_nan(results.view.as_ref().map(|v| largest(&[0, 1, 2].map(|i| v.vanishing_points[i].error)))),
            depth_confidence: or_nan(results.features.as_ref().map(|f| {
                let data = &f.depth_confidence.data;
                data.iter().map(|&c| f64::from(c)).sum::<f64>() / data.len() as f64
            })),
            plane_error: or_nan(results.plane.as_ref().map(|s| s.error)),
            lights_error: or_nan(results.lights.as_ref().map(|s| s.error)),
            unwarp_error: or_nan(results.unwarped.as_ref().map(|u| largest(&u.corner_error))),
            emission_error: or_nan(results.emission.as_ref().map(|e| e.error)),
            relight_error: or_nan(results.solution.as_ref().map(|s| s.error())),
            render_error: or_nan(results.film.as_ref().map(|f| f.error)),
            texel_size: or_nan(lit.or(results.unsolved.as_ref()).map(|l| l.texel_size)),
            target: results.target.map_or([f32::NAN; 3], |t| t.to_array()),
            ..Self::defaults()
        }
    }
}

/// One lamp of the lit scene. Set struct_size before the call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_fixture {
    /// sizeof(luxfer_fixture), set by the caller.
    pub struct_size: u32,
    /// Centre in metres.
    pub position: [f32; 3],
    /// Unit direction the lamp shines in.
    pub normal: [f32; 3],
    /// Unit direction of its long axis.
    pub axis: [f32; 3],
    /// Mean luminance per channel in cd/m².
    pub radiance: [f32; 3],
    /// 0.
    pub reserved: u32,
    /// Lengths along and across the axis in metres.
    pub size: [f64; 2],
    /// Area in m².
    pub area: f64,
    /// Luminous flux in lumens.
    pub flux: f64,
}

// SAFETY: plain numbers.
unsafe impl Versioned for luxfer_fixture {
    const NAME: &'static str = "luxfer_fixture";
    const SIZES: &'static [usize] = &[88];
    fn defaults() -> Self {
        Self {
            struct_size: 88,
            position: [0.0; 3],
            normal: [0.0; 3],
            axis: [0.0; 3],
            radiance: [0.0; 3],
            reserved: 0,
            size: [0.0; 2],
            area: 0.0,
            flux: 0.0,
        }
    }
}
