//! Judges of stylised pictures: fine detail against the exemplar, and likeness to a picture that is known to be right.

use glam::Vec3;
use luxfer::image::Image;
use luxfer::image::colour::{delta_e_2000, linear_to_lab, linear_to_srgb, luminance};

/// Number of bins of guide luminance, each with an equal share of the target.
const BINS: usize = 16;
/// Minimum number of exemplar pixels in a bin that counts.
const MIN_PIXELS: usize = 200;
/// Standard deviation, in pixels, of the Gaussian whose residue is the finest octave.
const OCTAVE: f64 = 1.0;
/// Standard deviation, in pixels, of the window of SSIM, and its constants for values in `[0, 1]` (Wang et al. 2004).
const WINDOW: f64 = 1.5;
const SSIM: [f64; 2] = [1e-4, 9e-4];

/// One channel of an image.
#[derive(Clone)]
pub struct Plane {
    width: usize,
    values: Vec<f64>,
}

impl Plane {
    /// Luminance as on a display, in `[0, 1]` and rounded to 8 bits per channel.
    pub fn of(image: &Image) -> Self {
        let shown = |v: f32| (linear_to_srgb(v).clamp(0.0, 1.0) * 255.0).round() / 255.0;
        let pixels = image.data.chunks_exact(image.channels);
        let values = pixels.map(|p| f64::from(luminance(Vec3::from_slice(p).map(shown))));
        Self { width: image.width, values: values.collect() }
    }

    fn map(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let values = self.values.iter().zip(&other.values).map(|(a, b)| f(*a, *b)).collect();
        Self { width: self.width, values }
    }

    /// Half the difference of the neighbours on both sides; the border's pixels repeat.
    fn slope(&self, [dx, dy]: [isize; 2]) -> Self {
        let (width, height) = (self.width as isize, (self.values.len() / self.width) as isize);
        let at = |x: isize, y: isize| self.values[(y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize];
        let slope = |i: isize| {
            let (x, y) = (i % width, i / width);
            0.5 * (at(x + dx, y + dy) - at(x - dx, y - dy))
        };
        Self { width: self.width, values: (0..width * height).map(slope).collect() }
    }

    /// Gaussian blur; the border's pixels repeat.
    fn blurred(&self, sigma: f64) -> Self {
        let radius = (3.5 * sigma).ceil() as isize;
        let kernel: Vec<f64> = (-radius..=radius).map(|i| (-0.5 * (i as f64 / sigma).powi(2)).exp()).collect();
        let total: f64 = kernel.iter().sum();
        let (width, height) = (self.width as isize, (self.values.len() / self.width) as isize);
        let pass = |values: &[f64], step: [isize; 2]| -> Vec<f64> {
            let at = |x: isize, y: isize| values[(y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize];
            let sum = |i: isize| -> f64 {
                let taps = (-radius..=radius).zip(&kernel);
                taps.map(|(k, weight)| weight * at(i % width + k * step[0], i / width + k * step[1])).sum()
            };
            (0..width * height).map(|i| sum(i) / total).collect()
        };
        Self { width: self.width, values: pass(&pass(&self.values, [1, 0]), [0, 1]) }
    }
}

/// Standard deviations, in pixels, of the Gaussians that smooth a picture before its gradients are taken, and the
/// products of the gradients.
const INNER: f64 = 1.0;
const OUTER: f64 = 4.0;

/// The local orientation of a picture by the structure tensor of its luminance.
pub struct Orientation {
    /// Direction across which the picture changes most, in radians modulo π.
    pub angle: Vec<f64>,
    /// 0 where all directions are alike, 1 where the picture changes in one direction only.
    pub coherence: Vec<f64>,
}

impl Orientation {
    pub fn of(picture: &Image) -> Self {
        let plane = Plane::of(picture).blurred(INNER);
        let [dx, dy] = [plane.slope([1, 0]), plane.slope([0, 1])];
        let smooth = |a: &Plane, b: &Plane| a.map(b, |a, b| a * b).blurred(OUTER).values;
        let (xx, xy, yy) = (smooth(&dx, &dx), smooth(&dx, &dy), smooth(&dy, &dy));
        let pixels = || xx.iter().zip(&xy).zip(&yy).map(|((xx, xy), yy)| (xx - yy, 2.0 * xy, xx + yy));
        let angle = pixels().map(|(difference, twice, _)| 0.5 * twice.atan2(difference)).collect();
        let coherence = pixels().map(|(difference, twice, sum)| difference.hypot(twice) / (sum + f64::MIN_POSITIVE));
        Self { angle, coherence: coherence.collect() }
    }

    /// Angle between the orientations of two pictures at a pixel, in degrees, in `[0, 90]`.
    pub fn error(&self, truth: &Self, pixel: usize) -> f64 {
        let difference = (self.angle[pixel] - truth.angle[pixel]).to_degrees().rem_euclid(180.0);
        difference.min(180.0 - difference)
    }
}

/// The power of the finest octave of a picture, and the luminance of the guide at each pixel.
pub struct Detail {
    power: Plane,
    light: Plane,
}

impl Detail {
    pub fn of(picture: &Image, guide: &Image) -> Self {
        let plane = Plane::of(picture);
        let power = plane.map(&plane.blurred(OCTAVE), |v, mean| (v - mean).powi(2));
        Self { power, light: Plane::of(guide) }
    }

    /// Mean power, and number of pixels, where the light lies in a range.
    fn within(&self, [low, high]: [f64; 2]) -> (f64, usize) {
        let pixels = self.power.values.iter().zip(&self.light.values).filter(|(_, l)| (low..=high).contains(*l));
        let (sum, count) = pixels.fold((0.0, 0), |(sum, count), (power, _)| (sum + power, count + 1));
        (sum / count.max(1) as f64, count)
    }

    /// Logarithm, to the base 2, of the power of this picture over that of a reference, by bins of guide luminance:
    /// of the power of all bins together, and the mean of the bins' logarithms.
    pub fn over(&self, reference: &Self) -> [f64; 2] {
        let mut light = self.light.values.clone();
        light.sort_by(f64::total_cmp);
        let end = |bin: usize| light[(light.len() - 1) * bin / BINS];
        let (mut sums, mut logs, mut count) = ([0.0; 2], 0.0, 0.0);
        for bin in 0..BINS {
            let range = [end(bin), end(bin + 1)];
            let (own, other) = (self.within(range), reference.within(range));
            if other.1 < MIN_PIXELS || other.0 <= 0.0 || own.0 <= 0.0 {
                continue;
            }
            sums = [sums[0] + own.0, sums[1] + other.0];
            logs += (own.0 / other.0).log2();
            count += 1.0;
        }
        [(sums[0] / sums[1]).log2(), logs / count]
    }
}

/// Likeness of a picture to the truth.
pub struct Likeness {
    /// Structural similarity of the luminance (Wang et al. 2004), of the whole picture and of the objects in it.
    pub ssim: f64,
    pub on_object: f64,
    /// Mean CIEDE2000 difference.
    pub delta_e: f64,
}

impl Likeness {
    pub fn of(picture: &Image, truth: &Image, object: &[bool]) -> Self {
        let (a, b) = (Plane::of(picture), Plane::of(truth));
        let [mean_a, mean_b] = [&a, &b].map(|p| p.blurred(WINDOW));
        let moment = |p: &Plane, q: &Plane, mp: &Plane, mq: &Plane| {
            let product = mp.map(mq, |p, q| p * q);
            p.map(q, |p, q| p * q).blurred(WINDOW).map(&product, |m, product| m - product)
        };
        let variance_a = moment(&a, &a, &mean_a, &mean_a);
        let variance_b = moment(&b, &b, &mean_b, &mean_b);
        let covariance = moment(&a, &b, &mean_a, &mean_b);
        let similarity: Vec<f64> = (0..a.values.len())
            .map(|i| {
                let (p, q) = (mean_a.values[i], mean_b.values[i]);
                let means = (2.0 * p * q + SSIM[0]) / (p * p + q * q + SSIM[0]);
                let spread = variance_a.values[i] + variance_b.values[i] + SSIM[1];
                means * (2.0 * covariance.values[i] + SSIM[1]) / spread
            })
            .collect();
        let mean = |on: &dyn Fn(usize) -> bool| {
            let chosen: Vec<f64> = (0..similarity.len()).filter(|&i| on(i)).map(|i| similarity[i]).collect();
            chosen.iter().sum::<f64>() / chosen.len() as f64
        };
        let lab = |p: &[f32]| linear_to_lab(Vec3::from_slice(p));
        let pixels = picture.data.chunks_exact(3).zip(truth.data.chunks_exact(3));
        let delta_e: f64 = pixels.map(|(p, q)| delta_e_2000(lab(p), lab(q))).sum();
        Self { ssim: mean(&|_| true), on_object: mean(&|i| object[i]), delta_e: delta_e / similarity.len() as f64 }
    }
}
