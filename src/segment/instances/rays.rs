//! Removes the rays of a star from a lamp. The aperture of a lens draws rays around small bright lamps, so that the
//! region of the lamp has thin spikes.

use super::regions::Brightness;
use super::surroundings::Bounds;
use crate::error::Result;
use crate::image::regions::Regions as Pieces;
use crate::image::{Image, dilate, try_collect, try_vec};
use crate::job::Job;

/// Only regions whose solidity is below this may have rays. A rectangle has 0.95. [convention]
pub const MAX_SOLIDITY: f64 = 0.93;
/// Radius of the disc that the region without its rays is made of, as a share of half the region's short axis.
/// [bench photos:nostrokes]
const RADIUS: f32 = 0.5;
/// A part that no disc covers is a ray if it reaches farther from the discs than this, in radii of a disc. The corner
/// of an equilateral triangle reaches one radius. [convention]
const MIN_REACH: f32 = 1.2;
/// Minimum number of rays of a star. [convention]
const MIN_RAYS: usize = 2;
/// Minimum share of the region that remains without its rays. Rings and branched shapes keep less, because their arms
/// are thin themselves; they stay as they are. [convention]
const MIN_CORE: f64 = 0.5;

/// Returns the pixels of a region without the rays of a star; all pixels if there is no star. `short_axis` is the short
/// axis of the region in pixels.
pub fn remove(pixels: Vec<u32>, short_axis: f64, photo: &Brightness, job: Job) -> Result<Vec<u32>> {
    let radius = RADIUS * 0.5 * short_axis as f32;
    let bounds = Bounds::of(&pixels, photo, 1);
    let [across, down] = bounds.size();
    let mut outside = Image::new(across, down, 1)?;
    outside.data.fill(1.0);
    pixels.iter().for_each(|&p| outside.data[bounds.index(p, photo.width)] = 0.0);

    // Open the region: keep the pixels that lie in a disc inside the region.
    let mut centres = dilate(&outside, radius, job)?;
    centres.data.iter_mut().for_each(|v| *v = 1.0 - *v);
    let discs = dilate(&centres, radius, job)?;
    let reached = dilate(&discs, MIN_REACH * radius, job)?;
    let in_core = pixels.iter().filter(|&&p| discs.data[bounds.index(p, photo.width)] > 0.5).count();
    if (in_core as f64) < MIN_CORE * pixels.len() as f64 {
        return Ok(pixels);
    }

    // A part outside the discs is a ray if it reaches far from them.
    let mut thin = Image::new(across, down, 1)?;
    for (thin, (outside, disc)) in thin.data.iter_mut().zip(outside.data.iter().zip(&discs.data)) {
        *thin = f32::from(*outside < 0.5 && *disc < 0.5);
    }
    let pieces = Pieces::of(&thin)?;
    let mut is_ray = try_vec(pieces.count + 1, false)?;
    for (&label, _) in pieces.labels.iter().zip(&reached.data).filter(|(label, reached)| **label > 0 && **reached < 0.5)
    {
        is_ray[label as usize] = true;
    }
    if is_ray.iter().filter(|ray| **ray).count() < MIN_RAYS {
        return Ok(pixels);
    }
    let stays = |&p: &u32| !is_ray[pieces.labels[bounds.index(p, photo.width)] as usize];
    try_collect(pixels.into_iter().filter(stays))
}
