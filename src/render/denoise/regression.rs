//! One pass of the filter: for each pixel, fits a plane `value = p + q x + r y` to the neighbours by weighted least
//! squares, where (x, y) is the offset of a neighbour from the pixel, in taps. The filtered value is p (first-order
//! regression, as by Bitterli et al. 2016, here over the pixel coordinates). The pass without a pilot takes the
//! weighted mean instead.
//!
//! A neighbour's weight is the product of four factors:
//!
//! - a Gaussian of its distance in taps;
//! - exp(-d), where d is its distance in the guides (`guides`);
//! - exp(-t / tolerance), where t is the squared difference of the two pilot values divided by the sum of their
//!   variances (the square of Welch's t, as by Sakai et al. 2024), averaged over the channels;
//! - its confidence (`light`).

use super::guides::Guides;
use super::light::LIGHT;
use super::planes::{Planes, Shift};
use crate::error::Result;
use crate::image::try_vec;
use crate::job::Job;
use crate::maths;
use crate::simd::widest;

/// Number of taps along each axis, on either side of a pixel. [convention: 5 x 5 taps, as in à-trous filters]
const RADIUS: isize = 2;
/// Standard deviation of the Gaussian over the taps, in taps. [bench filter]
const SIGMA: f32 = 2.0;
/// Ridge regularisation of the slopes q and r: this share of Σw is added to Σwx² and to Σwy² (see [`SUMS`]).
/// Where the neighbours are few, the result then approaches the weighted mean; where they lie on one line, the slope
/// across the line approaches 0. [bench filter]
const RIDGE: f32 = 0.02;
/// Eliminating the slopes from the normal equations leaves one equation for p. If the coefficient of p in this equation
/// is at most this share of the sum of weights, the weighted mean is taken instead of p. [rounding]
const MIN_LEFT: f32 = 0.02;
/// Relative difference that rounding alone may cause between two pilot values. [rounding]
const EQUAL: f32 = 1e-6;
/// Number of sums per pixel. With the weight w and the value f of a tap at the offset (x, y), the sums are Σw, Σwx,
/// Σwy, Σwx², Σwxy and Σwy², then Σwf, Σwfx and Σwfy for each of the three channels.
const SUMS: usize = 15;

/// The data of one pass.
pub struct FilterPass<'a> {
    /// The values to which the planes are fitted: the light of both halves.
    pub light: &'a Planes,
    /// The pilot: an estimate of the light with less noise, whose pixels are compared by the statistical test. `None`
    /// skips the test and the fit of slopes.
    pub pilot: Option<PilotImage<'a>>,
    /// Confidence in the light of each half of the paths, for each pixel, in `(0, 1]`.
    pub confidence: &'a Planes,
    pub guides: &'a Guides,
    /// Distance between neighbouring taps, in pixels.
    pub step: usize,
}

#[derive(Clone, Copy)]
pub struct PilotImage<'a> {
    pub light: &'a Planes,
    /// Variance of the pilot, per channel; one value serves both halves.
    pub variance: &'a Planes,
    /// The weight of a neighbour is divided by e if the squared difference of the two pilot values is this multiple of
    /// the sum of their variances.
    pub tolerance: f32,
}

/// Memory in which a row is computed.
struct RowScratch {
    /// For each half, the sums of all pixels (see [`SUMS`]).
    sums: [Vec<f32>; 2],
    /// Distances in the guides, and weights, of the pixels' neighbours at one tap.
    distance: Vec<f32>,
    weights: Vec<f32>,
}

impl RowScratch {
    fn new(width: usize) -> Result<Self> {
        let sums = [try_vec(SUMS * width, 0.0)?, try_vec(SUMS * width, 0.0)?];
        Ok(Self { sums, distance: try_vec(width, 0.0)?, weights: try_vec(width, 0.0)? })
    }
}

impl FilterPass<'_> {
    /// Filters both halves. Each half is tested with its own half of the pilot, so its noise stays independent of the
    /// noise of the other half. Only the smoothed variance of the pilot is common to both tests.
    pub fn run(&self, job: Job) -> Result<Planes> {
        let Planes { width, height, .. } = *self.light;
        Planes::from_rows_with(
            [width, height, LIGHT],
            job,
            || RowScratch::new(width),
            |scratch, y, out| {
                scratch.sums.iter_mut().for_each(|sums| sums.fill(0.0));
                for dy in -RADIUS..=RADIUS {
                    for dx in -RADIUS..=RADIUS {
                        self.add(y, [dx, dy], scratch);
                    }
                }
                let (first, second) = out.split_at_mut(3 * width);
                for (sums, out) in scratch.sums.iter().zip([first, second]) {
                    solve(sums, self.pilot.is_some(), out);
                }
            },
        )
    }

    /// Adds one tap to the sums of the pixels of a row.
    fn add(&self, y: usize, tap: [isize; 2], scratch: &mut RowScratch) {
        let (width, height) = (self.light.width, self.light.height);
        let Some(at) = Shift::new([width, height], y, tap.map(|t| t * self.step as isize)) else { return };
        let (distance, weights) = (&mut scratch.distance[..at.span], &mut scratch.weights[..at.span]);
        match tap {
            [0, 0] => distance.fill(0.0),
            _ => self.guides.distances(y, &at, distance),
        }
        let place = tap.map(|t| t as f32);
        let gauss = maths::exp(-0.5 * (place[0] * place[0] + place[1] * place[1]) / (SIGMA * SIGMA));
        for (half, sums) in scratch.sums.iter_mut().enumerate() {
            let values = self.light.part(at.row, 3 * half, at.there, at.span);
            let confidence = &self.confidence.row(at.row, half)[at.there..at.there + at.span];
            match self.pilot {
                None => weights.copy_from_slice(distance),
                Some(PilotImage { light, variance, tolerance }) => {
                    let here = light.part(y, 3 * half, at.from, at.span);
                    let there = light.part(at.row, 3 * half, at.there, at.span);
                    let noise_here = variance.part(y, 0, at.from, at.span);
                    let noise_there = variance.part(at.row, 0, at.there, at.span);
                    test(tolerance, distance, here, there, noise_here, noise_there, weights);
                }
            }
            accumulate(gauss, place, confidence, values, weights, at.from, sums);
        }
    }
}

widest! {
    /// Writes to `out` the distance in the guides plus the mean over the channels of
    /// `(a - b)² / (tolerance * (v + w))`. Here a and b are the pilot values (`here`, `there`), and v and w their
    /// variances (`noise_here`, `noise_there`).
    fn test(
        tolerance: f32,
        distance: &[f32],
        here: [&[f32]; 3],
        there: [&[f32]; 3],
        noise_here: [&[f32]; 3],
        noise_there: [&[f32]; 3],
        out: &mut [f32],
    ) {
        let n = out.len();
        let distance = &distance[..n];
        let [a, b, v, w] = [here, there, noise_here, noise_there].map(|planes| planes.map(|s| &s[..n]));
        let square = |v: f32| v * v;
        for i in 0..n {
            let t = |c: usize| {
                let rounding = square(EQUAL * (a[c][i] + b[c][i])) + f32::MIN_POSITIVE;
                square(a[c][i] - b[c][i]) / (tolerance * (v[c][i] + w[c][i]) + rounding)
            };
            out[i] = distance[i] + (1.0 / 3.0) * (t(0) + t(1) + t(2));
        }
    }
}

widest! {
    /// Replaces the distances t in `weights` by the weights `gauss * exp(-t) * confidence`. Then adds the terms of one
    /// tap, at the offset `place`, to the sums (see [`SUMS`]) of the pixels from column `from` on.
    fn accumulate(
        gauss: f32,
        place: [f32; 2],
        confidence: &[f32],
        values: [&[f32]; 3],
        weights: &mut [f32],
        from: usize,
        sums: &mut [f32],
    ) {
        let n = weights.len();
        let confidence = &confidence[..n];
        for i in 0..n {
            // Approximate exp(-t) by (1 - t/8)⁸, which is 0 from t = 8 on.
            let square = |v: f32| v * v;
            let w = (1.0 - weights[i] * 0.125).max(0.0);
            weights[i] = gauss * square(square(square(w))) * confidence[i];
        }
        let [x, y] = place;
        let width = sums.len() / SUMS;
        let mut planes = sums.chunks_exact_mut(width);
        let mut add = |scale: f32, values: Option<&[f32]>| {
            let Some(plane) = planes.next() else { return };
            let plane = &mut plane[from..from + n];
            match values {
                None => (0..n).for_each(|i| plane[i] += scale * weights[i]),
                Some(values) => {
                    let values = &values[..n];
                    (0..n).for_each(|i| plane[i] += scale * (weights[i] * values[i]));
                }
            }
        };
        for scale in [1.0, x, y, x * x, x * y, y * y] {
            add(scale, None);
        }
        for values in values {
            for scale in [1.0, x, y] {
                add(scale, Some(values));
            }
        }
    }
}

/// Computes the filtered values of a row from its sums: the value p of the fitted plane at the pixel, or the weighted
/// mean if `has_slopes` is false or the fit is ill-conditioned.
fn solve(sums: &[f32], has_slopes: bool, out: &mut [f32]) {
    let width = out.len() / 3;
    let sum = |plane: usize, x: usize| sums[plane * width + x];
    for x in 0..width {
        let [weight, bx, by] = [0, 1, 2].map(|plane| sum(plane, x));
        let (xx, xy, yy) = (sum(3, x) + RIDGE * weight, sum(4, x), sum(5, x) + RIDGE * weight);
        let determinant = xx * yy - xy * xy;
        let (u, v) = ((yy * bx - xy * by) / determinant, (xx * by - xy * bx) / determinant);
        let left = weight - u * bx - v * by;
        for c in 0..3 {
            let [value, along_x, along_y] = [0, 1, 2].map(|moment| sum(6 + 3 * c + moment, x));
            out[c * width + x] = match has_slopes && left > MIN_LEFT * weight {
                true => (value - u * along_x - v * along_y) / left,
                false => value / weight,
            };
        }
    }
}
