//! Resampling through a homography, the distortion of a lens, or a map given on a grid: bicubic interpolation
//! (Catmull-Rom) where the source is magnified, the mean over the pixel's footprint where it is minified.
//!
//! The parallelogram that a pixel covers is replaced by the sheared rectangle with the same second moments (see
//! [`Footprints`]). Rectangles large in both directions are sampled from a coarser level of a pyramid. Rectangles that
//! are still longer than the 4 × 4 samples that a filter reads (its taps) are divided into equal parts, as in Feline
//! (McCormack et al. 1999).

use super::footprint::{Footprints, Map, RUN, extent, locate};
use super::gather::{store, sum};
use super::grid_map::GridMap;
use super::taps::{MAX_SIDE, Part, Taps, weigh};
use crate::error::{Error, Result};
use crate::exec;
use crate::geometry::{Homography, PhotoMap, Radial};
use crate::image::{Image, pyramid};
use crate::job::Job;
use crate::simd::{Level, widest};
use glam::{DMat3, DVec2, Vec4};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Maximum number of parts of a footprint. Footprints that need more parts use a coarser pyramid level. On the
/// coarsest level, this is the maximum number of parts along x and the maximum number along y.
const MAX_PARTS: usize = 16;

/// Number of rows per band, the unit of work. The first row of each band is examined to find the number of pyramid
/// levels needed.
const BAND: usize = 8;

/// Resamples the source to an image of the given size: the pixel at `p` shows the source at `to_source(p)`. Footprints
/// that extend past the source's border use the border's values. Pixels whose position lies outside the source or
/// behind the camera are 0. A pixel is not finite if one of the samples it depends on is not finite.
pub fn warp(source: &Image, to_source: &Homography, width: usize, height: usize, job: Job) -> Result<Image> {
    warp_photo(source, &PhotoMap::from(*to_source), width, height, job)
}

/// Returns the photo that an ideal lens would have taken, with the same size and principal point. Pixels that the photo
/// does not show are 0. If the lens has no distortion, the result is an exact copy of the photo.
pub fn undistort(photo: &Image, lens: &Radial, job: Job) -> Result<Image> {
    if lens.is_none() {
        return photo.try_clone();
    }
    let map = PhotoMap { homography: Homography(DMat3::IDENTITY), lens: *lens };
    warp_photo(photo, &map, photo.width, photo.height, job)
}

/// Like [`warp`], but resamples a photo through a homography and the distortion of its lens in one step.
pub fn warp_photo(source: &Image, to_source: &PhotoMap, width: usize, height: usize, job: Job) -> Result<Image> {
    let PhotoMap { homography, lens } = to_source;
    if !homography.0.is_finite() {
        return Err(Error::argument("the homography has entries that are not finite"));
    }
    if !(lens.centre.is_finite() && lens.bend.is_finite()) {
        return Err(Error::argument(format!(
            "the lens has the centre {} and the bend {}; both must be finite",
            lens.centre, lens.bend
        )));
    }
    let map = Map {
        to_source: homography.0.to_cols_array(),
        front: homography.apply_homogeneous(DVec2::new(width as f64, height as f64) / 2.0).z.signum(),
        lens: (!lens.is_none()).then_some(*lens),
        grid: None,
        size: [source.width as f64, source.height as f64],
    };
    resample(source, &Target { map, width }, height, job)
}

/// Like [`warp`], but resamples through a map that is given on a grid.
pub fn warp_grid(source: &Image, to_source: &GridMap, job: Job) -> Result<Image> {
    let map = Map {
        to_source: [0.0; 9],
        front: 1.0,
        lens: None,
        grid: Some(to_source.try_clone()?),
        size: [source.width as f64, source.height as f64],
    };
    resample(source, &Target { map, width: to_source.width }, to_source.height, job)
}

fn resample(source: &Image, target: &Target, height: usize, job: Job) -> Result<Image> {
    let width = target.width;
    let mut out = Image::new(width, height, source.channels)?;

    let wanted = exec::map(height.div_ceil(BAND), job.part(0.0, 0.05), |band| highest_level(target, band * BAND))?;
    let wanted = wanted.into_iter().max().unwrap_or(0);
    let smaller = pyramid::halvings(source, wanted, job.part(0.05, 0.2))?;
    let levels: Vec<&Image> = std::iter::once(source).chain(&smaller).collect();

    let row_len = width * source.channels;
    let job = job.part(0.2, 1.0);
    let done = AtomicUsize::new(0);
    exec::for_runs(&mut out.data, BAND * row_len, job, |first, band| {
        fill(Level::widest(), &levels, target, first / row_len, band);
        let rows = done.fetch_add(BAND, Ordering::Relaxed) + BAND;
        job.report(rows.min(height) as f64 / height as f64);
    })?;
    Ok(out)
}

/// The map from output pixels to the source image, and the width of the output image in pixels.
struct Target {
    map: Map,
    width: usize,
}

widest! {
    /// Returns the coarsest pyramid level that a row needs.
    fn highest_level(target: &Target, row: usize) -> usize {
        let mut footprints = Footprints::EMPTY;
        let mut highest = 0;
        for x in (0..target.width).step_by(RUN) {
            locate(&target.map, row, x, &mut footprints);
            highest = highest.max(choose_sampling(&footprints, usize::MAX).map_or(0, |p| p.level));
        }
        highest
    }
}

widest! {
    /// Computes the output rows from `first_row` on.
    fn fill(instructions: Level, levels: &[&Image], target: &Target, first_row: usize, rows: &mut [f32]) {
        let channels = levels[0].channels;
        let (mut footprints, mut taps, mut sums) = (Footprints::EMPTY, Taps::EMPTY, [Vec4::ZERO; RUN]);
        for (y, row) in rows.chunks_exact_mut(target.width * channels).enumerate() {
            for x in (0..target.width).step_by(RUN) {
                let count = RUN.min(target.width - x);
                let out = &mut row[x * channels..(x + count) * channels];
                locate(&target.map, first_row + y, x, &mut footprints);
                footprints.is_seen[count..].fill(false);
                let sampling = choose_sampling(&footprints, levels.len());
                let Some(Sampling { level, parts: [across, down] }) = sampling else { continue };
                let (seen, source) = (&footprints.is_seen, levels[level]);
                let scale = 1.0 / (1u64 << level) as f32;
                for channel in 0..if channels == 3 { 1 } else { channels } {
                    sums.fill(Vec4::ZERO);
                    for at in 0..across * down {
                        let part = Part { at: [at % across, at / across], of: [across, down], scale };
                        weigh(&footprints, &part, source, &mut taps);
                        sum(instructions, source, channel, &taps, seen, &mut sums);
                    }
                    store(&sums, across * down, channels, channel, out);
                }
            }
        }
    }
}

/// The pyramid level that a run samples, and the number of parts of each footprint along x and y.
struct Sampling {
    level: usize,
    parts: [usize; 2],
}

/// Chooses the finest pyramid level on which the shortest side of the footprints fits into the taps, and no footprint
/// needs more than [`MAX_PARTS`] parts. If none of the `levels` levels suffices, takes the coarsest. `None` if no pixel
/// is visible.
#[inline(always)]
fn choose_sampling(footprints: &Footprints, levels: usize) -> Option<Sampling> {
    let [shortest, width, height] = extent(footprints)?;
    let (mut level, mut scale) = (0, 1.0);
    loop {
        let parts = [width, height].map(|side| ((side * scale / MAX_SIDE).ceil() as usize).max(1));
        if shortest * scale <= MAX_SIDE && parts[0].saturating_mul(parts[1]) <= MAX_PARTS || level + 1 >= levels {
            return Some(Sampling { level, parts: parts.map(|n| n.min(MAX_PARTS)) });
        }
        (level, scale) = (level + 1, 0.5 * scale);
    }
}

#[cfg(test)]
mod tests;
