//! Triangle meshes.

use crate::rng::hash;
use glam::{Vec2, Vec3, Vec4};

/// Triangles in world space. Front faces are wound counter-clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The host's name of the object; surfaces are looked up by it.
    pub name: String,
    /// Index into the scene's materials.
    pub material: usize,
    pub positions: Vec<Vec3>,
    /// One per position; if empty, faces are flat.
    pub normals: Vec<Vec3>,
    /// Up to two sets of texture coordinates, each with one entry per position or empty; (0, 0) is the top-left of a
    /// texture.
    pub uvs: [Vec<Vec2>; 2],
    /// Factors of the base colour and of alpha, each in `[0, 1]`: one per position; if empty, 1.
    pub colours: Vec<Vec4>,
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// A parallelogram of two triangles whose front faces along `u` × `v`. Its texture coordinates are (0, 0) at the
    /// corner, (1, 0) along `u` and (0, 1) along `v`.
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

    /// Whether the consistently wound triangles enclose a volume: every edge is then traversed equally often in both
    /// directions. Vertices at equal positions count as one. Edges are compared by a sum of hashes, which needs no
    /// memory and errs for one in 2^64 meshes.
    pub fn is_closed(&self) -> bool {
        // Adding zero turns -0 into 0.
        let place = |p: Vec3| hash(0, &(p + Vec3::ZERO).to_array().map(|v| v.to_bits().into()));
        let boundary = (0..self.triangles.len()).fold(0u64, |sum, triangle| {
            let [a, b, c] = self.corners(triangle).map(place);
            let edges = [[a, b], [b, c], [c, a]];
            edges.iter().fold(sum, |sum, &[a, b]| sum.wrapping_add(hash(1, &[a, b])).wrapping_sub(hash(1, &[b, a])))
        });
        !self.triangles.is_empty() && boundary == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_is_closed_until_a_side_is_taken_away() {
        // Each side has its own vertices, as in meshes with sharp normals.
        let mut cube = Mesh::default();
        let mut corner = Vec3::splat(-1.0);
        for axis in 0..3 {
            let [u, v] = [1, 2].map(|k| 2.0 * Vec3::AXES[(axis + k) % 3]);
            for (corner, u, v) in [(corner, v, u), (corner + 2.0 * Vec3::AXES[axis], u, v)] {
                let side = Mesh::parallelogram(corner, u, v, 0);
                let first = cube.positions.len() as u32;
                cube.positions.extend(side.positions);
                cube.triangles.extend(side.triangles.iter().map(|t| t.map(|i| i + first)));
            }
        }
        assert!(cube.is_closed());
        // Zeros of either sign are the same position.
        cube.positions.iter_mut().for_each(|p| p.x += 1.0);
        corner.x = 0.0;
        cube.positions.iter_mut().filter(|p| **p == corner).take(1).for_each(|p| p.x = -0.0);
        assert!(cube.is_closed());
        let mut open = cube.clone();
        open.triangles.truncate(10);
        assert!(!open.is_closed());
        let mut turned = cube.clone();
        turned.triangles[3].swap(0, 1);
        assert!(!turned.is_closed());
        assert!(!Mesh::parallelogram(corner, Vec3::X, Vec3::Y, 0).is_closed() && !Mesh::default().is_closed());
    }
}
