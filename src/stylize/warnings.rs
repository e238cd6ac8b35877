//! Warnings about the motion of a sequence.

use crate::image::Comparison;
use crate::warning::{Code, Warning, percent};
use glam::DVec2;

/// Maximum share of the pixels at whose earlier place the previous frame may show another surface. A correct motion
/// has next to none, apart from errors of a pixel, which do not count. [judged on 1 scene]
pub const MAX_DISAGREEMENT: f64 = 0.001;

/// Warns if the motion disagrees with the guides: if it leads too many pixels to another surface.
pub fn motion_disagrees(comparison: Comparison) -> Option<Warning> {
    let Comparison { compared, wrong, place } = comparison;
    let share = wrong as f64 / compared.max(1) as f64;
    let message = || {
        let share = percent(share);
        format!("the motion contradicts the guides on {share} of its pixels, which showed another surface before")
    };
    let advice = "give the offset from this frame to the previous one, x right and y down, in pixels, for moving \
                  objects too: luxfer_guides_get_motion computes it";
    let place = place.map(|[x, y]| DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
    Some(Warning::above(Code::MotionDisagrees, share, MAX_DISAGREEMENT, message, advice)?.at(place))
}
