//! A prepass of a few paths over a scene, for the roulette weights of renders in parts (`roulette`).
//!
//! A render of the whole image takes these weights from its own earlier passes. The parts of a distributed render do
//! not know each other's paths; instead each part traces the same few paths over the image and over each of its tiles,
//! with equal results. These paths have seeds of their own and are not part of the image, so that they bias no
//! estimate. They also learn which lights reach the surfaces in view, for all paths of the part.

use super::block::seed_of;
use super::eye::{Eye, paths};
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

/// Paths of each sampled pixel for the median radiance of the image. [origin not recorded]
const PATHS: u32 = 4;
/// Distance between the sampled pixels of a tile, with one path each. [origin not recorded]
const STEP: usize = 2;
/// Separates the random numbers of the prepass from those of the image.
const SALT: u64 = 0x7375_7276_6579_6564;

pub struct Prepass<'a> {
    world: &'a World,
    eye: &'a Eye,
    params: &'a Params,
    median_radiance: Option<DVec3>,
}

impl<'a> Prepass<'a> {
    pub fn new(world: &'a World, eye: &'a Eye, params: &'a Params, job: Job) -> Result<Self> {
        let mut prepass = Self { world, eye, params, median_radiance: None };
        let stride = coarse_stride(params.width, params.height);
        let across = params.width.div_ceil(stride);
        let means = exec::map(across * params.height.div_ceil(stride), job, |i| {
            prepass.sample_pixel([i % across * stride, i / across * stride], PATHS).mean()
        })?;
        prepass.median_radiance = median(&means);
        Ok(prepass)
    }

    /// The prepass with the world that its first paths have learned, for the paths of its tiles.
    pub fn in_world(self, world: &'a World) -> Self {
        Self { world, ..self }
    }

    /// Median radiance of the sampled pixels, per channel; `None` without pixels.
    pub fn median_radiance(&self) -> Option<DVec3> {
        self.median_radiance
    }

    /// Roulette weight of the tile with this corner.
    pub fn weight(&self, [left, top]: [usize; 2]) -> Option<Vec3> {
        let end = |start: usize, size: usize| (start + TILE).min(size);
        let (right, bottom) = (end(left, self.params.width), end(top, self.params.height));
        let columns = || (left..right).step_by(STEP);
        let pixels = (top..bottom).step_by(STEP).flat_map(|y| columns().map(move |x| [x, y]));
        let pixels: Vec<Pixel> = pixels.map(|at| self.sample_pixel(at, 1)).collect();
        self.median_radiance
            .map(|median_radiance| RouletteWeights::of(&pixels, median_radiance).weight(&Pixel::default()))
    }

    /// Samples `count` paths of a pixel.
    pub fn sample_pixel(&self, at: [usize; 2], count: u32) -> Pixel {
        let length = PathLength { max_bounces: MAX_BOUNCES, roulette_weight: None };
        // Drop paths that are not finite, as in the image, but do not count them.
        let (mut pixel, discarded) = (Pixel::default(), AtomicU64::new(0));
        pixel.extend(count, |replication, indices| {
            let seed = seed_of(self.params.seed ^ SALT, at, replication);
            paths(self.world, self.eye, at, length, (seed, indices), None, &discarded)
        });
        pixel
    }
}
