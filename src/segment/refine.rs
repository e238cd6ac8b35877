//! Edge-aware refinement: the guided filter makes the probabilities follow the edges of the photo (He, Sun and Tang
//! 2013, "Guided Image Filtering"). The guide image consists of the first three features, which are the colour.
//!
//! In the window around each pixel, an affine function of the colour I is fitted to the probability, `p ≈ a · I + b`.
//! A penalty keeps `a` small where colour varies by less than the tolerance. The refined probability of a pixel is the
//! mean over the fits of all windows that contain the pixel.
//!
//! Sums over windows are running sums, so the time does not depend on the radius. Rows are processed in bands of fixed
//! height, each with margins above and below. A task therefore needs memory for one band only, and the bits of the
//! result do not depend on the number of threads.

use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_vec, try_with_capacity};
use crate::job::Job;
use crate::simd::widest;
use std::ops::Range;

/// The image is filtered in bands of this many rows, in parallel.
const BAND: usize = 64;

/// Sums over the pixels of a window that lie in the region, for the guide colour I and the probability p. Elements: 1,
/// I (3), p, I p (3), upper triangle of I Iᵀ (6), unused (2).
type Moments = [f64; 16];
/// Sums of the coefficients of the fits `a · I + b` over the pixels of a window. Elements: number of fits, a (3), b,
/// unused (3).
type Fits = [f64; 8];

/// The input and the settings of the filter.
#[derive(Clone, Copy)]
pub struct Refinement<'a> {
    /// The features of each pixel. The first three channels are the guide image; fewer channels are allowed.
    pub features: &'a Image,
    pub confidence: &'a Image,
    /// The filter ignores pixels whose region value is at most 0.5, and leaves their confidence unchanged.
    pub region: Option<&'a Image>,
    /// Half-width of the windows, in pixels, at least 1.
    pub radius: usize,
    /// Colour differences below this value are smoothed over, in units of the guide image; > 0.
    pub tolerance: f64,
}

/// Runs the filter and returns the refined probabilities, in `[0, 1]`.
pub fn run(refinement: &Refinement, job: Job) -> Result<Image> {
    let (width, height) = (refinement.confidence.width, refinement.confidence.height);
    let bands = exec::map(height.div_ceil(BAND), job, |k| {
        refinement.band(k * BAND..((k + 1) * BAND).min(height), job.part(0.0, 0.0))
    })?;
    let mut data = try_with_capacity(width * height)?;
    for band in bands {
        data.extend_from_slice(&band?);
    }
    Ok(Image { width, height, channels: 1, data })
}

impl Refinement<'_> {
    /// Computes the refined probabilities of the given rows.
    fn band(&self, rows: Range<usize>, job: Job) -> Result<Vec<f32>> {
        let (width, height, radius) = (self.confidence.width, self.confidence.height, self.radius);
        let around = |y: usize| y.saturating_sub(radius)..(y + radius + 1).min(height);

        // Fit all windows that reach into the band.
        let windows = around(rows.start).start..around(rows.end - 1).end;
        let mut fits = try_vec(windows.len() * width, [0.0f32; 5])?;
        let mut columns = try_vec(width, [0.0; 16])?;
        let mut held = 0..0;
        for (y, fits) in windows.clone().zip(fits.chunks_exact_mut(width)) {
            job.check()?;
            slide(&mut held, around(y), |y, sign| self.add_moments(y, sign, &mut columns));
            fit_row(self, &Line { y, columns: &columns }, fits);
        }

        // Average the fits over the windows that contain each pixel.
        let mut out = try_vec(rows.len() * width, 0.0)?;
        let mut columns = try_vec(width, [0.0; 8])?;
        let mut held = 0..0;
        for (y, out) in rows.zip(out.chunks_exact_mut(width)) {
            job.check()?;
            slide(&mut held, around(y), |y, sign| {
                add_fits(&fits[(y - windows.start) * width..][..width], sign, &mut columns);
            });
            mean_row(self, y, &columns, out);
        }
        Ok(out)
    }

    fn weight(&self, x: usize, y: usize) -> f64 {
        self.region.map_or(1.0, |region| f64::from(region.data[y * region.width + x] > 0.5))
    }

    /// Adds the moments of row `y`'s pixels to the sums of their columns if `sign` is 1, or subtracts them if `sign` is
    /// -1.
    fn add_moments(&self, y: usize, sign: f64, columns: &mut [Moments]) {
        let row = MomentRow { features: self.features.row(y), probability: self.confidence.row(y), sign };
        match self.region {
            None => add_row(&row, self.features.channels, &[], columns),
            Some(region) => add_row(&row, self.features.channels, region.row(y), columns),
        }
    }
}

struct MomentRow<'a> {
    features: &'a [f32],
    probability: &'a [f32],
    sign: f64,
}

/// For each column of the image, the sums of its moments over the rows of the windows around row `y`.
struct Line<'a> {
    y: usize,
    columns: &'a [Moments],
}

/// Moves running sums from the rows `held` to the rows `wanted`: calls `add(y, 1.0)` for each row that enters, and
/// `add(y, -1.0)` for each row that leaves. Then sets `held` to `wanted`.
fn slide(held: &mut Range<usize>, wanted: Range<usize>, mut add: impl FnMut(usize, f64)) {
    (held.end.max(wanted.start)..wanted.end).for_each(|y| add(y, 1.0));
    (held.start..held.end.min(wanted.start)).for_each(|y| add(y, -1.0));
    *held = wanted;
}

/// The guide image at a pixel: the first three features; missing channels are 0.
#[inline(always)]
fn guide(features: &[f32], channels: usize, x: usize) -> [f64; 3] {
    std::array::from_fn(|c| if c < channels { f64::from(features[x * channels + c]) } else { 0.0 })
}

widest! {
    fn add_row(row: &MomentRow, channels: usize, region: &[f32], columns: &mut [Moments]) {
        for (x, column) in columns.iter_mut().enumerate() {
            let weight = if region.get(x).is_none_or(|w| *w > 0.5) { row.sign } else { 0.0 };
            let [r, g, b] = guide(row.features, channels, x);
            let p = f64::from(row.probability[x]);
            let of_pixel = [
                1.0, r, g, b, p, r * p, g * p, b * p, r * r, r * g, r * b, g * g, g * b, b * b, 0.0, 0.0,
            ];
            for k in 0..16 {
                column[k] += weight * of_pixel[k];
            }
        }
    }
}

widest! {
    /// In the window around each pixel of a row, fits an affine function `a · I + b` of the colour I to the
    /// probabilities (the guided filter). A fit is stored as five values: 1, a (3 values) and b. The 1 counts the fits
    /// when they are averaged. For pixels outside the region, all five values are 0.
    fn fit_row(of: &Refinement, line: &Line, fits: &mut [[f32; 5]]) {
        let width = fits.len();
        let epsilon = of.tolerance * of.tolerance;
        let mut sum = [0.0; 16];
        for column in &line.columns[..of.radius.min(width)] {
            for k in 0..16 {
                sum[k] += column[k];
            }
        }
        for (x, fit) in fits.iter_mut().enumerate() {
            if let Some(column) = line.columns.get(x + of.radius) {
                for k in 0..16 {
                    sum[k] += column[k];
                }
            }
            if x > of.radius {
                let column = &line.columns[x - of.radius - 1];
                for k in 0..16 {
                    sum[k] -= column[k];
                }
            }
            *fit = [0.0; 5];
            if of.weight(x, line.y) > 0.0 {
                let [a, b, c, d] = affine(&sum, epsilon).map(|v| v as f32);
                let is_finite = a.is_finite() && b.is_finite() && c.is_finite() && d.is_finite();
                // If the sums are so large that the fit is not finite, use the mean probability of the window.
                *fit = if is_finite { [1.0, a, b, c, d] } else { [1.0, 0.0, 0.0, 0.0, (sum[4] / sum[0]) as f32] };
            }
        }
    }
}

/// Returns the coefficients of a window's fit: `a = (Σ + ε E)⁻¹ cov(I, p)` (3 values) and `b = p̄ - a · Ī`. Σ is the
/// covariance matrix of the colours I, E is the identity matrix, and ε is the squared tolerance. p̄ and Ī are the means
/// in the window.
#[inline(always)]
fn affine(sum: &Moments, epsilon: f64) -> [f64; 4] {
    let per_n = 1.0 / sum[0];
    // Enlarge the penalty by the rounding error of the running sums, so that rounding alone does not make `a` large.
    let epsilon = epsilon + 1e-12 * per_n * (sum[8] + sum[11] + sum[13]);
    let [r, g, b, p] = [1, 2, 3, 4].map(|k| sum[k] * per_n);
    let covariance = |k: usize, u: f64, v: f64| sum[k] * per_n - u * v;
    let variance = |k: usize, u: f64| covariance(k, u, u).max(0.0) + epsilon;
    let (rp, gp, bp) = (covariance(5, r, p), covariance(6, g, p), covariance(7, b, p));
    let (rg, rb, gb) = (covariance(9, r, g), covariance(10, r, b), covariance(12, g, b));

    // Decompose the matrix into L D Lᵀ. No pivot may fall below ε, whatever the rounding.
    let d0 = variance(8, r);
    let (l10, l20) = (rg / d0, rb / d0);
    let d1 = (variance(11, g) - l10 * rg).max(epsilon);
    let t = gb - l20 * rg;
    let l21 = t / d1;
    let d2 = (variance(13, b) - l20 * rb - l21 * t).max(epsilon);
    let y1 = gp - l10 * rp;
    let y2 = bp - l20 * rp - l21 * y1;
    let a2 = y2 / d2;
    let a1 = y1 / d1 - l21 * a2;
    let a0 = rp / d0 - l10 * a1 - l20 * a2;
    [a0, a1, a2, p - a0 * r - a1 * g - a2 * b]
}

widest! {
    fn add_fits(fits: &[[f32; 5]], sign: f64, columns: &mut [Fits]) {
        for (column, fit) in columns.iter_mut().zip(fits) {
            for k in 0..5 {
                column[k] += sign * f64::from(fit[k]);
            }
        }
    }
}

widest! {
    fn mean_row(of: &Refinement, y: usize, columns: &[Fits], out: &mut [f32]) {
        let features = of.features.row(y);
        let mut sum = [0.0; 8];
        for column in &columns[..of.radius.min(columns.len())] {
            for k in 0..8 {
                sum[k] += column[k];
            }
        }
        for (x, out) in out.iter_mut().enumerate() {
            if let Some(column) = columns.get(x + of.radius) {
                for k in 0..8 {
                    sum[k] += column[k];
                }
            }
            if x > of.radius {
                let column = &columns[x - of.radius - 1];
                for k in 0..8 {
                    sum[k] -= column[k];
                }
            }
            *out = of.confidence.data[y * columns.len() + x];
            if of.weight(x, y) > 0.0 {
                let [r, g, b] = guide(features, of.features.channels, x);
                let value = (sum[1] * r + sum[2] * g + sum[3] * b + sum[4]) / sum[0];
                *out = value.clamp(0.0, 1.0) as f32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exec::Pool;
    use crate::job::Monitor;
    use crate::rng::Rng;

    fn refined(refinement: &Refinement) -> Image {
        run(refinement, Monitor::default().job()).unwrap()
    }

    fn noise(width: usize, height: usize, seed: u64) -> Image {
        Image::from_fn(width, height, |x, y| [Rng::new(seed, &[x as u64, y as u64]).next_f32()]).unwrap()
    }

    /// The refined probabilities by the filter's definition, window by window.
    fn by_definition(of: &Refinement) -> Vec<f64> {
        let (width, height) = (of.confidence.width, of.confidence.height);
        let window = |x: usize, y: usize| {
            let rows = y.saturating_sub(of.radius)..(y + of.radius + 1).min(height);
            let columns = x.saturating_sub(of.radius)..(x + of.radius + 1).min(width);
            let pixels = rows.flat_map(move |y| columns.clone().map(move |x| (x, y)));
            pixels.filter(|&(x, y)| of.weight(x, y) > 0.0)
        };
        let fit = |x: usize, y: usize| {
            let mut sum = [0.0; 16];
            for (x, y) in window(x, y) {
                let [r, g, b] = guide(of.features.row(y), of.features.channels, x);
                let p = f64::from(of.confidence.pixel(x, y)[0]);
                let add = [1.0, r, g, b, p, r * p, g * p, b * p, r * r, r * g, r * b, g * g, g * b, b * b, 0.0, 0.0];
                sum.iter_mut().zip(add).for_each(|(s, a)| *s += a);
            }
            affine(&sum, of.tolerance * of.tolerance)
        };
        let value = |i: usize| {
            let (x, y) = (i % width, i / width);
            let [r, g, b] = guide(of.features.row(y), of.features.channels, x);
            let fits: Vec<[f64; 4]> = window(x, y).map(|(x, y)| fit(x, y)).collect();
            let sum: f64 = fits.iter().map(|[p, q, s, t]| p * r + q * g + s * b + t).sum();
            if of.weight(x, y) > 0.0 { sum / fits.len() as f64 } else { f64::from(of.confidence.data[i]) }
        };
        (0..width * height).map(value).collect()
    }

    #[test]
    fn bands_and_running_sums_are_the_definition() {
        let features = Image::from_fn(37, 150, |x, y| {
            let mut rng = Rng::new(2, &[x as u64, y as u64]);
            [100.0 * rng.next_f32(), rng.next_f32(), 10.0 * rng.next_f32(), 7.0]
        })
        .unwrap();
        let (confidence, region) = (noise(37, 150, 3), noise(37, 150, 4));
        for region in [None, Some(&region)] {
            let of = Refinement { features: &features, confidence: &confidence, region, radius: 3, tolerance: 2.0 };
            let (got, expected) = (refined(&of), by_definition(&of));
            for (got, expected) in got.data.iter().zip(expected) {
                assert!((f64::from(*got) - expected.clamp(0.0, 1.0)).abs() < 1e-5, "{got} {expected}");
            }
        }
    }

    #[test]
    fn the_solution_is_that_of_the_normal_equations() {
        let mut rng = Rng::new(8, &[]);
        for _ in 0..100 {
            let pixels: Vec<[f64; 4]> = (0..9).map(|_| std::array::from_fn(|_| rng.next_f64())).collect();
            let mut sum = [0.0; 16];
            for [r, g, b, p] in &pixels {
                let add =
                    [1.0, *r, *g, *b, *p, r * p, g * p, b * p, r * r, r * g, r * b, g * g, g * b, b * b, 0.0, 0.0];
                sum.iter_mut().zip(add).for_each(|(s, a)| *s += a);
            }
            let a = affine(&sum, 0.01);
            // At the minimum, the gradient of Σ (a · I + b - p)² + n ε |a|² must be zero.
            let residual = |q: &[f64; 4]| a[0] * q[0] + a[1] * q[1] + a[2] * q[2] + a[3] - q[3];
            for c in 0..3 {
                let slope: f64 = pixels.iter().map(|q| residual(q) * q[c]).sum::<f64>() + 9.0 * 0.01 * a[c];
                assert!(slope.abs() < 1e-9, "{slope}");
            }
            assert!(pixels.iter().map(residual).sum::<f64>().abs() < 1e-12);
        }
    }

    #[test]
    fn a_blurred_border_snaps_to_the_edge_and_noise_goes() {
        // Two colours that meet at a sharp edge, and a noisy probability that rises across that edge over 16 pixels.
        let features = Image::from_fn(96, 80, |x, _| [if x < 48 { 30.0 } else { 70.0 }, 0.0, 0.0]).unwrap();
        let confidence = Image::from_fn(96, 80, |x, y| {
            let noise = Rng::new(5, &[x as u64, y as u64]).next_f32() - 0.5;
            [((x as f32 - 44.0) / 16.0 + 0.5 + 0.4 * noise).clamp(0.0, 1.0)]
        })
        .unwrap();
        let of = Refinement { features: &features, confidence: &confidence, region: None, radius: 12, tolerance: 4.0 };
        let wrong = |image: &Image| {
            let is_wrong = |(i, p): (usize, &f32)| (*p > 0.5) != (i % 96 >= 48);
            image.data.iter().enumerate().filter(|&p| is_wrong(p)).count()
        };
        let got = refined(&of);
        assert!(wrong(&confidence) > 200 && wrong(&got) == 0, "{} {}", wrong(&confidence), wrong(&got));
        assert!(got.data.iter().all(|p| (0.0..=1.0).contains(p)));
    }

    #[test]
    fn what_is_constant_stays_and_extremes_stay_finite() {
        for (guide, radius) in [(0.0, 1), (1e18, 5), (-3.0, 4096)] {
            let features = Image::from_fn(33, 9, |_, _| [guide, guide, 0.0]).unwrap();
            let confidence = Image::from_fn(33, 9, |_, _| [0.7]).unwrap();
            let of = Refinement { features: &features, confidence: &confidence, region: None, radius, tolerance: 0.1 };
            assert!(refined(&of).data.iter().all(|p| (p - 0.7).abs() < 1e-3), "{guide} {radius}");
        }
        // An image of one channel that is 0, 100 or 1e18 at random; then an image of one pixel.
        let wild = Image::from_fn(40, 70, |x, y| match Rng::new(6, &[x as u64, y as u64]).next_f32() {
            v if v < 0.3 => [0.0],
            v if v < 0.6 => [100.0],
            _ => [1e18],
        })
        .unwrap();
        let confidence = noise(40, 70, 7);
        let of = Refinement { features: &wild, confidence: &confidence, region: None, radius: 2, tolerance: 0.1 };
        assert!(refined(&of).data.iter().all(|p| (0.0..=1.0).contains(p)));
        let one = noise(1, 1, 1);
        let of = Refinement { features: &one, confidence: &one, region: None, radius: 7, tolerance: 1.0 };
        assert!((refined(&of).data[0] - one.data[0]).abs() < 1e-6);
    }

    #[test]
    fn the_bits_do_not_depend_on_the_number_of_threads_and_a_cancelled_job_ends() {
        let (features, confidence) = (noise(50, 200, 1), noise(50, 200, 2));
        let of = Refinement { features: &features, confidence: &confidence, region: None, radius: 9, tolerance: 0.1 };
        let with = |threads: usize| Pool::new(threads).unwrap().run(|| refined(&of));
        assert!(with(1) == with(3));
        let monitor = Monitor::default();
        monitor.cancel();
        assert!(run(&of, monitor.job()).is_err());
    }
}
