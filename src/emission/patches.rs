//! Iterative patch placement: image quilting (Efros and Freeman 2001) over colour and metadata ("Lighting Style Transfer", §6).
//!
//! Blocks are filled in scanline order. A patch is a shift of the exemplar; of the shifts that cover a block best, one is
//! drawn among those that agree best with what is already there. What a patch cannot show, because the photo did not, is
//! filled by further patches of the same block. On a lattice only shifts by lattice vectors are tried: whatever is chosen,
//! the lamps stay in phase, and errors do not add up from patch to patch because every shift is measured from the origin.

use super::balance::Balance;
use super::exemplar::AreaSums;
use super::guide::{Feature, Guide, squares};
use super::layout::{Layout, NONE, Shift};
use super::period::Continuation;
use super::seam;
use crate::error::Result;
use crate::exec;
use crate::image::try_vec;
use crate::job::Job;
use crate::rng::{self, Rng};
use glam::{DMat2, DVec2, Vec4};
use std::collections::BTreeMap;

/// Most candidates per patch where a lattice allows more.
const LATTICE_CANDIDATES: usize = 128;
/// Patches within this factor of the best (0.1 in the original), or this close to it, are equally good.
const TOLERANCE: (f32, f32) = (1.1, 1e-6);
/// Parts of a pixel in which its light is counted.
const LIGHT_STEPS: f32 = 255.0;
/// Patches that cover at least this share of what the best would cover compete by their error.
const ENOUGH_COVERAGE: f64 = 0.95;
/// Added to the cost of a seam on a lamp: more than any path around it.
const LAMP_COST: f32 = 1e4;
/// Of more patches than this, only those that agree best in one of so many rows are compared in all.
const FINALISTS: usize = 16;
const ROW_STEP: usize = 4;
/// Pixels compared by one thread before another is worth waking.
const TASK: usize = 1 << 16;

#[derive(Clone, Copy)]
struct Rect {
    x: usize,
    y: usize,
    w: usize,
    h: usize,
}

/// Pixels of a row of a block, and where in the exemplar the first of them is taken from, one after the other.
#[derive(Clone, Copy)]
struct Run {
    x: usize,
    y: usize,
    length: usize,
    source: usize,
}

/// A block: its pixels that show nothing yet, and those that show pixels of the exemplar.
struct Block {
    rect: Rect,
    /// The pixel of the exemplar that each shows, row by row; or [`NONE`].
    known: Vec<u32>,
    empty: Vec<Run>,
    filled: Vec<Run>,
}

fn count(runs: &[Run]) -> usize {
    runs.iter().map(|r| r.length).sum()
}

/// A shift, how many empty pixels of a block it fills, by how many pixels of light more than their share, and its mean squared
/// difference from the known ones, with what that light counts for.
#[derive(Clone, Copy)]
struct Scored {
    shift: Shift,
    fills: usize,
    excess: f64,
    error: f32,
}

struct Quilt<'a> {
    guide: &'a Guide<'a>,
    features: Vec<Feature>,
    turns: Vec4,
    /// The rows that no block reaches any more, and all shifts.
    layout: Layout,
    /// The labels of the rows from `first` on that blocks still reach.
    first: usize,
    open: Vec<u32>,
    /// The label of each shift.
    labels: BTreeMap<([i32; 2], [u64; 2]), u32>,
    continuation: Continuation,
    /// Where the lattice begins, in unwarped pixels.
    offset: DVec2,
    /// The box of the usable pixels, and the corners at which a whole block of them can be taken.
    bounds: [usize; 4],
    admissible: Vec<u32>,
    usable: AreaSums,
    light: AreaSums,
    /// Share of what the exemplar shows that is light.
    lit_share: f64,
    balance: Balance,
    /// Difference in error that says nothing.
    slack: f32,
    seed: u64,
}

/// Fills `width` × `height` working pixels with patches of side `block`; a lattice is shifted by `offset` unwarped pixels.
pub fn place(
    guide: &Guide,
    continuation: Continuation,
    offset: DVec2,
    (width, height): (usize, usize),
    block: usize,
    seed: u64,
    job: Job,
) -> Result<Layout> {
    let working = guide.working;
    let bounds = working.usable_box();
    let (mut w, mut h) = (block.min(bounds[2] - bounds[0]).min(width), block.min(bounds[3] - bounds[1]).min(height));

    // Where patches are free, a whole block must be found somewhere: shrink it until there is one.
    let usable = AreaSums::new(|i| working.usable[i], working.width, working.height)?;
    let mut admissible = Vec::new();
    if continuation.lattice().is_none() {
        loop {
            for y in bounds[1]..=bounds[3] - h {
                let fits = |x: &usize| usable.count(*x, y, w, h) == w * h;
                admissible.extend((bounds[0]..=bounds[2] - w).filter(fits).map(|x| (y * working.width + x) as u32));
            }
            if !admissible.is_empty() {
                break;
            }
            (w, h) = ((w * 3 / 4).max(1), (h * 3 / 4).max(1));
        }
    }

    let overlap = [w / 3, h / 3];
    let shown = working.shown_coverage.iter().zip(&working.shown).filter(|(_, shown)| **shown);
    let (lit, all) = shown.fold((0.0, 0usize), |(lit, all), (&light, _)| (lit + f64::from(light), all + 1));
    // Lattice shifts are rounded to whole pixels, which alone makes both distances differ by the root of a sixth of one.
    let slack = match continuation.lattice() {
        Some(_) => (f64::from(guide.metadata_weight) / (3.0 * guide.cap.powi(2))) as f32,
        None => 0.0,
    };
    let mut quilt = Quilt {
        guide,
        features: guide.features(),
        turns: guide.turns(),
        layout: Layout::new(width, height),
        first: 0,
        // A row of blocks, and the row of pixels above it.
        open: try_vec(width * (h + 1), NONE)?,
        labels: BTreeMap::new(),
        continuation,
        offset,
        bounds,
        admissible,
        usable,
        light: AreaSums::of(|i| (working.coverage[i] * LIGHT_STEPS).round() as u32, working.width, working.height)?,
        lit_share: lit / all.max(1) as f64,
        balance: Balance::new(width.div_ceil(w - overlap[0]), guide.lamp, continuation.lattice().is_some())?,
        slack: slack.max(TOLERANCE.1),
        seed,
    };
    for y in (0..height).step_by(h - overlap[1]) {
        quilt.close(y.saturating_sub(1));
        quilt.balance.begin_row();
        for x in (0..width).step_by(w - overlap[0]) {
            job.check()?;
            let rect = Rect { x, y, w: w.min(width - x), h: h.min(height - y) };
            quilt.fill(&rect, overlap, job.part(0.0, 0.0))?;
            quilt.balance.pass_on();
        }
        job.report((y + 1) as f64 / height as f64);
    }
    quilt.close(height);
    Ok(quilt.layout)
}

impl Quilt<'_> {
    fn label(&self, x: usize, y: usize) -> u32 {
        self.open[(y - self.first) * self.layout.width + x]
    }

    /// Gives the rows above `y` to the layout.
    fn close(&mut self, y: usize) {
        let width = self.layout.width;
        let done = (y - self.first) * width;
        self.open[..done].chunks_exact(width).for_each(|row| self.layout.push(row));
        self.open.copy_within(done.., 0);
        let rest = self.open.len() - done;
        self.open[rest..].fill(NONE);
        self.first = y;
    }

    /// Places patches until nothing of the block is empty that any of them could show.
    fn fill(&mut self, rect: &Rect, overlap: [usize; 2], job: Job) -> Result<()> {
        let mut first = true;
        loop {
            let block = self.block(rect);
            if block.empty.is_empty() {
                return Ok(());
            }
            let scored = self.score(&block, &self.candidates(rect), None, f32::INFINITY, job)?;
            let Some(mut chosen) = self.choose(&block, &scored) else { return Ok(()) };
            if !self.admissible.is_empty() {
                chosen = self.improve(&block, chosen, job)?;
            }
            self.balance.add(chosen.excess);
            self.paste(&block, chosen.shift, first.then_some(overlap));
            first = false;
        }
    }

    /// What the pixels of a block show already.
    fn block(&self, rect: &Rect) -> Block {
        let mut block =
            Block { rect: *rect, known: Vec::with_capacity(rect.w * rect.h), empty: Vec::new(), filled: Vec::new() };
        for y in rect.y..rect.y + rect.h {
            let start = (y - self.first) * self.layout.width + rect.x;
            let mut x = rect.x;
            for labels in self.open[start..start + rect.w].chunk_by(|a, b| a == b) {
                // One shift shows pixels side by side.
                let source = self.layout.source(x, y, labels[0], self.guide.working);
                let run = Run { x, y, length: labels.len(), source: source.unwrap_or(NONE as usize) };
                match source {
                    Some(source) => block.known.extend((source..).take(run.length).map(|s| s as u32)),
                    None => block.known.extend(std::iter::repeat_n(NONE, run.length)),
                }
                block.add(run);
                x += run.length;
            }
        }
        block
    }

    /// The shifts of what lies around a block.
    fn neighbours(&self, rect: &Rect) -> Vec<Shift> {
        let mut shifts: Vec<Shift> = Vec::new();
        let mut neighbour = |x: usize, y: usize| {
            if let Some(&shift) = self.layout.shifts.get(self.label(x, y) as usize)
                && !shifts.contains(&shift)
            {
                shifts.push(shift);
            }
        };
        let right = rect.x + rect.w - 1;
        for (x, y) in [(rect.x, rect.y), (right, rect.y), (rect.x, rect.y + rect.h - 1)] {
            neighbour(x, y);
            neighbour(x.saturating_sub(1), y.saturating_sub(1));
        }
        shifts
    }

    /// The shifts worth trying: those of the neighbours, which continue what is there, and those the pattern allows.
    fn candidates(&self, rect: &Rect) -> Vec<Shift> {
        let mut shifts = self.neighbours(rect);
        let pitch = self.guide.working.pitch;
        match self.continuation.lattice() {
            Some(basis) => shifts.extend(self.lattice_shifts(rect, basis)),
            None => {
                let mut rng = Rng::new(self.seed, &[rect.x as u64, rect.y as u64]);
                let width = self.guide.working.width;
                shifts.extend((0..self.guide.candidates).map(|_| {
                    let corner = self.admissible[rng.below(self.admissible.len())] as usize;
                    let working = [rect.x as i32 - (corner % width) as i32, rect.y as i32 - (corner / width) as i32];
                    free_shift(working, pitch)
                }));
            }
        }
        shifts
    }

    /// Lattice vectors that bring some usable pixel into a block.
    fn lattice_shifts(&self, rect: &Rect, basis: [DVec2; 2]) -> Vec<Shift> {
        let pitch = self.guide.working.pitch;
        let point = |x: usize, y: usize| DVec2::new(x as f64, y as f64);
        let low = (point(rect.x, rect.y) - point(self.bounds[2], self.bounds[3])) * pitch;
        let high = (point(rect.x + rect.w, rect.y + rect.h) - point(self.bounds[0], self.bounds[1])) * pitch;

        // The cells of the lattice that the box of such shifts touches.
        let inverse = DMat2::from_cols(basis[0], basis[1]).inverse();
        let corners =
            [low, DVec2::new(high.x, low.y), DVec2::new(low.x, high.y), high].map(|c| inverse * (c - self.offset));
        let first = corners.iter().fold(DVec2::INFINITY, |m, c| m.min(*c)).ceil();
        let last = corners.iter().fold(DVec2::NEG_INFINITY, |m, c| m.max(*c)).floor();
        let columns = (last.x - first.x).max(-1.0) as u64 + 1;
        let count = columns * ((last.y - first.y).max(-1.0) as u64 + 1);
        let keep = |i: u64| {
            count <= LATTICE_CANDIDATES as u64
                || rng::hash(self.seed, &[rect.x as u64, rect.y as u64, i]) % count < LATTICE_CANDIDATES as u64
        };
        (0..count)
            .filter(|&i| keep(i))
            .map(|i| {
                let steps = first + DVec2::new((i % columns) as f64, (i / columns) as f64);
                let exact = self.offset + basis[0] * steps.x + basis[1] * steps.y;
                let working = (exact / pitch).round();
                Shift { working: [working.x as i32, working.y as i32], exact }
            })
            .filter(|s| s.exact.cmpge(low).all() && s.exact.cmple(high).all())
            .collect()
    }

    /// The part of a run that a shift takes from within the exemplar: how many of its pixels come before, how many there are,
    /// and the place of the first in the exemplar.
    fn shown(&self, run: &Run, shift: &Shift) -> Option<(usize, usize, [usize; 2])> {
        let working = self.guide.working;
        let (x, y) = (run.x as i64 - i64::from(shift.working[0]), run.y as i64 - i64::from(shift.working[1]));
        let skipped = (-x).max(0);
        let length = (run.length as i64).min(working.width as i64 - x) - skipped;
        let inside = length > 0 && y >= 0 && y < working.height as i64;
        inside.then(|| (skipped as usize, length as usize, [(x + skipped) as usize, y as usize]))
    }

    /// How many empty pixels of a block each shift fills, or 0 if far less than the best; and whether it shows something usable in all
    /// of the block.
    fn fills(&self, block: &Block, shifts: &[Shift]) -> Vec<(usize, bool)> {
        let Rect { x, y, w, h } = block.rect;
        let empty = count(&block.empty);
        let usable_of = |runs: &[Run], shift: &Shift| -> usize {
            runs.iter()
                .filter_map(|run| self.shown(run, shift))
                .map(|(_, length, [x, y])| self.usable.count(x, y, length, 1))
                .sum()
        };
        // All of the block at once: the most that a shift can fill.
        let most_of = |shift: &Shift| {
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
        let bounds: Vec<usize> = shifts.iter().map(most_of).collect();
        let mut most = if bounds.contains(&(w * h)) { empty } else { 0 };
        let exact = |(shift, bound): (&Shift, usize)| {
            if bound == w * h {
                return (empty, true);
            }
            if (bound as f64) < ENOUGH_COVERAGE * most as f64 {
                return (0, false);
            }
            let fills = usable_of(&block.empty, shift);
            most = most.max(fills);
            (fills, false)
        };
        shifts.iter().zip(bounds).map(exact).collect()
    }

    /// The shifts that fill `least` or more of the empty pixels, or without it nearly as many as the best does, and how well
    /// they agree with the known ones. The error of those that are no match for the best, or for one of error `limit`, is infinite.
    fn score(
        &self,
        block: &Block,
        shifts: &[Shift],
        least: Option<usize>,
        limit: f32,
        job: Job,
    ) -> Result<Vec<Scored>> {
        let fills = self.fills(block, shifts);
        let most = fills.iter().map(|f| f.0).max().unwrap_or(0);
        let least = least.unwrap_or((ENOUGH_COVERAGE * most as f64).ceil() as usize).max(1);
        let mut covering: Vec<usize> = (0..shifts.len()).filter(|&n| fills[n].0 >= least).collect();
        let filled = count(&block.filled);
        let mut excess = vec![0.0; shifts.len()];
        let of_covering = self.excess(block, covering.iter().map(|&n| shifts[n]));
        covering.iter().zip(of_covering).for_each(|(&n, e)| excess[n] = e);
        let penalty = |n: usize| (self.balance.penalty(excess[n]) / filled.max(1) as f64) as f32;
        if covering.len() > FINALISTS && block.rect.h >= 4 * ROW_STEP {
            let is_sampled = |run: &&Run| (run.y - block.rect.y) % ROW_STEP == ROW_STEP / 2;
            let rows: Vec<Run> = block.filled.iter().filter(is_sampled).copied().collect();
            let compared = count(&rows);
            let error =
                |&n: &usize| (penalty(n) + self.error(&rows, (&shifts[n], fills[n].1), compared, f32::INFINITY), n);
            let mut ranked: Vec<(f32, usize)> = covering.iter().map(error).collect();
            ranked.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            // What nothing known tells apart all stays.
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

    /// Mean squared difference of a shift, which may show something usable everywhere, from known pixels, of which there are `filled`;
    /// infinite as soon as it exceeds `limit`.
    fn error(&self, known: &[Run], (shift, is_whole): (&Shift, bool), filled: usize, limit: f32) -> f32 {
        let working = self.guide.working;
        let most = f64::from(limit) * filled as f64;
        let (mut sum, mut compared) = (0f64, 0usize);
        for run in known {
            let Some((skipped, length, [x, y])) = self.shown(run, shift) else { continue };
            let (old, new) = (run.source + skipped, y * working.width + x);
            let mut add = |from: usize, to: usize| {
                let (a, b) = (&self.features[old + from..old + to], &self.features[new + from..new + to]);
                sum += f64::from(squares(a, b, self.turns));
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
            // No mean over fewer pixels is less.
            if sum > most {
                return f32::INFINITY;
            }
        }
        if compared > 0 { (sum / compared as f64) as f32 } else { 0.0 }
    }

    /// By how many pixels of light more than their share each of some shifts fills the empty pixels of a block. On a lattice their share
    /// is what all of them show on average, since its lamps are always at the same places of a block; elsewhere that of the exemplar.
    fn excess(&self, block: &Block, shifts: impl Iterator<Item = Shift>) -> Vec<f64> {
        let light_of = |shift: Shift| {
            let parts = block.empty.iter().filter_map(|run| self.shown(run, &shift));
            parts.fold([0, 0], |[light, all], (_, length, [x, y])| {
                [light + self.light.count(x, y, length, 1), all + self.usable.count(x, y, length, 1)]
            })
        };
        let lights: Vec<[f64; 2]> =
            shifts.map(light_of).map(|[light, all]| [light as f64 / f64::from(LIGHT_STEPS), all as f64]).collect();
        let sum = |k: usize| lights.iter().map(|l| l[k]).sum::<f64>();
        let share = match self.continuation.lattice() {
            Some(_) => sum(0) / sum(1).max(1.0),
            None => self.lit_share,
        };
        lights.into_iter().map(|[light, all]| light - share * all).collect()
    }

    /// Draws one of the shifts that are as good as the best. A row of lamps begins as the exemplar does, and goes on with it as
    /// far as it goes.
    fn choose(&self, block: &Block, scored: &[Scored]) -> Option<Scored> {
        let rect = &block.rect;
        if matches!(self.continuation, Continuation::Row(_)) && self.layout.shifts.is_empty() {
            let length = |s: &&Scored| (s.shift.exact - self.offset).length();
            return scored.iter().min_by(|a, b| length(a).total_cmp(&length(b))).copied();
        }
        let least = scored.iter().map(|s| s.error).fold(f32::INFINITY, f32::min);
        let equal: Vec<_> = scored.iter().filter(|s| s.error <= self.equally_good(least)).collect();
        if matches!(self.continuation, Continuation::Row(_)) {
            let around = self.neighbours(rect);
            if let Some(same) = equal.iter().find(|s| around.contains(&s.shift)) {
                return Some(**same);
            }
        }
        let mut rng = Rng::new(self.seed, &[rect.x as u64, rect.y as u64, 1]);
        equal.get(rng.below(equal.len().max(1))).map(|s| **s)
    }

    /// The largest error that is as good as another.
    fn equally_good(&self, error: f32) -> f32 {
        error * TOLERANCE.0 + self.slack
    }

    /// Moves a free patch to the best place in its neighbourhood, by ever smaller steps.
    fn improve(&self, block: &Block, start: Scored, job: Job) -> Result<Scored> {
        let mut best = start;
        for step in [4, 2, 1] {
            let ring = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
            let near = ring.map(|(dx, dy)| {
                let [x, y] = best.shift.working;
                free_shift([x + dx * step, y + dy * step], self.guide.working.pitch)
            });
            for near in self.score(block, &near, Some(start.fills), best.error, job)? {
                if near.error < best.error {
                    best = near;
                }
            }
        }
        Ok(best)
    }

    /// Shows a shift in the empty pixels of a block and, with an overlap, up to the seams in the known ones.
    fn paste(&mut self, block: &Block, shift: Shift, overlap: Option<[usize; 2]>) {
        let (working, rect, known) = (self.guide.working, block.rect, &block.known);
        let source = |x: usize, y: usize| {
            working
                .index((rect.x + x) as i32 - shift.working[0], (rect.y + y) as i32 - shift.working[1])
                .filter(|&s| working.usable[s])
        };
        let cost = |x: usize, y: usize| match (known[y * rect.w + x], source(x, y)) {
            (NONE, _) | (_, None) => 0.0,
            (old, Some(new)) => {
                let old = old as usize;
                let lamp = if working.is_lit(old) || working.is_lit(new) { LAMP_COST } else { 0.0 };
                squares(&self.features[old..=old], &self.features[new..=new], self.turns) + lamp
            }
        };

        // Where the new patch begins: the column in each row, and the row in each column.
        let mut from_column = vec![0; rect.h];
        let mut from_row = vec![0; rect.w];
        if let Some([ow, oh]) = overlap {
            if rect.x > 0 {
                let w = ow.min(rect.w);
                let strip: Vec<f32> = (0..w * rect.h).map(|i| cost(i % w, i / w)).collect();
                from_column = seam::vertical_cut(&strip, w, rect.h);
            }
            if rect.y > 0 {
                let h = oh.min(rect.h);
                let strip: Vec<f32> = (0..rect.w * h).map(|i| cost(i % rect.w, i / rect.w)).collect();
                from_row = seam::horizontal_cut(&strip, rect.w, h);
            }
        }
        let shifts = &mut self.layout.shifts;
        let key = (shift.working, shift.exact.to_array().map(f64::to_bits));
        let label = *self.labels.entry(key).or_insert_with(|| {
            shifts.push(shift);
            shifts.len() as u32 - 1
        });
        for (i, &old) in known.iter().enumerate() {
            let (x, y) = (i % rect.w, i / rect.w);
            let beyond = overlap.is_some() && x >= from_column[y] && y >= from_row[x];
            if old != NONE && !beyond {
                continue;
            }
            let Some(new) = source(x, y) else { continue };
            if old != NONE {
                self.balance.add(f64::from(working.coverage[new] - working.coverage[old as usize]));
            }
            self.open[(rect.y + y - self.first) * self.layout.width + rect.x + x] = label;
        }
    }
}

impl Block {
    fn add(&mut self, run: Run) {
        let runs = if run.source == NONE as usize { &mut self.empty } else { &mut self.filled };
        runs.push(run);
    }
}

fn free_shift(working: [i32; 2], pitch: DVec2) -> Shift {
    Shift { working, exact: DVec2::new(f64::from(working[0]), f64::from(working[1])) * pitch }
}
