//! Compares two patterns of lamps by their pair correlation functions: how often two lamps lie at each distance from
//! each other, up to a few times the distance between neighbours.

use super::statistics::nearest_distances;
use glam::DVec2;

/// Maximum distance between the two points of a pair that is compared, as a multiple of the mean distance between
/// nearest neighbours. [convention: part of the definition of this statistic]
const MAX_DISTANCE: f64 = 2.5;
/// Half width of the Epanechnikov kernel that smooths the distances, as a multiple of the mean distance between nearest
/// neighbours. Stoyan and Stoyan recommend 0.15 / √λ for a density of λ points per area; on a square lattice, 1 / √λ is
/// the distance between neighbours. [paper: Stoyan and Stoyan 1994, eq. 15.16]
const KERNEL_HALF_WIDTH: f64 = 0.15;
/// Number of steps into which the distances from 0 to [`MAX_DISTANCE`] are divided.
const STEPS: usize = 100;

/// Points in a rectangle that has one corner at the origin and the opposite corner at `size`. Lengths may be in any
/// unit, but two patterns that are compared must have the same unit.
pub struct Points<'a> {
    pub at: &'a [DVec2],
    pub size: DVec2,
}

/// Difference between two patterns in the distances between their points: ½ Σ |p(r) - q(r)|. Here p(r) and q(r) are the
/// shares of the pairs of each pattern that lie at the distance r; the sum runs over r up to `MAX_DISTANCE`. The
/// difference is 0 if p = q, and 1 if the patterns have no distance in common. `None` if a pattern has no pair of
/// points within `MAX_DISTANCE`.
///
/// In a rectangle of w × h, a pair with the offset (x, y) has the weight 1 / ((w - |x|) (h - |y|)). The weight is
/// needed because fewer pairs with a large offset fit into the rectangle (translation correction, Ohser 1983). A kernel
/// spreads each pair over neighbouring distances (Stoyan and Stoyan 1994). `MAX_DISTANCE` and the kernel's width are
/// multiples of the mean distance between nearest neighbours in the pattern `of`.
pub fn distance(of: &Points, from: &Points) -> Option<f64> {
    let nearest = nearest_distances(of.at);
    let spacing = nearest.iter().sum::<f64>() / nearest.len() as f64;
    if !(spacing > 0.0 && spacing.is_finite() && from.at.len() > 1) {
        return None;
    }
    let (a, b) = (pairs(of, spacing), pairs(from, spacing));
    let (all_a, all_b): (f64, f64) = (a.iter().sum(), b.iter().sum());
    let off: f64 = a.iter().zip(&b).map(|(a, b)| (a / all_a - b / all_b).abs()).sum();
    (all_a > 0.0 && all_b > 0.0).then_some(off / 2.0)
}

/// Computes the density of pairs of points at each of `STEPS` distances r, up to a constant factor: r g(r), where g is
/// the pair correlation function. `spacing` is the mean distance between nearest neighbours.
fn pairs(points: &Points, spacing: f64) -> [f64; STEPS] {
    let (max_distance, width) = (MAX_DISTANCE * spacing, KERNEL_HALF_WIDTH * spacing);
    let mut order: Vec<DVec2> = points.at.to_vec();
    order.sort_by(|p, q| p.x.total_cmp(&q.x));
    let mut sums = [0.0; STEPS];
    for (i, p) in order.iter().enumerate() {
        for q in order[i + 1..].iter().take_while(|q| q.x - p.x < max_distance + width) {
            let apart = (*q - *p).abs();
            let shown = (points.size - apart).max(DVec2::ZERO).element_product();
            if shown <= 0.0 {
                continue;
            }
            for (step, sum) in sums.iter_mut().enumerate() {
                // Weigh the pair by the Epanechnikov kernel.
                let r = (step as f64 + 0.5) / STEPS as f64 * max_distance;
                let t = (r - apart.length()) / width;
                *sum += (1.0 - t * t).max(0.0) / shown;
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn the_same_law_is_near_and_another_far() {
        let size = DVec2::new(1000.0, 800.0);
        let grid = |shift: DVec2, jitter: f64, seed: u64| -> Vec<DVec2> {
            let mut rng = Rng::new(seed, &[]);
            (0..20 * 25)
                .map(|i| DVec2::new(f64::from(i % 25), f64::from(i / 25)) * 40.0 + shift)
                .map(|p| p + (DVec2::new(rng.next_f64(), rng.next_f64()) - 0.5) * jitter)
                .collect()
        };
        let mut rng = Rng::new(7, &[]);
        let scattered: Vec<DVec2> = (0..500).map(|_| DVec2::new(rng.next_f64(), rng.next_f64()) * size).collect();
        let between = |a: &[DVec2], b: &[DVec2]| distance(&Points { at: a, size }, &Points { at: b, size }).unwrap();
        let plain = grid(DVec2::splat(20.0), 0.0, 1);
        assert_eq!(between(&plain, &plain), 0.0);
        assert!(between(&plain, &grid(DVec2::splat(3.0), 0.0, 1)) < 1e-9);
        assert!(between(&plain, &grid(DVec2::splat(20.0), 4.0, 2)) < 0.15);
        assert!(between(&plain, &scattered) > 0.35);
        // A part of the grid in a smaller rectangle must agree with the whole grid, because the weights of the pairs
        // correct for the size of the rectangle.
        let part: Vec<DVec2> = plain.iter().copied().filter(|p| p.x < 400.0 && p.y < 400.0).collect();
        let part = Points { at: &part, size: DVec2::splat(400.0) };
        assert!(distance(&Points { at: &plain, size }, &part).unwrap() < 0.02);
        assert!(distance(&Points { at: &plain[..1], size }, &part).is_none());
    }
}
