//! Selects, among the planes of an object, the plane that faces the room, and the side of the plane on which the room
//! lies.

use super::patch::Patch;
use crate::error::{Error, Result};
use crate::maths;
use crate::rng::Rng;
use crate::scene::Scene;
use glam::{DVec3, Vec3};

/// Number of rays cast from each side of each plane.
const RAYS: usize = 128;
/// Maximum number of triangles in a [`Chunk`].
const CHUNK: usize = 64;
/// Weight of the cameras: the score of a side is multiplied by 1 plus this weight times the share of cameras in front
/// of the side. [bench constants:surface]
const CAMERA_WEIGHT: f64 = 4.0;

/// Returns the index of the plane that faces the room, and its unit normal into the room.
///
/// A side faces the room if rays leaving it travel far, relative to the size of the plane, and then hit a surface.
/// (Rays from the upper side of a ceiling hit nothing; rays inside a slab end at once.) The score of a side is the
/// product of three factors:
///
/// - the area of the plane,
/// - the mean of `min(1, distance / √area)` over the rays; a ray that hits nothing counts as 0,
/// - a factor for the cameras in front of the side ([`CAMERA_WEIGHT`]).
///
/// In an otherwise empty scene all scores are 0, and the result is the front side of the first plane.
pub fn facing(scene: &Scene, patches: &[Patch]) -> Result<(usize, DVec3)> {
    let chunks = chunks(scene);
    let mut best: Option<(f64, usize, DVec3)> = None;
    for (i, patch) in patches.iter().enumerate() {
        for normal in [front_normal(scene, patch), -front_normal(scene, patch)] {
            let score = patch.area
                * mean_clear_distance(scene, &chunks, patch, normal)
                * (1.0 + CAMERA_WEIGHT * cameras(scene, patch, normal));
            if best.is_none_or(|(b, ..)| score > b) {
                best = Some((score, i, normal));
            }
        }
    }
    best.map(|(_, i, normal)| (i, normal)).ok_or_else(|| Error::degenerate("the surface has no area"))
}

/// Returns the normal on the front side of the plane: the side from which most of its area is wound counter-clockwise.
fn front_normal(scene: &Scene, patch: &Patch) -> DVec3 {
    let signed: f64 = patch
        .triangles
        .iter()
        .map(|&(mesh, triangle)| {
            let [a, b, c] = scene.meshes[mesh].corners(triangle).map(|p| p.as_dvec3());
            (b - a).cross(c - a).dot(patch.normal)
        })
        .sum();
    if signed < 0.0 { -patch.normal } else { patch.normal }
}

/// Share of the scene's cameras on the side of the plane to which `normal` points; 0 without cameras.
fn cameras(scene: &Scene, patch: &Patch, normal: DVec3) -> f64 {
    let in_front = scene.cameras.iter().filter(|c| (c.position.as_dvec3() - patch.centre).dot(normal) > 0.0).count();
    in_front as f64 / scene.cameras.len().max(1) as f64
}

/// Returns how far one can see from one side of a plane, in `[0, 1]`. It is the mean of `min(1, distance / √area)` over
/// [`RAYS`] rays, where `area` is the area of the plane. A ray that hits nothing counts as 0.
fn mean_clear_distance(scene: &Scene, chunks: &[Chunk], patch: &Patch, normal: DVec3) -> f64 {
    // Accumulate the areas of the triangles, to sample triangles in proportion to area.
    let mut sums = Vec::with_capacity(patch.triangles.len());
    let mut sum = 0.0;
    for &(mesh, triangle) in &patch.triangles {
        let [a, b, c] = scene.meshes[mesh].corners(triangle).map(|p| p.as_dvec3());
        sum += (b - a).cross(c - a).length();
        sums.push(sum);
    }
    let scale = patch.area.sqrt();
    let (u, v) = normal.any_orthonormal_pair();
    let mut seen = 0.0;
    for ray in 0..RAYS {
        // Sample a point uniformly by area, and a direction in proportion to its cosine to the normal (Malley's
        // method).
        let mut rng = Rng::new(0, &[ray as u64]);
        let area = rng.next_f64() * sum;
        let at = sums.partition_point(|s| *s < area).min(sums.len() - 1);
        let (mesh, triangle) = patch.triangles[at];
        let [a, b, c] = scene.meshes[mesh].corners(triangle).map(|p| p.as_dvec3());
        let (root, share) = (rng.next_f64().sqrt(), rng.next_f64());
        let point = a * (1.0 - root) + (b * (1.0 - share) + c * share) * root;
        let (radius2, angle) = (rng.next_f64(), std::f64::consts::TAU * rng.next_f64());
        let (s, t) = maths::sin_cos(angle);
        let direction = (u * t + v * s) * radius2.sqrt() + normal * (1.0 - radius2).sqrt();
        // Start beyond the plane's own triangles, which differ in height by up to four tolerances.
        let start = point + normal * (4.0 * patch.tolerance);
        if let Some(distance) = nearest(scene, chunks, start.as_vec3(), direction.as_vec3()) {
            seen += (f64::from(distance) / scale).min(1.0);
        }
    }
    seen / RAYS as f64
}

/// Up to [`CHUNK`] consecutive triangles of one mesh, with their common bounding box. The box is mostly small, because
/// triangles that are neighbours in a file are mostly neighbours in space.
struct Chunk {
    mesh: usize,
    triangles: std::ops::Range<usize>,
    low: Vec3,
    high: Vec3,
}

fn chunks(scene: &Scene) -> Vec<Chunk> {
    let mut out = Vec::new();
    for (index, mesh) in scene.meshes.iter().enumerate() {
        for start in (0..mesh.triangles.len()).step_by(CHUNK) {
            let triangles = start..(start + CHUNK).min(mesh.triangles.len());
            let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            for corner in triangles.clone().flat_map(|t| mesh.corners(t)) {
                low = low.min(corner);
                high = high.max(corner);
            }
            out.push(Chunk { mesh: index, triangles, low, high });
        }
    }
    out
}

/// Returns the distance to the nearest triangle along a ray; `None` if the ray hits nothing.
fn nearest(scene: &Scene, chunks: &[Chunk], origin: Vec3, direction: Vec3) -> Option<f32> {
    let inverse = direction.recip();
    let mut closest = f32::INFINITY;
    for chunk in chunks {
        // Slab test. A ray that lies exactly in the plane of a face of the box gives NaN (0 × ∞), and may miss the box;
        // this is negligible for random directions.
        let (a, b) = ((chunk.low - origin) * inverse, (chunk.high - origin) * inverse);
        let (near, far) = (a.min(b).max_element().max(0.0), a.max(b).min_element());
        if near > far || near > closest {
            continue;
        }
        for triangle in chunk.triangles.clone() {
            let [a, b, c] = scene.meshes[chunk.mesh].corners(triangle);
            if let Some(t) = hit(origin, direction, a, b, c) {
                closest = closest.min(t);
            }
        }
    }
    closest.is_finite().then_some(closest)
}

/// Two-sided ray-triangle test of Möller and Trumbore (1997). Returns the distance of the hit; `None` if the ray misses
/// the triangle.
fn hit(origin: Vec3, direction: Vec3, a: Vec3, b: Vec3, c: Vec3) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    let s = origin - a;
    let u = s.dot(p) / determinant;
    let q = s.cross(ab);
    let v = direction.dot(q) / determinant;
    let t = ac.dot(q) / determinant;
    (determinant != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}
