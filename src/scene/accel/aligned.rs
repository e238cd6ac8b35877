//! What the tests of boxes and of triangles both need to know of a ray.

use super::Ray;
use glam::{BVec4A, Vec4};

/// A ray in registers of four, whose last lane is 0, and its longest axis.
pub(super) struct Aligned {
    pub origin: Vec4,
    pub direction: Vec4,
    /// One over the direction, finite: a component too small to divide by is replaced by one that moves the ray less than
    /// the margin of its boxes.
    pub inverse: Vec4,
    /// Where the direction is longest; more than one axis where they are equal.
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
        let most = finite(Vec4::splat(1e12 / along));
        let inverse = (Vec4::ONE / direction).max(-most).min(most);
        (is_finite && along > 0.0 && ray.t_max > 0.0).then_some(Self { origin, direction, inverse, is_dominant })
    }

    /// The longest axis; the last of equals.
    #[inline(always)]
    pub fn dominant_axis(&self) -> usize {
        (31 - (self.is_dominant.bitmask() & 7 | 1).leading_zeros()) as usize
    }
}

/// Infinities become the largest numbers.
#[inline(always)]
pub(super) fn finite(v: Vec4) -> Vec4 {
    v.max(Vec4::splat(f32::MIN)).min(Vec4::splat(f32::MAX))
}
