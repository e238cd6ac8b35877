//! Picture files: PNG, JPEG, WebP, TIFF, BMP, GIF, Radiance HDR and OpenEXR in; PNG and OpenEXR out. With `raster` and `samples` the
//! only user of `image` and `exr`.
//!
//! A header that promises more than [`MAX_PIXELS`] is refused before anything is allocated for it. Colour profiles (ICC) are not
//! applied: integers are taken as sRGB, or as they are. So the saturated colours of a photo in Display P3 or Adobe RGB come out
//! paler than they were; greys, and light near white, do not change.

pub use super::files::{Target, check_regular, read_file, write_file};
use crate::error::{Error, ErrorKind, Result};
use crate::image::colour::linear_to_srgb;
use crate::image::format::Format;
use crate::image::photo::{self, Orientation, PhotoMetadata};
use crate::image::samples::Largest;
use crate::image::{Image, MAX_SIDE, raster, room, tiff, try_collect, try_with_capacity};
use exr::prelude as ex;
use image::ImageFormat;
use std::io::Cursor;
use std::path::Path;

/// Largest image a file may hold: 2^28 pixels, a 16 k square.
pub const MAX_PIXELS: u64 = 1 << 28;

pub(super) const EXR_MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// No compression of an OpenEXR or TIFF file that can be read makes samples more times shorter (deflate: 1032, once PXR24 has left
/// out a quarter; LZW: 1330).
pub(super) const DENSEST: usize = 1400;

/// Bytes of a tile that any file may have.
const LARGEST_TILE: usize = 64 << 20;

/// How the integers of a file are to be read. Floating-point files are always linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Srgb,
    /// Data that is no colour: normal maps, roughness, masks.
    Linear,
}

/// A picture that stands upright, and what its file says of the camera.
#[derive(Clone, Debug)]
pub struct Photo {
    pub image: Image,
    pub metadata: PhotoMetadata,
}

/// Reads a file with 1, 3 or 4 channels, as linear values, upright.
pub fn load(path: &Path, encoding: Encoding) -> Result<Image> {
    decode_photo(&read_file(path)?, encoding).map(|photo| photo.image).map_err(|e| e.within(path.display()))
}

/// Reads a picture file held in memory, its rows and columns as they are stored.
pub fn decode(bytes: &[u8], encoding: Encoding) -> Result<Image> {
    decode_turned(bytes, encoding, Orientation::UPRIGHT)
}

/// Reads a picture file held in memory, and puts it upright by what the camera wrote into it.
pub fn decode_photo(bytes: &[u8], encoding: Encoding) -> Result<Photo> {
    let exif = match Format::of(bytes)? {
        Format::Exr => photo::Exif::default(),
        Format::Tiff | Format::Raster(_) => photo::read(bytes),
    };
    let image = decode_turned(bytes, encoding, exif.orientation)?;
    let metadata = PhotoMetadata::new(&exif, image.width, image.height);
    Ok(Photo { image, metadata })
}

fn decode_turned(bytes: &[u8], encoding: Encoding, orientation: Orientation) -> Result<Image> {
    match Format::of(bytes)? {
        Format::Exr => decode_exr(bytes),
        Format::Tiff => tiff::decode(bytes, encoding, orientation),
        Format::Raster(format) => raster::decode(bytes, format, encoding, orientation),
    }
}

/// Width, height and largest number of channels of a picture file, from its header alone: what decoding it will need. The sides are
/// those of the stored picture, not of the upright one.
pub fn probe(bytes: &[u8]) -> Result<(usize, usize, usize)> {
    match Format::of(bytes)? {
        Format::Exr => {
            let headers = exr_headers(bytes)?;
            let size = headers.iter().map(|h| (h.layer_size.0, h.layer_size.1, h.channels.list.len().min(4)));
            size.max_by_key(|s| s.0 * s.1 * s.2).ok_or_else(|| Error::format("the OpenEXR file has no layers"))
        }
        Format::Tiff => tiff::probe(bytes),
        Format::Raster(format) => raster::probe(bytes, format),
    }
}

pub(super) fn check_size(width: u64, height: u64) -> Result<()> {
    if width == 0 || height == 0 || width > MAX_SIDE as u64 || height > MAX_SIDE as u64 || width * height > MAX_PIXELS {
        return Err(Error::format(format!(
            "the header says {width} x {height} pixels; sides must lie in [1, {MAX_SIDE}] and the area in [1, {MAX_PIXELS}]"
        )));
    }
    Ok(())
}

pub(super) fn broken_exr(e: exr::error::Error) -> Error {
    let is_memory = matches!(&e, exr::error::Error::Io(e) if e.kind() == std::io::ErrorKind::OutOfMemory);
    let kind = if is_memory { ErrorKind::OutOfMemory } else { ErrorKind::Format };
    Error::new(kind, format!("the OpenEXR file cannot be decoded: {e}"))
}

pub(super) fn exr_headers(bytes: &[u8]) -> Result<exr::meta::Headers> {
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(broken_exr)?;
    for header in &meta.headers {
        let (width, height) = (header.layer_size.0, header.layer_size.1);
        check_size(width as u64, height as u64)?;
        // Memory is taken for all channels before the first of them is read.
        if (width * height).saturating_mul(header.channels.bytes_per_pixel) > bytes.len().saturating_mul(DENSEST) {
            return Err(Error::format("the OpenEXR header promises more than so short a file can hold"));
        }
        // Tiles may be larger than the picture; memory is taken for as much of one as the file says that it stores.
        let tile = room::block_bytes(header);
        if tile > bytes.len().saturating_mul(DENSEST).max(LARGEST_TILE) {
            return Err(Error::format(format!(
                "the OpenEXR header asks for tiles of {tile} bytes, which so short a file cannot hold"
            )));
        }
    }
    Ok(meta.headers)
}

/// The first layer of a file whose headers have been looked at, with all of its channels.
pub(super) fn first_exr_layer(
    bytes: &[u8],
    headers: &exr::meta::Headers,
) -> Result<ex::Layer<ex::AnyChannels<ex::FlatSamples>>> {
    use ex::{ReadChannels, ReadLayers};
    room::check_layer(headers)?;
    let file = exr::image::read::any_channels::ReadAnyChannels { read_samples: Largest }
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes));
    Ok(file.map_err(broken_exr)?.layer_data)
}

/// The first layer that has R, G and B (and A), or one with a single channel.
fn decode_exr(bytes: &[u8]) -> Result<Image> {
    let layer = first_exr_layer(bytes, &exr_headers(bytes)?)?;
    let list = &layer.channel_data.list;
    let find = |name: &str| list.iter().find(|c| c.name.eq_case_insensitive(name));
    let channels: Vec<_> = match (find("R"), find("G"), find("B"), find("A")) {
        (Some(r), Some(g), Some(b), Some(a)) => vec![r, g, b, a],
        (Some(r), Some(g), Some(b), None) => vec![r, g, b],
        _ if list.len() == 1 => vec![&list[0]],
        _ => {
            return Err(Error::new(
                ErrorKind::Unsupported,
                "the OpenEXR layer has neither R, G, B nor one single channel",
            ));
        }
    };
    let mut out = Image::new(layer.size.0, layer.size.1, channels.len())?;
    for (c, channel) in channels.iter().enumerate() {
        for (o, v) in out.data.iter_mut().skip(c).step_by(channels.len()).zip(channel.sample_data.values_as_f32()) {
            *o = v;
        }
    }
    Ok(out)
}

/// Encodes a linear image as an 8-bit sRGB PNG after multiplying it by `exposure`; 1, 3 or 4 channels.
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
    room::check_packing(bytes.len())?;
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
    Ok(out.into_inner())
}

/// One named group of channels of an OpenEXR file; an empty name gives plain `R`, `G`, `B`.
pub struct Layer<'a> {
    pub name: &'a str,
    pub image: &'a Image,
    /// One letter or word per channel: `["R", "G", "B"]`, `["Z"]`, `["X", "Y", "Z"]`.
    pub channels: &'a [&'a str],
}

/// Encodes layers of one size into a single-part 32-bit float OpenEXR file, channels named `layer.channel`. `notes` are
/// texts kept in its header, by name.
pub fn encode_exr(layers: &[Layer], notes: &[(String, String)]) -> Result<Vec<u8>> {
    use ex::WritableImage;
    // Texts of OpenEXR files are UTF-8.
    let text = |text: &str| ex::Text::from_slice_unchecked(text.as_bytes());
    let first = layers.first().ok_or_else(|| Error::argument("an OpenEXR file needs at least one layer"))?.image;
    let mut list = ex::SmallVec::<[ex::AnyChannel<ex::FlatSamples>; 4]>::new();
    for layer in layers {
        first.check_same_size("the first layer", layer.image, layer.name)?;
        if layer.channels.len() != layer.image.channels {
            return Err(Error::argument(format!(
                "layer {} has {} channels and {} channel names",
                layer.name,
                layer.image.channels,
                layer.channels.len()
            )));
        }
        for (c, channel) in layer.channels.iter().enumerate() {
            let name = if layer.name.is_empty() { channel.to_string() } else { format!("{}.{channel}", layer.name) };
            let samples = try_collect(layer.image.data.iter().skip(c).step_by(layer.image.channels).copied())?;
            list.push(ex::AnyChannel::new(text(&name), ex::FlatSamples::F32(samples)));
        }
    }
    let mut file = ex::Image::from_channels((first.width, first.height), ex::AnyChannels::sort(list));
    for (name, note) in notes {
        file.layer_data.attributes.other.insert(text(name), ex::AttributeValue::Text(text(note)));
    }
    let channels = layers.iter().map(|l| l.channels.len()).sum::<usize>();
    let texts = notes.iter().map(|(name, note)| name.len() + note.len() + 64).sum::<usize>() + 64 * channels;
    let (width, height) = (first.width, first.height);
    let mut out = Cursor::new(try_with_capacity(room::longest_file(width, height, channels, texts))?);
    room::check_blocks(width, height, channels)?;
    file.write()
        .non_parallel()
        .to_buffered(&mut out)
        .map_err(|e| Error::new(ErrorKind::Internal, format!("the OpenEXR encoder failed: {e}")))?;
    Ok(out.into_inner())
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
    fn truncated_and_lying_files_are_errors() {
        let image = picture();
        let png = encode_png(&image, 1.0).unwrap();
        let exr = encode_exr(&[Layer { name: "", image: &image, channels: &["R", "G", "B"] }], &[]).unwrap();
        for file in [&png, &exr] {
            assert_eq!(probe(file).unwrap(), (19, 13, 3));
            for cut in [0, 1, 4, 8, 20, file.len() / 2, file.len() - 20] {
                assert!(decode(&file[..cut], Encoding::Srgb).is_err(), "cut at {cut}");
            }
        }
        // One whose tiles claim 2^20 pixels a side.
        let mut bomb = exr.clone();
        let at = exr.windows(15).position(|w| w == b"tiles\0tiledesc\0").unwrap() + 15 + 4;
        assert_eq!(bomb[at..at + 8], [64, 0, 0, 0, 64, 0, 0, 0]);
        bomb[at..at + 8].copy_from_slice(&[0, 0, 16, 0, 0, 0, 16, 0]);
        let error = probe(&bomb).unwrap_err();
        assert!(error.kind == ErrorKind::Format && error.message.contains("tiles of"), "{error}");
        // A PNG whose header claims 2^31 - 1 pixels a side.
        let mut bomb = png.clone();
        bomb[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
        assert_eq!(decode(&bomb, Encoding::Srgb).unwrap_err().kind, ErrorKind::Format);
        // An OpenEXR file both of whose windows claim 16384 pixels a side.
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
        // The table with the place of the only tile, which begins with its column, its row and its level in both directions. It has one
        // pixel at all levels.
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
