//! Summed-area table: sums over rectangles of an image in constant time (Crow 1984).

use crate::error::Result;
use crate::image::try_vec;

/// A summed-area table of a mask or of integers.
pub struct AreaSums {
    width: usize,
    sums: Vec<u32>,
}

impl AreaSums {
    pub fn new(mask: impl Fn(usize) -> bool, width: usize, height: usize) -> Result<Self> {
        Self::of(|i| u32::from(mask(i)), width, height)
    }

    /// A table of the integers that `value` gives for each pixel index. Running sums may wrap around; a rectangle's
    /// sum is correct as long as it is below 2³².
    pub fn of(value: impl Fn(usize) -> u32, width: usize, height: usize) -> Result<Self> {
        let stride = width + 1;
        let mut sums = try_vec(stride * (height + 1), 0u32)?;
        for y in 0..height {
            let mut row = 0u32;
            for x in 0..width {
                row = row.wrapping_add(value(y * width + x));
                sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1].wrapping_add(row);
            }
        }
        Ok(Self { width: stride, sums })
    }

    /// The number of set pixels, or the sum of the values, in `[x, x + w) × [y, y + h)`.
    pub fn count(&self, x: usize, y: usize, w: usize, h: usize) -> usize {
        let at = |x: usize, y: usize| self.sums[y * self.width + x];
        let rows = |x: usize| at(x, y + h).wrapping_sub(at(x, y));
        rows(x + w).wrapping_sub(rows(x)) as usize
    }
}
