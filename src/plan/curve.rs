//! Curves of error against time, and the allocation of time to several stages along their curves.

use super::Goal;
use crate::maths;

/// The error of a stage as a function of its time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curve {
    /// Minimum and maximum time in seconds that the stage can use; 0 < minimum <= maximum.
    pub min_seconds: f64,
    pub max_seconds: f64,
    /// Ascending times in seconds, each with the squared error after this time. In each of the two intervals between
    /// the points, the squared error is proportional to time^-p. The exponent p follows from the two ends of the
    /// interval and is clamped to [`POWERS`]. If p was clamped, the curve in this interval passes through the middle
    /// point only. The curve continues before the first point, and after the last point with p at most
    /// [`MAX_EXTRAPOLATED`].
    pub points: [[f64; 2]; 3],
}

/// Minimum and maximum of the exponent p in error² ∝ time^-p. The minimum holds for independent samples, the maximum
/// for scrambled nets on smooth integrands (Owen 1997, "Scrambled net variance for integrals of smooth functions").
/// [paper: Owen 1997]
const POWERS: [f64; 2] = [1.0, 3.0];
/// Maximum exponent p of the extrapolation. In the long run, edges dominate the error. If an edge crosses one sampling
/// dimension, only the stratum that contains the edge contributes to the error. The squared error of n samples then
/// falls as 1/n². [convention: exponent of a stratified step function]
const MAX_EXTRAPOLATED: f64 = 2.0;

/// Factor by which an allocation step lengthens the time of a stage. [convention]
const STEP: f64 = 1.01;

impl Curve {
    /// Returns the curve for independent samples: the squared error is `squared_error` after the minimum time, and
    /// inversely proportional to the time.
    pub fn of_independent(min_seconds: f64, max_seconds: f64, squared_error: f64) -> Self {
        let point = |times: f64| [times * min_seconds, squared_error / times];
        Self { min_seconds, max_seconds, points: [point(1.0), point(2.0), point(4.0)] }
    }

    /// Returns the squared error after a time in seconds.
    pub fn squared_error(&self, seconds: f64) -> f64 {
        let [first, middle, last] = self.points;
        let ([s, a], [t, b]) = if seconds < middle[0] { (first, middle) } else { (middle, last) };
        if a <= 0.0 || b <= 0.0 {
            return b.max(0.0);
        }
        let power = (maths::ln(a / b) / maths::ln(t / s)).clamp(POWERS[0], POWERS[1]);
        // error² = middle error² · (middle time / time)^power up to the last point. From there on the error falls with
        // the limited exponent.
        let [known, beyond] = [seconds.min(last[0]), seconds.max(last[0])];
        middle[1] * maths::powf(middle[0] / known, power) * maths::powf(last[0] / beyond, power.min(MAX_EXTRAPOLATED))
    }

    /// Returns by how much the squared error falls per second during the allocation step that begins at `seconds`; 0
    /// at the end of the curve.
    fn gain(&self, seconds: f64) -> f64 {
        let next = (seconds * STEP).min(self.max_seconds);
        if next > seconds { (self.squared_error(seconds) - self.squared_error(next)) / (next - seconds) } else { 0.0 }
    }
}

/// Returns the time for each stage, in seconds. Each stage starts with its minimum time. Small steps of time then go,
/// one by one, to the stage in which they lower the sum of squared errors most per second. This ends when the goal is
/// reached or no stage can use more time. If no curve becomes steeper at its middle point, each step on a curve gains
/// less than the step before, and the result is optimal to within one step.
pub(super) fn allocate(curves: &[Curve], goal: Goal) -> Vec<f64> {
    let mut seconds: Vec<f64> = curves.iter().map(|c| c.min_seconds).collect();
    loop {
        let total: f64 = seconds.iter().sum();
        let squared_error: f64 = curves.iter().zip(&seconds).map(|(c, &s)| c.squared_error(s)).sum();
        let left = match goal {
            Goal::Error(error) if squared_error <= error * error => return seconds,
            Goal::Error(_) => f64::INFINITY,
            Goal::Seconds(budget) => budget - total,
        };
        let best = (0..curves.len()).max_by(|&a, &b| curves[a].gain(seconds[a]).total_cmp(&curves[b].gain(seconds[b])));
        let Some(best) = best.filter(|&i| left > 0.0 && curves[i].gain(seconds[i]) > 0.0) else { return seconds };
        let next = (seconds[best] * STEP).min(curves[best].max_seconds);
        if next - seconds[best] >= left {
            seconds[best] += left;
            return seconds;
        }
        seconds[best] = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn monte_carlo(squared_error: f64) -> Curve {
        Curve::of_independent(0.01, 1e6, squared_error)
    }

    #[test]
    fn curves_pass_through_their_points() {
        let curve = Curve { min_seconds: 1.0, max_seconds: 1e6, points: [[1.0, 64.0], [4.0, 8.0], [16.0, 2.0]] };
        for ([seconds, squared_error], expected) in curve.points.iter().map(|p| (*p, p[1])) {
            assert!((curve.squared_error(seconds) - expected).abs() < 1e-9, "{squared_error} after {seconds} s");
        }
        assert!(
            (curve.squared_error(64.0) - 0.5).abs() < 1e-9
                && (curve.squared_error(2.0) - 64.0 / 8f64.sqrt()).abs() < 1e-9
        );
        // Between the points, the exponent p is 2.66. After the last point it is limited to 2.
        let steep = Curve { points: [[1.0, 320.0], [4.0, 8.0], [16.0, 0.2]], ..curve };
        assert!((steep.squared_error(1.0) - 320.0).abs() < 1e-9 && (steep.squared_error(16.0) - 0.2).abs() < 1e-9);
        assert!((steep.squared_error(64.0) - 0.2 / 16.0).abs() < 1e-9);
        // Noisy measurements must neither let the error rise with time nor let it fall without bound.
        let odd = Curve { points: [[1.0, 1.0], [4.0, 2.0], [16.0, 1e-9]], ..curve };
        assert!(odd.squared_error(1.0) > odd.squared_error(4.0) && odd.squared_error(64.0) > 1e-12);
        assert_eq!(Curve { points: [[1.0, 0.0], [4.0, 0.0], [16.0, 0.0]], ..curve }.squared_error(9.0), 0.0);
    }

    #[test]
    fn time_goes_where_it_lowers_the_error_most() {
        // For the squared errors a / t₁ and b / t₂ of two stages with the times t₁ and t₂, the optimal times are
        // proportional to √a and √b.
        let curves = [monte_carlo(1.0), monte_carlo(9.0)];
        let seconds = allocate(&curves, Goal::Seconds(8.0));
        assert!((seconds.iter().sum::<f64>() - 8.0).abs() < 1e-9);
        assert!((seconds[0] - 2.0).abs() < 0.05, "{seconds:?}");
        // For an error goal, the optimal times have the same ratio, and the squared error is (√a + √b)² / (t₁ + t₂).
        let seconds = allocate(&curves, Goal::Error(0.2));
        let squared_error: f64 = curves.iter().zip(&seconds).map(|(c, &s)| c.squared_error(s)).sum();
        assert!(squared_error <= 0.04 && squared_error > 0.039, "{squared_error}");
        assert!((seconds[1] / seconds[0] - 3.0).abs() < 0.1, "{seconds:?}");
    }

    #[test]
    fn least_and_most_are_kept() {
        let short = Curve { max_seconds: 0.5, ..monte_carlo(1.0) };
        assert_eq!(allocate(&[short], Goal::Seconds(9.0)), [0.5]);
        assert_eq!(allocate(&[short], Goal::Error(1e-5)), [0.5]);
        assert_eq!(allocate(&[short, short], Goal::Seconds(0.001)), [0.01, 0.01]);
        // A stage without error gets only its minimum time.
        let exact = monte_carlo(0.0);
        assert_eq!(allocate(&[exact, monte_carlo(1.0)], Goal::Seconds(1.0))[0], 0.01);
    }
}
