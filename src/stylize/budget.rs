//! The error budget (StyLit, §3.3, Eq. 4): selects the matches that are good enough to be used.
//!
//! The sorted matching errors follow a hyperbola `f(x) = 1 / (a - b x)` when both axes are scaled to `[0, 1]`. (Errors
//! are scaled by their 99th percentile: the largest of a million errors is an outlier that would move the knee.) The
//! knee k, where `f′(k) = 1`, separates feasible matches from matches that force a patch into an unsuitable position.
//! Since `f′ = b f²`, the knee satisfies `a - b k = √b`, so `k = a/b - √(1/b)`. The paper prints a plus sign, which
//! puts the knee beyond the pole at `a/b`.
//!
//! If no hyperbola fits, the knee is the point farthest below the diagonal. An example is a curve with a step, which
//! arises if most exemplar patches have no suitable place (Fig. 7). A curve that never runs below the diagonal has no
//! knee: all of its errors are feasible.

use crate::maths;

/// Minimum number of errors to which a curve is fitted.
const MIN_ERRORS: usize = 8;
/// Maximum number of points of the sorted curve to which a hyperbola is fitted.
const SAMPLES: usize = 256;

/// Minimum share of the variance of the sorted errors that a hyperbola must explain. [bench constants:paint]
const MIN_EXPLAINED: f64 = 0.8;
/// A curve has a knee only if it runs farther than this below the diagonal. [bench constants:paint]
const MIN_SAG: f64 = 0.01;

/// The hyperbola `1 / (a - b x)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hyperbola {
    pub a: f64,
    pub b: f64,
}

impl Hyperbola {
    /// Returns the x of the knee; `None` unless the knee lies between 0 and 1, and the pole `a/b` beyond 1.
    pub fn knee(self) -> Option<f64> {
        let pole = self.a / self.b;
        let knee = pole - (1.0 / self.b).sqrt();
        (self.b > 0.0 && pole > 1.0 && knee > 0.0 && knee < 1.0).then_some(knee)
    }

    /// Returns the share of the variance of `points` that the hyperbola explains.
    fn explained(self, points: &[(f64, f64)]) -> f64 {
        let mean = points.iter().map(|p| p.1).sum::<f64>() / points.len() as f64;
        let variance: f64 = points.iter().map(|p| maths::powi(p.1 - mean, 2)).sum();
        let rest: f64 = points.iter().map(|p| maths::powi(p.1 - 1.0 / (self.a - self.b * p.0), 2)).sum();
        1.0 - rest / variance
    }

    /// Fits points `(x, y)` in the unit square, sorted by `x`.
    ///
    /// The equation `1/y = a - b x` is linear in `a` and `b`. With weights `y⁴`, its squared residuals equal the
    /// squared residuals of `y` to first order. Three Gauss-Newton steps on the residuals of `y` follow. Returns `None`
    /// if the points do not determine both `a` and `b`.
    pub fn fit(points: &[(f64, f64)]) -> Option<Self> {
        let points = || points.iter().filter(|p| p.1 > 0.0);
        let mut fit = solve(points().map(|&(x, y)| ([y * y, -x * y * y], y)))?;
        for _ in 0..3 {
            // The derivatives are df/da = -f² and df/db = x f².
            let step = solve(points().map(|&(x, y)| {
                let f = 1.0 / (fit.a - fit.b * x);
                ([-f * f, x * f * f], y - f)
            }));
            match step {
                Some(d) if (fit.a + d.a - fit.b - d.b) > 0.0 && fit.a + d.a > 0.0 => {
                    fit = Self { a: fit.a + d.a, b: fit.b + d.b };
                }
                _ => break,
            }
        }
        (fit.a.is_finite() && fit.b.is_finite()).then_some(fit)
    }
}

/// Solves a linear least-squares problem of two unknowns, given rows of coefficients and right-hand sides.
fn solve(rows: impl Iterator<Item = ([f64; 2], f64)>) -> Option<Hyperbola> {
    let (mut m, mut r) = ([0.0; 3], [0.0; 2]);
    for ([p, q], v) in rows {
        m[0] += p * p;
        m[1] += p * q;
        m[2] += q * q;
        r[0] += p * v;
        r[1] += q * v;
    }
    let det = m[0] * m[2] - m[1] * m[1];
    (det > 1e-12 * m[0] * m[2])
        .then(|| Hyperbola { a: (m[2] * r[0] - m[1] * r[1]) / det, b: (m[0] * r[1] - m[1] * r[0]) / det })
}

/// The error budget of a set of matches: the share of feasible matches, and the sum of their errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Share of the matches left of the knee; 1 if there is no knee, so that all matches are feasible.
    pub knee: f64,
    /// Sum of the errors left of the knee, T in Eq. 4 of StyLit; infinite if there is no knee.
    pub total: f64,
}

/// Computes the budget of `errors`, which are in ascending order. If there are few errors, if they are nearly all
/// equal, or if their curve has no knee, all are feasible.
pub fn budget(errors: &[u32]) -> Budget {
    let sum = |errors: &[u32]| errors.iter().map(|&e| f64::from(e)).sum();
    let all = || Budget { knee: 1.0, total: f64::INFINITY };
    // Scale by the 99th percentile; the errors above it are outliers.
    let n = errors.len();
    let worst = if n > 0 { errors[(n - 1) * 99 / 100] } else { 0 };
    if n < MIN_ERRORS || worst == 0 || errors[0] == worst {
        return all();
    }
    let samples = SAMPLES.min(n);
    let points: Vec<(f64, f64)> = (0..samples)
        .map(|s| {
            let i = (2 * s + 1) * (n * 99 / 100) / (2 * samples);
            ((i as f64 + 0.5) / n as f64, f64::from(errors[i]) / f64::from(worst))
        })
        .collect();
    // A curve that never runs below the diagonal has no knee: the knee of a hyperbola through (1, 1) lies below the
    // diagonal, by the square of `1 - √(1/b)`.
    let knee = farthest_below_diagonal(&points).map(|farthest| {
        let hyperbola = Hyperbola::fit(&points).filter(|f| f.explained(&points) >= MIN_EXPLAINED);
        hyperbola.and_then(Hyperbola::knee).unwrap_or(farthest)
    });
    match knee {
        Some(knee) => Budget { knee, total: sum(&errors[..(knee * n as f64).ceil() as usize]) },
        None => all(),
    }
}

fn farthest_below_diagonal(points: &[(f64, f64)]) -> Option<f64> {
    let farthest = points.iter().max_by(|p, q| (p.0 - p.1).total_cmp(&(q.0 - q.1)))?;
    (farthest.0 - farthest.1 > MIN_SAG).then_some(farthest.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(n: usize, f: impl Fn(f64) -> f64) -> Vec<u32> {
        (0..n).map(|i| (f((i as f64 + 0.5) / n as f64) * 1e9) as u32).collect()
    }

    #[test]
    fn a_hyperbola_is_recovered_and_its_knee_has_slope_one() {
        for (a, b) in [(21.0, 20.0), (3.0, 2.0), (101.0, 100.0)] {
            let points: Vec<_> = (0..200).map(|i| i as f64 / 200.0).map(|x| (x, 1.0 / (a - b * x))).collect();
            let fit = Hyperbola::fit(&points).unwrap();
            assert!((fit.a - a).abs() < 1e-6 * a && (fit.b - b).abs() < 1e-6 * b, "{fit:?}");
            if let Some(k) = fit.knee() {
                let f = |x: f64| 1.0 / (a - b * x);
                assert!(((f(k + 1e-6) - f(k - 1e-6)) / 2e-6 - 1.0).abs() < 1e-4);
            }
        }
        assert!((Hyperbola { a: 21.0, b: 20.0 }.knee().unwrap() - 0.826_393_2).abs() < 1e-6);
    }

    #[test]
    fn the_budget_is_the_sum_left_of_the_knee() {
        let errors = curve(10_000, |x| 1.0 / (21.0 - 20.0 * x));
        let budget = budget(&errors);
        // Scaled by its 99th percentile, 1 / 1.2, the hyperbola has a = 17.5 and b = 16.67.
        assert!((budget.knee - (1.05 - (0.06f64).sqrt())).abs() < 0.002, "{budget:?}");
        let accepted = errors.iter().scan(0.0, |sum, &e| {
            *sum += f64::from(e);
            Some(*sum)
        });
        let count = accepted.take_while(|&s| s <= budget.total).count();
        assert!((count as f64 - budget.knee * 1e4).abs() < 2.0);
    }

    #[test]
    fn curves_without_a_knee_are_accepted_whole() {
        for errors in [vec![], vec![5], vec![1, 2, 3, 4, 5, 6, 900], vec![0; 100], vec![7; 100]] {
            assert_eq!(budget(&errors).total, f64::INFINITY, "{errors:?}");
        }
        // The first curve is concave: its slope falls. The second is flat with one outlier: no hyperbola fits it, and
        // the budget must not fail.
        assert_eq!(budget(&curve(1000, |x| x.sqrt())).knee, 1.0);
        let mut outlier = vec![10u32; 1000];
        outlier[999] = u32::MAX - 1;
        let b = budget(&outlier);
        assert!(b.knee > 0.0 && b.knee <= 1.0 && b.total >= 0.0);
        // A step: a fifth of the matches is feasible, and the others are forced into unsuitable positions (Fig. 7).
        let step = curve(1000, |x| if x < 0.2 { 0.01 } else { 0.9 + 0.1 * x });
        assert!((super::budget(&step).knee - 0.2).abs() < 0.01);
        // In the last curve, most errors are zero.
        let mut zeros = vec![0u32; 1000];
        zeros[990..].iter_mut().enumerate().for_each(|(i, e)| *e = 1 + i as u32);
        assert!(budget(&zeros).knee > 0.9);
    }
}
