//! Resampling of images: exact area averages for any size, halving, and Gaussian blur.

use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::job::Job;
use crate::maths;

/// Resizes an image, separately along x and y. Along an axis that shrinks, each new pixel is the exact average over the
/// length that it covers. Along an axis that grows, pixels are interpolated linearly.
pub fn resize(image: &Image, width: usize, height: usize, job: Job) -> Result<Image> {
    let columns = weights(image.width, width);
    let rows = weights(image.height, height);
    let c = image.channels;

    // Resize along x, then along y.
    let mut wide = Image::new(width, image.height, c)?;
    exec::for_rows(&mut wide.data, width * c, job.part(0.0, 0.5), |y, out| {
        let source = image.row(y);
        for (pixel, (first, taps)) in out.chunks_exact_mut(c).zip(&columns) {
            for (i, w) in taps.iter().enumerate() {
                let s = &source[(first + i) * c..(first + i + 1) * c];
                pixel.iter_mut().zip(s).for_each(|(o, v)| *o += w * v);
            }
        }
    })?;
    let mut out = Image::new(width, height, c)?;
    exec::for_rows(&mut out.data, width * c, job.part(0.5, 1.0), |y, row| {
        let (first, taps) = &rows[y];
        for (i, w) in taps.iter().enumerate() {
            row.iter_mut().zip(wide.row(first + i)).for_each(|(o, v)| *o += w * v);
        }
    })?;
    Ok(out)
}

/// Returns the filter weights along one axis, on which `to` new pixels cover `from` old pixels. For each new pixel:
/// the first old pixel that contributes, and the weights of this pixel and its successors, which sum to 1.
fn weights(from: usize, to: usize) -> Vec<(usize, Vec<f32>)> {
    let scale = from as f64 / to as f64;
    (0..to)
        .map(|i| {
            let (low, high) = if scale >= 1.0 {
                (i as f64 * scale, (i + 1) as f64 * scale)
            } else {
                // When the image grows, a box one old pixel wide around the centre of the new pixel gives bilinear
                // interpolation.
                let centre = (i as f64 + 0.5) * scale;
                ((centre - 0.5).max(0.0), (centre + 0.5).min(from as f64))
            };
            let first = (low.floor() as usize).min(from - 1);
            let last = (high.ceil() as usize).clamp(first + 1, from);
            let overlap = |p: usize| (high.min(p as f64 + 1.0) - low.max(p as f64)).max(0.0);
            let total: f64 = (first..last).map(overlap).sum();
            (first, (first..last).map(|p| (overlap(p) / total) as f32).collect())
        })
        .collect()
}

/// Returns the image at half the size, rounded up. Each new pixel is the mean of 2 × 2 pixels; an odd last column or
/// row counts twice.
pub fn half(image: &Image, job: Job) -> Result<Image> {
    let c = image.channels;
    let mut out = Image::new(image.width.div_ceil(2), image.height.div_ceil(2), c)?;
    let row_len = out.row_len();
    exec::for_rows(&mut out.data, row_len, job, |y, row| {
        let (above, below) = (image.row(2 * y), image.row((2 * y + 1).min(image.height - 1)));
        for (x, pixel) in row.chunks_exact_mut(c).enumerate() {
            let (left, right) = (2 * x * c, (2 * x + 1).min(image.width - 1) * c);
            for (k, out) in pixel.iter_mut().enumerate() {
                *out = 0.25 * ((above[left + k] + above[right + k]) + (below[left + k] + below[right + k]));
            }
        }
    })?;
    Ok(out)
}

/// Returns `count` copies of the image, at 1/2, 1/4, … of its size. The list ends early after a copy of a single pixel.
pub fn halvings(image: &Image, count: usize, job: Job) -> Result<Vec<Image>> {
    let mut copies: Vec<Image> = Vec::new();
    while copies.len() < count {
        let last = copies.last().unwrap_or(image);
        if last.width == 1 && last.height == 1 {
            break;
        }
        copies.push(half(last, job)?);
    }
    Ok(copies)
}

/// Gaussian blur with a standard deviation of `sigma` pixels, truncated at three standard deviations. The border pixels
/// are repeated outwards. If `sigma` is 0 or less, the image is copied.
pub fn blur(image: &Image, sigma: f32, job: Job) -> Result<Image> {
    if sigma <= 0.0 {
        return image.try_clone();
    }
    let radius = (3.0 * sigma).ceil() as isize;
    let mut kernel: Vec<f32> =
        (-radius..=radius).map(|i| maths::exp(-0.5 * maths::powi(i as f32 / sigma, 2))).collect();
    let total: f32 = kernel.iter().sum();
    kernel.iter_mut().for_each(|k| *k /= total);
    let c = image.channels;
    let clamp = |i: isize, n: usize| i.clamp(0, n as isize - 1) as usize;

    let mut wide = Image::new(image.width, image.height, c)?;
    exec::for_rows(&mut wide.data, image.row_len(), job.part(0.0, 0.5), |y, out| {
        let source = image.row(y);
        // Compute the interior of a row tap by tap, which vectorises, and the ends of the row pixel by pixel. Both sum
        // the taps in the same order.
        let border = (radius as usize * c).min(out.len());
        let inside = border..(out.len() - border).max(border);
        for (k, w) in kernel.iter().enumerate() {
            let from = &source[(k * c).min(source.len())..];
            out[inside.clone()].iter_mut().zip(from).for_each(|(o, v)| *o += w * v);
        }
        for x in (0..inside.start / c).chain(inside.end / c..image.width) {
            let pixel = &mut out[x * c..(x + 1) * c];
            for (k, w) in kernel.iter().enumerate() {
                let s = clamp(x as isize + k as isize - radius, image.width) * c;
                pixel.iter_mut().zip(&source[s..s + c]).for_each(|(o, v)| *o += w * v);
            }
        }
    })?;
    let mut out = Image::new(image.width, image.height, c)?;
    exec::for_rows(&mut out.data, image.row_len(), job.part(0.5, 1.0), |y, row| {
        for (k, w) in kernel.iter().enumerate() {
            let s = clamp(y as isize + k as isize - radius, image.height);
            row.iter_mut().zip(wide.row(s)).for_each(|(o, v)| *o += w * v);
        }
    })?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    #[test]
    fn resizing_keeps_the_mean_and_constants() {
        let monitor = Monitor::default();
        let image = Image::from_fn(37, 23, |x, y| [(x * y % 11) as f32, 2.0]).unwrap();
        let mean = |i: &Image| i.data.iter().step_by(2).sum::<f32>() / (i.width * i.height) as f32;
        for (w, h) in [(1, 1), (5, 23), (36, 22)] {
            let small = resize(&image, w, h, monitor.job()).unwrap();
            assert!((mean(&small) - mean(&image)).abs() < 1e-4);
        }
        let large = resize(&image, 100, 90, monitor.job()).unwrap();
        assert!(large.data.iter().skip(1).step_by(2).all(|&v| (v - 2.0).abs() < 1e-5));
        assert_eq!(resize(&image, 37, 23, monitor.job()).unwrap(), image);
    }

    #[test]
    fn halving_takes_means_and_counts_odd_ends_twice() {
        let image = Image::from_fn(5, 3, |x, y| [(x + 10 * y) as f32, 1.0]).unwrap();
        let small = half(&image, Monitor::default().job()).unwrap();
        assert_eq!((small.width, small.height), (3, 2));
        let first: Vec<f32> = small.data.iter().step_by(2).copied().collect();
        assert_eq!(first, [5.5, 7.5, 9.0, 20.5, 22.5, 24.0]);
        assert!(small.data.iter().skip(1).step_by(2).all(|&v| v == 1.0));
    }

    #[test]
    fn blur_spreads_an_impulse_by_its_sigma() {
        let mut image = Image::new(41, 41, 1).unwrap();
        image.pixel_mut(20, 20)[0] = 1.0;
        let blurred = blur(&image, 2.0, Monitor::default().job()).unwrap();
        let total: f32 = blurred.data.iter().sum();
        let variance: f32 = (0..41 * 41).map(|i| ((i % 41) as f32 - 20.0).powi(2) * blurred.data[i]).sum();
        assert!((total - 1.0).abs() < 1e-5);
        assert!((variance - 4.0).abs() < 0.15, "{variance}");
    }
}
