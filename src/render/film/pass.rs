//! One pass over the image: how many paths each pixel has after it.

use super::grid::TILE;
use crate::error::Result;
use crate::image::try_vec;

/// The number of paths that each pixel has after a pass.
pub struct Pass {
    /// For each tile: number of paths of each pixel that the pass covers.
    pub(super) counts: Vec<u32>,
    /// The pass covers only pixels whose column and row are multiples of this power of two.
    pub(super) stride: usize,
}

impl Pass {
    /// Returns a pass after which every pixel has `count` paths.
    pub fn uniform(tiles: usize, count: u32) -> Result<Self> {
        Ok(Self { counts: try_vec(tiles, count)?, stride: 1 })
    }

    pub fn count(&self, tile: usize, x: usize, y: usize) -> u32 {
        if (x | y) & (self.stride - 1) == 0 { self.counts[tile] } else { 0 }
    }

    /// Whether the pass covers all pixels.
    pub fn is_dense(&self) -> bool {
        self.stride == 1
    }

    /// Whether the pass covers no pixel of the tile whose first pixel is given. A pass with a stride of [`TILE`] or
    /// more covers at most the first pixel of a tile.
    pub fn skips_tile(&self, (left, top): (usize, usize)) -> bool {
        self.stride >= TILE && (left | top) & (self.stride - 1) != 0
    }

    /// Returns the mean number of paths per pixel of a tile after the pass; pixels that the pass does not cover count
    /// with 0 paths. If the stride is larger than [`TILE`], the mean is not taken over the tile itself, but over a
    /// square of stride × stride pixels.
    pub fn per_pixel(&self, tile: usize) -> f64 {
        f64::from(self.counts[tile]) / (self.stride * self.stride) as f64
    }
}
