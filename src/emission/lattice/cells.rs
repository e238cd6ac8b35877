//! Enumerates the cells of a lattice.

use glam::{DMat2, DVec2};

/// Returns all cells whose origin lies in the axis-aligned box between the corners `low` and `high`, and possibly some
/// cells outside it. Positions are relative to the origin of cell (0, 0). `to_cells` maps positions to lattice
/// coordinates: the inverse of the matrix whose columns are the periods.
pub fn between(to_cells: DMat2, low: DVec2, high: DVec2) -> impl Iterator<Item = Cell> {
    let corners = [low, DVec2::new(high.x, low.y), DVec2::new(low.x, high.y), high].map(|c| to_cells * c);
    let first = corners.iter().fold(DVec2::INFINITY, |m, c| m.min(*c)).floor();
    let last = corners.iter().fold(DVec2::NEG_INFINITY, |m, c| m.max(*c)).ceil();
    let columns = first.x as i64..=last.x as i64;
    (first.y as i64..=last.y as i64).flat_map(move |j| columns.clone().map(move |i| [i, j]))
}

/// A cell `[i, j]`, whose origin is i a + j b, where a and b are the periods of the lattice.
pub type Cell = [i64; 2];
