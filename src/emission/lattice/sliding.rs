//! Recognises a lattice vector that slides lines of light along themselves.
//!
//! Lines of light that the border cuts at different places look alike after any short shift along the lines. The
//! autocorrelation then has peaks at shifts that differ only along the lines, and two such peaks span a lattice that
//! the lights do not have: each line would overlap its own copy.

use super::{basis, law};
use crate::emission::exemplar::Exemplar;
use crate::geometry::lattice::reduced;
use glam::DVec2;

/// A shift slides lights along themselves if it moves at least this share of the lit pixels onto pixels of the same
/// light. Separate lamps on a lattice do not overlap their copies at all. [bench photos:tune]
const MIN_OVERLAP: f64 = 0.3;

/// If one of the short vectors of the lattice slides the lights along the x or the y axis, returns the direction of
/// this axis and the period across it. `None` if no vector does.
pub fn find(exemplar: &Exemplar, found: [DVec2; 2]) -> Option<[DVec2; 2]> {
    let [a, b] = reduced(found);
    [[a, b], [b, a], [a - b, a], [a + b, a]].into_iter().find_map(|[slide, across]| {
        let aligned = law::aligned(slide);
        let (axis, period) = match () {
            () if aligned.y == 0.0 => (DVec2::X, DVec2::new(0.0, across.y)),
            () if aligned.x == 0.0 => (DVec2::Y, DVec2::new(across.x, 0.0)),
            () => return None,
        };
        let is_long = |v: DVec2| v.length() > basis::MAX_UNCHANGING_LENGTH;
        (is_long(slide) && is_long(period) && slides(exemplar, slide)).then_some([axis, period])
    })
}

/// Whether a shift slides the lights along themselves. A line overlaps its copy more after half the shift; a net of
/// lines, whose meshes are true periods, overlaps it less.
fn slides(exemplar: &Exemplar, shift: DVec2) -> bool {
    let overlapping = overlap(exemplar, shift);
    overlapping >= MIN_OVERLAP && overlap(exemplar, shift / 2.0) >= overlapping
}

/// Of the lit pixels that a shift moves onto pixels that the photo shows, the share that it moves onto pixels of the
/// same light.
fn overlap(exemplar: &Exemplar, shift: DVec2) -> f64 {
    let (width, height) = (exemplar.width as i64, exemplar.height as i64);
    let shift = shift.round().to_array().map(|v| v as i64);
    let components = &exemplar.components;
    let may_overlap = |k: usize| (0..2).all(|axis| components.list[k].size()[axis] as i64 > shift[axis].abs());
    let (mut moved, mut kept) = (0u64, 0u64);
    let lights: Vec<bool> = (0..components.list.len()).map(may_overlap).collect();
    if !lights.contains(&true) {
        return 0.0;
    }
    for y in 0..height {
        let to = y + shift[1];
        if !(0..height).contains(&to) {
            continue;
        }
        for x in (-shift[0]).max(0)..width.min(width - shift[0]) {
            let label = components.labels[(y * width + x) as usize];
            let target = (to * width + x + shift[0]) as usize;
            if label != 0 && exemplar.shown[target] {
                moved += 1;
                kept += u64::from(components.labels[target] == label);
            }
        }
    }
    kept as f64 / moved.max(1) as f64
}
