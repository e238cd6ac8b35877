//! Reads Radiance HDR files (Ward 1991, "Real Pixels"; `picture` of Radiance's file formats). This module reads the
//! header; the crate `image` decodes the pixels.
//!
//! If the picture holds colours, the stored values are divided by the factors `EXPOSURE` and `COLORCORR`. Colours in
//! other `PRIMARIES` or in CIE XYZ are converted to linear Rec.709. Data other than colours stay unchanged. Scan lines
//! may run in any of the eight directions.
//!
//! Not modelled: `PIXASPECT`, the pixel aspect ratio.

use super::file_colour::{Chromaticities, Space};
use super::limits::check_size;
use super::orientation::{Orientation, Upright};
use super::{Image, memory, try_vec};
use crate::error::{Error, ErrorKind, Result};
use glam::{DMat3, DVec3};
use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;
use std::io::Read;

/// The texts with which the first line of a Radiance file may begin.
pub const MAGICS: [&[u8]; 2] = [b"#?RADIANCE", b"#?RGBE"];

/// Code point of the primaries of CIE XYZ in Recommendation ITU-T H.273.
const XYZ: u8 = 10;

struct Header {
    /// Length of a scan line, and number of scan lines.
    columns: usize,
    rows: usize,
    orientation: Orientation,
    space: Space,
    /// Offset of the pixels in the file, in bytes.
    pixels: usize,
}

impl Header {
    fn new(bytes: &[u8]) -> Result<Self> {
        let mut lines = Lines { bytes, at: 0 };
        let ends = || Error::format("the Radiance file ends within its header");
        lines.next().ok_or_else(ends)?;
        let mut colour = ColourHeader::default();
        loop {
            let line = lines.next().ok_or_else(ends)?.trim_ascii();
            if line.is_empty() {
                break;
            }
            let mut parts = line.splitn(2, |&b| b == b'=');
            if let (Some(key), Some(value)) = (parts.next(), parts.next()) {
                colour.read(key.trim_ascii(), value.trim_ascii())?;
            }
        }
        let [rows, columns, orientation] = resolution(lines.next().ok_or_else(ends)?)?;
        check_size(columns as u64, rows as u64)?;
        let orientation = Orientation::new(orientation as u64).unwrap_or_default();
        Ok(Self { columns, rows, orientation, space: colour.space(), pixels: lines.at })
    }
}

struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        let line = &rest[..rest.iter().position(|&b| b == b'\n')?];
        self.at += line.len() + 1;
        Some(line)
    }
}

/// Reads a header line such as `-Y 480 +X 640`. Returns the number of scan lines, their length, and the orientation.
/// The line states the direction from one scan line to the next and the number of scan lines, then the direction along
/// a scan line and its length.
fn resolution(line: &[u8]) -> Result<[usize; 3]> {
    let text = String::from_utf8_lossy(line);
    let wrong =
        || Error::format(format!("the Radiance file's resolution is {text:.40}; it must be like -Y 480 +X 640"));
    let parts: Vec<&str> = text.split_whitespace().take(5).collect();
    let [across, rows, along, columns] = parts[..] else { return Err(wrong()) };
    // The orientation by its number in EXIF.
    let orientation = match (across, along) {
        ("-Y", "+X") => 1,
        ("-Y", "-X") => 2,
        ("+Y", "-X") => 3,
        ("+Y", "+X") => 4,
        ("+X", "-Y") => 5,
        ("-X", "-Y") => 6,
        ("-X", "+Y") => 7,
        ("+X", "+Y") => 8,
        _ => return Err(wrong()),
    };
    let number = |text: &str| text.parse::<u32>().map(|n| n as usize).map_err(|_| wrong());
    Ok([number(rows)?, number(columns)?, orientation])
}

/// The lines of the header that say how the stored values encode colours.
struct ColourHeader {
    /// Factor by which the values of the scene were multiplied before they were stored.
    factor: DVec3,
    chromaticities: Option<Chromaticities>,
    is_readable: bool,
}

impl Default for ColourHeader {
    fn default() -> Self {
        Self { factor: DVec3::ONE, chromaticities: None, is_readable: true }
    }
}

impl ColourHeader {
    fn read(&mut self, key: &[u8], value: &[u8]) -> Result<()> {
        match key {
            b"FORMAT" if value == b"32-bit_rle_rgbe" => {}
            b"FORMAT" if value == b"32-bit_rle_xyze" => self.chromaticities = Chromaticities::of_code(XYZ),
            b"FORMAT" => {
                let format = String::from_utf8_lossy(value);
                return Err(Error::new(
                    ErrorKind::Unsupported,
                    format!("the Radiance file is in the format {format:.40}, which is not read"),
                ));
            }
            // Each program that changed the exposure has added a line; the product of all lines counts.
            b"EXPOSURE" => match numbers::<1>(value) {
                Some([factor]) => self.factor *= factor,
                None => self.is_readable = false,
            },
            b"COLORCORR" => match numbers::<3>(value) {
                Some(factors) => self.factor *= DVec3::from(factors),
                None => self.is_readable = false,
            },
            b"PRIMARIES" => match numbers::<8>(value) {
                Some([rx, ry, gx, gy, bx, by, x, y]) => {
                    self.chromaticities =
                        Some(Chromaticities { primaries: [[rx, ry], [gx, gy], [bx, by]], white: [x, y] });
                }
                None => self.is_readable = false,
            },
            _ => {}
        }
        Ok(())
    }

    fn space(&self) -> Space {
        let is_factor = self.factor.min_element() > 0.0 && self.factor.is_finite() && self.factor.recip().is_finite();
        let matrix = self.chromaticities.unwrap_or(Chromaticities::REC709).to_rec709();
        match matrix {
            Some(matrix) if is_factor && self.is_readable => {
                if self.factor == DVec3::ONE && self.chromaticities.is_none() {
                    return Space::Unstated;
                }
                Space::linear(matrix * DMat3::from_diagonal(self.factor.recip()))
            }
            _ => Space::Unusable,
        }
    }
}

/// Parses `N` numbers separated by blanks, and ignores anything after them. `None` if there are fewer, or if one is not
/// a finite number.
fn numbers<const N: usize>(value: &[u8]) -> Option<[f64; N]> {
    let text = str::from_utf8(value).ok()?;
    let mut parts = text.split_whitespace().map(|part| part.parse().ok().filter(|v: &f64| v.is_finite()));
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        *number = parts.next()??;
    }
    Some(numbers)
}

/// Returns width, height and number of channels of the stored picture.
pub fn probe(bytes: &[u8]) -> Result<(usize, usize, usize)> {
    let header = Header::new(bytes)?;
    Ok((header.columns, header.rows, 3))
}

/// Bytes of memory for reading the picture, in addition to the picture itself.
pub fn working_bytes(bytes: &[u8]) -> Result<usize> {
    let header = Header::new(bytes)?;
    Ok(header.columns * header.rows * 12 + memory::scanlines(header.columns))
}

/// Decodes the picture, turned upright, and returns the colour space that the file states.
pub fn decode(bytes: &[u8]) -> Result<(Image, Space)> {
    let header = Header::new(bytes)?;
    let (columns, rows) = (header.columns, header.rows);
    let mut raw = try_vec(columns * rows * 12, 0u8)?;
    memory::check_scanlines(columns)?;
    let plain = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {rows} +X {columns}\n");
    let file = plain.as_bytes().chain(&bytes[header.pixels..]);
    HdrDecoder::new(file).and_then(|decoder| decoder.read_image(&mut raw)).map_err(super::raster::broken)?;
    let mut out = Upright::new(columns, rows, 3, header.orientation)?;
    for (i, pixel) in raw.as_chunks::<4>().0.as_chunks::<3>().0.iter().enumerate() {
        out.pixel(i % columns, i / columns).copy_from_slice(&pixel.map(f32::from_ne_bytes));
    }
    Ok((out.image, header.space))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::file_colour::FileColour;
    use crate::image::io::{Encoding, decode_photo, probe};

    /// A file of three by two pixels with the values 1 to 6 in all channels, whose header has the given lines.
    fn file(lines: &str, resolution: &str) -> Vec<u8> {
        let pixels: Vec<u8> = (1..=6u8).flat_map(|v| [v << 4, v << 4, v << 4, 132]).collect();
        [format!("#?RADIANCE\n{lines}\n{resolution}\n").as_bytes(), &pixels].concat()
    }

    fn load(lines: &str, encoding: Encoding) -> (Vec<f32>, FileColour) {
        let photo = decode_photo(&file(lines, "-Y 2 +X 3"), encoding).unwrap();
        (photo.image.data, photo.metadata.colour)
    }

    #[test]
    fn factors_of_the_header_are_undone() {
        let format = "FORMAT=32-bit_rle_rgbe\n";
        let (plain, colour) = load(format, Encoding::Srgb);
        assert_eq!((plain[0], plain[17], colour), (1.0, 6.0, FileColour::Assumed));
        let lines = format!("{format}EXPOSURE= 2\npfilt -e 4\n\tEXPOSURE=4.0\nCOLORCORR= 1 2 0.5\n");
        let (image, colour) = load(&lines, Encoding::Srgb);
        assert_eq!((&image[..3], colour), (&[0.125, 0.0625, 0.25][..], FileColour::Converted));
        // Read as data, the values stay unchanged. Colours with invalid factors are not converted.
        assert_eq!(load(&lines, Encoding::Linear), (plain.clone(), FileColour::Data));
        for line in ["EXPOSURE=0\n", "EXPOSURE=-1\n", "EXPOSURE=bright\n", "COLORCORR=1 2\n", "PRIMARIES=0 0 0\n"] {
            assert_eq!(load(line, Encoding::Srgb), (plain.clone(), FileColour::Unconverted), "{line}");
        }
    }

    #[test]
    fn primaries_keep_white() {
        for lines in [
            "PRIMARIES=0.708 0.292 0.17 0.797 0.131 0.046 0.3127 0.329\n",
            "PRIMARIES= 0.640 0.330 0.290 0.600 0.150 0.060 0.333 0.333\n",
            "FORMAT=32-bit_rle_xyze\n",
        ] {
            let (image, colour) = load(lines, Encoding::Srgb);
            assert!((0..18).all(|i| (image[i] - (i / 3 + 1) as f32).abs() < 1e-5), "{lines}: {image:?}");
            assert_eq!(colour, FileColour::Converted);
        }
        let rec709 = "PRIMARIES=0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329\n";
        assert_eq!(load(rec709, Encoding::Srgb).1, FileColour::Stated);
        // A red pixel in the primaries of Recommendation BT.2020.
        let bytes = file("PRIMARIES=0.708 0.292 0.17 0.797 0.131 0.046 0.3127 0.329\n", "-Y 2 +X 3");
        let mut red = bytes.clone();
        let at = bytes.len() - 24;
        red[at + 1..at + 3].fill(0);
        let red = decode_photo(&red, Encoding::Srgb).unwrap().image;
        assert!((red.pixel(0, 0)[0] - 1.6605).abs() < 1e-3 && red.pixel(0, 0)[1..] == [0.0, 0.0]);
    }

    #[test]
    fn scan_lines_run_in_any_direction() {
        for (resolution, width, first_row) in [
            ("-Y 2 +X 3", 3, [1, 2, 3].as_slice()),
            ("-Y 2 -X 3", 3, &[3, 2, 1]),
            ("+Y 2 -X 3", 3, &[6, 5, 4]),
            ("+Y 2 +X 3", 3, &[4, 5, 6]),
            ("+X 2 -Y 3", 2, &[1, 4]),
            ("-X 2 -Y 3", 2, &[4, 1]),
            ("-X 2 +Y 3", 2, &[6, 3]),
            ("+X 2 +Y 3", 2, &[3, 6]),
        ] {
            let image = decode_photo(&file("", resolution), Encoding::Srgb).unwrap().image;
            let row: Vec<i32> = (0..image.width).map(|x| image.pixel(x, 0)[0] as i32).collect();
            assert_eq!((image.width, row.as_slice()), (width, first_row), "{resolution}");
        }
    }

    #[test]
    fn damaged_files_are_distinguished_from_other_formats() {
        let kind = |bytes: &[u8]| decode_photo(bytes, Encoding::Srgb).unwrap_err().kind;
        let whole = file("", "-Y 2 +X 3");
        for cut in 0..whole.len() {
            assert_eq!(kind(&whole[..cut]), ErrorKind::Format, "{cut}");
        }
        for resolution in ["-Y 2", "-Y 2 +X x", "-Y 2 -Y 3", "-Y 0 +X 3", "", "-Y 2 +X 3 +Z"] {
            assert_eq!(kind(&file("", resolution)), ErrorKind::Format, "{resolution}");
        }
        assert_eq!(kind(&file("FORMAT=64-bit\n", "-Y 2 +X 3")), ErrorKind::Unsupported);
        assert_eq!(kind(&file("", "-Y 100000 +X 100000")), ErrorKind::Unsupported);
        assert_eq!(probe(&whole).unwrap(), (3, 2, 3));
    }
}
