//! Bounded least squares with one-sided terms, for targets that are lower or upper limits.
//!
//! Minimises `½ Σ ψ(a x − b)² + ½ λ |x − p|²` over `0 ≤ x ≤ u`, where `ψ(r)` is `r` for exact targets, `min(r, 0)` for
//! lower limits, and `max(r, 0)` for upper limits. The function is convex, smooth and piecewise quadratic. A step of
//! Newton's method has three parts:
//!
//! 1. Find the active terms: the exact targets, and the limits that the current point violates.
//! 2. Solve the problem with the active terms only ([`super::bounded`]).
//! 3. Go to the minimum of the function on the line from the current point to this solution.
//!
//! The method ends after finitely many steps (Sun 1997, "On piecewise quadratic Newton and trust region problems"), in
//! practice after a few.

use super::bounded::{BoundedLeastSquares, dot};
use super::line_search::Slope;
use crate::error::{Error, ErrorKind, Result};

/// Whether a target is exact or a limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Constraint {
    /// An exact target.
    #[default]
    Exactly,
    /// A lower limit, for example the illuminance that a standard requires on a desk, or the value of a clipped pixel.
    AtLeast,
    /// An upper limit, against glare.
    AtMost,
}

impl Constraint {
    /// Returns the residual of a value that exceeds its target by `over`. If the target is a limit and the value
    /// satisfies it, the residual is 0.
    pub(super) fn miss(self, over: f64) -> f64 {
        match self {
            Self::Exactly => over,
            Self::AtLeast => over.min(0.0),
            Self::AtMost => over.max(0.0),
        }
    }
}

pub(super) struct OneSidedLeastSquares<'a> {
    /// The coefficients `a` of the terms, row by row.
    pub matrix: &'a [f64],
    pub right: &'a [f64],
    /// The kind of each term: one per row.
    pub constraints: &'a [Constraint],
    /// Weight `λ` of `|x − p|²`, relative to the mean squared norm of a row; positive.
    pub regularisation: f64,
    /// Preferred values `p` of the unknowns.
    pub preferred: &'a [f64],
    /// Upper bounds `u` of the unknowns, non-negative; may be infinite.
    pub upper: &'a [f64],
}

/// Maximum number of Newton steps; a few suffice. [convention]
const MAX_STEPS: usize = 200;
/// If the value of a term equals its limit up to this relative difference, the term keeps its state: active or not.
/// [rounding]
const ROUNDING: f64 = 1e-12;

impl OneSidedLeastSquares<'_> {
    /// Returns the solution `x`.
    ///
    /// # Errors
    /// `Internal` if the method does not converge, which cannot happen in theory.
    pub fn solve(&self) -> Result<Vec<f64>> {
        let lambda = self.regularisation * dot(self.matrix, self.matrix) / self.right.len() as f64;
        let mut x: Vec<f64> = self.preferred.iter().zip(self.upper).map(|(p, u)| p.clamp(0.0, *u)).collect();
        if !(lambda > 0.0 && lambda.is_finite()) {
            // Without any response, the solution is the preferred value, clipped to its bounds.
            return Ok(x);
        }
        let mut active = self.active(&x, &vec![false; self.right.len()]);
        for _ in 0..MAX_STEPS {
            let next = self.solve_active(&active, lambda)?;
            let then = self.active(&next, &active);
            if then == active {
                return Ok(next);
            }
            let (t, slope) = self.line_search(lambda, &x, &next);
            x.iter_mut().zip(&next).for_each(|(x, n)| *x += t * (n - *x));
            // Stop when the function no longer decreases. Without this condition, a term at its limit could change its
            // state by rounding in every step, without end.
            if -slope * t <= ROUNDING * dot(self.right, self.right) {
                return Ok(x);
            }
            active = self.active(&x, &active);
        }
        Err(Error::new(ErrorKind::Internal, "the powers for goals with limits did not settle"))
    }

    fn row(&self, i: usize) -> &[f64] {
        let n = self.preferred.len();
        &self.matrix[i * n..(i + 1) * n]
    }

    /// Returns which terms are active at `x`: exact targets, and limits that are violated. A term whose value equals
    /// its limit up to rounding keeps its state from `before`.
    fn active(&self, x: &[f64], before: &[bool]) -> Vec<bool> {
        let is_active = |i: usize| {
            let (light, right) = (dot(self.row(i), x), self.right[i]);
            let over = light - right;
            let edge = ROUNDING * (light.abs() + right.abs());
            match self.constraints[i] {
                Constraint::Exactly => true,
                _ if over.abs() <= edge => before[i],
                constraint => constraint.miss(over) != 0.0,
            }
        };
        (0..self.right.len()).map(is_active).collect()
    }

    /// Solves the problem with only the active terms, which are treated as exact targets.
    fn solve_active(&self, active: &[bool], regularisation: f64) -> Result<Vec<f64>> {
        let Self { matrix, right, preferred, upper, .. } = *self;
        if active.iter().all(|is_active| *is_active) {
            return BoundedLeastSquares { matrix, right, regularisation, preferred, upper }.solve();
        }
        let rows = || (0..right.len()).filter(|&i| active[i]);
        let matrix: Vec<f64> = rows().flat_map(|i| self.row(i).iter().copied()).collect();
        let right: Vec<f64> = rows().map(|i| right[i]).collect();
        BoundedLeastSquares { matrix: &matrix, right: &right, regularisation, preferred, upper }.solve()
    }

    /// Returns the position of the function's minimum between two points, in `[0, 1]`, and the derivative at the first
    /// point.
    fn line_search(&self, lambda: f64, from: &[f64], to: &[f64]) -> (f64, f64) {
        let step: Vec<f64> = to.iter().zip(from).map(|(b, a)| b - a).collect();
        let away: f64 = from.iter().zip(self.preferred).zip(&step).map(|((x, p), d)| (x - p) * d).sum();
        let mut slope = Slope { start: lambda * away, growth: lambda * dot(&step, &step), changes: Vec::new() };
        for (i, constraint) in self.constraints.iter().enumerate() {
            let (over, rise) = (dot(self.row(i), from) - self.right[i], dot(self.row(i), &step));
            slope.start += constraint.miss(over) * rise;
            let edge = -over / rise;
            let (first, last) = match (constraint, rise > 0.0) {
                (Constraint::Exactly, _) => (f64::NEG_INFINITY, f64::INFINITY),
                (Constraint::AtLeast, true) | (Constraint::AtMost, false) => (f64::NEG_INFINITY, edge),
                (Constraint::AtLeast, false) | (Constraint::AtMost, true) => (edge, f64::INFINITY),
            };
            if rise != 0.0 {
                slope.add(first, last, rise * rise);
            }
        }
        let start = slope.start;
        (slope.zero(), start)
    }
}

/// Returns the common power `q ≥ 0` of all lamps that minimises `½ Σ ψ(a q − b)²`, where `a ≥ 0` are the `responses`
/// to all lamps together. Among several minima it returns the smallest, which uses the least light. If no term
/// requires light, it returns the minimum nearest to 1, the current power.
pub(super) fn common_power(responses: &[f64], right: &[f64], constraints: &[Constraint]) -> f64 {
    let rows = || {
        responses
            .iter()
            .zip(right)
            .zip(constraints)
            .map(|((a, b), constraint)| (*a, *b, *constraint))
            .filter(|row| row.0 > 0.0)
    };
    // The minimum lies at or below the largest of the ratios b / a.
    let last = rows().map(|(a, b, _)| b / a).fold(0.0, f64::max);
    let mut slope = Slope { start: 0.0, growth: 0.0, changes: Vec::new() };
    for (a, b, constraint) in rows() {
        slope.start += constraint.miss(-b) * a;
        let (first, end) = match constraint {
            Constraint::Exactly => (0.0, f64::INFINITY),
            Constraint::AtLeast => (0.0, b / a),
            Constraint::AtMost => (b / a, f64::INFINITY),
        };
        slope.add(first / last, end / last, a * a * last);
    }
    let open = slope.start == 0.0 && rows().all(|(_, _, constraint)| constraint != Constraint::Exactly);
    if !open {
        return last * slope.zero();
    }
    rows().filter(|row| row.2 == Constraint::AtMost).map(|(a, b, _)| b / a).fold(1.0, f64::min)
}

#[cfg(test)]
mod tests {
    use super::Constraint::{AtLeast, AtMost, Exactly};
    use super::*;
    use crate::rng::Rng;

    const FREE: f64 = f64::INFINITY;

    #[test]
    fn closed_forms() {
        let solve = |matrix: &[f64], right: &[f64], constraints: &[Constraint], preferred: &[f64]| {
            let upper = vec![FREE; preferred.len()];
            OneSidedLeastSquares { matrix, right, constraints, regularisation: 1e-9, preferred, upper: &upper }
                .solve()
                .unwrap()
        };
        let near = |x: Vec<f64>, expected: &[f64]| {
            assert!(x.iter().zip(expected).all(|(x, e)| (x - e).abs() < 1e-6), "{x:?}, expected {expected:?}");
        };
        // The preferred value stays where it satisfies the limit, and moves to the limit where it does not.
        near(solve(&[2.0], &[6.0], &[AtLeast], &[5.0]), &[5.0]);
        near(solve(&[2.0], &[6.0], &[AtLeast], &[1.0]), &[3.0]);
        near(solve(&[2.0], &[6.0], &[AtMost], &[5.0]), &[3.0]);
        near(solve(&[2.0], &[6.0], &[AtMost], &[1.0]), &[1.0]);
        // The exact target requires x = 4 and the limit x <= 2: the minimum is in the middle.
        near(solve(&[1.0, 1.0], &[4.0, 2.0], &[Exactly, AtMost], &[0.0]), &[3.0]);
        near(solve(&[1.0, 1.0], &[4.0, 2.0], &[Exactly, AtLeast], &[0.0]), &[4.0]);
        // Each of two desks gets light mainly from its own lamp and needs at least 5; the first may get at most 6.
        let x = solve(&[1.0, 0.2, 0.2, 1.0, 1.0, 0.2], &[5.0, 5.0, 6.0], &[AtLeast, AtLeast, AtMost], &[0.0; 2]);
        near(x, &[25.0 / 6.0; 2]);
        // Without any response, the preferred value stays.
        near(solve(&[0.0], &[1.0], &[AtLeast], &[0.7]), &[0.7]);
    }

    /// The third unknown jumps from its upper bound to 0 in one step. The function still decreases after this step, so
    /// the method must not stop there.
    #[test]
    fn a_jump_from_bound_to_bound_does_not_end_the_search() {
        let (a, b) = ([0.64, 0.44, 0.37], [0.06, 0.92, 0.2]);
        let (matrix, right) = ([a, a, a, b, b].concat(), [1.07, 0.0, 0.59, 0.81, 1.11]);
        let constraints = [AtLeast, AtMost, AtLeast, AtMost, AtLeast];
        let (preferred, upper) = (&[1.0, 1.0, 0.1], &[1.18, 1.2, 0.1]);
        let problem = OneSidedLeastSquares {
            matrix: &matrix,
            right: &right,
            constraints: &constraints,
            regularisation: 7e-9,
            preferred,
            upper,
        };
        let x = problem.solve().unwrap();
        let misses: Vec<f64> = (0..5).map(|i| constraints[i].miss(dot(problem.row(i), &x) - right[i])).collect();
        for j in 0..3 {
            let slope: f64 = (0..5).map(|i| matrix[i * 3 + j] * misses[i]).sum();
            let held = x[j] == 0.0 && slope > 0.0 || x[j] == upper[j] && slope < 0.0;
            assert!(held || slope.abs() < 1e-6, "{x:?}: {slope}");
        }
    }

    #[test]
    fn one_power_for_all() {
        let alike = |rows: &[(f64, f64, Constraint)]| {
            let [a, b] = [0, 1].map(|i| rows.iter().map(|r| [r.0, r.1][i]).collect::<Vec<_>>());
            common_power(&a, &b, &rows.iter().map(|r| r.2).collect::<Vec<_>>())
        };
        // Least squares of inconsistent targets: q = Σ ab / Σ a².
        assert!((alike(&[(2.0, 6.0, Exactly), (1.0, 1.0, Exactly)]) - 13.0 / 5.0).abs() < 1e-15);
        assert_eq!(alike(&[(2.0, 6.0, AtLeast), (1.0, 1.0, AtLeast)]), 3.0);
        assert_eq!(alike(&[(2.0, 6.0, AtLeast), (1.0, 1.0, AtMost)]), 13.0 / 5.0);
        assert_eq!(alike(&[(2.0, 6.0, AtLeast), (1.0, 4.0, AtMost)]), 3.0);
        // Upper limits alone keep the current power or reduce it.
        assert_eq!(alike(&[(2.0, 6.0, AtMost)]), 1.0);
        assert_eq!(alike(&[(2.0, 1.0, AtMost), (1.0, 4.0, AtMost)]), 0.5);
        // The target is black, or is exceeded by other light alone, or receives no light from the lamps.
        assert_eq!(alike(&[(2.0, 0.0, Exactly)]), 0.0);
        assert_eq!(alike(&[(2.0, -1.0, Exactly)]), 0.0);
        assert_eq!(alike(&[(2.0, -1.0, AtMost)]), 0.0);
        assert_eq!(alike(&[(2.0, -1.0, AtLeast)]), 1.0);
        assert_eq!(alike(&[(0.0, 1.0, Exactly)]), 1.0);
    }

    /// The Karush-Kuhn-Tucker conditions hold at the solutions of random problems.
    #[test]
    fn conditions_of_optimality() {
        let mut rng = Rng::new(7, &[]);
        for case in 0..1000 {
            let (m, n) = (1 + rng.below(8), 1 + rng.below(if case % 2 == 0 { 30 } else { 5 }));
            let mut matrix: Vec<f64> = (0..m * n).map(|_| rng.next_f64()).collect();
            // In every third case, make groups of three rows equal, as the three channels of a goal are in a grey
            // room.
            for i in (1..m).filter(|i| case % 3 == 0 && i % 3 != 0) {
                matrix.copy_within((i - 1) * n..i * n, i * n);
            }
            let right: Vec<f64> = (0..m).map(|_| rng.next_f64() * n as f64 * 0.5).collect();
            let constraints: Vec<Constraint> = (0..m).map(|_| [Exactly, AtLeast, AtMost][rng.below(3)]).collect();
            let preferred: Vec<f64> = (0..n).map(|_| rng.next_f64()).collect();
            let upper: Vec<f64> =
                (0..n).map(|_| if rng.next_f64() < 0.5 { FREE } else { 2.0 * rng.next_f64() }).collect();
            let regularisation = 10f64.powf(-9.0 * rng.next_f64());
            let problem = OneSidedLeastSquares {
                matrix: &matrix,
                right: &right,
                constraints: &constraints,
                regularisation,
                preferred: &preferred,
                upper: &upper,
            };
            let x = problem.solve().unwrap();
            let lambda = regularisation * dot(&matrix, &matrix) / m as f64;
            let misses: Vec<f64> = (0..m).map(|i| constraints[i].miss(dot(problem.row(i), &x) - right[i])).collect();
            for j in 0..n {
                let slope = (0..m).map(|i| matrix[i * n + j] * misses[i]).sum::<f64>() + lambda * (x[j] - preferred[j]);
                let small = 1e-6 * (lambda + dot(&right, &right).sqrt());
                let fits = match x[j] {
                    v if v == upper[j] => slope <= small,
                    0.0 => slope >= -small,
                    _ => slope.abs() <= small,
                };
                assert!(fits && (0.0..=upper[j]).contains(&x[j]), "case {case}: x {}, slope {slope}", x[j]);
            }
        }
    }
}
