//! Finds the pixels at which two exposures disagree beyond noise, because something moved or its light changed.
//!
//! The difference of the two exposures is averaged over 3 × 3 pixels, which a person or a leaf covers. It may have the
//! measured deviation at its level of light, five standard deviations of the measured noise, the rounding of 8-bit
//! codes, and the difference that the remaining misalignment makes, at most half a pixel, because the alignment is by
//! whole pixels. Its size is measured where the photos have edges.

use super::frame::Frame;
use super::noise::Noise;
use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_collect};
use crate::job::Job;

/// Number of standard deviations of the noise that are not disagreement: at 10 million pixels, chance exceeds five
/// about six times. [convention]
const SIGMAS: f32 = 5.0;

/// A pixel that is clipped in the long exposure disagrees if the short one predicts less than this part of the clipping
/// value. [convention]
const PREDICTED: f32 = 0.8;

/// Bounds of half a step of 8-bit sRGB in linear light: near black, and relative to the square root of the light.
/// [convention: IEC 61966-2-1, 0.5 / 255 / 12.92 and 0.5 / 255 * 2.4 / 1.055]
const HALF_CODE: [f32; 2] = [1.52e-4, 4.46e-3];

/// The misalignment that is allowed, over its median at edges, and its largest value in pixels. [convention]
const MISALIGNMENT: f32 = 3.0;
const MAX_MISALIGNMENT: f32 = 0.5;

/// A pixel is at an edge if the light of its neighbours differs by more than this part of its own. [convention]
const EDGE: f32 = 0.1;

/// Number of pixels on which the misalignment is measured, about, and at least.
const EDGES: usize = 1 << 16;
const MIN_EDGES: usize = 64;

/// Distance by which the pixels of a disagreement are extended, in pixels: the fringes of what moved.
const FRINGE: usize = 2;

/// Returns 1 for each pixel of the reference's frame at which two exposures disagree, otherwise 0. `ratio` is that of
/// their exposures.
pub fn disagreement(
    [short, long]: [&Frame; 2],
    ratio: f32,
    noise: &Noise,
    [width, height]: [usize; 2],
    job: Job,
) -> Result<Vec<u8>> {
    // For each pixel: the difference of the exposures, how far it may differ, and the variance of the noise.
    let mut found = Image::new(width, height, 3)?;
    let mut pair = FramePair { short, long, ratio, noise, misalignment: 0.0 };
    pair.misalignment = pair.measured_misalignment([width, height], job.part(0.0, 0.1))?;
    exec::for_rows(&mut found.data, 3 * width, job.part(0.1, 0.6), |y, row| {
        for (x, out) in row.chunks_exact_mut(3).enumerate() {
            out.copy_from_slice(&pair.difference(x, y));
        }
    })?;
    let mut flags = crate::image::try_vec(width * height, 0u8)?;
    exec::for_rows(&mut flags, width, job.part(0.6, 0.9), |y, row| {
        for (x, out) in row.iter_mut().enumerate() {
            let [difference, allowed, variance] = around(&found, x, y);
            *out = u8::from(difference.abs() > allowed + SIGMAS * variance.sqrt());
        }
    })?;
    extended(&flags, width, job.part(0.9, 1.0))
}

/// Two neighbours in the order of exposure.
struct FramePair<'a> {
    short: &'a Frame<'a>,
    long: &'a Frame<'a>,
    ratio: f32,
    noise: &'a Noise,
    /// In pixels.
    misalignment: f32,
}

impl FramePair<'_> {
    /// The difference of the exposures at a pixel, how far it may differ, and the variance of its noise; zeros if
    /// the photos do not show it.
    fn difference(&self, x: usize, y: usize) -> [f32; 3] {
        let (Some([s, s_peak]), Some([l, l_peak])) = (self.short.levels(x, y), self.long.levels(x, y)) else {
            return [0.0; 3];
        };
        let is_clipped = l_peak >= self.long.clip;
        let predicted = self.ratio * s;
        if is_clipped && (s_peak >= self.short.clip || self.ratio * s_peak >= PREDICTED * self.long.clip) {
            return [0.0; 3];
        }
        let light = if is_clipped { predicted } else { (s + l) * self.ratio / (1.0 + self.ratio) };
        let [deviation, spread] = self.noise.at(light);
        let difference =
            if is_clipped { PREDICTED * self.long.clip - self.ratio * s_peak } else { l - predicted - deviation };
        let allowed = self.misalignment * self.steps(x, y, [s, l])
            + half_code(self.long, l)
            + self.ratio * half_code(self.short, s);
        [difference, allowed, spread * spread]
    }

    /// Measures the misalignment: the median difference at edges, relative to the steps of the light there.
    fn measured_misalignment(&self, [width, height]: [usize; 2], job: Job) -> Result<f32> {
        let step = ((width * height / EDGES) as f64).sqrt().ceil().max(1.0) as usize;
        let rows = exec::map(height.div_ceil(step), job, |row| {
            let y = row * step;
            let at = |x: usize| {
                let ([s, s_peak], [l, l_peak]) = (self.short.levels(x, y)?, self.long.levels(x, y)?);
                let steps = self.steps(x, y, [s, l]);
                let is_edge = s_peak < self.short.clip && l_peak < self.long.clip && steps > EDGE * l;
                is_edge.then(|| (l - self.ratio * s).abs() / steps)
            };
            (0..width).step_by(step).filter_map(at).collect::<Vec<_>>()
        })?;
        let mut found = try_collect(rows.into_iter().flatten())?;
        if found.len() < MIN_EDGES {
            return Ok(MAX_MISALIGNMENT);
        }
        let middle = found.len() / 2;
        let median = *found.select_nth_unstable_by(middle, f32::total_cmp).1;
        Ok((MISALIGNMENT * median).min(MAX_MISALIGNMENT))
    }

    /// The difference that a shift by one pixel along each of the axes makes, at most, in the long exposure.
    fn steps(&self, x: usize, y: usize, [s, l]: [f32; 2]) -> f32 {
        let mut steps = [0.0f32; 2];
        for (axis, step) in steps.iter_mut().enumerate() {
            for offset in [-1, 1] {
                let [column, row] = if axis == 0 { [offset, 0] } else { [0, offset] };
                let (column, row) = (x.wrapping_add_signed(column), y.wrapping_add_signed(row));
                let of_short = self.short.levels(column, row).map_or(0.0, |[v, _]| self.ratio * (v - s).abs());
                let of_long = self.long.levels(column, row).map_or(0.0, |[v, _]| (v - l).abs());
                *step = step.max(of_short).max(of_long);
            }
        }
        steps[0] + steps[1]
    }
}

/// Half a step of 8-bit sRGB at a value; 0 in a photo of a high dynamic range, which is not of 8 bits.
#[inline]
fn half_code(frame: &Frame, value: f32) -> f32 {
    if frame.clip.is_finite() { HALF_CODE[0].max(HALF_CODE[1] * value.max(0.0).sqrt()) } else { 0.0 }
}

/// The sums of the three channels over a pixel and its neighbours.
fn around(found: &Image, x: usize, y: usize) -> [f32; 3] {
    let mut sums = [0.0; 3];
    for row in y.saturating_sub(1)..(y + 2).min(found.height) {
        for pixel in found.row(row)[3 * x.saturating_sub(1)..3 * (x + 2).min(found.width)].chunks_exact(3) {
            sums.iter_mut().zip(pixel).for_each(|(sum, v)| *sum += v);
        }
    }
    sums
}

/// Sets the pixels near the set ones, in a square.
fn extended(flags: &[u8], width: usize, job: Job) -> Result<Vec<u8>> {
    let height = flags.len() / width;
    let near = |at: usize, size: usize| at.saturating_sub(FRINGE)..(at + FRINGE + 1).min(size);
    let mut rows = crate::image::try_vec(flags.len(), 0u8)?;
    exec::for_rows(&mut rows, width, job, |y, row| {
        for other in near(y, height) {
            row.iter_mut().zip(&flags[other * width..]).for_each(|(out, v)| *out |= v);
        }
    })?;
    let mut out = crate::image::try_vec(flags.len(), 0u8)?;
    exec::for_rows(&mut out, width, job, |y, row| {
        let from = &rows[y * width..(y + 1) * width];
        for (x, out) in row.iter_mut().enumerate() {
            *out = from[near(x, width)].iter().fold(0, |a, b| a | b);
        }
    })?;
    Ok(out)
}
