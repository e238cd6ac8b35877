//! Image files: PNG, JPEG, Radiance HDR and OpenEXR in; PNG and OpenEXR out. The only user of `image` and `exr`.
//!
//! A header that promises more than [`MAX_PIXELS`] is refused before anything is allocated for it.

use crate::error::{Error, ErrorKind, Result};
use crate::image::colour::{linear_to_srgb, srgb_to_linear, srgb8_table};
use crate::image::samples::Largest;
use crate::image::{Image, MAX_SIDE, room, try_collect, try_vec, try_with_capacity};
use exr::prelude as ex;
use image::{ImageDecoder, ImageFormat, ImageReader};
use std::io::Cursor;
use std::path::Path;

/// Largest image a file may hold: 2^28 pixels, a 16 k square.
pub const MAX_PIXELS: u64 = 1 << 28;

const EXR_MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// No compression of an OpenEXR file that can be read makes samples more times shorter (deflate: 1032, once PXR24 has left out a
/// quarter).
const DENSEST: usize = 1400;

/// Bytes of a tile that any file may have.
const LARGEST_TILE: usize = 64 << 20;

/// How the integers of a file are to be read. Floating-point files are always linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Srgb,
    /// Data that is no colour: normal maps, roughness, masks.
    Linear,
}

/// Reads a file with 1, 3 or 4 channels, as linear values.
pub fn load(path: &Path, encoding: Encoding) -> Result<Image> {
    decode(&read_file(path)?, encoding).map_err(|e| e.within(path.display()))
}

/// Reads a whole file.
pub fn read_file(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|e| {
        let is_memory = e.kind() == std::io::ErrorKind::OutOfMemory;
        let kind = if is_memory { ErrorKind::OutOfMemory } else { ErrorKind::Io };
        Error::new(kind, format!("{}: {e}", path.display()))
    })
}

/// Reads an image file held in memory.
pub fn decode(bytes: &[u8], encoding: Encoding) -> Result<Image> {
    if bytes.starts_with(&EXR_MAGIC) { decode_exr(bytes) } else { decode_raster(bytes, encoding) }
}

/// Width, height and largest number of channels of an image file, from its header alone: what decoding it will need.
pub fn probe(bytes: &[u8]) -> Result<(usize, usize, usize)> {
    if bytes.starts_with(&EXR_MAGIC) {
        let headers = exr_headers(bytes)?;
        let size = headers.iter().map(|h| (h.layer_size.0, h.layer_size.1, h.channels.list.len().min(4)));
        return size.max_by_key(|s| s.0 * s.1 * s.2).ok_or_else(|| Error::format("the OpenEXR file has no layers"));
    }
    let (_, decoder) = raster_decoder(bytes)?;
    let (width, height) = decoder.dimensions();
    Ok((width as usize, height as usize, usize::from(decoder.color_type().channel_count())))
}

fn check_size(width: u64, height: u64) -> Result<()> {
    if width == 0 || height == 0 || width > MAX_SIDE as u64 || height > MAX_SIDE as u64 || width * height > MAX_PIXELS {
        return Err(Error::format(format!(
            "the header says {width} x {height} pixels; sides must lie in [1, {MAX_SIDE}] and the area in [1, {MAX_PIXELS}]"
        )));
    }
    Ok(())
}

fn raster_decoder(bytes: &[u8]) -> Result<(ImageFormat, impl ImageDecoder + '_)> {
    let format = image::guess_format(bytes)
        .map_err(|_| Error::format("not a PNG, JPEG, Radiance HDR or OpenEXR file".to_string()))?;
    if format == ImageFormat::Png {
        check_chunks(bytes)?;
    }
    let decoder = ImageReader::with_format(Cursor::new(bytes), format).into_decoder().map_err(broken_raster)?;
    let (width, height) = decoder.dimensions();
    check_size(width.into(), height.into())?;
    Ok((format, decoder))
}

/// The decoder takes for granted that a PNG's palette holds whole colours, and takes memory for other chunks as they come.
fn check_chunks(bytes: &[u8]) -> Result<()> {
    let mut chunks = bytes.get(8..).unwrap_or_default();
    while let Some((&[a, b, c, d, ref name @ ..], rest)) = chunks.split_first_chunk::<8>() {
        let length = u32::from_be_bytes([a, b, c, d]) as usize;
        if name == b"PLTE" && !(length % 3 == 0 && (1..=256).contains(&(length / 3))) {
            return Err(Error::format(format!(
                "the PNG's palette has {length} bytes; it must hold 1 to 256 colours of 3"
            )));
        }
        room::check_chunk(name, length.min(rest.len()))?;
        // Beyond its content lie four bytes of a checksum.
        chunks = rest.get(length.saturating_add(4)..).unwrap_or_default();
    }
    Ok(())
}

fn broken_raster(e: image::ImageError) -> Error {
    if let image::ImageError::IoError(io) = &e
        && io.kind() == std::io::ErrorKind::OutOfMemory
    {
        return Error::new(ErrorKind::OutOfMemory, "could not allocate memory to decode the file");
    }
    Error::format(format!("the file cannot be decoded: {e}"))
}

fn decode_raster(bytes: &[u8], encoding: Encoding) -> Result<Image> {
    let (format, decoder) = raster_decoder(bytes)?;
    let (width, height) = decoder.dimensions();
    let colour = decoder.color_type();
    let mut raw = try_vec(usize::try_from(decoder.total_bytes()).unwrap_or(usize::MAX), 0u8)?;
    room::check_pixels(format, width as usize, height as usize, usize::from(colour.bytes_per_pixel()))?;
    decoder.read_image(&mut raw).map_err(broken_raster)?;

    // Grey with alpha becomes RGBA.
    let given = usize::from(colour.channel_count());
    let channels = if given == 2 { 4 } else { given };
    let mut out = Image::new(width as usize, height as usize, channels)?;
    let mut fill = |value: &dyn Fn(usize, bool) -> f32| {
        for (i, pixel) in out.data.chunks_exact_mut(channels).enumerate() {
            for (c, sample) in pixel.iter_mut().enumerate() {
                let from = if given == 2 { c / 3 } else { c };
                *sample = value(i * given + from, c == 3);
            }
        }
    };
    // Integers in sRGB decode through a table or the curve; everything else is scaled only.
    let is_curved = encoding == Encoding::Srgb && format != ImageFormat::Hdr;
    let curve = |v: f32, is_alpha: bool| if is_curved && !is_alpha { srgb_to_linear(v) } else { v };
    match usize::from(colour.bytes_per_pixel()) / given {
        1 => {
            let linear: [f32; 256] = std::array::from_fn(|i| i as f32 / 255.0);
            let table = if is_curved { srgb8_table() } else { linear };
            fill(&|i, is_alpha| (if is_alpha { &linear } else { &table })[usize::from(raw[i])]);
        }
        2 => fill(&|i, is_alpha| curve(f32::from(sample(&raw, i, u16::from_ne_bytes)) / 65_535.0, is_alpha)),
        _ => fill(&|i, is_alpha| curve(sample(&raw, i, f32::from_ne_bytes), is_alpha)),
    }
    Ok(out)
}

/// The sample of a number of bytes at an index.
fn sample<const N: usize, T>(raw: &[u8], index: usize, of: fn([u8; N]) -> T) -> T {
    of(std::array::from_fn(|k| raw[index * N + k]))
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

/// Writes a whole file, or leaves what was there before: the bytes go to a neighbour first, then take its place.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let failed = |e: std::io::Error| Error::new(ErrorKind::Io, format!("{}: {e}", path.display()));
    let mut neighbour = path.as_os_str().to_owned();
    neighbour.push(format!(".{}.part", std::process::id()));
    std::fs::write(&neighbour, bytes).and_then(|()| std::fs::rename(&neighbour, path)).map_err(|e| {
        let _ = std::fs::remove_file(&neighbour);
        failed(e)
    })
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
