//! The votes for one pixel: the exemplar pixels that the patches over the pixel place there.

use super::field::Field;
use super::position::{NONE, pack, unpack};
use crate::image::Image;

/// The votes for the pixels of an image that is reconstructed from a field.
#[derive(Clone, Copy)]
pub(super) struct Ballot<'a> {
    pub field: &'a Field,
    /// The exemplar.
    pub style: &'a Image,
    /// Width of a patch.
    pub patch: usize,
    /// Mean of the distances of all matches, at least 1.
    scale: f64,
}

/// An exemplar pixel that at least one patch places at the target pixel, with its votes.
pub(super) struct Candidate {
    /// Packed position of the source minus packed position of the target, wrapping. It is equal for patches that
    /// continue each other.
    pub offset: u32,
    pub count: usize,
    pub weight: f64,
}

impl<'a> Ballot<'a> {
    pub fn new(field: &'a Field, style: &'a Image, patch: usize) -> Self {
        let matched = field.error.iter().filter(|&&e| e != u32::MAX).count().max(1);
        Self { field, style, patch, scale: (field.energy() / matched as f64).max(1.0) }
    }

    /// Returns the position of the exemplar pixel at an offset from a target pixel.
    #[inline]
    pub fn source(offset: u32, [x, y]: [usize; 2]) -> (usize, usize) {
        unpack(offset.wrapping_add(pack(x, y)))
    }

    /// Returns the colour of the exemplar pixel at an offset from a target pixel.
    #[inline]
    pub fn colour(&self, offset: u32, at: [usize; 2]) -> &'a [f32] {
        let (x, y) = Self::source(offset, at);
        self.style.pixel(x, y)
    }

    /// Collects the candidates of a pixel. If `weighted`, a vote has the weight `1 / (1 + E / mean E)`, otherwise 1. E
    /// is the distance of a match, and `mean E` its mean over all matches of the field.
    #[inline(always)]
    pub fn collect(&self, candidates: &mut Vec<Candidate>, [x, y]: [usize; 2], weighted: bool) {
        let Self { field, patch, scale, .. } = *self;
        candidates.clear();
        for fy in patches_over(y, patch, field.height) {
            for fx in patches_over(x, patch, field.width) {
                let i = fy * field.width + fx;
                if field.at[i] == NONE {
                    continue;
                }
                let offset = field.at[i].wrapping_sub(pack(fx, fy));
                let weight = if weighted { 1.0 / (1.0 + f64::from(field.error[i]) / scale) } else { 1.0 };
                match candidates.iter_mut().find(|b| b.offset == offset) {
                    Some(b) => (b.count, b.weight) = (b.count + 1, b.weight + weight),
                    None => candidates.push(Candidate { offset, count: 1, weight }),
                }
            }
        }
    }

    /// Writes the weighted mean of the candidates' colours.
    #[inline]
    pub fn mean(&self, candidates: &[Candidate], at: [usize; 2], out: &mut [f32]) {
        let total: f64 = candidates.iter().map(|b| b.weight).sum();
        for (c, value) in out.iter_mut().enumerate() {
            let sum: f64 = candidates.iter().map(|b| b.weight * f64::from(self.colour(b.offset, at)[c])).sum();
            *value = (sum / total) as f32;
        }
    }

    /// Returns the offset of the candidate whose colour is closest to `mean`; `None` if there are no candidates. If
    /// `by_count`, only the candidates with the most votes are compared.
    #[inline]
    pub fn choose(&self, candidates: &[Candidate], at: [usize; 2], mean: &[f32], by_count: bool) -> Option<u32> {
        let count = |b: &Candidate| if by_count { b.count } else { 0 };
        let distance =
            |b: &Candidate| -> f32 { self.colour(b.offset, at).iter().zip(mean).map(|(s, m)| (s - m) * (s - m)).sum() };
        let better =
            |a: &Candidate, b: &Candidate| count(b).cmp(&count(a)).then_with(|| distance(a).total_cmp(&distance(b)));
        candidates.iter().min_by(|a, b| better(a, b)).map(|best| best.offset)
    }
}

/// Returns the offset from target to source that all patches over a pixel share; `None` if the offsets differ or a
/// patch has no match.
#[inline]
pub(super) fn common_offset(field: &Field, patch: usize, [x, y]: [usize; 2]) -> Option<u32> {
    let (columns, rows) = (patches_over(x, patch, field.width), patches_over(y, patch, field.height));
    let first = field.at[rows.start * field.width + columns.start];
    let offset = first.wrapping_sub(pack(columns.start, rows.start));
    let agrees = |fy: usize| {
        let at = &field.at[fy * field.width + columns.start..fy * field.width + columns.end];
        at.iter().zip(pack(columns.start, fy)..).all(|(at, here)| at.wrapping_sub(here) == offset)
    };
    (first != NONE && rows.into_iter().all(agrees)).then_some(offset)
}

/// Returns the range of patches along one axis that cover a pixel.
fn patches_over(pixel: usize, patch: usize, count: usize) -> std::ops::Range<usize> {
    (pixel + 1).saturating_sub(patch)..(pixel + 1).min(count)
}
