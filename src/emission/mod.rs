//! Emission: an emissive texture of any size from the unwarped lights of a photo (Lipp et al., §6).

use crate::error::Result;
use crate::geometry::Homography;
use crate::image::Image;
use crate::job::Job;
use glam::{DVec2, Vec3};

#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// Unwarped photo, linear RGB.
    pub unwarped: &'a Image,
    /// Unwarped confidence that a pixel is light, in `[0, 1]`.
    pub light: &'a Image,
    /// 1 where the two above show the plane.
    pub valid: &'a Image,
    /// The photo itself and the map from unwarped pixels into it, from which full detail is recovered; absent: the
    /// unwarped image is the finest there is.
    pub photo: Option<(&'a Image, Homography)>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Size of the texture in texels, each in `[1, 65536]`.
    pub width: usize,
    pub height: usize,
    /// Unwarped pixels per texel, > 0.
    pub scale: f64,
    /// Side of a patch in working pixels; 0 chooses it from the spacing of the lights.
    pub block: usize,
    /// Longest side of the exemplar during synthesis, in pixels, in `[16, 2048]`.
    pub working_side: usize,
    /// Weight of the metadata channels against colour, in `[0, 1e3]`; 0 is plain quilting.
    pub metadata_weight: f32,
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self { width: 1024, height: 1024, scale: 1.0, block: 0, working_side: 256, metadata_weight: 1.0, seed: 1 }
    }
}

/// One lamp of the texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Luminaire {
    /// Centre in texels.
    pub centre: DVec2,
    /// Lengths of the principal axes in texels, long one first.
    pub size: DVec2,
    /// Angle of the long axis from x towards y, in radians, in (-π/2, π/2].
    pub orientation: f64,
    /// Area in texels.
    pub area: f64,
    /// Mean linear colour.
    pub colour: Vec3,
    /// Share of the light of the whole texture, in `[0, 1]`.
    pub flux_share: f64,
    /// Corners of the outline in texels.
    pub outline: Vec<DVec2>,
}

#[derive(Clone, Debug)]
pub struct Emission {
    /// Linear RGB, relative to the photo's white; 0 where there is no lamp.
    pub texture: Image,
    /// Light mask of the texture, 0 or 1.
    pub mask: Image,
    /// What synthesis worked with, at working size: confidence, signed x and y distance to the nearest light.
    pub exemplar_metadata: Image,
    /// The same of its result.
    pub metadata: Image,
    pub luminaires: Vec<Luminaire>,
    /// Relative difference between texture and exemplar in share of lit area.
    pub error: f64,
}

pub fn run(_input: &Input, _params: &Params, _job: Job) -> Result<Emission> {
    todo!()
}
