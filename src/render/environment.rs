//! Environment light: its radiance by direction, and importance sampling of directions towards it.

use super::contribution::mean_channel;
use super::distribution::Distribution;
use crate::error::Result;
use crate::image::Image;
use crate::maths;
use crate::scene::Environment;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A distribution of directions towards the environment, from which light samples are drawn.
pub enum EnvironmentSampler {
    /// Constant radiance: directions are uniform over the sphere.
    Constant,
    /// An equirectangular image: pixels are selected in proportion to their weights. The weight of a pixel is its
    /// solid angle times the mean brightness of its 3 × 3 neighbourhood. The weight uses this mean because bilinear
    /// interpolation spreads light to neighbouring pixels: the mean is positive wherever the interpolated radiance is
    /// positive.
    Image { rows: Distribution, columns: Vec<Distribution> },
}

impl EnvironmentSampler {
    /// Builds the sampler. Also returns the brightness (mean of the channels), averaged over all directions. Returns
    /// `None` for a black environment.
    pub fn build(environment: &Environment) -> Result<Option<(Self, f64)>> {
        let image = match environment {
            Environment::Constant(radiance) => {
                let mean = f64::from(mean_channel(radiance.max(Vec3::ZERO)));
                return Ok((mean > 0.0).then_some((Self::Constant, mean)));
            }
            Environment::Image(image) => image,
        };
        let mut columns = Vec::with_capacity(image.height);
        for y in 0..image.height {
            let band = band_solid_angle(y, image.height);
            let weight = |x: usize| f64::from(neighbourhood(image, x, y)) * band / image.width as f64;
            columns.push(Distribution::new((0..image.width).map(weight))?);
        }
        let rows = Distribution::new(columns.iter().map(Distribution::total))?;
        let mean = rows.total() / f64::from(2.0 * TAU);
        Ok((mean > 0.0).then_some((Self::Image { rows, columns }, mean)))
    }

    /// Samples a direction towards the environment. Also returns its solid-angle pdf.
    pub fn sample(&self, u: f64, v: f32) -> (Vec3, f32) {
        match self {
            Self::Constant => {
                let (cosine, angle) = (1.0 - 2.0 * u as f32, TAU * v);
                let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
                (Vec3::new(sine * maths::cos(angle), cosine, sine * maths::sin(angle)), 1.0 / (4.0 * PI))
            }
            Self::Image { rows, columns } => {
                let (y, remainder) = rows.sample(u);
                let (x, across) = columns[y].sample(f64::from(v));
                let (width, height) = (columns[y].len(), columns.len());
                // Sample the pixel uniformly by solid angle: the cosine of the polar angle and the azimuth are
                // uniform.
                let (top, bottom) = polar_cosines(y, height);
                let cosine = (top + (bottom - top) * remainder) as f32;
                let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
                let angle = ((x as f64 + across) / width as f64 - 0.5) as f32 * TAU;
                let direction = Vec3::new(sine * maths::sin(angle), cosine, -sine * maths::cos(angle));
                (direction, self.pixel_pdf(x, y))
            }
        }
    }

    /// Returns the solid-angle pdf with which [`EnvironmentSampler::sample`] draws a unit direction.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        match self {
            Self::Constant => 1.0 / (4.0 * PI),
            Self::Image { columns, .. } => {
                let (width, height) = (columns[0].len(), columns.len());
                let uv = equirectangular(direction);
                let x = ((uv.x * width as f32) as usize).min(width - 1);
                let y = ((uv.y * height as f32) as usize).min(height - 1);
                self.pixel_pdf(x, y)
            }
        }
    }

    fn pixel_pdf(&self, x: usize, y: usize) -> f32 {
        match self {
            Self::Constant => 1.0 / (4.0 * PI),
            Self::Image { rows, columns } => {
                let solid_angle = band_solid_angle(y, columns.len()) / columns[y].len() as f64;
                (rows.pmf(y) * columns[y].pmf(x) / solid_angle) as f32
            }
        }
    }
}

/// Returns the radiance that arrives from a unit direction. Images are interpolated bilinearly. They wrap around
/// horizontally and are clamped at the top and the bottom (the poles).
pub fn radiance(environment: &Environment, direction: Vec3) -> Vec3 {
    let image = match environment {
        Environment::Constant(radiance) => return radiance.max(Vec3::ZERO),
        Environment::Image(image) => image,
    };
    let uv = equirectangular(direction);
    let (x, y) = (uv.x * image.width as f32 - 0.5, uv.y * image.height as f32 - 0.5);
    let (left, top) = (x.floor(), y.floor());
    let column = |x: f32| (x as i64).rem_euclid(image.width as i64) as usize;
    let row = |y: f32| (y as i64).clamp(0, image.height as i64 - 1) as usize;
    let at = |x: f32, y: f32| image.rgb(column(x), row(y)).max(Vec3::ZERO);
    let upper = at(left, top).lerp(at(left + 1.0, top), x - left);
    let lower = at(left, top + 1.0).lerp(at(left + 1.0, top + 1.0), x - left);
    upper.lerp(lower, y - top)
}

/// Returns the texture coordinates of a unit direction. The centre of the image is the direction -z, its top +y, and
/// +x lies a quarter of the width to the right of the centre.
fn equirectangular(d: Vec3) -> Vec2 {
    Vec2::new(0.5 + maths::atan2(d.x, -d.z) / TAU, maths::acos(d.y.clamp(-1.0, 1.0)) / PI)
}

fn polar_cosines(y: usize, height: usize) -> (f64, f64) {
    let cosine = |y: usize| maths::cos(std::f64::consts::PI * y as f64 / height as f64);
    (cosine(y), cosine(y + 1))
}

/// Returns the solid angle of one row of pixels, in steradians.
fn band_solid_angle(y: usize, height: usize) -> f64 {
    let (top, bottom) = polar_cosines(y, height);
    std::f64::consts::TAU * (top - bottom)
}

/// Returns the mean brightness of a pixel and its eight neighbours.
fn neighbourhood(image: &Image, x: usize, y: usize) -> f32 {
    let mut sum = 0.0;
    for dy in 0..3 {
        for dx in 0..3 {
            let column = (x + image.width + dx - 1) % image.width;
            let row = (y + dy).saturating_sub(1).min(image.height - 1);
            sum += mean_channel(image.rgb(column, row).max(Vec3::ZERO));
        }
    }
    sum / 9.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::tests::chi2::assert_follows;
    use crate::rng::Rng;
    use glam::DVec3;

    fn images() -> Vec<Image> {
        let smooth = Image::from_fn(32, 16, |x, y| [(x + y) as f32 + 0.1, 1.0, (x * y) as f32]);
        let mut spot = Image::new(40, 20, 3).unwrap();
        spot.pixel_mut(0, 0).fill(5.0);
        spot.pixel_mut(39, 12).fill(50.0);
        vec![smooth.unwrap(), spot, Image::from_fn(1, 1, |_, _| [2.0]).unwrap()]
    }

    #[test]
    fn sampled_directions_follow_the_stated_pdf() {
        for image in images() {
            let environment = Environment::Image(image);
            let (sampler, _) = EnvironmentSampler::build(&environment).unwrap().unwrap();
            let mut rng = Rng::new(31, &[]);
            let mut disagreed = 0;
            for _ in 0..20_000 {
                let (direction, pdf) = sampler.sample(rng.next_f64(), rng.next_f32());
                assert!((direction.length() - 1.0).abs() < 1e-5);
                disagreed += usize::from((sampler.pdf(direction) / pdf - 1.0).abs() > 1e-4);
            }
            // The two pdfs may differ only for directions within rounding of a pixel's border.
            assert!(disagreed < 20, "{disagreed}");
        }
    }

    #[test]
    fn sampled_pixels_follow_the_stated_pdf() {
        for image in images() {
            let (width, height) = (image.width, image.height);
            let (sampler, _) = EnvironmentSampler::build(&Environment::Image(image)).unwrap().unwrap();
            let mut rng = Rng::new(33, &[]);
            let n = 100_000;
            let mut counts = vec![0.0; width * height];
            for _ in 0..n {
                let uv = equirectangular(sampler.sample(rng.next_f64(), rng.next_f32()).0);
                let at = |u: f32, size: usize| ((u * size as f32) as usize).min(size - 1);
                counts[at(uv.y, height) * width + at(uv.x, width)] += 1.0;
            }
            let expected: Vec<f64> = (0..width * height)
                .map(|i| {
                    let solid_angle = band_solid_angle(i / width, height) / width as f64;
                    f64::from(sampler.pixel_pdf(i % width, i / width)) * solid_angle * f64::from(n)
                })
                .collect();
            assert_follows(&expected, &counts, 4, &format!("{width} x {height}"));
        }
        // Test the sampler of constant radiance by counts in bins of equal solid angle.
        let (mut counts, mut rng) = (vec![0.0; 16 * 16], Rng::new(34, &[]));
        for _ in 0..50_000 {
            let d = EnvironmentSampler::Constant.sample(rng.next_f64(), rng.next_f32()).0;
            let row = ((d.y + 1.0) / 2.0 * 16.0) as usize;
            let column = ((0.5 + d.z.atan2(d.x) / TAU) * 16.0) as usize;
            counts[row.min(15) * 16 + column.min(15)] += 1.0;
        }
        assert_follows(&vec![50_000.0 / 256.0; 256], &counts, 4, "constant");
    }

    #[test]
    fn sampling_a_direction_can_be_inverted() {
        let mut rng = Rng::new(35, &[]);
        for image in images() {
            let (sampler, _) = EnvironmentSampler::build(&Environment::Image(image)).unwrap().unwrap();
            let EnvironmentSampler::Image { rows, columns } = &sampler else { panic!("an image") };
            for _ in 0..2000 {
                let (u, v) = (rng.next_f64(), rng.next_f32());
                let d = sampler.sample(u, v).0.as_dvec3();
                // Invert the sampling: find the pixel that contains the direction, and where the direction lies in the
                // pixel, as a share of the pixel's solid angle.
                let height = columns.len();
                let row = (d.y.clamp(-1.0, 1.0).acos() / std::f64::consts::PI * height as f64).min(height as f64 - 1.0);
                let (top, bottom) = polar_cosines(row as usize, height);
                let remainder = (d.y - top) / (bottom - top);
                let back = running(rows, row as usize) + remainder * rows.pmf(row as usize);
                let table = &columns[row as usize];
                let column = (0.5 + d.x.atan2(-d.z) / std::f64::consts::TAU) * table.len() as f64;
                let at = (column as usize).min(table.len() - 1);
                let across = running(table, at) + (column - at as f64) * table.pmf(at);
                // The tolerance allows for the rounding of directions to f32 and for directions at the borders of
                // pixels.
                let tolerance = 1e-4;
                assert!((back - u).abs() < tolerance, "{u} became {d}, and that {back}");
                let near_pole = d.x.hypot(d.z) < 0.02;
                assert!(near_pole || (across - f64::from(v)).abs() < tolerance, "{v} became {d}, and that {across}");
            }
        }
    }

    /// Returns the sum of the pmf of all entries before `entry`.
    fn running(table: &Distribution, entry: usize) -> f64 {
        (0..entry).map(|i| table.pmf(i)).sum()
    }

    #[test]
    fn densities_integrate_to_one_and_estimates_to_the_light() {
        for image in images() {
            let environment = Environment::Image(image);
            let (sampler, mean) = EnvironmentSampler::build(&environment).unwrap().unwrap();
            let mut rng = Rng::new(32, &[]);
            let n = 400_000;
            let (mut pdf, mut light, mut sampled) = (0.0, 0.0, 0.0);
            for _ in 0..n {
                let cosine = 1.0 - 2.0 * rng.next_f64();
                let (sine, angle) = ((1.0 - cosine * cosine).sqrt(), f64::from(TAU) * rng.next_f64());
                let d = DVec3::new(sine * angle.cos(), cosine, sine * angle.sin()).as_vec3();
                let sphere = f64::from(4.0 * PI) / f64::from(n);
                pdf += f64::from(sampler.pdf(d)) * sphere;
                light += f64::from(mean_channel(radiance(&environment, d))) * sphere;
                let (d, pdf) = sampler.sample(rng.next_f64(), rng.next_f32());
                sampled += f64::from(mean_channel(radiance(&environment, d)) / pdf) / f64::from(n);
            }
            assert!((pdf - 1.0).abs() < 0.03, "{pdf}");
            assert!((sampled / light - 1.0).abs() < 0.05, "{sampled} and {light}");
            assert!((mean * f64::from(4.0 * PI) / light - 1.0).abs() < 0.05);
        }
        assert!(EnvironmentSampler::build(&Environment::Constant(Vec3::ZERO)).unwrap().is_none());
    }
}
