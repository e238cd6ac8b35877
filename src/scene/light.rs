//! Lights without a surface: glTF's punctual lights and the environment around the scene.

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
}

/// Light from infinitely far away, in cd/m².
#[derive(Clone, Debug, PartialEq)]
pub enum Environment {
    Constant(Vec3),
    /// Equirectangular linear RGB: the centre of the image looks along -z, its top along +y, its right along +x.
    Image(Image),
}
