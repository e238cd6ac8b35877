//! The light that is filtered: the halves of the picture, divided by the albedo of the surfaces, with their noise.

use super::guides::Guides;
use super::input::Input;
use super::planes::Planes;
use crate::error::Result;
use crate::image::colour;
use crate::job::Job;
use glam::Vec3;

/// Channels of the light: red, green and blue of the first half, then of the second.
pub const LIGHT: usize = 6;
/// Colours are divided by the albedo, or by this value where the albedo is smaller, because lamps and black surfaces
/// have an albedo of 0. [bench filter]
const MIN_ALBEDO: f32 = 0.02;
/// Each half of a pixel has the weight `1 / (1 + CONFIDENCE_FALLOFF * r)`. Here r is the variance of this half at the
/// pixel, divided by the mean variance of the same half in the surrounding pixels. [bench filter]
const CONFIDENCE_FALLOFF: f32 = 0.3;
/// Radius, in pixels, of the neighbourhood over which the variance of a half is averaged to compute its weight.
/// [bench filter]
const CONFIDENCE_RADIUS: usize = 6;
/// Relative errors are errors divided by a mean radiance around the pixel; this is the radius of the mean in pixels.
/// [bench filter]
const RADIANCE_RADIUS: usize = 4;

/// Both halves of the light: the picture divided by its mean and by the albedo.
pub struct Light {
    pub halves: Planes,
    /// Weight of each half of each pixel, in `(0, 1]`. The weight is low if the variance of the half is large compared
    /// with the pixels around, as in a pixel that has found a rare bright path.
    pub confidence: Planes,
    /// Albedo of the surface, at least `MIN_ALBEDO`.
    albedo: Planes,
    /// 1 where the variances of both halves are known, otherwise 0.
    known: Planes,
    /// The mean of the picture, in the units of the picture: picture = light × albedo × `unit`.
    pub unit: f32,
}

impl Light {
    pub fn new(input: &Input, guides: &Guides, job: Job) -> Result<Self> {
        let (width, height) = (input.halves[0].width, input.halves[0].height);
        let unit = unit(input);
        let albedo = Planes::from_rows([width, height, 3], job.part(0.0, 0.1), |y, row| {
            for c in 0..3 {
                let plane = &mut row[c * width..(c + 1) * width];
                plane.iter_mut().zip(guides.albedo(y, c)).for_each(|(out, albedo)| *out = albedo.max(MIN_ALBEDO));
            }
        })?;
        let halves = Planes::from_rows([width, height, LIGHT], job.part(0.1, 0.2), |y, row| {
            for (channel, plane) in row.chunks_exact_mut(width).enumerate() {
                let (half, c) = (input.halves[channel / 3], channel % 3);
                for (x, out) in plane.iter_mut().enumerate() {
                    *out = half.pixel(x, y)[c] / unit / albedo.row(y, c)[x];
                }
            }
        })?;
        let known = Planes::from_rows([width, height, 1], job.part(0.2, 0.3), |y, row| {
            row.iter_mut().enumerate().for_each(|(x, out)| *out = f32::from(u8::from(input.is_known(x, y))));
        })?;
        let confidence = confidence(input, &albedo, unit, job.part(0.3, 1.0))?;
        Ok(Self { halves, confidence, albedo, known, unit })
    }

    pub fn albedo(&self, x: usize, y: usize, channel: usize) -> f32 {
        self.albedo.row(y, channel)[x]
    }

    pub fn is_known(&self, x: usize, y: usize) -> bool {
        self.known.row(y, 0)[x] > 0.0
    }

    /// Returns for each pixel the factor `1 / (r² + min_light²)`, which makes its squared error relative. Here r is the
    /// mean radiance around the pixel, in units of the picture's mean.
    pub fn error_scale(&self, min_light: f32, job: Job) -> Result<Planes> {
        let (width, height) = (self.halves.width, self.halves.height);
        let radiance = Planes::from_rows([width, height, 1], job.part(0.0, 0.3), |y, row| {
            for (x, out) in row.iter_mut().enumerate() {
                let of_channel =
                    |c: usize| self.albedo(x, y, c) * (self.halves.row(y, c)[x] + self.halves.row(y, c + 3)[x]);
                *out = (of_channel(0) + of_channel(1) + of_channel(2)) / 6.0;
            }
        })?;
        let mut scale = radiance.smoothed(RADIANCE_RADIUS, job.part(0.3, 1.0))?;
        scale.data.iter_mut().for_each(|v| *v = 1.0 / (*v * *v + min_light * min_light));
        Ok(scale)
    }
}

/// Returns the mean absolute value of both halves; 1 for a black picture.
fn unit(input: &Input) -> f32 {
    let [one, other] = input.halves;
    let sum: f64 = one.data.iter().zip(&other.data).map(|(a, b)| f64::from(a.abs()) + f64::from(b.abs())).sum();
    let mean = (sum / (2 * one.data.len()).max(1) as f64) as f32;
    if mean > 0.0 && mean.is_finite() { mean } else { 1.0 }
}

/// Computes the confidence in the halves of the pixels from their variances. A half's confidence does not depend on the
/// other half, so it does not make the filtered halves depend on each other.
fn confidence(input: &Input, albedo: &Planes, unit: f32, job: Job) -> Result<Planes> {
    let (width, height) = (albedo.width, albedo.height);
    let noise = Planes::from_rows([width, height, 2], job.part(0.0, 0.2), |y, row| {
        for (half, plane) in row.chunks_exact_mut(width).enumerate() {
            for (x, out) in plane.iter_mut().enumerate() {
                let albedo: Vec3 = [0, 1, 2].map(|c| albedo.row(y, c)[x]).into();
                // Add standard errors rather than variances, because the noise of the channels is correlated.
                let error = colour::luminance(input.variances[half].rgb(x, y).map(f32::sqrt) / unit / albedo);
                *out = if (error * error).is_finite() { error * error } else { 0.0 };
            }
        }
    })?;
    let typical = noise.smoothed(CONFIDENCE_RADIUS, job.part(0.2, 0.9))?;
    Planes::from_rows([width, height, 2], job.part(0.9, 1.0), |y, row| {
        for (half, plane) in row.chunks_exact_mut(width).enumerate() {
            let (noise, typical) = (noise.row(y, half), typical.row(y, half));
            for (x, out) in plane.iter_mut().enumerate() {
                let ratio = noise[x] / typical[x];
                *out = if ratio.is_finite() { 1.0 / (1.0 + CONFIDENCE_FALLOFF * ratio) } else { 1.0 };
            }
        }
    })
}
