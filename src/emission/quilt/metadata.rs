//! The three metadata channels of a pixel: the confidence that it is light, and its signed x and y distance to the
//! nearest light ("Lighting Style Transfer", §6 and Fig. 12b; after Lefebvre and Hoppe 2006). In the dark space between
//! lamps, where colours are all equal, the distances tell patches apart.
//!
//! The paper does not say whether "horizontal and vertical distance" are measured to the nearest lamp in the pixel's
//! row and column, or to the nearest lamp in the plane. Here, they are the components of the offset from the pixel to
//! the *nearest lit pixel* in the plane. The reasons:
//!
//! - The x and the y distance of a pixel always belong to the same lamp.
//! - They vary continuously, except at the bisectors between lamps.
//! - They also exist in rows and columns without light.

use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_vec};
use crate::job::Job;
use crate::maths;

/// Value in place of the index of the nearest lit pixel, or of the nearest lit row of a column, if there is none.
const NONE: u32 = u32::MAX;

/// Computes the metadata of each pixel of a `width` × `height` image. Channel 0 is the confidence. Channels 1 and 2 are
/// the x and y offset to the nearest lit pixel, divided by `cap` pixels and clamped to [-1, 1]; both are 1 if there is
/// no light at all. The values -1 and 1 mean the same: no light is near.
pub fn compute(
    confidence: &[f32],
    is_lit: impl Fn(usize) -> bool,
    width: usize,
    height: usize,
    cap: f64,
    job: Job,
) -> Result<Image> {
    let nearest = nearest_feature(is_lit, width, height, job)?;
    let mut out = Image::new(width, height, 3)?;
    for (i, pixel) in out.data.chunks_exact_mut(3).enumerate() {
        let distance = |from: usize, to: usize| ((to as f64 - from as f64) / cap).clamp(-1.0, 1.0) as f32;
        pixel[0] = confidence[i];
        let feature = nearest[i] as usize;
        if nearest[i] == NONE {
            pixel[1..].fill(1.0);
        } else {
            pixel[1] = distance(i % width, feature % width);
            pixel[2] = distance(i / width, feature / width);
        }
    }
    Ok(out)
}

/// Finds the index of the lit pixel nearest to each pixel, exactly and in linear time: two sweeps along columns, then
/// the lower envelope of parabolas along rows (Felzenszwalb and Huttenlocher 2012).
fn nearest_feature(is_lit: impl Fn(usize) -> bool, width: usize, height: usize, job: Job) -> Result<Vec<u32>> {
    // For each pixel, find the row of the nearest lit pixel in its column.
    let mut row_of = try_vec(width * height, NONE)?;
    for y in 0..height {
        for x in 0..width {
            let i = y * width + x;
            row_of[i] = match () {
                _ if is_lit(i) => y as u32,
                _ if y > 0 => row_of[i - width],
                _ => NONE,
            };
        }
    }
    for y in (0..height.saturating_sub(1)).rev() {
        for x in 0..width {
            let (above, below) = (row_of[y * width + x], row_of[(y + 1) * width + x]);
            if below != NONE && (above == NONE || below.abs_diff(y as u32) < above.abs_diff(y as u32)) {
                row_of[y * width + x] = below;
            }
        }
    }

    // Each column c now proposes one lit pixel, at the vertical distance d(c). Find the column with the least squared
    // distance (x - c)² + d(c)² for every x: the lower envelope of these parabolas. `hull` lists the parabolas of the
    // envelope as pairs of c and the x from which the parabola is the lowest.
    let mut nearest = try_vec(width * height, NONE)?;
    exec::for_rows(&mut nearest, width, job, |y, out| {
        let rows = &row_of[y * width..(y + 1) * width];
        let height_at = |c: usize| maths::powi(f64::from(rows[c].abs_diff(y as u32)), 2);
        let mut hull: Vec<(usize, f64)> = Vec::new();
        for c in (0..width).filter(|&c| rows[c] != NONE) {
            let start = loop {
                let Some(&(last, from)) = hull.last() else { break f64::NEG_INFINITY };
                let (p, q) = (last as f64, c as f64);
                let meet = (height_at(c) + q * q - height_at(last) - p * p) / (2.0 * (q - p));
                if meet > from {
                    break meet;
                }
                hull.pop();
            };
            hull.push((c, start));
        }
        let mut k = 0;
        for (x, out) in out.iter_mut().enumerate() {
            while k + 1 < hull.len() && hull[k + 1].1 <= x as f64 {
                k += 1;
            }
            if let Some(&(c, _)) = hull.get(k) {
                *out = rows[c] * width as u32 + c as u32;
            }
        }
    })?;
    Ok(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;
    use crate::rng::Rng;

    #[test]
    fn the_nearest_feature_is_that_of_brute_force() {
        let monitor = Monitor::default();
        for (case, (w, h, density)) in
            [(1, 1, 1.0), (1, 17, 0.2), (23, 1, 0.1), (31, 22, 0.01), (40, 33, 0.2), (9, 9, 0.0)]
                .into_iter()
                .enumerate()
        {
            let mut rng = Rng::new(3, &[case as u64]);
            let lit: Vec<bool> = (0..w * h).map(|_| rng.next_f64() < density).collect();
            let nearest = nearest_feature(|i| lit[i], w, h, monitor.job()).unwrap();
            for i in 0..w * h {
                let square = |j: usize| (i % w).abs_diff(j % w).pow(2) + (i / w).abs_diff(j / w).pow(2);
                let best = (0..w * h).filter(|&j| lit[j]).map(square).min();
                let found = (nearest[i] != NONE).then(|| {
                    assert!(lit[nearest[i] as usize]);
                    square(nearest[i] as usize)
                });
                assert_eq!(found, best, "{w} x {h} at {i}");
            }
        }
    }

    #[test]
    fn distances_are_signed_capped_and_finite_without_light() {
        let monitor = Monitor::default();
        let mut lit = [false; 11 * 3];
        lit[11 + 5] = true;
        let metadata = compute(&[0.5; 33], |i| lit[i], 11, 3, 4.0, monitor.job()).unwrap();
        assert_eq!(metadata.pixel(5, 1), [0.5, 0.0, 0.0]);
        assert_eq!(metadata.pixel(3, 0), [0.5, 0.5, 0.25]);
        assert_eq!(metadata.pixel(7, 2), [0.5, -0.5, -0.25]);
        assert_eq!(metadata.pixel(10, 1), [0.5, -1.0, 0.0]);
        let dark = compute(&[0.0; 33], |_| false, 11, 3, 4.0, monitor.job()).unwrap();
        assert!(dark.data.chunks_exact(3).all(|p| p == [0.0, 1.0, 1.0]));
    }
}
