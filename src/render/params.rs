//! The parameters of a render, with their ranges and defaults.

use super::layers::Outputs;
use crate::error::{Error, Result, check_range};
use crate::image::MAX_SIDE;
use crate::scene::Camera;

/// What to render, and when to stop.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Width and height of the image in pixels, each in `[1, 65536]`.
    pub width: usize,
    pub height: usize,
    /// Paths per pixel, in `[1, 1 << 20]`. Without an error target, every pixel gets this number of paths. With an
    /// error target, the mean over the image is at most this number.
    pub samples: u32,
    /// Stop when [`super::Film::error`] falls to this value; paths are allocated to minimise that error. 0 = never.
    pub target_error: f32,
    /// Stop when the error of each tile of 8 × 8 pixels falls to this value; 0 = never. For example, 0.1 means "within
    /// 10 % of the value, 19 times out of 20".
    ///
    /// - The error of a pixel is h / max(L, m / 10). L is the luminance of the pixel, and h is the half-width of the
    ///   95 % confidence interval of L. m is the mean radiance of the image over all pixels and channels.
    /// - The error of a tile is the root mean square of the errors of its pixels.
    /// - A tile gets at most 64 times `samples` paths per pixel, even if it then misses the target.
    ///
    /// If several targets are set, all of them must be met.
    pub pixel_error: f32,
    /// Stop when [`super::Film::relative_error`] falls to this value; paths are allocated to minimise that error. 0 =
    /// never.
    pub relative_error: f32,
    /// Stop after this many milliseconds; 0 = never.
    pub time_budget_ms: u32,
    /// Strength of the filter (`denoise`) that computes [`super::Film::preview`], in `[0, 10]`, usually 1. 0 = no
    /// preview, as for final images.
    pub preview: f32,
    pub seed: u64,
    /// Images to render in addition to the main image.
    pub outputs: Outputs,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            width: 1280,
            height: 720,
            samples: 64,
            target_error: 0.0,
            pixel_error: 0.0,
            relative_error: 0.0,
            time_budget_ms: 0,
            preview: 0.0,
            seed: 1,
            outputs: Outputs::default(),
        }
    }
}

impl Params {
    /// Returns an error if a setting is out of its range.
    pub fn check(&self) -> Result<()> {
        check_range("width", self.width, 1, MAX_SIDE)?;
        check_range("height", self.height, 1, MAX_SIDE)?;
        check_range("samples", self.samples, 1, 1 << 20)?;
        check_range("target_error", self.target_error, 0.0, f32::MAX)?;
        check_range("pixel_error", self.pixel_error, 0.0, f32::MAX)?;
        check_range("relative_error", self.relative_error, 0.0, f32::MAX)?;
        check_range("preview", self.preview, 0.0, 10.0)?;
        Ok(())
    }
}

/// Returns an error if a camera is degenerate, so that it has no view.
pub fn check_camera(camera: &Camera) -> Result<()> {
    let vectors = [camera.position, camera.forward, camera.up];
    let has_view = camera.forward.cross(camera.up).length_squared() > 0.0;
    if vectors.iter().any(|v| !v.is_finite())
        || !has_view
        || !(camera.fov_y > 0.0 && camera.fov_y < std::f32::consts::PI)
    {
        return Err(Error::argument(format!(
            "camera {:?} cannot see: its position must be finite, forward and up must not be parallel, and fov_y (now {}) \
             must lie in (0, pi)",
            camera.name, camera.fov_y
        )));
    }
    Ok(())
}
