//! Combines aligned exposures into one image (Hanji, Zhong and Mantiuk, Noise-aware merging of high dynamic range image
//! stacks without camera calibration, 2020).
//!
//! The estimate of a pixel is the sum of its values divided by the sum of their exposures. This is the
//! maximum-likelihood estimate for Poisson noise, and it needs no calibration of the camera. Weights change the
//! estimate at both ends of the range. Near saturation, the weight of a value falls to 0. Near black, the noise of
//! readout and rounding does not fall with the light; there, each value is weighted by its exposure, which is optimal
//! for constant noise. The weight near black depends on the estimate and not on the value itself, so it causes no bias.

use super::frame::{Frame, colours, light, peak};
use super::params::MAX_PHOTOS;
use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::job::Job;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The weight of a value falls from 1 at this share of the clipping value to 0 at the clipping value. [convention]
const FADE: f32 = 0.8;

/// Value at which the noise of readout and rounding has the same variance as the photon noise. A camera that saturates
/// at 20,000 electrons and has 3 electrons of readout noise gives (3 / 20000)² * 20000 = 0.0005. The rounding of 8-bit
/// sRGB near black adds as much again. [convention]
const BLACK: f32 = 1e-3;

/// A photo, with its exposure relative to the exposure of the reference photo.
pub struct Exposed<'a> {
    pub frame: Frame<'a>,
    pub exposure: f32,
}

/// The photos to combine, and the pixels at which they disagree.
pub struct Stack<'a> {
    /// The photos in the order of their exposures, the shortest first.
    pub photos: Vec<Exposed<'a>>,
    /// For each photo but the last, one flag per pixel of the reference: 1 where the photo disagrees with the next
    /// photo, otherwise 0. If the outer list is empty, no photos disagree.
    pub disagreements: Vec<Vec<u8>>,
    /// Index of the reference photo in `photos`.
    pub reference: usize,
}

/// The merged image. `clipped` is the number of pixels that are clipped in every exposure, `moved` the number of pixels
/// at which exposures disagree.
pub struct Merged {
    pub image: Image,
    pub clipped: usize,
    pub moved: usize,
}

/// Combines the photos into an image with the pixel grid of the reference photo.
pub fn combine(stack: &Stack, job: Job) -> Result<Merged> {
    let reference = stack.photos[stack.reference].frame.image;
    let mut image = Image::new(reference.width, reference.height, reference.channels)?;
    let (clipped, moved) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let (row_len, channels) = (image.row_len(), image.channels);
    exec::for_rows(&mut image.data, row_len, job, |y, row| {
        let mut counts = [0; 2];
        for (x, out) in row.chunks_exact_mut(channels).enumerate() {
            let found = stack.pixel(x, y, out);
            counts[0] += usize::from(found.is_clipped);
            counts[1] += usize::from(found.has_moved);
        }
        clipped.fetch_add(counts[0], Ordering::Relaxed);
        moved.fetch_add(counts[1], Ordering::Relaxed);
    })?;
    Ok(Merged { image, clipped: clipped.into_inner(), moved: moved.into_inner() })
}

/// Whether every exposure clips a pixel, and whether the exposures disagree at it.
struct Outcome {
    is_clipped: bool,
    has_moved: bool,
}

impl Stack<'_> {
    /// Computes pixel `(x, y)` of the merged image and writes it to `out`.
    fn pixel(&self, x: usize, y: usize, out: &mut [f32]) -> Outcome {
        let count = self.photos.len();
        let mut shown: [&[f32]; MAX_PHOTOS] = [&[]; MAX_PHOTOS];
        let mut weights = [0.0f32; MAX_PHOTOS];
        for (k, photo) in self.photos.iter().enumerate() {
            if let Some(pixel) = photo.frame.pixel(x, y) {
                (shown[k], weights[k]) = (pixel, fade(peak(pixel) / photo.frame.clip));
            }
        }
        let at = y * self.photos[self.reference].frame.image.width + x;
        let disagree = |k: usize| self.disagreements.get(k).is_some_and(|flags| flags[at] != 0);
        let has_moved = (0..count - 1).any(disagree);

        out.copy_from_slice(shown[self.reference]); // keeps alpha
        let base = (0..=self.reference).rev().find(|&k| weights[k] > 0.0);
        let Some(base) = base else {
            // All exposures up to the reference clip the pixel. The shortest exposure that shows it gives a lower
            // bound.
            let shortest = (0..=self.reference).find(|&k| !shown[k].is_empty()).unwrap_or(self.reference);
            let exposure = self.photos[shortest].exposure;
            out.iter_mut().zip(colours(shown[shortest])).for_each(|(out, v)| *out = v / exposure);
            return Outcome { is_clipped: true, has_moved };
        };
        // Use the exposures around `base`; in each direction, stop at the first pair of neighbours that disagree.
        let low = (0..base).rev().find(|&k| disagree(k)).map_or(0, |k| k + 1);
        let high = (base..count - 1).find(|&k| disagree(k)).unwrap_or(count - 1);
        self.average(&shown, &weights, low..high + 1, out);
        Outcome { is_clipped: false, has_moved }
    }

    /// Averages a pixel over the photos whose indices lie in `range`, and writes the result to `out`. `shown` holds the
    /// pixel's values in each photo, `weights` their weights near saturation.
    fn average(
        &self,
        shown: &[&[f32]; MAX_PHOTOS],
        weights: &[f32; MAX_PHOTOS],
        range: std::ops::Range<usize>,
        out: &mut [f32],
    ) {
        let used = || range.clone().filter(|&k| weights[k] > 0.0);
        let single = used().nth(1).is_none();
        let sums = used().fold([0.0; 2], |sums: [f32; 2], k| {
            [sums[0] + weights[k] * light(shown[k]), sums[1] + weights[k] * self.photos[k].exposure]
        });
        let estimate = (sums[0] / sums[1]).max(0.0);
        let mut total = [0.0f32; 3];
        let mut exposures = 0.0;
        for k in used() {
            let exposure = self.photos[k].exposure;
            let weight = if single { 1.0 } else { weights[k] * exposure / (exposure * estimate + BLACK) };
            total.iter_mut().zip(colours(shown[k])).for_each(|(sum, v)| *sum += weight * v);
            exposures += weight * exposure;
        }
        out.iter_mut().zip(total).take(3).for_each(|(out, sum)| *out = sum / exposures);
    }
}

/// Returns the weight of a value near saturation: 1 up to `FADE`, falling smoothly to 0 at 1. `value` is a multiple of
/// the clipping value.
#[inline]
fn fade(value: f32) -> f32 {
    let t = ((1.0 - value) / (1.0 - FADE)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
