//! Dilates masks by a radius, with the exact Euclidean distance transform (Felzenszwalb and Huttenlocher 2012).
//!
//! Example: dilate the mask of the lights by the radius of their bloom. Outside the dilated mask, bloom does not change
//! the colour of the ceiling.

use super::Image;
use crate::error::{Result, check_range};
use crate::exec;
use crate::job::Job;
use crate::maths;

/// Dilates a mask by a disc: a pixel becomes 1 if a pixel with a mask value above 0.5 lies within `radius` pixels of
/// it, else 0. Distances are measured between pixel centres; `radius` lies in `[0, 65536]`.
pub fn dilate(mask: &Image, radius: f32, job: Job) -> Result<Image> {
    check_range("radius", radius, 0.0, 65_536.0)?;
    check_range("the number of channels of the mask", mask.channels, 1, 1)?;
    let (width, height) = (mask.width, mask.height);

    // For each pixel, compute the squared distance from the nearest set pixel of its column. The image `columns` is
    // transposed.
    let mut columns = Image::new(height, width, 1)?;
    exec::for_rows(&mut columns.data, height, job.part(0.0, 0.5), |x, column| {
        let is_set = |y: usize| mask.data[y * width + x] > 0.5;
        let mut last = f32::INFINITY;
        for (y, out) in column.iter_mut().enumerate() {
            last = if is_set(y) { 0.0 } else { last + 1.0 };
            *out = last;
        }
        last = f32::INFINITY;
        for (y, out) in column.iter_mut().enumerate().rev() {
            last = if is_set(y) { 0.0 } else { last + 1.0 };
            *out = maths::powi(out.min(last), 2);
        }
    })?;

    // In each row, let f[v] be the squared distance found in column v. The squared distance at x is then the minimum
    // over v of (x - v)² + f[v], the lower envelope of one parabola per column. `hull` lists the parabolas of the
    // envelope from left to right: v, and the x from which this parabola is the lowest.
    let mut out = Image::new(width, height, 1)?;
    exec::for_rows(&mut out.data, width, job.part(0.5, 1.0), |y, row| {
        let f: Vec<f64> = (0..width).map(|x| f64::from(columns.data[x * height + y])).collect();
        let mut hull: Vec<(usize, f64)> = Vec::new();
        for x in (0..width).filter(|&x| f[x].is_finite()) {
            let mut from = f64::NEG_INFINITY;
            while let Some(&(v, start)) = hull.last() {
                let (xf, vf) = (x as f64, v as f64);
                from = (f[x] + xf * xf - f[v] - vf * vf) / (2.0 * (xf - vf));
                if from > start {
                    break;
                }
                hull.pop();
                from = f64::NEG_INFINITY;
            }
            hull.push((x, from));
        }
        let mut k = 0;
        for (x, out) in row.iter_mut().enumerate() {
            while k + 1 < hull.len() && hull[k + 1].1 <= x as f64 {
                k += 1;
            }
            let near = hull.get(k).is_some_and(|&(v, _)| {
                let d = x as f64 - v as f64;
                d * d + f[v] <= maths::powi(f64::from(radius), 2)
            });
            *out = f32::from(near);
        }
    })?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;
    use crate::rng::Rng;

    #[test]
    fn dilation_agrees_with_its_definition() {
        let dot = |x: usize, y: usize| Rng::new(3, &[x as u64, y as u64]).next_f32() < 0.04;
        let mask = Image::from_fn(31, 23, |x, y| [f32::from(dot(x, y))]).unwrap();
        for radius in [0.0, 1.0, 1.5, 3.7, 100.0] {
            let grown = dilate(&mask, radius, Monitor::default().job()).unwrap();
            for y in 0..23 {
                for x in 0..31 {
                    let near = (0..31 * 23).any(|i| {
                        let (dx, dy) = ((i % 31) as f32 - x as f32, (i / 31) as f32 - y as f32);
                        mask.data[i] > 0.5 && dx * dx + dy * dy <= radius * radius
                    });
                    assert_eq!(grown.pixel(x, y)[0], f32::from(near), "{x} {y} {radius}");
                }
            }
        }
    }

    #[test]
    fn empty_masks_stay_empty_and_colours_are_refused() {
        let empty = Image::new(9, 5, 1).unwrap();
        let monitor = Monitor::default();
        assert_eq!(dilate(&empty, 50.0, monitor.job()).unwrap(), empty);
        assert!(dilate(&empty, f32::NAN, monitor.job()).is_err());
        assert!(dilate(&Image::new(9, 5, 3).unwrap(), 1.0, monitor.job()).is_err());
    }
}
