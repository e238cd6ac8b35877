//! The coarse-to-fine loop (§3.4): alternate matching and voting on each level, then continue on the next finer level
//! from the upsampled field.

use super::animate::{keep, moved};
use super::finder::Nearest;
use super::level::{Level, Problem};
use super::report::{LevelReport, Report, Usage, energy, guide_error, sources};
use super::retrieve::retrieve;
use super::{Finder, Glimpse, Input, Mode, Output, Params, Publish, greedy};
use crate::error::{Error, Result};
use crate::exec;
use crate::image::colour::srgb_to_linear;
use crate::image::{Image, try_collect};
use crate::job::Job;
use crate::patch::{Field, NONE, Occurrence, Search, Sweep, Vote, level_count, origin, unpack, vote};
use crate::rng::hash;

/// Maximum number of patch pairs for which the initial field is found by exhaustive comparison.
const EXHAUSTIVE: usize = 1 << 24;

pub(super) fn run(problem: &Problem, input: &Input, params: &Params, publish: Publish, job: Job) -> Result<Output> {
    let halved = usize::from(!problem.is_of(input.artwork));
    // Continuing from a previous frame or result needs only the finest level.
    let moved = match (input.previous, input.motion) {
        (Some(before), Some(motion)) => Some(moved(&checked_size(before, problem)?, motion, problem, halved, job)?),
        _ => None,
    };
    let goes_on = input.previous.is_some() && (moved.is_none() || params.coherence == 1.0);
    // Build the pyramid; the coarsest level is at least five patches wide.
    let levels = match params.mode {
        Mode::LitSphere => 1,
        _ if goes_on => 1,
        _ => level_count(problem.shortest_side(), 5 * problem.patch, params.levels),
    };
    let mut coarser: Vec<Problem> = Vec::new();
    for _ in 1..levels {
        let next = coarser.last().unwrap_or(problem).halve(job.part(0.0, 0.01))?;
        coarser.push(next);
    }

    // A level costs four times as much as the next coarser one.
    let cost = |l: usize| 0.25f64.powi(l as i32);
    let total: f64 = (0..levels).map(cost).sum();
    let mut done = 0.0;
    let mut reports = Vec::new();
    let mut field = match (&moved, input.previous) {
        _ if !goes_on => None,
        (None, Some(previous)) => Some(checked_size(previous, problem)?),
        (moved, _) => moved.as_ref().map(Field::try_clone).transpose()?,
    };
    for l in (0..levels).rev() {
        let job = job.part(0.01 + 0.98 * done / total, 0.01 + 0.98 * (done + cost(l)) / total);
        done += cost(l);
        // Release levels that are done.
        let popped = if l > 0 { coarser.pop() } else { None };
        let problem = popped.as_ref().unwrap_or(problem);
        let seed = hash(params.seed, &[l as u64]);
        let guides = if l > 0 { params.coarse_guides } else { 1.0 };
        let weights = Params { guide_weight: params.guide_weight * guides, ..params.clone() };
        let mut level = Level::new(problem, &weights, 1.0, seed, job.part(0.0, 0.01))?;
        if level.allowed.is_empty() {
            return Err(Error::degenerate(
                "no exemplar patch can be used: every patch is outside source_mask or has a pixel that is not finite"
                    .to_string(),
            ));
        }

        // Start from the coarser field, or from the guides alone.
        let (width, height) = (level.wanted.width, level.wanted.height);
        let mut current = match field.take() {
            Some(coarse) if l + 1 < levels => coarse.upsample(width, height, &level.allowed)?,
            Some(previous) => checked(previous, &level)?,
            None => by_guides_alone(problem, params, seed, job.part(0.0, 0.1))?,
        };
        // Keep the matches of the previous frame where they fit.
        let kept = match &moved {
            Some(moved) if l == 0 => {
                let mut moved = checked(moved.try_clone()?, &level)?;
                let kept = keep(&mut level, &mut moved, params, hash(seed, &[1]), job.part(0.1, 0.1))?;
                for i in (0..kept.len()).filter(|&i| kept[i]) {
                    (current.at[i], current.error[i]) = (moved.at[i], moved.error[i]);
                }
                kept
            }
            _ => Vec::new(),
        };
        let mut picture = problem.blank_picture()?;
        let how = if params.mode == Mode::LitSphere { Vote::Nearest } else { params.vote };
        paint(&mut picture, &current, problem, how, job.part(0.1, 0.12), |_| true)?;

        // Alternate matching and voting.
        let iterations = match (params.mode, l) {
            (Mode::LitSphere, _) => 0,
            (Mode::Greedy, _) => 1,
            (_, 0) => params.finest_iterations + params.polish,
            (_, 1) => params.iterations,
            _ => params.coarse_iterations,
        };
        let mut report = LevelReport {
            width: problem.guides.target.width,
            height: problem.guides.target.height,
            energy: Vec::new(),
            passes: Vec::new(),
        };
        for k in 0..iterations {
            let part = |from: f64, to: f64| {
                let n = iterations as f64;
                job.part(0.12 + 0.88 * (k as f64 + from) / n, 0.12 + 0.88 * (k as f64 + to) / n)
            };
            // Only patches over changed pixels can have changed distances; but the first polishing iteration rematches
            // all patches assigned under the budget.
            let polishes = params.mode == Mode::Budget && l == 0 && k >= params.finest_iterations;
            let anew = k == 0 || polishes && k == params.finest_iterations;
            let mut changed = if anew {
                try_collect(level.wanted.flags().iter().copied())?
            } else {
                level.changed_by(&picture, part(0.0, 0.01))?
            };
            level.set_picture(&picture, part(0.0, 0.01))?;
            match params.mode {
                Mode::Budget if polishes => {
                    changed.iter_mut().zip(&kept).for_each(|(changed, kept)| *changed &= !kept);
                    nearest(&level, &mut current, &changed, params, k, part(0.0, 0.9))?;
                }
                Mode::Budget | Mode::Uniform => {
                    report.passes.push(retrieve(
                        &level,
                        &mut current,
                        &changed,
                        &kept,
                        params,
                        k as u64,
                        part(0.0, 0.9),
                    )?);
                }
                Mode::Nearest | Mode::LitSphere | Mode::Occurrence => {
                    nearest(&level, &mut current, &changed, params, k, part(0.0, 0.9))?;
                }
                Mode::Greedy => {
                    nearest(&level, &mut current, &changed, params, k, part(0.0, 0.5))?;
                    greedy::run(&mut level, &mut current, &mut picture, l, part(0.5, 0.9))?;
                }
            }
            report.energy.push(energy(&current, &level));
            // The greedy mode paints while it matches.
            let how = if l == 0 && k + 1 == iterations { params.final_vote } else { params.vote };
            match params.mode {
                Mode::Greedy => restore_known(&mut picture, problem),
                _ => paint(&mut picture, &current, problem, how, part(0.9, 1.0), |_| true)?,
            }
        }
        reports.push(report);

        if l == 0 {
            let usage = Usage::of(&current, &level)?;
            drop(level);
            let mut image = picture.try_clone()?;
            let provenance = Provenance { field: &current, problem, artwork: input.artwork, known: input.known };
            decode_into(&mut image, &picture, provenance, job.part(1.0, 1.0), |_| true)?;
            let report = Report {
                levels: reports,
                usage,
                guide_error: guide_error(&current, problem, job)?,
                sources: sources(&current, problem, halved, job)?,
                halvings: halved,
                patch: problem.patch,
                broken_source: problem.broken.0,
                broken_target: problem.broken.1,
            };
            return Ok(Output { image, field: current, report });
        }
        publish(Glimpse { picture: decode(&picture, job)?, halvings: l + halved, levels: &reports });
        field = Some(current);
    }
    Err(Error::new(crate::error::ErrorKind::Internal, "the pyramid has no levels"))
}

/// Finds the nearest exemplar patch of each target patch that has changed; the others are up to date.
fn nearest(level: &Level, field: &mut Field, changed: &[bool], params: &Params, round: usize, job: Job) -> Result<()> {
    let changed = |i: usize| changed[i];
    let search = level.forward();
    search.rescore(field, job.part(0.0, 0.1), changed)?;
    let nearest = Nearest::new(level, params, job.part(0.1, 0.2))?;
    if params.mode != Mode::Occurrence || params.occurrence == 0.0 {
        return nearest.forward(&search, field, round as u64, job.part(0.2, 1.0), changed);
    }
    // Usage penalties depend on all matches: any match may change.
    let patch = level.problem.patch;
    let weight = f64::from(params.occurrence) * level.unit() / (patch * patch) as f64;
    let occurrence = Occurrence::new(field, &level.allowed, patch, weight)?;
    let search = Search { occurrence: Some(&occurrence), ..search };
    nearest.forward(&search, field, round as u64, job.part(0.2, 1.0), |i| level.wanted.contains_index(i))
}

/// An initial field by the guides only. Ties prefer the same relative position, so that equal guides yield the
/// identity.
fn by_guides_alone(problem: &Problem, params: &Params, seed: u64, job: Job) -> Result<Field> {
    let level = Level::new(problem, params, 0.0, seed, job.part(0.0, 0.01))?;
    let search = level.forward();
    let wanted = |i: usize| level.wanted.contains_index(i);
    let mut field = Field::proportional(level.wanted.width, level.wanted.height, &level.allowed)?;
    search.rescore(&mut field, job.part(0.0, 0.05), wanted)?;
    if level.wanted.len().saturating_mul(level.allowed.len()) <= EXHAUSTIVE {
        search.exhaustive(&mut field, job.part(0.05, 1.0), wanted)?;
    } else if params.finder == Finder::Table {
        let nearest = Nearest::new(&level, params, job.part(0.05, 0.4))?;
        nearest.forward(&search, &mut field, 0, job.part(0.4, 1.0), wanted)?;
    } else {
        let radius = level.allowed.width.max(level.allowed.height);
        for k in 0..8 {
            let sweep = Sweep { index: k, radius, initial_samples: 16 };
            search.sweep(&mut field, sweep, job.part(0.05 + 0.11 * k as f64, 0.05 + 0.11 * (k + 1) as f64), wanted)?;
        }
    }
    Ok(field)
}

/// Checks that an external field has the size of the target, and copies it.
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

/// Checks that the matches of an external field lie inside the exemplar.
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

/// Votes for the pixels for which `wanted` holds, and restores known pixels.
pub(super) fn paint(
    picture: &mut Image,
    field: &Field,
    problem: &Problem,
    how: Vote,
    job: Job,
    wanted: impl Fn(usize) -> bool + Sync,
) -> Result<()> {
    vote(picture, field, &problem.style, problem.patch, how, job, wanted)?;
    restore_known(picture, problem);
    Ok(())
}

fn restore_known(picture: &mut Image, problem: &Problem) {
    if let (Some(mask), Some(known)) = (&problem.target_mask, &problem.known) {
        let channels = picture.channels;
        let pixels = picture.data.chunks_exact_mut(channels).zip(known.data.chunks_exact(channels));
        pixels.zip(mask).filter(|(_, made)| !**made).for_each(|((p, k), _)| p.copy_from_slice(k));
    }
}

fn decode(picture: &Image, job: Job) -> Result<Image> {
    let mut out = picture.try_clone()?;
    let row_len = out.row_len();
    exec::for_rows(&mut out.data, row_len, job.part(1.0, 1.0), |_, row| {
        row.iter_mut().for_each(|v| *v = srgb_to_linear(*v));
    })?;
    Ok(out)
}

/// The inputs that produced an encoded picture.
pub(super) struct Provenance<'a> {
    pub field: &'a Field,
    pub problem: &'a Problem,
    /// The artwork and the known part of the target, linear.
    pub artwork: &'a Image,
    pub known: Option<&'a Image>,
}

/// Decodes the pixels of a picture for which `wanted` holds into `image`, in linear colour. Pixels on which all
/// patches agree, and known pixels, are copied from the linear originals, so that they equal them to the bit.
pub(super) fn decode_into(
    image: &mut Image,
    picture: &Image,
    provenance: Provenance,
    job: Job,
    wanted: impl Fn(usize) -> bool + Sync,
) -> Result<()> {
    let Provenance { field, problem, artwork, known } = provenance;
    let (width, channels, whole) = (image.width, image.channels, problem.is_of(artwork));
    let left_out = |i: usize| whole && problem.target_mask.as_ref().is_some_and(|mask| !mask[i]);
    exec::for_rows(&mut image.data, width * channels, job, |y, row| {
        for (x, pixel) in row.chunks_exact_mut(channels).enumerate().filter(|(x, _)| wanted(y * width + x)) {
            match (left_out(y * width + x), known) {
                (true, Some(known)) => pixel.copy_from_slice(known.pixel(x, y)),
                (true, None) => pixel.fill(0.0),
                _ => match whole.then(|| origin(field, problem.patch, x, y)).flatten() {
                    Some((px, py)) => pixel.copy_from_slice(artwork.pixel(px, py)),
                    None => pixel.iter_mut().zip(picture.pixel(x, y)).for_each(|(p, v)| *p = srgb_to_linear(*v)),
                },
            }
        }
    })
}
