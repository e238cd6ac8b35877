//! The camera of a photo: focal length, principal point, radial distortion, and the three room axes in camera space.

use super::Radial;
use glam::{DMat3, DVec2, DVec3};

/// Where the value of a focal length comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FocalSource {
    /// The caller gave it.
    Given,
    /// It comes mainly from finite vanishing points of orthogonal directions, which are more accurate than the prior.
    VanishingPoints,
    /// It comes mainly from the usual focal length, 0.85 of the image width: the photo has no metadata, and the
    /// vanishing points are less accurate.
    Assumed,
    /// It comes mainly from the photo's metadata, because the vanishing points are less accurate.
    Metadata,
    /// It follows from the images of lamps on a plane, on the assumption that all these lamps have the same shape.
    Lamps,
}

/// Column indices of the room axes in [`Perspective::axes`]: two horizontal axes and the vertical.
pub const HORIZONTAL_A: usize = 0;
pub const VERTICAL: usize = 1;
pub const HORIZONTAL_B: usize = 2;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perspective {
    /// Focal length in pixels, equal in x and y.
    pub focal: f64,
    pub focal_source: FocalSource,
    /// Principal point in pixels.
    pub principal: DVec2,
    /// Radial distortion about the principal point, see [`Radial::bend`]; 0 for an ideal lens. Focal length and
    /// vanishing points refer to the photo that an ideal lens would take.
    pub bend: f64,
    /// Room axes as unit columns in camera space (x right, y down, z forward), orthogonal and right-handed. Column 1
    /// is the room's vertical and points down. Column 2 is the horizontal axis closest to the viewing direction.
    pub axes: DMat3,
}

impl Perspective {
    /// Returns the direction in camera space through a pixel of the photo, scaled to z = 1.
    pub fn ray(&self, pixel: DVec2) -> DVec3 {
        ((self.lens().ideal(pixel) - self.principal) / self.focal).extend(1.0)
    }

    /// Returns the distortion of the lens.
    pub fn lens(&self) -> Radial {
        Radial { centre: self.principal, bend: self.bend }
    }

    /// Returns the matrix `K` from camera space to homogeneous pixels of the photo that an ideal lens would take.
    pub fn intrinsics(&self) -> DMat3 {
        DMat3::from_cols(DVec3::new(self.focal, 0.0, 0.0), DVec3::new(0.0, self.focal, 0.0), self.principal.extend(1.0))
    }

    /// Returns the vanishing point of a room axis, in homogeneous pixels of the photo that an ideal lens would
    /// take.
    pub fn vanishing_point(&self, axis: usize) -> DVec3 {
        self.intrinsics() * self.axes.col(axis)
    }
}
