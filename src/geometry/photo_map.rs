//! Maps from a plane of the room into a photo.

use super::{Homography, Radial};
use glam::DVec2;

/// A map from a plane into a photo: a homography into the photo that an ideal lens would take, then the distortion of
/// the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotoMap {
    pub homography: Homography,
    pub lens: Radial,
}

impl PhotoMap {
    /// Maps a point of the plane to a pixel of the photo. The result is infinite or NaN on the plane's horizon.
    pub fn apply(&self, p: DVec2) -> DVec2 {
        self.lens.shown(self.homography.apply(p))
    }
}

impl From<Homography> for PhotoMap {
    fn from(homography: Homography) -> Self {
        Self { homography, lens: Radial::NONE }
    }
}
