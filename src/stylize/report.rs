//! Measures a run: energy, coverage, patch usage, guide error.

use super::exemplar::Doubts;
use super::lack::Lack;
use super::level::{Level, Problem};
use super::retrieve::PassReport;
use crate::error::Result;
use crate::exec;
use crate::image::{Comparison, Image, try_vec};
use crate::job::Job;
use crate::maths;
use crate::patch::{Field, NONE, unpack};

/// The report of one resolution level.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelReport {
    pub width: usize,
    pub height: usize,
    /// Energy (StyLit, Eq. 3) after each iteration, divided by the number of target patches and by the pixels of a
    /// patch: the mean weighted squared difference of channels in `[0, 1]`. The artwork's channels have a total weight
    /// of 1. The guides' channels have a total weight of μ, times `Params::coarse_guides` on all levels except the
    /// finest.
    pub energy: Vec<f64>,
    /// Retrieval passes of each iteration.
    pub passes: Vec<Vec<PassReport>>,
}

/// Usage statistics of the exemplar patches in the result.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Usage {
    /// Share of the allowed exemplar patches that are used.
    pub used: f64,
    /// Number of uses of the patch that is used most often.
    pub max_uses: u32,
    /// Entropy, in bits, of the distribution of the matches over the exemplar patches; at most log2 of the number of
    /// target patches.
    pub entropy: f64,
}

#[derive(Clone, Debug)]
pub struct Report {
    /// Reports of the levels, coarsest level first.
    pub levels: Vec<LevelReport>,
    pub usage: Usage,
    /// Of the pixels painted by a vote, the share that are whole exemplar pixels, in `[0, 1]`; the others are blends of
    /// exemplar pixels.
    pub unblended_share: f64,
    /// One channel: for each target pixel, the weighted root mean square difference between its guides and the guides
    /// of the exemplar pixel painted there, in `[0, 1]`. It is high where no part of the exemplar is suitable (StyLit,
    /// Fig. 17), and 0 where a pixel has no match.
    pub guide_error: Image,
    /// Two channels: for each target pixel, the position in the artwork from which its paint comes, x and y in pixels.
    /// Of the patches that cover the pixel, the patch with the nearest centre determines the position. Both values are
    /// -1 if that patch has no match.
    pub sources: Image,
    /// Number of halvings from the target's size to the result's: 1 in preview, else 0.
    pub halvings: usize,
    /// The patch width used.
    pub patch: usize,
    /// Number of exemplar pixels left out because they are NaN or infinite (`broken_source`), and number of target
    /// guide pixels set to 0 for the same reason (`broken_target`).
    pub broken_source: usize,
    pub broken_target: usize,
    /// How the motion agrees with the guides of both frames. A pixel is wrong if its motion leads to another surface in
    /// the previous frame. Zeros without motion or a record of the previous frame, and in a preview.
    pub agreement: Comparison,
    /// The part of the target whose light the exemplar lacks.
    pub lack: Lack,
    /// Defects of the exemplar.
    pub doubts: Doubts,
    /// Weight with which [`Input::normals`](super::Input::normals) guided the run: 0 if they are missing, or if the
    /// strokes of the exemplar do not follow the shapes.
    pub normals_weight: f32,
}

impl Usage {
    pub(super) fn of(field: &Field, level: &Level) -> Result<Self> {
        let mut counts = try_vec(level.allowed.width * level.allowed.height, 0u32)?;
        let mut total = 0u32;
        for &at in field.at.iter().filter(|&&at| at != NONE) {
            let (x, y) = unpack(at);
            counts[y * level.allowed.width + x] += 1;
            total += 1;
        }
        let used = counts.iter().filter(|&&c| c > 0);
        let entropy = |c: u32| {
            let p = f64::from(c) / f64::from(total);
            -p * maths::log2(p)
        };
        Ok(Self {
            used: used.clone().count() as f64 / level.allowed.len().max(1) as f64,
            max_uses: used.clone().copied().max().unwrap_or(0),
            entropy: used.map(|&c| entropy(c)).sum(),
        })
    }
}

/// Returns the mean distance of matched patches, per pixel of a patch, in the units of Eq. 1 of StyLit with channels
/// in `[0, 1]`.
pub(super) fn energy(field: &Field, level: &Level) -> f64 {
    field.energy() / level.wanted.len().max(1) as f64 / level.unit()
}

/// Returns the exemplar pixel that is painted at a target pixel by the patch with the nearest centre.
fn source_of(field: &Field, patch: usize, x: usize, y: usize) -> Option<(usize, usize)> {
    let nearest = |pixel: usize, count: usize| pixel.saturating_sub(patch / 2).min(count - 1);
    let (fx, fy) = (nearest(x, field.width), nearest(y, field.height));
    let at = field.at[fy * field.width + fx];
    let (px, py) = unpack(at);
    (at != NONE).then_some((px + x - fx, py + y - fy))
}

/// Computes the guide error of each target pixel, as defined at [`Report::guide_error`].
pub(super) fn guide_error(field: &Field, problem: &Problem, job: Job) -> Result<Image> {
    let (source, target) = (&problem.guides.source, &problem.guides.target);
    let mut out = Image::new(target.width, target.height, 1)?;
    exec::for_rows(&mut out.data, target.width, job, |y, row| {
        for (x, error) in row.iter_mut().enumerate() {
            if let Some((px, py)) = source_of(field, problem.patch, x, y) {
                let terms = source.pixel(px, py).iter().zip(target.pixel(x, y)).zip(&problem.guides.weights);
                let sum: f64 = terms.map(|((a, b), w)| w * maths::powi(f64::from(a - b), 2)).sum();
                *error = sum.sqrt() as f32;
            }
        }
    })?;
    Ok(out)
}

/// Computes for each target pixel the position in the artwork from which its paint comes. The artwork was halved
/// `halvings` times for matching.
pub(super) fn sources(field: &Field, problem: &Problem, halvings: usize, job: Job) -> Result<Image> {
    let target = &problem.guides.target;
    let mut out = Image::new(target.width, target.height, 2)?;
    let pixel = (1 << halvings) as f32;
    exec::for_rows(&mut out.data, 2 * target.width, job, |y, row| {
        for (x, source) in row.chunks_exact_mut(2).enumerate() {
            match source_of(field, problem.patch, x, y) {
                Some((px, py)) => source.copy_from_slice(&[(px as f32 + 0.5) * pixel, (py as f32 + 0.5) * pixel]),
                None => source.fill(-1.0),
            }
        }
    })?;
    Ok(out)
}
