//! Reads and writes picture files: reads PNG, JPEG, WebP, TIFF, BMP, GIF, Radiance HDR and OpenEXR; writes PNG and
//! OpenEXR.
//!
//! A header that claims more than [`MAX_PIXELS`] is refused before any allocation. Photos are converted from the
//! colour space that their file states to linear Rec.709 ([`super::file_colour`]). Textures and data are not
//! converted: glTF requires readers to ignore the colour space of textures (2.0, 3.8.3).

pub use super::files::{Target, check_regular, read_file, write_file};
pub use super::limits::{Encoding, MAX_PIXELS};
use crate::error::{Error, ErrorKind, Result};
use crate::image::colour::linear_to_srgb;
use crate::image::file_colour::{Conversion, FileColour, Space};
use crate::image::format::Format;
use crate::image::orientation::Orientation;
use crate::image::photo::{self, PhotoMetadata};
use crate::image::{Image, inks, memory, openexr, radiance, raster, stated_space, tiff, try_with_capacity};
use image::ImageFormat;
use std::io::Cursor;
use std::path::Path;

pub use crate::image::openexr::{Layer, encode as encode_exr};
pub use crate::image::working_memory::working_bytes;

/// A picture in linear Rec.709, turned upright, with the metadata of its file.
#[derive(Clone, Debug)]
pub struct Photo {
    pub image: Image,
    pub metadata: PhotoMetadata,
}

/// Reads a picture file from disk as 1, 3 or 4 channels of linear values, turned upright.
pub fn load(path: &Path, encoding: Encoding) -> Result<Image> {
    decode_photo(&read_file(path)?, encoding).map(|photo| photo.image).map_err(|e| e.context(path.display()))
}

/// Decodes a picture file in memory to linear values. The EXIF orientation is ignored, and colours are not converted
/// from the space that the file states: integers of [`Encoding::Srgb`] count as sRGB.
pub fn decode(bytes: &[u8], encoding: Encoding) -> Result<Image> {
    match Format::of(bytes)? {
        Format::Exr => Ok(openexr::decode(bytes)?.0),
        Format::Radiance => Ok(radiance::decode(bytes)?.0),
        Format::Tiff => tiff::decode(bytes, encoding, Orientation::UPRIGHT),
        Format::Raster(format) => raster::decode(bytes, format, encoding, Orientation::UPRIGHT),
    }
}

/// Decodes a picture file in memory, turns it upright by its EXIF orientation, and converts its colours to linear
/// Rec.709. Data ([`Encoding::Linear`]) are not converted.
pub fn decode_photo(bytes: &[u8], encoding: Encoding) -> Result<Photo> {
    let format = Format::of(bytes)?;
    let exif = match format {
        Format::Exr | Format::Radiance => photo::Exif::default(),
        Format::Tiff | Format::Raster(_) => photo::read(bytes),
    };
    let (image, colour) = match format {
        Format::Exr => convert(openexr::decode(bytes)?, encoding)?,
        Format::Radiance => convert(radiance::decode(bytes)?, encoding)?,
        Format::Tiff | Format::Raster(_) => {
            convert_stored(stated_space::of(bytes, format, &exif)?, encoding, |read| match (format, read) {
                (Format::Tiff, Read::Inks) => tiff::decode_inks(bytes, exif.orientation),
                (Format::Tiff, Read::Colours(encoding)) => tiff::decode(bytes, encoding, exif.orientation),
                (Format::Raster(raster), Read::Colours(encoding)) => {
                    raster::decode(bytes, raster, encoding, exif.orientation)
                }
                _ => inks::decode(bytes, exif.orientation),
            })?
        }
    };
    let metadata = PhotoMetadata::new(&exif, image.width, image.height, colour);
    Ok(Photo { image, metadata })
}

/// Converts linear colours from the space that their file states to linear Rec.709; data ([`Encoding::Linear`]) stay
/// unchanged. Also returns how the colours were interpreted.
fn convert((mut image, space): (Image, Space), encoding: Encoding) -> Result<(Image, FileColour)> {
    let colour = match space {
        _ if encoding == Encoding::Linear => FileColour::Data,
        Space::Unstated => FileColour::Assumed,
        Space::Native => FileColour::Stated,
        // A picture with one channel has no colour space.
        Space::Other(_) if image.channels < 3 => FileColour::Assumed,
        Space::Other(conversion) => {
            conversion.apply(&mut image)?;
            FileColour::Converted
        }
        Space::Unusable | Space::Inks(_) => FileColour::Unconverted,
    };
    Ok((image, colour))
}

/// The kind of samples that a decoder is asked to return.
enum Read {
    Colours(Encoding),
    /// Amounts of cyan, magenta, yellow and black.
    Inks,
}

/// Decodes a picture with `read`, and converts its colours to linear Rec.709 from the space that its file states. If
/// the file states none, integers count as sRGB and floating-point numbers as linear. Data ([`Encoding::Linear`]) stay
/// as stored.
fn convert_stored(
    space: Space,
    encoding: Encoding,
    read: impl Fn(Read) -> Result<Image>,
) -> Result<(Image, FileColour)> {
    let space = match space {
        Space::Inks(inks) if encoding == Encoding::Srgb => {
            return Ok((inks.apply(&read(Read::Inks)?)?, FileColour::Converted));
        }
        Space::Other(conversion) if encoding == Encoding::Srgb => {
            let mut image = read(Read::Colours(Encoding::Linear))?;
            let fits = conversion.fits(image.channels);
            let conversion = if fits { conversion } else { Conversion::srgb()? };
            conversion.apply(&mut image)?;
            return Ok((image, if fits { FileColour::Converted } else { FileColour::Unconverted }));
        }
        space => space,
    };
    convert((read(Read::Colours(encoding))?, space), encoding)
}

/// Returns width, height and an upper bound of the number of channels of a picture file, from its header alone. Width
/// and height belong to the stored picture, before it is turned upright.
pub fn probe(bytes: &[u8]) -> Result<(usize, usize, usize)> {
    match Format::of(bytes)? {
        Format::Exr => openexr::probe(bytes),
        Format::Radiance => radiance::probe(bytes),
        Format::Tiff => tiff::probe(bytes),
        Format::Raster(format) => raster::probe(bytes, format),
    }
}

/// Encodes a linear image of 1, 3 or 4 channels as an 8-bit sRGB PNG. The colours are first multiplied by `exposure`;
/// the fourth channel is alpha and is stored as it is.
pub fn encode_png(image: &Image, exposure: f32) -> Result<Vec<u8>> {
    let colour = match image.channels {
        1 => image::ExtendedColorType::L8,
        3 => image::ExtendedColorType::Rgb8,
        4 => image::ExtendedColorType::Rgba8,
        n => return Err(Error::argument(format!("a PNG cannot hold {n} channels; it must be 1, 3 or 4"))),
    };
    let mut bytes = crate::image::try_vec(image.data.len(), 0u8)?;
    for (i, (b, &v)) in bytes.iter_mut().zip(&image.data).enumerate() {
        let alpha = image.channels == 4 && i % 4 == 3;
        let encoded = if alpha { v } else { linear_to_srgb(v * exposure) };
        *b = (encoded.clamp(0.0, 1.0) * 255.0).round() as u8;
    }
    memory::check_packing(bytes.len())?;
    let mut out = Cursor::new(Vec::new());
    image::write_buffer_with_format(
        &mut out,
        &bytes,
        image.width as u32,
        image.height as u32,
        colour,
        ImageFormat::Png,
    )
    .map_err(|e| Error::new(ErrorKind::Internal, format!("the PNG encoder failed: {e}")))?;
    state_srgb(out.get_ref())
}

/// Inserts an `sRGB` chunk into a PNG, with the relative colorimetric rendering intent.
fn state_srgb(png: &[u8]) -> Result<Vec<u8>> {
    const CHUNK: [u8; 13] = *b"\0\0\0\x01sRGB\x01\xd9\xc9\x2c\x7f";
    // Insert the chunk after the signature and the header chunk.
    let (head, pixels) = png.split_at(8 + 25);
    let parts = [head, &CHUNK, pixels];
    let mut out = try_with_capacity(parts.iter().map(|part| part.len()).sum())?;
    parts.iter().for_each(|part| out.extend_from_slice(part));
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> Image {
        Image::from_fn(19, 13, |x, y| [x as f32 / 18.0, y as f32 / 12.0, 0.5]).unwrap()
    }

    #[test]
    fn png_and_exr_round_trip() {
        let image = picture();
        let png = decode(&encode_png(&image, 1.0).unwrap(), Encoding::Srgb).unwrap();
        assert!(png.data.iter().zip(&image.data).all(|(a, b)| (a - b).abs() < 0.01));
        let exr = encode_exr(&[Layer { name: "", image: &image, channels: &["R", "G", "B"] }], &[]).unwrap();
        assert_eq!(decode(&exr, Encoding::Srgb).unwrap(), image);
    }

    #[test]
    fn truncated_and_inconsistent_files_are_errors() {
        let image = picture();
        let png = encode_png(&image, 1.0).unwrap();
        let exr = encode_exr(&[Layer { name: "", image: &image, channels: &["R", "G", "B"] }], &[]).unwrap();
        for file in [&png, &exr] {
            assert_eq!(probe(file).unwrap(), (19, 13, 3));
            for cut in [0, 1, 4, 8, 20, file.len() / 2, file.len() - 20] {
                assert!(decode(&file[..cut], Encoding::Srgb).is_err(), "cut at {cut}");
            }
        }
        // An OpenEXR file whose tiles claim 2^20 pixels per side.
        let mut bomb = exr.clone();
        let at = exr.windows(15).position(|w| w == b"tiles\0tiledesc\0").unwrap() + 15 + 4;
        assert_eq!(bomb[at..at + 8], [64, 0, 0, 0, 64, 0, 0, 0]);
        bomb[at..at + 8].copy_from_slice(&[0, 0, 16, 0, 0, 0, 16, 0]);
        let error = probe(&bomb).unwrap_err();
        assert!(error.kind == ErrorKind::Format && error.message.contains("tiles of"), "{error}");
        // A PNG whose header claims 2^31 - 1 pixels per side.
        let mut bomb = png.clone();
        bomb[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
        assert_eq!(decode(&bomb, Encoding::Srgb).unwrap_err().kind, ErrorKind::Unsupported);
        // An OpenEXR file whose display and data window claim 16384 pixels per side.
        let mut bomb = exr.clone();
        let window = |width: i32, height: i32| [0, 0, width - 1, height - 1].map(i32::to_le_bytes).concat();
        let places: Vec<usize> = (0..exr.len() - 16).filter(|&at| exr[at..at + 16] == window(19, 13)).collect();
        assert_eq!(places.len(), 2);
        places.iter().for_each(|&at| bomb[at..at + 16].copy_from_slice(&window(1 << 14, 1 << 14)));
        let error = probe(&bomb).unwrap_err();
        assert!(error.kind == ErrorKind::Format && error.message.contains("promises more"), "{error}");
        assert_eq!(load(Path::new("/nonexistent.png"), Encoding::Srgb).unwrap_err().kind, ErrorKind::Io);
    }

    #[test]
    fn a_tile_of_a_resolution_that_the_file_has_not_is_refused() {
        let image = Image::from_fn(1, 1, |_, _| [0.5]).unwrap();
        let mut exr = encode_exr(&[Layer { name: "", image: &image, channels: &["Y"] }], &[]).unwrap();
        assert_eq!(decode(&exr, Encoding::Srgb).unwrap(), image);
        // Find the offset table, which has one entry. The only tile follows the table, and begins with its column, its
        // row, and its resolution level along x and along y. Change the level along x from 0 to 10. This picture of one
        // pixel has one pixel at level 10, too, so only the level itself is wrong.
        let table = (0..exr.len() - 8).find(|&at| exr[at..at + 8] == (at as u64 + 8).to_le_bytes()).unwrap();
        assert_eq!(exr[table + 8..table + 24], [0; 16]);
        exr[table + 16] = 10;
        let error = decode(&exr, Encoding::Srgb).unwrap_err();
        assert!(error.kind == ErrorKind::Format && error.message.contains("is not where"), "{error}");
    }

    #[test]
    fn a_palette_that_ends_within_a_colour_is_refused() {
        let file =
            b"\x89PNG\x0d\x0a\x1a\x0a\x00\x00\x00\x0dIHDR\x00\x00\x00\x04\x00\x00\x00\x04\x02\x03\x00\x00\x00\xd4\x9fv\
            \xed\x00\x00\x001PLTE\x00\x01\x02\x03\x04\x05\x06\x07\x08\x09\x0a\x0b\x0c\x0d\x0e\x0f\x10\x11\x12\x13\
            \x14\x15\x16\x17\x1e\x18iCCP\x1d\x1e\x1f !\"#$%&'()*+,-./\xad\x97\x8e\xef\x00\x00\x00\x09tR\x00\x00S\x00\
            \x00N\x00\x00\x00\x00\x00sd\x9b\xa1\x00\x00\x00\x10IDATx\x9cc``d`b`\xbcf\x00\x00\x00\x1c\x00\x07\xcf\xe3\
            \x82\xbb\x00\x00\x00\x00IEND\xaeB`\x82";
        assert_eq!(file[37..41], *b"PLTE");
        let error = decode(file, Encoding::Srgb).unwrap_err();
        assert!(error.kind == ErrorKind::Format && error.message.contains("49 bytes"), "{error}");
        assert!(probe(file).is_err());
    }
}
