//! SIMD lanes: four neighbouring pixels of one or three channels in vector registers.
//!
//! Every instruction set performs the operations in the same order, so sums are identical to the bit.

use glam::{Vec4, Vec4Swizzles};

/// Number of taps along each side of a pixel's filter. It is also the number of source pixels that one load reads.
pub const TAPS: usize = 4;

/// Maximum number of samples that [`PixelLanes::load`] reads with three channels: four pixels and the samples after
/// them that fill the register.
pub const MAX_READ: usize = 16;

/// Four neighbouring pixels with one channel or three.
pub trait PixelLanes: Copy {
    const CHANNELS: usize;
    /// Number of samples that one load reads.
    const READ: usize;

    /// # Safety
    /// At least [`Self::READ`] samples must be readable at `from`.
    unsafe fn load(from: *const f32) -> Self;
    /// Hints that the memory at `from` will be read soon; any address is allowed.
    #[inline(always)]
    fn prefetch(_from: *const f32) {}
    /// Broadcasts the weight of each pixel to all its channels.
    fn spread(weights: &[f32; TAPS]) -> Self;
    fn splat(value: f32) -> Self;
    fn mul(self, other: Self) -> Self;
    fn add(self, other: Self) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    /// Returns the sum of the four pixels for each channel. The lanes beyond the channels are undefined, here and in
    /// the results of `min_over_pixels` and `max_over_pixels`.
    fn sum(self) -> Vec4;
    fn min_over_pixels(self) -> Vec4;
    fn max_over_pixels(self) -> Vec4;
}

/// Four pixels of one channel, in one register.
#[derive(Clone, Copy)]
pub struct GreyLanes(Vec4);

impl GreyLanes {
    #[inline(always)]
    fn fold(self, f: impl Fn(Vec4, Vec4) -> Vec4) -> Vec4 {
        let pairs = f(self.0, self.0.zwxy());
        f(pairs, pairs.yxwz())
    }
}

impl PixelLanes for GreyLanes {
    const CHANNELS: usize = 1;
    const READ: usize = 4;

    #[inline(always)]
    unsafe fn load(from: *const f32) -> Self {
        // SAFETY: by the contract of `load`.
        Self(Vec4::from_array(unsafe { from.cast::<[f32; 4]>().read_unaligned() }))
    }

    #[inline(always)]
    fn spread(weights: &[f32; TAPS]) -> Self {
        Self(Vec4::from_array(*weights))
    }

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(Vec4::splat(value))
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }

    #[inline(always)]
    fn sum(self) -> Vec4 {
        self.fold(|a, b| a + b)
    }

    #[inline(always)]
    fn min_over_pixels(self) -> Vec4 {
        self.fold(Vec4::min)
    }

    #[inline(always)]
    fn max_over_pixels(self) -> Vec4 {
        self.fold(Vec4::max)
    }
}

/// Four pixels of three interleaved channels, in three registers of four lanes.
#[derive(Clone, Copy)]
pub struct RgbLanes([Vec4; 3]);

impl RgbLanes {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(Vec4, Vec4) -> Vec4) -> Self {
        Self(std::array::from_fn(|k| f(self.0[k], other.0[k])))
    }

    #[inline(always)]
    fn fold(self, f: impl Fn(Vec4, Vec4) -> Vec4) -> Vec4 {
        let [a, b, c] = self.0;
        let second = Vec4::new(a.w, b.x, b.y, b.y);
        let third = Vec4::new(b.z, b.w, c.x, c.x);
        f(f(a, third), f(second, c.yzww()))
    }
}

impl PixelLanes for RgbLanes {
    const CHANNELS: usize = 3;
    const READ: usize = 12;

    #[inline(always)]
    unsafe fn load(from: *const f32) -> Self {
        // SAFETY: by the contract of `load`.
        let samples = unsafe { from.cast::<[[f32; 4]; 3]>().read_unaligned() };
        Self(samples.map(Vec4::from_array))
    }

    #[inline(always)]
    fn spread(weights: &[f32; TAPS]) -> Self {
        let weights = Vec4::from_array(*weights);
        Self([weights.xxxy(), weights.yyzz(), weights.zwww()])
    }

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self([Vec4::splat(value); 3])
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, Vec4::min)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, Vec4::max)
    }

    #[inline(always)]
    fn sum(self) -> Vec4 {
        self.fold(|a, b| a + b)
    }

    #[inline(always)]
    fn min_over_pixels(self) -> Vec4 {
        self.fold(Vec4::min)
    }

    #[inline(always)]
    fn max_over_pixels(self) -> Vec4 {
        self.fold(Vec4::max)
    }
}

#[cfg(target_arch = "x86_64")]
pub use avx512::RgbLanesAvx512;

#[cfg(target_arch = "x86_64")]
mod avx512 {
    use super::{MAX_READ, PixelLanes, TAPS};
    use glam::Vec4;
    use std::arch::x86_64::*;

    /// Four pixels of three channels in one register of sixteen lanes, of which twelve are used. Use this type only in
    /// functions compiled for AVX-512, into which its methods are inlined.
    #[derive(Clone, Copy)]
    pub struct RgbLanesAvx512(__m512);

    // SAFETY of all blocks below: users of `RgbLanesAvx512` ensure that the processor supports AVX-512.

    /// Combines the first pixel with the third and the second with the fourth, then combines the two results.
    macro_rules! fold {
        ($of:expr, $of_eight:ident, $of_four:ident) => {
            unsafe {
                let all = _mm512_castps_si512($of.0);
                let upper = _mm512_castps512_ps256(_mm512_castsi512_ps(_mm512_alignr_epi32::<6>(all, all)));
                let half = $of_eight(_mm512_castps512_ps256($of.0), upper);
                let bits = _mm256_castps_si256(half);
                let upper = _mm256_castps256_ps128(_mm256_castsi256_ps(_mm256_alignr_epi32::<3>(bits, bits)));
                Vec4::from($of_four(_mm256_castps256_ps128(half), upper))
            }
        };
    }

    impl PixelLanes for RgbLanesAvx512 {
        const CHANNELS: usize = 3;
        const READ: usize = MAX_READ;

        #[inline(always)]
        unsafe fn load(from: *const f32) -> Self {
            Self(unsafe { _mm512_loadu_ps(from) })
        }

        #[inline(always)]
        fn prefetch(from: *const f32) {
            unsafe { _mm_prefetch::<_MM_HINT_T0>(from.cast()) }
        }

        #[inline(always)]
        fn spread(weights: &[f32; TAPS]) -> Self {
            unsafe {
                let lanes = _mm512_setr_epi32(0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 3, 3, 3, 3);
                let weights = _mm512_castps128_ps512(_mm_loadu_ps(weights.as_ptr()));
                Self(_mm512_permutexvar_ps(lanes, weights))
            }
        }

        #[inline(always)]
        fn splat(value: f32) -> Self {
            Self(unsafe { _mm512_set1_ps(value) })
        }

        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            Self(unsafe { _mm512_mul_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn add(self, other: Self) -> Self {
            Self(unsafe { _mm512_add_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn min(self, other: Self) -> Self {
            Self(unsafe { _mm512_min_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(unsafe { _mm512_max_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn sum(self) -> Vec4 {
            fold!(self, _mm256_add_ps, _mm_add_ps)
        }

        #[inline(always)]
        fn min_over_pixels(self) -> Vec4 {
            fold!(self, _mm256_min_ps, _mm_min_ps)
        }

        #[inline(always)]
        fn max_over_pixels(self) -> Vec4 {
            fold!(self, _mm256_max_ps, _mm_max_ps)
        }
    }
}
