//! Computes the distance between two patches, with early exit; the only file of the patch engine with `unsafe` code.
//!
//! The portable and the AVX2 version add the same integers in 32 bits and stop after the same row, so they agree to
//! the bit. [`Quantiser`] (see `quantised.rs`) keeps the sum below 2³¹.
//!
//! [`Quantiser`]: super::Quantiser

use crate::simd::Level;

/// The instruction set with which distances are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kernel(Level);

/// A patch: the samples of its image from its top-left pixel on, and the number of samples per row of the image.
#[derive(Clone, Copy)]
pub struct Patch<'a> {
    pub samples: &'a [i16],
    pub row_len: usize,
}

impl Kernel {
    /// Returns the fastest kernel on this machine.
    pub fn detect() -> Self {
        Self(Level::widest())
    }

    /// Returns the sum of squared differences over `rows` rows of `run` samples (a multiple of 8). After the row in
    /// which the sum reaches `limit`, stops and returns the sum so far.
    #[inline]
    pub fn distance(self, a: Patch, b: Patch, run: usize, rows: usize, limit: u32) -> u32 {
        let end = |p: &Patch| (rows - 1) * p.row_len + run;
        assert!(rows > 0 && run.is_multiple_of(8) && end(&a) <= a.samples.len() && end(&b) <= b.samples.len());
        match self.0 {
            Level::Baseline => portable(a, b, run, rows, limit),
            // SAFETY: the processor supports the detected level and all levels below, and the assertion above keeps
            // every load inside its slice. (Rows are short: wider registers with masked ends are slower.)
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 | Level::Avx512 => unsafe { avx2(a, b, run, rows, limit) },
        }
    }
}

fn portable(a: Patch, b: Patch, run: usize, rows: usize, limit: u32) -> u32 {
    let mut total = 0u32;
    for row in 0..rows {
        let (i, j) = (row * a.row_len, row * b.row_len);
        for (&x, &y) in a.samples[i..i + run].iter().zip(&b.samples[j..j + run]) {
            let d = i32::from(x) - i32::from(y);
            total += (d * d) as u32;
        }
        if total >= limit {
            break;
        }
    }
    total
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn avx2(a: Patch, b: Patch, run: usize, rows: usize, limit: u32) -> u32 {
    use std::arch::x86_64::*;
    let mut sums = _mm256_setzero_si256();
    let mut total = 0;
    for row in 0..rows {
        // SAFETY: the caller checked that `rows` rows of `run` samples, a multiple of 8, lie inside both slices.
        unsafe {
            let mut x = a.samples.as_ptr().add(row * a.row_len);
            let mut y = b.samples.as_ptr().add(row * b.row_len);
            for _ in 0..run / 16 {
                let d = _mm256_sub_epi16(_mm256_loadu_si256(x.cast()), _mm256_loadu_si256(y.cast()));
                sums = _mm256_add_epi32(sums, _mm256_madd_epi16(d, d));
                x = x.add(16);
                y = y.add(16);
            }
            if !run.is_multiple_of(16) {
                let d = _mm_sub_epi16(_mm_loadu_si128(x.cast()), _mm_loadu_si128(y.cast()));
                sums = _mm256_add_epi32(sums, _mm256_zextsi128_si256(_mm_madd_epi16(d, d)));
            }
        }
        // Add the eight lanes of `sums`.
        let half = _mm_add_epi32(_mm256_castsi256_si128(sums), _mm256_extracti128_si256::<1>(sums));
        let pair = _mm_add_epi32(half, _mm_unpackhi_epi64(half, half));
        let one = _mm_add_epi32(pair, _mm_shuffle_epi32::<1>(pair));
        total = _mm_cvtsi128_si32(one) as u32;
        if total >= limit {
            break;
        }
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;
    use crate::simd::forced;

    #[test]
    fn all_levels_agree_to_the_bit_with_and_without_early_exit() {
        let mut rng = Rng::new(3, &[]);
        for case in 0..200 {
            let (lanes, w, width) = (8 * (1 + case % 5), 1 + case % 9, 12);
            let mut image = || -> Vec<i16> { (0..width * width * lanes).map(|_| rng.below(180) as i16).collect() };
            let (a, b) = (image(), image());
            let a = Patch { samples: &a[lanes..], row_len: width * lanes };
            let b = Patch { samples: &b[..], row_len: width * lanes };
            let full = portable(a, b, w * lanes, w, u32::MAX);
            for limit in [0, full / 2, full, full + 1, u32::MAX] {
                let want = portable(a, b, w * lanes, w, limit);
                for level in forced::levels() {
                    assert_eq!(Kernel(level).distance(a, b, w * lanes, w, limit), want, "{level:?}");
                }
                assert_eq!(want < limit, full < limit);
            }
        }
    }

    #[test]
    fn the_largest_differences_do_not_overflow() {
        let a = vec![9267i16; 25 * 16];
        let mut b = vec![0i16; 25 * 16];
        b.iter_mut().enumerate().for_each(|(i, v)| *v = if i % 16 == 0 { 0 } else { 9267 });
        let (a, b) = (Patch { samples: &a, row_len: 80 }, Patch { samples: &b, row_len: 80 });
        for level in forced::levels() {
            assert_eq!(Kernel(level).distance(a, b, 80, 5, u32::MAX), 25 * 9267 * 9267, "{level:?}");
        }
    }
}
