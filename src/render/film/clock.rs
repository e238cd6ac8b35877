//! The time budget of a render: when to stop, and when to publish an image.

use crate::error::Result;
use std::time::{Duration, Instant};

/// Smallest time between the end of one publication of an image and the start of the next, as a multiple of the time
/// that the earlier publication took. Publishing thus takes at most one eleventh of the time of a render. The finished
/// image does not depend on this ratio. [convention]
const PUBLISH_RATIO: u32 = 10;

/// Measures the time that a render has taken, and compares it with the time budget.
pub struct Clock {
    start: Instant,
    budget: Option<Duration>,
    /// Total time spent on tracing paths.
    sampling: Duration,
    /// Time that publishing the most recent image took.
    publishing: Duration,
    published: Option<Instant>,
}

impl Clock {
    /// Starts the clock with a budget in milliseconds; 0 = unlimited.
    pub fn start(budget_ms: u32) -> Self {
        let budget = (budget_ms > 0).then(|| Duration::from_millis(budget_ms.into()));
        Self { start: Instant::now(), budget, sampling: Duration::ZERO, publishing: Duration::ZERO, published: None }
    }

    /// Runs `pass`, which traces paths until the deadline that it is given, and measures its time. The deadline leaves
    /// time for publishing the final image. Before the first image is published, the deadline is `None`, so that every
    /// render yields an image.
    pub fn sample(&mut self, pass: impl FnOnce(Option<Instant>) -> Result<()>) -> Result<()> {
        let start = Instant::now();
        let deadline = self.budget.map(|b| self.start + b.saturating_sub(self.publishing));
        let result = pass(deadline.filter(|_| self.published.is_some()));
        self.sampling += start.elapsed();
        result
    }

    /// Assembles and publishes an image with `publish`, and measures the time this takes.
    pub fn publish<T>(&mut self, publish: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let value = publish();
        let end = Instant::now();
        self.publishing = end - start;
        self.published = Some(end);
        value
    }

    /// Whether to publish another image now. This is so if no image has been published yet, or if enough time has
    /// passed since the last one (see [`PUBLISH_RATIO`]).
    pub fn is_publish_due(&self) -> bool {
        self.published.is_none_or(|published| published.elapsed() >= self.publishing * PUBLISH_RATIO)
    }

    pub fn is_over(&self) -> bool {
        self.left().is_some_and(|left| left.is_zero())
    }

    /// Returns the time left for tracing, relative to the time spent on tracing so far; `None` without a budget.
    pub fn affordable_ratio(&self) -> Option<f64> {
        self.left().map(|left| left.as_secs_f64() / self.sampling.as_secs_f64().max(1e-9))
    }

    /// Returns the share of the time budget that has passed, at most 1; 0 without a budget.
    pub fn spent(&self) -> f64 {
        self.budget.map_or(0.0, |b| (self.start.elapsed().as_secs_f64() / b.as_secs_f64()).min(1.0))
    }

    fn left(&self) -> Option<Duration> {
        self.budget.map(|b| b.saturating_sub(self.publishing).saturating_sub(self.start.elapsed()))
    }
}
