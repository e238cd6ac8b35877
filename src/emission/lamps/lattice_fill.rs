//! Places lamps at the exact sites of a lattice, and draws each from a lamp that is sharp in the photo. A site is a
//! position within the lattice cell at which lamps lie.
//!
//! Patches repeat the errors of the photo: they lack distant lamps that the mask missed, and perspective has displaced
//! others. The mean position of a site's lamps, weighted by their photo pixels, is more exact. A site that nearly
//! always has a lamp gets one in every cell. At other sites the patches decide whether there is a lamp, and the lamp
//! moves to the exact site.

use super::design::Designs;
use super::instance::Instance;
use crate::emission::analysis::sites::{Site, Sites};
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::measured_lamp::MeasuredLamp;
use crate::emission::exemplar::roles::Role;
use crate::emission::lattice::cells;
use crate::emission::lattice::law::Law;
use crate::rng::Rng;
use glam::{DMat2, DVec2};

/// A site (a position in the lattice cell) gets a lamp in every cell if lamps shine there in at least this share of
/// the visible cells between its first and its last lamp, weighted by photo pixels. [bench emission:perspective]
const MIN_OCCUPANCY: f64 = 0.93;
/// If a site is dark in at most `MAX_FEW_DARK` of these cells, the share `MIN_OCCUPANCY_FEW_DARK` suffices instead of
/// `MIN_OCCUPANCY`, because something may hide the missing lamps. [judged on 20 photos]
const MIN_OCCUPANCY_FEW_DARK: f64 = 0.5;
const MAX_FEW_DARK: usize = 2;
/// A lamp counts as sharp if it has at least this share of the photo pixels of its site's largest lamp.
/// [judged on 5 photos]
const MIN_SHARP_SHARE: f64 = 0.4;
/// Two positions count as one site if their distance along each axis is at most this share of a lamp's side.
/// [judged on 20 photos]
const OVERLAP: f64 = 0.5;

/// Places lamps at the sites of a lattice or row, in a texture of `size` unwarped pixels whose lattice begins at
/// `offset`. A site that nearly always has a lamp gets one in every cell. `shown` holds the lamps that the copied
/// patches contain: at such a site they are dropped, near another site they move exactly onto it, and elsewhere they
/// stay unmoved.
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
    // Add the lamps that the copied patches contain. A site is a position that repeats in every cell. Skip a lamp near
    // a site that got a lamp in every cell above. Move a lamp near one of the other sites exactly onto it. Leave a
    // lamp near no site where it is.
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

/// Finds where the pattern ends in the exemplar. Returns a function that is true for a position beyond the end. Only
/// sites that get a lamp in every cell count, and the pattern ends where all of them have ended. `None` if there is no
/// such site, or if one of them does not end in view.
pub fn end<'a>(sites: &'a Sites, exemplar: &Exemplar) -> Option<impl Fn(DVec2) -> bool + use<'a>> {
    let filled: Vec<&Site> = sites.list.iter().filter(|site| is_always_taken(site, exemplar)).collect();
    let all_end = !filled.is_empty() && filled.iter().all(|site| site.ends());
    all_end.then(|| move |position| !filled.iter().any(|site| sites.continues(site, position)))
}

/// Whether a site gets a lamp in every cell. The panes of a luminous ceiling always do.
fn is_always_taken(site: &Site, exemplar: &Exemplar) -> bool {
    if exemplar.is_luminous_ceiling() {
        return true;
    }
    site.occupancy() >= if site.hole_count <= MAX_FEW_DARK { MIN_OCCUPANCY_FEW_DARK } else { MIN_OCCUPANCY }
}

/// Returns the sites in descending order of the number of photo pixels of their lamps. Leaves out each site that
/// overlaps an earlier one in this order.
fn distinct(sites: &Sites) -> Vec<&Site> {
    let mut order: Vec<&Site> = sites.list.iter().collect();
    order.sort_by(|a, b| b.shown.total_cmp(&a.shown));
    let mut kept: Vec<&Site> = Vec::new();
    for site in order {
        let is_over = |other: &&Site| {
            let reach = (site.lamps[0].size + other.lamps[0].size) * (OVERLAP / 2.0);
            sites.residual(site.at - other.at).abs().cmple(reach).all()
        };
        if !kept.iter().any(is_over) {
            kept.push(site);
        }
    }
    kept
}

/// Returns the components that may be drawn at a site: its whole lamps that are sharp in the photo. If any whole lamp
/// has a design, only lamps with a design are returned. If there is no whole lamp, returns the site's first lamp.
fn sharpest(site: &Site, exemplar: &Exemplar, designs: &Designs) -> Vec<usize> {
    let whole = || site.lamps.iter().filter(|l| exemplar.roles[l.component] == Role::Whole);
    let has_design = |l: &MeasuredLamp| designs.of(l.component).is_some();
    let any_design = whole().any(has_design);
    let clear = || whole().filter(|l| !any_design || has_design(l));
    let most = clear().map(|l| l.weight).fold(0.0, f64::max);
    let sharp: Vec<usize> = clear().filter(|l| l.weight >= MIN_SHARP_SHARE * most).map(|l| l.component).collect();
    if sharp.is_empty() { vec![site.lamps[0].component] } else { sharp }
}
