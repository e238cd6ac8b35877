//! The picture: how long rendering takes for an error, from a few of its tiles.

use super::curve::{Curve, allocate};
use super::{Clock, Expected, Goal, PATIENCE, overtime};
use crate::error::Result;
use crate::job::Job;
use crate::render::pilot::{self, PATHS, REPLICATIONS, nets};
use crate::render::{self, Pilot, World};
use crate::scene::Camera;

/// Least paths of a pixel that state an error.
const FEWEST: f64 = 4.0;
/// Most paths of a pixel.
const MOST: f64 = (1u32 << 20) as f64;
/// Paths of a pixel from which on they go where they are needed, if there is a target.
const EVEN: f64 = 16.0;

/// A rendering as it is to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendering {
    pub params: render::Params,
    pub expected: Expected,
}

/// Plans a rendering: of `params` what is no matter of quality is kept.
///
/// # Errors
/// A goal or a setting out of range, a camera that cannot see; cancelled.
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

/// What a picture takes.
pub(super) struct Picture {
    pixels: f64,
    pilot: Pilot,
}

impl Picture {
    pub fn new(world: &World, camera: &Camera, params: &render::Params, clock: Clock, job: Job) -> Result<Self> {
        let pilot = pilot::run(world, camera, params, clock, job)?;
        Ok(Self { pixels: params.width as f64 * params.height as f64, pilot })
    }

    /// Root mean square of the picture over its mean.
    pub fn contrast(&self) -> f64 {
        self.pilot.contrast
    }

    fn seconds(&self, paths: f64) -> f64 {
        self.pixels * paths * self.pilot.seconds_per_path.max(1e-12)
    }

    /// With as many paths for every pixel. The curve is that of whole nets; other numbers of paths are several, and the
    /// error of each is taken for its own. So more paths may even do worse: a few beside a net bring little but their error.
    fn error(&self, paths: u32) -> f64 {
        let (curve, replications) = (self.curve(), f64::from(REPLICATIONS));
        let square = |points: f64| replications * curve.square(self.seconds(replications * points));
        nets(paths).map(f64::from).map(|points| points * points * square(points)).sum::<f64>().sqrt() / f64::from(paths)
    }

    /// How many times fewer paths reach an error when they may go where they are needed: the ideal is the square of what
    /// tiles that are doubled one by one come to.
    fn saved(&self) -> f64 {
        self.pilot.adaptive_gain.sqrt()
    }

    /// Error against time, with as many paths for every pixel.
    pub fn curve(&self) -> Curve {
        let points = [0, 1, 2].map(|i| [self.seconds(PATHS[i].into()), self.pilot.squared_errors[i]]);
        Curve { least: self.seconds(FEWEST), most: self.seconds(MOST), points }
    }

    /// The settings with which rendering takes so many seconds with as many paths for every pixel, or reaches the error
    /// that they stand for.
    pub fn plan(&self, params: &render::Params, goal: Goal, seconds: f64) -> Rendering {
        let plain = render::Params {
            target_error: 0.0,
            relative_error: 0.0,
            pixel_error: 0.0,
            time_budget_ms: 0,
            ..params.clone()
        };
        let even = seconds / self.seconds(1.0);
        let wanted = self.curve().square(seconds).sqrt();
        let count = |paths: f64| paths.clamp(FEWEST, MOST) as u32;
        let alike = |paths: u32| {
            let expected = Expected { seconds: self.seconds(paths.into()), error: self.error(paths) };
            Rendering { params: render::Params { samples: paths, ..plain.clone() }, expected }
        };
        match goal {
            Goal::Error(_) if even > EVEN => {
                let error = wanted;
                let samples = (PATIENCE * even).min(MOST) as u32;
                let expected = Expected { seconds: self.seconds(EVEN + (even - EVEN) / self.saved()), error };
                Rendering { params: render::Params { samples, target_error: error as f32, ..plain }, expected }
            }
            Goal::Error(_) => {
                let mut counts = count(even.ceil())..=EVEN as u32;
                alike(counts.find(|&paths| self.error(paths) <= wanted).unwrap_or(EVEN as u32))
            }
            Goal::Seconds(_) => {
                // The most that there is time for, or less to whole nets.
                let most = count(even);
                let whole = (0..most.ilog2()).map(|bits| most >> bits << bits).filter(|&paths| paths >= FEWEST as u32);
                let error = |paths: &u32| self.error(*paths);
                let best = whole.min_by(|a, b| error(a).total_cmp(&error(b))).unwrap_or(most);
                let mut plan = alike(best);
                plan.params.time_budget_ms = overtime(plan.expected);
                plan
            }
        }
    }
}
