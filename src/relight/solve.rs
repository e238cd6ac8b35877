//! Computes the closed-form scale of the emission and its confidence interval, from the means of independent batches.

use super::estimate::{BATCHES, STUDENT_T, mean, pseudo_values, standard_error, without};
use super::sided::Constraint;
use super::solution::{Solution, TargetStatus};
use super::transport::Pairs;
use crate::error::{Error, ErrorKind, Result};
use crate::image::colour;
use crate::maths;
use glam::DVec3;

/// Measurements of the batches: the target's mean radiance under the emission, and under all other light.
pub(super) struct BatchMeasurements {
    pub response: Vec<DVec3>,
    pub background: Vec<DVec3>,
    /// Second moments for a least squares fit over the target's points; `None` for a fit of the mean.
    pub pairs: Option<Vec<Pairs>>,
    /// Number of paths traced.
    pub paths: u32,
}

/// The measurements of one channel, per batch.
struct Channel {
    response: [f64; BATCHES],
    background: [f64; BATCHES],
    /// Two means over the target's points: of the squared response, and of the response times the background.
    squares: Option<[[f64; BATCHES]; 2]>,
}

#[derive(Clone, Copy)]
struct Answer {
    scale: f64,
    half_width: f64,
    status: TargetStatus,
    /// Deviation of each batch's pseudo-value from the solution.
    deviations: [f64; BATCHES],
}

pub(super) fn run(measured: &BatchMeasurements, target: DVec3, constraint: [Constraint; 3]) -> Result<Solution> {
    let channels: [Channel; 3] = std::array::from_fn(|c| Channel {
        response: std::array::from_fn(|b| measured.response[b][c]),
        background: std::array::from_fn(|b| measured.background[b][c]),
        squares: measured
            .pairs
            .as_ref()
            .map(|pairs| [std::array::from_fn(|b| pairs[b].own[c]), std::array::from_fn(|b| pairs[b].cross[c])]),
    });
    let mut answers: [Answer; 3] = std::array::from_fn(|c| channels[c].solve(target[c]));
    keep_sides(&mut answers, constraint);
    let status = answers.each_ref().map(|a| a.status);
    if status.iter().all(|&r| r != TargetStatus::Met) {
        return Err(Error::new(ErrorKind::Unreachable, explain(status)));
    }
    // A channel without response gets the mean scale of the channels that met their target, so that it is neither black
    // nor extrapolated.
    let met: Vec<f64> = answers.iter().filter(|a| a.status == TargetStatus::Met).map(|a| a.scale).collect();
    let neutral = met.iter().sum::<f64>() / met.len() as f64;
    let scale = answers.each_ref().map(|a| if a.status == TargetStatus::Dark { neutral } else { a.scale });
    let response = DVec3::from(channels.each_ref().map(|c| mean(&c.response)));
    let background = DVec3::from(channels.each_ref().map(|c| mean(&c.background)));
    // The achieved light: the target in channels with exact targets, the background plus the scaled response in
    // channels with limits.
    let light = background + DVec3::from(scale) * response;
    let seen =
        DVec3::from(std::array::from_fn(|c| if constraint[c] == Constraint::Exactly { target[c] } else { light[c] }));
    Ok(Solution {
        scale: DVec3::from(scale),
        half_width: DVec3::from(answers.each_ref().map(|a| a.half_width)),
        status,
        constraint,
        response,
        background,
        delta_e: colour_interval(seen, |b| response * DVec3::from(answers.each_ref().map(|a| a.deviations[b]))),
        paths: measured.paths,
    })
}

/// Adjusts the channels whose target is only a lower or an upper limit. To preserve the colour of the lamps, such a
/// channel takes the mean scale of the channels whose exact target was met, unless this scale violates the channel's
/// limit. If no exact target was met, the channel keeps the scale that just reaches its limit.
fn keep_sides(answers: &mut [Answer; 3], constraint: [Constraint; 3]) {
    // A lower limit is met if the other light alone exceeds it.
    for (answer, _) in answers.iter_mut().zip(constraint).filter(|(_, constraint)| *constraint == Constraint::AtLeast) {
        if answer.status == TargetStatus::TooBright {
            answer.status = TargetStatus::Met;
        }
    }
    let exact = |c: &usize| constraint[*c] == Constraint::Exactly;
    let met: Vec<Answer> = (0..3).filter(exact).map(|c| answers[c]).filter(|a| a.status == TargetStatus::Met).collect();
    if met.is_empty() {
        return;
    }
    let share = 1.0 / met.len() as f64;
    let scale = share * met.iter().map(|a| a.scale).sum::<f64>();
    let deviations = std::array::from_fn(|b| share * met.iter().map(|a| a.deviations[b]).sum::<f64>());
    let half_width = STUDENT_T * standard_error(&deviations);
    let neutral = Answer { scale, half_width, status: TargetStatus::Met, deviations };
    for (answer, constraint) in
        answers.iter_mut().zip(constraint).filter(|(_, constraint)| *constraint != Constraint::Exactly)
    {
        if answer.status == TargetStatus::Met && constraint.miss(scale - answer.scale) == 0.0 {
            *answer = neutral;
        }
    }
}

impl Channel {
    /// Computes the scale from the target `t`, background `b` and response `r`. `E[·]` is the mean over the target's
    /// points. The argument `mean` averages the batches' values of `E[·]`.
    ///
    /// - Fit of the mean: `(t - E[b]) / E[r]`.
    /// - Least squares: `(t E[r] - E[b r]) / E[r²]`.
    fn scale(&self, target: f64, mean: impl Fn(&[f64; BATCHES]) -> f64) -> f64 {
        match &self.squares {
            None => (target - mean(&self.background)) / mean(&self.response),
            Some([own, cross]) => (target * mean(&self.response) - mean(cross)) / mean(own),
        }
    }

    /// Solves for the scale, with its confidence interval by the jackknife. The scale is 0 if the response does not
    /// exceed three of its standard errors (`Dark`), or if other light alone exceeds the target (`TooBright`).
    fn solve(&self, target: f64) -> Answer {
        let response = mean(&self.response);
        let noise = standard_error(&self.response);
        // `scale` divides by the mean of `own` over the batches. The jackknife leaves out one batch at a time. At least
        // two batches must therefore have a positive value of `own`; otherwise a divisor could become 0.
        let paired = self.squares.is_none_or(|[own, _]| own.iter().filter(|square| **square > 0.0).count() > 1);
        if response.is_nan() || response <= 3.0 * noise || !paired {
            return Answer { scale: 0.0, half_width: 0.0, status: TargetStatus::Dark, deviations: [0.0; BATCHES] };
        }
        let rest = std::array::from_fn(|b| self.scale(target, |values| without(mean(values), values[b])));
        let alone = pseudo_values(self.scale(target, mean), &rest);
        let scale = mean(&alone);
        let half_width = STUDENT_T * standard_error(&alone);
        let deviations = alone.map(|a| a - scale);
        if scale < 0.0 {
            return Answer { scale: 0.0, half_width, status: TargetStatus::TooBright, deviations: [0.0; BATCHES] };
        }
        Answer { scale, half_width, status: TargetStatus::Met, deviations }
    }
}

/// Computes the CIEDE2000 difference below which 95 % of the target's colour errors stay. `deviation` returns how far
/// the pseudo-value of a batch changes the light of the target, compared with the solution.
///
/// For each batch, the target's colour is changed by the deviation / √(BATCHES - 1): over the batches, this change has
/// the standard error of the mean. The result is the root mean square of the colour differences, times Student's
/// quantile. The three channels of a batch deviate together, so their correlation is included. The exposure shows the
/// target as a middle grey.
pub(super) fn colour_interval(target: DVec3, deviation: impl Fn(usize) -> DVec3) -> f64 {
    let squares = (0..BATCHES).map(|b| {
        let change = deviation(b) / (BATCHES as f64 - 1.0).sqrt();
        maths::powi(colour::delta_e_from(target, target + change), 2)
    });
    STUDENT_T * (squares.sum::<f64>() / BATCHES as f64).sqrt()
}

fn explain(status: [TargetStatus; 3]) -> String {
    if status.iter().all(|&r| r == TargetStatus::Dark) {
        "no light of the emission finds its way back to the target surface: it may face away from the room, or be \
         all lamps, which are left out, or everything around it may be black; choose another target surface"
            .into()
    } else {
        "the other lights of the scene alone are brighter than the target: dim or remove them, or raise the target"
            .into()
    }
}
