//! Measures the ratio of two exposures from the pixels that both show well.
//!
//! If both values v of a pixel have Poisson noise, the maximum-likelihood estimate of the ratio r = long / short is the
//! sum of the long values divided by the sum of the short values. It is unbiased if the pixels are selected by the sum
//! of their two values: given the sum, each photon fell into the long exposure with the probability r / (1 + r). (A
//! selection by the values themselves favours values that noise made smaller.) Pixels that do not follow the ratio,
//! because something moved, get Tukey's weights. The error comes from the spread between blocks of the photo, so noise
//! that is correlated between neighbours does not make it too small.

use super::frame::Frame;
use crate::error::Result;
use crate::exec;
use crate::image::{try_collect, try_vec};
use crate::job::Job;

/// Number of pixels to look at; of larger photos, an even lattice of pixels. With 1 % of noise, this many determine the
/// ratio to 0.003 %.
const MAX_PIXELS: usize = 1 << 18;

/// A ratio is measured on at least this many pixels, in at least this many blocks.
const MIN_PIXELS: usize = 64;
const MIN_BLOCKS: usize = 4;

/// Number of blocks along each side.
const BLOCKS: usize = 8;

/// A pixel is well exposed if the short exposure is expected to show at least the first value, which is more than five
/// steps of 8-bit sRGB, and no channel of the long exposure more than the second times the clipping value.
/// [convention]
const WELL_EXPOSED: [f64; 2] = [0.002, 0.8];

/// Tukey's constant, in standard deviations: 95 % efficiency for normal noise. [paper §4 of Beaton and Tukey 1974]
const TUKEY: f64 = 4.685;

/// Standard deviation of normal noise over its median absolute deviation. [convention]
pub const MAD_TO_SIGMA: f64 = 1.4826;

/// Smallest spread, relative to the square root of the values, so that equal photos have weights. [rounding]
const MIN_SPREAD: f64 = 1e-6;

/// Number of steps of the reweighting, which converges by a factor of about 5 per step.
const STEPS: usize = 8;

/// Range and bins of the logarithm of the ratio for the first guess. [convention]
const LOG_RANGE: [f64; 2] = [-2.0, 16.0];
const LOG_BINS: usize = 1800;

/// A measured ratio of two exposures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// Natural logarithm of the ratio.
    pub log: f64,
    /// Standard error of the logarithm.
    pub error: f64,
}

/// A pixel that is clipped in neither photo.
#[derive(Clone, Copy)]
pub struct Sample {
    /// Light in the two photos.
    pub short: f32,
    pub long: f32,
    /// Largest channels in the two photos.
    short_peak: f32,
    long_peak: f32,
    block: u32,
}

/// Returns the pixels that neither photo clips. Large photos are subsampled: every n-th row and column is read.
pub fn samples(short: &Frame, long: &Frame, [width, height]: [usize; 2], job: Job) -> Result<Vec<Sample>> {
    let step = ((width * height).div_ceil(MAX_PIXELS) as f64).sqrt().ceil() as usize;
    let rows = exec::map(height.div_ceil(step), job, |row| {
        let y = row * step;
        let sample = |x: usize| {
            let ([s, s_peak], [l, l_peak]) = (short.levels(x, y)?, long.levels(x, y)?);
            let is_open = s_peak < short.clip && l_peak < long.clip && s > 0.0 && l > 0.0;
            let block = (y * BLOCKS / height * BLOCKS + x * BLOCKS / width) as u32;
            is_open.then_some(Sample { short: s, long: l, short_peak: s_peak, long_peak: l_peak, block })
        };
        (0..width).step_by(step).filter_map(sample).collect::<Vec<_>>()
    })?;
    try_collect(rows.into_iter().flatten())
}

/// Measures the ratio of two exposures; `None` if too few pixels are well exposed in both.
pub fn measure(samples: &[Sample], clip: f32) -> Result<Option<Ratio>> {
    let Some(mut ratio) = first_guess(samples) else { return Ok(None) };
    let well = try_collect(samples.iter().filter(|s| is_well_exposed(s, ratio, clip)).copied())?;
    if well.len() < MIN_PIXELS {
        return Ok(None);
    }
    let mut weights = try_vec(well.len(), [1.0; 2])?;
    let mut sizes = try_vec(well.len(), 0.0)?;
    for _ in 0..STEPS {
        reweigh(&well, ratio, &mut sizes, &mut weights);
        let sums = well
            .iter()
            .zip(&weights)
            .fold([0.0; 2], |sums, (s, [w, _])| [sums[0] + w * f64::from(s.long), sums[1] + w * f64::from(s.short)]);
        ratio = sums[0] / sums[1];
    }
    let error = error_of(&well, &weights, ratio).filter(|_| ratio.is_finite() && ratio > 0.0);
    Ok(error.map(|error| Ratio { log: ratio.ln(), error }))
}

/// The weighted median of the ratios of single pixels. The weights are the reciprocal variances of the logarithms, for
/// Poisson noise.
fn first_guess(samples: &[Sample]) -> Option<f64> {
    let mut bins = [0.0; LOG_BINS];
    let width = (LOG_RANGE[1] - LOG_RANGE[0]) / LOG_BINS as f64;
    for s in samples {
        let (short, long) = (f64::from(s.short), f64::from(s.long));
        let bin = ((long / short).ln() - LOG_RANGE[0]) / width;
        bins[(bin.max(0.0) as usize).min(LOG_BINS - 1)] += long * short / (long + short);
    }
    let half = 0.5 * bins.iter().sum::<f64>();
    let mut below = 0.0;
    let bin = bins.iter().position(|weight| {
        below += weight;
        below >= half && below > 0.0
    })?;
    Some((LOG_RANGE[0] + (bin as f64 + 0.5) * width).exp())
}

/// Whether a pixel is well exposed in both photos. This is judged by the sum of its two values, so that noise does not
/// select pixels that are bright in one photo and dark in the other. Besides, the value that the short exposure
/// predicts for the long one must not be clipped: at the edges of lamps, one photo may show the lamp and the other its
/// surroundings.
fn is_well_exposed(s: &Sample, ratio: f64, clip: f32) -> bool {
    let short = f64::from(s.short + s.long) / (1.0 + ratio);
    let long_peak = f64::from(s.short_peak + s.long_peak) * ratio / (1.0 + ratio);
    let is_open = ratio * f64::from(s.short_peak) < f64::from(clip);
    is_open && short >= WELL_EXPOSED[0] && long_peak < WELL_EXPOSED[1] * f64::from(clip)
}

/// Sets Tukey's weights for the residuals `long - ratio * short`, relative to the square root of their expected
/// variance, and the slopes of the weighted residuals. The variance depends equally on the values of both photos, so
/// that edges that lie differently in the photos have no preferred sign.
/// `sizes` is working memory with an element for each sample.
fn reweigh(samples: &[Sample], ratio: f64, sizes: &mut [f64], weights: &mut [[f64; 2]]) {
    let residual = |s: &Sample| {
        let (short, long) = (f64::from(s.short), f64::from(s.long));
        (long - ratio * short) / (long + ratio * short).sqrt()
    };
    sizes.iter_mut().zip(samples).for_each(|(size, s)| *size = residual(s).abs());
    let middle = sizes.len() / 2;
    let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
    let limit = TUKEY * (MAD_TO_SIGMA * *median).max(MIN_SPREAD);
    for (weight, s) in weights.iter_mut().zip(samples) {
        let z = residual(s) / limit;
        let inside = (1.0 - z * z).max(0.0);
        *weight = [inside * inside, inside * (1.0 - 5.0 * z * z)];
    }
}

/// The standard error of the logarithm of the ratio, from the spread between blocks: the jackknife of an M-estimate,
/// whose denominator is the sum of the slopes (Huber 1964). `None` if too few blocks have pixels.
fn error_of(samples: &[Sample], weights: &[[f64; 2]], ratio: f64) -> Option<f64> {
    let mut blocks = [[0.0; 2]; BLOCKS * BLOCKS];
    for (s, [weight, slope]) in samples.iter().zip(weights) {
        let (short, long) = (f64::from(s.short), f64::from(s.long));
        let block = &mut blocks[s.block as usize];
        block[0] += weight * (long - ratio * short);
        block[1] += slope * short;
    }
    let count = blocks.iter().filter(|[_, short]| *short != 0.0).count();
    let total: f64 = blocks.iter().map(|[_, short]| short).sum();
    let squares: f64 = blocks.iter().map(|[residual, _]| residual * residual).sum();
    let variance = count as f64 / (count as f64 - 1.0) * squares / (ratio * total).powi(2);
    (count >= MIN_BLOCKS).then(|| variance.sqrt())
}
