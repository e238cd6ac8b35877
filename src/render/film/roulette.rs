//! Weights for the survival probabilities of Russian roulette. The weight of a pixel is the median radiance of the
//! image divided by the radiance of the pixel.
//!
//! Errors matter relative to the radiance of the pixel: an error of 1 cd/m² is 10 % of a pixel of 10 cd/m², but 0.1 %
//! of a pixel of 1000 cd/m². Paths of dark pixels are therefore continued with a higher probability. The weights come
//! from earlier paths. This causes no bias, because the random number that decides on survival is independent of these
//! paths ([`super::super::sampler::Sampler::chance`]).

use super::grid::AREA;
use super::pixel::Pixel;
use crate::error::Result;
use crate::exec;
use crate::image::try_collect;
use crate::job::Job;
use glam::{DVec3, Vec3};

/// A measured mean radiance is blended with a prior, which counts as this number of paths. The prior of a pixel is the
/// mean of its tile; the prior of a tile is the median of the image. Roulette is unbiased with any weights, so any
/// value from 4 to 16 gives the same expected image. [convention]
const PRIOR_PATHS: f64 = 8.0;
/// Upper bound on the ratio of the median radiance to a pixel's radiance; its reciprocal is the lower bound. Like
/// `PRIOR_PATHS`, it does not change the expected image; any value from 25 to 100 changes the roulette only of pixels
/// that are darker or brighter than the median by more than four f-stops. [convention]
const MAX_WEIGHT: f64 = 50.0;

/// Returns the median, over the tiles, of the mean radiance of a tile, per channel; `None` if no pixel has paths.
pub fn median_radiance(pixels: &[Pixel], job: Job) -> Result<Option<DVec3>> {
    let tile = |i: usize| &pixels[i * AREA..(i + 1) * AREA];
    let means = exec::map(pixels.len() / AREA, job, |i| mean(tile(i)).map(|(mean, _)| mean))?;
    Ok(median(&try_collect(means.into_iter().flatten())?))
}

/// Returns the median of each channel; `None` for an empty list.
pub fn median(means: &[DVec3]) -> Option<DVec3> {
    let median = |channel: usize| {
        let mut values: Vec<f64> = means.iter().map(|m| m[channel]).collect();
        let middle = values.len() / 2;
        *values.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    (!means.is_empty()).then(|| DVec3::from_array([0, 1, 2].map(median)))
}

/// Returns the mean radiance of the pixels that have paths, and the total number of their paths; `None` if no pixel has
/// paths.
pub fn mean<'a>(pixels: impl IntoIterator<Item = &'a Pixel>) -> Option<(DVec3, f64)> {
    let (mut sum, mut count, mut paths) = (DVec3::ZERO, 0.0, 0.0);
    for pixel in pixels.into_iter().filter(|p| p.count() > 0) {
        (sum, count, paths) = (sum + pixel.mean(), count + 1.0, paths + f64::from(pixel.count()));
    }
    (count > 0.0).then(|| (sum / count, paths))
}

/// Returns the weight n / (n + [`PRIOR_PATHS`]), in `[0, 1)`, with which a mean of n paths is blended with its prior.
pub fn shrinkage(paths: f64) -> f64 {
    paths / (paths + PRIOR_PATHS)
}

/// Computes the roulette weights of a tile's pixels, from the median radiance of the image and the mean radiance of
/// the tile (`tile`).
pub struct RouletteWeights {
    median_radiance: DVec3,
    tile: DVec3,
}

impl RouletteWeights {
    /// Prepares the weights of a tile from its pixels and the [`median_radiance`] of the image.
    pub fn of(tile: &[Pixel], median_radiance: DVec3) -> Self {
        Self {
            median_radiance,
            tile: mean(tile).map_or(median_radiance, |(mean, paths)| median_radiance.lerp(mean, shrinkage(paths))),
        }
    }

    /// Returns the median radiance of the image divided by the radiance of a pixel, per channel, limited by
    /// [`MAX_WEIGHT`]. The radiance is the pixel's mean blended with the mean of the tile; for a pixel without paths,
    /// it is the mean of the tile alone.
    pub fn weight(&self, pixel: &Pixel) -> Vec3 {
        let radiance = self.tile.lerp(pixel.mean(), shrinkage(f64::from(pixel.count())));
        let weight = (self.median_radiance / radiance).clamp(DVec3::splat(1.0 / MAX_WEIGHT), DVec3::splat(MAX_WEIGHT));
        // Use the weight 1 in channels whose median radiance is 0: there, the ratio would be 0 or 0 / 0.
        DVec3::select(self.median_radiance.cmpgt(DVec3::ZERO), weight, DVec3::ONE).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    fn pixel(radiance: DVec3, count: u32) -> Pixel {
        let mut pixel = Pixel::default();
        pixel.extend(count, |_, indices| radiance * indices.len() as f64);
        pixel
    }

    #[test]
    fn roulette_weights_are_larger_in_the_shade_and_one_without_paths() {
        let job = Monitor::default();
        let unseen = vec![Pixel::default(); 3 * AREA];
        assert!(median_radiance(&unseen, job.job()).unwrap().is_none());
        // One bright tile, a lamp in view, does not change the median.
        let mut pixels = unseen;
        for (tile, radiance) in [2.0, 1000.0, 0.5].into_iter().enumerate() {
            pixels[tile * AREA..(tile + 1) * AREA].fill(pixel(DVec3::new(radiance, radiance, 0.0), 64));
        }
        let median_radiance = median_radiance(&pixels, job.job()).unwrap().unwrap();
        assert_eq!(median_radiance, DVec3::new(2.0, 2.0, 0.0));
        let weight = |tile: usize, pixel: &Pixel| {
            RouletteWeights::of(&pixels[tile * AREA..(tile + 1) * AREA], median_radiance).weight(pixel)
        };
        assert!((weight(0, &pixels[0]) - Vec3::ONE).abs().max_element() < 1e-5);
        assert!((weight(2, &pixels[2 * AREA]) - Vec3::new(4.0, 4.0, 1.0)).abs().max_element() < 0.05);
        // If a pixel has few paths and is dark by chance, its weight comes mainly from its tile.
        let dark = weight(0, &pixel(DVec3::ZERO, 1)).x;
        assert!(dark > 1.0 && dark < 1.2, "{dark}");
        // Weights are bounded on both sides.
        assert_eq!(weight(1, &pixels[AREA]).x, 1.0 / MAX_WEIGHT as f32);
        assert_eq!(weight(2, &pixel(DVec3::ZERO, 1 << 20)).x, MAX_WEIGHT as f32);
    }
}
