//! Per-ray values shared by the box test and the triangle test.

use super::ray::Ray;
use glam::{BVec4A, Vec4};

/// A ray in registers of four lanes, the last lane being 0, with its dominant axis.
pub(super) struct Aligned {
    pub origin: Vec4,
    pub direction: Vec4,
    /// Reciprocal of the direction, always finite: a component too small to invert is replaced by one that moves the
    /// ray by less than the margin of its boxes.
    pub inverse: Vec4,
    /// Mask of the axes with the largest absolute component; several if tied.
    pub is_dominant: BVec4A,
}

impl Aligned {
    /// `None` for rays that hit nothing: zero direction or length, or non-finite components.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Option<Self> {
        let (origin, direction) = (ray.origin.extend(0.0), ray.direction.extend(0.0));
        let size = direction.abs();
        let along = size.max_element();
        // Zero times infinity or NaN is NaN.
        let is_finite = (origin * 0.0 + direction * 0.0).cmpeq(Vec4::ZERO).all();
        let is_dominant = size.cmpeq(Vec4::splat(along));
        let limit = finite(Vec4::splat(1e12 / along));
        let inverse = (Vec4::ONE / direction).max(-limit).min(limit);
        (is_finite && along > 0.0 && ray.t_max > 0.0).then_some(Self { origin, direction, inverse, is_dominant })
    }

    /// The dominant axis; the last one if tied.
    #[inline(always)]
    pub fn dominant_axis(&self) -> usize {
        (31 - (self.is_dominant.bitmask() & 7 | 1).leading_zeros()) as usize
    }
}

/// Clamps infinities to the largest finite numbers.
#[inline(always)]
pub(super) fn finite(v: Vec4) -> Vec4 {
    v.max(Vec4::splat(f32::MIN)).min(Vec4::splat(f32::MAX))
}
