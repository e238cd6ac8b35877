//! Logistic regression with a ridge, by Newton's method (iteratively reweighted least squares), in `f64`.

use crate::error::Result;
use crate::job::Job;
use crate::simd::widest;

/// Weighted examples: rows of `dimension` terms of which the last is the constant.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    pub rows: &'a [f64],
    pub dimension: usize,
    pub positive: &'a [bool],
    /// 0 leaves an example out.
    pub weights: &'a [f64],
}

/// The weights that minimise the mean log loss plus `ridge / 2 |w|²`, the constant term being free. The ridge makes
/// the solution finite and unique even for separable, duplicated or constant terms. Starts at `start`, and ends when a step
/// gains less than `precision`.
pub fn fit(problem: &Problem, ridge: f64, start: &[f64], precision: f64, job: Job) -> Result<Vec<f64>> {
    let d = problem.dimension;
    let total: f64 = problem.weights.iter().sum();
    let mut w = start.to_vec();
    let mut value = objective(problem, ridge, total, &w);
    for _ in 0..30 {
        job.check()?;

        // Gradient and Hessian (lower triangle).
        let mut gradient = vec![0.0; d];
        let mut hessian = vec![0.0; d * d];
        derivatives(problem, total, &w, &mut gradient, &mut hessian);
        for i in 0..d {
            // The constant has a trace of a ridge too: one class could be all the weight there is.
            let r = if i + 1 == d { 1e-6 * ridge } else { ridge };
            gradient[i] += r * w[i];
            hessian[i * d + i] += r;
        }

        // A Newton step, halved until the objective falls.
        let Some(step) = cholesky_solve(&mut hessian, &gradient) else { break };
        let mut length = 1.0;
        let (next, next_value) = loop {
            let next: Vec<f64> = w.iter().zip(&step).map(|(w, s)| w - length * s).collect();
            let v = objective(problem, ridge, total, &next);
            if v <= value || length < 1e-6 {
                break (next, v);
            }
            length *= 0.5;
        };
        let gain = value - next_value;
        if gain <= 0.0 {
            break;
        }
        (w, value) = (next, next_value);
        if gain < precision {
            break;
        }
    }
    Ok(w)
}

widest! {
    /// Adds the gradient and the lower triangle of the Hessian of the mean log loss.
    fn derivatives(problem: &Problem, total: f64, w: &[f64], gradient: &mut [f64], hessian: &mut [f64]) {
        let d = problem.dimension;
        for ((x, &positive), &weight) in problem.rows.chunks_exact(d).zip(problem.positive).zip(problem.weights) {
            if weight == 0.0 {
                continue;
            }
            let p = sigmoid(dot(w, x));
            let slope = weight / total * (p - f64::from(positive));
            let curvature = weight / total * (p * (1.0 - p)).max(1e-12);
            for i in 0..d {
                gradient[i] += slope * x[i];
                let c = curvature * x[i];
                for (h, v) in hessian[i * d..=i * d + i].iter_mut().zip(x) {
                    *h += c * v;
                }
            }
        }
    }
}

fn objective(problem: &Problem, ridge: f64, total: f64, w: &[f64]) -> f64 {
    let d = problem.dimension;
    let examples = problem.rows.chunks_exact(d).zip(problem.positive).zip(problem.weights);
    let loss: f64 =
        examples.filter(|(_, weight)| **weight > 0.0).map(|((x, &p), weight)| weight * log_loss(dot(w, x), p)).sum();
    let penalty: f64 = w[..d - 1].iter().map(|v| v * v).sum::<f64>() + 1e-6 * w[d - 1] * w[d - 1];
    loss / total + 0.5 * ridge * penalty
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub fn sigmoid(z: f64) -> f64 {
    1.0 / (1.0 + (-z).exp())
}

/// `-ln` of the probability that a logit gives to the truth.
pub fn log_loss(logit: f64, positive: bool) -> f64 {
    let z = if positive { -logit } else { logit };
    if z > 30.0 { z } else { z.exp().ln_1p() }
}

/// Solves `A x = b` for a symmetric positive definite `A` whose lower triangle is given; it is overwritten.
pub fn cholesky_solve(a: &mut [f64], b: &[f64]) -> Option<Vec<f64>> {
    let n = b.len();
    for j in 0..n {
        for i in j..n {
            let sum = dot(&a[i * n..i * n + j], &a[j * n..j * n + j]);
            let v = a[i * n + j] - sum;
            if i == j {
                if v.is_nan() || v <= 0.0 {
                    return None;
                }
                a[j * n + j] = v.sqrt();
            } else {
                a[i * n + j] = v / a[j * n + j];
            }
        }
    }
    let mut x = b.to_vec();
    for i in 0..n {
        x[i] = (x[i] - dot(&a[i * n..i * n + i], &x[..i])) / a[i * n + i];
    }
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|k| a[k * n + i] * x[k]).sum();
        x[i] = (x[i] - sum) / a[i * n + i];
    }
    x.iter().all(|v| v.is_finite()).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;
    use crate::rng::Rng;

    /// A constant alone: the weight is the logit of the share of positives.
    #[test]
    fn the_constant_model_is_the_logit_of_the_share() {
        let positive: Vec<bool> = (0..100).map(|i| i % 4 == 0).collect();
        let problem = Problem { rows: &[1.0; 100], dimension: 1, positive: &positive, weights: &[1.0; 100] };
        let w = fit(&problem, 1e-6, &[0.0], 1e-9, Monitor::default().job()).unwrap();
        assert!((w[0] - (1.0f64 / 3.0).ln()).abs() < 1e-5, "{w:?}");
    }

    #[test]
    fn known_weights_are_recovered_from_many_draws() {
        let truth = [1.5, -0.7, 0.4];
        let mut rng = Rng::new(1, &[]);
        let (mut rows, mut positive) = (Vec::new(), Vec::new());
        for _ in 0..20_000 {
            let x = [rng.normal(), rng.normal(), 1.0];
            positive.push(rng.next_f64() < sigmoid(dot(&truth, &x)));
            rows.extend(x);
        }
        let problem = Problem { rows: &rows, dimension: 3, positive: &positive, weights: &vec![1.0; 20_000] };
        let w = fit(&problem, 1e-9, &[0.0; 3], 1e-9, Monitor::default().job()).unwrap();
        // Standard errors are about 0.02 to 0.03: five of them.
        assert!(w.iter().zip(&truth).all(|(w, t)| (w - t).abs() < 0.13), "{w:?}");
    }

    #[test]
    fn separable_duplicated_and_constant_terms_stay_finite_and_symmetric() {
        let rows: Vec<f64> = (0..40)
            .flat_map(|i| {
                let x = f64::from(i) - 19.5;
                [x, x, 0.0, 1.0]
            })
            .collect();
        let positive: Vec<bool> = (0..40).map(|i| i >= 20).collect();
        let problem = Problem { rows: &rows, dimension: 4, positive: &positive, weights: &[1.0; 40] };
        let w = fit(&problem, 1e-3, &[0.0; 4], 1e-9, Monitor::default().job()).unwrap();
        assert!(w.iter().all(|v| v.is_finite()));
        assert!((w[0] - w[1]).abs() < 1e-9 && w[0] > 0.0 && w[2] == 0.0 && w[3].abs() < 1e-6, "{w:?}");
    }
}
