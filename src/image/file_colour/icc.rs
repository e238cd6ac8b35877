//! Reads the ICC profiles (ICC.1:2022) of picture files with the crate `moxcms`. A profile has three curves and a
//! matrix, or one curve for greys, or tables for RGB or for inks.

use super::chromaticities::{is_identity, of_colorants};
use super::cicp;
use super::conversion::Conversion;
use super::curve::{Curve, is_srgb};
use super::inks::Inks;
use super::space::Space;
use crate::error::Result;
use crate::image::{memory, try_push, try_vec};
use glam::DMat3;
use miniz_oxide::inflate::decompress_slice_iter_to_slice;
use moxcms::{
    CicpProfile, ColorProfile, DataColorSpace, Layout, ParsingOptions, RenderingIntent, ToneReprCurve, TransformOptions,
};
use std::borrow::Cow;

pub use crate::image::memory::MAX_PROFILE_BYTES as MAX_BYTES;

/// Maximum total length of a profile's tags, relative to the length of the profile. The total may exceed the length of
/// the profile, because tags may share data (such as one curve for three channels). [convention]
const MAX_SHARING: usize = 8;

const HEADER_BYTES: usize = 128;

/// Joins the pieces of the profile in the segments of a JPEG (ICC.1:2022, annex B.4) in the order of their numbers;
/// `None` if there is no profile. If pieces are missing, or occur twice, the profile is empty, hence unusable.
pub fn of_segments<'a>(segments: impl Iterator<Item = (u8, &'a [u8])>) -> Result<Option<Cow<'a, [u8]>>> {
    let mut pieces = Vec::new();
    for (marker, segment) in segments {
        if marker == 0xe2
            && let Some([number, count, piece @ ..]) = segment.strip_prefix(b"ICC_PROFILE\0")
        {
            try_push(&mut pieces, (*number, *count, piece))?;
        }
    }
    if pieces.is_empty() {
        return Ok(None);
    }
    pieces.sort_by_key(|piece| piece.0);
    let is_complete = pieces.iter().zip(1..).all(|((number, count, _), k)| {
        let is_alone = pieces.len() == 1 && *count <= 1;
        is_alone || (*number as usize, *count as usize) == (k, pieces.len())
    });
    match pieces[..] {
        _ if !is_complete => return Ok(Some((&[][..]).into())),
        [(_, _, piece)] => return Ok(Some(piece.into())),
        _ => {}
    }
    let mut profile = try_vec(pieces.iter().map(|piece| piece.2.len()).sum(), 0u8)?;
    let mut rest = &mut profile[..];
    for (_, _, piece) in &pieces {
        rest[..piece.len()].copy_from_slice(piece);
        rest = &mut rest[piece.len()..];
    }
    Ok(Some(profile.into()))
}

/// Unpacks the profile in the `iCCP` chunk of a PNG: a name, a zero, the compression method, and deflated data. `None`
/// if the chunk is damaged or the profile too long.
pub fn of_chunk(chunk: &[u8]) -> Result<Option<Vec<u8>>> {
    let name = chunk.iter().take(80).position(|&b| b == 0);
    let Some([_, 0, packed @ ..]) = name.map(|end| &chunk[end..]) else { return Ok(None) };
    let unpack = |out: &mut [u8]| {
        use miniz_oxide::inflate::TINFLStatus::HasMoreOutput;
        let needed = out.len();
        match decompress_slice_iter_to_slice(out, std::iter::once(packed), true, true) {
            Ok(written) => written == needed,
            Err(status) => status == HasMoreOutput,
        }
    };
    // A profile begins with its length. Check the length before unpacking the rest.
    let mut head = [0; 4];
    let len = if unpack(&mut head) { u32::from_be_bytes(head) as usize } else { 0 };
    if !(HEADER_BYTES..=MAX_BYTES).contains(&len) {
        return Ok(None);
    }
    let mut profile = try_vec(len, 0u8)?;
    Ok(unpack(&mut profile).then_some(profile))
}

/// Returns the colour space that a profile describes.
pub fn space(bytes: &[u8]) -> Result<Space> {
    if bytes.len() > MAX_BYTES || !shares_little(bytes) {
        return Ok(Space::Unusable);
    }
    memory::check_profile(bytes.len(), has_tables(bytes))?;
    let options = ParsingOptions { max_profile_size: MAX_BYTES + 1, ..ParsingOptions::default() };
    let Ok(profile) = ColorProfile::new_from_slice_with_options(bytes, options) else { return Ok(Space::Unusable) };
    // The curves of a profile cannot exceed 1. A profile for high dynamic range therefore names its transfer function
    // by a code point (the `cicp` tag).
    if let Some(codes) = &profile.cicp
        && let Some(space) = hdr(codes)?
    {
        return Ok(space);
    }
    match profile.color_space {
        DataColorSpace::Rgb if intent(&profile).is_some() => tables(&profile),
        DataColorSpace::Rgb => curves_and_matrix(&profile),
        DataColorSpace::Gray => grey(&profile),
        DataColorSpace::Cmyk => inks(&profile),
        _ => Ok(Space::Unusable),
    }
}

/// Bytes of memory that [`space`] needs for a profile; 0 if the profile is too long, because it is then ignored.
pub fn working_bytes(bytes: &[u8]) -> usize {
    if bytes.len() > MAX_BYTES { 0 } else { memory::profile(bytes.len(), has_tables(bytes)) }
}

/// Iterates over the entries of the tag table of a profile: the name, offset and length of each tag.
fn tags(bytes: &[u8]) -> impl Iterator<Item = &[u8; 12]> {
    let parts = bytes.get(HEADER_BYTES..).and_then(|rest| rest.split_first_chunk());
    let (count, tags) = parts.map_or((0, &[][..]), |(count, tags)| (u32::from_be_bytes(*count), tags));
    tags.as_chunks().0.iter().take(count as usize)
}

fn has_tables(bytes: &[u8]) -> bool {
    tags(bytes).any(|tag| tag.starts_with(b"A2B"))
}

/// Whether all tags together are at most [`MAX_SHARING`] times as long as the profile. Each tag is decoded on its own,
/// so shared data need memory several times.
fn shares_little(bytes: &[u8]) -> bool {
    let total: u64 = tags(bytes).map(|&[.., a, b, c, d]| u64::from(u32::from_be_bytes([a, b, c, d]))).sum();
    bytes.len() > HEADER_BYTES && total <= (MAX_SHARING * bytes.len()) as u64
}

/// Returns the space of a profile that states the transfer function PQ or HLG; `None` for other profiles, and if the
/// primaries are unknown.
fn hdr(codes: &CicpProfile) -> Result<Option<Space>> {
    let transfer = codes.transfer_characteristics as u8;
    if !matches!(transfer, cicp::PQ | cicp::HLG) {
        return Ok(None);
    }
    cicp::space(codes.color_primaries as u8, transfer, |code| code)
}

fn curves_and_matrix(profile: &ColorProfile) -> Result<Space> {
    let (Some(r), Some(g), Some(b)) = (&profile.red_trc, &profile.green_trc, &profile.blue_trc) else {
        return Ok(Space::Unusable);
    };
    let columns = DMat3::from_cols_array_2d(&profile.rgb_to_xyz_matrix().v).transpose();
    let matrix = if profile.pcs == DataColorSpace::Xyz { of_colorants(columns) } else { None };
    let (Some(matrix), Some(red)) = (matrix, function(r)) else { return Ok(Space::Unusable) };
    // In most profiles all three curves are equal. Then sample only one of them.
    let is_equal = g == r && b == r;
    if is_equal && is_identity(matrix) && is_srgb(&red) {
        return Ok(Space::Native);
    }
    let red = Curve::new(red)?;
    let other = |trc| if is_equal { Ok(Some(red.clone())) } else { function(trc).map(Curve::new).transpose() };
    let (Some(green), Some(blue)) = (other(g)?, other(b)?) else { return Ok(Space::Unusable) };
    Ok(Space::Other(Conversion::new([red, green, blue], matrix)))
}

fn grey(profile: &ColorProfile) -> Result<Space> {
    match profile.gray_trc.as_ref().and_then(function) {
        Some(function) if is_srgb(&function) => Ok(Space::Native),
        Some(function) => Ok(Space::Other(Conversion::grey(Curve::new(function)?))),
        None => Ok(Space::Unusable),
    }
}

fn function(trc: &ToneReprCurve) -> Option<impl Fn(f64) -> f64 + use<>> {
    let evaluator = trc.make_linear_evaluator().ok()?;
    Some(move |code| f64::from(evaluator.evaluate_value(code as f32)))
}

/// Returns the rendering intent whose tables are used: relative colorimetric if it has tables, else perceptual, else
/// saturation. `None` if no intent has tables.
fn intent(profile: &ColorProfile) -> Option<RenderingIntent> {
    let has = |tables: &Option<_>, intent| tables.is_some().then_some(intent);
    has(&profile.lut_a_to_b_colorimetric, RenderingIntent::RelativeColorimetric)
        .or(has(&profile.lut_a_to_b_perceptual, RenderingIntent::Perceptual))
        .or(has(&profile.lut_a_to_b_saturation, RenderingIntent::Saturation))
}

fn tables(profile: &ColorProfile) -> Result<Space> {
    let Some(rendering_intent) = intent(profile) else { return Ok(Space::Unusable) };
    let options = TransformOptions { rendering_intent, prefer_fixed_point: false, ..TransformOptions::default() };
    match profile.create_transform_f32(Layout::Rgb, &ColorProfile::new_srgb(), Layout::Rgb, options) {
        Ok(to_srgb) => Ok(Space::Other(Conversion::tables(to_srgb)?)),
        Err(_) => Ok(Space::Unusable),
    }
}

fn inks(profile: &ColorProfile) -> Result<Space> {
    let Some(intent) = intent(profile) else { return Ok(Space::Unusable) };
    Ok(Inks::new(profile, intent)?.map_or(Space::Unusable, Space::Inks))
}
