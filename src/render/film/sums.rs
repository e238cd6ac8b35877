//! The sums of one part of a render. A part is a rectangle of the image and a range of its pixels' paths. The sums of
//! all parts together give the image.
//!
//! The path with a given index in a pixel is the same in every part, because every part samples it with the same point
//! of the same point sequence. The sums are in f64, so that the f32 image hardly ever depends on how the paths are
//! divided into parts, or on the order in which the sums are added.

use super::block::{BlockPixel, BlockTracer, blocks};
use super::camera_rays::CameraRays;
use super::grid::{AREA, Grid, TILE};
use super::part::Part;
use super::pixel::{REPLICATIONS, paths_of_replication};
use super::prepass::Prepass;
use crate::error::Result;
use crate::exec;
use crate::image::try_vec;
use crate::job::Job;
use crate::render::layers::Layers;
use crate::render::params::Params;
use crate::render::path::{MAX_BOUNCES, PathLength};
use crate::render::world::World;
use crate::scene::Camera;
use glam::DVec3;
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of radiance sums of a pixel: one for each channel of each replication.
const LIGHT: usize = 3 * REPLICATIONS as usize;
/// Number of paths of a replication (point sequence) between two checks for cancellation. [convention]
const SLICE: u32 = 16;

/// The sums of a part, for each of its pixels.
pub struct Sums {
    part: Part,
    /// Column and row, in the image, of the first pixel of `grid`. This is the corner of the tile that contains the
    /// first pixel of the part.
    corner: [usize; 2],
    grid: Grid,
    /// How many numbers are stored per pixel: radiance sums, then the sums of the layers.
    numbers_per_pixel: usize,
    /// The sums of all pixels in `grid`, tile by tile, `numbers_per_pixel` numbers for each pixel.
    numbers: Vec<f64>,
    /// Number of paths dropped because their radiance was not finite.
    discarded: u64,
}

impl Sums {
    /// Creates the sums of a part, all 0.
    pub fn new(part: &Part, layers: Option<&Layers>) -> Result<Self> {
        let corner = [part.x / TILE * TILE, part.y / TILE * TILE];
        let grid = Grid { width: part.x + part.width - corner[0], height: part.y + part.height - corner[1] };
        let numbers_per_pixel = LIGHT + layers.map_or(0, Layers::sum_count);
        let numbers = try_vec(grid.tiles() * AREA * numbers_per_pixel, 0.0)?;
        Ok(Self { part: *part, corner, grid, numbers_per_pixel, numbers, discarded: 0 })
    }

    /// Traces the paths of a part and returns their sums.
    pub fn trace(world: &World, camera: &Camera, params: &Params, part: &Part, job: Job) -> Result<Self> {
        let layers = Layers::new(world, camera, &params.outputs, 0, AREA)?;
        let mut sums = Self::new(part, layers.as_ref())?;
        let camera_rays = CameraRays::new(world, camera, params);
        let learning = world.learning()?;
        let prepass = Prepass::new(&learning, &camera_rays, params, job.part(0.0, 0.01))?;
        let world = &learning.settled()?;
        let prepass = prepass.with_world(world);
        let discarded = AtomicU64::new(0);
        let Self { corner, grid, numbers_per_pixel, numbers, .. } = &mut sums;
        exec::for_rows(numbers, AREA * *numbers_per_pixel, job.part(0.01, 1.0), |tile, numbers| {
            let (left, top) = grid.corner(tile);
            let tile_corner = [corner[0] + left, corner[1] + top];
            let length = PathLength { max_bounces: MAX_BOUNCES, roulette_weight: prepass.weight(tile_corner) };
            let mut tracer = BlockTracer::new(layers.as_ref());
            // The paths of a block share secondary vertices, so the pixels of the block outside this part are traced
            // too. The layers of these pixels go into this buffer, which is never read.
            let mut ignored_layer_sums = vec![0.0; *numbers_per_pixel - LIGHT];
            for replication in 0..REPLICATIONS {
                for block in blocks(replication) {
                    let members = members_in_image(&block, tile_corner, length, params, replication);
                    if !members.iter().any(|m| part.has(m.at)) {
                        continue;
                    }
                    for index in paths_of_replication(part.first, replication)
                        ..paths_of_replication(part.first + part.samples, replication)
                    {
                        if index % SLICE == 0 && job.is_cancelled() {
                            return;
                        }
                        let discard = |member: usize| {
                            if part.has(members[member].at) {
                                discarded.fetch_add(1, Ordering::Relaxed);
                            }
                        };
                        let sums = tracer.paths(world, &camera_rays, &members, index..index + 1, discard);
                        for (k, (member, sum)) in members.iter().zip(sums).enumerate() {
                            let numbers = &mut numbers[member.pixel * *numbers_per_pixel..][..*numbers_per_pixel];
                            let (light, layer_sums) = numbers.split_at_mut(LIGHT);
                            let is_wanted = part.has(member.at);
                            if let Some(recorders) = tracer.recorders() {
                                recorders[k].add_to(if is_wanted { layer_sums } else { &mut ignored_layer_sums });
                            }
                            if is_wanted {
                                let light = &mut light[3 * replication as usize..][..3];
                                (DVec3::from_slice(light) + sum).write_to_slice(light);
                            }
                        }
                    }
                }
            }
        })?;
        job.check()?;
        sums.discarded = discarded.into_inner();
        Ok(sums)
    }

    /// Adds the sums of `other`, whose part lies within the part of `self`.
    pub fn join(&mut self, other: &Self, layers: Option<&Layers>, job: Job) -> Result<()> {
        let Self { corner, grid, numbers_per_pixel, numbers, .. } = self;
        exec::for_rows(numbers, AREA * *numbers_per_pixel, job, |tile, numbers| {
            let (left, top) = grid.corner(tile);
            for (i, numbers) in numbers.chunks_exact_mut(*numbers_per_pixel).enumerate() {
                let at = [corner[0] + left + i % TILE, corner[1] + top + i / TILE];
                if other.part.has(at) {
                    let (light, layer_sums) = numbers.split_at_mut(LIGHT);
                    let (other_light, other_layer_sums) = other.numbers(at).split_at(LIGHT);
                    light.iter_mut().zip(other_light).for_each(|(sum, other)| *sum += other);
                    if let Some(layers) = layers {
                        layers.join_sums(layer_sums, other_layer_sums);
                    }
                }
            }
        })?;
        self.discarded += other.discarded;
        Ok(())
    }

    pub fn part(&self) -> &Part {
        &self.part
    }

    pub fn discarded(&self) -> u64 {
        self.discarded
    }

    pub fn set_discarded(&mut self, discarded: u64) {
        self.discarded = discarded;
    }

    /// Returns how many numbers are stored per pixel.
    pub fn numbers_per_pixel(&self) -> usize {
        self.numbers_per_pixel
    }

    /// Returns the radiance sum of each replication (point sequence), and the sums of the layers. The list of
    /// replications begins with the replication that contains the part's first path, as `Pixel::of_sums` expects.
    pub fn pixel(&self, x: usize, y: usize) -> ([DVec3; REPLICATIONS as usize], &[f64]) {
        let (light, layer_sums) = self.numbers([x, y]).split_at(LIGHT);
        let first = self.part.first as usize;
        (std::array::from_fn(|i| DVec3::from_slice(&light[3 * ((first + i) % REPLICATIONS as usize)..])), layer_sums)
    }

    /// Returns all sums of a pixel of the part: radiance, then layers.
    pub fn numbers(&self, at: [usize; 2]) -> &[f64] {
        &self.numbers[self.place(at)..][..self.numbers_per_pixel]
    }

    pub fn numbers_mut(&mut self, at: [usize; 2]) -> &mut [f64] {
        let place = self.place(at);
        &mut self.numbers[place..][..self.numbers_per_pixel]
    }

    fn place(&self, [x, y]: [usize; 2]) -> usize {
        let (tile, i) = self.grid.locate(x - self.corner[0], y - self.corner[1]);
        (tile * AREA + i) * self.numbers_per_pixel
    }
}

/// Returns the pixels of a block that lie in the image, for the paths of one replication (point sequence). `block`
/// holds the indices of the pixels in their tile, and `tile_corner` is the column and row of the tile's first pixel.
fn members_in_image(
    block: &[usize],
    tile_corner: [usize; 2],
    length: PathLength,
    params: &Params,
    replication: u32,
) -> Vec<BlockPixel> {
    let at = |i: usize| [tile_corner[0] + i % TILE, tile_corner[1] + i / TILE];
    let is_in_image = |[x, y]: [usize; 2]| x < params.width && y < params.height;
    let members = block.iter().map(|&i| (i, at(i))).filter(|(_, at)| is_in_image(*at));
    members.map(|(i, at)| BlockPixel::new(i, at, length, params.seed, replication)).collect()
}
