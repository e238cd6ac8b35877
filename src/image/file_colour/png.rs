//! Determines the colour space of a PNG from the chunks before its pixels, in their order of precedence (PNG
//! specification, third edition, 4.3).

use super::chromaticities::{Chromaticities, is_identity};
use super::conversion::Conversion;
use super::curve::Curve;
use super::space::Space;
use super::{cicp, icc};
use crate::error::Result;
use crate::image::containers::png_chunks;
use crate::maths;

/// Factor by which `gAMA` and `cHRM` multiply the numbers that they store. [convention: PNG]
const UNIT: f64 = 100_000.0;

/// Plausible exponents of the transfer curve, which are the reciprocals of the numbers in `gAMA`. Other exponents are
/// ignored. [convention]
const EXPONENTS: std::ops::RangeInclusive<f64> = 0.1..=10.0;

/// Returns the content of the first chunk named `wanted` before the pixels.
fn find<'a>(bytes: &'a [u8], wanted: &[u8; 4]) -> Option<&'a [u8]> {
    let mut chunks = png_chunks(bytes).take_while(|c| c.0 != b"IDAT");
    chunks.find(|c| c.0 == wanted).map(|(.., content)| content)
}

/// Returns the unpacked colour profile; `None` if there is none.
pub fn profile(bytes: &[u8]) -> Result<Option<Vec<u8>>> {
    find(bytes, b"iCCP").map_or(Ok(None), icc::of_chunk)
}

pub fn space(bytes: &[u8]) -> Result<Space> {
    let find = |wanted| find(bytes, wanted);
    let mut is_stated = false;
    if let Some(&[primaries, transfer, 0, range, ..]) = find(b"cICP") {
        is_stated = true;
        let bits = find(b"IHDR").and_then(|header| header.get(8).copied()).unwrap_or(8);
        let full = move |code| if range == 0 { narrow(code, bits) } else { code };
        if let Some(space) = cicp::space(primaries, transfer, full)? {
            return Ok(space);
        }
    }
    if let Some(chunk) = find(b"iCCP") {
        is_stated = true;
        let space = icc::of_chunk(chunk)?.map(|profile| icc::space(&profile)).transpose()?;
        match space {
            None | Some(Space::Unusable) => {}
            Some(space) => return Ok(space),
        }
    }
    if find(b"sRGB").is_some() {
        return Ok(Space::Native);
    }
    let exponent = find(b"gAMA").and_then(|gamma| number(gamma, 0)).map(|gamma| 1.0 / gamma);
    let exponent = exponent.filter(|exponent| EXPONENTS.contains(exponent));
    let chromaticities = find(b"cHRM").and_then(chromaticities);
    match (exponent, chromaticities) {
        (None, None) if is_stated => Ok(Space::Unusable),
        (None, None) => Ok(Space::Unstated),
        (exponent, chromaticities) => by_numbers(exponent, chromaticities),
    }
}

/// Maps a code of video range so that the black of that range becomes 0 and its white 1 (Recommendation ITU-T H.273,
/// 8.3). `code` is a share of the highest 8-bit or 16-bit code. Codes below black become 0.
fn narrow(code: f64, bits: u8) -> f64 {
    let max = f64::from(if bits == 16 { u16::MAX } else { 255 });
    let unit = (max + 1.0) / 256.0;
    ((code * max / unit - 16.0) / 219.0).max(0.0)
}

fn number(chunk: &[u8], index: usize) -> Option<f64> {
    let (numbers, _) = chunk.as_chunks::<4>();
    numbers.get(index).map(|&bytes| f64::from(u32::from_be_bytes(bytes)) / UNIT)
}

/// Reads the chromaticities in a `cHRM` chunk: white, red, green and blue, in this order.
fn chromaticities(chunk: &[u8]) -> Option<Chromaticities> {
    let point = |index: usize| Some([number(chunk, 2 * index)?, number(chunk, 2 * index + 1)?]);
    Some(Chromaticities { white: point(0)?, primaries: [point(1)?, point(2)?, point(3)?] })
}

/// Returns the space with this exponent and these chromaticities. A missing value is taken from sRGB. The space is
/// unusable if the primaries are collinear.
fn by_numbers(exponent: Option<f64>, chromaticities: Option<Chromaticities>) -> Result<Space> {
    let Some(matrix) = chromaticities.unwrap_or(Chromaticities::REC709).to_rec709() else { return Ok(Space::Unusable) };
    let curve = match exponent {
        Some(exponent) => Curve::new(|code| maths::powf(code, exponent))?,
        None if is_identity(matrix) => return Ok(Space::Native),
        None => Curve::srgb()?,
    };
    Ok(Space::Other(Conversion::new([curve.clone(), curve.clone(), curve], matrix)))
}
