//! The division of an image into tiles, which determines the storage order of pixels.

use crate::error::Result;
use crate::image::try_collect;

/// Side of a tile in pixels. A tile is the unit of work and of adaptive sampling.
pub const TILE: usize = 8;
/// Number of pixels in a tile.
pub const AREA: usize = TILE * TILE;

/// Largest number of pixels in the coarsest image of a progressive render. The number determines only which pixels get
/// their first path first: the finished image has the same expected value for any number. [convention]
const COARSE_PIXELS: usize = 1024;

/// An image divided into tiles, row by row. The tiles of the last column and row may extend beyond the image.
#[derive(Clone, Copy)]
pub struct Grid {
    pub width: usize,
    pub height: usize,
}

impl Grid {
    pub fn across(&self) -> usize {
        self.width.div_ceil(TILE)
    }

    pub fn down(&self) -> usize {
        self.height.div_ceil(TILE)
    }

    pub fn tiles(&self) -> usize {
        self.across() * self.down()
    }

    /// Returns the column and row of a tile's first pixel.
    pub fn corner(&self, tile: usize) -> (usize, usize) {
        (tile % self.across() * TILE, tile / self.across() * TILE)
    }

    /// Returns the column and row, in the image, of pixel number `pixel` of a tile; `None` outside the image.
    pub fn place(&self, tile: usize, pixel: usize) -> Option<(usize, usize)> {
        let (left, top) = self.corner(tile);
        let (x, y) = (left + pixel % TILE, top + pixel / TILE);
        (x < self.width && y < self.height).then_some((x, y))
    }

    /// Returns the index of the tile that contains a pixel, and the index of the pixel within the tile.
    pub fn locate(&self, x: usize, y: usize) -> (usize, usize) {
        (y / TILE * self.across() + x / TILE, y % TILE * TILE + x % TILE)
    }

    /// Returns the number of pixels of a tile that lie within the image.
    pub fn area(&self, tile: usize) -> usize {
        let part = |at: usize, size: usize| TILE.min(size - at * TILE);
        part(tile % self.across(), self.width) * part(tile / self.across(), self.height)
    }

    /// Returns for each tile the larger of its own value and the mean value of the tiles in its 3 × 3 neighbourhood.
    pub fn max_with_neighbourhood_mean(&self, values: &[f64]) -> Result<Vec<f64>> {
        let (across, down) = (self.across(), self.down());
        let around = |i: usize, n: usize| i.saturating_sub(1)..(i + 2).min(n);
        let at = |tile: usize| {
            let (columns, rows) = (around(tile % across, across), around(tile / across, down));
            let count = columns.len() * rows.len();
            let sum: f64 = rows.flat_map(|y| columns.clone().map(move |x| values[y * across + x])).sum();
            values[tile].max(sum / count as f64)
        };
        try_collect((0..values.len()).map(at))
    }
}

/// Returns the pixel stride of the coarsest pass, along each axis: the smallest power of two for which the pass covers
/// at most [`COARSE_PIXELS`] pixels.
pub fn coarse_stride(width: usize, height: usize) -> usize {
    let mut stride = 1;
    while width.div_ceil(stride) * height.div_ceil(stride) > COARSE_PIXELS {
        stride *= 2;
    }
    stride
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_has_one_place() {
        for (width, height) in [(1, 1), (8, 8), (17, 9), (3, 40)] {
            let grid = Grid { width, height };
            let mut seen = vec![0; width * height];
            for tile in 0..grid.tiles() {
                let places: Vec<_> = (0..AREA).filter_map(|i| grid.place(tile, i).map(|p| (i, p))).collect();
                assert_eq!(places.len(), grid.area(tile));
                for (i, (x, y)) in places {
                    assert_eq!(grid.locate(x, y), (tile, i));
                    seen[y * width + x] += 1;
                }
            }
            assert!(seen.iter().all(|&n| n == 1));
        }
    }

    #[test]
    fn the_need_of_a_tile_depends_on_its_neighbours_only() {
        let grid = Grid { width: 4 * TILE, height: 3 * TILE };
        let mut values = vec![0.0; grid.tiles()];
        values[0] = 12.0;
        let heeded = grid.max_with_neighbourhood_mean(&values).unwrap();
        assert_eq!(heeded[..6], [12.0, 2.0, 0.0, 0.0, 2.0, 12.0 / 9.0]);
        assert!(heeded[6..].iter().all(|&v| v == 0.0));
    }
}
