//! Counter-based random numbers. Each number is a pure function of a seed and of coordinates, such as a pixel's
//! position. Results therefore do not depend on the order in which threads compute them.

use crate::maths;

/// Hashes 64 bits so that every input bit affects every output bit (the finaliser of SplitMix64, Steele et al. 2014).
#[inline]
pub fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Hashes a seed and the coordinates that identify a random quantity.
#[inline]
pub fn hash(seed: u64, coordinates: &[u64]) -> u64 {
    coordinates.iter().fold(mix(seed.wrapping_add(0x9e37_79b9_7f4a_7c15)), |h, &c| {
        mix(h.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ mix(c.wrapping_add(0x9e37_79b9_7f4a_7c15)))
    })
}

/// A stream of random numbers. Its initial state is a hash of a seed and of coordinates, such as a pixel's position.
#[derive(Clone)]
pub struct Rng(u64);

impl Rng {
    pub fn new(seed: u64, coordinates: &[u64]) -> Self {
        Self(hash(seed, coordinates))
    }

    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.0)
    }

    pub fn next_u32(&mut self) -> u32 {
        (self.next_u64() >> 32) as u32
    }

    /// Returns a number uniform in `[0, 1)`; all 24 bits of its fraction are random.
    pub fn next_f32(&mut self) -> f32 {
        (self.next_u64() >> 40) as f32 * (1.0 / (1u32 << 24) as f32)
    }

    /// Returns a number uniform in `[0, 1)`; all 53 bits of its fraction are random.
    pub fn next_f64(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Returns a uniform integer in `0..count` by multiplication (Lemire 2019). Without his rejection step,
    /// probabilities deviate by a relative error of at most `count / 2^64`.
    pub fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.next_u64()) * count as u128) >> 64) as usize
    }

    /// Returns a standard normal deviate (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * maths::ln(1.0 - self.next_f64())).sqrt();
        radius * maths::cos(std::f64::consts::TAU * self.next_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_and_independence_of_neighbouring_streams() {
        let n = 100_000;
        let (mut sum, mut square, mut cross) = (0.0, 0.0, 0.0);
        for i in 0..n {
            let u = Rng::new(7, &[i]).next_f64() - 0.5;
            let v = Rng::new(7, &[i + 1]).next_f64() - 0.5;
            sum += u;
            square += u * u;
            cross += u * v;
        }
        // The tolerance is six standard deviations of each estimate.
        let n = n as f64;
        assert!((sum / n).abs() < 6.0 * (1.0 / 12.0 / n).sqrt());
        assert!((square / n - 1.0 / 12.0).abs() < 6.0 * (1.0 / 180.0 / n).sqrt());
        assert!((cross / n).abs() < 6.0 / 12.0 / n.sqrt());
    }

    #[test]
    fn below_covers_its_range_evenly() {
        let mut counts = [0u32; 7];
        let mut rng = Rng::new(1, &[]);
        for _ in 0..70_000 {
            counts[rng.below(7)] += 1;
        }
        // With 6 degrees of freedom, chi-squared exceeds 27.9 with a probability of 1e-4.
        let chi2: f64 = counts.iter().map(|&c| (f64::from(c) - 10_000.0).powi(2) / 10_000.0).sum();
        assert!(chi2 < 27.9, "{chi2}");
    }
}
