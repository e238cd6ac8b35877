//! Canny's edge detection (1986): thin edges at the maxima of the gradient magnitude, then hysteresis.

use super::gradient::Gradients;
use crate::error::Result;
use crate::image::{try_collect, try_push, try_vec};
use crate::job::Job;

/// Hysteresis thresholds of the gradient magnitude, in encoded luma per pixel: every pixel of an edge must reach
/// `WEAK`, and at least one pixel of each edge must reach `STRONG`. Their ratio is between two and three, as Canny
/// recommends. Only the Hough transform uses these edges. The bench prints the accuracy of the vanishing points from
/// Hough lines. [bench vp]
const WEAK: f32 = 0.015;
const STRONG: f32 = 0.04;

/// Returns the indices of the edge pixels in ascending order.
pub fn edges(gradients: &Gradients, job: Job) -> Result<Vec<u32>> {
    let Gradients { width, height, derivative, magnitude } = gradients;
    let (width, height) = (*width, *height);
    const NONE: u8 = 0;
    const CANDIDATE: u8 = 1;
    const EDGE: u8 = 2;
    let mut state = try_vec(width * height, NONE)?;
    let mut pending: Vec<u32> = Vec::new();

    // Non-maximum suppression: keep a pixel if its gradient magnitude exceeds the magnitudes on both sides of it along
    // the gradient, each interpolated between two neighbours.
    for y in 1..height.saturating_sub(1) {
        job.check()?;
        for x in 1..width.saturating_sub(1) {
            let i = y * width + x;
            let m = magnitude[i];
            if m < WEAK {
                continue;
            }
            let [dx, dy] = derivative[i];
            let (along, across, t) = if dx.abs() >= dy.abs() {
                (1isize, width as isize, dy / dx)
            } else {
                (width as isize, 1isize, dx / dy)
            };
            let at = |offset: isize| magnitude[(i as isize + offset) as usize];
            let side = if t >= 0.0 { across } else { -across };
            let t = t.abs();
            let ahead = at(along) * (1.0 - t) + at(along + side) * t;
            let behind = at(-along) * (1.0 - t) + at(-along - side) * t;
            if m > ahead && m >= behind {
                state[i] = CANDIDATE;
                if m >= STRONG {
                    state[i] = EDGE;
                    try_push(&mut pending, i as u32)?;
                }
            }
        }
    }
    // Hysteresis: candidates connected to an edge pixel are edge pixels too.
    while let Some(i) = pending.pop() {
        let (x, y) = (i as usize % width, i as usize / width);
        for ny in y - 1..=y + 1 {
            for nx in x - 1..=x + 1 {
                let n = ny * width + nx;
                if state[n] == CANDIDATE {
                    state[n] = EDGE;
                    try_push(&mut pending, n as u32)?;
                }
            }
        }
    }
    try_collect((0..state.len() as u32).filter(|&i| state[i as usize] == EDGE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::job::Monitor;
    use crate::rectify::gradient::gradients;

    #[test]
    fn a_step_has_one_edge_pixel_per_row() {
        let monitor = Monitor::default();
        let luma = Image::from_fn(40, 30, |x, _| [if x < 20 { 0.2 } else { 0.7 }]).unwrap();
        let found = edges(&gradients(&luma, monitor.job()).unwrap(), monitor.job()).unwrap();
        for y in 2..28 {
            let row: Vec<u32> = found.iter().filter(|&&i| i / 40 == y).map(|i| i % 40).collect();
            assert!(row == [19] || row == [20], "{row:?}");
        }
        let flat = Image::from_fn(1, 9, |_, y| [y as f32]).unwrap();
        assert!(edges(&gradients(&flat, monitor.job()).unwrap(), monitor.job()).unwrap().is_empty());
    }
}
