//! The clocks that benchmarks use.

use std::time::Duration;

/// A clock for benchmarks.
#[derive(Clone, Copy)]
pub enum Clock {
    /// Wall-clock time: for work on several threads.
    Wall,
    /// Processor time of the calling thread: for work on one thread, unaffected by other threads and programs.
    Thread,
    /// Processor time of all threads of this process: the cost of work on several threads, unaffected by other
    /// processes.
    Process,
}

impl Clock {
    /// Reads the clock: the time since an arbitrary start.
    pub fn now(self) -> Duration {
        let clock = match self {
            Self::Wall => libc::CLOCK_MONOTONIC,
            Self::Thread => libc::CLOCK_THREAD_CPUTIME_ID,
            Self::Process => libc::CLOCK_PROCESS_CPUTIME_ID,
        };
        let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
        // SAFETY: the call fills the structure that it is given.
        unsafe { libc::clock_gettime(clock, &mut time) };
        Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
    }
}

/// Runs `work`; returns the seconds that it takes, and its result.
pub fn time<T>(clock: Clock, work: impl FnOnce() -> T) -> (f64, T) {
    let start = clock.now();
    let value = work();
    (clock.now().saturating_sub(start).as_secs_f64(), value)
}
