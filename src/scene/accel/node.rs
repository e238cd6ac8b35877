//! Nodes of eight children and the conservative test of a ray against their boxes.

use super::Ray;
use glam::{Vec3, Vec4};

/// What a node points to: another node, a packet of triangles, or nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Child(u32);

impl Child {
    pub const EMPTY: Self = Self(u32::MAX);
    const PACKET: u32 = 1 << 31;

    pub fn of_node(index: usize) -> Self {
        Self(index as u32)
    }

    pub fn of_packet(index: usize) -> Self {
        Self(index as u32 | Self::PACKET)
    }

    pub fn is_empty(self) -> bool {
        self == Self::EMPTY
    }

    pub fn packet(self) -> Option<usize> {
        (self.0 & Self::PACKET != 0).then_some((self.0 & !Self::PACKET) as usize)
    }

    pub fn node(self) -> usize {
        self.0 as usize
    }
}

/// Eight boxes side by side: `bounds[2 * axis]` are their low ends, `bounds[2 * axis + 1]` their high ends.
#[derive(Clone)]
#[repr(C, align(32))]
pub(super) struct Node {
    pub bounds: [[f32; 8]; 6],
    pub children: [Child; 8],
}

impl Node {
    /// No children: every box is inside out, so no ray hits it.
    pub fn empty() -> Self {
        let (low, high) = ([f32::INFINITY; 8], [f32::NEG_INFINITY; 8]);
        Self { bounds: [low, high, low, high, low, high], children: [Child::EMPTY; 8] }
    }

    pub fn set(&mut self, lane: usize, low: Vec3, high: Vec3, child: Child) {
        for axis in 0..3 {
            self.bounds[2 * axis][lane] = low[axis];
            self.bounds[2 * axis + 1][lane] = high[axis];
        }
        self.children[lane] = child;
    }

    /// Mask of the boxes a ray may meet before `t_max`, and where it enters each.
    #[inline(always)]
    pub fn intersect(&self, ray: &NodeRay, t_max: f32) -> (u32, [f32; 8]) {
        let mut mask = 0;
        let mut entry = [0.0; 8];
        for half in [0, 4] {
            let plane = |side: usize, scale: f32, shift: f32| {
                Vec4::from_slice(&self.bounds[side][half..half + 4]) * Vec4::splat(scale) + Vec4::splat(shift)
            };
            let mut near = Vec4::ZERO;
            let mut far = Vec4::splat(t_max);
            for axis in 0..3 {
                near = near.max(plane(ray.near_side[axis], ray.near_scale[axis], ray.near_shift[axis]));
                far = far.min(plane(ray.near_side[axis] ^ 1, ray.far_scale[axis], ray.far_shift[axis]));
            }
            mask |= near.cmple(far).bitmask() << half;
            near.write_to_slice(&mut entry[half..half + 4]);
        }
        (mask, entry)
    }

    /// The same with eight lanes at a time. Rounding differs in the last bit, which the margin of [`NodeRay`] covers.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    #[inline]
    pub fn intersect_avx2(&self, ray: &NodeRay, t_max: f32) -> (u32, [f32; 8]) {
        use std::arch::x86_64::*;
        let mut near = _mm256_setzero_ps();
        let mut far = _mm256_set1_ps(t_max);
        for axis in 0..3 {
            let side = ray.near_side[axis] & 7;
            // SAFETY: both rows hold eight floats and start at a multiple of 32 bytes, as the node does.
            let (low, high) =
                unsafe { (_mm256_load_ps(self.bounds[side].as_ptr()), _mm256_load_ps(self.bounds[side ^ 1].as_ptr())) };
            let enter =
                _mm256_fmadd_ps(low, _mm256_set1_ps(ray.near_scale[axis]), _mm256_set1_ps(ray.near_shift[axis]));
            let leave = _mm256_fmadd_ps(high, _mm256_set1_ps(ray.far_scale[axis]), _mm256_set1_ps(ray.far_shift[axis]));
            near = _mm256_max_ps(near, enter);
            far = _mm256_min_ps(far, leave);
        }
        let mask = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far)) as u32;
        let mut entry = [0.0; 8];
        // SAFETY: the array holds eight floats.
        unsafe { _mm256_storeu_ps(entry.as_mut_ptr(), near) };
        (mask, entry)
    }
}

/// A ray prepared for boxes: the distance to a plane is `plane * scale + shift`.
///
/// The triangle test works on rounded coordinates and may report a hit a few units in the last place outside the box of
/// its triangle; so the near planes are moved towards the ray and the far planes away, as section 3.3 of Woop et al.
/// asks for. The margin is counted in units of the largest coordinate met, so it follows the scale of the scene.
pub(super) struct NodeRay {
    /// Row of [`Node::bounds`] through which the ray enters, per axis.
    near_side: [usize; 3],
    near_scale: [f32; 3],
    near_shift: [f32; 3],
    far_scale: [f32; 3],
    far_shift: [f32; 3],
}

impl NodeRay {
    #[inline(always)]
    pub fn new(ray: &Ray, low: Vec3, high: Vec3) -> Self {
        // Eight rounding errors, of 2^-24 each.
        const MARGIN: f32 = 1.0 / (1 << 21) as f32;
        let reach = ray.origin.abs() + low.abs().max(high.abs());
        let along = ray.direction.abs().max_element();
        let dominant = (0..3).find(|&k| ray.direction[k].abs() == along).unwrap_or(2);
        let margin = (reach + Vec3::splat(reach[dominant])) * MARGIN;
        let (mut near_side, mut near_scale, mut near_shift) = ([0; 3], [0.0; 3], [0.0; 3]);
        let (mut far_scale, mut far_shift) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            // A component too small to divide by is replaced by one that moves the ray less than the margin.
            let least = along * 1e-18;
            let d = ray.direction[axis];
            let d = if d.abs() < least { least.copysign(d) } else { d };
            let scale = 1.0 / d;
            let (o, m) = (ray.origin[axis], margin[axis].copysign(d));
            near_side[axis] = 2 * axis + usize::from(d.is_sign_negative());
            near_scale[axis] = scale;
            near_shift[axis] = -(o + m) * scale;
            far_scale[axis] = scale * (1.0 + MARGIN);
            far_shift[axis] = -(o - m) * far_scale[axis];
        }
        Self { near_side, near_scale, near_shift, far_scale, far_shift }
    }
}
