//! Averages the estimated variances of neighbouring pixels. The averages are accurate enough for confidence intervals;
//! the estimate from a single pixel is not.

use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::job::Job;

/// Binomial weights of the pixels at distances 0, 1, 2 and 3 along an axis. [bench error_control]
const WEIGHTS: [f32; 4] = [20.0, 15.0, 6.0, 1.0];

/// Pools the variances of the pixel means over neighbouring pixels that may have different numbers of paths.
///
/// `variance` holds the variance of each pixel's mean, and `paths` the number n of paths of each pixel (0 counts as 1).
/// The variance of a single path is n × the variance of the mean. These variances are pooled by [`pooled`], and the
/// result is divided by the pixel's own n. So a pixel with many paths does not get the large variance of a neighbour
/// with few paths.
pub fn pooled_by_paths(variance: &Image, paths: &Image, job: Job) -> Result<Image> {
    let (width, channels) = (variance.width, variance.channels);
    let max_paths = paths.data.iter().fold(1f32, |max_paths, &n| max_paths.max(n));
    // Divide the numbers of paths by the largest one. The quotients are exactly 1 if all pixels have equal numbers of
    // paths, and their products with variances cannot overflow.
    let share = |x: usize, y: usize| paths.pixel(x, y)[0].max(1.0) / max_paths;
    let mut single = Image::new(width, variance.height, channels)?;
    exec::for_rows(&mut single.data, width * channels, job, |y, row| {
        for (x, out) in row.chunks_exact_mut(channels).enumerate() {
            out.iter_mut().zip(variance.pixel(x, y)).for_each(|(out, v)| *out = v * share(x, y));
        }
    })?;
    let mut pooled = pooled(&single, job)?;
    exec::for_rows(&mut pooled.data, width * channels, job, |y, row| {
        for (x, out) in row.chunks_exact_mut(channels).enumerate() {
            out.iter_mut().for_each(|v| *v /= share(x, y));
        }
    })?;
    Ok(pooled)
}

/// Returns the weighted mean of the finite variances over the 7 × 7 pixels around each pixel; infinite where the
/// pixel's own variance is infinite.
pub fn pooled(variance: &Image, job: Job) -> Result<Image> {
    let (width, height, channels) = (variance.width, variance.height, variance.channels);
    let mut along = Image::new(width, height, channels)?;
    exec::for_rows(&mut along.data, width * channels, job, |y, row| {
        for (x, out) in row.chunks_exact_mut(channels).enumerate() {
            mean_around(x, width, out, |x| variance.pixel(x, y));
        }
    })?;
    let mut pooled = Image::new(width, height, channels)?;
    exec::for_rows(&mut pooled.data, width * channels, job, |y, row| {
        for (x, out) in row.chunks_exact_mut(channels).enumerate() {
            mean_around(y, height, out, |y| along.pixel(x, y));
            for (out, own) in out.iter_mut().zip(variance.pixel(x, y)) {
                *out = if own.is_finite() { *out } else { *own };
            }
        }
    })?;
    Ok(pooled)
}

/// Computes, per channel, the weighted mean of the finite values around position `at` on a line of `n` values;
/// infinite if no value is finite.
fn mean_around<'a>(at: usize, n: usize, out: &mut [f32], value: impl Fn(usize) -> &'a [f32]) {
    let radius = WEIGHTS.len() - 1;
    for (channel, out) in out.iter_mut().enumerate() {
        let (mut sum, mut weight) = (0.0, 0.0);
        for i in at.saturating_sub(radius)..(at + radius + 1).min(n) {
            let v = value(i)[channel];
            if v.is_finite() {
                sum += WEIGHTS[i.abs_diff(at)] * v;
                weight += WEIGHTS[i.abs_diff(at)];
            }
        }
        *out = if weight > 0.0 { sum / weight } else { f32::INFINITY };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    #[test]
    fn pooling_keeps_constants_and_skips_infinite_variances() {
        let monitor = Monitor::default();
        let even = Image::from_fn(9, 5, |x, y| if (x, y) == (4, 2) { [f32::INFINITY, 2.0] } else { [3.0, 2.0] });
        let pooled = pooled(&even.unwrap(), monitor.job()).unwrap();
        for (i, p) in pooled.data.chunks(2).enumerate() {
            assert!((p[1] - 2.0).abs() < 1e-6 && (i == 2 * 9 + 4 || (p[0] - 3.0).abs() < 1e-6), "{i}: {p:?}");
        }
        assert_eq!(pooled.pixel(4, 2)[0], f32::INFINITY);
    }

    #[test]
    fn a_pixel_with_many_paths_keeps_its_small_variance_beside_pixels_with_few() {
        let monitor = Monitor::default();
        let paths = Image::from_fn(16, 8, |x, _| [if x < 8 { 16.0 } else { 4096.0 }]).unwrap();
        let variance = Image::from_fn(16, 8, |x, _| [if x < 8 { 2.0 / 16.0 } else { 2.0 / 4096.0 }]).unwrap();
        let pooled = pooled_by_paths(&variance, &paths, monitor.job()).unwrap();
        for (i, (pooled, own)) in pooled.data.iter().zip(&variance.data).enumerate() {
            assert!((pooled / own - 1.0).abs() < 1e-5, "{i}: {pooled}, {own}");
        }
        // Pixels without paths have unknown (infinite) variances, before and after pooling.
        let none = Image::from_fn(3, 3, |_, _| [0.0]).unwrap();
        let unknown = Image::from_fn(3, 3, |_, _| [f32::INFINITY]).unwrap();
        let pooled = pooled_by_paths(&unknown, &none, monitor.job()).unwrap();
        assert!(pooled.data.iter().all(|&v| v == f32::INFINITY));
    }

    #[test]
    fn one_pixel_spreads_by_its_weights() {
        let monitor = Monitor::default();
        let dot = Image::from_fn(15, 15, |x, y| [f32::from(u8::from((x, y) == (7, 7)))]).unwrap();
        let pooled = pooled(&dot, monitor.job()).unwrap();
        let weight = |d: usize| WEIGHTS.get(d).copied().unwrap_or(0.0) / 64.0;
        for (i, v) in pooled.data.iter().enumerate() {
            let expected = weight((i % 15).abs_diff(7)) * weight((i / 15).abs_diff(7));
            assert!((v - expected).abs() < 1e-7, "{i}");
        }
    }
}
