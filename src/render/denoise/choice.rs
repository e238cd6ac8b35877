//! The choice, at each pixel, of the candidate with the least estimated error. The candidates are the unfiltered
//! picture and the result of each pass of the filter.
//!
//! Let A and B be the values of the two halves at a pixel before filtering, and a and b their values after filtering.
//!
//! - The filter changes each half by its bias plus noise. The noise of the halves is independent, so the expectation of
//!   (a - A)(b - B) is the squared bias.
//! - (a - b)² / 4 is an estimate of the variance of the filtered picture (a + b) / 2. It includes correlations between
//!   pixels.
//! - The sum of these two terms, averaged over neighbouring pixels, estimates the squared error of a pass. The squared
//!   error of the unfiltered picture is its variance alone.
//!
//! Rousselle et al. 2012 use two halves too. Stein's unbiased risk estimate, as used by Li et al. 2012, would need the
//! covariance of all pixels.
//!
//! The pixels at edges of surfaces and the remaining pixels form two classes (`Classes`). At each pixel, the errors are
//! averaged only over neighbours of the pixel's own class. Otherwise, the large errors at the outlines of lamps would
//! decide the choice for all pixels nearby.

use super::light::{LIGHT, Light};
use super::planes::{Classes, Planes};
use crate::error::Result;
use crate::job::Job;

/// Radius in pixels of the neighbourhood over which estimated errors are averaged (`ERROR_RADIUS`), and over which the
/// choices of pixels are smoothed (`CHOICE_RADIUS`). [bench filter]
const ERROR_RADIUS: usize = 16;
const CHOICE_RADIUS: usize = 4;
/// Squared errors are divided by r² + m², where r is the mean radiance around the pixel and m is `MIN_LIGHT` times the
/// mean of the picture. So errors are relative to the radiance, except in dark pixels. [bench filter]
const MIN_LIGHT: f32 = 0.1;

/// Returns both halves of the filtered light. The candidates are the unfiltered light and the result of each pass;
/// every pixel chooses the candidate with the least estimated error. The result at a pixel is a weighted mean of the
/// candidates. The weight of a candidate is the share of the surrounding pixels that choose this candidate.
pub fn choose(light: &Light, passes: &[Planes], classes: &Classes, job: Job) -> Result<Planes> {
    let raw = &light.halves;
    let (width, height) = (raw.width, raw.height);
    let scale = light.error_scale(MIN_LIGHT, job.part(0.0, 0.1))?;
    let errors = Planes::from_rows([width, height, passes.len() + 1], job.part(0.1, 0.2), |y, row| {
        for (candidate, row) in row.chunks_exact_mut(width).enumerate() {
            let filtered = candidate.checked_sub(1).map_or(raw, |pass| &passes[pass]);
            for (x, error) in row.iter_mut().enumerate() {
                *error = scale.row(y, 0)[x] * squared_error(raw, filtered, light, [x, y]);
            }
        }
    })?;
    let errors = classes.smoothed(&errors, ERROR_RADIUS, job.part(0.2, 0.6))?;
    let choices = Planes::from_rows([width, height, passes.len() + 1], job.part(0.6, 0.7), |y, row| {
        for x in 0..width {
            let best = (0..=passes.len()).min_by(|&i, &j| errors.row(y, i)[x].total_cmp(&errors.row(y, j)[x]));
            // Where the variance is unknown, no error can be estimated: take the last pass.
            let choice = if light.is_known(x, y) { best.unwrap_or(0) } else { passes.len() };
            row[choice * width + x] = 1.0;
        }
    })?;
    let shares = classes.smoothed(&choices, CHOICE_RADIUS, job.part(0.7, 0.9))?;
    Planes::from_rows([width, height, LIGHT], job.part(0.9, 1.0), |y, row| {
        for (channel, row) in row.chunks_exact_mut(width).enumerate() {
            // Add the weighted changes to the unfiltered light. A pixel thus keeps its exact value if all pixels around
            // choose the unfiltered light.
            let raw = raw.row(y, channel);
            row.copy_from_slice(raw);
            for (pass, filtered) in passes.iter().enumerate() {
                let (share, filtered) = (shares.row(y, pass + 1), filtered.row(y, channel));
                (0..width).for_each(|x| row[x] += share[x] * (filtered[x] - raw[x]));
            }
        }
    })
}

/// Estimates the squared error of the mean of the filtered halves at a pixel, summed over the channels. The unit is the
/// square of the picture's mean.
fn squared_error(raw: &Planes, filtered: &Planes, light: &Light, [x, y]: [usize; 2]) -> f32 {
    let of_channel = |c: usize| {
        let [before, after] = [raw, filtered].map(|planes| [c, c + 3].map(|channel| planes.row(y, channel)[x]));
        let albedo = light.albedo(x, y, c);
        let bias = (after[0] - before[0]) * (after[1] - before[1]);
        albedo * albedo * (bias + 0.25 * (after[0] - after[1]) * (after[0] - after[1]))
    };
    of_channel(0) + of_channel(1) + of_channel(2)
}
