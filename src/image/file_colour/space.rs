//! The colour space that a picture file states, and how the reader interpreted it.

use super::chromaticities::{Chromaticities, is_identity};
use super::conversion::Conversion;
use super::curve::Curve;
use super::inks::Inks;
use crate::error::Result;
use crate::maths;
use glam::DMat3;

/// How the colours of a picture were interpreted.
#[repr(i32)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FileColour {
    /// The picture is not from a file.
    #[default]
    None = 0,
    /// The file states no colour space. Integers are taken as sRGB, floating-point numbers as linear Rec.709.
    Assumed = 1,
    /// The file states sRGB for integers, or linear Rec.709 for floating-point numbers.
    Stated = 2,
    /// The file states another space, from which its colours were converted.
    Converted = 3,
    /// The file states a space that cannot be converted, or holds inks without a profile. Its colours were read as if
    /// the file stated nothing.
    Unconverted = 4,
    /// The caller asked for the stored numbers without conversion.
    Data = 5,
}

/// The colour space that a picture file states.
pub(in crate::image) enum Space {
    Unstated,
    /// sRGB for integers, or linear Rec.709 for floating-point numbers.
    Native,
    Other(Conversion),
    /// Amounts of cyan, magenta, yellow and black.
    Inks(Inks),
    /// A space that cannot be converted.
    Unusable,
}

impl Space {
    /// Returns the linear colour space from which `matrix` converts to linear Rec.709.
    pub fn linear(matrix: DMat3) -> Self {
        if is_identity(matrix) { Self::Native } else { Self::Other(Conversion::linear(matrix)) }
    }
}

/// The colour space that the EXIF metadata of a file state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExifColour {
    #[default]
    Unstated,
    Srgb,
    AdobeRgb,
}

impl ExifColour {
    /// Returns the colour space that the EXIF metadata state.
    pub(in crate::image) fn space(self) -> Result<Space> {
        match self {
            Self::Unstated => Ok(Space::Unstated),
            Self::Srgb => Ok(Space::Native),
            Self::AdobeRgb => {
                let curve = Curve::new(|v| maths::powf(v, ADOBE_GAMMA))?;
                Ok(Chromaticities::ADOBE_RGB.to_rec709().map_or(Space::Unusable, |matrix| {
                    Space::Other(Conversion::new([curve.clone(), curve.clone(), curve], matrix))
                }))
            }
        }
    }
}

/// Exponent of the transfer curve of Adobe RGB: 2 + 51/256. [convention: Adobe RGB (1998), 4.3.1.2]
const ADOBE_GAMMA: f64 = 563.0 / 256.0;
