//! Lamps at the sites of a lattice: each at its exact place, shown as the photo shows it best.
//!
//! Patches keep the disorder of the photo: lamps that the mask missed far away, and places that perspective moved. The
//! sites of the lattice, weighed by photo pixels, tell where lamps belong. A site that is nearly always taken has a
//! lamp in every cell; at others the patches decide, and the lamp moves to its place.

use super::design::Designs;
use super::instance::Instance;
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::roles::Role;
use crate::emission::lattice::cells;
use crate::emission::lattice::continuation::Continuation;
use crate::emission::reading::sites::{Site, Sites};
use crate::rng::Rng;
use glam::{DMat2, DVec2};

/// Share of its places in view that shine, by photo pixels, from which a site has a lamp in every cell. [bench
/// emission:perspective]
const ALWAYS: f64 = 0.93;
/// The same of a site with no more than so many dark places: something may stand before these. [judged on 20 photos]
const MOSTLY: f64 = 0.5;
const FEW_DARK: usize = 2;
/// A lamp is shown sharply if it covers this share of the photo pixels that the largest of its site does. [judged on 5
/// photos]
const SHARP: f64 = 0.4;
/// Share of a lamp by which two sites may overlap before they are one. [judged on 20 photos]
const OVERLAP: f64 = 0.5;

/// Lamps where the sites of a law have them, in a texture of `size` unwarped pixels whose lattice begins at `offset`;
/// of the lamps that patches show those that belong to no such site stay.
pub fn place(
    exemplar: &Exemplar,
    designs: &Designs,
    sites: &Sites,
    law: Continuation,
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
        let choice = sharpest(site, exemplar);
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
    // Lamps that patches show elsewhere, each at its place.
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

/// Whether a site has a lamp in every cell: panes go on over all of a luminous ceiling.
fn is_always_taken(site: &Site, exemplar: &Exemplar) -> bool {
    if exemplar.is_luminous_ceiling() {
        return true;
    }
    site.occupancy() >= if site.dark <= FEW_DARK { MOSTLY } else { ALWAYS }
}

/// The sites without those that lie over a better one, the best first.
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

/// The lamps of a site that the photo shows sharply and as a whole.
fn sharpest(site: &Site, exemplar: &Exemplar) -> Vec<usize> {
    let clear = || site.lamps.iter().filter(|l| exemplar.roles[l.component] == Role::Whole);
    let most = clear().map(|l| l.weight).fold(0.0, f64::max);
    let sharp: Vec<usize> = clear().filter(|l| l.weight >= SHARP * most).map(|l| l.component).collect();
    if sharp.is_empty() { vec![site.lamps[0].component] } else { sharp }
}
