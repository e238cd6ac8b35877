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
    /// What synthesis worked with, at working size; empty where the caller gave the texture. Confidence, signed x and
    /// y distance to the nearest light.
    pub exemplar_metadata: Image,
    /// The same of its result.
    pub metadata: Image,
    pub luminaires: Vec<Luminaire>,
    /// How the texture goes on beyond the exemplar.
    pub continuation: Continuation,
    /// Correlation of the lights with themselves shifted by the lattice, the lower of both periods, in `[0, 1]`; 0
    /// where no period was found.
    pub regularity: f64,
    /// How well the law of the lights predicts the lamps of the photo, and the best other law.
    pub choice: Choice,
    /// Of the exemplar, in texels, and of the texture.
    pub statistics: [Statistics; 2],
    /// Largest relative difference between the two, their luminance aside. It weighs as much as the lamps that the
    /// exemplar shows whole, `exemplar_lamps`: of a few, what the border cuts off is a large part, and without any
    /// only light is compared.
    pub error: f64,
    /// By how much the exemplar's own statistics are off, as far as can be told: the root mean square of that
    /// difference between parts of the texture as large as the exemplar, and the whole. No method is expected to have
    /// a smaller error than that. 0 where the texture shows nothing that the exemplar does not, and of blended
    /// exemplars.
    pub sampling_error: f64,
    /// Number of lamps that the exemplars show whole.
    pub exemplar_lamps: usize,
}
