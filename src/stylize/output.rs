//! The results of a stylisation.

use super::guide_record::GuideRecord;
use super::report::{LevelReport, Report};
use crate::image::Image;
use crate::patch::Field;

#[derive(Clone, Debug)]
pub struct Output {
    /// The stylised target, linear colour.
    pub image: Image,
    /// The match of each target patch: the exemplar patch that it shows.
    pub field: Field,
    /// Record of the guides for the next frame of a sequence: see [`Input::guide_record`](super::Input::guide_record).
    pub guide_record: GuideRecord,
    pub report: Report,
}

/// An intermediate result, published after each level except the last, coarsest first.
pub struct IntermediateResult<'a> {
    /// The current picture in linear colour, at the size of the level.
    pub picture: Image,
    /// Number of halvings (rounding down) from the target's size to the picture's.
    pub halvings: usize,
    /// Reports of the finished levels.
    pub levels: &'a [LevelReport],
}

/// Callback that receives intermediate results.
pub type Publish<'a> = &'a (dyn Fn(IntermediateResult) + Sync);
