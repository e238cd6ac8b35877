//! Scores how well a shift of the exemplar fills a block of the texture. Three criteria count: how many empty pixels it
//! fills, how well it agrees with the known pixels, and how well it balances the amount of light.

use super::balance::Balance;
use super::block::{Block, Rect, Run, count};
use super::guide::{Feature, Guide, squares};
use super::patch_map::Shift;
use crate::emission::exemplar::area_sums::AreaSums;
use crate::error::Result;
use crate::exec;
use crate::job::Job;
use crate::maths;
use glam::Vec4;

/// A patch counts as equally good as the best one if its error is at most a e + b, where e is the lowest error. The
/// first value is a: Efros and Freeman (2001) also allow 10 %. The second value is the smallest b, which only allows
/// for rounding. On a lattice, b is `Comparison::slack` if that is larger. [paper: Efros and Freeman 2001]
const TOLERANCE: (f32, f32) = (1.1, 1e-6);

/// The lit share of a pixel, in `[0, 1]`, is multiplied by this and rounded, so that light can be summed in integers.
/// [rounding]
const LIGHT_STEPS: f32 = 255.0;

/// Let n be the largest number of empty pixels of a block that any candidate patch fills. Patches that fill fewer than
/// this share of n are discarded; the others are compared by their error. [bench constants:lamps]
const ENOUGH_COVERAGE: f64 = 0.95;

/// If a block has more than `FINALISTS` candidate patches, they are first compared in every `ROW_STEP`-th row of the
/// block only. Only the `FINALISTS` best ones are then compared in all rows. Blocks of fewer than 4 `ROW_STEP` rows
/// skip the first comparison.
const FINALISTS: usize = 16;

const ROW_STEP: usize = 4;

/// A parallel task compares about this number of pixels, so that its work takes much longer than starting the task.
const TASK: usize = 1 << 16;

/// A shift with its score for a block.
///
/// - `fills`: number of empty pixels of the block that the shift fills.
/// - `excess`: number of lit pixels that the shift adds to these empty pixels, minus the target number.
/// - `error`: d + p / n. Here n is the number of known pixels of the block, d is the mean squared difference from these
///   pixels, and p is the penalty for the excess ([`Balance::penalty`]).
#[derive(Clone, Copy)]
pub struct Scored {
    pub shift: Shift,
    pub fills: usize,
    pub excess: f64,
    pub error: f32,
}

/// The data by which shifts are compared.
pub struct Comparison<'a> {
    pub guide: &'a Guide<'a>,
    pub features: Vec<Feature>,
    pub channel_periods: Vec4,
    /// `usable`: summed-area table of the exemplar's usable pixels. `light`: summed-area table of the lit share of its
    /// pixels, in units of 1 / [`LIGHT_STEPS`].
    pub usable: AreaSums,
    light: AreaSums,
    /// Lit share of the part of the exemplar that the photo shows.
    lit_share: f64,
    is_lattice: bool,
    /// The value b of [`TOLERANCE`]: the constant part of the largest error that counts as equally good.
    slack: f32,
}

impl<'a> Comparison<'a> {
    pub fn new(guide: &'a Guide<'a>, usable: AreaSums, is_lattice: bool) -> Result<Self> {
        let working = guide.working;
        let shown = working.shown_coverage.iter().zip(&working.shown).filter(|(_, shown)| **shown);
        let (lit, all) = shown.fold((0.0, 0usize), |(lit, all), (&light, _)| (lit + f64::from(light), all + 1));
        // Lattice shifts are rounded to whole pixels, with an error that is uniform in ±1/2 and has the variance 1/12.
        // Between two patches that match perfectly, the x and y distances in the metadata then differ by a mean square
        // of 2/12 = 1/6 pixel² each. Tolerate this difference: 2 · (1/6) · weight / cap² = weight / (3 cap²).
        let slack = match is_lattice {
            true => (f64::from(guide.guide_weight) / (3.0 * maths::powi(guide.cap, 2))) as f32,
            false => 0.0,
        };
        Ok(Self {
            guide,
            features: guide.features(),
            channel_periods: guide.channel_periods(),
            usable,
            light: AreaSums::of(|i| (working.coverage[i] * LIGHT_STEPS).round() as u32, working.width, working.height)?,
            lit_share: lit / all.max(1) as f64,
            is_lattice,
            slack: slack.max(TOLERANCE.1),
        })
    }

    /// The part of a run of the texture for which a shift gives pixels inside the exemplar. Returns the number of
    /// pixels of the run before this part, the length of the part, and the exemplar's pixel `[x, y]` that its first
    /// pixel shows. `None` if no pixel of the run has a source.
    pub fn shown(&self, run: &Run, shift: &Shift) -> Option<(usize, usize, [usize; 2])> {
        let working = self.guide.working;
        let (x, y) = (run.x as i64 - i64::from(shift.working[0]), run.y as i64 - i64::from(shift.working[1]));
        let skipped = (-x).max(0);
        let length = (run.length as i64).min(working.width as i64 - x) - skipped;
        let inside = length > 0 && y >= 0 && y < working.height as i64;
        inside.then(|| (skipped as usize, length as usize, [(x + skipped) as usize, y as usize]))
    }

    /// Returns two values for each shift: the number of empty pixels of a block that the shift fills, and whether it
    /// would show usable pixels in the whole block. The number is not computed, and is 0, if it is certainly below
    /// [`ENOUGH_COVERAGE`] times the number of another shift.
    pub fn fills(&self, block: &Block, shifts: &[Shift]) -> Vec<(usize, bool)> {
        let Rect { x, y, w, h } = block.rect;
        let empty = count(&block.empty);
        let usable_of = |runs: &[Run], shift: &Shift| -> usize {
            runs.iter()
                .filter_map(|run| self.shown(run, shift))
                .map(|(_, length, [x, y])| self.usable.count(x, y, length, 1))
                .sum()
        };
        // The number of usable pixels that a shift shows in the whole block, filled pixels included, is an upper bound
        // for the number of empty pixels that it fills.
        let max_fill = |shift: &Shift| {
            let working = self.guide.working;
            let side = |at: usize, by: i32, length: usize, side: usize| {
                let start = at as i64 - i64::from(by);
                let (low, high) = (start.max(0), (start + length as i64).min(side as i64));
                (low as usize, (high - low).max(0) as usize)
            };
            let (u, columns) = side(x, shift.working[0], w, working.width);
            let (v, rows) = side(y, shift.working[1], h, working.height);
            if columns * rows == 0 { 0 } else { self.usable.count(u, v, columns, rows) }
        };
        let bounds: Vec<usize> = shifts.iter().map(max_fill).collect();
        let mut max_fills = if bounds.contains(&(w * h)) { empty } else { 0 };
        let exact = |(shift, bound): (&Shift, usize)| {
            if bound == w * h {
                return (empty, true);
            }
            if (bound as f64) < ENOUGH_COVERAGE * max_fills as f64 {
                return (0, false);
            }
            let fills = usable_of(&block.empty, shift);
            max_fills = max_fills.max(fills);
            (fills, false)
        };
        shifts.iter().zip(bounds).map(exact).collect()
    }

    /// Scores how well shifts agree with the known pixels of a block.
    ///
    /// - Leaves out shifts that fill fewer than `min_fill` empty pixels. If `min_fill` is `None`, the minimum is
    ///   [`ENOUGH_COVERAGE`] times the largest number that any shift fills.
    /// - Stops comparing a shift, and gives it an infinite error, as soon as its error must exceed
    ///   [`Self::equally_good`] of the lowest known error. The lowest known error begins with `limit`.
    pub fn score(
        &self,
        block: &Block,
        shifts: &[Shift],
        min_fill: Option<usize>,
        limit: f32,
        balance: &Balance,
        job: Job,
    ) -> Result<Vec<Scored>> {
        let fills = self.fills(block, shifts);
        let max_fills = fills.iter().map(|f| f.0).max().unwrap_or(0);
        let min_fill = min_fill.unwrap_or((ENOUGH_COVERAGE * max_fills as f64).ceil() as usize).max(1);
        let mut covering: Vec<usize> = (0..shifts.len()).filter(|&n| fills[n].0 >= min_fill).collect();
        let filled = count(&block.filled);
        let mut excess = vec![0.0; shifts.len()];
        let of_covering = self.excess(block, covering.iter().map(|&n| shifts[n]));
        covering.iter().zip(of_covering).for_each(|(&n, e)| excess[n] = e);
        let penalty = |n: usize| (balance.penalty(excess[n]) / filled.max(1) as f64) as f32;
        if covering.len() > FINALISTS && block.rect.h >= 4 * ROW_STEP {
            let is_sampled = |run: &&Run| (run.y - block.rect.y) % ROW_STEP == ROW_STEP / 2;
            let rows: Vec<Run> = block.filled.iter().filter(is_sampled).copied().collect();
            let compared = count(&rows);
            let error =
                |&n: &usize| (penalty(n) + self.error(&rows, (&shifts[n], fills[n].1), compared, f32::INFINITY), n);
            let mut ranked: Vec<(f32, usize)> = covering.iter().map(error).collect();
            ranked.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            // If the compared rows have no known pixels, there is no difference by which to rank shifts, so keep all of
            // them.
            ranked.truncate(if compared > 0 { FINALISTS } else { usize::MAX });
            covering = ranked.into_iter().map(|r| r.1).collect();
        }
        let some = (TASK / filled.max(1)).max(1);
        let scored = exec::map(covering.len().div_ceil(some), job, |task| {
            let mut limit = limit;
            let shifts = covering[task * some..].iter().take(some).map(|&n| {
                let left = self.equally_good(limit) - penalty(n);
                let error = match left >= 0.0 {
                    true => penalty(n) + self.error(&block.filled, (&shifts[n], fills[n].1), filled, left),
                    false => f32::INFINITY,
                };
                limit = limit.min(error);
                Scored { shift: shifts[n], fills: fills[n].0, excess: excess[n], error }
            });
            shifts.collect::<Vec<_>>()
        })?;
        Ok(scored.into_iter().flatten().collect())
    }

    /// Mean squared difference between the known pixels of a block and the usable pixels that a shift shows there; 0 if
    /// it shows none there. May return infinity if the mean exceeds `limit`. `known` are the runs of known pixels, and
    /// `filled` is their number of pixels. `is_whole` states that the shift shows usable pixels in the whole block.
    pub fn error(&self, known: &[Run], (shift, is_whole): (&Shift, bool), filled: usize, limit: f32) -> f32 {
        let working = self.guide.working;
        let max_sum = f64::from(limit) * filled as f64;
        let (mut sum, mut compared) = (0f64, 0usize);
        for run in known {
            let Some((skipped, length, [x, y])) = self.shown(run, shift) else { continue };
            let (old, new) = (run.source + skipped, y * working.width + x);
            let mut add = |from: usize, to: usize| {
                let (a, b) = (&self.features[old + from..old + to], &self.features[new + from..new + to]);
                sum += f64::from(squares(a, b, self.channel_periods));
                compared += to - from;
            };
            if is_whole || self.usable.count(x, y, length, 1) == length {
                add(0, length);
            } else {
                let mut at = 0;
                for part in working.usable[new..new + length].chunk_by(|a, b| a == b) {
                    if part[0] {
                        add(at, at + part.len());
                    }
                    at += part.len();
                }
            }
            // Stop if the sum so far, divided by `filled`, exceeds `limit`. The final mean would exceed it too: the sum
            // can only grow, and it is divided by at most `filled` pixels.
            if sum > max_sum {
                return f32::INFINITY;
            }
        }
        if compared > 0 { (sum / compared as f64) as f32 } else { 0.0 }
    }

    /// For each shift, the number of lit pixels that it adds to the empty pixels of a block, minus the target number.
    /// The target is the number of pixels that the shift fills, times a lit share:
    ///
    /// - On a lattice, every shift puts lamps at the same positions of the block, although some lamps may be missing.
    ///   The lit share is the mean lit share of the pixels that the given shifts fill.
    /// - Without a lattice, it is the lit share of the exemplar.
    pub fn excess(&self, block: &Block, shifts: impl Iterator<Item = Shift>) -> Vec<f64> {
        let light_of = |shift: Shift| {
            let parts = block.empty.iter().filter_map(|run| self.shown(run, &shift));
            parts.fold([0, 0], |[light, all], (_, length, [x, y])| {
                [light + self.light.count(x, y, length, 1), all + self.usable.count(x, y, length, 1)]
            })
        };
        let lights: Vec<[f64; 2]> =
            shifts.map(light_of).map(|[light, all]| [light as f64 / f64::from(LIGHT_STEPS), all as f64]).collect();
        let sum = |k: usize| lights.iter().map(|l| l[k]).sum::<f64>();
        let share = match self.is_lattice {
            true => sum(0) / sum(1).max(1.0),
            false => self.lit_share,
        };
        lights.into_iter().map(|[light, all]| light - share * all).collect()
    }

    /// The largest error that counts as equally good as `error`.
    pub fn equally_good(&self, error: f32) -> f32 {
        error * TOLERANCE.0 + self.slack
    }
}
