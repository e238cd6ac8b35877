//! Nodes of eight children, and the conservative test of a ray against their eight boxes.

use super::lanes::{Lanes, Row};
use super::prepared_ray::{PreparedRay, finite};
use glam::{Vec3, Vec4};

/// A child reference: another node, a packet of triangles, or empty. Nodes and packets are identified by the number of
/// their first cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Child(u32);

impl Default for Child {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Child {
    pub const EMPTY: Self = Self(u32::MAX);
    /// Maximum number of cache lines that a child reference can address.
    pub const LINES: usize = (1 << 31) - 1;
    const PACKET: u32 = 1 << 31;

    pub fn of_node(line: usize) -> Self {
        Self(line as u32)
    }

    pub fn of_packet(line: usize) -> Self {
        Self(line as u32 | Self::PACKET)
    }

    pub fn bits(self) -> u32 {
        self.0
    }

    pub fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    pub fn is_empty(self) -> bool {
        self == Self::EMPTY
    }

    #[inline(always)]
    pub fn is_packet(self) -> bool {
        self.0 & Self::PACKET != 0
    }

    #[inline(always)]
    pub fn line(self) -> usize {
        (self.0 & !Self::PACKET) as usize
    }

    /// Returns the reference for a child that has moved by `lines` cache lines.
    pub fn moved(self, lines: usize) -> Self {
        if self.is_empty() { self } else { Self(self.0 + lines as u32) }
    }
}

/// Eight boxes in SoA layout, in four cache lines. A ray test reads all bounds, so the four lines are fetched
/// together, and the children in the first line are then available without another wait for memory.
#[derive(Clone)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Bits of eight [`Child`] references. As integers, they are copied to the traversal stack together.
    pub children: [u32; 8],
    /// `bounds[2 * axis]` holds the lower bounds, `bounds[2 * axis + 1]` the upper bounds.
    pub bounds: [Row; 6],
    /// Padding that fills the last cache line.
    unused: [u32; 8],
}

impl Node {
    /// A node without children. All its boxes are inverted, so no ray hits them.
    pub fn empty() -> Self {
        let (low, high) = (Row([f32::INFINITY; 8]), Row([f32::NEG_INFINITY; 8]));
        Self { bounds: [low, high, low, high, low, high], children: [Child::EMPTY.0; 8], unused: [0; 8] }
    }

    pub fn set(&mut self, lane: usize, low: Vec3, high: Vec3, child: Child) {
        for axis in 0..3 {
            self.bounds[2 * axis].0[lane] = low[axis];
            self.bounds[2 * axis + 1].0[lane] = high[axis];
        }
        self.children[lane] = child.0;
    }

    /// Whether a lane has a child whose box satisfies the test `meets`, which takes the lower and the upper corner.
    pub fn is_met(&self, lane: usize, meets: impl Fn(Vec3, Vec3) -> bool) -> bool {
        let corner = |side: usize| Vec3::from_array([0, 1, 2].map(|axis| self.bounds[2 * axis + side].0[lane]));
        !self.child(lane).is_empty() && meets(corner(0), corner(1))
    }

    #[inline(always)]
    pub fn child(&self, lane: usize) -> Child {
        Child(self.children[lane & 7])
    }

    /// Returns a mask of the boxes that the ray may hit before `t_max`, and the distances at which it enters them. The
    /// last bits of a distance differ between processors; the margin of [`NodeRay`] exceeds this difference.
    #[inline(always)]
    pub fn intersect<L: Lanes>(&self, ray: &NodeRay<L>, t_max: f32) -> (u32, L) {
        let plane = |start: usize, axis: usize, shift: L| {
            // SAFETY: `near_start` is the byte offset of one of the six rows; flipping one bit of this offset gives
            // the offset of the neighbouring row.
            L::load(unsafe { &*self.bounds.as_ptr().byte_add(start) }).mul_add(ray.scale[axis], shift)
        };
        let enter = |axis: usize| plane(ray.near_start[axis], axis, ray.near_shift[axis]);
        let leave = |axis: usize| plane(ray.near_start[axis] ^ size_of::<Row>(), axis, ray.far_shift[axis]);
        let near = enter(0).max(enter(1)).max(enter(2).max(L::splat(0.0)));
        let far = leave(0).min(leave(1)).min(leave(2).min(L::splat(t_max)));
        (L::bits(near.le(far)), near)
    }
}

/// Margin of the box test, relative to the coordinates of the ray's origin and of the scene: sixteen rounding errors of
/// 2^-24 each. [rounding]
const MARGIN: f32 = 1.0 / (1 << 20) as f32;

/// A ray prepared for box tests. It meets the axis-aligned plane with the coordinate p at the distance
/// `p * scale + shift`.
///
/// The triangle test works on rounded coordinates and may report a hit a few units in the last place outside the
/// triangle's box. As section 3.3 of Woop et al. requires, the shifts therefore move each box's near planes towards the
/// ray and its far planes away from the ray. The margin is relative to the largest coordinate, so it follows the scale
/// of the scene.
pub(super) struct NodeRay<L> {
    /// Per axis, the byte offset in [`Node::bounds`] of the row with the planes through which the ray enters.
    near_start: [usize; 3],
    scale: [L; 3],
    near_shift: [L; 3],
    far_shift: [L; 3],
}

impl<L: Lanes> NodeRay<L> {
    #[inline(always)]
    pub fn new(ray: &PreparedRay, largest: Vec4) -> Self {
        let magnitude = ray.origin.abs() + largest;
        let dominant = Vec4::select(ray.is_dominant, magnitude, Vec4::ZERO).max_element();
        let margin = (magnitude + Vec4::splat(dominant)) * MARGIN;
        let scale = ray.inverse;
        // Keep the shifts finite for any ray. With an infinite shift, an empty box could give NaN, which would count
        // as a hit.
        let (middle, margin) = (-ray.origin * scale, margin * scale.abs());
        let (near, far) = (finite(middle - margin), finite(middle + margin));
        let is_negative = ray.direction.is_negative_bitmask() as usize;
        let start = |axis: usize| size_of::<Row>() * (2 * axis + (is_negative >> axis & 1));
        Self {
            near_start: [start(0), start(1), start(2)],
            scale: [L::splat(scale.x), L::splat(scale.y), L::splat(scale.z)],
            near_shift: [L::splat(near.x), L::splat(near.y), L::splat(near.z)],
            far_shift: [L::splat(far.x), L::splat(far.y), L::splat(far.z)],
        }
    }
}
