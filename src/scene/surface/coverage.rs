//! Finds the texels of a surface's bounding rectangle that its triangles cover.

use super::Surface;
use crate::error::Result;
use crate::image::try_vec;
use crate::scene::Scene;
use glam::{DVec2, DVec3, UVec2};

/// Distance in texels by which each edge of a triangle is moved outwards. Without it, rounding could leave a texel
/// centre on the common edge of two triangles outside both. [rounding]
const CRACK: f64 = 1e-3;
/// A surface counts as a full rectangle if its area is at least this share of its bounding rectangle's area.
/// [rounding]
const FULL: f32 = 0.9999;

impl Surface {
    /// Whether the surface fills its bounding rectangle.
    pub fn is_rectangle(&self) -> bool {
        self.area >= FULL * self.size.element_product()
    }

    /// Converts a point from coordinates on this surface to coordinates on another surface in the same plane. The
    /// coordinates of a surface are metres from its `origin` along its u and v axes.
    pub fn to_other(&self, other: &Self, at: DVec2) -> DVec2 {
        let point = self.origin.as_dvec3() + self.u_axis.as_dvec3() * at.x + self.v_axis.as_dvec3() * at.y;
        let offset = point - other.origin.as_dvec3();
        DVec2::new(offset.dot(other.u_axis.as_dvec3()), offset.dot(other.v_axis.as_dvec3()))
    }

    /// For each texel of a texture that covers the bounding rectangle, whether its centre lies in a triangle of the
    /// surface. If `with_partial` is true, the value is also true for centres within one texel of a triangle.
    pub fn covered_texels(&self, scene: &Scene, size: UVec2, with_partial: bool) -> Result<Vec<bool>> {
        let slack = if with_partial { 1.0 } else { CRACK };
        let (width, height) = (size.x as usize, size.y as usize);
        let mut covered = try_vec(width * height, false)?;
        let texels_per_metre = size.as_dvec2() / self.size.as_dvec2();
        for &(mesh, triangle) in &self.triangles {
            let mut corners = scene.meshes[mesh].corners(triangle).map(|p| {
                let from: DVec3 = p.as_dvec3() - self.origin.as_dvec3();
                DVec2::new(from.dot(self.u_axis.as_dvec3()), from.dot(self.v_axis.as_dvec3())) * texels_per_metre
            });
            if (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]) < 0.0 {
                corners.swap(1, 2);
            }
            // Compute the edges; a point inside has positive signed distances from all three.
            let edges = [0, 1, 2].map(|i| {
                let along = (corners[(i + 1) % 3] - corners[i]).normalize_or_zero();
                (corners[i], along)
            });
            let (low, high) = corners.iter().fold((corners[0], corners[0]), |(l, h), c| (l.min(*c), h.max(*c)));
            let first = (low - slack - 0.5).ceil().max(DVec2::ZERO).as_uvec2();
            let end = (high + slack + 0.5).floor().max(DVec2::ZERO).as_uvec2().min(size);
            for y in first.y..end.y {
                for x in first.x..end.x {
                    let texel = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                    if edges.iter().all(|(from, along)| along.perp_dot(texel - *from) >= -slack) {
                        covered[y as usize * width + x as usize] = true;
                    }
                }
            }
        }
        Ok(covered)
    }
}
