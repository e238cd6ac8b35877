//! Estimates normals from the depth image, by fitting a plane to each pixel's neighbourhood.
//!
//! On a plane `n · p = c` the point of a pixel is `p = z ray`, so `1/z = (n / c) · ray`: inverse depth is affine in
//! pixel coordinates. The plane fit is therefore a linear regression of `1/z` over a window (see `plane_fit`), exact
//! for exact planes. At depth edges and creases the window must stay on one side: each pixel takes the best fit among
//! its own window and the eight windows that have the pixel on their border (Kuwahara et al. 1976, with planes instead
//! of constants).

use super::frustum::Frustum;
use super::plane_fit::{self, FitRow};
use crate::error::Result;
use crate::exec;
use crate::geometry::Radial;
use crate::image::Image;
use crate::job::Job;
use crate::simd::widest;

/// Number of rows that one task fits. Within these rows, the window sums are updated from row to row; the next task
/// starts new sums.
const BAND: usize = 64;
/// Factor on the cost of the centred window. A shifted window is preferred only if its cost is below this share of the
/// cost of the centred window. With a value near 1, noise alone shifts windows on planes. With a much smaller value,
/// windows stay centred on creases that are faint compared with the noise. [convention]
const PREFER_CENTRED: f32 = 0.5;
/// Offsets, in radii, from a pixel to the centres of its windows. Of equally good windows, the first is taken.
const SHIFTS: [[isize; 2]; 9] = [[0, 0], [-1, -1], [1, -1], [-1, 1], [1, 1], [0, -1], [-1, 0], [1, 0], [0, 1]];

/// Number of pixels of a row whose windows are selected together: the candidates stay in the first-level cache.
const TILE: usize = 128;
/// Number of pixels whose best planes are held in registers.
const LANES: usize = 16;

/// The best plane of each pixel of a tile: its cost, and the derivatives of inverse depth along x and y.
struct Best {
    cost: [f32; TILE],
    dx: [f32; TILE],
    dy: [f32; TILE],
}

/// The plane fits of the windows that lie at one of the offsets [`SHIFTS`] from the pixels of a tile.
#[derive(Clone, Copy)]
struct Windows<'a> {
    fits: FitRow<'a>,
    /// Offset from the pixel to the window centre, in columns and rows.
    steps: [f32; 2],
    /// Factor on the cost of these windows; a smaller factor favours them.
    favour: f32,
}

/// Ray directions of a tile of pixels.
#[derive(Clone, Copy)]
struct Rays {
    /// x of the first ray (`first_x`), and its step per pixel (`step_x`).
    first_x: f32,
    step_x: f32,
    /// y of all rays (`y`), and its step per row (`step_y`).
    y: f32,
    step_y: f32,
}

/// Computes unit normals in camera space, towards the camera. Pixels of confidence 0 are ignored and get a normal
/// facing the camera.
pub fn fit(inverse_depth: &Image, confidence: &Image, frustum: &Frustum, radius: usize, job: Job) -> Result<Image> {
    let (width, height) = (inverse_depth.width, inverse_depth.height);
    let bands = || {
        exec::map(height.div_ceil(BAND), job.part(0.0, 0.6), |band| {
            plane_fit::band(inverse_depth, confidence, radius, band * BAND..((band + 1) * BAND).min(height))
        })
    };
    // Allocate the output in parallel with the fits, because allocation takes time.
    let (bands, normals) = exec::both(bands, || Image::new(width, height, 3));
    let (bands, mut normals) = (bands?, normals?);
    let fits_of = |y: usize| FitRow::of(&bands[y / BAND], y % BAND, width);

    // Neglect the distortion of the lens. At the corners of the photo, the relative error of the derivatives is about
    // three times the distortion: 10 % for a barrel distortion of 3 %.
    let ideal = Frustum { lens: Radial::NONE, ..*frustum };
    let origin = ideal.ray(ideal.ndc(0, 0, width, height));
    let step_x = (frustum.right - frustum.left) / (frustum.near * width as f32);
    let step_y = (frustum.bottom - frustum.top) / (frustum.near * height as f32);
    let r = radius as isize;
    let off_weight = 1.0 / (2.0 * radius as f32 + 1.0);
    exec::for_rows(&mut normals.data, width * 3, job.part(0.6, 1.0), |y, row| {
        let w = inverse_depth.row(y);
        // Near the left and right border, fewer windows lie inside the image. Split each row there, so that all pixels
        // of a tile have the same windows.
        let inner = radius.min(width)..width.saturating_sub(radius).max(radius.min(width));
        for part in [0..inner.start, inner.clone(), inner.end..width] {
            for start in part.clone().step_by(TILE) {
                let tile = start..(start + TILE).min(part.end);
                let windows = SHIFTS.map(|[sx, sy]| {
                    let (shift, centre) = (sx * r, y as isize + sy * r);
                    let there = tile.start as isize + shift..tile.end as isize + shift;
                    let is_inside =
                        (0..height as isize).contains(&centre) && there.start >= 0 && there.end <= width as isize;
                    is_inside.then(|| Windows {
                        fits: fits_of(centre as usize).columns(there.start as usize..there.end as usize),
                        steps: [shift as f32, (sy * r) as f32],
                        favour: if (sx, sy) == (0, 0) { PREFER_CENTRED } else { 1.0 },
                    })
                });
                let best = best_of(&w[tile.clone()], &windows, off_weight);
                let first_x = origin.x + step_x * tile.start as f32;
                let rays = Rays { first_x, step_x, y: origin.y + step_y * y as f32, step_y };
                let out = &mut row[3 * tile.start..3 * tile.end];
                plane_normals(&w[tile.clone()], &confidence.row(y)[tile], &best, rays, out);
            }
        }
    })?;
    Ok(normals)
}

widest! {
    /// Selects for each pixel the window of lowest cost. The cost is the window's factor `favour`, times the sum of
    /// the mean squared residual over the window and `off_weight` times the squared residual at the pixel itself.
    fn best_of(w: &[f32], windows: &[Option<Windows>; 9], off_weight: f32) -> Best {
        let mut best = Best { cost: [f32::INFINITY; TILE], dx: [0.0; TILE], dy: [0.0; TILE] };
        for start in (0..w.len()).step_by(LANES) {
            let w = lanes(w, start);
            // Write to new arrays: updating in place compiles to masked stores, which are slower.
            let (mut cost, mut dx, mut dy) = ([f32::INFINITY; LANES], [0.0; LANES], [0.0; LANES]);
            for Windows { fits, steps, favour } in windows.iter().flatten() {
                let (value, residual) = (lanes(fits.value, start), lanes(fits.residual, start));
                let (fit_dx, fit_dy) = (lanes(fits.dx, start), lanes(fits.dy, start));
                let new: [f32; LANES] = std::array::from_fn(|k| {
                    let off = value[k] - fit_dx[k] * steps[0] - fit_dy[k] * steps[1] - w[k];
                    favour * (residual[k] + off * off * off_weight)
                });
                let is_better: [bool; LANES] = std::array::from_fn(|k| new[k] < cost[k]);
                let better = |new: [f32; LANES], old: [f32; LANES]| -> [f32; LANES] {
                    std::array::from_fn(|k| if is_better[k] { new[k] } else { old[k] })
                };
                (cost, dx, dy) = (better(new, cost), better(fit_dx, dx), better(fit_dy, dy));
            }
            best.cost[start..start + LANES].copy_from_slice(&cost);
            best.dx[start..start + LANES].copy_from_slice(&dx);
            best.dy[start..start + LANES].copy_from_slice(&dy);
        }
        best
    }
}

/// Returns `LANES` values from `start` on, padded with zeros.
#[inline(always)]
fn lanes(values: &[f32], start: usize) -> [f32; LANES] {
    match values.get(start..start + LANES).map(TryInto::try_into) {
        Some(Ok(whole)) => whole,
        _ => std::array::from_fn(|k| values.get(start + k).copied().unwrap_or(0.0)),
    }
}

widest! {
    /// Computes normals of the planes `1/z = a · ray` from the inverse depth `w` and its derivatives. The normals
    /// point towards the camera.
    fn plane_normals(w: &[f32], confidence: &[f32], best: &Best, rays: Rays, out: &mut [f32]) {
        let n = w.len().min(TILE);
        let (w, confidence) = (&w[..n], &confidence[..n]);
        let (per_x, per_y) = (1.0 / rays.step_x, 1.0 / rays.step_y);
        let mut planes = [[0.0; TILE]; 3];
        let [nx, ny, nz] = &mut planes;
        for x in 0..n {
            // Since a · ray = w > 0, `a` points away from the camera.
            let (ax, ay) = (best.dx[x] * per_x, best.dy[x] * per_y);
            let az = w[x] - ax * (rays.first_x + rays.step_x * x as f32) - ay * rays.y;
            let length = (ax * ax + ay * ay + az * az).sqrt();
            let is_plane =
                (confidence[x] > 0.0) & (best.cost[x] < f32::INFINITY) & (length > 0.0) & (length < f32::INFINITY);
            let scale = -1.0 / length;
            nx[x] = if is_plane { ax * scale } else { 0.0 };
            ny[x] = if is_plane { ay * scale } else { 0.0 };
            nz[x] = if is_plane { az * scale } else { -1.0 };
        }
        for (x, out) in out.as_chunks_mut::<3>().0.iter_mut().enumerate().take(n) {
            *out = [nx[x], ny[x], nz[x]];
        }
    }
}
