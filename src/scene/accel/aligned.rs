//! What the tests of boxes and of triangles both need to know of a ray.

use super::Ray;
use glam::{BVec4A, Vec4};

/// A ray in registers of four, whose last lane is 0, and its longest axis.
pub(super) struct Aligned {
    pub origin: Vec4,
    pub direction: Vec4,
    /// Absolute values of the direction.
    pub size: Vec4,
    /// The largest of them.
    pub along: f32,
    /// Where that is; more than one axis where they are equal.
    pub is_dominant: BVec4A,
}

impl Aligned {
    /// None for a ray that hits nothing: of no direction or length, or of numbers that are not finite.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Option<Self> {
        let (origin, direction) = (ray.origin.extend(0.0), ray.direction.extend(0.0));
        let size = direction.abs();
        let along = size.max_element();
        // Zero times an infinity or NaN is NaN.
        let is_finite = (origin * 0.0 + direction * 0.0).cmpeq(Vec4::ZERO).all();
        let is_dominant = size.cmpeq(Vec4::splat(along));
        (is_finite && along > 0.0 && ray.t_max > 0.0).then_some(Self { origin, direction, size, along, is_dominant })
    }

    /// The longest axis; the last of equals.
    #[inline(always)]
    pub fn dominant_axis(&self) -> usize {
        (31 - (self.is_dominant.bitmask() & 7 | 1).leading_zeros()) as usize
    }
}
