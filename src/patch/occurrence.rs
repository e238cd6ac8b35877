//! Counts how often each pixel of an image is used by matches, and penalises further use: Kaspar et al., "Self Tuning
//! Texture Optimization" (2015).
//!
//! The occurrence Ω of a pixel is the number of matches that contain the pixel. Under uniform usage of all allowed
//! patches, the occurrence of this pixel would be ω. The penalty of a match, added to its distance, is λ times the
//! mean of Ω / ω over its pixels. ω is computed per pixel, since fewer patches contain pixels near a border: uniform
//! usage then has the same penalty everywhere, and an identity field remains an identity.

use super::domain::Domain;
use super::field::Field;
use super::position::{NONE, unpack};
use crate::error::Result;
use crate::image::{try_collect, try_vec};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// The occurrence of every pixel of an image. A search updates it with every match that changes, and therefore runs on
/// one thread.
pub struct Occurrence {
    /// Width of the image (`width`) and of a patch (`patch`), in pixels.
    width: usize,
    patch: usize,
    /// Ω of each pixel: the number of matches that contain it.
    uses: Vec<AtomicU32>,
    /// Penalty of one use, for each pixel.
    each: Vec<f32>,
}

impl Occurrence {
    /// Counts the matches of `field` among the `allowed` patches of width `patch`. `weight` is the penalty that a
    /// match has under uniform usage, in the units of a distance.
    pub fn new(field: &Field, allowed: &Domain, patch: usize, weight: f64) -> Result<Self> {
        let (width, height) = (allowed.width + patch - 1, allowed.height + patch - 1);
        let matched = field.at.iter().filter(|&&at| at != NONE);
        let mut holders = try_vec(width * height, 0u32)?;
        for &position in allowed.members() {
            pixels(position, width, patch).for_each(|i| holders[i] += 1);
        }
        let uses_of_each = matched.clone().count().max(1) as f64 / allowed.len().max(1) as f64;
        let share = weight / (patch * patch) as f64;
        let each = holders.iter().map(|&h| (share / (f64::from(h.max(1)) * uses_of_each)) as f32);
        let uses = try_collect((0..width * height).map(|_| AtomicU32::new(0)))?;
        let occurrence = Self { width, patch, uses, each: try_collect(each)? };
        matched.for_each(|&at| occurrence.count(at, 1));
        Ok(occurrence)
    }

    /// Returns the penalty of a match at `position`.
    pub fn cost(&self, position: u32) -> u32 {
        let cost: f32 =
            pixels(position, self.width, self.patch).map(|i| self.uses[i].load(Relaxed) as f32 * self.each[i]).sum();
        // A distance stays below 2³¹, so the sum of cost and distance does not overflow.
        cost.min(i32::MAX as f32 / 2.0) as u32
    }

    /// Updates the counts when a patch changes from one match, or [`NONE`], to another.
    pub(super) fn replace(&self, from: u32, to: u32) {
        if from != NONE {
            self.count(from, u32::MAX);
        }
        self.count(to, 1);
    }

    /// Adds `times`, with wrap-around, to the uses of the pixels of a match; `u32::MAX` subtracts one use.
    fn count(&self, position: u32, times: u32) {
        pixels(position, self.width, self.patch).for_each(|i| {
            self.uses[i].fetch_add(times, Relaxed);
        });
    }
}

/// Returns the pixel indices of a patch in an image of `width` pixels per row.
fn pixels(position: u32, width: usize, patch: usize) -> impl Iterator<Item = usize> {
    let (x, y) = unpack(position);
    (y..y + patch).flat_map(move |row| row * width + x..row * width + x + patch)
}

#[cfg(test)]
mod tests {
    use super::super::position::pack;
    use super::*;

    #[test]
    fn even_usage_costs_the_same_everywhere_and_more_use_costs_more() {
        let allowed = Domain::new(9, 7, 3, None, false).unwrap();
        let identity = Field::proportional(7, 5, &allowed).unwrap();
        let occurrence = Occurrence::new(&identity, &allowed, 3, 1000.0).unwrap();
        let costs = |o: &Occurrence| allowed.members().iter().map(|&at| o.cost(at)).collect::<Vec<u32>>();
        assert!(costs(&occurrence).iter().all(|c| c.abs_diff(1000) <= 1), "{:?}", costs(&occurrence));
        // A field with twice as many patches has the same penalties under uniform usage.
        let twice = Field { width: 14, height: 5, at: [&identity.at[..]; 2].concat(), error: vec![0; 70] };
        let even = Occurrence::new(&twice, &allowed, 3, 1000.0).unwrap();
        assert!(costs(&even).iter().all(|c| c.abs_diff(1000) <= 1));
        // Move one match from the first allowed patch to the last one, and back.
        let (from, to) = (pack(0, 0), pack(6, 4));
        occurrence.replace(from, to);
        assert!(occurrence.cost(from) < 900 && occurrence.cost(to) > 1100);
        assert!(occurrence.cost(pack(3, 2)).abs_diff(1000) <= 1);
        occurrence.replace(to, from);
        assert!(costs(&occurrence).iter().all(|c| c.abs_diff(1000) <= 1));
        // Even for a huge weight, the penalty is at most 2^30.
        let heavy = Occurrence::new(&identity, &allowed, 3, 1e30).unwrap();
        assert!(heavy.cost(from) <= i32::MAX as u32 / 2 + 1);
        assert_eq!(Occurrence::new(&Field::new(3, 3).unwrap(), &allowed, 3, 1.0).unwrap().cost(from), 0);
    }
}
