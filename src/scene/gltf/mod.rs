//! glTF 2.0 in and out: GLB or JSON with embedded or outside buffers and images.
//!
//! Specification: Khronos, glTF 2.0 (ISO/IEC 12113:2022), with `KHR_lights_punctual`, `KHR_materials_emissive_strength`,
//! `_ior`, `_transmission`, `_unlit` (read as an ordinary material), `KHR_texture_transform`, `KHR_mesh_quantization` and
//! `EXT_lights_ies` (type C).
//!
//! Read: every node × primitive becomes one mesh in world space, named after its node. Not read: animation, skins and
//! morph targets (the rest pose is taken), vertex colours, tangents (the renderer derives them), occlusion textures,
//! points and lines, orthographic cameras, more than two sets of texture coordinates, and what other extensions say of
//! materials, among them `KHR_materials_specular`, `_clearcoat`, `_sheen` and `_volume`. A required extension that is not in the
//! list is an error; an optional one is passed over.
//!
//! Written: a flat list of nodes, one per mesh, camera and light. glTF cannot hold the environment; it is left out.
//!
//! A file is not trusted: the crate `gltf` parses the JSON, but its checks index without bounds in places, so that every
//! index, range and count is checked here before it is used. What a small file can make this allocate is bounded.

mod accessor;
mod container;
mod export;
mod import;
mod material;
#[cfg(test)]
mod tests;

pub use export::export;
pub use import::import;

use super::Scene;
use crate::error::Result;
use crate::image::io;
use std::path::Path;

/// Asked for the bytes of each mesh and texture before they are made; an error ends the reading.
pub type Budget<'a> = &'a dyn Fn(u64) -> Result<()>;

/// Takes what a file needs.
pub const UNLIMITED: Budget<'static> = &|_| Ok(());

/// Reads a `.glb` or `.gltf` file; outside files it names are looked up in its folder and below.
pub fn load(path: &Path, budget: Budget) -> Result<Scene> {
    import(&io::read_file(path)?, path.parent(), budget).map_err(|e| e.within(path.display()))
}
