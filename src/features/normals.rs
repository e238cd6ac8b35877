//! Normals from the pixel grid: a plane through each pixel's neighbours.
//!
//! On a plane `n · p = c` the point of a pixel is `p = z ray`, so that `1/z = (n / c) · ray`: inverse depth is affine
//! in pixel coordinates, and the plane fit is a linear regression of `1/z` over a window, exact for exact planes. At
//! depth edges and creases the window must stay on one side: each pixel takes the best of the fits of its own window
//! and of the eight windows that have it on their border (Kuwahara et al. 1976, with planes for constants).

use super::Frustum;
use crate::error::Result;
use crate::exec;
use crate::geometry::linear;
use crate::image::Image;
use crate::job::Job;
use glam::Vec3;

/// Rows worked on together: their horizontal sums are shared.
const BAND: usize = 32;
/// A shifted window must fit this much better than the centred one to be taken.
const PREFER_CENTRED: f32 = 0.5;

/// Sums over a row of a window, `i` being the column offset and `w` the inverse depth.
#[derive(Clone, Copy, Default)]
struct RowSums {
    n: f64,
    i: f64,
    ii: f64,
    w: f64,
    iw: f64,
    ww: f64,
}

impl RowSums {
    fn of(i: f64, w: f64) -> Self {
        Self { n: 1.0, i, ii: i * i, w, iw: i * w, ww: w * w }
    }

    fn plus(&self, other: &Self, sign: f64) -> Self {
        Self {
            n: self.n + sign * other.n,
            i: self.i + sign * other.i,
            ii: self.ii + sign * other.ii,
            w: self.w + sign * other.w,
            iw: self.iw + sign * other.iw,
            ww: self.ww + sign * other.ww,
        }
    }

    /// The same sums with columns counted from `x`.
    fn about(&self, x: f64) -> Self {
        Self {
            i: self.i - x * self.n,
            ii: self.ii - 2.0 * x * self.i + x * x * self.n,
            iw: self.iw - x * self.w,
            ..*self
        }
    }
}

/// A regression plane about its pixel: `w ≈ value + dx i + dy j`, and the mean square of what it leaves.
#[derive(Clone, Copy)]
struct Fit {
    value: f32,
    dx: f32,
    dy: f32,
    residual: f32,
}

const NO_FIT: Fit = Fit { value: 0.0, dx: 0.0, dy: 0.0, residual: f32::INFINITY };

/// Unit normals in camera space, towards the camera. Pixels with confidence 0 do not count and face the camera.
pub fn fit(inverse_depth: &Image, confidence: &Image, frustum: &Frustum, radius: usize, job: Job) -> Result<Image> {
    let (width, height) = (inverse_depth.width, inverse_depth.height);
    let bands = exec::map(height.div_ceil(BAND), job.part(0.0, 0.7), |band| {
        fit_band(inverse_depth, confidence, radius, band * BAND, ((band + 1) * BAND).min(height))
    })?;
    let fit_at = |x: usize, y: usize| bands[y / BAND][(y % BAND) * width + x];

    let mut normals = Image::new(width, height, 3)?;
    let r = radius as isize;
    // Steps of normalised device coordinates, and of rays, per pixel.
    let ray_step = (frustum.right - frustum.left) / (frustum.near * width as f32);
    let ray_step_y = (frustum.bottom - frustum.top) / (frustum.near * height as f32);
    exec::for_rows(&mut normals.data, width * 3, job.part(0.7, 1.0), |y, row| {
        for (x, out) in row.chunks_exact_mut(3).enumerate() {
            let mut normal = Vec3::NEG_Z;
            if confidence.pixel(x, y)[0] > 0.0 {
                // The best window with this pixel in it, judged also by how well it meets the pixel itself.
                let w = inverse_depth.pixel(x, y)[0];
                let (mut best, mut best_cost) = (fit_at(x, y), f32::INFINITY);
                for (sx, sy) in [(0, 0), (-1, -1), (1, -1), (-1, 1), (1, 1), (0, -1), (-1, 0), (1, 0), (0, 1)] {
                    let (cx, cy) = (x as isize + sx * r, y as isize + sy * r);
                    if cx < 0 || cy < 0 || cx >= width as isize || cy >= height as isize {
                        continue;
                    }
                    let fit = fit_at(cx as usize, cy as usize);
                    let off = fit.value - fit.dx * (sx * r) as f32 - fit.dy * (sy * r) as f32 - w;
                    let centred = if (sx, sy) == (0, 0) { PREFER_CENTRED } else { 1.0 };
                    let cost = centred * (fit.residual + off * off / (2.0 * radius as f32 + 1.0));
                    if cost < best_cost {
                        (best, best_cost) = (fit, cost);
                    }
                }
                if best_cost.is_finite() {
                    normal = plane_normal(
                        best.dx,
                        best.dy,
                        w,
                        ray_step,
                        ray_step_y,
                        frustum.ray(frustum.ndc(x, y, width, height)),
                    );
                }
            }
            normal.write_to_slice(out);
        }
    })?;
    Ok(normals)
}

/// The normal of the plane `1/z = a · ray` from its inverse depth and its steps at a pixel, turned to the camera.
fn plane_normal(dx: f32, dy: f32, w: f32, step_x: f32, step_y: f32, ray: Vec3) -> Vec3 {
    let (ax, ay) = (dx / step_x, dy / step_y);
    let a = Vec3::new(ax, ay, w - ax * ray.x - ay * ray.y);
    // a · ray = w > 0: `a` points away from the camera.
    (-a).try_normalize().unwrap_or(Vec3::NEG_Z)
}

/// The fits of all pixels of rows `from..to`.
fn fit_band(inverse_depth: &Image, confidence: &Image, radius: usize, from: usize, to: usize) -> Vec<Fit> {
    let (width, height) = (inverse_depth.width, inverse_depth.height);
    let (first, last) = (from.saturating_sub(radius), (to + radius).min(height));

    // Along rows: differences of running sums, about each pixel's own column.
    let mut sums = Vec::with_capacity((last - first) * width);
    let mut running = Vec::with_capacity(width + 1);
    for y in first..last {
        running.clear();
        let mut s = RowSums::default();
        running.push(s);
        for (x, (&w, &c)) in inverse_depth.row(y).iter().zip(confidence.row(y)).enumerate() {
            if c > 0.0 {
                s = s.plus(&RowSums::of(x as f64, f64::from(w)), 1.0);
            }
            running.push(s);
        }
        for x in 0..width {
            let (a, b) = (x.saturating_sub(radius), (x + radius + 1).min(width));
            sums.push(running[b].plus(&running[a], -1.0).about(x as f64));
        }
    }

    // Along columns, sums that slide down by a row at a time; then the regression.
    let row = |y: usize| &sums[(y - first) * width..(y - first + 1) * width];
    let r = radius as f64;
    let mut windows = vec![WindowSums::default(); width];
    let mut fits = Vec::with_capacity((to - from) * width);
    for y in from..to {
        if y == from {
            for k in first..(y + radius + 1).min(height) {
                let j = k as f64 - y as f64;
                windows.iter_mut().zip(row(k)).for_each(|(window, sums)| window.add(sums, j, 1.0));
            }
        } else {
            if y > radius {
                let leaving = row(y - radius - 1);
                windows.iter_mut().zip(leaving).for_each(|(window, sums)| window.add(sums, -r, -1.0));
            }
            windows.iter_mut().for_each(WindowSums::move_down);
            if y + radius < height {
                windows.iter_mut().zip(row(y + radius)).for_each(|(window, sums)| window.add(sums, r, 1.0));
            }
        }
        fits.extend(windows.iter().map(|t| regress(&t.sums, t.j, t.jj, t.ij, t.jw)));
    }
    fits
}

/// Sums over a window, `j` being the row offset.
#[derive(Clone, Copy, Default)]
struct WindowSums {
    sums: RowSums,
    j: f64,
    jj: f64,
    ij: f64,
    jw: f64,
}

impl WindowSums {
    /// A row at offset `j` comes (`sign` 1) or goes (-1).
    fn add(&mut self, row: &RowSums, j: f64, sign: f64) {
        self.sums = self.sums.plus(row, sign);
        let j = sign * j;
        self.j += j * row.n;
        self.jj += j * j * sign * row.n;
        self.ij += j * row.i;
        self.jw += j * row.w;
    }

    /// Offsets counted from the next row.
    fn move_down(&mut self) {
        self.jj += self.sums.n - 2.0 * self.j;
        self.j -= self.sums.n;
        self.ij -= self.sums.i;
        self.jw -= self.sums.w;
    }
}

/// Least squares of `w` on `(1, i, j)`, about the means; no fit where the points lie on one line.
fn regress(t: &RowSums, tj: f64, tjj: f64, tij: f64, tjw: f64) -> Fit {
    if t.n < 3.0 {
        return NO_FIT;
    }
    let (mi, mj, mw) = (t.i / t.n, tj / t.n, t.w / t.n);
    let (cii, cij, cjj) = (t.ii - t.n * mi * mi, tij - t.n * mi * mj, tjj - t.n * mj * mj);
    let (ciw, cjw) = (t.iw - t.n * mi * mw, tjw - t.n * mj * mw);
    let Some([dx, dy]) = linear::solve([[cii, cij], [cij, cjj]], [ciw, cjw]) else { return NO_FIT };
    let left = (t.ww - t.n * mw * mw - dx * ciw - dy * cjw).max(0.0) / t.n;
    Fit { value: (mw - dx * mi - dy * mj) as f32, dx: dx as f32, dy: dy as f32, residual: left as f32 }
}
