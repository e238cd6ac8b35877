//! The coarse-to-fine loop (StyLit, §3.4): alternate matching and voting on each level, then continue on the next
//! finer level from the upsampled field.

use super::animate::{Moved, keep, moved};
use super::border::{self, Border};
use super::exemplar::examine;
use super::finder::Nearest;
use super::guide_record::GuideRecord;
use super::lack::lack;
use super::level::{Level, Problem};
use super::output::{IntermediateResult, Output, Publish};
use super::params::{Finder, Input, Params};
use super::picture::{DecodeInput, decode, decode_into, paint, unblended_share};
use super::report::{LevelReport, Report, Usage, energy, guide_error, sources};
use super::retrieve::{PassReport, retrieve};
use crate::error::{Error, Result};
use crate::image::{Comparison, Image, try_collect};
use crate::job::Job;
use crate::maths;
use crate::patch::{Field, NONE, SearchIteration, level_count, unpack};
use crate::rng::hash;

/// If there are at most this many pairs of patches, the initial field is found by exhaustive comparison, otherwise by
/// the search that the parameters select.
const EXHAUSTIVE: usize = 1 << 24;

/// Values that all levels of a run share.
struct Setup<'a> {
    input: &'a Input<'a>,
    params: &'a Params,
    /// Number of pyramid levels of the run.
    levels: usize,
    /// Number of halvings from the artwork's size to the finest level: 1 for a preview, else 0.
    halved: usize,
    /// The matches of the previous frame, advected into this one.
    moved: Option<Moved>,
}

/// The state of a level between two iterations.
struct State {
    field: Field,
    picture: Image,
    /// For each target patch, whether it keeps its match of the previous frame; empty without motion.
    kept: Vec<bool>,
    /// Record of this frame's guides, by which the next frame decides which matches it keeps. For a kept match, the
    /// record holds the light of the frame in which the match was chosen.
    guide_record: Option<GuideRecord>,
}

/// Runs all levels. `guide_record` becomes the record of the output; `None` if no later frame needs it.
pub(super) fn run(
    problem: &Problem,
    mut guide_record: Option<GuideRecord>,
    input: &Input,
    params: &Params,
    publish: Publish,
    job: Job,
) -> Result<Output> {
    let halved = usize::from(!problem.is_of(input.artwork));
    let moved = match (input.previous, input.motion) {
        (Some(before), Some(motion)) => Some(moved(&checked_size(before, problem)?, motion, problem, halved, job)?),
        _ => None,
    };
    // A run that continues the matches of a previous result needs only the finest level. A frame of a sequence needs
    // all levels. With the finest level alone, places that were hidden in the previous frame, and places whose light
    // has changed, would be filled with the paint around them.
    let continues = input.previous.is_some() && moved.is_none();
    // Build the pyramid. Each level below full resolution is at least five patches wide along its shortest side.
    let levels = if continues { 1 } else { level_count(problem.shortest_side(), 5 * problem.patch, params.levels) };
    let mut coarser: Vec<Problem> = Vec::new();
    for _ in 1..levels {
        let next = coarser.last().unwrap_or(problem).halve(job.part(0.0, 0.01))?;
        coarser.push(next);
    }

    // A level costs four times as much as the next coarser level.
    let cost = |l: usize| maths::powi(0.25f64, l as i32);
    let total: f64 = (0..levels).map(cost).sum();
    let mut done = 0.0;
    let mut reports = Vec::new();
    let previous = input.previous.filter(|_| continues);
    let mut field = previous.map(|previous| checked_size(previous, problem)).transpose()?;
    let setup = Setup { input, params, levels, halved, moved };
    for l in (0..levels).rev() {
        let job = job.part(0.01 + 0.98 * done / total, 0.01 + 0.98 * (done + cost(l)) / total);
        done += cost(l);
        // Take the problem of this level out of the list, so that its memory is released after this level.
        let popped = if l > 0 { coarser.pop() } else { None };
        let problem = popped.as_ref().unwrap_or(problem);
        let seed = hash(params.seed, &[l as u64]);
        let mut level = quantise(problem, params, l, seed, job.part(0.0, 0.01))?;
        let guide_record = if l == 0 { guide_record.take() } else { None };
        let mut state = initialise(&mut level, field.take(), guide_record, &setup, l, job)?;
        reports.push(iterate(&mut level, &mut state, params, l, job)?);
        if l == 0 {
            return output(level, state, reports, &setup, job);
        }
        publish(IntermediateResult { picture: decode(&state.picture, job)?, halvings: l + halved, levels: &reports });
        field = Some(state.field);
    }
    Err(Error::new(crate::error::ErrorKind::Internal, "the pyramid has no levels"))
}

/// Quantises level `l` with the guide weight of this level.
fn quantise<'a>(problem: &'a Problem, params: &Params, l: usize, seed: u64, job: Job) -> Result<Level<'a>> {
    let guides = if l > 0 { params.coarse_guides } else { 1.0 };
    let weights = Params { guide_weight: params.guide_weight * guides, ..params.clone() };
    let level = Level::new(problem, &weights, 1.0, seed, job)?;
    if level.allowed.is_empty() {
        return Err(Error::degenerate(
            "no exemplar patch can be used: every patch is outside source_mask or has a pixel that is not finite"
                .to_string(),
        ));
    }
    Ok(level)
}

/// Returns the initial state of level `l`. The field comes from the next coarser level or from an earlier result, else
/// from a search by the guides alone.
fn initialise(
    level: &mut Level,
    field: Option<Field>,
    mut guide_record: Option<GuideRecord>,
    setup: &Setup,
    l: usize,
    job: Job,
) -> Result<State> {
    let (problem, params) = (level.problem, setup.params);
    // Start from the given field, or find a field by the guides alone.
    let (width, height) = (level.wanted.width, level.wanted.height);
    let mut field = match field {
        Some(coarse) if l + 1 < setup.levels => coarse.upsample(width, height, &level.allowed)?,
        Some(previous) => checked(previous, level)?,
        None => by_guides_alone(problem, params, level.seed, job.part(0.0, 0.1))?,
    };
    // Keep the matches of the previous frame where they fit.
    let kept = match &setup.moved {
        Some(moved) if l == 0 => {
            let from = try_collect(moved.from.iter().copied())?;
            let mut moved = Moved { field: checked(moved.field.try_clone()?, level)?, from };
            let before =
                setup.input.guide_record.filter(|before| guide_record.as_ref().is_some_and(|now| now.is_like(before)));
            let guide_records = before.zip(guide_record.as_ref());
            let kept = keep(level, &mut moved, guide_records, params, hash(level.seed, &[1]), job.part(0.1, 0.1))?;
            for i in (0..kept.len()).filter(|&i| kept[i]) {
                (field.at[i], field.error[i]) = (moved.field.at[i], moved.field.error[i]);
                if let (Some(guide_record), Some(before)) = (&mut guide_record, before) {
                    guide_record.recall(i, before, moved.from[i] as usize);
                }
            }
            kept
        }
        _ => Vec::new(),
    };
    let mut picture = problem.blank_picture()?;
    paint(&mut picture, &field, problem, params.vote, job.part(0.1, 0.12), |_| true)?;
    Ok(State { field, picture, kept, guide_record })
}

/// Alternates matching and voting on level `l`.
fn iterate(level: &mut Level, state: &mut State, params: &Params, l: usize, job: Job) -> Result<LevelReport> {
    let iterations = match l {
        0 => params.finest_iterations + params.polish,
        1 => params.iterations,
        _ => params.coarse_iterations,
    };
    let target = &level.problem.guides.target;
    let mut report = LevelReport { width: target.width, height: target.height, energy: Vec::new(), passes: Vec::new() };
    let mut border = Border::new(level.problem, &state.kept, params, level.seed, job.part(0.12, 0.12))?;
    for k in 0..iterations {
        let part = |from: f64, to: f64| {
            let n = iterations as f64;
            job.part(0.12 + 0.88 * (k as f64 + from) / n, 0.12 + 0.88 * (k as f64 + to) / n)
        };
        let passes = rematch(level, state, params, l, k, part(0.0, 0.9))?;
        report.passes.extend(passes);
        let State { field, picture, .. } = &mut *state;
        if let Some(border) = &mut border {
            border.rematch(level, field, picture, k as u64, part(0.9, 0.9))?;
            if l == 0 {
                border::limit_usage(level, field, part(0.9, 0.9))?;
            }
        }
        report.energy.push(energy(field, level));
        let is_last = l == 0 && k + 1 == iterations;
        let vote_mode = if is_last { params.final_vote } else { params.vote };
        paint(picture, field, level.problem, vote_mode, part(0.9, 1.0), |_| true)?;
        if is_last && border.is_some() {
            border::fade(picture, field, level.problem, vote_mode, part(1.0, 1.0), |_| true)?;
        }
    }
    Ok(report)
}

/// Runs iteration `k` of the matching on level `l`. Returns the retrieval passes, or `None` in the
/// iterations of `Params::polish`.
fn rematch(
    level: &mut Level,
    state: &mut State,
    params: &Params,
    l: usize,
    k: usize,
    job: Job,
) -> Result<Option<Vec<PassReport>>> {
    let State { field, picture, kept, .. } = state;
    // The distance of a match changes only if the target patch contains a changed pixel, so rematch only such patches.
    // Two iterations rematch all patches: the first one, because no distances are valid yet, and the first iteration of
    // `Params::polish`, because the matches were assigned under the budget instead of to the nearest exemplar patches.
    let polishes = l == 0 && k >= params.finest_iterations;
    let rematches_all = k == 0 || l == 0 && k == params.finest_iterations;
    let mut changed = if rematches_all {
        try_collect(level.wanted.flags().iter().copied())?
    } else {
        level.changed_by(picture, job.part(0.0, 0.01))?
    };
    level.set_picture(picture, job.part(0.0, 0.01))?;
    if !polishes {
        return retrieve(level, field, &changed, kept, params, k as u64, job).map(Some);
    }
    // Find the nearest exemplar patch of each target patch that has changed and is not kept. All other matches are up
    // to date.
    changed.iter_mut().zip(&*kept).for_each(|(changed, kept)| *changed &= !kept);
    let changed = |i: usize| changed[i];
    let search = level.forward();
    search.rescore(field, job.part(0.0, 0.1), changed)?;
    let nearest = Nearest::new(level, params, job.part(0.1, 0.2))?;
    nearest.forward(&search, field, k as u64, job.part(0.2, 1.0), changed)?;
    Ok(None)
}

/// Decodes the picture of the finest level and completes the report.
fn output(level: Level, state: State, levels: Vec<LevelReport>, setup: &Setup, job: Job) -> Result<Output> {
    let State { field, picture, guide_record, .. } = state;
    // Only pilot runs have no record: no later frame is compared with them.
    let guide_record = guide_record.unwrap_or_default();
    let problem = level.problem;
    let usage = Usage::of(&field, &level)?;
    drop(level);
    let mut image = picture.try_clone()?;
    let decode_input = DecodeInput { field: &field, problem, artwork: setup.input.artwork, known: setup.input.known };
    decode_into(&mut image, &picture, decode_input, job.part(1.0, 1.0), |_| true)?;
    let guide_error = guide_error(&field, problem, job)?;
    let report = Report {
        lack: lack(problem.light.as_ref(), problem.target_mask.as_deref(), &guide_error, job)?,
        doubts: examine(problem, job)?,
        normals_weight: problem.normals_weight,
        levels,
        usage,
        unblended_share: unblended_share(&picture, &field, problem, job)?,
        guide_error,
        sources: sources(&field, problem, setup.halved, job)?,
        halvings: setup.halved,
        patch: problem.patch,
        broken_source: problem.broken.0,
        broken_target: problem.broken.1,
        agreement: agreement(&guide_record, setup.input, setup.halved, job)?,
    };
    Ok(Output { image, field, guide_record, report })
}

/// Compares the motion, if any, with the guides of this frame and the previous one. A preview compares nothing: at
/// half the resolution, pixels at silhouettes average the motion and guides of two surfaces.
fn agreement(guide_record: &GuideRecord, input: &Input, halved: usize, job: Job) -> Result<Comparison> {
    match (input.motion, input.guide_record) {
        (Some(motion), Some(before)) if halved == 0 && guide_record.is_like(before) => {
            guide_record.agreement(before, motion, job)
        }
        _ => Ok(Comparison::default()),
    }
}

/// Finds an initial field by the guides alone, without colours. Among equally close matches, the match at the same
/// relative position is preferred, so that equal guides yield the identity.
fn by_guides_alone(problem: &Problem, params: &Params, seed: u64, job: Job) -> Result<Field> {
    let level = Level::new(problem, params, 0.0, seed, job.part(0.0, 0.01))?;
    let search = level.forward();
    let wanted = |i: usize| level.wanted.contains_index(i);
    let mut field = Field::proportional(level.wanted.width, level.wanted.height, &level.allowed)?;
    search.rescore(&mut field, job.part(0.0, 0.05), wanted)?;
    if level.wanted.len().saturating_mul(level.allowed.len()) <= EXHAUSTIVE {
        search.exhaustive(&mut field, job.part(0.05, 1.0), wanted)?;
    } else if params.finder == Finder::KdTree {
        let nearest = Nearest::new(&level, params, job.part(0.05, 0.4))?;
        nearest.forward(&search, &mut field, 0, job.part(0.4, 1.0), wanted)?;
    } else {
        let radius = level.allowed.width.max(level.allowed.height);
        for k in 0..8 {
            let iteration = SearchIteration { index: k, radius, initial_samples: 16 };
            search.iterate(
                &mut field,
                iteration,
                job.part(0.05 + 0.11 * k as f64, 0.05 + 0.11 * (k + 1) as f64),
                wanted,
            )?;
        }
    }
    Ok(field)
}

/// Checks that a field that the caller supplied has the size of the target, and copies it.
fn checked_size(field: &Field, problem: &Problem) -> Result<Field> {
    let target = &problem.guides.target;
    let (width, height) = (target.width + 1 - problem.patch, target.height + 1 - problem.patch);
    let count = width * height;
    if (field.width, field.height) != (width, height) || field.at.len() != count || field.error.len() != count {
        return Err(Error::argument(format!(
            "previous is a field of {} x {} patches; this target has {width} x {height}",
            field.width, field.height
        )));
    }
    field.try_clone()
}

/// Checks that the matches of a field that the caller supplied lie inside the exemplar.
fn checked(field: Field, level: &Level) -> Result<Field> {
    let outside = |&at: &u32| {
        let (x, y) = unpack(at);
        at != NONE && (x >= level.allowed.width || y >= level.allowed.height)
    };
    if field.at.iter().any(outside) {
        return Err(Error::argument("previous has matches outside the exemplar".to_string()));
    }
    Ok(field)
}
