//! Stylises the frames of a sequence (StyLit, section 5, future work). The matches of the previous frame, advected by
//! the motion, are kept where they still fit, so that paint sticks to objects. Three kinds of patches are matched anew:
//!
//! - patches whose match fits badly;
//! - patches astride a silhouette: their pixels do not all come from one patch of the previous frame. If they kept a
//!   match, its paint would stay behind as the ghost of a contour;
//! - patches whose light has changed since their match was chosen (`guide_record`). The change adds up over the frames,
//!   so the paint follows slow changes too.
//!
//! `Params::coherence` is the share of fitting matches that are kept: 1 keeps all, 0 none. In between, each frame keeps
//! the matches of a random set of blocks. The frames then flicker as if painted by hand (after the temporal noise
//! control of Fišer et al. 2014, "Color Me Noisy").

use super::budget::budget;
use super::guide_record::GuideRecord;
use super::level::{Level, Problem};
use super::params::Params;
use super::picture::paint;
use crate::error::Result;
use crate::image::{Image, try_collect, try_vec};
use crate::job::Job;
use crate::patch::{Field, NONE, halve};
use crate::rng::Rng;

/// Side, in pixels, of the blocks whose matches are kept or discarded together.
const BLOCK: usize = 24;

/// A patch is astride a silhouette if the motion of one of its pixels differs from the motion of its centre by more
/// than this, in pixels along x or y. [bench sequences]
const MAX_SPREAD: f32 = 1.0;
/// A patch is matched anew when the light on it has changed by more than this since its match was chosen: the weighted
/// root mean square over the channels of light, encoded for display (white = 1). [bench sequences]
const MAX_CHANGE: f32 = 0.02;

/// The matches of the previous frame, advected into this frame.
pub(super) struct Moved {
    pub field: Field,
    /// The patch of the previous frame from which each match comes. [`NONE`] if the match must not be kept: the target
    /// patch is astride a silhouette, or its centre was not visible in the previous frame.
    pub from: Vec<u32>,
}

/// Advects the field (the matches) of the previous frame into this frame. `motion` leads from each pixel to the
/// position of the same surface point in the previous frame. The motion at the centre of a patch leads to a patch of
/// the previous frame; the match of that patch is taken over. `motion` has the resolution of the guides. If the problem
/// has half that resolution (`halved` is not 0), this function halves `motion`.
pub(super) fn moved(before: &Field, motion: &Image, problem: &Problem, halved: usize, job: Job) -> Result<Moved> {
    if halved == 0 {
        return advect(before, motion, problem.patch);
    }
    let mut half = halve(motion, job.part(0.0, 0.01))?;
    half.data.iter_mut().for_each(|v| *v /= 2.0);
    advect(before, &half, problem.patch)
}

fn advect(before: &Field, motion: &Image, patch: usize) -> Result<Moved> {
    let mut field = Field::new(before.width, before.height)?;
    let mut from = try_vec(before.at.len(), NONE)?;
    let inside = |v: f32, n: usize| (v >= 0.0 && v < n as f32).then_some(v as usize);
    for (i, at) in field.at.iter_mut().enumerate() {
        let (x, y) = (i % before.width, i / before.width);
        let step = motion.pixel(x + patch / 2, y + patch / 2);
        // Adding half a pixel before truncation rounds to the nearest position; NaN counts as outside.
        let place = (inside(x as f32 + step[0] + 0.5, before.width), inside(y as f32 + step[1] + 0.5, before.height));
        if let (Some(px), Some(py)) = place {
            *at = before.at[py * before.width + px];
            let differs = |other: &[f32]| (0..2).any(|k| !((other[k] - step[k]).abs() <= MAX_SPREAD));
            let is_astride = (y..y + patch).any(|y| (x..x + patch).any(|x| differs(motion.pixel(x, y))));
            if !is_astride {
                from[i] = (py * before.width + px) as u32;
            }
        }
    }
    Ok(Moved { field, from })
}

/// The records of the guides of the previous frame and of this frame.
pub(super) type GuideRecords<'a> = Option<(&'a GuideRecord, &'a GuideRecord)>;

/// Computes the distances of the advected matches. Returns for each target patch whether it keeps its match, which
/// requires all of these conditions:
/// - The error of the match lies left of the knee of the sorted errors.
/// - The light on the patch has hardly changed since the match was chosen; always true without `guide_records`.
/// - The patch is not astride a silhouette, and its centre was visible in the previous frame.
/// - [`Params::coherence`] does not choose the block of the patch for new matches.
pub(super) fn keep(
    level: &mut Level,
    moved: &mut Moved,
    guide_records: GuideRecords,
    params: &Params,
    seed: u64,
    job: Job,
) -> Result<Vec<bool>> {
    let Moved { field, from } = moved;
    let mut picture = level.problem.blank_picture()?;
    paint(&mut picture, field, level.problem, params.vote, job, |_| true)?;
    level.set_picture(&picture, job)?;
    level.forward().rescore(field, job, |i| level.wanted.contains_index(i))?;

    let fits = |i: usize| level.wanted.contains_index(i) && field.at[i] != NONE && field.error[i] != u32::MAX;
    let mut errors = try_collect((0..field.at.len()).filter(|&i| fits(i)).map(|i| field.error[i]))?;
    errors.sort_unstable();
    let feasible = (budget(&errors).knee * errors.len() as f64).ceil() as usize;
    let limit = errors.get(feasible.saturating_sub(1)).copied().unwrap_or(0);
    let block = |i: usize| [(i % field.width / BLOCK) as u64, (i / field.width / BLOCK) as u64];
    let stays = |i: usize| Rng::new(seed, &block(i)).next_f32() < params.coherence;
    let is_lit_alike = |i: usize| {
        // Each block has a limit of its own, 0.5 to 1.5 times `MAX_CHANGE`. If the light changes slowly, the blocks are
        // therefore matched anew in different frames.
        let share = 0.5 + Rng::new(2, &block(i)).next_f32();
        guide_records.is_none_or(|(before, now)| now.change(i, before, from[i] as usize) <= share * MAX_CHANGE)
    };
    try_collect(
        (0..field.at.len())
            .map(|i| fits(i) && field.error[i] <= limit && stays(i) && from[i] != NONE && is_lit_alike(i)),
    )
}
