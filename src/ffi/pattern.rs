//! Pattern
//!
//! Settings for the layout of a transfer's light pattern on the surface: its size, rotation and offset, and the areas
//! without lamps.

use super::params::versioned;
use crate::error::{Error, Result};
use crate::transfer::{Pattern, Scale};
use glam::DVec2;

/// Choice of the length that sets the size of the pattern on the surface: a LUXFER_PATTERN_ value.
pub type luxfer_pattern_scale = i32;
/// The distance of the photo's camera from the plane with the lights. It is plane_distance of luxfer_transfer_params,
/// or if that is 0, an estimate. The estimate comes from the size of the lamps if they are rectangular; otherwise it is
/// a usual distance with a large error.
pub const LUXFER_PATTERN_DISTANCE: luxfer_pattern_scale = 0;
/// The length of the lamps: the pattern is scaled until the median of their longer sides is
/// luxfer_pattern_params.length.
pub const LUXFER_PATTERN_LAMP: luxfer_pattern_scale = 1;
/// The spacing of the lamps: the pattern is scaled until this spacing is luxfer_pattern_params.length. The spacing is
/// the shorter period of the lamps' lattice or, without a lattice, the median distance from a lamp to its nearest
/// neighbour.
pub const LUXFER_PATTERN_SPACING: luxfer_pattern_scale = 2;
/// The width of the surface: as many lamps lie side by side on it as on the plane in the photo.
pub const LUXFER_PATTERN_ACROSS: luxfer_pattern_scale = 3;

/// Layout of the light pattern on a surface; luxfer_surface gives the corner and the axes u and v of the surface. Fill
/// it with luxfer_pattern_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_pattern_params {
    /// sizeof(luxfer_pattern_params), set by luxfer_pattern_params_init.
    pub struct_size: u32,
    /// The length that sets the size of the pattern: a LUXFER_PATTERN_ value; default LUXFER_PATTERN_DISTANCE.
    pub scale: luxfer_pattern_scale,
    /// Length of a lamp for LUXFER_PATTERN_LAMP, or spacing of the lamps for LUXFER_PATTERN_SPACING, in metres, in
    /// [1e-6, 1e6]; default 1. Other values of scale do not use it.
    pub length: f64,
    /// Side of a texel in metres, in [0, 1e6]. 0, the default: the size of an unwarped pixel on the surface, or a
    /// larger size if the texture would otherwise exceed max_texels of luxfer_transfer_params. With a size at which the
    /// texture exceeds max_texels, the job ends with LUXFER_INVALID_ARGUMENT.
    pub texel_size: f64,
    /// Rotation of the pattern from u towards v in radians, in [-2 pi, 2 pi]; default 0.
    pub rotation: f64,
    /// Shift of the pattern in metres, along u and v after their rotation by the field rotation; each in [-1e6, 1e6];
    /// default 0. With LUXFER_LAW_FREE, the shift must be 0, unless luxfer_emission_params.offset allows another value.
    pub offset: [f64; 2],
    /// Minimum distance in metres of lamps from the edge of the surface and from the zones of
    /// luxfer_transfer_set_zones, in [-1, 1e6]; lamps that are nearer are left out. With a value below 0, such as the
    /// default -1, only lamps that touch a zone are left out, and the edge of the surface cuts lamps.
    pub margin: f64,
}

versioned!(luxfer_pattern_params, [56], {
    let d = Pattern::default();
    Self {
        struct_size: 56,
        scale: LUXFER_PATTERN_DISTANCE,
        length: 1.0,
        texel_size: d.texel_size,
        rotation: d.rotation,
        offset: d.offset.to_array(),
        margin: d.margin,
    }
});

impl luxfer_pattern_params {
    pub(super) fn pattern(&self) -> Result<Pattern> {
        let scale = match self.scale {
            LUXFER_PATTERN_DISTANCE => Scale::Distance,
            LUXFER_PATTERN_LAMP => Scale::Lamp(self.length),
            LUXFER_PATTERN_SPACING => Scale::Spacing(self.length),
            LUXFER_PATTERN_ACROSS => Scale::Across,
            other => return Err(Error::argument(format!("scale is {other}; it must be a LUXFER_PATTERN_ value"))),
        };
        Ok(Pattern {
            scale,
            texel_size: self.texel_size,
            rotation: self.rotation,
            offset: DVec2::from_array(self.offset),
            margin: self.margin,
        })
    }
}
