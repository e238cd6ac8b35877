//! Normals from the pixel grid: a plane through each pixel's neighbours.
//!
//! On a plane `n · p = c` the point of a pixel is `p = z ray`, so that `1/z = (n / c) · ray`: inverse depth is affine
//! in pixel coordinates, and the plane fit is a linear regression of `1/z` over a window (see `plane_fit`), exact for exact
//! planes. At depth edges and creases the window must stay on one side: each pixel takes the best of the fits of its own
//! window and of the eight windows that have it on their border (Kuwahara et al. 1976, with planes for constants).

use super::Frustum;
use super::plane_fit::{self, FitRow};
use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::job::Job;
use crate::simd::widest;

/// Rows worked on together: their sums slide down from one to the next.
const BAND: usize = 64;
/// A shifted window must fit this much better than the centred one to be taken.
const PREFER_CENTRED: f32 = 0.5;
/// Steps, in radii, to the centres of the windows that hold a pixel; of equal fits the first is taken.
const SHIFTS: [[isize; 2]; 9] = [[0, 0], [-1, -1], [1, -1], [-1, 1], [1, 1], [0, -1], [-1, 0], [1, 0], [0, 1]];

/// The best plane so far of each pixel of a row: its cost, and the steps of inverse depth along it.
struct Best {
    cost: Vec<f32>,
    dx: Vec<f32>,
    dy: Vec<f32>,
}

/// How the rays of a frustum change from pixel to pixel of a row.
#[derive(Clone, Copy)]
struct Rays {
    /// x of the first ray, and of each step.
    first_x: f32,
    step_x: f32,
    /// y of all, and its step to the next row.
    y: f32,
    step_y: f32,
}

/// Unit normals in camera space, towards the camera. Pixels with confidence 0 do not count and face the camera.
pub fn fit(inverse_depth: &Image, confidence: &Image, frustum: &Frustum, radius: usize, job: Job) -> Result<Image> {
    let (width, height) = (inverse_depth.width, inverse_depth.height);
    let bands = exec::map(height.div_ceil(BAND), job.part(0.0, 0.6), |band| {
        plane_fit::band(inverse_depth, confidence, radius, band * BAND..((band + 1) * BAND).min(height))
    })?;
    let fits_of = |y: usize| FitRow::of(&bands[y / BAND], y % BAND, width);

    let mut normals = Image::new(width, height, 3)?;
    let origin = frustum.ray(frustum.ndc(0, 0, width, height));
    let step_x = (frustum.right - frustum.left) / (frustum.near * width as f32);
    let step_y = (frustum.bottom - frustum.top) / (frustum.near * height as f32);
    let r = radius as isize;
    exec::for_rows(&mut normals.data, width * 3, job.part(0.6, 1.0), |y, row| {
        // The best window with the pixel in it, judged also by how well it meets the pixel itself.
        let w = inverse_depth.row(y);
        let mut best = Best { cost: vec![f32::INFINITY; width], dx: vec![0.0; width], dy: vec![0.0; width] };
        for [sx, sy] in SHIFTS {
            let (shift, centre) = (sx * r, y as isize + sy * r);
            let here = (-shift).max(0) as usize..width.saturating_sub(shift.max(0) as usize);
            if centre < 0 || centre >= height as isize || here.is_empty() {
                continue;
            }
            let there = here.start.wrapping_add_signed(shift)..here.end.wrapping_add_signed(shift);
            let favour = if (sx, sy) == (0, 0) { PREFER_CENTRED } else { 1.0 };
            let off_weight = 1.0 / (2.0 * radius as f32 + 1.0);
            let fits = fits_of(centre as usize).columns(there);
            let steps = [shift as f32, (sy * r) as f32];
            prefer(
                &w[here.clone()],
                fits,
                steps,
                [favour, off_weight],
                [&mut best.cost[here.clone()], &mut best.dx[here.clone()], &mut best.dy[here]],
            );
        }
        let rays = Rays { first_x: origin.x, step_x, y: origin.y + step_y * y as f32, step_y };
        plane_normals(w, confidence.row(y), &best, rays, row);
    })?;
    Ok(normals)
}

widest! {
    /// Takes the fits that cost less than the best so far: `steps` away from them, `weights` of the whole and of how far
    /// they miss the pixel.
    fn prefer(w: &[f32], fits: FitRow, steps: [f32; 2], weights: [f32; 2], best: [&mut [f32]; 3]) {
        let n = w.len();
        let [cost, dx, dy] = best;
        let (cost, dx, dy) = (&mut cost[..n], &mut dx[..n], &mut dy[..n]);
        let (value, fit_dx, fit_dy, residual) =
            (&fits.value[..n], &fits.dx[..n], &fits.dy[..n], &fits.residual[..n]);
        for x in 0..n {
            let off = value[x] - fit_dx[x] * steps[0] - fit_dy[x] * steps[1] - w[x];
            let new = weights[0] * (residual[x] + off * off * weights[1]);
            let is_better = new < cost[x];
            cost[x] = if is_better { new } else { cost[x] };
            dx[x] = if is_better { fit_dx[x] } else { dx[x] };
            dy[x] = if is_better { fit_dy[x] } else { dy[x] };
        }
    }
}

widest! {
    /// Normals of planes `1/z = a · ray` from the inverse depth `w` and its steps, turned to the camera.
    fn plane_normals(w: &[f32], confidence: &[f32], best: &Best, rays: Rays, out: &mut [f32]) {
        let n = w.len();
        let (confidence, cost, dx, dy) = (&confidence[..n], &best.cost[..n], &best.dx[..n], &best.dy[..n]);
        let (per_x, per_y) = (1.0 / rays.step_x, 1.0 / rays.step_y);
        for (x, out) in out.chunks_exact_mut(3).enumerate().take(n) {
            // a · ray = w > 0: `a` points away from the camera.
            let (ax, ay) = (dx[x] * per_x, dy[x] * per_y);
            let az = w[x] - ax * (rays.first_x + rays.step_x * x as f32) - ay * rays.y;
            let length = (ax * ax + ay * ay + az * az).sqrt();
            let is_plane = confidence[x] > 0.0 && cost[x] < f32::INFINITY && length > 0.0 && length < f32::INFINITY;
            let scale = if is_plane { -1.0 / length } else { 0.0 };
            out[0] = if is_plane { ax * scale } else { 0.0 };
            out[1] = if is_plane { ay * scale } else { 0.0 };
            out[2] = if is_plane { az * scale } else { -1.0 };
        }
    }
}
