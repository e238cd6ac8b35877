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
    /// Metadata of the exemplar at working size (the reduced size of the synthesis): confidence, and signed x and y
    /// distance to the nearest light. Empty if the caller supplied the texture.
    pub exemplar_metadata: Image,
    /// Metadata of the texture at working size, copied from `exemplar_metadata` patch by patch.
    pub metadata: Image,
    pub luminaires: Vec<Luminaire>,
    /// How the pattern continues beyond the exemplar: on a lattice, in a row, by repetition or without a lattice.
    pub law: Law,
    /// Autocorrelation of the lights at a shift by one period, in `[0, 1]`: the lower value of the two periods. 0 if
    /// there is no period, or if the periods were found from the distances between lamps.
    pub regularity: f64,
    /// How well `law` predicts the lamps of the photo, and the best alternative.
    pub choice: Choice,
    /// Two sets of statistics, with lengths in texels: expected from the exemplars, and measured in the texture.
    pub statistics: [Statistics; 2],
    /// Largest relative difference between the two `statistics`, without luminance. It is less reliable if the exemplar
    /// shows few whole lamps (`exemplar_lamps`), because cut lamps at the border then have more influence. Without
    /// whole lamps, only the lit share is compared.
    pub error: f64,
    /// The error of the first texture, made by the law that the lamps suggest, if other laws were tried because of this
    /// error ([`super::other_laws`]). `None` if no other law was tried.
    pub first_error: Option<f64>,
    /// Sampling error of the exemplar's statistics, which arises because the exemplar shows only a part of its
    /// ceiling. No method can be expected to have a smaller `error`. The estimate is the root mean square relative
    /// difference between the statistics of the texture and of parts of it as large as the exemplar. 0 for blended
    /// exemplars, for a copy or a repetition of the exemplar, and for a texture too small to hold several parts.
    pub sampling_error: f64,
    /// Number of lamps that the photos of the exemplars show completely. If the caller supplied the texture: number of
    /// its lamps that do not touch the border.
    pub exemplar_lamps: usize,
}
