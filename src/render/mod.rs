//! Rendering: unidirectional path tracing with next-event estimation and multiple importance sampling (Kajiya 1986;
//! Veach 1997), for images and for the irradiance of surfaces ("Lighting Style Transfer", section 7; StyLit, section 3.2).
//!
//! [`World`] makes a scene ready; [`run`] renders a camera's view; [`irradiance`] samples the light that arrives at a point.
//! Nothing is clamped; estimates are unbiased unless [`run`] is given a target; the same seed gives the same bits on any
//! number of threads.
//!
//! `sampler` numbers → `path` a walk → (`light` one light of all, by way of `emissive` and `environment`; `vertex` what was
//! hit; `bsdf` how it scatters, by way of `ggx`) → a [`PathSink`] → `film` means, errors, and which pixels get more paths.
//! The paths of neighbouring pixels are `shared`: what one finds behind the first surface is light for all that see it.
//! Beside the image, `layers` makes images of light by the way it came (`lpe`) and of surfaces (`aov`) from the same paths;
//! [`illuminance`] calculates grids and maps of meshes in lux. For previews, `denoise` filters noise out, with a bias.
//!
//! Not modelled: volumes, refraction in solids, frosted glass, polarisation, wavelengths, depth of field, motion blur. Solids of
//! glass and frosted glass in a scene are named by [`Requirements::left_out`], in C by `luxfer_scene_requirements_text`.

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

/// The same at a point that is on no surface, of the light that arrives on the side of a normal of any length but 0: a
/// point of a calculation grid.
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
    /// Paths per pixel, in `[1, 1 << 20]`: of each pixel if there is no target, on the average over the image if there is.
    pub samples: u32,
    /// Stop when the image's [`Film::error`] falls to this, and give paths to where they lower it most; 0 = never.
    pub target_error: f32,
    /// Stop when every part of the image (tiles of 8 × 8 pixels, root mean square) is known to this: half the width of the
    /// interval that holds the luminance of a pixel with a probability of 95 %, relative to that luminance. 0.1 means
    /// "within 10 % of its value, 19 times out of 20". Pixels darker than a tenth of the image's mean luminance need not
    /// be known better than that tenth. A part gets at most 64 times `samples`, though it may miss the target. 0 = never.
    /// With several targets all are reached.
    pub pixel_error: f32,
    /// Stop when the image's [`Film::relative_error`] falls to this, and give paths to where they lower it most; 0 = never.
    pub relative_error: f32,
    /// Stop after this many milliseconds; 0 = never.
    pub time_budget_ms: u32,
    /// End every path where what is left is at most this share of all light that surfaces scatter, in `[0, 1)`
    /// ([`Requirements::bounces`]): the image is too dark by up to that share. 0 = never: paths end by chance alone.
    pub bounce_error: f32,
    /// Strength of the filter that makes [`Film::preview`] (`denoise`), in `[0, 10]`, 1 as a rule; 0 = no preview, for
    /// final images.
    pub preview: f32,
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

/// What has been rendered so far; a render that is cancelled or out of time leaves it usable.
#[derive(Clone, Debug)]
pub struct Film {
    /// Mean radiance per pixel, linear RGB in cd/m². A pixel without paths shows one nearby.
    pub beauty: Image,
    /// Variance of that mean, per channel, each pixel from its own paths; infinite below two paths. See
    /// [`Film::interval`] for what it says about the truth.
    pub variance: Image,
    /// Number of paths of each pixel; one channel.
    pub paths: Image,
    /// Paths per pixel so far, on the average.
    pub samples: u32,
    /// Root mean square over pixels and channels of the standard error, relative to the mean of the image.
    pub error: f64,
    /// The same relative to what each pixel shows, the mean of its channels; one darker than a hundredth of the image's mean
    /// counts as if it were as bright. Of few paths it states rather too much: of 8 about a quarter.
    pub relative_error: f64,
    /// Paths that were left out because their radiance was no finite number.
    pub discarded: u64,
    /// The images beside it: those of expressions in their order, then those of surfaces in theirs.
    pub layers: Vec<Layer>,
    /// The image with its noise filtered out, and how far that has moved it, if asked for. It is not the expected value.
    pub preview: Option<denoise::Output>,
}

impl Film {
    /// A copy, or an error where there is no memory for it.
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

/// Renders a camera's view; `publish` is called with the film after the first pass, and again whenever enough has been
/// added to be worth its time. To be called on the library's own pool.
///
/// Without a target the estimate of each pixel is unbiased. With one, where the next paths go depends on those before, and
/// pixels whose bright paths are rare come out too dark by a small part of their standard error (see `film::adaptive`).
///
/// # Errors
/// Parameters out of range, a camera that cannot see, no memory; cancelled, when the film last published stays good.
pub fn run(world: &World, camera: &Camera, params: &Params, job: Job, publish: &mut dyn FnMut(&Film)) -> Result<Film> {
    params.check()?;
    check_camera(camera)?;
    // The images are made also after a cancel.
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
