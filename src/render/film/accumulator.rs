//! The accumulator of a render in progress: for each pixel, the sums over its paths so far.

use super::camera_rays::CameraRays;
use super::grid::{AREA, Grid};
use super::pass::Pass;
use super::pixel::Pixel;
use super::roulette;
use super::sums::Sums;
use super::tile::{Tile, TileContext};
use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_vec};
use crate::job::Job;
use crate::render::layers::Layers;
use crate::render::params::Params;
use crate::render::world::World;
use crate::scene::Camera;
use glam::DVec3;
use std::sync::atomic::AtomicU64;
use std::time::Instant;

/// The sums over all paths so far, for every pixel of the image.
pub struct Accumulator<'a> {
    pub(super) world: &'a World,
    /// A copy of `world`, in which the paths are traced. After each pass, the copy learns from the traced paths which
    /// lights reach the surfaces in view.
    pub(super) learning: World,
    pub(super) camera_rays: CameraRays,
    pub(super) seed: u64,
    pub(super) grid: Grid,
    /// Pixels tile by tile, [`AREA`] per tile.
    pub(super) pixels: Vec<Pixel>,
    pub(super) layers: Option<Layers<'a>>,
    /// Number of paths dropped because their radiance was not finite.
    pub(super) discarded: AtomicU64,
}

impl<'a> Accumulator<'a> {
    pub fn new(world: &'a World, camera: &'a Camera, params: &'a Params) -> Result<Self> {
        Self::sized(world, camera, params, Grid { width: params.width, height: params.height })
    }

    fn sized(world: &'a World, camera: &'a Camera, params: &'a Params, grid: Grid) -> Result<Self> {
        let pixels = try_vec(grid.tiles() * AREA, Pixel::default())?;
        let layers = Layers::new(world, camera, &params.outputs, grid.tiles(), AREA)?;
        let camera_rays = CameraRays::new(world, camera, params);
        let learning = world.learning()?;
        Ok(Self { world, learning, camera_rays, seed: params.seed, grid, pixels, layers, discarded: AtomicU64::new(0) })
    }

    /// Builds an accumulator for one part of a distributed render. It has the pixels of the part's rectangle, filled
    /// with `sums`, the sums over the part's paths.
    pub fn of_sums(world: &'a World, camera: &'a Camera, params: &'a Params, sums: &Sums, job: Job) -> Result<Self> {
        let part = sums.part();
        let mut accumulator = Self::sized(world, camera, params, Grid { width: part.width, height: part.height })?;
        let Self { grid, pixels, layers, .. } = &mut accumulator;
        let layers = layers.as_ref();
        exec::for_rows(pixels, AREA, job, |tile, pixels| {
            for (i, pixel) in pixels.iter_mut().enumerate() {
                let Some((x, y)) = grid.place(tile, i) else { continue };
                let (light, others) = sums.pixel(part.x + x, part.y + y);
                *pixel = Pixel::of_sums(light, part.samples);
                if let Some(layers) = layers {
                    layers.set_totals(tile, i, others);
                }
            }
        })?;
        accumulator.discarded = AtomicU64::new(sums.discarded());
        Ok(accumulator)
    }

    /// Traces paths until every pixel has the number of paths that `pass` asks for, or until the deadline.
    pub fn extend(&mut self, pass: &Pass, deadline: Option<Instant>, job: Job) -> Result<()> {
        let Self { learning, camera_rays, seed, grid, pixels, layers, discarded, .. } = self;
        let layers = layers.as_ref();
        let median_radiance = roulette::median_radiance(pixels, job.part(0.0, 0.0))?;
        let is_over = || job.is_cancelled() || deadline.is_some_and(|d| Instant::now() >= d);
        let context =
            TileContext { world: learning, camera_rays, seed: *seed, grid: *grid, median_radiance, discarded };
        exec::for_rows(pixels, AREA, job, |tile, pixels| {
            // Skip tiles in which a coarse pass covers no pixel.
            if !pass.skips_tile(grid.corner(tile)) {
                Tile::new(context, tile, pixels, layers).extend(pass, is_over);
            }
        })?;
        if let Some(learned) = self.learning.learned()? {
            self.learning = learned;
        }
        job.check()
    }

    /// Returns the progress of a render after a pass: the mean number of paths per pixel, divided by `samples`.
    pub fn progress(&self, pass: &Pass, samples: u32) -> f64 {
        let paths = |tile| self.grid.area(tile) as f64 * pass.per_pixel(tile);
        let pixels = (self.grid.width * self.grid.height) as f64;
        (0..self.grid.tiles()).map(paths).sum::<f64>() / (pixels * f64::from(samples))
    }

    /// Returns the pixels of a tile that lie within the image.
    pub(super) fn tile(&self, tile: usize) -> impl Iterator<Item = &Pixel> {
        let pixels = self.pixels[tile * AREA..(tile + 1) * AREA].iter().enumerate();
        pixels.filter(move |(i, _)| self.grid.place(tile, *i).is_some()).map(|(_, pixel)| pixel)
    }

    pub(super) fn pixel(&self, x: usize, y: usize) -> &Pixel {
        let (tile, i) = self.grid.locate(x, y);
        &self.pixels[tile * AREA + i]
    }

    /// Returns the pixel whose value the image shows at (`x`, `y`): this pixel itself, if it has paths. Otherwise, the
    /// low bits of `x` and `y` are cleared one by one until (`x`, `y`) is a pixel that has paths: a pixel of a coarse
    /// pass, above or to the left.
    pub(super) fn nearest(&self, x: usize, y: usize) -> (usize, usize) {
        let (mut x, mut y, mut mask) = (x, y, !0);
        while self.pixel(x, y).count() == 0 && (x, y) != (0, 0) {
            mask <<= 1;
            (x, y) = (x & mask, y & mask);
        }
        (x, y)
    }

    /// Returns, for each pixel of the image, the pixel whose value the image shows there ([`Accumulator::nearest`]):
    /// its tile, its index in the tile, and its number of paths.
    pub(super) fn places(&self, job: Job) -> Result<Vec<(u32, u32, u32)>> {
        let mut places = try_vec(self.grid.width * self.grid.height, (0, 0, 0))?;
        exec::for_rows(&mut places, self.grid.width, job, |y, row| {
            for (x, place) in row.iter_mut().enumerate() {
                let (x, y) = self.nearest(x, y);
                let (tile, i) = self.grid.locate(x, y);
                *place = (tile as u32, i as u32, self.pixel(x, y).count());
            }
        })?;
        Ok(places)
    }

    /// Computes an image pixel by pixel, in parallel; `value` writes the channels of a pixel.
    pub(super) fn image(
        &self,
        channels: usize,
        job: Job,
        value: impl Fn(usize, usize, &mut [f32]) + Sync,
    ) -> Result<Image> {
        let mut image = Image::new(self.grid.width, self.grid.height, channels)?;
        exec::for_rows(&mut image.data, self.grid.width * channels, job, |y, row| {
            row.chunks_exact_mut(channels).enumerate().for_each(|(x, out)| value(x, y, out));
        })?;
        Ok(image)
    }

    pub(super) fn variance(&self, job: Job) -> Result<Image> {
        self.image(3, job, |x, y, out| self.pixel(x, y).variance().as_vec3().write_to_slice(out))
    }

    /// Returns two images, each computed from one half of the paths. The two images are equal at pixels that have a
    /// single path.
    pub fn halves(&self, job: Job) -> Result<[Image; 2]> {
        self.pair(job, Pixel::halves)
    }

    /// Returns the variances of the two [`halves`](Self::halves), each computed only from the paths of its half.
    pub fn half_variances(&self, job: Job) -> Result<[Image; 2]> {
        self.pair(job, Pixel::half_variances)
    }

    fn pair(&self, job: Job, values: impl Fn(&Pixel) -> [DVec3; 2] + Sync) -> Result<[Image; 2]> {
        let half = |which: usize| {
            self.image(3, job, |x, y, out| {
                let (x, y) = self.nearest(x, y);
                values(self.pixel(x, y))[which].as_vec3().write_to_slice(out);
            })
        };
        Ok([half(0)?, half(1)?])
    }
}
