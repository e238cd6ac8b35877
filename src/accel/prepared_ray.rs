//! Per-ray values shared by the box test and the triangle test of the BVH traversal.

use super::ray::Ray;
use glam::{BVec4A, Vec4};

/// A ray in SIMD registers of four lanes (the fourth lane is 0), with its dominant axis.
pub(super) struct PreparedRay {
    pub origin: Vec4,
    pub direction: Vec4,
    /// Componentwise reciprocal of the direction, always finite. Direction components too small to invert get a large
    /// finite reciprocal instead of infinity; the resulting error is less than the margin that
    /// [`super::node::NodeRay`] adds to the boxes.
    pub inverse: Vec4,
    /// Mask of the axes along which the direction has its largest absolute component; several axes if tied.
    pub is_dominant: BVec4A,
}

impl PreparedRay {
    /// Prepares a ray. `None` if the ray can hit nothing, because its direction is zero, its `t_max` is not positive,
    /// or a component is not finite.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Option<Self> {
        let (origin, direction) = (ray.origin.extend(0.0), ray.direction.extend(0.0));
        let size = direction.abs();
        let along = size.max_element();
        // A number times zero is zero; infinity or NaN times zero is NaN, which compares unequal.
        let is_finite = (origin * 0.0 + direction * 0.0).cmpeq(Vec4::ZERO).all();
        let is_dominant = size.cmpeq(Vec4::splat(along));
        let limit = finite(Vec4::splat(1e12 / along));
        let inverse = (Vec4::ONE / direction).max(-limit).min(limit);
        (is_finite && along > 0.0 && ray.t_max > 0.0).then_some(Self { origin, direction, inverse, is_dominant })
    }

    /// Index of the dominant axis; the highest index if several are tied.
    #[inline(always)]
    pub fn dominant_axis(&self) -> usize {
        (31 - (self.is_dominant.bitmask() & 7 | 1).leading_zeros()) as usize
    }
}

/// Replaces infinities by the largest finite numbers of the same sign.
#[inline(always)]
pub(super) fn finite(v: Vec4) -> Vec4 {
    v.max(Vec4::splat(f32::MIN)).min(Vec4::splat(f32::MAX))
}
