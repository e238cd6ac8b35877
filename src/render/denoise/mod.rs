//! Noise filter: smooths an image rendered with few paths per pixel, guided by surface attributes, and states the error
//! of the result.
//!
//! 1. The paths of each pixel are split into two halves. The images of the two halves are filtered separately (after
//!    Rousselle et al. 2012, "Adaptive rendering with non-local means filtering"). First they are divided by the albedo
//!    of the surfaces (`light`), which preserves textures.
//! 2. A first pass averages 5 x 5 neighbours on the same surface (`guides`). Its result is the first pilot: an image
//!    with so little noise that its pixels can be compared by a statistical test.
//! 3. Further passes take 5 x 5 neighbours at growing distances. A neighbour counts if the pilot values of the two
//!    pixels differ by no more than their variances explain (after Sakai et al. 2024, "A statistical approach to Monte
//!    Carlo denoising"). Each pass fits a plane to the neighbours instead of taking their mean (`regression`), so that
//!    gradients survive. Its result is the pilot of the next pass. The variances follow from the difference between the
//!    two halves, which includes the correlation between pixels that share paths.
//! 4. Each pixel takes the result of the pass with the least estimated error, or stays as it is (`choice`). If the
//!    halves are equal and all variances are 0, the image is unchanged.
//! 5. A pixel has two values, one from each half of its paths. The filter changes neither value by more than two
//!    standard errors of the value (`limit`).
//! 6. The error, the bias and the interval of each pixel are estimated from the halves (`statement`).
//!
//! The filter is biased: it blurs features that the guide images do not show, such as soft shadows, wherever the
//! feature differs from its surroundings by no more than about the standard error. The stated error includes this bias.
//! Final images are rendered without the filter.
//!
//! Not modelled: motion; reflections, which are smoothed as if they were light on the mirror's surface; textures seen
//! in mirrors, which are blurred.

mod choice;
mod guides;
mod input;
mod light;
mod limit;
mod planes;
mod regression;
mod statement;

use crate::error::{Result, check_range};
use crate::exec;
use crate::image::Image;
use crate::job::Job;
pub use input::Input;

use guides::Guides;
use light::Light;
use planes::{Classes, Planes};
use regression::{FilterPass, PilotImage};
use statement::Statement;

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Strength of the smoothing, in `[0, 10]`. The filter averages neighbouring pixels whose pilots (first estimates
    /// of their values, [`PilotImage`]) differ by no more than noise explains. `strength` scales the squared difference
    /// that counts as noise. 0 leaves the image unchanged.
    pub strength: f32,
}

impl Default for Params {
    fn default() -> Self {
        Self { strength: 1.0 }
    }
}

#[derive(Clone, Debug)]
pub struct Output {
    pub image: Image,
    /// Half-width of the 95 % interval of each pixel's radiance, per channel, bias included; infinite where a variance
    /// is unknown. Along the edges of surfaces, fewer than 95 % of the intervals contain the truth
    /// (docs/notes/filter.md).
    pub interval: Image,
    /// Estimated error, remaining noise and bias together: root mean square over pixels and channels, relative to the
    /// mean of the image. Infinite if a variance is unknown.
    pub error: f64,
    /// Estimated bias, relative to the mean of the image: the root mean square, over squares of 8 × 8 pixels, of the
    /// mean bias in a square. The mean square is an unbiased estimate, which noise can make negative; it then counts as
    /// 0. Blur within a square of pixels goes undetected.
    pub bias: f64,
}

/// For each pass: the distance between neighbouring taps, and the radius over which the variance of the pilot is
/// averaged, both in pixels. [bench filter]
const PASSES: [(usize, usize); 3] = [(1, 6), (2, 6), (4, 10)];
/// At strength 1, the weight of a neighbour is divided by e if `(a - b)² = TOLERANCE * (v + w)`. Here a and b are the
/// pilot values of the pixel and the neighbour, and v and w their variances. [bench filter]
const TOLERANCE: f32 = 4.0;

/// Filters the image, and states the error of the result.
///
/// # Errors
/// Images of different sizes or with too few channels; values that are not finite; a strength out of range; no memory;
/// cancelled.
pub fn run(input: &Input, params: &Params, job: Job) -> Result<Output> {
    check_range("strength", params.strength, 0.0, 10.0)?;
    input.check()?;
    let guides = Guides::new(input, job.part(0.0, 0.05))?;
    let light = Light::new(input, &guides, job.part(0.05, 0.1))?;
    let edges = guides.edges(job.part(0.1, 0.1))?;
    let classes = Classes { is_first: &edges };
    let passes = match params.strength > 0.0 {
        true => passes(&light, &guides, &classes, TOLERANCE * params.strength, job.part(0.1, 0.8))?,
        false => Vec::new(),
    };
    let chosen = choice::choose(&light, &passes, &classes, job.part(0.8, 0.9))?;
    let limits = limit::limits(input, job.part(0.9, 0.91))?;
    let change = Change { light: &light, chosen: &chosen, limits: &limits };
    let [one, other] = [0, 1].map(|half| change.of(input.halves[half], half, job.part(0.91, 0.92)));
    let (mut image, other) = (one?, other?);
    let statement = Statement::of(&light, &classes, input.halves, [&image, &other], job.part(0.92, 0.98))?;
    exec::for_rows(&mut image.data, 3 * other.width, job.part(0.98, 1.0), |y, row| {
        row.iter_mut().zip(&other.data[3 * other.width * y..]).for_each(|(a, b)| *a = 0.5 * *a + 0.5 * b);
    })?;
    let Statement { interval, error, bias } = statement;
    Ok(Output { image, interval, error, bias })
}

/// Returns the filtered light after each pass; the pilot of the first pass is not among them.
fn passes(light: &Light, guides: &Guides, classes: &Classes, tolerance: f32, job: Job) -> Result<Vec<Planes>> {
    let pass = |values: &Planes, pilot: Option<PilotImage>, step: usize, job: Job| {
        FilterPass { light: values, pilot, confidence: &light.confidence, guides, step }.run(job)
    };
    let mut pilot = pass(&light.halves, None, 1, job.part(0.0, 0.2))?;
    let mut passes: Vec<Planes> = Vec::with_capacity(PASSES.len());
    for (i, (step, radius)) in PASSES.into_iter().enumerate() {
        let part = job.part(0.2 + 0.26 * i as f64, 0.2 + 0.26 * (i + 1) as f64);
        let values = passes.last().unwrap_or(&light.halves);
        let pilots = passes.last().unwrap_or(&pilot);
        let before = passes.iter().rev().nth(1).unwrap_or(&light.halves);
        let squares = squared_differences(light, pilots, before, part.part(0.0, 0.05))?;
        let variance = classes.smoothed(&squares, radius, part.part(0.05, 0.2))?;
        let tested = PilotImage { light: pilots, variance: &variance, tolerance };
        let filtered = pass(values, Some(tested), step, part.part(0.2, 1.0))?;
        passes.push(filtered);
        // Free the first pilot: from now on, the pilot is the result of the most recent pass.
        pilot.data = Vec::new();
    }
    Ok(passes)
}

/// Returns half the squared difference between the halves of the pilot, per channel: an estimate of the variance of a
/// half. Where the variance of the picture is unknown, the two halves may be equal. There, the difference between the
/// first half of the pilot and of `before`, the pilot's predecessor, is used instead.
fn squared_differences(light: &Light, pilot: &Planes, before: &Planes, job: Job) -> Result<Planes> {
    let (width, height) = (pilot.width, pilot.height);
    Planes::from_rows([width, height, 3], job, |y, row| {
        for (c, plane) in row.chunks_exact_mut(width).enumerate() {
            let (one, other) = (pilot.row(y, c), pilot.row(y, c + 3));
            for (x, out) in plane.iter_mut().enumerate() {
                let other = if light.is_known(x, y) { other[x] } else { before.row(y, c)[x] };
                *out = 0.5 * (one[x] - other) * (one[x] - other);
            }
        }
    })
}

/// The change of the picture by the filter.
struct Change<'a> {
    light: &'a Light,
    /// Both halves of the filtered light.
    chosen: &'a Planes,
    /// The largest change of a half (see [`limit::limits`]).
    limits: &'a Planes,
}

impl Change<'_> {
    /// Returns the filtered picture of half number `number`, from its unfiltered picture `half`. The change of the
    /// light is multiplied by the albedo and the unit, clamped to the limit, and added to the unfiltered half. A pixel
    /// whose light is unchanged therefore keeps its exact value.
    fn of(&self, half: &Image, number: usize, job: Job) -> Result<Image> {
        let Self { light, chosen, limits } = *self;
        let width = half.width;
        let mut image = Image::new(width, half.height, 3)?;
        exec::for_rows(&mut image.data, 3 * width, job, |y, row| {
            for (x, out) in row.chunks_exact_mut(3).enumerate() {
                for (c, out) in out.iter_mut().enumerate() {
                    let [before, after] = [&light.halves, chosen].map(|planes| planes.row(y, 3 * number + c)[x]);
                    let (change, limit) = ((after - before) * light.albedo(x, y, c) * light.unit, limits.row(y, c)[x]);
                    *out = half.pixel(x, y)[c] + change.max(-limit).min(limit);
                }
            }
        })?;
        Ok(image)
    }
}
