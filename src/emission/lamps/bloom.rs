//! Bloom: the light that a lens spreads around a lamp. It lengthens every side of a lamp by about the same number of
//! photo pixels.

use crate::maths;

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
    fit.side(fit.bloom())
}

/// Estimates two sides as [`common_side`] does. The long side gets at most the bloom of the short side: lamps that are
/// partly hidden have different lengths, which a large bloom can seem to explain.
pub fn common_sides(sides: [impl Iterator<Item = (f64, f64)>; 2]) -> Option<[f64; 2]> {
    let fits = sides.map(BloomFit::new);
    let mut blooms = [fits[0].bloom(), fits[1].bloom()];
    let long = usize::from(fits[1].mean() > fits[0].mean());
    blooms[long] = blooms[long].min(blooms[1 - long]);
    Some([fits[0].side(blooms[0])?, fits[1].side(blooms[1])?])
}

/// A weighted least-squares fit of the line `side = s + 2 b p` to the measured sides of lamps. `p` is the length of a
/// photo pixel at a lamp in unwarped pixels. The unknowns are the side `s` without bloom, in unwarped pixels, and the
/// bloom `b` at each edge, in photo pixels.
pub struct BloomFit {
    /// Weighted sums over the lamps, where y is the measured side and x = 2 p.
    weight: f64,
    x: f64,
    y: f64,
    /// The same sums of products, relative to the means of x and y, once all lamps are added.
    xx: f64,
    xy: f64,
    yy: f64,
    shortest: f64,
    count: usize,
}

impl BloomFit {
    pub fn new(sides: impl Iterator<Item = (f64, f64)>) -> Self {
        let mut fit =
            Self { weight: 0.0, x: 0.0, y: 0.0, xx: 0.0, xy: 0.0, yy: 0.0, shortest: f64::INFINITY, count: 0 };
        for (side, pixel) in sides {
            let (weight, x) = (maths::powi(SIDE_NOISE * pixel, -2), 2.0 * pixel);
            fit.weight += weight;
            fit.x += weight * x;
            fit.y += weight * side;
            fit.xx += weight * x * x;
            fit.xy += weight * x * side;
            fit.yy += weight * side * side;
            (fit.shortest, fit.count) = (fit.shortest.min(side), fit.count + 1);
        }
        fit.xx -= fit.x * fit.x / fit.weight;
        fit.xy -= fit.x * fit.y / fit.weight;
        fit.yy -= fit.y * fit.y / fit.weight;
        fit
    }

    /// The bloom in photo pixels, at least 0, as [`common_side`] describes it.
    fn bloom(&self) -> f64 {
        let shown = if self.count >= MIN_BLOOM_LAMPS { self.shown_bloom() } else { None };
        shown.unwrap_or_else(|| if self.count > 1 { self.bloom_with_prior(BLOOM).max(0.0) } else { 0.0 })
    }

    /// The bloom in photo pixels. Its prior is normal, with mean 0 and the given standard deviation in photo pixels.
    fn bloom_with_prior(&self, deviation: f64) -> f64 {
        self.xy / (self.xx + maths::powi(deviation, -2))
    }

    /// The bloom that the lamps show. `None` if it is below 0 or above [`MAX_BLOOM`], or if it does not explain more
    /// than the share [`MIN_EXPLAINED`] of the variation of the measured sides.
    fn shown_bloom(&self) -> Option<f64> {
        let bloom = self.bloom_with_prior(SHOWN_BLOOM);
        // The weighted sum of squared residuals with bloom; `yy` is this sum without bloom.
        let left = self.yy - 2.0 * bloom * self.xy + bloom * bloom * self.xx;
        ((0.0..=MAX_BLOOM).contains(&bloom) && left < (1.0 - MIN_EXPLAINED) * self.yy).then_some(bloom)
    }

    /// The side without the bloom that the lamps show; `None` if they show none ([`Self::shown_bloom`]).
    pub fn shown(&self) -> Option<f64> {
        self.shown_bloom().and_then(|bloom| self.side(bloom))
    }

    /// The weighted mean of the measured sides.
    fn mean(&self) -> f64 {
        self.y / self.weight
    }

    /// The side without the given bloom, but at least [`MIN_SIDE`] times the shortest measured side; `None` unless it
    /// is positive and finite.
    fn side(&self, bloom: f64) -> Option<f64> {
        let side = (self.mean() - bloom * self.x / self.weight).max(MIN_SIDE * self.shortest);
        Some(side).filter(|s| s.is_finite() && *s > 0.0)
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

    #[test]
    fn lengths_get_no_more_bloom_than_widths() {
        // Lamps of 14 x 70 unwarped pixels with a bloom of half a photo pixel. The nearest one is hidden in part.
        // Alone, the lengths would be those of lamps of 20 unwarped pixels with a bloom of 5 photo pixels.
        let lengths = [(43.0, 2.45), (68.0, 4.19), (68.0, 4.71), (66.0, 5.33)];
        assert!(common_side(lengths.into_iter()).unwrap() < 25.0);
        let widths = [1.43, 0.88, 1.92, 3.28].map(|pixel| (14.0 + pixel, pixel));
        let [width, length] = common_sides([widths.into_iter(), lengths.into_iter()]).unwrap();
        assert!((width - 14.0).abs() < 0.5 && length > 45.0, "{width} x {length}");
        let [length, width] = common_sides([lengths.into_iter(), widths.into_iter()]).unwrap();
        assert!((width - 14.0).abs() < 0.5 && length > 45.0, "{width} x {length}");
    }
}
