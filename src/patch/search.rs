//! PatchMatch (Barnes et al. 2009): propagation and random search, deterministic for any number of threads.
//!
//! The query image is cut into fixed tiles. A sweep visits each tile twice, forwards and backwards, seeing the rest of
//! the field as it was before the sweep, and only then are the tiles written back.

use super::domain::Domain;
use super::features::Features;
use super::field::{Field, NONE, pack, unpack};
use super::kernel::{Kernel, Patch};
use crate::error::Result;
use crate::exec;
use crate::job::Job;
use crate::rng::{Rng, hash};

/// Patches along a side of a tile: with 16 channels a tile and its matches stay in a second-level cache.
const TILE: usize = 48;

/// Where matches of the patches of `query` may be searched for.
#[derive(Clone, Copy)]
pub struct Search<'a> {
    pub query: &'a Features,
    pub base: &'a Features,
    /// Patches of `base` that may be matches.
    pub allowed: &'a Domain,
    /// Width of a patch in pixels.
    pub patch: usize,
    pub kernel: Kernel,
    pub seed: u64,
}

/// One round of propagation and random search.
#[derive(Clone, Copy, Debug)]
pub struct Sweep {
    /// Number of this sweep: random numbers depend on it.
    pub index: u64,
    /// Largest distance of random candidates from the best match so far, in pixels; halved until it is 0.
    pub reach: usize,
    /// Random candidates from anywhere for a patch that has no match yet.
    pub fresh: usize,
}

impl Search<'_> {
    /// Distance between a patch of the query and one of the base, cut short at `limit`.
    #[inline]
    pub fn distance(&self, x: usize, y: usize, match_x: usize, match_y: usize, limit: u32) -> u32 {
        fn at(image: &Features, x: usize, y: usize) -> Patch<'_> {
            Patch { samples: &image.data[(y * image.width + x) * image.lanes..], row_len: image.row_len() }
        }
        let run = self.patch * self.query.lanes;
        self.kernel.distance(at(self.query, x, y), at(self.base, match_x, match_y), run, self.patch, limit)
    }

    /// Recomputes the distances of the patches for which `wanted` holds, where they have an allowed match.
    pub fn rescore(&self, field: &mut Field, job: Job, wanted: impl Fn(usize) -> bool + Sync) -> Result<()> {
        let width = field.width;
        let at = &field.at;
        exec::for_rows(&mut field.error, width, job, |y, errors| {
            for (x, error) in errors.iter_mut().enumerate() {
                if wanted(y * width + x) {
                    *error = match at[y * width + x] {
                        NONE => u32::MAX,
                        position => {
                            let (px, py) = unpack(position);
                            if self.allowed.contains(px, py) { self.distance(x, y, px, py, u32::MAX) } else { u32::MAX }
                        }
                    }
                }
            }
        })
    }

    /// Compares every active patch with every allowed one: for images of a few thousand pixels.
    pub fn exhaustive(&self, field: &mut Field, job: Job, active: impl Fn(usize) -> bool + Sync) -> Result<()> {
        let width = field.width;
        let rows = exec::map(field.height, job, |y| {
            let mut row = Vec::with_capacity(width);
            for i in y * width..(y + 1) * width {
                let mut best = Best { at: field.at[i], error: field.error[i], x: i % width, y };
                if active(i) {
                    for &position in self.allowed.members() {
                        let (px, py) = unpack(position);
                        best.try_at(self, px as isize, py as isize);
                    }
                }
                row.push((best.at, best.error));
            }
            row
        })?;
        field.set_rows(rows);
        Ok(())
    }

    /// Lowers the distances of the patches for which `active` holds; no distance rises.
    pub fn sweep(
        &self,
        field: &mut Field,
        sweep: Sweep,
        job: Job,
        active: impl Fn(usize) -> bool + Sync,
    ) -> Result<()> {
        if self.allowed.is_empty() {
            return job.check();
        }
        let (columns, rows) = (field.width.div_ceil(TILE), field.height.div_ceil(TILE));
        let key = hash(self.seed, &[sweep.index]);
        let tiles = exec::map(columns * rows, job, |t| {
            let mut tile = Tile::cut(field, t % columns * TILE, t / columns * TILE);
            tile.search(self, field, sweep, key, &active).then_some(tile)
        })?;
        tiles.into_iter().flatten().for_each(|tile| tile.paste(field));
        Ok(())
    }
}

/// A copy of a part of the field.
struct Tile {
    x0: usize,
    y0: usize,
    width: usize,
    height: usize,
    at: Vec<u32>,
    error: Vec<u32>,
}

impl Tile {
    fn cut(field: &Field, x0: usize, y0: usize) -> Self {
        let (width, height) = (TILE.min(field.width - x0), TILE.min(field.height - y0));
        let copy = |from: &[u32]| -> Vec<u32> {
            (y0..y0 + height).flat_map(|y| from[y * field.width + x0..][..width].iter().copied()).collect()
        };
        Self { x0, y0, width, height, at: copy(&field.at), error: copy(&field.error) }
    }

    fn paste(&self, field: &mut Field) {
        for y in 0..self.height {
            let (from, to) = (y * self.width, (self.y0 + y) * field.width + self.x0);
            field.at[to..to + self.width].copy_from_slice(&self.at[from..from + self.width]);
            field.error[to..to + self.width].copy_from_slice(&self.error[from..from + self.width]);
        }
    }

    /// Searches forwards and backwards; says whether there was anything to do.
    fn search(
        &mut self,
        search: &Search,
        before: &Field,
        sweep: Sweep,
        key: u64,
        active: &(impl Fn(usize) -> bool + Sync),
    ) -> bool {
        let count = self.width * self.height;
        let mut busy = false;
        for step in 0..2 * count {
            let backwards = step >= count;
            let i = if backwards { 2 * count - 1 - step } else { step };
            let (x, y) = (self.x0 + i % self.width, self.y0 + i / self.width);
            let index = y * before.width + x;
            if self.error[i] == 0 || !active(index) {
                continue;
            }
            busy = true;
            let mut best = Best { at: self.at[i], error: self.error[i], x, y };

            // Propagation: the matches of the two neighbours just visited, moved by one.
            let d = if backwards { 1 } else { -1 };
            for (dx, dy) in [(d, 0), (0, d)] {
                if let Some(neighbour) = self.neighbour(before, x as isize + dx, y as isize + dy) {
                    let (nx, ny) = unpack(neighbour);
                    best.try_at(search, nx as isize - dx, ny as isize - dy);
                }
            }

            // Random search, on the way forwards only.
            if !backwards {
                let mut rng = Rng::new(key, &[index as u64]);
                if best.error == u32::MAX {
                    for _ in 0..sweep.fresh {
                        let members = search.allowed.members();
                        let (px, py) = unpack(members[rng.below(members.len())]);
                        best.try_at(search, px as isize, py as isize);
                    }
                }
                let mut reach = sweep.reach;
                while reach > 0 && best.at != NONE {
                    let (px, py) = unpack(best.at);
                    let (bits, span) = (rng.next_u64(), 2 * reach as u64 + 1);
                    let offset = |half: u64| ((half * span) >> 32) as isize - reach as isize;
                    best.try_at(search, px as isize + offset(bits & 0xffff_ffff), py as isize + offset(bits >> 32));
                    reach /= 2;
                }
            }
            (self.at[i], self.error[i]) = (best.at, best.error);
        }
        busy
    }

    /// The match of a patch: this tile's newest, or from outside it what was known before the sweep.
    fn neighbour(&self, before: &Field, x: isize, y: isize) -> Option<u32> {
        if x < 0 || y < 0 || x as usize >= before.width || y as usize >= before.height {
            return None;
        }
        let (x, y) = (x as usize, y as usize);
        let (tx, ty) = (x.wrapping_sub(self.x0), y.wrapping_sub(self.y0));
        let at = if tx < self.width && ty < self.height {
            self.at[ty * self.width + tx]
        } else {
            before.at[y * before.width + x]
        };
        (at != NONE).then_some(at)
    }
}

/// The best match of one patch so far.
pub(super) struct Best {
    pub at: u32,
    pub error: u32,
    pub x: usize,
    pub y: usize,
}

impl Best {
    #[inline]
    pub fn try_at(&mut self, search: &Search, px: isize, py: isize) {
        if px < 0 || py < 0 || px as usize >= search.allowed.width || py as usize >= search.allowed.height {
            return;
        }
        let (px, py) = (px as usize, py as usize);
        let at = pack(px, py);
        // A match already known costs nothing; a hint has yet to be measured.
        if (at == self.at && self.error != u32::MAX) || !search.allowed.contains(px, py) {
            return;
        }
        let error = search.distance(self.x, self.y, px, py, self.error);
        if error < self.error {
            (self.at, self.error) = (at, error);
        }
    }
}
