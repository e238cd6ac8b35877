//! Resamples the photo under a texel: computes its mean colour over a small square of the unwarped image.
//!
//! The homography maps the square to a quadrangle in the photo. The sides of the quadrangle are divided into steps of
//! about one photo pixel, and the colours at these points are averaged. Cubic interpolation gives the colour at a
//! point (Catmull and Rom 1974). Detail is thus kept where the photo is magnified, and averaged where it is reduced.
//!
//! The usual method, the elliptical weighted average (Heckbert 1989, 3.5), takes a fifth to a half of the time, but is
//! less exact. At its published width, its Gaussian also weighs parts of the photo that belong to other texels; a
//! Gaussian as narrow as a texel does not have the texel's shape. The usual method is better only at extreme
//! magnification, where tens of texels along one side share a photo pixel. `cargo bench --bench emission -- recovery`
//! compares both methods with the truth.

use crate::geometry::Homography;
use crate::image::Image;
use glam::{DVec2, Vec3};

/// Maximum number of sample points along each side of the square. It limits the time for texels near the horizon.
const MAX_POINTS: f64 = 32.0;

/// Mean colour of a photo over a square of the unwarped image, given by its centre `middle` and its side. Only sample
/// points within the photo count. `None` if there are none, or if the mean is not finite.
pub fn mean(photo: &Image, to_photo: &Homography, middle: DVec2, side: f64) -> Option<Vec3> {
    let at = |step: DVec2| to_photo.apply(middle + step * side);
    // At the horizon the length is NaN, which the cast turns into 0 points.
    let points = |axis: DVec2| (at(axis * 0.5) - at(axis * -0.5)).length().ceil().clamp(1.0, MAX_POINTS) as usize;
    let (across, down) = (points(DVec2::X), points(DVec2::Y));
    let (mut sum, mut shown) = (Vec3::ZERO, 0.0);
    for i in 0..across * down {
        let step = DVec2::new((i % across) as f64 + 0.5, (i / across) as f64 + 0.5);
        if let Some(colour) = cubic(photo, at(step / DVec2::new(across as f64, down as f64) - 0.5)) {
            sum += colour;
            shown += 1.0;
        }
    }
    Some(sum / shown).filter(|colour| colour.is_finite())
}

/// Colour at a point of the photo by cubic interpolation; `None` outside the photo. Border pixels are repeated
/// outwards. The result is limited to the range of the four pixels around the point, because the cubic would fall
/// below 0 next to a bright lamp.
fn cubic(photo: &Image, p: DVec2) -> Option<Vec3> {
    let size = DVec2::new(photo.width as f64, photo.height as f64);
    if !(p.cmpge(DVec2::ZERO).all() && p.cmple(size).all()) {
        return None;
    }
    let low = (p - 0.5).floor();
    let t = (p - 0.5 - low).as_vec2();
    let (across, down) = (weights(t.x), weights(t.y));
    let (x, y) = (low.x as isize, low.y as isize);
    let inside = |at: isize, side: usize| at.clamp(0, side as isize - 1) as usize;
    let (mut sum, mut least, mut most) = (Vec3::ZERO, Vec3::INFINITY, Vec3::NEG_INFINITY);
    for (j, down) in (0..).zip(down) {
        for (i, across) in (0..).zip(across) {
            let pixel = photo.rgb(inside(x + i - 1, photo.width), inside(y + j - 1, photo.height));
            sum += pixel * (across * down);
            if (1..3).contains(&i) && (1..3).contains(&j) {
                (least, most) = (least.min(pixel), most.max(pixel));
            }
        }
    }
    // Only finite sums are limited, so that NaN and infinite values are passed on.
    Some(if sum.is_finite() { sum.max(least).min(most) } else { sum })
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
    use glam::DMat3;

    #[test]
    fn pixels_are_themselves_and_planes_exact_between_them() {
        let photo = Image::from_fn(9, 7, |x, y| [x as f32 + 0.5, 2.0 * y as f32, (x * x + y) as f32]).unwrap();
        let same = Homography(DMat3::IDENTITY);
        for (x, y) in [(0, 0), (4, 3), (8, 6)] {
            let middle = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            assert_eq!(mean(&photo, &same, middle, 1.0), Some(photo.rgb(x, y)));
        }
        for p in [DVec2::new(3.2, 3.9), DVec2::new(5.75, 2.6)] {
            let (x, y) = (p.x as f32, 2.0 * (p.y as f32 - 0.5));
            let found = cubic(&photo, p).unwrap();
            assert!((found.x - x).abs() < 1e-5 && (found.y - y).abs() < 1e-5, "{found}");
        }
    }

    #[test]
    fn areas_are_averaged_and_what_is_beyond_the_photo_left_out() {
        // Squares that cover 12 x 3 photo pixels. The mean of a linear image over a square is its value at the centre.
        let photo = Image::from_fn(96, 30, |x, y| [x as f32 + 0.5 + 10.0 * (y as f32 + 0.5); 3]).unwrap();
        let wide = Homography(DMat3::from_diagonal(glam::DVec3::new(12.0, 3.0, 1.0)));
        let found = mean(&photo, &wide, DVec2::new(4.5, 5.5), 1.0).unwrap();
        assert!((found.x - (54.0 + 165.0)).abs() < 1e-3, "{found}");
        // If half of the square lies outside the photo, only the other half counts.
        let found = mean(&photo, &wide, DVec2::new(0.0, 5.5), 1.0).unwrap();
        assert!((found.x - (3.0 + 165.0)).abs() < 0.2, "{found}");
        assert_eq!(mean(&photo, &wide, DVec2::new(-1.0, 5.5), 1.0), None);
        // At the horizon the square covers unboundedly many photo pixels, but the limit on the sample points keeps the
        // time short.
        let horizon = Homography(DMat3::from_cols_array_2d(&[[1.0, 0.0, 0.0], [0.0, 1.0, 1.0], [1.0, 1.0, -1.0]]));
        for y in [0.9, 1.0, 1.0 + 1e-9, 1.5] {
            mean(&photo, &horizon, DVec2::new(0.5, y), 1.0);
        }
    }

    #[test]
    fn beside_bright_lamps_nothing_is_darker_than_dark_and_what_is_no_number_is_told() {
        let edge = Image::from_fn(12, 4, |x, _| [if x < 6 { 1000.0 } else { 1.0 }; 3]).unwrap();
        for i in 0..60 {
            let value = cubic(&edge, DVec2::new(3.0 + 0.1 * f64::from(i), 2.2)).unwrap();
            assert!(value.min_element() >= 1.0 && value.max_element() <= 1000.0, "{value}");
        }
        let mut hole = edge;
        hole.data[3 * (12 + 3)] = f32::NAN;
        assert_eq!(mean(&hole, &Homography(DMat3::IDENTITY), DVec2::new(3.2, 1.7), 1.0), None);
    }
}
