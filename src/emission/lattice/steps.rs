//! Finds periods along the axes from the steps between lamps. A step is the vector from the centre of one lamp to the
//! centre of another lamp of about equal size.
//!
//! The autocorrelation compares areas, so it misses a step between only a few lamps, and a step to a lamp that the
//! photo shows only in part. The centres of the lamps show these steps.

use super::law::aligned;
use crate::emission::exemplar::measured_lamp::MeasuredLamp;
use glam::DVec2;

/// Maximum number of lamps between which steps are compared: the lamps with most photo pixels. [bench emission:seconds]
const MAX_LAMPS: usize = 48;
/// Two steps count as equal if, along x and along y, they differ by at most this share of the length of a step, plus
/// the blur of the two lamps between which the step leads. The blur is about the length of a photo pixel at the lamp
/// ([`MeasuredLamp`]). [judged on 50 photos]
const MAX_DIFFERENCE: f64 = 0.04;
/// A step is a period if at least `MIN_PAIRS` pairs of lamps show it, because a single pair shows no repetition. The
/// number of pairs must also be at least `MIN_PAIRS_PER_LAMP` times the number of lamps, because some steps between
/// scattered lamps are equal by chance. [convention]
const MIN_PAIRS: usize = 2;
const MIN_PAIRS_PER_LAMP: f64 = 1.0 / 3.0;
/// Maximum number of periods along each axis. [bench emission:seconds]
const MAX_PERIODS: usize = 4;

/// A step that one or more pairs of lamps show, in unwarped pixels.
struct Step {
    mean: DVec2,
    pairs: usize,
}

/// The periods along x and along y, in unwarped pixels, at most [`MAX_PERIODS`] each. A period that more pairs of lamps
/// show comes first; among equals, the shorter one. Leaves out multiples of an earlier period. `lamps` is in descending
/// order of photo pixels.
pub fn periods(lamps: &[MeasuredLamp]) -> [Vec<f64>; 2] {
    let lamps = &lamps[..lamps.len().min(MAX_LAMPS)];
    let mut steps = steps(lamps);
    steps.retain(|step| step.pairs >= MIN_PAIRS && step.pairs as f64 >= MIN_PAIRS_PER_LAMP * lamps.len() as f64);
    steps.sort_by(|a, b| b.pairs.cmp(&a.pairs).then(a.mean.length().total_cmp(&b.mean.length())));
    [0, 1].map(|axis| {
        let mut periods: Vec<f64> = Vec::new();
        for step in steps.iter().filter(|step| step.mean[1 - axis] == 0.0) {
            let length = step.mean[axis];
            let is_multiple = |period: &f64| {
                let times = (length / period).round();
                times >= 1.0 && (length - times * period).abs() <= MAX_DIFFERENCE * length
            };
            if !periods.iter().any(is_multiple) {
                periods.push(length);
            }
        }
        periods.truncate(MAX_PERIODS);
        periods
    })
}

/// Finds the steps from one lamp to another of about equal size that are parallel to the x or to the y axis. Counts the
/// pairs of lamps that show each step.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn lamp(x: f64, y: f64) -> MeasuredLamp {
        let (size, blur) = (DVec2::new(12.0, 6.0), DVec2::splat(0.5));
        MeasuredLamp { component: 0, centre: DVec2::new(x, y), size, weight: 72.0, blur }
    }

    #[test]
    fn steps_that_two_pairs_show_are_periods_and_single_or_oblique_ones_are_not() {
        let lamps = [lamp(10.0, 10.0), lamp(50.0, 10.0), lamp(10.0, 41.0), lamp(50.0, 41.0), lamp(123.0, 10.0)];
        // In this row, the steps to the second, third, … lamp are multiples of the period 30 and are left out.
        let row: Vec<MeasuredLamp> = (0..6).map(|k| lamp(30.0 * f64::from(k), 0.0)).collect();
        assert_eq!(periods(&row), [vec![30.0], vec![]]);
        assert_eq!(periods(&lamps), [vec![40.0], vec![31.0]]);
        for few in [&lamps[..2], &[]] {
            assert!(periods(few).iter().all(Vec::is_empty));
        }
    }
}
