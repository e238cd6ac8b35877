//! Features: what segmentation knows of each pixel (Lipp et al., "Single-Exemplar Lighting Style Transfer", §4.1).

use crate::error::Result;
use crate::geometry::{Perspective, Segment};
use crate::image::Image;
use crate::job::Job;

/// Number of feature channels: L*, a*, b*, depth, x, y, z, and the normal's x, y, z.
pub const CHANNELS: usize = 10;

/// What a caller's depth map measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthKind {
    /// Distance along the viewing axis.
    AlongZ,
    /// Distance along each pixel's ray.
    AlongRay,
}

/// A depth map of the photo's size with one channel; zero, negative or non-finite values are holes.
#[derive(Clone, Copy)]
pub struct DepthMap<'a> {
    pub image: &'a Image,
    pub kind: DepthKind,
}

/// What is known of the room's geometry: the built-in depth is laid out from it.
#[derive(Clone, Copy)]
pub struct RoomView<'a> {
    pub perspective: &'a Perspective,
    /// Detected segments with the room axis each runs along (0, 1, 2), if any.
    pub segments: &'a [(Segment, Option<usize>)],
}

#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// Linear RGB, 1 = display white.
    pub photo: &'a Image,
    pub depth: Option<DepthMap<'a>>,
    pub room: Option<RoomView<'a>>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Near plane of Eq. 1, in its own units, > 0.
    pub near: f32,
    /// Far plane of Eq. 1, > near.
    pub far: f32,
}

impl Default for Params {
    fn default() -> Self {
        Self { near: 1.0, far: 10.0 }
    }
}

#[derive(Clone, Debug)]
pub struct Features {
    /// [`CHANNELS`] channels of the photo's size; finite everywhere.
    pub image: Image,
    /// Trust in the depth of each pixel, in `[0, 1]`: 1 where the caller gave it, less for the built-in layout.
    pub depth_confidence: Image,
}

/// Computes the features of a photo.
pub fn run(_input: &Input, _params: &Params, _job: Job) -> Result<Features> {
    todo!()
}
