//! Computes the transforms of nodes, and of the instances of a node's mesh (`EXT_mesh_gpu_instancing`).

use super::accessor;
use super::container::File;
use super::features::INSTANCING;
use crate::error::{Error, Result};
use crate::image::try_collect;
use glam::{DMat4, DQuat, DVec3, Vec3};
use gltf::json::{self, Index};
use serde_json::Value;

/// Returns the transform of a node relative to its parent, with the translation in f64.
pub fn local_transform(file: &File, index: usize, node: &json::Node) -> DMat4 {
    let translation = file.translations.get(index).copied().unwrap_or_default();
    if let Some(matrix) = node.matrix {
        let mut matrix = DMat4::from_cols_array(&matrix.map(f64::from));
        matrix.w_axis = translation.extend(matrix.w_axis.w);
        return matrix;
    }
    let rotation = node.rotation.unwrap_or_default().0;
    compose(translation, rotation, node.scale.unwrap_or([1.0; 3]))
}

/// Returns translation × rotation × scale. A quaternion of zeros counts as no rotation.
fn compose(translation: DVec3, rotation: [f32; 4], scale: [f32; 3]) -> DMat4 {
    let rotation = DQuat::from_array(rotation.map(f64::from));
    let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
    DMat4::from_scale_rotation_translation(Vec3::from(scale).as_dvec3(), rotation, translation)
}

/// Returns the world transforms of all instances of a node's mesh. `transform` is the node's own world transform,
/// which is the only one unless the node has `EXT_mesh_gpu_instancing`.
pub fn instances(file: &File, node: &json::Node, transform: DMat4) -> Result<Vec<DMat4>> {
    match node.extensions.as_ref().and_then(|e| e.others.get(INSTANCING)) {
        Some(stated) => read(file, stated, transform).map_err(|e| e.context(INSTANCING)),
        None => Ok(vec![transform]),
    }
}

fn read(file: &File, stated: &Value, transform: DMat4) -> Result<Vec<DMat4>> {
    let index = |name: &str| {
        let index = stated.get("attributes")?.get(name)?.as_u64()?;
        u32::try_from(index).ok().map(Index::<json::Accessor>::new)
    };
    let translations = index("TRANSLATION").map(|index| accessor::vectors::<3>(file, index)).transpose()?;
    let rotations = index("ROTATION").map(|index| accessor::vectors::<4>(file, index)).transpose()?;
    let scales = index("SCALE").map(|index| accessor::vectors::<3>(file, index)).transpose()?;
    let counts = [translations.as_ref().map(Vec::len), rotations.as_ref().map(Vec::len), scales.as_ref().map(Vec::len)];
    let Some(count) = counts.into_iter().flatten().next() else { return Ok(vec![transform]) };
    if counts.into_iter().flatten().any(|other| other != count) {
        return Err(Error::format("its attributes have different counts"));
    }
    try_collect((0..count).map(|i| {
        let translation = translations.as_ref().map_or([0.0; 3], |all| all[i]);
        let rotation = rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |all| all[i]);
        let scale = scales.as_ref().map_or([1.0; 3], |all| all[i]);
        transform * compose(Vec3::from(translation).as_dvec3(), rotation, scale)
    }))
}
