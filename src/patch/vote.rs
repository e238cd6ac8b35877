//! Reconstructs an image from a field by Algorithm 1 of StyLit: averages the pixels that overlapping matches place at
//! each position.

use super::field::Field;
use super::position::{NONE, pack, unpack};
use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::job::Job;

/// How the pixels placed at the same position are combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoteMode {
    /// The mean, as in StyLit.
    Plain,
    /// The mean weighted by `1 / (1 + E / mean E)`, where E is the distance of a match.
    Weighted,
    /// The pixel whose colour is closest to the mean: introduces no new colours, so texture keeps its contrast.
    Nearest,
    /// The pixel placed most often (ties: the one closest to the mean). Where two pieces of the exemplar meet, each
    /// stays intact up to the seam.
    Majority,
}

/// An exemplar pixel that at least one patch places at the target pixel, with its votes.
struct VoteCandidate {
    /// Packed position of the source minus packed position of the target, wrapping. It is equal for patches that
    /// continue each other.
    offset: u32,
    count: usize,
    weight: f64,
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
    let (width, channels) = (out.width, out.channels);
    let matched = field.error.iter().filter(|&&e| e != u32::MAX).count().max(1);
    let scale = (field.energy() / matched as f64).max(1.0);
    exec::for_rows(&mut out.data, width * channels, job, |y, row| {
        let mut candidates: Vec<VoteCandidate> = Vec::with_capacity(patch * patch);
        for (x, pixel) in row.chunks_exact_mut(channels).enumerate().filter(|(x, _)| wanted(y * width + x)) {
            let colour = |offset: u32| {
                let (px, py) = unpack(offset.wrapping_add(pack(x, y)));
                style.pixel(px, py)
            };
            // Fast path for most pixels: all patches over the pixel place the same exemplar pixel there.
            if let Some(offset) = common_offset(field, patch, x, y) {
                pixel.copy_from_slice(colour(offset));
                continue;
            }
            let weight = |i: usize| match mode {
                VoteMode::Weighted => 1.0 / (1.0 + f64::from(field.error[i]) / scale),
                _ => 1.0,
            };
            collect(&mut candidates, field, patch, [x, y], weight);
            match &candidates[..] {
                [] => continue,
                [only] => {
                    pixel.copy_from_slice(colour(only.offset));
                    continue;
                }
                _ => (),
            }
            let total: f64 = candidates.iter().map(|b| b.weight).sum();
            for (c, value) in pixel.iter_mut().enumerate() {
                let sum: f64 = candidates.iter().map(|b| b.weight * f64::from(colour(b.offset)[c])).sum();
                *value = (sum / total) as f32;
            }
            if matches!(mode, VoteMode::Nearest | VoteMode::Majority) {
                let count = |b: &VoteCandidate| if mode == VoteMode::Majority { b.count } else { 0 };
                let distance = |b: &VoteCandidate| -> f32 {
                    colour(b.offset).iter().zip(&*pixel).map(|(s, m)| (s - m) * (s - m)).sum()
                };
                let best = (candidates.iter())
                    .min_by(|a, b| count(b).cmp(&count(a)).then_with(|| distance(a).total_cmp(&distance(b))));
                if let Some(best) = best {
                    pixel.copy_from_slice(colour(best.offset));
                }
            }
        }
    })
}

/// Collects the exemplar pixels that the patches over a pixel place there; `weight(i)` is the weight of patch `i`.
#[inline(always)]
fn collect(
    candidates: &mut Vec<VoteCandidate>,
    field: &Field,
    patch: usize,
    [x, y]: [usize; 2],
    weight: impl Fn(usize) -> f64,
) {
    candidates.clear();
    for fy in fields_over(y, patch, field.height) {
        for fx in fields_over(x, patch, field.width) {
            let i = fy * field.width + fx;
            if field.at[i] == NONE {
                continue;
            }
            let offset = field.at[i].wrapping_sub(pack(fx, fy));
            let weight = weight(i);
            match candidates.iter_mut().find(|b| b.offset == offset) {
                Some(b) => (b.count, b.weight) = (b.count + 1, b.weight + weight),
                None => candidates.push(VoteCandidate { offset, count: 1, weight }),
            }
        }
    }
}

/// Returns the offset from target to source that all patches over a pixel share; `None` if the offsets differ or a
/// patch has no match.
#[inline]
fn common_offset(field: &Field, patch: usize, x: usize, y: usize) -> Option<u32> {
    let (columns, rows) = (fields_over(x, patch, field.width), fields_over(y, patch, field.height));
    let first = field.at[rows.start * field.width + columns.start];
    let offset = first.wrapping_sub(pack(columns.start, rows.start));
    let agrees = |fy: usize| {
        let at = &field.at[fy * field.width + columns.start..fy * field.width + columns.end];
        at.iter().zip(pack(columns.start, fy)..).all(|(at, here)| at.wrapping_sub(here) == offset)
    };
    (first != NONE && rows.into_iter().all(agrees)).then_some(offset)
}

/// Returns the exemplar pixel that all patches over target pixel (`x`, `y`) place there; `None` if the patches
/// disagree or one of them has no match.
pub fn origin(field: &Field, patch: usize, x: usize, y: usize) -> Option<(usize, usize)> {
    common_offset(field, patch, x, y).map(|offset| unpack(offset.wrapping_add(pack(x, y))))
}

/// Returns the range of patches along one axis that cover a pixel.
fn fields_over(pixel: usize, patch: usize, count: usize) -> std::ops::Range<usize> {
    (pixel + 1).saturating_sub(patch)..(pixel + 1).min(count)
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
        let middle = |mode| {
            let mut out = Image::new(9, 5, 1).unwrap();
            vote(&mut out, &field, &style, 5, mode, Monitor::default().job(), |_| true).unwrap();
            out.pixel(4, 2)[0]
        };
        assert_eq!(
            [VoteMode::Plain, VoteMode::Weighted, VoteMode::Nearest, VoteMode::Majority].map(middle),
            [0.5, 0.5, 0.5, 0.0]
        );
    }
}
