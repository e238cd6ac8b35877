//! The solution and its interval, from the means of independent batches.

use super::transport::{BATCHES, Batches};
use super::{Reach, Solution};
use crate::error::{Error, ErrorKind, Result};
use glam::DVec3;

/// 97.5 % quantile of Student's t with `BATCHES - 1` = 31 degrees of freedom.
const STUDENT_T: f64 = 2.039_513;

/// One channel: what each batch measured.
struct Channel {
    response: [f64; BATCHES],
    background: [f64; BATCHES],
}

struct Answer {
    scale: f64,
    half_width: f64,
    reach: Reach,
}

pub(super) fn run(batches: &Batches, target: DVec3) -> Result<Solution> {
    let means = batches.means();
    let channels: [Channel; 3] = std::array::from_fn(|c| Channel {
        response: means.map(|(emitter, _)| emitter[c]),
        background: means.map(|(_, others)| others[c]),
    });
    let answers: [Answer; 3] = std::array::from_fn(|c| channels[c].solve(target[c]));
    let reach = answers.each_ref().map(|a| a.reach);
    if reach.iter().all(|&r| r != Reach::Met) {
        return Err(Error::new(ErrorKind::Unreachable, explain(&reach)));
    }
    // A channel without response is set to the mean of the others: neither black nor a guess beyond them.
    let met: Vec<f64> = answers.iter().filter(|a| a.reach == Reach::Met).map(|a| a.scale).collect();
    let neutral = met.iter().sum::<f64>() / met.len() as f64;
    let scale = answers.each_ref().map(|a| if a.reach == Reach::Dark { neutral } else { a.scale });
    Ok(Solution {
        scale: DVec3::from(scale),
        half_width: DVec3::from(answers.map(|a| a.half_width)),
        reach,
        response: DVec3::from(channels.each_ref().map(|c| mean(&c.response))),
        background: DVec3::from(channels.each_ref().map(|c| mean(&c.background))),
        paths: batches.paths(),
    })
}

impl Channel {
    /// `(target - background) / response` and its interval by the jackknife over batches, which also takes away the
    /// ratio's bias of order 1/n (Efron 1982, §2).
    fn solve(&self, target: f64) -> Answer {
        let n = BATCHES as f64;
        let (response, background) = (mean(&self.response), mean(&self.background));
        let noise = standard_error(&self.response);
        if response.is_nan() || response <= 3.0 * noise {
            return Answer { scale: 0.0, half_width: 0.0, reach: Reach::Dark };
        }
        let whole = (target - background) / response;
        let without: [f64; BATCHES] = std::array::from_fn(|b| {
            let rest = |mean: f64, part: f64| (n * mean - part) / (n - 1.0);
            (target - rest(background, self.background[b])) / rest(response, self.response[b])
        });
        let scale = n * whole - (n - 1.0) * mean(&without);
        let half_width = STUDENT_T * (n - 1.0) * standard_error(&without);
        if scale < 0.0 {
            return Answer { scale: 0.0, half_width, reach: Reach::TooBright };
        }
        Answer { scale, half_width, reach: Reach::Met }
    }
}

fn mean(values: &[f64; BATCHES]) -> f64 {
    values.iter().sum::<f64>() / BATCHES as f64
}

fn standard_error(values: &[f64; BATCHES]) -> f64 {
    let centre = mean(values);
    let n = BATCHES as f64;
    (values.iter().map(|v| (v - centre) * (v - centre)).sum::<f64>() / (n - 1.0) / n).sqrt()
}

fn explain(reach: &[Reach; 3]) -> String {
    if reach.iter().all(|&r| r == Reach::Dark) {
        "no light of the emission finds its way back to the target surface: it may face away from the room, or everything \
         around it may be black; choose another target surface"
            .into()
    } else {
        "the other lights of the scene alone are brighter than the target: dim or remove them, or raise the target"
            .into()
    }
}
