//! Fragments: specks, and pieces of light that broke off a lamp, for example between the blades of a louvre.
//!
//! A lamp usually has others of its kind. A piece is a fragment, not a lamp, if it covers far fewer photo pixels than a
//! lamp of the smallest kind would cover in its place, and either lies close to another light or has few of its like. A
//! fragment tells where light is, but is not shown.

use super::components::{Component, Components};
use super::evidence::Evidence;
use super::foreshortening::LocalMap;
use super::roles::Role;
use crate::geometry::Homography;
use glam::DVec2;

/// Smallest share of all lamps' photo pixels that makes a group of alike pieces a kind of lamps. [judged on 20 photos]
const MIN_KIND: f64 = 0.15;
/// Share of the photo pixels of a lamp below which a piece is a fragment. [judged on 20 photos]
const MAX_FRAGMENT: f64 = 0.2;
/// Largest distance from a piece to the light that it broke off, as a multiple of the longer side of a lamp.
/// [judged on 20 photos]
const CLOSE: f64 = 0.35;
/// A group of this many alike pieces or more is a kind of lamps, however small, unless the pieces lie close to other
/// lights. [judged on 20 photos]
const MANY: usize = 3;

/// Gives the fragments among the whole lamps the role [`Role::Cut`].
pub fn demote(components: &Components, roles: &mut [Role], photo_area: &[f64], to_photo: Homography) {
    let mut lamps: Vec<Evidence> = Vec::new();
    for (k, component) in components.list.iter().enumerate().filter(|(k, _)| roles[*k].is_whole()) {
        lamps.push(Evidence::new(k, component, photo_area[k], Some(to_photo)));
    }
    lamps.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let total: f64 = lamps.iter().map(|l| l.weight).sum();

    // Major kinds: those that make up a good part of the light.
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

/// Whether the bounding box of another component lies within `reach`.
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
