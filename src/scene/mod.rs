//! The 3D scene: what a host describes, before anything is built for rendering.
//!
//! Metres, right-handed, Y up. All meshes are in world space: a loader applies its node transforms. Emission is in
//! cd/m² (`factor × texture × strength`, as glTF has it), punctual lights in candela (point, spot, luminaire) and lux (directional).

pub mod accel;
pub mod camera;
mod fingerprint;
pub mod gltf;
pub mod light;
pub mod material;
pub mod mesh;
pub mod surface;
pub mod texture;
mod validate;

pub use camera::Camera;
pub use light::{Environment, PunctualLight, c90};
pub use material::{AlphaMode, Material, TextureRef};
pub use mesh::Mesh;
pub use texture::{Texture, Wrap, texel_at};
pub use validate::check_place;

use crate::photometry::Luminaire;
use std::sync::Arc;

/// Everything a host can describe. Indices between the lists are checked by [`Scene::validate`].
#[derive(Clone, Debug, Default)]
pub struct Scene {
    pub meshes: Vec<Mesh>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub lights: Vec<PunctualLight>,
    /// Measured intensities, for the luminaires among the lights.
    pub distributions: Vec<Arc<Luminaire>>,
    pub environment: Option<Environment>,
    pub cameras: Vec<Camera>,
}
