//! Recovers the tone curve of the camera from a bracket with known exposures (Mitsunaga and Nayar 1999, "Radiometric
//! self calibration").
//!
//! If the camera's curve is not that of sRGB, the values `v` of the loaded photos are not proportional to the light.
//! The light is `g(v) = v exp(p(v))`, with one curve for all channels and photos. For two exposures of a pixel with the
//! ratio `R`, `ln g(long) - ln g(short) = ln R`. The correction `p` is a sum of basis functions, so this is a linear
//! least squares problem in its coefficients: a multiple of `ln v`, which changes the exponent of the curve, and
//! Chebyshev polynomials of the encoded value. (The authors use a polynomial for `g` itself; the logarithm weighs
//! relative errors, and sRGB is the curve `p = 0`.)
//!
//! Exposures that metadata state are known up to their rounding; the ratios are then unknowns too, with the stated
//! values as priors. Without any knowledge of the exposures, the curve cannot be found: `g` and `R` and any power of
//! both fit equally well (Grossberg and Nayar 2003, "Determining the camera response from images: what is knowable?").
//!
//! Not modelled: curves that differ between channels or photos, as of cameras that adapt the curve to each photo.

use super::comparagram::LevelPair;
use super::params::{CURVE_VALUES, CurveReport};
use crate::image::colour::{linear_to_srgb, srgb_to_linear};
use crate::maths;

/// Number of basis functions: the logarithm, and Chebyshev polynomials of the orders 1 to 5. Cameras' curves need about
/// this many for 1 % (Grossberg and Nayar 2003: five components explain 99.9 % of the variance of 201 curves).
const TERMS: usize = 6;

/// Standard deviation of the prior of each coefficient: wide, it only decides what the photos leave open. [convention]
const PRIOR: f64 = 3.0;

/// Standard deviation of the logarithm of an exposure ratio that the caller gives: small against the errors of the
/// levels, and large enough for the precision of the equations. [convention]
const GIVEN: f64 = 1e-4;

/// Standard deviation of the logarithm of a ratio of which nothing is known. [convention]
const UNKNOWN: f64 = 10.0;

/// A curve is recovered only from ratios of exposures with logarithms of at least this: the levels of two exposures
/// must differ. [convention: a third of a stop]
const MIN_LOG_RATIO: f64 = 0.2;

/// A curve needs at least this many levels per unknown. [convention]
const LEVELS_PER_UNKNOWN: usize = 2;

/// A curve replaces that of sRGB only if the F statistic of the fit without and with the curve exceeds this (for 6 and
/// 24 degrees of freedom, chance exceeds it once in 3000 brackets), and if it changes the light of some level by more
/// than `MIN_CHANGE` and by more than `SIGNIFICANT` of its standard errors. [convention]
const MIN_F: f64 = 6.0;
const MIN_CHANGE: f64 = 0.02;
const SIGNIFICANT: f64 = 3.0;

/// Minimum slope of the logarithm of the light against that of the value; a curve must rise. [convention]
const MIN_SLOPE: f64 = 0.02;

/// Number of steps at which a curve is checked and tabulated. [convention]
const STEPS: usize = 1024;

/// What is known about the exposures of two photos, and their levels.
pub struct PairEvidence {
    /// Logarithm of the ratio long / short, and its standard error, which is 0 if the caller gives the ratio.
    pub log_ratio: [f64; 2],
    pub levels: Vec<LevelPair>,
}

/// A tone curve, as a correction of values that were decoded as sRGB.
#[derive(Clone, Debug)]
pub struct RecoveredCurve {
    coefficients: [f64; TERMS],
    /// Range of the encoded values that the photos show. Darker values keep the correction of the first number. The
    /// correction is 0 from the second number on, so that white keeps its value.
    range: [f64; 2],
    /// Largest error of the logarithm of the light within the range, relative to white: the root of the sum of the
    /// squares of the standard error and of the change by the last basis function.
    pub error: f64,
    /// The factor `exp(p)` at even steps of the square root of the value.
    factors: Vec<f32>,
}

/// Returns the basis functions at an encoded value.
fn basis(code: f64) -> [f64; TERMS] {
    let t = 2.0 * code - 1.0;
    let mut chebyshev = [1.0, t, 0.0, 0.0, 0.0, 0.0];
    for k in 2..TERMS {
        chebyshev[k] = 2.0 * t * chebyshev[k - 1] - chebyshev[k - 2];
    }
    chebyshev[0] = maths::ln(f64::from(srgb_to_linear(code as f32)).max(f64::MIN_POSITIVE));
    chebyshev
}

fn difference(a: [f64; TERMS], b: [f64; TERMS]) -> [f64; TERMS] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn code_of(light: f64) -> f64 {
    f64::from(linear_to_srgb(light as f32))
}

/// Returns the curve with which the levels of all pairs agree best; `None` if the photos do not determine one, or if
/// they agree about as well with that of sRGB.
pub fn recover(pairs: &[PairEvidence]) -> Option<RecoveredCurve> {
    let used: Vec<&PairEvidence> =
        pairs.iter().filter(|pair| pair.log_ratio[0] >= MIN_LOG_RATIO && !pair.levels.is_empty()).collect();
    let count = used.iter().map(|pair| pair.levels.len()).sum::<usize>();
    let unknowns = TERMS + used.len();
    if used.is_empty() || count < LEVELS_PER_UNKNOWN * unknowns {
        return None;
    }
    let all = || used.iter().flat_map(|pair| &pair.levels);
    let low = code_of(all().map(|level| level.short).fold(f64::INFINITY, f64::min));
    let high = code_of(all().map(|level| level.long).fold(0.0, f64::max));
    // Ratios that contradict the order of the photos' brightness leave no range.
    if low >= high {
        return None;
    }

    let (curved, plain) = (Fit::new(&used, TERMS)?, Fit::new(&used, 0)?);
    let shorter = Fit::new(&used, TERMS - 1)?;
    let scale = (curved.squares / (count - unknowns) as f64).max(1.0);
    if (plain.squares - curved.squares) / (TERMS as f64 * scale) < MIN_F {
        return None;
    }
    let coefficients: [f64; TERMS] = std::array::from_fn(|k| curved.solution[k]);
    let mut curve = RecoveredCurve { coefficients, range: [low, high], error: 0.0, factors: Vec::new() };
    // The largest change and the largest error of the light, relative to white.
    let mut is_significant = false;
    for step in 0..=STEPS {
        let code = low + (high - low) * step as f64 / STEPS as f64;
        let slopes = difference(basis(code), basis(high));
        let variance: f64 =
            (0..TERMS).map(|i| slopes[i] * (0..TERMS).map(|j| curved.covariance[i][j] * slopes[j]).sum::<f64>()).sum();
        // The last basis function shows how much the basis functions of higher order, which are left out, may change.
        let last = slopes[TERMS - 1] * coefficients[TERMS - 1]
            + (0..TERMS - 1).map(|k| slopes[k] * (coefficients[k] - shorter.solution[k])).sum::<f64>();
        let error = maths::hypot((scale * variance.max(0.0)).sqrt(), last);
        let change = curve.correction(code).abs();
        is_significant |= change > MIN_CHANGE && change > SIGNIFICANT * error;
        curve.error = curve.error.max(error);
    }
    (is_significant && curve.rises()).then(|| curve.tabulated())
}

/// Whether the levels contradict the curve of sRGB, whatever the ratios of the exposures are: another curve fits them
/// significantly better, and the values deviate from a constant ratio by more than `MIN_CHANGE` in the root mean
/// square.
pub fn contradicts_srgb(levels: Vec<Vec<LevelPair>>) -> bool {
    let pairs: Vec<PairEvidence> =
        levels.into_iter().map(|levels| PairEvidence { log_ratio: [0.0, UNKNOWN], levels }).collect();
    let used: Vec<&PairEvidence> = pairs.iter().filter(|pair| !pair.levels.is_empty()).collect();
    let count = used.iter().map(|pair| pair.levels.len()).sum::<usize>();
    let unknowns = TERMS + used.len();
    if used.is_empty() || count < LEVELS_PER_UNKNOWN * unknowns {
        return false;
    }
    let (Some(curved), Some(plain)) = (Fit::new(&used, TERMS), Fit::new(&used, 0)) else { return false };
    let scale = (curved.squares / (count - unknowns) as f64).max(1.0);
    let deviation = |(pair, log): (&&PairEvidence, &f64)| -> f64 {
        pair.levels.iter().map(|level| maths::powi(maths::ln(level.long / level.short) - log, 2)).sum()
    };
    let squares: f64 = used.iter().zip(&plain.solution).map(deviation).sum();
    let is_better = plain.squares - curved.squares > MIN_F * TERMS as f64 * scale;
    is_better && (squares / count as f64).sqrt() > MIN_CHANGE
}

impl RecoveredCurve {
    pub fn report(&self) -> CurveReport {
        let code = |k: usize| srgb_to_linear(k as f32 / (CURVE_VALUES - 1) as f32);
        CurveReport { light: std::array::from_fn(|k| f64::from(self.light(code(k)))), error: self.error }
    }

    /// Returns `p` at an encoded value.
    fn correction(&self, code: f64) -> f64 {
        let slopes = difference(basis(code.clamp(self.range[0], self.range[1])), basis(self.range[1]));
        slopes.iter().zip(self.coefficients).map(|(slope, coefficient)| slope * coefficient).sum()
    }

    /// Whether the light rises with the value, over the whole range.
    fn rises(&self) -> bool {
        let log = |code: f64| maths::ln(f64::from(srgb_to_linear(code as f32)));
        let at = |step: usize| self.range[0] + (self.range[1] - self.range[0]) * step as f64 / STEPS as f64;
        (0..STEPS).all(|step| {
            let (a, b) = (at(step), at(step + 1));
            let change = self.correction(b) - self.correction(a);
            change.is_finite() && 1.0 + change / (log(b) - log(a)) > MIN_SLOPE
        })
    }

    fn tabulated(self) -> Self {
        let factor = |step: usize| {
            let light = maths::powi(step as f64 / STEPS as f64, 2);
            maths::exp(self.correction(code_of(light))) as f32
        };
        Self { factors: (0..=STEPS).map(factor).collect(), ..self }
    }

    /// Returns the light of a value.
    #[inline]
    pub fn light(&self, value: f32) -> f32 {
        let at = value.clamp(0.0, 1.0).sqrt() * STEPS as f32;
        let step = (at as usize).min(STEPS - 1);
        let [a, b] = [self.factors[step], self.factors[step + 1]];
        value * (a + (b - a) * (at - step as f32))
    }
}

/// A least squares fit of the levels, with the first basis functions or, with none, the curve of sRGB.
struct Fit {
    /// The coefficients of the curve, if it has one, then the logarithms of the ratios.
    solution: Vec<f64>,
    covariance: Vec<Vec<f64>>,
    /// Sum of the squared residuals, in units of their variances. Those of the priors of the ratios are included.
    squares: f64,
}

impl Fit {
    fn new(pairs: &[&PairEvidence], terms: usize) -> Option<Self> {
        let size = terms + pairs.len();
        let mut rows: Vec<(Vec<f64>, f64)> = Vec::new();
        for (j, pair) in pairs.iter().enumerate() {
            for level in &pair.levels {
                let weight = level.variance.sqrt().recip();
                let mut row = vec![0.0; size];
                let slopes = difference(basis(code_of(level.long)), basis(code_of(level.short)));
                row[..terms].copy_from_slice(&slopes[..terms]);
                row[terms + j] = -1.0;
                row.iter_mut().for_each(|v| *v *= weight);
                rows.push((row, maths::ln(level.short / level.long) * weight));
            }
            let [log, error] = pair.log_ratio;
            let mut row = vec![0.0; size];
            row[terms + j] = 1.0 / error.max(GIVEN);
            rows.push((row, log / error.max(GIVEN)));
        }
        let mut normal = vec![vec![0.0; size]; size];
        let mut right = vec![0.0; size];
        (0..terms).for_each(|k| normal[k][k] = PRIOR.recip() * PRIOR.recip());
        for (row, value) in &rows {
            for i in 0..size {
                right[i] += row[i] * value;
                (0..size).for_each(|j| normal[i][j] += row[i] * row[j]);
            }
        }
        let covariance = inverse(normal)?;
        let solution: Vec<f64> =
            covariance.iter().map(|row| row.iter().zip(&right).map(|(a, b)| a * b).sum()).collect();
        let residual = |(row, value): &(Vec<f64>, f64)| {
            let fitted: f64 = row.iter().zip(&solution).map(|(a, x)| a * x).sum();
            maths::powi(fitted - value, 2)
        };
        let squares: f64 = rows.iter().map(residual).sum();
        squares.is_finite().then_some(Self { solution, covariance, squares })
    }
}

/// Returns the inverse of a symmetric positive definite matrix by Gauss-Jordan elimination, after scaling its diagonal
/// to 1; `None` if it is singular.
fn inverse(mut matrix: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let size = matrix.len();
    let scales: Vec<f64> = (0..size).map(|i| matrix[i][i].sqrt().recip()).collect();
    for i in 0..size {
        (0..size).for_each(|j| matrix[i][j] *= scales[i] * scales[j]);
    }
    let mut result: Vec<Vec<f64>> =
        (0..size).map(|i| (0..size).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    for k in 0..size {
        let pivot = matrix[k][k];
        if !(pivot > f64::EPSILON) {
            return None;
        }
        for row in [&mut matrix, &mut result] {
            row[k].iter_mut().for_each(|v| *v /= pivot);
        }
        for i in (0..size).filter(|&i| i != k) {
            let factor = matrix[i][k];
            for row in [&mut matrix, &mut result] {
                let pivot_row = row[k].clone();
                row[i].iter_mut().zip(&pivot_row).for_each(|(v, p)| *v -= factor * p);
            }
        }
    }
    for i in 0..size {
        (0..size).for_each(|j| result[i][j] *= scales[i] * scales[j]);
    }
    Some(result)
}
