//! Progress reports of long computations, and requests to cancel them.
//!
//! The thread that works and the threads that watch share a [`Monitor`]. The worker reports through a [`Job`], which
//! stands for a span of the whole progress bar. A routine reports progress from 0 to 1 within its job, and need not
//! know which span its caller gave it.

use crate::error::{Error, ErrorKind, Result};
use crate::reserve;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// The state of a job: its progress in `[0, 1]`, which never falls, and whether the job is cancelled, which cannot be
/// undone.
pub struct Monitor {
    cancelled: AtomicBool,
    /// How often the memory reserve had been used in this process when the job started.
    uses: u64,
    /// Progress as the bits of an `f64`. Non-negative floats sort like their bits as integers, so `fetch_max` keeps
    /// the progress from falling.
    progress: AtomicU64,
    /// For tests: a function that is called at every check for cancellation.
    #[cfg(test)]
    pub at_check: Option<Box<dyn Fn() + Send + Sync>>,
}

impl Default for Monitor {
    fn default() -> Self {
        Self {
            cancelled: AtomicBool::new(false),
            uses: reserve::uses(),
            progress: AtomicU64::new(0),
            #[cfg(test)]
            at_check: None,
        }
    }
}

impl Monitor {
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    pub fn progress(&self) -> f64 {
        f64::from_bits(self.progress.load(Ordering::Relaxed))
    }

    /// Returns a job that spans the whole progress bar.
    pub fn job(&self) -> Job<'_> {
        Job { monitor: self, start: 0.0, span: 1.0 }
    }
}

#[derive(Clone, Copy)]
pub struct Job<'a> {
    monitor: &'a Monitor,
    start: f64,
    span: f64,
}

impl<'a> Job<'a> {
    /// Returns the sub-job that spans the part of this job between the fractions `from` and `to`.
    pub fn part(self, from: f64, to: f64) -> Job<'a> {
        debug_assert!((0.0..=1.0).contains(&from) && from <= to && to <= 1.0);
        Job { monitor: self.monitor, start: self.start + self.span * from, span: self.span * (to - from) }
    }

    /// Reports which fraction of this job is done, in `[0, 1]`.
    pub fn report(self, fraction: f64) {
        let whole = (self.start + self.span * fraction.clamp(0.0, 1.0)).clamp(0.0, 1.0);
        self.monitor.progress.fetch_max(whole.to_bits(), Ordering::Relaxed);
    }

    /// Returns an error if the job was cancelled, or if memory ran so short that the memory reserve has been used
    /// since the job started. Call it at least every few milliseconds.
    pub fn check(self) -> Result<()> {
        if self.is_cancelled() {
            Err(Error::cancelled())
        } else if reserve::uses() != self.monitor.uses {
            Err(Error::new(
                ErrorKind::OutOfMemory,
                "the process ran out of memory, if only for a moment: even a small allocation failed",
            ))
        } else {
            Ok(())
        }
    }

    pub fn is_cancelled(self) -> bool {
        #[cfg(test)]
        if let Some(call) = &self.monitor.at_check {
            call();
        }
        self.monitor.is_cancelled()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_map_onto_the_whole_and_progress_never_falls() {
        let monitor = Monitor::default();
        let half = monitor.job().part(0.5, 1.0);
        half.part(0.0, 0.5).report(1.0);
        assert_eq!(monitor.progress(), 0.75);
        monitor.job().report(0.1);
        assert_eq!(monitor.progress(), 0.75);
        half.report(1.0);
        assert_eq!(monitor.progress(), 1.0);
    }

    #[test]
    fn a_cancel_request_reaches_every_part() {
        let monitor = Monitor::default();
        let part = monitor.job().part(0.2, 0.4);
        assert!(part.check().is_ok());
        monitor.cancel();
        assert_eq!(part.check(), Err(Error::cancelled()));
    }
}
