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
    /// A parallelogram of two triangles that faces along `u` × `v`. Its texture coordinates are (0, 0) at the corner, and (1, 0) and (0, 1)
    /// along `u` and `v`.
    pub fn parallelogram(corner: Vec3, u: Vec3, v: Vec3, material: usize) -> Self {
        Self {
            material,
            positions: vec![corner, corner + u, corner + u + v, corner + v],
            uvs: [vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y], Vec::new()],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Self::default()
        }
    }

    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }
}
