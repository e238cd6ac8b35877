//! The result of a run.

use super::agreement::statistics::Statistics;
use super::lamps::luminaire::Luminaire;
use super::lattice::continuation::Continuation;
use super::reading::Choice;
use crate::image::Image;

#[derive(Clone, Debug)]
pub struct Emission {
    /// Linear RGB, relative to the photo's white; 0 where there is no lamp.
    pub texture: Image,
    /// Light mask of the texture, 0 or 1.
    pub mask: Image,
    /// Metadata of the exemplar at working size: confidence, and signed x and y distance to the nearest light. Empty
    /// where the caller supplied the texture.
    pub exemplar_metadata: Image,
    /// The exemplar's metadata as the patches of the texture show them, at working size.
    pub metadata: Image,
    pub luminaires: Vec<Luminaire>,
    /// How the texture goes on beyond the exemplar.
    pub continuation: Continuation,
    /// Correlation of the lights with themselves after a shift by a period, in `[0, 1]`: the lower value of both
    /// periods; 0 where no period was found.
    pub regularity: f64,
    /// How well the law of the lights predicts the lamps of the photo, and the best other law.
    pub choice: Choice,
    /// The statistics expected from the exemplars, converted to texels, and those of the texture.
    pub statistics: [Statistics; 2],
    /// Largest relative difference between the two `statistics`; luminance is not compared. The fewer whole lamps the
    /// exemplar shows (`exemplar_lamps`), the less the difference says: the lamps that the border cuts are then a large
    /// part. Without whole lamps only the lit share is compared.
    pub error: f64,
    /// Estimate of how far the exemplar's own statistics are off, because it shows only a part of its ceiling: the root
    /// mean square difference between parts of the texture as large as the exemplar and the whole texture. No method
    /// can be expected to have a smaller `error`. 0 where the texture shows nothing that the exemplar does not, and for
    /// blended exemplars.
    pub sampling_error: f64,
    /// Number of lamps that the exemplars show whole.
    pub exemplar_lamps: usize,
}
