//! Memory that codecs of others take, and without which they would end the process: asked for before they run, and
//! counted against the budget of whoever reads a file ([`super::working`]).
//!
//! The bounds are of what the crates `png`, `zune-jpeg`, `image-webp`, `gif`, `weezl` and `exr` allocate beside what
//! they are given.

use super::containers::riff_chunks;
use super::file_colour::icc::MAX_BYTES;
use super::{MAX_SIDE, no_memory};
use crate::error::Result;
use crate::reserve;
use exr::compression::Compression;
use exr::meta::BlockDescription;
use exr::meta::header::Header;
use image::ImageFormat;

/// An error if the system has no room for so many bytes.
pub fn check(bytes: usize) -> Result<()> {
    if reserve::has_room(bytes) { Ok(()) } else { Err(no_memory::<u8>(bytes)) }
}

/// For the pixels of a file of the crate `image`, which have memory themselves.
pub(super) fn check_pixels(
    file: &[u8],
    format: ImageFormat,
    width: usize,
    height: usize,
    pixel_bytes: usize,
) -> Result<()> {
    check(pixels(file, format, width, height, pixel_bytes))
}

/// Bytes for the pixels of a file of the crate `image` on their way.
pub(super) fn pixels(file: &[u8], format: ImageFormat, width: usize, height: usize, pixel_bytes: usize) -> usize {
    match format {
        // Of progressive ones the coefficients of four components, two bytes each, in blocks of up to 32 pixels; a row
        // of blocks.
        ImageFormat::Jpeg => (width + 32) * (8 * (height + 32) + 256),
        ImageFormat::WebP => webp(file, width, height),
        // The frame, where it is not as wide as the screen; LZW.
        ImageFormat::Gif => 5 * width * height + (1 << 20),
        _ => 16 * width * pixel_bytes + (1 << 20),
    }
}

/// For the scan lines of a Radiance file on their way.
pub(super) fn check_scanlines(columns: usize) -> Result<()> {
    check(scanlines(columns))
}

pub(super) fn scanlines(columns: usize) -> usize {
    16 * columns + (1 << 20)
}

/// For a WebP's pixels beside the picture itself.
fn webp(file: &[u8], width: usize, height: usize) -> usize {
    let has = |wanted: &[u8; 4]| riff_chunks(file).any(|(name, _)| name == wanted);
    // Of lossy ones Y, U and V in blocks of 16, and the file's partitions, of which one may lie about its 2^24 bytes.
    let lossy = 2 * (width + 16) * (height + 16) + 3 * file.len() + (17 << 20);
    if !has(b"VP8L") && !has(b"ALPH") && !has(b"ANMF") {
        return lossy;
    }
    // RGBA, of moving pictures twice; transforms and the choice of codes for blocks of 4 x 4 pixels; codes, of which
    // the shortest that have a table of 4 KiB take 12 bytes of the file.
    11 * width * height + 400 * file.len() + lossy
}

/// For the decompressors of a TIFF's pixels.
pub(super) fn check_unpacking() -> Result<()> {
    check(UNPACKING)
}

/// Bytes of the decompressors.
pub(super) const UNPACKING: usize = 1 << 20;

/// For a chunk of a PNG file beside its pixels. The pixels' are read bit by bit, a colour profile is unpacked, up to a
/// limit; nothing that deflate has packed is more than 1032 times as long.
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

/// Bytes that the decoder of PNG may take beside the pixels of a file of so many: chunks, which grow by doubling, a
/// row of the widest picture, and a colour profile.
pub(super) fn png_limit(file_bytes: usize) -> usize {
    file_bytes.saturating_mul(3).saturating_add(8 * MAX_SIDE).saturating_add(MAX_BYTES)
}

pub(super) fn check_profile(bytes: usize, has_tables: bool) -> Result<()> {
    check(profile(bytes, has_tables))
}

/// Bytes for a colour profile: its tables as floating-point numbers, the curves, and, of profiles with tables of
/// colours, the tables of a transform (33³ colours, curves of 2^16 values).
pub(super) fn profile(bytes: usize, has_tables: bool) -> usize {
    bytes.saturating_mul(32).saturating_add(if has_tables { 8 << 20 } else { 2 << 20 })
}

/// For a PNG file of so many bytes of pixels: what becomes of them, packed and as they are, which grow by doubling.
pub(super) fn check_packing(bytes: usize) -> Result<()> {
    check(bytes.saturating_mul(5))
}

/// Width and height of a block of an OpenEXR file, which may be larger than the picture.
fn block_size(header: &Header) -> [usize; 2] {
    match header.blocks {
        BlockDescription::Tiles(tiles) => [tiles.tile_size.0, tiles.tile_size.1],
        BlockDescription::ScanLines => [header.layer_size.0, header.compression.scan_lines_per_block()],
    }
}

/// Bytes of a whole block.
pub(super) fn block_bytes(header: &Header) -> usize {
    let [width, height] = block_size(header);
    width.saturating_mul(height).saturating_mul(header.channels.bytes_per_pixel)
}

/// For the first layer of an OpenEXR file: all of its samples, a block on its way through a decompressor, and lists of
/// blocks.
pub(super) fn check_layer(headers: &[Header]) -> Result<()> {
    check(layer(headers))
}

pub(super) fn layer(headers: &[Header]) -> usize {
    let Some(header) = headers.first() else { return 0 };
    let (width, height) = (header.layer_size.0, header.layer_size.1);
    let [block_width, block_height] = block_size(header);
    let channels = &header.channels;
    let transform = match header.compression {
        // 768 bytes for 8 x 8 pixels.
        Compression::DWAA(_) | Compression::DWAB(_) => 13 * channels.list.len(),
        _ => 0,
    };
    let block =
        (block_width.min(width) + 8) * (block_height.min(height) + 8) * (5 * channels.bytes_per_pixel + transform);
    let chunks: usize = headers.iter().map(|h| h.chunk_count).sum();
    let samples = width * height * channels.bytes_per_pixel;
    samples.saturating_add(block).saturating_add(block_bytes(header)).saturating_add(176 * chunks)
}

/// The blocks of an OpenEXR file as it is written here: tiles of so many pixels a side.
const TILE: usize = 64;

fn tiles(width: usize, height: usize) -> usize {
    width.div_ceil(TILE) * height.div_ceil(TILE)
}

/// For an OpenEXR file that is written, beside the bytes of [`longest_file`]: blocks on their way, and their list.
pub(super) fn check_blocks(width: usize, height: usize, channels: usize) -> Result<()> {
    check(8 * TILE * TILE * 4 * channels + 160 * tiles(width, height))
}

/// Bytes of an OpenEXR file of such numbers that no compression makes shorter, with so many of names and notes:
/// samples, and for each block its place and head.
pub(super) fn longest_file(width: usize, height: usize, channels: usize, texts: usize) -> usize {
    4 * channels * width * height + 32 * tiles(width, height) + 64 * channels + texts + 4096
}
