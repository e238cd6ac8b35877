//! Expected values of terms of Tukey's biweight, for normally distributed residuals. `sphere` computes the covariance
//! of a vanishing point from them. Residuals are in units of the biweight's limit. Beyond the limit the weight is 0, so
//! residuals with `|r| ≥ 1` are left out of all means.

use crate::maths;
use std::sync::LazyLock;

/// Means over the residuals `r` with `|r| < 1`, for normally distributed residuals of known variance. As the variance
/// tends to 0, all three means tend to 1. They fall as the variance grows.
#[derive(Clone, Copy, Debug)]
pub struct Biweight {
    /// Mean of `r²`, divided by the variance.
    pub square: f64,
    /// Mean of `ψ′(r)`, where `ψ(r) = r (1 - r²)²`.
    pub slope: f64,
    /// Mean of `ψ²(r)`, divided by the variance.
    pub influence: f64,
}

/// Number of intervals of the lookup table. Its entries are spaced uniformly in `d / (1 + d)`, where `d` is the
/// standard deviation of the residuals.
const INTERVALS: usize = 64;

/// `MIN_DEVIATION`: smallest standard deviation for which the means are integrated; a smaller standard deviation gets
/// the means of this one. `STEPS`: number of integration steps. [rounding]
const MIN_DEVIATION: f64 = 1e-3;
const STEPS: usize = 256;

static TABLE: LazyLock<[Biweight; INTERVALS + 1]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let place = i as f64 / INTERVALS as f64;
        if i < INTERVALS { integrate((place / (1.0 - place)).max(MIN_DEVIATION)) } else { Biweight::INFINITE_NOISE }
    })
});

impl Biweight {
    const INFINITE_NOISE: Self = Self { square: 0.0, slope: 0.0, influence: 0.0 };

    pub fn of_noise(variance: f64) -> Self {
        let deviation = variance.max(0.0).sqrt();
        let place = INTERVALS as f64 * (deviation / (1.0 + deviation)).min(1.0);
        let first = (place as usize).min(INTERVALS - 1);
        let (a, b, t) = (TABLE[first], TABLE[first + 1], place - first as f64);
        let between = |a: f64, b: f64| a + (b - a) * t;
        Self {
            square: between(a.square, b.square),
            slope: between(a.slope, b.slope),
            influence: between(a.influence, b.influence),
        }
    }
}

fn integrate(deviation: f64) -> Biweight {
    let variance = deviation * deviation;
    let far = (8.0 * deviation).min(1.0);
    let mut sums = [0.0; 4];
    for step in 0..STEPS {
        let square = maths::powi((step as f64 + 0.5) / STEPS as f64 * far, 2);
        let gaussian = maths::exp(-0.5 * square / variance);
        let agreement = 1.0 - square;
        let values = [1.0, square, agreement * (1.0 - 5.0 * square), square * maths::powi(agreement, 4)];
        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += gaussian * value);
    }
    let [all, square, slope, influence] = sums;
    Biweight { square: square / (all * variance), slope: slope / all, influence: influence / (all * variance) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn means_are_those_of_random_residuals() {
        for deviation in [0.0, 0.01, 0.1, 0.3, 0.45, 0.9, 3.0] {
            let mut rng = Rng::new(5, &[]);
            let (mut sums, mut count) = ([0.0; 3], 0.0);
            for _ in 0..400_000 {
                let unit = rng.normal();
                let square = (deviation * unit).powi(2);
                if square < 1.0 {
                    let a = 1.0 - square;
                    let values = [unit * unit, a * (1.0 - 5.0 * square), unit * unit * a.powi(4)];
                    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
                    count += 1.0;
                }
            }
            let Biweight { square, slope, influence } = Biweight::of_noise(deviation * deviation);
            for (found, sum) in [square, slope, influence].into_iter().zip(sums) {
                assert!((found - sum / count).abs() < 0.01, "{deviation}: {found} instead of {}", sum / count);
            }
        }
        let limit = Biweight::of_noise(f64::INFINITY);
        assert!(limit.slope == 0.0 && limit.square == 0.0 && limit.influence == 0.0);
    }
}
