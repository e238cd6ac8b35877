//! Resampling through a homography: elliptical weighted averages (Heckbert 1989) where the source is minified, bicubic
//! interpolation (Catmull-Rom) where it is magnified.

use crate::error::{Error, Result};
use crate::exec;
use crate::geometry::Homography;
use crate::image::Image;
use crate::job::Job;
use glam::{DMat2, DVec2};

/// Variance of the Gaussian that reconstructs the source and of the one that bounds the band of the result, in pixels
/// of each.
const VARIANCE: f64 = 0.25;

/// The Gaussian is cut at this many standard deviations.
const CUT: f64 = 2.5;

/// Most source samples across an ellipse: larger ones are sampled on a coarser lattice.
const MOST_ACROSS: f64 = 96.0;

/// Fills an image of the given size, the pixel at `p` from the source at `to_source(p)`. Where that is outside the source
/// or behind the camera the result is 0.
pub fn warp(source: &Image, to_source: &Homography, width: usize, height: usize, job: Job) -> Result<Image> {
    if !to_source.0.is_finite() {
        return Err(Error::argument("the homography has entries that are not finite"));
    }
    let mut out = Image::new(width, height, source.channels)?;
    let channels = source.channels;
    let front = front_sign(to_source, width, height);
    exec::for_rows(&mut out.data, width * channels, job, |y, row| {
        for (x, pixel) in row.chunks_exact_mut(channels).enumerate() {
            let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            if let Some((q, jacobian)) = locate(to_source, p, front)
                && inside(source, q)
            {
                let squared = jacobian * jacobian.transpose();
                // The longest axis of the ellipse a pixel covers, squared.
                let trace = squared.x_axis.x + squared.y_axis.y;
                let longest = trace / 2.0 + (trace * trace / 4.0 - squared.determinant()).max(0.0).sqrt();
                if longest <= 1.2 { cubic(source, q, pixel) } else { ellipse(source, q, squared, longest, pixel) }
            }
        }
    })?;
    Ok(out)
}

/// The sign of the third coordinate in front of the camera: that of the centre, which is taken to be visible.
pub fn front_sign(to_source: &Homography, width: usize, height: usize) -> f64 {
    to_source.apply_homogeneous(DVec2::new(width as f64, height as f64) / 2.0).z.signum()
}

/// Where a pixel's centre lies in the source and the derivative there; `None` behind the camera.
pub fn locate(to_source: &Homography, p: DVec2, front: f64) -> Option<(DVec2, DMat2)> {
    let q = to_source.apply_homogeneous(p);
    if !(q.z * front > 0.0) {
        return None;
    }
    let m = &to_source.0;
    let at = q.truncate() / q.z;
    let column = |c: glam::DVec3| (c.truncate() - at * c.z) / q.z;
    let jacobian = DMat2::from_cols(column(m.x_axis), column(m.y_axis));
    (at.is_finite() && jacobian.is_finite()).then_some((at, jacobian))
}

fn inside(source: &Image, q: DVec2) -> bool {
    q.x >= 0.0 && q.y >= 0.0 && q.x <= source.width as f64 && q.y <= source.height as f64
}

/// Catmull-Rom interpolation, the border extended; kept within the range of the samples, so that a lamp throws no ring of
/// negative light.
fn cubic(source: &Image, q: DVec2, out: &mut [f32]) {
    let (x, y) = (q.x - 0.5, q.y - 0.5);
    let (x0, y0) = (x.floor(), y.floor());
    let weights = |t: f32| {
        [
            ((2.0 - t) * t - 1.0) * t / 2.0,
            ((3.0 * t - 5.0) * t * t + 2.0) / 2.0,
            ((4.0 - 3.0 * t) * t + 1.0) * t / 2.0,
            (t - 1.0) * t * t / 2.0,
        ]
    };
    let (wx, wy) = (weights((x - x0) as f32), weights((y - y0) as f32));
    let clamp = |v: f64, size: usize| v.clamp(0.0, (size - 1) as f64) as usize;
    let columns: [usize; 4] = std::array::from_fn(|i| clamp(x0 + i as f64 - 1.0, source.width));
    let rows: [&[f32]; 4] = std::array::from_fn(|j| source.row(clamp(y0 + j as f64 - 1.0, source.height)));
    for (channel, out) in out.iter_mut().enumerate() {
        let (mut low, mut high, mut sum) = (f32::INFINITY, f32::NEG_INFINITY, 0.0);
        for (row, wy) in rows.iter().zip(wy) {
            let values = columns.map(|column| row[column * source.channels + channel]);
            for (value, wx) in values.into_iter().zip(wx) {
                (low, high) = (low.min(value), high.max(value));
                sum += wx * wy * value;
            }
        }
        // Not `clamp`: without a finite sample there is no range.
        *out = sum.max(low).min(high);
    }
}

/// The source averaged under a Gaussian of covariance `VARIANCE (J Jᵀ + 1)`; what lies outside has no weight.
fn ellipse(source: &Image, q: DVec2, squared: DMat2, longest: f64, out: &mut [f32]) {
    let covariance = (squared + DMat2::IDENTITY) * VARIANCE;
    let conic = covariance.inverse();
    let reach = DVec2::new(covariance.x_axis.x.sqrt(), covariance.y_axis.y.sqrt()) * CUT;
    let across = 2.0 * CUT * ((longest + 1.0) * VARIANCE).sqrt();
    let step = (across / MOST_ACROSS).ceil().max(1.0);
    let range = |centre: f64, reach: f64, size: usize| {
        let low = (centre - reach - 0.5).ceil().max(0.0);
        (low, (centre + reach - 0.5).floor().min(size as f64 - 1.0))
    };
    let ((x_low, x_high), (y_low, y_high)) = (range(q.x, reach.x, source.width), range(q.y, reach.y, source.height));
    out.fill(0.0);
    let mut total = 0.0f32;
    let mut y = y_low;
    while y <= y_high {
        let row = source.row(y as usize);
        let dy = y + 0.5 - q.y;
        let mut x = x_low;
        while x <= x_high {
            let dx = x + 0.5 - q.x;
            let r2 = conic.x_axis.x * dx * dx + 2.0 * conic.x_axis.y * dx * dy + conic.y_axis.y * dy * dy;
            if r2 <= CUT * CUT {
                let w = (-0.5 * r2 as f32).exp();
                let s = &row[x as usize * source.channels..];
                out.iter_mut().zip(s).for_each(|(o, v)| *o += w * v);
                total += w;
            }
            x += step;
        }
        y += step;
    }
    if total > 0.0 {
        out.iter_mut().for_each(|o| *o /= total);
    } else {
        cubic(source, q, out);
    }
}
