//! Precision of logistic regression with quadratic terms by Newton's method, on two classes that are nearly separable.

use super::real::Real;
use super::{Study, Way, timed};
use luxfer::rng::Rng;

const SAMPLES: usize = 2000;
/// Number of terms: five channels, their squares and products, and the constant.
const TERMS: usize = 21;
const RIDGE: f64 = 1e-6;
const STEPS: usize = 12;

type Row<R> = [R; TERMS];

/// Fits the classifier by Newton's method; returns the probabilities of the samples.
fn fit<R: Real>(rows: &[Row<R>], positive: &[bool]) -> Vec<R> {
    let one = R::of(1.0);
    let probability = |w: &Row<R>, row: &Row<R>| one / (one + (-dot(w, row)).exp());
    let scale = R::of(1.0 / rows.len() as f64);
    let mut w = [R::ZERO; TERMS];
    for _ in 0..STEPS {
        let mut gradient = w.map(|w| w * R::of(RIDGE));
        let mut hessian = [[R::ZERO; TERMS]; TERMS];
        for (row, &positive) in rows.iter().zip(positive) {
            let p = probability(&w, row);
            let slope = scale * if positive { p - one } else { p };
            let curvature = scale * p * (one - p);
            for i in 0..TERMS {
                gradient[i] += slope * row[i];
                let curved = curvature * row[i];
                (0..=i).for_each(|j| hessian[i][j] += curved * row[j]);
            }
        }
        (0..TERMS).for_each(|i| hessian[i][i] += R::of(RIDGE));
        let Some(step) = solve(hessian, gradient) else { break };
        (0..TERMS).for_each(|i| w[i] -= step[i]);
    }
    rows.iter().map(|row| probability(&w, row)).collect()
}

fn dot<R: Real>(a: &Row<R>, b: &Row<R>) -> R {
    a.iter().zip(b).map(|(&a, &b)| a * b).sum()
}

/// Solves the linear system by Cholesky decomposition; `None` if rounding has made the matrix indefinite.
fn solve<R: Real>(mut a: [Row<R>; TERMS], mut b: Row<R>) -> Option<Row<R>> {
    for i in 0..TERMS {
        for j in 0..=i {
            let sum: R = (0..j).map(|k| a[i][k] * a[j][k]).sum();
            let left = a[i][j] - sum;
            a[i][j] = if i != j {
                left / a[j][j]
            } else if left > R::ZERO {
                left.sqrt()
            } else {
                return None;
            };
        }
        let sum: R = (0..i).map(|k| a[i][k] * b[k]).sum();
        b[i] = (b[i] - sum) / a[i][i];
    }
    for i in (0..TERMS).rev() {
        let sum: R = (i + 1..TERMS).map(|k| a[k][i] * b[k]).sum();
        b[i] = (b[i] - sum) / a[i][i];
    }
    Some(b)
}

pub fn measure(study: &mut Study) {
    let mut rng = Rng::new(4, &[]);
    let (mut rows, mut positive) = (Vec::new(), Vec::new());
    for k in 0..SAMPLES {
        let is_positive = k % 2 == 0;
        // Make channels that are nearly linearly dependent, as colour and depth are on one wall.
        let shared = rng.normal() + if is_positive { 1.5 } else { -1.5 };
        let x: [f64; 5] = std::array::from_fn(|i| shared + 0.02 * (i as f64 + 1.0) * rng.normal());
        let mut row: Row<f64> = [1.0; TERMS];
        let pairs = (0..5).flat_map(|i| (i..5).map(move |j| (i, j)));
        row[..5].copy_from_slice(&x);
        row[5..20].iter_mut().zip(pairs).for_each(|(term, (i, j))| *term = x[i] * x[j]);
        rows.push(row);
        positive.push(is_positive);
    }
    let narrow: Vec<Row<f32>> = rows.iter().map(|row| row.map(|v| v as f32)).collect();
    let (found, truth) = (fit(&narrow, &positive), fit(&rows, &positive));
    let error =
        found.iter().zip(&truth).map(|(&f, t)| (f64::from(f) - t).abs()).fold(0.0, |a, e| if e <= a { a } else { e });
    study.add(
        "segmentation: learning on channels that nearly repeat each other",
        "of a probability, the largest",
        1,
        &mut [
            Way { name: "f32", bytes: 4 * TERMS, error, work: &mut timed(|| fit(&narrow, &positive)) },
            Way { name: "f64", bytes: 8 * TERMS, error: 0.0, work: &mut timed(|| fit(&rows, &positive)) },
        ],
    );
}
