//! Finds the solid bodies that contain the start of a path: a camera or a light meter.

use super::medium::{self, Media};
use super::world::World;
use crate::accel::Ray;
use glam::Vec3;

/// A direction that is unlikely to run along an edge of a body. [convention]
const ASIDE: Vec3 = Vec3::new(0.3741, 0.8512, 0.3682);

/// Returns the media around a point, given in world coordinates. A ray from the point leaves the bodies that contain
/// the point, and no others, without having entered them before.
pub fn media_at(world: &World, position: Vec3) -> Media {
    if world.media().len() == 1 {
        return Media::NONE;
    }
    let mut surfaces = Vec::new();
    world.accel().occluded(&Ray::new(position, ASIDE), |hit| {
        let facet = world.facet(hit.triangle);
        let medium = world.compiled_material(facet).medium;
        if medium != medium::AIR {
            surfaces.push((hit.t, medium, facet.normal.dot(ASIDE) > 0.0));
        }
        false
    });
    surfaces.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    // Collect the bodies from the inside outwards, then enter them from the outside inwards.
    let (mut entered, mut around) = (Vec::new(), Vec::new());
    for (_, medium, leaves) in surfaces {
        match entered.iter().position(|&other| other == medium) {
            _ if !leaves => entered.push(medium),
            Some(place) => drop(entered.swap_remove(place)),
            None => around.push(medium),
        }
    }
    around.into_iter().rev().fold(Media::NONE, Media::entered)
}
