//! Paper and canvas for the artworks, and the marks that tools leave on them.

use crate::demo::pattern::noise;
use crate::error::Result;
use crate::image::colour::srgb_to_linear;
use crate::image::{Image, try_vec};
use crate::maths;
use crate::rng::Rng;
use glam::{Vec2, Vec3};

/// A sheet of paper or canvas. Its colours are sRGB-encoded.
pub struct Canvas {
    pub width: usize,
    pub height: usize,
    colour: Vec<Vec3>,
    /// Surface texture in `[0, 1]`. Ink ([`Self::spot`]) covers best where the surface texture is high; a dry brush
    /// ([`Self::touch`]) covers best where it is low.
    tooth: Vec<f32>,
    /// Thickness of the paint, in arbitrary units. It is lit as a relief.
    relief: Vec<f32>,
}

impl Canvas {
    /// Creates paper of a colour, which fibres, grain and clouds vary slightly.
    pub fn paper(width: usize, height: usize, colour: Vec3, seed: u64) -> Result<Self> {
        let mut canvas = Self {
            width,
            height,
            colour: try_vec(width * height, colour)?,
            tooth: try_vec(width * height, 0.0)?,
            relief: try_vec(width * height, 0.0)?,
        };
        for i in 0..width * height {
            let at = Vec2::new((i % width) as f32, (i / width) as f32);
            let grain = Rng::new(seed, &[i as u64]).next_f32();
            let fibre = noise(at / Vec2::new(3.1, 1.7), [4096; 2], seed + 1);
            let cloud = noise(at / 61.0, [4096; 2], seed + 2);
            canvas.tooth[i] = 0.5 * fibre + 0.5 * grain;
            canvas.colour[i] *= 1.0 + 0.035 * (canvas.tooth[i] - 0.5) + 0.02 * (cloud - 0.5);
        }
        Ok(canvas)
    }

    /// Creates canvas whose weave shows in the surface texture and in the relief.
    pub fn linen(width: usize, height: usize, colour: Vec3, seed: u64) -> Result<Self> {
        let mut canvas = Self::paper(width, height, colour, seed)?;
        for i in 0..width * height {
            let (x, y) = ((i % width) as f32, (i / width) as f32);
            let thread = maths::sin(x * 2.1) * maths::cos(y * 2.1);
            canvas.tooth[i] = 0.5 + 0.3 * thread + 0.4 * (canvas.tooth[i] - 0.5);
            canvas.relief[i] = 0.25 * thread;
        }
        Ok(canvas)
    }

    /// Draws a round spot of ink with a soft rim. `opacity` lies in `[0, 1]`. The surface texture breaks up a spot of
    /// low opacity.
    pub fn spot(&mut self, at: Vec2, radius: f32, colour: Vec3, opacity: f32) {
        self.deposit(at, radius, |canvas, i, cover| {
            let taken = cover * opacity * (0.55 + 0.9 * canvas.tooth[i]).min(1.0);
            canvas.colour[i] = canvas.colour[i].lerp(colour, taken.clamp(0.0, 1.0));
        });
    }

    /// Paints a round dab. `radius` is in pixels. Where the paint covers the canvas, the relief gets the value
    /// `thickness`.
    pub fn touch(&mut self, at: Vec2, radius: f32, colour: Vec3, opacity: f32, thickness: f32) {
        self.deposit(at, radius, |canvas, i, cover| {
            // At high opacity the paint covers everything, like a loaded brush. At low opacity it covers only places
            // where the surface texture is low, like a dry brush.
            let coverage = (opacity * 1.6 - canvas.tooth[i] * 0.6).clamp(0.0, 1.0);
            canvas.colour[i] = canvas.colour[i].lerp(colour, cover * coverage);
            canvas.relief[i] += (thickness - canvas.relief[i]) * cover * coverage;
        });
    }

    fn deposit(&mut self, at: Vec2, radius: f32, mut put: impl FnMut(&mut Self, usize, f32)) {
        let (low, high) = (at - radius - 0.5, at + radius + 0.5);
        let clamp = |v: f32, n: usize| (v.max(0.0) as usize).min(n);
        for y in clamp(low.y, self.height)..clamp(high.y + 1.0, self.height) {
            for x in clamp(low.x, self.width)..clamp(high.x + 1.0, self.width) {
                let distance = (Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - at).length();
                let cover = (radius + 0.5 - distance).clamp(0.0, 1.0).min(2.0 * radius);
                if cover > 0.0 {
                    put(self, y * self.width + x, cover);
                }
            }
        }
    }

    /// Returns the sheet in linear colour, with its relief lit from the upper left.
    pub fn into_image(self) -> Result<Image> {
        let (width, height) = (self.width, self.height);
        let relief = |x: usize, y: usize| self.relief[y.min(height - 1) * width + x.min(width - 1)];
        let mut out = Image::new(width, height, 3)?;
        for (i, pixel) in out.data.chunks_exact_mut(3).enumerate() {
            let (x, y) = (i % width, i / width);
            let slope = relief(x.saturating_sub(1), y.saturating_sub(1)) - relief(x + 1, y + 1);
            let colour = self.colour[i] - 0.10 * slope;
            pixel.copy_from_slice(&colour.clamp(Vec3::ZERO, Vec3::ONE).to_array().map(srgb_to_linear));
        }
        Ok(out)
    }
}

/// Returns smooth noise in `[-1, 1]` at the position `at` along a line, to imitate the tremor of a hand.
pub fn tremor(at: f32, seed: u64) -> f32 {
    2.0 * noise(Vec2::new(at, 0.5), [1 << 20, 1], seed) - 1.0
}
