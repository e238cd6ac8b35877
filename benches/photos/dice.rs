//! Random draws for a generated room and photo, all from one seed.

use luxfer::rng::Rng;

pub struct Dice(Rng);

impl Dice {
    /// Each purpose has a random stream of its own, so that a change of one purpose leaves the others as they are.
    pub fn new(seed: u64, purpose: u64) -> Self {
        Self(Rng::new(seed, &[purpose]))
    }

    /// A number with uniform distribution between `low` and `high`.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.0.next_f32()
    }

    /// A number between two positive numbers whose logarithm has uniform distribution.
    pub fn log_between(&mut self, low: f32, high: f32) -> f32 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub fn chance(&mut self, probability: f32) -> bool {
        self.0.next_f32() < probability
    }

    /// A whole number with uniform distribution in `0..count`.
    pub fn below(&mut self, count: usize) -> usize {
        self.0.below(count)
    }

    /// A whole number with uniform distribution from `low` to `high`, both included.
    pub fn whole(&mut self, low: usize, high: usize) -> usize {
        low + self.0.below(high - low + 1)
    }

    pub fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.0.below(of.len())]
    }

    /// One of several items, chosen with probabilities in proportion to their weights.
    pub fn weighted<T: Copy>(&mut self, of: &[(T, f32)]) -> T {
        let mut left = self.0.next_f32() * of.iter().map(|(_, weight)| weight).sum::<f32>();
        let found = of.iter().find(|(_, weight)| {
            left -= weight;
            left < 0.0
        });
        found.unwrap_or(&of[of.len() - 1]).0
    }

    pub fn normal(&mut self) -> f32 {
        self.0.normal() as f32
    }
}
