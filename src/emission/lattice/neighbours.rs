//! Periods along the axes, from the distances between lamps and their neighbours.
//!
//! Correlation needs lamps of equal shape at equal distances. Lamps in rows and columns tell their periods by the
//! distances between neighbours, even where the far lamps are blurred. Where wide and narrow bars alternate, these
//! distances alternate too, and the second neighbour tells the period.

use crate::emission::exemplar::evidence::Evidence;
use crate::geometry::robust::weighted_median;
use glam::DVec2;

/// Number of neighbours that may tell a period: the next lamp, and the lamp after it. [convention]
const ORDERS: usize = 2;

/// The lattices along the axes that the neighbours propose.
pub fn lattices(lamps: &[Evidence]) -> Vec<[DVec2; 2]> {
    let [across, down] = periods(lamps);
    across.iter().flat_map(|x| down.iter().map(|y| [DVec2::X * *x, DVec2::Y * *y])).collect()
}

/// Periods along x and along y, at most [`ORDERS`] each, in unwarped pixels.
fn periods(lamps: &[Evidence]) -> [Vec<f64>; 2] {
    [0, 1].map(|axis| {
        let found = (1..=ORDERS).filter_map(|order| {
            let distances = lamps.iter().filter_map(|lamp| Some((distance(lamps, lamp, axis, order)?, lamp.weight)));
            weighted_median(distances.collect())
        });
        found.collect()
    })
}

/// Distance along an axis from a lamp to its neighbour of a given order, in the axis's positive direction, among the
/// lamps in the same row or column.
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
