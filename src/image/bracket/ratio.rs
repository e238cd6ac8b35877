//! Measures the ratio of two exposures from the pixels that both show well.
//!
//! If both values of each pixel have Poisson noise, the maximum-likelihood estimate of the ratio r = long / short is
//! the sum of the long values divided by the sum of the short values. It is unbiased if the pixels are selected by the
//! sum of their two values: given this sum, each photon fell into the long exposure with the probability r / (1 + r).
//! (A selection by one of the values would favour values that noise made smaller.) Pixels that do not follow the ratio,
//! because something moved, get small Tukey weights. The standard error is computed from the spread between blocks of
//! the photo, so noise that is correlated between neighbouring pixels does not make it too small.

use super::frame::Frame;
use crate::error::Result;
use crate::exec;
use crate::image::{try_collect, try_vec};
use crate::job::Job;
use crate::maths;

/// Approximate maximum number of pixels that are read; a larger photo is read at an even lattice of pixels. With 1 % of
/// noise, this number of pixels determines the ratio to 0.003 %.
const MAX_PIXELS: usize = 1 << 18;

/// A ratio is measured only from at least `MIN_PIXELS` pixels in at least `MIN_BLOCKS` blocks of the photo.
const MIN_PIXELS: usize = 64;
const MIN_BLOCKS: usize = 4;

/// Number of blocks along each side of the photo.
const BLOCKS: usize = 8;

/// A pixel is well exposed if two conditions hold. Its expected value in the short exposure is at least the first
/// number, which is more than five steps of 8-bit sRGB. The expected value of its largest channel in the long exposure
/// is less than the second number times the clipping value. [convention]
const WELL_EXPOSED: [f64; 2] = [0.002, 0.8];

/// Tukey's constant, in standard deviations: 95 % efficiency for normal noise. [paper §4 of Beaton and Tukey 1974]
const TUKEY: f64 = 4.685;

/// Standard deviation of normal noise over its median absolute deviation. [convention]
pub const MAD_TO_SIGMA: f64 = 1.4826;

/// Minimum standard deviation of the residuals, relative to the square root of the values. It keeps weights finite for
/// photos without noise. [rounding]
const MIN_SPREAD: f64 = 1e-6;

/// Number of reweighting steps. Each step reduces the error by a factor of about 5.
const STEPS: usize = 8;

/// Range of the logarithm of the ratio, and number of bins, in the histogram that gives the first guess. [convention]
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
    /// Light of the pixel in the short and in the long exposure.
    pub short: f32,
    pub long: f32,
    /// Largest colour channel of the pixel in the short and in the long exposure.
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

/// Measures the ratio long / short of two exposures. `clip` is the clipping value of the long exposure. `None` if too
/// few pixels are well exposed in both photos, or if they lie in too few blocks.
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
    Ok(error.map(|error| Ratio { log: maths::ln(ratio), error }))
}

/// Returns the weighted median of the ratios of single pixels. The weights are the reciprocal variances of the ratios'
/// logarithms under Poisson noise.
fn first_guess(samples: &[Sample]) -> Option<f64> {
    let mut bins = [0.0; LOG_BINS];
    let width = (LOG_RANGE[1] - LOG_RANGE[0]) / LOG_BINS as f64;
    for s in samples {
        let (short, long) = (f64::from(s.short), f64::from(s.long));
        let bin = (maths::ln(long / short) - LOG_RANGE[0]) / width;
        bins[(bin.max(0.0) as usize).min(LOG_BINS - 1)] += long * short / (long + short);
    }
    let half = 0.5 * bins.iter().sum::<f64>();
    let mut below = 0.0;
    let bin = bins.iter().position(|weight| {
        below += weight;
        below >= half && below > 0.0
    })?;
    Some(maths::exp(LOG_RANGE[0] + (bin as f64 + 0.5) * width))
}

/// Whether a pixel is well exposed in both photos. The test uses the sum of the pixel's two values, so that noise does
/// not select pixels that are bright in one photo and dark in the other. In addition, the value that the short exposure
/// predicts for the long exposure must not be clipped: at the edges of lamps, one photo may show the lamp and the other
/// its surroundings.
fn is_well_exposed(s: &Sample, ratio: f64, clip: f32) -> bool {
    let short = f64::from(s.short + s.long) / (1.0 + ratio);
    let long_peak = f64::from(s.short_peak + s.long_peak) * ratio / (1.0 + ratio);
    let is_open = ratio * f64::from(s.short_peak) < f64::from(clip);
    is_open && short >= WELL_EXPOSED[0] && long_peak < WELL_EXPOSED[1] * f64::from(clip)
}

/// Computes for each sample Tukey's weight, and the slope (derivative) of the weighted residual. The residual is
/// `long - ratio * short`, divided by the square root of its expected variance. This variance depends equally on the
/// values of both photos, so that edges that lie differently in the photos have no preferred sign. `sizes` is working
/// memory with one element per sample.
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
    let variance = count as f64 / (count as f64 - 1.0) * squares / maths::powi(ratio * total, 2);
    (count >= MIN_BLOCKS).then(|| variance.sqrt())
}
