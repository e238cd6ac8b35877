//! Smooth maps without a formula, sampled at the nodes of a grid.

use crate::error::{Error, Result};
use crate::image::try_collect;
use glam::DVec2;

/// Number of cells of the grid along each side.
const CELLS: usize = 64;
/// Number of nodes along each side: the corners of the cells, and one more node beyond each border.
pub const NODES: usize = CELLS + 3;

/// A smooth map from the pixels of an image to pixels of a photo. Between the nodes of the grid, the map is a cubic
/// polynomial along each axis, through the four nearest nodes.
#[derive(Debug)]
pub struct GridMap {
    /// Size of the image in pixels.
    pub width: usize,
    pub height: usize,
    /// The values at the nodes, row by row.
    nodes: Vec<DVec2>,
}

impl GridMap {
    /// Samples the map `to_photo`, which is also evaluated up to 1/64 of the image's size outside the image.
    ///
    /// Errors: a value of the map is not finite, or memory is short.
    pub fn sample(width: usize, height: usize, to_photo: impl Fn(DVec2) -> DVec2) -> Result<Self> {
        let cell = DVec2::new(width as f64, height as f64) / CELLS as f64;
        let place = |i: usize| i as f64 - 1.0;
        let at = |i: usize| to_photo(cell * DVec2::new(place(i % NODES), place(i / NODES)));
        let nodes = try_collect((0..NODES * NODES).map(at))?;
        if nodes.iter().any(|v| !v.is_finite()) {
            return Err(Error::degenerate("a part of the image has no place in the photo"));
        }
        Ok(Self { width, height, nodes })
    }

    pub fn try_clone(&self) -> Result<Self> {
        Ok(Self { nodes: try_collect(self.nodes.iter().copied())?, ..*self })
    }

    /// Maps a pixel of the image to a pixel of the photo.
    pub fn apply(&self, p: DVec2) -> DVec2 {
        let (column, across) = weights(p.x / self.width as f64);
        (0..4).map(|i| across.value[i] * self.on_row(p.y, column + i)[0]).sum()
    }

    /// Returns the value and the derivative along y of the map on a row of the image, in the given column of nodes.
    pub fn on_row(&self, y: f64, column: usize) -> [DVec2; 2] {
        let (row, down) = weights(y / self.height as f64);
        let mut sums = [DVec2::ZERO; 2];
        for i in 0..4 {
            let node = self.nodes[(row + i) * NODES + column];
            sums[0] += down.value[i] * node;
            sums[1] += down.slope[i] / self.height as f64 * node;
        }
        sums
    }
}

/// The weights of four successive nodes.
pub struct NodeWeights {
    pub value: [f64; 4],
    /// Derivatives of `value` by the position as a share of the image's side.
    pub slope: [f64; 4],
}

/// Returns the first of the four nodes around a position, and their weights (Lagrange interpolation). `share` is the
/// position as a share of the image's side.
#[inline(always)]
pub fn weights(share: f64) -> (usize, NodeWeights) {
    let place = share * CELLS as f64;
    let first = place.clamp(0.0, (CELLS - 1) as f64) as usize;
    let t = place - first as f64;
    let (a, b, c, d) = (t + 1.0, t, t - 1.0, t - 2.0);
    let value = [b * c * d / -6.0, a * c * d / 2.0, a * b * d / -2.0, a * b * c / 6.0];
    let pairs = |p: f64, q: f64, r: f64| (p * q + q * r + r * p) * CELLS as f64;
    let slope = [pairs(b, c, d) / -6.0, pairs(a, c, d) / 2.0, pairs(a, b, d) / -2.0, pairs(a, b, c) / 6.0];
    (first, NodeWeights { value, slope })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    #[test]
    fn smooth_maps_are_interpolated_and_cubic_ones_exactly() {
        let cubic = |p: DVec2| DVec2::new(3.0 + p.x - 1e-4 * p.x.powi(3), 0.5 * p.y - 1e-2 * p.x * p.y.powi(2));
        let tilted = |p: DVec2| DVec2::new(900.0 + 4.0 * p.x, 50.0 + 6.0 * p.y) / (1.0 + 0.003 * p.x + 0.002 * p.y);
        for (limit, map) in [(1e-7, &cubic as &dyn Fn(DVec2) -> DVec2), (1e-4, &tilted)] {
            let grid = GridMap::sample(160, 120, map).unwrap();
            for k in 0..400 {
                let p = DVec2::new(0.4 * f64::from(k), 0.3 * f64::from((k * 7) % 400));
                assert!(grid.apply(p).distance(map(p)) < limit, "{p}: {} {}", grid.apply(p), map(p));
            }
        }
        let e = GridMap::sample(10, 10, |p| p / (p.x - 5.0)).unwrap_err();
        assert_eq!(e.kind, ErrorKind::Degenerate);
    }
}
