//! A discrete distribution, which samples entries in proportion to their weights.

use crate::error::Result;
use crate::image::try_vec;

/// A discrete distribution, stored as the running sum of its weights.
pub struct Distribution {
    /// `cumulative[i]` is the sum of the weights of entries 0 to `i`.
    cumulative: Vec<f64>,
    /// `guide[k]` is the entry that `u = k / guide.len()` selects. A search for a larger `u` starts there (Chen and
    /// Asau 1974).
    guide: Vec<u32>,
}

impl Distribution {
    /// Builds the distribution from finite, non-negative weights.
    pub fn new(weights: impl ExactSizeIterator<Item = f64>) -> Result<Self> {
        let mut cumulative = try_vec(weights.len(), 0.0)?;
        let mut sum = 0.0;
        for (c, w) in cumulative.iter_mut().zip(weights) {
            sum += w;
            *c = sum;
        }
        let mut guide = try_vec(cumulative.len(), 0u32)?;
        let mut index = 0;
        for (k, g) in guide.iter_mut().enumerate() {
            let target = k as f64 / cumulative.len() as f64 * sum;
            while index + 1 < cumulative.len() && cumulative[index] <= target {
                index += 1;
            }
            *g = index as u32;
        }
        Ok(Self { cumulative, guide })
    }

    pub fn len(&self) -> usize {
        self.cumulative.len()
    }

    pub fn total(&self) -> f64 {
        self.cumulative.last().copied().unwrap_or(0.0)
    }

    pub fn pmf(&self, index: usize) -> f64 {
        let before = if index == 0 { 0.0 } else { self.cumulative[index - 1] };
        if self.total() > 0.0 { (self.cumulative[index] - before) / self.total() } else { 0.0 }
    }

    /// Samples an entry with `u` in `[0, 1)`. Also returns the relative position of `u` within the entry, in `[0, 1)`.
    /// Never returns an entry of zero weight; at least one weight must be positive.
    pub fn sample(&self, u: f64) -> (usize, f64) {
        let target = u * self.total();
        // Search from one value of `guide` to the next one. Because of rounding, include one more entry on each side.
        let k = ((u * self.guide.len() as f64) as usize).min(self.guide.len() - 1);
        let low = (self.guide[k] as usize).saturating_sub(1);
        let high =
            self.guide.get(k + 1).map_or(self.cumulative.len(), |&g| (g as usize + 1).min(self.cumulative.len()));
        let offset = self.cumulative[low..high].partition_point(|&c| c <= target);
        let index = (low + offset).min(self.cumulative.len() - 1);
        let before = if index == 0 { 0.0 } else { self.cumulative[index - 1] };
        let width = self.cumulative[index] - before;
        (index, if width > 0.0 { ((target - before) / width).min(1.0 - f64::EPSILON) } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_guide_table_agrees_with_a_search_of_the_whole_table() {
        let mut rng = crate::rng::Rng::new(1, &[]);
        for len in [1, 2, 7, 1000] {
            let table =
                Distribution::new((0..len).map(|i| if i % 3 == 1 { 0.0 } else { rng.next_f64().powi(8) })).unwrap();
            for i in 0..10_000 {
                let u = if i < 1000 { f64::from(i) / 1000.0 } else { rng.next_f64() };
                let whole = table.cumulative.partition_point(|&c| c <= u * table.total()).min(len - 1);
                assert_eq!(table.sample(u).0, whole, "{len} entries at {u}");
            }
        }
    }

    #[test]
    fn entries_are_sampled_in_proportion_to_their_weight() {
        let weights = [0.0, 3.0, 0.0, 1.0, 4.0, 0.0];
        let table = Distribution::new(weights.into_iter()).unwrap();
        let mut counts = [0; 6];
        for i in 0..8000 {
            let (index, rest) = table.sample((f64::from(i) + 0.5) / 8000.0);
            assert!((0.0..1.0).contains(&rest));
            counts[index] += 1;
        }
        assert_eq!(counts, [0, 3000, 0, 1000, 4000, 0]);
        assert_eq!(table.pmf(4), 0.5);
        assert_eq!(table.sample(0.0).0, 1);
        assert_eq!(table.sample(1.0 - 1e-16).0, 4);
        // Invert the sampling: the entry and the position within it determine `u`.
        for i in 0..1000 {
            let u = f64::from(i) / 1000.0;
            let (index, rest) = table.sample(u);
            let before: f64 = (0..index).map(|j| table.pmf(j)).sum();
            assert!((before + rest * table.pmf(index) - u).abs() < 1e-12, "{u}");
        }
    }
}
