//! Finds periods along the axes from the distances between neighbouring lamps.
//!
//! Autocorrelation needs lamps of equal shape at equal distances. The distances between neighbours give the periods of
//! lamps in rows and columns even if the distant lamps are blurred. If wide and narrow gaps between lamps alternate,
//! these distances alternate too, and the distance to the second neighbour gives the period.

use crate::emission::exemplar::measured_lamp::MeasuredLamp;
use crate::geometry::robust::weighted_median;
use glam::DVec2;

/// Number of neighbours whose distances are proposed as periods: the next lamp, the second and the third one. For
/// windows of n ≤ 3 panes along an axis, the distance to the n-th neighbour is the period of the windows. [convention]
const ORDERS: usize = 3;

/// Proposes lattices along the axes: every pair of a period along x and a period along y.
pub fn lattices([across, down]: &[Vec<f64>; 2]) -> Vec<[DVec2; 2]> {
    across.iter().flat_map(|x| down.iter().map(|y| [DVec2::X * *x, DVec2::Y * *y])).collect()
}

/// Proposes rows along the axes: every period along x, and every period along y.
pub fn rows([across, down]: &[Vec<f64>; 2]) -> Vec<DVec2> {
    across.iter().map(|x| DVec2::X * *x).chain(down.iter().map(|y| DVec2::Y * *y)).collect()
}

/// Periods along x and along y, at most [`ORDERS`] each, in unwarped pixels.
pub fn periods(lamps: &[MeasuredLamp]) -> [Vec<f64>; 2] {
    [0, 1].map(|axis| {
        let found = (1..=ORDERS).filter_map(|order| {
            let distances = lamps.iter().filter_map(|lamp| Some((distance(lamps, lamp, axis, order)?, lamp.weight)));
            weighted_median(distances.collect())
        });
        found.collect()
    })
}

/// Distance along an axis from a lamp to its `order`-th neighbour in the positive direction, within the lamp's row or
/// column. `None` if there are fewer neighbours.
fn distance(lamps: &[MeasuredLamp], lamp: &MeasuredLamp, axis: usize, order: usize) -> Option<f64> {
    let offset = |other: &MeasuredLamp| other.centre - lamp.centre;
    let is_beside = |other: &&MeasuredLamp| {
        let reach = 0.25 * (lamp.size + other.size);
        offset(other)[1 - axis].abs() < reach[1 - axis] && offset(other)[axis] > reach[axis]
    };
    let mut all: Vec<f64> = lamps.iter().filter(is_beside).map(|other| offset(other)[axis]).collect();
    all.sort_by(f64::total_cmp);
    all.get(order - 1).copied()
}
