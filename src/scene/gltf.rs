//! glTF 2.0 in and out.

use super::Scene;
use crate::error::Result;
use std::path::Path;

/// Reads a `.glb` or `.gltf` file.
pub fn load(_path: &Path) -> Result<Scene> {
    todo!()
}

/// Reads a GLB or glTF file held in memory; outside files it names are looked up beside `base`.
pub fn import(_bytes: &[u8], _base: Option<&Path>) -> Result<Scene> {
    todo!()
}

/// Encodes a scene as GLB.
pub fn export(_scene: &Scene) -> Result<Vec<u8>> {
    todo!()
}
