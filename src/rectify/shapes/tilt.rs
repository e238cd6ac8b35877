//! The tilt of a plane towards the camera.

use glam::{DMat2, DVec2, DVec3};

/// A tilt is rejected if the sine of the angle between the plane and the ray through the centre of a lamp is
/// below this. [bench photos:tune]
const MIN_INCIDENCE: f64 = 0.05;

/// The normal of a plane, which points away from the camera, and the focal length in pixels.
#[derive(Clone, Copy, Debug)]
pub struct Tilt {
    pub normal: DVec3,
    pub focal: f64,
}

impl Tilt {
    /// Projects a pixel, given relative to the principal point, onto the plane at distance 1 from the camera. Returns
    /// the point in coordinates of the plane, and the derivative of these coordinates by the pixel. `None` if the ray
    /// misses the plane or meets it at too small an angle.
    pub fn project(&self, pixel: DVec2) -> Option<(DVec2, DMat2)> {
        let ray = (pixel / self.focal).extend(1.0);
        let depth = self.normal.dot(ray);
        if !(depth >= MIN_INCIDENCE * ray.length()) {
            return None;
        }
        let (right, down) = self.normal.any_orthonormal_pair();
        let on_plane = |v: DVec3| DVec2::new(right.dot(v), down.dot(v));
        let derivative = |axis: DVec3| on_plane((axis - ray * (self.normal.dot(axis) / depth)) / (depth * self.focal));
        Some((on_plane(ray / depth), DMat2::from_cols(derivative(DVec3::X), derivative(DVec3::Y))))
    }
}
