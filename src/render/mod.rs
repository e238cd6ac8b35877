//! Rendering: unidirectional path tracing with next-event estimation and multiple importance sampling (Kajiya 1986;
//! Veach 1997), for images and for the irradiance of surfaces ("Lighting Style Transfer", section 7; StyLit, section
//! 3.2).
//!
//! [`World`] prepares a scene for tracing; [`run`] renders the view of a camera; [`irradiance`] samples the light that
//! arrives at a point. Contributions are not clamped. Estimates are unbiased unless [`run`] has an error target. A seed
//! gives the same bits on any number of threads.
//!
//! A sample passes through these files: `sampler` draws its random numbers → `path` traces it (`vertex` describes a
//! hit, `bsdf` and `ggx` scatter, `light` samples one of the lights of `emissive` and `environment`) → a [`PathSink`]
//! receives its contributions → `film` keeps means and errors and decides which pixels get more paths. `shared` lets
//! the paths of neighbouring pixels reuse each other's secondary vertices. `layers` adds images from the same paths:
//! light path expressions (`lpe`) and surface attributes (`aov`). [`illuminance`] computes grids and maps of meshes in
//! lux. `denoise` filters previews, with a bias.
//!
//! Not modelled: volumes, refraction in solids, frosted glass, polarisation, wavelengths, depth of field, motion blur.
//! [`Requirements::left_out`] names the solids of glass and the frosted glass of a scene, as does
//! `luxfer_scene_requirements_text` in C.

mod aov;
mod ballot;
mod bsdf;
mod compiled_material;
pub mod denoise;
mod distribution;
mod emissive;
mod environment;
mod facet;
mod film;
mod ggx;
pub mod illuminance;
mod layers;
mod light;
pub mod lpe;
pub mod parts;
mod path;
mod preview;
mod requirements;
mod sampler;
mod shared;
mod tape;
mod vertex;
mod world;

pub use aov::Aov;
pub use film::pilot::{self, Pilot};
pub use layers::{Layer, Outputs};
pub use requirements::Requirements;
pub use world::World;

use crate::error::{Error, Result, check_range};
use crate::image::{Image, MAX_SIDE};
use crate::job::{Job, Monitor};
use crate::scene::Camera;
use film::{AdaptiveSampler, Canvas, Clock};
use glam::{Vec2, Vec3};
use sampler::Sampler;
use vertex::Vertex;

/// The light that a path contribution comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSource {
    /// An emissive triangle; `uv` are the coordinates of the look-up in its emission texture.
    Surface {
        mesh: u32,
        triangle: u32,
        uv: Vec2,
    },
    /// Index of a punctual light of the scene.
    Punctual(u32),
    Environment,
}

/// Receives the contributions of a path; the sum of their products `importance * emission` is the estimate.
pub trait PathSink {
    /// `importance` is every factor but the emission: throughput × mis_weight / pdf.
    fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3);
}

/// A point of a surface at which irradiance is estimated.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    pub mesh: u32,
    pub triangle: u32,
    /// Barycentric coordinates of corners 1 and 2.
    pub barycentric: Vec2,
    /// Whether the point gathers on the front side, which the winding of the triangle faces.
    pub front: bool,
}

/// Adds one sample of the irradiance (lux) at a point to a sink. `sample` is the index of the sample and `seed` selects
/// an independent sequence. The samples of one seed are stratified: their mean converges faster than that of
/// independent samples, best at powers of two. A point outside the scene's surfaces or on a degenerate triangle adds
/// nothing.
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

/// Adds one sample of the irradiance at a free point in space, such as a point of a calculation grid, on the side of a
/// non-zero normal of any length.
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
        let vertex = Vertex::free(world, position, normal);
        path::gather(world, &vertex, true, &mut Sampler::new(seed, sample), &mut path::Contributions(sink));
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Size of the image in pixels, each in `[1, 65536]`.
    pub width: usize,
    pub height: usize,
    /// Paths per pixel, in `[1, 1 << 20]`: for each pixel without an error target, the mean over the image with one.
    pub samples: u32,
    /// Stop when [`Film::error`] falls to this value, with paths allocated to minimise it; 0 = never.
    pub target_error: f32,
    /// Stop when each tile of 8 × 8 pixels reaches this error: the root mean square over its pixels of the half-width
    /// of the 95 % interval of the luminance, relative to that luminance. 0.1 means "within 10 % of the value, 19 times
    /// out of 20". Pixels darker than a tenth of the image's mean luminance are measured against that tenth. A tile
    /// gets at most 64 times `samples` paths per pixel, though it may miss the target. 0 = never. If several targets
    /// are set, all of them are met.
    pub pixel_error: f32,
    /// Stop when [`Film::relative_error`] falls to this value, with paths allocated to minimise it; 0 = never.
    pub relative_error: f32,
    /// Stop after this many milliseconds; 0 = never.
    pub time_budget_ms: u32,
    /// End every path when its remaining bounces carry at most this share of all scattered light, in `[0, 1)`
    /// ([`Requirements::bounces`]); the image is too dark by up to that share. 0 = never: only Russian roulette ends
    /// paths.
    pub bounce_error: f32,
    /// Strength of the filter that makes [`Film::preview`] (`denoise`), in `[0, 10]`, usually 1; 0 = no preview, for
    /// final images.
    pub preview: f32,
    pub seed: u64,
    /// Images to render beside the main image.
    pub outputs: Outputs,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            width: 1280,
            height: 720,
            samples: 64,
            target_error: 0.0,
            pixel_error: 0.0,
            relative_error: 0.0,
            time_budget_ms: 0,
            bounce_error: 0.0,
            preview: 0.0,
            seed: 1,
            outputs: Outputs::default(),
        }
    }
}

impl Params {
    /// Checks that every setting is in its range.
    pub fn check(&self) -> Result<()> {
        check_range("width", self.width, 1, MAX_SIDE)?;
        check_range("height", self.height, 1, MAX_SIDE)?;
        check_range("samples", self.samples, 1, 1 << 20)?;
        check_range("target_error", self.target_error, 0.0, f32::MAX)?;
        check_range("pixel_error", self.pixel_error, 0.0, f32::MAX)?;
        check_range("relative_error", self.relative_error, 0.0, f32::MAX)?;
        check_range("bounce_error", self.bounce_error, 0.0, 1.0f32.next_down())?;
        check_range("preview", self.preview, 0.0, 10.0)?;
        Ok(())
    }
}

/// The image rendered so far; it stays usable after a cancel or at the end of the time budget.
#[derive(Clone, Debug)]
pub struct Film {
    /// Mean radiance per pixel, linear RGB in cd/m². A pixel without paths shows a nearby pixel.
    pub beauty: Image,
    /// Variance of that mean per channel, each pixel from its own paths; infinite below two paths. [`Film::interval`]
    /// derives confidence intervals from it.
    pub variance: Image,
    /// Number of paths of each pixel; one channel.
    pub paths: Image,
    /// Mean number of paths per pixel so far.
    pub samples: u32,
    /// Root mean square over pixels and channels of the standard error, relative to the mean of the image.
    pub error: f64,
    /// Root mean square of the standard error relative to the radiance of each pixel (mean of its channels, at least a
    /// hundredth of the image's mean). With few paths it overestimates: with 8 paths by about a quarter.
    pub relative_error: f64,
    /// Number of paths dropped because their radiance was not finite.
    pub discarded: u64,
    /// The additional images: those of expressions in order, then the AOVs in order.
    pub layers: Vec<Layer>,
    /// The filtered image and an estimate of its bias, if requested. It is not an unbiased estimate.
    pub preview: Option<denoise::Output>,
}

impl Film {
    /// Clones the film, or returns an error if there is no memory for the copy.
    pub fn try_clone(&self) -> Result<Self> {
        let layer = |l: &Layer| {
            Ok(Layer { image: l.image.try_clone()?, name: l.name.clone(), expression: l.expression.clone(), ..*l })
        };
        let preview = |p: &denoise::Output| Ok(denoise::Output { image: p.image.try_clone()?, ..*p });
        Ok(Self {
            beauty: self.beauty.try_clone()?,
            variance: self.variance.try_clone()?,
            paths: self.paths.try_clone()?,
            layers: self.layers.iter().map(layer).collect::<Result<_>>()?,
            preview: self.preview.as_ref().map(preview).transpose()?,
            ..*self
        })
    }
}

/// Renders the view of a camera. Calls `publish` with the film after the first pass, and again whenever a new film is
/// worth the time that publishing takes. Call it on the library's own thread pool.
///
/// Without an error target the estimate of each pixel is unbiased. With a target, the paths so far decide where the
/// next ones go, and pixels with rare bright paths come out too dark by a small part of their standard error (see
/// `film::adaptive`).
///
/// # Errors
/// Parameters out of range; a degenerate camera; no memory; cancelled. After a cancel the last published film is valid.
pub fn run(world: &World, camera: &Camera, params: &Params, job: Job, publish: &mut dyn FnMut(&Film)) -> Result<Film> {
    params.check()?;
    check_camera(camera)?;
    // Assemble images with a job of their own: they are also needed after a cancel.
    let always = Monitor::default();
    let mut clock = Clock::start(params.time_budget_ms);
    let guided = preview::guided(params);
    let mut canvas = Canvas::new(world, camera, &guided)?;
    let mut plan = AdaptiveSampler::new(params);
    let mut publish_film = |canvas: &Canvas, clock: &mut Clock| {
        clock.publish(|| {
            let mut film = canvas.film(always.job())?;
            preview::add_preview(&mut film, canvas, params, always.job())?;
            publish(&film);
            Ok(film)
        })
    };
    let (mut published, mut done) = (None, 0.0);
    while let Some(pass) = plan.next(&canvas, &clock, job.part(done, done))? {
        let next = canvas.progress(&pass, params.samples).clamp(done, 1.0);
        let cut = clock.sample(|deadline| canvas.extend(&pass, deadline, job.part(done, next)));
        done = next.max(clock.spent());
        job.report(done);
        published = None;
        if clock.is_publish_due() || cut.is_err() {
            published = Some(publish_film(&canvas, &mut clock)?);
        }
        cut?;
    }
    let film = match published {
        Some(film) => film,
        None => publish_film(&canvas, &mut clock)?,
    };
    job.report(1.0);
    Ok(film)
}

fn check_camera(camera: &Camera) -> Result<()> {
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
