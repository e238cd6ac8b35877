//! Reversed retrieval under an error budget (StyLit, §3.3).
//!
//! Each pass has three steps:
//!
//! 1. Every exemplar patch searches for its nearest target patch among the free target patches.
//! 2. The errors of these matches determine a budget.
//! 3. In order of rising error, the exemplar patches take their targets until the budget is spent. If two exemplar
//!    patches want one target, the patch with the smaller error takes it (the first, if equal).
//!
//! In the next pass, all exemplar patches are available again for the remaining targets. The passes end when enough of
//! the target is covered or when a pass gains next to nothing. Then each remaining target patch searches for its
//! nearest exemplar patch instead.
//!
//! The resulting field is varied but fragmented: neighbouring positions are painted from patches that were not
//! neighbours in the artwork. Therefore a target patch may finally continue the match of a neighbouring target patch
//! (`Params::settle`, `Params::seam`; not in the paper). It does so if the continued match is closer than the patch's
//! own match, or if avoiding the seam outweighs the greater distance. This step searches for no new matches, so the
//! result uses as much of the exemplar as before, but in larger pieces (docs/notes/stylize.md has its effect on the
//! energy).
//!
//! Each pass starts from the matches of the previous pass. An exemplar patch whose target has been taken searches anew
//! around that target; all other exemplar patches keep their matches.

use super::budget::budget;
use super::finder::Nearest;
use super::level::Level;
use super::params::Params;
use crate::error::Result;
use crate::exec;
use crate::image::try_collect;
use crate::job::Job;
use crate::patch::{Domain, Field, NONE, pack, unpack};

/// The outcome of a retrieval pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassReport {
    /// Share of the exemplar patches whose error lies left of the knee of the sorted errors.
    pub knee: f64,
    /// Number of target patches matched in this pass.
    pub gained: usize,
    /// Share of the wanted target patches that are matched after this pass.
    pub coverage: f64,
}

/// The passes end after the first pass that matches less than this share of the wanted target patches.
/// [bench constants:paint]
const MIN_GAIN: f64 = 0.005;

/// Matches every wanted target patch. `field` holds the matches of the previous iteration, which start the search, and
/// receives the result. The distances in `field` are valid except where `changed` is set. Matches with `kept` set stay
/// unchanged.
pub(super) fn retrieve(
    level: &Level,
    field: &mut Field,
    changed: &[bool],
    kept: &[bool],
    params: &Params,
    round: u64,
    job: Job,
) -> Result<Vec<PassReport>> {
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
    let enough = f64::from(params.coverage);

    while passes.len() < params.passes && ((wanted - free.len()) as f64) < enough * wanted as f64 {
        let done = passes.len() as f64 / params.passes as f64;
        let job = job.part(0.05 + 0.75 * done, 0.05 + 0.75 * (done + 1.0 / params.passes as f64));
        let lost = try_collect(reverse.error.iter().map(|&e| e == u32::MAX))?;
        let index = 2000 * round + passes.len() as u64;
        nearest.reverse(&mut reverse, &free, index, job, |i| lost[i] && level.allowed.contains_index(i))?;
        let (knee, gained) = accept(&mut matched, &mut free, &mut reverse, job)?;
        let coverage = (wanted - free.len()) as f64 / wanted as f64;
        passes.push(PassReport { knee, gained, coverage });
        if (gained as f64) < MIN_GAIN * wanted as f64 {
            break;
        }
    }

    // Match each remaining target patch to its nearest exemplar patch. Start from the matches of the previous
    // iteration and of neighbouring patches.
    for i in (0..field.at.len()).filter(|&i| free.contains_index(i)) {
        (matched.at[i], matched.error[i]) = (field.at[i], field.error[i]);
    }
    nearest.forward(&search, &mut matched, 2000 * round + 1500, job.part(0.8, 0.9), |i| free.contains_index(i))?;
    // Settle: let target patches continue their neighbours' matches where this lowers the error, including the cost of
    // seams.
    let seam = (f64::from(params.seam) * matched.energy() / wanted.max(1) as f64).min(1e9) as u32;
    for _ in 0..params.settle {
        search.join(&mut matched, seam, job.part(0.9, 1.0), |i| level.wanted.contains_index(i) && !is_kept(i))?;
    }
    *field = matched;
    Ok(passes)
}

/// Assigns target patches to exemplar patches in order of rising error. Stops before the sum of the errors exceeds the
/// budget. Returns the share of the exemplar patches whose error lies left of the knee of the sorted errors, and the
/// number of target patches assigned.
fn accept(matched: &mut Field, free: &mut Domain, reverse: &mut Field, job: Job) -> Result<(f64, usize)> {
    // Sort by error, then by position.
    let found = reverse.error.iter().enumerate().filter(|(_, e)| **e != u32::MAX);
    let mut order = try_collect(found.map(|(i, &e)| u64::from(e) << 32 | i as u64))?;
    exec::sort(&mut order, job)?;
    let errors = try_collect(order.iter().map(|o| (o >> 32) as u32))?;
    let budget = budget(&errors);

    // Spend the budget: each assigned target costs its error. Skip targets that are already taken.
    let (mut spent, mut gained) = (0.0, 0);
    for (&o, &error) in order.iter().zip(&errors) {
        let source = (o & 0xffff_ffff) as usize;
        let (x, y) = unpack(reverse.at[source]);
        let target = y * matched.width + x;
        if !free.contains_index(target) {
            continue;
        }
        spent += f64::from(error);
        if spent > budget.total {
            break;
        }
        matched.at[target] = pack(source % reverse.width, source / reverse.width);
        matched.error[target] = error;
        free.remove(target);
        gained += 1;
    }
    free.compact();

    // A match whose target is now taken becomes a hint for the next search: keep its position, but discard its
    // distance.
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
