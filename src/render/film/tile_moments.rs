//! A first look at all tiles of an image, with few paths, to tell how bright each is and how much its light varies.

use super::grid::{Grid, TILE};
use super::prepass::Prepass;
use crate::error::Result;
use crate::exec;
use crate::job::Job;

/// Paths of all tiles together, where tiles have more than [`MIN_ALONG`].
const MAX_TOTAL_PATHS: usize = 1 << 17;
/// Most and fewest paths of a tile along each side: powers of two, as the side is.
const MAX_ALONG: usize = TILE;
const MIN_ALONG: usize = 2;

/// What a tile shows at first sight, averaged over the channels.
#[derive(Clone, Copy)]
pub struct TileMoments {
    /// Mean radiance.
    pub mean: f64,
    /// Variance of the radiance of its paths.
    pub variance: f64,
}

/// Of all tiles.
pub fn tile_moments(prepass: &Prepass, grid: Grid, job: Job) -> Result<Vec<TileMoments>> {
    let mut along = MAX_ALONG;
    while along > MIN_ALONG && grid.tiles() * along * along > MAX_TOTAL_PATHS {
        along /= 2;
    }
    exec::map(grid.tiles(), job, |tile| TileMoments::of(prepass, grid, tile, along))
}

impl TileMoments {
    /// One path in each of `along` by `along` squares of the tile, at another place in each of its rows.
    fn of(prepass: &Prepass, grid: Grid, tile: usize, along: usize) -> Self {
        let (left, top) = grid.corner(tile);
        let (mut sum, mut squares) = (0.0, 0.0);
        let side = TILE / along;
        for i in 0..along * along {
            let (column, row) = (i % along, i / along);
            let (x, y) = (column * side + (row + column) % side, row * side + column % side);
            let at = [(left + x).min(grid.width - 1), (top + y).min(grid.height - 1)];
            let radiance = prepass.sample_pixel(at, 1).mean().element_sum() / 3.0;
            (sum, squares) = (sum + radiance, squares + radiance * radiance);
        }
        let count = (along * along) as f64;
        let mean = sum / count;
        Self { mean, variance: (squares / count - mean * mean).max(0.0) }
    }
}
