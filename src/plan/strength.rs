//! The strength of the emission: how long its solution takes for an error, from a few short ones.

use super::curve::Curve;
use super::{Clock, Expected, Goal, PATIENCE, overtime, timed};
use crate::error::Result;
use crate::job::Job;
use crate::relight;
use crate::render::World;
use glam::Vec3;

/// Paths of a trial of the solution, and trials: the error that one states is itself known to 13 %.
const TRIAL: u32 = 4096;
const TRIALS: u64 = 6;
/// Tells their paths from those of the solution.
const SALT: u64 = 0x7472_6961_6c73_2121;
/// Radiance in cd/m² that no other light reaches.
const BRIGHT: f32 = 1e9;
/// Least and most paths of a solution.
const SOLUTION_PATHS: [f64; 2] = [2048.0, (1u32 << 30) as f64];
/// A solution that stops at a target forecasts its paths with this margin.
const MARGIN: f64 = 1.1;
/// Half-widths of intervals over standard errors, with so many batches.
const HALF_WIDTH: f64 = 2.04;

/// What a solution of the emission takes.
pub(super) struct Strength {
    seconds_per_path: f64,
    /// Half-width of the interval, relative, that a trial leaves.
    half_width: f64,
}

impl Strength {
    /// Tries it a few times, for an emitting material and the triangles of the target. What the target is to be has no say
    /// where there is no other light; with other light it is what the emission makes of it as it stands.
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
        let first = trial(SALT, Vec3::splat(BRIGHT), job.part(0.0, 0.1))?;
        let target = (first.response + first.background).as_vec3();
        let (mut seconds, mut squares) = (0.0, 0.0);
        let job = job.part(0.1, 1.0);
        for k in 0..TRIALS {
            let part = job.part(k as f64 / TRIALS as f64, (k + 1) as f64 / TRIALS as f64);
            let (taken, solution) = timed(clock, || trial(SALT + 1 + k, target, part));
            seconds += taken;
            squares += solution?.error().powi(2);
        }
        let trials = TRIALS as f64;
        Ok(Self { seconds_per_path: seconds / trials / f64::from(TRIAL), half_width: (squares / trials).sqrt() })
    }

    /// Error that it adds to a picture of a contrast, against time.
    pub fn curve(&self, contrast: f64) -> Curve {
        let [least, most] = SOLUTION_PATHS.map(|paths| paths * self.seconds_per_path);
        Curve::of_independent(least, most, self.adds(self.half_width(SOLUTION_PATHS[0]), contrast).powi(2))
    }

    /// What a solution with such an interval adds to the error of a picture.
    pub fn adds(&self, half_width: f64, contrast: f64) -> f64 {
        half_width / HALF_WIDTH * contrast
    }

    fn half_width(&self, paths: f64) -> f64 {
        self.half_width * (f64::from(TRIAL) / paths).sqrt()
    }

    /// The settings with which it takes so many seconds, or reaches the error that they stand for; and what to expect of
    /// it: the error is that of the solution, half the width of its interval.
    pub fn plan(&self, params: &relight::Params, goal: Goal, seconds: f64) -> (relight::Params, Expected) {
        let paths = (seconds / self.seconds_per_path).clamp(SOLUTION_PATHS[0], SOLUTION_PATHS[1]);
        let error = self.half_width(paths);
        let count = |paths: f64| paths.clamp(SOLUTION_PATHS[0], SOLUTION_PATHS[1]) as u32;
        let plain = relight::Params { target_error: 0.0, time_budget_ms: 0, ..params.clone() };
        if matches!(goal, Goal::Error(_)) {
            let expected = Expected { seconds: MARGIN * paths * self.seconds_per_path, error };
            let target_error = error.min(1.0) as f32;
            (relight::Params { paths: count(PATIENCE * paths), target_error, ..plain }, expected)
        } else {
            let expected = Expected { seconds: paths * self.seconds_per_path, error };
            (relight::Params { paths: count(paths), time_budget_ms: overtime(expected), ..plain }, expected)
        }
    }
}
