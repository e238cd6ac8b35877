//! Recognises a lattice vector that slides lines of light along themselves.
//!
//! Lines of light that the border cuts at different places look alike after any short shift along the lines. The
//! autocorrelation then has peaks at shifts that differ only along the lines, and two such peaks span a lattice that
//! the lights do not have: each line would overlap its own copy.

use super::{basis, law};
use crate::emission::exemplar::Exemplar;
use glam::DVec2;

/// A shift slides the lights along themselves if at least this share of the lit pixels is moved onto pixels of the same
/// light. The lights of a true lattice do not overlap their copies at all. [bench photos:tune]
const MIN_OVERLAP: f64 = 0.3;

/// If a vector of the lattice slides the lights along the x or the y axis, returns the direction of this axis and the
/// period across it. `None` if no vector does.
pub fn find(exemplar: &Exemplar, found: [DVec2; 2]) -> Option<[DVec2; 2]> {
    let [a, b] = basis::reduced(found);
    [[a, b], [b, a]].into_iter().find_map(|[slide, across]| {
        let axis = law::aligned(slide).normalize_or_zero().abs();
        let period = across - axis * across.dot(axis);
        let is_slide = slide.length() > basis::MAX_UNCHANGING_LENGTH && axis.max_element() == 1.0;
        let has_period = period.length() > basis::MAX_UNCHANGING_LENGTH;
        (is_slide && has_period && overlap(exemplar, slide) >= MIN_OVERLAP).then_some([axis, period])
    })
}

/// Share of the lit pixels that a shift moves onto pixels of the same light.
fn overlap(exemplar: &Exemplar, shift: DVec2) -> f64 {
    let (width, height) = (exemplar.width as i64, exemplar.height as i64);
    let [dx, dy] = shift.round().to_array().map(|v| v as i64);
    let labels = &exemplar.components.labels;
    let (mut lit, mut kept) = (0u64, 0u64);
    for (i, &label) in labels.iter().enumerate().filter(|(_, label)| **label != 0) {
        let (x, y) = (i as i64 % width + dx, i as i64 / width + dy);
        lit += 1;
        let is_inside = (0..width).contains(&x) && (0..height).contains(&y);
        kept += u64::from(is_inside && labels[(y * width + x) as usize] == label);
    }
    kept as f64 / lit.max(1) as f64
}
