//! Rounding of powers to dimming levels.
//!
//! If each group were rounded separately, the errors would add up, because lamps of equal power would all be rounded
//! in the same direction. Instead, coordinate descent visits one group after the other, until no level changes. For
//! each group, it chooses the level that minimises the sum of squared residuals of the goals, with the levels of the
//! other groups fixed. The descent runs from two starting points, and the better result is kept. The sum is convex in
//! the power of one group, so the group's best level is found by stepping through the levels while the sum decreases.

use super::bounded::dot;
use super::sided::Constraint;
use crate::maths;

/// The terms of the goals, one per row of the matrix: see [`super::sided::OneSidedLeastSquares`].
pub(super) struct Terms<'a> {
    pub matrix: &'a [f64],
    pub right: &'a [f64],
    pub constraints: &'a [Constraint],
}

/// Maximum number of rounds over all groups; a few suffice. [convention]
const MAX_ROUNDS: usize = 100;
/// A decrease of the sum of squared residuals counts as zero if it is at most this share of the sum of the squared
/// targets. [rounding]
const ROUNDING: f64 = 1e-14;

/// The current powers, the index of the level chosen for each group, and the light of each term under these powers.
#[derive(Clone)]
struct DimmingState {
    powers: Vec<f64>,
    chosen: Vec<usize>,
    light: Vec<f64>,
}

impl Terms<'_> {
    /// Rounds the powers `x` to `levels` (ascending, not empty). The level of a group is at most the group's bound in
    /// `upper`; if all levels are above the bound, the group gets the lowest level.
    pub fn round(&self, x: &[f64], levels: &[f64], upper: &[f64]) -> Vec<f64> {
        let max_level: Vec<usize> = upper.iter().map(|u| levels.partition_point(|l| l <= u).max(1) - 1).collect();
        let nearest = |j: usize| {
            let off = |l: usize| (levels[l] - x[j]).abs();
            (0..=max_level[j]).min_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap_or(0)
        };
        let chosen: Vec<usize> = (0..x.len()).map(nearest).collect();
        let light = self.matrix.chunks_exact(x.len()).map(|row| dot(row, x)).collect();
        // Try two starting points: all groups at their nearest levels, and the unrounded powers. From the unrounded
        // powers, the descent rounds one group after the other.
        let after = DimmingState { powers: x.to_vec(), chosen, light };
        let mut at_once = after.clone();
        (0..x.len()).for_each(|j| self.set(&mut at_once, j, after.chosen[j], levels));
        let [a, b] = [at_once, after].map(|start| self.descend(start, levels, &max_level));
        if self.sum(&a, 0, 0.0) <= self.sum(&b, 0, 0.0) { a.powers } else { b.powers }
    }

    fn descend(&self, mut state: DimmingState, levels: &[f64], max_level: &[usize]) -> DimmingState {
        let small = ROUNDING * dot(self.right, self.right);
        for round in 0..MAX_ROUNDS {
            let mut changed = false;
            for j in 0..state.powers.len() {
                let sum = |l: usize| self.sum(&state, j, levels[l] - state.powers[j]);
                let mut best = (state.chosen[j], sum(state.chosen[j]));
                for up in [true, false] {
                    while let Some(next) = if up { best.0.checked_add(1) } else { best.0.checked_sub(1) } {
                        let there = if next <= max_level[j] { sum(next) } else { break };
                        if there >= best.1 - small {
                            break;
                        }
                        best = (next, there);
                    }
                }
                changed |= round == 0 || best.0 != state.chosen[j];
                self.set(&mut state, j, best.0, levels);
            }
            if !changed {
                break;
            }
        }
        state
    }

    fn set(&self, state: &mut DimmingState, j: usize, level: usize, levels: &[f64]) {
        let (n, change) = (state.powers.len(), levels[level] - state.powers[j]);
        state.light.iter_mut().enumerate().for_each(|(i, l)| *l += self.matrix[i * n + j] * change);
        (state.powers[j], state.chosen[j]) = (levels[level], level);
    }

    /// Returns the sum of squared residuals after the power of group `j` changes by `change`.
    fn sum(&self, state: &DimmingState, j: usize, change: f64) -> f64 {
        let n = state.powers.len();
        let light = |i: usize| state.light[i] + self.matrix[i * n + j] * change;
        (0..self.right.len()).map(|i| maths::powi(self.constraints[i].miss(light(i) - self.right[i]), 2)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    const FREE: f64 = f64::INFINITY;

    fn cost(terms: &Terms, x: &[f64]) -> f64 {
        let light: Vec<f64> = terms.matrix.chunks_exact(x.len()).map(|r| dot(r, x)).collect();
        light.iter().zip(terms.right).zip(terms.constraints).map(|((l, b), s)| s.miss(l - b).powi(2)).sum()
    }

    #[test]
    fn equal_lamps_share_the_rounding() {
        // Ten lamps with a power of 0.24 give 2.4 in total. If lamps can only be on or off, two must be on for an
        // exact target of 2.4, and three for a lower limit of 2.4.
        let terms = Terms { matrix: &[1.0; 10], right: &[2.4], constraints: &[Constraint::Exactly] };
        let on = terms.round(&[0.24; 10], &[0.0, 1.0], &[FREE; 10]).iter().sum::<f64>();
        assert_eq!(on, 2.0);
        let terms = Terms { constraints: &[Constraint::AtLeast], ..terms };
        assert_eq!(terms.round(&[0.24; 10], &[0.0, 1.0], &[FREE; 10]).iter().sum::<f64>(), 3.0);
        // A single lamp goes to the nearest level within its bound, or to the lowest level if all are above the bound.
        let terms = Terms { matrix: &[2.0], right: &[1.5], constraints: &[Constraint::Exactly] };
        assert_eq!(terms.round(&[0.75], &[0.0, 0.5, 0.7, 1.0], &[FREE]), [0.7]);
        assert_eq!(terms.round(&[0.5], &[0.0, 0.5, 0.7, 1.0], &[0.6]), [0.5]);
        assert_eq!(terms.round(&[0.1], &[0.2, 0.5], &[0.1]), [0.2]);
    }

    /// Joint rounding is never worse than separate rounding, and no change of a single group improves it. On average,
    /// the error of joint rounding is less than 0.6 times the error of separate rounding.
    #[test]
    fn joint_choices_against_all_combinations() {
        let mut rng = Rng::new(11, &[]);
        let levels = [0.0, 0.25, 0.5, 0.75, 1.0];
        let mut gaps = Vec::new();
        for _ in 0..60 {
            let (m, n) = (2, 5);
            let matrix: Vec<f64> = (0..m * n).map(|_| rng.next_f64()).collect();
            let x: Vec<f64> = (0..n).map(|_| rng.next_f64()).collect();
            let right: Vec<f64> = matrix.chunks_exact(n).map(|r| dot(r, &x)).collect();
            let terms = Terms { matrix: &matrix, right: &right, constraints: &[Constraint::Exactly; 2] };
            let found = terms.round(&x, &levels, &[FREE; 5]);
            let reached = cost(&terms, &found);
            let rounded: Vec<f64> = x.iter().map(|x| (x * 4.0).round() / 4.0).collect();
            assert!(reached <= cost(&terms, &rounded) + 1e-12);
            for j in 0..n {
                for level in levels {
                    let mut other = found.clone();
                    other[j] = level;
                    assert!(cost(&terms, &other) >= reached - 1e-12);
                }
            }
            gaps.push((reached.sqrt(), cost(&terms, &rounded).sqrt()));
        }
        let mean = |i: usize| gaps.iter().map(|g| [g.0, g.1][i]).sum::<f64>() / gaps.len() as f64;
        assert!(mean(0) < 0.6 * mean(1), "{} {}", mean(0), mean(1));
    }
}
