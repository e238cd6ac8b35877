//! Ellipsoids around the samples of each class in feature space, and how far pixels lie outside them.

use super::input::MAX_CHANNELS;
use super::logistic::cholesky_solve;
use super::table::{BLOCK, Lanes, Table, combine, dot_lanes};
use crate::maths;
use crate::simd::widest;

/// Variance that is added to each feature of a class, in standardised units. It gives a class a standard deviation of
/// at least 0.1 along each feature. For comparison, the samples of both classes together have a standard deviation of
/// at most 1. [bench segment:masks]
const MIN_VARIANCE: f64 = 0.01;
/// The ellipsoid of a class reaches to this percentile of its samples' Mahalanobis distances from the centre, but at
/// least to the distance 1.
const EXTENT_PERCENTILE: usize = 99;

/// Mean and covariance of a class's samples.
pub struct Spread<'a> {
    features: &'a Table,
    members: Vec<usize>,
    centre: Vec<f64>,
    /// The covariance matrix, row by row; only its lower triangle is filled.
    covariance: Vec<f64>,
}

/// An ellipsoid around nearly all samples of a class. The squared distance `(x - centre)ᵀ A (x - centre)` is at most 1
/// inside.
pub struct Ellipsoid {
    pub centre: Vec<f64>,
    /// The matrix `A`, row by row: the inverse covariance divided by the squared extent. The extent is the
    /// [`EXTENT_PERCENTILE`]th percentile of the samples' Mahalanobis distances, but at least 1.
    pub inverse: Vec<f64>,
}

impl<'a> Spread<'a> {
    /// Computes mean and covariance of the rows for which `is_member` holds.
    pub fn of(features: &'a Table, is_member: impl Fn(usize) -> bool) -> Self {
        let d = features.columns;
        let members: Vec<usize> = (0..features.rows).filter(|&i| is_member(i)).collect();
        let per_n = 1.0 / members.len() as f64;
        let of_members = |rows: std::ops::Range<usize>| -> Lanes {
            let start = rows.start;
            std::array::from_fn(|k| if start + k < rows.end && is_member(start + k) { per_n } else { 0.0 })
        };
        let mut centre = vec![0.0; d];
        let mut covariance = vec![0.0; d * d];
        for (rows, block) in features.blocks() {
            add_sums(block, &of_members(rows), &mut centre);
        }
        for (rows, block) in features.blocks() {
            add_products(block, &of_members(rows), &centre, &mut covariance);
        }
        (0..d).for_each(|i| covariance[i * d + i] += MIN_VARIANCE);
        Self { features, members, centre, covariance }
    }

    /// Computes the ellipsoid in the space of the given columns.
    pub fn ellipsoid(&self, columns: &[usize]) -> Ellipsoid {
        let (d, all) = (columns.len(), self.features.columns);
        let mut inverse = vec![0.0; d * d];
        for j in 0..d {
            let unit: Vec<f64> = (0..d).map(|i| f64::from(i == j)).collect();
            let lower = |&r: &usize| columns.iter().map(move |&c| self.covariance[r.max(c) * all + r.min(c)]);
            let mut covariance: Vec<f64> = columns.iter().flat_map(lower).collect();
            if let Some(column) = cholesky_solve(&mut covariance, &unit) {
                (0..d).for_each(|i| inverse[i * d + j] = column[i]);
            }
        }
        let mut ellipsoid = Ellipsoid { centre: columns.iter().map(|&c| self.centre[c]).collect(), inverse };
        let mut distances = Vec::with_capacity(self.features.rows);
        for (rows, block) in self.features.blocks() {
            distances.extend_from_slice(&ellipsoid.squared_distances(block, columns)[..rows.len()]);
        }
        let mut distances: Vec<f64> = self.members.iter().map(|&i| distances[i]).collect();
        let rank = (distances.len() - 1) * EXTENT_PERCENTILE / 100;
        let squared_extent = distances.select_nth_unstable_by(rank, f64::total_cmp).1.max(1.0);
        ellipsoid.inverse.iter_mut().for_each(|v| *v /= squared_extent);
        ellipsoid
    }
}

impl Ellipsoid {
    fn squared_distances(&self, block: &[Lanes], columns: &[usize]) -> Lanes {
        squared_distances(self, block, columns)
    }
}

/// Returns the mean over all pixels of how far a pixel lies outside the nearest ellipsoid: 0 inside, `1 - e^(1 - d)`
/// outside, where the distance d from the centre is 1 on the ellipsoid.
pub fn mean_unseen(pixels: &Table, columns: &[usize], ellipsoids: &[Ellipsoid]) -> f64 {
    let mut sum = 0.0;
    for (rows, block) in pixels.blocks() {
        let mut nearest = [f64::INFINITY; BLOCK];
        for ellipsoid in ellipsoids {
            let distances = ellipsoid.squared_distances(block, columns);
            nearest.iter_mut().zip(distances).for_each(|(n, d)| *n = n.min(d));
        }
        sum += nearest[..rows.len()].iter().map(|n| 1.0 - maths::exp(1.0 - n.max(1.0).sqrt())).sum::<f64>();
    }
    sum / pixels.rows.max(1) as f64
}

widest! {
    fn add_sums(block: &[Lanes], weights: &Lanes, sums: &mut [f64]) {
        for (sum, x) in sums.iter_mut().zip(block) {
            *sum += dot_lanes(weights, x);
        }
    }
}

widest! {
    /// Adds the weighted outer products of the deviations from the centre to the lower triangle of `products`.
    fn add_products(block: &[Lanes], weights: &Lanes, centre: &[f64], products: &mut [f64]) {
        let d = centre.len();
        let mut off = [[0.0; BLOCK]; MAX_CHANNELS];
        for ((off, x), centre) in off.iter_mut().zip(block).zip(centre) {
            for k in 0..BLOCK {
                off[k] = x[k] - centre;
            }
        }
        for i in 0..d {
            let mut weighted = [0.0; BLOCK];
            for k in 0..BLOCK {
                weighted[k] = weights[k] * off[i][k];
            }
            for j in 0..=i {
                products[i * d + j] += dot_lanes(&weighted, &off[j]);
            }
        }
    }
}

widest! {
    fn squared_distances(from: &Ellipsoid, block: &[Lanes], columns: &[usize]) -> Lanes {
        let d = columns.len();
        let mut off = [[0.0; BLOCK]; MAX_CHANNELS];
        for ((off, &c), centre) in off.iter_mut().zip(columns).zip(&from.centre) {
            for k in 0..BLOCK {
                off[k] = block[c][k] - centre;
            }
        }
        let mut sum = [0.0; BLOCK];
        for i in 0..d {
            let row = combine(&from.inverse[i * d..(i + 1) * d], &off[..d]);
            for k in 0..BLOCK {
                sum[k] += off[i][k] * row[k];
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn a_region_holds_its_members_and_distance_is_mahalanobis() {
        let mut rng = Rng::new(5, &[]);
        let rows: Vec<f64> = (0..400).flat_map(|_| [3.0 * rng.normal(), 7.0, 0.5 * rng.normal() + 1.0]).collect();
        let table = Table::of(&rows, 3).unwrap();
        let spread = Spread::of(&table, |i| i % 2 == 0);
        let region = spread.ellipsoid(&[0, 2]);
        let at = |x: f64, y: f64| {
            let point = Table::of(&[x, 0.0, y], 3).unwrap();
            region.squared_distances(point.blocks().next().unwrap().1, &[0, 2])[0]
        };
        let within = (0..400).step_by(2).filter(|&i| at(rows[3 * i], rows[3 * i + 2]) <= 1.0 + 1e-12).count();
        assert_eq!(within, 198);
        // Two points lie six standard deviations from the centre, one along each axis. Their Mahalanobis distances must
        // be nearly equal, although the standard deviations differ.
        let (x, y) = (region.centre[0], region.centre[1]);
        let (along, across) = (at(x + 18.0, y), at(x, y + 6.0 * 0.51));
        assert!((along / across).ln().abs() < 0.3, "{along} {across}");
        assert_eq!(mean_unseen(&Table::of(&[x, 0.0, y], 3).unwrap(), &[0, 2], &[region]), 0.0);
    }
}
