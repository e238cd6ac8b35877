//! The choice between the unfiltered picture and the passes of the filter, pixel by pixel, by their estimated errors.
//!
//! Let A and B be the two halves before filtering, and a and b after it. A half changes by its bias plus noise, and the
//! noises of the halves are independent, so (a - A)(b - B) has the squared bias as expectation, whatever the weights.
//! The variance of the mean of a and b has (a - b)² / 4 as estimate. Their sum, averaged over neighbours, estimates the
//! squared error of any candidate, correlations between pixels included; for the unfiltered picture it is the
//! variance. (Rousselle et al. 2012 use two halves too; Stein's estimate, as by Li et al. 2012, would need the
//! covariance of all pixels.) Pixels at edges of surfaces and all others are averaged apart, because the outlines of
//! lamps have errors that would decide for everything near them.

use super::light::{LIGHT, Light};
use super::planes::{Classes, Planes};
use crate::error::Result;
use crate::job::Job;

/// Radius in pixels of the neighbourhood over which estimated errors are averaged, and over which choices are
/// smoothed. [bench filter]
const ERROR_RADIUS: usize = 16;
const CHOICE_RADIUS: usize = 4;
/// The error of a pixel counts relative to its light, or to this share of the mean of the picture if it is darker.
/// [bench filter]
const MIN_LIGHT: f32 = 0.1;

/// Returns the halves of the filtered picture, relative to the albedo: at each pixel a mean of the candidates, by the
/// shares of the neighbours that choose them. The first candidate is the unfiltered picture.
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
            let least = (0..=passes.len()).min_by(|&i, &j| errors.row(y, i)[x].total_cmp(&errors.row(y, j)[x]));
            // Where nothing is known about the noise, take the last pass.
            let choice = if light.is_known(x, y) { least.unwrap_or(0) } else { passes.len() };
            row[choice * width + x] = 1.0;
        }
    })?;
    let shares = classes.smoothed(&choices, CHOICE_RADIUS, job.part(0.7, 0.9))?;
    Planes::from_rows([width, height, LIGHT], job.part(0.9, 1.0), |y, row| {
        for (channel, row) in row.chunks_exact_mut(width).enumerate() {
            // Add changes to the unfiltered picture, so that a pixel that chooses it keeps its exact value.
            let raw = raw.row(y, channel);
            row.copy_from_slice(raw);
            for (pass, filtered) in passes.iter().enumerate() {
                let (share, filtered) = (shares.row(y, pass + 1), filtered.row(y, channel));
                (0..width).for_each(|x| row[x] += share[x] * (filtered[x] - raw[x]));
            }
        }
    })
}

/// Estimates the squared error of the mean of two filtered halves at a pixel, summed over the channels.
fn squared_error(raw: &Planes, filtered: &Planes, light: &Light, [x, y]: [usize; 2]) -> f32 {
    let of_channel = |c: usize| {
        let [before, after] = [raw, filtered].map(|planes| [c, c + 3].map(|channel| planes.row(y, channel)[x]));
        let albedo = light.albedo(x, y, c);
        let bias = (after[0] - before[0]) * (after[1] - before[1]);
        albedo * albedo * (bias + 0.25 * (after[0] - after[1]) * (after[0] - after[1]))
    };
    of_channel(0) + of_channel(1) + of_channel(2)
}
