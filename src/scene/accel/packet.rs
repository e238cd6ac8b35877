//! Eight triangles side by side, and the watertight test of a ray against them (Woop, Benthin and Wald 2013).

use super::Hit;
use super::aligned::Aligned;
use super::lanes::{Lanes, Row};
use glam::Vec3;

/// Hits nearer than this share of a triangle's depth along the ray are lost in rounding: sixteen errors of 2^-24.
const NEAREST: f32 = 1.0 / (1 << 20) as f32;

/// Triangles a packet holds at most.
pub(super) const WIDTH: usize = 8;

#[derive(Clone)]
#[repr(C, align(64))]
pub(super) struct Packet {
    /// `corners[corner][axis]` holds that coordinate of eight triangles.
    corners: [[Row; 3]; 3],
    ids: [u32; WIDTH],
}

impl Packet {
    /// One to eight triangles. Free lanes are filled with NaN, which nothing hits.
    pub fn new(triangles: &[[Vec3; 3]], ids: &[u32]) -> Self {
        let mut packet = Self { corners: [[Row([f32::NAN; 8]); 3]; 3], ids: [u32::MAX; WIDTH] };
        for (lane, &id) in ids.iter().enumerate() {
            packet.ids[lane] = id;
            for (rows, corner) in packet.corners.iter_mut().zip(triangles[id as usize]) {
                for axis in 0..3 {
                    rows[axis].0[lane] = corner[axis];
                }
            }
        }
        packet
    }

    /// Mask of the triangles hit at distances in `(0, t_max]`, distances within rounding of 0 left out.
    #[inline(always)]
    pub fn intersect<L: Lanes>(&self, ray: &TriangleRay, t_max: f32) -> (u32, PacketHits<L>) {
        // Move the origin of space to the ray's, and shear it so that the ray runs along the third axis.
        let relative = |corner: usize, k: usize| {
            // SAFETY: `axes` is a permutation of 0, 1, 2.
            let row = unsafe { self.corners[corner].get_unchecked(ray.axes[k]) };
            L::load(row).sub(L::splat(ray.origin[k]))
        };
        let z = [relative(0, 2), relative(1, 2), relative(2, 2)];
        let sheared = |corner: usize, k: usize| relative(corner, k).sub(z[corner].mul(L::splat(ray.shear[k])));
        let x = [sheared(0, 0), sheared(1, 0), sheared(2, 0)];
        let y = [sheared(0, 1), sheared(1, 1), sheared(2, 1)];
        // Scaled barycentric coordinates: on which side of each edge the ray passes.
        let side = |a: usize, b: usize| x[a].mul(y[b]).sub(y[a].mul(x[b]));
        let mut edge = [side(2, 1), side(0, 2), side(1, 0)];
        let zero = L::splat(0.0);
        let inside = |edge: &[L; 3]| {
            let least = edge[0].min(edge[1]).min(edge[2]);
            let most = edge[0].max(edge[1]).max(edge[2]);
            L::or(zero.le(least), most.le(zero))
        };
        let mut hit = inside(&edge);
        if L::bits(hit) == 0 {
            return (0, PacketHits { t: zero, u: zero, v: zero });
        }
        // Only those that came out as zero are settled in f64: the neighbour across the edge has the same value with the
        // other sign, whichever way it was found. (A zero between edges of unlike signs is outside either way.)
        if L::bits(L::or(L::or(edge[0].eq(zero), edge[1].eq(zero)), edge[2].eq(zero))) != 0 {
            edge = settle_zeros(&x, &y, &edge);
            hit = inside(&edge);
        }
        let determinant = edge[0].add(edge[1]).add(edge[2]);
        // Distances, from the depths of the corners. A determinant of zero gives a NaN or an infinity, which fail below.
        let reciprocal = L::splat(1.0).div(determinant);
        let (b0, u, v) = (edge[0].mul(reciprocal), edge[1].mul(reciprocal), edge[2].mul(reciprocal));
        let t = b0.mul(z[0]).add(u.mul(z[1])).add(v.mul(z[2])).mul(L::splat(ray.shear[2]));
        // A hit nearer than its own rounding error is the surface the ray starts on.
        let depth = z[0].abs().max(z[1].abs()).max(z[2].abs());
        let far_enough = depth.mul(L::splat(ray.nearest)).lt(t);
        let hit = L::and(L::and(hit, far_enough), t.le(L::splat(t_max)));
        (L::bits(hit), PacketHits { t, u, v })
    }

    #[inline(always)]
    pub fn id(&self, lane: usize) -> u32 {
        self.ids[lane & (WIDTH - 1)]
    }
}

/// The edge functions with their zeros computed without cancellation: products of two `f32` are exact in `f64`, so the
/// sign is.
#[cold]
#[inline(never)]
fn settle_zeros<L: Lanes>(x: &[L; 3], y: &[L; 3], edge: &[L; 3]) -> [L; 3] {
    let (x, y) = (x.map(L::store), y.map(L::store));
    let exact = |found: L, a: usize, b: usize| {
        let mut row = found.store();
        for lane in 0..WIDTH {
            if row.0[lane] == 0.0 {
                let product = |p: &Row, q: &Row| f64::from(p.0[lane]) * f64::from(q.0[lane]);
                row.0[lane] = (product(&x[a], &y[b]) - product(&y[a], &x[b])) as f32;
            }
        }
        L::load(&row)
    };
    [exact(edge[0], 2, 1), exact(edge[1], 0, 2), exact(edge[2], 1, 0)]
}

pub(super) struct PacketHits<L> {
    t: L,
    u: L,
    v: L,
}

/// The same as rows that can be indexed.
pub(super) struct HitRows {
    t: Row,
    u: Row,
    v: Row,
}

impl<L: Lanes> PacketHits<L> {
    #[inline(always)]
    pub fn store(self) -> HitRows {
        HitRows { t: self.t.store(), u: self.u.store(), v: self.v.store() }
    }
}

impl HitRows {
    #[inline(always)]
    pub fn lane(&self, lane: usize, packet: &Packet) -> Hit {
        let lane = lane & (WIDTH - 1);
        Hit { t: self.t.0[lane], triangle: packet.id(lane), u: self.u.0[lane], v: self.v.0[lane] }
    }
}

/// A ray prepared for triangles: axes permuted so that the longest component of its direction is the third.
pub(super) struct TriangleRay {
    /// Permuted, as is `shear`.
    origin: [f32; 3],
    axes: [usize; 3],
    shear: [f32; 3],
    /// What a triangle's depth is multiplied by to give the least distance.
    nearest: f32,
}

impl TriangleRay {
    #[inline(always)]
    pub fn new(ray: &Aligned) -> Self {
        let z = ray.dominant_axis();
        let (origin, d, inverse) = (ray.origin.to_array(), ray.direction.to_array(), ray.inverse.to_array()[z]);
        // The two axes after it in turn, from tables of two bits each: 1, 2, 0 and 2, 0, 1.
        let (x, y) = (0b00_10_01 >> (2 * z) & 3, 0b01_00_10 >> (2 * z) & 3);
        Self {
            origin: [origin[x], origin[y], origin[z]],
            axes: [x, y, z],
            shear: [d[x] * inverse, d[y] * inverse, inverse],
            nearest: inverse.abs() * NEAREST,
        }
    }
}
