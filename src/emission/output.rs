//! The result of emission: the texture, its lamps and its statistics.

use super::agreement::statistics::Statistics;
use super::analysis::Choice;
use super::lamps::luminaire::Luminaire;
use super::lattice::law::Law;
use crate::image::Image;

#[derive(Clone, Debug)]
pub struct Emission {
    /// Linear RGB relative to the photo's white; 0 outside lamps.
    pub texture: Image,
    /// Light mask of the texture, 0 or 1.
    pub mask: Image,
    /// Metadata of the exemplar at working size: confidence, and signed x and y distance to the nearest light. Empty
    /// where the caller supplied the texture.
    pub exemplar_metadata: Image,
    /// Metadata of the texture, copied from `exemplar_metadata` patch by patch, at working size (the reduced size of
    /// the synthesis).
    pub metadata: Image,
    pub luminaires: Vec<Luminaire>,
    /// How the pattern continues beyond the exemplar: on a lattice, in a row, by repetition or without a lattice.
    pub law: Law,
    /// Autocorrelation of the lights at a shift by one period, in `[0, 1]`: the lower value of the two periods; 0 if
    /// no period was found.
    pub regularity: f64,
    /// How well `law` predicts the lamps of the photo, and the best alternative.
    pub choice: Choice,
    /// Two sets of statistics in texels: those expected from the exemplars, and those of the texture.
    pub statistics: [Statistics; 2],
    /// Largest relative difference between the two `statistics`, without luminance. It means less the fewer whole
    /// lamps the exemplar shows (`exemplar_lamps`), because cut lamps at the border then have more influence. Without
    /// whole lamps, only the lit share is compared.
    pub error: f64,
    /// Sampling error of the exemplar's statistics, which arises because the exemplar shows only a part of its
    /// ceiling. No method can be expected to have a smaller `error`. It is estimated as the root mean square
    /// difference between the whole texture and parts of the texture as large as the exemplar. 0 for blended
    /// exemplars, for a copy or a repetition of the exemplar, and for a texture too small to hold several parts.
    pub sampling_error: f64,
    /// Number of lamps that the photos of the exemplars show completely.
    pub exemplar_lamps: usize,
}
