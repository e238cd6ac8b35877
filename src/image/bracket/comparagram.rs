//! Compares the values of two exposures of the same pixels, level by level (Mann 2000, "Comparametric equations with
//! practical applications in quantigraphic image processing").
//!
//! The pixels are divided into levels by the mean of their two encoded values, so that noise does not select pixels
//! that are bright in one photo and dark in the other. Within a level, pixels that moved are left out by their robust
//! distance from the median.

use super::frame::{Frame, colours, peak};
use super::ratio::MAD_TO_SIGMA;
use crate::error::Result;
use crate::exec;
use crate::image::colour::linear_to_srgb;
use crate::image::try_push;
use crate::job::Job;
use crate::maths;

/// Approximate maximum number of pixels that are read; larger photos are read at an even lattice of pixels.
const MAX_PIXELS: usize = 1 << 18;

/// Number of levels. [convention]
const LEVELS: usize = 64;

/// A level is used only if it has at least this many values. [convention]
const MIN_VALUES: usize = 64;

/// Values further than this many standard deviations from the median of their level are left out. [convention]
const OUTLIER: f32 = 3.0;

/// Minimum standard deviation of the logarithm of a ratio, so that levels without noise keep all values. [rounding]
const MIN_SPREAD: f32 = 2e-3;

/// Range of the mean values of a level: the encoded value in the short exposure is at least the first number, because
/// noise and the rounding to codes change the mean of darker values; the value in the long exposure is at most the
/// second number times the clipping value, because brighter levels lose the pixels that noise clips. [convention]
const USABLE: [f64; 2] = [0.08, 0.85];

/// Standard error of the mean of a level that remains with any number of pixels, in encoded values: a tenth of an 8-bit
/// code. [convention]
const ROUNDING: f64 = 0.1 / 255.0;

/// A level of light: its mean values in both exposures.
#[derive(Clone, Copy, Debug)]
pub struct LevelPair {
    pub short: f64,
    pub long: f64,
    /// Variance of the logarithm of `long / short`.
    pub variance: f64,
}

/// Returns the levels of two photos of low dynamic range, in ascending order. Every colour channel counts for itself.
pub fn levels(short: &Frame, long: &Frame, [width, height]: [usize; 2], job: Job) -> Result<Vec<LevelPair>> {
    let step = ((width * height).div_ceil(MAX_PIXELS) as f64).sqrt().ceil() as usize;
    let rows = exec::map(height.div_ceil(step), job, |row| {
        let y = row * step;
        let pair = |x: usize| Some((short.pixel(x, y)?, long.pixel(x, y)?));
        let is_open = |(s, l): &(&[f32], &[f32])| peak(s) < short.clip && peak(l) < long.clip;
        let open = (0..width).step_by(step).filter_map(pair).filter(is_open);
        let values = open.flat_map(|(s, l)| colours(s).iter().copied().zip(colours(l).iter().copied()));
        values.filter(|(s, l)| *s > 0.0 && *l > 0.0).collect::<Vec<_>>()
    })?;
    let mut by_level: Vec<Vec<[f32; 2]>> = vec![Vec::new(); LEVELS];
    for (s, l) in rows.into_iter().flatten() {
        let mean = 0.5 * (linear_to_srgb(s) + linear_to_srgb(l));
        try_push(&mut by_level[((mean * LEVELS as f32) as usize).min(LEVELS - 1)], [s, l])?;
    }
    let is_usable = |level: &LevelPair| {
        let code = f64::from(linear_to_srgb(level.short as f32));
        code >= USABLE[0] && level.long <= USABLE[1] * f64::from(long.clip)
    };
    Ok(by_level.iter().filter_map(|values| level_of(values)).filter(is_usable).collect())
}

/// Returns the means of a level without outliers; `None` if it has too few values.
fn level_of(values: &[[f32; 2]]) -> Option<LevelPair> {
    if values.len() < MIN_VALUES {
        return None;
    }
    let ratio = |[s, l]: &[f32; 2]| maths::ln(l / s);
    let middle = median(values.iter().map(ratio).collect());
    let spread = median(values.iter().map(|v| (ratio(v) - middle).abs()).collect());
    let limit = OUTLIER * (MAD_TO_SIGMA as f32 * spread).max(MIN_SPREAD);
    let (mut count, mut sums, mut squares) = (0.0, [0.0; 2], 0.0);
    for value in values.iter().filter(|v| (ratio(v) - middle).abs() <= limit) {
        count += 1.0;
        sums = [sums[0] + f64::from(value[0]), sums[1] + f64::from(value[1])];
        squares += maths::powi(f64::from(ratio(value) - middle), 2);
    }
    let [short, long] = sums.map(|sum| sum / count);
    let rounding = [short, long].map(|v| maths::powi(ROUNDING * slope(v), 2));
    Some(LevelPair { short, long, variance: squares / (count * count) + rounding[0] + rounding[1] })
}

/// Returns the derivative of the logarithm of the light with respect to the encoded value.
fn slope(light: f64) -> f64 {
    2.4 / (f64::from(linear_to_srgb(light as f32)) + 0.055)
}

fn median(mut values: Vec<f32>) -> f32 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}
