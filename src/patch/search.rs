//! PatchMatch (Barnes et al. 2009): propagation and random search, with results independent of the number of threads.
//!
//! The query image is divided into fixed tiles. An iteration visits the patches of each tile forwards and then
//! backwards. A patch sees the current matches of its own tile. Of other tiles, it sees the matches from before the
//! iteration, because all tiles are written back at the end.

use super::domain::Domain;
use super::field::Field;
use super::kernel::{Kernel, Patch};
use super::position::{NONE, pack, unpack};
use super::quantised::QuantisedImage;
use crate::error::Result;
use crate::exec;
use crate::job::Job;
use crate::rng::{Rng, hash};

/// Number of patches along the side of a tile: with 16 channels, a tile and its matches fit into a second-level cache.
const TILE: usize = 48;

/// The search for matches of patches of `query` among patches of `base`.
#[derive(Clone, Copy)]
pub struct Search<'a> {
    pub query: &'a QuantisedImage,
    pub base: &'a QuantisedImage,
    /// Patches of `base` that may be matches.
    pub allowed: &'a Domain,
    /// Width of a patch in pixels.
    pub patch: usize,
    pub kernel: Kernel,
    pub seed: u64,
}

/// Parameters of an iteration of propagation and random search.
#[derive(Clone, Copy, Debug)]
pub struct SearchIteration {
    /// Index of this iteration, which seeds its random numbers.
    pub index: u64,
    /// Initial radius in pixels of the random search around the best match; halved until it is 0.
    pub radius: usize,
    /// Number of uniformly random candidates for a patch without a match of known distance.
    pub initial_samples: usize,
}

impl Search<'_> {
    /// Returns the distance between the patch of the query at (`x`, `y`) and the patch of the base at (`match_x`,
    /// `match_y`). Stops early if the distance reaches `limit`; the result is then at least `limit`.
    #[inline]
    pub fn distance(&self, x: usize, y: usize, match_x: usize, match_y: usize, limit: u32) -> u32 {
        fn at(image: &QuantisedImage, x: usize, y: usize) -> Patch<'_> {
            Patch { samples: &image.data[(y * image.width + x) * image.lanes..], row_len: image.row_len() }
        }
        let run = self.patch * self.query.lanes;
        self.kernel.distance(at(self.query, x, y), at(self.base, match_x, match_y), run, self.patch, limit)
    }

    /// Recomputes the distances of the patches for which `wanted` holds. A patch without an allowed match gets
    /// `u32::MAX`.
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

    /// Compares every active patch with every allowed patch. This is meant for images of at most a few thousand
    /// pixels.
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

    /// Improves the matches of the patches for which `active` holds, by propagation and random search. A match is
    /// replaced only by a closer one.
    pub fn iterate(
        &self,
        field: &mut Field,
        iteration: SearchIteration,
        job: Job,
        active: impl Fn(usize) -> bool + Sync,
    ) -> Result<()> {
        if self.allowed.is_empty() {
            return job.check();
        }
        let (columns, rows) = (field.width.div_ceil(TILE), field.height.div_ceil(TILE));
        let key = hash(self.seed, &[iteration.index]);
        let tiles = exec::map(columns * rows, job, |t| {
            let mut tile = FieldTile::cut(field, t % columns * TILE, t / columns * TILE);
            tile.search(self, field, iteration, key, &active).then_some(tile)
        })?;
        tiles.into_iter().flatten().for_each(|tile| tile.paste(field));
        Ok(())
    }
}

impl Search<'_> {
    /// Lets each active patch continue a neighbour's match if that lowers the patch's cost. The cost is the distance,
    /// plus `seam` for each of the four neighbours whose match the patch does not continue. Runs one forward and one
    /// backward round of iterated conditional modes (Besag 1986). No other matches are tried, and the sum of distances
    /// and seams of a tile never rises.
    pub fn join(&self, field: &mut Field, seam: u32, job: Job, active: impl Fn(usize) -> bool + Sync) -> Result<()> {
        let (columns, rows) = (field.width.div_ceil(TILE), field.height.div_ceil(TILE));
        let tiles = exec::map(columns * rows, job, |t| {
            let mut tile = FieldTile::cut(field, t % columns * TILE, t / columns * TILE);
            tile.join(self, field, seam, &active).then_some(tile)
        })?;
        tiles.into_iter().flatten().for_each(|tile| tile.paste(field));
        Ok(())
    }
}

/// A copy of a rectangular part of the field.
struct FieldTile {
    x0: usize,
    y0: usize,
    width: usize,
    height: usize,
    at: Vec<u32>,
    error: Vec<u32>,
}

impl FieldTile {
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

    /// Runs an iteration over the active patches of this tile, forwards and then backwards. Patches whose
    /// distance is 0 are skipped. Returns whether any patch needed a search.
    fn search(
        &mut self,
        search: &Search,
        before: &Field,
        iteration: SearchIteration,
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

            // Propagation: try the matches of the two neighbours already visited in this direction, shifted by one.
            let d = if backwards { 1 } else { -1 };
            for (dx, dy) in [(d, 0), (0, d)] {
                if let Some(neighbour) = self.neighbour(before, x as isize + dx, y as isize + dy) {
                    let (nx, ny) = unpack(neighbour);
                    best.try_at(search, nx as isize - dx, ny as isize - dy);
                }
            }

            // Random search, in the forward direction only.
            if !backwards {
                best.search_randomly(search, iteration, Rng::new(key, &[index as u64]));
            }
            (self.at[i], self.error[i]) = (best.at, best.error);
        }
        busy
    }

    /// Runs [`Search::join`] on this tile, forwards and then backwards. Returns whether any match changed.
    fn join(&mut self, search: &Search, before: &Field, seam: u32, active: &(impl Fn(usize) -> bool + Sync)) -> bool {
        let count = self.width * self.height;
        let mut changed = false;
        for step in 0..2 * count {
            let i = if step < count { step } else { 2 * count - 1 - step };
            let (x, y) = (self.x0 + i % self.width, self.y0 + i / self.width);
            // For each neighbour, the match of this patch that would continue the neighbour's match.
            let around = [(-1, 0), (1, 0), (0, -1), (0, 1)].map(|(dx, dy)| {
                let at = self.neighbour(before, x as isize + dx, y as isize + dy)?;
                let (px, py) = unpack(at);
                let (px, py) = (px as isize - dx, py as isize - dy);
                let inside =
                    px >= 0 && py >= 0 && (px as usize) < search.allowed.width && (py as usize) < search.allowed.height;
                inside.then(|| pack(px as usize, py as usize))
            });
            let seams = |at: u32| around.iter().filter(|&&a| a != Some(at)).count() as u64 * u64::from(seam);
            let own = self.at[i];
            let measured = self.error[i] != u32::MAX;
            let joined = measured && around.iter().all(|&a| a.is_none() || a == Some(own));
            if joined || !active(y * before.width + x) {
                continue;
            }
            let (mut best, mut error) = (own, self.error[i]);
            let mut cost = u64::from(error) + seams(own);
            for at in around.into_iter().flatten() {
                let (px, py) = unpack(at);
                let fixed = seams(at);
                if (at == best && measured) || fixed >= cost || !search.allowed.contains(px, py) {
                    continue;
                }
                let limit = (cost - fixed).min(u64::from(u32::MAX)) as u32;
                let distance = search.distance(x, y, px, py, limit);
                if distance < limit {
                    (best, error, cost) = (at, distance, u64::from(distance) + fixed);
                }
            }
            if error != self.error[i] || best != own {
                (self.at[i], self.error[i]) = (best, error);
                changed = true;
            }
        }
        changed
    }

    /// Returns the match of a patch: inside this tile the current match, outside it the match from before the
    /// iteration.
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

/// The best match so far of the patch at (`x`, `y`), and its distance `error`; `u32::MAX` marks a hint, or no match.
pub(super) struct Best {
    pub at: u32,
    pub error: u32,
    pub x: usize,
    pub y: usize,
}

impl Best {
    /// Tries uniformly random positions if no match has a known distance yet. Then tries random positions around the
    /// best match, within decreasing radii.
    #[inline(always)]
    fn search_randomly(&mut self, search: &Search, iteration: SearchIteration, mut rng: Rng) {
        if self.error == u32::MAX {
            for _ in 0..iteration.initial_samples {
                let members = search.allowed.members();
                let (px, py) = unpack(members[rng.below(members.len())]);
                self.try_at(search, px as isize, py as isize);
            }
        }
        let mut radius = iteration.radius;
        while radius > 0 && self.at != NONE {
            let (px, py) = unpack(self.at);
            let (bits, span) = (rng.next_u64(), 2 * radius as u64 + 1);
            let offset = |half: u64| ((half * span) >> 32) as isize - radius as isize;
            self.try_at(search, px as isize + offset(bits & 0xffff_ffff), py as isize + offset(bits >> 32));
            radius /= 2;
        }
    }

    #[inline]
    pub fn try_at(&mut self, search: &Search, px: isize, py: isize) {
        if px < 0 || py < 0 || px as usize >= search.allowed.width || py as usize >= search.allowed.height {
            return;
        }
        let (px, py) = (px as usize, py as usize);
        let at = pack(px, py);
        // Skip the current match if its distance is known. (The distance of a hint is not.) Skip positions that are not
        // allowed.
        if (at == self.at && self.error != u32::MAX) || self.error == 0 || !search.allowed.contains(px, py) {
            return;
        }
        let error = search.distance(self.x, self.y, px, py, self.error);
        if error < self.error {
            (self.at, self.error) = (at, error);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Quantiser;
    use super::*;
    use crate::image::Image;
    use crate::job::Monitor;

    fn noise(width: usize, height: usize) -> QuantisedImage {
        let image = Image::from_fn(width, height, |x, y| [Rng::new(4, &[x as u64, y as u64]).next_f32()]);
        let mut out = QuantisedImage::new(width, height, 1).unwrap();
        out.fill(0, &Quantiser::for_weights(&[1.0], 5), &image.unwrap(), Monitor::default().job()).unwrap();
        out
    }

    #[test]
    fn joining_corrects_outliers_lowers_the_cost_and_keeps_good_matches() {
        let (query, base) = (noise(70, 60), noise(70, 60));
        let allowed = Domain::new(70, 60, 5, None, false).unwrap();
        let search =
            Search { query: &query, base: &base, allowed: &allowed, patch: 5, kernel: Kernel::detect(), seed: 1 };
        let monitor = Monitor::default();
        let truth = {
            let mut field = Field::proportional(66, 56, &allowed).unwrap();
            search.rescore(&mut field, monitor.job(), |_| true).unwrap();
            field
        };
        let mut field = truth.clone();
        search.join(&mut field, 1000, monitor.job(), |_| true).unwrap();
        assert_eq!(field, truth);

        // Corrupt every third match.
        (0..field.at.len()).step_by(3).for_each(|i| field.at[i] = pack(i * 7 % 66, i * 5 % 56));
        search.rescore(&mut field, monitor.job(), |_| true).unwrap();
        let seams = |f: &Field| {
            let open = |i: usize, step: usize, one: u32| u32::from(f.at[i + step] != f.at[i].wrapping_add(one));
            let along = (0..f.at.len()).filter(|i| i % 66 != 65).map(|i| open(i, 1, pack(1, 0))).sum::<u32>();
            along + (0..f.at.len() - 66).map(|i| open(i, 66, pack(0, 1))).sum::<u32>()
        };
        let seam = (field.energy() / field.at.len() as f64) as u32;
        let cost = |f: &Field| f.energy() + 2.0 * f64::from(seam) * f64::from(seams(f));
        for active in [3, 2, 1] {
            let before = field.clone();
            search.join(&mut field, seam, monitor.job(), |i| i % active == 0).unwrap();
            assert!(cost(&field) <= cost(&before) && seams(&field) <= seams(&before));
            assert!((0..field.at.len()).all(|i| i % active == 0 || field.at[i] == before.at[i]));
        }
        assert_eq!(field, truth);
    }
}
