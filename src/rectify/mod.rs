//! Rectification ("Lighting Style Transfer", §5): finds the edges, lines and vanishing points of a photo, derives the
//! camera from them, and resamples a plane of the room to a fronto-parallel texture through a homography.
//!
//! ```text
//! photo ─▶ gradient ─▶ segments ───────▶ vanishing ─▶ camera ─▶ View ◀─ distortion ◀─ segments
//!             └─▶ canny ─▶ hough ─┘        ├ manhattan ─ sphere
//!                                          └ successive ─ metric
//! View + mask ─▶ plane ─▶ quad ─▶ unwarp ─▶ resample ─▶ Unwarped
//! View + masks of plane and lamps ─▶ shapes ─▶ View
//! ```
//!
//! [`Params::printed`] selects the paper's method as printed: gradient-restricted Hough lines and successive RANSAC
//! groups. The default differs where measurements favoured another choice:
//!
//! - It uses segments with end points instead of infinite lines.
//! - It searches for three orthogonal directions jointly with the unknown focal length, then refines each direction on
//!   the sphere with its own lines.
//! - It uses the focal length to give the unwarped plane its true aspect ratio, whereas the paper maps a rectangle of
//!   any aspect ratio onto the quadrilateral.
//!
//! Known weaknesses:
//!
//! - The reported standard deviations are right for most directions. Large errors, however, are more frequent than the
//!   standard deviations say. Where lines are few and noisy, the standard deviations are somewhat too small
//!   (docs/notes/vanishing-points.md).
//! - Lines found on a floor by chance can displace a direction that few lines support; the reported error of the
//!   direction does not show this.
//! - Short segments share a small bias, whose cause is unknown.
//!
//! Not modelled: lens distortion other than radial distortion with one coefficient; pixel aspect ratios other than 1;
//! planes that are not parallel to two of the room's axes, such as sloped ceilings, which are unwarped as if they were;
//! rooms whose walls are not at right angles. The axes of such rooms are made orthogonal, and
//! [`View::squareness`] reports their deviation from right angles.

mod axes;
mod biweight;
mod camera;
pub mod canny;
mod distortion;
mod edge_lines;
mod focal;
mod footprint;
mod gather;
pub mod gradient;
mod grid_map;
pub mod hough;
mod lanes;
mod manhattan;
pub mod metric;
mod off_plane;
mod params;
mod plane;
mod quad;
mod resample;
pub mod segments;
mod shapes;
mod sphere;
mod squareness;
mod successive;
mod taps;
#[cfg(test)]
mod tests;
mod unwarp;
pub mod vanishing;
mod warnings;

pub use distortion::Distortion;
pub use focal::FocalPrior;
pub use grid_map::GridMap;
pub use off_plane::off_plane;
pub use params::{LineDetector, Metric, Params, Search, UnwarpParams};
pub use resample::{undistort, warp, warp_grid, warp_photo};
pub use squareness::Squareness;
pub use unwarp::unwarp;
pub use vanishing::VanishingPoint;

use crate::error::{Error, ErrorKind, Result};
use crate::geometry::perspective::VERTICAL;
use crate::geometry::{Perspective, PhotoMap, Radial, Segment};
use crate::image::{Image, pyramid, try_collect};
use crate::job::Job;
use glam::{DMat3, DVec2, DVec3};

/// Longest side, in pixels, of the image in which lines are detected. Larger photos are first reduced to this size.
/// The precision lost is smaller than the deviation of real lenses and walls from straight lines.
const DETECTION_SIDE: usize = 1600;

/// The camera geometry that the lines of a photo imply.
#[derive(Clone, Debug)]
pub struct View {
    /// The segments in pixels of the photo, each with the index of the room axis along which it runs; `None` if it runs
    /// along no axis.
    pub segments: Vec<(Segment, Option<usize>)>,
    /// The vanishing point of each room axis, that is, of each column of `perspective.axes`, in pixels of the photo
    /// that an ideal lens would take.
    pub vanishing_points: [VanishingPoint; 3],
    pub perspective: Perspective,
    /// Standard deviation of the logarithm of the focal length; 0 if the caller gave the focal length.
    pub focal_spread: f64,
    /// For each axis, how far the angle between the two other axes deviates from a right angle, estimated from the
    /// lines of these two axes alone. `None` if one of the two has no lines.
    pub squareness: [Option<Squareness>; 3],
    /// Lens distortion, from the curvature of edges that should be straight; `None` if the photo has too few lines, or
    /// if only segments were given.
    pub distortion: Option<Distortion>,
    /// The distortion that was undone, as [`Distortion::corner`]; 0 if none was.
    pub undone: f64,
    /// The prior of the focal length: from the photo's metadata, or else the typical value for photos of rooms.
    pub expected_focal: FocalPrior,
    /// Number of lamps on a lattice that determine the view; 0 if no lattice does.
    pub lattice_lamps: usize,
}

impl View {
    /// Returns independent changes of the vertical direction in camera space, of one standard deviation each: the
    /// outer products of these vectors with themselves sum to the covariance of the direction.
    pub fn vertical_shifts(&self) -> [DVec3; 3] {
        // The columns of the Cholesky factor of the covariance, which has no more than rank 2.
        let mut rest = self.vanishing_points[VERTICAL].covariance;
        [0, 1, 2].map(|k| {
            let pivot = rest.col(k)[k];
            let column = if pivot > 0.0 { rest.col(k) / pivot.sqrt() } else { DVec3::ZERO };
            rest -= DMat3::from_cols(column * column.x, column * column.y, column * column.z);
            column
        })
    }

    /// Returns the standard deviation of the focal length in pixels; 0 if the caller gave the focal length.
    pub fn focal_error(&self) -> f64 {
        self.focal_spread * self.perspective.focal
    }
}

/// Finds lines, vanishing points and the camera of a linear RGB photo. Pixels that are not finite yield no lines.
///
/// A photo in which no two lines meet is an [`ErrorKind::Degenerate`](crate::error::ErrorKind) error.
pub fn find_view(photo: &Image, params: &Params, job: Job) -> Result<View> {
    params.check()?;
    let Lines { segments, distortion } = find_lines(photo, params, job.part(0.0, 0.7))?;
    let size = [photo.width, photo.height];
    let given = given_lens(size, params)?;
    let job = job.part(0.7, 1.0);
    let view = match distortion.filter(|d| params.distortion.is_none() && d.should_undo()) {
        None => view_through(&given, &segments, size, params, job)?,
        Some(found) => {
            let plain = view_through(&given, &segments, size, params, job.part(0.0, 0.5))?;
            straightened(&plain, &found, &segments, size, params, job.part(0.5, 1.0))?.unwrap_or(plain)
        }
    };
    Ok(View { distortion, ..view })
}

/// A measured distortion is undone only if the errors of the vanishing points fall below this share of their errors
/// without the correction. Edges that are curved themselves look like distortion, but no correction makes them meet
/// better in vanishing points. [bench vp:lenses]
const MAX_ERROR_SHARE: f64 = 0.95;

/// Returns the view after the measured distortion is undone; `None` if the lines meet hardly better than in the view
/// without the correction (`plain`), or if the map would fold over in a photo with a distant principal point.
fn straightened(
    plain: &View,
    found: &Distortion,
    segments: &[Segment],
    size: [usize; 2],
    params: &Params,
    job: Job,
) -> Result<Option<View>> {
    let Ok(lens) = given_lens(size, &Params { distortion: Some(found.corner), ..params.clone() }) else {
        return Ok(None);
    };
    let error = |view: &View| view.vanishing_points.iter().map(|v| v.error * v.error).sum::<f64>().sqrt();
    match view_through(&lens, segments, size, params, job) {
        Ok(view) => Ok(Some(view).filter(|view| error(view) < MAX_ERROR_SHARE * error(plain))),
        Err(e) if e.kind == ErrorKind::Degenerate => Ok(None),
        Err(e) => Err(e),
    }
}

/// Returns the lens with the distortion given in `params`; a lens without distortion if `params` gives none.
fn given_lens([width, height]: [usize; 2], params: &Params) -> Result<Radial> {
    let size = DVec2::new(width as f64, height as f64);
    params
        .distortion
        .map_or(Ok(Radial::NONE), |corner| Radial::new(corner, params.principal.unwrap_or(0.5 * size), size))
}

/// Finds the straight edges of a photo, in pixels of the photo.
pub fn find_segments(photo: &Image, params: &Params, job: Job) -> Result<Vec<Segment>> {
    find_lines(photo, params, job).map(|lines| lines.segments)
}

/// The straight edges of a photo, in pixels, and the lens distortion that their curvature implies.
struct Lines {
    segments: Vec<Segment>,
    distortion: Option<Distortion>,
}

fn find_lines(photo: &Image, params: &Params, job: Job) -> Result<Lines> {
    let size = DVec2::new(photo.width as f64, photo.height as f64);
    let centre = params.principal.unwrap_or(0.5 * size);
    let longest = photo.width.max(photo.height);
    if longest <= DETECTION_SIDE {
        return detect_lines(photo, centre, params, job);
    }
    let reduce = |side: usize| (side * DETECTION_SIDE).div_ceil(longest).max(1);
    let reduced = pyramid::resize(photo, reduce(photo.width), reduce(photo.height), job.part(0.0, 0.3))?;
    let scale = size / DVec2::new(reduced.width as f64, reduced.height as f64);
    let mut lines = detect_lines(&reduced, centre / scale, params, job.part(0.3, 1.0))?;
    for s in &mut lines.segments {
        (s.a, s.b) = (s.a * scale, s.b * scale);
    }
    Ok(lines)
}

fn detect_lines(photo: &Image, centre: DVec2, params: &Params, job: Job) -> Result<Lines> {
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

/// Like [`find_view`], but finds the vanishing points and the camera from segments that the caller has detected. The
/// `distortion` of the result is `None`; only a distortion given in `params` is undone.
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
    view_through(&given_lens([width, height], params)?, segments, [width, height], params, job)
}

/// Finds the vanishing points and the camera from segments of a photo that was taken through `lens`.
fn view_through(
    lens: &Radial,
    segments: &[Segment],
    [width, height]: [usize; 2],
    params: &Params,
    job: Job,
) -> Result<View> {
    let straight = try_collect(segments.iter().map(|s| Segment { a: lens.ideal(s.a), b: lens.ideal(s.b) }))?;
    let found = vanishing::from_segments(&straight, width, height, 3, params, job)?;
    let oriented = camera::orient(&found, width, height, params);
    let axis = |member: &Option<usize>| member.and_then(|k| oriented.axis_of[k]);
    Ok(View {
        segments: segments.iter().copied().zip(found.members.iter().map(axis)).collect(),
        vanishing_points: oriented.vanishing_points,
        perspective: Perspective { bend: lens.bend, ..oriented.perspective },
        focal_spread: oriented.focal_spread,
        squareness: oriented.squareness,
        distortion: None,
        undone: lens.bend * 0.25 * DVec2::new(width as f64, height as f64).length_squared(),
        expected_focal: oriented.expected,
        lattice_lamps: 0,
    })
}

/// A plane of the photo, resampled to fronto-parallel view. The x and y axes of the texture run nearly right and down
/// in the photo.
#[derive(Clone, Debug)]
pub struct Unwarped {
    /// Linear RGB.
    pub image: Image,
    /// One channel: 1 where the mask marks the plane and the photo is finite, else 0.
    pub valid: Image,
    /// Maps unwarped pixels to photo pixels.
    pub to_photo: PhotoMap,
    /// Size of an unwarped pixel divided by the distance between camera and plane: multiply by that distance to get
    /// metres.
    pub pixel_size: f64,
    /// Corners of the unwarped rectangle in photo pixels (possibly outside the photo): top left, then clockwise.
    pub corners: [DVec2; 4],
    /// Confidence in the aspect ratio, in `[0, 1]`; low if the focal length had to be assumed.
    pub aspect_confidence: f64,
    /// Expected error of each corner, as a root mean square in unwarped pixels.
    pub corner_error: [f64; 4],
}
