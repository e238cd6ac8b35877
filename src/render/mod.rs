//! Rendering: unidirectional path tracing with next-event estimation and multiple importance sampling (Kajiya 1986;
//! Veach 1997), for images and for the irradiance of surfaces ("Lighting Style Transfer", section 7; StyLit, section 3.2).
//!
//! [`World`] makes a scene ready; [`run`] renders a camera's view; [`irradiance`] samples the light that arrives at a point.
//! All estimates are unbiased and nothing is clamped; the same seed gives the same bits on any number of threads.
//!
//! `sampler` numbers → `path` a walk → (`light` one light of all, by way of `emissive` and `environment`; `vertex` what was
//! hit; `bsdf` how it scatters, by way of `ggx`) → a [`PathSink`] → `film` passes, means and variances.
//!
//! Not modelled: volumes, refraction in solids, frosted glass, polarisation, wavelengths, depth of field, motion blur.

mod aov;
mod bsdf;
mod distribution;
mod emissive;
mod environment;
mod facet;
mod film;
mod finish;
mod ggx;
pub mod illuminance;
mod layers;
mod light;
pub mod lpe;
mod path;
mod requirements;
mod sampler;
mod vertex;
mod world;

pub use aov::Aov;
pub use layers::{Layer, Outputs};
pub use requirements::Requirements;
pub use world::World;

use crate::error::{Error, Result, check_range};
use crate::image::{Image, MAX_SIDE};
use crate::job::Job;
use crate::scene::Camera;
use film::Passes;
use glam::{Vec2, Vec3};
use sampler::Sampler;
use std::time::{Duration, Instant};
use vertex::Vertex;

/// Where light of a path comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSource {
    /// An emissive triangle; `uv` are the coordinates its emission texture is looked up with.
    Surface {
        mesh: u32,
        triangle: u32,
        uv: Vec2,
    },
    /// Index into the scene's punctual lights.
    Punctual(u32),
    Environment,
}

/// Takes the contributions of a path: their products sum to the estimate.
pub trait PathSink {
    /// `importance` is all but the emission: throughput, weight and the reciprocal of the probability.
    fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3);
}

/// A point of a surface that gathers light.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    pub mesh: u32,
    pub triangle: u32,
    /// Barycentric coordinates of corners 1 and 2.
    pub barycentric: Vec2,
    /// Whether the side the triangle's winding faces gathers, or the other.
    pub front: bool,
}

/// Adds one sample of the irradiance (lux) at a point to a sink; `sample` counts up, `seed` separates estimates. Samples of
/// one seed are stratified among each other: their mean converges faster than independent ones, best at powers of two.
/// A point that is not on the scene's surfaces, or on a triangle of no area, adds nothing.
pub fn irradiance<S: PathSink>(world: &World, point: &SurfacePoint, seed: u64, sample: u32, sink: &mut S) {
    let mesh = world.scene().meshes.get(point.mesh as usize);
    if mesh.is_some_and(|m| (point.triangle as usize) < m.triangles.len()) {
        let vertex = Vertex::new(world, world.id(point.mesh, point.triangle), point.barycentric);
        if vertex.normal != Vec3::ZERO {
            let observer = &mut path::Contributions(sink);
            path::gather(world, &vertex, point.front, &mut Sampler::new(seed, sample), observer);
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Size of the image in pixels, each in `[1, 65536]`.
    pub width: usize,
    pub height: usize,
    /// Paths per pixel, in `[1, 1 << 20]`.
    pub samples: u32,
    /// Stop when the mean relative standard error falls below this; 0 = never.
    pub target_error: f32,
    /// Stop after this many milliseconds; 0 = never.
    pub time_budget_ms: u32,
    pub seed: u64,
    /// What to render beside the main image.
    pub outputs: Outputs,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            width: 1280,
            height: 720,
            samples: 64,
            target_error: 0.0,
            time_budget_ms: 0,
            seed: 1,
            outputs: Outputs::default(),
        }
    }
}

/// What has been rendered so far; a cancelled render leaves it usable.
#[derive(Clone, Debug)]
pub struct Film {
    /// Mean radiance per pixel, linear RGB in cd/m².
    pub beauty: Image,
    /// Variance of that mean, per channel.
    pub variance: Image,
    /// Paths per pixel so far.
    pub samples: u32,
    /// Mean over the pixels of the standard error relative to the image's mean.
    pub error: f64,
    /// The images beside it: those of expressions in their order, then those of surfaces in theirs.
    pub layers: Vec<Layer>,
}

/// Renders a camera's view; `publish` is called with the film after every pass. Each pass doubles the samples, so that
/// the first image comes soon. To be called on the library's own pool.
///
/// # Errors
/// Parameters out of range, a camera that cannot see, no memory; cancelled, when the film last published stays good.
pub fn run(world: &World, camera: &Camera, params: &Params, job: Job, publish: &mut dyn FnMut(&Film)) -> Result<Film> {
    check(camera, params)?;
    let start = Instant::now();
    let budget = Duration::from_millis(u64::from(params.time_budget_ms));
    let mut passes = Passes::new(world, camera, params)?;
    loop {
        // As many samples as there are, so that every pass is half of the image.
        let done = passes.samples();
        let mut count = done.max(FIRST_PASS).min(params.samples - done);
        if params.time_budget_ms > 0 && done > 0 {
            count = count.min(affordable(start.elapsed(), budget, done));
        }
        let part = |samples: u32| f64::from(samples) / f64::from(params.samples);
        passes.add(count, job.part(part(done), part(done + count)))?;
        let film = passes.film()?;
        publish(&film);
        let out_of_time = params.time_budget_ms > 0 && affordable(start.elapsed(), budget, film.samples) == 0;
        let good_enough = params.target_error > 0.0 && film.error <= f64::from(params.target_error);
        if film.samples >= params.samples || out_of_time || good_enough {
            job.report(1.0);
            return Ok(film);
        }
    }
}

/// Samples per pixel of the first pass.
const FIRST_PASS: u32 = 4;

/// How many more samples the remaining time allows, at the speed so far.
fn affordable(elapsed: Duration, budget: Duration, samples: u32) -> u32 {
    let left = budget.saturating_sub(elapsed).as_secs_f64();
    (left / elapsed.as_secs_f64().max(1e-9) * f64::from(samples)) as u32
}

fn check(camera: &Camera, params: &Params) -> Result<()> {
    check_range("width", params.width, 1, MAX_SIDE)?;
    check_range("height", params.height, 1, MAX_SIDE)?;
    check_range("samples", params.samples, 1, 1 << 20)?;
    check_range("target_error", params.target_error, 0.0, f32::MAX)?;
    let vectors = [camera.position, camera.forward, camera.up];
    let sees = camera.forward.cross(camera.up).length_squared() > 0.0;
    if vectors.iter().any(|v| !v.is_finite()) || !sees || !(camera.fov_y > 0.0 && camera.fov_y < std::f32::consts::PI) {
        return Err(Error::argument(format!(
            "camera {:?} cannot see: its position must be finite, forward and up must not be parallel, and fov_y (now {}) \
             must lie in (0, pi)",
            camera.name, camera.fov_y
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
