//! Rectification: edges to lines to vanishing points to a homography to an unwarped texture (Lipp et al., §5).

use crate::error::Result;
use crate::geometry::{Homography, Perspective, Segment};
use crate::image::Image;
use crate::job::Job;
use glam::{DVec2, DVec3};

/// How far a vanishing point is from a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// The paper's measure on the detected segment, in homogeneous form: finite at infinity.
    Segment,
    /// As printed: `min(d_naive, d_vanishing)` on the whole visible line (Eq. 2).
    VisibleLine,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    pub metric: Metric,
    /// Half-width in radians of the band around the gradient direction that votes (paper: 2.5°).
    pub hough_band: f64,
    /// Focal length in pixels, if known.
    pub focal: Option<f64>,
    /// Principal point in pixels; the image centre if absent.
    pub principal: Option<DVec2>,
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self { metric: Metric::Segment, hough_band: 2.5f64.to_radians(), focal: None, principal: None, seed: 1 }
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
}

/// What the lines of a photo say about its camera.
#[derive(Clone, Debug)]
pub struct View {
    /// Segments with the index of the room axis each runs along, if any.
    pub segments: Vec<(Segment, Option<usize>)>,
    /// One for each column of `perspective.axes`.
    pub vanishing_points: [VanishingPoint; 3],
    pub perspective: Perspective,
}

/// Finds lines, vanishing points and the camera of a linear RGB photo.
pub fn find_view(_photo: &Image, _params: &Params, _job: Job) -> Result<View> {
    todo!()
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
        Self { axes: None, max_side: 2048, max_magnification: 6.0 }
    }
}

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
    /// Corners of the unwarped rectangle in the photo.
    pub corners: [DVec2; 4],
    /// Trust in the aspect ratio, in `[0, 1]`: low where the focal length had to be assumed.
    pub aspect_confidence: f64,
    /// Expected error of each corner in unwarped pixels.
    pub corner_error: [f64; 4],
}

/// Unwarps the plane that `mask` marks in the photo.
pub fn unwarp(_photo: &Image, _view: &View, _mask: &Image, _params: &UnwarpParams, _job: Job) -> Result<Unwarped> {
    todo!()
}

/// Resamples any image of the photo's size the way [`unwarp`] did; outside the photo the result is 0.
pub fn warp(_source: &Image, _to_source: &Homography, _width: usize, _height: usize, _job: Job) -> Result<Image> {
    todo!()
}
