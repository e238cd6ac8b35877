//! Finds periods along the axes from the steps between lamps of equal size.
//!
//! Autocorrelation compares areas, so it misses a step between few lamps, and steps to lamps of which the photo shows
//! only a part. The lamps' centres show these steps.

use super::law::aligned;
use crate::emission::exemplar::measured_lamp::MeasuredLamp;
use glam::DVec2;

/// Maximum number of lamps between which steps are compared: the lamps with most photo pixels. [bench emission:seconds]
const MAX_LAMPS: usize = 48;
/// Two steps count as equal if they differ by at most this share of their length, besides the lamps' blur.
/// [judged on 50 photos]
const MAX_DIFFERENCE: f64 = 0.04;
/// A step is a period if at least this many pairs of lamps show it: a single pair shows no repetition. [convention]
const MIN_PAIRS: usize = 2;
/// Maximum number of periods along each axis. [bench emission:seconds]
const MAX_PERIODS: usize = 4;

/// A step that one or more pairs of lamps show.
struct Step {
    mean: DVec2,
    pairs: usize,
}

/// The periods along x and along y that most pairs of lamps show, the shorter one first among equals.
pub fn periods(lamps: &[MeasuredLamp]) -> [Vec<f64>; 2] {
    let mut steps = steps(&lamps[..lamps.len().min(MAX_LAMPS)]);
    steps.retain(|step| step.pairs >= MIN_PAIRS);
    steps.sort_by(|a, b| b.pairs.cmp(&a.pairs).then(a.mean.length().total_cmp(&b.mean.length())));
    [0, 1].map(|axis| {
        let along = steps.iter().filter(|step| step.mean[1 - axis] == 0.0);
        along.map(|step| step.mean[axis].abs()).take(MAX_PERIODS).collect()
    })
}

/// The steps between lamps of equal size that follow an axis, and how many pairs of lamps show each.
fn steps(lamps: &[MeasuredLamp]) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    for (n, from) in lamps.iter().enumerate() {
        for to in lamps[n + 1..].iter().filter(|to| to.may_be_like(from)) {
            let step = aligned(to.centre - from.centre).abs();
            if step.min_element() > 0.0 {
                continue;
            }
            let slack = from.blur + to.blur + MAX_DIFFERENCE * step.length();
            let is_same = |other: &&mut Step| {
                let is_parallel = other.mean.dot(step) > 0.0;
                is_parallel && (other.mean - step).abs().cmple(slack).all()
            };
            match steps.iter_mut().find(is_same) {
                Some(other) => {
                    other.pairs += 1;
                    other.mean += (step - other.mean) / other.pairs as f64;
                }
                None => steps.push(Step { mean: step, pairs: 1 }),
            }
        }
    }
    steps
}
