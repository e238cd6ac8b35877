//! The CIE standard general sky (ISO 15469:2004, CIE S 011:2003): 15 types of relative luminance, and the traditional
//! overcast sky of Moon and Spencer (1942), which the standard keeps as its 16th.

use super::shape::LuminanceShape;
use crate::error::{Error, Result};
use crate::maths;
use std::f64::consts::FRAC_PI_2;

/// The number of the traditional overcast sky, (1 + 2 sin(altitude)) / 3 of the zenith's luminance.
pub const TRADITIONAL_OVERCAST: u32 = 16;

/// Parameters a and b of the gradations I to VI. [paper: ISO 15469:2004, table 1]
const GRADATIONS: [[f64; 2]; 6] = [[4.0, -0.7], [1.1, -0.8], [0.0, -1.0], [-1.0, -0.55], [-1.0, -0.32], [-1.0, -0.15]];
/// Parameters c, d and e of the indicatrices 1 to 6. [paper: ISO 15469:2004, table 1]
const INDICATRICES: [[f64; 3]; 6] =
    [[0.0, -1.0, 0.0], [2.0, -1.5, 0.15], [5.0, -2.5, 0.3], [10.0, -3.0, 0.45], [16.0, -3.0, 0.3], [24.0, -2.8, 0.15]];
/// Gradation and indicatrix of each type, counted from 1.
const TYPES: [[usize; 2]; 15] = [
    [1, 1],
    [1, 2],
    [2, 1],
    [2, 2],
    [3, 1],
    [3, 2],
    [3, 3],
    [3, 4],
    [4, 2],
    [4, 3],
    [4, 4],
    [5, 4],
    [5, 5],
    [6, 5],
    [6, 6],
];

/// A standard sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StandardSky {
    General(LuminanceShape),
    TraditionalOvercast,
}

impl StandardSky {
    /// Returns a sky by its number: 1 to 15, or [`TRADITIONAL_OVERCAST`].
    ///
    /// # Errors
    /// Another number.
    pub fn new(number: u32) -> Result<Self> {
        if number == TRADITIONAL_OVERCAST {
            return Ok(Self::TraditionalOvercast);
        }
        let index = (number as usize).checked_sub(1).and_then(|index| TYPES.get(index));
        let Some(&[gradation, indicatrix]) = index else {
            return Err(Error::argument(format!(
                "cie_type is {number}; it must lie in [1, 15], or be {TRADITIONAL_OVERCAST} for the traditional \
                 overcast sky"
            )));
        };
        let ([a, b], [c, d, e]) = (GRADATIONS[gradation - 1], INDICATRICES[indicatrix - 1]);
        Ok(Self::General(LuminanceShape { a, b, c, d, e, offset: maths::exp(d * FRAC_PI_2) }))
    }

    /// Returns the relative luminance for the cosines of the angles from the zenith and from the sun.
    pub fn luminance(&self, cos_zenith: f64, cos_sun: f64) -> f64 {
        match self {
            Self::General(shape) => shape.luminance(cos_zenith, cos_sun),
            Self::TraditionalOvercast => (1.0 + 2.0 * cos_zenith.max(0.0)) / 3.0,
        }
    }
}
