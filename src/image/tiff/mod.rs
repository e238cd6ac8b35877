//! Reads TIFF files: grey, RGB, palette and CMYK; integers of 1 to 32 bits and floating point of 16 to 64; with or
//! without alpha; in strips or tiles; uncompressed or with LZW, deflate or PackBits; with any predictor. Only the
//! first picture is read.
//!
//! The crate `tiff` allocates as much memory as a file demands, and prints to the console. This module therefore reads
//! the tags itself and checks them before it allocates. JPEG and fax compression, YCbCr, CIELAB, and the raw data of
//! cameras are not read; the error names them.
//!
//! References: TIFF revision 6.0 (Adobe, 1992); for the floating-point predictor, Adobe Photoshop TIFF technical note
//! 3 (2005).

mod chunk;
pub(super) mod ifd;
mod pixel_tags;
#[cfg(test)]
mod tests;

use super::colour::{srgb_to_linear, srgb8_table};
use super::limits::Encoding;
use super::orientation::{Orientation, Upright};
use super::{Image, memory, try_vec};
use crate::error::{Error, Result};
use chunk::{sample, undo_predictor, unpack};
use ifd::{Ifds, Order};
use pixel_tags::{Alpha, Chunk, Depth, Photometric, PixelTags};

fn pixel_tags(bytes: &[u8]) -> Result<(PixelTags<'_>, Order)> {
    let directory = Ifds::new(bytes).and_then(Ifds::first);
    let directory = directory.ok_or_else(|| Error::format("the TIFF has no directory of its pictures"))?;
    Ok((PixelTags::new(directory, bytes.len())?, directory.ifds().order()))
}

/// Returns width, height and number of channels of the first picture.
pub(super) fn probe(bytes: &[u8]) -> Result<(usize, usize, usize)> {
    let (tags, _) = pixel_tags(bytes)?;
    Ok((tags.width, tags.height, tags.channels()))
}

/// Bytes of memory for reading the first picture, in addition to the picture itself.
pub(super) fn working_bytes(bytes: &[u8]) -> Result<usize> {
    let (tags, _) = pixel_tags(bytes)?;
    Ok(memory::UNPACKING + tags.chunk_bytes() + tags.row_bytes())
}

/// Whether the samples of the first picture are floating-point numbers.
pub(super) fn is_float(bytes: &[u8]) -> bool {
    pixel_tags(bytes).is_ok_and(|(tags, _)| tags.depth.is_float())
}

/// Returns the colour profile of the first picture (ICC.1:2022, annex B.3).
pub(super) fn profile(bytes: &[u8]) -> Option<&[u8]> {
    const PROFILE: u16 = 34_675;
    Ifds::new(bytes)?.first()?.bytes(PROFILE)
}

/// Decodes the first picture to linear values.
pub(super) fn decode(bytes: &[u8], encoding: Encoding, orientation: Orientation) -> Result<Image> {
    let (tags, order) = pixel_tags(bytes)?;
    let mut image = read(&tags, order, tags.channels(), orientation)?;
    decode_colours(&mut image, &tags, encoding);
    Ok(image)
}

/// Whether the samples of the first picture are amounts of inks.
pub(super) fn has_inks(bytes: &[u8]) -> bool {
    pixel_tags(bytes).is_ok_and(|(tags, _)| matches!(tags.colour, Photometric::Cmyk))
}

/// Decodes the amounts of the four inks of the first picture. They lie in `[0, 1]`, unless the file is damaged.
pub(super) fn decode_inks(bytes: &[u8], orientation: Orientation) -> Result<Image> {
    let (tags, order) = pixel_tags(bytes)?;
    read(&tags, order, tags.colours(), orientation)
}

/// Reads and decompresses the samples of the first picture. The result stays encoded (not linear). Inks are converted
/// to RGB unless `channels` is 4.
fn read(tags: &PixelTags, order: Order, channels: usize, orientation: Orientation) -> Result<Image> {
    memory::check_unpacking()?;
    let mut out = Upright::new(tags.width, tags.height, channels, orientation)?;
    let mut unpacked = try_vec(tags.chunk_bytes(), 0u8)?;
    let mut spare = try_vec(tags.row_bytes(), 0u8)?;
    for chunk in tags.chunks() {
        let rows = &mut unpacked[..tags.row_bytes() * chunk.height];
        unpack(tags.stored(&chunk)?, tags.compression, rows)?;
        for (y, row) in rows.chunks_exact_mut(tags.row_bytes()).enumerate() {
            let order = undo_predictor(row, &mut spare, tags, order);
            put_row(&mut out, row, order, tags, &Chunk { y: chunk.y + y, ..chunk });
        }
    }
    Ok(out.image)
}

/// Writes the samples of one row of a chunk to their pixels in the image. The samples stay encoded (not linear); alpha
/// goes to the last channel.
fn put_row(out: &mut Upright, row: &[u8], order: Order, tags: &PixelTags, at: &Chunk) {
    let stored = tags.samples;
    let value = |i: usize| sample(row, i, tags.depth, order);
    let (colours, has_alpha) = (tags.colours(), tags.alpha.is_some());
    for x in 0..at.width {
        let pixel = out.pixel(at.x + x, at.y);
        let last = pixel.len() - 1;
        match tags.colour {
            // In a planar file, this chunk holds one sample of each pixel. Alpha goes to the last channel.
            _ if stored == 1 && at.plane > 0 => pixel[if at.plane == colours { last } else { at.plane }] = value(x),
            Photometric::Palette(map) => {
                let size = 1 << tags.depth.bits();
                let index = (value(x) * (size - 1) as f32).round() as usize;
                for (c, channel) in pixel.iter_mut().enumerate() {
                    *channel = map.integer(c * size + index).unwrap_or(0) as f32 / 65_535.0;
                }
            }
            Photometric::Cmyk if last == 3 => {
                pixel.iter_mut().enumerate().for_each(|(c, ink)| *ink = value(x * stored + c));
            }
            Photometric::Cmyk => {
                let black = value(x * stored + 3);
                for (c, channel) in pixel.iter_mut().enumerate() {
                    *channel = (1.0 - value(x * stored + c)) * (1.0 - black);
                }
            }
            Photometric::Grey { is_inverted } => {
                let grey = value(x * stored);
                pixel[0] = if is_inverted { 1.0 - grey } else { grey };
                if stored > 1 && has_alpha {
                    pixel[last] = value(x * stored + 1);
                }
            }
            Photometric::Rgb => {
                let count = if stored == 1 { 1 } else { pixel.len() };
                for (c, channel) in pixel[..count].iter_mut().enumerate() {
                    *channel = value(x * stored + c);
                }
            }
        }
    }
}

/// Converts the colours to linear values once all samples are in place. Colours that were multiplied by alpha are first
/// divided by alpha, unless alpha is 0; integer colours are clipped to 1.
fn decode_colours(image: &mut Image, tags: &PixelTags, encoding: Encoding) {
    let is_curved = encoding == Encoding::Srgb && !tags.depth.is_float();
    let is_associated = tags.alpha == Some(Alpha::Associated);
    // An 8-bit colour has only 256 values, so decode it by a table.
    let table = (tags.depth == Depth::U8
        && !is_associated
        && !matches!(tags.colour, Photometric::Cmyk | Photometric::Palette(_)))
    .then(srgb8_table);
    let linear = |v: f32| match &table {
        _ if !is_curved => v,
        Some(table) => table[(v * 255.0).round() as usize],
        None => srgb_to_linear(v),
    };
    let is_grey = matches!(tags.colour, Photometric::Grey { .. });
    for pixel in image.data.chunks_exact_mut(image.channels) {
        let (colours, alpha) = pixel.split_at_mut(if tags.alpha.is_some() { 3 } else { tags.channels() });
        if is_associated && alpha[0] > 0.0 {
            let bound = if tags.depth.is_float() { f32::INFINITY } else { 1.0 };
            colours.iter_mut().for_each(|v| *v = (*v / alpha[0]).min(bound));
        }
        if is_grey {
            let grey = linear(colours[0]);
            colours.fill(grey);
        } else {
            colours.iter_mut().for_each(|v| *v = linear(*v));
        }
    }
}
