//! Packets of eight triangles, and the watertight ray test against them (Woop, Benthin and Wald 2013).

use super::lanes::{Lanes, Row};
use super::prepared_ray::PreparedRay;
use super::ray::Hit;
use glam::Vec3;

/// Minimum distance of a hit, relative to the largest depth of the triangle's corners along the ray. Nearer hits are
/// refused, because the distance could be a rounding error (sixteen errors of 2^-24 each). [rounding]
const MIN_DISTANCE: f32 = 1.0 / (1 << 20) as f32;

/// Maximum number of triangles in a packet.
pub(super) const WIDTH: usize = 8;

#[derive(Clone)]
#[repr(C, align(64))]
pub(super) struct Packet {
    /// `corners[corner][axis]` holds one coordinate of one corner for all eight triangles.
    corners: [[Row; 3]; 3],
    ids: [u32; WIDTH],
}

impl Packet {
    /// Packs one to eight triangles, whose indices in the list `triangles` are `ids`. Unused lanes are filled with NaN,
    /// so no ray hits them.
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

    /// Returns the index and the corners of each triangle.
    pub fn triangles(&self) -> impl Iterator<Item = (u32, [Vec3; 3])> {
        let used = (0..WIDTH).filter(|&lane| self.ids[lane] != u32::MAX);
        let point = |lane: usize| move |rows: &[Row; 3]| Vec3::from_array([0, 1, 2].map(|axis| rows[axis].0[lane]));
        used.map(move |lane| (self.ids[lane], self.corners.each_ref().map(point(lane))))
    }

    /// Renumbers the triangles: the index `i` of a triangle becomes `ids[i]`.
    pub fn renumber(&mut self, ids: &[u32]) {
        self.ids.iter_mut().filter(|id| **id != u32::MAX).for_each(|id| *id = ids[*id as usize]);
    }

    /// Returns a mask of the triangles hit, and a hit for each lane; only hits of lanes in the mask are meaningful. A
    /// hit counts if its distance is at most `t_max` and exceeds its own rounding error.
    #[inline(always)]
    pub fn intersect<L: Lanes>(&self, ray: &TriangleRay, t_max: f32) -> (u32, PacketHits<L>) {
        let [x, y, z] = self.sheared::<L>(ray);
        let mut edge = edges(&x, &y);
        let mut hit = inside(&edge);
        let zero = L::splat(0.0);
        if L::bits(hit) == 0 {
            return (0, PacketHits { t: zero, u: zero, v: zero });
        }
        // Recompute in `f64` the edge functions whose value is zero. In either precision, the triangle on the other
        // side of the edge obtains the same value with the opposite sign, so no ray slips between the two triangles.
        // (If the other two edge functions of a triangle have opposite signs, the ray misses this triangle in any
        // case.)
        if L::bits(L::or(L::or(edge[0].eq(zero), edge[1].eq(zero)), edge[2].eq(zero))) != 0 {
            edge = self.settled_edges(ray);
            hit = inside(&edge);
        }
        // Interpolate the distance from the depths of the corners. If the edge functions sum to zero, the distance is
        // NaN or infinite and fails the comparisons below.
        let corner = z.map(|z| z.mul(L::splat(ray.shear[2])));
        let reciprocal = L::splat(1.0).div(edge[0].add(edge[1]).add(edge[2]));
        let (b0, u, v) = (edge[0].mul(reciprocal), edge[1].mul(reciprocal), edge[2].mul(reciprocal));
        let t = b0.mul(corner[0]).add(u.mul(corner[1])).add(v.mul(corner[2]));
        // Reject a hit nearer than its own rounding error: it may lie on the surface where the ray starts.
        let farthest = corner[0].abs().max(corner[1].abs()).max(corner[2].abs());
        let far_enough = farthest.mul(L::splat(MIN_DISTANCE)).lt(t);
        let hit = L::and(L::and(hit, far_enough), t.le(L::splat(t_max)));
        (L::bits(hit), PacketHits { t, u, v })
    }

    /// Returns the x, y and z coordinates of the corners, sheared so that the ray starts at the origin and runs along
    /// z.
    #[inline(always)]
    fn sheared<L: Lanes>(&self, ray: &TriangleRay) -> [[L; 3]; 3] {
        let relative = |corner: usize, k: usize| {
            // SAFETY: `axes` is a permutation of 0, 1, 2, and each corner has three rows.
            let row = unsafe { self.corners[corner].get_unchecked(ray.axes[k]) };
            L::load(row).sub(L::splat(ray.origin[k]))
        };
        let z = [relative(0, 2), relative(1, 2), relative(2, 2)];
        let sheared = |corner: usize, k: usize| relative(corner, k).sub(z[corner].mul(L::splat(ray.shear[k])));
        [[sheared(0, 0), sheared(1, 0), sheared(2, 0)], [sheared(0, 1), sheared(1, 1), sheared(2, 1)], z]
    }

    /// Computes the edge functions in `f32`. Where one is zero, computes it again in `f64`: a product of two `f32` is
    /// exact in `f64`, so the sign of the difference of two products is exact. The function starts from the corners
    /// again, so that its caller need not keep intermediate values in registers for this rare case.
    #[cold]
    #[inline(never)]
    fn settled_edges<L: Lanes>(&self, ray: &TriangleRay) -> [L; 3] {
        let [x, y, _] = self.sheared::<L>(ray);
        let edge = edges(&x, &y).map(L::store);
        let (x, y) = (x.map(L::store), y.map(L::store));
        [(2, 1), (0, 2), (1, 0)].map(|(a, b)| {
            let mut row = edge[3 - a - b];
            for lane in 0..WIDTH {
                if row.0[lane] == 0.0 {
                    let product = |p: &Row, q: &Row| f64::from(p.0[lane]) * f64::from(q.0[lane]);
                    row.0[lane] = (product(&x[a], &y[b]) - product(&y[a], &x[b])) as f32;
                }
            }
            L::load(&row)
        })
    }

    #[inline(always)]
    pub fn id(&self, lane: usize) -> u32 {
        self.ids[lane & (WIDTH - 1)]
    }
}

/// Computes the three edge functions of each triangle (scaled barycentric coordinates). The sign of an edge function
/// tells on which side of its edge the ray passes.
#[inline(always)]
fn edges<L: Lanes>(x: &[L; 3], y: &[L; 3]) -> [L; 3] {
    let side = |a: usize, b: usize| x[a].mul(y[b]).sub(y[a].mul(x[b]));
    [side(2, 1), side(0, 2), side(1, 0)]
}

#[inline(always)]
fn inside<L: Lanes>(edge: &[L; 3]) -> L::Mask {
    let zero = L::splat(0.0);
    let min = edge[0].min(edge[1]).min(edge[2]);
    let max = edge[0].max(edge[1]).max(edge[2]);
    L::or(zero.le(min), max.le(zero))
}

pub(super) struct PacketHits<L> {
    t: L,
    u: L,
    v: L,
}

/// The hits of a packet in memory, where they can be indexed by lane.
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

/// A ray prepared for triangle tests. Its axes are permuted so that the dominant axis is the third.
pub(super) struct TriangleRay {
    /// The origin, with its coordinates in the order of `axes`.
    origin: [f32; 3],
    /// The three axes; the last one is the dominant axis.
    axes: [usize; 3],
    /// `[dx / dz, dy / dz, 1 / dz]` for the direction (dx, dy, dz), with its components in the order of `axes`.
    shear: [f32; 3],
}

impl TriangleRay {
    #[inline(always)]
    pub fn new(ray: &PreparedRay) -> Self {
        let z = ray.dominant_axis();
        let (origin, d, inverse) = (ray.origin.to_array(), ray.direction.to_array(), ray.inverse.to_array()[z]);
        // Look up x = (z + 1) mod 3 and y = (z + 2) mod 3, in tables of two bits per entry: 1, 2, 0 and 2, 0, 1.
        let (x, y) = (0b00_10_01 >> (2 * z) & 3, 0b01_00_10 >> (2 * z) & 3);
        Self {
            origin: [origin[x], origin[y], origin[z]],
            axes: [x, y, z],
            shear: [d[x] * inverse, d[y] * inverse, inverse],
        }
    }
}
