//! Builds the surface (inverse depth, normals and confidence) from the caller's depth map or from a neutral prior.

use super::frustum::Frustum;
use super::input::{DepthKind, DepthMap};
use super::normals;
use crate::error::{Error, Result};
use crate::exec;
use crate::image::Image;
use crate::job::Job;

/// The estimated surface at each pixel. Stores inverse depth `1/z`, which is affine in pixel coordinates on a plane
/// `n · p = c`: the point is `p = z ray`, so `1/z = (n · ray) / c`.
pub struct Surface {
    /// Inverse depth `1/z`, positive. The depth `z` has the same unit of length as [`Frustum::near`].
    pub inverse_depth: Image,
    /// Unit normals in camera space, towards the camera.
    pub normals: Image,
    /// Confidence in the depth of each pixel, in `[0, 1]`. It is 0 where the depth was filled in from the surroundings
    /// of a hole.
    pub confidence: Image,
}

/// Confidence in the neutral prior. [convention]
const NEUTRAL_CONFIDENCE: f32 = 0.05;
/// Depths are clamped to within this factor of the median; more extreme depths are not meaningful. With a median of 3
/// m, the range is 0.3 mm to 30 km, so any value from 1e3 to 1e5 leaves the depths of a room unchanged. [convention]
const MAX_RATIO: f32 = 1e4;
/// Maximum number of depth samples from which quantiles are estimated.
const QUANTILE_SAMPLES: usize = 1 << 16;
/// Quantile of the inverse depths that is taken for the nearest depth. It leaves out isolated wrong values.
/// [convention]
const NEAREST: f64 = 0.98;

/// Builds the surface from the caller's depth map. Scales the depth so that its 2 % quantile lies on the near plane,
/// and fills holes from their surroundings.
///
/// Errors: more than one channel (`InvalidArgument`); no positive finite depth (`Degenerate`).
pub fn from_map(map: &DepthMap, frustum: &Frustum, radius: usize, job: Job) -> Result<Surface> {
    let depth = map.image;
    let (width, height) = (depth.width, depth.height);
    if depth.channels != 1 {
        return Err(Error::argument(format!("depth has {} channels; it must have 1", depth.channels)));
    }

    // Convert distances along the ray to distances along z; mark holes by 0.
    let inverse_at = |x: usize, y: usize, d: f32| {
        let per_z = match map.kind {
            DepthKind::AlongZ => 1.0,
            DepthKind::AlongRay => frustum.ray(frustum.ndc(x, y, width, height)).length(),
        };
        if d > 0.0 && d.is_finite() { per_z / d } else { 0.0 }
    };
    let inverse_row = |y: usize| depth.row(y).iter().enumerate().map(move |(x, &d)| inverse_at(x, y, d));

    // Normalise the scale: only ratios of depth are meaningful.
    let mut known = sample_known(depth, inverse_at, job.part(0.0, 0.15))?;
    if known.is_empty() {
        return Err(Error::degenerate(format!(
            "depth has no positive finite value in its {width} x {height} pixels; omit it to use the built-in layout"
        )));
    }
    let mut quantile = |q: f64| {
        let k = ((known.len() - 1) as f64 * q).round() as usize;
        *known.select_nth_unstable_by(k, f32::total_cmp).1
    };
    let (median, nearest) = (quantile(0.5), quantile(NEAREST));
    let (low, high) = (median / MAX_RATIO, median.min(f32::MAX / MAX_RATIO) * MAX_RATIO);
    let nearest = nearest.clamp(low, high);
    let (inverse, confidence) = exec::both(|| Image::new(width, height, 1), || Image::new(width, height, 1));
    let (mut inverse, mut confidence) = (inverse?, confidence?);
    exec::for_rows(&mut inverse.data, width, job.part(0.15, 0.2), |y, row| {
        for (out, w) in row.iter_mut().zip(inverse_row(y)) {
            *out = if w > 0.0 { (w.clamp(low, high) / nearest) / frustum.near } else { 0.0 };
        }
    })?;
    exec::for_rows(&mut confidence.data, width, job.part(0.2, 0.25), |y, row| {
        row.iter_mut().zip(inverse.row(y)).for_each(|(c, &w)| *c = f32::from(w > 0.0));
    })?;

    // Fit normals to measured pixels only, then fill the holes.
    let normals = normals::fit(&inverse, &confidence, frustum, radius, job.part(0.25, 0.8))?;
    let mut surface = Surface { inverse_depth: inverse, normals, confidence };
    fill_holes(&mut surface, job.part(0.8, 1.0))?;
    Ok(surface)
}

/// Returns every n-th known inverse depth, where n is the smallest number for which there are at most
/// [`QUANTILE_SAMPLES`].
fn sample_known(depth: &Image, inverse_at: impl Fn(usize, usize, f32) -> f32 + Sync, job: Job) -> Result<Vec<f32>> {
    let (width, height) = (depth.width, depth.height);
    let at = |x: usize, y: usize| inverse_at(x, y, depth.data[y * width + x]);
    let is_known = |w: &f32| *w > 0.0 && *w < f32::INFINITY;
    let counts = exec::map(height, job.part(0.0, 0.5), |y| {
        depth.row(y).iter().enumerate().map(|(x, &d)| usize::from(is_known(&inverse_at(x, y, d)))).sum::<usize>()
    })?;
    let stride = counts.iter().sum::<usize>().div_ceil(QUANTILE_SAMPLES).max(1);
    let mut before = 0usize;
    let mut skips = Vec::with_capacity(height);
    for count in &counts {
        // In this row, skip to the first known pixel whose index among all known pixels is a multiple of the stride.
        skips.push(before.next_multiple_of(stride) - before);
        before += count;
    }
    let sampled = exec::map(height, job.part(0.5, 1.0), |y| -> Vec<f32> {
        if counts[y] == width {
            return (skips[y]..width).step_by(stride).map(|x| at(x, y)).collect();
        }
        (0..width).map(|x| at(x, y)).filter(is_known).skip(skips[y]).step_by(stride).collect()
    })?;
    Ok(sampled.concat())
}

/// Builds the prior for an interior of which nothing is known: farthest at mid-height, nearer towards the ceiling above
/// and the floor below. At mid-height, `1/z` is `1 / √(near far)`. It rises quadratically with the distance from
/// mid-height, to twice this value at the top and the bottom border of the photo.
pub fn neutral(width: usize, height: usize, frustum: &Frustum, radius: usize, job: Job) -> Result<Surface> {
    let middle = 1.0 / (frustum.near * frustum.far).sqrt();
    let mut inverse_depth = Image::new(width, height, 1)?;
    exec::for_rows(&mut inverse_depth.data, width, job.part(0.0, 0.2), |y, row| {
        let v = frustum.ndc(0, y, width, height).y;
        row.fill(middle * (1.0 + v * v));
    })?;
    let mut confidence = Image::new(width, height, 1)?;
    confidence.data.fill(NEUTRAL_CONFIDENCE);
    let normals = normals::fit(&inverse_depth, &confidence, frustum, radius, job.part(0.2, 1.0))?;
    Ok(Surface { inverse_depth, normals, confidence })
}

/// Fills holes (confidence 0) by the pull-push algorithm (Gortler et al. 1996): averages the known values to the
/// coarser levels of a pyramid (pull), then fills the holes of each level from the next coarser one (push).
fn fill_holes(surface: &mut Surface, job: Job) -> Result<()> {
    let (width, height) = (surface.confidence.width, surface.confidence.height);
    let has_holes = exec::map(height, job.part(0.0, 0.0), |y| surface.confidence.row(y).contains(&0.0))?;
    if !has_holes.contains(&true) {
        return Ok(());
    }
    // Channels: inverse depth and normal, both multiplied by a weight that is 1 for known pixels and 0 for holes; the
    // weight itself is the fifth channel.
    let mut base = Image::new(width, height, 5)?;
    for (i, out) in base.data.chunks_exact_mut(5).enumerate() {
        if surface.confidence.data[i] > 0.0 {
            out[0] = surface.inverse_depth.data[i];
            out[1..4].copy_from_slice(&surface.normals.data[3 * i..3 * i + 3]);
            out[4] = 1.0;
        }
    }
    // Pull: each level sums four pixels of the next finer level. If the sum of their weights exceeds 1, divide all
    // channels by this sum.
    let mut levels = vec![base];
    while let Some(fine) = levels.last().filter(|l| l.width > 1 || l.height > 1) {
        job.check()?;
        let (w, h) = (fine.width.div_ceil(2), fine.height.div_ceil(2));
        let mut coarse = Image::new(w, h, 5)?;
        for y in 0..fine.height {
            for x in 0..fine.width {
                let p = fine.pixel(x, y);
                coarse.pixel_mut(x / 2, y / 2).iter_mut().zip(p).for_each(|(o, v)| *o += v);
            }
        }
        for p in coarse.data.chunks_exact_mut(5).filter(|p| p[4] > 1.0) {
            let weight = p[4];
            p.iter_mut().for_each(|v| *v /= weight);
        }
        levels.push(coarse);
    }
    // Push: fill the missing weight from the next coarser level by bilinear interpolation.
    for fine in (0..levels.len() - 1).rev() {
        job.check()?;
        let (finer, coarser) = levels.split_at_mut(fine + 1);
        let (level, coarse) = (&mut finer[fine], &coarser[0]);
        for y in 0..level.height {
            for x in 0..level.width {
                let missing = 1.0 - level.pixel(x, y)[4];
                if missing > 0.0 {
                    let (u, v) = ((x as f64 + 0.5) / 2.0, (y as f64 + 0.5) / 2.0);
                    let add: [f32; 5] = std::array::from_fn(|c| coarse.sample(u, v, c) * missing);
                    level.pixel_mut(x, y).iter_mut().zip(add).for_each(|(o, a)| *o += a);
                }
            }
        }
    }
    for (i, filled) in levels[0].data.chunks_exact(5).enumerate() {
        if surface.confidence.data[i] == 0.0 && filled[4] > 0.0 {
            surface.inverse_depth.data[i] = filled[0] / filled[4];
            let normal = glam::Vec3::from_slice(&filled[1..4]).try_normalize().unwrap_or(glam::Vec3::NEG_Z);
            normal.write_to_slice(&mut surface.normals.data[3 * i..3 * i + 3]);
        }
    }
    Ok(())
}
