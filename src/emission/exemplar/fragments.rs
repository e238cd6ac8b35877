//! Detects fragments: specks, and pieces of light that are only parts of a lamp, for example between the blades of a
//! louvre.
//!
//! A photo usually shows several lamps of a kind. A kind is major if it has a large share of the photo pixels of all
//! lamps. A piece of light of any other kind is a fragment if two conditions hold:
//!
//! - It covers far fewer photo pixels than a lamp of the smallest major kind would cover in its place.
//! - It lies close to another light, or it covers few photo pixels and only few pieces are similar to it.
//!
//! A fragment gets the role [`Role::Cut`]: it counts as light in the statistics, but the texture does not show it.

use super::components::Components;
use super::foreshortening::LocalMap;
use super::measured_lamp::MeasuredLamp;
use super::roles::Role;
use crate::geometry::PhotoMap;
use glam::DVec2;

/// A group of similar pieces is a major kind of lamps if it has at least this share of the photo pixels of all lamps.
/// [judged on 20 photos]
const MIN_KIND_SHARE: f64 = 0.15;
/// A fragment covers less than this share of the photo pixels that a lamp of the smallest major kind would cover in its
/// place. [judged on 20 photos]
const MAX_FRAGMENT: f64 = 0.2;
/// A fragment is close to another light if their distance is at most this multiple of the longer side of a lamp of the
/// smallest major kind. [judged on 20 photos]
const MAX_GAP: f64 = 0.35;
/// A group of at least this many similar small pieces counts as a kind of lamps; only the pieces close to other lights
/// are then fragments. [judged on 20 photos]
const MIN_KIND_COUNT: usize = 3;
/// A piece of at least this many photo pixels has a clear shape. It is a fragment only if it is close to another light,
/// however few pieces are similar to it: a downlight among large panels is a lamp. [bench photos:tune]
const MAX_SPECK: f64 = 150.0;

/// Gives the fragments among the whole lamps the role [`Role::Cut`].
pub fn demote(components: &Components, roles: &mut [Role], photo_area: &[f64], to_photo: PhotoMap) {
    let mut lamps: Vec<MeasuredLamp> = Vec::new();
    for (k, component) in components.list.iter().enumerate().filter(|(k, _)| roles[*k].is_whole()) {
        lamps.push(MeasuredLamp::new(k, component, photo_area[k], Some(to_photo)));
    }
    lamps.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let total: f64 = lamps.iter().map(|l| l.weight).sum();

    // Of the major kinds (kinds with a large share of the lamps' photo pixels), find the kind with the smallest lamps.
    let kinds = MeasuredLamp::kinds(&lamps, MeasuredLamp::is_like);
    let is_major = |kind: &&Vec<MeasuredLamp>| kind.iter().map(|l| l.weight).sum::<f64>() >= MIN_KIND_SHARE * total;
    let smallest = kinds.iter().filter(is_major).map(|kind| kind[0]).min_by(|a, b| {
        let area = |l: &MeasuredLamp| l.size.element_product();
        area(a).total_cmp(&area(b))
    });
    let Some(lamp) = smallest else { return };

    for kind in kinds.iter().filter(|kind| !is_major(kind)) {
        for piece in kind {
            let expected = lamp.size.element_product() * LocalMap::new(Some(to_photo), piece.centre).area();
            let is_small = piece.weight < MAX_FRAGMENT * expected;
            let max_distance = MAX_GAP * lamp.size.max_element();
            let is_rare = kind.len() < MIN_KIND_COUNT && piece.weight < MAX_SPECK;
            if is_small && (is_rare || has_neighbour(components, piece.component, max_distance)) {
                roles[piece.component] = Role::Cut;
            }
        }
    }
}

/// Whether another component's bounding box lies within `max_distance` of the bounding box of component `own`.
fn has_neighbour(components: &Components, own: usize, max_distance: f64) -> bool {
    let (low, high) = components.list[own].bounds();
    components.list.iter().enumerate().filter(|(k, _)| *k != own).any(|(_, other)| {
        let (from, to) = other.bounds();
        (from - high).max(low - to).max(DVec2::ZERO).length() <= max_distance
    })
}
