//! Foreshortening: the number of photo pixels that show each part of the unwarped image.

use crate::geometry::{Homography, PhotoMap};
use crate::maths;
use glam::{DMat2, DVec2};

/// First-order approximation of the map from the unwarped image into the photo, near a point.
#[derive(Clone, Copy, Debug)]
pub struct LocalMap {
    /// Derivative of the map, in photo pixels per unwarped pixel.
    jacobian: DMat2,
}

impl LocalMap {
    /// The map near a point of the unwarped image. Without a map, the unwarped image stands for the photo: the
    /// map is the identity.
    pub fn new(to_photo: Option<PhotoMap>, at: DVec2) -> Self {
        let jacobian = to_photo.map_or(DMat2::IDENTITY, |h| {
            let p = |dx: f64, dy: f64| h.apply(at + DVec2::new(dx, dy));
            DMat2::from_cols(p(0.5, 0.0) - p(-0.5, 0.0), p(0.0, 0.5) - p(0.0, -0.5))
        });
        Self { jacobian }
    }

    /// Area in photo pixels of one unwarped pixel.
    pub fn area(&self) -> f64 {
        self.jacobian.x_axis.perp_dot(self.jacobian.y_axis).abs()
    }

    /// Derivative of the inverse map, in unwarped pixels per photo pixel.
    pub fn inverse(&self) -> DMat2 {
        self.jacobian.inverse()
    }

    /// Length of a photo pixel in unwarped pixels, along x and along y. If an edge perpendicular to the axis moves by
    /// one pixel in the photo, it moves by this length in the unwarped image. Infinite if the map has no inverse.
    pub fn photo_pixel(&self) -> DVec2 {
        let inverse = self.jacobian.inverse().transpose();
        let size = DVec2::new(inverse.x_axis.length(), inverse.y_axis.length());
        if size.is_finite() { size } else { DVec2::splat(f64::INFINITY) }
    }
}

/// The part of an unwarped image in which unwarping magnifies the photo by at most a given factor. The magnification at
/// a point is a length in the unwarped image over the same length in the photo. The factor is relative to the
/// magnification at the least magnified pixel. Lens distortion hardly changes the magnification and is ignored.
#[derive(Clone, Copy, Debug)]
pub struct MagnificationLimit {
    homography: Homography,
    /// Largest allowed value of [`denominator`].
    max_denominator: f64,
}

impl MagnificationLimit {
    /// The part of the image that is magnified at most `max_magnification` times as much as the least magnified `shown`
    /// pixel; `None` if all `shown` pixels meet this limit.
    pub fn new(to_photo: &PhotoMap, (shown, width): (&[bool], usize), max_magnification: f64) -> Option<Self> {
        let homography = to_photo.homography;
        let denominator = |i: usize| denominator(&homography, pixel_centre(i, width));
        let values = || (0..shown.len()).filter(|&i| shown[i]).map(denominator);
        let (low, high) = values().fold((f64::INFINITY, 0.0f64), |(low, high), d| (low.min(d), high.max(d)));
        let max_denominator = low * maths::powf(max_magnification, 2.0 / 3.0);
        (max_denominator < high).then_some(Self { homography, max_denominator })
    }

    /// Sets `shown` to false for the pixels that are magnified beyond the limit.
    pub fn restrict(&self, shown: &mut [bool], width: usize) {
        shown.iter_mut().enumerate().for_each(|(i, shown)| *shown &= self.contains(pixel_centre(i, width)));
    }

    /// Whether the magnification at a point of the unwarped image is within the limit.
    pub fn contains(&self, at: DVec2) -> bool {
        denominator(&self.homography, at) <= self.max_denominator
    }
}

fn pixel_centre(i: usize, width: usize) -> DVec2 {
    DVec2::new((i % width) as f64, (i / width) as f64) + 0.5
}

/// |w| of a point that the homography has mapped, where w is the third homogeneous coordinate. The magnification of
/// lengths is proportional to |w|^(3/2).
pub fn denominator(homography: &Homography, at: DVec2) -> f64 {
    (homography.0 * at.extend(1.0)).z.abs()
}
