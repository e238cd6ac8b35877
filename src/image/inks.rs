//! Reads JPEG files with four inks (cyan, magenta, yellow and black), for conversion by their colour profile.
//!
//! The crate `image` converts inks to RGB without a profile. This module therefore uses the decoder on which that
//! crate is based, `zune-jpeg`.
//!
//! By the convention of Adobe Photoshop, which every reader follows, a stored value of 255 means no ink (libjpeg,
//! `libjpeg.txt`, "Special color spaces"). In YCCK files, YCbCr encodes R, G and B, which are 255 minus the cyan,
//! magenta and yellow that a CMYK file would store. Black is stored as in CMYK files.

use super::Image;
use super::containers::jpeg_segments;
use super::limits::check_size;
use super::memory;
use super::orientation::{Orientation, Upright};
use crate::error::{Error, Result};
use crate::image::try_vec;
use image::ImageFormat;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Whether a JPEG has four components, according to its frame header.
pub fn has_inks(bytes: &[u8]) -> bool {
    // The markers C0 to CF begin frame headers, except the markers of tables (C4, CC) and of an extension (C8). The
    // sixth byte of a frame header is the number of components.
    jpeg_segments(bytes)
        .find(|(marker, _)| matches!(marker, 0xc0..=0xcf) && !matches!(marker, 0xc4 | 0xc8 | 0xcc))
        .is_some_and(|(_, frame)| frame.get(5) == Some(&4))
}

/// Decodes the amounts of the four inks in `[0, 1]`, turned upright by `orientation`.
pub fn decode(bytes: &[u8], orientation: Orientation) -> Result<Image> {
    let options = DecoderOptions::default().set_strict_mode(false).set_max_width(usize::MAX).set_max_height(usize::MAX);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    let broken = |e| Error::format(format!("the file cannot be decoded: {e}"));
    decoder.decode_headers().map_err(broken)?;
    let stored = decoder.input_colorspace().filter(|space| matches!(space, ColorSpace::CMYK | ColorSpace::YCCK));
    let (Some(stored), Some((width, height))) = (stored, decoder.dimensions()) else {
        return Err(Error::format("the JPEG's four components are no inks"));
    };
    check_size(width as u64, height as u64)?;
    // Ask for the components as stored, without conversion to RGB.
    decoder.set_options(options.jpeg_set_out_colorspace(stored));
    let mut raw = try_vec(4 * width * height, 0u8)?;
    memory::check_pixels(bytes, ImageFormat::Jpeg, width, height, 4)?;
    decoder.decode_into(&mut raw).map_err(broken)?;

    let mut out = Upright::new(width, height, 4, orientation)?;
    for (y, row) in raw.chunks_exact(4 * width).enumerate() {
        for (x, &stored_pixel) in row.as_chunks().0.iter().enumerate() {
            let inks = if stored == ColorSpace::YCCK { of_ycck(stored_pixel) } else { of_cmyk(stored_pixel) };
            out.pixel(x, y).copy_from_slice(&inks);
        }
    }
    Ok(out.image)
}

fn of_cmyk(stored: [u8; 4]) -> [f32; 4] {
    stored.map(|v| 1.0 - f32::from(v) / 255.0)
}

/// Converts YCCK to amounts of inks. The R, G and B that follow from YCbCr (JFIF; ITU-T T.871, 7) are the amounts of
/// cyan, magenta and yellow.
fn of_ycck([y, cb, cr, k]: [u8; 4]) -> [f32; 4] {
    let (y, cb, cr) = (f32::from(y), f32::from(cb) - 128.0, f32::from(cr) - 128.0);
    // The coefficients of ITU-T T.871, 7. [convention]
    let rgb = [y + 1.402 * cr, y - 0.344_136 * cb - 0.714_136 * cr, y + 1.772 * cb];
    let [c, m, yellow] = rgb.map(|v| v.round().clamp(0.0, 255.0) / 255.0);
    [c, m, yellow, 1.0 - f32::from(k) / 255.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inks_are_amounts() {
        assert_eq!(of_cmyk([255, 0, 255, 0]), [0.0, 1.0, 0.0, 1.0]);
        assert_eq!(of_ycck([0, 128, 128, 255]), [0.0; 4]);
        assert_eq!(of_ycck([255, 128, 128, 0]), [1.0; 4]);
        // A pixel of cyan alone is stored as the YCbCr of pure red.
        assert_eq!(of_ycck([76, 85, 255, 255]), [254.0 / 255.0, 0.0, 0.0, 0.0]);
    }
}
