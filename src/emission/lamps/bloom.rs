//! Bloom: the light that a lens spreads around a lamp. It lengthens every side of a lamp by about the same number of
//! photo pixels.

use crate::maths;
use glam::{DMat2, DVec2};

/// `SIDE_NOISE`: standard deviation of the error of a measured side. `BLOOM`: standard deviation of the prior of the
/// bloom, the distance by which a lens moves each edge outwards; the prior has mean 0. Both in photo pixels.
/// [judged on 20 photos]
const SIDE_NOISE: f64 = 0.7;
const BLOOM: f64 = 0.5;
/// `SHOWN_BLOOM` is the standard deviation of a wider prior, in photo pixels. It replaces `BLOOM` if the lamps show
/// their bloom, which means:
///
/// - There are at least `MIN_BLOOM_LAMPS` lamps.
/// - The estimated bloom is between 0 and `MAX_BLOOM` photo pixels.
/// - The bloom explains more than the share `MIN_EXPLAINED` of the variation of the sides. Lamps of several lengths and
///   partly hidden lamps fail this condition, because their sides do not grow with magnification.
///
/// `MIN_SIDE`: minimum side without bloom, as a share of the shortest measured side. [bench photos:tune, photos:real]
const SHOWN_BLOOM: f64 = 6.0;
const MAX_BLOOM: f64 = 10.0;
const MIN_EXPLAINED: f64 = 0.5;
pub const MIN_BLOOM_LAMPS: usize = 4;
const MIN_SIDE: f64 = 0.35;

/// Estimates the side that lamps of equal size have without bloom, in unwarped pixels. Each item of `sides` holds the
/// measured side of a lamp and the length of a photo pixel at the lamp, both in unwarped pixels.
///
/// - If at least [`MIN_BLOOM_LAMPS`] lamps show their bloom ([`BloomFit::shown`]), the bloom is estimated with the wide
///   prior [`SHOWN_BLOOM`].
/// - Otherwise it is estimated with the narrow prior [`BLOOM`]. If this estimate is not above 0, or if there is only
///   one lamp, the result is the mean measured side.
///
/// `None` if there is no lamp.
pub fn common_side(sides: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let fit = BloomFit::new(sides);
    let shown = if fit.count >= MIN_BLOOM_LAMPS { fit.shown() } else { None };
    shown.or_else(|| {
        let [side, bloom] = fit.solve(BLOOM).to_array();
        fit.limited(if bloom > 0.0 && fit.count > 1 { side } else { fit.mean() })
    })
}

/// A weighted least-squares fit of the line `side = s + 2 b p` to the measured sides of lamps. `p` is the length of a
/// photo pixel at a lamp in unwarped pixels. The unknowns are the side `s` without bloom, in unwarped pixels, and the
/// bloom `b` at each edge, in photo pixels.
pub struct BloomFit {
    /// The normal equations are `gram` (s, b) = `sums`.
    gram: DMat2,
    sums: DVec2,
    /// Weighted sum of the squared measured sides.
    square: f64,
    shortest: f64,
    count: usize,
}

impl BloomFit {
    pub fn new(sides: impl Iterator<Item = (f64, f64)>) -> Self {
        let mut fit = Self { gram: DMat2::ZERO, sums: DVec2::ZERO, square: 0.0, shortest: f64::INFINITY, count: 0 };
        for (side, pixel) in sides {
            let weight = maths::powi(SIDE_NOISE * pixel, -2);
            let row = DVec2::new(1.0, 2.0 * pixel);
            fit.gram += DMat2::from_cols(row * row.x, row * row.y) * weight;
            fit.sums += row * side * weight;
            fit.square += side * side * weight;
            (fit.shortest, fit.count) = (fit.shortest.min(side), fit.count + 1);
        }
        fit
    }

    /// Solves for (s, b), the side in unwarped pixels and the bloom in photo pixels. The prior of the bloom is normal,
    /// with mean 0 and the given standard deviation in photo pixels.
    fn solve(&self, deviation: f64) -> DVec2 {
        (self.gram + DMat2::from_diagonal(DVec2::new(0.0, maths::powi(deviation, -2)))).inverse() * self.sums
    }

    /// The weighted mean of the measured sides.
    fn mean(&self) -> f64 {
        self.sums.x / self.gram.x_axis.x
    }

    /// The side without bloom. `None` if the bloom is below 0 or above [`MAX_BLOOM`], or if it does not explain more
    /// than the share [`MIN_EXPLAINED`] of the variation of the measured sides.
    pub fn shown(&self) -> Option<f64> {
        let solution = self.solve(SHOWN_BLOOM);
        // Weighted sums of squared residuals of two models: a side with bloom (`left`), and a constant side (`all`).
        let left = self.square - 2.0 * solution.dot(self.sums) + solution.dot(self.gram * solution);
        let all = self.square - self.mean() * self.sums.x;
        let is_shown = (0.0..=MAX_BLOOM).contains(&solution.y) && left < (1.0 - MIN_EXPLAINED) * all;
        is_shown.then_some(solution.x).and_then(|side| self.limited(side))
    }

    /// Returns the larger of `side` and [`MIN_SIDE`] times the shortest measured side; `None` unless this is positive
    /// and finite.
    fn limited(&self, side: f64) -> Option<f64> {
        Some(side.max(MIN_SIDE * self.shortest)).filter(|s| s.is_finite() && *s > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bloom_that_grows_with_magnification_is_taken_off() {
        // Sides of 40 unwarped pixels. Bloom moves each edge by 0.8 photo pixels. A photo pixel is 1 to 6 unwarped
        // pixels long.
        let pixels = [1.0f64, 1.5, 2.5, 4.0, 6.0];
        let side = common_side(pixels.into_iter().map(|p| (40.0 + 1.6 * p, p))).unwrap();
        assert!((side - 40.0).abs() < 1.0, "{side}");
        // A single lamp keeps its measured side.
        assert!((common_side([(41.6, 1.0)].into_iter()).unwrap() - 41.6).abs() < 1e-9);
    }
}
