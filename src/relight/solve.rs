//! The closed form and its interval, from the means of independent batches.

use super::estimate::{BATCHES, STUDENT_T, mean, pseudo_values, standard_error, without};
use super::sided::Sense;
use super::transport::Pairs;
use super::{Reach, Solution};
use crate::error::{Error, ErrorKind, Result};
use crate::image::colour;
use glam::DVec3;

/// What the batches measured: the target's mean radiance under the emission, and under all other light.
pub(super) struct Measured {
    pub response: Vec<DVec3>,
    pub background: Vec<DVec3>,
    /// For least squares over the target's points.
    pub pairs: Option<Vec<Pairs>>,
    /// Paths behind it.
    pub paths: u32,
}

/// One channel: what each batch measured.
struct Channel {
    response: [f64; BATCHES],
    background: [f64; BATCHES],
    /// Means over the target's points of the squared response, and of the response times the background.
    squares: Option<[[f64; BATCHES]; 2]>,
}

#[derive(Clone, Copy)]
struct Answer {
    scale: f64,
    half_width: f64,
    reach: Reach,
    /// What each batch alone would say, less the answer.
    deviations: [f64; BATCHES],
}

pub(super) fn run(measured: &Measured, target: DVec3, sense: [Sense; 3]) -> Result<Solution> {
    let channels: [Channel; 3] = std::array::from_fn(|c| Channel {
        response: std::array::from_fn(|b| measured.response[b][c]),
        background: std::array::from_fn(|b| measured.background[b][c]),
        squares: measured
            .pairs
            .as_ref()
            .map(|pairs| [std::array::from_fn(|b| pairs[b].own[c]), std::array::from_fn(|b| pairs[b].cross[c])]),
    });
    let mut answers: [Answer; 3] = std::array::from_fn(|c| channels[c].solve(target[c]));
    keep_sides(&mut answers, sense);
    let reach = answers.each_ref().map(|a| a.reach);
    if reach.iter().all(|&r| r != Reach::Met) {
        return Err(Error::new(ErrorKind::Unreachable, explain(&reach)));
    }
    // A channel without response is set to the mean of the others: neither black nor a guess beyond them.
    let met: Vec<f64> = answers.iter().filter(|a| a.reach == Reach::Met).map(|a| a.scale).collect();
    let neutral = met.iter().sum::<f64>() / met.len() as f64;
    let scale = answers.each_ref().map(|a| if a.reach == Reach::Dark { neutral } else { a.scale });
    let response = DVec3::from(channels.each_ref().map(|c| mean(&c.response)));
    let background = DVec3::from(channels.each_ref().map(|c| mean(&c.background)));
    // What the target shows: what it should, but where it need not be at its limit.
    let light = background + DVec3::from(scale) * response;
    let seen = DVec3::from(std::array::from_fn(|c| if sense[c] == Sense::Exactly { target[c] } else { light[c] }));
    Ok(Solution {
        scale: DVec3::from(scale),
        half_width: DVec3::from(answers.each_ref().map(|a| a.half_width)),
        reach,
        sense,
        response,
        background,
        delta_e: colour_interval(&answers, response, seen),
        paths: measured.paths,
    })
}

/// Of channels whose targets are limits: they keep the mean scale of those that are at theirs, which leaves the lamps their
/// colour, unless that breaks the limit. Where no channel must be at its target, all stay at their limits.
fn keep_sides(answers: &mut [Answer; 3], sense: [Sense; 3]) {
    // Where other light alone is brighter than a least, none is needed.
    for (answer, _) in answers.iter_mut().zip(sense).filter(|(_, sense)| *sense == Sense::AtLeast) {
        if answer.reach == Reach::TooBright {
            answer.reach = Reach::Met;
        }
    }
    let exact = |c: &usize| sense[*c] == Sense::Exactly;
    let met: Vec<Answer> = (0..3).filter(exact).map(|c| answers[c]).filter(|a| a.reach == Reach::Met).collect();
    if met.is_empty() {
        return;
    }
    let share = 1.0 / met.len() as f64;
    let scale = share * met.iter().map(|a| a.scale).sum::<f64>();
    let deviations = std::array::from_fn(|b| share * met.iter().map(|a| a.deviations[b]).sum::<f64>());
    let half_width = STUDENT_T * standard_error(&deviations);
    let neutral = Answer { scale, half_width, reach: Reach::Met, deviations };
    for (answer, sense) in answers.iter_mut().zip(sense).filter(|(_, sense)| *sense != Sense::Exactly) {
        if answer.reach == Reach::Met && sense.miss(scale - answer.scale) == 0.0 {
            *answer = neutral;
        }
    }
}

impl Channel {
    /// The scale from means over all batches, or over some, as `mean` takes them: `(t - E b) / E r` of the mean, and
    /// `(t E r - E br) / E r²` of least squares.
    fn scale(&self, target: f64, mean: impl Fn(&[f64; BATCHES]) -> f64) -> f64 {
        match &self.squares {
            None => (target - mean(&self.background)) / mean(&self.response),
            Some([own, cross]) => (target * mean(&self.response) - mean(cross)) / mean(own),
        }
    }

    /// The scale and its interval by the jackknife.
    fn solve(&self, target: f64) -> Answer {
        let response = mean(&self.response);
        let noise = standard_error(&self.response);
        // Without any batch there must be something left to divide by.
        let paired = self.squares.is_none_or(|[own, _]| own.iter().filter(|square| **square > 0.0).count() > 1);
        if response.is_nan() || response <= 3.0 * noise || !paired {
            return Answer { scale: 0.0, half_width: 0.0, reach: Reach::Dark, deviations: [0.0; BATCHES] };
        }
        let rest = std::array::from_fn(|b| self.scale(target, |values| without(mean(values), values[b])));
        let alone = pseudo_values(self.scale(target, mean), &rest);
        let scale = mean(&alone);
        let half_width = STUDENT_T * standard_error(&alone);
        let deviations = alone.map(|a| a - scale);
        if scale < 0.0 {
            return Answer { scale: 0.0, half_width, reach: Reach::TooBright, deviations: [0.0; BATCHES] };
        }
        Answer { scale, half_width, reach: Reach::Met, deviations }
    }
}

/// How far the colour of the target may be off: Student's quantile of the root mean square difference that deviations as
/// large as the standard error make, channels together as they came. That bounds 95 % of errors, whichever way they lie. Seen
/// at the exposure that shows the target as a middle grey.
fn colour_interval(answers: &[Answer; 3], response: DVec3, target: DVec3) -> f64 {
    let squares = (0..BATCHES).map(|b| {
        let deviation = DVec3::from(std::array::from_fn(|c| answers[c].deviations[b])) / (BATCHES as f64 - 1.0).sqrt();
        colour::delta_e_from(target, target + deviation * response).powi(2)
    });
    STUDENT_T * (squares.sum::<f64>() / BATCHES as f64).sqrt()
}

fn explain(reach: &[Reach; 3]) -> String {
    if reach.iter().all(|&r| r == Reach::Dark) {
        "no light of the emission finds its way back to the target surface: it may face away from the room, or be \
         all lamps, which are left out, or everything around it may be black; choose another target surface"
            .into()
    } else {
        "the other lights of the scene alone are brighter than the target: dim or remove them, or raise the target"
            .into()
    }
}
