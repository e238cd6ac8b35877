//! The image a field stands for: the average of the pixels that overlapping matches put in each place (Algorithm 1).

use super::domain::Domain;
use super::field::{Field, NONE, pack, unpack};
use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_vec};
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

/// Writes into each pixel of `out` what the matches in `style` say; a pixel that no match covers keeps its value.
/// Where all agree the result is the exemplar's pixel to the bit.
pub fn vote(
    out: &mut Image,
    field: &Field,
    style: &Image,
    base: &Domain,
    patch: usize,
    how: Vote,
    job: Job,
) -> Result<()> {
    let channels = out.channels;
    let matched = field.error.iter().filter(|&&e| e != u32::MAX).count().max(1);
    let scale = (field.energy() / matched as f64).max(1.0);
    debug_assert!(base.width + patch - 1 == style.width);
    exec::for_rows(&mut out.data, out.width * channels, job, |y, row| {
        let mut votes: Vec<(usize, f64)> = Vec::with_capacity(patch * patch);
        for (x, pixel) in row.chunks_exact_mut(channels).enumerate() {
            // Collect the exemplar's pixels that the patches over this place put here.
            votes.clear();
            for fy in fields_over(y, patch, field.height) {
                for fx in fields_over(x, patch, field.width) {
                    let i = fy * field.width + fx;
                    if field.at[i] != NONE {
                        let (px, py) = unpack(field.at[i]);
                        let weight = match how {
                            Vote::Weighted => 1.0 / (1.0 + f64::from(field.error[i]) / scale),
                            _ => 1.0,
                        };
                        votes.push((((py + y - fy) * style.width + px + x - fx) * channels, weight));
                    }
                }
            }
            let Some(&(first, _)) = votes.first() else { continue };
            if votes.iter().all(|v| v.0 == first) {
                pixel.copy_from_slice(&style.data[first..first + channels]);
                continue;
            }
            let total: f64 = votes.iter().map(|v| v.1).sum();
            for (c, value) in pixel.iter_mut().enumerate() {
                let sum: f64 = votes.iter().map(|&(start, weight)| weight * f64::from(style.data[start + c])).sum();
                *value = (sum / total) as f32;
            }
            if matches!(how, Vote::Nearest | Vote::Most) {
                let count = |start: usize| match how {
                    Vote::Most => votes.iter().filter(|v| v.0 == start).count(),
                    _ => 0,
                };
                let distance = |start: usize| -> f32 {
                    style.data[start..start + channels].iter().zip(&*pixel).map(|(s, m)| (s - m) * (s - m)).sum()
                };
                let candidates = votes.iter().map(|v| (count(v.0), distance(v.0), v.0));
                let best = candidates.min_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
                let start = best.map_or(first, |b| b.2);
                pixel.copy_from_slice(&style.data[start..start + channels]);
            }
        }
    })
}

/// For each pixel the pixel of `style` that all the matches over it put there; [`NONE`] where they differ or none covers.
pub fn origins(width: usize, height: usize, field: &Field, patch: usize, job: Job) -> Result<Vec<u32>> {
    let mut out = try_vec(width * height, NONE)?;
    exec::for_rows(&mut out, width, job, |y, row| {
        for (x, origin) in row.iter_mut().enumerate() {
            let mut votes = (fields_over(y, patch, field.height))
                .flat_map(|fy| fields_over(x, patch, field.width).map(move |fx| (fx, fy)))
                .filter_map(|(fx, fy)| match field.at[fy * field.width + fx] {
                    NONE => None,
                    at => Some(unpack(at)).map(|(px, py)| pack(px + x - fx, py + y - fy)),
                });
            if let Some(first) = votes.next()
                && votes.all(|v| v == first)
            {
                *origin = first;
            }
        }
    })?;
    Ok(out)
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
        let base = Domain::new(40, 5, 5, None, false).unwrap();
        let mut field = Field::new(5, 1).unwrap();
        field.at = [6, 7, 18, 27, 33].map(|x| pack(x, 0)).to_vec();
        field.error = vec![1; 5];
        let middle = |how| {
            let mut out = Image::new(9, 5, 1).unwrap();
            vote(&mut out, &field, &style, &base, 5, how, Monitor::default().job()).unwrap();
            out.pixel(4, 2)[0]
        };
        assert_eq!([Vote::Plain, Vote::Weighted, Vote::Nearest, Vote::Most].map(middle), [0.5, 0.5, 0.5, 0.0]);
    }
}
