//! Confidence intervals of pixels: they contain the true radiance of 95 % of the pixels.
//!
//! The variance among a pixel's own four replications is a poor estimate. It has three degrees of freedom, and it is
//! correlated with the mean: both are too small where no bright path has been found yet. In rooms, mean ± 1.96
//! standard errors contains the truth for 66 to 83 % of the pixels, and with Student's factor for 78 to 93 %. The
//! variances of neighbouring pixels are almost independent of the pixel's mean, because only pixels of the same block
//! share some paths (see `block`). The variances are therefore averaged over 7 × 7 pixels with binomial weights, as
//! variances of single paths, because neighbours may have other numbers of paths. From
//! 8 paths per pixel on, the resulting intervals contain the truth for 93 to 97 % of the pixels;
//! `benches/error_control.rs` measures this coverage.

use super::pooling::pooled_by_paths;
use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::job::Job;
use crate::render::output::Film;

/// Half-width, in standard deviations, of the interval that contains 95 % of a normal distribution. [convention]
pub const NORMAL_95: f64 = 1.959_964;

impl Film {
    /// Returns the half-width of the 95 % confidence interval of each pixel's radiance, per channel, in cd/m²;
    /// infinite for pixels with fewer than two paths. Measured in rooms, the intervals contain the truth for 93 % to
    /// 97 % of the pixels. The coverage is lower where light arrives by paths so rare that no pixel nearby has found
    /// one, such as caustics of small lamps.
    pub fn interval(&self, job: Job) -> Result<Image> {
        let mut out = pooled_by_paths(&self.variance, &self.paths, job)?;
        exec::for_rows(&mut out.data, out.width * out.channels, job, |_, row| {
            row.iter_mut().for_each(|v| *v = NORMAL_95 as f32 * v.sqrt());
        })?;
        Ok(out)
    }
}
