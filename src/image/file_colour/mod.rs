//! The colour space that a picture file states, and the conversion of its samples to linear Rec.709.
//!
//! | file | statement, the first that can be used |
//! |---|---|
//! | PNG | `cICP`, `iCCP`, `sRGB`, `gAMA` with `cHRM` (PNG specification, third edition, 4.3) |
//! | JPEG, WebP, TIFF | ICC profile, then the colour space of the EXIF notes (sRGB, Adobe RGB) |
//! | GIF, BMP | ICC profile; of BMP the mark for sRGB |
//! | OpenEXR | `chromaticities`, `adoptedNeutral` |
//! | Radiance HDR | `PRIMARIES`, `EXPOSURE`, `COLORCORR`, `FORMAT` (RGB or XYZ) |
//!
//! Without a statement, integers are sRGB and floating-point numbers linear Rec.709. White becomes white: whites other
//! than D65 are adapted with the Bradford matrix, as ICC profiles are.
//!
//! Not modelled: rendering intents other than relative colorimetric, gain maps, endpoints and linked profiles of BMP
//! files, profiles for the inks of CMYK files. A file with a statement that cannot be used is read as one without, and
//! [`FileColour`] says so.

mod chromaticities;
mod cicp;
mod conversion;
mod curve;
pub(super) mod icc;
mod png;
#[cfg(test)]
mod tests;

pub(super) use chromaticities::Chromaticities;
pub(super) use conversion::Conversion;

use super::containers::{bmp_space, gif_extension, jpeg_segments, riff_chunks};
use super::format::Format;
use super::photo::Exif;
use super::tiff;
use crate::error::Result;
use crate::image::try_collect;
use curve::Curve;
use image::ImageFormat;
use std::borrow::Cow;

/// How the colours of a picture were understood.
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
    /// The file states a space that cannot be converted. It was read as if it stated none.
    Unconverted = 4,
    /// The caller asked for the numbers as they are.
    Data = 5,
}

/// The colour space that a file states.
pub(super) enum Space {
    Unstated,
    /// sRGB for integers, linear Rec.709 for floating-point numbers.
    Native,
    Other(Conversion),
    /// One that cannot be converted.
    Unusable,
}

impl Space {
    /// The space of a picture of integers.
    pub fn of(bytes: &[u8], format: Format, exif: &Exif) -> Result<Self> {
        let profile = match format {
            Format::Raster(ImageFormat::Png) => return png::space(bytes),
            Format::Exr | Format::Radiance => return Ok(Self::Unstated),
            _ => profile(bytes, format)?,
        };
        // Floating-point numbers are encoded only if a profile says so.
        let is_float = format == Format::Tiff && tiff::is_float(bytes);
        match profile.map(|profile| icc::space(&profile)).transpose()? {
            Some(Self::Native) if is_float => Ok(Self::Other(Conversion::srgb()?)),
            Some(space) => Ok(space),
            None if is_float => Ok(Self::Unstated),
            None if format == Format::Raster(ImageFormat::Bmp) => Ok(bmp(bytes)),
            None => exif.colour.space(),
        }
    }
}

/// The ICC profile in a file.
pub fn profile(bytes: &[u8], format: Format) -> Result<Option<Cow<'_, [u8]>>> {
    Ok(match format {
        Format::Raster(ImageFormat::Png) => png::profile(bytes)?.map(Into::into),
        Format::Raster(ImageFormat::Jpeg) => icc::of_segments(jpeg_segments(bytes))?,
        Format::Raster(ImageFormat::WebP) => {
            riff_chunks(bytes).find(|c| c.0 == b"ICCP").map(|(_, profile)| profile.into())
        }
        Format::Raster(ImageFormat::Gif) => {
            let Some(blocks) = gif_extension(bytes, b"ICCRGBG1012") else { return Ok(None) };
            Some(try_collect(blocks.flatten().copied())?.into())
        }
        Format::Raster(ImageFormat::Bmp) => bmp_space(bytes).and_then(|(_, profile)| profile).map(Into::into),
        Format::Tiff => tiff::profile(bytes).map(Into::into),
        Format::Raster(_) | Format::Exr | Format::Radiance => None,
    })
}

/// The space of a BMP without an embedded profile that can be read.
fn bmp(bytes: &[u8]) -> Space {
    match bmp_space(bytes).map(|(kind, _)| kind) {
        Some(kind) if kind == *b"sRGB" => Space::Native,
        // A profile in another file, or one that is cut off.
        Some(kind) if kind == *b"LINK" || kind == *b"MBED" => Space::Unusable,
        // The space of the system, or endpoints, which most writers leave at 0.
        _ => Space::Unstated,
    }
}

/// The colour space by the EXIF notes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExifColour {
    #[default]
    Unstated,
    Srgb,
    AdobeRgb,
}

impl ExifColour {
    fn space(self) -> Result<Space> {
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

/// Adobe RGB (1998), 4.3.1.2: 2 + 51/256.
const ADOBE_GAMMA: f64 = 563.0 / 256.0;
