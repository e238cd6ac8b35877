//! Finds periods along the axes from the distances between neighbouring lamps.
//!
//! Autocorrelation needs lamps of equal shape at equal distances. The distances between the centres of neighbours in a
//! row or column give the period even if blur has changed the shape of distant lamps. If wide and narrow gaps
//! alternate, the period is the distance to the second neighbour.

use crate::emission::exemplar::measured_lamp::MeasuredLamp;
use crate::geometry::robust::weighted_median;
use glam::DVec2;

/// The distances from a lamp to this number of neighbours in its row or column are proposed as periods: to the first,
/// the second and the third lamp after it. For example, if each window has three panes side by side, the period of the
/// windows is the distance from a pane to the third pane after it. [convention]
const ORDERS: usize = 3;
/// Let d be this share of the sum of the sizes of two lamps. The lamps are in one row if their centres differ across
/// the row by less than d, and neighbours if their centres also differ along the row by more than d. At 0.5, lamps that
/// only touch side by side would be in one row; at 0, blur would move the lamps of a row into different rows. The value
/// lies in the middle. [convention]
const MAX_OFF_ROW: f64 = 0.25;

/// Proposes lattices along the axes: every pair of a period along x and a period along y.
pub fn lattices([across, down]: &[Vec<f64>; 2]) -> Vec<[DVec2; 2]> {
    across.iter().flat_map(|x| down.iter().map(|y| [DVec2::X * *x, DVec2::Y * *y])).collect()
}

/// Proposes rows along the axes: every period along x, and every period along y.
pub fn rows([across, down]: &[Vec<f64>; 2]) -> Vec<DVec2> {
    across.iter().map(|x| DVec2::X * *x).chain(down.iter().map(|y| DVec2::Y * *y)).collect()
}

/// Periods along x and along y in unwarped pixels, at most [`ORDERS`] each. The n-th period is the median over all
/// lamps of the distance to the n-th neighbour in the same row or column. The weight of a lamp is the number of photo
/// pixels that show it.
pub fn periods(lamps: &[MeasuredLamp]) -> [Vec<f64>; 2] {
    [0, 1].map(|axis| {
        let found = (1..=ORDERS).filter_map(|order| {
            let distances = lamps.iter().filter_map(|lamp| Some((distance(lamps, lamp, axis, order)?, lamp.weight)));
            weighted_median(distances.collect())
        });
        found.collect()
    })
}

/// Distance along an axis (0 for x, 1 for y) from a lamp to its `order`-th neighbour in the positive direction, among
/// the lamps of the same row or column. `None` if there are fewer neighbours.
fn distance(lamps: &[MeasuredLamp], lamp: &MeasuredLamp, axis: usize, order: usize) -> Option<f64> {
    let offset = |other: &MeasuredLamp| other.centre - lamp.centre;
    let is_beside = |other: &&MeasuredLamp| {
        let max_offset = MAX_OFF_ROW * (lamp.size + other.size);
        offset(other)[1 - axis].abs() < max_offset[1 - axis] && offset(other)[axis] > max_offset[axis]
    };
    let mut all: Vec<f64> = lamps.iter().filter(is_beside).map(|other| offset(other)[axis]).collect();
    all.sort_by(f64::total_cmp);
    all.get(order - 1).copied()
}
