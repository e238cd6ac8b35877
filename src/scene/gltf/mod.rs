//! glTF 2.0 import and export: GLB, or JSON with embedded or external buffers and images.
//!
//! Specification: Khronos, glTF 2.0 (ISO/IEC 12113:2022), with `KHR_lights_punctual`, `KHR_texture_transform`,
//! `KHR_materials_emissive_strength`, `_ior`, `_transmission`, `_volume`, `_specular`, `_clearcoat` (without a normal
//! texture of its own), `_pbrSpecularGlossiness` (converted),
//! `_unlit` (read as an ordinary material), `_variants` (the default one), `KHR_mesh_quantization`,
//! `KHR_draco_mesh_compression`, `EXT_meshopt_compression`, `KHR_meshopt_compression`, `EXT_mesh_gpu_instancing`,
//! `EXT_texture_webp` and `EXT_lights_ies` (type C).
//!
//! Import: every combination of node, instance and primitive becomes one mesh in world space, named after its node.
//! Morph targets are mixed by their weights, and skins follow their joints at rest. A vertex colour that all vertices
//! share becomes part of the material.
//!
//! Not imported: animation, morph targets of colours and texture coordinates, tangents (the renderer derives them),
//! occlusion textures, points and lines, orthographic cameras, more than two sets of texture coordinates, and the
//! properties of other material extensions such as `KHR_materials_sheen`. An extension
//! not listed above is an error if the file requires it, and is ignored otherwise. [`Scene::unrendered`] lists the
//! visible features of the file that are not rendered.
//!
//! If a scene lies far from the origin, the importer subtracts [`Scene::origin`] from its positions, in f64.
//!
//! Export: a flat list of nodes, one per mesh, camera and light. The environment is left out, because glTF cannot
//! represent it.
//!
//! Files are not trusted. The crate `gltf` parses the JSON, but its own validation indexes out of bounds in places.
//! Every index, range and count is therefore checked here before use, and the memory that a small file can cause to be
//! allocated is bounded.

mod accessor;
mod container;
mod document;
#[cfg_attr(not(feature = "mesh-compression"), path = "absent/draco.rs")]
mod draco;
mod export;
mod features;
mod glossiness;
mod import;
mod instances;
mod material;
#[cfg_attr(not(feature = "mesh-compression"), path = "absent/meshopt.rs")]
mod meshopt;
mod nodes;
mod origin;
mod pose;
mod settings;
#[cfg(test)]
mod tests;
mod vertices;

pub use export::export;
pub use import::import;

use super::Scene;
use crate::error::Result;
use crate::image::io;
use std::path::Path;

/// Limits the memory of an import. An error from either method aborts the import.
pub trait Budget {
    /// Is called before the memory of a mesh or a texture is allocated. `bytes` is the size of the mesh or texture.
    fn keep(&self, bytes: u64) -> Result<()>;

    /// Runs `work`, which needs `bytes` of temporary memory until it returns.
    fn lend(&self, bytes: u64, work: &mut dyn FnMut() -> Result<()>) -> Result<()>;
}

/// A budget without limit.
const UNLIMITED: &dyn Budget = &Unlimited;

struct Unlimited;

impl Budget for Unlimited {
    fn keep(&self, _: u64) -> Result<()> {
        Ok(())
    }

    fn lend(&self, _: u64, work: &mut dyn FnMut() -> Result<()>) -> Result<()> {
        work()
    }
}

/// Settings of an import.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    pub budget: &'a dyn Budget,
    /// Length in metres of one unit of the file's coordinates, positive and finite.
    pub unit: f64,
    /// Whether the file may refer to external files outside its folder.
    pub is_open: bool,
    /// Whether positions stay relative to the file's origin even if the scene lies far from it.
    pub keep_origin: bool,
    /// Whether all luminaires shine from points, even if their files state a luminous size.
    pub point_luminaires: bool,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Self { budget: UNLIMITED, unit: 1.0, is_open: false, keep_origin: false, point_luminaires: false }
    }
}

/// Reads a `.glb` or `.gltf` file. External files are resolved relative to its folder.
pub fn load(path: &Path, options: Options) -> Result<Scene> {
    import(&io::read_file(path)?, path.parent(), options).map_err(|e| e.context(path.display()))
}
