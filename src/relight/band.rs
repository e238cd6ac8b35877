//! Band-limited look-ups in a repeating texture, with derivatives, for the gradient descent of a placement.
//!
//! A look-up interpolates with cubic B-splines within two levels of an image pyramid, and linearly between the levels.
//! The result is differentiable with respect to the texture coordinates, unlike nearest and bilinear look-ups.

use crate::error::Result;
use crate::image::{Image, pyramid};
use crate::job::Job;
use glam::{DVec2, DVec3};

pub(super) struct Pyramid {
    levels: Vec<Level>,
}

struct Level {
    width: usize,
    height: usize,
    texels: Vec<DVec3>,
}

/// A filtered value with its partial derivatives with respect to texture coordinates and pyramid level.
#[derive(Clone, Copy)]
pub(super) struct TextureSample {
    pub value: DVec3,
    pub d_du: DVec3,
    pub d_dv: DVec3,
    pub d_dlevel: DVec3,
}

impl Pyramid {
    /// Builds the pyramid: levels from the full resolution down to a single texel. Negative values are clamped to 0.
    pub fn new(image: &Image, job: Job) -> Result<Self> {
        let mut image = image.to_rgb()?;
        image.data.iter_mut().for_each(|v| *v = v.max(0.0));
        let mut levels = vec![Level::new(&image)];
        while image.width.max(image.height) > 1 {
            image = pyramid::resize(&image, image.width.div_ceil(2), image.height.div_ceil(2), job)?;
            levels.push(Level::new(&image));
        }
        Ok(Self { levels })
    }

    /// Looks up the texture at `uv`, filtered to texels with `2^level` times the side of the original texels. `level`
    /// may be fractional; it is clamped to the levels of the pyramid.
    pub fn look_up(&self, uv: DVec2, level: f64) -> TextureSample {
        let last = (self.levels.len() - 1) as f64;
        let clamped = level.clamp(0.0, last);
        let fine = clamped as usize;
        let share = clamped - fine as f64;
        let a = self.levels[fine].look_up(uv);
        if share == 0.0 {
            return a;
        }
        let b = self.levels[fine + 1].look_up(uv);
        let between = |a: DVec3, b: DVec3| a + (b - a) * share;
        TextureSample {
            value: between(a.value, b.value),
            d_du: between(a.d_du, b.d_du),
            d_dv: between(a.d_dv, b.d_dv),
            d_dlevel: b.value - a.value,
        }
    }
}

impl Level {
    fn new(image: &Image) -> Self {
        let texels = image.data.chunks_exact(3).map(|p| DVec3::new(p[0].into(), p[1].into(), p[2].into())).collect();
        Self { width: image.width, height: image.height, texels }
    }

    fn look_up(&self, uv: DVec2) -> TextureSample {
        let (x, y) = (Taps::new(uv.x, self.width), Taps::new(uv.y, self.height));
        let (mut value, mut d_du, mut d_dv) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
        for j in 0..4 {
            let row = &self.texels[y.texels[j] * self.width..][..self.width];
            let (mut sum, mut slope) = (DVec3::ZERO, DVec3::ZERO);
            for i in 0..4 {
                let texel = row[x.texels[i]];
                sum += texel * x.weights[i];
                slope += texel * x.slopes[i];
            }
            value += sum * y.weights[j];
            d_du += slope * y.weights[j];
            d_dv += sum * y.slopes[j];
        }
        TextureSample { value, d_du, d_dv, d_dlevel: DVec3::ZERO }
    }
}

/// The four texels under a cubic B-spline, with their weights and the derivatives of the weights with respect to the
/// coordinate.
struct Taps {
    texels: [usize; 4],
    weights: [f64; 4],
    slopes: [f64; 4],
}

impl Taps {
    fn new(u: f64, size: usize) -> Self {
        let position = u.rem_euclid(1.0) * size as f64 - 0.5;
        let (base, t) = (position.floor(), position - position.floor());
        let texels = std::array::from_fn(|i| (base as i64 + i as i64 - 1).rem_euclid(size as i64) as usize);
        let s = 1.0 - t;
        let weights = [
            s * s * s / 6.0,
            (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
            (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
            t * t * t / 6.0,
        ];
        let slopes = [-s * s / 2.0, (3.0 * t * t - 4.0 * t) / 2.0, (4.0 * s - 3.0 * s * s) / 2.0, t * t / 2.0];
        Self { texels, weights, slopes: slopes.map(|w| w * size as f64) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;
    use crate::rng::Rng;

    #[test]
    fn derivatives_equal_central_differences_and_splines_keep_constants() {
        let mut rng = Rng::new(1, &[]);
        let texel = |x: usize, y: usize| {
            let mut rng = Rng::new(2, &[x as u64, y as u64]);
            [rng.next_f32(), rng.next_f32(), rng.next_f32()]
        };
        let image = Image::from_fn(24, 15, texel).unwrap();
        let mean = image.data.chunks_exact(3).map(|p| f64::from(p[0])).sum::<f64>() / (24.0 * 15.0);
        let monitor = Monitor::default();
        let pyramid = Pyramid::new(&image, monitor.job()).unwrap();
        const H: f64 = 1e-6;
        for _ in 0..100 {
            let (uv, level) = (DVec2::new(rng.next_f64() * 4.0 - 2.0, rng.next_f64()), rng.next_f64() * 3.0);
            let sample = pyramid.look_up(uv, level);
            let step = |uv: DVec2, level: f64| pyramid.look_up(uv, level).value;
            let differences = [
                (step(uv + DVec2::X * H, level) - step(uv - DVec2::X * H, level)) / (2.0 * H),
                (step(uv + DVec2::Y * H, level) - step(uv - DVec2::Y * H, level)) / (2.0 * H),
                (step(uv, level + H) - step(uv, level - H)) / (2.0 * H),
            ];
            for (slope, difference) in [sample.d_du, sample.d_dv, sample.d_dlevel].into_iter().zip(differences) {
                assert!((slope - difference).abs().max_element() < 1e-5, "{slope} {difference}");
            }
            // The texture repeats, and the last level is its mean.
            assert!((sample.value - step(uv + 1.0, level)).abs().max_element() < 1e-9);
            assert!((step(uv, 99.0).x - mean).abs() < 1e-6);
        }
        // A constant texture stays constant.
        let flat = Pyramid::new(&Image::from_fn(5, 3, |_, _| [0.7]).unwrap(), monitor.job()).unwrap();
        let sample = flat.look_up(DVec2::new(0.3, 0.9), 0.4);
        assert!(
            (sample.value - f64::from(0.7f32)).abs().max_element() < 1e-7 && sample.d_du.abs().max_element() < 1e-6
        );
    }
}
