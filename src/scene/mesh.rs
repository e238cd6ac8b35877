//! Triangle meshes.

use crate::rng::hash;
use glam::{DVec3, Vec2, Vec3, Vec4};

/// Triangles in world space. Front faces are wound counter-clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The host's name for the object. Surfaces are looked up by this name.
    pub name: String,
    /// Index into the scene's materials.
    pub material: usize,
    pub positions: Vec<Vec3>,
    /// One normal per position, or empty for flat-shaded faces.
    pub normals: Vec<Vec3>,
    /// Two sets of texture coordinates. Each set is empty or has one entry per position; (0, 0) is the top-left corner
    /// of a texture.
    pub uvs: [Vec<Vec2>; 2],
    /// Factors of the base colour (RGB) and of alpha, each in `[0, 1]`: one entry per position, or empty for factors
    /// of 1.
    pub colours: Vec<Vec4>,
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// A parallelogram of two triangles whose front side faces along `u` × `v`. The texture coordinates are (0, 0) at
    /// `corner`, (1, 0) at `corner + u` and (0, 1) at `corner + v`.
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

    /// Returns the size of the mesh in memory, in bytes.
    pub fn bytes(&self) -> usize {
        let uvs = self.uvs.iter().map(Vec::len).sum::<usize>();
        let vectors = self.positions.len() + self.normals.len() + self.triangles.len();
        12 * vectors + 8 * uvs + 16 * self.colours.len()
    }

    /// Whether the triangles are consistently wound and enclose a volume. In such a mesh every edge is traversed
    /// equally often in both directions. Vertices at equal positions count as one vertex.
    ///
    /// The function computes a hash for each directed edge. It sums the hashes of all edges and subtracts the hashes of
    /// the reversed edges. The sum needs no memory, and it is 0 if the mesh is closed. For an open mesh, it is 0 by
    /// chance with probability 2^-64.
    pub fn is_closed(&self) -> bool {
        // Add zero, which turns -0 into +0, so that zeros of either sign hash alike.
        let place = |p: Vec3| hash(0, &(p + Vec3::ZERO).to_array().map(|v| v.to_bits().into()));
        let boundary = (0..self.triangles.len()).fold(0u64, |sum, triangle| {
            let [a, b, c] = self.corners(triangle).map(place);
            let edges = [[a, b], [b, c], [c, a]];
            edges.iter().fold(sum, |sum, &[a, b]| sum.wrapping_add(hash(1, &[a, b])).wrapping_sub(hash(1, &[b, a])))
        });
        !self.triangles.is_empty() && boundary == 0
    }

    /// Returns the volume of a closed mesh in m³; negative if its front sides face inwards.
    pub fn volume(&self) -> f64 {
        // Sum the volumes of pyramids with their tips at the first vertex, so that distance from the origin does not
        // spoil the sum.
        let tip = self.positions.first().map_or(DVec3::ZERO, |p| p.as_dvec3());
        let pyramid = |triangle| {
            let [a, b, c] = self.corners(triangle).map(|p| p.as_dvec3() - tip);
            a.dot(b.cross(c)) / 6.0
        };
        (0..self.triangles.len()).map(pyramid).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_is_closed_until_a_side_is_taken_away() {
        // Give each side its own vertices, as meshes with sharp normals have.
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
        let volume = cube.volume().abs();
        assert!((volume - 8.0).abs() < 1e-12, "{volume}");
        let mut turned = cube.clone();
        turned.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        assert_eq!(turned.volume(), -cube.volume());
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
