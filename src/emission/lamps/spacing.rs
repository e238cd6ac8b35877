//! Keeps the copies of lamps in a texture apart.
//!
//! If the lamps of a photo do not lie exactly on a lattice, different patches may show one lamp at two nearly equal
//! positions. One of these copies is dropped.

use super::design::Design;
use super::designs::Designs;
use super::instance::Instance;
use crate::emission::exemplar::Exemplar;
use crate::emission::lattice::law::Law;
use glam::{DMat2, DVec2};
use std::collections::BTreeMap;

/// Minimum gap between the boxes of two lamps of the texture, as a share of the smallest gap between the boxes of two
/// whole lamps of the unwarped photo. [convention]
const MIN_GAP_SHARE: f64 = 0.5;
/// Two lamps are whole periods apart if their distance differs from a lattice vector by at most this, in unwarped
/// pixels, along x and along y. [rounding]
const MAX_OFF_STEP: f64 = 1.0;

/// An axis-aligned box around a lamp, in unwarped pixels.
#[derive(Clone, Copy)]
struct Frame {
    centre: DVec2,
    size: DVec2,
}

impl Frame {
    /// The larger of the gaps between two boxes along x and along y; negative if they overlap.
    fn gap(&self, other: &Self) -> f64 {
        ((self.centre - other.centre).abs() - (self.size + other.size) / 2.0).max_element()
    }
}

/// The box around a component at its position in the exemplar. A component with a design gets the box of the design.
fn frame(component: usize, exemplar: &Exemplar, designs: &Designs) -> Frame {
    match designs.of(component) {
        Some((&Design { size, axis, .. }, fitted)) => {
            Frame { centre: fitted.centre, size: axis.abs() * size.x + axis.perp().abs() * size.y }
        }
        None => {
            let (low, high) = exemplar.components.list[component].bounds();
            Frame { centre: (low + high) / 2.0, size: high - low }
        }
    }
}

/// Leaves out each instance that is too close to an earlier instance that is kept, and returns the other instances. The
/// minimum gap is [`MIN_GAP_SHARE`] times the smallest gap between two whole lamps of the exemplar. Lamps that are
/// whole periods apart are never too close: the photo may show only pairs that lie along the longer period. If whole
/// lamps touch, or if there are fewer than two, returns all instances.
pub fn keep_apart(exemplar: &Exemplar, designs: &Designs, law: Law, instances: Vec<Instance>) -> Vec<Instance> {
    let frames: Vec<Frame> = (0..exemplar.roles.len()).map(|k| frame(k, exemplar, designs)).collect();
    let whole: Vec<Frame> = (0..frames.len()).filter(|&k| exemplar.roles[k].is_whole()).map(|k| frames[k]).collect();
    let gaps = whole.iter().enumerate().flat_map(|(n, one)| whole[n + 1..].iter().map(|other| one.gap(other)));
    let min_gap = MIN_GAP_SHARE * gaps.fold(f64::INFINITY, f64::min);
    if !(min_gap.is_finite() && min_gap > 0.0) {
        return instances;
    }

    let lattice = law.lattice().map(|[a, b]| DMat2::from_cols(a, b));
    let are_periods_apart = |step: DVec2| {
        lattice.is_some_and(|basis| {
            let cells = (basis.inverse() * step).round();
            cells != DVec2::ZERO && (basis * cells - step).abs().max_element() <= MAX_OFF_STEP
        })
    };
    // Find earlier instances by a grid over their centres. A grid cell is as large as the longest lamp plus the minimum
    // gap, so an instance that is too close lies in the same grid cell or in an adjacent one.
    let cell = frames.iter().map(|f| f.size.max_element()).fold(0.0, f64::max) + min_gap;
    let mut grid: BTreeMap<[i64; 2], Vec<Frame>> = BTreeMap::new();
    let mut kept = Vec::new();
    for instance in instances {
        let own = frames[instance.component];
        let own = Frame { centre: own.centre + instance.shift, ..own };
        let [x, y] = (own.centre / cell).floor().to_array().map(|v| v as i64);
        let mut around = (y - 1..=y + 1).flat_map(|v| (x - 1..=x + 1).map(move |u| [u, v]));
        let clashes = |f: &Frame| f.gap(&own) < min_gap && !are_periods_apart(own.centre - f.centre);
        let is_close = around.any(|at| grid.get(&at).is_some_and(|there| there.iter().any(clashes)));
        if !is_close {
            grid.entry([x, y]).or_default().push(own);
            kept.push(instance);
        }
    }
    kept
}
