use super::{FILM_DIAGONAL, PhotoMetadata};
use crate::image::Image;
use crate::image::io::{Encoding, decode, decode_photo, encode_png};
use crate::image::tiff::ifd::Order;
use crate::image::tiff::ifd::tests::{Entry, structure, writers};
use image::ImageEncoder;
use std::slice::from_ref;

const ASCII: u16 = 2;
const SHORT: u16 = 3;
const LONG: u16 = 4;
const RATIONAL: u16 = 5;

/// An EXIF block with the given tags in the directory of the picture and in the EXIF directory.
pub fn notes(order: Order, picture: &[Entry], camera: &[Entry]) -> Vec<u8> {
    let (_, _, u32) = writers(order);
    let with = |offset: u32| [picture, &[(0x8769, LONG, u32(offset))]].concat();
    let first = structure(order, &with(0)).len();
    let mut notes = structure(order, &with(first as u32));
    // `structure` counts the offsets of values from a header of 8 bytes before its directory. In the file, this
    // directory begins at byte `first`, so add `first - 8`.
    let (_, _, u32) = writers(order);
    let own = structure(order, camera);
    let mut own = own[8..].to_vec();
    for (k, (_, kind, bytes)) in camera.iter().enumerate() {
        if bytes.len() > 4 {
            let _ = kind;
            let at = 2 + 12 * k + 8;
            let place = own[at..at + 4].try_into().map(|b| order.u32(b)).unwrap();
            own[at..at + 4].copy_from_slice(&u32(place - 8 + first as u32));
        }
    }
    notes.extend(own);
    notes
}

fn short(order: Order, tag: u16, value: u16) -> Entry {
    (tag, SHORT, writers(order).1(value))
}

fn rational(order: Order, tag: u16, over: u32, under: u32) -> Entry {
    let (_, _, u32) = writers(order);
    (tag, RATIONAL, [u32(over), u32(under)].concat())
}

fn jpeg(image: &image::RgbImage, notes: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut file, 100);
    encoder.write_image(image, image.width(), image.height(), image::ExtendedColorType::Rgb8).unwrap();
    let segment = [b"Exif\0\0", notes].concat();
    let length = (segment.len() as u16 + 2).to_be_bytes();
    [&file[..2], &[0xff, 0xe1], &length, &segment, &file[2..]].concat()
}

fn png(image: &Image, notes: &[u8]) -> Vec<u8> {
    let file = encode_png(image, 1.0).unwrap();
    let named = [b"eXIf", notes].concat();
    let crc = named.iter().fold(u32::MAX, |crc, b| {
        (0..8).fold(crc ^ u32::from(*b), |crc, _| if crc & 1 != 0 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 })
    });
    let chunk = [&(notes.len() as u32).to_be_bytes()[..], &named, &(!crc).to_be_bytes()].concat();
    // Insert the chunk after the header.
    [&file[..33], &chunk, &file[33..]].concat()
}

fn webp(image: &image::RgbImage, notes: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let encoder = image::codecs::webp::WebPEncoder::new_lossless(&mut file);
    encoder.write_image(image, image.width(), image.height(), image::ExtendedColorType::Rgb8).unwrap();
    let side = |v: u32| (v - 1).to_le_bytes()[..3].to_vec();
    let chunk = |name: &[u8], content: &[u8]| {
        let padding = vec![0; content.len() % 2];
        [name, &(content.len() as u32).to_le_bytes(), content, &padding].concat()
    };
    let extended = [&[8, 0, 0, 0][..], &side(image.width()), &side(image.height())].concat();
    let chunks = [chunk(b"VP8X", &extended), file[12..].to_vec(), chunk(b"EXIF", notes)].concat();
    [b"RIFF", &(chunks.len() as u32 + 4).to_le_bytes()[..], b"WEBP", &chunks].concat()
}

/// The letter F with strokes sixteen pixels wide: no rotation or reflection maps it to itself.
fn letter(x: u32, y: u32) -> bool {
    [[1, 1, 1], [1, 0, 0], [1, 1, 0], [1, 0, 0]][y as usize / 16][x as usize / 16] == 1
}

/// The letter as a file stores it in orientation `code`: EXIF's table gives the upright position of each stored pixel.
fn stored(code: u16) -> image::RgbImage {
    let (width, height) = if code >= 5 { (64, 48) } else { (48, 64) };
    image::RgbImage::from_fn(width, height, |x, y| {
        let (right, bottom) = (width - 1 - x, height - 1 - y);
        let (x, y) = match code {
            1 => (x, y),
            2 => (right, y),
            3 => (right, bottom),
            4 => (x, bottom),
            5 => (y, x),
            6 => (bottom, x),
            7 => (bottom, right),
            _ => (y, right),
        };
        image::Rgb([if letter(x, y) { 255 } else { 0 }; 3])
    })
}

fn is_upright(image: &Image) -> bool {
    let fits = |i: usize, v: &[f32]| (v[0] > 0.5) == letter((i % 48) as u32, (i / 48) as u32);
    (image.width, image.height) == (48, 64) && image.data.chunks(image.channels).enumerate().all(|(i, v)| fits(i, v))
}

#[test]
fn photos_of_every_orientation_and_format_stand_upright() {
    for code in 1..=8 {
        let picture = stored(code);
        let linear = Image::from_fn(picture.width() as usize, picture.height() as usize, |x, y| {
            [f32::from(picture.get_pixel(x as u32, y as u32)[0]) / 255.0; 3]
        });
        for order in [Order::Little, Order::Big] {
            let notes = notes(order, &[short(order, 0x112, code)], &[]);
            let named = [b"Exif\0\0", &notes[..]].concat();
            let files = [
                jpeg(&picture, &notes),
                png(&linear.clone().unwrap(), &notes),
                webp(&picture, &notes),
                webp(&picture, &named),
            ];
            for (k, file) in files.iter().enumerate() {
                let photo = decode_photo(file, Encoding::Srgb).unwrap();
                assert!(is_upright(&photo.image), "orientation {code}, file {k}");
                assert_eq!(u16::from(photo.metadata.orientation.code()), code);
                // Textures stay in the orientation in which they are stored.
                assert_eq!(is_upright(&decode(file, Encoding::Srgb).unwrap()), code == 1);
            }
        }
    }
}

/// The metadata that a photo of 40 x 30 pixels has if its EXIF directory holds the tags `camera`.
fn metadata(camera: &[Entry]) -> PhotoMetadata {
    let picture = image::RgbImage::new(40, 30);
    let notes = notes(Order::Big, &[(0x10f, ASCII, b"Maker\0".to_vec()), short(Order::Big, 0x112, 6)], camera);
    decode_photo(&jpeg(&picture, &notes), Encoding::Srgb).unwrap().metadata
}

fn near(value: Option<f64>, wanted: f64) -> bool {
    value.is_some_and(|v| (v / wanted - 1.0).abs() < 1e-6)
}

#[test]
fn the_focal_length_is_in_pixels_of_the_loaded_photo() {
    let big = Order::Big;
    let film = short(big, 0xa405, 26);
    let recorded = [short(big, 0xa002, 4032), short(big, 0xa003, 3024)];
    let by_film = 26.0 * 50.0 / FILM_DIAGONAL;
    assert!(near(metadata(from_ref(&film)).focal, by_film));
    assert!(near(metadata(&[&recorded[..], from_ref(&film)].concat()).focal, by_film));
    // A sensor of 7 x 5.25 mm behind a lens of 4.3 mm: 576 pixels per millimetre, 4032 pixels in a row.
    let sensor = [
        rational(big, 0x920a, 43, 10),
        rational(big, 0xa20e, 5760, 1),
        rational(big, 0xa20f, 5760, 1),
        short(big, 0xa210, 3),
    ];
    let all = [&recorded[..], &sensor].concat();
    let by_sensor = 4.3 * 576.0 * 40.0 / 4032.0;
    assert!(near(metadata(&all).focal, by_sensor), "{:?}", metadata(&all));
    // If the two estimates agree within 10 %, the estimate from the sensor is used, otherwise the 35 mm equivalent.
    assert!(near(metadata(&[&all[..], &[short(big, 0xa405, 21)]].concat()).focal, by_sensor));
    assert!(near(metadata(&[&all[..], from_ref(&film)].concat()).focal, by_film));
    // The focal length is unknown if the photo is cropped to another aspect ratio, if the 35 mm equivalent is 0, or if
    // a denominator is 0.
    assert_eq!(metadata(&[short(big, 0xa002, 4032), short(big, 0xa003, 2268), film]).focal, None);
    assert_eq!(metadata(&[short(big, 0xa405, 0)]).focal, None);
    assert_eq!(metadata(&[rational(big, 0x920a, 43, 0)]).focal, None);
    // A photo that an editor rotated, exchanging the recorded sides.
    let turned = [short(big, 0xa002, 3024), short(big, 0xa003, 4032), short(big, 0xa405, 26)];
    assert!(near(metadata(&turned).focal, by_film));
}

#[test]
fn the_luminance_of_white_follows_from_the_exposure() {
    let big = Order::Big;
    let exposure = [rational(big, 0x829a, 1, 60), rational(big, 0x829d, 28, 10), short(big, 0x8827, 400)];
    let known = metadata(&exposure);
    assert!(near(known.f_number, 2.8) && near(known.exposure_time, 1.0 / 60.0) && near(known.iso, 400.0));
    // White is at 1.2 x 2^EV100 cd/m² (Lagarde and de Rousiers, Moving Frostbite to physically based rendering, 2014,
    // section 5.1.1).
    let ev100 = (2.8f64 * 2.8 * 60.0 * 100.0 / 400.0).log2();
    let white = known.white_luminance().unwrap();
    assert!((white.expected - 1.2 * ev100.exp2()).abs() < 1e-9 * white.expected, "{white:?}");
    assert!((white.low / white.expected - 0.708).abs() < 1e-3 && white.high == 2.0 * white.expected);
    for missing in 0..3 {
        let mut some = exposure.to_vec();
        some.remove(missing);
        assert_eq!(metadata(&some).white_luminance(), None);
    }
    // Shutter speed and aperture as logarithms instead of numbers, and an ISO speed too large for 16 bits.
    let logarithms = [
        short(big, 0x8827, 65_535),
        (0x8832, LONG, writers(big).2(102_400)),
        rational(big, 0x9201, 6, 1),
        rational(big, 0x9202, 4, 1),
    ];
    let known = metadata(&logarithms);
    assert!(near(known.f_number, 4.0) && near(known.exposure_time, 1.0 / 64.0) && near(known.iso, 102_400.0));
    assert_eq!(metadata(&[rational(big, 0x829a, 0, 1), rational(big, 0x829d, 1, 1000)]).f_number, None);
}

#[test]
fn implausible_metadata_count_as_absent() {
    let order = Order::Little;
    let camera = [short(order, 0xa405, 26), rational(order, 0x829a, 1, 60)];
    let whole = notes(order, &[short(order, 0x112, 6)], &camera);
    let picture = image::RgbImage::from_fn(24, 16, |x, y| image::Rgb([x as u8, y as u8, 7]));
    let plain = decode(&jpeg(&picture, &[]), Encoding::Srgb).unwrap();
    let mut bad: Vec<Vec<u8>> = (0..whole.len()).map(|cut| whole[..cut].to_vec()).collect();
    for at in 0..whole.len() {
        bad.extend([0, 1, 8, 127, 255].map(|value| {
            let mut notes = whole.clone();
            notes[at] = value;
            notes
        }));
    }
    for notes in bad {
        let photo = decode_photo(&jpeg(&picture, &notes), Encoding::Srgb).unwrap();
        assert_eq!(photo.image.data.len(), plain.data.len());
        let known = photo.metadata;
        assert!(known.focal.is_none_or(|f| f.is_finite() && f > 0.0) && (1..=8).contains(&known.orientation.code()));
    }
}
