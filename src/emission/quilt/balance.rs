//! Balances the light in a texture, so that the lit share of the texture stays close to a target.
//!
//! Without balance, the amount of light and the number of missing lamps would depend on which parts of the exemplar
//! happen to match most often. So each block passes its excess of light (or its lack, as a negative excess) on to its
//! unfilled neighbours, as in error diffusion (Floyd and Steinberg 1976). A block that has received an excess prefers
//! darker patches. Every part of the texture then has about the target share of light.

use crate::error::Result;
use crate::image::try_vec;
use crate::maths;

/// Weight w of the penalty w e² / A, which is added to a patch's sum of squared differences. Here e is the excess light
/// in pixels, and A is the mean area of a lamp in pixels. One surplus or missing lamp (e = A) costs w A, as much as a
/// squared difference of w at each pixel of a lamp. The bench prints the light and the distances between lamps, with
/// and without a lattice. [bench emission]
///
/// - `ON_LATTICE`: about the squared difference of a pixel at which one patch shows a lamp and the other patch shows
///   none: up to 1 in colour, 1 in confidence, and 1 in each of the two distances.
/// - `ANYWHERE`, for patterns without a lattice: from 1/3 on, the penalty selects patches with the right amount of
///   light but wrong distances between lamps.
const ON_LATTICE: f64 = 3.0;
const ANYWHERE: f64 = 0.3;

/// The excess light of the blocks of a texture, as a number of lit pixels. Blocks are filled row by row.
pub struct Balance {
    /// For each block of the current row (`row`) and of the next row (`below`), the excess light that earlier blocks
    /// have passed on to it.
    row: Vec<f64>,
    below: Vec<f64>,
    /// The column of the current block.
    column: usize,
    /// Mean area of a lamp in pixels (`lamp`), and weight of one surplus or missing lamp (`weight`).
    lamp: f64,
    weight: f64,
}

impl Balance {
    pub fn new(columns: usize, lamp: f64, is_lattice: bool) -> Result<Self> {
        let weight = if is_lattice { ON_LATTICE } else { ANYWHERE };
        Ok(Self { row: try_vec(columns, 0.0)?, below: try_vec(columns, 0.0)?, column: 0, lamp, weight })
    }

    /// Makes the first block of the next row the current block.
    pub fn begin_row(&mut self) {
        std::mem::swap(&mut self.row, &mut self.below);
        self.below.fill(0.0);
        self.column = 0;
    }

    /// Adds `excess` lit pixels to the excess of the current block. `excess` is the number of lit pixels that a patch
    /// adds, minus the target number ([`Comparison::excess`](super::comparison::Comparison::excess)).
    pub fn add(&mut self, excess: f64) {
        self.row[self.column] += excess;
    }

    /// The penalty for a patch that adds `excess` lit pixels to the excess that the current block has so far. It has
    /// the unit of a sum of squared differences over pixels.
    pub fn penalty(&self, excess: f64) -> f64 {
        self.weight * maths::powi(self.row[self.column] + excess, 2) / self.lamp
    }

    /// Passes the excess of the current block on to its neighbours, and makes the next block the current one. The
    /// weights follow Floyd and Steinberg: 7/16 to the right, 3/16, 5/16 and 1/16 below. At the sides of the texture,
    /// the weights of missing neighbours are added to the weight of the block below, so that no excess is lost.
    pub fn pass_on(&mut self) {
        let (column, excess) = (self.column, self.row[self.column] / 16.0);
        let (has_left, has_right) = (column > 0, column + 1 < self.row.len());
        let mut straight = 5.0;
        if has_left {
            self.below[column - 1] += 3.0 * excess;
        } else {
            straight += 3.0;
        }
        if has_right {
            self.row[column + 1] += 7.0 * excess;
            self.below[column + 1] += excess;
        } else {
            straight += 8.0;
        }
        self.below[column] += straight * excess;
        self.column = column + 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn what_is_too_much_is_passed_on_and_nothing_of_it_lost() {
        for columns in [1, 2, 5] {
            let mut balance = Balance::new(columns, 1.0, true).unwrap();
            let (mut rng, mut all) = (Rng::new(4, &[]), 0.0);
            for _ in 0..7 {
                balance.begin_row();
                for _ in 0..columns {
                    let excess = rng.next_f64() - 0.3;
                    balance.add(excess);
                    all += excess;
                    balance.pass_on();
                }
                assert!((balance.below.iter().sum::<f64>() - all).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn choosing_the_least_penalty_keeps_every_part_at_its_share() {
        // Each block has one lamp of ten pixels or none. Three of four blocks should have a lamp.
        let (columns, rows, lamp) = (24, 20, 10.0);
        let mut balance = Balance::new(columns, lamp, true).unwrap();
        let mut lamps = vec![0.0; columns * rows];
        for row in lamps.chunks_exact_mut(columns) {
            balance.begin_row();
            for has_lamp in row {
                let [none, one] = [-0.75 * lamp, 0.25 * lamp];
                *has_lamp = f64::from(u8::from(balance.penalty(one) < balance.penalty(none)));
                balance.add(if *has_lamp > 0.0 { one } else { none });
                balance.pass_on();
            }
        }
        for (x, y) in [(0, 0), (5, 3), (12, 8), (16, 12)] {
            let part: f64 = (y..y + 8).map(|v| lamps[v * columns + x..][..8].iter().sum::<f64>()).sum();
            assert!((part / 64.0 - 0.75).abs() < 0.07, "{x} {y}: {part}");
        }
    }
}
