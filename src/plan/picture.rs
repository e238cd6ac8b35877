//! Plans the rendering of the picture: predicts the time needed for a given error from a few rendered tiles.

use super::curve::{Curve, allocate};
use super::{Clock, Expected, Goal, MAX_COST, overtime};
use crate::error::Result;
use crate::job::Job;
use crate::render::pilot::{self, PATHS, REPLICATIONS, nets};
use crate::render::{self, Pilot, World};
use crate::scene::Camera;

/// Minimum number of paths per pixel of a planned rendering: one per replication (point sequence of a pixel).
/// [convention]
const MIN_PATHS: f64 = REPLICATIONS as f64;
/// Maximum number of paths per pixel. [convention]
const MAX_PATHS: f64 = (1u32 << 20) as f64;
/// Number of paths per pixel after which adaptive sampling starts if there is a target error; the renderer uses the
/// same number. [convention]
const ADAPTIVE_FROM: f64 = pilot::MIN_UNIFORM_PATHS as f64;

/// A planned rendering.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendering {
    pub params: render::Params,
    pub expected: Expected,
}

/// Plans a rendering. Settings of `params` that do not affect quality are kept.
///
/// # Errors
/// A goal or a setting out of range; an invalid camera; cancellation.
pub fn rendering(
    world: &World,
    camera: &Camera,
    params: &render::Params,
    goal: Goal,
    clock: Clock,
    job: Job,
) -> Result<Rendering> {
    goal.check()?;
    let picture = Picture::new(world, camera, params, clock, job)?;
    let seconds = allocate(&[picture.curve()], goal)[0];
    Ok(picture.plan(params, goal, seconds))
}

/// Measured cost and error of a picture.
pub(super) struct Picture {
    pixels: f64,
    pilot: Pilot,
}

impl Picture {
    pub fn new(world: &World, camera: &Camera, params: &render::Params, clock: Clock, job: Job) -> Result<Self> {
        let pilot = pilot::run(world, camera, params, clock, job)?;
        Ok(Self { pixels: params.width as f64 * params.height as f64, pilot })
    }

    /// Root mean square of the picture divided by its mean.
    pub fn contrast(&self) -> f64 {
        self.pilot.contrast
    }

    fn seconds(&self, paths: f64) -> f64 {
        self.pixels * paths * self.pilot.seconds_per_path.max(1e-12)
    }

    /// Returns the expected error after `paths` paths per pixel with uniform sampling.
    ///
    /// The paths of a pixel are divided among its replications (independent point sequences), and the paths of each
    /// replication among nets of 1, 2, 4, 8, … points. The curve holds if each replication has a single net. For other
    /// numbers of paths, the errors σ of the nets are added as independent errors: error² = Σ (nᵢ / paths)² σ²(nᵢ),
    /// where nᵢ is the number of points of net i. A few paths more than a whole net may therefore increase the error.
    fn error(&self, paths: u32) -> f64 {
        let (curve, replications) = (self.curve(), f64::from(REPLICATIONS));
        let square = |points: f64| replications * curve.squared_error(self.seconds(replications * points));
        nets(paths).map(f64::from).map(|points| points * points * square(points)).sum::<f64>().sqrt() / f64::from(paths)
    }

    /// Returns the factor by which adaptive sampling reduces the number of paths needed for a given error. The pilot
    /// measures the reduction for an ideal allocation of paths. The renderer doubles the paths of whole tiles instead,
    /// and achieves about the square root of the ideal factor.
    fn saved(&self) -> f64 {
        self.pilot.adaptive_gain.sqrt()
    }

    /// Returns the curve of error against time with uniform sampling.
    pub fn curve(&self) -> Curve {
        let points = [0, 1, 2].map(|i| [self.seconds(PATHS[i].into()), self.pilot.squared_errors[i]]);
        Curve { min_seconds: self.seconds(MIN_PATHS), max_seconds: self.seconds(MAX_PATHS), points }
    }

    /// Returns the settings of a rendering that gets the time `seconds`. For a goal in seconds, the settings use this
    /// time. For an error goal, they aim at the error that uniform sampling reaches in this time.
    pub fn plan(&self, params: &render::Params, goal: Goal, seconds: f64) -> Rendering {
        let plain = render::Params {
            target_error: 0.0,
            relative_error: 0.0,
            pixel_error: 0.0,
            time_budget_ms: 0,
            ..params.clone()
        };
        let uniform_paths = seconds / self.seconds(1.0);
        let wanted = self.curve().squared_error(seconds).sqrt();
        let count = |paths: f64| paths.clamp(MIN_PATHS, MAX_PATHS) as u32;
        let uniform = |paths: u32| {
            let expected = Expected { seconds: self.seconds(paths.into()), error: self.error(paths) };
            Rendering { params: render::Params { samples: paths, ..plain.clone() }, expected }
        };
        match goal {
            Goal::Error(_) if uniform_paths > ADAPTIVE_FROM => {
                let error = wanted;
                let samples = (MAX_COST * uniform_paths).min(MAX_PATHS) as u32;
                let expected = Expected {
                    seconds: self.seconds(ADAPTIVE_FROM + (uniform_paths - ADAPTIVE_FROM) / self.saved()),
                    error,
                };
                Rendering { params: render::Params { samples, target_error: error as f32, ..plain }, expected }
            }
            Goal::Error(_) => {
                let mut counts = count(uniform_paths.ceil())..=ADAPTIVE_FROM as u32;
                uniform(counts.find(|&paths| self.error(paths) <= wanted).unwrap_or(ADAPTIVE_FROM as u32))
            }
            Goal::Seconds(_) => {
                // Candidates are the largest number of paths that the time allows, and the numbers that remain if its
                // lowest bits are cleared: these numbers consist of fewer nets. Use the candidate with the smallest
                // expected error.
                let max_paths = count(uniform_paths);
                let whole = (0..max_paths.ilog2())
                    .map(|bits| max_paths >> bits << bits)
                    .filter(|&paths| paths >= MIN_PATHS as u32);
                let error = |paths: &u32| self.error(*paths);
                let best = whole.min_by(|a, b| error(a).total_cmp(&error(b))).unwrap_or(max_paths);
                let mut plan = uniform(best);
                plan.params.time_budget_ms = overtime(plan.expected);
                plan
            }
        }
    }
}
