//! Logistic regression with a ridge penalty, by Newton's method (iteratively reweighted least squares), in `f64`.

use super::exponential::{exp_f64, ln};
use super::table::{BLOCK, Lanes, Table, combine, dot_lanes};
use crate::error::Result;
use crate::job::Job;
use crate::simd::widest;

/// Weighted samples for logistic regression. Each sample is a row of terms; the last term is the constant 1.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    pub terms: &'a Table,
    pub positive: &'a [bool],
    /// Weight of each sample; 0 leaves a sample out.
    pub weights: &'a [f64],
}

/// The objective of a fit and its first and second derivatives, for given weights of the terms.
pub struct Objective {
    pub value: f64,
    pub gradient: Vec<f64>,
    /// The Hessian matrix, row by row; only its lower triangle is filled.
    pub hessian: Vec<f64>,
}

/// Finds the weights `w` that minimise the objective: the mean log loss plus `ridge / 2 |w|²`. The weight of the
/// constant term is hardly penalised. The ridge makes the solution finite and unique even if the classes are separable,
/// or if terms are duplicated or constant.
///
/// Newton's method starts at `start`. It ends with the first step whose expected decrease of the objective is below
/// `precision`, or after 30 steps. It ends early if the Hessian is not positive definite, or if no shortened step
/// lowers the objective.
pub fn fit(problem: &Problem, ridge: f64, start: &[f64], precision: f64, job: Job) -> Result<Vec<f64>> {
    let mut w = start.to_vec();
    let mut here = Objective::at(problem, ridge, &w);
    for _ in 0..30 {
        job.check()?;
        let Some(step) = cholesky_solve(&mut here.hessian, &here.gradient) else { break };
        // A Newton step is expected to decrease the objective by half of gradient · step. This is exact for a parabola,
        // which the objective resembles near its minimum.
        let expected = 0.5 * dot(&here.gradient, &step);
        let moved = |length: f64| -> Vec<f64> { w.iter().zip(&step).map(|(w, s)| w - length * s).collect() };
        if expected < precision {
            w = moved(1.0);
            break;
        }

        // Take a Newton step. While the step would raise the objective, halve its length; give up below 1e-6 of the
        // full length.
        let mut length = 1.0;
        let (next, there) = loop {
            let next = moved(length);
            let there = Objective::at(problem, ridge, &next);
            if there.value <= here.value || length < 1e-6 {
                break (next, there);
            }
            length *= 0.5;
        };
        if !(there.value < here.value) {
            break;
        }
        (w, here) = (next, there);
    }
    Ok(w)
}

impl Objective {
    pub fn at(problem: &Problem, ridge: f64, w: &[f64]) -> Self {
        let d = w.len();
        let mut at = Self { value: 0.0, gradient: vec![0.0; d], hessian: vec![0.0; d * d] };
        add_log_loss(problem, w, &mut at);
        for i in 0..d {
            // The constant term gets a tiny ridge too: its best weight would be infinite if all weighted samples had
            // one class.
            let r = if i + 1 == d { 1e-6 * ridge } else { ridge };
            at.value += 0.5 * r * w[i] * w[i];
            at.gradient[i] += r * w[i];
            at.hessian[i * d + i] += r;
        }
        at
    }
}

widest! {
    /// Adds the weighted mean log loss and its derivatives to the objective.
    fn add_log_loss(problem: &Problem, w: &[f64], to: &mut Objective) {
        let d = w.len();
        let scale = 1.0 / problem.weights.iter().sum::<f64>();
        for (rows, block) in problem.terms.blocks() {
            let (mut weight, mut target) = ([0.0; BLOCK], [0.0; BLOCK]);
            for (k, row) in rows.enumerate() {
                weight[k] = scale * problem.weights[row];
                target[k] = f64::from(problem.positive[row]);
            }
            let z = combine(w, block);
            let (mut loss, mut slope, mut curvature) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
            for k in 0..BLOCK {
                let e = exp_f64(-z[k].abs());
                let larger = 1.0 / (1.0 + e);
                let p = if z[k] > 0.0 { larger } else { e * larger };
                loss[k] = ln(1.0 + e) + z[k].max(0.0) - target[k] * z[k];
                slope[k] = weight[k] * (p - target[k]);
                curvature[k] = weight[k] * (e * larger * larger).max(1e-12);
            }
            to.value += dot_lanes(&weight, &loss);
            for (i, x) in block.iter().enumerate() {
                to.gradient[i] += dot_lanes(&slope, x);
                let mut curved = [0.0; BLOCK];
                for k in 0..BLOCK {
                    curved[k] = curvature[k] * x[k];
                }
                for (h, y) in to.hessian[i * d..=i * d + i].iter_mut().zip(block) {
                    *h += dot_lanes(&curved, y);
                }
            }
        }
    }
}

/// Computes the logits of the rows whose index `wanted` accepts. Each result is a pair: the row's index and its logit.
pub fn logits(terms: &Table, w: &[f64], wanted: impl Fn(usize) -> bool) -> Vec<(usize, f64)> {
    let mut out = Vec::new();
    for (rows, block) in terms.blocks().filter(|(rows, _)| rows.clone().any(&wanted)) {
        let z = logits_of(w, block);
        out.extend(rows.zip(z).filter(|(row, _)| wanted(*row)));
    }
    out
}

widest! {
    fn logits_of(w: &[f64], block: &[Lanes]) -> Lanes {
        combine(w, block)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Solves `A x = b` by Cholesky decomposition. `a` holds the symmetric matrix `A` row by row; only its lower triangle
/// is read, and `a` is overwritten. `None` if `A` is not positive definite.
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

    /// If the constant is the only term, its weight must be the logit of the share of positive samples.
    #[test]
    fn the_constant_model_is_the_logit_of_the_share() {
        let positive: Vec<bool> = (0..100).map(|i| i % 4 == 0).collect();
        let terms = Table::of(&[1.0; 100], 1).unwrap();
        let problem = Problem { terms: &terms, positive: &positive, weights: &[1.0; 100] };
        let w = fit(&problem, 1e-6, &[0.0], 1e-9, Monitor::default().job()).unwrap();
        assert!((w[0] - (1.0f64 / 3.0).ln()).abs() < 1e-5, "{w:?}");
    }

    #[test]
    fn the_derivatives_are_those_of_the_value() {
        let mut rng = Rng::new(2, &[]);
        let rows: Vec<f64> = (0..3 * 50).map(|i| if i % 3 == 2 { 1.0 } else { 3.0 * rng.normal() }).collect();
        let positive: Vec<bool> = (0..50).map(|i| i % 3 == 0).collect();
        let weights: Vec<f64> = (0..50).map(|i| f64::from(i % 5)).collect();
        let terms = Table::of(&rows, 3).unwrap();
        let problem = Problem { terms: &terms, positive: &positive, weights: &weights };
        let w = [0.4, -1.1, 0.2];
        let here = Objective::at(&problem, 0.1, &w);
        let step = 1e-5;
        for i in 0..3 {
            let [below, above] = [-step, step].map(|s| {
                let mut w = w;
                w[i] += s;
                Objective::at(&problem, 0.1, &w)
            });
            assert!((here.gradient[i] - (above.value - below.value) / (2.0 * step)).abs() < 1e-8);
            for j in 0..=i {
                let second = (above.gradient[j] - below.gradient[j]) / (2.0 * step);
                assert!((here.hessian[i * 3 + j] - second).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn known_weights_are_recovered_from_many_draws() {
        let truth = [1.5, -0.7, 0.4];
        let mut rng = Rng::new(1, &[]);
        let (mut rows, mut positive) = (Vec::new(), Vec::new());
        for _ in 0..20_000 {
            let x = [rng.normal(), rng.normal(), 1.0];
            positive.push(rng.next_f64() < 1.0 / (1.0 + (-dot(&truth, &x)).exp()));
            rows.extend(x);
        }
        let terms = Table::of(&rows, 3).unwrap();
        let problem = Problem { terms: &terms, positive: &positive, weights: &vec![1.0; 20_000] };
        let w = fit(&problem, 1e-9, &[0.0; 3], 1e-9, Monitor::default().job()).unwrap();
        // The standard errors of the weights are about 0.02 to 0.03; the bound allows about five of them.
        assert!(w.iter().zip(&truth).all(|(w, t)| (w - t).abs() < 0.13), "{w:?}");
        assert_eq!(logits(&terms, &w, |row| row == 777)[0].0, 777);
        assert!((logits(&terms, &w, |row| row == 777)[0].1 - dot(&w, &rows[3 * 777..3 * 778])).abs() < 1e-12);
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
        let terms = Table::of(&rows, 4).unwrap();
        let problem = Problem { terms: &terms, positive: &positive, weights: &[1.0; 40] };
        let w = fit(&problem, 1e-3, &[0.0; 4], 1e-9, Monitor::default().job()).unwrap();
        assert!(w.iter().all(|v| v.is_finite()));
        assert!((w[0] - w[1]).abs() < 1e-9 && w[0] > 0.0 && w[2] == 0.0 && w[3].abs() < 1e-6, "{w:?}");
    }
}
