//! Smooths rendered light along surfaces, by the edge-avoiding à-trous wavelets of Dammertz et al. 2010.

use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::image::colour::luminance;
use crate::job::Job;
use crate::maths;
use glam::Vec3;

/// Number of passes; the distance between the averaged pixels doubles from pass to pass.
const PASSES: u32 = 3;
/// The cubic B-spline that each pass applies along x and y. [convention]
const KERNEL: [f32; 5] = [1.0 / 16.0, 0.25, 0.375, 0.25, 1.0 / 16.0];
/// Relative difference |a - b| / m at which the weight of a neighbour falls to 1/e. a and b are the brightnesses of the
/// pixel and of the neighbour; m is their mean, plus 2 % of the mean luminance of the image. [bench constants:guides]
const TOLERANCE: f32 = 0.25;

/// Averages the light over neighbouring pixels of the same material, similar normal and similar brightness. For this
/// comparison, the brightness of a pixel is the mean over 5 × 5 pixels, because single pixels are too noisy to
/// distinguish light from shadow.
pub fn along_surfaces(light: &Image, normals: &Image, material: &Image, job: Job) -> Result<Image> {
    let floor = 0.02 * mean_luminance(light);
    let surface = Surface { normals, material };
    let range_weight = |a: f32, b: f32| {
        let apart = (a - b) / (TOLERANCE * (0.5 * (a + b) + floor)).max(f32::MIN_POSITIVE);
        maths::exp(-apart * apart)
    };
    let mut current = light.try_clone()?;
    for pass in 0..PASSES {
        let means = surface.average(&current, &current, 1, |_, _| 1.0, job)?;
        current = surface.average(&current, &means, 1 << pass, range_weight, job)?;
    }
    Ok(current)
}

/// The normal and the material of the surface that each pixel shows.
struct Surface<'a> {
    normals: &'a Image,
    material: &'a Image,
}

impl Surface<'_> {
    /// Computes weighted means of `light` over 5 × 5 pixels that lie `step` pixels apart. The weight of a neighbour is
    /// the product of three factors: the B-spline, a power of the cosine between the two normals (1 if the centre pixel
    /// has none), and `range_weight(a, b)`. `a` and `b` are the luminances of the centre pixel and of the neighbour in
    /// the image `guide`. Neighbours of another material have no weight.
    fn average(
        &self,
        light: &Image,
        guide: &Image,
        step: isize,
        range_weight: impl Fn(f32, f32) -> f32 + Sync,
        job: Job,
    ) -> Result<Image> {
        let (width, height) = (light.width, light.height);
        let mut out = Image::new(width, height, 3)?;
        let normal = |x: usize, y: usize| Vec3::from_slice(self.normals.pixel(x, y));
        exec::for_rows(&mut out.data, width * 3, job, |y, row| {
            for (x, out) in row.chunks_exact_mut(3).enumerate() {
                let (here, brightness) = (normal(x, y), luminance(guide.rgb(x, y)));
                let (mut sum, mut total) = (Vec3::ZERO, 0.0);
                for (i, weight) in KERNEL.iter().flat_map(|a| KERNEL.iter().map(move |b| a * b)).enumerate() {
                    let (dx, dy) = (i as isize % 5 - 2, i as isize / 5 - 2);
                    let (u, v) = (x as isize + dx * step, y as isize + dy * step);
                    if u < 0 || v < 0 || u as usize >= width || v as usize >= height {
                        continue;
                    }
                    let (u, v) = (u as usize, v as usize);
                    if self.material.pixel(u, v) != self.material.pixel(x, y) {
                        continue;
                    }
                    let facing =
                        if here == Vec3::ZERO { 1.0 } else { maths::powi(here.dot(normal(u, v)).max(0.0), 16) };
                    let weight = weight * facing * range_weight(brightness, luminance(guide.rgb(u, v)));
                    if weight.is_finite() {
                        sum += light.rgb(u, v) * weight;
                        total += weight;
                    }
                }
                let mean = if total > 0.0 { sum / total } else { light.rgb(x, y) };
                out.copy_from_slice(&mean.to_array());
            }
        })?;
        Ok(out)
    }
}

fn mean_luminance(image: &Image) -> f32 {
    let sum: f64 = image.data.chunks_exact(3).map(|p| f64::from(luminance(Vec3::from_slice(p)))).sum();
    (sum / (image.width * image.height) as f64) as f32
}
