//! Rectification: edges to lines to vanishing points to a homography to an unwarped texture ("Lighting Style Transfer", §5).
//!
//! ```text
//! photo ─▶ gradient ─▶ segments ───────▶ vanishing ─▶ camera ─▶ View ◀─ distortion ◀─ segments
//!             └─▶ canny ─▶ hough ─┘        ├ manhattan ─ sphere
//!                                          └ successive ─ metric
//! View + mask ─▶ plane ─▶ quad ─▶ unwarp ─▶ resample ─▶ Unwarped
//! ```
//!
//! The paper's method, gradient-restricted Hough lines and successive RANSAC groups, is there as printed
//! ([`Params::printed`]). The default differs where measurements asked for it: segments with end points instead of
//! infinite lines, three orthogonal directions sought at once with an unknown focal length, then each refined freely on
//! the sphere. The paper maps a rectangle of any shape onto the quadrilateral; here the focal length gives the plane its
//! true aspect ratio.
//!
//! Known weaknesses. Stated errors presume five segments per independent observation and a floor of 0.2°, calibrated on
//! re-projected panoramas: half of their true errors lie below 0.73 of the stated ones, as they should, but one in fourteen
//! beyond 2. A direction that few lines show can be lost to chance lines of a floor, and its stated error does not say
//! so. Short segments share a bias of about 0.01 rad on re-projected photos, whose cause is not known. Where lines are
//! few, and noisy for their length, those of directions are up to an eighth too small (the mean square of true over stated
//! ones is 1.3 with 14 lines an axis and a pixel of noise, 1.0 to 1.15 with more lines or less noise).
//!
//! Not modelled: lens distortion, which is measured however ([`View::distortion`]); pixels that are not square and rooms whose
//! walls are not at right angles, whose axes are made orthogonal; how far they are from it is measured ([`View::squareness`]).

mod biweight;
mod camera;
pub mod canny;
mod distortion;
mod footprint;
mod four;
mod gather;
pub mod gradient;
pub mod hough;
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

/// Longest side of the picture in which lines are sought: larger photos are reduced, which costs no precision that
/// lenses and walls have.
const DETECTION_SIDE: usize = 1600;

/// How lines are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineDetector {
    /// Regions of like gradient direction, with sub-pixel end points.
    Regions,
    /// The paper's gradient-restricted Hough transform of Canny edges, its lines trimmed to their edges.
    Hough,
}

/// How vanishing points are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// Three orthogonal directions and the focal length at once, then each refined freely.
    Manhattan,
    /// The paper's: one group of lines after the other.
    Successive,
}

/// How far a vanishing point is from a line, in [`Search::Successive`].
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
    /// Half-width in radians of the band around the gradient direction that votes in the Hough transform, in
    /// `(0, pi / 2]` (paper: 2.5°).
    pub hough_band: f64,
    /// Focal length in pixels, if known; > 0.
    pub focal: Option<f64>,
    /// Focal length in pixels that is expected where `focal` is absent, as the photo's file says, and its standard deviation; > 0. It
    /// is one more observation beside the lines. Without it 0.85 of the width is expected, and believed little.
    pub expected_focal: Option<[f64; 2]>,
    /// Principal point in pixels, where the lens's axis meets the picture, which is the lens's centre as the photo has it;
    /// the image centre if absent. Cropped photos and those of shifted lenses have it elsewhere, some outside.
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
    /// Homogeneous pixels, unit length; third coordinate 0 = at infinity.
    pub point: DVec3,
    /// Number of segments that agree with it; 0 = derived from the other two.
    pub support: usize,
    /// Standard deviation of its direction in camera space, in radians.
    pub error: f64,
    /// Covariance of that direction, in radians squared, whose trace is the square of `error`: lines that meet far away
    /// fix it across them better than along.
    pub covariance: DMat3,
}

/// What the lines of a photo say about its camera.
#[derive(Clone, Debug)]
pub struct View {
    /// Segments with the index of the room axis each runs along, if any.
    pub segments: Vec<(Segment, Option<usize>)>,
    /// One for each column of `perspective.axes`.
    pub vanishing_points: [VanishingPoint; 3],
    pub perspective: Perspective,
    /// For each axis how far the angle between the two others is from a right one, by the lines of these two alone; absent where
    /// one of them has no lines.
    pub squareness: [Option<Squareness>; 3],
    /// How far the lens bends straight lines; absent where a photo has too few of them, or was not seen itself.
    pub distortion: Option<Distortion>,
    /// The focal length that was expected before the lines were looked at.
    pub expected_focal: Expected,
}

/// Finds lines, vanishing points and the camera of a linear RGB photo. Pixels that are not finite make no lines.
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

/// The straight edges of a photo, in its pixels, and how straight they are.
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

/// The same as [`find_view`] from segments found by other means.
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
    /// The room axes the plane spans; found from the lines in it if absent.
    pub axes: Option<[usize; 2]>,
    /// Longest side of the unwarped image in pixels, in `[16, 16384]`; the photo's own density decides below it.
    pub max_side: usize,
    /// Largest magnification of the photo, > 0: what is further away is cut off.
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

/// A plane of the photo as seen from straight in front of it, turned so that right and down are nearly the photo's.
#[derive(Clone, Debug)]
pub struct Unwarped {
    /// Linear RGB.
    pub image: Image,
    /// 1 where the photo shows the plane, else 0.
    pub valid: Image,
    /// From unwarped pixels to photo pixels.
    pub to_photo: Homography,
    /// Size of an unwarped pixel as a share of the camera's distance from the plane: times that distance, metres.
    pub pixel_size: f64,
    /// Corners of the unwarped rectangle in the photo, which may lie outside it: top left, then clockwise.
    pub corners: [DVec2; 4],
    /// Trust in the aspect ratio, in `[0, 1]`: low where the focal length had to be assumed.
    pub aspect_confidence: f64,
    /// Expected error of each corner in unwarped pixels.
    pub corner_error: [f64; 4],
}
