//! The estimate of one pixel: four independent replications of a point sequence. The differences between the
//! replications give the error of the pixel.
//!
//! Owen scrambling makes the points of one sequence dependent on each other. The variance among the points of a
//! sequence therefore does not give the error of their mean. The variance among independently scrambled sequences does
//! (Owen 1997). The paths of a pixel are dealt in turn to four independently scrambled replications. Each replication
//! continues from pass to pass, which preserves its stratification at every power of two. With fewer replications,
//! each would be stratified better; with more, the variance of a single pixel would be estimated more accurately.
//! `interval` averages the variance over neighbouring pixels.

use glam::{DVec3, Vec3};

/// Number of independently scrambled point sequences per pixel. Each of the two halves of a pixel needs at least two
/// sequences for an estimate of the half's variance ([`Pixel::half_variances`]), so four is the smallest number.
/// \[convention\]
pub const REPLICATIONS: u32 = 4;

/// Sums over the paths of a pixel so far.
#[derive(Clone, Copy, Default)]
pub struct Pixel {
    /// Sum of the radiance of each replication's paths, in f32. New paths are summed in f64 before they are added.
    sums: [Vec3; REPLICATIONS as usize],
    /// Total number of paths in all replications.
    count: u32,
}

/// Returns how many of the first `count` paths of a pixel belong to a replication: path i belongs to replication
/// i mod 4.
pub fn paths_of_replication(count: u32, replication: u32) -> u32 {
    (count + REPLICATIONS - 1 - replication) / REPLICATIONS
}

impl Pixel {
    /// Builds a pixel of `count` paths from the sums of its replications.
    pub fn of_sums(sums: [DVec3; REPLICATIONS as usize], count: u32) -> Self {
        Self { sums: sums.map(|s| s.as_vec3()), count }
    }

    pub fn count(&self) -> u32 {
        self.count
    }

    /// Adds paths until the pixel has `count` paths. `path(replication, indices)` traces the paths with the given
    /// indices of a replication, and returns the sum of their radiance.
    pub fn extend(&mut self, count: u32, mut path: impl FnMut(u32, std::ops::Range<u32>) -> DVec3) {
        for (replication, sum) in (0..REPLICATIONS).zip(&mut self.sums) {
            let indices = paths_of_replication(self.count, replication)..paths_of_replication(count, replication);
            if !indices.is_empty() {
                *sum += path(replication, indices).as_vec3();
            }
        }
        self.count = count;
    }

    /// Adds `sum`, the summed radiance of new paths of a replication.
    pub fn add(&mut self, replication: u32, sum: DVec3) {
        self.sums[replication as usize] += sum.as_vec3();
    }

    /// Sets the total number of paths, after all replications have been added.
    pub fn set_count(&mut self, count: u32) {
        self.count = count;
    }

    /// Returns the mean radiance; black if the pixel has no paths.
    pub fn mean(&self) -> DVec3 {
        self.sums.iter().map(|s| s.as_dvec3()).sum::<DVec3>() / f64::from(self.count.max(1))
    }

    /// Returns the mean of the even and the mean of the odd replications. The two means are independent if the pixel
    /// has at least two paths, and equal otherwise.
    pub fn halves(&self) -> [DVec3; 2] {
        [0, 1].map(|first| {
            let of = || (0..REPLICATIONS).zip(&self.sums).filter(|(replication, _)| replication % 2 == first);
            match of().map(|(replication, _)| paths_of_replication(self.count, replication)).sum() {
                0 => self.mean(),
                paths => of().map(|(_, s)| s.as_dvec3()).sum::<DVec3>() / f64::from(paths),
            }
        })
    }

    /// Returns the mean radiance over the replications except the brightest and the darkest one, averaged over the
    /// channels. A single bright path hardly changes this mean.
    pub fn trimmed_mean(&self) -> f64 {
        let mut means: [f64; REPLICATIONS as usize] = std::array::from_fn(|i| {
            let paths = paths_of_replication(self.count, i as u32).max(1);
            f64::from(self.sums[i].element_sum()) / 3.0 / f64::from(paths)
        });
        means.sort_unstable_by(f64::total_cmp);
        let middle = &means[1..means.len() - 1];
        middle.iter().sum::<f64>() / middle.len() as f64
    }

    /// Returns an unbiased estimate of the variance of the mean; infinite for fewer than two paths.
    pub fn variance(&self) -> DVec3 {
        self.variance_of(0..REPLICATIONS)
    }

    /// Returns unbiased estimates of the variances of the two [`halves`](Self::halves), each from its own paths alone;
    /// infinite for fewer than four paths.
    pub fn half_variances(&self) -> [DVec3; 2] {
        [0, 1].map(|first| self.variance_of((0..REPLICATIONS).skip(first).step_by(2)))
    }

    /// Returns an unbiased estimate of the variance of the mean of some replications; infinite if fewer than two of
    /// them have paths.
    fn variance_of(&self, replications: impl Iterator<Item = u32> + Clone) -> DVec3 {
        let sums = replications.map(|r| (self.sums[r as usize].as_dvec3(), r));
        let used = sums
            .map(|(sum, r)| (sum, f64::from(paths_of_replication(self.count, r))))
            .filter(|(_, paths)| *paths > 0.0);
        let (sum, paths) = used.clone().fold((DVec3::ZERO, 0.0), |(s, n), (sum, paths)| (s + sum, n + paths));
        let count = used.clone().count();
        if count < 2 {
            return DVec3::INFINITY;
        }
        // Weight each replication by its number of paths, on the assumption that its variance is inversely proportional
        // to this number.
        let mean = sum / paths;
        let squares: DVec3 = used.map(|(sum, paths)| (sum / paths - mean) * (sum / paths - mean) * paths).sum();
        squares / (count - 1) as f64 / paths
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn paths_are_dealt_in_turn_and_none_is_lost_between_passes() {
        let mut pixel = Pixel::default();
        let mut seen = Vec::new();
        for count in [1, 2, 7, 7, 8, 64] {
            pixel.extend(count, |replication, indices| {
                seen.extend(indices.clone().map(|i| i * REPLICATIONS + replication));
                DVec3::splat(indices.len() as f64)
            });
            assert_eq!((pixel.count(), pixel.mean()), (count, DVec3::ONE));
            assert_eq!(pixel.halves(), [DVec3::ONE; 2]);
        }
        assert_eq!(pixel.trimmed_mean(), 1.0);
        seen.sort_unstable();
        assert!(seen.iter().copied().eq(0..64));
        assert_eq!(pixel.variance(), DVec3::ZERO);
    }

    #[test]
    fn variance_is_that_of_the_mean_for_any_count() {
        // Each path contributes a uniform random number, whose variance is 1/12.
        for count in [2, 3, 5, 6, 8, 21] {
            let n = 20_000;
            let mut sum = 0.0;
            for trial in 0..n {
                let mut rng = Rng::new(trial, &[u64::from(count)]);
                let mut pixel = Pixel::default();
                pixel.extend(count, |_, indices| indices.map(|_| DVec3::splat(rng.next_f64())).sum());
                sum += pixel.variance().x;
            }
            let ratio = sum / n as f64 * 12.0 * f64::from(count);
            // The relative standard deviation of a single variance estimate is below 1.5.
            assert!((ratio - 1.0).abs() < 5.0 * 1.5 / (n as f64).sqrt(), "{count} paths: {ratio}");
        }
        assert_eq!(Pixel::default().variance(), DVec3::INFINITY);
    }

    #[test]
    fn variances_of_halves_use_their_own_paths_and_need_four() {
        let pixel = |values: &[f64]| {
            let mut pixel = Pixel::default();
            let value = |r: u32, i: u32| DVec3::splat(values[(i * REPLICATIONS + r) as usize]);
            pixel.extend(values.len() as u32, |r, indices| indices.map(|i| value(r, i)).sum());
            pixel.half_variances().map(|v| v.x)
        };
        // The variance of the mean of two values is a quarter of their squared difference.
        assert_eq!(pixel(&[1.0, 5.0, 3.0, 11.0]), [1.0, 9.0]);
        assert_eq!(pixel(&[1.0, 5.0, 3.0, 11.0, 1.0, 5.0, 3.0, 11.0]), [1.0, 9.0]);
        assert_eq!(pixel(&[1.0, 5.0, 3.0]), [1.0, f64::INFINITY]);
    }
}
