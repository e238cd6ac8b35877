//! Camera paths: generates the rays of a pixel and traces the radiance along them.

use crate::render::immersion::media_at;
use crate::render::layers::Recorder;
use crate::render::medium::Media;
use crate::render::params::Params;
use crate::render::path::{self, PathLength};
use crate::render::sampler::Sampler;
use crate::render::shared::Start;
use crate::render::tape::SumTape;
use crate::render::world::World;
use crate::scene::Camera;
use glam::{DVec3, Vec3};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// Traces some paths through the pixel `at` and returns the sum of their radiance. Path i is sampled by point i of the
/// point sequence with seed `seed`; `indices` are the indices i of the paths. Paths whose radiance is not finite are
/// dropped and counted in `discarded`. All callers use this one function, so that the path tracer, which is inlined
/// into it, is compiled only once.
pub fn paths(
    world: &World,
    camera_rays: &CameraRays,
    at: [usize; 2],
    length: PathLength,
    (seed, indices): (u64, Range<u32>),
    mut recorder: Option<&mut Recorder>,
    discarded: &AtomicU64,
) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for index in indices {
        let radiance = radiance(world, camera_rays, at, length, Sampler::new(seed, index), recorder.as_deref_mut());
        if radiance.is_finite() {
            sum += radiance.as_dvec3();
        } else {
            discarded.fetch_add(1, Ordering::Relaxed);
        }
    }
    sum
}

/// Traces one path and returns its radiance.
fn radiance(
    world: &World,
    camera_rays: &CameraRays,
    at: [usize; 2],
    length: PathLength,
    sampler: Sampler,
    recorder: Option<&mut Recorder>,
) -> Vec3 {
    let Start { ray, media, light_u, length, mut sampler } = camera_rays.start(world, at, length, sampler);
    match recorder {
        None => {
            let mut sum = SumTape::default();
            path::trace(world, ray, media, light_u, length, &mut sampler, &mut sum);
            sum.0
        }
        Some(recorder) => {
            recorder.start();
            path::trace(world, ray, media, light_u, length, &mut sampler, recorder);
            recorder.end_path()
        }
    }
}

/// A camera prepared for path tracing. The direction through the image point (x, y), in pixels, is `corner` + x
/// `right` + y `down` before normalisation.
pub struct CameraRays {
    position: Vec3,
    /// The media around the camera.
    media: Media,
    corner: Vec3,
    right: Vec3,
    down: Vec3,
}

impl CameraRays {
    pub fn new(world: &World, camera: &Camera, params: &Params) -> Self {
        let aspect = params.width as f32 / params.height as f32;
        let at = |x: f32, y: f32| camera.direction(x, y, aspect);
        let corner = at(0.0, 0.0);
        let right = (at(1.0, 0.0) - corner) / params.width as f32;
        let down = (at(0.0, 1.0) - corner) / params.height as f32;
        let media = media_at(world, world.from_scene(camera.position));
        Self { position: camera.position, media, corner, right, down }
    }

    /// Starts a path through the pixel `at`. Its first random numbers select the point in the pixel (box filter) and
    /// the light sample at the primary vertex.
    pub fn start(&self, world: &World, at: [usize; 2], length: PathLength, mut sampler: Sampler) -> Start {
        let place = sampler.next();
        let direction = self.direction(at[0] as f64 + place.fine(0), at[1] as f64 + place.fine(1));
        let light_u = (place.fine(2), place.get(3));
        Start { ray: world.ray(self.position, direction), media: self.media, light_u, length, sampler }
    }

    /// Returns the unit direction through a point of the image, given in pixels.
    fn direction(&self, x: f64, y: f64) -> Vec3 {
        (self.corner + self.right * x as f32 + self.down * y as f32).normalize_or_zero()
    }
}
