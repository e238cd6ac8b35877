//! The image under way: passes of samples, their means and the variance of the whole.
//!
//! Each pass of a pixel is split into batches with scramblings of their own. Within a batch the samples are stratified, the
//! batches are independent; so their scatter gives an unbiased estimate of the variance of the pass, however much
//! stratification helped. Passes are independent too: the mean weighs them by their samples, and so does its variance.

use super::layers::{Layers, Recorder};
use super::path::{self, Contributions};
use super::sampler::Sampler;
use super::world::World;
use super::{Film, LightSource, Params, PathSink};
use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_vec};
use crate::job::{Job, Monitor};
use crate::rng;
use crate::scene::Camera;
use glam::{DVec3, Vec3};

/// Side of a tile in pixels: the unit of work.
const TILE: usize = 32;

#[derive(Clone, Copy, Default)]
struct Pixel {
    /// Sum of all samples.
    sum: DVec3,
    /// Sum over the passes of the variance of their sums.
    variance: DVec3,
}

/// Sums over the passes so far, tile by tile.
pub struct Passes<'a> {
    world: &'a World,
    camera: &'a Camera,
    params: &'a Params,
    tiles_across: usize,
    pixels: Vec<Pixel>,
    layers: Option<Layers<'a>>,
    pass: u32,
    samples: u32,
}

impl<'a> Passes<'a> {
    pub fn new(world: &'a World, camera: &'a Camera, params: &'a Params) -> Result<Self> {
        let (across, down) = (params.width.div_ceil(TILE), params.height.div_ceil(TILE));
        let pixels = try_vec(across * down * TILE * TILE, Pixel::default())?;
        let layers = Layers::new(world, camera, &params.outputs, across * down, TILE * TILE)?;
        Ok(Self { world, camera, params, tiles_across: across, pixels, layers, pass: 0, samples: 0 })
    }

    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Adds `count` samples to every pixel. A cancelled pass leaves sums that must not be used.
    pub fn add(&mut self, count: u32, job: Job) -> Result<()> {
        let (world, camera, params, pass) = (self.world, self.camera, self.params, self.pass);
        let (batches, per_batch) = batches(count);
        let (across, layers) = (self.tiles_across, self.layers.as_ref());
        exec::for_rows(&mut self.pixels, TILE * TILE, job, |tile, pixels| {
            let mut recorder = layers.map(|l| l.recorder(world));
            let (left, top) = (tile % across * TILE, tile / across * TILE);
            for (i, pixel) in pixels.iter_mut().enumerate() {
                let (x, y) = (left + i % TILE, top + i / TILE);
                if x >= params.width || y >= params.height {
                    continue;
                }
                let mut sums = Batches::default();
                for batch in 0..batches {
                    let seed = rng::hash(params.seed, &[x as u64, y as u64, u64::from(pass), u64::from(batch)]);
                    let mut sum = DVec3::ZERO;
                    for index in 0..per_batch {
                        if job.is_cancelled() {
                            return;
                        }
                        let sampler = Sampler::new(seed, index);
                        sum += radiance(world, camera, params, (x, y), sampler, recorder.as_mut()).as_dvec3();
                    }
                    sums.add(sum);
                }
                pixel.sum += sums.sum;
                pixel.variance += sums.variance_of_sum();
                if let (Some(layers), Some(recorder)) = (layers, &mut recorder) {
                    layers.keep(recorder, tile, i);
                }
            }
        })?;
        job.check()?;
        self.pass += 1;
        self.samples += batches * per_batch;
        Ok(())
    }

    /// The image of all passes so far.
    pub fn film(&self) -> Result<Film> {
        let (width, height) = (self.params.width, self.params.height);
        let mut beauty = Image::new(width, height, 3)?;
        let mut variance = Image::new(width, height, 3)?;
        let n = f64::from(self.samples.max(1));
        let (mut total, mut deviation) = (0.0, 0.0);
        for y in 0..height {
            for x in 0..width {
                let tile = y / TILE * self.tiles_across + x / TILE;
                let pixel = &self.pixels[tile * TILE * TILE + y % TILE * TILE + x % TILE];
                let (mean, var) = (pixel.sum / n, pixel.variance / (n * n));
                beauty.pixel_mut(x, y).copy_from_slice(&mean.as_vec3().to_array());
                variance.pixel_mut(x, y).copy_from_slice(&var.as_vec3().to_array());
                total += mean.element_sum() / 3.0;
                deviation += (var.element_sum() / 3.0).sqrt();
            }
        }
        let error = if deviation == 0.0 { 0.0 } else { deviation / total };
        let place = |x: usize, y: usize| (y / TILE * self.tiles_across + x / TILE, y % TILE * TILE + x % TILE, n);
        let always = Monitor::default();
        let layers = self.layers.as_ref().map_or(Ok(Vec::new()), |l| l.images(&beauty, place, always.job()))?;
        Ok(Film { beauty, variance, samples: self.samples, error, layers })
    }
}

/// Into how many batches of how many samples a pass is split: about the square root of each, at least eight batches.
fn batches(count: u32) -> (u32, u32) {
    let root = 1 << (31 - count.max(1).leading_zeros()).div_ceil(2);
    let batches = root.max(8).min(count);
    (batches, count / batches)
}

#[derive(Default)]
struct Batches {
    count: f64,
    sum: DVec3,
    /// Mean of the batches and sum of the squared distances from it (Welford 1962).
    mean: DVec3,
    squares: DVec3,
}

impl Batches {
    fn add(&mut self, batch: DVec3) {
        self.count += 1.0;
        self.sum += batch;
        let before = batch - self.mean;
        self.mean += before / self.count;
        self.squares += before * (batch - self.mean);
    }

    /// Infinite for a single batch: one sample says nothing about its scatter.
    fn variance_of_sum(&self) -> DVec3 {
        if self.count < 2.0 { DVec3::INFINITY } else { self.squares * (self.count / (self.count - 1.0)) }
    }
}

/// One sample of a pixel's radiance; the first block of numbers places it in the pixel (box filter).
fn radiance(
    world: &World,
    camera: &Camera,
    params: &Params,
    (x, y): (usize, usize),
    mut sampler: Sampler,
    recorder: Option<&mut Recorder>,
) -> Vec3 {
    let place = sampler.next();
    let u = ((x as f64 + place.fine(0)) / params.width as f64) as f32;
    let v = ((y as f64 + place.fine(1)) / params.height as f64) as f32;
    let aspect = params.width as f32 / params.height as f32;
    let ray = world.ray(camera.position, camera.direction(u, v, aspect).normalize_or_zero());
    match recorder {
        None => {
            let mut sum = Sum(Vec3::ZERO);
            path::trace(world, ray, &mut sampler, &mut Contributions(&mut sum));
            sum.0
        }
        Some(recorder) => {
            recorder.start();
            path::trace(world, ray, &mut sampler, recorder);
            recorder.finish()
        }
    }
}

/// Adds contributions up.
struct Sum(Vec3);

impl PathSink for Sum {
    fn add(&mut self, _: LightSource, importance: Vec3, emission: Vec3) {
        self.0 += importance * emission;
    }
}
