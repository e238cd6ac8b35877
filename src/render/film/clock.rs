//! Time: how much is left, and what it will be spent on.

use crate::error::Result;
use std::time::{Duration, Instant};

/// Time between two published images, in times of what publishing one costs.
const PUBLISH_RATIO: u32 = 10;

/// The time a render has taken, and the time it has.
pub struct Clock {
    start: Instant,
    budget: Option<Duration>,
    /// Time spent on paths.
    sampling: Duration,
    /// What making and handing over an image took last.
    publishing: Duration,
    published: Option<Instant>,
}

impl Clock {
    /// Starts with a budget in milliseconds; 0 = no end.
    pub fn start(budget_ms: u32) -> Self {
        let budget = (budget_ms > 0).then(|| Duration::from_millis(budget_ms.into()));
        Self { start: Instant::now(), budget, sampling: Duration::ZERO, publishing: Duration::ZERO, published: None }
    }

    /// Runs a pass, which must end by the deadline: what remains then is for the last image. Only the first pass, which is
    /// coarse, has no deadline: there is always an image.
    pub fn sample(&mut self, pass: impl FnOnce(Option<Instant>) -> Result<()>) -> Result<()> {
        let start = Instant::now();
        let deadline = self.budget.map(|b| self.start + b.saturating_sub(self.publishing));
        let result = pass(deadline.filter(|_| self.published.is_some()));
        self.sampling += start.elapsed();
        result
    }

    /// Makes an image and hands it over.
    pub fn publish<T>(&mut self, publish: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let value = publish();
        let end = Instant::now();
        self.publishing = end - start;
        self.published = Some(end);
        value
    }

    /// Whether so much has been done since the last image that another one is worth its time; the first always is.
    pub fn is_publish_due(&self) -> bool {
        self.published.is_none_or(|published| published.elapsed() >= self.publishing * PUBLISH_RATIO)
    }

    pub fn is_over(&self) -> bool {
        self.left().is_some_and(|left| left.is_zero())
    }

    /// How many times as much time is left for paths as they have taken so far; none without a budget.
    pub fn affordable_ratio(&self) -> Option<f64> {
        self.left().map(|left| left.as_secs_f64() / self.sampling.as_secs_f64().max(1e-9))
    }

    /// Share of the budget that is gone; 0 without one.
    pub fn spent(&self) -> f64 {
        self.budget.map_or(0.0, |b| (self.start.elapsed().as_secs_f64() / b.as_secs_f64()).min(1.0))
    }

    fn left(&self) -> Option<Duration> {
        self.budget.map(|b| b.saturating_sub(self.publishing).saturating_sub(self.start.elapsed()))
    }
}
