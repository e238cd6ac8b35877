//! Depth map
//!
//! A depth map of a photo is an image of the photo's size with 1 channel, in any unit of length. Pixels whose value is
//! not positive and finite are holes, which are filled from their surroundings. luxfer_transfer_set_depth and
//! luxfer_features_set_depth take a depth map.

use crate::error::{Error, Result};
use crate::features::DepthKind;

/// Quantity that a depth map measures: a LUXFER_DEPTH_ value.
pub type luxfer_depth_kind = i32;
/// Distance from the camera along the viewing axis (depth z).
pub const LUXFER_DEPTH_ALONG_Z: luxfer_depth_kind = 0;
/// Distance from the camera along the ray of each pixel.
pub const LUXFER_DEPTH_ALONG_RAY: luxfer_depth_kind = 1;

pub(super) fn depth_kind(value: luxfer_depth_kind) -> Result<DepthKind> {
    match value {
        LUXFER_DEPTH_ALONG_Z => Ok(DepthKind::AlongZ),
        LUXFER_DEPTH_ALONG_RAY => Ok(DepthKind::AlongRay),
        other => Err(Error::argument(format!("depth kind is {other}; it must be a LUXFER_DEPTH_ value"))),
    }
}
