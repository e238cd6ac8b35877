//! Reads PNG, JPEG, WebP, BMP and GIF files with the crate `image`. Of an animation, only the first frame is read.

use super::colour::{srgb_to_linear, srgb8_table};
use super::containers::{gif_frame, png_chunks};
use super::limits::{Encoding, check_size};
use super::orientation::{Orientation, Upright};
use super::{Image, memory, try_vec};
use crate::error::{Error, ErrorKind, Result};
use image::{ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use std::io::Cursor;

/// Returns width, height and number of channels of a file, from its header.
pub fn probe(bytes: &[u8], format: ImageFormat) -> Result<(usize, usize, usize)> {
    let decoder = decoder(bytes, format)?;
    let (width, height) = decoder.dimensions();
    Ok((width as usize, height as usize, channels(usize::from(decoder.color_type().channel_count()))))
}

/// Bytes of memory for reading a file, in addition to the picture itself. The ancillary chunks of a PNG are not
/// included.
pub fn working_bytes(bytes: &[u8], format: ImageFormat) -> Result<usize> {
    let decoder = decoder(bytes, format)?;
    let (width, height) = decoder.dimensions();
    let pixel = usize::from(decoder.color_type().bytes_per_pixel());
    let stored = usize::try_from(decoder.total_bytes()).unwrap_or(usize::MAX);
    Ok(stored.saturating_add(memory::pixels(bytes, format, width as usize, height as usize, pixel)))
}

/// Returns the number of channels of the image for a number of stored channels: grey with alpha becomes RGBA.
fn channels(stored: usize) -> usize {
    if stored == 2 { 4 } else { stored }
}

fn decoder(bytes: &[u8], format: ImageFormat) -> Result<impl ImageDecoder + '_> {
    match format {
        ImageFormat::Png => check_chunks(bytes)?,
        ImageFormat::Gif => check_frame(bytes)?,
        _ => {}
    }
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    if format == ImageFormat::Png {
        let mut limits = Limits::no_limits();
        limits.max_alloc = Some(memory::png_limit(bytes.len()) as u64);
        reader.limits(limits);
    }
    let decoder = reader.into_decoder().map_err(broken)?;
    let (width, height) = decoder.dimensions();
    check_size(width.into(), height.into())?;
    Ok(decoder)
}

/// Checks the chunks of a PNG on behalf of its decoder. The decoder assumes that the palette has three bytes per
/// colour, and it allocates memory without limit for other chunks and for a row.
fn check_chunks(bytes: &[u8]) -> Result<()> {
    for (name, length, content) in png_chunks(bytes) {
        if name == b"IHDR"
            && let (&[[a, b, c, d], [e, f, g, h], ..], _) = content.as_chunks()
        {
            check_size(u32::from_be_bytes([a, b, c, d]).into(), u32::from_be_bytes([e, f, g, h]).into())?;
        }
        if name == b"PLTE" && !(length % 3 == 0 && (1..=256).contains(&(length / 3))) {
            return Err(Error::format(format!(
                "the PNG's palette has {length} bytes; it must hold 1 to 256 colours of 3"
            )));
        }
        memory::check_chunk(name, content.len(), bytes.len())?;
    }
    Ok(())
}

/// Checks that the first frame of a GIF lies within the screen. The decoder does not check this, and allocates memory
/// for a frame of any size.
fn check_frame(bytes: &[u8]) -> Result<()> {
    let screen = |at: usize| Some(usize::from(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?)));
    let sizes = gif_frame(bytes).zip(screen(6)).zip(screen(8));
    let (([left, top, width, height], screen_width), screen_height) =
        sizes.ok_or_else(|| Error::format("the GIF ends before its first frame"))?;
    if left + width > screen_width || top + height > screen_height {
        return Err(Error::format(format!(
            "the GIF's frame of {width} x {height} pixels at ({left}, {top}) is not within its screen of \
             {screen_width} x {screen_height}"
        )));
    }
    Ok(())
}

// The error is taken by value, because `map_err` passes it by value.
#[allow(clippy::needless_pass_by_value)]
pub(super) fn broken(e: ImageError) -> Error {
    match &e {
        ImageError::IoError(io) if io.kind() == std::io::ErrorKind::OutOfMemory => {
            Error::new(ErrorKind::OutOfMemory, "could not allocate memory to decode the file")
        }
        ImageError::Unsupported(_) => {
            Error::new(ErrorKind::Unsupported, format!("the file is of a kind that is not read: {e}"))
        }
        _ => Error::format(format!("the file cannot be decoded: {e}")),
    }
}

pub fn decode(bytes: &[u8], format: ImageFormat, encoding: Encoding, orientation: Orientation) -> Result<Image> {
    let decoder = decoder(bytes, format)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    let colour = decoder.color_type();
    let mut raw = try_vec(usize::try_from(decoder.total_bytes()).unwrap_or(usize::MAX), 0u8)?;
    memory::check_pixels(bytes, format, width, height, usize::from(colour.bytes_per_pixel()))?;
    decoder.read_image(&mut raw).map_err(broken)?;

    let stored = usize::from(colour.channel_count());
    let mut out = Upright::new(width, height, channels(stored), orientation)?;
    // If the encoding is sRGB, decode colours by a table (8 bits) or by the curve. Alpha and data are only scaled to
    // the range `[0, 1]`.
    let is_curved = encoding == Encoding::Srgb;
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

/// Writes the pixels of a file to their upright positions. `value` returns a sample, given its index and whether it is
/// alpha.
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

/// Returns the sample at `index`, converted by `of` from its `N` bytes.
fn sample<const N: usize, T>(raw: &[u8], index: usize, of: fn([u8; N]) -> T) -> T {
    of(std::array::from_fn(|k| raw[index * N + k]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::io::{decode, decode_photo, probe};
    use image::codecs::{bmp::BmpEncoder, gif::GifEncoder, webp::WebPEncoder};
    use image::{ExtendedColorType, Frame, ImageEncoder, Rgba, RgbaImage};

    /// The VP8 frame of a lossy WebP file: 24 x 16 pixels, red on the left and blue on the right.
    const LOSSY: &[u8] = &[
        0xb0, 0x03, 0x00, 0x9d, 0x01, 0x2a, 0x18, 0x00, 0x10, 0x00, 0x3f, 0x11, 0x72, 0xb0, 0x50, 0x2c, 0x26, 0xa4,
        0xa2, 0xb0, 0x08, 0x01, 0x80, 0x22, 0x09, 0x40, 0x13, 0xa6, 0x50, 0x56, 0x80, 0xab, 0xff, 0xdc, 0x00, 0x03,
        0x36, 0x00, 0x00, 0xfe, 0xdf, 0xf9, 0x13, 0xd9, 0x75, 0x9c, 0x36, 0xa2, 0x13, 0x9b, 0x7b, 0x72, 0xbf, 0xaf,
        0xff, 0xf1, 0x0d, 0xed, 0xbe, 0xe3, 0xbf, 0xa1, 0x86, 0x67, 0xd8, 0x01, 0x17, 0x75, 0x40, 0x00,
    ];
    /// Alpha for the frame in `LOSSY`: 1 in the upper half, 0.5 in the lower half.
    const ALPHA: &[u8] = &[0x01, 0x10, 0x0b, 0x26, 0xea, 0x99, 0x67, 0xb0, 0x3b, 0x22, 0x72, 0x7e, 0x7c];

    fn riff(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let chunk = |(name, content): &(&[u8; 4], &[u8])| {
            [&name[..], &(content.len() as u32).to_le_bytes(), content, &[0][..content.len() % 2]].concat()
        };
        let chunks: Vec<u8> = chunks.iter().flat_map(chunk).collect();
        [b"RIFF", &(chunks.len() as u32 + 4).to_le_bytes()[..], b"WEBP", &chunks].concat()
    }

    /// A picture of four colours, the last of which has the given alpha.
    fn picture(alpha: u8) -> RgbaImage {
        let colours = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [9, 99, 199, alpha]];
        RgbaImage::from_fn(20, 14, |x, y| Rgba(colours[(x / 10 + y / 7 * 2) as usize]))
    }

    /// One file per format: its name, its number of channels, and its bytes.
    fn files() -> [(&'static str, usize, Vec<u8>); 4] {
        let raw = |encode: &dyn Fn(&mut Vec<u8>)| {
            let mut file = Vec::new();
            encode(&mut file);
            file
        };
        let rgb = image::DynamicImage::ImageRgba8(picture(255)).to_rgb8();
        [
            ("bmp", 3, raw(&|f| BmpEncoder::new(f).encode(&rgb, 20, 14, ExtendedColorType::Rgb8).unwrap())),
            (
                "webp",
                3,
                raw(&|f| WebPEncoder::new_lossless(f).write_image(&rgb, 20, 14, ExtendedColorType::Rgb8).unwrap()),
            ),
            (
                "webp with alpha",
                4,
                raw(&|f| {
                    let encoder = WebPEncoder::new_lossless(f);
                    encoder.write_image(&picture(128), 20, 14, ExtendedColorType::Rgba8).unwrap()
                }),
            ),
            (
                "gif",
                4,
                raw(&|f| {
                    // A GIF with a second frame, which the reader ignores.
                    let frames = [picture(255), RgbaImage::from_pixel(20, 14, Rgba([1, 2, 3, 255]))].map(Frame::new);
                    GifEncoder::new(f).encode_frames(frames).unwrap()
                }),
            ),
        ]
    }

    #[test]
    fn every_format_gives_its_colours_back() {
        for (name, channels, file) in files() {
            assert_eq!(probe(&file).unwrap(), (20, 14, channels), "{name}");
            let image = decode(&file, Encoding::Linear).unwrap();
            let wanted = picture(if name.contains("alpha") { 128 } else { 255 });
            for (pixel, wanted) in image.data.chunks(channels).zip(wanted.pixels()) {
                for (v, w) in pixel.iter().zip(wanted.0) {
                    assert!((v - f32::from(w) / 255.0).abs() < 1e-6, "{name}: {pixel:?} instead of {wanted:?}");
                }
            }
            // Read as sRGB, the colours are decoded by the curve, but alpha is not.
            let curved = decode_photo(&file, Encoding::Srgb).unwrap().image;
            assert!((curved.pixel(19, 13)[1] - srgb_to_linear(99.0 / 255.0)).abs() < 1e-6);
            assert!(channels == 3 || curved.pixel(19, 13)[3] == image.pixel(19, 13)[3]);
        }
        let lossy = decode(&riff(&[(b"VP8 ", LOSSY)]), Encoding::Linear).unwrap();
        let extended = [&[16, 0, 0, 0][..], &[23, 0, 0, 15, 0, 0]].concat();
        let alpha = riff(&[(b"VP8X", &extended), (b"ALPH", ALPHA), (b"VP8 ", LOSSY)]);
        let alpha = decode(&alpha, Encoding::Linear).unwrap();
        for (x, wanted) in [(4, [0.97, 0.16, 0.1]), (20, [0.09, 0.23, 0.94])] {
            for (c, wanted) in wanted.into_iter().enumerate() {
                assert!((lossy.pixel(x, 8)[c] - wanted).abs() < 0.02 && (alpha.pixel(x, 8)[c] - wanted).abs() < 0.02);
            }
        }
        assert_eq!([4, 12].map(|y| alpha.pixel(9, y)[3]), [1.0, 128.0 / 255.0]);
    }

    #[test]
    fn truncated_files_are_errors() {
        let lossy = riff(&[(b"VP8 ", LOSSY)]);
        for (name, _, file) in files().into_iter().chain([("lossy webp", 3, lossy)]) {
            // Number of bytes without which decoding must fail. Files that are cut later may still be decoded: only the
            // first frame of a GIF is read, padding is ignored, and a lossy WebP whose picture is cut is decoded in
            // part.
            let needed = match name {
                "gif" => file.len() / 2,
                "lossy webp" => 30,
                _ => file.len() - 4,
            };
            for cut in 0..needed {
                assert!(decode(&file[..cut], Encoding::Srgb).is_err(), "{name} cut at {cut}");
            }
            // A changed byte may cause an error or change the picture, but it must not cause a panic.
            for at in 0..file.len().min(200) {
                for value in [0, 1, 127, 255] {
                    let mut bad = file.clone();
                    bad[at] = value;
                    if probe(&bad).is_ok_and(|(width, height, _)| width * height < 1 << 20) {
                        let _ = decode(&bad, Encoding::Srgb);
                    }
                }
            }
        }
    }

    #[test]
    fn lying_headers_are_refused_before_memory_is_taken() {
        let of = |name: &str| files().into_iter().find(|f| f.0 == name).unwrap().2;
        let mut bmp = of("bmp");
        bmp[18..26].copy_from_slice(&[0, 0, 1, 0, 0, 0, 1, 0]);
        assert!(probe(&bmp).unwrap_err().message.contains("65536"));
        let mut gif = of("gif");
        let frame = gif.windows(10).position(|w| w[0] == 0x2c && w[5..9] == [20, 0, 14, 0]).unwrap();
        gif[frame + 5..frame + 9].copy_from_slice(&[255; 4]);
        let error = probe(&gif).unwrap_err();
        assert!(error.kind == ErrorKind::Format && error.message.contains("65535 x 65535 pixels"), "{error}");
        // An animation whose canvas claims 2^24 pixels per side.
        let canvas = [&[2, 0, 0, 0][..], &[255; 6]].concat();
        let webp = riff(&[(b"VP8X", &canvas), (b"ANIM", &[0; 6]), (b"ANMF", &[0; 32])]);
        assert_eq!(probe(&webp).unwrap_err().kind, ErrorKind::Format);
    }
}
