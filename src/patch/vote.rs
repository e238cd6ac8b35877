//! Reconstructs an image from a field by Algorithm 1 of StyLit: averages the pixels that overlapping matches place at
//! each position, or chooses one of them.

use super::adaptive;
use super::ballot::{Ballot, Candidate, common_offset};
use super::field::Field;
use super::position::{pack, unpack};
use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::job::Job;

/// How the pixels placed at the same position are combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoteMode {
    /// The mean, as in StyLit.
    Plain,
    /// The mean weighted by `1 / (1 + E / mean E)`. E is the distance of a match, and `mean E` its mean over the field.
    Weighted,
    /// The pixel whose colour is closest to the mean: introduces no new colours, so texture keeps its contrast.
    Nearest,
    /// The pixel placed most often; among equally frequent pixels, the pixel closest to the mean. Where two pieces of
    /// the exemplar meet, each piece stays intact up to the seam.
    Majority,
    /// A blend of `Plain` and `Majority` that has as much fine detail as the exemplar: see the module `adaptive`.
    Adaptive,
}

/// Reconstructs each pixel of `out` for which `wanted` holds from the matched pixels of the exemplar `style`; pixels
/// without a match keep their value. Where all matches agree, the result equals the exemplar's pixel to the bit.
pub fn vote(
    out: &mut Image,
    field: &Field,
    style: &Image,
    patch: usize,
    mode: VoteMode,
    job: Job,
    wanted: impl Fn(usize) -> bool + Sync,
) -> Result<()> {
    let ballot = Ballot::new(field, style, patch);
    if mode == VoteMode::Adaptive {
        return adaptive::vote(out, &ballot, job, wanted);
    }
    let (width, channels) = (out.width, out.channels);
    exec::for_rows(&mut out.data, width * channels, job, |y, row| {
        let mut candidates: Vec<Candidate> = Vec::with_capacity(patch * patch);
        for (x, pixel) in row.chunks_exact_mut(channels).enumerate().filter(|(x, _)| wanted(y * width + x)) {
            // Fast path for most pixels: all patches over the pixel place the same exemplar pixel there.
            if let Some(offset) = common_offset(field, patch, [x, y]) {
                pixel.copy_from_slice(ballot.colour(offset, [x, y]));
                continue;
            }
            ballot.collect(&mut candidates, [x, y], mode == VoteMode::Weighted);
            match &candidates[..] {
                [] => continue,
                [only] => {
                    pixel.copy_from_slice(ballot.colour(only.offset, [x, y]));
                    continue;
                }
                _ => (),
            }
            ballot.mean(&candidates, [x, y], pixel);
            if matches!(mode, VoteMode::Nearest | VoteMode::Majority) {
                let best = ballot.choose(&candidates, [x, y], pixel, mode == VoteMode::Majority);
                if let Some(best) = best {
                    pixel.copy_from_slice(ballot.colour(best, [x, y]));
                }
            }
        }
    })
}

/// Returns the exemplar pixel that all patches over target pixel (`x`, `y`) place there; `None` if the patches
/// disagree or one of them has no match.
pub fn origin(field: &Field, patch: usize, x: usize, y: usize) -> Option<(usize, usize)> {
    common_offset(field, patch, [x, y]).map(|offset| unpack(offset.wrapping_add(pack(x, y))))
}

/// Returns the share of whole exemplar pixels in `picture`, among the pixels that have a match and for which `wanted`
/// holds. A pixel is whole if it has the colour of an exemplar pixel that a patch places there.
pub fn whole_share(
    picture: &Image,
    field: &Field,
    style: &Image,
    patch: usize,
    job: Job,
    wanted: impl Fn(usize) -> bool + Sync,
) -> Result<f64> {
    let ballot = Ballot::new(field, style, patch);
    let rows = exec::map(picture.height, job, |y| {
        let mut candidates: Vec<Candidate> = Vec::with_capacity(patch * patch);
        let (mut whole, mut matched) = (0, 0);
        for x in (0..picture.width).filter(|x| wanted(y * picture.width + x)) {
            ballot.collect(&mut candidates, [x, y], false);
            let is_whole = candidates.iter().any(|b| ballot.colour(b.offset, [x, y]) == picture.pixel(x, y));
            whole += usize::from(is_whole);
            matched += usize::from(!candidates.is_empty());
        }
        (whole, matched)
    })?;
    let (whole, matched) = rows.iter().fold((0, 0), |sum, row| (sum.0 + row.0, sum.1 + row.1));
    Ok(whole as f64 / matched.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    /// Of the five patches over one pixel, two place 0 there; the others place 0.5, 1 and 1 from different positions.
    #[test]
    fn votes_are_averaged_or_chosen_from() {
        let style = Image::from_fn(40, 5, |x, _| [[0.0, 0.5, 1.0, 1.0][(x.clamp(10, 39) - 10) / 8]]).unwrap();
        let mut field = Field::new(5, 1).unwrap();
        field.at = [6, 7, 18, 27, 33].map(|x| pack(x, 0)).to_vec();
        field.error = vec![1; 5];
        let job = Monitor::default();
        let voted = |mode| {
            let mut out = Image::new(9, 5, 1).unwrap();
            vote(&mut out, &field, &style, 5, mode, job.job(), |_| true).unwrap();
            out
        };
        let middle = |mode| voted(mode).pixel(4, 2)[0];
        assert_eq!(
            [VoteMode::Plain, VoteMode::Weighted, VoteMode::Nearest, VoteMode::Majority].map(middle),
            [0.5, 0.5, 0.5, 0.0]
        );
        // With `Plain`, at least 3 x 5 pixels in the middle are means of different colours, so they are not whole.
        // With `Majority` and `Nearest`, all pixels are whole.
        let share = |mode| whole_share(&voted(mode), &field, &style, 5, job.job(), |_| true).unwrap();
        assert_eq!(share(VoteMode::Majority), 1.0);
        assert_eq!(share(VoteMode::Nearest), 1.0);
        assert!(share(VoteMode::Plain) < 0.8, "{}", share(VoteMode::Plain));
    }
}
