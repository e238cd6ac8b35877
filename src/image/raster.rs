//! PNG, JPEG, WebP, BMP, GIF and Radiance HDR files, by the crate `image`. Of moving pictures the first frame is read.

use super::colour::{srgb_to_linear, srgb8_table};
use super::containers::{gif_frame, png_chunks};
use super::io::{Encoding, check_size};
use super::photo::{Orientation, Upright};
use super::{Image, room, try_vec};
use crate::error::{Error, ErrorKind, Result};
use image::{ImageDecoder, ImageFormat, ImageReader};
use std::io::Cursor;

/// Width, height and number of channels, from the header.
pub fn probe(bytes: &[u8], format: ImageFormat) -> Result<(usize, usize, usize)> {
    let decoder = decoder(bytes, format)?;
    let (width, height) = decoder.dimensions();
    Ok((width as usize, height as usize, channels(usize::from(decoder.color_type().channel_count()))))
}

/// Grey with alpha becomes RGBA.
fn channels(stored: usize) -> usize {
    if stored == 2 { 4 } else { stored }
}

fn decoder(bytes: &[u8], format: ImageFormat) -> Result<impl ImageDecoder + '_> {
    match format {
        ImageFormat::Png => check_chunks(bytes)?,
        ImageFormat::Gif => check_frame(bytes)?,
        _ => {}
    }
    let decoder = ImageReader::with_format(Cursor::new(bytes), format).into_decoder().map_err(broken)?;
    let (width, height) = decoder.dimensions();
    check_size(width.into(), height.into())?;
    Ok(decoder)
}

/// The decoder takes for granted that a PNG's palette holds whole colours, and takes memory for other chunks as they come.
fn check_chunks(bytes: &[u8]) -> Result<()> {
    for (name, length, content) in png_chunks(bytes) {
        if name == b"PLTE" && !(length % 3 == 0 && (1..=256).contains(&(length / 3))) {
            return Err(Error::format(format!(
                "the PNG's palette has {length} bytes; it must hold 1 to 256 colours of 3"
            )));
        }
        room::check_chunk(name, content.len())?;
    }
    Ok(())
}

/// The decoder takes memory for a frame of any size, however small its screen.
fn check_frame(bytes: &[u8]) -> Result<()> {
    let screen = |at: usize| Some(usize::from(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?)));
    let sizes = gif_frame(bytes).zip(screen(6)).zip(screen(8));
    let (([left, top, width, height], screen_width), screen_height) =
        sizes.ok_or_else(|| Error::format("the GIF ends before its first frame"))?;
    if left + width > screen_width || top + height > screen_height {
        return Err(Error::format(format!(
            "the GIF's frame of {width} x {height} pixels at ({left}, {top}) is not within its screen of {screen_width} x \
             {screen_height}"
        )));
    }
    Ok(())
}

fn broken(e: image::ImageError) -> Error {
    if let image::ImageError::IoError(io) = &e
        && io.kind() == std::io::ErrorKind::OutOfMemory
    {
        return Error::new(ErrorKind::OutOfMemory, "could not allocate memory to decode the file");
    }
    Error::format(format!("the file cannot be decoded: {e}"))
}

pub fn decode(bytes: &[u8], format: ImageFormat, encoding: Encoding, orientation: Orientation) -> Result<Image> {
    let decoder = decoder(bytes, format)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    let colour = decoder.color_type();
    let mut raw = try_vec(usize::try_from(decoder.total_bytes()).unwrap_or(usize::MAX), 0u8)?;
    room::check_pixels(bytes, format, width, height, usize::from(colour.bytes_per_pixel()))?;
    decoder.read_image(&mut raw).map_err(broken)?;

    let stored = usize::from(colour.channel_count());
    let mut out = Upright::new(width, height, channels(stored), orientation)?;
    // Integers in sRGB decode through a table or the curve; everything else is scaled only.
    let is_curved = encoding == Encoding::Srgb && format != ImageFormat::Hdr;
    let curve = |v: f32, is_alpha: bool| if is_curved && !is_alpha { srgb_to_linear(v) } else { v };
    match usize::from(colour.bytes_per_pixel()) / stored {
        1 => {
            let linear: [f32; 256] = std::array::from_fn(|i| i as f32 / 255.0);
            let table = if is_curved { srgb8_table() } else { linear };
            let value = |i: usize, is_alpha| (if is_alpha { &linear } else { &table })[usize::from(raw[i])];
            fill(&mut out, [width, height], stored, value);
        }
        2 => fill(&mut out, [width, height], stored, |i, is_alpha| {
            curve(f32::from(sample(&raw, i, u16::from_ne_bytes)) / 65_535.0, is_alpha)
        }),
        _ => {
            fill(&mut out, [width, height], stored, |i, is_alpha| curve(sample(&raw, i, f32::from_ne_bytes), is_alpha))
        }
    }
    Ok(out.image)
}

/// Puts the pixels of a file where they belong; `value` gives a sample by its index, and is told whether it is alpha.
fn fill(out: &mut Upright, [width, height]: [usize; 2], stored: usize, value: impl Fn(usize, bool) -> f32) {
    for y in 0..height {
        for x in 0..width {
            let start = (y * width + x) * stored;
            for (c, sample) in out.pixel(x, y).iter_mut().enumerate() {
                let from = if stored == 2 { c / 3 } else { c };
                *sample = value(start + from, c == 3);
            }
        }
    }
}

/// The sample of a number of bytes at an index.
fn sample<const N: usize, T>(raw: &[u8], index: usize, of: fn([u8; N]) -> T) -> T {
    of(std::array::from_fn(|k| raw[index * N + k]))
}
