//! A look at a few tiles of an image, to tell what all of it would take.
//!
//! What a path costs and how much paths scatter depends on the scene more than on anything that could be counted before.
//! So some tiles are rendered as the image will be, each pixel of its true size, with the neighbours it shares its paths
//! with; they stand for the rest. A few tiles with the edge of a lamp may have most of an image's error, so tiles are
//! chosen with a probability in proportion to how much a first look finds their light to vary, and weighed by its
//! reciprocal (Horvitz and Thompson 1952). A look may miss the sliver of a lamp, which the tile beside it shows more of: so
//! tiles heed their neighbours. The middle of a lamp does not vary at all, and is hardly ever chosen, though it may have most of
//! an image's light. So how bright the image is follows from the first look at all of it, and the chosen tiles correct
//! that by what they find it to be off (the difference estimator of Särndal, Swensson and Wretman 1992).
//!
//! Stratified points let the variance of pixels fall faster than their number rises, by how much depends on the scene. So it
//! is known at three numbers of paths; at the largest of a few of those tiles, chosen in turn in proportion to their part in it
//! at the second.

use super::Eye;
use super::adaptive::Pass;
use super::grid::{AREA, Grid};
pub use super::pixel::REPLICATIONS;
use super::pixel::{Pixel, paths_of_replication};
use super::prepass::Prepass;
use super::tile::{Tile, TileContext};
use super::tile_moments::{TileMoments, tile_moments};
use crate::error::Result;
use crate::exec;
use crate::image::try_collect;
use crate::job::Job;
use crate::render::{Params, World};
use crate::rng::Rng;
use crate::scene::Camera;
use std::sync::atomic::AtomicU64;
use std::time::Duration;

/// Tiles that are rendered, at most.
const MAX_TILES: usize = 128;
/// Paths of each of their pixels, in three passes: each replication's are a power of four, at which points are stratified best.
pub const PATHS: [u32; 3] = [REPLICATIONS, 4 * REPLICATIONS, 16 * REPLICATIONS];
/// Tiles that are given the last of them, at most.
const MAX_DEEP_TILES: usize = 32;
/// Chance of a tile whose light does not vary at all, relative to the mean.
const MIN_CHANCE: f64 = 0.5;
/// Tells the paths of the probe from those of the image.
const SALT: u64 = 0x7072_6f62_6564_2121;

/// What a few tiles say of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pilot {
    /// Seconds that a path takes, all threads working.
    pub seconds_per_path: f64,
    /// The square of the [`super::super::Film::error`] that the image would have with each of [`PATHS`] everywhere.
    pub squared_errors: [f64; 3],
    /// How many times fewer paths do where they go to where they lower the error most; at least 1.
    pub adaptive_gain: f64,
    /// Root mean square of the image's radiance relative to its mean: an error common to all light, times this, is what
    /// it adds to the image's error.
    pub contrast: f64,
}

/// The nets that so many paths of a pixel consist of, each by its number of points, a power of two: every replication has
/// its own.
pub fn nets(paths: u32) -> impl Iterator<Item = u32> {
    let nets = |points: u32| (0..u32::BITS).map(move |bit| points & 1 << bit).filter(|&points| points > 0);
    (0..REPLICATIONS).flat_map(move |replication| nets(paths_of_replication(paths, replication)))
}

/// A tile that stands for others.
struct PilotTile {
    tile: usize,
    /// How many tiles it stands for.
    weight: f64,
    /// For how many of the chosen, with the same part in the error, it stands in the last pass; 0 if it is not in it.
    deep_weight: f64,
    /// Its mean at first sight.
    expected: f64,
    pixels: [Pixel; AREA],
    /// Paths of each pixel, and the seconds they took.
    paths: f64,
    seconds: f64,
}

/// Sums over the pixels of a tile, averaged over the channels.
#[derive(Clone, Copy, Default)]
struct TileSums {
    weight: f64,
    pixels: f64,
    /// What was expected of `mean` and of `square`.
    expected: [f64; 2],
    mean: f64,
    square: f64,
    variance: f64,
}

/// Renders some tiles; `clock` tells the time, from any start.
///
/// # Errors
/// A setting out of range, a camera that cannot see; cancelled.
pub fn run(
    world: &World,
    camera: &Camera,
    params: &Params,
    clock: &(dyn Fn() -> Duration + Sync),
    job: Job,
) -> Result<Pilot> {
    params.check()?;
    crate::render::check_camera(camera)?;
    let grid = Grid { width: params.width, height: params.height };
    let eye = Eye::new(world, camera, params);
    let params = &Params { seed: params.seed ^ SALT, ..params.clone() };
    let prepass = Prepass::new(world, &eye, params, job.part(0.0, 0.05))?;
    let expected = tile_moments(&prepass, grid, job.part(0.05, 0.1))?;
    let mut rng = Rng::new(params.seed, &[]);
    let mut chosen = choose(&expected, grid, &mut rng)?;

    let discarded = AtomicU64::new(0);
    let context = TileContext {
        world,
        eye: &eye,
        seed: params.seed,
        grid,
        median_radiance: prepass.median_radiance(),
        discarded: &discarded,
    };
    let start = clock();
    let render = |chosen: &mut [PilotTile], count: u32, part: Job| -> Result<Vec<TileSums>> {
        let wanted = Pass::uniform(grid.tiles(), count)?;
        exec::for_rows(chosen, 1, part, |_, chosen| {
            let PilotTile { tile, pixels, seconds, paths, deep_weight, .. } = &mut chosen[0];
            if *deep_weight > 0.0 {
                let start = clock();
                Tile::new(context, *tile, pixels, None).extend(&wanted, || part.is_cancelled());
                *seconds += clock().saturating_sub(start).as_secs_f64();
                *paths = f64::from(count);
            }
        })?;
        job.check()?;
        Ok(chosen.iter().map(|c| tile_sums(grid, c)).collect())
    };
    let area = (grid.width * grid.height) as f64;
    let mean = |tile_sums: &[TileSums], of: &dyn Fn(&TileSums) -> f64| total(tile_sums, of) / area;

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

    // What threads come to together, were the tiles as those of the image.
    let sum = |of: &dyn Fn(&PilotTile, &TileSums) -> f64| chosen.iter().zip(&last).map(|(c, t)| of(c, t)).sum::<f64>();
    let paths = sum(&|c, t| c.paths * t.pixels);
    let alike = sum(&|c, _| c.seconds) / paths;
    let weighed = sum(&|c, _| c.weight * c.seconds / c.paths) / sum(&|c, t| c.weight * t.pixels);
    let bias = if alike > 0.0 { weighed / alike } else { 1.0 };
    let seen =
        |power: i32| (0..grid.tiles()).map(|t| grid.area(t) as f64 * expected[t].mean.powi(power)).sum::<f64>() / area;
    let brightness = (seen(1) + mean(&last, &|t| t.mean - t.expected[0])).max(f64::MIN_POSITIVE);
    let square = seen(2) + mean(&last, &|t| t.square - t.expected[1]);
    Ok(Pilot {
        seconds_per_path: seconds / paths * bias,
        squared_errors: variances.map(|v| v / (brightness * brightness)),
        adaptive_gain: adaptive_gain(&middle, area),
        contrast: (square.max(0.0).sqrt() / brightness).max(1.0),
    })
}

/// Tiles by how much their light varies.
fn choose(expected: &[TileMoments], grid: Grid, rng: &mut Rng) -> Result<Vec<PilotTile>> {
    let variances = try_collect(expected.iter().map(|l| l.variance))?;
    let varies = grid.max_with_neighbourhood_mean(&variances)?;
    let deviation = |tile: usize| varies[tile].sqrt();
    let sum: f64 = (0..expected.len()).map(deviation).sum();
    let floor = if sum > 0.0 { MIN_CHANCE * sum / expected.len() as f64 } else { 1.0 };

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

/// Evenly spaced steps along the chances of items in a row: those that are met are chosen.
struct SystematicSampler {
    step: f64,
    next: f64,
    end: f64,
}

impl SystematicSampler {
    /// So many of them along all chances, which have this sum.
    fn new(sum: f64, count: usize, rng: &mut Rng) -> Self {
        let step = sum / count as f64;
        Self { step, next: rng.next_f64() * step, end: 0.0 }
    }

    /// How many items like the next one, of this chance, it stands for; 0 if it is not chosen. One whose chance is longer than
    /// a step is met more than once.
    fn weight_of(&mut self, chance: f64) -> f64 {
        self.end += chance;
        let mut met = 0.0;
        while self.next < self.end {
            (self.next, met) = (self.next + self.step, met + 1.0);
        }
        if met > 0.0 { met * self.step / chance } else { 0.0 }
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
    sum.expected = [1, 2].map(|power| sum.pixels * chosen.expected.powi(power));
    sum
}

/// Sum over the image.
fn total(tile_sums: &[TileSums], of: &dyn Fn(&TileSums) -> f64) -> f64 {
    tile_sums.iter().map(|t| t.weight * of(t)).sum()
}

/// In proportion to the standard deviation of a tile's paths, the error of even paths needs so many times fewer (Neyman 1934).
fn adaptive_gain(tile_sums: &[TileSums], area: f64) -> f64 {
    let deviation = total(tile_sums, &|t| (t.variance * t.pixels).sqrt());
    if deviation > 0.0 { (total(tile_sums, &|t| t.variance) * area / (deviation * deviation)).max(1.0) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_chosen_stands_for_all() {
        // The sum of anything is found on the average, and that of the chances always.
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
        // The sum has a standard deviation of some 30.
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
