//! Takes a photo of a demonstration room: a rendering with models of a lens and of an 8-bit sensor.

use crate::error::Result;
use crate::exec;
use crate::image::colour::{linear_to_srgb, luminance, srgb_to_linear};
use crate::image::{Image, pyramid, try_collect};
use crate::job::Job;
use crate::maths;
use crate::render::{self, World};
use crate::rng::Rng;
use crate::scene::{Camera, Scene};
use glam::Vec3;
use std::sync::Arc;

/// Standard deviation of the lens blur in pixels. [convention]
const LENS_BLUR: f32 = 0.7;
/// Share of the light that the lens scatters into a glow around lamps, and the standard deviation of that glow in
/// pixels. [convention]
const GLARE: (f32, f32) = (0.03, 9.0);
/// Brightness in the corners of the photo relative to its centre. [convention]
const VIGNETTE: f32 = 0.8;
/// Full-well capacity of a pixel, and standard deviation of the read-out noise, both in electrons. [convention]
const WELL: (f64, f64) = (6000.0, 12.0);
/// Strength of the white balance: 0 keeps the colour of the light, 1 turns the mean colour grey. Real cameras correct
/// partially. [convention]
const WHITE_BALANCE: f32 = 0.6;
/// The exposure maps the median luminance of the rendering to this linear value. [convention]
const MEDIAN_EXPOSURE: f32 = 0.14;

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    pub width: usize,
    pub height: usize,
    /// Number of paths per pixel of the rendering.
    pub samples: u32,
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self { width: 600, height: 400, samples: 12, seed: 1 }
    }
}

/// Takes the photo of `scene`. Returns the photo and its exposure. The photo is linear RGB in `[0, 1]` after
/// quantisation to 8-bit sRGB, with lamps clipped to white. The exposure is the linear value of 1 cd/m².
pub fn photograph(scene: Arc<Scene>, camera: &Camera, params: &Params, job: Job) -> Result<(Image, f32)> {
    let world = World::build(scene, job.part(0.0, 0.05))?;
    let settings = render::Params {
        width: params.width,
        height: params.height,
        samples: params.samples,
        seed: params.seed,
        ..render::Params::default()
    };
    let film = render::run(&world, camera, &settings, job.part(0.05, 0.9), &mut |_| {})?;

    // Model the lens: compute a slightly blurred image, and a strongly blurred one for the glow around bright parts.
    let sharp = pyramid::blur(&film.beauty, LENS_BLUR, job.part(0.9, 0.92))?;
    let glow = pyramid::blur(&film.beauty, GLARE.1, job.part(0.92, 0.96))?;

    // Expose for the room by its median luminance, which the few bright pixels of the lamps hardly affect.
    let mut levels = try_collect(film.beauty.data.chunks_exact(3).map(|p| luminance(Vec3::from_slice(p))))?;
    let half = levels.len() / 2;
    let median = *levels.select_nth_unstable_by(half, f32::total_cmp).1;
    let exposure = MEDIAN_EXPOSURE / median.max(f32::MIN_POSITIVE);

    // White balance: shift the room's mean colour towards grey at constant luminance.
    let mean = film.beauty.data.chunks_exact(3).map(|p| Vec3::from_slice(p)).sum::<Vec3>();
    let mean = (mean / luminance(mean).max(f32::MIN_POSITIVE)).max(Vec3::splat(1e-3));
    let balance = mean.map(|v| maths::powf(v, -WHITE_BALANCE));
    let balance = balance / luminance(mean * balance);

    // Model vignetting and the sensor: shot noise, read-out noise, clipping at white, and rounding to 8 bits.
    let mut photo = Image::new(params.width, params.height, 3)?;
    let centre = [params.width as f32 / 2.0, params.height as f32 / 2.0];
    let half_diagonal = maths::hypot(centre[0], centre[1]);
    exec::for_rows(&mut photo.data, params.width * 3, job.part(0.96, 1.0), |y, row| {
        for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
            let radius = maths::hypot(x as f32 + 0.5 - centre[0], y as f32 + 0.5 - centre[1]) / half_diagonal;
            let falloff = 1.0 - (1.0 - VIGNETTE) * radius * radius;
            let mut rng = Rng::new(params.seed, &[x as u64, y as u64]);
            for (c, out) in pixel.iter_mut().enumerate() {
                let light = (1.0 - GLARE.0) * sharp.pixel(x, y)[c] + GLARE.0 * glow.pixel(x, y)[c];
                let electrons = f64::from((light * falloff * exposure * balance[c]).max(0.0)) * WELL.0;
                let noise = (electrons + WELL.1 * WELL.1).sqrt() * rng.normal();
                let value = ((electrons + noise) / WELL.0).clamp(0.0, 1.0) as f32;
                *out = srgb_to_linear((linear_to_srgb(value) * 255.0).round() / 255.0);
            }
        }
    })?;
    Ok((photo, exposure))
}
