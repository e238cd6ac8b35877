//! Places lamps at the exact sites of a lattice, and draws each from a lamp that is sharp in the photo. A site is a
//! position within the lattice cell at which lamps lie.
//!
//! Patches repeat the errors of the unwarped photo: some distant lamps are absent because the light mask missed them,
//! and others are displaced because the unwarping is inexact. The mean position of all lamps of a site, weighted by
//! their photo pixels, is more exact than the position of a single lamp.
//!
//! - A site that nearly always has a lamp in the photo gets one in every cell.
//! - At any other site, the patch there decides whether there is a lamp. If there is one, it moves to the exact site.

use super::designs::Designs;
use super::instance::Instance;
use crate::emission::analysis::sites::{Site, Sites};
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::measured_lamp::MeasuredLamp;
use crate::emission::exemplar::roles::Role;
use crate::emission::lattice::cells;
use crate::emission::lattice::law::Law;
use crate::rng::Rng;
use glam::{DMat2, DVec2};

/// A site gets a lamp in every cell if its occupancy ([`Site::occupancy`]) is at least this. The occupancy is the share
/// of visible cells, from the site's first to its last lamp, in which a lamp shines at the site. Cells are weighted by
/// photo pixels. [bench emission:perspective]
const MIN_OCCUPANCY: f64 = 0.93;
/// Something may hide the missing lamps of a site that is dark in few visible cells between its first and its last
/// lamp. If there are at most `MAX_FEW_DARK` such cells, an occupancy of `MIN_OCCUPANCY_FEW_DARK` suffices.
/// [judged on 20 photos]
const MIN_OCCUPANCY_FEW_DARK: f64 = 0.5;
const MAX_FEW_DARK: usize = 2;
/// A lamp counts as sharp if the number of its photo pixels is at least this share of the largest such number at its
/// site. [judged on 5 photos]
const MIN_SHARP_SHARE: f64 = 0.4;
/// A position belongs to a site if its distance from the site, along x and along y, is at most this share of the width
/// or height of the site's first lamp. [judged on 20 photos]
const OVERLAP: f64 = 0.5;

/// Places lamps at the sites of a lattice or row, in a texture of `size` unwarped pixels. The origin of the exemplar
/// moves to `offset`. `shown` holds the lamps that the copied patches contain.
///
/// - A site that nearly always has a lamp in the exemplar gets one in every cell, whatever `shown` has there.
/// - At any other site, the lamps of `shown` are moved exactly onto the site.
/// - Lamps of `shown` that are near no site stay where they are. If `law` has no lattice, all lamps of `shown` stay.
pub fn place(
    exemplar: &Exemplar,
    designs: &Designs,
    sites: &Sites,
    law: Law,
    shown: Vec<Instance>,
    (offset, size): (DVec2, DVec2),
    seed: u64,
) -> Vec<Instance> {
    let Some([a, b]) = law.lattice() else { return shown };
    let kept = distinct(sites);
    let centre = |component: usize| {
        designs.of(component).map_or(exemplar.components.list[component].centre, |(_, fitted)| fitted.centre)
    };
    let to_cells = DMat2::from_cols(a, b).inverse();
    let mut instances = Vec::new();
    for (n, site) in kept.iter().enumerate().filter(|(_, site)| is_always_taken(site, exemplar)) {
        let half = site.lamps[0].size / 2.0;
        let choice = sharpest(site, exemplar, designs);
        let (low, high) = (-half - site.at - offset, size + half - site.at - offset);
        for [i, j] in cells::between(to_cells, low, high) {
            let step = offset + a * i as f64 + b * j as f64;
            let at = site.at + step;
            if (at + half).cmpgt(DVec2::ZERO).all() && (at - half).cmplt(size).all() {
                let mut rng = Rng::new(seed, &[0x7369, n as u64, i as u64, j as u64]);
                let component = choice[rng.below(choice.len())];
                instances.push(Instance { component, shift: at - centre(component) });
            }
        }
    }
    // Add the lamps that the copied patches contain. Skip a lamp near a site that got a lamp in every cell above. Move
    // a lamp near any other site exactly onto the site. Leave a lamp where it is if no site is near.
    for instance in shown {
        let at = centre(instance.component) + instance.shift - offset;
        let off = |site: &&Site| sites.residual(at - site.at);
        let is_here = |site: &&Site| off(site).abs().cmple(site.lamps[0].size * OVERLAP).all();
        match kept.iter().find(|site| is_here(site)) {
            Some(site) if is_always_taken(site, exemplar) => {}
            Some(site) => instances.push(Instance { shift: instance.shift - off(site), ..instance }),
            None => instances.push(instance),
        }
    }
    instances
}

/// Finds where the pattern of lamps ends in the exemplar, for example before a wall. Returns a function that is true
/// for a position beyond the end. Only sites that get a lamp in every cell are considered, and the pattern ends where
/// the last of them ends. `None` if there is no such site, or if at least one of them continues to the border of the
/// view.
pub fn end<'a>(sites: &'a Sites, exemplar: &Exemplar) -> Option<impl Fn(DVec2) -> bool + use<'a>> {
    let filled: Vec<&Site> = sites.list.iter().filter(|site| is_always_taken(site, exemplar)).collect();
    let all_end = !filled.is_empty() && filled.iter().all(|site| site.ends());
    all_end.then_some(move |position| !filled.iter().any(|site| sites.continues(site, position)))
}

/// Whether a site gets a lamp in every cell. On a luminous ceiling, every site does: panes cover it without gaps.
fn is_always_taken(site: &Site, exemplar: &Exemplar) -> bool {
    if exemplar.is_luminous_ceiling() {
        return true;
    }
    site.occupancy() >= if site.hole_count <= MAX_FEW_DARK { MIN_OCCUPANCY_FEW_DARK } else { MIN_OCCUPANCY }
}

/// Returns the sites in descending order of the number of photo pixels that show their lamps. Leaves out each site that
/// overlaps an earlier site of this order.
fn distinct(sites: &Sites) -> Vec<&Site> {
    let mut order: Vec<&Site> = sites.list.iter().collect();
    order.sort_by(|a, b| b.shown.total_cmp(&a.shown));
    let mut kept: Vec<&Site> = Vec::new();
    for site in order {
        let is_over = |other: &&Site| {
            let max_offset = (site.lamps[0].size + other.lamps[0].size) * (OVERLAP / 2.0);
            sites.residual(site.at - other.at).abs().cmple(max_offset).all()
        };
        if !kept.iter().any(is_over) {
            kept.push(site);
        }
    }
    kept
}

/// Returns the components that may be drawn at a site: its whole lamps that are sharp in the photo. If any whole lamp
/// has a design, only lamps with a design are returned. If there is no whole lamp, returns the site's first lamp.
///
/// On a luminous ceiling, only panes of the site's main kind are returned, if any of its whole lamps has a design: a
/// larger pane would overlap its neighbours.
fn sharpest(site: &Site, exemplar: &Exemplar, designs: &Designs) -> Vec<usize> {
    let is_whole = |l: &&MeasuredLamp| exemplar.roles[l.component] == Role::Whole;
    let main =
        if exemplar.is_luminous_ceiling() { main_kind(site.lamps.iter().filter(is_whole), designs) } else { None };
    let fits = |l: &&MeasuredLamp| main.is_none() || kind(l, designs) == main;
    let whole = || site.lamps.iter().filter(is_whole).filter(fits);
    let has_design = |l: &MeasuredLamp| designs.of(l.component).is_some();
    let any_design = whole().any(has_design);
    let clear = || whole().filter(|l| !any_design || has_design(l));
    let max_weight = clear().map(|l| l.weight).fold(0.0, f64::max);
    let sharp: Vec<usize> = clear().filter(|l| l.weight >= MIN_SHARP_SHARE * max_weight).map(|l| l.component).collect();
    if sharp.is_empty() { vec![site.lamps[0].component] } else { sharp }
}

/// The index of a lamp's design in [`Designs::kinds`]; `None` if the lamp has no design.
fn kind(lamp: &MeasuredLamp, designs: &Designs) -> Option<usize> {
    designs.of(lamp.component).map(|(_, fitted)| fitted.kind)
}

/// The index of the design that most photo pixels of the lamps show; `None` if none of the lamps has a design.
fn main_kind<'a>(lamps: impl Iterator<Item = &'a MeasuredLamp>, designs: &Designs) -> Option<usize> {
    let mut shown = vec![0.0; designs.kinds.len()];
    lamps.filter_map(|lamp| Some((kind(lamp, designs)?, lamp.weight))).for_each(|(kind, weight)| shown[kind] += weight);
    let main = (0..shown.len()).max_by(|a, b| shown[*a].total_cmp(&shown[*b]))?;
    (shown[main] > 0.0).then_some(main)
}
