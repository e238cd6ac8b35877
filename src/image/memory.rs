//! Upper bounds of the memory that third-party codecs need. These codecs abort the process if an allocation fails. The
//! memory is therefore checked before they run, and charged to the caller's memory budget ([`super::working_memory`]).
//!
//! The bounds follow the allocations of the crates `png`, `zune-jpeg`, `image-webp`, `gif` and `weezl`. They do not
//! include the buffers that this library passes to these crates. The bounds of the crate `exr` are in `exr_memory`.

use super::containers::riff_chunks;
use super::{MAX_SIDE, no_memory};
use crate::error::Result;
use crate::reserve;
use image::ImageFormat;

/// Maximum size in bytes of a colour profile; larger ones are ignored. Profiles of displays and cameras have a few
/// thousand bytes, profiles of scanners up to a million. [convention]
pub const MAX_PROFILE_BYTES: usize = 3 << 20;

/// Returns an error if the system cannot provide `bytes` bytes.
pub fn check(bytes: usize) -> Result<()> {
    if reserve::can_allocate(bytes) { Ok(()) } else { Err(no_memory::<u8>(bytes)) }
}

/// Checks that there is enough memory for the crate `image` to decode the pixels of a file, in addition to the picture
/// itself.
pub(super) fn check_pixels(
    file: &[u8],
    format: ImageFormat,
    width: usize,
    height: usize,
    pixel_bytes: usize,
) -> Result<()> {
    check(pixels(file, format, width, height, pixel_bytes))
}

/// Bytes that the crate `image` needs to decode the pixels of a file, in addition to the picture itself.
pub(super) fn pixels(file: &[u8], format: ImageFormat, width: usize, height: usize, pixel_bytes: usize) -> usize {
    match format {
        // Progressive files need the coefficients of four components, two bytes each, for the whole picture. The
        // picture is padded to blocks of up to 32 × 32 pixels. All files need a row of such blocks.
        ImageFormat::Jpeg => (width + 32) * (8 * (height + 32) + 256),
        ImageFormat::WebP => webp(file, width, height),
        // Per pixel: one byte for the index of its colour, and four bytes for a separate copy of the frame, which is
        // needed if the frame is narrower than the GIF's screen. One MiB for the tables of the LZW decoder.
        ImageFormat::Gif => 5 * width * height + (1 << 20),
        _ => 16 * width * pixel_bytes + (1 << 20),
    }
}

/// Checks that there is enough memory to decode the scan lines of a Radiance file with this many columns.
pub(super) fn check_scanlines(columns: usize) -> Result<()> {
    check(scanlines(columns))
}

pub(super) fn scanlines(columns: usize) -> usize {
    16 * columns + (1 << 20)
}

/// Bytes for decoding the pixels of a WebP file, in addition to the picture itself.
fn webp(file: &[u8], width: usize, height: usize) -> usize {
    let has = |wanted: &[u8; 4]| riff_chunks(file).any(|(name, _)| name == wanted);
    // Lossy files need Y, U and V of the picture, padded to blocks of 16 × 16 pixels, and copies of the partitions of
    // the file. One partition may claim 2^24 bytes.
    let lossy = 2 * (width + 16) * (height + 16) + 3 * file.len() + (17 << 20);
    if !has(b"VP8L") && !has(b"ALPH") && !has(b"ANMF") {
        return lossy;
    }
    // Lossless files, and files with alpha or animation, need more. Per pixel: RGBA (for animations two copies), the
    // transforms, and for each block of 4 x 4 pixels the index of its code tables. Per byte of the file: up to 340
    // bytes of code tables, since the shortest table takes 12 bytes in the file and 4 KiB in memory.
    11 * width * height + 400 * file.len() + lossy
}

/// Checks that there is enough memory for the decompressors of a TIFF file.
pub(super) fn check_unpacking() -> Result<()> {
    check(UNPACKING)
}

/// Bytes that the decompressors of a TIFF file need.
pub(super) const UNPACKING: usize = 1 << 20;

/// Checks that there is enough memory for a chunk of a PNG file. Chunks of pixels need none, because they are read
/// piece by piece. A colour profile is unpacked up to a limit; deflate expands it at most 1032 times.
pub(super) fn check_chunk(name: &[u8], length: usize, file_bytes: usize) -> Result<()> {
    check(chunk(name, length, file_bytes))
}

pub(super) fn chunk(name: &[u8], length: usize, file_bytes: usize) -> usize {
    match name {
        b"IDAT" | b"fdAT" => 0,
        b"iCCP" => length.saturating_mul(1032).min(png_limit(file_bytes)),
        _ => length,
    }
}

/// Bytes that the PNG decoder may need in addition to the pixels, for a file of `file_bytes` bytes: chunks, whose
/// buffers grow by doubling; a row of maximum width; and a colour profile.
pub(super) fn png_limit(file_bytes: usize) -> usize {
    file_bytes.saturating_mul(3).saturating_add(8 * MAX_SIDE).saturating_add(MAX_PROFILE_BYTES)
}

pub(super) fn check_profile(bytes: usize, has_tables: bool) -> Result<()> {
    check(profile(bytes, has_tables))
}

/// Bytes for reading a colour profile: its tables as floating-point numbers, its curves, and, if it has colour tables,
/// the tables of the transform made from them (33³ colours, curves of 2^16 values).
pub(super) fn profile(bytes: usize, has_tables: bool) -> usize {
    bytes.saturating_mul(32).saturating_add(if has_tables { 8 << 20 } else { 2 << 20 })
}

/// Checks that there is enough memory to write a PNG file with this many bytes of pixels: the compressed and the
/// uncompressed data, whose buffers grow by doubling.
pub(super) fn check_packing(bytes: usize) -> Result<()> {
    check(bytes.saturating_mul(5))
}
