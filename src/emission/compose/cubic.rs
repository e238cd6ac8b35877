//! Cubic interpolation of an image (Catmull and Rom 1974).

use crate::image::Image;
use glam::{DVec2, Vec3, Vec4};

/// Colour at a point of an image by cubic interpolation; `None` outside the image. Border pixels are repeated
/// outwards. Each channel is limited to the range of the four pixels around the point, because the cubic would fall
/// below 0 next to a bright lamp.
pub fn colour(image: &Image, p: DVec2) -> Option<Vec3> {
    let size = DVec2::new(image.width as f64, image.height as f64);
    if !(p.cmpge(DVec2::ZERO).all() && p.cmple(size).all()) {
        return None;
    }
    let [x, y] = (p - 0.5).to_array().map(floor);
    let t = (p - 0.5 - DVec2::new(x as f64, y as f64)).as_vec2();
    let [across, down] = [weights(t.x), weights(t.y)];
    // Each pixel is read as four floats: its three channels and the first channel of the next pixel. So the last column
    // that is read must not be the last one of the image.
    let is_inner = x >= 1 && y >= 1 && x + 3 < image.width as isize && y + 2 < image.height as isize;
    let [above, upper, lower, below] = if is_inner && image.channels == 3 {
        let first = 3 * ((y as usize - 1) * image.width + x as usize - 1);
        let row = |j: usize| pixels_of_row(&image.data[first + j * 3 * image.width..]);
        [row(0), row(1), row(2), row(3)]
    } else {
        let inside = |at: isize, side: usize| at.clamp(0, side as isize - 1) as usize;
        let row = |j: isize| {
            let pixel = |i: isize| image.rgb(inside(x + i, image.width), inside(y + j, image.height)).extend(0.0);
            [pixel(-1), pixel(0), pixel(1), pixel(2)]
        };
        [row(-1), row(0), row(1), row(2)]
    };
    let along = |row: [Vec4; 4]| (row[0] * across[0] + row[1] * across[1]) + (row[2] * across[2] + row[3] * across[3]);
    let sum = (along(above) * down[0] + along(upper) * down[1]) + (along(lower) * down[2] + along(below) * down[3]);
    let min_rgb = upper[1].min(upper[2]).min(lower[1].min(lower[2]));
    let max_rgb = upper[1].max(upper[2]).max(lower[1].max(lower[2]));
    // Only finite sums are limited, so that NaN and infinite values are passed on.
    let sum_rgb = sum.truncate();
    Some(if sum_rgb.is_finite() { sum.max(min_rgb).min(max_rgb).truncate() } else { sum_rgb })
}

/// Four neighbouring pixels of an image with three channels. The fourth lane of each holds the red channel of the next
/// pixel, and is ignored.
#[inline(always)]
fn pixels_of_row(row: &[f32]) -> [Vec4; 4] {
    let row = &row[..13];
    let pixel = |i: usize| Vec4::new(row[i], row[i + 1], row[i + 2], row[i + 3]);
    [pixel(0), pixel(3), pixel(6), pixel(9)]
}

/// The largest integer that is at most `value`. This is faster than `f64::floor`, for which baseline x86-64 has no
/// instruction.
fn floor(value: f64) -> isize {
    let towards_zero = value as isize;
    towards_zero - isize::from(towards_zero as f64 > value)
}

/// Catmull-Rom weights of four pixels in a row, at the fraction `t` of the way from the second to the third pixel.
fn weights(t: f32) -> [f32; 4] {
    let u = 1.0 - t;
    let (first, last) = (-0.5 * t * u * u, -0.5 * u * t * t);
    [first, u + last - 2.0 * first, t + first - 2.0 * last, last]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beside_bright_lamps_nothing_is_darker_than_dark_and_values_that_are_no_numbers_are_reported() {
        let edge = Image::from_fn(12, 4, |x, _| [if x < 6 { 1000.0 } else { 1.0 }; 3]).unwrap();
        for i in 0..60 {
            let value = colour(&edge, DVec2::new(3.0 + 0.1 * f64::from(i), 2.2)).unwrap();
            assert!(value.min_element() >= 1.0 && value.max_element() <= 1000.0, "{value}");
        }
        let mut hole = edge;
        hole.data[3 * (12 + 3)] = f32::NAN;
        assert!(!colour(&hole, DVec2::new(3.2, 1.7)).unwrap().is_finite());
    }
}
