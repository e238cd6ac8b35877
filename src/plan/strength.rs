//! Plans the solution for the strength of the emission: predicts the time needed for a given error from a few short
//! trial solutions.

use super::curve::Curve;
use super::{Clock, Expected, Goal, MAX_COST, overtime, timed};
use crate::error::Result;
use crate::job::Job;
use crate::maths;
use crate::relight;
use crate::render::World;
use glam::Vec3;

/// Number of paths per trial solution (`TRIAL`), and number of timed trials (`TRIALS`). Several trials are averaged,
/// because the standard error that one trial reports has itself a relative standard error of 13 %.
const TRIAL: u32 = 4096;
const TRIALS: u64 = 6;
/// Constant that is XORed with the seed of the solution, so that the trials trace other random paths than the solution.
const TRIAL_SEED: u64 = 0x7472_6961_6c73_2121;
/// Target radiance of the first trial, in cd/m². It exceeds all other light of a scene by far, so that the emission
/// must supply it. [convention]
const DOMINANT: f32 = 1e9;
/// Minimum and maximum number of paths of a solution: the paths of its first round, and the largest value that
/// [`relight::Params::paths`] allows. [convention]
const SOLUTION_PATHS: [f64; 2] = [(relight::BATCHES as u32 * relight::FIRST_ROUND) as f64, (1u32 << 30) as f64];
/// Half-width of a 95 % confidence interval in standard errors: Student's factor for the number of batches used.
/// [convention]
const HALF_WIDTH: f64 = 2.04;

/// Measured cost and error of the solution for the emission's strength.
pub(super) struct Strength {
    seconds_per_path: f64,
    /// Half-width of the confidence interval of a trial's solution, relative to the solution; the root mean square over
    /// the trials.
    half_width: f64,
}

impl Strength {
    /// Runs the trials for an emitting material and the triangles of the target.
    ///
    /// A first trial only measures b and r: the target's radiance from other lights, and from the unscaled emission.
    /// Its own solution, for the radiance [`DOMINANT`], is not used. The timed trials then solve for the current
    /// radiance b + r. Another target would give nearly the same relative error: the solution is (target - b) / r, and
    /// if b = 0, its relative error does not depend on the target.
    pub fn new(
        (world, emitter, target_triangles): (&World, usize, &[(usize, usize)]),
        params: &relight::Params,
        clock: Clock,
        job: Job,
    ) -> Result<Self> {
        let trial = |seed: u64, target: Vec3, job| {
            let input = relight::Input { world, emitter, target_triangles, target };
            let params = relight::Params {
                paths: TRIAL,
                target_error: 0.0,
                time_budget_ms: 0,
                seed: params.seed ^ seed,
                ..params.clone()
            };
            relight::run(&input, &params, job)
        };
        let first = trial(TRIAL_SEED, Vec3::splat(DOMINANT), job.part(0.0, 0.1))?;
        let target = (first.response + first.background).as_vec3();
        let (mut seconds, mut squares) = (0.0, 0.0);
        let job = job.part(0.1, 1.0);
        for k in 0..TRIALS {
            let part = job.part(k as f64 / TRIALS as f64, (k + 1) as f64 / TRIALS as f64);
            let (taken, solution) = timed(clock, || trial(TRIAL_SEED + 1 + k, target, part));
            seconds += taken;
            squares += maths::powi(solution?.error(), 2);
        }
        let trials = TRIALS as f64;
        Ok(Self { seconds_per_path: seconds / trials / f64::from(TRIAL), half_width: (squares / trials).sqrt() })
    }

    /// Returns a curve over the seconds spent on the solution: the squared error that the solution adds to a picture of
    /// the given contrast.
    pub fn curve(&self, contrast: f64) -> Curve {
        let [min_seconds, max_seconds] = SOLUTION_PATHS.map(|paths| paths * self.seconds_per_path);
        Curve::of_independent(
            min_seconds,
            max_seconds,
            maths::powi(Self::contribution(self.half_width(SOLUTION_PATHS[0]), contrast), 2),
        )
    }

    /// Returns how much a solution contributes to the error of a picture of the given contrast, from the relative
    /// half-width of the solution's confidence interval.
    pub fn contribution(half_width: f64, contrast: f64) -> f64 {
        half_width / HALF_WIDTH * contrast
    }

    fn half_width(&self, paths: f64) -> f64 {
        self.half_width * (f64::from(TRIAL) / paths).sqrt()
    }

    /// Returns the settings, and the expected time and error. For a goal in seconds, the settings use the time
    /// `seconds`. For an error goal, they aim at the error expected after this time. The error is the relative
    /// half-width of the solution's confidence interval.
    pub fn plan(&self, params: &relight::Params, goal: Goal, seconds: f64) -> (relight::Params, Expected) {
        let paths = (seconds / self.seconds_per_path).clamp(SOLUTION_PATHS[0], SOLUTION_PATHS[1]);
        let error = self.half_width(paths);
        let count = |paths: f64| paths.clamp(SOLUTION_PATHS[0], SOLUTION_PATHS[1]) as u32;
        let plain = relight::Params { target_error: 0.0, time_budget_ms: 0, ..params.clone() };
        if matches!(goal, Goal::Error(_)) {
            let expected = Expected { seconds: relight::FORECAST_MARGIN * paths * self.seconds_per_path, error };
            let target_error = error.min(1.0) as f32;
            (relight::Params { paths: count(MAX_COST * paths), target_error, ..plain }, expected)
        } else {
            let expected = Expected { seconds: paths * self.seconds_per_path, error };
            (relight::Params { paths: count(paths), time_budget_ms: overtime(expected), ..plain }, expected)
        }
    }
}
