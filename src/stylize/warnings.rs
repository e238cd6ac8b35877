//! Warnings about the exemplar, about light that it lacks, and about the motion of a sequence.

use super::exemplar::Doubts;
use super::lack::Lack;
use super::report::Report;
use crate::image::Comparison;
use crate::warning::{Code, Warning, percent};
use glam::DVec2;

/// A warning is given if the motion of more than this share of the compared pixels leads to another surface in the
/// previous frame. With a correct motion, the share is nearly 0. Errors of the motion of up to one pixel do not count.
/// [judged on 1 scene]
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
    Some(Warning::above(Code::MotionDisagrees, share, MAX_DISAGREEMENT, message, advice)?.at(centre(place)))
}

/// A warning is given if the exemplar lacks the light of more than this share of the pixels to paint.
/// \[bench stylit:autocomplete\]
pub const MAX_LACK: f64 = 0.01;
/// A warning is given if the share [`Doubts::ambiguous`] of blocks whose light has two paints exceeds this.
/// \[bench stylit:doubts\]
pub const MAX_AMBIGUOUS: f64 = 0.18;
/// A warning is given if a block of the artwork differs from nearly all other blocks with similar guides by more than
/// this, in grains ([`Doubts::blemish`]). \[bench stylit:doubts\]
pub const MAX_BLEMISH: f64 = 13.0;

impl Report {
    /// Returns warnings about defects of the exemplar, and about light of the target that the exemplar lacks. In a
    /// half-painted picture, the exemplar is the painted part. Positions are in pixels of the full size, even for a
    /// preview.
    pub fn warnings(&self, is_half_painted: bool) -> Vec<Warning> {
        let light = light_not_painted(&self.lack, is_half_painted);
        let all = light.into_iter().chain(ambiguous_paint(&self.doubts)).chain(blemish(&self.doubts));
        let pixel = f64::from(1 << self.halvings);
        all.map(|warning| Warning { place: warning.place.map(|place| place * pixel), ..warning }).collect()
    }
}

fn light_not_painted(lack: &Lack, is_half_painted: bool) -> Option<Warning> {
    let message = || {
        let (share, exemplar) = (percent(lack.share), if is_half_painted { "painted part" } else { "exemplar" });
        format!("{share} of the pixels to paint show light that the {exemplar} lacks, so their paint is a guess")
    };
    let advice = if is_half_painted {
        "paint a piece of this place yourself; LUXFER_STYLIZE_IMAGE_GUIDE_ERROR shows all such places"
    } else {
        "use an exemplar that shows such light, or raise match_appearance; LUXFER_STYLIZE_IMAGE_GUIDE_ERROR shows all \
         such places"
    };
    Some(Warning::above(Code::LightNotPainted, lack.share, MAX_LACK, message, advice)?.at(centre(lack.place)))
}

fn ambiguous_paint(doubts: &Doubts) -> Option<Warning> {
    let message = || {
        let share = percent(doubts.ambiguous);
        format!("{share} of the exemplar has light that is painted in two ways, which the picture mixes")
    };
    let advice = "add a guide that distinguishes the two, such as materials or normals, or paint equal light alike";
    let warning = Warning::above(Code::AmbiguousPaint, doubts.ambiguous, MAX_AMBIGUOUS, message, advice)?;
    Some(warning.at(centre(doubts.ambiguous_at)))
}

fn blemish(doubts: &Doubts) -> Option<Warning> {
    let message = || {
        let grains = doubts.blemish;
        format!("a place of the artwork differs from all places with similar light by {grains:.0} times its grain")
    };
    let advice = "if it is a stain or a slip, retouch it, or exclude it by luxfer_stylize_set_source_mask";
    Some(Warning::above(Code::Blemish, doubts.blemish, MAX_BLEMISH, message, advice)?.at(centre(doubts.blemish_at)))
}

/// Returns the centre of a pixel.
fn centre(pixel: Option<[usize; 2]>) -> Option<DVec2> {
    pixel.map(|[x, y]| DVec2::new(x as f64 + 0.5, y as f64 + 0.5))
}
