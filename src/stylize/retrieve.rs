//! Reversed retrieval under an error budget (§3.3).
//!
//! In each pass every exemplar patch looks for its nearest target patch among those still free. The errors give a budget;
//! in order of rising error the patches take their targets until it is spent. Where two want the same target the closer
//! one has it, among equals the first. Then all exemplar patches may be used again for what is left. When enough is covered,
//! or a pass brings next to nothing, the remaining target patches look for their nearest exemplar patch instead.
//!
//! A field made this way is rich but frayed: neighbouring places are painted from patches that were never neighbours. So
//! in the end a target patch may continue a neighbour's match where that is closer than its own, or so nearly as close that
//! it is worth a seam less (`Params::settle`, `Params::seam`; not in the paper). Nothing is searched for anew, so what is used stays as varied as the budget made it, in larger pieces;
//! on the pair in `tests/real_stylize.rs` it brings Eq. 3 down threefold and keeps more of the texture.
//!
//! A pass starts from the last one: an exemplar patch whose target was taken looks around it; the others stay.

use super::budget::budget;
use super::finder::Nearest;
use super::level::Level;
use super::{Mode, Params};
use crate::error::Result;
use crate::exec;
use crate::image::try_collect;
use crate::job::Job;
use crate::patch::{Domain, Field, NONE, pack, unpack};

/// What a retrieval pass did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// Share of the exemplar patches left of the knee.
    pub knee: f64,
    /// Target patches that were given a match in this pass.
    pub gained: usize,
    /// Share of the wanted target patches with a match after it.
    pub coverage: f64,
}

/// A pass that covers less than this share of the target is the last.
const LEAST_GAIN: f64 = 0.005;

/// Matches every wanted target patch; `field` holds matches or hints of the last iteration, with distances that hold but
/// where `changed`, and what it returns has the distances of this one. Where `kept` is set the match of `field` stays as it is.
pub(super) fn retrieve(
    level: &Level,
    field: &mut Field,
    changed: &[bool],
    kept: &[bool],
    params: &Params,
    round: u64,
    job: Job,
) -> Result<Vec<Pass>> {
    let wanted = level.wanted.len();
    let nearest = Nearest::new(level, params, job.part(0.0, 0.02))?;
    let search = level.forward();
    search.rescore(field, job.part(0.02, 0.05), |i| changed[i])?;
    let mut free = level.wanted.try_clone()?;
    let mut reverse = field.invert(&level.allowed)?;
    let mut matched = Field::new(field.width, field.height)?;
    for i in (0..kept.len()).filter(|&i| kept[i]) {
        (matched.at[i], matched.error[i]) = (field.at[i], field.error[i]);
        free.remove(i);
    }
    free.compact();
    let is_kept = |i: usize| kept.get(i) == Some(&true);
    let mut passes = Vec::new();
    let enough = if params.mode == Mode::Uniform { 1.0 } else { f64::from(params.coverage) };

    while passes.len() < params.passes && ((wanted - free.len()) as f64) < enough * wanted as f64 {
        let done = passes.len() as f64 / params.passes as f64;
        let job = job.part(0.05 + 0.75 * done, 0.05 + 0.75 * (done + 1.0 / params.passes as f64));
        let lost = try_collect(reverse.error.iter().map(|&e| e == u32::MAX))?;
        let index = 2000 * round + passes.len() as u64;
        nearest.reverse(&mut reverse, &free, index, job, |i| lost[i] && level.allowed.contains_index(i))?;
        let (knee, gained) = accept(&mut matched, &mut free, &mut reverse, params.mode, job)?;
        let coverage = (wanted - free.len()) as f64 / wanted as f64;
        passes.push(Pass { knee, gained, coverage });
        if (gained as f64) < LEAST_GAIN * wanted as f64 {
            break;
        }
    }

    // Ordinary retrieval for what is left, from the last iteration's matches and those of the neighbours.
    for i in (0..field.at.len()).filter(|&i| free.contains_index(i)) {
        (matched.at[i], matched.error[i]) = (field.at[i], field.error[i]);
    }
    nearest.forward(&search, &mut matched, 2000 * round + 1500, job.part(0.8, 0.9), |i| free.contains_index(i))?;
    // Let patches continue their neighbours' matches where those fit better, seams counted.
    let seam = (f64::from(params.seam) * matched.energy() / wanted.max(1) as f64).min(1e9) as u32;
    for _ in 0..params.settle {
        search.join(&mut matched, seam, job.part(0.9, 1.0), |i| level.wanted.contains_index(i) && !is_kept(i))?;
    }
    *field = matched;
    Ok(passes)
}

/// Gives target patches to exemplar patches in order of rising error until the budget is spent; returns the knee and the
/// number given.
fn accept(matched: &mut Field, free: &mut Domain, reverse: &mut Field, mode: Mode, job: Job) -> Result<(f64, usize)> {
    // Sort by error, then by position.
    let found = reverse.error.iter().enumerate().filter(|(_, e)| **e != u32::MAX);
    let mut order = try_collect(found.map(|(i, &e)| u64::from(e) << 32 | i as u64))?;
    exec::sort(&mut order, job)?;
    let errors = try_collect(order.iter().map(|o| (o >> 32) as u32))?;
    let budget = budget(&errors);
    let total = if mode == Mode::Uniform { f64::INFINITY } else { budget.total };

    // Spend the budget; a target that is taken costs nothing.
    let (mut spent, mut gained) = (0.0, 0);
    for (&o, &error) in order.iter().zip(&errors) {
        let source = (o & 0xffff_ffff) as usize;
        let (x, y) = unpack(reverse.at[source]);
        let target = y * matched.width + x;
        if !free.contains_index(target) {
            continue;
        }
        spent += f64::from(error);
        if spent > total {
            break;
        }
        matched.at[target] = pack(source % reverse.width, source / reverse.width);
        matched.error[target] = error;
        free.remove(target);
        gained += 1;
    }
    free.compact();

    // What pointed at a target now taken is but a hint.
    for (at, error) in reverse.at.iter().zip(&mut reverse.error) {
        if *at != NONE {
            let (x, y) = unpack(*at);
            if !free.contains(x, y) {
                *error = u32::MAX;
            }
        }
    }
    Ok((budget.knee, gained))
}
