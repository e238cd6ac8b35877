//! Fits the basis vectors of a lattice to the centres of its lamps.

use crate::emission::exemplar::Exemplar;
use glam::{DMat2, DVec2};

/// Maximum number of lamps whose pairs take part in the fit. If there are more lamps, only every k-th one is used, with
/// the smallest k that keeps this maximum. [bench emission:seconds]
const MAX_LAMPS: usize = 400;
/// A pair of lamps takes part in the fit if the vector between them differs from a lattice vector by less than this
/// share of the first period's length. [bench emission:patterns]
const MAX_OFF_SITE: f64 = 0.12;
/// Maximum number of lattice steps between the two lamps of a pair, along either basis vector, for each of the three
/// passes of the fit. The limits lie halfway between whole numbers, so rounding errors cannot move a whole number of
/// steps across a limit. [rounding]
const MAX_STEPS: [f64; 3] = [1.5, 3.5, f64::INFINITY];
/// If the pattern does not change along the x or y axis, it has no period along this axis. The search for lattices then
/// returns a shift of one unwarped pixel along the axis instead. A basis vector that is at most this long, in unwarped
/// pixels, is such a shift. [rounding]
pub const MAX_UNCHANGING_LENGTH: f64 = 1.5;

/// Returns a period, made exactly parallel to the x or y axis if its slant is below `max_slant`. The slant is the
/// tangent of the angle between period and axis. The length of the period stays. In a row of few lamps, a slant of a
/// few percent may be a measurement error, but it would carry a long row far from the axis.
pub fn straight(period: DVec2, max_slant: f64) -> DVec2 {
    match () {
        _ if period.x.abs() < max_slant * period.y.abs() => DVec2::new(0.0, period.length().copysign(period.y)),
        _ if period.y.abs() < max_slant * period.x.abs() => DVec2::new(period.length().copysign(period.x), 0.0),
        _ => period,
    }
}

/// Refines the first `count` (1 or 2) vectors of `basis`, called `a` and `b` here, by a least-squares fit to the
/// centres of lamps. A pair of lamps takes part if the two lamps have about equal sizes, and if the vector between
/// their centres is about `i a + j b` with integers `i` and `j`. The first pass uses close pairs only, the second more
/// distant ones, and the third all pairs, because `i` and `j` of a distant pair are correct only if the basis is
/// already accurate. A pair is weighted by the area of the smaller lamp, because small fragments resemble each other by
/// chance.
pub fn refine(exemplar: &Exemplar, basis: [DVec2; 2], count: usize) -> [DVec2; 2] {
    let all: Vec<_> = exemplar.lamps().collect();
    let lamps: Vec<_> = all.iter().step_by(all.len().div_ceil(MAX_LAMPS).max(1)).collect();
    let mut basis = basis;
    for max_step in MAX_STEPS {
        let inverse = DMat2::from_cols(basis[0], basis[1]).inverse();
        if !inverse.is_finite() {
            break;
        }
        // Accumulate the normal equations of the fit: difference = i a + j b for each pair, with unknown a and b.
        let (mut gram, mut sums) = (DMat2::ZERO, DMat2::ZERO);
        let mut votes = 0;
        for (n, p) in lamps.iter().enumerate() {
            for q in &lamps[n + 1..] {
                let alike = (0..2).all(|k| p.size()[k].abs_diff(q.size()[k]) <= 2 + p.size()[k] / 8);
                let difference = q.centre - p.centre;
                let cell = inverse * difference;
                let step = DVec2::new(cell.x.round(), if count == 2 { cell.y.round() } else { 0.0 });
                let off = (difference - basis[0] * step.x - basis[1] * step.y).length();
                let near = step.x.abs().max(step.y.abs()) <= max_step;
                if alike && near && step != DVec2::ZERO && off < MAX_OFF_SITE * basis[0].length() {
                    let weight = p.area.min(q.area) as f64;
                    gram += DMat2::from_cols(step * step.x, step * step.y) * weight;
                    sums += DMat2::from_cols(difference * step.x, difference * step.y) * weight;
                    votes += 1;
                }
            }
        }
        if votes == 0 {
            continue;
        }
        if count == 1 {
            basis[0] = sums.x_axis / gram.x_axis.x;
        } else if gram.determinant() > 1e-6 * gram.x_axis.x * gram.y_axis.y {
            let fitted = sums * gram.inverse();
            basis = [fitted.x_axis, fitted.y_axis];
        }
    }
    basis
}
