//! Finds the best quadrilateral around a plane's mask (§5.3). Its sides run to the vanishing points of the plane's two
//! axes, so it is a rectangle in plane coordinates. It lies on the camera's side of the horizon. Far parts of the
//! plane, which would have to be magnified too much, do not count as part of the mask.

use super::plane::Plane;
use crate::error::{Error, Result};
use crate::image::{Image, try_collect};
use glam::DVec2;

/// Number of grid cells along each side of the area in which the rectangle is searched for.
const GRID: usize = 96;
/// Cost of a cell outside the mask relative to the gain of a cell inside it. The cost is low because later stages
/// ignore holes, whereas a lamp at the rim is lost if the rim is cut off. [bench emission:real]
const HOLE: f64 = 0.25;

/// A rectangle in plane coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    pub low: DVec2,
    pub high: DVec2,
    /// Side, in plane units, of the square that a photo pixel covers on the best-resolved part of the plane (the 2 %
    /// quantile over the pixels of the mask).
    pub finest_pixel_side: f64,
}

/// Finds the rectangle with the highest score: the number of its cells that the mask marks and whose magnification is
/// allowed, minus `HOLE` times the number of its other cells. `max_magnification` is relative to the best-resolved part
/// of the plane.
pub fn largest(plane: &Plane, mask: &Image, pixels: &[DVec2], max_magnification: f64) -> Result<Rectangle> {
    // Keep the pixels on the camera's side of the horizon, each with the size of the square that it covers on the
    // plane.
    let mut seen = try_collect(pixels.iter().filter_map(|&p| plane.meet(p).map(|q| (plane.pixel_side(p), q))))?;
    if seen.is_empty() {
        return Err(Error::degenerate("the mask lies beyond the plane's horizon: choose other axes"));
    }
    seen.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let finest_pixel_side = seen[seen.len() / 50].0;
    let max_pixel_side = finest_pixel_side * max_magnification;
    seen.truncate(seen.partition_point(|s| s.0 <= max_pixel_side).max(1));
    // Widen the bounding box by half of the finest pixel side, since only pixel centres were counted.
    let rim = DVec2::splat(finest_pixel_side / 2.0);
    let (low, high) =
        seen.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), (_, q)| (low.min(*q), high.max(*q)));
    let (low, high) = (low - rim, high + rim);

    // Score each cell: +1 if the mask marks it and its magnification is allowed, else `-HOLE`. Exclude cells behind
    // the camera by a large negative score.
    let cell = (high - low) / GRID as f64;
    let (homography, lens) = (plane.homography(), plane.perspective.lens());
    let mut gain = vec![[0.0f64; GRID]; GRID];
    for (y, row) in gain.iter_mut().enumerate() {
        for (x, gain) in row.iter_mut().enumerate() {
            let corner =
                |dx: f64, dy: f64| homography.apply_homogeneous(low + cell * DVec2::new(x as f64 + dx, y as f64 + dy));
            let in_front = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].iter().all(|c| corner(c.0, c.1).z > 1e-6);
            let centre = corner(0.5, 0.5);
            let photo = lens.shown(centre.truncate() / centre.z);
            let shows = in_front && marks(mask, photo) && plane.pixel_side(photo) <= max_pixel_side;
            *gain = if shows {
                1.0
            } else if in_front {
                -HOLE
            } else {
                -1e9
            };
        }
    }
    let ([x0, y0], [x1, y1]) = max_sum_block(&gain);
    let at = |x: usize, y: usize| low + cell * DVec2::new(x as f64, y as f64);
    Ok(Rectangle { low: at(x0, y0), high: at(x1, y1), finest_pixel_side })
}

/// Whether the mask marks the pixel at a position of the photo.
pub fn marks(mask: &Image, p: DVec2) -> bool {
    p.x >= 0.0 && p.y >= 0.0 && p.x <= mask.width as f64 && p.y <= mask.height as f64 && mask.sample(p.x, p.y, 0) >= 0.5
}

/// Finds the block of cells with the greatest sum of gains (Kadane's algorithm over every range of rows). Returns its
/// first cell and the cell past its last.
fn max_sum_block(gain: &[[f64; GRID]]) -> ([usize; 2], [usize; 2]) {
    let mut best = (f64::NEG_INFINITY, [0, 0], [GRID, GRID]);
    for top in 0..GRID {
        let mut sums = [0.0; GRID];
        for bottom in top..GRID {
            let (mut run, mut start) = (0.0, 0);
            for x in 0..GRID {
                sums[x] += gain[bottom][x];
                if run <= 0.0 {
                    (run, start) = (0.0, x);
                }
                run += sums[x];
                if run > best.0 {
                    best = (run, [start, top], [x + 1, bottom + 1]);
                }
            }
        }
    }
    (best.1, best.2)
}
