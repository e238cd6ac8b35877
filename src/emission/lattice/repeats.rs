//! Finds repeats: shifts that move lights onto lights. The autocorrelation of the lights has a peak at each of them.

use super::correlation::Autocorrelation;
use crate::maths;
use glam::DVec2;

/// Before the highest correlation is sought, this number of standard errors is subtracted from each correlation.
/// Otherwise a shift with few lamps in its overlap would often have the highest correlation by chance. [convention]
const STANDARD_ERRORS: f32 = 2.0;

/// The pattern counts as unchanging along an axis if the correlation is at least this at all shifts along the axis.
/// [bench emission:ceilings]
const MIN_UNCHANGING: f32 = 0.95;

/// A peak counts only if the correlation falls by at least `MIN_FALL.1` within `MIN_FALL.0` pixels on both sides of it.
/// The fall is measured along x or along y, whichever is closer to the direction of the shift. If the correlation does
/// not fall, the lights run along this axis without interruption and have no period along it.
/// [bench emission:ceilings]
const MIN_FALL: (isize, f32) = (8, 0.02);

/// A shift that moves lights onto lights, found as a peak of the autocorrelation.
pub struct Repeat {
    /// The shift, in pixels of the correlated image; [`super::shifts`] converts it to unwarped pixels.
    pub shift: DVec2,
    /// The correlation at this shift.
    pub value: f32,
    /// Number of valid pixels of the image that the shift moves onto valid pixels.
    pub overlap: f32,
}

impl Repeat {
    /// The correlation r minus [`STANDARD_ERRORS`] standard errors, because r may be too high by chance. The standard
    /// error is (1 - r²) / √(n - 1), where n is `lights`, the number of lights in the overlap.
    pub fn lower_bound(&self, lights: f32) -> f32 {
        self.value - STANDARD_ERRORS * (1.0 - maths::powi(self.value, 2)) / (lights - 1.0).max(1.0).sqrt()
    }
}

/// Whether the lights stay nearly the same under every shift along an axis, for example because they are long tubes
/// parallel to the axis. Tests the shifts of 1, 2, 3, … pixels, as long as at least 2.5 `min_overlap` pixels overlap.
pub fn is_unchanging(correlation: &Autocorrelation, axis: DVec2, min_overlap: f32) -> bool {
    let (dx, dy) = (axis.x as isize, axis.y as isize);
    let values: Vec<f32> = (1..).map_while(|i| correlation.at(dx * i, dy * i, 2.5 * min_overlap)).collect();
    !values.is_empty() && values.iter().all(|&v| v >= MIN_UNCHANGING)
}

/// Finds the local maxima of the correlation at sub-pixel precision. Only one half-plane of shifts is searched, because
/// opposite shifts have equal correlations. A maximum needs an overlap of `min_overlap` pixels and a correlation of
/// `min_value`, and the correlation must fall beside it ([`MIN_FALL`]). `unchanging` is a direction, x or y, along
/// which the lights do not change. The correlation then has ridges along this direction instead of peaks, so only
/// shifts perpendicular to it are tested.
pub fn peaks(
    correlation: &Autocorrelation,
    (width, height): (usize, usize),
    (min_overlap, min_value): (f32, f32),
    unchanging: Option<DVec2>,
) -> Vec<Repeat> {
    let (w, h) = (width as isize, height as isize);
    let mut found = Vec::new();
    for y in 0..h {
        for x in (1 - w)..w {
            let off_axis = unchanging.is_some_and(|u| u.dot(DVec2::new(x as f64, y as f64)) != 0.0);
            if (y == 0 && x <= 0) || off_axis {
                continue;
            }
            let Some(value) = correlation.at(x, y, min_overlap).filter(|&v| v >= min_value) else { continue };
            let at = |dx: isize, dy: isize| match unchanging {
                Some(u) if u.dot(DVec2::new(dx as f64, dy as f64)) != 0.0 => -1.0,
                _ => correlation.at(x + dx, y + dy, 1.0).unwrap_or(-1.0),
            };
            let ring = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
            // If neighbours are equal, the first one in reading order is the peak.
            let is_peak = ring.iter().enumerate().all(|(i, &(dx, dy))| {
                let other = at(dx, dy);
                if i < 4 { value > other } else { value >= other }
            });
            let (ux, uy) = if x.abs() > y { (1, 0) } else { (0, 1) };
            let is_flat = [-1, 1].into_iter().any(|side| {
                (1..=MIN_FALL.0).all(|k| {
                    correlation.at(x + side * k * ux, y + side * k * uy, 1.0).is_some_and(|v| v > value - MIN_FALL.1)
                })
            });
            if is_peak && !is_flat {
                // Fit a parabola through the values at -1, 0 and 1, where the value at 0 is `value`. Return the
                // position of its vertex, and the height of the vertex above `value`.
                let vertex = |low: f32, high: f32| {
                    let (slope, curvature) = (high - low, low + high - 2.0 * value);
                    if curvature > -1e-6 {
                        return (0.0, 0.0);
                    }
                    (-0.5 * slope / curvature, -0.125 * slope * slope / curvature)
                };
                let (right, rise_x) = vertex(at(-1, 0), at(1, 0));
                let (down, rise_y) = vertex(at(0, -1), at(0, 1));
                let shift = DVec2::new(x as f64 + f64::from(right), y as f64 + f64::from(down));
                let value = (value + rise_x + rise_y).min(1.0);
                found.push(Repeat { shift, value, overlap: correlation.overlap(x, y) });
            }
        }
    }
    found
}

/// Refines every shift s by peaks at its multiples. If there are peaks at about 2 s, 3 s, … n s, the position of the
/// peak at n s, divided by n, replaces s. The division reduces the error of the position by the factor n.
pub fn sharpen(peaks: &mut [Repeat]) {
    let all: Vec<DVec2> = peaks.iter().map(|p| p.shift).collect();
    for Repeat { shift, .. } in peaks {
        for times in 2.. {
            let expected = *shift * f64::from(times);
            let nearest =
                all.iter().min_by(|p, q| p.distance_squared(expected).total_cmp(&q.distance_squared(expected)));
            match nearest.filter(|p| p.distance(expected) < 1.0) {
                Some(peak) => *shift = *peak / f64::from(times),
                None => break,
            }
        }
    }
}
