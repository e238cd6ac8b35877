//! The estimate of one pixel: four replications of a point sequence, whose differences give its error.
//!
//! Owen scrambling makes the points of one sequence dependent: their variance does not give the error of their mean,
//! but the variance among independent scramblings does (Owen 1997). The paths of a pixel are dealt in turn to four
//! independently scrambled replications. Each replication continues from pass to pass, which preserves its
//! stratification at every power of two. Fewer replications would preserve more stratification; more of them would
//! make the variance of a single pixel more accurate. `interval` averages the variance over neighbouring pixels.

use glam::{DVec3, Vec3};

/// Number of independent scramblings per pixel. [origin not recorded]
pub const REPLICATIONS: u32 = 4;

/// Sums of the paths so far.
#[derive(Clone, Copy, Default)]
pub struct Pixel {
    /// Sum of each replication, in f32. New paths are first summed in f64, and their sum is then added.
    sums: [Vec3; REPLICATIONS as usize],
    /// Number of paths of all replications.
    count: u32,
}

/// Number of a pixel's first `count` paths that belong to a replication.
pub fn paths_of_replication(count: u32, replication: u32) -> u32 {
    (count + REPLICATIONS - 1 - replication) / REPLICATIONS
}

impl Pixel {
    /// A pixel of `count` paths from the sums of its replications.
    pub fn of_sums(sums: [DVec3; REPLICATIONS as usize], count: u32) -> Self {
        Self { sums: sums.map(|s| s.as_vec3()), count }
    }

    pub fn count(&self) -> u32 {
        self.count
    }

    /// Adds paths up to a total of `count`; `path(replication, indices)` returns the sum of the paths of an index
    /// range.
    pub fn extend(&mut self, count: u32, mut path: impl FnMut(u32, std::ops::Range<u32>) -> DVec3) {
        for (replication, sum) in (0..REPLICATIONS).zip(&mut self.sums) {
            let indices = paths_of_replication(self.count, replication)..paths_of_replication(count, replication);
            if !indices.is_empty() {
                *sum += path(replication, indices).as_vec3();
            }
        }
        self.count = count;
    }

    /// Adds the sum of a replication's paths.
    pub fn add(&mut self, replication: u32, sum: DVec3) {
        self.sums[replication as usize] += sum.as_vec3();
    }

    /// Sets the total number of paths, after all replications have been added.
    pub fn set_count(&mut self, count: u32) {
        self.count = count;
    }

    /// Mean radiance; black without paths.
    pub fn mean(&self) -> DVec3 {
        self.sums.iter().map(|s| s.as_dvec3()).sum::<DVec3>() / f64::from(self.count.max(1))
    }

    /// Means of the even and of the odd replications: independent if the pixel has at least two paths.
    pub fn halves(&self) -> [DVec3; 2] {
        [0, 1].map(|first| {
            let of = || (0..REPLICATIONS).zip(&self.sums).filter(|(replication, _)| replication % 2 == first);
            match of().map(|(replication, _)| paths_of_replication(self.count, replication)).sum() {
                0 => self.mean(),
                paths => of().map(|(_, s)| s.as_dvec3()).sum::<DVec3>() / f64::from(paths),
            }
        })
    }

    /// Mean of the replications without the brightest and the darkest, averaged over the channels: robust against a
    /// single bright path.
    pub fn trimmed_mean(&self) -> f64 {
        let mut means: [f64; REPLICATIONS as usize] = std::array::from_fn(|i| {
            let paths = paths_of_replication(self.count, i as u32).max(1);
            f64::from(self.sums[i].element_sum()) / 3.0 / f64::from(paths)
        });
        means.sort_unstable_by(f64::total_cmp);
        let middle = &means[1..means.len() - 1];
        middle.iter().sum::<f64>() / middle.len() as f64
    }

    /// Unbiased estimate of the variance of the mean; infinite below two paths.
    pub fn variance(&self) -> DVec3 {
        if self.count < 2 {
            return DVec3::INFINITY;
        }
        let mean = self.mean();
        let (mut squares, mut used) = (DVec3::ZERO, 0u32);
        for (replication, sum) in (0..REPLICATIONS).zip(&self.sums) {
            let paths = paths_of_replication(self.count, replication);
            if paths > 0 {
                // Weight by the number of paths, as if the variance of a replication were inversely proportional to
                // that number.
                let distance = sum.as_dvec3() / f64::from(paths) - mean;
                squares += distance * distance * f64::from(paths);
                used += 1;
            }
        }
        squares / f64::from(used - 1) / f64::from(self.count)
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
        // Independent paths of variance 1/12.
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
            // The relative standard deviation of one variance estimate is below 1.5.
            assert!((ratio - 1.0).abs() < 5.0 * 1.5 / (n as f64).sqrt(), "{count} paths: {ratio}");
        }
        assert_eq!(Pixel::default().variance(), DVec3::INFINITY);
    }
}
