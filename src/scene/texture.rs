//! Textures: images with wrapping and bilinear sampling.

use crate::image::Image;
use crate::image::regions::any_light;
use glam::{Vec2, Vec4};

/// How a texture continues outside `[0, 1]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    Repeat,
    Clamp,
    Mirror,
}

/// An image with linear values; (u, v) = (0, 0) is the outer corner of the top-left texel.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    pub name: String,
    pub image: Image,
    pub wrap: [Wrap; 2],
}

impl Texture {
    pub fn new(name: &str, image: Image) -> Self {
        Self { name: name.into(), image, wrap: [Wrap::Repeat; 2] }
    }

    /// Samples bilinearly. An image without alpha gives an alpha of 1, and a grey image gives r = g = b.
    pub fn sample(&self, uv: Vec2) -> Vec4 {
        let ([x0, x1], tx) = neighbours(uv.x, self.image.width, self.wrap[0]);
        let ([y0, y1], ty) = neighbours(uv.y, self.image.height, self.wrap[1]);
        // Written out, so that no platform's vector code fuses the multiplication and the addition.
        let between = |a: Vec4, b: Vec4, t: f32| a + (b - a) * t;
        let top = between(self.texel(x0, y0), self.texel(x1, y0), tx);
        let bottom = between(self.texel(x0, y1), self.texel(x1, y1), tx);
        between(top, bottom, ty)
    }

    /// Returns the texel that covers `uv`, without interpolation.
    pub fn nearest(&self, uv: Vec2) -> Vec4 {
        let size = Vec2::new(self.image.width as f32, self.image.height as f32);
        self.continued((uv * size).floor())
    }

    /// Returns the texel at integer coordinates, wrapped if they lie outside the image.
    pub fn continued(&self, texel: Vec2) -> Vec4 {
        let x = wrap_index(texel.x, self.image.width, self.wrap[0]);
        let y = wrap_index(texel.y, self.image.height, self.wrap[1]);
        self.texel(x, y)
    }

    /// Whether all texels of a square are black. The square has its top-left texel at (x, y) and lies inside the
    /// image.
    pub fn is_black(&self, [x, y]: [usize; 2], side: usize) -> bool {
        let channels = self.image.channels;
        let row = |y: usize| &self.image.data[(y * self.image.width + x) * channels..][..side * channels];
        // Two channels hold no colour: `texel` returns white for such an image.
        channels != 2 && (y..y + side).all(|y| !any_light(row(y), channels))
    }

    /// Returns the texel at (x, y) as RGBA; see [`Texture::sample`] for missing channels.
    pub fn texel(&self, x: usize, y: usize) -> Vec4 {
        match *self.image.pixel(x, y) {
            [v] => Vec4::new(v, v, v, 1.0),
            [r, g, b] => Vec4::new(r, g, b, 1.0),
            [r, g, b, a, ..] => Vec4::new(r, g, b, a),
            _ => Vec4::ONE,
        }
    }
}

/// Row-major index of the texel that covers `uv` in a texture of `width × height` texels.
pub fn texel_at(uv: Vec2, [width, height]: [usize; 2], wrap: [Wrap; 2]) -> usize {
    let texel = (uv * Vec2::new(width as f32, height as f32)).floor();
    wrap_index(texel.y, height, wrap[1]) * width + wrap_index(texel.x, width, wrap[0])
}

/// Returns the indices of the two texels whose centres enclose a coordinate, and the fractional position between them.
fn neighbours(u: f32, size: usize, wrap: Wrap) -> ([usize; 2], f32) {
    let position = (u * size as f32 - 0.5).max(-16_777_216.0).min(16_777_216.0);
    // A cast truncates towards 0, so subtract one from a negative position that is not whole. (`floor` is a function
    // call on processors without SSE4.1.)
    let cut = position as i32;
    let base = cut - i32::from(cut as f32 > position);
    let t = position - base as f32;
    // Fast path: both texels lie inside the image, so no wrapping is needed.
    if base >= 0 && base as usize + 1 < size {
        return ([base as usize, base as usize + 1], t);
    }
    ([wrap_index(base as f32, size, wrap), wrap_index(base as f32 + 1.0, size, wrap)], t)
}

fn wrap_index(i: f32, size: usize, wrap: Wrap) -> usize {
    // Clamp to 2^24, beyond which `f32` does not distinguish neighbouring texels. The cast turns NaN into 0.
    let i = i.clamp(-16_777_216.0, 16_777_216.0) as i32;
    let n = size as i32;
    // Fast path: an index within the texture needs no wrapping and thus no slow integer division.
    if (0..n).contains(&i) {
        return i as usize;
    }
    let wrapped = match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Clamp => i.clamp(0, n - 1),
        Wrap::Mirror => {
            let m = i.rem_euclid(2 * n);
            m.min(2 * n - 1 - m)
        }
    };
    wrapped as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapping_follows_its_mode() {
        let image = Image::from_fn(4, 1, |x, _| [x as f32]).unwrap();
        let at = |wrap, u| {
            Texture { name: String::new(), image: image.clone(), wrap: [wrap; 2] }.nearest(Vec2::new(u, 0.5)).x
        };
        assert_eq!([-0.1, 0.1, 1.1, 2.9].map(|u| at(Wrap::Repeat, u)), [3.0, 0.0, 0.0, 3.0]);
        assert_eq!([-0.1, 0.1, 1.1, 2.9].map(|u| at(Wrap::Clamp, u)), [0.0, 0.0, 3.0, 3.0]);
        assert_eq!([-0.1, 0.1, 1.1, 2.9].map(|u| at(Wrap::Mirror, u)), [0.0, 0.0, 3.0, 3.0]);
        assert!(at(Wrap::Repeat, f32::NAN).is_finite() && at(Wrap::Clamp, f32::INFINITY).is_finite());
        // Check the interpolation between texel centres, across the border of the image and far outside it.
        let between = |wrap, u| {
            Texture { name: String::new(), image: image.clone(), wrap: [wrap; 2] }.sample(Vec2::new(u, 0.5)).x
        };
        assert_eq!([0.125, 0.25, 0.875, 0.9375, 1.0].map(|u| between(Wrap::Repeat, u)), [0.0, 0.5, 3.0, 2.25, 1.5]);
        assert_eq!([-0.25, -1.0, 2.25].map(|u| between(Wrap::Repeat, u)), [2.5, 1.5, 0.5]);
        assert_eq!([-0.25, 1.0, 2.25].map(|u| between(Wrap::Clamp, u)), [0.0, 3.0, 3.0]);
        assert_eq!([-0.25, 1.25].map(|u| between(Wrap::Mirror, u)), [0.5, 2.5]);
        assert!(between(Wrap::Mirror, f32::NEG_INFINITY).is_finite());
    }
}
