//! Solves for the scales of several emitters at once, each with a target of its own.
//!
//! In each channel, the light of target `i` is `bᵢ + Σⱼ rᵢⱼ xⱼ`, where `bᵢ` is all other light, `xⱼ` the scale of
//! emitter `j`, and `rᵢⱼ` the response of target `i` to emitter `j`. The scales minimise the sum over the targets of
//! the squared difference from the target light, with all scales ≥ 0. If the targets can be met, this solution meets
//! all of them. An emitter whose target the other light exceeds gets the scale 0; then its target is left out, so that
//! the other targets are still met. With one emitter, the scale is the closed form of [`super::run`].
//!
//! Two kinds of scales follow from the other channels instead, so that the lamps keep their colour:
//!
//! - The scale of a channel in which no light reaches the target, or no light of the emitter reaches any target.
//! - The scale of a channel whose target is only a limit, if the limit is then satisfied.
//!
//! These scales are set to the mean scale of the emitter's channels with exact targets; then the remaining ones are
//! solved for again.

use super::bounded::{BoundedLeastSquares, dot};
use super::estimate::{BATCHES, STUDENT_T, mean, pseudo_values, standard_error};
use super::groups::GroupParams;
use super::params::EmitterTarget;
use super::sided::Constraint;
use super::solution::{Solution, TargetStatus};
use super::solve::colour_interval;
use super::transport::Means;
use crate::error::{Error, ErrorKind, Result};
use glam::DVec3;

/// Weight of the regularisation towards equal scales, relative to the mean squared norm of the rows. It only decides
/// where the targets leave the scales open: at 1e-9, it changes a scale by less than 1e-6 of itself unless two emitters
/// light all targets alike within 3 %. [convention]
const REGULARISATION: f64 = 1e-9;

/// Responses and backgrounds of all targets: means over batches.
struct MeanLight {
    /// For each target, the response to each emitter.
    responses: Vec<Vec<DVec3>>,
    background: Vec<DVec3>,
}

/// The scales that are fixed in advance: one per emitter and channel.
type Fixed = Vec<[Option<f64>; 3]>;

/// The targets, and their light in each batch.
pub(super) struct Coupled<'a> {
    pub planes: &'a [EmitterTarget<'a>],
    /// For each target, the means over the paths of each batch. The bins are the emitters.
    pub measured: &'a [Vec<Means>],
    /// Number of paths traced per target.
    pub paths: u32,
}

impl Coupled<'_> {
    /// Returns the solution of each emitter.
    ///
    /// # Errors
    /// `Unreachable` if no channel of any target can be met.
    pub fn solve(&self) -> Result<Vec<Solution>> {
        let whole = self.means(None);
        let dark = self.dark(&whole);
        let (scales, fixed, is_neutral) = self.settle(&whole, &dark)?;
        let mut rest = Vec::with_capacity(BATCHES);
        for batch in 0..BATCHES {
            rest.push(self.scales_without(batch, &dark, &fixed, &is_neutral)?);
        }
        let solutions: Vec<Solution> =
            (0..self.planes.len()).map(|i| self.solution(i, &whole, &scales, &rest, &dark)).collect();
        if solutions.iter().flat_map(|s| s.status).all(|status| status != TargetStatus::Met) {
            let all_dark = dark.iter().flatten().all(|is_dark| *is_dark);
            let reason = if all_dark {
                "no light of the emission finds its way back to the target surfaces; choose other target surfaces"
            } else {
                "the other lights of the scene alone are brighter than the targets: dim or remove them, or raise the \
                 targets"
            };
            return Err(Error::new(ErrorKind::Unreachable, reason));
        }
        Ok(solutions)
    }

    /// Returns the means over all batches, or over all batches but one.
    fn means(&self, left_out: Option<usize>) -> MeanLight {
        let count = (BATCHES - usize::from(left_out.is_some())) as f64;
        let over = |value: &dyn Fn(usize) -> DVec3| {
            (0..BATCHES).filter(|b| Some(*b) != left_out).map(value).sum::<DVec3>() / count
        };
        let emitters = 0..self.planes.len();
        let row = |batches: &Vec<Means>| emitters.clone().map(|j| over(&|b| batches[b].bins[j])).collect();
        MeanLight {
            responses: self.measured.iter().map(row).collect(),
            background: self.measured.iter().map(|batches| over(&|b| batches[b].others)).collect(),
        }
    }

    /// Returns for each plane and channel whether the scale cannot be measured: the light of all emitters at the
    /// target, or the light of the emitter at all targets, does not exceed three of its standard errors.
    fn dark(&self, whole: &MeanLight) -> Vec<[bool; 3]> {
        let planes = 0..self.planes.len();
        let is_dark = |mean: f64, batches: [f64; BATCHES]| !(mean > 3.0 * standard_error(&batches));
        let at_target = |i: usize, c: usize| {
            let light = |b: usize| self.measured[i][b].bins.iter().map(|r| r[c]).sum();
            is_dark(whole.responses[i].iter().map(|r| r[c]).sum(), std::array::from_fn(light))
        };
        let of_emitter = |j: usize, c: usize| {
            let light = |b: usize| self.measured.iter().map(|batches| batches[b].bins[j][c]).sum();
            is_dark(whole.responses.iter().map(|row| row[j][c]).sum(), std::array::from_fn(light))
        };
        planes.map(|i| [0, 1, 2].map(|c| at_target(i, c) || of_emitter(i, c))).collect()
    }

    /// Solves twice: first with the dark channels off and all targets exact, then with the scales that follow from the
    /// other channels. Returns the scales, the scales that were fixed, and for each plane and channel whether the fixed
    /// scale is the mean of the other channels.
    fn settle(&self, whole: &MeanLight, dark: &[[bool; 3]]) -> Result<(Vec<DVec3>, Fixed, Vec<[bool; 3]>)> {
        let fixed: Fixed = dark.iter().map(|dark| dark.map(|is_dark| is_dark.then_some(0.0))).collect();
        let first = self.scales(whole, &fixed)?;
        let neutral: Vec<Option<f64>> = (0..self.planes.len()).map(|i| self.neutral(i, whole, &first, dark)).collect();
        let is_neutral: Vec<[bool; 3]> = (0..self.planes.len())
            .map(|i| {
                [0, 1, 2].map(|c| {
                    let limit = self.planes[i].constraint[c];
                    let keeps = |neutral: f64| limit.miss(neutral - first[i][c]) == 0.0;
                    neutral[i].is_some_and(|n| dark[i][c] || limit != Constraint::Exactly && keeps(n))
                })
            })
            .collect();
        if is_neutral.iter().flatten().all(|is_neutral| !is_neutral) {
            return Ok((first, fixed, is_neutral));
        }
        let fixed = self.fixed(&first, &fixed, &is_neutral, &neutral);
        Ok((self.scales(whole, &fixed)?, fixed, is_neutral))
    }

    /// Returns the scales without one batch, with the same channels fixed as for all batches.
    fn scales_without(
        &self,
        batch: usize,
        dark: &[[bool; 3]],
        fixed: &Fixed,
        is_neutral: &[[bool; 3]],
    ) -> Result<Vec<DVec3>> {
        let means = self.means(Some(batch));
        if is_neutral.iter().flatten().all(|is_neutral| !is_neutral) {
            return self.scales(&means, fixed);
        }
        let off: Fixed = dark.iter().map(|dark| dark.map(|is_dark| is_dark.then_some(0.0))).collect();
        let first = self.scales(&means, &off)?;
        let neutral: Vec<Option<f64>> = (0..self.planes.len()).map(|i| self.neutral(i, &means, &first, dark)).collect();
        self.scales(&means, &self.fixed(&first, &off, is_neutral, &neutral))
    }

    fn fixed(&self, first: &[DVec3], off: &Fixed, is_neutral: &[[bool; 3]], neutral: &[Option<f64>]) -> Fixed {
        let at =
            |i: usize, c: usize| if is_neutral[i][c] { Some(neutral[i].unwrap_or(first[i][c])) } else { off[i][c] };
        (0..self.planes.len()).map(|i| [0, 1, 2].map(|c| at(i, c))).collect()
    }

    /// Returns the mean scale of the channels of a plane whose exact targets are met; `None` without such a channel.
    fn neutral(&self, i: usize, means: &MeanLight, scales: &[DVec3], dark: &[[bool; 3]]) -> Option<f64> {
        let is_exact = |c: &usize| !dark[i][*c] && self.planes[i].constraint[*c] == Constraint::Exactly;
        let is_met = |c: &usize| self.status(i, *c, means, scales) == TargetStatus::Met;
        let met: Vec<f64> = (0..3).filter(is_exact).filter(is_met).map(|c| scales[i][c]).collect();
        (!met.is_empty()).then(|| met.iter().sum::<f64>() / met.len() as f64)
    }

    /// Solves for the scales that are not fixed.
    fn scales(&self, means: &MeanLight, fixed: &Fixed) -> Result<Vec<DVec3>> {
        let mut scales = vec![DVec3::ZERO; self.planes.len()];
        for c in 0..3 {
            for (j, scale) in self.channel(means, fixed, c)?.into_iter().enumerate() {
                scales[j][c] = scale;
            }
        }
        Ok(scales)
    }

    /// Solves one channel for the scales that are free. Only the targets of their emitters count.
    fn channel(&self, means: &MeanLight, fixed: &Fixed, c: usize) -> Result<Vec<f64>> {
        let free: Vec<usize> = (0..self.planes.len()).filter(|&j| fixed[j][c].is_none()).collect();
        let mut scales: Vec<f64> = fixed.iter().map(|fixed| fixed[c].unwrap_or(0.0)).collect();
        let missing = |&i: &usize| {
            let light: f64 = means.responses[i].iter().zip(&scales).map(|(r, x)| r[c] * x).sum();
            f64::from(self.planes[i].target[c]) - means.background[i][c] - light
        };
        let missing: Vec<f64> = free.iter().map(missing).collect();
        let row = |&i: &usize| free.iter().map(|&j| means.responses[i][j][c]).collect();
        let rows: Vec<Vec<f64>> = free.iter().map(row).collect();
        let solved = meet(&rows, &missing)?;
        free.iter().zip(solved).for_each(|(&j, scale)| scales[j] = scale);
        Ok(scales)
    }

    /// Returns whether the scales meet a target in one channel, within the tolerance of [`GroupParams`] and the
    /// confidence interval of the light.
    fn status(&self, i: usize, c: usize, means: &MeanLight, scales: &[DVec3]) -> TargetStatus {
        let light = |responses: &[DVec3], background: DVec3| -> f64 {
            background[c] + responses.iter().zip(scales).map(|(r, x)| r[c] * x[c]).sum::<f64>()
        };
        let target = self.planes[i].target;
        let batches = std::array::from_fn(|b| light(&self.measured[i][b].bins, self.measured[i][b].others));
        let over = light(&means.responses[i], means.background[i]) - f64::from(target[c]);
        let miss = self.planes[i].constraint[c].miss(over);
        let tolerance = GroupParams::default().tolerance * f64::from(target.max_element());
        match () {
            () if miss.abs() <= tolerance + STUDENT_T * standard_error(&batches) => TargetStatus::Met,
            () if miss > 0.0 => TargetStatus::TooBright,
            () => TargetStatus::TooDim,
        }
    }

    /// Assembles the solution of one emitter. Its background includes the light of the other emitters at their scales.
    fn solution(
        &self,
        i: usize,
        whole: &MeanLight,
        scales: &[DVec3],
        rest: &[Vec<DVec3>],
        dark: &[[bool; 3]],
    ) -> Solution {
        let pseudo = |j: usize, c: usize| pseudo_values(scales[j][c], &std::array::from_fn(|b| rest[b][j][c]));
        let deviations: Vec<[[f64; BATCHES]; 3]> = (0..self.planes.len())
            .map(|j| {
                [0, 1, 2].map(|c| {
                    let values = pseudo(j, c);
                    let centre = mean(&values);
                    values.map(|v| v - centre)
                })
            })
            .collect();
        let row = &whole.responses[i];
        let others = (0..row.len()).filter(|&j| j != i).map(|j| row[j] * scales[j]).sum::<DVec3>();
        let background = whole.background[i] + others;
        let status = [0, 1, 2].map(|c| if dark[i][c] { TargetStatus::Dark } else { self.status(i, c, whole, scales) });
        let deviation = |b: usize| {
            let of_emitter = |j: usize| row[j] * DVec3::from(deviations[j].map(|channel| channel[b]));
            (0..row.len()).map(of_emitter).sum::<DVec3>()
        };
        Solution {
            scale: scales[i],
            half_width: DVec3::from(deviations[i].map(|channel| STUDENT_T * standard_error(&channel))),
            status,
            constraint: self.planes[i].constraint,
            response: row[i],
            background,
            delta_e: colour_interval(background + row[i] * scales[i], deviation),
            paths: self.paths,
        }
    }
}

/// Returns the scales ≥ 0 with which the emitters meet the targets. `rows[i][j]` is the response of target `i` to
/// emitter `j`, and `missing[i]` the light that target `i` lacks. If not all targets can be met, the emitters whose
/// scale is 0 stay off, the target that is exceeded most is left out, and the others are solved for again.
fn meet(rows: &[Vec<f64>], missing: &[f64]) -> Result<Vec<f64>> {
    let mut emitters: Vec<usize> = (0..rows.len()).collect();
    let mut targets = emitters.clone();
    let mut scales = vec![0.0; rows.len()];
    loop {
        let row = |i: usize| emitters.iter().map(move |&j| rows[i][j]);
        let matrix: Vec<f64> = targets.iter().flat_map(|&i| row(i)).collect();
        let right: Vec<f64> = targets.iter().map(|&i| missing[i]).collect();
        let solved = least_squares(&matrix, &right, emitters.len())?;
        emitters.iter().zip(&solved).for_each(|(&j, scale)| scales[j] = *scale);
        let over = |k: usize| -> f64 { row(targets[k]).zip(&solved).map(|(r, x)| r * x).sum::<f64>() - right[k] };
        let most = (0..targets.len()).max_by(|&a, &b| over(a).total_cmp(&over(b)));
        // With an emitter that is off now, or was before, the targets need not all be met.
        let is_short = solved.contains(&0.0) || targets.len() > emitters.len();
        let Some(most) = most.filter(|&most| is_short && targets.len() > 1 && over(most) > 0.0) else {
            return Ok(scales);
        };
        targets.remove(most);
        emitters.retain(|&j| scales[j] > 0.0);
        if emitters.is_empty() {
            return Ok(scales);
        }
    }
}

/// Returns the `count` scales ≥ 0 that minimise the squared residuals of the rows of a matrix; all 0 if nothing
/// responds.
fn least_squares(matrix: &[f64], right: &[f64], count: usize) -> Result<Vec<f64>> {
    let lambda = REGULARISATION * dot(matrix, matrix) / right.len().max(1) as f64;
    if !(lambda > 0.0 && lambda.is_finite()) {
        return Ok(vec![0.0; count]);
    }
    let together: Vec<f64> = matrix.chunks_exact(count).map(|row| row.iter().sum()).collect();
    let equal = (dot(&together, right) / dot(&together, &together)).max(0.0);
    let (preferred, upper) = (vec![equal; count], vec![f64::INFINITY; count]);
    BoundedLeastSquares { matrix, right, regularisation: lambda, preferred: &preferred, upper: &upper }.solve()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The third target is so bright that its light alone exceeds the first two. It is met, and the first two emitters
    /// are off.
    #[test]
    fn a_target_is_met_although_two_others_are_exceeded() {
        let rows = [vec![1.0, 0.1, 0.5], vec![0.1, 1.0, 0.5], vec![0.3, 0.3, 1.0]];
        let scales = meet(&rows, &[10.0, 10.0, 100.0]).unwrap();
        assert_eq!(scales[..2], [0.0, 0.0]);
        assert!((scales[2] - 100.0).abs() < 1e-4, "{scales:?}");
        // If other light exceeds all targets, all emitters are off.
        assert_eq!(meet(&rows, &[-1.0, -2.0, -3.0]).unwrap(), [0.0; 3]);
        assert!(meet(&[], &[]).unwrap().is_empty());
    }
}
