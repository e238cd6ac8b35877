//! Resamples the photo under a texel: computes its mean colour over a small square of the unwarped image.
//!
//! The homography maps the square to a quadrangle in the photo. The colours at a grid of points in the quadrangle,
//! about one photo pixel apart, are averaged. Cubic interpolation gives the colour at a point (Catmull and Rom 1974).
//! Detail is thus kept where the photo is magnified, and averaged where it is reduced.
//! If the quadrangle is at least [`MIN_PIXELS`] photo pixels wide, the points are read from a copy of the photo at 1/2,
//! 1/4, … of its size. In this copy, the quadrangle is 4 to 8 pixels wide.
//!
//! The usual method is the elliptical weighted average (Heckbert 1989, 3.5). It takes a fifth to a half of the time of
//! the method used here, but is less exact. Its Gaussian, at the published width, also covers parts of the photo that
//! belong to other texels; a narrower Gaussian still does not have the square shape of a texel. The elliptical weighted
//! average is better only at extreme magnification, where a row of tens of texels shows the same photo pixel.
//! `cargo bench --bench emission -- recovery` compares both methods with the true image.

use super::cubic;
use crate::error::Result;
use crate::geometry::PhotoMap;
use crate::image::{Image, pyramid};
use crate::job::Job;
use glam::{DVec2, Vec3};

/// Maximum number of sample points along each side of the square. It limits the time for texels near the horizon.
/// [convention]
const MAX_POINTS: f64 = 32.0;

/// In the photo, a square of the unwarped image is a quadrangle. If its shorter side is at least this number of photo
/// pixels long, a smaller copy of the photo is read instead of the photo. [bench emission:recovery]
const MIN_PIXELS: f64 = 8.0;

/// The photo and its smaller copies, each with half the width and height of the copy before.
#[derive(Clone, Copy)]
pub struct Levels<'a> {
    pub photo: &'a Image,
    pub smaller: &'a [Image],
}

/// Makes the smaller copies of the photo that are needed to read squares of the unwarped image, given by their centres
/// and their side.
pub fn smaller(
    photo: &Image,
    to_photo: &PhotoMap,
    centres: impl Iterator<Item = DVec2>,
    side: f64,
    job: Job,
) -> Result<Vec<Image>> {
    let pixels = centres.map(|p| sides(to_photo, p, side).min_element()).filter(|pixels| pixels.is_finite());
    pyramid::halvings(photo, level(pixels.fold(0.0, f64::max), usize::MAX), job)
}

/// How many times the photo is halved before a quadrangle is read from it; at most `max`. The shorter side of the
/// quadrangle is `pixels` photo pixels long.
fn level(pixels: f64, max: usize) -> usize {
    // The cast turns NaN into 0.
    let ratio = (pixels / MIN_PIXELS) as usize;
    ratio.checked_ilog2().map_or(0, |halvings| halvings as usize + 1).min(max)
}

/// The lengths, in photo pixels, of the lines that connect the middles of opposite sides of a square of the unwarped
/// image. NaN or infinite at the horizon.
fn sides(to_photo: &PhotoMap, middle: DVec2, side: f64) -> DVec2 {
    let length = |axis: DVec2| {
        let half = axis * (0.5 * side);
        (to_photo.apply(middle + half) - to_photo.apply(middle - half)).length()
    };
    DVec2::new(length(DVec2::X), length(DVec2::Y))
}

impl Levels<'_> {
    /// Mean colour of the photo over a square of the unwarped image, given by its centre `middle` and its side. `edit`
    /// changes the colour of each sample point. Only sample points within the photo count. `None` if there are none,
    /// or if the mean is not finite.
    pub fn mean(&self, to_photo: &PhotoMap, middle: DVec2, side: f64, edit: impl Fn(Vec3) -> Vec3) -> Option<Vec3> {
        let pixels = sides(to_photo, middle, side);
        let level = level(pixels.min_element(), self.smaller.len());
        let image = level.checked_sub(1).map_or(self.photo, |i| &self.smaller[i]);
        let factor = 1.0 / (1usize << level) as f64;
        // At the horizon, the lengths are NaN; the cast turns them into 0 points.
        let [across, down] = (pixels * factor).to_array().map(|p| p.ceil().clamp(1.0, MAX_POINTS) as usize);

        // Step from point to point in homogeneous coordinates, in which the map into the photo is linear.
        let counts = DVec2::new(across as f64, down as f64);
        let first = to_photo.homography.apply_homogeneous(middle + (0.5 / counts - 0.5) * side);
        let [along_x, along_y] = [0, 1].map(|k| to_photo.homography.0.col(k) * (side / counts[k]));
        let (mut sum, mut shown) = (Vec3::ZERO, 0.0);
        for j in 0..down {
            let start = first + along_y * j as f64;
            for i in 0..across {
                let q = start + along_x * i as f64;
                let at = match to_photo.lens.is_none() {
                    true => q.truncate() * (factor / q.z),
                    false => to_photo.lens.shown(q.truncate() / q.z) * factor,
                };
                if let Some(colour) = cubic::colour(image, at) {
                    sum += edit(colour);
                    shown += 1.0;
                }
            }
        }
        Some(sum / shown).filter(|colour| colour.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Homography, Radial};
    use crate::job::Monitor;
    use glam::DMat3;

    fn mean(photo: &Image, to_photo: &PhotoMap, middle: DVec2, side: f64) -> Option<Vec3> {
        Levels { photo, smaller: &[] }.mean(to_photo, middle, side, |colour| colour)
    }

    #[test]
    fn pixels_are_themselves_and_planes_exact_between_them() {
        let photo = Image::from_fn(9, 7, |x, y| [x as f32 + 0.5, 2.0 * y as f32, (x * x + y) as f32]).unwrap();
        let same: PhotoMap = Homography(DMat3::IDENTITY).into();
        for (x, y) in [(0, 0), (4, 3), (8, 6)] {
            let middle = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            assert_eq!(mean(&photo, &same, middle, 1.0), Some(photo.rgb(x, y)));
        }
        for p in [DVec2::new(3.2, 3.9), DVec2::new(5.75, 2.6)] {
            let (x, y) = (p.x as f32, 2.0 * (p.y as f32 - 0.5));
            let found = cubic::colour(&photo, p).unwrap();
            assert!((found.x - x).abs() < 1e-5 && (found.y - y).abs() < 1e-5, "{found}");
        }
    }

    #[test]
    fn areas_are_averaged_and_what_is_beyond_the_photo_left_out() {
        // Squares that cover 12 x 3 photo pixels. The mean of a linear image over a square is its value at the centre.
        let photo = Image::from_fn(96, 30, |x, y| [x as f32 + 0.5 + 10.0 * (y as f32 + 0.5); 3]).unwrap();
        let wide = Homography(DMat3::from_diagonal(glam::DVec3::new(12.0, 3.0, 1.0))).into();
        let found = mean(&photo, &wide, DVec2::new(4.5, 5.5), 1.0).unwrap();
        assert!((found.x - (54.0 + 165.0)).abs() < 1e-3, "{found}");
        // If half of the square lies outside the photo, only the other half counts.
        let found = mean(&photo, &wide, DVec2::new(0.0, 5.5), 1.0).unwrap();
        assert!((found.x - (3.0 + 165.0)).abs() < 0.2, "{found}");
        assert_eq!(mean(&photo, &wide, DVec2::new(-1.0, 5.5), 1.0), None);
        // The mean is `None` if it would include a pixel that is not finite.
        let mut hole = photo.clone();
        hole.data[3 * (12 * 96 + 54)] = f32::NAN;
        assert_eq!(mean(&hole, &wide, DVec2::new(4.5, 4.2), 1.0), None);
        // At the horizon the square covers unboundedly many photo pixels, but the limit on the sample points keeps the
        // time short.
        let horizon =
            Homography(DMat3::from_cols_array_2d(&[[1.0, 0.0, 0.0], [0.0, 1.0, 1.0], [1.0, 1.0, -1.0]])).into();
        for y in [0.9, 1.0, 1.0 + 1e-9, 1.5] {
            mean(&photo, &horizon, DVec2::new(0.5, y), 1.0);
        }
    }

    #[test]
    fn the_distortion_of_a_lens_is_part_of_the_map() {
        // In the photo of an ideal lens, the values would be linear, so their mean is the value at the centre.
        let lens = Radial::new(-0.2, DVec2::new(48.0, 15.0), DVec2::new(96.0, 30.0)).unwrap();
        let photo = Image::from_fn(96, 30, |x, y| {
            let ideal = lens.ideal(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
            [(ideal.x + 10.0 * ideal.y) as f32; 3]
        });
        let homography = Homography(DMat3::from_diagonal(glam::DVec3::new(12.0, 3.0, 1.0)));
        let at = |map: &PhotoMap| mean(photo.as_ref().unwrap(), map, DVec2::new(5.5, 6.5), 1.0).unwrap().x;
        let found = at(&PhotoMap { homography, lens });
        assert!((found - (66.0 + 195.0)).abs() < 0.1, "{found}");
        assert!((at(&homography.into()) - found).abs() > 1.0);
    }

    #[test]
    fn wide_squares_are_read_from_smaller_copies() {
        let wide = Homography(DMat3::from_diagonal(glam::DVec3::new(40.0, 20.0, 1.0))).into();
        let centres = || [DVec2::new(3.0, 4.0)].into_iter();
        // A linear ramp plus stripes that are two pixels wide and average to 0.
        let stripe = |x: usize| if x % 4 < 2 { 200.0 } else { -200.0 };
        let photo = Image::from_fn(240, 160, |x, y| [x as f32 + 10.0 * y as f32 + stripe(x); 3]).unwrap();
        let smaller = smaller(&photo, &wide, centres(), 1.0, Monitor::default().job()).unwrap();
        assert_eq!(smaller.iter().map(|copy| copy.width).collect::<Vec<_>>(), [120, 60]);
        let found = Levels { photo: &photo, smaller: &smaller }.mean(&wide, DVec2::new(3.0, 4.0), 1.0, |colour| colour);
        // The mean of a ramp is its value at the centre, (120, 80) in the photo. Pixel centres lie at half-integers, so
        // the value there is 119.5 + 10 · 79.5.
        assert!((found.unwrap().x - (119.5 + 795.0)).abs() < 0.5, "{found:?}");
        // A square of 0.3 unwarped pixels covers 12 × 6 photo pixels, which needs no smaller copy.
        let none = super::smaller(&photo, &wide, centres(), 0.3, Monitor::default().job()).unwrap();
        assert!(none.is_empty());
    }
}
