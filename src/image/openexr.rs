//! OpenEXR files: reads flat layers of R, G, B (and A) or of a single channel; writes any layers. Only this module and
//! the modules `samples`, `numbers` and `exr_memory` use the crate `exr`.
//!
//! A picture has the size of the display window of its file. Pixels outside the data window are 0; pixels outside the
//! display window are dropped. Colours are converted from the chromaticities that the file states to linear Rec.709.
//!
//! Deep data and luminance with subsampled chroma are not read; the error names them. If a file has several
//! resolutions, the largest is read; if it has several parts, the first.

use super::file_colour::{Chromaticities, Space};
use super::limits::{MAX_COMPRESSION, check_size};
use super::samples::Largest;
use super::{Image, exr_memory, try_collect, try_with_capacity};
use crate::error::{Error, ErrorKind, Result};
use exr::meta::attribute;
use exr::prelude as ex;
use std::io::Cursor;

pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// The primaries that a file states if its R, G and B are CIE X, Y and Z. [convention]
const XYZ: [[f64; 2]; 3] = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];

/// Tiles of up to this many bytes are accepted in files of any length. A larger tile is refused if the file is too
/// short to contain it even at the maximum compression ratio.
const MAX_TILE_BYTES: usize = 64 << 20;

// The error is taken by value, because `map_err` passes it by value.
#[allow(clippy::needless_pass_by_value)]
pub(super) fn broken(e: exr::error::Error) -> Error {
    use exr::error::Error as Cause;
    match &e {
        Cause::Io(io) if io.kind() == std::io::ErrorKind::OutOfMemory => {
            Error::new(ErrorKind::OutOfMemory, format!("the OpenEXR file cannot be decoded: {e}"))
        }
        Cause::NotSupported(kind) => Error::new(
            ErrorKind::Unsupported,
            format!("the OpenEXR file is of a kind that is not read ({kind}): save it as flat R, G, B"),
        ),
        _ => Error::format(format!("the OpenEXR file cannot be decoded: {e}")),
    }
}

pub(super) fn headers(bytes: &[u8]) -> Result<exr::meta::Headers> {
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(broken)?;
    for header in &meta.headers {
        let (width, height) = (header.layer_size.0, header.layer_size.1);
        check_size(width as u64, height as u64)?;
        // Refuse a picture that so short a file cannot contain: the decoder allocates memory for all channels before it
        // reads the first one.
        if (width * height).saturating_mul(header.channels.bytes_per_pixel)
            > bytes.len().saturating_mul(MAX_COMPRESSION)
        {
            return Err(Error::format("the OpenEXR header promises more than so short a file can hold"));
        }
        // A tile may be larger than the picture, and the decoder allocates memory for the whole tile.
        let tile = exr_memory::block_bytes(header);
        if tile > bytes.len().saturating_mul(MAX_COMPRESSION).max(MAX_TILE_BYTES) {
            return Err(Error::format(format!(
                "the OpenEXR header asks for tiles of {tile} bytes, which so short a file cannot hold"
            )));
        }
    }
    Ok(meta.headers)
}

/// Decodes all channels of the first layer of a file whose headers have been checked.
pub(super) fn first_layer(
    bytes: &[u8],
    headers: &exr::meta::Headers,
) -> Result<ex::Layer<ex::AnyChannels<ex::FlatSamples>>> {
    use ex::{ReadChannels, ReadLayers};
    exr_memory::check_layer(headers)?;
    let file = exr::image::read::any_channels::ReadAnyChannels { read_samples: Largest }
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes));
    Ok(file.map_err(broken)?.layer_data)
}

/// Returns the display window, which all layers share.
fn display(headers: &exr::meta::Headers) -> Result<ex::IntegerBounds> {
    let header = headers.first().ok_or_else(|| Error::format("the OpenEXR file has no layers"))?;
    let window = header.shared_attributes.display_window;
    check_size(window.size.0 as u64, window.size.1 as u64)?;
    Ok(window)
}

/// Returns width, height and the largest number of channels of any layer, at most 4, from the headers.
pub(super) fn probe(bytes: &[u8]) -> Result<(usize, usize, usize)> {
    let headers = headers(bytes)?;
    let size = display(&headers)?.size;
    let channels = headers.iter().map(|h| h.channels.list.len().min(4)).max().unwrap_or(1);
    Ok((size.0, size.1, channels))
}

/// Bytes of memory for reading the first layer, in addition to the picture.
pub(super) fn working_bytes(bytes: &[u8]) -> Result<usize> {
    Ok(exr_memory::layer(&headers(bytes)?))
}

/// Decodes the first layer if it has R, G and B (and A) or a single channel; also returns the colour space that the
/// file states.
pub(super) fn decode(bytes: &[u8]) -> Result<(Image, Space)> {
    let headers = headers(bytes)?;
    let window = display(&headers)?;
    let layer = first_layer(bytes, &headers)?;
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
    let mut out = Image::new(window.size.0, window.size.1, channels.len())?;
    let place = Place::new(&layer, window);
    for (c, channel) in channels.iter().enumerate() {
        place.put(&mut out, c, &channel.sample_data);
    }
    let space = headers.first().map_or(Space::Unstated, |header| {
        space(header.shared_attributes.chromaticities, layer.attributes.adopted_neutral)
    });
    Ok((out, space))
}

/// The part of a layer (the data window) that lies within the picture (the display window).
struct Place {
    /// Width of the layer in pixels.
    width: usize,
    /// Column and row of the first pixel of this part, counted in the layer (`from`) and in the picture (`to`).
    from: [usize; 2],
    to: [usize; 2],
    size: [usize; 2],
}

impl Place {
    fn new<C>(layer: &ex::Layer<C>, window: ex::IntegerBounds) -> Self {
        let corner = layer.attributes.layer_position;
        // First column and row of the layer, relative to the picture.
        let start =
            [(corner.0, window.position.0), (corner.1, window.position.1)].map(|(a, b)| i64::from(a) - i64::from(b));
        let stored = [layer.size.0, layer.size.1];
        let shown = [window.size.0, window.size.1];
        let from = start.map(|s| (-s).max(0) as usize);
        let to = start.map(|s| s.max(0) as usize);
        let size = [0, 1].map(|k| stored[k].saturating_sub(from[k]).min(shown[k].saturating_sub(to[k])));
        Self { width: stored[0], from, to, size }
    }

    fn put(&self, out: &mut Image, channel: usize, samples: &ex::FlatSamples) {
        let mut copy = |value: &dyn Fn(usize) -> f32| {
            for y in 0..self.size[1] {
                let from = (self.from[1] + y) * self.width + self.from[0];
                let to = ((self.to[1] + y) * out.width + self.to[0]) * out.channels + channel;
                let row = out.data[to..].iter_mut().step_by(out.channels).take(self.size[0]);
                row.enumerate().for_each(|(x, v)| *v = value(from + x));
            }
        };
        if self.size.contains(&0) {
            return;
        }
        match samples {
            ex::FlatSamples::F16(samples) => copy(&|i| samples[i].to_f32()),
            ex::FlatSamples::F32(samples) => copy(&|i| samples[i]),
            ex::FlatSamples::U32(samples) => copy(&|i| samples[i] as f32),
        }
    }
}

/// Returns the colour space with the stated chromaticities, or with the chromaticities of Rec.709 if only `neutral` is
/// stated. Colours of the chromaticity `neutral` become white; without `neutral`, colours of the stated white do.
/// `Unstated` if the file states neither.
fn space(stated: Option<attribute::Chromaticities>, neutral: Option<ex::Vec2<f32>>) -> Space {
    let point = |v: ex::Vec2<f32>| [f64::from(v.0), f64::from(v.1)];
    let chromaticities = match stated {
        Some(c) => Chromaticities { primaries: [c.red, c.green, c.blue].map(point), white: point(c.white) },
        None if neutral.is_some() => Chromaticities::REC709,
        None => return Space::Unstated,
    };
    // For a picture in CIE XYZ, take D65 as white. The stated white (1/3, 1/3) only defines the coordinates.
    let is_xyz = chromaticities.primaries == XYZ;
    let white = if is_xyz { Chromaticities::REC709.white } else { chromaticities.white };
    let white = neutral.map_or(white, point);
    chromaticities.to_rec709_from_white(white).map_or(Space::Unusable, Space::linear)
}

/// A layer of an OpenEXR file: a named group of channels. With an empty name, the channels have no prefix, such as `R`.
pub struct Layer<'a> {
    pub name: &'a str,
    pub image: &'a Image,
    /// One letter or word per channel, such as `["R", "G", "B"]`, `["Z"]` or `["X", "Y", "Z"]`.
    pub channels: &'a [&'a str],
}

/// Encodes layers of equal size as a single-part OpenEXR file of 32-bit floats. Channels are named `layer.channel`. The
/// file states the chromaticities of Rec.709 if any layer has a channel `R`. `attributes` are text attributes of the
/// header, as (name, text).
pub fn encode(layers: &[Layer], attributes: &[(String, String)]) -> Result<Vec<u8>> {
    use ex::WritableImage;
    // Store texts as UTF-8, as OpenEXR prescribes.
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
    if layers.iter().any(|layer| layer.channels.contains(&"R")) {
        file.attributes.chromaticities = Some(rec709());
    }
    for (name, value) in attributes {
        file.layer_data.attributes.other.insert(text(name), ex::AttributeValue::Text(text(value)));
    }
    let channels = layers.iter().map(|l| l.channels.len()).sum::<usize>();
    let texts = attributes.iter().map(|(name, value)| name.len() + value.len() + 64).sum::<usize>() + 64 * channels;
    let (width, height) = (first.width, first.height);
    let mut out = Cursor::new(try_with_capacity(exr_memory::max_file_bytes(width, height, channels, texts))?);
    exr_memory::check_blocks(width, height, channels)?;
    file.write()
        .non_parallel()
        .to_buffered(&mut out)
        .map_err(|e| Error::new(ErrorKind::Internal, format!("the OpenEXR encoder failed: {e}")))?;
    Ok(out.into_inner())
}

/// Returns the chromaticities of Rec.709 as an attribute of the file.
fn rec709() -> attribute::Chromaticities {
    let point = |[x, y]: [f64; 2]| ex::Vec2(x as f32, y as f32);
    let [red, green, blue] = Chromaticities::REC709.primaries.map(point);
    attribute::Chromaticities { red, green, blue, white: point(Chromaticities::REC709.white) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::file_colour::FileColour;
    use crate::image::io::{Encoding, decode, decode_photo, probe};

    /// A file whose pixels have the red values 1, 2, 3 and so on. `corner` and `size` give its data window, `display`
    /// its display window.
    fn file(corner: [i32; 2], size: [usize; 2], display: ([i32; 2], [usize; 2])) -> Vec<u8> {
        colourful(corner, size, display, |_| ())
    }

    fn colourful(
        [x, y]: [i32; 2],
        [width, height]: [usize; 2],
        (origin, shown): ([i32; 2], [usize; 2]),
        change: impl FnOnce(&mut ex::Image<ex::Layer<ex::AnyChannels<ex::FlatSamples>>>),
    ) -> Vec<u8> {
        use ex::WritableImage;
        let samples = |factor: f32| ex::FlatSamples::F32((1..=width * height).map(|i| factor * i as f32).collect());
        let channels = [("B", 0.0), ("G", 0.0), ("R", 1.0)].map(|(name, v)| ex::AnyChannel::new(name, samples(v)));
        let mut file = ex::Image::from_channels((width, height), ex::AnyChannels::sort(channels.into_iter().collect()));
        file.layer_data.attributes.layer_position = ex::Vec2(x, y);
        file.attributes.display_window =
            ex::IntegerBounds::new(ex::Vec2(origin[0], origin[1]), ex::Vec2(shown[0], shown[1]));
        change(&mut file);
        let mut out = Cursor::new(Vec::new());
        file.write().non_parallel().to_buffered(&mut out).unwrap();
        out.into_inner()
    }

    fn red(file: &[u8]) -> Vec<i32> {
        let image = decode(file, Encoding::Srgb).unwrap();
        let (width, height, _) = probe(file).unwrap();
        assert_eq!((image.width, image.height), (width, height));
        image.data.chunks(3).map(|pixel| pixel[0] as i32).collect()
    }

    #[test]
    fn the_data_window_lies_in_the_display_window() {
        let display = ([10, 20], [4, 3]);
        // Positions of the data window relative to the picture: equal to it; inside it; beyond its top-left corner;
        // beyond its bottom-right corner; beyond all sides; outside it.
        assert_eq!(red(&file([10, 20], [4, 3], display)), (1..=12).collect::<Vec<i32>>());
        assert_eq!(red(&file([11, 21], [2, 1], display)), [0, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 0]);
        assert_eq!(red(&file([9, 19], [3, 2], display)), [5, 6, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(red(&file([12, 22], [5, 5], display)), [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2]);
        assert_eq!(red(&file([9, 19], [6, 6], display)), [8, 9, 10, 11, 14, 15, 16, 17, 20, 21, 22, 23]);
        for corner in [[0, 0], [14, 20], [10, 23], [-1_000_000, -1_000_000]] {
            assert_eq!(red(&file(corner, [2, 2], display)), [0; 12]);
        }
    }

    #[test]
    fn windows_past_the_limits_are_unsupported() {
        let bomb = file([0, 0], [1, 1], ([0, 0], [1 << 15, 1 << 14]));
        assert_eq!(probe(&bomb).unwrap_err().kind, ErrorKind::Unsupported);
    }

    #[test]
    fn chromaticities_are_converted_and_data_are_not() {
        let point = |x, y| ex::Vec2(x, y);
        // The chromaticities of ACEScg (S-2014-004) and ACES2065-1 (SMPTE ST 2065-1).
        let acescg = attribute::Chromaticities {
            red: point(0.713, 0.293),
            green: point(0.165, 0.830),
            blue: point(0.128, 0.044),
            white: point(0.32168, 0.33767),
        };
        let aces = attribute::Chromaticities {
            red: point(0.7347, 0.2653),
            green: point(0.0, 1.0),
            blue: point(0.0001, -0.077),
            ..acescg
        };
        // The red values follow from the matrices of the ACES system to linear Rec.709 with Bradford adaptation;
        // negative components become 0.
        for (chromaticities, wanted) in [(acescg, 1.705_05), (aces, 2.521_69)] {
            let bytes = colourful([0, 0], [1, 1], ([0, 0], [1, 1]), |f| {
                f.attributes.chromaticities = Some(chromaticities);
            });
            let photo = decode_photo(&bytes, Encoding::Srgb).unwrap();
            let pixel = photo.image.pixel(0, 0);
            assert!((pixel[0] - wanted).abs() < 2e-3 && pixel[1..] == [0.0, 0.0], "{pixel:?}");
            assert_eq!(photo.metadata.colour, FileColour::Converted);
            let data = decode_photo(&bytes, Encoding::Linear).unwrap();
            assert_eq!((data.image.pixel(0, 0), data.metadata.colour), (&[1.0, 0.0, 0.0][..], FileColour::Data));
        }
        // Read a pixel of an XYZ picture with X = 1 and Y = Z = 0, and check its red. The white is D65, with or without
        // a stated neutral.
        for neutral in [None, Some(point(0.3127, 0.3290))] {
            let xyz = colourful([0, 0], [1, 1], ([0, 0], [1, 1]), |f| {
                f.attributes.chromaticities = Some(attribute::Chromaticities {
                    red: point(1.0, 0.0),
                    green: point(0.0, 1.0),
                    blue: point(0.0, 0.0),
                    white: point(1.0 / 3.0, 1.0 / 3.0),
                });
                f.layer_data.attributes.adopted_neutral = neutral;
            });
            let photo = decode_photo(&xyz, Encoding::Srgb).unwrap();
            assert!((photo.image.pixel(0, 0)[0] - 3.240_97).abs() < 1e-3);
        }
    }
}
