//! Prepass for renders in parts: traces a few paths over the whole image. From these paths, every part computes the
//! same weights for Russian roulette (see `roulette`).
//!
//! A render of the whole image takes these weights from its own earlier passes. The parts of a distributed render do
//! not know each other's paths. Instead, each part traces a few paths over the whole image, and a few paths in each of
//! its own tiles. These paths are the same in every part, so all parts get the same weights. They have their own seeds
//! and are not part of the image, so they bias no estimate. The paths over the whole image also show which lights reach
//! the surfaces in view.

use super::block::seed_of;
use super::camera_rays::{CameraRays, paths};
use super::grid::{TILE, coarse_stride};
use super::pixel::Pixel;
use super::roulette::{RouletteWeights, median};
use crate::error::Result;
use crate::exec;
use crate::job::Job;
use crate::render::params::Params;
use crate::render::path::{MAX_BOUNCES, PathLength};
use crate::render::world::World;
use glam::{DVec3, Vec3};
use std::sync::atomic::AtomicU64;

/// Number of paths through each pixel of a coarse grid, from which the median radiance of the image is estimated. The
/// median serves only roulette, which is unbiased with any weights. [convention]
const PATHS: u32 = 4;
/// For the roulette weight of a tile, one path is traced through every pixel whose column and row are multiples of this
/// stride. Roulette is unbiased with any weights. [convention]
const STEP: usize = 2;
/// Salt of the prepass's seed, so that its random numbers differ from the random numbers of the image.
const SALT: u64 = 0x7375_7276_6579_6564;

pub struct Prepass<'a> {
    world: &'a World,
    camera_rays: &'a CameraRays,
    params: &'a Params,
    median_radiance: Option<DVec3>,
}

impl<'a> Prepass<'a> {
    pub fn new(world: &'a World, camera_rays: &'a CameraRays, params: &'a Params, job: Job) -> Result<Self> {
        let mut prepass = Self { world, camera_rays, params, median_radiance: None };
        let stride = coarse_stride(params.width, params.height);
        let across = params.width.div_ceil(stride);
        let means = exec::map(across * params.height.div_ceil(stride), job, |i| {
            prepass.sample_pixel([i % across * stride, i / across * stride], PATHS).mean()
        })?;
        prepass.median_radiance = median(&means);
        Ok(prepass)
    }

    /// Returns the prepass with `world` in place of its own world. `world` is a copy that has learned, from the paths
    /// of [`Prepass::new`], which lights reach the surfaces in view.
    pub fn with_world(self, world: &'a World) -> Self {
        Self { world, ..self }
    }

    /// Returns the median radiance of the sampled pixels, per channel; `None` without pixels.
    pub fn median_radiance(&self) -> Option<DVec3> {
        self.median_radiance
    }

    /// Traces a few paths through a tile and returns the roulette weight that all its pixels share; `None` if there is
    /// no median radiance. `left` and `top` are the column and the row of the tile's top left pixel.
    pub fn weight(&self, [left, top]: [usize; 2]) -> Option<Vec3> {
        let end = |start: usize, size: usize| (start + TILE).min(size);
        let (right, bottom) = (end(left, self.params.width), end(top, self.params.height));
        let columns = || (left..right).step_by(STEP);
        let pixels = (top..bottom).step_by(STEP).flat_map(|y| columns().map(move |x| [x, y]));
        let pixels: Vec<Pixel> = pixels.map(|at| self.sample_pixel(at, 1)).collect();
        self.median_radiance
            .map(|median_radiance| RouletteWeights::of(&pixels, median_radiance).weight(&Pixel::default()))
    }

    /// Traces `count` paths of a pixel and returns their sums.
    pub fn sample_pixel(&self, at: [usize; 2], count: u32) -> Pixel {
        let length = PathLength { max_bounces: MAX_BOUNCES, roulette_weight: None };
        // Drop paths whose radiance is not finite, as in the image, but do not report their number.
        let (mut pixel, discarded) = (Pixel::default(), AtomicU64::new(0));
        pixel.extend(count, |replication, indices| {
            let seed = seed_of(self.params.seed ^ SALT, at, replication);
            paths(self.world, self.camera_rays, at, length, (seed, indices), None, &discarded)
        });
        pixel
    }
}
