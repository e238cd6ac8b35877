//! Random draws of a room, all from its seed.

use luxfer::rng::Rng;

pub struct Dice(Rng);

impl Dice {
    /// A stream of its own for each purpose, so that a change to one leaves the others alone.
    pub fn new(seed: u64, purpose: u64) -> Self {
        Self(Rng::new(seed, &[purpose]))
    }

    /// Uniform between two numbers.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.0.next_f32()
    }

    /// Uniform in the logarithm between two positive numbers.
    pub fn log_between(&mut self, low: f32, high: f32) -> f32 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub fn chance(&mut self, probability: f32) -> bool {
        self.0.next_f32() < probability
    }

    /// Uniform in `0..count`.
    pub fn below(&mut self, count: usize) -> usize {
        self.0.below(count)
    }

    /// A whole number from a range, both ends included.
    pub fn whole(&mut self, low: usize, high: usize) -> usize {
        low + self.0.below(high - low + 1)
    }

    pub fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.0.below(of.len())]
    }

    /// One of several things by their weights.
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
