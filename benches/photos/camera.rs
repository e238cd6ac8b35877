//! A model of a camera: lens, sensor and processing turn the light of a scene into a JPEG file.

use super::dice::Dice;
use super::exposure::Exposure;
use super::room::Class;
use glam::{DVec2, Vec3};
use luxfer::image::colour::{linear_to_srgb, luminance};
use luxfer::image::{Image, pyramid};
use luxfer::job::Monitor;
use luxfer::rng::Rng;

/// The properties of one camera. Lengths are shares of the picture's height, except for `blur`.
#[derive(Clone, Debug)]
pub struct Look {
    /// Standard deviation of the lens blur in pixels.
    blur: f32,
    /// A narrow and a wide glow of the lens: for each its share of the light, and its standard deviation.
    glow: [(f32, f32); 2],
    /// The star around bright lamps: number of its rays (0 for no star), its share of the light, the length of the
    /// rays, and the angle of the first ray in radians.
    star: (usize, f32, f32, f32),
    /// Radial distortion k: a pixel at distance r from the centre of the photo shows the point at r (1 + k r²) of the
    /// undistorted picture, with r = 1 in the corner. Positive values are barrel distortion.
    distortion: f32,
    /// Brightness in the corner of the picture, relative to its centre.
    vignette: f32,
    /// Linear value to which the median of the picture is exposed, unless the exposure is set for the lamps.
    key: f32,
    /// Whether the exposure is set for the lamps.
    for_lamps: bool,
    /// Strength of the white balance: 0 leaves the colour of the light, 1 makes it white.
    balance: f32,
    /// Number of electrons at white, and standard deviation of the read-out noise in electrons.
    well: f32,
    read_out: f32,
    /// Whether the tone curve rolls off towards white.
    shoulder: bool,
    contrast: f32,
    saturation: f32,
    sharpening: f32,
    quality: u8,
}

impl Look {
    pub fn new(dice: &mut Dice) -> Self {
        Self {
            blur: dice.between(0.4, 1.0),
            glow: [(dice.log_between(0.01, 0.06), 0.007), (dice.log_between(0.004, 0.035), 0.06)],
            star: (
                if dice.chance(0.15) { dice.pick(&[4, 6, 8]) } else { 0 },
                dice.between(0.005, 0.02),
                dice.between(0.04, 0.12),
                dice.between(0.0, 1.5),
            ),
            distortion: (0.012 * dice.normal() - 0.01).clamp(-0.05, 0.02),
            vignette: dice.between(0.65, 1.0),
            key: 0.27 * (0.35 * dice.normal()).exp2(),
            for_lamps: dice.chance(0.1),
            balance: dice.between(0.3, 1.0),
            well: dice.log_between(700.0, 12_000.0),
            read_out: dice.log_between(2.0, 12.0),
            shoulder: dice.chance(0.6),
            contrast: dice.between(0.0, 0.9),
            saturation: dice.between(0.9, 1.25),
            sharpening: dice.between(0.0, 0.8),
            quality: dice.whole(72, 96) as u8,
        }
    }

    /// Factor for positions in the undistorted picture, relative to its centre. Under barrel distortion it is below 1:
    /// the photo then shows the picture enlarged, so that no corner of the photo is empty.
    pub fn magnification(&self) -> f64 {
        1.0 / f64::from(self.distortion.max(0.0) + 1.0)
    }

    /// Position in the undistorted picture that a pixel of the photo shows.
    fn straight(&self, at: DVec2, size: DVec2) -> DVec2 {
        let from_centre = (at - size / 2.0) / (size.length() / 2.0);
        let k = f64::from(self.distortion);
        size / 2.0
            + from_centre * (1.0 + k * from_centre.length_squared()) * self.magnification() * (size.length() / 2.0)
    }

    /// Applies the lens distortion: light is interpolated, classes and lamp numbers are taken from the nearest pixel.
    pub fn bend(&self, exposure: &Exposure) -> Exposure {
        let (width, height) = (exposure.light.width, exposure.light.height);
        let size = DVec2::new(width as f64, height as f64);
        let from = |x: usize, y: usize| self.straight(DVec2::new(x as f64 + 0.5, y as f64 + 0.5), size);
        let light = &exposure.light;
        let moved = |x: usize, y: usize| -> [f32; 3] {
            let p = from(x, y);
            std::array::from_fn(|c| light.sample(p.x, p.y, c))
        };
        let nearest = |i: usize| {
            let p = from(i % width, i / width);
            (p.y as usize).min(height - 1) * width + (p.x as usize).min(width - 1)
        };
        Exposure {
            light: Image::from_fn(width, height, moved).expect("a picture"),
            classes: (0..width * height).map(|i| exposure.classes[nearest(i)]).collect(),
            lamps: (0..width * height).map(|i| exposure.lamps[nearest(i)]).collect(),
        }
    }

    /// Takes the photo; returns the bytes of its JPEG file.
    pub fn photograph(&self, exposure: &Exposure, seed: u64) -> Vec<u8> {
        let optical = self.starred(&self.glowing(&exposure.light));
        let exposed = self.sensor(&optical, exposure, seed);
        let developed = self.develop(&exposed);
        encode(&developed, self.quality)
    }

    /// Applies the lens blur and the two glows.
    fn glowing(&self, light: &Image) -> Image {
        let mut sum = blurred(light, self.blur);
        let spread: f32 = self.glow.iter().map(|(share, _)| share).sum();
        sum.data.iter_mut().for_each(|v| *v *= 1.0 - spread);
        for (share, size) in self.glow {
            let glow = coarsely_blurred(light, size * light.height as f32);
            sum.data.iter_mut().zip(&glow.data).for_each(|(a, b)| *a += share * b);
        }
        sum
    }

    /// Adds a star of rays to each pixel that is far brighter than the median.
    fn starred(&self, light: &Image) -> Image {
        let (rays, share, length, turn) = self.star;
        let mut out = light.clone();
        if rays == 0 {
            return out;
        }
        let bright = 20.0 * median_luminance(light);
        let steps = (length * light.height as f32) as i32;
        let weights: f32 = (1..=steps).map(|t| (-3.0 * t as f32 / steps as f32).exp()).sum::<f32>() * rays as f32;
        for y in 0..light.height {
            for x in 0..light.width {
                let colour = light.rgb(x, y);
                if luminance(colour) < bright {
                    continue;
                }
                for ray in 0..rays {
                    let way = glam::Vec2::from_angle(turn + std::f32::consts::TAU * ray as f32 / rays as f32);
                    for t in 1..=steps {
                        let at = glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5) + way * t as f32;
                        if at.min_element() >= 0.0 && (at.x as usize) < light.width && (at.y as usize) < light.height {
                            let weight = (-3.0 * t as f32 / steps as f32).exp() / weights * share;
                            let pixel = out.pixel_mut(at.x as usize, at.y as usize);
                            (Vec3::from_slice(pixel) + colour * weight).write_to_slice(pixel);
                        }
                    }
                }
            }
        }
        out
    }

    /// Applies exposure, white balance, vignetting, noise and clipping; returns linear values, of which 1 is white.
    fn sensor(&self, light: &Image, exposure: &Exposure, seed: u64) -> Image {
        let scene = &exposure.light;
        let median = metered(exposure).max(1e-6);
        let lamp = brightest(scene).max(1e-6);
        let exposure =
            if self.for_lamps { (1.3 / lamp).max(0.02 / median).min(self.key / median) } else { self.key / median };
        let mean = scene.data.chunks_exact(3).map(|p| Vec3::from_slice(p).min(Vec3::splat(8.0 * median))).sum::<Vec3>();
        let mean = (mean / luminance(mean).max(1e-6)).max(Vec3::splat(0.05));
        let balance = mean.powf(-self.balance);
        let balance = balance / luminance(mean * balance);
        let centre = DVec2::new(light.width as f64, light.height as f64) / 2.0;
        let falloff = |x: usize, y: usize| {
            let radius = (DVec2::new(x as f64 + 0.5, y as f64 + 0.5) - centre).length() / centre.length();
            1.0 - (1.0 - self.vignette) * (radius * radius) as f32
        };
        Image::from_fn(light.width, light.height, |x, y| {
            let mut rng = Rng::new(seed, &[77, x as u64, y as u64]);
            let colour = light.rgb(x, y) * balance * (exposure * falloff(x, y));
            colour.to_array().map(|value| {
                let electrons = value.max(0.0) * self.well;
                let noise = (electrons + self.read_out * self.read_out).sqrt() * rng.normal() as f32;
                ((electrons + noise) / self.well).clamp(0.0, 1.2)
            })
        })
        .expect("a picture")
    }

    /// Applies noise reduction, sharpening, saturation and the tone curve; returns display values from 0 to 1.
    fn develop(&self, exposed: &Image) -> Image {
        let soft = blurred(exposed, 0.6);
        let wide = blurred(exposed, 1.2);
        Image::from_fn(exposed.width, exposed.height, |x, y| {
            let colour = soft.rgb(x, y) + (soft.rgb(x, y) - wide.rgb(x, y)) * self.sharpening;
            let grey = luminance(colour);
            let colour = Vec3::splat(grey) + (colour - grey) * self.saturation;
            colour.to_array().map(|v| self.tone(v))
        })
        .expect("a picture")
    }

    fn tone(&self, linear: f32) -> f32 {
        let v = linear.max(0.0);
        const KNEE: f32 = 0.65;
        let v = if self.shoulder && v > KNEE {
            KNEE + (1.0 - KNEE) * (1.0 - (-(v - KNEE) / (1.0 - KNEE) * 1.5).exp())
        } else {
            v
        };
        let v = linear_to_srgb(v.min(1.0));
        (v + self.contrast * v * (1.0 - v) * (v - 0.42)).clamp(0.0, 1.0)
    }
}

fn blurred(image: &Image, sigma: f32) -> Image {
    pyramid::blur(image, sigma, Monitor::default().job()).expect("a blur")
}

/// Applies a wide blur at a reduced size, which is faster.
fn coarsely_blurred(image: &Image, sigma: f32) -> Image {
    let reduce = ((sigma / 2.0) as usize).max(1);
    let job = Monitor::default();
    let resize = |image: &Image, w: usize, h: usize| pyramid::resize(image, w, h, job.job()).expect("a size");
    let small = resize(image, image.width.div_ceil(reduce), image.height.div_ceil(reduce));
    resize(&blurred(&small, sigma / reduce as f32), image.width, image.height)
}

/// Luminance from which the exposure is set: the median of the pixels that show neither lamps nor windows, unless such
/// pixels are few.
fn metered(exposure: &Exposure) -> f32 {
    let shines = |class: u8| class == Class::Lamp as u8 || class == Class::Window as u8;
    let pixels = exposure.light.data.chunks_exact(3).zip(&exposure.classes);
    let dull = pixels.filter(|(_, class)| !shines(**class)).map(|(pixel, _)| luminance(Vec3::from_slice(pixel)));
    let mut levels: Vec<f32> = dull.collect();
    if levels.len() * 5 < exposure.classes.len() {
        return 0.5 * median_luminance(&exposure.light);
    }
    // Raise the level if a large part is dark, so that the bright parts are not clipped.
    let mut at = |share: f32| {
        let place = (levels.len() as f32 * share) as usize;
        *levels.select_nth_unstable_by(place, f32::total_cmp).1
    };
    at(0.5).max(0.45 * at(0.8))
}

fn median_luminance(image: &Image) -> f32 {
    let mut levels: Vec<f32> = image.data.chunks_exact(3).map(|p| luminance(Vec3::from_slice(p))).collect();
    let half = levels.len() / 2;
    *levels.select_nth_unstable_by(half, f32::total_cmp).1
}

/// Luminance that 0.5 % of the pixels exceed.
fn brightest(image: &Image) -> f32 {
    let mut levels: Vec<f32> = image.data.chunks_exact(3).map(|p| luminance(Vec3::from_slice(p))).collect();
    let at = levels.len() - 1 - levels.len() / 200;
    *levels.select_nth_unstable_by(at, f32::total_cmp).1
}

fn encode(display: &Image, quality: u8) -> Vec<u8> {
    let bytes: Vec<u8> = display.data.iter().map(|v| (v * 255.0).round() as u8).collect();
    let mut out = Vec::new();
    let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut out, quality);
    let size = [display.width as u32, display.height as u32];
    encoder.encode(&bytes, size[0], size[1], image::ExtendedColorType::Rgb8).expect("a JPEG file");
    out
}
