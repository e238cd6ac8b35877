//! 95 % confidence intervals for the radiance of each pixel.
//!
//! The variance among a pixel's own four replications (point sequences) is a poor estimate for two reasons. It has only
//! three degrees of freedom. And it is correlated with the mean: where no bright path has been found yet, the variance
//! and the mean are both too small. Intervals from this estimate contain the truth for far fewer than 95 % of the
//! pixels.
//!
//! The variances are therefore averaged over 7 × 7 pixels with binomial weights. The variances of the neighbours are
//! almost independent of the pixel's mean, because only pixels of the same block share some paths (see `block`). Since
//! neighbours may have other numbers of paths, the variance of a single path is averaged.
//!
//! `benches/error_control.rs` measures the share of the pixels whose interval contains the truth (results in
//! docs/notes/intervals.md).

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
    /// infinite for pixels with fewer than two paths. An interval contains the truth less often where light arrives by
    /// paths so rare that no pixel nearby has found one, such as caustics of small lamps.
    pub fn interval(&self, job: Job) -> Result<Image> {
        let mut out = pooled_by_paths(&self.variance, &self.paths, job)?;
        exec::for_rows(&mut out.data, out.width * out.channels, job, |_, row| {
            row.iter_mut().for_each(|v| *v = NORMAL_95 as f32 * v.sqrt());
        })?;
        Ok(out)
    }
}
