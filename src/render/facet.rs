//! Triangles as the path tracer uses them: the data needed to shade a hit, in one cache line. Also chooses the origin
//! of world coordinates.

use crate::maths;
use crate::scene::Mesh;
use crate::scene::origin;
use glam::{DVec3, Vec2, Vec3};

/// A triangle prepared for path tracing. Coordinates are relative to the centre of the world ([`centre`]).
#[repr(C, align(64))]
#[derive(Clone, Copy)]
pub struct Facet {
    corner: Vec3,
    /// Edges from the first corner to the second and to the third.
    sides: [Vec3; 2],
    /// Unit geometric normal of the front side; zero for a degenerate triangle.
    pub normal: Vec3,
    /// Distance by which rays start off the surface, in metres; it exceeds the rounding error of a point on the
    /// triangle.
    pub offset: f32,
    pub mesh: u32,
    /// Index of the material; the highest bit is set if the shading normal may differ from the geometric normal.
    material: u32,
    /// Index of the emitter of this triangle, or `NONE`.
    pub emitter: u32,
}

/// Bound on the rounding error of an interpolated point, relative to the largest coordinate of its triangle: sixteen
/// times 2^-24, the rounding error of an f32 number. [rounding]
pub const OFFSET: f32 = 1.0 / (1 << 20) as f32;
/// A free point (`Vertex::free`) belongs to no triangle but may happen to lie in a surface. To leave such a surface,
/// its rays start at a distance of `OFFSET * max(p, min(c, MAX_FREE_COORDINATE))`. Here p is the largest coordinate of
/// the point and c the largest coordinate of the scene, in metres. Without the limit, in a scene as large as a country,
/// the offset would move the point through a wall. [convention]
pub const MAX_FREE_COORDINATE: f32 = 256.0;
/// The region where most triangles of a scene lie counts as far from the origin if the largest coordinate of their
/// median position exceeds `FAR` times half the region's extent. [convention]
const FAR: f64 = 32.0;
/// The region where most triangles of a scene lie is found from a sample of the triangles. The sample has
/// from `DETAIL_SAMPLES` to twice as many triangles, so that it fits in the memory reserve. In a scene with fewer
/// triangles, all triangles are examined. [convention]
const DETAIL_SAMPLES: usize = 1024;
/// Index that stands for "no triangle" or "no emitter".
pub const NONE: u32 = u32::MAX;
/// Bit of `Facet::material` that is set if the shading normal may differ from the geometric normal.
const SMOOTH: u32 = 1 << 31;

impl Facet {
    pub const EMPTY: Self = Self {
        corner: Vec3::ZERO,
        sides: [Vec3::ZERO; 2],
        normal: Vec3::ZERO,
        offset: 0.0,
        mesh: 0,
        material: 0,
        emitter: NONE,
    };

    /// Builds triangle number `triangle` of mesh number `index`. `corners` are in world coordinates (relative to
    /// [`centre`]).
    pub fn new(corners: [Vec3; 3], index: u32, mesh: &Mesh, triangle: usize) -> Self {
        // Compute edges and normal in f64, because small triangles far from the centre suffer from cancellation in
        // f32.
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let normal = (b - a).cross(c - a).normalize_or_zero().as_vec3();
        let smooth = if is_flat(mesh, triangle, normal) { 0 } else { SMOOTH };
        let largest = corners[0].abs().max(corners[1].abs()).max(corners[2].abs()).max_element();
        Self {
            corner: corners[0],
            sides: [(b - a).as_vec3(), (c - a).as_vec3()],
            normal,
            offset: largest * OFFSET,
            mesh: index,
            material: mesh.material as u32 | smooth,
            emitter: NONE,
        }
    }

    #[inline]
    pub fn point(&self, b: Vec2) -> Vec3 {
        self.corner + self.sides[0] * b.x + self.sides[1] * b.y
    }

    pub fn corners(&self) -> [Vec3; 3] {
        [self.corner, self.corner + self.sides[0], self.corner + self.sides[1]]
    }

    #[inline]
    pub fn material(&self) -> usize {
        (self.material & !SMOOTH) as usize
    }

    /// Returns a copy whose shading normal is always interpolated.
    pub fn without_analysis(&self) -> Self {
        Self { material: self.material | SMOOTH, ..*self }
    }

    /// Whether the interpolated vertex normals may differ from the geometric normal. A normal map may change the
    /// shading normal even if this is false.
    #[inline]
    pub fn is_smooth(&self) -> bool {
        self.material & SMOOTH != 0
    }
}

/// Whether the mesh has no vertex normals, or the vertex normals of the triangle equal its geometric normal up to
/// rounding.
fn is_flat(mesh: &Mesh, triangle: usize, normal: Vec3) -> bool {
    if mesh.normals.is_empty() {
        return true;
    }
    let [a, b, c] = mesh.triangles[triangle].map(|i| mesh.normals[i as usize].normalize_or_zero());
    // Shading flips vertex normals that oppose the winding, so compare such normals with the flipped geometric normal.
    let side = if a.dot(normal) < 0.0 { -normal } else { normal };
    [a, b, c].iter().all(|n| (*n - side).abs().max_element() < 1e-6)
}

/// Returns the origin of world coordinates, relative to the coordinates of the scene: the middle of the scene, rounded
/// to a grid so coarse that the translation is exact.
///
/// The spacing of f32 numbers grows with the distance from the origin, in powers of two. The cell size of the grid is
/// the smallest power of two that is at least the extent of the scene. If the scene lies at least one cell from the
/// origin, grid points are multiples of the f32 spacing there, so subtracting a grid point from the coordinates is
/// exact. A scene nearer to the origin is not translated, because a translation would hardly gain precision.
///
/// Some scenes are in the map coordinates of a country. A stray object at the origin of these coordinates then makes
/// the scene as large as the distance from that origin to the building. Therefore, if most triangles lie close together
/// and far from the origin, the centre is the median position of the triangles, rounded to a grid. The translation of
/// these triangles is exact. Only the coordinates of stray triangles are rounded. Such triangles lie as far from the
/// new origin as the building lay from the old one, so they get the precision that the building had in its file.
pub fn centre(meshes: &[Mesh]) -> DVec3 {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for mesh in meshes {
        for p in mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize]) {
            (low, high) = (low.min(p), high.max(p));
        }
    }
    let (low, high) = (low.as_dvec3(), high.as_dvec3());
    let extent = (high - low).max_element();
    if !(extent > 0.0 && extent.is_finite()) {
        return if low.is_finite() { low } else { DVec3::ZERO };
    }
    let grid = maths::powi(2f64, maths::log2(extent).ceil() as i32);
    let middle = (low + high) / 2.0;
    let whole = DVec3::select(middle.abs().cmplt(DVec3::splat(grid)), DVec3::ZERO, (middle / grid).round() * grid);
    if whole == DVec3::ZERO { centre_of_detail(meshes).unwrap_or(whole) } else { whole }
}

/// If most triangles of the scene lie close together and far from the origin, returns the centre of world coordinates
/// that suits these triangles; `None` otherwise.
fn centre_of_detail(meshes: &[Mesh]) -> Option<DVec3> {
    let count: usize = meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    let triangles = meshes.iter().flat_map(|mesh| (0..mesh.triangles.len()).map(move |triangle| (mesh, triangle)));
    let sampled = triangles.step_by((count / DETAIL_SAMPLES).max(1));
    let corners: Vec<DVec3> = sampled.flat_map(|(mesh, triangle)| mesh.corners(triangle)).map(Vec3::as_dvec3).collect();
    let (median, half_extent) = origin::detail(&corners)?;
    let is_far = half_extent > 0.0 && median.abs().max_element() > FAR * half_extent;
    let grid = maths::powi(2f64, maths::log2((2.0 * half_extent).max(f64::MIN_POSITIVE)).ceil() as i32);
    is_far.then(|| (median / grid).round() * grid)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    fn sheet(at: Vec3, size: f32) -> Mesh {
        let corner = |x: f32, z: f32| at + Vec3::new(x, 0.0, z) * size;
        let positions = vec![corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0), corner(1.0, 0.0)];
        Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
    }

    #[test]
    fn the_translation_to_the_centre_is_exact() {
        let mut rng = Rng::new(31, &[]);
        for _ in 0..2000 {
            let exponent = |rng: &mut Rng, range: f32| (rng.next_f32() * 2.0 * range - range).exp2();
            let size = exponent(&mut rng, 13.0);
            let place = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - 1.0;
            let mesh = sheet(place * size * exponent(&mut rng, 13.0), size);
            let centre = centre(std::slice::from_ref(&mesh));
            for p in &mesh.positions {
                let exact = p.as_dvec3() - centre;
                assert_eq!(exact.as_vec3().as_dvec3(), exact, "{p} from {centre}");
                let bound = f64::from(size) * 4.0;
                assert!(exact.abs().max_element() <= bound, "{exact} with a size of {size}");
            }
        }
    }

    #[test]
    fn normals_that_repeat_the_faces_do_not_bend_them() {
        let mut mesh = sheet(Vec3::ZERO, 2.0);
        let facet = |mesh: &Mesh| {
            let corners = mesh.corners(0);
            Facet::new(corners, 0, mesh, 0)
        };
        assert!(!facet(&mesh).is_smooth());
        mesh.normals = vec![Vec3::Y; 4];
        assert!(!facet(&mesh).is_smooth());
        mesh.normals = vec![Vec3::NEG_Y; 4];
        assert!(!facet(&mesh).is_smooth());
        mesh.normals[1] = Vec3::new(0.0, 1.0, 1e-3);
        assert!(facet(&mesh).is_smooth());
    }
}
