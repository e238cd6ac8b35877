//! Warns if the lamps do not lie on the unwarped plane, as their sizes in the photo tell.
//!
//! Not modelled: lamps of several kinds. If all large lamps are far away and all small lamps near, the warning is
//! raised although the lamps may lie on the plane.

use super::Unwarped;
use super::shapes::BLOOM_UNIT;
use crate::geometry::PhotoMap;
use crate::image::Image;
use crate::image::regions::{Moments, Regions};
use crate::maths;
use crate::warning::{Code, Warning};
use std::f64::consts::PI;

/// Number of lamps below which their sizes tell nothing about the plane. [convention]
const MIN_LAMPS: usize = 6;
/// Photo pixels of the smallest lamp that counts. The area of a smaller lamp is mostly rounding. [rounding]
const MIN_AREA: f64 = 20.0;
/// A warning is given if the exponent of the lamps is below this: half of the exponent of lamps that are alike and lie
/// on the plane. [convention]
const MIN_EXPONENT: f64 = 0.5;
/// The exponent must also lie this number of standard errors below 1. [convention]
const SIGNIFICANT: f64 = 3.0;
/// Bloom widens small and large lamps alike and so lowers the exponent. Widths of bloom for which both must hold, in
/// units of [`BLOOM_UNIT`]: up to the standard deviation of the width. [bench photos:tune]
const BLOOMS: [f64; 4] = [0.0, 0.5, 1.0, 1.5];

/// How the areas of lamps in the photo grow with the scale of the plane at their places, which is the area in the photo
/// of a small part of the plane. The areas are proportional to a power of the scale. If the lamps are alike and lie on
/// the plane, the exponent is 1; if their sizes have nothing to do with the plane, it is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Growth {
    exponent: f64,
    /// Standard error of the exponent.
    error: f64,
}

/// Warns if the sizes of the lamps in the photo do not follow the perspective of the plane. `lights` is the mask of the
/// lights in the photo. `None` if they follow it, or if there are too few lamps to tell.
pub fn off_plane(lights: &Image, unwarped: &Unwarped) -> Option<Warning> {
    let lamps = Regions::of(lights).and_then(|regions| regions.moments([lights.width, lights.height])).ok()?;
    let unit = BLOOM_UNIT * lights.width.max(lights.height) as f64;
    let growths = BLOOMS.map(|bloom| Growth::of(&lamps, &unwarped.to_photo, bloom * unit));
    let is_below = |growth: &Growth| growth.exponent + SIGNIFICANT * growth.error < 1.0;
    if !growths.iter().all(|growth| growth.as_ref().is_some_and(is_below)) {
        return None;
    }
    let exponent = growths.iter().flatten().map(|growth| growth.exponent).fold(f64::NEG_INFINITY, f64::max);
    let message = || {
        format!(
            "the sizes of the lamps contradict the plane: where the photo shows the plane k times as large, it shows \
             the lamps k^{exponent:.2} times as large"
        )
    };
    let advice = "do not use the texture unless it looks like the photo: if the lamps hang or lie on several planes, \
                  the photo has no pattern to copy; otherwise the mask of the lights shows other things, or the camera \
                  is wrong";
    Warning::below(Code::OffPlane, exponent, MIN_EXPONENT, message, advice)
}

impl Growth {
    /// The growth of lamps that the border of the photo does not cut, after bloom of this width in pixels is removed
    /// from them. `None` if too few lamps remain.
    fn of(lamps: &[Moments], to_photo: &PhotoMap, bloom: f64) -> Option<Self> {
        let to_plane = to_photo.homography.inverse();
        let points = lamps.iter().filter(|lamp| lamp.area >= MIN_AREA && !lamp.is_cut).map(|lamp| {
            // A homography with the third homogeneous coordinate w multiplies areas by a constant over |w|³.
            let w = to_plane.apply_homogeneous(to_photo.lens.ideal(lamp.centre)).z;
            let radius = (lamp.area / PI).sqrt() - bloom;
            [3.0 * maths::ln(w.abs()), 2.0 * maths::ln(radius.max(0.0))]
        });
        let points: Vec<[f64; 2]> = points.filter(|[scale, area]| scale.is_finite() && area.is_finite()).collect();
        (points.len() >= MIN_LAMPS).then(|| Self::fit(&points)).flatten()
    }

    /// The straight line of least squares through points of the logarithms of scale and area. `None` if all scales are
    /// equal.
    fn fit(points: &[[f64; 2]]) -> Option<Self> {
        let count = points.len() as f64;
        let mean = [0, 1].map(|k| points.iter().map(|point| point[k]).sum::<f64>() / count);
        let product = |a: usize, b: usize| -> f64 {
            points.iter().map(|point| (point[a] - mean[a]) * (point[b] - mean[b])).sum()
        };
        let exponent = product(0, 1) / product(0, 0);
        let residual = (product(1, 1) - exponent * product(0, 1)).max(0.0) / (count - 2.0);
        let error = (residual / product(0, 0)).sqrt();
        (exponent.is_finite() && error.is_finite()).then_some(Self { exponent, error })
    }
}

#[cfg(test)]
#[path = "tests/off_plane.rs"]
mod tests;
