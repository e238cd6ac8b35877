//! The limit of the filter's changes. A pixel has two values, one from each half of its paths. The filter changes
//! neither value by more than two standard errors of the value.
//!
//! The choice between the passes rests on errors that are averaged over a neighbourhood. On average, the chosen pass is
//! better than the unfiltered picture, but a single pixel can differ from the pixels around. For example, the outline
//! of a lamp is a row of pixels that are alike, so it does not count as an edge. A pass that suits the wall beside the
//! lamp then blurs the outline. The limit bounds this harm: the filtered value cannot contradict the paths of the pixel
//! itself (a limited translation estimator, after Efron and Morris 1972, "Limiting the risk of Bayes and empirical
//! Bayes estimators").

use super::input::Input;
use super::planes::Planes;
use crate::error::Result;
use crate::job::Job;

/// Largest change of a half, in standard errors. [bench filter]
const LIMIT: f32 = 2.0;
/// Radius in pixels of the neighbourhood over which variances are averaged. The limit follows from this average or from
/// the pixel's own variance, whichever is larger. A pixel that has missed the light of its neighbours has too small a
/// variance of its own. [bench filter]
const RADIUS: usize = 1;

/// Returns, for each pixel, the largest change that the filter may make to the value of a half of the paths: per
/// channel, in units of the picture, infinite where a variance is unknown. The limit is the same for both halves.
pub fn limits(input: &Input, job: Job) -> Result<Planes> {
    let [one, other] = input.halves;
    let own = Planes::from_rows([one.width, one.height, 3], job.part(0.0, 0.3), |y, row| {
        for (c, plane) in row.chunks_exact_mut(one.width).enumerate() {
            for (x, out) in plane.iter_mut().enumerate() {
                let [v, w] = input.variances.map(|variance| variance.pixel(x, y)[c]);
                *out = variance_of_half(one.pixel(x, y)[c] - other.pixel(x, y)[c], v, w);
            }
        }
    })?;
    let mut limits = own.smoothed(RADIUS, job.part(0.3, 1.0))?;
    limits.data.iter_mut().zip(&own.data).for_each(|(limit, own)| *limit = LIMIT * limit.max(*own).sqrt());
    Ok(limits)
}

/// Estimates the variance of a half from the difference between the halves and the halves' own variance estimates `v`
/// and `w`. Each half is the mean of two replications, whose spread gives `v` or `w` (`film::pixel`). The squared
/// deviations of all four replications from their common mean add up to `2 v + 2 w + difference²`. They have three
/// degrees of freedom, so a third of the sum is the variance of a replication. The variance of a half is half of that.
fn variance_of_half(difference: f32, v: f32, w: f32) -> f32 {
    (2.0 * v + 2.0 * w + difference * difference) / 6.0
}
