//! Pilot run: predicts the rendering time and the error of an image by rendering a few of its tiles.
//!
//! No number known before rendering predicts the cost and the variance of paths well. The pilot run therefore renders a
//! sample of tiles exactly as the image would: at full resolution and with the same path sharing. A few tiles, such as
//! tiles at the edge of a lamp, may cause most of an image's error. Therefore a few paths are first traced in all tiles
//! (`tile_moments`), to estimate the standard deviation of each tile's light. Tiles are selected with a probability
//! proportional to this deviation, and weighted by the reciprocal of this probability (Horvitz and Thompson 1952). The
//! few paths that are traced first may miss the edge of a lamp in one tile but find it in the next, so the deviations
//! are spread to neighbouring tiles.
//!
//! The interior of a lamp in view has no variance. Its tiles are hardly ever selected, although they may have most of
//! the image's radiance. The mean of the image is therefore taken from the first few paths, which cover all tiles. The
//! selected tiles only correct this mean, by the difference between their rendered means and the means from their
//! first few paths (the difference estimator of Särndal, Swensson and Wretman 1992).
//!
//! With stratified points, the variance of a pixel falls faster than 1 / n, at a rate that depends on the scene. The
//! pilot run therefore measures the variance at three numbers of paths. It traces the largest number only in some of
//! the tiles. These tiles are selected in proportion to their share of the variance that was measured at the second
//! number.

pub use super::adaptive::MIN_UNIFORM_PATHS;
use super::camera_rays::CameraRays;
use super::grid::{AREA, Grid};
use super::pass::Pass;
pub use super::pixel::REPLICATIONS;
use super::pixel::{Pixel, paths_of_replication};
use super::prepass::Prepass;
use super::tile::{Tile, TileContext};
use super::tile_moments::{TileMoments, tile_moments};
use crate::error::Result;
use crate::exec;
use crate::image::try_collect;
use crate::job::Job;
use crate::maths;
use crate::render::params::{self, Params};
use crate::render::world::World;
use crate::rng::Rng;
use crate::scene::Camera;
use std::sync::atomic::AtomicU64;
use std::time::Duration;

/// Largest number of tiles that the pilot run renders, a limit on its work. Predictions are unbiased for any number
/// (Horvitz and Thompson); `make bench ONLY=plan:renderings` prints their errors. [convention]
const MAX_TILES: usize = 128;
/// Paths per pixel of the three passes. Each of the four replications of a pixel gets a power of four of these paths,
/// because points are stratified best at powers of four.
pub const PATHS: [u32; 3] = [REPLICATIONS, 4 * REPLICATIONS, 16 * REPLICATIONS];
/// Largest number of tiles that the third pass renders. See `MAX_TILES`. [convention]
const MAX_DEEP_TILES: usize = 32;
/// Constant that is added to each tile's selection weight, as a multiple of the mean standard deviation of all tiles,
/// so that even tiles without variance can be selected. Predictions are unbiased for any positive value, and a tile of
/// mean deviation is selected with the same probability for any value. [convention]
const ADDED_WEIGHT: f64 = 0.5;
/// Salt of the pilot's seed, so that its random numbers differ from the random numbers of the image.
const SALT: u64 = 0x7072_6f62_6564_2121;

/// What a pilot run predicts about the whole image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pilot {
    /// Time per path in seconds, with all threads busy.
    pub seconds_per_path: f64,
    /// Predicted square of [`super::super::Film::error`] for each number of paths per pixel in [`PATHS`].
    pub squared_errors: [f64; 3],
    /// Number of paths that uniform sampling needs, divided by the number that adaptive sampling needs for the same
    /// error; at least 1.
    pub adaptive_gain: f64,
    /// Root mean square of the image's radiance, divided by the mean radiance. If the error of every pixel is the same
    /// share of the pixel's radiance, then [`super::super::Film::error`] is that share times `contrast`.
    pub contrast: f64,
}

/// Splits the `paths` paths of a pixel into scrambled nets. Returns the sizes of the nets: for each replication, the
/// powers of two that add up to its number of paths.
pub fn nets(paths: u32) -> impl Iterator<Item = u32> {
    let nets = |points: u32| (0..u32::BITS).map(move |bit| points & 1 << bit).filter(|&points| points > 0);
    (0..REPLICATIONS).flat_map(move |replication| nets(paths_of_replication(paths, replication)))
}

/// A tile that the pilot run renders.
struct PilotTile {
    tile: usize,
    /// Number of the image's tiles that this tile represents, computed from its selection probability.
    weight: f64,
    /// Number of pilot tiles that this tile represents in the third pass (`PATHS[2]` paths per pixel), which renders
    /// only some of the tiles; 0 if that pass leaves this tile out.
    deep_weight: f64,
    /// Mean radiance of the tile, estimated beforehand with few paths (`tile_moments`).
    expected: f64,
    pixels: [Pixel; AREA],
    /// Number of paths of each pixel (`paths`), and total time for all paths of the tile in seconds (`seconds`).
    paths: f64,
    seconds: f64,
}

/// Sums over the pixels of a pilot tile, and the weight of the tile. Radiance and its square are averaged over the
/// channels.
#[derive(Clone, Copy, Default)]
struct TileSums {
    weight: f64,
    pixels: f64,
    /// Values of the sums `mean` and `square` that the estimate of `tile_moments` predicts.
    expected: [f64; 2],
    mean: f64,
    square: f64,
    variance: f64,
}

/// Runs the pilot: selects tiles, renders them and returns the prediction. `clock` returns the time since an arbitrary
/// start.
///
/// # Errors
/// A setting out of range; a degenerate camera; cancelled.
pub fn run(
    world: &World,
    camera: &Camera,
    params: &Params,
    clock: &(dyn Fn() -> Duration + Sync),
    job: Job,
) -> Result<Pilot> {
    params.check()?;
    params::check_camera(camera)?;
    let grid = Grid { width: params.width, height: params.height };
    let camera_rays = CameraRays::new(world, camera, params);
    let params = &Params { seed: params.seed ^ SALT, ..params.clone() };
    let learning = world.learning()?;
    let prepass = Prepass::new(&learning, &camera_rays, params, job.part(0.0, 0.05))?;
    let world = &learning.settled()?;
    let prepass = prepass.with_world(world);
    let expected = tile_moments(&prepass, grid, job.part(0.05, 0.1))?;
    let mut rng = Rng::new(params.seed, &[]);
    let mut chosen = choose(&expected, grid, &mut rng)?;

    let discarded = AtomicU64::new(0);
    let context = TileContext {
        world,
        camera_rays: &camera_rays,
        seed: params.seed,
        grid,
        median_radiance: prepass.median_radiance(),
        discarded: &discarded,
    };
    let start = clock();
    let render = |chosen: &mut [PilotTile], count: u32, part: Job| render_tiles(context, chosen, count, clock, part);
    let area = (grid.width * grid.height) as f64;
    let mean = |tile_sums: &[TileSums], of: &dyn Fn(&TileSums) -> f64| total(tile_sums, of) / area;

    // Measure the variance at three numbers of paths per pixel. Trace the largest number only in some of the tiles.
    let few = render(&mut chosen, PATHS[0], job.part(0.1, 0.2))?;
    let middle = render(&mut chosen, PATHS[1], job.part(0.2, 0.6))?;
    let part = |t: &TileSums| t.weight * t.variance;
    let mut sampling =
        SystematicSampler::new(total(&middle, &|t| t.variance), MAX_DEEP_TILES.min(chosen.len()), &mut rng);
    chosen.iter_mut().zip(&middle).for_each(|(c, t)| c.deep_weight = sampling.weight_of(part(t)));
    let last = render(&mut chosen, PATHS[2], job.part(0.6, 1.0))?;
    let many = chosen.iter().zip(&last).map(|(c, t)| c.deep_weight * part(t)).sum::<f64>() / area;
    let variances = [mean(&few, &|t| t.variance), mean(&middle, &|t| t.variance), many];
    let seconds = clock().saturating_sub(start).as_secs_f64();

    // Estimate the mean and the mean square of the radiance: take the estimates of `tile_moments` over all tiles, and
    // correct them by the errors found in the pilot tiles (difference estimator).
    let seen = |power: i32| {
        (0..grid.tiles()).map(|t| grid.area(t) as f64 * maths::powi(expected[t].mean, power)).sum::<f64>() / area
    };
    let brightness = (seen(1) + mean(&last, &|t| t.mean - t.expected[0])).max(f64::MIN_POSITIVE);
    let square = seen(2) + mean(&last, &|t| t.square - t.expected[1]);
    Ok(Pilot {
        seconds_per_path: seconds_per_path(&chosen, &last, seconds),
        squared_errors: variances.map(|v| v / (brightness * brightness)),
        adaptive_gain: adaptive_gain(&middle, area),
        contrast: (square.max(0.0).sqrt() / brightness).max(1.0),
    })
}

/// Traces paths in the pilot tiles of positive `deep_weight` (before the third pass, all of them) until each of their
/// pixels has `count` paths. Returns the sums of all pilot tiles, also of tiles without new paths.
fn render_tiles(
    context: TileContext,
    chosen: &mut [PilotTile],
    count: u32,
    clock: &(dyn Fn() -> Duration + Sync),
    job: Job,
) -> Result<Vec<TileSums>> {
    let wanted = Pass::uniform(context.grid.tiles(), count)?;
    exec::for_rows(chosen, 1, job, |_, chosen| {
        let PilotTile { tile, pixels, seconds, paths, deep_weight, .. } = &mut chosen[0];
        if *deep_weight > 0.0 {
            let start = clock();
            Tile::new(context, *tile, pixels, None).extend(&wanted, || job.is_cancelled());
            *seconds += clock().saturating_sub(start).as_secs_f64();
            *paths = f64::from(count);
        }
    })?;
    job.check()?;
    Ok(chosen.iter().map(|c| tile_sums(context.grid, c)).collect())
}

/// Returns the time per path of the whole image in seconds, with all threads busy. `seconds` is the elapsed time of the
/// pilot's three passes. The tiles' own times are times on one thread, so only their ratios are used.
///
/// Expensive tiles may be selected more often than others, so the pilot's own time per path, `seconds / paths`, is
/// biased; `paths` is the number of all paths that the pilot traced. The result is `seconds / paths` times the ratio of
/// two means of the tiles' times per path. In the first mean, the weight of a tile is its number of pixels times the
/// number of tiles that it represents. In the second mean, the weight is the number of paths that the pilot traced in
/// the tile.
fn seconds_per_path(chosen: &[PilotTile], sums: &[TileSums], seconds: f64) -> f64 {
    let sum = |of: &dyn Fn(&PilotTile, &TileSums) -> f64| chosen.iter().zip(sums).map(|(c, t)| of(c, t)).sum::<f64>();
    let paths = sum(&|c, t| c.paths * t.pixels);
    let unweighted = sum(&|c, _| c.seconds) / paths;
    let weighted = sum(&|c, _| c.weight * c.seconds / c.paths) / sum(&|c, t| c.weight * t.pixels);
    let bias = if unweighted > 0.0 { weighted / unweighted } else { 1.0 };
    seconds / paths * bias
}

/// Selects pilot tiles. The probability that a tile is selected grows with a standard deviation: the square root of the
/// variance of the tile's paths, or of the mean variance of the 3 × 3 tiles around it if that is larger.
fn choose(expected: &[TileMoments], grid: Grid, rng: &mut Rng) -> Result<Vec<PilotTile>> {
    let variances = try_collect(expected.iter().map(|l| l.variance))?;
    let varies = grid.max_with_neighbourhood_mean(&variances)?;
    let deviation = |tile: usize| varies[tile].sqrt();
    let sum: f64 = (0..expected.len()).map(deviation).sum();
    let floor = if sum > 0.0 { ADDED_WEIGHT * sum / expected.len() as f64 } else { 1.0 };

    let mut sampling = SystematicSampler::new(sum + floor * expected.len() as f64, expected.len().min(MAX_TILES), rng);
    let mut chosen = Vec::with_capacity(MAX_TILES);
    for (tile, moments) in expected.iter().enumerate() {
        let weight = sampling.weight_of(deviation(tile) + floor);
        if weight > 0.0 {
            let pixels = [Pixel::default(); AREA];
            chosen.push(PilotTile {
                tile,
                weight,
                deep_weight: 1.0,
                expected: moments.mean,
                pixels,
                paths: 0.0,
                seconds: 0.0,
            });
        }
    }
    Ok(chosen)
}

/// Systematic sampling: lays the items side by side on a line, places marks at equal distances, and selects each item
/// that contains a mark. The length of an item is called its chance: the probability that the item is selected is
/// proportional to it.
struct SystematicSampler {
    step: f64,
    next: f64,
    end: f64,
}

impl SystematicSampler {
    /// Places `count` marks at equal distances, with a random start, in the interval `[0, sum]`. `sum` is the sum of
    /// the chances of all items.
    fn new(sum: f64, count: usize, rng: &mut Rng) -> Self {
        let step = sum / count as f64;
        Self { step, next: rng.next_f64() * step, end: 0.0 }
    }

    /// Returns the weight of the next item, whose length on the line is `chance`. The weight is the number of items
    /// that this item represents, or 0 if this item is not selected. An item that is longer than the distance between
    /// marks may contain several marks; each adds to its weight.
    fn weight_of(&mut self, chance: f64) -> f64 {
        self.end += chance;
        let mut marks = 0.0;
        while self.next < self.end {
            (self.next, marks) = (self.next + self.step, marks + 1.0);
        }
        if marks > 0.0 { marks * self.step / chance } else { 0.0 }
    }
}

fn tile_sums(grid: Grid, chosen: &PilotTile) -> TileSums {
    let mut sum = TileSums { weight: chosen.weight, ..TileSums::default() };
    for pixel in (0..AREA).filter(|&i| grid.place(chosen.tile, i).is_some()).map(|i| &chosen.pixels[i]) {
        let (mean, variance) = (pixel.mean(), pixel.variance());
        sum.pixels += 1.0;
        sum.mean += mean.element_sum() / 3.0;
        sum.square += ((mean * mean).element_sum() - variance.element_sum()) / 3.0;
        sum.variance += variance.element_sum() / 3.0;
    }
    sum.expected = [1, 2].map(|power| sum.pixels * maths::powi(chosen.expected, power));
    sum
}

/// Estimates the sum of the quantity `of` over all tiles of the image, from the pilot tiles and their weights.
fn total(tile_sums: &[TileSums], of: &dyn Fn(&TileSums) -> f64) -> f64 {
    tile_sums.iter().map(|t| t.weight * of(t)).sum()
}

/// Returns the number of paths that uniform sampling needs, divided by the number that adaptive sampling needs for
/// equal error. Adaptive sampling allocates paths in proportion to the standard deviation of each tile (Neyman 1934).
fn adaptive_gain(tile_sums: &[TileSums], area: f64) -> f64 {
    let deviation = total(tile_sums, &|t| (t.variance * t.pixels).sqrt());
    if deviation > 0.0 { (total(tile_sums, &|t| t.variance) * area / (deviation * deviation)).max(1.0) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn systematic_samples_estimate_totals_without_bias() {
        // The weighted sum over the selected items estimates the sum of `values` over all items without bias. If
        // the values are the chances, the estimated sum is exact in every round.
        let chances = [0.1, 3.0, 0.0, 0.4, 1.5, 0.2, 7.0];
        let values = [5.0, 1.0, 0.0, 2.0, 4.0, 3.0, 9.0];
        let (mut rng, mut mean) = (Rng::new(3, &[]), 0.0);
        let rounds = 20_000;
        for _ in 0..rounds {
            let mut sampling = SystematicSampler::new(chances.iter().sum(), 4, &mut rng);
            let weights = chances.map(|chance| sampling.weight_of(chance));
            let sum = |of: &[f64]| weights.iter().zip(of).map(|(w, v)| w * v).sum::<f64>();
            assert!((sum(&chances) - chances.iter().sum::<f64>()).abs() < 1e-9 && weights[2] == 0.0);
            mean += sum(&values) / f64::from(rounds);
        }
        // A single estimate has a standard deviation of about 30.
        assert!((mean - 24.0).abs() < 4.0 * 30.0 / f64::from(rounds).sqrt(), "{mean}");
        assert_eq!(SystematicSampler::new(0.0, 4, &mut rng).weight_of(0.0), 0.0);
    }

    #[test]
    fn paths_are_nets_of_every_replication() {
        let nets = |paths| super::nets(paths).collect::<Vec<_>>();
        assert_eq!((nets(PATHS[0]), nets(PATHS[2])), (vec![1; 4], vec![16; 4]));
        assert_eq!(nets(28), [[1, 2, 4]; 4].concat());
        assert_eq!(nets(9), [1, 2, 2, 2, 2]);
        assert!((0..300).all(|paths| super::nets(paths).sum::<u32>() == paths));
    }
}
