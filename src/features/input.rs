//! The inputs and the settings of the features.

use super::box_room::Layout;
use crate::error::{Result, check_range};
use crate::geometry::{Perspective, Segment};
use crate::image::Image;

/// Number of feature channels: L*, a*, b*, depth, x, y, z, and the normal's x, y, z.
pub const CHANNELS: usize = 10;
/// The first channel of the position (`POSITION`), and the first of the normal (`NORMAL`).
pub const POSITION: usize = 4;
pub const NORMAL: usize = 7;

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

/// Known geometry of the room, from which the built-in depth is computed.
#[derive(Clone, Copy)]
pub struct RoomView<'a> {
    pub perspective: &'a Perspective,
    /// Detected segments, each with the index (0, 1, 2) of the room axis it runs along, if any.
    pub segments: &'a [(Segment, Option<usize>)],
    /// The user's strokes: positive ones lie on a single plane of the room (any plane), the others on other surfaces.
    pub strokes: &'a [PlaneStroke<'a>],
    /// The box of the room if it is known. If `None`, a box is fitted to the segments and the strokes.
    pub layout: Option<Layout>,
}

/// A user's stroke as evidence about the room.
#[derive(Clone, Copy)]
pub struct PlaneStroke<'a> {
    /// Pixel indices `y * width + x`; indices outside the photo are ignored.
    pub pixels: &'a [u32],
    /// True if the stroke lies on the plane, false if it lies on another surface.
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
    /// Normals come from planes fitted in a square window around each pixel; this is half the width of the window in
    /// pixels, in `[1, 64]`. 0 selects 1 % of the photo's width, at least 2 pixels and at most 64. Wider windows
    /// suppress more noise and smooth away more small detail.
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
    /// The box room of [`Features::layout`](super::Features::layout).
    Layout,
    /// The prior that uses no information from the photo.
    Neutral,
}
