//! The lamps of an exemplar, as evidence for a law: the rule by which their pattern continues, such as a lattice.
//!
//! The border of the photo may cut a lamp, so that only a part is visible. If this part resembles a whole lamp, the cut
//! lamp is assumed to have the size of the whole lamp. The centre of the cut lamp then follows from the edges that the
//! border does not cut. Such a cut lamp is as good evidence for a period as a whole lamp is.

use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::components::Component;
use crate::emission::exemplar::measured_lamp::MeasuredLamp;
use crate::emission::exemplar::roles::Role;
use glam::{BVec2, DVec2};

/// The border cuts a side of a lamp if at least this share of the side's length lies at the border. A smaller contact
/// counts as fraying of the mask. [rounding]
const MIN_CUT_SHARE: f64 = 0.1;

/// The lamps of an exemplar. Each list is in descending order of the number of photo pixels that show the lamp.
pub struct Evidence {
    /// The whole lamps: lamps that the photo shows completely, and lamps that count as whole ([`Role::is_whole`]).
    pub whole: Vec<MeasuredLamp>,
    /// The lamps that the border cuts and whose size is known. `centre` is the centre of the whole lamp; `weight` is
    /// the number of photo pixels of the visible part. Always empty for a luminous ceiling, because it is not known at
    /// which bar a cut pane would end.
    pub completed: Vec<MeasuredLamp>,
    /// The visible parts of the lamps that the border cuts and whose size is unknown.
    pub parts: Vec<MeasuredLamp>,
}

impl Evidence {
    pub fn of(exemplar: &Exemplar) -> Self {
        let whole = exemplar.measured_lamps(Role::is_whole);
        let mut parts = exemplar.measured_lamps(|role| matches!(role, Role::Cut | Role::Partial));
        let mut completed = Vec::new();
        if !exemplar.is_luminous_ceiling() {
            completed = parts.iter().filter_map(|part| complete(exemplar, part, &whole)).collect();
            parts.retain(|part| !completed.iter().any(|lamp| lamp.component == part.component));
        }
        Self { whole, completed, parts }
    }

    /// Whether the photo shows exactly one whole lamp, no completed one, and at most one part of another lamp (no part,
    /// for a luminous ceiling). Such an exemplar shows no period.
    pub fn is_single(&self, exemplar: &Exemplar) -> bool {
        let max_parts = usize::from(!exemplar.is_luminous_ceiling());
        self.whole.len() == 1 && self.completed.is_empty() && self.parts.len() <= max_parts
    }
}

/// Completes a cut lamp of which the photo shows `part`: takes the size of a whole lamp that `part` resembles, and
/// computes the centre. `None` if `part` does not have the role `Cut`, if it resembles no whole lamp, or if the border
/// cuts it at both ends of an axis.
fn complete(exemplar: &Exemplar, part: &MeasuredLamp, whole: &[MeasuredLamp]) -> Option<MeasuredLamp> {
    if exemplar.roles[part.component] != Role::Cut {
        return None;
    }
    let lamp = &exemplar.components.list[part.component];
    let (low, high) = lamp.bounds();
    let [cut_low, cut_high] = cut_sides(exemplar, part.component, lamp);
    if (cut_low & cut_high).any() {
        return None;
    }

    // Find a whole lamp to which the part may be equal. Along an axis that is not cut, the lamp must be about as long
    // as the part; along a cut axis, at least about as long.
    let is_cut = cut_low | cut_high;
    let size = whole.iter().find_map(|other| {
        let size = DVec2::select(is_cut, part.size.max(other.size), part.size);
        MeasuredLamp { size, ..*part }.is_like(other).then_some(other.size)
    })?;
    let centre =
        DVec2::select(cut_low, high - size / 2.0, DVec2::select(cut_high, low + size / 2.0, (low + high) / 2.0));
    Some(MeasuredLamp { centre, size, ..*part })
}

/// Whether the border cuts the left and the top side of a component, and whether it cuts the right and the bottom side.
fn cut_sides(exemplar: &Exemplar, component: usize, lamp: &Component) -> [BVec2; 2] {
    let Exemplar { width, height, ref shown, ref components, .. } = *exemplar;
    let [mut left, mut right, mut top, mut bottom] = [0usize; 4];
    for y in lamp.min[1]..=lamp.max[1] {
        for x in lamp.min[0]..=lamp.max[0] {
            let i = y * width + x;
            if components.labels[i] as usize == component + 1 {
                left += usize::from(x == 0 || !shown[i - 1]);
                right += usize::from(x + 1 == width || !shown[i + 1]);
                top += usize::from(y == 0 || !shown[i - width]);
                bottom += usize::from(y + 1 == height || !shown[i + width]);
            }
        }
    }
    let [across, down] = lamp.size();
    let is_cut = |contacts: usize, side: usize| contacts as f64 >= MIN_CUT_SHARE * side as f64;
    [BVec2::new(is_cut(left, down), is_cut(top, across)), BVec2::new(is_cut(right, down), is_cut(bottom, across))]
}
