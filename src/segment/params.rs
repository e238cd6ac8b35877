//! The settings of a segmentation.

use crate::error::{Result, check_range};
use crate::features::CHANNELS;

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Samples drawn from the strokes of each class, in `[1, 1e6]`.
    pub samples_per_class: usize,
    /// Which feature channels to use; bit `i` is channel `i`. 0 leaves the choice open: with [`CHANNELS`] channels, the
    /// subset in [`SUBSETS`] that does best on held-out strokes is used; with any other number, all channels are used.
    pub channels: u32,
    /// Strength of the prior that keeps weights small, relative to the data, in `[1e-9, 1e3]`.
    pub ridge: f64,
    pub seed: u64,
    /// Half-width of the windows of the edge-aware refinement, in pixels, in `[0, 1024]`; 0: no refinement. The first
    /// three channels of the features guide it.
    pub refine_radius: usize,
    /// Differences of the guide below which neighbours belong to one surface, in the guide's units (for colour those of
    /// CIELAB), in `[1e-3, 1e6]`.
    pub refine_tolerance: f64,
    /// What the positive strokes lie on.
    pub subject: Subject,
}

/// What is segmented: "stuff", which has a look but no shape, or "things", which have both (Kirillov et al. 2019,
/// "Panoptic Segmentation").
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Subject {
    /// Lamps if a region is given and the features have [`CHANNELS`] channels, else a surface.
    #[default]
    Auto,
    /// A surface: every pixel is judged by its features, and must lie on the face of the room that the strokes lie on.
    Surface,
    /// Lamps: compact regions with a sharp contour, brighter than their surroundings ([`super::instances`]).
    Lamps,
}

/// The subsets of channels to choose from if the caller leaves the choice open: colour; colour and position; colour and
/// normal; all. More channels are not always better: a channel that does not tell the classes apart still misleads
/// where there is no stroke.
pub const SUBSETS: [u32; 4] = [0b111, 0b111_0_111, 0b111_000_0_111, (1 << CHANNELS) - 1];

impl Default for Params {
    fn default() -> Self {
        Self {
            samples_per_class: 1000,
            channels: 0,
            ridge: 1e-3,
            seed: 1,
            refine_radius: 0,
            refine_tolerance: 8.0,
            subject: Subject::Auto,
        }
    }
}

impl Params {
    /// Checks that every setting is in its range.
    pub fn check(&self) -> Result<()> {
        check_range("samples_per_class", self.samples_per_class, 1, 1_000_000)?;
        check_range("ridge", self.ridge, 1e-9, 1e3)?;
        check_range("refine_radius", self.refine_radius, 0, 1024)?;
        check_range("refine_tolerance", self.refine_tolerance, 1e-3, 1e6)?;
        Ok(())
    }

    /// For the second phase: colour only.
    pub fn for_lights() -> Self {
        Self { channels: 0b111, ..Self::default() }
    }
}
