//! Warnings about doubtful emissive textures.

use super::lattice::law::Law;
use super::output::Emission;
use crate::warning::{Code, Warning, percent};

/// A warning is given if [`Emission::error`], the relative difference between the statistics of texture and photo,
/// exceeds this. [judged on 38 photos]
const MAX_ERROR: f64 = 0.25;
/// If the lamps lie on no lattice and [`Emission::error`] exceeds this, a warning says so, whether or not the error
/// also exceeds `MAX_ERROR`. [judged on 38 photos]
const MAX_FREE_ERROR: f64 = 0.15;
/// [`Emission::error`] of a texture without any light, whose lit share differs from the photo's by 100 %. If the error
/// is larger, the warning says that there is no pattern. [convention]
pub(super) const UNLIT_ERROR: f64 = 1.0;
/// If the exemplars show fewer whole lamps than this, a warning says that they are too few for measuring size and
/// spacing. [convention]
const MIN_LAMPS: usize = 2;
/// A texture that repeats its exemplar as a whole counts as lacking a lattice only if the exemplars show at least this
/// number of whole lamps. Fewer lamps need no lattice. [convention]
const MIN_LATTICE_LAMPS: usize = 6;

impl Emission {
    /// Returns warnings about the texture. A texture that the caller supplied gets none.
    pub fn warnings(&self) -> Vec<Warning> {
        if self.is_given() {
            return Vec::new();
        }
        [self.uncertain(), self.few_lamps(), self.no_lattice()].into_iter().flatten().collect()
    }

    /// Whether the caller has made the texture.
    fn is_given(&self) -> bool {
        self.exemplar_metadata.data.is_empty()
    }

    fn uncertain(&self) -> Option<Warning> {
        let parts = "the lit share, the size or the spacing of its lamps";
        let difference = || format!("the texture differs from the photo by {} in {parts}", percent(self.error));
        let first_error = self.first_error.unwrap_or(self.error);
        if first_error > UNLIT_ERROR {
            let message = if self.error < first_error {
                format!(
                    "{}; it was chosen because the pattern that the lamps suggest would differ by {}, more than a texture \
                     without light does",
                    difference(),
                    percent(first_error)
                )
            } else {
                format!("{}, more than a texture without light does", difference())
            };
            let advice = "do not use the texture unless it looks like the photo: if the lamps hang or lie on several planes, \
                          the photo has no pattern to copy; otherwise paint more strokes where the masks are wrong";
            return Some(Warning::new(Code::NoPattern, first_error, UNLIT_ERROR, message, advice));
        }
        Warning::above(
            Code::PatternUncertain,
            self.error,
            MAX_ERROR,
            difference,
            "compare the texture with the unwarped photo; correct the mask of the lights, or lower max_magnification of \
             the rectification",
        )
    }

    fn few_lamps(&self) -> Option<Warning> {
        let is_copy = self.law == Law::Copy;
        let message = || {
            format!("the number of lamps that the plane shows whole is {}, too few for a pattern", self.exemplar_lamps)
        };
        let advice = "use a photo with more lamps in full view, or check that the mask of the lights keeps them apart; \
                      lamps that run through the photo, as lines of light, may be right as they are";
        let lamps = self.exemplar_lamps as f64;
        let raised = (!is_copy).then(|| Warning::below(Code::FewLamps, lamps, MIN_LAMPS as f64, message, advice));
        raised.flatten()
    }

    fn no_lattice(&self) -> Option<Warning> {
        let has_no_lattice = match self.law {
            Law::Free => true,
            Law::Whole(_) => self.exemplar_lamps >= MIN_LATTICE_LAMPS,
            _ => false,
        };
        let message =
            || format!("the lamps form no lattice, and the texture differs from the photo by {}", percent(self.error));
        let advice = "lower min_regularity of the emission if the lamps are regular";
        has_no_lattice.then(|| Warning::above(Code::NoLattice, self.error, MAX_FREE_ERROR, message, advice)).flatten()
    }
}

#[cfg(test)]
#[path = "tests/warnings.rs"]
mod tests;
