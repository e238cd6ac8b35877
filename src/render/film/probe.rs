//! A look at a few tiles of an image, to tell what all of it would take.
//!
//! What a path costs and how much paths scatter depends on the scene more than on anything that could be counted before.
//! So some tiles are rendered as the image will be, each pixel of its true size, with the neighbours it shares its paths
//! with; they stand for the rest. A few tiles with the edge of a lamp may have most of an image's error, so tiles are
//! chosen with a probability in proportion to how much a first look finds their light to vary, and weighed by its
//! reciprocal (Horvitz and Thompson 1952).
//!
//! Stratified points let the variance of pixels fall faster than their number rises, by how much depends on the scene. So it
//! is known at three numbers of paths; at the largest only of the tiles that have most of it, and of the others as if
//! their paths were independent from the second on.

use super::Eye;
use super::grid::{AREA, Grid, TILE};
use super::pixel::Pixel;
use super::plan::Pass;
use super::survey::Survey;
use super::tile::{Setting, Tile};
use crate::error::Result;
use crate::exec;
use crate::job::Job;
use crate::render::{Params, World};
use crate::rng::Rng;
use crate::scene::Camera;
use std::sync::atomic::AtomicU64;
use std::time::Duration;

/// Tiles that a first look is taken at, and that are rendered, at most.
const LOOKED_AT: usize = 2048;
const TILES: usize = 128;
/// Paths of each of their pixels, in three passes: powers of four, at which points are stratified best.
pub const PATHS: [u32; 3] = [4, 16, 64];
/// Tiles that are given the last of them.
const DEEP: usize = 32;
/// Paths of the first look at a tile, along each side.
const LOOKS: usize = 4;
/// Chance of a tile whose light does not vary at all, relative to the mean.
const FLOOR: f64 = 0.5;
/// Tells the paths of the probe from those of the image.
const SALT: u64 = 0x7072_6f62_6564_2121;

/// What a few tiles say of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Seconds that a path takes, all threads working.
    pub seconds_per_path: f64,
    /// The square of the [`super::super::Film::error`] that the image would have with each of [`PATHS`] everywhere.
    pub squares: [f64; 3],
    /// How many times fewer paths do where they go to where they lower the error most; at least 1.
    pub saved: f64,
    /// Root mean square of the image's radiance relative to its mean: an error common to all light, times this, is what
    /// it adds to the image's error.
    pub contrast: f64,
}

/// A tile that stands for others.
struct Chosen {
    tile: usize,
    /// How many tiles it stands for.
    weight: f64,
    pixels: [Pixel; AREA],
    /// Paths of each pixel, and the seconds they took.
    paths: f64,
    seconds: f64,
}

/// Sums over the pixels of a tile, averaged over the channels.
#[derive(Clone, Copy, Default)]
struct Tally {
    weight: f64,
    pixels: f64,
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
) -> Result<Probe> {
    params.check()?;
    crate::render::check_camera(camera)?;
    let grid = Grid { width: params.width, height: params.height };
    let eye = Eye::new(world, camera, params);
    let params = &Params { seed: params.seed ^ SALT, ..params.clone() };
    let survey = Survey::new(world, &eye, params, job.part(0.0, 0.05))?;
    let mut chosen = choose(&survey, grid, params.seed, job.part(0.05, 0.1))?;

    let discarded = AtomicU64::new(0);
    let setting = Setting { world, eye: &eye, seed: params.seed, grid, level: survey.level(), discarded: &discarded };
    let start = clock();
    let render = |chosen: &mut [Chosen], count: u32, part: Job| {
        let wanted = Pass::alike(grid.tiles(), count)?;
        exec::for_rows(chosen, 1, part, |_, chosen| {
            let Chosen { tile, pixels, seconds, paths, .. } = &mut chosen[0];
            let start = clock();
            Tile::new(setting, *tile, pixels, None).extend(&wanted, || part.is_cancelled());
            *seconds += clock().saturating_sub(start).as_secs_f64();
            *paths = f64::from(count);
        })?;
        job.check()
    };
    let tallies = |chosen: &[Chosen]| chosen.iter().map(|c| tally(grid, c)).collect::<Vec<_>>();

    render(&mut chosen, PATHS[0], job.part(0.1, 0.2))?;
    let few = mean(&tallies(&chosen), |t| t.variance);
    render(&mut chosen, PATHS[1], job.part(0.2, 0.6))?;
    chosen.sort_by(|a, b| {
        let part = |c: &Chosen| c.weight * tally(grid, c).variance;
        part(b).total_cmp(&part(a)).then(a.tile.cmp(&b.tile))
    });
    let middle = tallies(&chosen);
    let deep = chosen.len().min(DEEP);
    render(&mut chosen[..deep], PATHS[2], job.part(0.6, 1.0))?;
    let mut last = tallies(&chosen);
    let independent = f64::from(PATHS[1]) / f64::from(PATHS[2]);
    last[deep..].iter_mut().for_each(|t| t.variance *= independent);
    let variances = [few, mean(&middle, |t| t.variance), mean(&last, |t| t.variance)];
    let seconds = clock().saturating_sub(start).as_secs_f64();

    // What threads come to together, were the tiles as those of the image.
    let sum = |of: &dyn Fn(&Chosen, &Tally) -> f64| chosen.iter().zip(&last).map(|(c, t)| of(c, t)).sum::<f64>();
    let paths = sum(&|c, t| c.paths * t.pixels);
    let alike = sum(&|c, _| c.seconds) / paths;
    let weighed = sum(&|c, _| c.weight * c.seconds / c.paths) / sum(&|c, t| c.weight * t.pixels);
    let bias = if alike > 0.0 { weighed / alike } else { 1.0 };
    let brightness = mean(&last, |t| t.mean).max(f64::MIN_POSITIVE);
    Ok(Probe {
        seconds_per_path: seconds / paths * bias,
        squares: variances.map(|v| v / (brightness * brightness)),
        saved: saved(&middle),
        contrast: (mean(&last, |t| t.square).max(0.0).sqrt() / brightness).max(1.0),
    })
}

/// Tiles by how much their light varies.
fn choose(survey: &Survey, grid: Grid, seed: u64, job: Job) -> Result<Vec<Chosen>> {
    let (tiles, mut rng) = (grid.tiles(), Rng::new(seed, &[]));
    // One in each stretch of the rows of tiles.
    let count = tiles.min(LOOKED_AT);
    let place = |i: usize| ((i as f64 + rng.next_f64()) * tiles as f64 / count as f64) as usize;
    let looked_at: Vec<usize> = (0..count).map(place).map(|tile| tile.min(tiles - 1)).collect();
    let varies = exec::map(count, job, |i| survey.variation(grid, looked_at[i]))?;
    let floor = FLOOR * varies.iter().sum::<f64>() / count as f64;
    let chances: Vec<f64> = varies.iter().map(|v| v + if floor > 0.0 { floor } else { 1.0 }).collect();
    let total: f64 = chances.iter().sum();

    // Evenly spaced steps along the chances; one longer than a step is met more than once.
    let wanted = count.min(TILES);
    let step = total / wanted as f64;
    let (mut next, mut end) = (rng.next_f64() * step, 0.0);
    let mut chosen = Vec::with_capacity(wanted);
    for (&tile, chance) in looked_at.iter().zip(chances) {
        end += chance;
        let mut met = 0.0;
        while next < end {
            (next, met) = (next + step, met + 1.0);
        }
        if met > 0.0 {
            chosen.push(Chosen {
                tile,
                weight: met * step / chance,
                pixels: [Pixel::default(); AREA],
                paths: 0.0,
                seconds: 0.0,
            });
        }
    }
    Ok(chosen)
}

impl Survey<'_> {
    /// Standard deviation of the radiance of paths over a tile.
    fn variation(&self, grid: Grid, tile: usize) -> f64 {
        let (left, top) = grid.corner(tile);
        let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
        // One in each square of the tile, at another place in each of its rows.
        let side = TILE / LOOKS;
        for i in 0..LOOKS * LOOKS {
            let (column, row) = (i % LOOKS, i / LOOKS);
            let (x, y) = (column * side + (row + column) % side, row * side + column % side);
            let at = [(left + x).min(grid.width - 1), (top + y).min(grid.height - 1)];
            let radiance = self.look(at, 1).mean().element_sum() / 3.0;
            (count, sum, squares) = (count + 1.0, sum + radiance, squares + radiance * radiance);
        }
        f64::max(squares / count - (sum / count) * (sum / count), 0.0).sqrt()
    }
}

fn tally(grid: Grid, chosen: &Chosen) -> Tally {
    let mut sum = Tally { weight: chosen.weight, ..Tally::default() };
    for pixel in (0..AREA).filter(|&i| grid.place(chosen.tile, i).is_some()).map(|i| &chosen.pixels[i]) {
        let (mean, variance) = (pixel.mean(), pixel.variance());
        sum.pixels += 1.0;
        sum.mean += mean.element_sum() / 3.0;
        sum.square += ((mean * mean).element_sum() - variance.element_sum()) / 3.0;
        sum.variance += variance.element_sum() / 3.0;
    }
    sum
}

/// Mean over the pixels of the image.
fn mean(tallies: &[Tally], of: impl Fn(&Tally) -> f64) -> f64 {
    let sum = |of: &dyn Fn(&Tally) -> f64| tallies.iter().map(|t| t.weight * of(t)).sum::<f64>();
    sum(&of) / sum(&|t| t.pixels)
}

/// In proportion to the standard deviation of a tile's paths, the error of even paths needs so many times fewer (Neyman 1934).
fn saved(tallies: &[Tally]) -> f64 {
    let deviation = mean(tallies, |t| (t.variance * t.pixels).sqrt());
    if deviation > 0.0 { (mean(tallies, |t| t.variance) / (deviation * deviation)).max(1.0) } else { 1.0 }
}
