//! Fragments: pieces of light that broke off a lamp, as between the blades of a louvre, and specks.
//!
//! A lamp is one of a kind. A piece that covers far fewer photo pixels than a lamp of the smallest kind would in its
//! place, and that lies close to another light or has no like, is no lamp: it tells where light is, and is not shown.

use super::components::{Component, Components};
use super::evidence::Evidence;
use super::foreshortening::LocalMap;
use super::roles::Role;
use crate::geometry::Homography;
use glam::DVec2;

/// Share of all lamps' photo pixels that a kind of lamps has at least. [judged on 20 photos]
const MIN_KIND: f64 = 0.15;
/// Share of the photo pixels of a lamp below which a piece is a fragment. [judged on 20 photos]
const MAX_FRAGMENT: f64 = 0.2;
/// Distance to the nearest light up to which a piece broke off, in longer sides of a lamp. [judged on 20 photos]
const CLOSE: f64 = 0.35;
/// A kind of so many lamps stands for itself, however small. [judged on 20 photos]
const MANY: usize = 3;

/// Gives fragments among the whole lamps the role of lamps that are cut.
pub fn demote(components: &Components, roles: &mut [Role], photo_area: &[f64], to_photo: Homography) {
    let mut lamps: Vec<Evidence> = Vec::new();
    for (k, component) in components.list.iter().enumerate().filter(|(k, _)| roles[*k].is_whole()) {
        lamps.push(Evidence::new(k, component, photo_area[k], Some(to_photo)));
    }
    lamps.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let total: f64 = lamps.iter().map(|l| l.weight).sum();

    // Kinds of lamps that are a good part of the light.
    let kinds = Evidence::kinds(&lamps);
    let is_major = |kind: &&Vec<Evidence>| kind.iter().map(|l| l.weight).sum::<f64>() >= MIN_KIND * total;
    let smallest = kinds.iter().filter(is_major).map(|kind| kind[0]).min_by(|a, b| {
        let area = |l: &Evidence| l.size.element_product();
        area(a).total_cmp(&area(b))
    });
    let Some(lamp) = smallest else { return };

    for kind in kinds.iter().filter(|kind| !is_major(kind)) {
        for piece in kind {
            let expected = lamp.size.element_product() * LocalMap::new(Some(to_photo), piece.centre).area();
            let is_small = piece.weight < MAX_FRAGMENT * expected;
            let reach = CLOSE * lamp.size.max_element();
            if is_small && (kind.len() < MANY || has_neighbour(components, piece.component, reach)) {
                roles[piece.component] = Role::Cut;
            }
        }
    }
}

/// Whether the box of another component comes this near.
fn has_neighbour(components: &Components, own: usize, reach: f64) -> bool {
    let corners = |c: &Component| {
        let point = |p: [usize; 2]| DVec2::new(p[0] as f64, p[1] as f64);
        (point(c.min), point(c.max) + 1.0)
    };
    let (low, high) = corners(&components.list[own]);
    components.list.iter().enumerate().filter(|(k, _)| *k != own).any(|(_, other)| {
        let (from, to) = corners(other);
        (from - high).max(low - to).max(DVec2::ZERO).length() <= reach
    })
}
