//! Stores any number of `f64` values per pixel exactly, in OpenEXR files that each hold a window (a rectangle) of a
//! picture.
//!
//! The channels R, G and B hold the picture itself, so that any program can display it. The display window of the file
//! is the whole picture, and the data window is the window that the file holds. Each `f64` is stored in two channels
//! of 32-bit integers, `number.K.high` and `number.K.low`, because floating-point channels have at most 32 bits.
//! Further information is stored as text attributes of the header.

pub use super::file_header::FileHeader;
use super::io::check_regular;
use super::openexr::{broken, first_layer, headers};
use super::{Image, exr_memory, try_vec, try_with_capacity};
use crate::error::{Error, ErrorKind, Result};
use exr::meta::header::Header;
use exr::prelude as ex;
use std::fs::File;
use std::io::{BufReader, Cursor};
use std::path::Path;

impl FileHeader {
    fn of(headers: &[Header]) -> Result<Self> {
        let [header] = headers else {
            return Err(Error::format(format!("it has {} layers in place of one", headers.len())));
        };
        let (window, display) = (header.own_attributes.layer_position, header.shared_attributes.display_window);
        let size = [header.layer_size.0, header.layer_size.1];
        let corner = [window.0, window.1].map(|v| usize::try_from(v).ok());
        let origin = [display.position.0, display.position.1];
        let whole = [display.size.0, display.size.1];
        let ([Some(x), Some(y)], [0, 0]) = (corner, origin) else {
            return Err(Error::format("its windows begin left of or above the picture"));
        };
        if x.saturating_add(size[0]) > whole[0] || y.saturating_add(size[1]) > whole[1] {
            return Err(Error::format(format!(
                "its window of {} x {} pixels at {x}, {y} does not lie in the picture of {} x {}",
                size[0], size[1], whole[0], whole[1]
            )));
        }
        // The channels are sorted by name: B, G and R of the picture, then the high and the low half of each number.
        let channels = &header.channels.list;
        let numbers = channels.len().saturating_sub(3) / 2;
        for (i, channel) in channels.iter().enumerate() {
            let (name, kind) = match i {
                0..3 => (["B", "G", "R"][i].to_string(), ex::SampleType::F32),
                _ => (name((i - 3) / 2, i % 2 == 1), ex::SampleType::U32),
            };
            if !channel.name.eq(name.as_str()) || channel.sample_type != kind || channel.sampling != ex::Vec2(1, 1) {
                return Err(Error::format(format!("its channel {} is not {name} of {kind:?}", channel.name)));
            }
        }
        if channels.len() < 3 || channels.len() % 2 == 0 {
            return Err(Error::format(format!("it has {} channels", channels.len())));
        }
        let mut attributes: Vec<(String, String)> = Vec::new();
        for (name, value) in &header.own_attributes.other {
            if let ex::AttributeValue::Text(text) = value {
                attributes.push((utf8(name), utf8(text)));
            }
        }
        attributes.sort();
        Ok(Self { whole, corner: [x, y], size, numbers, attributes })
    }
}

fn utf8(text: &ex::Text) -> String {
    String::from_utf8_lossy(text.bytes()).into_owned()
}

/// Returns the name of the channel that holds the high or the low 32 bits of a number.
fn name(number: usize, is_high: bool) -> String {
    format!("number.{number:05}.{}", if is_high { "high" } else { "low" })
}

/// Reads the header of a file on disk.
pub fn read_header(path: &Path) -> Result<FileHeader> {
    check_regular(path)?;
    let file = File::open(path).map_err(|e| Error::new(ErrorKind::Io, format!("{}: {e}", path.display())))?;
    let meta = exr::meta::MetaData::read_from_buffered(BufReader::new(file), false).map_err(broken);
    meta.and_then(|meta| FileHeader::of(&meta.headers)).map_err(|e| e.context(path.display()))
}

/// Decodes a file and calls `pixel` for each pixel of the window, with the pixel's column and row in the window and its
/// `f64` values. The header of the file must equal `header`; otherwise the file is refused before memory is allocated
/// for its pixels.
pub fn decode(bytes: &[u8], header: &FileHeader, mut pixel: impl FnMut([usize; 2], &[f64])) -> Result<()> {
    let headers = headers(bytes)?;
    let found = FileHeader::of(&headers)?;
    if found != *header {
        return Err(Error::format("its header is not what it was before"));
    }
    let [width, height] = header.size;
    let layer = first_layer(bytes, &headers)?;
    let mut halves: Vec<&[u32]> = try_with_capacity(2 * header.numbers)?;
    for channel in layer.channel_data.list.iter().skip(3) {
        match &channel.sample_data {
            ex::FlatSamples::U32(samples) if samples.len() == width * height => halves.push(samples),
            _ => return Err(Error::format(format!("its channel {} is incomplete", channel.name))),
        }
    }
    let (pairs, _) = halves.as_chunks::<2>();
    let mut numbers = try_vec(header.numbers, 0.0)?;
    for i in 0..width * height {
        for (number, [high, low]) in numbers.iter_mut().zip(pairs) {
            *number = f64::from_bits(u64::from(high[i]) << 32 | u64::from(low[i]));
        }
        pixel([i % width, i / width], &numbers);
    }
    Ok(())
}

/// Encodes the window that `header` describes. `picture` holds the R, G and B of the window's pixels.
/// `number([x, y], k)` returns value k of the pixel in column x and row y of the window, with k from 0 to
/// `header.numbers - 1`.
pub fn encode(header: &FileHeader, picture: &Image, number: impl Fn([usize; 2], usize) -> f64) -> Result<Vec<u8>> {
    let text = |text: &str| ex::Text::from_slice_unchecked(text.as_bytes());
    let [width, height] = header.size;
    let mut list = ex::SmallVec::<[ex::AnyChannel<ex::FlatSamples>; 4]>::new();
    for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
        let samples = super::try_collect(picture.data.iter().skip(c).step_by(3).copied())?;
        list.push(ex::AnyChannel::new(text(name), ex::FlatSamples::F32(samples)));
    }
    for k in 0..header.numbers {
        for is_high in [true, false] {
            let mut samples: Vec<u32> = try_with_capacity(width * height)?;
            for i in 0..width * height {
                let bits = number([i % width, i / width], k).to_bits();
                samples.push(if is_high { (bits >> 32) as u32 } else { bits as u32 });
            }
            list.push(ex::AnyChannel::new(text(&name(k, is_high)), ex::FlatSamples::U32(samples)));
        }
    }
    let other = header.attributes.iter().map(|(name, value)| (text(name), ex::AttributeValue::Text(text(value))));
    let attributes = ex::LayerAttributes {
        layer_position: ex::Vec2(header.corner[0] as i32, header.corner[1] as i32),
        other: other.collect(),
        ..ex::LayerAttributes::default()
    };
    let list = ex::AnyChannels::sort(list);
    // Use run-length compression, because it is fast. The stored numbers are sums over random light paths. Their low
    // digits are noise, on which stronger compression would take as long as tracing the paths.
    let layer = ex::Layer::new((width, height), attributes, ex::Encoding::FAST_LOSSLESS, list);
    let mut file = ex::Image::from_layer(layer);
    file.attributes.display_window = ex::IntegerBounds::new((0, 0), (header.whole[0], header.whole[1]));
    let texts = header.attributes.iter().map(|(name, value)| name.len() + value.len() + 64).sum::<usize>();
    let channels = 3 + 2 * header.numbers;
    use ex::WritableImage;
    let mut out = Cursor::new(try_with_capacity(exr_memory::max_file_bytes(width, height, channels, texts))?);
    exr_memory::check_blocks(width, height, channels)?;
    file.write()
        .non_parallel()
        .to_buffered(&mut out)
        .map_err(|e| Error::new(ErrorKind::Internal, format!("the OpenEXR encoder failed: {e}")))?;
    Ok(out.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::io::{Encoding, decode as decode_picture};

    fn number(at: [usize; 2], k: usize) -> f64 {
        [1.0 / 3.0, -0.0, f64::MAX, 1e-300, 1e9 + 1e-7][k] * (1 + at[0] + 100 * at[1]) as f64
    }

    fn file() -> (FileHeader, Image, Vec<u8>) {
        let header = FileHeader {
            whole: [40, 30],
            corner: [8, 5],
            size: [19, 13],
            numbers: 5,
            attributes: vec![("luxfer.one".into(), "Ä".into()), ("luxfer.two".into(), String::new())],
        };
        let picture = Image::from_fn(19, 13, |x, y| [x as f32, y as f32, 0.5]).unwrap();
        let bytes = encode(&header, &picture, number).unwrap();
        (header, picture, bytes)
    }

    #[test]
    fn doubles_are_lossless_and_other_readers_see_the_picture() {
        let (header, picture, bytes) = file();
        let mut seen = 0;
        decode(&bytes, &header, |at, numbers| {
            assert_eq!(at, [seen % 19, seen / 19]);
            let expected: Vec<u64> = (0..5).map(|k| number(at, k).to_bits()).collect();
            assert_eq!(numbers.iter().map(|n| n.to_bits()).collect::<Vec<_>>(), expected);
            seen += 1;
        })
        .unwrap();
        assert_eq!(seen, 19 * 13);
        // Decoded as a picture, the file has the size of the whole picture, with the window at its position.
        let whole = decode_picture(&bytes, Encoding::Linear).unwrap();
        assert_eq!([whole.width, whole.height], header.whole);
        for (x, y) in (0..13).flat_map(|y| (0..19).map(move |x| (x, y))) {
            assert_eq!(whole.pixel(header.corner[0] + x, header.corner[1] + y), picture.pixel(x, y));
        }
        let lit = |image: &Image| image.data.iter().filter(|v| **v != 0.0).count();
        assert_eq!(lit(&whole), lit(&picture));
        assert_eq!((header.attribute("luxfer.one"), header.attribute("three")), (Some("Ä"), None));
    }

    #[test]
    fn damaged_files_are_errors() {
        let (header, picture, bytes) = file();
        for cut in [0, 4, 100, 400, bytes.len() / 2, bytes.len() - 20] {
            assert_eq!(decode(&bytes[..cut], &header, |_, _| ()).unwrap_err().kind, ErrorKind::Format, "cut at {cut}");
        }
        let other = FileHeader { numbers: 4, ..header.clone() };
        assert_eq!(decode(&bytes, &other, |_, _| ()).unwrap_err().kind, ErrorKind::Format);
        // An OpenEXR file without `f64` values is accepted, a file with a named layer is not.
        let layer = super::super::io::Layer { name: "", image: &picture, channels: &["R", "G", "B"] };
        let plain = super::super::io::encode_exr(&[layer], &[]).unwrap();
        assert_eq!(FileHeader::of(&headers(&plain).unwrap()).unwrap().numbers, 0);
        let layer = super::super::io::Layer { name: "deep", image: &picture, channels: &["R", "G", "B"] };
        let plain = super::super::io::encode_exr(&[layer], &[]).unwrap();
        assert!(FileHeader::of(&headers(&plain).unwrap()).is_err());
        // A file that claims 16384 x 16384 pixels.
        let bomb = FileHeader { whole: [1 << 14, 1 << 14], size: [1 << 14, 1 << 14], corner: [0, 0], ..header.clone() };
        let mut lie = bytes.clone();
        let window = |[x, y]: [usize; 2], [w, h]: [usize; 2]| {
            [x, y, x + w - 1, y + h - 1].map(|v| (v as i32).to_le_bytes()).concat()
        };
        for (from, to) in [
            (window(header.corner, header.size), window(bomb.corner, bomb.size)),
            (window([0, 0], header.whole), window([0, 0], bomb.whole)),
        ] {
            let at = lie.windows(16).position(|bytes| bytes == from).unwrap();
            lie[at..at + 16].copy_from_slice(&to);
        }
        let error = decode(&lie, &bomb, |_, _| ()).unwrap_err();
        assert!(error.kind == ErrorKind::Format, "{}", error.message);
    }
}
