//! The least of a convex, piecewise quadratic function along a step, in closed form: where its derivative, which is
//! piecewise linear and never falls, is zero.

/// A derivative along a step, from 0 to 1.
pub(super) struct Slope {
    /// At 0.
    pub start: f64,
    /// How fast it grows everywhere, ≥ 0.
    pub growth: f64,
    /// Where it begins to grow faster or slower, and by how much.
    pub changes: Vec<(f64, f64)>,
}

impl Slope {
    /// A piece that lets the derivative grow by `growth` more from one place to another.
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

    /// Where the derivative is zero, or the end that is nearer to it.
    pub fn zero(mut self) -> f64 {
        if self.start >= 0.0 {
            return 0.0;
        }
        self.changes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut at, mut slope, mut growth) = (0.0, self.start, self.growth);
        for (next, change) in self.changes.into_iter().chain([(1.0, 0.0)]) {
            // What is taken away was added before: below zero it is rounding.
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
        // One parabola, whose foot is within the step, at its end, or beyond.
        assert_eq!([2.0, 1.0, 0.5].map(|growth| slope(-1.0, growth, &[])), [0.5, 1.0, 1.0]);
        assert_eq!(slope(0.0, 1.0, &[]), 0.0);
        // Steeper from a half on: -1 + 0.5 + 2 (t - 0.5) = 0 at 0.75.
        assert_eq!(slope(-1.0, 1.0, &[(0.5, 7.0, 1.0)]), 0.75);
        // A piece that ends before the foot: -1 + 0.25 t * ..., 4 from 0 to 0.125 and 1 after it.
        assert_eq!(slope(-1.0, 1.0, &[(-3.0, 0.125, 3.0)]), 0.625);
        // Pieces outside count nothing.
        assert_eq!(slope(-1.0, 2.0, &[(1.0, 2.0, 9.0), (-2.0, 0.0, 9.0), (0.3, 0.3, 9.0)]), 0.5);
    }
}
