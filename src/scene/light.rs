//! Punctual lights (glTF), measured luminaires, and the environment light.

use crate::error::{Error, Result};
use crate::image::Image;
use crate::photometry::Luminaire;
use crate::photometry::opening::Opening;
use glam::Vec3;
use std::sync::Arc;

/// Largest luminance in cd/m², intensity in cd and illuminance in lux of any light, per channel. A pixel near a lamp
/// may reach a multiple of this value. The square of the pixel does not overflow `f32` (3.4e38) as long as the multiple
/// is below 18,000. For comparison, the sun's disc has 1.6e9 cd/m².
// [rounding]
pub const MAX_LIGHT: f32 = 1e15;

/// Checks that each channel of `light` lies in [0, [`MAX_LIGHT`]]; `what` names the light in the error.
pub fn check_light(what: &str, light: Vec3) -> Result<()> {
    // Comparisons with NaN are false, so NaN is refused.
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
    /// `intensity` is the luminous intensity per channel on the axis, in cd. Up to `inner_angle` from the axis, the
    /// intensity stays the same. From there it falls to 0 at `outer_angle`, as glTF prescribes. Both angles are in
    /// radians, from the axis to the side of a cone.
    Spot { position: Vec3, direction: Vec3, intensity: Vec3, inner_angle: f32, outer_angle: f32 },
    /// A light infinitely far away. `illuminance` per channel in lux is that of a surface perpendicular to `direction`,
    /// along which the light travels. The light is a uniform disc, such as the sun's, which is seen under the angle
    /// 2 `half_angle` in radians, in `[0, π / 4]` for `half_angle`. At 0 its rays are parallel, and neither the eye nor
    /// mirrors see it.
    Directional { direction: Vec3, illuminance: Vec3, half_angle: f32 },
    /// A measured luminaire. It shines from the faces of its luminous opening ([`PunctualLight::opening`]), whose
    /// centre is `position`. Without an opening, it shines from the point `position`.
    ///
    /// - `axis` is the unit direction of γ = 0, which points down for a hanging luminaire.
    /// - `c0` is the unit direction of C = 0, perpendicular to `axis`. C increases anticlockwise as seen by a viewer
    ///   who looks along `axis`, that is, from above for a hanging luminaire.
    /// - The intensity in cd is the product of `colour` and the value of the measured distribution. `distribution` is
    ///   the index of this distribution in the scene.
    /// - If `is_point` is true, the luminaire shines from its position even if it has an opening. This assumes that the
    ///   lit surfaces are far away compared with its size.
    Luminaire { position: Vec3, axis: Vec3, c0: Vec3, colour: Vec3, distribution: usize, is_point: bool },
}

impl PunctualLight {
    /// Returns a directional light with parallel rays.
    pub fn parallel(direction: Vec3, illuminance: Vec3) -> Self {
        Self::Directional { direction, illuminance, half_angle: 0.0 }
    }

    /// Returns the luminous opening from whose faces the light shines; `None` if it shines from a point or from far
    /// away.
    pub fn opening(&self, distributions: &[Arc<Luminaire>]) -> Option<Opening> {
        match *self {
            Self::Luminaire { distribution, is_point: false, .. } => distributions.get(distribution)?.opening(),
            _ => None,
        }
    }
}

/// Returns the direction with C = 90° and γ = 90° of a luminaire.
pub fn c90(axis: Vec3, c0: Vec3) -> Vec3 {
    c0.cross(axis)
}

/// Light from infinitely far away, with its luminance in cd/m².
#[derive(Clone, Debug, PartialEq)]
pub enum Environment {
    Constant(Vec3),
    /// Equirectangular linear RGB. The image centre shows the direction -z, and the top row shows +y. To the right of
    /// the centre, the directions turn towards +x.
    Image(Image),
}
