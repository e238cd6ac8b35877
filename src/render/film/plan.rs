//! Where the next paths go.
//!
//! First a coarse image, then a few paths for every pixel, then twice as many, and so on: at powers of two the points are
//! stratified best. With a target, tiles go on alone from [`EVEN`] paths on. For the error of the whole image the least
//! paths are those in proportion to the standard deviation of a tile's paths (Neyman 1934), or to that relative to what its
//! pixels show; for the error of each pixel they follow from the tile's own. The tiles that lack most of what they need are
//! doubled first.
//!
//! Stopping where the scatter is small by chance makes an image too dark: where it is small, a bright path has not been
//! found yet. So a decision is about a whole tile, and heeds what is around it (after Dammertz et al. 2010, "A hierarchical
//! automatic stopping condition for Monte Carlo global illumination"). What bias remains is measured in the tests and by
//! `benches/error_control.rs`.

use super::grid::{AREA, TILE};
use super::interval::{NORMAL_95, pooled};
use super::pixel::Pixel;
use super::worth::{mean, trust};
use super::{Canvas, Clock};
use crate::error::Result;
use crate::exec;
use crate::image::{colour::luminance, try_vec};
use crate::job::Job;
use crate::render::Params;
use glam::DVec3;

/// Pixels of the coarsest image.
const COARSE: usize = 1024;
/// Paths of the first pass over all pixels.
const FIRST: u32 = 4;
/// Paths of every pixel before anything is decided from them.
const EVEN: u32 = 16;
/// Paths that a pixel of a tile gets at most, relative to what pixels are allowed on the average. Light that few paths find
/// would take all there are: a caustic, the image of a small lamp in polish.
const SHARE: u32 = 64;
/// Pixels darker than this share of the mean luminance count as if they were as bright.
const DARK: f64 = 0.1;
/// The same where the errors of all pixels are one figure: darker ones may count for more in it, as none holds up the others.
const BLACK: f64 = 0.01;

/// How many paths pixels are to have.
pub struct Pass {
    /// Per tile.
    counts: Vec<u32>,
    /// Only pixels whose column and row are multiples of this power of two.
    stride: usize,
}

impl Pass {
    /// So many paths for every pixel.
    pub fn alike(tiles: usize, count: u32) -> Result<Self> {
        Ok(Self { counts: try_vec(tiles, count)?, stride: 1 })
    }

    pub fn count(&self, tile: usize, x: usize, y: usize) -> u32 {
        if (x | y) & (self.stride - 1) == 0 { self.counts[tile] } else { 0 }
    }

    /// Whether all pixels are meant.
    pub fn is_dense(&self) -> bool {
        self.stride == 1
    }

    /// Whether no pixel of the tile with this corner is meant: those of a coarse pass are the first of theirs.
    pub fn passes_over(&self, (left, top): (usize, usize)) -> bool {
        self.stride >= TILE && (left | top) & (self.stride - 1) != 0
    }

    /// Paths per pixel of a tile, on the average.
    pub fn per_pixel(&self, tile: usize) -> f64 {
        f64::from(self.counts[tile]) / (self.stride * self.stride) as f64
    }
}

/// Sums over a tile, or over the image.
#[derive(Clone, Copy, Default)]
pub struct Tally {
    pub paths: u64,
    pixels: u32,
    /// Most paths of a pixel.
    most: u32,
    /// Of the means of the pixels, averaged over the channels.
    mean: f64,
    /// Of the variances of those means.
    variance: f64,
    /// Of the variances of single paths.
    spread: f64,
}

impl Tally {
    fn add(&mut self, other: &Self) {
        self.paths += other.paths;
        self.pixels += other.pixels;
        self.most = self.most.max(other.most);
        self.mean += other.mean;
        self.variance += other.variance;
        self.spread += other.spread;
    }

    /// Mean of the pixels.
    fn level(&self) -> f64 {
        self.mean / f64::from(self.pixels.max(1))
    }

    /// Root mean square of the standard errors, relative to the mean.
    pub fn error(&self) -> f64 {
        let variance = self.variance / f64::from(self.pixels.max(1));
        if variance == 0.0 { 0.0 } else { variance.sqrt() / self.level() }
    }
}

impl Canvas<'_> {
    /// Of the whole image.
    pub fn total(&self, job: Job) -> Result<Tally> {
        Ok(whole(&self.tallies(|_, _| 1.0, job)?))
    }

    /// The same with the error of each pixel relative to what it shows, not to the mean of the image.
    pub fn relative_total(&self, job: Job) -> Result<Tally> {
        let mean = self.total(job.part(0.0, 0.0))?.level();
        Ok(whole(&self.relative_tallies(mean, job)?))
    }

    /// A pixel with a rare bright path is bright where its scatter is large; it counts for what it shows without. Few paths
    /// leave the word to the tile.
    fn relative_tallies(&self, mean: f64, job: Job) -> Result<Vec<Tally>> {
        let weight = |pixel: &Pixel, tile: f64| {
            let shown = tile + (pixel.middling() - tile) * trust(f64::from(pixel.count()));
            if mean > 0.0 { mean / shown.max(BLACK * mean) } else { 1.0 }
        };
        self.tallies(weight, job)
    }

    /// `weight` is what the error of a pixel counts for, whose tile has this mean.
    fn tallies(&self, weight: impl Fn(&Pixel, f64) -> f64 + Sync, job: Job) -> Result<Vec<Tally>> {
        exec::map(self.grid.tiles(), job, |tile| {
            let mut tally = Tally::default();
            let shown = mean(self.tile(tile)).map_or(0.0, |(mean, _)| average(mean));
            for pixel in self.tile(tile) {
                let variance = average(pixel.variance()) * weight(pixel, shown).powi(2);
                tally.paths += u64::from(pixel.count());
                tally.pixels += 1;
                tally.most = tally.most.max(pixel.count());
                tally.mean += average(pixel.mean());
                tally.variance += variance;
                tally.spread += variance * f64::from(pixel.count());
            }
            tally
        })
    }

    /// Per tile, the mean square of the pixels' intervals relative to their luminance.
    fn doubts(&self, floor: f64, job: Job) -> Result<Vec<f64>> {
        let variance = pooled(&self.variance(job)?, job)?;
        exec::map(self.grid.tiles(), job, |tile| {
            let pixels = (0..AREA).filter_map(|i| self.grid.place(tile, i));
            let square = |(x, y): (usize, usize)| {
                // The channels of a path rise and fall together, so the error of a luminance is that of its parts.
                let error = f64::from(luminance(variance.rgb(x, y).map(f32::sqrt)));
                let value = f64::from(luminance(self.pixel(x, y).mean().as_vec3())).max(floor);
                if error == 0.0 { 0.0 } else { (NORMAL_95 * error / value).powi(2) }
            };
            pixels.map(square).sum::<f64>() / self.grid.area(tile) as f64
        })
    }
}

/// Decides pass by pass.
pub struct Plan<'p> {
    params: &'p Params,
    /// Stride and paths per pixel of the last pass that treated all alike.
    stride: usize,
    even: u32,
}

impl<'p> Plan<'p> {
    pub fn new(params: &'p Params) -> Self {
        Self { params, stride: 2 * coarse_stride(params.width, params.height), even: 0 }
    }

    /// The next pass; none if the image is as good as was asked for, or there is no time left.
    pub fn next(&mut self, canvas: &Canvas, clock: &Clock, job: Job) -> Result<Option<Pass>> {
        let Params { samples, target_error, relative_error, pixel_error, .. } = *self.params;
        if self.even > 0 && clock.is_over() {
            return Ok(None);
        }
        // A coarse image, a finer one, and so on down to one path per pixel.
        if self.stride > 1 {
            self.stride /= 2;
            self.even = 1;
            return self.alike(canvas, 1);
        }
        let has_target = target_error > 0.0 || relative_error > 0.0 || pixel_error > 0.0;
        if has_target && self.even >= EVEN.min(samples) {
            return self.where_needed(canvas, clock, job);
        }
        if self.even >= samples {
            return Ok(None);
        }
        // The same for all: doubled, or as much as there is time for.
        let doubled = if self.even < FIRST { FIRST } else { self.even.saturating_mul(2) };
        let afforded = clock.affordable().map_or(u32::MAX, |times| {
            let more = (f64::from(self.even) * times) as u32 / FIRST * FIRST;
            self.even.saturating_add(more.max(FIRST))
        });
        self.even = doubled.min(afforded.max(FIRST)).min(samples);
        self.alike(canvas, self.even)
    }

    fn alike(&self, canvas: &Canvas, count: u32) -> Result<Option<Pass>> {
        Ok(Some(Pass { stride: self.stride, ..Pass::alike(canvas.grid.tiles(), count)? }))
    }

    /// Doubles the tiles that need it most.
    fn where_needed(&self, canvas: &Canvas, clock: &Clock, job: Job) -> Result<Option<Pass>> {
        let tallies = canvas.tallies(|_, _| 1.0, job)?;
        let wanted = self.wanted(canvas, &tallies, job)?;
        let whole = whole(&tallies);

        // What they need, as far as there are paths and time for it.
        let most = self.params.samples.saturating_mul(SHARE);
        let lack = |tile: usize| {
            (wanted[tile].min(f64::from(most)) - f64::from(tallies[tile].most)).max(0.0)
                * f64::from(tallies[tile].pixels)
        };
        let mut budget: f64 = (0..tallies.len()).map(lack).sum();
        if let Some(times) = clock.affordable() {
            budget = budget.min(whole.paths as f64 * times);
        }
        let allowed = f64::from(self.params.samples) * f64::from(whole.pixels) - whole.paths as f64;
        let mut needy: Vec<(f64, usize)> = (0..tallies.len())
            .map(|tile| (wanted[tile] / f64::from(tallies[tile].most.max(1)), tile))
            .filter(|&(need, tile)| need > 1.0 && tallies[tile].most < most)
            .collect();
        // Equal needs in order of the tiles.
        needy.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));

        let mut counts: Vec<u32> = tallies.iter().map(|t| t.most).collect();
        let mut spent = 0.0;
        for (_, tile) in needy {
            let cost = f64::from(tallies[tile].most) * f64::from(tallies[tile].pixels);
            if spent > 0.0 && spent >= budget || spent + cost > allowed {
                break;
            }
            counts[tile] = counts[tile].saturating_mul(2).min(most);
            spent += cost;
        }
        Ok((spent > 0.0).then_some(Pass { counts, stride: 1 }))
    }

    /// Paths per pixel that each tile should have in the end.
    fn wanted(&self, canvas: &Canvas, tallies: &[Tally], job: Job) -> Result<Vec<f64>> {
        let Params { target_error, relative_error, pixel_error, .. } = *self.params;
        let mean = whole(tallies).level();
        let mut wanted = try_vec(tallies.len(), 0.0)?;
        if target_error > 0.0 {
            self.want_together(canvas, tallies, target_error, &mut wanted)?;
        }
        if relative_error > 0.0 {
            self.want_together(canvas, &canvas.relative_tallies(mean, job)?, relative_error, &mut wanted)?;
        }
        if pixel_error > 0.0 {
            let doubts = canvas.doubts(DARK * mean, job)?;
            for ((wanted, doubt), tally) in wanted.iter_mut().zip(doubts).zip(tallies) {
                *wanted = wanted.max(f64::from(tally.most) * doubt / f64::from(pixel_error).powi(2));
            }
        }
        Ok(wanted)
    }

    /// Raises what is wanted to the least paths that bring the error of all tiles together down to a target.
    fn want_together(&self, canvas: &Canvas, tallies: &[Tally], target: f32, wanted: &mut [f64]) -> Result<()> {
        let (whole, target) = (whole(tallies), f64::from(target));
        if whole.error() <= target {
            return Ok(());
        }
        let spreads: Vec<f64> = tallies.iter().map(|t| t.spread / f64::from(t.pixels)).collect();
        let deviations: Vec<f64> = canvas.grid.heeding_neighbours(&spreads)?.into_iter().map(f64::sqrt).collect();
        // In proportion n = k d they leave the mean square error mean(s / k d), with s the variance of single paths.
        let mean_of = |value: &dyn Fn(usize) -> f64| {
            (0..tallies.len()).map(|t| value(t) * f64::from(tallies[t].pixels)).sum::<f64>() / f64::from(whole.pixels)
        };
        let left = mean_of(&|t| if spreads[t] > 0.0 { spreads[t] / deviations[t] } else { 0.0 });
        let needed = left / (target * whole.level()).powi(2);
        let allowed = f64::from(self.params.samples) / mean_of(&|t| deviations[t]);
        wanted.iter_mut().zip(&deviations).for_each(|(w, d)| *w = w.max(needed.min(allowed) * d));
        Ok(())
    }
}

/// Of the channels.
fn average(v: DVec3) -> f64 {
    v.element_sum() / 3.0
}

/// Distance between the pixels of the coarsest image of a size: a power of two.
pub fn coarse_stride(width: usize, height: usize) -> usize {
    let mut stride = 1;
    while width.div_ceil(stride) * height.div_ceil(stride) > COARSE {
        stride *= 2;
    }
    stride
}

fn whole(tallies: &[Tally]) -> Tally {
    let mut whole = Tally::default();
    tallies.iter().for_each(|t| whole.add(t));
    whole
}
