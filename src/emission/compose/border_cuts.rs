//! Counts the lamps that the border of a part of the exemplar cuts, for all parts of one size at once.

use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::area_sums::AreaSums;
use crate::emission::exemplar::roles::Role;
use crate::error::Result;
use crate::image::try_vec;
use std::ops::Range;

/// Outlines of lamps run between pixels and may reach into the pixels around a lamp, so its box has this margin.
/// [convention: one pixel]
const MARGIN: usize = 1;

/// For each position of a part of the exemplar, the number of lamps that lie neither wholly inside nor wholly outside.
pub struct BorderCuts {
    counts: AreaSums,
}

impl BorderCuts {
    /// Counts for all parts of `size` pixels, which must not exceed the exemplar. A part cuts a lamp if it overlaps the
    /// lamp's bounding box and does not contain it. The corners of both kinds of parts fill rectangles. One is added at
    /// each corner of the first rectangle, and subtracted at each corner of the second, by differences at the corners
    /// of the rectangles.
    pub fn new(exemplar: &Exemplar, size: [usize; 2]) -> Result<Self> {
        let columns = exemplar.width - size[0] + 2;
        let rows = exemplar.height - size[1] + 2;
        let mut differences = try_vec(columns * rows, 0u32)?;
        let mut add = |x: Range<usize>, y: Range<usize>, value: u32| {
            let (x, y) = (x.start..x.end.min(columns - 1), y.start..y.end.min(rows - 1));
            if x.start < x.end && y.start < y.end {
                for (row, value) in [(y.start, value), (y.end, value.wrapping_neg())] {
                    let row = &mut differences[row * columns..][..columns];
                    row[x.start] = row[x.start].wrapping_add(value);
                    row[x.end] = row[x.end].wrapping_sub(value);
                }
            }
        };
        // The border always cuts lights that run through the photo.
        let lamps = exemplar.components.list.iter().zip(&exemplar.roles).filter(|(_, role)| **role != Role::Through);
        for (lamp, _) in lamps {
            // Along an axis, a part overlaps the box [first, last] from the corner `reaching(first)` to the corner
            // `last`, and contains it from `reaching(last)` to `first`.
            let first = |axis: usize| lamp.min[axis].saturating_sub(MARGIN);
            let last = |axis: usize| lamp.max[axis] + MARGIN;
            let reaching = |axis: usize, pixel: usize| (pixel + 1).saturating_sub(size[axis]);
            let overlap = |axis: usize| reaching(axis, first(axis))..last(axis) + 1;
            let inside = |axis: usize| reaching(axis, last(axis))..first(axis) + 1;
            add(overlap(0), overlap(1), 1);
            add(inside(0), inside(1), 1u32.wrapping_neg());
        }
        Ok(Self { counts: AreaSums::of(|i| differences[i], columns, rows)? })
    }

    /// The number of lamps that the part with the given upper left corner cuts.
    pub fn at(&self, (x, y): (usize, usize)) -> usize {
        self.counts.count(0, 0, x + 1, y + 1)
    }
}
