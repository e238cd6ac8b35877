//! A directional light as a uniform disc infinitely far away, such as the sun's.
//!
//! Let α be half of the angle under which the disc is seen. A disc of luminance L lights a surface that faces its
//! centre with the illuminance E = π sin²α L. Light samples are uniform on the unit disc that the visible disc becomes
//! when it is projected onto this surface (Malley's method, restricted to sin α), so that the illuminance of this
//! surface has no variance. Their solid-angle pdf is cos ψ / (π sin²α), with the angle ψ to the centre; L / pdf is E /
//! cos ψ.

use crate::maths;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// A disc infinitely far away. A disc of angle 0 is a point with parallel rays.
pub struct Disc {
    /// Unit direction to the centre of the disc.
    towards: Vec3,
    /// Two unit vectors perpendicular to `towards` and to each other.
    side: Vec3,
    up: Vec3,
    /// Illuminance per channel in lux of a surface that faces the centre of the disc.
    pub illuminance: Vec3,
    /// Sine of half of the disc's angle.
    sine: f32,
}

impl Disc {
    /// Prepares a disc; `half_angle` in `[0, π / 4]` radians is half of the angle under which it is seen.
    pub fn new(towards: Vec3, illuminance: Vec3, half_angle: f32) -> Self {
        let (side, up) = if towards == Vec3::ZERO { (Vec3::X, Vec3::Y) } else { towards.any_orthonormal_pair() };
        Self { towards, side, up, illuminance, sine: maths::sin(half_angle) }
    }

    /// Samples a direction to the disc from two uniform random numbers. Also returns the cosine of the angle between
    /// this direction and the centre of the disc: the illuminance divided by it is the estimate of one sample.
    #[inline]
    pub fn sample(&self, (u, v): (f64, f32)) -> (Vec3, f32) {
        if self.sine == 0.0 {
            return (self.towards, 1.0);
        }
        let radius = self.sine * (u as f32).sqrt();
        let (y, x) = maths::sin_cos(TAU * v);
        let cosine = (1.0 - radius * radius).sqrt();
        ((self.towards * cosine + (self.side * x + self.up * y) * radius).normalize(), cosine)
    }

    /// Whether the disc has a size, so that it is seen directly and in mirrors.
    pub fn is_visible(&self) -> bool {
        self.sine > 0.0
    }

    /// Whether a unit direction meets the disc.
    pub fn contains(&self, direction: Vec3) -> bool {
        // The length of the cross product is the sine of the angle. For small discs it is precise, unlike the cosine.
        direction.dot(self.towards) > 0.0 && direction.cross(self.towards).length_squared() <= self.sine * self.sine
    }

    /// Returns the luminance in cd/m² per lux of illuminance.
    pub fn luminance_factor(&self) -> f32 {
        1.0 / (PI * self.sine * self.sine)
    }
}
