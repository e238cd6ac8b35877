//! Exact line search for a convex, piecewise quadratic function: the zero of its derivative, which is piecewise linear
//! and non-decreasing.

/// The derivative of the function along a step. Positions on the step run from 0 to 1.
pub(super) struct Slope {
    /// The derivative at 0.
    pub start: f64,
    /// The slope of the derivative at 0, ≥ 0.
    pub growth: f64,
    /// Positions at which the slope of the derivative changes, each with the change.
    pub changes: Vec<(f64, f64)>,
}

impl Slope {
    /// Increases the slope of the derivative by `growth` on the interval from position `from` to position `to`.
    pub fn add(&mut self, from: f64, to: f64, growth: f64) {
        if to <= 0.0 || from >= 1.0 || from >= to {
            return;
        }
        if from <= 0.0 {
            self.growth += growth;
        } else {
            self.changes.push((from, growth));
        }
        if to < 1.0 {
            self.changes.push((to, -growth));
        }
    }

    /// Returns the position at which the derivative is zero. If the derivative has no zero on the step, returns the end
    /// at which the function is smaller: 0 if the derivative is positive, 1 if it is negative.
    pub fn zero(mut self) -> f64 {
        if self.start >= 0.0 {
            return 0.0;
        }
        self.changes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut at, mut slope, mut growth) = (0.0, self.start, self.growth);
        for (next, change) in self.changes.into_iter().chain([(1.0, 0.0)]) {
            // Clamp `growth` to 0. Every amount that is subtracted from it was added before, so only rounding makes it
            // negative.
            let rise = growth.max(0.0) * (next - at);
            if slope + rise >= 0.0 {
                return if rise > 0.0 { at - slope / growth } else { at };
            }
            (at, slope, growth) = (next, slope + rise, growth + change);
        }
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_parabolas() {
        let slope = |start, growth, pieces: &[(f64, f64, f64)]| {
            let mut slope = Slope { start, growth, changes: Vec::new() };
            pieces.iter().for_each(|&(from, to, growth)| slope.add(from, to, growth));
            slope.zero()
        };
        // The minimum of a single parabola lies within the step, at its end, or beyond.
        assert_eq!([2.0, 1.0, 0.5].map(|growth| slope(-1.0, growth, &[])), [0.5, 1.0, 1.0]);
        assert_eq!(slope(0.0, 1.0, &[]), 0.0);
        // The slope increases at one half: the derivative -1 + 0.5 + 2 (t - 0.5) is zero at 0.75.
        assert_eq!(slope(-1.0, 1.0, &[(0.5, 7.0, 1.0)]), 0.75);
        // The derivative has the slope 4 up to 0.125, and 1 after it.
        assert_eq!(slope(-1.0, 1.0, &[(-3.0, 0.125, 3.0)]), 0.625);
        // Intervals outside the step and empty intervals have no effect.
        assert_eq!(slope(-1.0, 2.0, &[(1.0, 2.0, 9.0), (-2.0, 0.0, 9.0), (0.3, 0.3, 9.0)]), 0.5);
    }
}
