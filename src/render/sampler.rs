//! The random numbers of paths: Owen-scrambled Sobol' points (Burley 2020, "Practical hash-based Owen scrambling"),
//! four dimensions at a time.
//!
//! A path draws its numbers in blocks of four; each block is one four-dimensional Sobol' point. Blocks are combined by
//! padding: each block shuffles and scrambles the same sequence in its own way. Within a block, the samples of a pixel
//! are stratified: any 2^k successive samples whose first index is a multiple of 2^k fill 2^k strata evenly. The four
//! numbers of a block are for decisions that should be stratified jointly, such as the choice of a direction and of the
//! light sample at the next vertex.

use crate::rng;

/// The random numbers of one path.
#[derive(Clone)]
pub struct Sampler {
    /// Index of the path in the point sequence of `seed`, with its bits reversed.
    index: u32,
    seed: u64,
    block: u64,
}

/// Four random numbers of 32 bits: the coordinates of one scrambled Sobol' point.
#[derive(Clone, Copy)]
pub struct Block([u32; 4]);

impl Block {
    /// Returns a number uniform in `[0, 1)`, with a resolution of 24 bits.
    #[inline]
    pub fn get(&self, dimension: usize) -> f32 {
        // Convert to f32 as a signed integer, which is a single instruction; 24 bits never set the sign.
        (self.0[dimension] >> 8) as i32 as f32 * (1.0 / (1u32 << 24) as f32)
    }

    /// Returns a number uniform in `[0, 1)` with all 32 bits, for choices among very many entries.
    #[inline]
    pub fn fine(&self, dimension: usize) -> f64 {
        f64::from(self.0[dimension]) * (1.0 / 4_294_967_296.0)
    }
}

impl Sampler {
    /// Returns a sampler that yields the random numbers of path number `index` in the point sequence of `seed`.
    #[inline]
    pub fn new(seed: u64, index: u32) -> Self {
        Self { index: index.reverse_bits(), seed: rng::mix(seed), block: 0 }
    }

    /// Returns the next block of four numbers.
    #[inline]
    pub fn next(&mut self) -> Block {
        // Compute one hash per block (Steele et al. 2014). Half of its bits shuffle the index, the other half scramble
        // the dimensions.
        self.block = self.block.wrapping_add(1);
        let hash = rng::mix(self.seed.wrapping_add(self.block.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        let point = self.point(scramble(self.index, hash as u32));
        let seed = |d: u32| mix(((hash >> 32) as u32).wrapping_add(d.wrapping_mul(0x9e37_79b9)));
        Block(std::array::from_fn(|d| scramble(point[d], seed(d as u32)).reverse_bits()))
    }

    /// Returns a point of the Sobol' sequence in its first four dimensions. The bits of `index` and of the results are
    /// in reversed order. Each table look-up handles eight bits of the index.
    #[inline]
    fn point(&self, index: u32) -> [u32; 4] {
        let row = |byte: usize| &SOBOL[byte][(index >> (8 * byte)) as usize & 255];
        let low = row(3);
        // Skip three look-ups for indices below 256, which differ only in their low eight bits. Shuffling flips the
        // higher bits of all these indices alike, which would XOR all points with the same constant. This XOR can be
        // omitted, because the scrambling of the points has the same effect.
        if self.index & 0x00ff_ffff == 0 {
            return *low;
        }
        let (a, b, c) = (row(0), row(1), row(2));
        std::array::from_fn(|i| low[i] ^ a[i] ^ b[i] ^ c[i])
    }

    /// Returns a hash of the path and its current block, for decisions that need no stratification.
    #[inline]
    pub fn ray_seed(&self) -> u64 {
        rng::mix(self.seed ^ (self.block << 32 | u64::from(self.index)))
    }

    /// Returns a number uniform in `[0, 1)` that, unlike the numbers of blocks, is independent of the numbers of all
    /// other paths. Decisions that depend on the results of other paths (Russian roulette) must use this function,
    /// because stratified numbers would bias the estimate.
    #[inline]
    pub fn chance(&self) -> f32 {
        (self.ray_seed() >> 40) as f32 * (1.0 / (1u32 << 24) as f32)
    }
}

/// Hashes 32 bits so that every input bit affects every output bit (Wellons 2018, "lowbias32").
#[inline]
fn mix(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Nested uniform scrambling: flips each bit by a hash of all higher bits (Laine and Karras 2011, with the constants
/// of Vegdahl 2021). Input and output have reversed bits, since carries run from low to high bits.
#[inline]
fn scramble(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Look-up tables of the Sobol' sequence. A point is the XOR of four entries, one for each byte of its index:
/// `SOBOL[byte][value]`. Indices and points have reversed bits.
static SOBOL: [[[u32; 4]; 256]; 4] = sobol_tables();

const fn sobol_tables() -> [[[u32; 4]; 256]; 4] {
    let directions = sobol_directions();
    let mut tables = [[[0u32; 4]; 256]; 4];
    let mut byte = 0;
    while byte < 4 {
        let mut value = 0;
        while value < 256 {
            let mut bit = 0;
            while bit < 8 {
                if value >> bit & 1 == 1 {
                    let mut d = 0;
                    while d < 4 {
                        tables[byte][value][d] ^= directions[d][31 - (8 * byte + bit)].reverse_bits();
                        d += 1;
                    }
                }
                bit += 1;
            }
            value += 1;
        }
        byte += 1;
    }
    tables
}

/// Returns the direction numbers of dimensions 1 to 4, from the primitive polynomials and initial values of Joe and
/// Kuo (2008).
const fn sobol_directions() -> [[u32; 32]; 4] {
    const DEGREE: [usize; 4] = [0, 1, 2, 3];
    const COEFFICIENTS: [u32; 4] = [0, 0, 1, 1];
    const INITIAL: [[u32; 3]; 4] = [[0, 0, 0], [1, 0, 0], [1, 3, 0], [1, 3, 1]];
    let mut v = [[0u32; 32]; 4];
    let mut i = 0;
    while i < 32 {
        v[0][i] = 1 << (31 - i);
        i += 1;
    }
    let mut d = 1;
    while d < 4 {
        let s = DEGREE[d];
        let mut i = 0;
        while i < 32 {
            if i < s {
                v[d][i] = INITIAL[d][i] << (31 - i);
            } else {
                let mut x = v[d][i - s] ^ (v[d][i - s] >> s);
                let mut k = 1;
                while k < s {
                    if COEFFICIENTS[d] >> (s - 1 - k) & 1 == 1 {
                        x ^= v[d][i - k];
                    }
                    k += 1;
                }
                v[d][i] = x;
            }
            i += 1;
        }
        d += 1;
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_power_of_two_is_stratified_in_each_dimension_and_pair() {
        for seed in 0..20 {
            let points: Vec<Block> = (0..256).map(|i| Sampler::new(seed, i).next()).collect();
            for d in 0..4 {
                let mut strata = [0; 256];
                points.iter().for_each(|p| strata[(p.get(d) * 256.0) as usize] += 1);
                assert!(strata.iter().all(|&c| c == 1), "dimension {d}");
            }
            // The first two dimensions form a (0, 2)-sequence: each elementary interval of area 1/256 contains one of
            // the first 256 points.
            for log in 0..=8 {
                let (nx, ny) = (1usize << log, 256usize >> log);
                let mut boxes = vec![0; 256];
                points.iter().for_each(|p| {
                    boxes[(p.get(0) * nx as f32) as usize * ny + (p.get(1) * ny as f32) as usize] += 1;
                });
                assert!(boxes.iter().all(|&c| c == 1), "boxes of {nx} x {ny}");
            }
        }
    }

    #[test]
    fn blocks_and_seeds_are_uncorrelated() {
        let n = 4096;
        let (mut blocks, mut seeds) = (0.0, 0.0);
        for i in 0..n {
            let mut sampler = Sampler::new(3, i);
            let (a, b) = (sampler.next().fine(0) - 0.5, sampler.next().fine(0) - 0.5);
            blocks += a * b;
            seeds += a * (Sampler::new(4, i).next().fine(0) - 0.5);
        }
        let limit = 6.0 / 12.0 / f64::from(n).sqrt();
        assert!((blocks / f64::from(n)).abs() < limit && (seeds / f64::from(n)).abs() < limit);
    }
}
