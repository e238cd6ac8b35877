//! Lights without a surface: glTF's punctual lights, luminaires that were measured, and the environment around the scene.

use crate::image::Image;
use glam::Vec3;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PunctualLight {
    /// Luminous intensity per channel in cd, the same in every direction.
    Point { position: Vec3, intensity: Vec3 },
    /// Luminous intensity on the axis in cd; falls from the inner to the outer cone angle (radians) as glTF prescribes.
    Spot { position: Vec3, direction: Vec3, intensity: Vec3, inner_angle: f32, outer_angle: f32 },
    /// Illuminance per channel in lux on a surface that faces the light; `direction` is where the light travels.
    Directional { direction: Vec3, illuminance: Vec3 },
    /// A luminaire that was measured, small beside how far it is from what it lights. `axis` is where its γ is 0: down, for
    /// one that hangs; `c0` is where C is 0, at right angles to it. C grows anticlockwise as seen against the axis, from
    /// above. Both are unit vectors. Each channel is `colour` times the intensity of a distribution of the scene.
    Luminaire { position: Vec3, axis: Vec3, c0: Vec3, colour: Vec3, distribution: usize },
}

/// The direction where C is 90° and γ is 90°.
pub fn c90(axis: Vec3, c0: Vec3) -> Vec3 {
    c0.cross(axis)
}

/// Light from infinitely far away, in cd/m².
#[derive(Clone, Debug, PartialEq)]
pub enum Environment {
    Constant(Vec3),
    /// Equirectangular linear RGB: the centre of the image looks along -z, its top along +y, its right along +x.
    Image(Image),
}
