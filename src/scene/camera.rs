//! The pinhole camera from which a scene is rendered.

use crate::maths;
use glam::Vec3;

/// A pinhole camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    pub name: String,
    pub position: Vec3,
    /// Unit viewing direction.
    pub forward: Vec3,
    /// Unit vector orthogonal to `forward` that points up in the image.
    pub up: Vec3,
    /// Full vertical angle of view in radians, in (0, π).
    pub fov_y: f32,
}

impl Camera {
    /// A camera at `position` that looks at `target`, rolled so that the world's +y points up in the image. If it looks
    /// along the y axis, +x points right in the image. If `target` equals `position`, it looks along -z.
    pub fn look_at(position: Vec3, target: Vec3, fov_y: f32) -> Self {
        let forward = (target - position).normalize_or(Vec3::NEG_Z);
        let side = forward.cross(Vec3::Y).try_normalize().unwrap_or(Vec3::X);
        Self { name: String::new(), position, forward, up: side.cross(forward), fov_y }
    }

    /// Returns the unnormalised ray direction through a point of the image. `x` and `y` lie in `[0, 1]` from the
    /// top-left corner; `aspect` is width over height.
    pub fn direction(&self, x: f32, y: f32, aspect: f32) -> Vec3 {
        let half = maths::tan(self.fov_y / 2.0);
        let right = self.forward.cross(self.up);
        self.forward + right * ((2.0 * x - 1.0) * half * aspect) + self.up * ((1.0 - 2.0 * y) * half)
    }

    /// The inverse of [`Camera::direction`]: returns the image position (x, y) to which a direction projects, and the
    /// component of the direction along `forward`. Returns `None` unless this component is positive.
    pub fn project(&self, direction: Vec3, aspect: f32) -> Option<([f32; 2], f32)> {
        let half = maths::tan(self.fov_y / 2.0);
        let depth = direction.dot(self.forward);
        let x = direction.dot(self.forward.cross(self.up)) / (depth * half * aspect);
        let y = direction.dot(self.up) / (depth * half);
        (depth > 0.0).then_some(([(1.0 + x) / 2.0, (1.0 - y) / 2.0], depth))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_projection_inverts_the_direction() {
        let camera = Camera::look_at(Vec3::new(1.0, 2.0, 3.0), Vec3::new(-0.5, 0.2, 0.1), 0.7);
        for [x, y] in [[0.0, 0.0], [0.5, 0.5], [0.9, 0.2], [1.3, -0.4]] {
            let ([u, v], depth) = camera.project(camera.direction(x, y, 1.6) * 2.5, 1.6).unwrap();
            assert!((u - x).abs() < 1e-5 && (v - y).abs() < 1e-5 && (depth - 2.5).abs() < 1e-5, "{x} {y}: {u} {v}");
        }
        assert_eq!(camera.project(-camera.forward, 1.6), None);
    }
}
