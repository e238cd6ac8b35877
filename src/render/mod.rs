//! Rendering: unidirectional path tracing with next-event estimation and multiple importance sampling (Kajiya 1986;
//! Veach 1997). It renders images, and estimates the irradiance of surfaces ("Lighting Style Transfer", section 7;
//! StyLit, section 3.2).
//!
//! [`World`] prepares a scene for tracing; [`run`] renders the view of a camera; [`irradiance`] samples the light that
//! arrives at a point. Contributions are not clamped. Estimates are unbiased unless [`run`] has an error target.
//! Results with the same seed are equal bit by bit for any number of threads.
//!
//! A sample passes through these files:
//!
//! - `sampler` draws its random numbers.
//! - `path` traces it: `vertex` describes a hit, `bsdf` and `ggx` scatter, and `light` samples one of the lights from
//!   `emissive` (surfaces and the faces of `luminaires`) and `environment`.
//! - A [`PathSink`] receives its contributions.
//! - `film` keeps means and errors, and decides which pixels get more paths.
//!
//! `vicinity` holds the surfaces around the paths, which suffice for most rays. `shared` lets the paths of neighbouring
//! pixels reuse each other's secondary vertices. `layers` computes further images from the same paths: light path
//! expressions (`lpe`) and surface attributes (`aov`). [`illuminance`] computes grids and surface maps in lux,
//! [`glare`] the unified glare rating of observers, [`gonio`] the luminous intensity distribution of emissive bodies.
//! `denoise` filters noise and states the error that is left.
//!
//! Not modelled: scattering in volumes, frosted panes, polarisation, wavelengths, depth of field, motion blur.
//! [`Requirements::left_out`] lists the frosted panes of a scene, and closed glass without a thickness. In C,
//! `luxfer_scene_get_requirements_text` returns this list.

mod aov;
mod ballot;
mod bounds;
mod bsdf;
mod clear_coat;
mod compiled_material;
mod contribution;
pub mod denoise;
mod dielectric;
mod distribution;
mod emissive;
mod environment;
mod facet;
mod film;
mod ggx;
pub mod glare;
pub mod gonio;
pub mod illuminance;
mod immersion;
mod layers;
mod light;
pub mod lpe;
mod luminaires;
mod measured;
mod medium;
mod output;
mod overview;
mod params;
pub mod parts;
mod path;
mod preview;
mod requirements;
mod sampler;
mod shared;
mod tape;
mod texture_context;
mod vertex;
mod vicinity;
mod world;

pub use aov::Aov;
pub use contribution::{LightSource, PathSink};
pub use film::pilot::{self, Pilot};
pub use layers::{Layer, Outputs};
pub use light::LampVisibility;
pub use output::Film;
pub use overview::overview_camera;
pub use params::Params;
pub use requirements::Requirements;
pub use world::World;

use crate::error::{Error, Result};
use crate::job::{Job, Monitor};
use crate::scene::{Camera, MAX_LIGHT};
use film::{Accumulator, AdaptiveSampler, Clock};
use glam::{Vec2, Vec3};
use params::check_camera;
use sampler::Sampler;
use vertex::Vertex;

/// A surface point at which irradiance is estimated.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    pub mesh: u32,
    pub triangle: u32,
    /// Barycentric coordinates of corners 1 and 2.
    pub barycentric: Vec2,
    /// Whether the point receives light on the front side of the triangle, from which its corners wind
    /// counter-clockwise.
    pub front: bool,
}

/// Adds one sample of the irradiance (lux) at a point to a sink. `sample` is the index of the sample; each `seed`
/// selects an independent sequence of samples. The samples of one seed are stratified: their mean converges faster than
/// the mean of independent samples, and best if their number is a power of two. A point that is not on a surface of the
/// scene, or that lies on a degenerate triangle, adds nothing.
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

/// Adds one sample of the irradiance (lux) at a point in free space, such as a point of a calculation grid. The point
/// receives light on the side of `normal`, a vector of any length. If `normal` is 0 or the position is not finite, adds
/// nothing.
pub fn irradiance_in_air<S: PathSink>(
    world: &World,
    position: Vec3,
    normal: Vec3,
    seed: u64,
    sample: u32,
    sink: &mut S,
) {
    let normal = normal.normalize_or_zero();
    if normal != Vec3::ZERO && position.is_finite() {
        let vertex = Vertex::free(world, world.from_scene(position), normal);
        path::gather(world, &vertex, true, &mut Sampler::new(seed, sample), &mut path::Contributions(sink));
    }
}

/// Renders the view of a camera. Calls `publish` with the film after the first pass, at the end and, without a preview,
/// on cancellation. In between, calls it after a pass if at least ten times the duration of the last publication has
/// passed. Call `run` on the library's own thread pool.
///
/// Without an error target, the estimate of each pixel is unbiased. With a target, earlier paths decide which pixels
/// get further paths; pixels with rare bright paths then come out too dark by a small part of their standard error
/// (see `film::adaptive`).
///
/// # Errors
/// Parameters out of range; a degenerate camera; lights so bright that pixels overflow; no memory; cancelled. After
/// cancellation, the last published film is valid.
pub fn run(world: &World, camera: &Camera, params: &Params, job: Job, publish: &mut dyn FnMut(&Film)) -> Result<Film> {
    params.check()?;
    check_camera(camera)?;
    // Assemble films with a separate job, because they are also needed after cancellation. But do not filter them then:
    // a cancelled job must end soon.
    let always = Monitor::default();
    let mut clock = Clock::start(params.time_budget_ms);
    let guided = preview::guided(params);
    let mut accumulator = Accumulator::new(world, camera, &guided)?;
    let mut sampler = AdaptiveSampler::new(params);
    let mut publish_film = |accumulator: &Accumulator, clock: &mut Clock| {
        clock.publish(|| {
            let mut film = accumulator.film(always.job())?;
            preview::add_preview(&mut film, accumulator, params, job.part(0.0, 0.0))?;
            publish(&film);
            Ok(film)
        })
    };
    let (mut published, mut done) = (None, 0.0);
    while let Some(pass) = sampler.next(&accumulator, &clock, job.part(done, done))? {
        let next = accumulator.progress(&pass, params.samples).clamp(done, 1.0);
        let cut = clock.sample(|deadline| accumulator.extend(&pass, deadline, job.part(done, next)));
        done = next.max(clock.spent());
        job.report(done);
        published = None;
        if clock.is_publish_due() || cut.is_err() {
            published = Some(publish_film(&accumulator, &mut clock)?);
        }
        cut?;
    }
    let film = match published {
        Some(film) => film,
        None => publish_film(&accumulator, &mut clock)?,
    };
    check_finite(&film)?;
    job.report(1.0);
    Ok(film)
}

/// Returns an error if values of the film have overflowed.
fn check_finite(film: &Film) -> Result<()> {
    match film.beauty.count_non_finite() {
        0 => Ok(()),
        n => Err(Error::argument(format!(
            "{n} values of the picture are not finite: a light is too bright for the surfaces near it; lower emission, \
             intensity or illuminance (at most {MAX_LIGHT:e}), or move the light away"
        ))),
    }
}

#[cfg(test)]
mod tests;
