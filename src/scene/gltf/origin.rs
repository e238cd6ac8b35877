//! Chooses a new origin for a scene that lies far from the origin of its file.
//!
//! On a national grid, a building may lie 10,000 km from the origin, where `f32` rounds to metres. Such a file stores
//! the vertices in `f32` relative to their nodes, and places the nodes by translations, which JSON holds in `f64`. The
//! importer therefore transforms vertices in `f64` and subtracts the new origin before it rounds them to `f32`.

use super::container::File;
use super::instances::instances;
use super::pose::node_transforms;
use crate::error::Result;
use crate::image::try_push;
use crate::scene::origin::detail;
use glam::{DMat4, DVec3};
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

/// A scene within this distance in metres of the origin of its file keeps that origin: `f32` resolves 0.015 mm there.
/// The coordinates of a new origin are multiples of this distance. [convention]
pub const GRID: f64 = 256.0;

/// The origin moves along each axis on which the scene's distance from the file's origin is at least `FAR` times the
/// scene's half-extent ([`detail`]), and at least [`GRID`]. [convention]
const FAR: f64 = 4.0;

/// Once this many corners of bounding boxes are collected, no further nodes are examined. The origin follows from the
/// median of the corners, which further corners would hardly move. [convention]
const MAX_CORNERS: usize = 1 << 16;
/// If more corners than this are collected, only every n-th one is used, so that at least this many and fewer than
/// twice as many remain. The remaining corners fit into the library's small memory reserve. [convention]
const SAMPLES: usize = 4096;

/// Returns the new origin of the scene, in metres; zero if the scene lies near the file's origin. `world` converts
/// coordinates of the file to metres.
pub fn origin(file: &File, world: DMat4) -> Result<DVec3> {
    let mut corners = Vec::new();
    for (node, transform) in file.root.nodes.iter().zip(node_transforms(file, world)?) {
        let Some((mesh, transform)) = node.mesh.and_then(|mesh| file.root.get(mesh)).zip(transform) else { continue };
        if corners.len() >= MAX_CORNERS {
            break;
        }
        // Ignore a broken list of instances here: the error is reported when the meshes are read.
        for transform in instances(file, node, transform).unwrap_or_default() {
            for [low, high] in mesh.primitives.iter().map(|primitive| bounds(file, primitive)) {
                for corner in [low, high].map(|corner| transform.transform_point3(corner)) {
                    try_push(&mut corners, corner)?;
                }
            }
        }
    }
    corners.retain(|corner| corner.is_finite());
    let sampled: Vec<DVec3> = corners.iter().step_by((corners.len() / SAMPLES).max(1)).copied().collect();
    let Some((median, half_extent)) = detail(&sampled) else { return Ok(DVec3::ZERO) };
    let is_near = median.abs().cmplt(DVec3::splat(GRID.max(FAR * half_extent)));
    Ok(DVec3::select(is_near, DVec3::ZERO, (median / GRID).round() * GRID))
}

/// Returns the lowest and the highest corner of a primitive's bounding box in the coordinates of its node, as its
/// accessor states them. Both corners are zero if the accessor states no bounds. Both are also zero for normalised
/// integers, because the accessor then states its bounds as integers instead of coordinates.
fn bounds(file: &File, primitive: &Primitive) -> [DVec3; 2] {
    let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
    let accessor = positions.and_then(|index| file.root.get(*index)).filter(|accessor| !accessor.normalized);
    let corner = |value: Option<&serde_json::Value>| {
        let coordinate = |axis: usize| value.and_then(|v| v.get(axis)?.as_f64()).unwrap_or(0.0);
        DVec3::from_array(std::array::from_fn(coordinate))
    };
    [accessor.and_then(|a| a.min.as_ref()), accessor.and_then(|a| a.max.as_ref())].map(corner)
}
