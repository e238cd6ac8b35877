//! The 3D scene as a host describes it, before any acceleration structure is built.
//!
//! Coordinates are in metres, right-handed, with Y up. All meshes are in world space: a loader applies the transforms
//! of the nodes. Emission is in cd/m² (`factor × texture × strength`, as in glTF). Punctual lights are in candela
//! (point, spot, luminaire) or in lux (directional).

mod brightness;
pub mod camera;
mod emission;
mod fingerprint;
pub mod gltf;
pub mod light;
pub mod material;
pub mod mesh;
pub mod origin;
pub mod surface;
pub mod texture;
pub mod unrendered;
mod validate;
mod warnings;

pub use camera::Camera;
pub use light::{Environment, MAX_LIGHT, PunctualLight, c90, check_light};
pub use material::{AlphaMode, ClearCoat, Material, Specular, TextureRef};
pub use mesh::Mesh;
pub use texture::{Texture, Wrap, texel_at};
pub use unrendered::Unrendered;
pub use validate::check_place;

use crate::photometry::Luminaire;
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// A scene description. [`Scene::validate`] checks that every index into another list is in range.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The origin of all positions, in metres in the coordinates of the scene's file. An origin near the building
    /// keeps `f32` positions precise: relative to the origin of a national grid, they would be rounded to centimetres.
    pub origin: DVec3,
    pub meshes: Vec<Mesh>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub lights: Vec<PunctualLight>,
    /// Measured luminous intensity distributions; luminaires among the lights refer to them by index.
    pub distributions: Vec<Arc<Luminaire>>,
    pub environment: Option<Environment>,
    /// Index among `lights` of the sun that belongs to the sky ([`Scene::set_sun`]).
    pub sun: Option<usize>,
    pub cameras: Vec<Camera>,
    /// The features of the scene's file that the renderer does not show.
    pub unrendered: Vec<Unrendered>,
}

impl Scene {
    /// Sets the sun of the sky: its direction, along which the light travels, its illuminance per channel in lux, and
    /// half of the angle of its disc. It replaces an earlier sun in the list of lights. `None` gives an earlier sun the
    /// illuminance 0, so that the other lights keep their indices. Returns the index of the sun.
    pub fn set_sun(&mut self, sun: Option<(Vec3, Vec3, f32)>) -> Option<usize> {
        let earlier = self.sun.and_then(|index| self.lights.get_mut(index));
        match (sun, earlier) {
            (Some((direction, illuminance, half_angle)), earlier) => {
                let light = PunctualLight::Directional { direction, illuminance, half_angle };
                match earlier {
                    Some(place) => *place = light,
                    None => {
                        self.sun = Some(self.lights.len());
                        self.lights.push(light);
                    }
                }
            }
            (None, Some(PunctualLight::Directional { illuminance, .. })) => *illuminance = Vec3::ZERO,
            (None, _) => {}
        }
        self.sun
    }
}
