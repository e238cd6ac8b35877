//! Poses meshes at rest: mixes shapes from morph targets, and deforms skins by their joints, whose poses come from the
//! nodes of the file (glTF 2.0, sections 3.7.2.2 and 3.7.3).

use super::container::{File, missing};
use super::instances::local_transform;
use super::vertices::Vertices;
use super::{accessor, nodes};
use crate::error::{Error, Result};
use crate::image::{try_collect, try_vec, try_with_capacity};
use glam::{DMat4, Vec3};
use gltf::json::mesh::{MorphTarget, Primitive, Semantic};
use gltf::json::skin::Skin;
use gltf::json::{Accessor, Index};

/// Maximum number of attribute sets with joints per vertex: JOINTS_0 to JOINTS_3, four joints each.
const MAX_SETS: u32 = 4;

/// Returns the world transform of each node; `None` for a node in or below a cycle of nodes.
pub fn node_transforms(file: &File, world: DMat4) -> Result<Vec<Option<DMat4>>> {
    let all = &file.root.nodes;
    let mut placed = try_vec(all.len(), None)?;
    let mut stack = try_collect(nodes::parentless(&file.root)?.into_iter().map(|top| (top, world)))?;
    while let Some((index, parent)) = stack.pop() {
        let Some(node) = all.get(index) else { continue };
        if placed[index].is_none() {
            let transform = parent * local_transform(file, index, node);
            placed[index] = Some(transform);
            stack.extend(node.children.iter().flatten().map(|child| (child.value(), transform)));
        }
    }
    Ok(placed)
}

/// The skinning of a primitive: the transforms of the joints, and each vertex's joints with their weights.
pub struct Skinning {
    /// For each joint, the transform from the space of the mesh in the bind pose to world space.
    joints: Vec<DMat4>,
    /// The attribute sets: for each vertex, the indices of four joints and their weights.
    sets: Vec<(Vec<[f32; 4]>, Vec<[f32; 4]>)>,
}

impl Skinning {
    /// Reads the joints and weights of `count` vertices; `None` if the primitive has no joints.
    pub fn read(
        file: &File,
        vertices: &Vertices,
        skin: Index<Skin>,
        nodes: &[Option<DMat4>],
        count: usize,
    ) -> Result<Option<Self>> {
        let mut sets = Vec::new();
        for set in 0..MAX_SETS {
            let joints = vertices.checked(&Semantic::Joints(set), count)?;
            let weights = vertices.checked(&Semantic::Weights(set), count)?;
            let (Some(joints), Some(weights)) = (joints, weights) else { break };
            sets.push((joints, weights));
        }
        if sets.is_empty() {
            return Ok(None);
        }
        let joints = joints(file, skin, nodes).map_err(|e| e.context(format_args!("skin {}", skin.value())))?;
        let skinning = Self { joints, sets };
        for vertex in 0..count {
            skinning.check(vertex)?;
        }
        Ok(Some(skinning))
    }

    /// Iterates over the joints that move a vertex (joints whose weight is not 0), each with its weight.
    fn influences(&self, vertex: usize) -> impl Iterator<Item = (usize, f64)> {
        let set = move |(joints, weights): &(Vec<[f32; 4]>, Vec<[f32; 4]>)| {
            let (joints, weights) = (joints[vertex], weights[vertex]);
            (0..4).map(move |i| (joints[i] as usize, f64::from(weights[i])))
        };
        self.sets.iter().flat_map(set).filter(|influence| influence.1 != 0.0)
    }

    fn check(&self, vertex: usize) -> Result<()> {
        match self.influences(vertex).find(|&(joint, _)| joint >= self.joints.len()) {
            Some((joint, _)) => Err(missing("joint", joint, self.joints.len())),
            None => Ok(()),
        }
    }

    /// Whether the joints mirror the majority of the `count` vertices.
    pub fn is_mirrored(&self, count: usize) -> bool {
        let is_possible = self.joints.iter().any(|joint| joint.determinant() < 0.0);
        is_possible && (0..count).map(|i| self.transform(i).determinant().signum()).sum::<f64>() < 0.0
    }

    /// Returns the transform of a vertex: the mean of its joints' transforms, weighted by the weights of the joints.
    /// If all weights are 0, it is the transform of the vertex's first joint.
    pub fn transform(&self, vertex: usize) -> DMat4 {
        let (mut sum, mut total) = (DMat4::ZERO, 0.0);
        for (joint, weight) in self.influences(vertex) {
            sum += self.joints[joint] * weight;
            total += weight;
        }
        if total != 0.0 {
            return sum * (1.0 / total);
        }
        let first = self.sets[0].0[vertex][0] as usize;
        self.joints.get(first).copied().unwrap_or(DMat4::IDENTITY)
    }
}

/// Returns for each joint of a skin its world transform times its inverse bind matrix (the identity if the skin has no
/// inverse bind matrices).
fn joints(file: &File, skin: Index<Skin>, nodes: &[Option<DMat4>]) -> Result<Vec<DMat4>> {
    let root = &file.root;
    let skin = root.get(skin).ok_or_else(|| missing("skin", skin.value(), root.skins.len()))?;
    let inverse = skin.inverse_bind_matrices.map(|index| accessor::vectors::<16>(file, index)).transpose()?;
    if let Some(inverse) = inverse.as_ref().filter(|inverse| inverse.len() < skin.joints.len()) {
        let message = format!("it has {} joints, but {} inverse bind matrices", skin.joints.len(), inverse.len());
        return Err(Error::format(message));
    }
    let mut out = try_with_capacity(skin.joints.len())?;
    for (i, joint) in skin.joints.iter().enumerate() {
        let at = joint.value();
        let node = nodes.get(at).ok_or_else(|| missing("node", at, nodes.len()))?;
        let node = node.ok_or_else(|| Error::format(format!("its joint, node {at}, is its own ancestor")))?;
        let bind = inverse.as_ref().map_or(DMat4::IDENTITY, |all| DMat4::from_cols_array(&all[i].map(f64::from)));
        let transform = node * bind;
        if !transform.is_finite() {
            return Err(Error::format(format!("its joint, node {at}, has a transform that is not finite")));
        }
        out.push(transform);
    }
    Ok(out)
}

/// Iterates over the morph targets of a primitive, each with its weight; targets with a weight of 0 are skipped.
pub fn mixed<'a>(primitive: &'a Primitive, weights: &'a [f32]) -> impl Iterator<Item = (&'a MorphTarget, f32)> + Clone {
    let targets = primitive.targets.iter().flatten();
    targets.zip(weights.iter().copied()).filter(|(_, weight)| *weight != 0.0)
}

/// Adds the weighted displacements of morph targets to the values of one vertex attribute.
pub fn mix<'a>(
    file: &File,
    targets: impl Iterator<Item = (&'a MorphTarget, f32)>,
    attribute: impl Fn(&MorphTarget) -> Option<Index<Accessor>>,
    values: &mut [[f32; 3]],
) -> Result<()> {
    for (target, weight) in targets {
        let Some(index) = attribute(target) else { continue };
        let moves: Vec<[f32; 3]> = accessor::vectors(file, index)?;
        if moves.len() != values.len() {
            let message = format!("a morph target has {} values for {} vertices", moves.len(), values.len());
            return Err(Error::format(message));
        }
        for (value, by) in values.iter_mut().zip(moves) {
            *value = (Vec3::from(*value) + Vec3::from(by) * weight).to_array();
        }
    }
    Ok(())
}
