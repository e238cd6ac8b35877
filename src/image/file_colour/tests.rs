//! Tests with whole picture files that state their colour space. The files are made here; tests/python/test_colour.py
//! compares the results with LCMS.

use super::FileColour;
use super::curve::{bt709, hlg, pq};
use super::icc::{MAX_BYTES, of_chunk, of_segments};
use crate::error::ErrorKind;
use crate::image::Image;
use crate::image::colour::srgb_to_linear;
use crate::image::io::{Encoding, Layer, decode, decode_photo, encode_exr, encode_png};
use crate::image::tiff::ifd::{Order, tests::structure};
use moxcms::ColorProfile;

/// A PNG of one row with 8-bit or 16-bit codes, and with `chunks` before its pixels.
fn png(colour_type: u8, codes: &[u16], bits: u8, chunks: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    let channels = if colour_type == 2 { 3 } else { 1 };
    let row: Vec<u8> = match bits {
        8 => codes.iter().map(|&c| c as u8).collect(),
        _ => codes.iter().flat_map(|c| c.to_be_bytes()).collect(),
    };
    let width = (codes.len() / channels) as u32;
    let header = [&width.to_be_bytes()[..], &1u32.to_be_bytes(), &[bits, colour_type, 0, 0, 0]].concat();
    let pixels = zlib(&[&[0], &row[..]].concat());
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    let chunks = chunks.iter().map(|(name, content)| (*name, content.clone()));
    for (name, content) in [(b"IHDR", header)].into_iter().chain(chunks).chain([(b"IDAT", pixels), (b"IEND", vec![])]) {
        file.extend((content.len() as u32).to_be_bytes());
        let named = [&name[..], &content].concat();
        file.extend(&named);
        file.extend(crc(&named).to_be_bytes());
    }
    file
}

/// Compresses bytes with deflate in a zlib stream.
fn zlib(bytes: &[u8]) -> Vec<u8> {
    miniz_oxide::deflate::compress_to_vec_zlib(bytes, 6)
}

fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |c, _| if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 })
    })
}

fn iccp(profile: &[u8]) -> (&'static [u8; 4], Vec<u8>) {
    (b"iCCP", [b"name\0\0", &zlib(profile)[..]].concat())
}

fn display_p3() -> Vec<u8> {
    ColorProfile::new_display_p3().encode().unwrap()
}

fn load(file: &[u8]) -> (Image, FileColour) {
    let photo = decode_photo(file, Encoding::Srgb).unwrap();
    (photo.image, photo.metadata.colour)
}

#[track_caller]
fn assert_near(image: &Image, wanted: [f64; 3], tolerance: f64) {
    for (v, wanted) in image.pixel(0, 0).iter().zip(wanted) {
        assert!((f64::from(*v) - wanted).abs() < tolerance, "{:?} instead of {wanted:?}", image.pixel(0, 0));
    }
}

#[test]
fn display_p3_is_converted_in_every_format() {
    // CSS Color 4, section 20: color(display-p3 0 1 0) is color(srgb -0.5116 1.0183 -0.3107). The values for (0.6,
    // 0.4, 0.2) follow from the matrix of that section.
    let linear = [0.6, 0.4, 0.2].map(|v| f64::from(srgb_to_linear((v * 255f32).round() / 255.0)));
    let wanted = [
        1.224_940 * linear[0] - 0.224_940 * linear[1],
        -0.042_057 * linear[0] + 1.042_057 * linear[1],
        -0.019_638 * linear[0] - 0.078_636 * linear[1] + 1.098_274 * linear[2],
    ];
    let codes = [153, 102, 51];
    let (image, colour) = load(&png(2, &codes, 8, &[iccp(&display_p3())]));
    assert_near(&image, wanted, 3e-4);
    assert_eq!(colour, FileColour::Converted);
    let wide = codes.map(|c| c * 257);
    assert_near(&load(&png(2, &wide, 16, &[iccp(&display_p3())])).0, wanted, 3e-4);
    let green = load(&png(2, &[0, 255, 0], 8, &[iccp(&display_p3())])).0;
    assert_near(&green, [0.0, 1.042_057, 0.0], 5e-4);
    // In formats other than PNG, too, colours of photos are converted, and data and textures stay unchanged.
    for (name, file) in [
        ("JPEG", jpeg(&display_p3())),
        ("WebP", webp(&display_p3())),
        ("TIFF", tiff(&display_p3(), codes)),
        ("GIF", gif(&display_p3())),
        ("BMP", bmp(b"MBED", &display_p3())),
    ] {
        let (image, colour) = load(&file);
        assert_eq!(colour, FileColour::Converted, "{name}");
        let stored = decode(&file, Encoding::Srgb).unwrap().pixel(0, 0).to_vec();
        let stored = [0, 1, 2].map(|c| f64::from(stored[c]));
        let wanted = 1.224_940 * stored[0] - 0.224_940 * stored[1];
        assert!((f64::from(image.pixel(0, 0)[0]) - wanted).abs() < 3e-4, "{name}");
        let data = decode_photo(&file, Encoding::Linear).unwrap();
        assert_eq!(data.metadata.colour, FileColour::Data);
        assert_eq!(data.image, decode(&file, Encoding::Linear).unwrap());
    }
}

/// A JPEG of 8 x 8 pixels with a profile in two pieces, of which the second comes first.
fn jpeg(profile: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let pixels: Vec<u8> = [200u8, 100, 50].repeat(64);
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut file, 100)
        .encode(&pixels, 8, 8, image::ExtendedColorType::Rgb8)
        .unwrap();
    let (first, second) = profile.split_at(100);
    let segment = |number: u8, piece: &[u8]| {
        let length = (2 + 14 + piece.len()) as u16;
        [&[0xff, 0xe2][..], &length.to_be_bytes(), b"ICC_PROFILE\0", &[number, 2], piece].concat()
    };
    [&file[..2], &segment(2, second), &segment(1, first), &file[2..]].concat()
}

/// A GIF of one pixel with a profile in sub-blocks.
fn gif(profile: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    image::codecs::gif::GifEncoder::new(&mut file)
        .encode(&[200, 100, 50], 1, 1, image::ExtendedColorType::Rgb8)
        .unwrap();
    let blocks = profile.chunks(255).flat_map(|block| [&[block.len() as u8], block].concat());
    let extension = [&[0x21, 0xff, 11][..], b"ICCRGBG1012", &blocks.collect::<Vec<_>>(), &[0]].concat();
    let colours = if file[10] & 0x80 != 0 { 3 << ((file[10] & 7) + 1) } else { 0 };
    [&file[..13 + colours], &extension, &file[13 + colours..]].concat()
}

/// A BMP of one pixel, whose header of version 5 states the colour space type `kind` and holds a profile.
fn bmp(kind: &[u8; 4], profile: &[u8]) -> Vec<u8> {
    let pixels = [50, 100, 200, 0];
    let mut header = [&124u32.to_le_bytes()[..], &1u32.to_le_bytes(), &1u32.to_le_bytes(), &[1, 0, 24, 0]].concat();
    header.resize(124, 0);
    header[56..60].copy_from_slice(&u32::from_be_bytes(*kind).to_le_bytes());
    header[112..116].copy_from_slice(&(124 + pixels.len() as u32).to_le_bytes());
    header[116..120].copy_from_slice(&(profile.len() as u32).to_le_bytes());
    let start = 14 + header.len() as u32;
    let length = start + (pixels.len() + profile.len()) as u32;
    let head = [&b"BM"[..], &length.to_le_bytes(), &[0; 4], &start.to_le_bytes()].concat();
    [head, header, pixels.to_vec(), profile.to_vec()].concat()
}

#[test]
fn a_bmp_reports_the_interpretation_of_its_colours() {
    assert_eq!(load(&bmp(b"sRGB", &[])).1, FileColour::Stated);
    assert_eq!(load(&bmp(b"Win ", &[])).1, FileColour::Assumed);
    for (kind, profile) in [(b"LINK", &b"a.icc"[..]), (b"MBED", b"no profile")] {
        let (image, colour) = load(&bmp(kind, profile));
        assert_eq!(colour, FileColour::Unconverted);
        assert_eq!(image.pixel(0, 0), load(&bmp(b"Win ", &[])).0.pixel(0, 0));
    }
}

fn webp(profile: &[u8]) -> Vec<u8> {
    use image::ImageEncoder;
    let mut file = Vec::new();
    let mut encoder = image::codecs::webp::WebPEncoder::new_lossless(&mut file);
    encoder.set_icc_profile(profile.to_vec()).unwrap();
    encoder.write_image(&[200, 100, 50], 1, 1, image::ExtendedColorType::Rgb8).unwrap();
    file
}

/// A TIFF of one pixel with a profile.
fn tiff(profile: &[u8], codes: [u16; 3]) -> Vec<u8> {
    let short = |v: u16| v.to_le_bytes().to_vec();
    let pixel: Vec<u8> = codes.iter().map(|&c| c as u8).collect();
    let mut file = structure(
        Order::Little,
        &[
            (256, 3, short(1)),
            (257, 3, short(1)),
            (258, 3, [8u16; 3].map(u16::to_le_bytes).concat()),
            (262, 3, short(2)),
            (273, 4, vec![0; 4]),
            (277, 3, short(3)),
            (279, 4, 3u32.to_le_bytes().to_vec()),
            (34_675, 7, profile.to_vec()),
        ],
    );
    // Append the pixel, and store its offset in the fifth entry of the directory.
    let at = u32::from_le_bytes([file[4], file[5], file[6], file[7]]) as usize + 2 + 4 * 12 + 8;
    let end = (file.len() as u32).to_le_bytes();
    file[at..at + 4].copy_from_slice(&end);
    file.extend(pixel);
    file
}

#[test]
fn the_chunks_of_a_png_have_their_precedence() {
    let gamma = |v: u32| (b"gAMA", v.to_be_bytes().to_vec());
    let srgb = || (b"sRGB", vec![0]);
    let cicp = |codes: [u8; 4]| (b"cICP", codes.to_vec());
    let of = |chunks: &[(&[u8; 4], Vec<u8>)]| {
        let (image, colour) = load(&png(2, &[153, 102, 51], 8, chunks));
        (f64::from(image.pixel(0, 0)[0]), colour)
    };
    let code = 0.6f64;
    let as_srgb = f64::from(srgb_to_linear(0.6));
    let p3 = of(&[iccp(&display_p3())]).0;
    let cases: [(&str, Vec<(&[u8; 4], Vec<u8>)>, f64, FileColour); 8] = [
        ("nothing", vec![], as_srgb, FileColour::Assumed),
        ("sRGB", vec![gamma(100_000), srgb()], as_srgb, FileColour::Stated),
        ("gAMA", vec![gamma(100_000)], code, FileColour::Converted),
        ("gAMA of 1/2.5", vec![gamma(40_000)], code.powf(2.5), FileColour::Converted),
        ("iCCP before sRGB", vec![gamma(100_000), srgb(), iccp(&display_p3())], p3, FileColour::Converted),
        ("cICP before iCCP", vec![iccp(&display_p3()), cicp([1, 8, 0, 1])], code, FileColour::Converted),
        ("unknown cICP", vec![cicp([1, 99, 0, 1]), srgb()], as_srgb, FileColour::Stated),
        ("only a damaged profile", vec![iccp(&[0; 200])], as_srgb, FileColour::Unconverted),
    ];
    for (name, chunks, wanted, colour) in cases {
        let (red, found) = of(&chunks);
        assert!((red - wanted).abs() < 1e-5, "{name}: {red} instead of {wanted}");
        assert_eq!(found, colour, "{name}");
    }
}

#[test]
fn primaries_of_a_png_are_converted() {
    let numbers = |v: [u32; 8]| (b"cHRM", v.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<u8>>());
    let p3 = [31_270, 32_900, 68_000, 32_000, 26_500, 69_000, 15_000, 6_000];
    let (image, colour) = load(&png(2, &[255, 0, 0], 8, &[numbers(p3), (b"gAMA", 45_455u32.to_be_bytes().to_vec())]));
    assert_near(&image, [1.224_940, 0.0, 0.0], 1e-4);
    assert_eq!(colour, FileColour::Converted);
    let rec709 = [31_270, 32_900, 64_000, 33_000, 30_000, 60_000, 15_000, 6_000];
    assert_eq!(load(&png(2, &[255, 0, 0], 8, &[numbers(rec709)])).1, FileColour::Stated);
    // Primaries on one line cannot be converted.
    assert_eq!(load(&png(2, &[255, 0, 0], 8, &[numbers([30_000; 8])])).1, FileColour::Unconverted);
}

#[test]
fn high_dynamic_range_has_its_reference_white_at_one() {
    let of = |codes: [u8; 4], code: u16| {
        let (image, colour) = load(&png(2, &[code; 3], 16, &[(b"cICP", codes.to_vec())]));
        assert_eq!(colour, FileColour::Converted);
        let pixel = image.pixel(0, 0);
        assert!((pixel[0] - pixel[1]).abs() <= 1e-4 * pixel[1], "grey stays grey");
        f64::from(pixel[1])
    };
    let share = |code: u16| f64::from(code) / 65_535.0;
    for code in [1_000, 20_000, 38_055, 50_000, 65_535] {
        assert!((of([9, 16, 0, 1], code) / (pq(share(code)) / 203.0) - 1.0).abs() < 1e-4);
        assert!((of([9, 18, 0, 1], code) / (hlg(share(code)) / 0.264_96) - 1.0).abs() < 1e-4);
        assert!((of([1, 1, 0, 1], code) / bt709(share(code)) - 1.0).abs() < 1e-4);
    }
    assert!((of([9, 16, 0, 1], 38_055) - 1.0).abs() < 1e-3 && (of([9, 18, 0, 1], 49_151) - 1.0).abs() < 1e-3);
    // Codes of video range run from 16 to 235 of 256.
    assert!((of([1, 8, 0, 0], 235 << 8) - 1.0).abs() < 1e-4 && (of([1, 8, 0, 0], 16 << 8)).abs() < 1e-4);
}

#[test]
fn profiles_for_greys_convert_greys_only() {
    let profile = ColorProfile::new_gray_with_gamma(1.8);
    let profile = profile.encode().unwrap();
    let (grey, colour) = load(&png(0, &[128], 8, &[iccp(&profile)]));
    assert!((f64::from(grey.pixel(0, 0)[0]) - (128.0 / 255f64).powf(1.8)).abs() < 3e-4 && grey.channels == 1);
    assert_eq!(colour, FileColour::Converted);
    let (rgb, colour) = load(&png(2, &[128; 3], 8, &[iccp(&profile)]));
    assert!((rgb.pixel(0, 0)[0] - srgb_to_linear(128.0 / 255.0)).abs() < 1e-6);
    assert_eq!(colour, FileColour::Unconverted);
    // The tone curve of an RGB profile also converts greys.
    let (grey, colour) = load(&png(0, &[128], 8, &[iccp(&display_p3())]));
    assert!((grey.pixel(0, 0)[0] - srgb_to_linear(128.0 / 255.0)).abs() < 1e-4);
    assert_eq!(colour, FileColour::Converted);
}

#[test]
fn a_plain_srgb_profile_changes_no_bit() {
    let codes: Vec<u16> = (0..255).collect();
    let plain = load(&png(2, &codes, 8, &[])).0;
    let (image, colour) = load(&png(2, &codes, 8, &[iccp(&ColorProfile::new_srgb().encode().unwrap())]));
    assert_eq!((image, colour), (plain, FileColour::Stated));
}

#[test]
fn damaged_profiles_are_ignored_and_bombs_are_not_unpacked() {
    let profile = display_p3();
    let plain = load(&png(2, &[153, 102, 51], 8, &[])).0;
    for cut in (0..profile.len()).step_by(7) {
        let (image, colour) = load(&png(2, &[153, 102, 51], 8, &[iccp(&profile[..cut])]));
        assert!(colour == FileColour::Converted || (colour == FileColour::Unconverted && image == plain), "{cut}");
    }
    for at in 0..profile.len() {
        for value in [0, 1, 127, 255] {
            let mut bad = profile.clone();
            bad[at] = value;
            let (image, _) = load(&png(2, &[153, 102, 51], 8, &[iccp(&bad)]));
            assert!(image.data.iter().all(|v| !(*v < 0.0)), "{at} = {value}: {:?}", image.data);
        }
    }
    // A profile that states its true length, which exceeds the limit.
    let mut bomb = vec![0; MAX_BYTES + 1];
    bomb[..4].copy_from_slice(&(MAX_BYTES as u32 + 1).to_be_bytes());
    let (_, chunk) = iccp(&bomb);
    assert!(chunk.len() < 5000 && of_chunk(&chunk).unwrap().is_none());
    // A profile with a thousand tags that share their data.
    let mut shared = vec![0; 128];
    shared.extend(1000u32.to_be_bytes());
    shared.extend([b"A2B0", &128u32.to_be_bytes()[..], &12_132u32.to_be_bytes()].concat().repeat(1000));
    assert_eq!(load(&png(2, &[153, 102, 51], 8, &[iccp(&shared)])).1, FileColour::Unconverted);
    assert!(of_segments([(0xe2, &b"ICC_PROFILE\0"[..])].into_iter()).unwrap().is_none());
}

#[test]
fn pieces_of_a_profile_are_joined_by_number_and_must_be_complete() {
    let piece = |number: u8, count: u8, data: &[u8]| [&b"ICC_PROFILE\0"[..], &[number, count], data].concat();
    let joined = |pieces: &[Vec<u8>]| {
        of_segments(pieces.iter().map(|piece| (0xe2, &piece[..]))).unwrap().map(|profile| profile.into_owned())
    };
    let [one, two] = [piece(1, 2, b"ab"), piece(2, 2, b"cd")];
    assert_eq!(joined(&[two.clone(), one.clone()]).unwrap(), b"abcd");
    assert_eq!(joined(&[piece(1, 1, b"ab")]).unwrap(), b"ab");
    assert_eq!(joined(&[]), None);
    // A piece is missing, occurs twice, or states another number of pieces: the profile is unusable.
    for pieces in [vec![one.clone()], vec![two.clone()], vec![one.clone(), one.clone()], vec![one, piece(2, 3, b"cd")]]
    {
        assert_eq!(joined(&pieces).unwrap(), b"");
    }
    assert!(matches!(super::icc::space(b"").unwrap(), super::space::Space::Unusable));
}

#[test]
fn adobe_rgb_is_known_by_its_exif_notes() {
    // A TIFF structure with directories at fixed offsets: the EXIF directory at 26, the interoperability directory at
    // 56.
    let entry = |tag: u16, kind: u16, count: u32, value: [u8; 4]| {
        [&tag.to_le_bytes()[..], &kind.to_le_bytes(), &count.to_le_bytes(), &value].concat()
    };
    let directory =
        |entries: &[Vec<u8>]| [&(entries.len() as u16).to_le_bytes()[..], &entries.concat(), &[0; 4]].concat();
    let notes = |colour_space: u16, index: &[u8; 4]| {
        [
            b"II*\0\x08\0\0\0".to_vec(),
            directory(&[entry(0x8769, 4, 1, 26u32.to_le_bytes())]),
            directory(&[
                entry(0xa001, 3, 1, u32::from(colour_space).to_le_bytes()),
                entry(0xa005, 4, 1, 56u32.to_le_bytes()),
            ]),
            directory(&[entry(1, 2, 4, *index)]),
        ]
        .concat()
    };
    let jpeg = |notes: &[u8]| {
        let file = jpeg(&display_p3());
        // Replace the two segments that hold the profile by one segment with the EXIF block.
        let pieces = display_p3().len() + 2 * 18;
        let length = (2 + 6 + notes.len()) as u16;
        [&file[..2], &[0xff, 0xe1], &length.to_be_bytes(), b"Exif\0\0", notes, &file[2 + pieces..]].concat()
    };
    let (adobe, colour) = load(&jpeg(&notes(0xffff, b"R03\0")));
    assert_eq!(colour, FileColour::Converted);
    let (srgb, colour) = load(&jpeg(&notes(1, b"R98\0")));
    assert_eq!(colour, FileColour::Stated);
    assert_eq!(load(&jpeg(&notes(0xffff, b"R98\0"))).1, FileColour::Assumed);
    // Red is stronger in Adobe RGB (1998, 4.3) than in sRGB for the codes (200, 100, 50).
    assert!(adobe.pixel(0, 0)[0] > 1.2 * srgb.pixel(0, 0)[0]);
}

#[test]
fn written_files_state_their_colours() {
    let image = Image::from_fn(3, 2, |x, y| [0.1 * x as f32, 0.2 * y as f32, 0.5]).unwrap();
    let (_, colour) = load(&encode_png(&image, 1.0).unwrap());
    assert_eq!(colour, FileColour::Stated);
    let exr = encode_exr(&[Layer { name: "", image: &image, channels: &["R", "G", "B"] }], &[]).unwrap();
    assert_eq!(load(&exr), (image, FileColour::Stated));
}

#[test]
fn sizes_past_the_limits_are_unsupported() {
    let mut file = png(2, &[1, 2, 3], 8, &[]);
    file[16..20].copy_from_slice(&70_000u32.to_be_bytes());
    assert_eq!(decode(&file, Encoding::Srgb).unwrap_err().kind, ErrorKind::Unsupported);
    file[16..20].fill(0);
    assert_eq!(decode(&file, Encoding::Srgb).unwrap_err().kind, ErrorKind::Format);
}
