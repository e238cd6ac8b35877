//! Centres a lattice in the texture, so that the border cuts as few lamps as possible.

use super::law::Law;
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::components::Component;
use glam::{DMat2, DVec2};
use std::cmp::Ordering;

/// In a texture with more lattice cells than this, it would take too long to count the lamps that the border cuts. The
/// lamp nearest to the exemplar's centre then moves to the texture's centre, without comparison. [convention]
const MAX_CELLS: f64 = 1e6;

/// A bounding box of lights, in unwarped pixels.
#[derive(Clone, Copy)]
struct Bounds {
    low: DVec2,
    high: DVec2,
}

impl Bounds {
    fn of(lamp: &Component) -> Self {
        let (low, high) = lamp.bounds();
        Self { low, high }
    }

    fn centre(self) -> DVec2 {
        (self.low + self.high) / 2.0
    }

    fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
}

/// The shift, in unwarped pixels, that centres a lattice in a texture of `size` unwarped pixels. Four shifts are
/// compared. They move one of these points to the texture's centre: the centre of a lamp or of the group that repeats,
/// the midpoint between two of them that are one period apart (for each period), or the midpoint between four of them.
/// The shift is chosen for which the border cuts the fewest lamps; among equal shifts, the shift with the number of
/// lamps nearest to the size of the texture divided by the size of a lattice cell; then the shift that keeps the lamps
/// farthest from the border. With more than [`MAX_CELLS`] cells, the first point moves to the centre without
/// comparison. `None` if the law has no lattice.
pub fn shift(exemplar: &Exemplar, law: Law, size: DVec2) -> Option<DVec2> {
    let [a, b] = law.lattice()?;
    let (anchor, motif) = motif(exemplar, law)?;
    let middles = [DVec2::ZERO, a / 2.0, b / 2.0, (a + b) / 2.0];
    let shifts = middles.map(|from_anchor| size / 2.0 + from_anchor - anchor);
    let inverse = DMat2::from_cols(a, b).inverse();
    if size.element_product() * inverse.determinant().abs() > MAX_CELLS {
        return Some(shifts[0]);
    }
    let expected = motif.len() as f64 * size.element_product() * inverse.determinant().abs();
    let scores = shifts.map(|shift| {
        let Border { cut, whole, margin } = Border::of(&motif, [a, b], shift, size);
        // Rounded to a millionth of a lamp or pixel: smaller differences are rounding errors.
        [cut as f64, (whole as f64 - expected).abs(), -margin].map(|score| (score * 1e6).round())
    });
    let best = (0..4).min_by(|&i, &j| scores[i].partial_cmp(&scores[j]).unwrap_or(Ordering::Equal))?;
    Some(shifts[best])
}

/// The point of a lattice cell that centring moves to the texture's centre, or half a period beside it, and the
/// bounding boxes of the cell's lamps. The first lamp is the one nearest to the exemplar's centre.
///
/// - Lattice: the centre of the first lamp, and all lamps in the cell that is centred on it.
/// - Row: a single box and its centre. Along the row, it is as long as the first lamp; across the row, it spans all
///   lamps.
/// - Repetition of the whole exemplar: the centre of the box around all lamps, and all lamps.
fn motif(exemplar: &Exemplar, law: Law) -> Option<(DVec2, Vec<Bounds>)> {
    let mut lamps: Vec<Bounds> = exemplar.pieces().map(|(_, lamp)| Bounds::of(lamp)).collect();
    if lamps.is_empty() {
        lamps = exemplar.components.list.iter().map(Bounds::of).collect();
    }
    let middle = DVec2::new(exemplar.width as f64, exemplar.height as f64) / 2.0;
    lamps.sort_by(|p, q| p.centre().distance_squared(middle).total_cmp(&q.centre().distance_squared(middle)));
    let first = *lamps.first()?;
    let all = lamps.iter().fold(first, |all, lamp| all.with(*lamp));
    let row = |low, high| {
        let row = Bounds { low, high };
        (row.centre(), vec![row])
    };
    Some(match law {
        Law::Lattice([a, b]) => {
            let inverse = DMat2::from_cols(a, b).inverse();
            lamps.retain(|lamp| (inverse * (lamp.centre() - first.centre())).round() == DVec2::ZERO);
            (first.centre(), lamps)
        }
        Law::Row([_, across]) if across.x == 0.0 => {
            row(DVec2::new(first.low.x, all.low.y), DVec2::new(first.high.x, all.high.y))
        }
        Law::Row(_) => row(DVec2::new(all.low.x, first.low.y), DVec2::new(all.high.x, first.high.y)),
        _ => (all.centre(), lamps),
    })
}

/// The lamps at the texture's border after a shift.
struct Border {
    /// The numbers of lamps that the border cuts, and that lie in the texture as a whole.
    cut: usize,
    whole: usize,
    /// The minimum distance of the whole lamps from the border, in unwarped pixels; infinite without a whole lamp.
    margin: f64,
}

impl Border {
    /// The lamps of `motif` are repeated with the periods `a` and `b`, and shifted by `shift`.
    fn of(motif: &[Bounds], [a, b]: [DVec2; 2], shift: DVec2, size: DVec2) -> Self {
        let inverse = DMat2::from_cols(a, b).inverse();
        let mut border = Self { cut: 0, whole: 0, margin: f64::INFINITY };
        for lamp in motif {
            let lamp = Bounds { low: lamp.low + shift, high: lamp.high + shift };
            // Find the range of lattice coordinates (i, j) for which the lamp, moved by i a + j b, may touch the
            // texture.
            let half = (lamp.high - lamp.low) / 2.0;
            let corners =
                [-half, DVec2::new(size.x + half.x, -half.y), DVec2::new(-half.x, size.y + half.y), size + half];
            let cells = corners.map(|c| inverse * (c - lamp.centre()));
            let first = cells.iter().fold(DVec2::INFINITY, |m, c| m.min(*c)).ceil();
            let last = cells.iter().fold(DVec2::NEG_INFINITY, |m, c| m.max(*c)).floor();
            let along = |first: f64, last: f64| (0..=(last - first).max(-1.0) as i64).map(move |i| first + i as f64);
            for j in along(first.y, last.y) {
                for i in along(first.x, last.x) {
                    let (low, high) = (lamp.low + a * i + b * j, lamp.high + a * i + b * j);
                    if !(high.cmpgt(DVec2::ZERO).all() && low.cmplt(size).all()) {
                        continue;
                    }
                    let inside = low.min(size - high).min_element();
                    if inside < -1e-6 {
                        border.cut += 1;
                    } else {
                        border.whole += 1;
                        border.margin = border.margin.min(inside);
                    }
                }
            }
        }
        border
    }
}
