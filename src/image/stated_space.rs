//! Determines the colour space that a picture file states. [`super::file_colour`] lists the statements that are read.

use super::containers::{bmp_space, gif_extension, jpeg_segments, riff_chunks};
use super::file_colour::{Conversion, Space, icc, png};
use super::format::Format;
use super::photo::Exif;
use super::{inks, tiff, try_collect};
use crate::error::Result;
use image::ImageFormat;
use std::borrow::Cow;

/// Determines the space of a picture that the crate `image` or the TIFF reader decodes.
pub fn of(bytes: &[u8], format: Format, exif: &Exif) -> Result<Space> {
    let profile = match format {
        Format::Raster(ImageFormat::Png) => return png::space(bytes),
        Format::Exr | Format::Radiance => return Ok(Space::Unstated),
        _ => profile(bytes, format)?,
    };
    // Floating-point numbers are linear unless a profile says otherwise.
    let is_float = format == Format::Tiff && tiff::is_float(bytes);
    let has_inks = has_inks(bytes, format);
    match profile.map(|profile| icc::space(&profile)).transpose()? {
        Some(space) if has_inks => Ok(if matches!(space, Space::Inks(_)) { space } else { Space::Unusable }),
        Some(Space::Inks(_)) => Ok(Space::Unusable),
        // Amounts of inks have no meaning without a profile.
        None if has_inks => Ok(Space::Unusable),
        Some(Space::Native) if is_float => Ok(Space::Other(Conversion::srgb()?)),
        Some(space) => Ok(space),
        None if is_float => Ok(Space::Unstated),
        None if format == Format::Raster(ImageFormat::Bmp) => Ok(bmp(bytes)),
        None => exif.colour.space(),
    }
}

/// Whether the samples of a file are amounts of inks.
pub fn has_inks(bytes: &[u8], format: Format) -> bool {
    match format {
        Format::Raster(ImageFormat::Jpeg) => inks::has_inks(bytes),
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
