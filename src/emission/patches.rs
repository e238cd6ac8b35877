//! Iterative patch placement: image quilting (Efros and Freeman 2001) over colour and metadata ("Lighting Style Transfer", §6).
//!
//! Blocks are filled in scanline order. A patch is a shift of the exemplar; of the shifts that cover a block best, one is
//! drawn among those that agree best with what is already there. What a patch cannot show, because the photo did not, is
//! filled by further patches of the same block. On a lattice only shifts by lattice vectors are tried: whatever is chosen,
//! the lamps stay in phase, and errors do not add up from patch to patch because every shift is measured from the origin.

use super::exemplar::{AreaSums, Working};
use super::layout::{Layout, NONE, Shift};
use super::period::Continuation;
use super::seam;
use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_vec};
use crate::job::Job;
use crate::rng::{self, Rng};
use glam::{DMat2, DVec2};
use std::collections::BTreeMap;

/// Candidates per patch where any shift is allowed, and the most where the lattice allows too many.
const FREE_CANDIDATES: usize = 192;
const LATTICE_CANDIDATES: usize = 128;
/// Patches within this factor of the best (0.1 in the original), or this close to it, are equally good.
const TOLERANCE: (f32, f32) = (1.1, 1e-6);
/// Patches that cover at least this share of what the best would cover compete by their error.
const ENOUGH_COVERAGE: f64 = 0.95;
/// Added to the cost of a seam on a lamp: more than any path around it.
const LAMP_COST: f32 = 1e4;

/// Colour and metadata of the exemplar, and their weights.
pub struct Guide<'a> {
    pub working: &'a Working,
    pub metadata: &'a Image,
    pub metadata_weight: f32,
}

impl Guide<'_> {
    fn features(&self) -> Vec<[f32; 6]> {
        let pixels = self.working.colour.data.chunks_exact(3).zip(self.metadata.data.chunks_exact(3));
        pixels.map(|(c, m)| [c[0], c[1], c[2], m[0], m[1], m[2]]).collect()
    }

    /// Squared difference of two pixels. Distances wrap: one cap to the left of a lamp is as far as one cap to its right.
    fn difference(&self, a: &[f32; 6], b: &[f32; 6]) -> f32 {
        let square = |c: usize| (a[c] - b[c]) * (a[c] - b[c]);
        let wrapped = |c: usize| {
            let d = (a[c] - b[c]).abs();
            let d = d.min(2.0 - d);
            d * d
        };
        (square(0) + square(1) + square(2)) / 3.0 + self.metadata_weight * (square(3) + wrapped(4) + wrapped(5))
    }
}

#[derive(Clone, Copy)]
struct Rect {
    x: usize,
    y: usize,
    w: usize,
    h: usize,
}

/// A block: its pixels that show nothing yet, and those that show a pixel of the exemplar.
struct Block {
    rect: Rect,
    empty: Vec<[i32; 2]>,
    filled: Vec<([i32; 2], u32)>,
}

/// A shift, how many empty pixels of a block it fills, and its mean squared difference from the known ones.
#[derive(Clone, Copy)]
struct Scored {
    shift: Shift,
    fills: usize,
    error: f32,
}

struct Quilt<'a> {
    guide: &'a Guide<'a>,
    features: Vec<[f32; 6]>,
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

    let mut quilt = Quilt {
        guide,
        features: guide.features(),
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
        seed,
    };
    let overlap = [w / 3, h / 3];
    for y in (0..height).step_by(h - overlap[1]) {
        quilt.close(y.saturating_sub(1));
        for x in (0..width).step_by(w - overlap[0]) {
            job.check()?;
            let rect = Rect { x, y, w: w.min(width - x), h: h.min(height - y) };
            quilt.fill(&rect, overlap, job.part(0.0, 0.0))?;
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
            let known = self.known(rect);
            let position = |i: usize| [(rect.x + i % rect.w) as i32, (rect.y + i / rect.w) as i32];
            let pixels = || known.iter().enumerate().map(|(i, k)| (position(i), *k));
            let block = Block {
                rect: *rect,
                empty: pixels().filter(|(_, k)| k.is_none()).map(|(p, _)| p).collect(),
                filled: pixels().filter_map(|(p, k)| k.map(|k| (p, k))).collect(),
            };
            if block.empty.is_empty() {
                return Ok(());
            }
            let scored = self.score(&block, &self.candidates(rect), None, job)?;
            let Some(mut chosen) = self.choose(rect, &scored) else { return Ok(()) };
            if !self.admissible.is_empty() {
                chosen = self.improve(&block, chosen, job)?;
            }
            self.paste(rect, &known, chosen.shift, first.then_some(overlap));
            first = false;
        }
    }

    /// The exemplar pixel each pixel of a block already shows.
    fn known(&self, rect: &Rect) -> Vec<Option<u32>> {
        let pixel = |i: usize| {
            let (x, y) = (rect.x + i % rect.w, rect.y + i / rect.w);
            self.layout.source(x, y, self.label(x, y), self.guide.working)
        };
        (0..rect.w * rect.h).map(|i| pixel(i).map(|s| s as u32)).collect()
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
                shifts.extend((0..FREE_CANDIDATES).map(|_| {
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

    /// How many empty pixels of a block a shift fills; and whether it shows something usable in all of the block.
    fn fills(&self, block: &Block, shift: &Shift) -> (usize, bool) {
        let (working, rect) = (self.guide.working, &block.rect);
        let [x, y] = [rect.x as i32 - shift.working[0], rect.y as i32 - shift.working[1]];
        let inside = x >= 0 && y >= 0 && x as usize + rect.w <= working.width && y as usize + rect.h <= working.height;
        if inside && self.usable.count(x as usize, y as usize, rect.w, rect.h) == rect.w * rect.h {
            return (block.empty.len(), true);
        }
        let [dx, dy] = shift.working;
        let is_usable = |&&[x, y]: &&[i32; 2]| working.index(x - dx, y - dy).is_some_and(|s| working.usable[s]);
        (block.empty.iter().filter(is_usable).count(), false)
    }

    /// The shifts that fill `least` or more of the empty pixels, or without it nearly as many as the best does, and how well
    /// they agree with the known ones.
    fn score(&self, block: &Block, shifts: &[Shift], least: Option<usize>, job: Job) -> Result<Vec<Scored>> {
        let working = self.guide.working;
        let fills: Vec<(usize, bool)> = shifts.iter().map(|shift| self.fills(block, shift)).collect();
        let most = fills.iter().map(|f| f.0).max().unwrap_or(0);
        let least = least.unwrap_or((ENOUGH_COVERAGE * most as f64).ceil() as usize).max(1);
        let covering: Vec<usize> = (0..shifts.len()).filter(|&n| fills[n].0 >= least).collect();
        exec::map(covering.len(), job, |i| {
            let (shift, (fills, is_whole)) = (shifts[covering[i]], fills[covering[i]]);
            let [dx, dy] = shift.working;
            let source = |[x, y]: [i32; 2]| match is_whole {
                true => Some((y - dy) as usize * working.width + (x - dx) as usize),
                false => working.index(x - dx, y - dy).filter(|&s| working.usable[s]),
            };
            // Sums of a few in single precision: short chains of additions run side by side.
            let (mut sum, mut count) = (0f64, 0u32);
            for some in block.filled.chunks(8) {
                let mut part = 0f32;
                for &(at, old) in some {
                    if let Some(new) = source(at) {
                        part += self.guide.difference(&self.features[old as usize], &self.features[new]);
                        count += 1;
                    }
                }
                sum += f64::from(part);
            }
            let error = if count > 0 { (sum / f64::from(count)) as f32 } else { 0.0 };
            Scored { shift, fills, error }
        })
    }

    /// Draws one of the shifts that are as good as the best. A row of lamps begins as the exemplar does, and goes on with it as far
    /// as it goes.
    fn choose(&self, rect: &Rect, scored: &[Scored]) -> Option<Scored> {
        if matches!(self.continuation, Continuation::Row(_)) && self.layout.shifts.is_empty() {
            let length = |s: &&Scored| (s.shift.exact - self.offset).length();
            return scored.iter().min_by(|a, b| length(a).total_cmp(&length(b))).copied();
        }
        let least = scored.iter().map(|s| s.error).fold(f32::INFINITY, f32::min);
        let equal: Vec<_> = scored.iter().filter(|s| s.error <= least * TOLERANCE.0 + TOLERANCE.1).collect();
        if matches!(self.continuation, Continuation::Row(_)) {
            let around = self.neighbours(rect);
            if let Some(same) = equal.iter().find(|s| around.contains(&s.shift)) {
                return Some(**same);
            }
        }
        let pick = Rng::new(self.seed, &[rect.x as u64, rect.y as u64, 1]).below(equal.len().max(1));
        equal.get(pick).map(|s| **s)
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
            for near in self.score(block, &near, Some(start.fills), job)? {
                if near.error < best.error {
                    best = near;
                }
            }
        }
        Ok(best)
    }

    /// Shows a shift in the empty pixels of a block and, with an overlap, up to the seams in the known ones.
    fn paste(&mut self, rect: &Rect, known: &[Option<u32>], shift: Shift, overlap: Option<[usize; 2]>) {
        let working = self.guide.working;
        let source = |x: usize, y: usize| {
            working
                .index((rect.x + x) as i32 - shift.working[0], (rect.y + y) as i32 - shift.working[1])
                .filter(|&s| working.usable[s])
        };
        let cost = |x: usize, y: usize| match (known[y * rect.w + x].map(|k| k as usize), source(x, y)) {
            (Some(old), Some(new)) => {
                let lamp = if working.lit[old] || working.lit[new] { LAMP_COST } else { 0.0 };
                self.guide.difference(&self.features[old], &self.features[new]) + lamp
            }
            _ => 0.0,
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
        for (i, old) in known.iter().enumerate() {
            let (x, y) = (i % rect.w, i / rect.w);
            let beyond = overlap.is_some() && x >= from_column[y] && y >= from_row[x];
            if (old.is_none() || beyond) && source(x, y).is_some() {
                self.open[(rect.y + y - self.first) * self.layout.width + rect.x + x] = label;
            }
        }
    }
}

fn free_shift(working: [i32; 2], pitch: DVec2) -> Shift {
    Shift { working, exact: DVec2::new(f64::from(working[0]), f64::from(working[1])) * pitch }
}
