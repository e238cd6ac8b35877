//! Determines the colour space that a picture file states, and converts its samples to linear Rec.709.
//!
//! The table lists the statements that are read, by format. In OpenEXR and Radiance HDR files, all of them count
//! together. In files of the other formats, only the first one that can be used counts.
//!
//! | file | statements |
//! |---|---|
//! | PNG | `cICP`, `iCCP`, `sRGB`, `gAMA` with `cHRM` (PNG specification, third edition, 4.3) |
//! | JPEG, WebP, TIFF | ICC profile, then the EXIF colour space (sRGB, Adobe RGB); for inks the profile alone |
//! | GIF, BMP | ICC profile; for BMP the mark for sRGB |
//! | OpenEXR | `chromaticities`, `adoptedNeutral` |
//! | Radiance HDR | `PRIMARIES`, `EXPOSURE`, `COLORCORR`, `FORMAT` (RGB or XYZ) |
//!
//! Without a statement, integers are taken as sRGB and floating-point numbers as linear Rec.709. White stays white:
//! whites other than D65 are adapted with the Bradford matrix, as in ICC profiles.
//!
//! Not modelled: rendering intents other than relative colorimetric (unless a profile lacks it), gain maps, endpoints
//! and linked profiles of BMP files, black point compensation. If none of a file's statements can be used, the file is
//! read as if it had none, and [`FileColour`] says so.

mod chromaticities;
mod cicp;
mod conversion;
mod curve;
pub(super) mod icc;
mod inks;
mod png;
mod space;
#[cfg(test)]
mod tests;

pub(super) use chromaticities::Chromaticities;
pub(super) use conversion::Conversion;
pub(super) use space::Space;
pub use space::{ExifColour, FileColour};

use super::containers::{bmp_space, gif_extension, jpeg_segments, riff_chunks};
use super::format::Format;
use super::inks as ink_files;
use super::photo::Exif;
use super::tiff;
use crate::error::Result;
use crate::image::try_collect;
use image::ImageFormat;
use std::borrow::Cow;

impl Space {
    /// Determines the space of a picture that the crate `image` or the TIFF reader decodes.
    pub fn of(bytes: &[u8], format: Format, exif: &Exif) -> Result<Self> {
        let profile = match format {
            Format::Raster(ImageFormat::Png) => return png::space(bytes),
            Format::Exr | Format::Radiance => return Ok(Self::Unstated),
            _ => profile(bytes, format)?,
        };
        // Floating-point numbers are linear unless a profile says otherwise.
        let is_float = format == Format::Tiff && tiff::is_float(bytes);
        let has_inks = has_inks(bytes, format);
        match profile.map(|profile| icc::space(&profile)).transpose()? {
            Some(space) if has_inks => Ok(if matches!(space, Self::Inks(_)) { space } else { Self::Unusable }),
            Some(Self::Inks(_)) => Ok(Self::Unusable),
            // Amounts of inks have no meaning without a profile.
            None if has_inks => Ok(Self::Unusable),
            Some(Self::Native) if is_float => Ok(Self::Other(Conversion::srgb()?)),
            Some(space) => Ok(space),
            None if is_float => Ok(Self::Unstated),
            None if format == Format::Raster(ImageFormat::Bmp) => Ok(bmp(bytes)),
            None => exif.colour.space(),
        }
    }
}

/// Whether the samples of a file are amounts of inks.
pub fn has_inks(bytes: &[u8], format: Format) -> bool {
    match format {
        Format::Raster(ImageFormat::Jpeg) => ink_files::has_inks(bytes),
        Format::Tiff => tiff::has_inks(bytes),
        Format::Raster(_) | Format::Exr | Format::Radiance => false,
    }
}

/// Returns the ICC profile in a file; `None` if it has none.
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

/// Returns the colour space of a BMP that holds no readable profile.
fn bmp(bytes: &[u8]) -> Space {
    match bmp_space(bytes).map(|(kind, _)| kind) {
        Some(kind) if kind == *b"sRGB" => Space::Native,
        // The profile is in another file, or it is cut off.
        Some(kind) if kind == *b"LINK" || kind == *b"MBED" => Space::Unusable,
        // The header names the operating system's default colour space, or gives primaries, which are ignored because
        // most writers leave them at 0.
        _ => Space::Unstated,
    }
}
