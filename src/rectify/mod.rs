//! Rectification: edges, lines, vanishing points, a homography, and an unwarped texture ("Lighting Style Transfer",
//! §5).
//!
//! ```text
//! photo ─▶ gradient ─▶ segments ───────▶ vanishing ─▶ camera ─▶ View ◀─ distortion ◀─ segments
//!             └─▶ canny ─▶ hough ─┘        ├ manhattan ─ sphere
//!                                          └ successive ─ metric
//! View + mask ─▶ plane ─▶ quad ─▶ unwarp ─▶ resample ─▶ Unwarped
//! ```
//!
//! The paper's method (gradient-restricted Hough lines and successive RANSAC groups) is available as printed:
//! [`Params::printed`]. The default differs from it where measurements favoured another choice. It uses segments with
//! end points instead of infinite lines; it searches for three orthogonal directions and the unknown focal length
//! jointly, then refines each direction freely on the sphere. The paper maps a rectangle of any shape onto the
//! quadrilateral; here the focal length gives the plane its true aspect ratio.
//!
//! Known weaknesses. Stated errors assume five segments per independent observation and an error floor of 0.2°, both
//! calibrated on re-projected panoramas. There, half of the true errors lie below 0.73 of the stated ones, as they
//! should, but one in fourteen lies beyond 2. Chance lines of a floor can displace a direction that few lines support,
//! and its stated error does not show this. Short segments share a bias of about 0.01 rad on re-projected photos; its
//! cause is unknown. Where lines are few, and noisy for their length, stated errors of directions are up to an eighth
//! too small: the mean square of true over stated errors is 1.3 with 14 lines per axis and a pixel of noise, and 1.0
//! to 1.15 with more lines or less noise.
//!
//! Not modelled: lens distortion (it is measured, see [`View::distortion`], but not corrected); pixels that are not
//! square; rooms whose walls are not at right angles. The axes of such rooms are made orthogonal, and
//! [`View::squareness`] reports their deviation from right angles.

mod biweight;
mod camera;
pub mod canny;
mod distortion;
mod footprint;
mod gather;
pub mod gradient;
pub mod hough;
mod lanes;
mod manhattan;
pub mod metric;
mod plane;
mod quad;
mod resample;
pub mod segments;
mod sphere;
mod squareness;
mod successive;
mod taps;
#[cfg(test)]
mod tests;
mod unwarp;
pub mod vanishing;
mod warnings;

pub use camera::Expected;
pub use distortion::Distortion;
pub use resample::warp;
pub use squareness::Squareness;
pub use unwarp::unwarp;

use crate::error::{Error, Result, check_range};
use crate::geometry::{Homography, Perspective, Segment};
use crate::image::{Image, pyramid};
use crate::job::Job;
use glam::{DMat3, DVec2, DVec3};

/// Longest side, in pixels, of the image in which lines are detected. Larger photos are reduced first: lenses and
/// walls deviate from straight lines by more than the precision lost.
const DETECTION_SIDE: usize = 1600;

/// How lines are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineDetector {
    /// Regions of similar gradient direction, with sub-pixel end points.
    Regions,
    /// The paper's gradient-restricted Hough transform of Canny edges; its lines are trimmed to the edges they cover.
    Hough,
}

/// How vanishing points are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// Three orthogonal directions and the focal length jointly; then each direction is refined freely.
    Manhattan,
    /// The paper's search: one group of lines after the other.
    Successive,
}

/// Distance between a vanishing point and a line in [`Search::Successive`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// The paper's measure on the detected segment, in homogeneous form: finite at infinity.
    Segment,
    /// As printed: `min(d_naive, d_vanishing)` on the whole visible line (Eq. 2).
    VisibleLine,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    pub detector: LineDetector,
    pub search: Search,
    pub metric: Metric,
    /// Half-width in radians of the band around the gradient direction that votes in the Hough transform, in `(0, pi /
    /// 2]`; default 2.5° [paper §5.1].
    pub hough_band: f64,
    /// Focal length in pixels, if known; > 0.
    pub focal: Option<f64>,
    /// Focal length in pixels that the photo's metadata gives, and its standard deviation; > 0. It counts as one more
    /// observation beside the lines, if `focal` is absent. Without it the prior is 0.85 of the width, with a wide spread.
    pub expected_focal: Option<[f64; 2]>,
    /// Principal point in pixels: the point where the optical axis meets the image plane; the image centre if absent.
    /// In cropped photos and photos by shifted lenses it lies elsewhere, possibly outside the image.
    pub principal: Option<DVec2>,
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            detector: LineDetector::Regions,
            search: Search::Manhattan,
            metric: Metric::Segment,
            hough_band: 2.5f64.to_radians(),
            focal: None,
            expected_focal: None,
            principal: None,
            seed: 1,
        }
    }
}

impl Params {
    /// The paper's method as printed.
    pub fn printed() -> Self {
        Self {
            detector: LineDetector::Hough,
            search: Search::Successive,
            metric: Metric::VisibleLine,
            ..Self::default()
        }
    }

    /// Checks that every setting is in its range.
    pub fn check(&self) -> Result<()> {
        check_range("hough_band", self.hough_band, 1e-4, std::f64::consts::FRAC_PI_2)?;
        if let Some(focal) = self.focal {
            check_range("focal", focal, 1e-3, 1e9)?;
        }
        if let Some([focal, error]) = self.expected_focal {
            check_range("expected_focal", focal, 1e-3, 1e9)?;
            check_range("error of expected_focal", error, 1e-6 * focal, 10.0 * focal)?;
        }
        if let Some(principal) = self.principal {
            check_range("principal.x", principal.x, -1e9, 1e9)?;
            check_range("principal.y", principal.y, -1e9, 1e9)?;
        }
        Ok(())
    }
}

#[derive(Clone, Debug)]
pub struct VanishingPoint {
    /// In homogeneous pixel coordinates, normalised to unit length; the third coordinate is 0 for a point at infinity.
    pub point: DVec3,
    /// Number of segments that run to the point; 0 if the point was derived from the other two.
    pub support: usize,
    /// Standard deviation of its direction in camera space, in radians.
    pub error: f64,
    /// Covariance of that direction in radians squared; its trace is the square of `error`. Lines that meet far away
    /// constrain the direction across them better than along them.
    pub covariance: DMat3,
}

/// The camera geometry that the lines of a photo imply.
#[derive(Clone, Debug)]
pub struct View {
    /// Segments, each with the index of the room axis it runs along, if any.
    pub segments: Vec<(Segment, Option<usize>)>,
    /// One vanishing point for each column of `perspective.axes`.
    pub vanishing_points: [VanishingPoint; 3],
    pub perspective: Perspective,
    /// For each axis, the deviation from a right angle of the angle between the two other axes, estimated from the
    /// lines of these two alone; absent if one of them has no lines.
    pub squareness: [Option<Squareness>; 3],
    /// Distortion of straight lines by the lens; absent if the photo has too few lines, or if only segments were
    /// given.
    pub distortion: Option<Distortion>,
    /// The focal length that was expected before the lines were looked at.
    pub expected_focal: Expected,
}

/// Finds lines, vanishing points and the camera of a linear RGB photo. Pixels that are not finite yield no lines.
///
/// A photo in which no two lines meet is an [`ErrorKind::Degenerate`](crate::error::ErrorKind) error.
pub fn find_view(photo: &Image, params: &Params, job: Job) -> Result<View> {
    params.check()?;
    let Lines { segments, distortion } = find_lines(photo, params, job.part(0.0, 0.7))?;
    let view = view_from_segments(&segments, photo.width, photo.height, params, job.part(0.7, 1.0))?;
    Ok(View { distortion, ..view })
}

/// The straight edges of a photo, in its pixels.
pub fn find_segments(photo: &Image, params: &Params, job: Job) -> Result<Vec<Segment>> {
    find_lines(photo, params, job).map(|lines| lines.segments)
}

/// The straight edges of a photo, in its pixels, and the lens distortion that their curvature implies.
struct Lines {
    segments: Vec<Segment>,
    distortion: Option<Distortion>,
}

fn find_lines(photo: &Image, params: &Params, job: Job) -> Result<Lines> {
    let size = DVec2::new(photo.width as f64, photo.height as f64);
    let centre = params.principal.unwrap_or(0.5 * size);
    let longest = photo.width.max(photo.height);
    if longest <= DETECTION_SIDE {
        return lines_at_full_size(photo, centre, params, job);
    }
    let reduce = |side: usize| (side * DETECTION_SIDE).div_ceil(longest).max(1);
    let reduced = pyramid::resize(photo, reduce(photo.width), reduce(photo.height), job.part(0.0, 0.3))?;
    let scale = size / DVec2::new(reduced.width as f64, reduced.height as f64);
    let mut lines = lines_at_full_size(&reduced, centre / scale, params, job.part(0.3, 1.0))?;
    for s in &mut lines.segments {
        (s.a, s.b) = (s.a * scale, s.b * scale);
    }
    Ok(lines)
}

fn lines_at_full_size(photo: &Image, centre: DVec2, params: &Params, job: Job) -> Result<Lines> {
    let luma = gradient::encoded_luma(photo, job.part(0.0, 0.2))?;
    let gradients = gradient::gradients(&luma, job.part(0.2, 0.4))?;
    let segments = match params.detector {
        LineDetector::Regions => segments::detect(&gradients, job.part(0.4, 1.0))?,
        LineDetector::Hough => {
            let edges = canny::edges(&gradients, job.part(0.4, 0.5))?;
            let peaks = hough::peaks(&gradients, &edges, params.hough_band, job.part(0.5, 0.7))?;
            match params.metric {
                Metric::Segment => hough::pieces(&gradients, &edges, &peaks, params.hough_band, job.part(0.7, 1.0))?,
                Metric::VisibleLine => hough::whole_lines(&gradients, &peaks),
            }
        }
    };
    let distortion = distortion::measure(&gradients, &segments, centre);
    Ok(Lines { segments, distortion })
}

/// Does the work of [`find_view`] on segments detected elsewhere.
pub fn view_from_segments(
    segments: &[Segment],
    width: usize,
    height: usize,
    params: &Params,
    job: Job,
) -> Result<View> {
    if width == 0 || height == 0 {
        return Err(Error::argument(format!("image size is {width} x {height}; both must be at least 1")));
    }
    let found = vanishing::from_segments(segments, width, height, 3, params, job)?;
    let oriented = camera::orient(&found, width, height, params);
    let axis = |member: &Option<usize>| member.and_then(|k| oriented.axis_of[k]);
    Ok(View {
        segments: segments.iter().copied().zip(found.members.iter().map(axis)).collect(),
        vanishing_points: oriented.vanishing_points,
        perspective: oriented.perspective,
        squareness: oriented.squareness,
        distortion: None,
        expected_focal: oriented.expected,
    })
}

#[derive(Clone, Debug, PartialEq)]
pub struct UnwarpParams {
    /// The two room axes that span the plane; chosen by the lines inside the mask if absent.
    pub axes: Option<[usize; 2]>,
    /// Longest side of the unwarped image in pixels, in `[16, 16384]`; the photo's own resolution decides below it.
    pub max_side: usize,
    /// Largest magnification of the photo, > 0; parts of the plane farther away are cut off.
    pub max_magnification: f64,
}

impl Default for UnwarpParams {
    fn default() -> Self {
        Self { axes: None, max_side: 2048, max_magnification: 16.0 }
    }
}

impl UnwarpParams {
    /// Checks that every setting is in its range.
    pub fn check(&self) -> Result<()> {
        check_range("max_side", self.max_side, 16, 16_384)?;
        check_range("max_magnification", self.max_magnification, f64::MIN_POSITIVE, 1e6)?;
        Ok(())
    }
}

/// A plane of the photo in fronto-parallel view, rotated so that right and down are nearly those of the photo.
#[derive(Clone, Debug)]
pub struct Unwarped {
    /// Linear RGB.
    pub image: Image,
    /// 1 where the photo shows the plane, else 0.
    pub valid: Image,
    /// From unwarped pixels to photo pixels.
    pub to_photo: Homography,
    /// Size of an unwarped pixel divided by the distance between camera and plane: multiply by that distance to get
    /// metres.
    pub pixel_size: f64,
    /// Corners of the unwarped rectangle in photo pixels (possibly outside the photo): top left, then clockwise.
    pub corners: [DVec2; 4],
    /// Confidence in the aspect ratio, in `[0, 1]`; low where the focal length had to be assumed.
    pub aspect_confidence: f64,
    /// Expected error of each corner in unwarped pixels.
    pub corner_error: [f64; 4],
}
