//! Periods along the axes, from the distances between lamps and their neighbours.
//!
//! Correlation needs lamps of equal shape at equal distances; lamps that stand side by side in rows and columns tell
//! their periods also where the far ones are blurred. Bars of two widths in turn put the lamps at two distances in
//! turn: the neighbour after the next tells that period.

use crate::emission::exemplar::evidence::Evidence;
use glam::DVec2;

/// Neighbours that tell a period: the next, and the one after it. [convention]
const ORDERS: usize = 2;

/// Periods along x and along y, at most [`ORDERS`] each, in unwarped pixels.
pub fn periods(lamps: &[Evidence]) -> [Vec<f64>; 2] {
    [0, 1].map(|axis| {
        let found = (1..=ORDERS).filter_map(|order| {
            let mut distances: Vec<(f64, f64)> =
                lamps.iter().filter_map(|lamp| Some((distance(lamps, lamp, axis, order)?, lamp.weight))).collect();
            weighted_median(&mut distances)
        });
        found.collect()
    })
}

/// Distance along an axis to the neighbour of a given order on that side, among the lamps that stand beside this one.
fn distance(lamps: &[Evidence], lamp: &Evidence, axis: usize, order: usize) -> Option<f64> {
    let offset = |other: &Evidence| other.centre - lamp.centre;
    let is_beside = |other: &&Evidence| {
        let reach = 0.25 * (lamp.size + other.size);
        offset(other)[1 - axis].abs() < reach[1 - axis] && offset(other)[axis] > reach[axis]
    };
    let mut all: Vec<f64> = lamps.iter().filter(is_beside).map(|other| offset(other)[axis]).collect();
    all.sort_by(f64::total_cmp);
    all.get(order - 1).copied()
}

/// Value at which half of the weight is reached; `None` without any.
fn weighted_median(values: &mut [(f64, f64)]) -> Option<f64> {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = values.iter().map(|v| v.1).sum::<f64>() / 2.0;
    let mut sum = 0.0;
    values
        .iter()
        .find(|(_, weight)| {
            sum += weight;
            sum >= half
        })
        .map(|v| v.0)
}

/// The lattices along the axes that the neighbours propose.
pub fn lattices(lamps: &[Evidence]) -> Vec<[DVec2; 2]> {
    let [across, down] = periods(lamps);
    across.iter().flat_map(|x| down.iter().map(|y| [DVec2::X * *x, DVec2::Y * *y])).collect()
}
