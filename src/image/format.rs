//! Detects the format of a picture file by its first bytes.

use super::{openexr, radiance};
use crate::error::{Error, ErrorKind, Result};
use image::ImageFormat;

/// The picture formats that can be read, grouped by decoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Exr,
    Radiance,
    Tiff,
    /// A format that the crate `image` decodes.
    Raster(ImageFormat),
}

/// Formats that cannot be read, but are recognised so that the error message can name them. Each entry holds the offset
/// of the signature, its bytes, and the name of the format.
const OTHERS: [(usize, &[u8], &str); 18] = [
    (4, b"ftypavif", "AVIF"),
    (4, b"ftypavis", "AVIF"),
    (4, b"ftypheic", "HEIC"),
    (4, b"ftypheix", "HEIC"),
    (4, b"ftyphevc", "HEIC"),
    (4, b"ftyphevx", "HEIC"),
    (4, b"ftypmif1", "HEIF"),
    (4, b"ftypmsf1", "HEIF"),
    (4, b"ftypcrx ", "raw (Canon CR3)"),
    (8, b"CR\x02\0", "raw (Canon CR2)"),
    (0, b"FUJIFILM", "raw (Fujifilm RAF)"),
    (0, b"IIU\0", "raw (Panasonic RW2)"),
    (0, b"IIRO", "raw (Olympus ORF)"),
    (0, b"II+\0", "BigTIFF"),
    (0, b"MM\0+", "BigTIFF"),
    (0, b"\0\0\0\x0cJXL ", "JPEG XL"),
    (0, b"\xff\x0a", "JPEG XL"),
    (0, b"8BPS", "Photoshop"),
];

impl Format {
    /// Detects the format of a file. If the format is known but cannot be read, the error names it.
    pub fn of(bytes: &[u8]) -> Result<Self> {
        let begins = |at: usize, with: &[u8]| bytes.get(at..).is_some_and(|rest| rest.starts_with(with));
        if let Some((.., name)) = OTHERS.iter().find(|(at, with, _)| begins(*at, with)) {
            return Err(Error::new(
                ErrorKind::Unsupported,
                format!("the file is in the format {name}, which is not read: convert it to JPEG, PNG, TIFF or WebP"),
            ));
        }
        if begins(0, &openexr::MAGIC) {
            return Ok(Self::Exr);
        }
        if radiance::MAGICS.iter().any(|magic| begins(0, magic)) {
            return Ok(Self::Radiance);
        }
        match image::guess_format(bytes) {
            Ok(ImageFormat::Tiff) => Ok(Self::Tiff),
            Ok(ImageFormat::WebP) if !cfg!(feature = "webp") => Err(Error::left_out("WebP files were", "webp")),
            Ok(
                format @ (ImageFormat::Png
                | ImageFormat::Jpeg
                | ImageFormat::WebP
                | ImageFormat::Bmp
                | ImageFormat::Gif),
            ) => Ok(Self::Raster(format)),
            _ => Err(Error::format("not a JPEG, PNG, WebP, TIFF, BMP, GIF, Radiance HDR or OpenEXR file")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_that_are_not_read_are_named() {
        for (file, name) in [
            (&b"\0\0\0\x1cftypavif\0\0\0\0mif1"[..], "AVIF"),
            (b"\0\0\0\x18ftypheic\0\0\0\0mif1heic", "HEIC"),
            (b"\0\0\0\x18ftypmif1\0\0\0\0mif1heic", "HEIF"),
            (b"\xff\x0a\xfa\x7f", "JPEG XL"),
            (b"II*\0\x10\0\0\0CR\x02\0", "CR2"),
            (b"II+\0\x08\0\0\0", "BigTIFF"),
        ] {
            let error = Format::of(file).unwrap_err();
            assert_eq!(error.kind, ErrorKind::Unsupported);
            assert!(error.message.contains(name) && error.message.contains("convert it to JPEG"), "{error}");
        }
        for file in [&b""[..], b"P6 1 1 255 abc", b"hello", b"\xff"] {
            assert_eq!(Format::of(file).unwrap_err().kind, ErrorKind::Format);
        }
        assert_eq!(Format::of(b"MM\0*\0\0\0\x08"), Ok(Format::Tiff));
    }
}
