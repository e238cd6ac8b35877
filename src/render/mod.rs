//! Rendering: unidirectional path tracing with next-event estimation and multiple importance sampling.

use crate::error::Result;
use crate::image::Image;
use crate::job::Job;
use crate::scene::{Camera, Scene};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// A scene made ready for tracing: acceleration structure and light distributions.
pub struct World {
    scene: Arc<Scene>,
}

impl World {
    pub fn build(scene: Arc<Scene>, _job: Job) -> Result<Self> {
        Ok(Self { scene })
    }

    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }
}

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

/// Adds one sample of the irradiance (lux) at a point to a sink; `sample` counts up, `seed` separates estimates.
pub fn irradiance<S: PathSink>(_world: &World, _point: &SurfacePoint, _seed: u64, _sample: u32, _sink: &mut S) {
    todo!()
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
}

impl Default for Params {
    fn default() -> Self {
        Self { width: 1280, height: 720, samples: 64, target_error: 0.0, time_budget_ms: 0, seed: 1 }
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
}

/// Renders a camera's view; `publish` is called with the film after every pass.
pub fn run(
    _world: &World,
    _camera: &Camera,
    _params: &Params,
    _job: Job,
    _publish: &mut dyn FnMut(&Film),
) -> Result<Film> {
    todo!()
}
