//! Finds the pixels at which two exposures disagree beyond noise, because an object moved or its illumination changed.
//!
//! The difference of the two exposures is averaged over 3 × 3 pixels, an area smaller than the image of a person or a
//! leaf. Four causes of a difference are allowed for: the systematic deviation measured at the pixel's level of light;
//! five standard deviations of the measured noise; the rounding of 8-bit codes; and the misalignment that remains
//! because photos are aligned by whole pixels. The misalignment is at most half a pixel, and is measured at the edges
//! in the photos.

use super::frame::Frame;
use super::noise::Noise;
use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_collect};
use crate::job::Job;

/// Two exposures disagree if they differ by more than this many standard deviations of the noise, beyond the other
/// allowed differences. Among 10 million pixels, about six exceed five standard deviations by chance. [convention]
const SIGMAS: f32 = 5.0;

/// A pixel that is clipped in the long exposure disagrees if the value that the short exposure predicts for it is less
/// than this share of the clipping value. [convention]
const PREDICTED: f32 = 0.8;

/// Half a step of 8-bit sRGB in linear light is at most the larger of two bounds. The first number is the bound near
/// black; the second number times the square root of the light is the bound for brighter values.
/// [convention: IEC 61966-2-1, 0.5 / 255 / 12.92 and 0.5 / 255 * 2.4 / 1.055]
const HALF_CODE: [f32; 2] = [1.52e-4, 4.46e-3];

/// The allowed misalignment is `MISALIGNMENT` times the median misalignment measured at edges, but at most
/// `MAX_MISALIGNMENT` pixels. [convention]
const MISALIGNMENT: f32 = 3.0;
const MAX_MISALIGNMENT: f32 = 0.5;

/// A pixel is at an edge if a shift by one pixel along each axis may change its light by more than this share.
/// [convention]
const EDGE: f32 = 0.1;

/// The misalignment is measured at the edges among about `EDGES` pixels. If fewer than `MIN_EDGES` of them are at
/// edges, the misalignment is taken to be `MAX_MISALIGNMENT`.
const EDGES: usize = 1 << 16;
const MIN_EDGES: usize = 64;

/// Number of pixels by which the areas of disagreement are extended on each side, to cover the fringes of moved
/// objects.
const FRINGE: usize = 2;

/// Returns a flag for each pixel of the reference photo, which has `width × height` pixels: 1 if the two exposures
/// disagree there, otherwise 0. `ratio` is the ratio long / short of the exposures.
pub fn disagreement(
    [short, long]: [&Frame; 2],
    ratio: f32,
    noise: &Noise,
    [width, height]: [usize; 2],
    job: Job,
) -> Result<Vec<u8>> {
    // Compute for each pixel the difference of the exposures, the allowed difference apart from noise, and the variance
    // of the noise.
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

/// Two photos that are neighbours in the order of exposure.
struct FramePair<'a> {
    short: &'a Frame<'a>,
    long: &'a Frame<'a>,
    ratio: f32,
    noise: &'a Noise,
    /// The allowed misalignment of the two photos, in pixels.
    misalignment: f32,
}

impl FramePair<'_> {
    /// Returns three numbers for a pixel of the reference: the difference of the exposures, the allowed difference
    /// apart from noise, and the variance of the noise. All are 0 if a photo does not show the pixel. They are also 0
    /// if the long exposure clips the pixel, and the short one clips it too or predicts a value near or above clipping.
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

    /// Measures the misalignment at edges: the median of the difference of the exposures divided by the change of light
    /// per pixel. Returns the allowed misalignment in pixels ([`MISALIGNMENT`]).
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

    /// Returns an upper bound of the change of the light in the long exposure if the photo shifts by one pixel along
    /// each axis.
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

/// Returns half a step of 8-bit sRGB at a value, in linear light. Returns 0 for a photo of high dynamic range, because
/// such a photo does not have 8 bits.
#[inline]
fn half_code(frame: &Frame, value: f32) -> f32 {
    if frame.clip.is_finite() { HALF_CODE[0].max(HALF_CODE[1] * value.max(0.0).sqrt()) } else { 0.0 }
}

/// Returns the sums of the three channels over a pixel and its up to eight neighbours.
fn around(found: &Image, x: usize, y: usize) -> [f32; 3] {
    let mut sums = [0.0; 3];
    for row in y.saturating_sub(1)..(y + 2).min(found.height) {
        for pixel in found.row(row)[3 * x.saturating_sub(1)..3 * (x + 2).min(found.width)].chunks_exact(3) {
            sums.iter_mut().zip(pixel).for_each(|(sum, v)| *sum += v);
        }
    }
    sums
}

/// Also sets all pixels within `FRINGE` columns and rows of a set pixel.
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
