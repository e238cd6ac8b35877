//! Upper bounds of the memory that reading a picture file needs in addition to the resulting picture. The caller's
//! memory budget is charged with these bytes while the file is read.

use super::containers::png_chunks;
use super::file_colour::icc;
use super::format::Format;
use super::io::probe;
use super::{memory, openexr, radiance, raster, stated_space, tiff};
use crate::error::Result;
use image::ImageFormat;

/// Returns an upper bound of the working memory in bytes, from the headers alone. No codec runs. Only a colour profile
/// may be unpacked into memory, which is freed before the function returns.
pub fn working_bytes(bytes: &[u8]) -> Result<u64> {
    let format = Format::of(bytes)?;
    let pixels = match format {
        Format::Exr => openexr::working_bytes(bytes)?,
        Format::Radiance => radiance::working_bytes(bytes)?,
        Format::Tiff => tiff::working_bytes(bytes)?,
        Format::Raster(ImageFormat::Png) => png(bytes),
        Format::Raster(format) => raster::working_bytes(bytes, format)?,
    };
    let profile = stated_space::profile(bytes, format)?;
    // If a profile converts the inks, their amounts are first read into an image with four channels, each of four
    // bytes.
    let inks = match &profile {
        Some(_) if stated_space::has_inks(bytes, format) => {
            let (width, height, _) = probe(bytes)?;
            16 * width * height
        }
        _ => 0,
    };
    let profile = profile.map_or(0, |profile| profile.len().saturating_add(icc::working_bytes(&profile)));
    Ok(pixels.saturating_add(profile).saturating_add(inks) as u64)
}

/// Returns the bytes of working memory for a PNG: for its samples in the decoder's format, and for its other chunks.
fn png(bytes: &[u8]) -> usize {
    let mut total = 0usize;
    for (name, _, content) in png_chunks(bytes) {
        let own = match (name, content) {
            (b"IHDR", &[a, b, c, d, e, f, g, h, depth, colour, ..]) => {
                let [width, height] = [[a, b, c, d], [e, f, g, h]].map(|side| u32::from_be_bytes(side) as usize);
                // Grey, RGB and palette images may have a transparent colour, for which the decoder adds an alpha
                // channel.
                let channels = if matches!(colour, 0 | 4) { 2 } else { 4 };
                let pixel = channels * if depth == 16 { 2 } else { 1 };
                let row = memory::pixels(bytes, ImageFormat::Png, width, height, pixel);
                width.saturating_mul(height).saturating_mul(pixel).saturating_add(row)
            }
            // The buffers of chunks grow by doubling.
            _ => memory::chunk(name, content.len(), bytes.len()).saturating_mul(2),
        };
        total = total.saturating_add(own);
    }
    total
}
