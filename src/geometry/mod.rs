//! Geometry of the plane and of space in `f64`: homographies, the pinhole camera and its vanishing points, radial
//! distortion, polygons, lattices, small linear systems, robust statistics.
//!
//! Image points are in pixels, x right, y down, with the centre of the top-left pixel at (0.5, 0.5). Camera space is x
//! right, y down, z forward. Homogeneous points are divided by their third coordinate only where necessary, because a
//! vanishing point may be at infinity.

pub mod homography;
pub mod lattice;
pub mod linear;
pub mod perspective;
pub mod photo_map;
pub mod polygon;
pub mod radial;
pub mod robust;

pub use homography::Homography;
pub use perspective::{FocalSource, Perspective};
pub use photo_map::PhotoMap;
pub use radial::Radial;

use glam::DVec2;

/// A straight piece of an image edge, given by its end points in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    pub a: DVec2,
    pub b: DVec2,
}

impl Segment {
    pub fn length(&self) -> f64 {
        self.a.distance(self.b)
    }

    pub fn midpoint(&self) -> DVec2 {
        (self.a + self.b) / 2.0
    }
}
