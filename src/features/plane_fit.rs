//! Fits regression planes of inverse depth in windows around all pixels, by sliding sums:
//!
//! 1. The sums over the part of each column inside the window are updated from row to row.
//! 2. The sums over a whole window are differences of prefix sums over the columns.
//!
//! All sums are `f64`, because differences of prefix sums cancel leading digits.

use crate::image::Image;
use crate::simd::widest;
use std::ops::Range;

/// Points count as collinear if the determinant of their covariance matrix, divided by the product of the two
/// variances, is below this. For non-collinear points with integer coordinates in the largest window, this ratio is at
/// least 1e-9; rounding yields 1e-15. [rounding]
const SINGULAR: f64 = 1e-12;

/// The regression planes around the pixels of a row: `w ≈ value + dx i + dy j`, where `i` and `j` are the offsets in
/// columns and rows from the pixel. `residual` is the mean squared residual, infinite where there is no plane.
#[derive(Clone, Copy)]
pub struct FitRow<'a> {
    pub value: &'a [f32],
    pub dx: &'a [f32],
    pub dy: &'a [f32],
    pub residual: &'a [f32],
}

impl<'a> FitRow<'a> {
    /// Selects row `y` of the output of [`band`].
    pub fn of(band: &'a [f32], y: usize, width: usize) -> Self {
        let plane = |k: usize| &band[(4 * y + k) * width..(4 * y + k + 1) * width];
        Self { value: plane(0), dx: plane(1), dy: plane(2), residual: plane(3) }
    }

    pub fn columns(self, x: Range<usize>) -> Self {
        let Range { start, end } = x;
        Self {
            value: &self.value[start..end],
            dx: &self.dx[start..end],
            dy: &self.dy[start..end],
            residual: &self.residual[start..end],
        }
    }
}

/// Sums over the part of each column inside the window: `j` is the row offset, `w` the inverse depth.
struct Columns {
    n: Vec<f64>,
    j: Vec<f64>,
    jj: Vec<f64>,
    w: Vec<f64>,
    jw: Vec<f64>,
    ww: Vec<f64>,
}

/// Prefix sums over columns, where `i` is the column: the difference of two prefix sums is the sum over a window. They
/// are padded by the window's radius before the first column and after the last.
struct Running {
    /// The sums of 1 (the count n), i, i², j, j², i j, w, i w, j w and w², in this order.
    sums: [Vec<f64>; 10],
    radius: usize,
}

/// Fits planes for all pixels of some rows. Returns for each row the values, the derivatives along x and y, and the
/// residuals (see [`FitRow`]).
pub fn band(inverse_depth: &Image, confidence: &Image, radius: usize, rows: Range<usize>) -> Vec<f32> {
    let (width, height) = (inverse_depth.width, inverse_depth.height);
    let zeros = || vec![0.0; width];
    let mut columns = Columns { n: zeros(), j: zeros(), jj: zeros(), w: zeros(), jw: zeros(), ww: zeros() };
    let mut running = Running { sums: std::array::from_fn(|_| vec![0.0; width + 2 * radius + 1]), radius };
    let mut fits = vec![0.0; 4 * width * rows.len()];
    let r = radius as f64;
    for (y, out) in rows.clone().zip(fits.chunks_exact_mut(4 * width)) {
        if y == rows.start {
            for k in y.saturating_sub(radius)..(y + radius + 1).min(height) {
                columns.add(inverse_depth.row(k), confidence.row(k), k as f64 - y as f64, 1.0);
            }
        } else {
            if y > radius {
                let leaving = y - radius - 1;
                columns.add(inverse_depth.row(leaving), confidence.row(leaving), -r, -1.0);
            }
            move_down(&mut columns);
            if y + radius < height {
                columns.add(inverse_depth.row(y + radius), confidence.row(y + radius), r, 1.0);
            }
        }
        running.fill(&columns);
        regress(&running, out);
    }
    fits
}

impl Columns {
    /// Adds (`sign` = 1) or removes (`sign` = -1) an image row at the row offset `j`.
    fn add(&mut self, w: &[f32], confidence: &[f32], j: f64, sign: f64) {
        add_row(self, w, confidence, j, sign);
    }
}

widest! {
    fn add_row(to: &mut Columns, w: &[f32], confidence: &[f32], j: f64, sign: f64) {
        let width = w.len();
        let confidence = &confidence[..width];
        let (n, js, jj) = (&mut to.n[..width], &mut to.j[..width], &mut to.jj[..width]);
        let (ws, jw, ww) = (&mut to.w[..width], &mut to.jw[..width], &mut to.ww[..width]);
        for x in 0..width {
            let count = if confidence[x] > 0.0 { sign } else { 0.0 };
            let w = f64::from(w[x]);
            n[x] += count;
            js[x] += count * j;
            jj[x] += count * j * j;
            ws[x] += count * w;
            jw[x] += count * j * w;
            ww[x] += count * w * w;
        }
    }
}

widest! {
    /// Makes the sums relative to the next row: each row offset `j` becomes `j - 1`.
    fn move_down(columns: &mut Columns) {
        let width = columns.n.len();
        let (n, w) = (&columns.n[..width], &columns.w[..width]);
        let (j, jj, jw) = (&mut columns.j[..width], &mut columns.jj[..width], &mut columns.jw[..width]);
        for x in 0..width {
            jj[x] += n[x] - 2.0 * j[x];
            j[x] -= n[x];
            jw[x] -= w[x];
        }
    }
}

impl Running {
    fn fill(&mut self, columns: &Columns) {
        let width = columns.n.len();
        let Columns { n, j, jj, w, jw, ww } = columns;
        let (n, j, jj, w, jw, ww) = (&n[..width], &j[..width], &jj[..width], &w[..width], &jw[..width], &ww[..width]);
        let mut total = [0.0; 10];
        let [q0, q1, q2, q3, q4, q5, q6, q7, q8, q9] =
            self.sums.each_mut().map(|sums| &mut sums[self.radius + 1..][..width]);
        for x in 0..width {
            let i = x as f64;
            let terms = [n[x], i * n[x], i * i * n[x], j[x], jj[x], i * j[x], w[x], i * w[x], jw[x], ww[x]];
            total.iter_mut().zip(terms).for_each(|(t, v)| *t += v);
            [q0[x], q1[x], q2[x], q3[x], q4[x], q5[x], q6[x], q7[x], q8[x], q9[x]] = total;
        }
        for (sums, total) in self.sums.iter_mut().zip(total) {
            sums[self.radius + 1 + width..].fill(total);
        }
    }
}

widest! {
    /// Least-squares regression of `w` on `(1, i, j)`, from sums relative to the means, for the windows of a row. A
    /// window with fewer than three points, or with collinear points, gets no plane: its residual is infinite.
    fn regress(running: &Running, out: &mut [f32]) {
        let width = out.len() / 4;
        let [n, i, ii, j, jj, ij, w, iw, jw, ww] = running.sums.each_ref().map(|sums| {
            (&sums[..width], &sums[2 * running.radius + 1..][..width])
        });
        let (value, rest) = out.split_at_mut(width);
        let (dx, rest) = rest.split_at_mut(width);
        let (dy, residual) = rest.split_at_mut(width);
        let residual = &mut residual[..width];
        for x in 0..width {
            // Sums over the window, with columns relative to its centre.
            let at = x as f64;
            let (n, j, w) = (n.1[x] - n.0[x], j.1[x] - j.0[x], w.1[x] - w.0[x]);
            let (jj, jw, ww) = (jj.1[x] - jj.0[x], jw.1[x] - jw.0[x], ww.1[x] - ww.0[x]);
            let (sum_i, sum_ii) = (i.1[x] - i.0[x], ii.1[x] - ii.0[x]);
            let i = sum_i - at * n;
            let ii = sum_ii - 2.0 * at * sum_i + at * at * n;
            let ij = ij.1[x] - ij.0[x] - at * j;
            let iw = iw.1[x] - iw.0[x] - at * w;

            // Centre the sums about the means.
            let per_n = 1.0 / n.max(1.0);
            let (mi, mj) = (i * per_n, j * per_n);
            let (cii, cij, cjj) = (ii - mi * i, ij - mi * j, jj - mj * j);
            let (ciw, cjw) = (iw - mi * w, jw - mj * w);

            let determinant = cii * cjj - cij * cij;
            let is_plane = n >= 3.0 && determinant > SINGULAR * (cii * cjj);
            let inverse = 1.0 / if is_plane { determinant } else { 1.0 };
            let slope_x = (ciw * cjj - cjw * cij) * inverse;
            let slope_y = (cjw * cii - ciw * cij) * inverse;
            let mean = w * per_n;
            let left = (ww - mean * w - slope_x * ciw - slope_y * cjw).max(0.0) * per_n;
            value[x] = (mean - slope_x * mi - slope_y * mj) as f32;
            dx[x] = slope_x as f32;
            dy[x] = slope_y as f32;
            residual[x] = if is_plane { left as f32 } else { f32::INFINITY };
        }
    }
}
