//! What light is worth to a pixel: errors are seen relative to what it shows.
//!
//! The same light means more to a pixel in the shade than to one under the lamp, and more to a black surface's than to a
//! white one's. Paths are the longer for it. It is drawn from the paths that are there already; on these the chances of
//! those to come may depend, and no estimate is biased ([`super::super::sampler::Sampler::chance`]).

use super::grid::AREA;
use super::pixel::Pixel;
use crate::error::Result;
use crate::exec;
use crate::image::try_collect;
use crate::job::Job;
use glam::{DVec3, Vec3};

/// What is known of the surroundings counts as much as so many paths.
const PRIOR_PATHS: f64 = 8.0;
/// Light is worth at most so many times more or less than in a middling pixel.
const MAX_WEIGHT: f64 = 50.0;

/// The brightness of the middling tile, per channel; none without any paths.
pub fn median_radiance(pixels: &[Pixel], job: Job) -> Result<Option<DVec3>> {
    let tile = |i: usize| &pixels[i * AREA..(i + 1) * AREA];
    let means = exec::map(pixels.len() / AREA, job, |i| mean(tile(i)).map(|(mean, _)| mean))?;
    Ok(median(&try_collect(means.into_iter().flatten())?))
}

/// The median of each channel; none of nothing.
pub fn median(means: &[DVec3]) -> Option<DVec3> {
    let median = |channel: usize| {
        let mut values: Vec<f64> = means.iter().map(|m| m[channel]).collect();
        let middle = values.len() / 2;
        *values.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    (!means.is_empty()).then(|| DVec3::from_array([0, 1, 2].map(median)))
}

/// Mean of the pixels that have paths, and how many paths they have.
pub fn mean<'a>(pixels: impl IntoIterator<Item = &'a Pixel>) -> Option<(DVec3, f64)> {
    let (mut sum, mut count, mut paths) = (DVec3::ZERO, 0.0, 0.0);
    for pixel in pixels.into_iter().filter(|p| p.count() > 0) {
        (sum, count, paths) = (sum + pixel.mean(), count + 1.0, paths + f64::from(pixel.count()));
    }
    (count > 0.0).then(|| (sum / count, paths))
}

/// How much the mean of so many paths counts beside what is known of the surroundings, in `[0, 1)`.
pub fn shrinkage(paths: f64) -> f64 {
    paths / (paths + PRIOR_PATHS)
}

/// What is around a pixel.
pub struct RouletteWeights {
    median_radiance: DVec3,
    tile: DVec3,
}

impl RouletteWeights {
    /// Of the pixels of a tile, in an image of that [`median_radiance`].
    pub fn of(tile: &[Pixel], median_radiance: DVec3) -> Self {
        Self {
            median_radiance,
            tile: mean(tile).map_or(median_radiance, |(mean, paths)| median_radiance.lerp(mean, shrinkage(paths))),
        }
    }

    /// What light of the brightness `median_radiance` is worth to a pixel, relative to what the pixel shows, per channel; positive.
    pub fn weight(&self, pixel: &Pixel) -> Vec3 {
        let radiance = self.tile.lerp(pixel.mean(), shrinkage(f64::from(pixel.count())));
        let weight = (self.median_radiance / radiance).clamp(DVec3::splat(1.0 / MAX_WEIGHT), DVec3::splat(MAX_WEIGHT));
        // Of a channel that is dark so far nothing is known.
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
    fn light_is_worth_more_in_the_shade_and_what_it_is_where_nothing_is_known() {
        let job = Monitor::default();
        let unseen = vec![Pixel::default(); 3 * AREA];
        assert!(median_radiance(&unseen, job.job()).unwrap().is_none());
        // A lamp in view does not change what is middling.
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
        // Few paths say little: the tile speaks for a pixel that happens to be dark.
        let dark = weight(0, &pixel(DVec3::ZERO, 1)).x;
        assert!(dark > 1.0 && dark < 1.2, "{dark}");
        // No pixel is so bright or so dark that light is worth nothing, or everything.
        assert_eq!(weight(1, &pixels[AREA]).x, 1.0 / MAX_WEIGHT as f32);
        assert_eq!(weight(2, &pixel(DVec3::ZERO, 1 << 20)).x, MAX_WEIGHT as f32);
    }
}
