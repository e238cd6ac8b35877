//! The settings of a segmentation.

use crate::error::{Result, check_range};
use crate::features::CHANNELS;

/// The settings of a segmentation. The tags state the origin of the defaults.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Maximum number of sample pixels drawn from the strokes of each class, in `[1, 1e6]`; by default 1000.
    /// \[paper §4.2\]
    pub samples_per_class: usize,
    /// Feature channels to use; bit `i` stands for channel `i`. 0 leaves the choice open: if there are [`CHANNELS`]
    /// channels, cross-validation chooses one of [`SUBSETS`]; with any other number, all channels are used.
    pub channels: u32,
    /// Strength of the ridge penalty, in `[1e-9, 1e3]`. The classifier's weights w minimise the mean log loss of the
    /// samples plus `ridge / 2 |w|²`. With n samples, this is a normal prior of the weights with the variance
    /// `1 / (n ridge)`. The default, 1e-3, gives a variance of 1 with 1000 samples, and of 0.5 with 1000 per class. The
    /// default of LIBLINEAR, `C = 1`, is a variance of 1. \[convention: LIBLINEAR\]
    pub ridge: f64,
    pub seed: u64,
    /// Half-width of the windows of the edge-aware filter, in pixels, in `[0, 1024]`; 0 turns the filter off. The
    /// filter's guide image is the first three channels of the features.
    pub refine_radius: usize,
    /// Differences in the guide image below this value are smoothed over; larger ones count as edges. In units of the
    /// guide (CIELAB units for colour), in `[1e-3, 1e6]`. \[bench segment\]
    pub refine_tolerance: f64,
    /// The kind of object that the positive strokes mark.
    pub subject: Subject,
}

/// The kind of object that is segmented: "stuff", which has an appearance but no shape (a surface), or "things", which
/// have both (lamps). The terms come from Kirillov et al. 2019, "Panoptic Segmentation".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Subject {
    /// Lamps if a region is given and the features have [`CHANNELS`] channels, else a surface.
    #[default]
    Auto,
    /// A surface: every pixel is classified by its features. The mask is then restricted to the face of the room that
    /// the positive strokes lie on.
    Surface,
    /// Lamps: compact regions with a sharp contour, brighter than their surroundings ([`super::instances`]).
    Lamps,
}

/// The subsets of channels to choose from if the caller leaves the choice open: colour; colour and position; colour
/// and normal; all channels. Using all channels is not always best: a channel that does not separate the classes adds
/// errors far from the strokes.
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

    /// Settings of the second phase, which finds the lights: colour channels only.
    pub fn for_lights() -> Self {
        Self { channels: 0b111, ..Self::default() }
    }
}
