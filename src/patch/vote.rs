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
            if how == Vote::Nearest {
                let distance = |start: usize| -> f32 {
                    style.data[start..start + channels].iter().zip(&*pixel).map(|(s, m)| (s - m) * (s - m)).sum()
                };
                let nearest = votes.iter().map(|v| v.0).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
                let start = nearest.unwrap_or(first);
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
