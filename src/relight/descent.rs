//! Bounded minimisation of a smooth function of a few variables: projected BFGS (Nocedal and Wright 2006, chapter 6;
//! Bertsekas 1982 for the projection).

use crate::job::Job;
use crate::maths;

/// Bounds of the variables.
pub(super) struct Bounds<const N: usize> {
    pub min: [f64; N],
    pub max: [f64; N],
    /// Period of the function in each variable. A variable whose range covers a period may take any value.
    pub period: [f64; N],
}

/// Maximum number of steps. Rosenbrock's valley takes 43 steps, smooth periodic functions of five variables up to 42,
/// so any value above 50 gives the same result. [convention]
const MAX_STEPS: usize = 60;
/// Maximum number of halvings of a step. [convention]
const MAX_HALVINGS: usize = 30;
/// A step is accepted if the function decreases by at least this share of the linear prediction (Armijo condition).
/// [convention]
const ARMIJO: f64 = 1e-4;
/// Length of steps along the steepest descent, such as the first step, in the units of the variables. The line search
/// shortens these steps if necessary. With any value from 0.025 to 0.1, Rosenbrock's valley takes 43 or 44 steps.
/// [convention]
const FIRST_STEP: f64 = 0.05;
/// The search ends when a step decreases the function by at most this share of the function's value. BFGS converges
/// faster than linearly, so any value from 1e-12 to 1e-8 gives the same minimum, up to a relative difference of 1e-8.
/// [convention]
const MIN_RELATIVE_GAIN: f64 = 1e-10;

impl<const N: usize> Bounds<N> {
    /// Whether a variable may take any value, because its range covers a period of the function.
    fn is_open(&self, i: usize) -> bool {
        self.max[i] - self.min[i] >= self.period[i] * (1.0 - 1e-12)
    }

    pub fn nearest(&self, x: [f64; N]) -> [f64; N] {
        std::array::from_fn(|i| if self.is_open(i) { x[i] } else { x[i].clamp(self.min[i], self.max[i]) })
    }

    /// Interpolates between the bounds of each variable: `share` is 0 at the minimum and 1 at the maximum.
    pub fn between(&self, share: [f64; N]) -> [f64; N] {
        std::array::from_fn(|i| self.min[i] + share[i] * (self.max[i] - self.min[i]))
    }

    /// Moves each variable that may take any value by whole periods into the period that begins at `min`. The function
    /// has the same value there.
    pub fn wrapped(&self, x: [f64; N]) -> [f64; N] {
        std::array::from_fn(|i| {
            if self.is_open(i) { self.min[i] + (x[i] - self.min[i]).rem_euclid(self.period[i]) } else { x[i] }
        })
    }

    /// Whether a variable may move against the gradient without leaving its bounds.
    fn is_free(&self, i: usize, x: &[f64; N], gradient: &[f64; N]) -> bool {
        let held = x[i] <= self.min[i] && gradient[i] >= 0.0 || x[i] >= self.max[i] && gradient[i] <= 0.0;
        self.is_open(i) || self.min[i] < self.max[i] && !held
    }
}

/// Minimises `f` from the point `x`; `f` returns the value and its gradient. Ends early if the job is cancelled.
pub(super) fn run<const N: usize>(
    bounds: &Bounds<N>,
    mut x: [f64; N],
    f: impl Fn([f64; N]) -> (f64, [f64; N]),
    job: Job,
) -> [f64; N] {
    let (mut value, mut gradient) = f(x);
    let mut inverse: Option<[[f64; N]; N]> = None;
    for _ in 0..MAX_STEPS {
        if job.is_cancelled() {
            break;
        }
        let free: [bool; N] = std::array::from_fn(|i| bounds.is_free(i, &x, &gradient));
        let steepest: [f64; N] = std::array::from_fn(|i| if free[i] { -gradient[i] } else { 0.0 });
        let length = dot(&steepest, &steepest).sqrt();
        if length == 0.0 || !length.is_finite() {
            break;
        }
        // Take the quasi-Newton direction if it descends, else the steepest descent.
        let mut step = steepest.map(|s| s * FIRST_STEP / length);
        if let Some(inverse) = &inverse {
            let newton = std::array::from_fn(|i| if free[i] { dot(&inverse[i], &steepest) } else { 0.0 });
            if dot(&newton, &gradient) < 0.0 {
                step = newton;
            }
        }
        // Halve the step until the Armijo condition holds.
        let mut next = None;
        for halving in 0..MAX_HALVINGS {
            let share = maths::powi(0.5f64, halving as i32);
            let to = bounds.nearest(std::array::from_fn(|i| x[i] + share * step[i]));
            let step_taken: [f64; N] = std::array::from_fn(|i| to[i] - x[i]);
            let (there, gradient_there) = f(to);
            if there <= value + ARMIJO * dot(&step_taken, &gradient) {
                next = Some((to, step_taken, there, gradient_there));
                break;
            }
        }
        let Some((to, step_taken, there, gradient_there)) = next else { break };
        let gradient_change: [f64; N] = std::array::from_fn(|i| gradient_there[i] - gradient[i]);
        update(&mut inverse, &step_taken, &gradient_change);
        let gain = value - there;
        (x, value, gradient) = (to, there, gradient_there);
        if gain <= MIN_RELATIVE_GAIN * value.abs() {
            break;
        }
    }
    x
}

/// Updates the inverse Hessian from a step and the change of the gradient (BFGS). Leaves it unchanged unless the
/// function has positive curvature along the step, beyond rounding.
fn update<const N: usize>(inverse: &mut Option<[[f64; N]; N]>, step_taken: &[f64; N], gradient_change: &[f64; N]) {
    let curvature = dot(step_taken, gradient_change);
    if !(curvature > 1e-12 * dot(step_taken, step_taken).sqrt() * dot(gradient_change, gradient_change).sqrt()) {
        return;
    }
    // Initialise the inverse Hessian with the curvature observed along the step, for all directions.
    let scale = curvature / dot(gradient_change, gradient_change);
    let h = inverse.get_or_insert(std::array::from_fn(|i| std::array::from_fn(|j| if i == j { scale } else { 0.0 })));
    let along: [f64; N] = std::array::from_fn(|i| dot(&h[i], gradient_change));
    let gain = (1.0 + dot(gradient_change, &along) / curvature) / curvature;
    for i in 0..N {
        for j in 0..N {
            h[i][j] += gain * step_taken[i] * step_taken[j]
                - (along[i] * step_taken[j] + step_taken[i] * along[j]) / curvature;
        }
    }
}

fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    /// Rosenbrock's function has its minimum at (1, 1); within x <= 0.5 it is at (0.5, 0.25).
    #[test]
    fn a_valley_with_and_without_bounds() {
        let valley = |[x, y]: [f64; 2]| {
            let (a, b) = (1.0 - x, y - x * x);
            (a * a + 100.0 * b * b, [-2.0 * a - 400.0 * x * b, 200.0 * b])
        };
        let monitor = Monitor::default();
        for (max, expected) in [(3.0, [1.0, 1.0]), (0.5, [0.5, 0.25])] {
            let bounds = Bounds { min: [-3.0; 2], max: [max, 3.0], period: [f64::INFINITY; 2] };
            let found = run(&bounds, [-1.2, 1.0], valley, monitor.job());
            assert!(found.iter().zip(expected).all(|(x, e)| (x - e).abs() < 1e-4), "{found:?}");
        }
        // The bounds of the first variable span a whole period, so it is unbounded. The bounds of the second variable
        // are equal, so it is fixed.
        let wave = |[x, y]: [f64; 2]| ((x - 3.0).cos(), [-(x - 3.0).sin(), 1.0 + y]);
        let bounds = Bounds { min: [-3.2, 0.7], max: [3.2, 0.7], period: [std::f64::consts::TAU, 1.0] };
        let found = run(&bounds, [2.9, 0.7], wave, monitor.job());
        let wrapped = bounds.wrapped(found);
        assert!((wrapped[0] - (3.0 - std::f64::consts::PI)).abs() < 1e-4 && wrapped[1] == 0.7, "{found:?} {wrapped:?}");
    }
}
