//! Preview filter: smooths an image rendered with few paths per pixel, guided by surface attributes.
//!
//! The filter is the edge-avoiding à-trous filter of Dammertz et al. (2010, "Edge-avoiding à-trous wavelet transform
//! for fast global illumination filtering") with the variance-guided range weights of Schied et al. (2017,
//! "Spatiotemporal variance-guided filtering"). Colours are divided by the albedo of the surface before filtering,
//! which preserves textures. Each level averages a pixel with eight neighbours, whose distance doubles from level to
//! level. The weight of a neighbour falls with its distance from the pixel's plane, with the angle between the
//! normals, with the difference in albedo, and with the difference in luminance relative to the standard errors of
//! both luminances. The filter propagates the variance of each average to the next level. With zero variance it leaves
//! the image unchanged.
//!
//! The filter is biased: it blurs features that the guide images do not show, such as soft shadows, and changes their
//! radiance by about their standard error. [`Output::bias`] estimates this bias; final images are rendered without the
//! filter. To measure the bias, the paths are split into two halves, which are filtered separately (as by Rousselle et
//! al. 2012, "Adaptive rendering with non-local means filtering", for a different purpose); the preview is the mean of
//! the two results. The filter changes each half by its bias plus noise. The noises of the halves are independent, so
//! the expected product of the two changes is the squared bias, whatever the weights.
//!
//! Not modelled: motion; reflections, which are smoothed as if they were light on the mirror's surface; textures seen
//! in mirrors, which are blurred.

use super::film::pooled;
use crate::error::{Error, Result, check_range};
use crate::exec;
use crate::image::{Image, colour, try_vec};
use crate::job::Job;
use glam::Vec3;

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Strength of the smoothing, in `[0, 10]`. The filter tolerates a squared difference in luminance between
    /// neighbours in proportion to their variances; `strength` scales this tolerance. 0 leaves the image unchanged.
    pub strength: f32,
}

impl Default for Params {
    fn default() -> Self {
        Self { strength: 1.0 }
    }
}

/// The image to be filtered and its guide images, all of equal size.
pub struct Input<'a> {
    /// Two independent estimates of the image with equal numbers of paths: linear RGB, finite.
    pub halves: [&'a Image; 2],
    /// Variance of the mean of both halves, per channel, at least 0; infinite where unknown.
    pub variance: &'a Image,
    /// RGB albedo of the surface; black for the background.
    pub albedo: &'a Image,
    /// Unit normal of the surface; 0 for the background.
    pub normal: &'a Image,
    /// Position of the surface, in any unit.
    pub position: &'a Image,
}

#[derive(Clone, Debug)]
pub struct Output {
    pub image: Image,
    /// Estimated bias of the preview, relative to the mean of the image: the root mean square, over squares of 8 × 8
    /// pixels, of the mean bias in a square. The square of this estimate is unbiased. Blur within a square of pixels
    /// goes undetected.
    pub bias: f64,
}

/// Distance between a pixel and its neighbours along each axis, per level, in pixels.
const STEPS: [usize; 6] = [1, 2, 4, 8, 16, 32];
/// Kernel weight of a neighbour in the same row or column, relative to the weight of the pixel itself: the binomial
/// kernel. [convention]
const TAP: f32 = 0.5;
/// Variance of one half of the paths, divided by the variance of the mean of both halves; exactly 2 if the halves are
/// independent. [convention]
const HALF: f32 = 2.0;
/// Luminance weight: at strength 1, the weight of a neighbour falls by a factor e if the squared difference in
/// luminance is this multiple of the sum of the two variances. [origin not recorded]
const RANGE: f32 = 12.0;
/// Plane weight: the weight falls by a factor e if the squared sine of the angle between the pixel's plane and the
/// direction to the neighbour has this value. [origin not recorded]
const PLANE: f32 = 0.01;
/// Normal weight: the weight falls by a factor e if 1 - cosine of the angle between the two normals has this value.
/// [origin not recorded]
const FACING: f32 = 0.02;
/// Albedo weight: the weight falls by a factor e if the squared difference in albedo has this value. [origin not
/// recorded]
const COLOUR: f32 = 0.02;
/// Smallest albedo by which colours are divided, so that lamps and black surfaces keep their light. [origin not
/// recorded]
const MIN_ALBEDO: f32 = 0.02;
/// Side of the squares over which the bias is averaged, in pixels. [convention]
const SQUARE: usize = 8;

/// Channels of the filtered image: red, green, blue, and the variance of the luminance.
const LIGHT: usize = 4;
/// Channels of the guide images, three each: albedo, normal, position.
const GUIDE: usize = 9;

/// Filters the image and estimates the bias of the result.
///
/// # Errors
/// Images of different sizes or with too few channels; values that are not finite; a strength out of range; no memory;
/// cancelled.
pub fn run(input: &Input, params: &Params, job: Job) -> Result<Output> {
    check(input, params)?;
    let guide = guides(input, job.part(0.0, 0.05))?;
    let variance = pooled(input.variance, job.part(0.05, 0.1))?;
    let one = filtered(input.halves[0], &variance, &guide, params.strength, job.part(0.1, 0.5))?;
    let other = filtered(input.halves[1], &variance, &guide, params.strength, job.part(0.5, 0.9))?;
    let bias = bias(input.halves, [&one, &other], job.part(0.9, 0.95))?;
    let mut image = one;
    exec::for_rows(&mut image.data, 3 * other.width, job.part(0.95, 1.0), |y, row| {
        row.iter_mut().zip(&other.data[3 * other.width * y..]).for_each(|(a, b)| *a = 0.5 * *a + 0.5 * b);
    })?;
    Ok(Output { image, bias })
}

/// Filters the image of one half of the paths.
fn filtered(half: &Image, variance: &Image, guide: &[f32], strength: f32, job: Job) -> Result<Image> {
    let (width, height) = (half.width, half.height);
    let mut light = light(half, variance, guide, job.part(0.0, 0.1))?;
    if strength > 0.0 {
        let mut next = try_vec(light.len(), 0.0f32)?;
        for (level, &step) in STEPS.iter().enumerate() {
            let part = job.part(0.1 + 0.14 * level as f64, 0.1 + 0.14 * (level + 1) as f64);
            let level = Level { light: &light, guide, width, height, step, range: RANGE * strength };
            exec::for_rows(&mut next, LIGHT * width, part, |y, row| level.row(y, row))?;
            std::mem::swap(&mut light, &mut next);
        }
    }
    // Multiply the filtered light by the albedo again.
    let mut image = Image::new(width, height, 3)?;
    exec::for_rows(&mut image.data, 3 * width, job.part(0.94, 1.0), |y, row| {
        let (light, guide) = (&light[y * LIGHT * width..], &guide[y * GUIDE * width..]);
        for (x, out) in row.chunks_exact_mut(3).enumerate() {
            (0..3).for_each(|c| out[c] = light[c * width + x] * guide[c * width + x].max(MIN_ALBEDO));
        }
    })?;
    Ok(image)
}

/// Returns the guide images in one array. Each row stores its channels one after the other.
fn guides(input: &Input, job: Job) -> Result<Vec<f32>> {
    let Image { width, height, .. } = *input.albedo;
    let mut out = try_vec(GUIDE * width * height, 0.0f32)?;
    exec::for_rows(&mut out, GUIDE * width, job, |y, row| {
        for (first, image) in [(0, input.albedo), (3, input.normal), (6, input.position)] {
            for x in 0..width {
                for (c, &v) in image.pixel(x, y)[..3].iter().enumerate() {
                    row[(first + c) * width + x] = if v.is_finite() { v } else { 0.0 };
                }
            }
        }
    })?;
    Ok(out)
}

/// Returns the image of one half of the paths, divided by the albedo, with the variance of the resulting luminance as
/// fourth channel. Each row stores its channels one after the other.
fn light(half: &Image, variance: &Image, guide: &[f32], job: Job) -> Result<Vec<f32>> {
    let Image { width, height, .. } = *half;
    let mut out = try_vec(LIGHT * width * height, 0.0f32)?;
    exec::for_rows(&mut out, LIGHT * width, job, |y, row| {
        for x in 0..width {
            let albedo: Vec3 = [0, 1, 2].map(|c| guide[(y * GUIDE + c) * width + x].max(MIN_ALBEDO)).into();
            let colour = half.rgb(x, y) / albedo;
            // Add standard errors rather than variances, because the noise of the channels is correlated.
            let error = variance.rgb(x, y).map(f32::sqrt) / albedo;
            let luminance = colour::luminance(colour);
            let error = if error.is_finite() { colour::luminance(error) } else { luminance };
            let values = [colour.x, colour.y, colour.z, HALF * error * error];
            values.into_iter().enumerate().for_each(|(c, v)| row[c * width + x] = v);
        }
    })?;
    Ok(out)
}

/// One level of the filter, with the data that it reads.
struct Level<'a> {
    light: &'a [f32],
    guide: &'a [f32],
    width: usize,
    height: usize,
    step: usize,
    range: f32,
}

impl Level<'_> {
    /// Filters row `y`. Each loop runs along the row for one of the eight neighbours, so that it vectorises.
    fn row(&self, y: usize, out: &mut [f32]) {
        let Self { light, guide, width, height, step, .. } = *self;
        out.copy_from_slice(&light[y * LIGHT * width..(y + 1) * LIGHT * width]);
        let mut weights = vec![1.0; width];
        for (dy, dx) in NEIGHBOURS {
            let Some(other) = y.checked_add_signed(dy * step as isize).filter(|&o| o < height) else { continue };
            // Restrict the row to the columns whose neighbour lies inside the image.
            let shift = dx * step as isize;
            let (from, to) = (shift.min(0).unsigned_abs(), width.saturating_sub(shift.max(0) as usize));
            if from >= to {
                continue;
            }
            let there = (from as isize + shift) as usize;
            let tap = if dx != 0 && dy != 0 { TAP * TAP } else { TAP };
            let span = to - from;
            let own = |data: &'_ [f32], planes: usize, plane: usize| {
                let start = (y * planes + plane) * width + from;
                start..(start + span).min(data.len())
            };
            let far = |planes: usize, plane: usize| {
                let start = (other * planes + plane) * width + there;
                start..start + span
            };
            let here: [&[f32]; LIGHT] = std::array::from_fn(|p| &light[own(light, LIGHT, p)]);
            let that: [&[f32]; LIGHT] = std::array::from_fn(|p| &light[far(LIGHT, p)]);
            let guide_here: [&[f32]; GUIDE] = std::array::from_fn(|p| &guide[own(guide, GUIDE, p)]);
            let guide_that: [&[f32]; GUIDE] = std::array::from_fn(|p| &guide[far(GUIDE, p)]);
            let (red, rest) = out.split_at_mut(width);
            let (green, rest) = rest.split_at_mut(width);
            let (blue, rest) = rest.split_at_mut(width);
            let sums = [red, green, blue, rest].map(|plane| &mut plane[from..to]);
            self.mix(tap, here, that, guide_here, guide_that, sums, &mut weights[from..to]);
        }
        for (x, weight) in weights.iter().enumerate() {
            let scale = 1.0 / weight;
            (0..3).for_each(|p| out[p * width + x] *= scale);
            out[3 * width + x] *= scale * scale;
        }
    }

    /// Adds the weighted values of neighbours (`that`) to the `sums` of the corresponding pixels (`here`).
    #[allow(clippy::too_many_arguments)]
    fn mix(
        &self,
        tap: f32,
        here: [&[f32]; LIGHT],
        that: [&[f32]; LIGHT],
        guide_here: [&[f32]; GUIDE],
        guide_that: [&[f32]; GUIDE],
        sums: [&mut [f32]; LIGHT],
        weights: &mut [f32],
    ) {
        let n = weights.len();
        // Slice to a common length, which removes the bounds checks of the loop.
        let [h0, h1, h2, h3] = here.map(|s| &s[..n]);
        let [t0, t1, t2, t3] = that.map(|s| &s[..n]);
        let a = guide_here.map(|s| &s[..n]);
        let b = guide_that.map(|s| &s[..n]);
        let [s0, s1, s2, s3] = sums.map(|s| &mut s[..n]);
        let square = |v: f32| v * v;
        for i in 0..n {
            let (lh, lt) = (luminance(h0[i], h1[i], h2[i]), luminance(t0[i], t1[i], t2[i]));
            let explained = self.range * (h3[i] + t3[i]) + square(EQUAL * (lh + lt)) + f32::MIN_POSITIVE;
            let range = square(lh - lt) / explained;
            let colour = square(a[0][i] - b[0][i]) + square(a[1][i] - b[1][i]) + square(a[2][i] - b[2][i]);
            let cosine = a[3][i] * b[3][i] + a[4][i] * b[4][i] + a[5][i] * b[5][i];
            let d = [a[6][i] - b[6][i], a[7][i] - b[7][i], a[8][i] - b[8][i]];
            let height = a[3][i] * d[0] + a[4][i] * d[1] + a[5][i] * d[2];
            let plane = square(height) / (square(d[0]) + square(d[1]) + square(d[2]) + f32::MIN_POSITIVE);
            let sum = range + colour * (1.0 / COLOUR) + (1.0 - cosine) * (1.0 / FACING) + plane * (1.0 / PLANE);
            // Approximate exp(-t) by (1 - t/8)⁸, which is 0 from t = 8 on.
            let w = (1.0 - sum * 0.125).max(0.0);
            let w = tap * square(square(square(w)));
            s0[i] += w * t0[i];
            s1[i] += w * t1[i];
            s2[i] += w * t2[i];
            s3[i] += w * w * t3[i];
            weights[i] += w;
        }
    }
}

/// Relative difference in luminance that rounding alone may cause. [rounding]
const EQUAL: f32 = 1e-6;

const NEIGHBOURS: [(isize, isize); 8] = [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)];

fn luminance(r: f32, g: f32, b: f32) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Estimates the bias of the filter, relative to the mean of the image, from the images of two halves of the paths
/// before and after filtering. In each square of pixels, the mean change of one half is multiplied by the mean change
/// of the other half. The bias is the square root of the mean of these products.
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

fn check(input: &Input, params: &Params) -> Result<()> {
    check_range("strength", params.strength, 0.0, 10.0)?;
    let Input { halves: [one, other], variance, albedo, normal, position } = *input;
    let images = [("first half", one), ("second half", other)];
    let others = [("variance", variance), ("albedo", albedo), ("normal", normal), ("position", position)];
    for (name, image) in images.into_iter().chain(others) {
        one.check_same_size("first half", image, name)?;
        if image.channels < 3 {
            return Err(Error::argument(format!("{name} has {} channels; it must have 3", image.channels)));
        }
    }
    for (name, image) in images {
        let bad = image.count_non_finite();
        if bad > 0 {
            return Err(Error::argument(format!("{bad} samples of the {name} are NaN or infinite; replace them")));
        }
    }
    if let Some(v) = variance.data.iter().find(|v| !(**v >= 0.0)) {
        return Err(Error::argument(format!("a variance is {v}; it must be at least 0")));
    }
    Ok(())
}
