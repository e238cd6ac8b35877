//! The 3D scene as described by a host, before any acceleration structure is built.
//!
//! Metres, right-handed, Y up. All meshes are in world space: a loader applies the node transforms. Emission is in
//! cd/m² (`factor × texture × strength`, as in glTF), punctual lights in candela (point, spot, luminaire) or lux
//! (directional).

pub mod accel;
mod brightness;
pub mod camera;
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
pub use material::{AlphaMode, Material, TextureRef};
pub use mesh::Mesh;
pub use texture::{Texture, Wrap, texel_at};
pub use unrendered::Unrendered;
pub use validate::check_place;

use crate::photometry::Luminaire;
use glam::DVec3;
use std::sync::Arc;

/// A scene description. [`Scene::validate`] checks the indices between the lists.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The origin of all positions, in the coordinates of the scene's file and in metres. Without it, f32 positions of
    /// a building on a national grid would be rounded to centimetres.
    pub origin: DVec3,
    pub meshes: Vec<Mesh>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub lights: Vec<PunctualLight>,
    /// Measured intensity distributions, referenced by the luminaires among the lights.
    pub distributions: Vec<Arc<Luminaire>>,
    pub environment: Option<Environment>,
    pub cameras: Vec<Camera>,
    /// The parts of the scene's file that are not shown.
    pub unrendered: Vec<Unrendered>,
}
