//! Four triangles side by side, and the watertight test of a ray against them (Woop, Benthin and Wald 2013).

use super::{Hit, Ray};
use glam::{Vec3, Vec4};

/// Hits nearer than this share of a triangle's depth along the ray are lost in rounding: sixteen errors of 2^-24.
const NEAREST: f32 = 1.0 / (1 << 20) as f32;

#[derive(Clone)]
pub(super) struct Packet {
    /// `corners[corner][axis]` holds that coordinate of four triangles.
    corners: [[Vec4; 3]; 3],
    ids: [u32; 4],
    /// Mask of the lanes in use.
    lanes: u32,
}

impl Packet {
    /// One to four triangles; free lanes repeat the first and are masked out.
    pub fn new(triangles: &[[Vec3; 3]], ids: &[u32]) -> Self {
        let lanes = (1 << ids.len()) - 1;
        let of_lane = |lane: usize| ids[if lane < ids.len() { lane } else { 0 }];
        let ids = std::array::from_fn(of_lane);
        let corners = std::array::from_fn(|corner| {
            std::array::from_fn(|axis| Vec4::from_array(ids.map(|id: u32| triangles[id as usize][corner][axis])))
        });
        Self { corners, ids, lanes }
    }

    /// Mask of the triangles hit at distances in `(0, t_max]`, distances within rounding of 0 left out.
    #[inline(always)]
    pub fn intersect(&self, ray: &TriangleRay, t_max: f32) -> (u32, PacketHits) {
        // Move the origin of space to the ray's, and shear it so that the ray runs along the third axis.
        let relative = |corner: usize, axis: usize| self.corners[corner][axis] - Vec4::splat(ray.origin[axis]);
        let mut x = [Vec4::ZERO; 3];
        let mut y = [Vec4::ZERO; 3];
        let mut z = [Vec4::ZERO; 3];
        for corner in 0..3 {
            z[corner] = relative(corner, ray.axes[2]);
            x[corner] = relative(corner, ray.axes[0]) - z[corner] * ray.shear.x;
            y[corner] = relative(corner, ray.axes[1]) - z[corner] * ray.shear.y;
        }
        // Scaled barycentric coordinates: on which side of each edge the ray passes.
        let mut edge = [x[2] * y[1] - y[2] * x[1], x[0] * y[2] - y[0] * x[2], x[1] * y[0] - y[1] * x[0]];
        // Only those that came out as zero are settled in f64: the neighbour across the edge has the same value with the
        // other sign, whichever way it was found.
        let zero = edge.map(|e| e.cmpeq(Vec4::ZERO));
        if (zero[0] | zero[1] | zero[2]).any() {
            let exact = exact_edges(&x, &y);
            edge = std::array::from_fn(|i| Vec4::select(zero[i], exact[i], edge[i]));
        }
        let all_front = edge[0].cmpge(Vec4::ZERO) & edge[1].cmpge(Vec4::ZERO) & edge[2].cmpge(Vec4::ZERO);
        let all_back = edge[0].cmple(Vec4::ZERO) & edge[1].cmple(Vec4::ZERO) & edge[2].cmple(Vec4::ZERO);
        let determinant = edge[0] + edge[1] + edge[2];
        let inside = (all_front | all_back) & determinant.cmpne(Vec4::ZERO);
        if !inside.any() {
            return (0, PacketHits { t: Vec4::ZERO, u: Vec4::ZERO, v: Vec4::ZERO });
        }
        // Distances, from the depths of the corners.
        let reciprocal = Vec4::ONE / determinant;
        let (b0, u, v) = (edge[0] * reciprocal, edge[1] * reciprocal, edge[2] * reciprocal);
        let t = (b0 * z[0] + u * z[1] + v * z[2]) * ray.shear.z;
        // A hit nearer than its own rounding error is the surface the ray starts on.
        let depth = z[0].abs().max(z[1].abs()).max(z[2].abs());
        let mask = inside & t.cmpgt(depth * (ray.shear.z.abs() * NEAREST)) & t.cmple(Vec4::splat(t_max));
        (mask.bitmask() & self.lanes, PacketHits { t, u, v })
    }
}

/// The edge functions without cancellation: products of two `f32` are exact in `f64`, so the sign is.
#[cold]
fn exact_edges(x: &[Vec4; 3], y: &[Vec4; 3]) -> [Vec4; 3] {
    let edge = |a: usize, b: usize| {
        Vec4::from_array(std::array::from_fn(|lane| {
            let product = |p: Vec4, q: Vec4| f64::from(p[lane]) * f64::from(q[lane]);
            (product(x[a], y[b]) - product(y[a], x[b])) as f32
        }))
    };
    [edge(2, 1), edge(0, 2), edge(1, 0)]
}

pub(super) struct PacketHits {
    t: Vec4,
    u: Vec4,
    v: Vec4,
}

impl PacketHits {
    #[inline(always)]
    pub fn lane(&self, lane: usize, packet: &Packet) -> Hit {
        Hit { t: self.t[lane], triangle: packet.ids[lane], u: self.u[lane], v: self.v[lane] }
    }
}

/// A ray prepared for triangles: axes permuted so that the longest component of its direction is the third.
pub(super) struct TriangleRay {
    origin: Vec3,
    axes: [usize; 3],
    shear: Vec3,
}

impl TriangleRay {
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let size = d.abs();
        let z = if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        Self { origin: ray.origin, axes: [x, y, z], shear: Vec3::new(d[x] / d[z], d[y] / d[z], 1.0 / d[z]) }
    }
}
