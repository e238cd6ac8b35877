//! How the samples of a file are interpreted, and limits on the sizes that its header states.

use super::MAX_SIDE;
use crate::error::{Error, ErrorKind, Result};

/// Maximum number of pixels of a picture file: 2^28, a square of 16384 pixels.
pub const MAX_PIXELS: u64 = 1 << 28;

/// Upper bound of the compression ratio of OpenEXR and TIFF files. (Deflate reaches 1032, or 1376 after PXR24 has
/// dropped a quarter of the bytes; LZW reaches 1330.)
pub(super) const MAX_COMPRESSION: usize = 1400;

/// How the samples of a file are interpreted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Colours. Integers are sRGB and floating-point numbers linear, unless the file of a photo states another colour
    /// space.
    Srgb,
    /// Data other than colour, such as normal maps, roughness or masks, returned as stored.
    Linear,
}

/// Refuses pictures without pixels, pictures wider or higher than [`MAX_SIDE`], and pictures with more than
/// [`MAX_PIXELS`] pixels.
pub(super) fn check_size(width: u64, height: u64) -> Result<()> {
    let is_empty = width == 0 || height == 0;
    if is_empty || width > MAX_SIDE as u64 || height > MAX_SIDE as u64 || width * height > MAX_PIXELS {
        return Err(Error::new(
            if is_empty { ErrorKind::Format } else { ErrorKind::Unsupported },
            format!(
                "the header says {width} x {height} pixels; sides must lie in [1, {MAX_SIDE}] and the area in [1, \
                 {MAX_PIXELS}]"
            ),
        ));
    }
    Ok(())
}
