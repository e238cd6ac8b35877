//! Features: the per-pixel input of segmentation ("Single-Exemplar Lighting Style Transfer", §4.1).
//!
//! ```text
//! photo ─▶ clean ─▶ L*, a*, b* ───────────────────────────────┐
//! depth ─▶ scale, fill holes ─┐                               ├─▶ 10 channels
//! room  ─▶ layout (a box) ────┼─▶ inverse depth ─▶ Eq. 1 ─────┤
//! none  ─▶ neutral prior ─────┘        └──▶ plane fits: normals┘
//! ```
//!
//! | channel | meaning | range |
//! |---|---|---|
//! | 0-2 | CIELAB of the photo (D65, display white = 1) | L* in `[0, 100]` for display-referred photos |
//! | 3 | screen-space depth `d_s` of Eq. 1: 0 on the near, 1 on the far plane | `[-far/near, far / (far - near)]` |
//! | 4-6 | position by Eq. 1, in units of the frustum; in room axes if the room is known | finite |
//! | 7-9 | unit normal towards the camera, in the same axes | `[-1, 1]` |
//!
//! Axes are x right, y down, z forward: camera axes, or the room's axes in the order the camera sees them
//! ([`RoomView`]). If the perspective is known, its rays replace the paper's 90° frustum: Eq. 1 then takes bounds from
//! the real focal length, so that planes stay planes. Only ratios of depth are meaningful; the nearest depth (its 2 %
//! quantile) is put on the near plane.
//!
//! A depth map may also be estimated from the photo alone, by a network that the caller supplies as an ONNX file
//! (Cargo feature `onnx`).
//!
//! Not modelled: lens distortion; room shapes other than a single box in the built-in layout (furniture, beams,
//! two-part rooms).

mod assemble;
mod clean;
mod depth;
mod frustum;
mod layout;
#[cfg(feature = "onnx")]
mod monocular;
mod normals;
mod plane_fit;
mod score;
mod search;
mod strokes;
#[cfg(test)]
mod tests;
mod warnings;

pub use frustum::Frustum;
pub use layout::Layout;
#[cfg(feature = "onnx")]
pub use monocular::{DepthNetwork, Normalisation, run_with_network};

use crate::error::{Error, Result, check_range};
use crate::exec;
use crate::geometry::{Perspective, Segment};
use crate::image::Image;
use crate::job::Job;
use std::sync::atomic::{AtomicBool, Ordering};

/// Number of feature channels: L*, a*, b*, depth, x, y, z, and the normal's x, y, z.
pub const CHANNELS: usize = 10;

/// The distance that a caller's depth map measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthKind {
    /// Distance along the viewing axis.
    AlongZ,
    /// Distance along each pixel's ray.
    AlongRay,
}

/// A depth map of the photo's size with one channel, in any unit; zero, negative or non-finite values mark holes.
#[derive(Clone, Copy)]
pub struct DepthMap<'a> {
    pub image: &'a Image,
    pub kind: DepthKind,
}

/// Known geometry of the room, from which the built-in depth is laid out.
#[derive(Clone, Copy)]
pub struct RoomView<'a> {
    pub perspective: &'a Perspective,
    /// Detected segments, each with the index (0, 1, 2) of the room axis it runs along, if any.
    pub segments: &'a [(Segment, Option<usize>)],
    /// Strokes on one plane of the room (any one), and strokes on other surfaces, if any.
    pub strokes: &'a [PlaneStroke<'a>],
}

/// A user's stroke as evidence about the room.
#[derive(Clone, Copy)]
pub struct PlaneStroke<'a> {
    /// Pixel indices `y * width + x`; indices outside the photo are ignored.
    pub pixels: &'a [u32],
    /// Whether the stroke lies on the plane or on another surface.
    pub positive: bool,
}

#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// Linear RGB, 1 = display white. NaN, infinite or negative pixels are replaced and counted.
    pub photo: &'a Image,
    pub depth: Option<DepthMap<'a>>,
    pub room: Option<RoomView<'a>>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Near plane of Eq. 1, in arbitrary units, in `[1e-3, 1e3]`.
    pub near: f32,
    /// Far plane of Eq. 1, in `[1.001, 1e6]` times `near`.
    pub far: f32,
    /// Half-width in pixels of the window of the normals' plane fits, in `[1, 64]`; 0 selects one pixel per 100
    /// columns, at least 2. Wider windows suppress more noise and smooth away more small detail.
    pub normal_radius: usize,
}

impl Default for Params {
    fn default() -> Self {
        Self { near: 1.0, far: 10.0, normal_radius: 0 }
    }
}

impl Params {
    /// Checks that every setting is in its range.
    pub fn check(&self) -> Result<()> {
        check_range("near", self.near, 1e-3, 1e3)?;
        check_range("far", self.far, self.near * 1.001, self.near * 1e6)?;
        check_range("normal_radius", self.normal_radius, 0, 64)?;
        Ok(())
    }
}

/// Origin of the depth, most reliable first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthSource {
    Caller,
    /// A network supplied by the caller.
    Network,
    /// The box room of [`Features::layout`].
    Layout,
    /// The prior that uses no information from the photo.
    Neutral,
}

#[derive(Clone, Debug)]
pub struct Features {
    /// [`CHANNELS`] channels of the photo's size; finite everywhere.
    pub image: Image,
    /// Confidence in the depth of each pixel, in `[0, 1]`: 1 where the caller gave it, 0 in its holes, 0.5 from a
    /// network, below 1 for the built-in layout, 0.05 for the neutral prior.
    pub depth_confidence: Image,
    pub depth_source: DepthSource,
    /// The box room from which the depth was laid out, if any.
    pub layout: Option<Layout>,
    /// Number of photo pixels with a NaN, infinite or negative value, which were replaced from their neighbours.
    pub non_finite: usize,
}

/// Computes the features of a photo. Fails if a depth map has no positive finite value.
pub fn run(input: &Input, params: &Params, job: Job) -> Result<Features> {
    params.check()?;
    let (width, height) = (input.photo.width, input.photo.height);
    let perspective = input.room.map(|r| r.perspective);
    let frustum = match perspective {
        Some(p) => Frustum::of_camera(p, width, height, params.near, params.far)?,
        None => Frustum::paper(params.near, params.far),
    };

    let (photo, non_finite) = clean::clean(input.photo, job.part(0.0, 0.1))?;

    // Compute depth and normals from the best available source.
    let geometry_job = job.part(0.1, 0.7);
    let radius = if params.normal_radius > 0 { params.normal_radius } else { (width / 100).clamp(2, 64) };
    let geometry = || match (&input.depth, &input.room) {
        (Some(map), _) => {
            input.photo.check_same_size("photo", map.image, "depth")?;
            Ok((depth::from_map(map, &frustum, radius, geometry_job)?, DepthSource::Caller, None))
        }
        (None, Some(room)) => {
            let layout = search::find(room, width, height, geometry_job.part(0.0, 0.6))?;
            let surface = layout.surface(room, width, height, &frustum, geometry_job.part(0.6, 1.0))?;
            Ok((surface, DepthSource::Layout, Some(layout)))
        }
        (None, None) => {
            Ok((depth::neutral(width, height, &frustum, radius, geometry_job)?, DepthSource::Neutral, None))
        }
    };
    // Allocate the output meanwhile: it takes a tenth of the total time.
    let (geometry, image) = exec::both(geometry, || Image::new(width, height, CHANNELS));
    let (surface, depth_source, layout) = geometry?;
    let mut image = image?;

    // Write all channels, in room axes.
    let to_room = perspective.map_or(glam::Mat3::IDENTITY, |p| layout::facing_axes(p).transpose().as_mat3());
    let is_finite = AtomicBool::new(true);
    exec::for_rows(&mut image.data, width * CHANNELS, job.part(0.7, 1.0), |y, row| {
        assemble::row(&photo, &surface, &frustum, to_room, y, row);
        if !row.iter().fold(true, |all, v| all & v.is_finite()) {
            is_finite.store(false, Ordering::Relaxed);
        }
    })?;
    if !is_finite.into_inner() {
        return Err(Error::argument("the photo holds values beyond 1e30; scale it so that 1 is display white"));
    }
    let confidence = surface.confidence;
    Ok(Features { image, depth_confidence: confidence, depth_source, layout, non_finite })
}
