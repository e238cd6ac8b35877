//! Restricts the mask of a surface to one face of the room. If the positive strokes lie on several faces, keeps the
//! connected parts of the mask that a positive stroke touches. Without this step, the per-pixel classifier would also
//! mark walls and floors of the same colour that no stroke has touched.

use super::classify::Classified;
use super::input::Input;
use super::segmentation::Segmentation;
use super::strokes::Stroke;
use crate::error::{Error, Result};
use crate::features::{CHANNELS, NORMAL, POSITION};
use crate::image::{Image, try_collect, try_push, try_vec};
use glam::Vec3;

/// Minimum cosine between two normals of the same face: the normals differ by at most 45 degrees. [convention]
const SAME_FACE: f32 = std::f32::consts::FRAC_1_SQRT_2;
/// Pixels lie on one face if at least this share of their normals agree with their common normal (see
/// [`agreed_normal`]). [judged on 28 photos]
const AGREEMENT: f64 = 0.9;

/// Minimum cosine between normals that differ by rounding only. Normals of a room laid out as a box pass this test,
/// normals of a depth map do not. [rounding]
const EQUAL: f32 = 1.0 - 1e-4;

/// The normal of the face that the positive strokes lie on, in a room laid out as a box. `None` if the room is not laid
/// out as a box, or if the strokes lie on several faces.
///
/// If there is such a normal, the mask is later restricted to this face. The classifier must then not use position:
/// otherwise it might cut off the parts of the face that are far from all positive strokes.
pub fn laid_out(input: &Input) -> Option<Vec3> {
    stroked_normal(input, EQUAL)
}

/// The normal of the face that a mask covers, in a room laid out as a box. `None` if the room is not laid out as a box,
/// or if the mask covers several faces.
pub fn laid_out_under(features: &Image, mask: &Image) -> Option<Vec3> {
    agreed_normal(features, || marked(mask), EQUAL)
}

/// The normal of a ceiling. Normals point into the room, and y points down. [convention]
const CEILING: Vec3 = Vec3::Y;
/// A ceiling is proposed only if it covers at least this share of the photo. [convention]
const MIN_CEILING: f64 = 0.02;
/// Expected error of a proposed plane: 1 minus the mean intersection over union of proposed and true plane, over
/// generated rooms. [bench photos:nostrokes:tune:48]
const PROPOSED_ERROR: f64 = 0.18;

/// Approximate number of ceiling pixels that serve as a positive stroke if the user has painted none. [convention]
const EXAMPLES: usize = 1000;

/// Returns the mask of the face that the positive strokes lie on, in a room laid out as a box. `None` if the room is
/// not laid out as a box, or if the strokes lie on more than one face.
pub fn of_strokes(input: &Input) -> Result<Option<Segmentation>> {
    laid_out(input).map(|normal| proposed(input, &face(input.features, normal)?)).transpose()
}

/// Returns the mask of the ceiling of a room laid out as a box. Errors: there is no ceiling (`Degenerate`).
pub fn of_ceiling(input: &Input) -> Result<Segmentation> {
    proposed(input, &ceiling(input.features)?)
}

fn proposed(input: &Input, mask: &Image) -> Result<Segmentation> {
    let is_off = |p: &&u32| **p as usize >= mask.data.len();
    let off_image = input.strokes.iter().flat_map(|s| &s.pixels).filter(is_off).count();
    let own = Segmentation::from_confidence(mask)?;
    Ok(Segmentation { error: PROPOSED_ERROR, is_proposed: true, off_image, ..own })
}

/// Returns a positive stroke of pixels spread over the ceiling. Errors: there is no ceiling (`Degenerate`).
pub fn ceiling_example(features: &Image) -> Result<Stroke> {
    let ceiling = ceiling(features)?;
    let step = (marked(&ceiling).count() / EXAMPLES).max(1);
    Ok(Stroke { pixels: try_collect(marked(&ceiling).step_by(step).map(|p| p as u32))?, positive: true })
}

/// Returns the mask of the pixels whose normals deviate from the given normal by at most 45 degrees.
fn face(features: &Image, normal: Vec3) -> Result<Image> {
    let mut mask = Image::new(features.width, features.height, 1)?;
    let is_on = |i: usize| normal_at(features, i).dot(normal) >= SAME_FACE;
    mask.data.iter_mut().enumerate().for_each(|(i, m)| *m = f32::from(is_on(i)));
    Ok(mask)
}

/// Returns the mask of the ceiling of a room laid out as a box. The normals of such a ceiling are equal, unlike the
/// normals of a depth map or of the neutral room that is assumed for photos without lines. Errors (`Degenerate`): the
/// room is not laid out as a box, or the ceiling covers less than [`MIN_CEILING`] of the photo.
fn ceiling(features: &Image) -> Result<Image> {
    let mask = face(features, CEILING)?;
    let is_in_view = marked(&mask).count() as f64 >= MIN_CEILING * mask.data.len() as f64;
    if is_in_view && laid_out_under(features, &mask).is_some() {
        return Ok(mask);
    }
    Err(Error::degenerate(
        "no positive stroke covers any pixel of the image, and no ceiling was found in it: paint at least one positive \
         stroke on the plane that holds the lights, and one negative stroke beside it",
    ))
}

/// Iterates over the indices of the pixels in a mask.
fn marked(mask: &Image) -> impl Iterator<Item = usize> {
    (0..mask.data.len()).filter(|&i| mask.data[i] > 0.5)
}

/// Removes from the mask the pixels that lie on another face of the room than the positive strokes. If the positive
/// strokes lie on several faces, removes the connected parts of the mask that no positive stroke touches.
pub fn restrict(input: &Input, classified: &mut Classified) -> Result<()> {
    let is_kept: Box<dyn Fn(usize) -> bool> = match stroked_normal(input, SAME_FACE) {
        Some(normal) => Box::new(move |i| normal_at(input.features, i).dot(normal) >= SAME_FACE),
        None => {
            let touched = touched(input, &classified.mask)?;
            Box::new(move |i| touched[i])
        }
    };
    for (i, confidence) in classified.confidence.data.iter_mut().enumerate() {
        if classified.mask.data[i] > 0.5 && !is_kept(i) {
            (classified.mask.data[i], *confidence) = (0.0, 0.0);
        }
    }
    Ok(())
}

/// The signed distance of a face from the camera: the mean of `position · normal` over the pixels whose own normals are
/// within 45 degrees of `normal`; 0 if there are none. It is negative, because `normal` points into the room.
pub fn offset(features: &Image, normal: Vec3) -> f32 {
    let pixels = features.data.chunks_exact(features.channels);
    let on_face = pixels.filter(|pixel| Vec3::from_slice(&pixel[NORMAL..]).dot(normal) >= SAME_FACE);
    let (sum, count) = on_face.fold((0.0, 0usize), |(sum, count), pixel| {
        (sum + f64::from(Vec3::from_slice(&pixel[POSITION..]).dot(normal)), count + 1)
    });
    (sum / count.max(1) as f64) as f32
}

/// The up to four neighbours of a pixel in its row and its column.
fn beside(i: usize, width: usize, count: usize) -> impl Iterator<Item = usize> {
    let x = i % width;
    let beside = [(x > 0).then(|| i - 1), (x + 1 < width).then_some(i + 1), i.checked_sub(width), Some(i + width)];
    beside.into_iter().flatten().filter(move |&n| n < count)
}

fn normal_at(features: &Image, pixel: usize) -> Vec3 {
    let n = &features.data[pixel * features.channels + NORMAL..][..3];
    Vec3::new(n[0], n[1], n[2])
}

/// Returns the common normal of the pixels under the positive strokes ([`agreed_normal`]), or `None` if they have none.
fn stroked_normal(input: &Input, cosine: f32) -> Option<Vec3> {
    let count = input.features.width * input.features.height;
    let strokes = || input.strokes.iter().filter(|s| s.positive).flat_map(|s| &s.pixels);
    agreed_normal(input.features, || strokes().map(|&p| p as usize).filter(|p| *p < count), cosine)
}

/// Returns the common normal of the given pixels: the mean of their normals, computed without outliers. A pixel agrees
/// with the common normal if the cosine between its own normal and the common one is at least `cosine`. `None` unless
/// at least the share [`AGREEMENT`] of the pixels agree. Also `None` if the features have no normals (fewer or more
/// than [`CHANNELS`] channels).
fn agreed_normal<I: Iterator<Item = usize>>(features: &Image, pixels: impl Fn() -> I, cosine: f32) -> Option<Vec3> {
    if features.channels != CHANNELS {
        return None;
    }
    let normals = || pixels().map(|p| normal_at(features, p));
    let middle = normals().fold(Vec3::ZERO, |sum, n| sum + n).try_normalize()?;
    // Average again without outliers on other faces, which would bias the mean.
    let mean = normals().filter(|n| n.dot(middle) >= SAME_FACE).fold(Vec3::ZERO, |sum, n| sum + n).try_normalize()?;
    let (mut agree, mut total) = (0usize, 0usize);
    for normal in normals() {
        agree += usize::from(normal.dot(mean) >= cosine);
        total += 1;
    }
    (agree as f64 >= AGREEMENT * total as f64).then_some(mean)
}

/// Finds the mask pixels that are connected to a positive stroke within the mask (flood fill).
fn touched(input: &Input, mask: &Image) -> Result<Vec<bool>> {
    let (width, count) = (mask.width, mask.data.len());
    let mut touched = try_vec(count, false)?;
    let mut next = Vec::new();
    for &p in input.strokes.iter().filter(|s| s.positive).flat_map(|s| &s.pixels) {
        let is_in = mask.data.get(p as usize).is_some_and(|m| *m > 0.5);
        if is_in && !std::mem::replace(&mut touched[p as usize], true) {
            try_push(&mut next, p as usize)?;
        }
    }
    while let Some(i) = next.pop() {
        for n in beside(i, width, count) {
            if mask.data[n] > 0.5 && !std::mem::replace(&mut touched[n], true) {
                try_push(&mut next, n)?;
            }
        }
    }
    Ok(touched)
}
