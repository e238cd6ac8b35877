//! Estimates the distance of the photo's camera from the lit plane, from the size of the lamps. A photo alone
//! determines lengths only up to a factor, but lamps come in few sizes, and cameras are held at few heights.
//!
//! The method applies Bayes' rule to the logarithm of the distance, on a grid. The prior covers rooms and halls. The
//! likelihood of a lamp's two sides is a mixture of the usual lamp sizes and a broad distribution of all sizes.

use crate::maths;

/// Range of the distances in the grid, in metres, and number of grid points. [convention]
const RANGE: [f64; 2] = [0.3, 20.0];
const STEPS: usize = 400;

/// Prior of the distance, a mixture of two log-normal distributions. Each has a weight, a median in metres, and a
/// standard deviation of the logarithm. The first distribution is for rooms with a ceiling 2.4 to 3.5 m above the floor
/// and a camera 1.2 to 1.7 m above the floor. The second distribution is for halls. [convention]
const PRIOR: [[f64; 3]; 2] = [[0.8, 1.4, 0.35], [0.2, 4.0, 0.6]];

/// Usual sizes of lamps: longer and shorter side in metres, and the probability of this size. The lamps are panels and
/// troffers that replace ceiling tiles of 0.6 m (EN 13964; 2 ft in America), and battens for tubes of 1.2 and 1.5 m
/// (IEC 60081). [convention]
const SIZES: [[f64; 3]; 8] = [
    [0.6, 0.6, 0.18],
    [1.2, 0.6, 0.12],
    [1.2, 0.3, 0.10],
    [1.2, 0.15, 0.04],
    [1.5, 0.15, 0.02],
    [0.6, 0.3, 0.02],
    [0.3, 0.3, 0.01],
    [1.2, 1.2, 0.01],
];
/// Probability of a lamp of any other size. [convention]
const OTHER: f64 = 0.5;
/// Shortest and longest side, in metres, of a lamp that has none of the usual sizes. The logarithm of each of its
/// sides is uniformly distributed in this range. [convention]
const SIDES: [f64; 2] = [0.05, 3.0];
/// Share of the length of a lamp's side that is luminous; the frame takes up the rest. [convention]
const SHINES: f64 = 0.96;
/// Standard deviation of the logarithm of a measured side. Its causes are frames, blur, and errors of the unwarping.
/// [bench photos:real]
const SIDE_ERROR: f64 = 0.07;

/// A distance with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraDistance {
    /// The distance in metres; if it is an estimate, the median of the posterior.
    pub metres: f64,
    /// Standard deviation of the logarithm of the distance, which is approximately the relative error of the distance.
    /// 0 if the caller has set the distance, or a length that determines it.
    pub error: f64,
}

impl CameraDistance {
    /// A distance that is known, with an error of 0.
    pub fn exact(metres: f64) -> Self {
        Self { metres, error: 0.0 }
    }

    /// Estimates the distance of the plane of the lamps from the camera. `sides` holds the median of the lamps' longer
    /// sides and the median of their shorter sides, as multiples of the distance. Lengths of 0 mean that there is no
    /// rectangular lamp.
    pub fn of_lamps(sides: [f64; 2]) -> Self {
        let [low, high] = RANGE.map(maths::ln);
        let step = (high - low) / STEPS as f64;
        let at = |k: usize| low + (k as f64 + 0.5) * step;
        let weights: Vec<f64> = (0..STEPS).map(|k| prior(at(k)) * likelihood(at(k), sides)).collect();
        let total: f64 = weights.iter().sum();
        let mean: f64 = weights.iter().enumerate().map(|(k, w)| w * at(k)).sum::<f64>() / total;
        let square: f64 =
            weights.iter().enumerate().map(|(k, w)| w * maths::powi(at(k) - mean, 2)).sum::<f64>() / total;
        let mut below = 0.0;
        let median = weights.iter().position(|w| {
            below += w;
            below >= total / 2.0
        });
        Self { metres: maths::exp(at(median.unwrap_or(STEPS / 2))), error: square.sqrt() }
    }
}

fn prior(log_metres: f64) -> f64 {
    PRIOR.iter().map(|[weight, median, deviation]| weight * normal(log_metres - maths::ln(*median), *deviation)).sum()
}

/// Probability density of the logarithms of a lamp's two sides, if the plane is at the given distance. If the sides are
/// not positive and finite, the density is the same for all distances.
fn likelihood(log_metres: f64, sides: [f64; 2]) -> f64 {
    let any = OTHER / maths::powi(maths::ln(SIDES[1] / SIDES[0]), 2);
    if !sides.iter().all(|side| side.is_finite() && *side > 0.0) {
        return any;
    }
    let pdf = |[long, short, weight]: &[f64; 3]| {
        let off = [(sides[0], long), (sides[1], short)]
            .map(|(side, usual)| log_metres + maths::ln(side) - maths::ln(SHINES * usual));
        weight * normal(off[0], SIDE_ERROR) * normal(off[1], SIDE_ERROR)
    };
    any + SIZES.iter().map(pdf).sum::<f64>()
}

fn normal(x: f64, deviation: f64) -> f64 {
    maths::exp(-0.5 * maths::powi(x / deviation, 2)) / (deviation * std::f64::consts::TAU.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The estimate keeps a part of the prior's error, because several usual sizes have equal proportions. For example,
    /// a lamp of 1.2 m x 0.6 m at 2.2 m looks like a lamp of 0.6 m x 0.3 m at 1.1 m.
    #[test]
    fn a_usual_lamp_tells_the_distance() {
        for (long, short) in [(0.6, 0.6), (1.2, 0.6), (1.2, 0.3)] {
            for metres in [1.0, 1.5, 2.2] {
                let found = CameraDistance::of_lamps([SHINES * long / metres, SHINES * short / metres]);
                let off = (found.metres / metres).ln().abs();
                let prior = CameraDistance::of_lamps([0.0, 0.0]);
                assert!(off < 0.03 && found.error < 0.75 * prior.error, "{long} x {short} at {metres} m: {found:?}");
            }
        }
    }

    #[test]
    fn an_unusual_lamp_leaves_the_prior_and_says_so() {
        let none = CameraDistance::of_lamps([0.0, 0.0]);
        assert!(none.metres > 1.2 && none.metres < 1.8 && none.error > 0.4, "{none:?}");
        for sides in [[0.1, 0.1], [0.9, 0.02], [40.0, 40.0], [1e-9, 1e-12], [f64::NAN, 1.0], [f64::INFINITY, 1.0]] {
            let found = CameraDistance::of_lamps(sides);
            assert!(found.metres.is_finite() && found.error > 0.3, "{sides:?}: {found:?}");
        }
    }

    /// Draws distances and lamp sizes from the model. The true distance must lie within 1.96 estimated standard errors
    /// about as often as for a normal distribution.
    #[test]
    fn stated_errors_cover_what_the_model_draws() {
        let mut rng = crate::rng::Rng::new(5, &[]);
        let mut gauss = || (0..12).map(|_| rng.next_f64()).sum::<f64>() - 6.0;
        let covered = (0..2000).filter(|k| {
            let [_, median, deviation] = PRIOR[usize::from(k % 5 == 0)];
            let metres = median * (deviation * gauss()).exp();
            let [long, short, _] = SIZES[[0, 1, 2][k % 3]];
            let sides = [long, short].map(|side| SHINES * side / metres * (SIDE_ERROR * gauss()).exp());
            let found = CameraDistance::of_lamps(sides);
            (found.metres / metres).ln().abs() < 1.96 * found.error
        });
        let share = covered.count() as f64 / 2000.0;
        assert!(share > 0.93, "{share} of the distances lie within 1.96 stated errors");
    }
}
