//! SIMD arithmetic on eight `f32` lanes: one AVX2 register, or two baseline registers of four lanes.
//!
//! Every operation except [`Lanes::mul_add`] rounds as IEEE 754 prescribes. Computations without `mul_add` therefore
//! give identical results on every processor.

use glam::{BVec4A, Vec4};

/// Eight values in memory: 32 bytes, aligned to 32.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Row(pub [f32; 8]);

pub(super) trait Lanes: Copy {
    /// The result of a comparison, with one truth value per lane.
    type Mask: Copy;

    fn splat(value: f32) -> Self;
    fn load(row: &Row) -> Self;
    /// Loads eight values that need not be aligned.
    fn load_from(values: &[f32; 8]) -> Self;
    fn store(self) -> Row;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    /// The smaller value per lane. If one operand is NaN, the result is `other`; this holds for `max` too.
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn abs(self) -> Self;
    /// In each lane, replaces the bits that are set in `mask` by the bits of `others`, which must have no bits outside
    /// the mask.
    fn with_bits(self, mask: u32, others: &[u32; 8]) -> Self;
    /// `self * factor + term`, rounded once or twice depending on the processor. Use it only for bounds that have a
    /// margin.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    fn le(self, other: Self) -> Self::Mask;
    fn lt(self, other: Self) -> Self::Mask;
    fn eq(self, other: Self) -> Self::Mask;
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Returns an integer whose bit `i` is set if lane `i` is true.
    fn bits(mask: Self::Mask) -> u32;
    /// Writes `payload[i]` as a `u64` for every lane `i` in `mask`, in lane order and without gaps. It may overwrite
    /// all eight entries at `to`: entries that the mask does not fill receive arbitrary values.
    ///
    /// # Safety
    /// Eight entries must be writable at `to`.
    unsafe fn pick(payload: &[u32; 8], mask: u32, to: *mut u64);
}

/// Two registers of four lanes: SSE2 on x86-64, NEON on aarch64, scalar code elsewhere.
#[derive(Clone, Copy)]
pub(super) struct Baseline([Vec4; 2]);

impl Baseline {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(Vec4, Vec4) -> Vec4) -> Self {
        Self([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(Vec4, Vec4) -> BVec4A) -> [BVec4A; 2] {
        [f(self.0[0], other.0[0]), f(self.0[1], other.0[1])]
    }
}

impl Lanes for Baseline {
    type Mask = [BVec4A; 2];

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self([Vec4::splat(value); 2])
    }

    #[inline(always)]
    fn load(row: &Row) -> Self {
        Self([Vec4::from_slice(&row.0[..4]), Vec4::from_slice(&row.0[4..])])
    }

    #[inline(always)]
    fn load_from(values: &[f32; 8]) -> Self {
        Self([Vec4::from_slice(&values[..4]), Vec4::from_slice(&values[4..])])
    }

    #[inline(always)]
    fn store(self) -> Row {
        let mut row = Row([0.0; 8]);
        self.0[0].write_to_slice(&mut row.0[..4]);
        self.0[1].write_to_slice(&mut row.0[4..]);
        row
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| Vec4::select(a.cmplt(b), a, b))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| Vec4::select(a.cmpgt(b), a, b))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(Vec4::abs))
    }

    #[inline(always)]
    fn with_bits(self, mask: u32, others: &[u32; 8]) -> Self {
        let mut row = self.store();
        row.0.iter_mut().zip(others).for_each(|(value, bits)| *value = f32::from_bits(value.to_bits() & !mask | bits));
        Self::load(&row)
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self.mul(factor).add(term)
    }

    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        self.compare(other, Vec4::cmple)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        self.compare(other, Vec4::cmplt)
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Self::Mask {
        self.compare(other, Vec4::cmpeq)
    }

    #[inline(always)]
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        [a[0] & b[0], a[1] & b[1]]
    }

    #[inline(always)]
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        [a[0] | b[0], a[1] | b[1]]
    }

    #[inline(always)]
    fn bits(mask: Self::Mask) -> u32 {
        mask[0].bitmask() | mask[1].bitmask() << 4
    }

    #[inline(always)]
    unsafe fn pick(payload: &[u32; 8], mut mask: u32, mut to: *mut u64) {
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize & 7;
            mask &= mask - 1;
            // SAFETY: the mask has at most eight bits, so at most eight entries are written.
            unsafe {
                to.write(u64::from(payload[lane]));
                to = to.add(1);
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use avx2::Avx2;

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{Lanes, Row};
    use std::arch::x86_64::*;

    /// One register of eight lanes, for processors with AVX2 and FMA only. `Accel` checks the processor once, when it
    /// is built. Everything below is inlined into functions compiled for these instructions.
    #[derive(Clone, Copy)]
    pub struct Avx2(__m256);

    /// For each mask of eight lanes, the indices of its set lanes in ascending order: one index per byte, lowest byte
    /// first.
    static LANES_OF: [u64; 256] = {
        let mut table = [0; 256];
        let mut mask = 0;
        while mask < 256 {
            let (mut lane, mut place) = (0, 0);
            while lane < 8 {
                if mask >> lane & 1 != 0 {
                    table[mask] |= (lane as u64) << (8 * place);
                    place += 1;
                }
                lane += 1;
            }
            mask += 1;
        }
        table
    };

    impl Lanes for Avx2 {
        type Mask = __m256;

        // SAFETY of all blocks below: the processor supports AVX2, as `Avx2` requires; rows are aligned to 32 bytes.

        #[inline(always)]
        fn splat(value: f32) -> Self {
            Self(unsafe { _mm256_set1_ps(value) })
        }

        #[inline(always)]
        fn load(row: &Row) -> Self {
            Self(unsafe { _mm256_load_ps(row.0.as_ptr()) })
        }

        #[inline(always)]
        fn load_from(values: &[f32; 8]) -> Self {
            Self(unsafe { _mm256_loadu_ps(values.as_ptr()) })
        }

        #[inline(always)]
        fn store(self) -> Row {
            let mut row = Row([0.0; 8]);
            unsafe { _mm256_store_ps(row.0.as_mut_ptr(), self.0) };
            row
        }

        #[inline(always)]
        fn add(self, other: Self) -> Self {
            Self(unsafe { _mm256_add_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            Self(unsafe { _mm256_sub_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            Self(unsafe { _mm256_mul_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn div(self, other: Self) -> Self {
            Self(unsafe { _mm256_div_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn min(self, other: Self) -> Self {
            Self(unsafe { _mm256_min_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(unsafe { _mm256_max_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn abs(self) -> Self {
            Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
        }

        #[inline(always)]
        fn with_bits(self, mask: u32, others: &[u32; 8]) -> Self {
            unsafe {
                let kept = _mm256_andnot_ps(_mm256_castsi256_ps(_mm256_set1_epi32(mask as i32)), self.0);
                Self(_mm256_or_ps(kept, _mm256_castsi256_ps(_mm256_loadu_si256(others.as_ptr().cast()))))
            }
        }

        #[inline(always)]
        fn mul_add(self, factor: Self, term: Self) -> Self {
            Self(unsafe { _mm256_fmadd_ps(self.0, factor.0, term.0) })
        }

        #[inline(always)]
        fn le(self, other: Self) -> __m256 {
            unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) }
        }

        #[inline(always)]
        fn lt(self, other: Self) -> __m256 {
            unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0) }
        }

        #[inline(always)]
        fn eq(self, other: Self) -> __m256 {
            unsafe { _mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, other.0) }
        }

        #[inline(always)]
        fn and(a: __m256, b: __m256) -> __m256 {
            unsafe { _mm256_and_ps(a, b) }
        }

        #[inline(always)]
        fn or(a: __m256, b: __m256) -> __m256 {
            unsafe { _mm256_or_ps(a, b) }
        }

        #[inline(always)]
        fn bits(mask: __m256) -> u32 {
            unsafe { _mm256_movemask_ps(mask) as u32 }
        }

        #[inline(always)]
        unsafe fn pick(payload: &[u32; 8], mask: u32, to: *mut u64) {
            unsafe {
                let lanes = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(LANES_OF[mask as usize & 255] as i64));
                let payload = _mm256_permutevar8x32_epi32(_mm256_loadu_si256(payload.as_ptr().cast()), lanes);
                let (low, high) = (_mm256_castsi256_si128(payload), _mm256_extracti128_si256::<1>(payload));
                _mm256_storeu_si256(to.cast(), _mm256_cvtepu32_epi64(low));
                _mm256_storeu_si256(to.add(4).cast(), _mm256_cvtepu32_epi64(high));
            }
        }
    }
}

/// Removes the lowest lane from a non-empty mask and returns it.
#[inline(always)]
pub(super) fn take_lowest(mask: &mut u32) -> usize {
    let lane = mask.trailing_zeros() as usize & 7;
    *mask &= *mask - 1;
    lane
}

/// Removes the highest lane from a non-empty mask and returns it.
#[inline(always)]
pub(super) fn take_highest(mask: &mut u32) -> usize {
    let lane = mask.ilog2() as usize & 7;
    *mask ^= 1 << lane;
    lane
}
