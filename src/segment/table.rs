//! A table of numbers, stored in blocks of rows so that SIMD instructions work on many rows at once.

use crate::error::Result;
use crate::image::try_vec;

/// Number of rows in a block.
pub const BLOCK: usize = 32;

/// One column of a block: the values of [`BLOCK`] rows.
pub type Lanes = [f64; BLOCK];

/// A table in blocks of [`BLOCK`] rows. Each block is stored column by column; the last block is padded with rows of
/// zeros.
pub struct Table {
    lanes: Vec<Lanes>,
    pub rows: usize,
    pub columns: usize,
}

impl Table {
    /// A table of zeros.
    pub fn new(rows: usize, columns: usize) -> Result<Self> {
        Ok(Self { lanes: try_vec(rows.div_ceil(BLOCK) * columns, [0.0; BLOCK])?, rows, columns })
    }

    /// Copies rows that are stored one after the other into a table.
    pub fn of(values: &[f64], columns: usize) -> Result<Self> {
        let mut table = Self::new(values.len() / columns, columns)?;
        for (r, row) in values.chunks_exact(columns).enumerate() {
            let block = &mut table.lanes[r / BLOCK * columns..][..columns];
            block.iter_mut().zip(row).for_each(|(lanes, &v)| lanes[r % BLOCK] = v);
        }
        Ok(table)
    }

    /// Copies the rows of another table with the given indices into a new table.
    pub fn of_rows(other: &Self, rows: &[usize]) -> Result<Self> {
        let columns = other.columns;
        let mut table = Self::new(rows.len(), columns)?;
        for (to, &from) in rows.iter().enumerate() {
            let source = &other.lanes[from / BLOCK * columns..][..columns];
            let block = &mut table.lanes[to / BLOCK * columns..][..columns];
            block.iter_mut().zip(source).for_each(|(lanes, source)| lanes[to % BLOCK] = source[from % BLOCK]);
        }
        Ok(table)
    }

    /// Iterates over the blocks: the range of row indices of a block, and its columns.
    pub fn blocks(&self) -> impl Iterator<Item = (std::ops::Range<usize>, &[Lanes])> {
        let rows = |b: usize| b * BLOCK..((b + 1) * BLOCK).min(self.rows);
        self.lanes.chunks_exact(self.columns).enumerate().map(move |(b, block)| (rows(b), block))
    }

    /// Iterates over the blocks for writing: the number of rows in a block, and its columns.
    pub fn blocks_mut(&mut self) -> impl Iterator<Item = (usize, &mut [Lanes])> {
        let rows = self.rows;
        self.lanes
            .chunks_exact_mut(self.columns)
            .enumerate()
            .map(move |(b, block)| ((rows - b * BLOCK).min(BLOCK), block))
    }
}

/// The dot product of two columns of a block. Eight partial sums are added in a fixed order, so that every instruction
/// set gives the same bits.
#[inline(always)]
pub fn dot_lanes(a: &Lanes, b: &Lanes) -> f64 {
    let mut sums = [0.0; 8];
    for (a, b) in a.chunks_exact(8).zip(b.chunks_exact(8)) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// Computes `Σ w_i x_i` over the columns `i`, for every row of a block.
#[inline(always)]
pub fn combine(weights: &[f64], block: &[Lanes]) -> Lanes {
    let mut sum = [0.0; BLOCK];
    for (w, x) in weights.iter().zip(block) {
        for k in 0..BLOCK {
            sum[k] += w * x[k];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_back_from_blocks() {
        let values: Vec<f64> = (0..3 * 70).map(f64::from).collect();
        let table = Table::of(&values, 3).unwrap();
        let row = |table: &Table, r: usize| -> Vec<f64> {
            let (_, block) = table.blocks().find(|(rows, _)| rows.contains(&r)).unwrap();
            block.iter().map(|lanes| lanes[r % BLOCK]).collect()
        };
        assert!((0..70).all(|r| row(&table, r) == values[3 * r..3 * r + 3]));
        let some = Table::of_rows(&table, &[69, 3, 40]).unwrap();
        assert_eq!((row(&some, 0), row(&some, 2)), (values[207..].to_vec(), values[120..123].to_vec()));
        assert_eq!(combine(&[1.0, 10.0, 0.0], some.blocks().next().unwrap().1)[..4], [2287.0, 109.0, 1330.0, 0.0]);
    }
}
