//! The colour space that a picture file states, and the conversion of its samples to linear Rec.709.
//!
//! | file | statement, the first that can be used |
//! |---|---|
//! | PNG | `cICP`, `iCCP`, `sRGB`, `gAMA` with `cHRM` (PNG specification, third edition, 4.3) |
//! | JPEG, WebP, TIFF | ICC profile, then the colour space of the EXIF notes (sRGB, Adobe RGB) |
//! | OpenEXR | `chromaticities`, `adoptedNeutral` |
//! | Radiance HDR | `PRIMARIES`, `EXPOSURE`, `COLORCORR`, `FORMAT` (RGB or XYZ) |
//!
//! Without a statement, integers are sRGB and floating-point numbers linear Rec.709. White becomes white: whites other
//! than D65 are adapted with the Bradford matrix, as ICC profiles are.
//!
//! Not modelled: rendering intents other than relative colorimetric, gain maps, profiles of GIF and BMP files,
//! profiles for the inks of CMYK files. A file with a statement that cannot be used is read as one without, and
//! [`FileColour`] says so.

mod chromaticities;
mod cicp;
mod conversion;
mod curve;
pub(super) mod icc;
mod png;
mod space;
#[cfg(test)]
mod tests;

pub(super) use chromaticities::Chromaticities;
pub(super) use conversion::Conversion;
pub(super) use space::Space;
pub use space::{ExifColour, FileColour};

use super::containers::{jpeg_segments, riff_chunks};
use super::format::Format;
use super::photo::Exif;
use super::tiff;
use crate::error::Result;
use image::ImageFormat;
use std::borrow::Cow;

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
        Format::Tiff => tiff::profile(bytes).map(Into::into),
        Format::Raster(_) | Format::Exr | Format::Radiance => None,
    })
}
