//! Places patches by image quilting (Efros and Freeman 2001). Patches are compared by colour and metadata: the
//! confidence, and the x and y distance to the nearest light ("Lighting Style Transfer", §6).
//!
//! A patch is a shift of the exemplar: position in the texture minus position in the exemplar. The texture is filled
//! block by block, row by row:
//!
//! 1. Of the shifts that cover most of the block, keep the shifts that agree best with the pixels already placed.
//! 2. Choose one of them at random.
//! 3. If pixels remain empty, because the photo does not show their source, fill them by further patches.
//!
//! On a lattice, only lattice vectors are tried as shifts. The lamps of all patches then lie on one lattice, whichever
//! shifts are chosen. Rounding errors do not accumulate from patch to patch, because every shift is computed from the
//! origin of the lattice, not from the neighbouring patch.

pub mod balance;
pub mod block;
pub mod comparison;
pub mod guide;
pub mod metadata;
pub mod patch_map;
pub mod seam;
pub mod stretched;

use super::exemplar::area_sums::AreaSums;
use super::lattice::law::Law;
use crate::error::Result;
use crate::image::try_vec;
use crate::job::Job;
use crate::rng::{self, Rng};
use balance::Balance;
use block::{Block, Rect, Run};
use comparison::{Comparison, Scored};
use glam::{DMat2, DVec2};
use guide::{Guide, squares};
use patch_map::{NONE, PatchMap, Shift};
use std::collections::BTreeMap;

/// Maximum number of candidate shifts per patch on a lattice. [bench emission:seconds]
const LATTICE_CANDIDATES: usize = 128;

/// Cost added to a pixel of a seam if it lies on a lamp. It exceeds the cost of any path around the lamp. [convention]
const LAMP_COST: f32 = 1e4;

/// A texture while it is filled with patches.
struct Quilt<'a> {
    comparison: Comparison<'a>,
    /// The finished rows, which no later block changes, and all shifts used so far.
    patch_map: PatchMap,
    /// Index of the first unfinished row (`first`), and for each pixel of the unfinished rows the label of its shift
    /// (`open`).
    first: usize,
    open: Vec<u32>,
    /// For each shift used so far, its label: its index in the patch map's list of shifts. The key is
    /// (`Shift::working`, bits of `Shift::exact`).
    labels: BTreeMap<([i32; 2], [u64; 2]), u32>,
    law: Law,
    /// Position of the lattice's origin in the texture, in unwarped pixels.
    offset: DVec2,
    /// `bounds`: bounding box of the exemplar's usable pixels. `admissible`: indices of the exemplar's pixels at which
    /// the upper left corner of a block may lie, so that the block contains usable pixels only; empty on a lattice.
    bounds: [usize; 4],
    admissible: Vec<u32>,
    balance: Balance,
    seed: u64,
}

/// Fills a texture of `width` × `height` working pixels with patches, in blocks of at most `block` × `block` pixels.
/// `offset` is the position of the lattice's origin in the texture, in unwarped pixels.
pub fn place(
    guide: &Guide,
    law: Law,
    offset: DVec2,
    (width, height): (usize, usize),
    block: usize,
    seed: u64,
    job: Job,
) -> Result<PatchMap> {
    let working = guide.working;
    let bounds = working.usable_box();
    let largest = [block.min(bounds[2] - bounds[0]).min(width), block.min(bounds[3] - bounds[1]).min(height)];
    let usable = AreaSums::new(|i| working.usable[i], working.width, working.height)?;
    let is_lattice = law.lattice().is_some();
    let ([w, h], admissible) = match is_lattice {
        true => (largest, Vec::new()),
        false => admissible_corners(&usable, working.width, bounds, largest),
    };
    let overlap = [w / 3, h / 3];
    let mut quilt = Quilt {
        comparison: Comparison::new(guide, usable, is_lattice)?,
        patch_map: PatchMap::new(width, height),
        first: 0,
        // Allocate one row of blocks, and one row of pixels above it for the comparison with neighbours.
        open: try_vec(width * (h + 1), NONE)?,
        labels: BTreeMap::new(),
        law,
        offset,
        bounds,
        admissible,
        balance: Balance::new(width.div_ceil(w - overlap[0]), guide.lamp, is_lattice)?,
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
    Ok(quilt.patch_map)
}

/// Returns the sides of a block, and all positions in the exemplar at which the block contains usable pixels only. A
/// texture without a lattice is made of blocks from these positions. Each position is given by the index of the block's
/// upper left pixel. If there is no such position, the sides shrink by a quarter, repeatedly, until there is one.
fn admissible_corners(
    usable: &AreaSums,
    width: usize,
    bounds: [usize; 4],
    [mut w, mut h]: [usize; 2],
) -> ([usize; 2], Vec<u32>) {
    let mut admissible = Vec::new();
    loop {
        for y in bounds[1]..=bounds[3] - h {
            let fits = |x: &usize| usable.count(*x, y, w, h) == w * h;
            admissible.extend((bounds[0]..=bounds[2] - w).filter(fits).map(|x| (y * width + x) as u32));
        }
        if !admissible.is_empty() {
            return ([w, h], admissible);
        }
        (w, h) = ((w * 3 / 4).max(1), (h * 3 / 4).max(1));
    }
}

impl Quilt<'_> {
    /// The label of a pixel in an unfinished row.
    fn label(&self, x: usize, y: usize) -> u32 {
        self.open[(y - self.first) * self.patch_map.width + x]
    }

    /// Moves the rows above row `y`, which are finished, into the patch map.
    fn close(&mut self, y: usize) {
        let width = self.patch_map.width;
        let done = (y - self.first) * width;
        self.open[..done].chunks_exact(width).for_each(|row| self.patch_map.push(row));
        self.open.copy_within(done.., 0);
        let rest = self.open.len() - done;
        self.open[rest..].fill(NONE);
        self.first = y;
    }

    /// Places patches in a block until it is full, or until no patch can fill any of its empty pixels.
    fn fill(&mut self, rect: &Rect, overlap: [usize; 2], job: Job) -> Result<()> {
        let mut first = true;
        loop {
            let block = self.block(rect);
            if block.empty.is_empty() {
                return Ok(());
            }
            let scored =
                self.comparison.score(&block, &self.candidates(rect), None, f32::INFINITY, &self.balance, job)?;
            let Some(mut chosen) = self.choose(&block, &scored) else { return Ok(()) };
            if !self.admissible.is_empty() {
                chosen = self.improve(&block, chosen, job)?;
            }
            self.balance.add(chosen.excess);
            self.paste(&block, chosen.shift, first.then_some(overlap));
            first = false;
        }
    }

    /// The block at `rect`, with the exemplar pixels that it shows so far.
    fn block(&self, rect: &Rect) -> Block {
        let mut block =
            Block { rect: *rect, known: Vec::with_capacity(rect.w * rect.h), empty: Vec::new(), filled: Vec::new() };
        for y in rect.y..rect.y + rect.h {
            let start = (y - self.first) * self.patch_map.width + rect.x;
            let mut x = rect.x;
            for labels in self.open[start..start + rect.w].chunk_by(|a, b| a == b) {
                // Adjacent pixels that have the same shift show adjacent pixels of the exemplar, so store them as one
                // run.
                let source = self.patch_map.source(x, y, labels[0], self.comparison.guide.working);
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

    /// The distinct shifts around three corners of a block: upper left, upper right and lower left. At each corner,
    /// these are the shift of the block's corner pixel and the shift of the pixel one column to the left and one row
    /// above it. Pixels without a patch give no shift.
    fn neighbours(&self, rect: &Rect) -> Vec<Shift> {
        let mut shifts: Vec<Shift> = Vec::new();
        let mut neighbour = |x: usize, y: usize| {
            if let Some(&shift) = self.patch_map.shifts.get(self.label(x, y) as usize)
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

    /// Returns the candidate shifts for a block. Some are the shifts of pixels at its corners, which continue the
    /// patches that are already placed. The others are new: lattice vectors or, without a lattice, random shifts.
    fn candidates(&self, rect: &Rect) -> Vec<Shift> {
        let mut shifts = self.neighbours(rect);
        let pitch = self.comparison.guide.working.pitch;
        match self.law.lattice() {
            Some(basis) => shifts.extend(self.lattice_shifts(rect, basis)),
            None => {
                let mut rng = Rng::new(self.seed, &[rect.x as u64, rect.y as u64]);
                let width = self.comparison.guide.working.width;
                shifts.extend((0..self.comparison.guide.candidates).map(|_| {
                    let corner = self.admissible[rng.below(self.admissible.len())] as usize;
                    let working = [rect.x as i32 - (corner % width) as i32, rect.y as i32 - (corner / width) as i32];
                    free_shift(working, pitch)
                }));
            }
        }
        shifts
    }

    /// The shifts that lead to a position of the lattice and move the bounding box of the exemplar's usable pixels so
    /// that it overlaps a block. If there are more than [`LATTICE_CANDIDATES`], a random subset of about this size.
    fn lattice_shifts(&self, rect: &Rect, basis: [DVec2; 2]) -> Vec<Shift> {
        let pitch = self.comparison.guide.working.pitch;
        let point = |x: usize, y: usize| DVec2::new(x as f64, y as f64);
        let low = (point(rect.x, rect.y) - point(self.bounds[2], self.bounds[3])) * pitch;
        let high = (point(rect.x + rect.w, rect.y + rect.h) - point(self.bounds[0], self.bounds[1])) * pitch;

        // Find the range of lattice cells that contains all shifts between `low` and `high`.
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

    /// Chooses at random among the equally good shifts, whose error exceeds the lowest error by no more than the
    /// tolerance ([`Comparison::equally_good`]). The law [`Law::Row`] is the exception. Its first block takes the shift
    /// nearest to `offset`. Each later block keeps the shift of a neighbouring patch if this shift is equally good.
    /// `None` if there is no shift to choose from.
    fn choose(&self, block: &Block, scored: &[Scored]) -> Option<Scored> {
        let rect = &block.rect;
        if matches!(self.law, Law::Row(_)) && self.patch_map.shifts.is_empty() {
            let length = |s: &&Scored| (s.shift.exact - self.offset).length();
            return scored.iter().min_by(|a, b| length(a).total_cmp(&length(b))).copied();
        }
        let min_error = scored.iter().map(|s| s.error).fold(f32::INFINITY, f32::min);
        let equal: Vec<_> = scored.iter().filter(|s| s.error <= self.comparison.equally_good(min_error)).collect();
        if matches!(self.law, Law::Row(_)) {
            let around = self.neighbours(rect);
            if let Some(same) = equal.iter().find(|s| around.contains(&s.shift)) {
                return Some(**same);
            }
        }
        let mut rng = Rng::new(self.seed, &[rect.x as u64, rect.y as u64, 1]);
        equal.get(rng.below(equal.len().max(1))).map(|s| **s)
    }

    /// Refines the shift of a patch by local search: moves it by 4, then 2, then 1 working pixels in the best of eight
    /// directions, if this lowers the error. Used only without a lattice.
    fn improve(&self, block: &Block, start: Scored, job: Job) -> Result<Scored> {
        let mut best = start;
        for step in [4, 2, 1] {
            let ring = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
            let near = ring.map(|(dx, dy)| {
                let [x, y] = best.shift.working;
                free_shift([x + dx * step, y + dy * step], self.comparison.guide.working.pitch)
            });
            for near in self.comparison.score(block, &near, Some(start.fills), best.error, &self.balance, job)? {
                if near.error < best.error {
                    best = near;
                }
            }
        }
        Ok(best)
    }

    /// Writes a shift to the empty pixels of a block. If `overlap`, the width and height of the overlap with earlier
    /// patches, is given, seams are cut through the overlap. Known pixels that lie both right of the vertical seam and
    /// below the horizontal seam are then overwritten as well. A pixel stays unchanged if the shift shows no usable
    /// pixel there.
    fn paste(&mut self, block: &Block, shift: Shift, overlap: Option<[usize; 2]>) {
        let (working, rect, known) = (self.comparison.guide.working, block.rect, &block.known);
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
                squares(
                    &self.comparison.features[old..=old],
                    &self.comparison.features[new..=new],
                    self.comparison.channel_periods,
                ) + lamp
            }
        };

        // Find the seams: `from_column` holds the new patch's first column in each row, `from_row` its first row in
        // each column.
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
        let shifts = &mut self.patch_map.shifts;
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
            self.open[(rect.y + y - self.first) * self.patch_map.width + rect.x + x] = label;
        }
    }
}

/// A shift by whole working pixels, for textures without a lattice.
fn free_shift(working: [i32; 2], pitch: DVec2) -> Shift {
    Shift { working, exact: DVec2::new(f64::from(working[0]), f64::from(working[1])) * pitch }
}
