//! Punctual lights (glTF), measured luminaires, and the environment light.

use crate::error::{Error, Result};
use crate::image::Image;
use glam::Vec3;

/// Largest luminance in cd/m², intensity in cd and illuminance in lux of any light, per channel. Squares of it, and of
/// its multiples in pixels near a lamp, stay within the range of `f32`. The sun's disc has 1.6e9 cd/m².
// [rounding]
pub const MAX_LIGHT: f32 = 1e15;

/// Checks that each channel of a light lies in [0, [`MAX_LIGHT`]].
pub fn check_light(what: &str, light: Vec3) -> Result<()> {
    // NaN compares false and is refused.
    if light.cmpge(Vec3::ZERO).all() && light.cmple(Vec3::splat(MAX_LIGHT)).all() {
        return Ok(());
    }
    let [red, green, blue] = light.to_array();
    Err(Error::argument(format!(
        "{what} is ({red:e}, {green:e}, {blue:e}); each channel must lie in [0, {MAX_LIGHT:e}]"
    )))
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PunctualLight {
    /// Isotropic luminous intensity per channel in cd.
    Point { position: Vec3, intensity: Vec3 },
    /// Luminous intensity on the axis in cd; falls off between the inner and outer cone angles (radians) as glTF
    /// prescribes.
    Spot { position: Vec3, direction: Vec3, intensity: Vec3, inner_angle: f32, outer_angle: f32 },
    /// Illuminance per channel in lux on a surface perpendicular to the light, which travels along `direction`.
    Directional { direction: Vec3, illuminance: Vec3 },
    /// A measured luminaire in the far field, so small that it acts as a point at the distance of the lit surfaces.
    /// `axis` is the direction of γ = 0 (down for a hanging luminaire); `c0` is the direction of C = 0, perpendicular
    /// to it. C increases anticlockwise as seen against the axis, from above. Both are unit vectors. Each channel is
    /// `colour` times the intensity of one of the scene's distributions.
    Luminaire { position: Vec3, axis: Vec3, c0: Vec3, colour: Vec3, distribution: usize },
}

/// The direction with C = 90° and γ = 90°.
pub fn c90(axis: Vec3, c0: Vec3) -> Vec3 {
    c0.cross(axis)
}

/// Light from infinitely far away, in cd/m².
#[derive(Clone, Debug, PartialEq)]
pub enum Environment {
    Constant(Vec3),
    /// Equirectangular linear RGB: the image centre is the direction -z, its top +y, its right +x.
    Image(Image),
}
