//! Images whose channels are quantised for matching.

use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_vec};
use crate::job::Job;

/// The number of samples per pixel is padded to a multiple of this: half an AVX2 register of `i16`.
pub const LANES: usize = 8;

/// Largest quantised sample: a round number below the largest 16-bit integer. [rounding]
const MAX_SAMPLE: f64 = 32_000.0;
/// Share of 2³¹ up to which sums of squared differences may come before rounding. Rounding can lengthen each difference
/// by one step; the margin of two per cent leaves room for that. [rounding]
const MAX_SUM_SHARE: f64 = 0.98;

/// Interleaved 16-bit channels, each multiplied by the square root of its weight, so that a plain sum of squared
/// differences equals the weighted sum of Eq. 1 of StyLit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QuantisedImage {
    pub width: usize,
    pub height: usize,
    /// Number of samples per pixel, a multiple of [`LANES`]; samples beyond the channels are 0.
    pub lanes: usize,
    pub data: Vec<i16>,
}

impl QuantisedImage {
    pub fn new(width: usize, height: usize, channels: usize) -> Result<Self> {
        let lanes = channels.div_ceil(LANES) * LANES;
        Ok(Self { width, height, lanes, data: try_vec(width * height * lanes, 0)? })
    }

    pub fn row_len(&self) -> usize {
        self.width * self.lanes
    }

    /// Quantises the channels of `image`, in `[0, 1]`, into consecutive channels from `first` on.
    pub fn fill(&mut self, first: usize, quantisers: &[Quantiser], image: &Image, job: Job) -> Result<()> {
        let (lanes, row_len) = (self.lanes, self.row_len());
        exec::for_rows(&mut self.data, row_len, job, |y, row| {
            for (pixel, values) in row.chunks_exact_mut(lanes).zip(image.row(y).chunks_exact(quantisers.len())) {
                for ((out, q), v) in pixel[first..].iter_mut().zip(quantisers).zip(values) {
                    *out = q.quantise(*v);
                }
            }
        })
    }
}

/// Converts a value in `[0, 1]` of a channel to an integer, scaled by the square root of the channel's weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantiser {
    scale: f32,
}

impl Quantiser {
    /// Returns quantisers for channels of the given weights (≥ 0, at least one positive). The quantisers are as fine as
    /// two limits allow: a sample is at most 32,000, and the sum of squared differences between two patches of width
    /// `patch` stays below 2³¹.
    pub fn for_weights(weights: &[f64], patch: usize) -> Vec<Self> {
        let unit = Self::unit(weights, patch);
        weights.iter().map(|w| Self { scale: (w.sqrt() * unit).min(MAX_SAMPLE) as f32 }).collect()
    }

    /// Returns the scale of a channel of weight 1: the number to which the value 1 is quantised, before rounding.
    pub fn unit(weights: &[f64], patch: usize) -> f64 {
        let total: f64 = weights.iter().sum();
        (MAX_SUM_SHARE * f64::from(i32::MAX) / ((patch * patch) as f64 * total)).sqrt()
    }

    pub fn quantise(self, value: f32) -> i16 {
        // Add one half and truncate: this rounds to the nearest integer, because the value is not negative.
        // `f32::round` would call the C library.
        (value.clamp(0.0, 1.0) * self.scale + 0.5) as i16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_patch_distance_fits_for_any_number_of_channels_and_weights() {
        for (channels, patch, weight) in [(1, 1, 1.0), (3, 5, 1e6), (64, 15, 0.3), (64, 33, 1e-6)] {
            let mut weights = vec![weight; channels];
            weights[0] = 1.0;
            let worst: u64 = Quantiser::for_weights(&weights, patch)
                .iter()
                .map(|q| (q.quantise(1.0) as u64).pow(2) * (patch * patch) as u64)
                .sum();
            assert!(worst < 1 << 31, "{channels} {patch}: {worst}");
        }
    }

    #[test]
    fn squared_steps_keep_the_ratio_of_the_weights() {
        let q = Quantiser::for_weights(&[1.0, 4.0, 0.0], 5);
        let square = |q: Quantiser| f64::from(q.quantise(1.0)).powi(2);
        assert!((square(q[1]) / square(q[0]) - 4.0).abs() < 0.01);
        assert_eq!(q[2].quantise(1.0), 0);
        assert_eq!(q[1].quantise(f32::NAN), 0);
    }
}
