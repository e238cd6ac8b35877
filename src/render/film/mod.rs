//! The film: sums of the paths of each pixel, their means and their errors.
//!
//! `tile` traces the paths of a tile, `block` those of pixels that share secondary vertices; `pixel` holds the sums of
//! a pixel. Between passes, `adaptive` allocates the next paths, and `roulette` sets the weights for Russian roulette.
//! `interval` gives confidence intervals. A pass extends the paths of each pixel up to a count, so that an interrupted
//! pass leaves a valid image with fewer paths in some pixels. The counts follow from the pixels of the pass before:
//! they are the same for any number of threads.
//!
//! For renders in parts, `sums` adds up the paths of some pixels independently of all others, with roulette weights
//! from a `prepass` instead of previous passes. `pilot` predicts the cost and the error of an image from a few of its
//! tiles, which it selects by their `tile_moments`.

mod adaptive;
mod block;
mod clock;
mod grid;
mod interval;
pub mod pilot;
mod pixel;
mod prepass;
mod roulette;
mod sums;
mod tile;
mod tile_moments;

pub use adaptive::{AdaptiveSampler, Pass};
pub use clock::Clock;
pub use grid::TILE;
pub use interval::pooled;
pub use sums::Sums;

use super::layers::{Layers, Recorder};
use super::output::Film;
use super::params::Params;
use super::path::{self, MAX_BOUNCES, PathLength};
use super::sampler::Sampler;
use super::shared::Start;
use super::tape::Sum;
use super::world::World;
use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_vec};
use crate::job::Job;
use crate::scene::Camera;
use glam::{DVec3, Vec3};
use grid::{AREA, Grid};
use pixel::Pixel;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use tile::{Tile, TileContext};

/// The sums of all paths so far.
pub struct Canvas<'a> {
    world: &'a World,
    eye: Eye,
    seed: u64,
    grid: Grid,
    /// Pixels in the order of tiles.
    pixels: Vec<Pixel>,
    layers: Option<Layers<'a>>,
    /// Number of paths dropped because their radiance was not finite.
    discarded: AtomicU64,
}

impl<'a> Canvas<'a> {
    pub fn new(world: &'a World, camera: &'a Camera, params: &'a Params) -> Result<Self> {
        Self::sized(world, camera, params, Grid { width: params.width, height: params.height })
    }

    fn sized(world: &'a World, camera: &'a Camera, params: &'a Params, grid: Grid) -> Result<Self> {
        let pixels = try_vec(grid.tiles() * AREA, Pixel::default())?;
        let layers = Layers::new(world, camera, &params.outputs, grid.tiles(), AREA)?;
        let eye = Eye::new(world, camera, params);
        Ok(Self { world, eye, seed: params.seed, grid, pixels, layers, discarded: AtomicU64::new(0) })
    }

    /// A canvas of the pixels of given sums alone.
    pub fn of_sums(world: &'a World, camera: &'a Camera, params: &'a Params, sums: &Sums, job: Job) -> Result<Self> {
        let part = sums.part();
        let mut canvas = Self::sized(world, camera, params, Grid { width: part.width, height: part.height })?;
        let Self { grid, pixels, layers, .. } = &mut canvas;
        let layers = layers.as_ref();
        exec::for_rows(pixels, AREA, job, |tile, pixels| {
            for (i, pixel) in pixels.iter_mut().enumerate() {
                let Some((x, y)) = grid.place(tile, i) else { continue };
                let (light, others) = sums.pixel(part.x + x, part.y + y);
                *pixel = Pixel::of_sums(light, part.samples);
                if let Some(layers) = layers {
                    layers.keep_sums(tile, i, others);
                }
            }
        })?;
        canvas.discarded = AtomicU64::new(sums.discarded());
        Ok(canvas)
    }

    /// Extends the paths of every pixel to the counts of a pass; stops at the deadline.
    pub fn extend(&mut self, pass: &Pass, deadline: Option<Instant>, job: Job) -> Result<()> {
        let Self { world, eye, seed, grid, pixels, layers, discarded } = self;
        let layers = layers.as_ref();
        let median_radiance = roulette::median_radiance(pixels, job.part(0.0, 0.0))?;
        let is_over = || job.is_cancelled() || deadline.is_some_and(|d| Instant::now() >= d);
        let context = TileContext { world, eye, seed: *seed, grid: *grid, median_radiance, discarded };
        exec::for_rows(pixels, AREA, job, |tile, pixels| {
            // Skip tiles without pixels of a coarse pass.
            if !pass.passes_over(grid.corner(tile)) {
                Tile::new(context, tile, pixels, layers).extend(pass, is_over);
            }
        })?;
        job.check()
    }

    /// Mean number of paths per pixel after a pass, relative to `samples`.
    pub fn progress(&self, pass: &Pass, samples: u32) -> f64 {
        let paths = |tile| self.grid.area(tile) as f64 * pass.per_pixel(tile);
        let pixels = (self.grid.width * self.grid.height) as f64;
        (0..self.grid.tiles()).map(paths).sum::<f64>() / (pixels * f64::from(samples))
    }

    /// The pixels of a tile that lie within the image.
    fn tile(&self, tile: usize) -> impl Iterator<Item = &Pixel> {
        let pixels = self.pixels[tile * AREA..(tile + 1) * AREA].iter().enumerate();
        pixels.filter(move |(i, _)| self.grid.place(tile, *i).is_some()).map(|(_, pixel)| pixel)
    }

    fn pixel(&self, x: usize, y: usize) -> &Pixel {
        let (tile, i) = self.grid.locate(x, y);
        &self.pixels[tile * AREA + i]
    }

    /// The pixel itself, or, if it has no paths yet, the nearest pixel of a coarser pass.
    fn nearest(&self, x: usize, y: usize) -> (usize, usize) {
        let (mut x, mut y, mut mask) = (x, y, !0);
        while self.pixel(x, y).count() == 0 && (x, y) != (0, 0) {
            mask <<= 1;
            (x, y) = (x & mask, y & mask);
        }
        (x, y)
    }

    /// For each pixel of the image, the displayed pixel: its tile, its index in the tile, and its number of paths.
    fn places(&self, job: Job) -> Result<Vec<(u32, u32, u32)>> {
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

    /// An image computed pixel by pixel.
    fn image(&self, channels: usize, job: Job, value: impl Fn(usize, usize, &mut [f32]) + Sync) -> Result<Image> {
        let mut image = Image::new(self.grid.width, self.grid.height, channels)?;
        exec::for_rows(&mut image.data, self.grid.width * channels, job, |y, row| {
            row.chunks_exact_mut(channels).enumerate().for_each(|(x, out)| value(x, y, out));
        })?;
        Ok(image)
    }

    fn variance(&self, job: Job) -> Result<Image> {
        self.image(3, job, |x, y, out| self.pixel(x, y).variance().as_vec3().write_to_slice(out))
    }

    /// Images of two halves of the paths; equal for pixels of a single path.
    pub fn halves(&self, job: Job) -> Result<[Image; 2]> {
        let half = |which: usize| {
            self.image(3, job, |x, y, out| {
                let (x, y) = self.nearest(x, y);
                self.pixel(x, y).halves()[which].as_vec3().write_to_slice(out);
            })
        };
        Ok([half(0)?, half(1)?])
    }

    /// The image of all paths so far.
    pub fn film(&self, job: Job) -> Result<Film> {
        let beauty = self.image(3, job, |x, y, out| {
            let (x, y) = self.nearest(x, y);
            self.pixel(x, y).mean().as_vec3().write_to_slice(out);
        })?;
        let paths = self.image(1, job, |x, y, out| out[0] = self.pixel(x, y).count() as f32)?;
        let layers = self.layers.as_ref().map_or(Ok(Vec::new()), |l| l.images(&beauty, &self.places(job)?, job))?;
        let total = self.total(job)?;
        Ok(Film {
            beauty,
            layers,
            variance: self.variance(job)?,
            paths,
            samples: (total.paths / (self.grid.width * self.grid.height) as u64) as u32,
            error: total.error(),
            relative_error: self.relative_total(job)?.error(),
            discarded: self.discarded.load(Ordering::Relaxed),
            preview: None,
        })
    }
}

/// Sum of the radiance of some paths of a pixel. All callers use this one function, so that the inlined path tracer is
/// compiled once.
fn paths(
    world: &World,
    eye: &Eye,
    at: [usize; 2],
    length: PathLength,
    (seed, indices): (u64, Range<u32>),
    mut recorder: Option<&mut Recorder>,
    discarded: &AtomicU64,
) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for index in indices {
        let radiance = radiance(world, eye, at, length, Sampler::new(seed, index), recorder.as_deref_mut());
        if radiance.is_finite() {
            sum += radiance.as_dvec3();
        } else {
            discarded.fetch_add(1, Ordering::Relaxed);
        }
    }
    sum
}

/// One sample of a pixel's radiance.
fn radiance(
    world: &World,
    eye: &Eye,
    at: [usize; 2],
    length: PathLength,
    sampler: Sampler,
    recorder: Option<&mut Recorder>,
) -> Vec3 {
    let Start { ray, light_u, length, mut sampler } = eye.start(world, at, length, sampler);
    match recorder {
        None => {
            let mut sum = Sum::default();
            path::trace(world, ray, light_u, length, &mut sampler, &mut sum);
            sum.0
        }
        Some(recorder) => {
            recorder.start();
            path::trace(world, ray, light_u, length, &mut sampler, recorder);
            recorder.end_path()
        }
    }
}

/// A camera prepared for tracing: the direction through a pixel is linear in its coordinates.
struct Eye {
    position: Vec3,
    corner: Vec3,
    right: Vec3,
    down: Vec3,
    /// Largest number of bounces of a path.
    max_bounces: u32,
}

impl Eye {
    fn new(world: &World, camera: &Camera, params: &Params) -> Self {
        let max_bounces = world.requirements().bounces(params.bounce_error).unwrap_or(MAX_BOUNCES).min(MAX_BOUNCES);
        let aspect = params.width as f32 / params.height as f32;
        let at = |x: f32, y: f32| camera.direction(x, y, aspect);
        let corner = at(0.0, 0.0);
        let right = (at(1.0, 0.0) - corner) / params.width as f32;
        let down = (at(0.0, 1.0) - corner) / params.height as f32;
        Self { position: camera.position, corner, right, down, max_bounces }
    }

    /// Starts a path: the first block of random numbers selects the point in the pixel (box filter) and the light
    /// sample at the primary vertex.
    fn start(&self, world: &World, at: [usize; 2], length: PathLength, mut sampler: Sampler) -> Start {
        let place = sampler.next();
        let direction = self.direction(at[0] as f64 + place.fine(0), at[1] as f64 + place.fine(1));
        Start { ray: world.ray(self.position, direction), light_u: (place.fine(2), place.get(3)), length, sampler }
    }

    /// The unit direction through a point of the image, in pixels.
    fn direction(&self, x: f64, y: f64) -> Vec3 {
        (self.corner + self.right * x as f32 + self.down * y as f32).normalize_or_zero()
    }
}
