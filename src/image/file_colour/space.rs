//! The colour space that a file states, and how the reader handled it.

use super::chromaticities::{Chromaticities, is_identity};
use super::conversion::Conversion;
use super::curve::Curve;
use super::inks::Inks;
use crate::error::Result;
use glam::DMat3;

/// How the colours of a picture were interpreted.
#[repr(i32)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FileColour {
    /// The picture is not from a file.
    #[default]
    None = 0,
    /// The file states no colour space: integers are taken as sRGB, floating-point numbers as linear Rec.709.
    Assumed = 1,
    /// The file states this space.
    Stated = 2,
    /// The file states another space, and its colours were converted.
    Converted = 3,
    /// The file states a space that cannot be converted, or holds inks without a profile. It was read as if it stated none.
    Unconverted = 4,
    /// The caller requested the stored numbers without conversion.
    Data = 5,
}

/// The colour space that a file states.
pub(in crate::image) enum Space {
    Unstated,
    /// sRGB for integers, linear Rec.709 for floating-point numbers.
    Native,
    Other(Conversion),
    /// Amounts of cyan, magenta, yellow and black.
    Inks(Inks),
    /// A space that cannot be converted.
    Unusable,
}

impl Space {
    /// The space whose linear colours a matrix converts to Rec.709.
    pub fn linear(matrix: DMat3) -> Self {
        if is_identity(matrix) { Self::Native } else { Self::Other(Conversion::linear(matrix)) }
    }
}

/// The colour space that the EXIF data state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExifColour {
    #[default]
    Unstated,
    Srgb,
    AdobeRgb,
}

impl ExifColour {
    /// The space that the EXIF data state.
    pub(super) fn space(self) -> Result<Space> {
        match self {
            Self::Unstated => Ok(Space::Unstated),
            Self::Srgb => Ok(Space::Native),
            Self::AdobeRgb => {
                let curve = Curve::new(|v| v.powf(ADOBE_GAMMA))?;
                Ok(Chromaticities::ADOBE_RGB.to_rec709().map_or(Space::Unusable, |matrix| {
                    Space::Other(Conversion::new([curve.clone(), curve.clone(), curve], matrix))
                }))
            }
        }
    }
}

/// Exponent of Adobe RGB: 2 + 51/256 [convention: Adobe RGB (1998), 4.3.1.2].
const ADOBE_GAMMA: f64 = 563.0 / 256.0;
