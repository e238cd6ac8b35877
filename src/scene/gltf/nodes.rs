//! Finds the root nodes of a glTF file, at which an import starts.

use super::container::{File, missing};
use crate::error::{Error, Result};
use crate::image::{try_collect, try_vec};
use gltf::json::Root;

/// Returns the root nodes: the root nodes of the default scene, else of the first scene, else all nodes without a
/// parent.
pub fn roots(file: &File) -> Result<Vec<usize>> {
    let root = &file.root;
    let number = root.scene.map_or(0, |s| s.value());
    match root.scenes.get(number) {
        Some(scene) => try_collect(scene.nodes.iter().map(|n| n.value())),
        None if root.scene.is_some() => Err(missing("scene", number, root.scenes.len())),
        None => {
            let roots = parentless(root)?;
            if roots.is_empty() && !root.nodes.is_empty() {
                return Err(Error::format("every node is the child of another: the nodes form a circle"));
            }
            Ok(roots)
        }
    }
}

/// Returns all nodes without a parent.
pub fn parentless(root: &Root) -> Result<Vec<usize>> {
    let mut is_child = try_vec(root.nodes.len(), false)?;
    for child in root.nodes.iter().flat_map(|n| n.children.iter().flatten()) {
        if let Some(flag) = is_child.get_mut(child.value()) {
            *flag = true;
        }
    }
    try_collect((0..root.nodes.len()).filter(|&i| !is_child[i]))
}
