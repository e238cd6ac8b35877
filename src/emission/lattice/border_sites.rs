//! Excludes dark places that the border of the exemplar cuts. A site is a position within the lattice cell at which
//! lamps lie. A place is the rectangle that the lamp of a site occupies, or would occupy, in one cell. A place without
//! a lamp is dark.
//!
//! Patches do not show a lamp that the border cuts, because only a part of it is visible. They must not show a dark
//! place that the border cuts either. Otherwise, of the places at the border, patches would show only the dark ones,
//! and lamps would be missing more often in the texture than in the exemplar.

use super::cells;
use crate::emission::exemplar::components::Component;
use crate::emission::exemplar::{Exemplar, area_sums::AreaSums};
use crate::error::Result;
use glam::{DMat2, DVec2};

/// Two lamps belong to one site if the vector between them differs from a lattice vector by less than this. The
/// difference is measured in lattice coordinates, in which each period has length 1. [bench emission:real]
/// (docs/notes/constants.md)
const MAX_OFF_SITE: f64 = 0.2;
/// The dark places of a site are excluded only if at least this share of its completely visible places has a lamp.
/// Otherwise the site is usually dark, and its dark places may stay. [convention]
const MIN_OCCUPANCY: f64 = 0.5;

/// Makes the dark places that the border of the exemplar cuts unusable for patches. Leaves out sites that are usually
/// dark ([`MIN_OCCUPANCY`]). The periods of the lattice, `a` and `b`, are in unwarped pixels.
pub fn exclude(exemplar: &mut Exemplar, [a, b]: [DVec2; 2]) -> Result<()> {
    let (width, height) = (exemplar.width, exemplar.height);
    let inverse = DMat2::from_cols(a, b).inverse();
    let shown = AreaSums::new(|i| exemplar.shown[i], width, height)?;
    let lit = AreaSums::new(|i| exemplar.components.labels[i] != 0, width, height)?;

    let size = DVec2::new(width as f64, height as f64);
    let mut dark: Vec<[usize; 4]> = Vec::new();
    for lamp in one_lamp_per_site(exemplar, inverse) {
        let (low, high) = lamp.bounds();
        let (mut whole, mut filled) = (0u32, 0u32);
        let mut cut = Vec::new();
        for [i, j] in cells::between(inverse, -high, size - low) {
            let shift = (a * i as f64 + b * j as f64).round();
            let (from, to) = ((low + shift).max(DVec2::ZERO), (high + shift).min(size));
            if from.cmpge(to).any() {
                continue;
            }
            let [x0, y0, x1, y1] = [from.x, from.y, to.x, to.y].map(|c| c as usize);
            let is_lit = lit.count(x0, y0, x1 - x0, y1 - y0) > 0;
            match shown.count(x0, y0, x1 - x0, y1 - y0) {
                0 => {}
                seen if seen == lamp.size()[0] * lamp.size()[1] => {
                    whole += 1;
                    filled += u32::from(is_lit);
                }
                _ if is_lit => {}
                _ => cut.push([x0, y0, x1, y1]),
            }
        }
        if f64::from(filled) >= MIN_OCCUPANCY * f64::from(whole) {
            dark.extend(cut);
        }
    }

    hide(exemplar, &dark);
    Ok(())
}

/// Returns one lamp for each site. A site is a position within the lattice cell at which lamps lie. `inverse` maps
/// unwarped pixels to lattice coordinates.
fn one_lamp_per_site(exemplar: &Exemplar, inverse: DMat2) -> Vec<&Component> {
    let mut first: Vec<&Component> = Vec::new();
    for lamp in exemplar.lamps() {
        let is_there = |other: &&Component| {
            let steps = inverse * (lamp.centre - other.centre);
            (steps - steps.round()).length() < MAX_OFF_SITE
        };
        if !first.iter().any(is_there) {
            first.push(lamp);
        }
    }
    first
}

/// Marks boxes, given as `[x0, y0, x1, y1]` in unwarped pixels, as unusable for patches. Does nothing if no usable
/// pixel would remain.
fn hide(exemplar: &mut Exemplar, boxes: &[[usize; 4]]) {
    let working = &exemplar.working;
    let mut usable = working.usable.clone();
    let range = |low: usize, high: usize, pitch: f64, side: usize| {
        (low as f64 / pitch) as usize..((high as f64 / pitch).ceil() as usize).min(side)
    };
    for &[x0, y0, x1, y1] in boxes {
        for y in range(y0, y1, working.pitch.y, working.height) {
            usable[y * working.width..][range(x0, x1, working.pitch.x, working.width)].fill(false);
        }
    }
    if usable.contains(&true) {
        exemplar.working.usable = usable;
    }
}
