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
//! | 3 | screen-space depth `d_s` of Eq. 1: 0 on the near, 1 on the far plane | up to `far / (far - near)` |
//! | 4-6 | position by Eq. 1, in the unit of length of `near`; in room axes if the room is known | finite |
//! | 7-9 | unit normal towards the camera, in the same axes | `[-1, 1]` |
//!
//! Axes are x right, y down, z forward: camera axes, or the room's axes if the room is known ([`RoomView`]). If the
//! perspective is known, its rays replace the paper's 90° frustum: Eq. 1 then takes bounds from the real focal length,
//! so that planes stay planes. Only ratios of depth are meaningful. Depth from a map or from a layout is therefore
//! scaled so that the 2 % quantile of the depth lies on the near plane.
//!
//! A depth map may also be estimated from the photo alone, by a network that the caller supplies as an ONNX file
//! (Cargo feature `onnx`).
//!
//! The user's strokes grow over the smooth surfaces on which they lie ([`Surfaces`]). The grown surfaces are evidence
//! for the layout, and tell which pixels lie off the plane of the strokes.
//!
//! Not modelled: lens distortion in the normals of a caller's depth map (positions and the built-in layout follow the
//! lens); room shapes other than a single box in the built-in layout (furniture, beams, two-part rooms).

mod assemble;
mod box_room;
mod clean;
mod depth;
mod enlarge;
mod frustum;
mod grow;
mod input;
mod layout;
#[cfg(feature = "onnx")]
mod monocular;
mod normals;
mod plane_fit;
mod score;
mod search;
mod several;
mod strokes;
#[cfg(test)]
mod tests;
mod warnings;

pub use box_room::{Face, Layout};
pub use enlarge::{LampsBeyond, RegionBeyond};
pub use frustum::Frustum;
pub use grow::Surfaces;
pub use input::{CHANNELS, DepthKind, DepthMap, DepthSource, Input, NORMAL, POSITION, Params, PlaneStroke, RoomView};
#[cfg(feature = "onnx")]
pub use monocular::{DepthNetwork, Normalisation, run_with_network};

pub use several::run_for_planes;

use crate::error::{Error, Result};
use crate::exec;
use crate::image::Image;
use crate::job::Job;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

#[derive(Clone, Debug)]
pub struct Features {
    /// [`CHANNELS`] channels of the photo's size; finite everywhere.
    pub image: Arc<Image>,
    /// Confidence in the depth of each pixel, in `[0, 1]`: 1 where the caller's depth map has a value, 0 in the holes
    /// of this map, 0.5 for depth from a network, below 1 for the built-in layout, 0.05 for the neutral prior.
    pub depth_confidence: Arc<Image>,
    pub depth_source: DepthSource,
    /// The box room from which the depth was computed, if any.
    pub layout: Option<Layout>,
    /// The parts of the photo over which the strokes of the room have grown; `None` unless strokes lie both on and off
    /// the plane.
    pub surfaces: Option<Surfaces>,
    /// Number of photo pixels with a NaN, infinite or negative value, which were replaced from their neighbours.
    pub non_finite: usize,
}

/// Computes the features of a photo.
///
/// Errors: a setting out of range, a depth map of another size, photo values too large for finite features
/// (`InvalidArgument`); a depth map without a positive finite value (`Degenerate`).
pub fn run(input: &Input, params: &Params, job: Job) -> Result<Features> {
    params.check()?;
    let (width, height) = (input.photo.width, input.photo.height);
    let perspective = input.room.map(|r| r.perspective);
    let frustum = match perspective {
        Some(p) => Frustum::of_camera(p, width, height, params.near, params.far)?,
        None => Frustum::paper(params.near, params.far),
    };

    let (photo, non_finite) = clean::clean(input.photo, job.part(0.0, 0.1))?;

    let strokes = input.room.as_ref().map_or(&[][..], |room| room.strokes);
    let surfaces = grow::grow(&photo, strokes, job.part(0.1, 0.15))?;

    // Compute depth and normals from the best available source.
    let geometry_job = job.part(0.15, 0.7);
    let radius = if params.normal_radius > 0 { params.normal_radius } else { (width / 100).clamp(2, 64) };
    let geometry = || match (&input.depth, &input.room) {
        (Some(map), _) => {
            input.photo.check_same_size("photo", map.image, "depth")?;
            Ok((depth::from_map(map, &frustum, radius, geometry_job)?, DepthSource::Caller, None))
        }
        (None, Some(room)) => {
            let layout = match room.layout {
                Some(known) => known,
                None => search::find(room, surfaces.as_ref(), [width, height], geometry_job.part(0.0, 0.6))?,
            };
            let surface = layout.surface(room, width, height, &frustum, geometry_job.part(0.6, 1.0))?;
            Ok((surface, DepthSource::Layout, Some(layout)))
        }
        (None, None) => {
            Ok((depth::neutral(width, height, &frustum, radius, geometry_job)?, DepthSource::Neutral, None))
        }
    };
    // Allocate the output while the depth is computed, because allocation takes a tenth of the total time.
    let (geometry, image) = exec::both(geometry, || Image::new(width, height, CHANNELS));
    let (surface, depth_source, layout) = geometry?;
    let mut image = image?;

    // Write all channels: in room axes if the room is known, else in camera axes.
    let to_room = perspective.map_or(glam::Mat3::IDENTITY, |p| box_room::facing_axes(p).transpose().as_mat3());
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
    let (image, depth_confidence) = (Arc::new(image), Arc::new(surface.confidence));
    Ok(Features { image, depth_confidence, depth_source, layout, surfaces, non_finite })
}
