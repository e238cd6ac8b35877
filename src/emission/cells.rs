//! A stretched lattice, cell by cell.
//!
//! Patches show lamps as far apart as the exemplar has them. Where a lattice is stretched, so that the texture can be repeated, lamps
//! would keep that distance within a patch and jump from one to the next. So each cell of the stretched lattice shows, in its own
//! place, the lamps of that cell of the exemplar which the patch at its middle shows.

use super::components::Component;
use super::exemplar::Exemplar;
use super::lamps::{self, Instance};
use super::layout::{Layout, NONE, Shift, Shifts};
use crate::error::Result;
use crate::image::try_vec;
use crate::rng::Rng;
use glam::{DMat2, DVec2};
use std::collections::{BTreeMap, BTreeSet};

/// A period of no more than this many unwarped pixels is none: nothing changes along it.
const UNCHANGING: f64 = 1.5;

/// Cells by their steps along both periods.
type Cell = [i64; 2];

/// The lamps of a texture of `size` unwarped pixels, on the lattice `stretched` instead of the exemplar's `own`, which begins at
/// `offset`. `None` where the exemplar shows no lamp, or no cell of it as a whole.
pub fn place(
    exemplar: &Exemplar,
    layout: &Layout,
    [own, stretched]: [[DVec2; 2]; 2],
    offset: DVec2,
    size: DVec2,
    seed: u64,
) -> Option<Vec<Instance>> {
    let [own, stretched] = [own, stretched].map(|[a, b]| DMat2::from_cols(a, b));
    let (to_own, to_stretched) = (own.inverse(), stretched.inverse());

    // Cells lie around the lamp nearest to the middle of the exemplar, and others like it.
    let middle = DVec2::new(exemplar.width as f64, exemplar.height as f64) / 2.0;
    let first = exemplar
        .pieces()
        .min_by(|p, q| p.1.centre.distance_squared(middle).total_cmp(&q.1.centre.distance_squared(middle)))?
        .1;
    let half = DVec2::new(first.size()[0] as f64, first.size()[1] as f64) / 2.0;
    let cell_of = |at: DVec2| (to_own * (at - first.centre)).round().to_array().map(|c| c as i64);
    let step = |[i, j]: Cell| DVec2::new(i as f64, j as f64);

    // The lamps of each, and those that are shown where that lamp is, or would be.
    let mut lamps: BTreeMap<Cell, Vec<usize>> = BTreeMap::new();
    exemplar.pieces().for_each(|(k, lamp)| lamps.entry(cell_of(lamp.centre)).or_default().push(k));
    let components = exemplar.components.list.iter().zip(&exemplar.cut);
    let spoilt: BTreeSet<Cell> = components.filter(|(_, cut)| **cut).map(|(lamp, _)| cell_of(lamp.centre)).collect();
    let is_shown = |at: DVec2| {
        let inside = at.cmpge(DVec2::ZERO).all() && at.x < exemplar.width as f64 && at.y < exemplar.height as f64;
        inside && exemplar.shown[at.y as usize * exemplar.width + at.x as usize]
    };
    let whole: Vec<Cell> = between(to_own, DVec2::ZERO - first.centre, middle * 2.0 - first.centre)
        .filter(|cell| {
            let at = first.centre + own * step(*cell);
            let corners = [-half, DVec2::new(half.x, -half.y), DVec2::new(-half.x, half.y), half * (1.0 - 1e-9)];
            !spoilt.contains(cell) && corners.into_iter().all(|corner| is_shown(at + corner))
        })
        .collect();
    if whole.is_empty() {
        return None;
    }
    let known: BTreeSet<Cell> = whole.iter().copied().collect();

    // Cells whose middle is in the texture: what lies beyond comes in again on the other side.
    let start = first.centre + offset;
    let mut instances = Vec::new();
    for cell in between(to_stretched, DVec2::ZERO - start, size - start) {
        let at = start + stretched * step(cell);
        if !(at.cmpge(DVec2::splat(-1e-6)).all() && at.cmplt(size - 1e-6).all()) {
            continue;
        }
        let pixel = at.max(DVec2::ZERO) / exemplar.working.pitch;
        let (u, v) = ((pixel.x as usize).min(layout.width - 1), (pixel.y as usize).min(layout.height - 1));
        let shown = layout.shift(u, v).map(|shift| cell_of(at - shift.exact)).filter(|cell| known.contains(cell));
        let source = shown.unwrap_or_else(|| {
            let mut rng = Rng::new(seed, &[0x6365, cell[0] as u64, cell[1] as u64]);
            whole[rng.below(whole.len())]
        });
        let shift = at - first.centre - own * step(source);
        instances.extend(lamps.get(&source).into_iter().flatten().map(|&component| Instance { component, shift }));
    }
    lamps::show_sharply(exemplar, &mut instances, seed);
    Some(instances)
}

/// The same of lights that follow the patches: each cell of the stretched lattice shows, in its own place, what the patch at its middle
/// shows there, and where that shows nothing, what the others do. Along an axis on which nothing changes there are no
/// cells. The layout meets itself at the sides of a texture of `size` unwarped pixels, which holds a whole number of them.
pub fn stretch(
    exemplar: &Exemplar,
    layout: &Layout,
    [own, stretched]: [[DVec2; 2]; 2],
    offset: DVec2,
    size: DVec2,
) -> Result<Layout> {
    let has_cells = DVec2::from(own.map(|period| f64::from(u8::from(period.length() > UNCHANGING))));
    let [own, stretched] = [own, stretched].map(|[a, b]| DMat2::from_cols(a, b));
    let to_cells = stretched.inverse();
    let working = &exemplar.working;
    let middle = DVec2::new(exemplar.width as f64, exemplar.height as f64) / 2.0;
    let from_middle = |lamp: &&Component| lamp.centre.distance_squared(middle);
    let lamps = exemplar.components.list.iter();
    let first = lamps.min_by(|p, q| from_middle(p).total_cmp(&from_middle(q))).map_or(middle, |lamp| lamp.centre);
    let start = first + offset;

    let mut out = Layout::new(layout.width, layout.height);
    let mut shifts = Shifts::default();
    let mut row = try_vec(layout.width, NONE)?;
    for y in 0..layout.height {
        for (x, label) in row.iter_mut().enumerate() {
            let place = (DVec2::new(x as f64, y as f64) + 0.5) * working.pitch;
            // The middle of the cell, and where that is within the texture.
            let cells = to_cells * (place - start);
            let at = start + stretched * (cells.round() * has_cells + cells * (DVec2::ONE - has_cells));
            let within = at.rem_euclid(size);
            let pixel = within / working.pitch;
            let (u, v) = ((pixel.x as usize).min(layout.width - 1), (pixel.y as usize).min(layout.height - 1));
            // Cells between there and where the patch begins are wider, or less wide, than the exemplar's.
            let moved = |patch: &Shift, at: DVec2| {
                let steps = to_cells * (at - start) - to_cells * (patch.exact - offset);
                patch.exact + (stretched - own) * (steps.round() * has_cells)
            };
            let shows = |shift: &DVec2| {
                let shift = (*shift / working.pitch).round();
                working.index(x as i32 - shift.x as i32, y as i32 - shift.y as i32).is_some_and(|i| working.usable[i])
            };
            let of_middle = layout.shift(u, v).map(|patch| moved(patch, within) + at - within).filter(shows);
            let own_patch = layout.shift(x, y);
            let shift = of_middle
                .or_else(|| own_patch.map(|patch| moved(patch, at)).filter(shows))
                .or_else(|| own_patch.map(|patch| patch.exact));
            *label = shift.map_or(NONE, |shift| shifts.label(shift, working.pitch));
        }
        out.push(&row);
    }
    out.shifts = shifts.list;
    Ok(out)
}

/// The cells whose place, from that of the first, is between two corners; and some around them.
pub fn between(to_cells: DMat2, low: DVec2, high: DVec2) -> impl Iterator<Item = Cell> {
    let corners = [low, DVec2::new(high.x, low.y), DVec2::new(low.x, high.y), high].map(|c| to_cells * c);
    let first = corners.iter().fold(DVec2::INFINITY, |m, c| m.min(*c)).floor();
    let last = corners.iter().fold(DVec2::NEG_INFINITY, |m, c| m.max(*c)).ceil();
    let columns = first.x as i64..=last.x as i64;
    (first.y as i64..=last.y as i64).flat_map(move |j| columns.clone().map(move |i| [i, j]))
}
