//! Nearest patches with a penalty for usage: Kaspar et al., "Self Tuning Texture Optimization" (2015).
//!
//! The occurrence Ω of a pixel is the number of matches that contain the pixel; under uniform usage of all patches, it
//! would be ω. The penalty of a match, added to its distance, is λ times the mean of Ω / ω over its pixels, in the unit
//! of Eq. 1 of StyLit. Each match that changes changes the penalties, so the search runs on one thread.

use super::earlier::{Matcher, PATCH};
use luxfer::patch::{Domain, Field, NONE, pack, unpack};
use luxfer::rng::Rng;

/// Initial radius in pixels of the random search around a match.
const RADIUS: u64 = 64;

/// The occurrence of every exemplar pixel.
struct Occurrence {
    width: usize,
    /// Ω of each pixel.
    uses: Vec<u32>,
    /// Penalty of one use, for each pixel.
    each: Vec<f32>,
}

impl Occurrence {
    /// Counts the matches of `field`. `weight` is the penalty of a match under uniform usage.
    fn new(field: &Field, allowed: &Domain, weight: f64) -> Self {
        let (width, height) = (allowed.width + PATCH - 1, allowed.height + PATCH - 1);
        let mut holders = vec![0u32; width * height];
        allowed.members().iter().for_each(|&at| pixels(at, width).for_each(|i| holders[i] += 1));
        let uses_of_each = field.at.len() as f64 / allowed.len() as f64;
        let share = weight / (PATCH * PATCH) as f64;
        let each = holders.iter().map(|&h| (share / (f64::from(h) * uses_of_each)) as f32).collect();
        let mut uses = vec![0; width * height];
        let matched = field.at.iter().filter(|&&at| at != NONE);
        matched.for_each(|&at| pixels(at, width).for_each(|i| uses[i] += 1));
        Self { width, uses, each }
    }

    fn cost(&self, at: u32) -> u32 {
        let cost: f32 = pixels(at, self.width).map(|i| self.uses[i] as f32 * self.each[i]).sum();
        cost.min(1e9) as u32
    }

    fn replace(&mut self, from: u32, to: u32) {
        pixels(from, self.width).for_each(|i| self.uses[i] -= 1);
        pixels(to, self.width).for_each(|i| self.uses[i] += 1);
    }
}

/// The pixel indices of a patch in an image of `width` pixels per row.
fn pixels(at: u32, width: usize) -> impl Iterator<Item = usize> {
    let (x, y) = unpack(at);
    (y..y + PATCH).flat_map(move |row| row * width + x..row * width + x + PATCH)
}

/// Improves every match once by propagation and random search (PatchMatch), forwards and then backwards. All patches
/// of `field` have matches, with their distances.
pub fn rematch(matcher: &Matcher, field: &mut Field, lambda: f64, k: u64) {
    let (search, allowed) = (matcher.search(), &matcher.allowed);
    let mut occurrence = Occurrence::new(field, allowed, lambda * matcher.unit);
    let count = field.at.len();
    for step in 0..2 * count {
        let (i, d) = if step < count { (step, -1) } else { (2 * count - 1 - step, 1) };
        let (x, y) = (i % field.width, i / field.width);
        let (mut best, mut error) = (field.at[i], field.error[i]);
        let mut total = error + occurrence.cost(best);
        let mut try_at = |px: isize, py: isize, best: &mut u32| {
            if px < 0 || py < 0 || px as usize >= allowed.width || py as usize >= allowed.height {
                return;
            }
            let at = pack(px as usize, py as usize);
            let penalty = occurrence.cost(at);
            if at == *best || penalty >= total {
                return;
            }
            let distance = search.distance(x, y, px as usize, py as usize, total - penalty);
            if distance < total - penalty {
                (*best, error, total) = (at, distance, distance + penalty);
            }
        };
        // Try to continue the matches of the two neighbours already visited.
        for (dx, dy) in [(d, 0), (0, d)] {
            let (nx, ny) = (x as isize + dx, y as isize + dy);
            if nx >= 0 && ny >= 0 && (nx as usize) < field.width && (ny as usize) < field.height {
                let (px, py) = unpack(field.at[ny as usize * field.width + nx as usize]);
                try_at(px as isize - dx, py as isize - dy, &mut best);
            }
        }
        let mut rng = Rng::new(k, &[i as u64]);
        let mut radius = if step < count { RADIUS } else { 0 };
        while radius > 0 {
            let (px, py) = unpack(best);
            let span = 2 * radius as usize + 1;
            let mut offset = || rng.below(span) as isize - radius as isize;
            let (dx, dy) = (offset(), offset());
            try_at(px as isize + dx, py as isize + dy, &mut best);
            radius /= 2;
        }
        if best != field.at[i] {
            occurrence.replace(field.at[i], best);
            (field.at[i], field.error[i]) = (best, error);
        }
    }
}
