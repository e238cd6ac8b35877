//! What the filter states about its result: the bias, the error, and the interval of each pixel.
//!
//! All three are computed from the two halves before and after filtering; `choice` explains the formulas. The formulas
//! hold for halves that are independent of each other. But the filtered halves depend on each other, so the formulas
//! alone state too small an error. The dependence has four causes; the first has the largest effect:
//!
//! - Both halves are filtered by the same guides, which come from the paths of both. At edges and in textures, the
//!   noise of the guides follows the noise of the halves.
//! - The statistical test uses the same variance for both halves; the variance comes from the difference of the halves.
//! - Both halves take the result of one pass: the pass with the least of several noisy error estimates.
//! - Light that comes by rare paths is usually missing from both halves.
//!
//! The filtered halves then agree more than independent halves would. The missing error is taken as a share of the
//! variance that the filter removes (docs/notes/filter.md has the measurements), and the statement adds this share
//! ([`SHARED`]) to the variance.

use super::light::Light;
use super::planes::{Classes, Planes};
use crate::error::Result;
use crate::exec;
use crate::image::{Image, colour};
use crate::job::Job;

/// Half-width, in standard deviations, of the interval that contains 95 % of a normal distribution. [convention]
const NORMAL_95: f32 = 1.959_964;
/// Side of the squares over which the bias is averaged, in pixels. [convention]
const SQUARE: usize = 8;
/// Radius in pixels of the neighbourhood over which squared errors are averaged to compute a pixel's interval.
/// [bench filter]
const INTERVAL_RADIUS: usize = 8;
/// Squared error that is common to both halves, as a share of the variance that the filter removes: for pixels within
/// surfaces, and for pixels at edges of surfaces. [bench filter]
const SHARED: [f32; 2] = [0.045, 0.3];

/// The statements of the filter about its result; `Output` describes the fields.
pub struct Statement {
    pub interval: Image,
    pub error: f64,
    pub bias: f64,
}

impl Statement {
    /// Returns the statements about the mean of two filtered halves.
    pub fn of(light: &Light, classes: &Classes, before: [&Image; 2], after: [&Image; 2], job: Job) -> Result<Self> {
        let Image { width, height, .. } = *before[0];
        let errors = squared_errors(classes, before, after, job.part(0.0, 0.2))?;
        let pixels = (3 * width * height) as f64;
        let mean: f64 =
            before.iter().flat_map(|image| &image.data).map(|&v| f64::from(v)).sum::<f64>() / (2.0 * pixels);
        let is_known = (0..height).all(|y| (0..width).all(|x| light.is_known(x, y)));
        let error = match mean > 0.0 {
            _ if !is_known => f64::INFINITY,
            true => (squared_error(&errors) / pixels).sqrt() / mean,
            false => 0.0,
        };
        let around = classes.smoothed(&errors, INTERVAL_RADIUS, job.part(0.2, 0.7))?;
        let mut interval = Image::new(width, height, 3)?;
        exec::for_rows(&mut interval.data, 3 * width, job.part(0.7, 0.8), |y, row| {
            for (x, out) in row.chunks_exact_mut(3).enumerate() {
                for (c, out) in out.iter_mut().enumerate() {
                    let [bias, variance] = [c, c + 3].map(|channel| around.row(y, channel)[x]);
                    let half_width = NORMAL_95 * (bias.max(0.0) + variance).sqrt();
                    *out = if light.is_known(x, y) { half_width } else { f32::INFINITY };
                }
            }
        })?;
        let bias = bias(before, after, job.part(0.8, 1.0))?;
        Ok(Self { interval, error, bias })
    }
}

/// Returns the squared error: the squared bias plus the variance, summed over all pixels and channels. If noise makes
/// the estimated sum of the squared biases negative, this sum counts as 0.
fn squared_error(errors: &Planes) -> f64 {
    let (mut bias, mut variance) = (0.0, 0.0);
    for y in 0..errors.height {
        let sum = |channel: usize| errors.row(y, channel).iter().map(|&v| f64::from(v)).sum::<f64>();
        bias += (0..3).map(sum).sum::<f64>();
        variance += (3..6).map(sum).sum::<f64>();
    }
    bias.max(0.0) + variance
}

/// Returns six channels: estimates of the squared bias of each pixel (R, G, B), then of the variance of the mean of the
/// two filtered halves plus the squared error common to both halves ([`SHARED`]; R, G, B). The estimates are accurate
/// only as means over many pixels.
fn squared_errors(classes: &Classes, before: [&Image; 2], after: [&Image; 2], job: Job) -> Result<Planes> {
    let Image { width, height, .. } = *before[0];
    Planes::from_rows([width, height, 6], job, |y, row| {
        let (biases, variances) = row.split_at_mut(3 * width);
        for x in 0..width {
            let [a, b, c, d] = [before[0], before[1], after[0], after[1]].map(|image| image.rgb(x, y));
            let shared = SHARED[usize::from(classes.is_first.row(y, 0)[x] > 0.0)];
            let (bias, unfiltered, filtered) = ((c - a) * (d - b), 0.25 * (a - b) * (a - b), 0.25 * (c - d) * (c - d));
            let variance = filtered + shared * (unfiltered - filtered);
            for channel in 0..3 {
                biases[channel * width + x] = bias[channel];
                variances[channel * width + x] = variance[channel];
            }
        }
    })
}

/// Estimates the bias of the filter, relative to the mean of the image, from the two halves before and after
/// filtering. For each square of pixels, multiplies the mean change of one half by the mean change of the other half.
/// The bias is the square root of the mean of these products; a negative mean counts as 0.
fn bias(before: [&Image; 2], after: [&Image; 2], job: Job) -> Result<f64> {
    let Image { width, height, .. } = *before[0];
    let across = width.div_ceil(SQUARE);
    let squares = exec::map(across * height.div_ceil(SQUARE), job, |square| {
        let (left, top) = (square % across * SQUARE, square / across * SQUARE);
        let (mut moved, mut light, mut count) = ([0.0; 2], 0.0, 0.0);
        for y in top..(top + SQUARE).min(height) {
            for x in left..(left + SQUARE).min(width) {
                for half in 0..2 {
                    let [before, after] = [before, after].map(|i| f64::from(colour::luminance(i[half].rgb(x, y))));
                    moved[half] += after - before;
                    light += before / 2.0;
                }
                count += 1.0;
            }
        }
        (moved[0] * moved[1] / count, light, count)
    })?;
    let (squared, light, count) = squares.iter().fold((0.0, 0.0, 0.0), |a, s| (a.0 + s.0, a.1 + s.1, a.2 + s.2));
    Ok(if light > 0.0 { f64::max(squared / count, 0.0).sqrt() * count / light } else { 0.0 })
}
