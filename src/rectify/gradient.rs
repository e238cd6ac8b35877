//! Image gradients, from which lines are detected: luma in a perceptual encoding, Gaussian smoothing, Scharr
//! derivatives.

use crate::error::Result;
use crate::exec;
use crate::image::{Image, colour, pyramid};
use crate::job::Job;

/// Standard deviation of the Gaussian in pixels: large enough to suppress JPEG blocks and sensor noise, small enough
/// to keep thin lines. [bench lines]
pub const SIGMA: f32 = 1.2;

/// Offset inside the square root that encodes luma. It limits the slope of the encoding near black. The linear part of
/// the sRGB curve, below 0.0031, has the same purpose. [convention: sRGB]
const TOE: f32 = 0.003;

/// Upper bound of the luminance relative to white, applied before the encoding. Brighter pixels are lamps, of which
/// only the outlines matter here. [bench vp:panoramas]
const CLIP: f32 = 4.0;

/// Gradients of a photo; they are zero near pixels that are not finite.
pub struct Gradients {
    pub width: usize,
    pub height: usize,
    /// Derivatives along x and y, interleaved, in encoded luma per pixel (white = 1).
    pub derivative: Vec<[f32; 2]>,
    pub magnitude: Vec<f32>,
}

/// Computes luma: the luminance divided by the photo's white, clamped to `[0, CLIP]`, and encoded by a square root.
/// White is the 95th percentile of the luminances above 0. The result is NaN where the photo is not finite.
pub fn encoded_luma(photo: &Image, job: Job) -> Result<Image> {
    let mut luma = Image::new(photo.width, photo.height, 1)?;
    exec::for_rows(&mut luma.data, photo.width, job, |y, row| {
        for (x, out) in row.iter_mut().enumerate() {
            *out = colour::luminance(photo.rgb(x, y));
        }
    })?;
    // Estimate white from a subset of the pixels, spread over the whole photo.
    let step = (luma.data.len() / 65_536).max(1);
    let mut subset: Vec<f32> = luma.data.iter().step_by(step).copied().filter(|v| v.is_finite() && *v > 0.0).collect();
    let scale = if subset.is_empty() {
        1.0
    } else {
        let rank = subset.len() * 95 / 100;
        1.0 / subset.select_nth_unstable_by(rank, f32::total_cmp).1.max(1e-30)
    };
    for v in &mut luma.data {
        *v = if v.is_finite() { ((*v * scale).clamp(0.0, CLIP) + TOE).sqrt() } else { f32::NAN };
    }
    Ok(luma)
}

/// Computes the gradients of the smoothed luma; they are 0 on the outermost pixels.
pub fn gradients(luma: &Image, job: Job) -> Result<Gradients> {
    let (width, height) = (luma.width, luma.height);
    let smooth = pyramid::blur(luma, SIGMA, job.part(0.0, 0.5))?;
    let mut derivative = crate::image::try_vec(width * height, [0.0f32; 2])?;
    let mut magnitude = crate::image::try_vec(width * height, 0.0f32)?;
    exec::for_rows(&mut derivative, width, job.part(0.5, 0.8), |y, row| {
        if y == 0 || y + 1 == height || width < 3 {
            return;
        }
        let (above, here, below) = (smooth.row(y - 1), smooth.row(y), smooth.row(y + 1));
        for x in 1..width - 1 {
            // Apply Scharr's kernel, the 3 × 3 derivative kernel whose gradient directions are the most isotropic.
            let (l, r) = (x - 1, x + 1);
            let dx = 3.0 * (above[r] - above[l] + below[r] - below[l]) + 10.0 * (here[r] - here[l]);
            let dy = 3.0 * (below[l] - above[l] + below[r] - above[r]) + 10.0 * (below[x] - above[x]);
            if (dx + dy).is_finite() {
                row[x] = [dx / 32.0, dy / 32.0];
            }
        }
    })?;
    exec::for_rows(&mut magnitude, width, job.part(0.8, 1.0), |y, row| {
        for (m, d) in row.iter_mut().zip(&derivative[y * width..]) {
            *m = (d[0] * d[0] + d[1] * d[1]).sqrt();
        }
    })?;
    Ok(Gradients { width, height, derivative, magnitude })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    #[test]
    fn a_ramp_has_its_slope_everywhere_inside() {
        let monitor = Monitor::default();
        let luma = Image::from_fn(20, 16, |x, y| [0.02 * x as f32 - 0.01 * y as f32]).unwrap();
        let g = gradients(&luma, monitor.job()).unwrap();
        for y in 5..11 {
            for x in 5..15 {
                let [dx, dy] = g.derivative[y * 20 + x];
                assert!((dx - 0.02).abs() < 1e-6 && (dy + 0.01).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn exposure_does_not_change_the_luma_and_nan_makes_no_edge() {
        let monitor = Monitor::default();
        let photo = |k: f32| Image::from_fn(32, 32, |x, y| [k * ((x * 7 + y * 3) % 32) as f32; 3]).unwrap();
        let (a, b) =
            (encoded_luma(&photo(0.01), monitor.job()).unwrap(), encoded_luma(&photo(500.0), monitor.job()).unwrap());
        assert!(a.data.iter().zip(&b.data).all(|(a, b)| (a - b).abs() < 1e-5));
        let mut flat = Image::from_fn(16, 16, |_, _| [0.5f32; 3]).unwrap();
        flat.pixel_mut(8, 8)[1] = f32::NAN;
        let g = gradients(&encoded_luma(&flat, monitor.job()).unwrap(), monitor.job()).unwrap();
        assert!(g.magnitude.iter().all(|&m| m < 1e-6));
    }
}
