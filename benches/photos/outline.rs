//! Outlines of lamps in a photo: a lamp covers the pixels whose luminance is above the middle between its own
//! luminance and that of its surroundings.
//!
//! The corpus lists lamps by polygons whose corners are indices of pixels on the border of a region grown by
//! brightness. Some of these regions include the glare around a lamp, and all are half a pixel too small on every
//! side. The middle level is the usual definition of the width of a blurred edge (full width at half maximum). It does
//! not depend on how the library finds lamps.

use super::masks::Mask;
use glam::{DVec2, IVec2};
use luxfer::image::Image;

/// Distance in pixels from a polygon within which its lamp may reach. [convention]
const NEAR: u32 = 3;
/// Distances in pixels from a polygon within which its surroundings lie; the second one serves if other lamps cover
/// the first. [convention]
const AROUND: [u32; 2] = [8, 14];
/// Quantile of the luminance inside the polygon that stands for the lamp: louvres and bars are darker than the lamp.
/// [convention]
const OWN: f64 = 0.8;
/// Minimum share of a lamp's pixels in a connected part, such as a pane beside a bar, that counts as a lamp by itself;
/// and minimum share of all such parts together, below which the lamp is not split. [convention]
const PART: f64 = 0.2;
const PARTS: f64 = 0.8;

/// Pixels of a lamp, as `y * width + x`, for each of its parts.
pub fn parts(photo: &Image, polygon: &[DVec2], lamps: &Mask) -> Vec<Vec<u32>> {
    let frame = Frame::around(polygon, photo);
    let mut drawn = frame.mask();
    drawn.fill(&polygon.iter().map(|p| *p - frame.origin.as_dvec2()).collect::<Vec<_>>());
    let own = quantile(&drawn, OWN, |i| frame.luminance(photo, i));
    let others = frame.cut(lamps).dilated(NEAR);
    let surroundings = AROUND.iter().find_map(|&reach| {
        let mut ring = drawn.dilated(reach);
        ring.on.iter_mut().zip(&others.on).for_each(|(on, other)| *on &= !other);
        quantile(&ring, 0.5, |i| frame.luminance(photo, i))
    });
    let (Some(own), Some(surroundings)) = (own, surroundings) else { return Vec::new() };
    let mut lamp = drawn.dilated(NEAR);
    let level = f64::midpoint(own, surroundings);
    lamp.on.iter_mut().enumerate().for_each(|(i, on)| *on &= frame.luminance(photo, i) > level);

    let in_photo = |part: Vec<usize>| part.into_iter().map(|i| frame.in_photo(i, photo.width)).collect::<Vec<u32>>();
    let all: usize = lamp.count();
    let mut parts = lamp.parts();
    parts.retain(|part| part.len() as f64 >= PART * all as f64);
    if parts.iter().map(Vec::len).sum::<usize>() as f64 >= PARTS * all as f64 {
        return parts.into_iter().map(in_photo).collect();
    }
    let whole: Vec<usize> = (0..lamp.on.len()).filter(|i| lamp.on[*i]).collect();
    vec![in_photo(whole)]
}

/// The four corners of a pixel, in pixels of the photo.
pub fn corners(pixel: u32, width: usize) -> [DVec2; 4] {
    let low = DVec2::new((pixel as usize % width) as f64, (pixel as usize / width) as f64);
    [low, low + DVec2::X, low + DVec2::ONE, low + DVec2::Y]
}

/// A rectangle of a photo around a polygon.
struct Frame {
    origin: IVec2,
    width: usize,
    height: usize,
}

impl Frame {
    fn around(polygon: &[DVec2], photo: &Image) -> Self {
        let margin = f64::from(AROUND[1] + 1);
        let size = DVec2::new(photo.width as f64, photo.height as f64);
        let low = polygon.iter().copied().fold(size, DVec2::min) - margin;
        let high = polygon.iter().copied().fold(DVec2::ZERO, DVec2::max) + margin;
        let (low, high) = (low.clamp(DVec2::ZERO, size - 1.0).floor(), high.clamp(DVec2::ONE, size).ceil());
        let extent = (high - low).max(DVec2::ONE);
        Self { origin: low.as_ivec2(), width: extent.x as usize, height: extent.y as usize }
    }

    fn mask(&self) -> Mask {
        Mask::new(self.width, self.height)
    }

    fn in_photo(&self, i: usize, width: usize) -> u32 {
        let (x, y) = (i % self.width + self.origin.x as usize, i / self.width + self.origin.y as usize);
        (y * width + x) as u32
    }

    fn cut(&self, mask: &Mask) -> Mask {
        let on = (0..self.width * self.height).map(|i| mask.on[self.in_photo(i, mask.width) as usize]).collect();
        Mask { width: self.width, height: self.height, on }
    }

    /// Relative luminance of pixel `i` of the frame, by Rec. 709.
    fn luminance(&self, photo: &Image, i: usize) -> f64 {
        let at = self.in_photo(i, photo.width) as usize * photo.channels;
        let [r, g, b] = [photo.data[at], photo.data[at + 1], photo.data[at + 2]].map(f64::from);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }
}

/// Quantile `q` of the values at a mask's pixels; `None` for an empty mask.
fn quantile(mask: &Mask, q: f64, value: impl Fn(usize) -> f64) -> Option<f64> {
    let mut values: Vec<f64> = (0..mask.on.len()).filter(|i| mask.on[*i]).map(value).collect();
    values.sort_by(f64::total_cmp);
    values.get(((values.len().max(1) - 1) as f64 * q) as usize).copied()
}
