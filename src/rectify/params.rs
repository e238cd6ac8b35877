//! The settings of rectification.

use crate::error::{Result, check_range};
use crate::geometry::radial;
use glam::DVec2;

/// How lines are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineDetector {
    /// Segments with sub-pixel end points, fitted to regions of similar gradient direction (LSD).
    Regions,
    /// The paper's gradient-restricted Hough transform of Canny edges. With [`Metric::Segment`], each line is cut into
    /// the pieces that edge pixels cover; with [`Metric::VisibleLine`], it is kept in its whole visible length.
    Hough,
}

/// How vanishing points are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// Three orthogonal directions, found jointly with the focal length. Each direction is then refined with its own
    /// lines; right angles are only a prior of this refinement.
    Manhattan,
    /// The paper's search: RANSAC finds one group of converging lines after another.
    Successive,
}

/// Distance between a vanishing point and a line in [`Search::Successive`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// The distance of the detected segment's end points from the line through its midpoint and the vanishing point.
    /// This distance is finite even if the vanishing point is at infinity.
    Segment,
    /// The paper's metric as printed (Eq. 2): `min(d_naive, d_vanishing)` of the whole visible line.
    VisibleLine,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    pub detector: LineDetector,
    pub search: Search,
    pub metric: Metric,
    /// Half-width, in radians, of the range of angles for which an edge pixel votes in the Hough transform, centred on
    /// its gradient direction; in `(0, pi / 2]`, default 2.5°. [paper §5.1]
    pub hough_band: f64,
    /// Focal length in pixels, if known; > 0.
    pub focal: Option<f64>,
    /// Focal length from the photo's metadata, and its standard deviation; both in pixels and > 0. If `focal` is
    /// absent, this value is used as one more observation beside the lines. If this value is absent too, the prior of
    /// the focal length is 0.85 of the image width, with a wide spread.
    pub expected_focal: Option<[f64; 2]>,
    /// Principal point in pixels: the point where the optical axis meets the image plane; the image centre if absent.
    /// In cropped photos and photos taken with a shifted lens, the principal point lies elsewhere, possibly outside
    /// the image.
    pub principal: Option<DVec2>,
    /// Radial distortion of the lens that is undone, as [`Distortion::corner`](super::Distortion::corner), in
    /// `[-1, 0.2]`; 0 undoes none. If absent, the distortion is measured, and undone if it is
    /// [worth undoing](super::Distortion::should_undo) and the lines then meet better in vanishing points.
    pub distortion: Option<f64>,
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
            distortion: None,
            seed: 1,
        }
    }
}

impl Params {
    /// Returns the settings of the paper's method as printed ("Lighting Style Transfer", §5).
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
        if let Some(distortion) = self.distortion {
            check_range("distortion", distortion, radial::MIN_CORNER, radial::MAX_CORNER)?;
        }
        Ok(())
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct UnwarpParams {
    /// The two room axes that span the plane; if `None`, the mask and the lines inside it decide.
    pub axes: Option<[usize; 2]>,
    /// Maximum length of the longer side of the unwarped image in pixels, in `[16, 16384]`. The image is smaller if
    /// the photo resolves the plane less.
    pub max_side: usize,
    /// Maximum magnification, > 0: the side of the square that a photo pixel covers on the plane, divided by this side
    /// in the best-resolved part of the plane. Parts of the plane with a greater magnification are cut off.
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
