//! Warnings about a camera and about an unwarped plane that may be wrong.

use super::focal::USUAL_SPREAD;
use super::{Unwarped, View};
use crate::geometry::FocalSource;
use crate::maths;
use crate::warning::{Code, Warning, percent};
use glam::{DMat2, DVec2};
use std::f64::consts::FRAC_1_SQRT_2;

/// Limit, stated in the warning about an assumed focal length, of the relative standard deviation of the focal length.
/// A focal length is assumed if the lines are no more precise than the prior. Its standard deviation is then at least
/// this value, and equal to it if the lines and the prior are equally precise. [convention]
const MAX_FOCAL_SPREAD: f64 = USUAL_SPREAD * FRAC_1_SQRT_2;
/// A room axis whose standard deviation is above this, in radians, raises a warning. [judged on 38 photos]
pub const MAX_DIRECTION_ERROR: f64 = 0.035;
/// A lens whose distortion is not undone raises a warning if it displaces the photo's corners by more than this share
/// of their distance from the centre. [judged on 38 photos]
const MAX_DISTORTION: f64 = 0.02;
/// A measured value counts as different from 0 if its magnitude exceeds this number of its standard deviations.
/// [convention]
const SIGNIFICANT: f64 = 3.0;
/// An angle between room axes raises a warning if it deviates from a right angle by more than this, in radians.
/// [judged on 38 photos]
const MAX_SKEW: f64 = 0.035;
/// An angle that deviates by more than this, in radians, raises no warning. Rooms are not so oblique: one of the two
/// vanishing points must be wrong. [judged on 28 photos]
const MAX_PLAUSIBLE_SKEW: f64 = 0.35;

/// Above this magnification of the photo, the position of a lamp's edge is uncertain. [judged on 38 photos]
const SHARP_MAGNIFICATION: f64 = 4.0;
/// A plane raises a warning if more than this share of it is magnified by more than `SHARP_MAGNIFICATION`.
/// [judged on 38 photos]
const MAX_MAGNIFIED: f64 = 0.8;
/// A plane raises a warning if the median of `sin a` over the plane is below this, where `a` is the angle between the
/// plane and the viewing ray. [judged on 38 photos]
const MIN_INCIDENCE: f64 = 0.1;
/// Maximum number of pixels sampled along each side of the unwarped plane.
const GRID: usize = 96;

impl View {
    /// Returns warnings about a camera that may be wrong.
    pub fn warnings(&self) -> Vec<Warning> {
        let all = [self.focal_assumed(), self.uncertain(), self.distorted(), self.not_square()];
        all.into_iter().flatten().collect()
    }

    fn focal_assumed(&self) -> Option<Warning> {
        let camera = &self.perspective;
        (camera.focal_source == FocalSource::Assumed).then(|| {
            let spread = self.focal_spread;
            let message = format!(
                "the lines do not determine the focal length; {:.0} pixels are assumed, within {}",
                camera.focal,
                percent(spread)
            );
            let advice = "set the focal length of the rectification if it is known, or check that lamps are as long as \
                          they should be";
            Warning::new(Code::FocalAssumed, spread.max(MAX_FOCAL_SPREAD), MAX_FOCAL_SPREAD, message, advice)
        })
    }

    fn uncertain(&self) -> Option<Warning> {
        let error = self.vanishing_points.iter().map(|v| v.error).fold(0.0, f64::max);
        Warning::above(
            Code::ViewUncertain,
            error,
            MAX_DIRECTION_ERROR,
            || format!("a room axis is known within {:.1} degrees only", error.to_degrees()),
            "use a photo with more straight edges along the room, or set the camera by a rectification of your own",
        )
    }

    fn distorted(&self) -> Option<Warning> {
        let found = self.distortion.filter(|d| d.corner.abs() > SIGNIFICANT * d.error && self.undone == 0.0)?;
        let kind = if found.corner < 0.0 { "barrel" } else { "pincushion" };
        Warning::above(
            Code::LensDistortion,
            found.corner.abs(),
            MAX_DISTORTION,
            || format!("the lens bends straight lines: {} of {kind} distortion", percent(found.corner.abs())),
            "set distortion of the rectification to the distortion of the lens, unless the edges in the photo are curved",
        )
    }

    fn not_square(&self) -> Option<Warning> {
        let significant = self.squareness.iter().flatten().filter(|s| s.angle.abs() > SIGNIFICANT * s.error);
        let significant = significant.filter(|s| s.angle.abs() <= MAX_PLAUSIBLE_SKEW);
        let skew = significant.map(|s| s.angle.abs()).fold(0.0, f64::max);
        Warning::above(
            Code::NotSquare,
            skew,
            MAX_SKEW,
            || format!("the lines of the room are {:.1} degrees off right angles", skew.to_degrees()),
            "set the principal point if the photo is cropped or the lens was shifted; a room with oblique walls needs a \
             rectification of your own",
        )
    }
}

/// The footprint of a pixel of the unwarped plane: the area of the photo that the pixel covers.
struct Footprint {
    /// Centre of the footprint in pixels of the photo.
    place: DVec2,
    /// Unwarped pixels per photo pixel along a side: the square root of the ratio of areas.
    magnification: f64,
    /// Sine of the angle between the plane and the viewing ray, from the axis ratio of the footprint.
    incidence: f64,
}

impl Unwarped {
    /// Returns warnings about an unwarped plane that may be wrong.
    pub fn warnings(&self) -> Vec<Warning> {
        let footprints = self.footprints();
        [magnified(&footprints), near_horizon(&footprints)].into_iter().flatten().collect()
    }

    /// Computes the footprints of valid pixels on a regular grid over the plane.
    fn footprints(&self) -> Vec<Footprint> {
        let (width, height) = (self.valid.width, self.valid.height);
        let steps = |size: usize| (0..size).step_by(size.div_ceil(GRID).max(1));
        let valid = |&(x, y): &(usize, usize)| self.valid.data[y * width + x] > 0.5;
        let pixels = steps(height).flat_map(|y| steps(width).map(move |x| (x, y))).filter(valid);
        pixels.map(|(x, y)| self.footprint(DVec2::new(x as f64 + 0.5, y as f64 + 0.5))).collect()
    }

    fn footprint(&self, pixel: DVec2) -> Footprint {
        let [right, down] = [0, 1].map(|k| self.to_photo.homography.0.col(k));
        let seen = self.to_photo.homography.apply_homogeneous(pixel);
        let ideal = seen.truncate() / seen.z;
        let place = self.to_photo.lens.shown(ideal);
        // Compute the Jacobian of the map into the photo, and the axes of the ellipse onto which it takes a pixel.
        let through_ideal_lens = DMat2::from_cols(
            (right.truncate() - ideal * right.z) / seen.z,
            (down.truncate() - ideal * down.z) / seen.z,
        );
        let lens = &self.to_photo.lens;
        let jacobian = match lens.is_none() {
            true => through_ideal_lens,
            false => lens.derivative(place).inverse() * through_ideal_lens,
        };
        let area = jacobian.determinant().abs();
        let trace = jacobian.x_axis.length_squared() + jacobian.y_axis.length_squared();
        let longest = 0.5 * (trace + (trace * trace - 4.0 * area * area).max(0.0).sqrt());
        Footprint { place, magnification: area.sqrt().recip(), incidence: area / longest }
    }
}

fn magnified(footprints: &[Footprint]) -> Option<Warning> {
    let worst = footprints.iter().max_by(|a, b| a.magnification.total_cmp(&b.magnification))?;
    let count = footprints.iter().filter(|f| f.magnification > SHARP_MAGNIFICATION).count();
    let share = count as f64 / footprints.len() as f64;
    Warning::above(
        Code::Magnified,
        share,
        MAX_MAGNIFIED,
        || format!("the photo shows {} of the plane {SHARP_MAGNIFICATION} or more times too small", percent(share)),
        "lower max_magnification of the rectification, which cuts the far part off, or use a photo of more pixels",
    )
    .map(|warning| warning.at(Some(worst.place)))
}

fn near_horizon(footprints: &[Footprint]) -> Option<Warning> {
    let mut by_incidence: Vec<&Footprint> = footprints.iter().collect();
    by_incidence.sort_by(|a, b| a.incidence.total_cmp(&b.incidence));
    let median = by_incidence.get(by_incidence.len() / 2)?.incidence;
    Warning::below(
        Code::PlaneNearHorizon,
        median,
        MIN_INCIDENCE,
        || format!("the camera sees half of the plane at less than {:.1} degrees", maths::asin(median).to_degrees()),
        "use a photo that looks more towards the plane, or check that its mask and axes are right",
    )
    .map(|warning| warning.at(by_incidence.first().map(|f| f.place)))
}

#[cfg(test)]
#[path = "tests/warnings.rs"]
mod tests;
