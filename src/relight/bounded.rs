//! Bounded least squares for few equations and any number of unknowns.
//!
//! Minimises `½ |A x − b|² + ½ λ |x − p|²` over `0 ≤ x ≤ u`. The Tikhonov term, `λ > 0`, makes the solution unique
//! even for identical columns.
//!
//! The dual problem has only one unknown per row of `A`, the vector `z`. A solution satisfies
//! `x = clip(p + Aᵀ z, 0, u)` and `λ z = b − A x`. Inserting the first condition into the second gives an equation for
//! `z` alone. It says that the gradient of the dual function is zero: `g(z) = λ z + A clip(p + Aᵀ z, 0, u) − b = 0`.
//! The dual function is convex and piecewise quadratic.
//!
//! Newton's method with an exact line search minimises the dual function in a few steps. Each step treats the unknowns
//! that are at their bounds as fixed (the primal-dual active set method of Hintermüller, Ito and Kunisch 2002).

use super::line_search::Slope;
use crate::error::{Error, ErrorKind, Result};

pub(super) struct BoundedLeastSquares<'a> {
    /// The matrix `A`, row by row.
    pub matrix: &'a [f64],
    pub right: &'a [f64],
    /// Weight `λ` of the Tikhonov term, positive.
    pub regularisation: f64,
    /// Preferred values `p` of the unknowns.
    pub preferred: &'a [f64],
    /// Upper bounds `u` of the unknowns, non-negative; may be infinite.
    pub upper: &'a [f64],
}

/// Maximum number of Newton steps; all but the last few change the set of unknowns at their bounds. [convention]
const MAX_STEPS: usize = 200;
/// A gradient counts as zero if its relative norm is at most this. The norm is relative to the largest entry of the
/// right-hand side, or to the norm of the first gradient if that is larger. [rounding]
const CONVERGED: f64 = 1e-12;
/// After `MAX_STEPS` steps, a gradient of this relative norm is still accepted, because rounding may change the state
/// of an unknown at its bound in every step. [rounding]
const CONVERGED_AT_BOUND: f64 = 1e-8;

/// The state of an unknown.
#[derive(Clone, Copy, PartialEq)]
enum BoundStatus {
    AtLower,
    Free,
    AtUpper,
}

impl BoundedLeastSquares<'_> {
    /// Returns the solution `x`.
    ///
    /// # Errors
    /// `Internal` if the method does not converge, which cannot happen in theory.
    pub fn solve(&self) -> Result<Vec<f64>> {
        let (m, lambda) = (self.right.len(), self.regularisation);
        let size = self.right.iter().map(|b| b.abs()).fold(0.0, f64::max);
        let mut z = vec![0.0; m];
        let mut gradient = self.gradient(lambda, &z);
        let scale = size.max(norm(&gradient));
        for _ in 0..MAX_STEPS {
            if norm(&gradient) <= CONVERGED * scale {
                return Ok(self.clipped(&z));
            }
            let states = self.states(&z);
            let step = self.newton_step(lambda, &states, &gradient);
            let t = self.line_search(lambda, &z, &step, &gradient);
            z.iter_mut().zip(&step).for_each(|(z, d)| *z += t * d);
            // If the active set did not change, the dual function is quadratic along the step. The full step then ends
            // at the minimum.
            if t > 1.0 - CONVERGED && self.states(&z) == states {
                return Ok(self.clipped(&z));
            }
            gradient = self.gradient(lambda, &z);
        }
        // Accept a small gradient: rounding may change the state of an unknown at its bound in every step.
        if norm(&gradient) <= CONVERGED_AT_BOUND * scale {
            return Ok(self.clipped(&z));
        }
        Err(Error::new(ErrorKind::Internal, "the powers of the groups did not settle"))
    }

    /// Returns the state of each unknown at the dual point `z`.
    fn states(&self, z: &[f64]) -> Vec<BoundStatus> {
        let state = |(x, u): (f64, &f64)| match x {
            x if x <= 0.0 => BoundStatus::AtLower,
            x if x >= *u => BoundStatus::AtUpper,
            _ => BoundStatus::Free,
        };
        self.unclipped(z).into_iter().zip(self.upper).map(state).collect()
    }

    fn row(&self, i: usize) -> &[f64] {
        let n = self.preferred.len();
        &self.matrix[i * n..(i + 1) * n]
    }

    /// The unknowns before they are clipped to their bounds: `p + Aᵀ z`.
    fn unclipped(&self, z: &[f64]) -> Vec<f64> {
        let mut x = self.preferred.to_vec();
        for (i, &z) in z.iter().enumerate().filter(|(_, z)| **z != 0.0) {
            x.iter_mut().zip(self.row(i)).for_each(|(x, a)| *x += a * z);
        }
        x
    }

    fn clipped(&self, z: &[f64]) -> Vec<f64> {
        let mut x = self.unclipped(z);
        x.iter_mut().zip(self.upper).for_each(|(x, u)| *x = x.clamp(0.0, *u));
        x
    }

    /// The gradient of the dual function at `z`: `λ z + A x(z) − b`.
    fn gradient(&self, lambda: f64, z: &[f64]) -> Vec<f64> {
        let x = self.clipped(z);
        (0..self.right.len()).map(|i| lambda * z[i] + dot(self.row(i), &x) - self.right[i]).collect()
    }

    /// The Newton step of the dual function: `−(λ I + Σ a aᵀ)⁻¹ g`, where `g` is the gradient. The sum is over the
    /// columns `a` of `A` whose unknowns lie between their bounds.
    fn newton_step(&self, lambda: f64, states: &[BoundStatus], gradient: &[f64]) -> Vec<f64> {
        let m = gradient.len();
        let mut hessian = vec![0.0; m * m];
        for i in 0..m {
            let count = |(a, state): (&f64, &BoundStatus)| if *state == BoundStatus::Free { *a } else { 0.0 };
            let between: Vec<f64> = self.row(i).iter().zip(states).map(count).collect();
            for k in 0..=i {
                hessian[i * m + k] = dot(&between, self.row(k));
            }
            hessian[i * m + i] += lambda;
        }
        let mut step: Vec<f64> = gradient.iter().map(|g| -g).collect();
        solve_cholesky(&mut hessian, &mut step);
        step
    }

    /// Returns the position of the minimum along the step, in `[0, 1]`. The derivative along the step is piecewise
    /// linear, and its slope changes where an unknown leaves a bound or reaches one.
    fn line_search(&self, lambda: f64, z: &[f64], step: &[f64], gradient: &[f64]) -> f64 {
        let along = {
            let mut along = vec![0.0; self.preferred.len()];
            for (i, &d) in step.iter().enumerate() {
                along.iter_mut().zip(self.row(i)).for_each(|(v, a)| *v += a * d);
            }
            along
        };
        let mut slope = Slope { start: dot(gradient, step), growth: lambda * dot(step, step), changes: Vec::new() };
        for ((x, v), u) in self.unclipped(z).iter().zip(&along).zip(self.upper).filter(|((_, v), _)| **v != 0.0) {
            let (enters, leaves) = if *v > 0.0 { (-x / v, (u - x) / v) } else { ((u - x) / v, -x / v) };
            slope.add(enters, leaves, v * v);
        }
        slope.zero()
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Use eight partial sums: with a single sum, each addition would wait for the previous one.
    let mut sums = [0.0; 8];
    let (eights_of_a, rest_of_a) = a.as_chunks::<8>();
    let (eights_of_b, rest_of_b) = b.as_chunks::<8>();
    for (a, b) in eights_of_a.iter().zip(eights_of_b) {
        for i in 0..8 {
            sums[i] += a[i] * b[i];
        }
    }
    let rest: f64 = rest_of_a.iter().zip(rest_of_b).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

fn norm(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}

/// Solves a positive definite system, given by its lower triangle, in place (Cholesky).
fn solve_cholesky(a: &mut [f64], x: &mut [f64]) {
    let m = x.len();
    for i in 0..m {
        for k in 0..=i {
            let rest = a[i * m + k] - dot(&a[i * m..i * m + k], &a[k * m..k * m + k]);
            // Bound small pivots from below: rounding could make them zero or negative.
            a[i * m + k] = if i == k { rest.max(f64::EPSILON * a[i * m + i]).sqrt() } else { rest / a[k * m + k] };
        }
    }
    for i in 0..m {
        x[i] = (x[i] - dot(&a[i * m..i * m + i], &x[..i])) / a[i * m + i];
    }
    for i in (0..m).rev() {
        let below: f64 = (i + 1..m).map(|k| a[k * m + i] * x[k]).sum();
        x[i] = (x[i] - below) / a[i * m + i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    /// Solves a problem whose `regularisation` is given relative to the mean squared norm of a row.
    fn solve(
        rows: usize,
        matrix: &[f64],
        right: &[f64],
        regularisation: f64,
        preferred: &[f64],
        upper: &[f64],
    ) -> Vec<f64> {
        let regularisation = regularisation * dot(matrix, matrix) / rows as f64;
        BoundedLeastSquares { matrix, right, regularisation, preferred, upper }.solve().unwrap()
    }

    const FREE: f64 = f64::INFINITY;

    #[test]
    fn closed_forms() {
        // One equation in one unknown: a x = b, slightly regularised towards p.
        let x = solve(1, &[2.0], &[6.0], 1e-9, &[0.0], &[FREE]);
        assert!((x[0] - 6.0 * 2.0 / (4.0 + 4e-9)).abs() < 1e-12);
        // The preferred values add up to 3 of the required 6. The remaining 3 is divided equally among identical
        // unknowns.
        let x = solve(1, &[1.0, 1.0, 1.0], &[6.0], 1e-9, &[0.0, 0.0, 3.0], &[FREE; 3]);
        assert!((x[0] - 1.0).abs() < 1e-7 && (x[1] - 1.0).abs() < 1e-7 && (x[2] - 4.0).abs() < 1e-7, "{x:?}");
        // The first unknown is bounded by 1, so the second unknown contributes the remaining 5.
        let x = solve(1, &[1.0, 1.0], &[6.0], 1e-9, &[0.0, 0.0], &[1.0, FREE]);
        assert!(x[0] == 1.0 && (x[1] - 5.0).abs() < 1e-7, "{x:?}");
        // A negative solution is clipped to 0.
        assert_eq!(solve(1, &[1.0], &[-6.0], 1e-9, &[1.0], &[FREE]), [0.0]);
        // An unreachable right-hand side puts all unknowns at their bounds.
        assert_eq!(solve(1, &[1.0, 2.0], &[100.0], 1e-9, &[1.0, 1.0], &[3.0, 4.0]), [3.0, 4.0]);
        // Two equations: [[2, 1], [1, 3]] x = [5, 10] has x = [1, 3].
        let x = solve(2, &[2.0, 1.0, 1.0, 3.0], &[5.0, 10.0], 1e-10, &[0.0, 0.0], &[FREE; 2]);
        assert!((x[0] - 1.0).abs() < 1e-8 && (x[1] - 3.0).abs() < 1e-8, "{x:?}");
        // Without equations, the solution is the preferred value, clipped to its bounds.
        assert_eq!(
            BoundedLeastSquares { matrix: &[], right: &[], regularisation: 1.0, preferred: &[0.7], upper: &[0.5] }
                .solve()
                .unwrap(),
            [0.5]
        );
    }

    /// The Karush-Kuhn-Tucker conditions hold at the solutions of random problems of all shapes, with columns that
    /// differ by up to twelve orders of magnitude.
    #[test]
    fn conditions_of_optimality() {
        let mut rng = Rng::new(3, &[]);
        for case in 0..600 {
            let (m, n) = (1 + rng.below(6), 1 + rng.below(40));
            let spread = if case % 4 == 0 { 12.0 } else { 0.0 };
            let size: Vec<f64> = (0..n).map(|_| 10f64.powf(-spread * rng.next_f64())).collect();
            let matrix: Vec<f64> = (0..m * n).map(|i| rng.next_f64() * size[i % n]).collect();
            let right: Vec<f64> = (0..m).map(|_| rng.normal() * n as f64).collect();
            let preferred = vec![1.0; n];
            let upper: Vec<f64> =
                (0..n).map(|_| if rng.next_f64() < 0.5 { FREE } else { 3.0 * rng.next_f64() }).collect();
            let regularisation = 10f64.powf(-9.0 * rng.next_f64());
            let x = solve(m, &matrix, &right, regularisation, &preferred, &upper);
            let lambda = regularisation * matrix.iter().map(|a| a * a).sum::<f64>() / m as f64;
            for j in 0..n {
                let slope: f64 =
                    (0..m).map(|i| matrix[i * n + j] * (dot(&matrix[i * n..][..n], &x) - right[i])).sum::<f64>()
                        + lambda * (x[j] - preferred[j]);
                // The slope is a difference of large terms: choose the tolerance relative to their size.
                let small = 1e-6 * (lambda + norm(&right));
                let fits = match x[j] {
                    v if v == upper[j] => slope <= small,
                    0.0 => slope >= -small,
                    _ => slope.abs() <= small,
                };
                assert!(
                    fits && (0.0..=upper[j]).contains(&x[j]),
                    "case {case}: x {} of {}, slope {slope}",
                    x[j],
                    upper[j]
                );
            }
        }
    }
}
