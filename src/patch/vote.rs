//! The image a field stands for: the average of the pixels that overlapping matches put in each place (Algorithm 1).

use super::field::{Field, NONE, pack, unpack};
use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::job::Job;

/// How the pixels that fall on the same place are combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vote {
    /// Their mean, as in the paper.
    Plain,
    /// Their mean weighted by `1 / (1 + E / mean E)`.
    Weighted,
    /// The one that is closest to their mean: no new colours, so texture keeps its contrast.
    Nearest,
    /// The one that most of them put there, among equals the closest to their mean: where two pieces of the exemplar meet,
    /// each stays whole up to the seam.
    Most,
}

/// What the matches over one place put there: pixels of the exemplar, each once.
struct Ballot {
    /// Where in the exemplar relative to the place, wrapping: the same for patches that continue each other.
    offset: u32,
    count: usize,
    weight: f64,
}

/// Writes into each pixel of `out` for which `wanted` holds what the matches in `style` say; a pixel that no match covers
/// keeps its value. Where all agree the result is the exemplar's pixel to the bit.
pub fn vote(
    out: &mut Image,
    field: &Field,
    style: &Image,
    patch: usize,
    how: Vote,
    job: Job,
    wanted: impl Fn(usize) -> bool + Sync,
) -> Result<()> {
    let (width, channels) = (out.width, out.channels);
    let matched = field.error.iter().filter(|&&e| e != u32::MAX).count().max(1);
    let scale = (field.energy() / matched as f64).max(1.0);
    exec::for_rows(&mut out.data, width * channels, job, |y, row| {
        let mut ballots: Vec<Ballot> = Vec::with_capacity(patch * patch);
        for (x, pixel) in row.chunks_exact_mut(channels).enumerate().filter(|(x, _)| wanted(y * width + x)) {
            let colour = |offset: u32| {
                let (px, py) = unpack(offset.wrapping_add(pack(x, y)));
                style.pixel(px, py)
            };
            // Mostly one piece of the exemplar covers the place.
            if let Some(offset) = common_offset(field, patch, x, y) {
                pixel.copy_from_slice(colour(offset));
                continue;
            }
            // Collect the exemplar's pixels that the patches over this place put here.
            ballots.clear();
            for fy in fields_over(y, patch, field.height) {
                for fx in fields_over(x, patch, field.width) {
                    let i = fy * field.width + fx;
                    if field.at[i] == NONE {
                        continue;
                    }
                    let offset = field.at[i].wrapping_sub(pack(fx, fy));
                    let weight = match how {
                        Vote::Weighted => 1.0 / (1.0 + f64::from(field.error[i]) / scale),
                        _ => 1.0,
                    };
                    match ballots.iter_mut().find(|b| b.offset == offset) {
                        Some(b) => (b.count, b.weight) = (b.count + 1, b.weight + weight),
                        None => ballots.push(Ballot { offset, count: 1, weight }),
                    }
                }
            }
            match &ballots[..] {
                [] => continue,
                [only] => {
                    pixel.copy_from_slice(colour(only.offset));
                    continue;
                }
                _ => (),
            }
            let total: f64 = ballots.iter().map(|b| b.weight).sum();
            for (c, value) in pixel.iter_mut().enumerate() {
                let sum: f64 = ballots.iter().map(|b| b.weight * f64::from(colour(b.offset)[c])).sum();
                *value = (sum / total) as f32;
            }
            if matches!(how, Vote::Nearest | Vote::Most) {
                let count = |b: &Ballot| if how == Vote::Most { b.count } else { 0 };
                let distance =
                    |b: &Ballot| -> f32 { colour(b.offset).iter().zip(&*pixel).map(|(s, m)| (s - m) * (s - m)).sum() };
                let best = (ballots.iter())
                    .min_by(|a, b| count(b).cmp(&count(a)).then_with(|| distance(a).total_cmp(&distance(b))));
                if let Some(best) = best {
                    pixel.copy_from_slice(colour(best.offset));
                }
            }
        }
    })
}

/// Where in the exemplar, relative to a place, all the matches over it have it from; `None` where they differ or one is
/// missing.
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

/// The pixel of the exemplar that all the matches over a place put there; `None` where they differ or one is missing.
pub fn origin(field: &Field, patch: usize, x: usize, y: usize) -> Option<(usize, usize)> {
    common_offset(field, patch, x, y).map(|offset| unpack(offset.wrapping_add(pack(x, y))))
}

/// The patches along one axis that cover a pixel.
fn fields_over(pixel: usize, patch: usize, count: usize) -> std::ops::Range<usize> {
    (pixel + 1).saturating_sub(patch)..(pixel + 1).min(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    /// Five patches over one pixel: two put 0 there, the others 0.5, 1 and 1 from different places.
    #[test]
    fn votes_are_averaged_or_chosen_from() {
        let style = Image::from_fn(40, 5, |x, _| [[0.0, 0.5, 1.0, 1.0][(x.clamp(10, 39) - 10) / 8]]).unwrap();
        let mut field = Field::new(5, 1).unwrap();
        field.at = [6, 7, 18, 27, 33].map(|x| pack(x, 0)).to_vec();
        field.error = vec![1; 5];
        let middle = |how| {
            let mut out = Image::new(9, 5, 1).unwrap();
            vote(&mut out, &field, &style, 5, how, Monitor::default().job(), |_| true).unwrap();
            out.pixel(4, 2)[0]
        };
        assert_eq!([Vote::Plain, Vote::Weighted, Vote::Nearest, Vote::Most].map(middle), [0.5, 0.5, 0.5, 0.0]);
    }
}
