//! Error statistics of a tile or of the whole image, computed from the variances of the pixels.

use super::accumulator::Accumulator;
use super::grid::AREA;
use super::interval::NORMAL_95;
use super::pixel::Pixel;
use super::pooling::pooled_by_paths;
use super::roulette::{mean, shrinkage};
use crate::error::Result;
use crate::exec;
use crate::image::colour::luminance;
use crate::job::Job;
use crate::maths;
use glam::DVec3;

/// In the relative error of the whole image, each pixel's error is divided by the pixel's radiance, or by this share of
/// the image's mean if the pixel is darker. The corresponding limit for the target `pixel_error`,
/// `adaptive::MIN_RELATIVE_LUMINANCE`, is higher: every tile must meet that target, so a few dark pixels could delay
/// the render. Here, the errors are averaged over the image. [convention: the relative error is defined with it]
const MIN_RELATIVE_RADIANCE: f64 = 0.01;

/// Sums of paths, radiance and variance over the pixels of a tile or of the image.
#[derive(Clone, Copy, Default)]
pub struct Statistics {
    pub paths: u64,
    pub pixels: u32,
    /// Largest number of paths in a pixel.
    pub max_paths: u32,
    /// Sum, over the pixels, of the pixel's mean radiance, averaged over the channels.
    mean_sum: f64,
    /// Sum, over the pixels, of w² × the variance of the pixel's mean radiance. The factor w on the pixel's error is
    /// the result of the function `weight` that [`Accumulator::statistics`] takes.
    variance_sum: f64,
    /// Sum, over the pixels, of w² × the variance of the radiance of a single path.
    pub path_variance_sum: f64,
}

impl Statistics {
    fn add(&mut self, other: &Self) {
        self.paths += other.paths;
        self.pixels += other.pixels;
        self.max_paths = self.max_paths.max(other.max_paths);
        self.mean_sum += other.mean_sum;
        self.variance_sum += other.variance_sum;
        self.path_variance_sum += other.path_variance_sum;
    }

    /// Returns the mean radiance of the pixels, averaged over the channels.
    pub fn mean_radiance(&self) -> f64 {
        self.mean_sum / f64::from(self.pixels.max(1))
    }

    /// Returns the root mean square of the pixels' standard errors, divided by the mean radiance of the pixels; 0 if
    /// all variances are 0.
    pub fn error(&self) -> f64 {
        let variance = self.variance_sum / f64::from(self.pixels.max(1));
        if variance == 0.0 { 0.0 } else { variance.sqrt() / self.mean_radiance() }
    }
}

impl Accumulator<'_> {
    /// Returns the statistics of the whole image.
    pub fn total(&self, job: Job) -> Result<Statistics> {
        Ok(whole(&self.statistics(|_, _| 1.0, job)?))
    }

    /// Returns the statistics of the whole image, in which the error of each pixel is relative to its own radiance.
    pub fn relative_total(&self, job: Job) -> Result<Statistics> {
        let mean = self.total(job.part(0.0, 0.0))?.mean_radiance();
        Ok(whole(&self.relative_statistics(mean, job)?))
    }

    /// Returns the statistics of each tile, with the error of each pixel multiplied by `mean` / radiance of the pixel.
    /// `mean` is the mean radiance of the image. [`Statistics::error`] of the whole image, which divides by `mean`, is
    /// then the relative error. The radiance of the pixel is estimated without its brightest and darkest replication
    /// ([`Pixel::trimmed_mean`]), since a rare bright path would raise the variance and the mean alike. If the pixel
    /// has few paths, the estimate is blended with the mean of the tile.
    pub fn relative_statistics(&self, mean: f64, job: Job) -> Result<Vec<Statistics>> {
        let weight = |pixel: &Pixel, tile_mean: f64| {
            let reference = tile_mean + (pixel.trimmed_mean() - tile_mean) * shrinkage(f64::from(pixel.count()));
            if mean > 0.0 { mean / reference.max(MIN_RELATIVE_RADIANCE * mean) } else { 1.0 }
        };
        self.statistics(weight, job)
    }

    /// Returns the statistics of each tile. `weight` gets a pixel and the mean radiance of its tile, and returns the
    /// factor by which the pixel's error is multiplied.
    pub fn statistics(&self, weight: impl Fn(&Pixel, f64) -> f64 + Sync, job: Job) -> Result<Vec<Statistics>> {
        exec::map(self.grid.tiles(), job, |tile| {
            let mut sum = Statistics::default();
            let tile_mean = mean(self.tile(tile)).map_or(0.0, |(mean, _)| average(mean));
            for pixel in self.tile(tile) {
                let variance = average(pixel.variance()) * maths::powi(weight(pixel, tile_mean), 2);
                sum.paths += u64::from(pixel.count());
                sum.pixels += 1;
                sum.max_paths = sum.max_paths.max(pixel.count());
                sum.mean_sum += average(pixel.mean());
                sum.variance_sum += variance;
                sum.path_variance_sum += variance * f64::from(pixel.count());
            }
            sum
        })
    }

    /// Returns for each tile the mean square of the relative errors of its pixels. The relative error of a pixel is
    /// the half-width of its 95 % confidence interval, divided by its luminance, or by `floor` if the pixel is darker.
    pub fn relative_intervals(&self, floor: f64, job: Job) -> Result<Vec<f64>> {
        let paths = self.image(1, job, |x, y, out| out[0] = self.pixel(x, y).count() as f32)?;
        let variance = pooled_by_paths(&self.variance(job)?, &paths, job)?;
        exec::map(self.grid.tiles(), job, |tile| {
            let pixels = (0..AREA).filter_map(|i| self.grid.place(tile, i));
            let square = |(x, y): (usize, usize)| {
                // Take the luminance of the standard errors, not of the variances, because the noise of the channels
                // is correlated.
                let error = f64::from(luminance(variance.rgb(x, y).map(f32::sqrt)));
                let value = f64::from(luminance(self.pixel(x, y).mean().as_vec3())).max(floor);
                if error == 0.0 { 0.0 } else { maths::powi(NORMAL_95 * error / value, 2) }
            };
            pixels.map(square).sum::<f64>() / self.grid.area(tile) as f64
        })
    }
}

/// Returns the mean of the channels.
fn average(v: DVec3) -> f64 {
    v.element_sum() / 3.0
}

/// Adds up the statistics of all tiles.
pub fn whole(statistics: &[Statistics]) -> Statistics {
    let mut whole = Statistics::default();
    statistics.iter().for_each(|t| whole.add(t));
    whole
}
