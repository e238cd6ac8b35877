//! Adaptive sampling: decides how many paths each tile gets in the next pass.
//!
//! 1. The first passes render a coarse image: they trace one path in each pixel of a coarse grid, then of finer grids,
//!    until every pixel has a path.
//! 2. The next passes give every pixel a few paths, then twice as many, and so on, since sample points are stratified
//!    best at powers of two.
//! 3. If there is an error target, the passes from [`MIN_UNIFORM_PATHS`] paths per pixel on are adaptive. Each adaptive
//!    pass doubles the paths of the tiles whose required number of paths is the largest multiple of their present
//!    number.
//!
//! If the target limits the error of the whole image, the required number of paths of a tile is proportional to the
//! standard deviation of its paths (Neyman 1934). For a target on the relative error, each pixel's deviation is first
//! divided by the pixel's radiance. If the target limits the error of each pixel, the required number follows from the
//! errors of the tile's own pixels.
//!
//! A tile in which no bright path has been found yet has a small variance by chance. If the sampling of such a tile
//! stopped early, the image would become too dark. Decisions are therefore made for whole tiles and take neighbouring
//! tiles into account (after Dammertz et al. 2010, "A hierarchical automatic stopping condition for Monte Carlo global
//! illumination"). The tests and `benches/error_control.rs` measure the remaining bias.

use super::accumulator::Accumulator;
use super::clock::Clock;
use super::grid::coarse_stride;
use super::pass::Pass;
use super::pixel::REPLICATIONS;
use super::statistics::{Statistics, whole};
use crate::error::Result;
use crate::image::try_vec;
use crate::job::Job;
use crate::maths;
use crate::render::params::Params;

/// Paths per pixel, in all, after the first pass that follows the coarse image.
/// [convention: one path per replication (point sequence) of a pixel]
const FIRST_PASS_PATHS: u32 = 4;
/// Paths per pixel, in all, before the first adaptive pass. With fewer paths, the allocation to tiles follows the noise
/// more closely, which increases the bias. The bench prints this bias, and the paths that an error target saves.
/// [bench error_control]
pub const MIN_UNIFORM_PATHS: u32 = 16;
/// Limit on the paths per pixel of a tile, as a multiple of `samples`. Without a limit, light that few paths find (a
/// caustic, or the glossy reflection of a small lamp) would take all paths. At the limit, the error of a tile is 1/8 of
/// its error with `samples` paths. The limit affects only tiles that need even more paths. [convention]
const MAX_TILE_RATIO: u32 = 64;
/// The relative error of a pixel is its error divided by its luminance. If the luminance is less than this share of
/// the image's mean radiance, the error is divided by this share of the mean instead. [convention: the target error is
/// defined with it]
const MIN_RELATIVE_LUMINANCE: f64 = 0.1;

/// Chooses the passes of a render, one after the other.
pub struct AdaptiveSampler<'p> {
    params: &'p Params,
    /// Pixel stride (`stride`) and paths per pixel (`uniform_paths`) of the last uniform pass.
    stride: usize,
    uniform_paths: u32,
}

impl<'p> AdaptiveSampler<'p> {
    pub fn new(params: &'p Params) -> Self {
        Self { params, stride: 2 * coarse_stride(params.width, params.height), uniform_paths: 0 }
    }

    /// Returns the next pass; `None` if all targets are met, or the paths or the time are used up.
    pub fn next(&mut self, accumulator: &Accumulator, clock: &Clock, job: Job) -> Result<Option<Pass>> {
        let Params { samples, target_error, relative_error, pixel_error, .. } = *self.params;
        if self.uniform_paths > 0 && clock.is_over() {
            return Ok(None);
        }
        // While the image is still coarse, halve the pixel stride. At a stride of 1, every pixel has one path.
        if self.stride > 1 {
            self.stride /= 2;
            self.uniform_paths = 1;
            return self.uniform(accumulator, 1);
        }
        let has_target = target_error > 0.0 || relative_error > 0.0 || pixel_error > 0.0;
        if has_target && self.uniform_paths >= MIN_UNIFORM_PATHS.min(samples) {
            return self.adaptive_pass(accumulator, clock, job);
        }
        if self.uniform_paths >= samples {
            return Ok(None);
        }
        // Give every pixel [`FIRST_PASS_PATHS`] paths, then double them in each pass, as far as the time budget
        // allows.
        let doubled =
            if self.uniform_paths < FIRST_PASS_PATHS { FIRST_PASS_PATHS } else { self.uniform_paths.saturating_mul(2) };
        let affordable = clock.affordable_ratio().map_or(u32::MAX, |times| {
            let more = (f64::from(self.uniform_paths) * times) as u32 / FIRST_PASS_PATHS * FIRST_PASS_PATHS;
            self.uniform_paths.saturating_add(more.max(FIRST_PASS_PATHS))
        });
        self.uniform_paths = doubled.min(affordable.max(FIRST_PASS_PATHS)).min(samples);
        self.uniform(accumulator, self.uniform_paths)
    }

    fn uniform(&self, accumulator: &Accumulator, count: u32) -> Result<Option<Pass>> {
        Ok(Some(Pass { stride: self.stride, ..Pass::uniform(accumulator.grid.tiles(), count)? }))
    }

    /// Returns a pass that doubles the paths of some tiles, or `None` if no tile needs more paths. The tiles with the
    /// largest need come first. The need of a tile is its required number of paths divided by its present number.
    fn adaptive_pass(&self, accumulator: &Accumulator, clock: &Clock, job: Job) -> Result<Option<Pass>> {
        let statistics = accumulator.statistics(|_, _| 1.0, job)?;
        let target_paths = self.target_paths(accumulator, &statistics, job)?;
        let whole = whole(&statistics);

        // Compute the budget of the pass: the paths that all tiles still need, or fewer if the time does not suffice.
        // The image may get `allowed` more paths before its mean number per pixel reaches `samples`.
        let max_paths = self.params.samples.saturating_mul(MAX_TILE_RATIO);
        let missing = |tile: usize| {
            (target_paths[tile].min(f64::from(max_paths)) - f64::from(statistics[tile].max_paths)).max(0.0)
                * f64::from(statistics[tile].pixels)
        };
        let mut budget: f64 = (0..statistics.len()).map(missing).sum();
        if let Some(times) = clock.affordable_ratio() {
            budget = budget.min(whole.paths as f64 * times);
        }
        let allowed = f64::from(self.params.samples) * f64::from(whole.pixels) - whole.paths as f64;
        let mut candidates: Vec<(f64, usize)> = (0..statistics.len())
            .map(|tile| (target_paths[tile] / f64::from(statistics[tile].max_paths.max(1)), tile))
            .filter(|&(need, tile)| need > 1.0 && statistics[tile].max_paths < max_paths)
            .collect();
        // Sort tiles by decreasing need, and tiles of equal need by their index.
        candidates.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));

        let mut counts: Vec<u32> = statistics.iter().map(|t| t.max_paths).collect();
        let mut spent = 0.0;
        for (_, tile) in candidates {
            if spent > 0.0 && spent >= budget {
                break;
            }
            let (present, pixels) = (statistics[tile].max_paths, f64::from(statistics[tile].pixels));
            // Double the tile's paths, but do not exceed `max_paths` per pixel or the paths that are left for the
            // image.
            let left = ((allowed - spent).max(0.0) / pixels) as u32 / REPLICATIONS * REPLICATIONS;
            let more = present.min(max_paths - present).min(left);
            counts[tile] = present + more;
            spent += f64::from(more) * pixels;
        }
        Ok((spent > 0.0).then_some(Pass { counts, stride: 1 }))
    }

    /// Returns the number of paths per pixel that each tile needs to meet all targets.
    fn target_paths(&self, accumulator: &Accumulator, statistics: &[Statistics], job: Job) -> Result<Vec<f64>> {
        let Params { target_error, relative_error, pixel_error, .. } = *self.params;
        let mean = whole(statistics).mean_radiance();
        let mut target_paths = try_vec(statistics.len(), 0.0)?;
        if target_error > 0.0 {
            self.add_allocation(accumulator, statistics, target_error, &mut target_paths)?;
        }
        if relative_error > 0.0 {
            self.add_allocation(
                accumulator,
                &accumulator.relative_statistics(mean, job)?,
                relative_error,
                &mut target_paths,
            )?;
        }
        if pixel_error > 0.0 {
            let relative_intervals = accumulator.relative_intervals(MIN_RELATIVE_LUMINANCE * mean, job)?;
            for ((paths, squared_interval), tile) in target_paths.iter_mut().zip(relative_intervals).zip(statistics) {
                *paths =
                    paths.max(f64::from(tile.max_paths) * squared_interval / maths::powi(f64::from(pixel_error), 2));
            }
        }
        Ok(target_paths)
    }

    /// Raises each tile's entry in `target_paths` to at least the number of paths that an allocation gives to the tile.
    /// This allocation meets `target`, an error of the whole image, with the fewest paths. If the allocation would take
    /// more than `samples` paths per pixel on average, it is scaled down to `samples`. Does nothing if the image meets
    /// `target` already.
    fn add_allocation(
        &self,
        accumulator: &Accumulator,
        statistics: &[Statistics],
        target: f32,
        target_paths: &mut [f64],
    ) -> Result<()> {
        let (whole, target) = (whole(statistics), f64::from(target));
        if whole.error() <= target {
            return Ok(());
        }
        let path_variances: Vec<f64> = statistics.iter().map(|t| t.path_variance_sum / f64::from(t.pixels)).collect();
        let deviations: Vec<f64> =
            accumulator.grid.max_with_neighbourhood_mean(&path_variances)?.into_iter().map(f64::sqrt).collect();
        // Give each tile n = k d paths per pixel. Here d is the standard deviation of the tile's paths, raised where
        // the neighbouring tiles vary more, and k is the same for all tiles. If s is the variance of single paths in a
        // tile, the mean square error of the image is the mean of s / (k d) over the tiles, weighted by their pixels.
        // Take the smaller of two values of k: the value that meets the target, and the value that spends `samples`
        // paths per pixel.
        let mean_of = |value: &dyn Fn(usize) -> f64| {
            (0..statistics.len()).map(|t| value(t) * f64::from(statistics[t].pixels)).sum::<f64>()
                / f64::from(whole.pixels)
        };
        let left = mean_of(&|t| if path_variances[t] > 0.0 { path_variances[t] / deviations[t] } else { 0.0 });
        let needed = left / maths::powi(target * whole.mean_radiance(), 2);
        let allowed = f64::from(self.params.samples) / mean_of(&|t| deviations[t]);
        target_paths.iter_mut().zip(&deviations).for_each(|(w, d)| *w = w.max(needed.min(allowed) * d));
        Ok(())
    }
}
