//! Upper bounds of the memory that the crate `exr` needs for OpenEXR files, as [`super::memory`] has them for other
//! formats.

use super::memory::check;
use crate::error::Result;
use exr::compression::Compression;
use exr::meta::BlockDescription;
use exr::meta::header::Header;

/// Width and height in pixels of a block of an OpenEXR file, which may be larger than the picture.
fn block_size(header: &Header) -> [usize; 2] {
    match header.blocks {
        BlockDescription::Tiles(tiles) => [tiles.tile_size.0, tiles.tile_size.1],
        BlockDescription::ScanLines => [header.layer_size.0, header.compression.scan_lines_per_block()],
    }
}

/// Size in bytes of a whole block of an OpenEXR file.
pub(super) fn block_bytes(header: &Header) -> usize {
    let [width, height] = block_size(header);
    width.saturating_mul(height).saturating_mul(header.channels.bytes_per_pixel)
}

/// Checks that there is enough memory to read the first layer of an OpenEXR file: all its samples, a block in a
/// decompressor, and the lists of blocks.
pub(super) fn check_layer(headers: &[Header]) -> Result<()> {
    check(layer(headers))
}

pub(super) fn layer(headers: &[Header]) -> usize {
    let Some(header) = headers.first() else { return 0 };
    let (width, height) = (header.layer_size.0, header.layer_size.1);
    let [block_width, block_height] = block_size(header);
    let channels = &header.channels;
    let transform = match header.compression {
        // The DWA decoder holds up to 771 bytes per channel for each block of 8 x 8 pixels, 768 for coefficients and 3
        // for flags. These are 12.05 bytes per pixel, rounded up to 13.
        Compression::DWAA(_) | Compression::DWAB(_) => 13 * channels.list.len(),
        _ => 0,
    };
    let block =
        (block_width.min(width) + 8) * (block_height.min(height) + 8) * (5 * channels.bytes_per_pixel + transform);
    let chunks: usize = headers.iter().map(|h| h.chunk_count).sum();
    let samples = width * height * channels.bytes_per_pixel;
    samples.saturating_add(block).saturating_add(block_bytes(header)).saturating_add(176 * chunks)
}

/// Side in pixels of the tiles in OpenEXR files that this library writes.
const TILE: usize = 64;

fn tiles(width: usize, height: usize) -> usize {
    width.div_ceil(TILE) * height.div_ceil(TILE)
}

/// Checks that there is enough memory to write an OpenEXR file: the blocks being compressed and the list of blocks.
/// The caller checks the memory for the file itself, [`max_file_bytes`].
pub(super) fn check_blocks(width: usize, height: usize, channels: usize) -> Result<()> {
    check(8 * TILE * TILE * 4 * channels + 160 * tiles(width, height))
}

/// Largest size in bytes of an OpenEXR file, reached if its samples cannot be compressed: the samples, an offset and a
/// head per block, and `texts` bytes of names and attributes.
pub(super) fn max_file_bytes(width: usize, height: usize, channels: usize, texts: usize) -> usize {
    4 * channels * width * height + 32 * tiles(width, height) + 64 * channels + texts + 4096
}
