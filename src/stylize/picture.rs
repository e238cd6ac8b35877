//! The picture of a level: painted from the matches, and decoded to linear colour.

use super::level::Problem;
use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::image::colour::srgb_to_linear;
use crate::job::Job;
use crate::patch::{Field, VoteMode, origin, vote, whole_share};

/// Paints the pixels for which `wanted` holds by a vote of the patches that cover them, and restores the known pixels.
pub(super) fn paint(
    picture: &mut Image,
    field: &Field,
    problem: &Problem,
    mode: VoteMode,
    job: Job,
    wanted: impl Fn(usize) -> bool + Sync,
) -> Result<()> {
    vote(picture, field, &problem.style, problem.patch, mode, job, wanted)?;
    restore_known(picture, problem);
    Ok(())
}

/// Returns the share of whole exemplar pixels in a picture: see `Report::unblended_share`.
pub(super) fn unblended_share(picture: &Image, field: &Field, problem: &Problem, job: Job) -> Result<f64> {
    let is_made = |i: usize| problem.target_mask.as_ref().is_none_or(|mask| mask[i]);
    whole_share(picture, field, &problem.style, problem.patch, job, is_made)
}

/// Restores the known pixels outside the target mask.
fn restore_known(picture: &mut Image, problem: &Problem) {
    if let (Some(mask), Some(known)) = (&problem.target_mask, &problem.known) {
        let channels = picture.channels;
        let pixels = picture.data.chunks_exact_mut(channels).zip(known.data.chunks_exact(channels));
        pixels.zip(mask).filter(|(_, made)| !**made).for_each(|((p, k), _)| p.copy_from_slice(k));
    }
}

/// Returns the picture in linear colour.
pub(super) fn decode(picture: &Image, job: Job) -> Result<Image> {
    let mut out = picture.try_clone()?;
    let row_len = out.row_len();
    exec::for_rows(&mut out.data, row_len, job.part(1.0, 1.0), |_, row| {
        row.iter_mut().for_each(|v| *v = srgb_to_linear(*v));
    })?;
    Ok(out)
}

/// The input of the decoder: the matches, and the images from which the matched patches were painted.
#[derive(Clone, Copy)]
pub(super) struct DecodeInput<'a> {
    pub field: &'a Field,
    pub problem: &'a Problem,
    /// The artwork and the known part of the target, both in linear colour.
    pub artwork: &'a Image,
    pub known: Option<&'a Image>,
}

/// Decodes the pixels for which `wanted` holds to linear colour and writes them to `image`. At full resolution, known
/// pixels and pixels on which all patches agree are copied from the linear originals, so that they equal the originals
/// to the bit.
pub(super) fn decode_into(
    image: &mut Image,
    picture: &Image,
    input: DecodeInput,
    job: Job,
    wanted: impl Fn(usize) -> bool + Sync,
) -> Result<()> {
    let DecodeInput { field, problem, artwork, known } = input;
    let (width, channels, whole) = (image.width, image.channels, problem.is_of(artwork));
    let left_out = |i: usize| whole && problem.target_mask.as_ref().is_some_and(|mask| !mask[i]);
    exec::for_rows(&mut image.data, width * channels, job, |y, row| {
        for (x, pixel) in row.chunks_exact_mut(channels).enumerate().filter(|(x, _)| wanted(y * width + x)) {
            match (left_out(y * width + x), known) {
                (true, Some(known)) => pixel.copy_from_slice(known.pixel(x, y)),
                (true, None) => pixel.fill(0.0),
                _ => match whole.then(|| origin(field, problem.patch, x, y)).flatten() {
                    // Near the border of a painted part, `border::fade` has changed the voted paint. So check that the
                    // pixel still equals the exemplar.
                    Some((px, py)) if picture.pixel(x, y) == problem.style.pixel(px, py) => {
                        pixel.copy_from_slice(artwork.pixel(px, py));
                    }
                    _ => pixel.iter_mut().zip(picture.pixel(x, y)).for_each(|(p, v)| *p = srgb_to_linear(*v)),
                },
            }
        }
    })
}
