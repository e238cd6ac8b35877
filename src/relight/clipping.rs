//! Estimates the values that the clipped pixels of a photo would have without clipping.
//!
//! A plane receives light directly from lamps and light reflected by the room. The colours of its pixels are mixtures
//! of these two lights and lie roughly on a line in colour space.
//!
//! 1. For each pair of channels, fit a line to the pixels in which both channels are unclipped.
//! 2. In the other pixels, predict a clipped channel from an unclipped one with this line.
//! 3. Limit the prediction, because it is an extrapolation. It is at least the clipped value. If it exceeds the clipped
//!    value, it is at most `r x`, where `x` is the value of the unclipped channel, and `r` is the mean of the clipped
//!    channel divided by the mean of the unclipped channel, both over the pixels of step 1.
//!
//! If all channels of a pixel are clipped, the pixel keeps its values, which are lower bounds.

use crate::maths;
use glam::{BVec3, DVec3, Vec3};

/// A channel of the photo counts as clipped from this linear value on; only the two largest 8-bit values reach it. In
/// the unwarped photo, whose pixels are means of photo pixels, the limit is lower (`emission::Params::clip_level`).
/// [convention]
const CLIPPED: f32 = 0.987;
/// The line between two channels is fitted only if at least this share of the pixels is unclipped in both.
/// [bench constants:colour]
const MIN_UNCLIPPED_SHARE: f64 = 0.02;
/// Strength of the regularisation of the fitted line. If the relative standard deviation of the predicting channel is
/// smaller than this, the line runs nearly through black; if it is larger, the line follows the pixels.
/// [bench constants:colour]
const RIDGE: f64 = 0.05;

/// Returns the mean colour of `pixels`, and for each channel the share of pixels in which its value remains unknown,
/// because it is clipped and was not estimated. Clipped values are estimated only if `one_plane` is true, that is, if
/// all pixels show one plane. Returns `None` if there are no pixels.
pub(super) fn mean(pixels: impl Iterator<Item = Vec3> + Clone, one_plane: bool) -> Option<(DVec3, DVec3)> {
    let mut moments = [[Moments::default(); 3]; 3];
    let mut count = 0.0;
    for rgb in pixels.clone() {
        count += 1.0;
        let unclipped = !clipped(rgb);
        for (x, y) in pairs().filter(|(x, y)| unclipped.test(*x) && unclipped.test(*y)) {
            moments[y][x].add(f64::from(rgb[x]), f64::from(rgb[y]));
        }
    }
    if count == 0.0 {
        return None;
    }
    let min_pixels = if one_plane { MIN_UNCLIPPED_SHARE * count } else { f64::INFINITY };
    let lines = moments.map(|row| row.map(|m| m.line(min_pixels)));
    let (mut sum, mut unknown) = (DVec3::ZERO, DVec3::ZERO);
    for rgb in pixels {
        let mask = clipped(rgb);
        let mut colour = rgb.as_dvec3();
        for y in (0..3).filter(|c| mask.test(*c)) {
            // Predict from the brightest unclipped channel that has a line to this channel.
            let known = (0..3).filter(|&x| !mask.test(x)).filter_map(|x| Some((rgb[x], lines[y][x]?)));
            match known.max_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((value, line)) => colour[y] = colour[y].max(line.at(value.into())),
                None => unknown[y] += 1.0,
            }
        }
        sum += colour;
    }
    Some((sum / count, unknown / count))
}

fn clipped(rgb: Vec3) -> BVec3 {
    rgb.cmpge(Vec3::splat(CLIPPED))
}

/// All ordered pairs of different channels.
fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..9).map(|i| (i % 3, i / 3)).filter(|(x, y)| x != y)
}

/// Sums over the pixels in which neither of two channels, x and y, is clipped.
#[derive(Clone, Copy, Default)]
struct Moments {
    n: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
}

/// The line that predicts channel y from the value x of another channel: `start + slope * x`, but at most `ratio * x`.
#[derive(Clone, Copy)]
struct Line {
    start: f64,
    slope: f64,
    /// Mean of channel y divided by the mean of channel x, over the pixels to which the line is fitted.
    ratio: f64,
}

impl Line {
    fn at(self, x: f64) -> f64 {
        (self.start + self.slope * x).min(self.ratio * x)
    }
}

impl Moments {
    fn add(&mut self, x: f64, y: f64) {
        self.n += 1.0;
        self.x += x;
        self.y += y;
        self.xx += x * x;
        self.xy += x * y;
    }

    /// Fits the line by least squares, regularised towards the line through black. Returns `None` if there are fewer
    /// than `min_pixels` pixels, or if channel x is black in all of them.
    fn line(&self, min_pixels: f64) -> Option<Line> {
        let (x, y) = (self.x / self.n, self.y / self.n);
        if self.n < min_pixels || !(x > 0.0) {
            return None;
        }
        let (variance, covariance) = ((self.xx / self.n - x * x).max(0.0), self.xy / self.n - x * y);
        let pull = maths::powi(RIDGE * x, 2);
        let slope = ((covariance + pull * y / x) / (variance + pull)).max(0.0);
        Some(Line { start: y - slope * x, slope, ratio: y / x })
    }
}
