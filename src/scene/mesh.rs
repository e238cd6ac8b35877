//! Triangle meshes.

use glam::{Vec2, Vec3};

/// Triangles in world space. Front faces are counter-clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The host's name of the object; surfaces are looked up by it.
    pub name: String,
    /// Index into the scene's materials.
    pub material: usize,
    pub positions: Vec<Vec3>,
    /// One per position, or empty: then faces are flat.
    pub normals: Vec<Vec3>,
    /// Up to two sets of texture coordinates, each one per position or empty; (0, 0) is the top-left of a texture.
    pub uvs: [Vec<Vec2>; 2],
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }
}
