//! The prior of the focal length.

use super::params::Params;
use crate::geometry::FocalSource;
use crate::maths;

/// Prior of the focal length over photos of rooms. `USUAL_FOCAL_PER_WIDTH`: median of the focal length as a share of
/// the image width; in portrait photos the width is the shorter side. `USUAL_SPREAD`: standard deviation of the
/// logarithm of the focal length. \[bench vp:panoramas\]
pub const USUAL_FOCAL_PER_WIDTH: f64 = 0.85;
pub const USUAL_SPREAD: f64 = 0.35;

/// The prior of a focal length, in pixels, and the standard deviation of its logarithm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FocalPrior {
    pub focal: f64,
    pub spread: f64,
    pub(super) source: FocalSource,
}

impl FocalPrior {
    /// Returns the prior from the photo's metadata or, without metadata, the usual focal length for this width.
    pub(super) fn new(params: &Params, width: usize) -> Self {
        match params.expected_focal {
            Some([focal, error]) => Self { focal, spread: error / focal, source: FocalSource::Metadata },
            None => {
                Self { focal: USUAL_FOCAL_PER_WIDTH * width as f64, spread: USUAL_SPREAD, source: FocalSource::Assumed }
            }
        }
    }

    /// Returns the prior with the logarithm of its focal length increased by the given number of standard deviations.
    pub fn moved(self, deviations: f64) -> Self {
        Self { focal: self.focal * maths::exp(self.spread * deviations), ..self }
    }
}
