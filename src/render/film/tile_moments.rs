//! Estimates the mean and the variance of the radiance of every tile of an image, from a few paths. The pilot run
//! selects its tiles by these values.

use super::grid::{Grid, TILE};
use super::prepass::Prepass;
use crate::error::Result;
use crate::exec;
use crate::job::Job;

/// Largest number of paths of all tiles together, a limit on the work. In large images, each tile gets fewer paths to
/// meet this limit, but at least `MIN_ALONG` × `MIN_ALONG` paths. The pilot's predictions are unbiased for any number
/// of paths. [convention]
const MAX_TOTAL_PATHS: usize = 1 << 17;
/// Largest and smallest number of paths along each side of a tile. Both are powers of two, as is the side of a tile.
const MAX_ALONG: usize = TILE;
const MIN_ALONG: usize = 2;

/// Moments of a tile's radiance, which is averaged over the channels.
#[derive(Clone, Copy)]
pub struct TileMoments {
    /// Mean radiance.
    pub mean: f64,
    /// Variance of the radiance of single paths.
    pub variance: f64,
}

/// Estimates the moments of all tiles.
pub fn tile_moments(prepass: &Prepass, grid: Grid, job: Job) -> Result<Vec<TileMoments>> {
    let mut along = MAX_ALONG;
    while along > MIN_ALONG && grid.tiles() * along * along > MAX_TOTAL_PATHS {
        along /= 2;
    }
    exec::map(grid.tiles(), job, |tile| TileMoments::of(prepass, grid, tile, along))
}

impl TileMoments {
    /// Divides a tile into `along` × `along` squares and traces one path through one pixel of each square. The
    /// position of the pixel in its square varies from square to square. Beyond the image, the nearest pixel of the
    /// image is used.
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
