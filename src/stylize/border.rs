//! Joins new paint to the painted part of a half-painted picture.
//!
//! Patches astride the border of the painted part contain painted pixels, which never change. The artist's paint thus
//! constrains these patches. Three steps make the new paint continue the artist's paint:
//!
//! - Each iteration matches the patches astride the border once more, with guides of a lower weight. Strokes that cross
//!   the border then find places of the artwork where such strokes continue.
//! - No exemplar patch is used too often. If no light in the painted part resembles the light of some place to paint, a
//!   single exemplar patch is nearest to all target patches of that place. Without a limit, copies of this exemplar
//!   patch would fill the place.
//! - The matches also determine paint for the painted pixels. The difference between the artist's paint and this paint
//!   would show as a step at the border. After the final vote, this difference fades out from the border into the new
//!   paint (a membrane, as in Pérez et al. 2003, "Poisson Image Editing").

use super::level::{Level, Problem};
use super::params::Params;
use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_collect, try_vec};
use crate::job::Job;
use crate::patch::{Domain, Field, NONE, Search, SearchIteration, VoteMode, unpack, vote};

/// Weight of the guides for patches astride the border, relative to their weight elsewhere. [bench stylit:autocomplete]
const GUIDES: f32 = 0.1;
/// Settings of the PatchMatch search that matches the patches astride the border once more. `ITERATIONS`: number of
/// search iterations. `RADIUS`: radius of the random search in pixels.
const ITERATIONS: usize = 2;
const RADIUS: usize = 256;
/// Maximum number of uses of an exemplar patch, as a multiple of the mean number of uses; the mean counts as at least
/// 1. [bench stylit:autocomplete]
const MAX_USES: f64 = 100.0;
/// Maximum number of rounds of [`limit_usage`]. In each round, exemplar patches above the maximum number of uses give
/// up target patches, which then search for other matches.
const ROUNDS: usize = 8;
/// `FADE_WIDTH`: number of diffusion steps, and thus the number of pixels over which a difference at the border fades
/// out. `DIFFUSION_FACTOR`: factor on the mean of the neighbours in each step (see [`spread`]).
/// [bench stylit:autocomplete]
const FADE_WIDTH: usize = 12;
const DIFFUSION_FACTOR: f32 = 0.97;

/// The border of the painted part at one pyramid level.
pub(super) struct Border<'a> {
    /// The pyramid level with the guides' weight multiplied by [`GUIDES`].
    level: Level<'a>,
    /// For each target patch, whether it contains both painted and unpainted pixels.
    is_astride: Vec<bool>,
}

impl<'a> Border<'a> {
    /// Returns the border of the painted part; `None` if the target has no painted part. Patches with `kept` set keep
    /// their matches.
    pub fn new(problem: &'a Problem, kept: &[bool], params: &Params, seed: u64, job: Job) -> Result<Option<Self>> {
        let (Some(mask), Some(_)) = (&problem.target_mask, &problem.known) else { return Ok(None) };
        let params = Params { guide_weight: params.guide_weight * GUIDES, ..params.clone() };
        let level = Level::new(problem, &params, 1.0, seed, job)?;
        let target = &level.target;
        let unpainted = Domain::new(target.width, target.height, problem.patch, Some(mask), false)?;
        let is_kept = |i: usize| kept.get(i) == Some(&true);
        let is_astride = |i: usize| level.wanted.contains_index(i) && !unpainted.contains_index(i) && !is_kept(i);
        let is_astride = try_collect((0..unpainted.flags().len()).map(is_astride))?;
        Ok(Some(Self { level, is_astride }))
    }

    /// Matches the patches astride the border again, with guides of a lower weight. Then stores the distances of the
    /// new matches as `level` measures them, with the guides' ordinary weight.
    pub fn rematch(&mut self, level: &Level, field: &mut Field, picture: &Image, round: u64, job: Job) -> Result<()> {
        let is_astride = |i: usize| self.is_astride[i];
        self.level.set_picture(picture, job)?;
        let search = self.level.forward();
        search.rescore(field, job, is_astride)?;
        for k in 0..ITERATIONS {
            let index = 4000 + 10 * round + k as u64;
            search.iterate(field, SearchIteration { index, radius: RADIUS, initial_samples: 8 }, job, is_astride)?;
        }
        level.forward().rescore(field, job, is_astride)
    }
}

/// Searches for other matches of target patches whose exemplar patch is used too often. The exemplar patch keeps the
/// target patches with the smallest distances, up to the maximum number of uses.
pub(super) fn limit_usage(level: &Level, field: &mut Field, job: Job) -> Result<()> {
    let mean = level.wanted.len() as f64 / level.allowed.len() as f64;
    let max_uses = (MAX_USES * mean.max(1.0)) as usize;
    let mut free = level.allowed.try_clone()?;
    for round in 0..ROUNDS {
        let mut users = try_collect((0..field.at.len()).filter(|&i| field.at[i] != NONE))?;
        users.sort_unstable_by_key(|&i| (field.at[i], field.error[i], i));
        let mut beyond = try_vec(field.at.len(), false)?;
        for group in users.chunk_by(|&a, &b| field.at[a] == field.at[b]).filter(|group| group.len() >= max_uses) {
            let (x, y) = unpack(field.at[group[0]]);
            free.remove(y * free.width + x);
            group[max_uses..].iter().for_each(|&i| beyond[i] = true);
        }
        if !beyond.contains(&true) {
            break;
        }
        free.compact();
        // Keep the matches above the maximum as starting positions of the search, and discard their distances.
        (0..beyond.len()).filter(|&i| beyond[i]).for_each(|i| field.error[i] = u32::MAX);
        let search = Search { allowed: &free, ..level.forward() };
        let iteration = SearchIteration { index: 5000 + round as u64, radius: 64, initial_samples: 8 };
        search.iterate(field, iteration, job, |i| beyond[i])?;
        level.forward().rescore(field, job, |i| beyond[i])?;
    }
    Ok(())
}

/// Fades out the step at the border of the painted part, in the pixels for which `wanted` holds. `mode` is the vote
/// that has painted these pixels of `picture` from `field`.
pub(super) fn fade(
    picture: &mut Image,
    field: &Field,
    problem: &Problem,
    mode: VoteMode,
    job: Job,
    wanted: impl Fn(usize) -> bool,
) -> Result<()> {
    let Some(mask) = &problem.target_mask else { return Ok(()) };
    // Vote on the painted pixels, and subtract the result from the artist's paint.
    let mut step = picture.try_clone()?;
    vote(&mut step, field, &problem.style, problem.patch, mode, job, |i| !mask[i])?;
    step.data.iter_mut().zip(&picture.data).for_each(|(step, paint)| *step = paint - *step);
    for _ in 0..FADE_WIDTH {
        spread(&mut step, mask, job)?;
    }
    let channels = picture.channels;
    let pixels = picture.data.chunks_exact_mut(channels).zip(step.data.chunks_exact(channels)).zip(mask);
    for (_, ((pixel, step), _)) in pixels.enumerate().filter(|(i, (_, unpainted))| **unpainted && wanted(*i)) {
        pixel.iter_mut().zip(step).for_each(|(v, step)| *v = (*v + step).clamp(0.0, 1.0));
    }
    Ok(())
}

/// Replaces each pixel inside the mask by [`DIFFUSION_FACTOR`] times the mean of its four neighbours.
fn spread(image: &mut Image, mask: &[bool], job: Job) -> Result<()> {
    let (width, height, channels) = (image.width, image.height, image.channels);
    let before = image.try_clone()?;
    exec::for_rows(&mut image.data, width * channels, job, |y, row| {
        for (x, pixel) in row.chunks_exact_mut(channels).enumerate().filter(|(x, _)| mask[y * width + x]) {
            let around = [
                [x.saturating_sub(1), y],
                [(x + 1).min(width - 1), y],
                [x, y.saturating_sub(1)],
                [x, (y + 1).min(height - 1)],
            ];
            for (c, v) in pixel.iter_mut().enumerate() {
                *v = 0.25 * DIFFUSION_FACTOR * around.map(|[x, y]| before.pixel(x, y)[c]).iter().sum::<f32>();
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    /// After many diffusion steps, a difference at a straight border falls by a factor r from each pixel to the next,
    /// where 4 / DIFFUSION_FACTOR = 2 + r + 1 / r.
    #[test]
    fn a_step_fades_out_from_a_straight_border() {
        let mut step = Image::from_fn(40, 9, |x, _| [f32::from(x < 10)]).unwrap();
        let mask: Vec<bool> = (0..40 * 9).map(|i| i % 40 >= 10).collect();
        let mut spread_times = |n: usize| {
            (0..n).for_each(|_| spread(&mut step, &mask, Monitor::default().job()).unwrap());
            (0..40).map(|x| step.pixel(x, 4)[0]).collect::<Vec<f32>>()
        };
        let reached = spread_times(FADE_WIDTH);
        assert!(reached[..10].iter().all(|v| *v == 1.0) && reached[10 + FADE_WIDTH..].iter().all(|v| *v == 0.0));
        let b = 2.0 / DIFFUSION_FACTOR - 1.0;
        let r = b - (b * b - 1.0).sqrt();
        let settled = spread_times(300);
        for (k, v) in settled[9..20].iter().enumerate() {
            assert!((v - r.powi(k as i32)).abs() < 1e-3, "{k}: {v} {}", r.powi(k as i32));
        }
    }
}
