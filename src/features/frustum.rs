//! Eq. 1 of the paper: from a pixel and its screen depth to a point in space, `p_w = P⁻¹ p_s`.
//!
//! `P(t, b, l, r, f, n)` is the standard projection matrix. Its screen depth is affine in *inverse* depth: with
//! `d_s = 0` on the near plane and 1 on the far plane (normalised device depth `2 d_s - 1`),
//! `1/z = 1/n + d_s (1/f - 1/n)`. Hence the inverse depth from a network such as MiDaS, normalised to `[0, 1]`, equals
//! `1 - d_s`, and points beyond the far plane stay finite: `d_s` tends to `f / (f - n)` as z grows.

use crate::error::{Error, Result};
use crate::geometry::{Perspective, Radial};
use glam::{DVec2, Vec2, Vec3};

/// A view frustum in camera space (x right, y down, z forward). `left`, `right`, `top` and `bottom` are bounds on the
/// near plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    pub left: f32,
    pub right: f32,
    pub top: f32,
    pub bottom: f32,
    pub near: f32,
    pub far: f32,
    /// Distortion of the lens; the bounds hold for an ideal lens.
    pub lens: Radial,
}

impl Frustum {
    /// The paper's choice: bounds ±1 for any aspect ratio of the photo. The y axis points down here, so the top is -1.
    pub fn paper(near: f32, far: f32) -> Self {
        Self { left: -1.0, right: 1.0, top: -1.0, bottom: 1.0, near, far, lens: Radial::NONE }
    }

    /// The frustum of a real camera: its corner rays pass through the corners of the photo that an ideal lens would
    /// take.
    pub fn of_camera(camera: &Perspective, width: usize, height: usize, near: f32, far: f32) -> Result<Self> {
        let ideal = Perspective { bend: 0.0, ..*camera };
        let corner = |x: usize, y: usize| ideal.ray(DVec2::new(x as f64, y as f64)).as_vec3() * near;
        let (low, high) = (corner(0, 0), corner(width, height));
        let frustum = Self { left: low.x, right: high.x, top: low.y, bottom: high.y, near, far, lens: camera.lens() };
        if camera.focal > 0.0 && camera.focal.is_finite() && low.is_finite() && high.is_finite() {
            return Ok(frustum);
        }
        Err(Error::argument(format!(
            "room.perspective has focal length {} px and principal point {}; both must be finite and \
             the focal length > 0",
            camera.focal, camera.principal
        )))
    }

    /// Normalised device coordinates of a pixel's centre: -1 at the left and top border, 1 at the right and bottom. If
    /// the lens has distortion, they are the coordinates of the point at which an ideal lens would show what the pixel
    /// shows.
    pub fn ndc(&self, x: usize, y: usize, width: usize, height: usize) -> Vec2 {
        if !self.lens.is_none() {
            let ideal = self.lens.ideal(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
            return (2.0 * ideal / DVec2::new(width as f64, height as f64) - 1.0).as_vec2();
        }
        Vec2::new((2 * x + 1) as f32 / width as f32 - 1.0, (2 * y + 1) as f32 / height as f32 - 1.0)
    }

    /// Returns the direction through normalised device coordinates, scaled to z = 1.
    pub fn ray(&self, ndc: Vec2) -> Vec3 {
        let x = self.left + (self.right - self.left) * (ndc.x + 1.0) / 2.0;
        let y = self.top + (self.bottom - self.top) * (ndc.y + 1.0) / 2.0;
        Vec3::new(x / self.near, y / self.near, 1.0)
    }

    /// Returns the screen depth of a point with inverse depth `1/z`.
    pub fn screen_depth(&self, inverse_depth: f32) -> f32 {
        (1.0 / self.near - inverse_depth) / (1.0 / self.near - 1.0 / self.far)
    }

    /// Eq. 1: maps `(x, y)` in normalised device coordinates and the screen depth to camera space.
    pub fn unproject(&self, screen: Vec3) -> Vec3 {
        let inverse_depth = 1.0 / self.near + screen.z * (1.0 / self.far - 1.0 / self.near);
        self.ray(screen.truncate()) / inverse_depth
    }

    /// The forward map of Eq. 1, `p_s = P p_w` after the perspective division; requires `z > 0`.
    pub fn project(&self, point: Vec3) -> Vec3 {
        let on_near = point.truncate() * (self.near / point.z);
        let x = 2.0 * (on_near.x - self.left) / (self.right - self.left) - 1.0;
        let y = 2.0 * (on_near.y - self.top) / (self.bottom - self.top) - 1.0;
        Vec3::new(x, y, self.screen_depth(1.0 / point.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::FocalSource;
    use glam::{DMat3, DVec3, Mat4, Vec4};

    /// The standard matrix (OpenGL `glFrustum`, y up and looking along -z), inverted, yields the same points.
    #[test]
    fn equation_1_is_the_inverse_of_the_common_projection_matrix() {
        let (n, f) = (1.0, 10.0);
        let p = Mat4::from_cols(
            Vec4::new(n, 0.0, 0.0, 0.0),
            Vec4::new(0.0, n, 0.0, 0.0),
            Vec4::new(0.0, 0.0, -(f + n) / (f - n), -1.0),
            Vec4::new(0.0, 0.0, -2.0 * f * n / (f - n), 0.0),
        );
        let frustum = Frustum::paper(n, f);
        for screen in [Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.3, -0.7, 0.4), Vec3::new(-1.0, 1.0, 1.0)] {
            let world = p.inverse() * Vec4::new(screen.x, -screen.y, 2.0 * screen.z - 1.0, 1.0);
            let expected = (world / world.w).truncate() * Vec3::new(1.0, -1.0, -1.0);
            assert!((frustum.unproject(screen) - expected).length() < 1e-4 * expected.length(), "{screen}");
        }
    }

    #[test]
    fn projecting_and_unprojecting_is_the_identity() {
        let frustum =
            Frustum { left: -0.7, right: 0.6, top: -0.4, bottom: 0.9, near: 0.5, far: 20.0, lens: Radial::NONE };
        for point in [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-4.0, 0.1, 0.5), Vec3::new(30.0, -20.0, 80.0)] {
            let back = frustum.unproject(frustum.project(point));
            assert!((back - point).length() < 1e-4 * point.length(), "{point} {back}");
        }
        assert!((frustum.screen_depth(1.0 / 0.5)).abs() < 1e-6);
        assert!((frustum.screen_depth(1.0 / 20.0) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_cameras_frustum_has_its_rays() {
        let camera = Perspective {
            focal: 500.0,
            focal_source: FocalSource::Given,
            principal: DVec2::new(310.0, 260.0),
            bend: 0.0,
            axes: DMat3::IDENTITY,
        };
        let frustum = Frustum::of_camera(&camera, 640, 480, 1.0, 10.0).unwrap();
        let ray = frustum.ray(frustum.ndc(17, 400, 640, 480)).as_dvec3();
        let expected: DVec3 = camera.ray(DVec2::new(17.5, 400.5));
        assert!((ray - expected).length() < 1e-6);
        // With a lens, too: the pixel's coordinates then refer to an ideal lens.
        let bent = Perspective { bend: -0.05 / (320.0f64 * 320.0 + 240.0 * 240.0), ..camera };
        let frustum = Frustum::of_camera(&bent, 640, 480, 1.0, 10.0).unwrap();
        let ray = frustum.ray(frustum.ndc(17, 400, 640, 480)).as_dvec3();
        assert!((ray - bent.ray(DVec2::new(17.5, 400.5))).length() < 1e-6 && (ray - expected).length() > 1e-3);
        assert!(Frustum::of_camera(&Perspective { focal: 0.0, ..camera }, 640, 480, 1.0, 10.0).is_err());
        assert!(Frustum::of_camera(&Perspective { focal: f64::NAN, ..camera }, 640, 480, 1.0, 10.0).is_err());
    }
}
