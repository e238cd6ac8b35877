//! Reads the EXIF metadata of JPEG, PNG, WebP and TIFF files (CIPA DC-008, JEITA CP-3451).

use crate::image::containers::{jpeg_segments, png_chunks, riff_chunks};
use crate::image::file_colour::ExifColour;
use crate::image::orientation::Orientation;
use crate::image::tiff::ifd::{Directory, Ifds};
use crate::maths;

/// EXIF tags. The first two are in the directory of the picture, the others in the EXIF directory unless noted.
mod tag {
    pub const ORIENTATION: u16 = 0x0112;
    pub const EXIF: u16 = 0x8769;
    pub const EXPOSURE_TIME: u16 = 0x829a;
    pub const F_NUMBER: u16 = 0x829d;
    pub const SENSITIVITY: u16 = 0x8827;
    pub const STANDARD_OUTPUT_SENSITIVITY: u16 = 0x8831;
    pub const RECOMMENDED_EXPOSURE_INDEX: u16 = 0x8832;
    pub const ISO_SPEED: u16 = 0x8833;
    pub const SHUTTER_SPEED: u16 = 0x9201;
    pub const APERTURE: u16 = 0x9202;
    pub const FOCAL_LENGTH: u16 = 0x920a;
    pub const COLOUR_SPACE: u16 = 0xa001;
    pub const WIDTH: u16 = 0xa002;
    pub const HEIGHT: u16 = 0xa003;
    pub const INTEROPERABILITY: u16 = 0xa005;
    pub const PLANE_X_RESOLUTION: u16 = 0xa20e;
    pub const PLANE_Y_RESOLUTION: u16 = 0xa20f;
    pub const PLANE_UNIT: u16 = 0xa210;
    pub const FOCAL_LENGTH_35: u16 = 0xa405;
    /// This tag is in the interoperability directory.
    pub const INTEROPERABILITY_INDEX: u16 = 0x0001;
}

/// If the sensitivity tag, which has 16 bits, has this value, the sensitivity is larger and is stored in another tag.
/// [convention: Exif]
const SENSITIVITY_ELSEWHERE: f64 = 65_535.0;

/// The metadata that the library uses. `None` if the file lacks a value or states an implausible one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exif {
    pub orientation: Orientation,
    /// Focal length in millimetres that gives the same angle of view on film of 36 x 24 mm.
    pub focal_35: Option<f64>,
    /// Focal length of the lens in millimetres.
    pub focal: Option<f64>,
    /// Pixels per millimetre of the sensor, for a picture of the size `recorded`.
    pub pixels_per_millimetre: Option<f64>,
    /// Width and height in pixels that the camera recorded.
    pub recorded: Option<[f64; 2]>,
    pub f_number: Option<f64>,
    /// Exposure time in seconds.
    pub exposure_time: Option<f64>,
    pub iso: Option<f64>,
    pub colour: ExifColour,
}

/// Reads the metadata of a picture file of any format. For a file without EXIF, all values are absent and the
/// orientation is upright.
pub fn read(bytes: &[u8]) -> Exif {
    let picture = notes(bytes).and_then(Ifds::new).and_then(Ifds::first);
    picture.map(|picture| Exif::new(&picture)).unwrap_or_default()
}

/// Returns the EXIF block of a file, or `None`. The block has the structure of a TIFF file without pixels.
fn notes(bytes: &[u8]) -> Option<&[u8]> {
    const NAME: &[u8] = b"Exif\0\0";
    match bytes {
        [0xff, 0xd8, ..] => {
            jpeg_segments(bytes).filter(|s| s.0 == 0xe1).find_map(|(_, segment)| segment.strip_prefix(NAME))
        }
        // Some programs also write the prefix `Exif\0\0`, which only JPEG requires, into PNG and WebP files.
        [0x89, b'P', b'N', b'G', ..] => {
            let chunk = png_chunks(bytes).find(|c| c.0 == b"eXIf")?.2;
            Some(chunk.strip_prefix(NAME).unwrap_or(chunk))
        }
        [b'R', b'I', b'F', b'F', ..] => {
            let chunk = riff_chunks(bytes).find(|c| c.0 == b"EXIF")?.1;
            Some(chunk.strip_prefix(NAME).unwrap_or(chunk))
        }
        _ => Some(bytes),
    }
}

impl Exif {
    fn new(picture: &Directory) -> Self {
        let orientation = picture.integer(tag::ORIENTATION).and_then(Orientation::new).unwrap_or_default();
        let notes = picture.integer(tag::EXIF).and_then(|offset| picture.ifds().directory(u32::try_from(offset).ok()?));
        let Some(notes) = notes else { return Self { orientation, ..Self::default() } };
        let positive = |tag| notes.number(tag).filter(|v| *v > 0.0);
        let within = |value: Option<f64>, low: f64, high: f64| value.filter(|v| (low..=high).contains(v));

        // Older cameras write logarithms only: 2 log2 N for the f-number N, and -log2 t for the exposure time t.
        let f_number = positive(tag::F_NUMBER).or_else(|| notes.number(tag::APERTURE).map(|v| maths::exp2(v / 2.0)));
        let time = positive(tag::EXPOSURE_TIME).or_else(|| notes.number(tag::SHUTTER_SPEED).map(|v| maths::exp2(-v)));
        let iso = positive(tag::SENSITIVITY).filter(|v| *v != SENSITIVITY_ELSEWHERE).or_else(|| {
            let tags = [tag::STANDARD_OUTPUT_SENSITIVITY, tag::RECOMMENDED_EXPOSURE_INDEX, tag::ISO_SPEED];
            tags.into_iter().find_map(positive)
        });
        // Discard values beyond limits that no lens, shutter or sensor of a camera exceeds. [convention]
        Self {
            orientation,
            focal_35: within(positive(tag::FOCAL_LENGTH_35), 1.0, 1e4),
            focal: within(positive(tag::FOCAL_LENGTH), 0.1, 1e4),
            pixels_per_millimetre: within(pixels_per_millimetre(&notes), 1.0, 1e5),
            recorded: positive(tag::WIDTH).zip(positive(tag::HEIGHT)).map(|(width, height)| [width, height]),
            f_number: within(f_number, 0.5, 256.0),
            exposure_time: within(time, 1e-7, 1e5),
            iso: within(iso, 1.0, 1e8),
            colour: colour(&notes),
        }
    }
}

/// Reads the colour space. A file in Adobe RGB states the space "uncalibrated", together with "R03", the
/// interoperability index of a DCF optional file (CIPA DC-009).
fn colour(notes: &Directory) -> ExifColour {
    let offset = notes.integer(tag::INTEROPERABILITY).and_then(|offset| u32::try_from(offset).ok());
    let index = offset.and_then(|offset| notes.ifds().directory(offset)?.bytes(tag::INTEROPERABILITY_INDEX));
    match notes.integer(tag::COLOUR_SPACE) {
        Some(1) => ExifColour::Srgb,
        // The value 2 is not in the standard, but cameras use it for Adobe RGB.
        Some(2) => ExifColour::AdobeRgb,
        _ if index.is_some_and(|index| index.starts_with(b"R03")) => ExifColour::AdobeRgb,
        _ => ExifColour::Unstated,
    }
}

/// Pixels per millimetre of the sensor: the geometric mean of the horizontal and the vertical density.
fn pixels_per_millimetre(notes: &Directory) -> Option<f64> {
    let millimetres = match notes.integer(tag::PLANE_UNIT).unwrap_or(2) {
        2 => 25.4,
        3 => 10.0,
        // The units 4 (millimetre) and 5 (micrometre) are not in the standard, but some cameras use them.
        4 => 1.0,
        5 => 1e-3,
        _ => return None,
    };
    let [x, y] = [tag::PLANE_X_RESOLUTION, tag::PLANE_Y_RESOLUTION].map(|tag| notes.number(tag).filter(|v| *v > 0.0));
    Some((x? * y.or(x)?).sqrt() / millimetres)
}
