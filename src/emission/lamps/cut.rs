//! Completes the lamps that the border of the photo cuts.
//!
//! The texture shows a cut lamp only if the photo shows no whole lamp like it. The border of the unwarped photo may run
//! obliquely. It then cuts a rectangle to a triangle or a wedge, and few lamps have such shapes. So a cut lamp is drawn
//! as the bounding rectangle of its visible part, unless the photo shows that this rectangle is partly dark.

use super::design::{Design, Shape};
use super::designs::{Designs, Fitted};
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::components::Component;
use crate::emission::exemplar::foreshortening::LocalMap;
use crate::emission::exemplar::roles::Role;
use glam::DVec2;

/// A cut lamp is drawn as a rectangle only if at least this share of the rectangle's pixels is lit. Pixels that the
/// photo does not show do not count. The limit excludes a half or a quarter of a disc, which covers only π/4 = 0.79 of
/// its bounding rectangle. [convention]
const MIN_LIT: f64 = 0.92;

/// Adds to `designs` a design for each lamp that the border cuts, unless the visible part shows that it is no
/// rectangle.
pub fn complete(mut designs: Designs, exemplar: &Exemplar) -> Designs {
    for component in (0..exemplar.roles.len()).filter(|&k| exemplar.roles[k] == Role::Partial) {
        if let Some((design, fitted)) = rectangle(exemplar, component, designs.kinds.len()) {
            designs.kinds.push(design);
            designs.lamps[component] = Some(fitted);
        }
    }
    designs
}

/// The design of a lamp that the border cuts, and the lamp's fit to it. No other lamp has this design, whose index is
/// `kind`. `None` if the visible part shows that the lamp is not an axis-aligned rectangle.
fn rectangle(exemplar: &Exemplar, component: usize, kind: usize) -> Option<(Design, Fitted)> {
    let lamp = &exemplar.components.list[component];
    if (lamp.area as f64) < MIN_LIT * shown_in_box(exemplar, lamp) as f64 {
        return None;
    }
    let (low, high) = lamp.bounds();
    let (centre, size) = ((low + high) / 2.0, high - low);
    let photo_pixel = LocalMap::new(exemplar.to_photo, lamp.centre).photo_pixel();
    Some((
        Design { shape: Shape::Rectangle, size, axis: DVec2::X, hole: DVec2::ZERO },
        Fitted { kind, centre, size, photo_pixel },
    ))
}

/// Number of pixels in the lamp's bounding box that the photo shows.
fn shown_in_box(exemplar: &Exemplar, lamp: &Component) -> usize {
    let row = |y: usize| &exemplar.shown[y * exemplar.width..][lamp.min[0]..=lamp.max[0]];
    (lamp.min[1]..=lamp.max[1]).map(|y| row(y).iter().filter(|shown| **shown).count()).sum()
}
