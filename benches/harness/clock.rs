//! The clocks that work is held against.

use std::time::Duration;

/// Which clock a piece of work is held against.
#[derive(Clone, Copy)]
pub enum Clock {
    /// Time on the wall: for work on several threads.
    Wall,
    /// Processor time of the calling thread: for work on one thread, blind to what else the machine does.
    Thread,
    /// Processor time of all threads of this process: what work on several of them costs, whoever else is there.
    Process,
}

impl Clock {
    /// What it shows, from any start.
    pub fn now(self) -> Duration {
        let clock = match self {
            Self::Wall => libc::CLOCK_MONOTONIC,
            Self::Thread => libc::CLOCK_THREAD_CPUTIME_ID,
            Self::Process => libc::CLOCK_PROCESS_CPUTIME_ID,
        };
        let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
        // SAFETY: the call fills the structure it is given.
        unsafe { libc::clock_gettime(clock, &mut time) };
        Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
    }
}

/// Seconds that `work` takes, and what it gives.
pub fn time<T>(clock: Clock, work: impl FnOnce() -> T) -> (f64, T) {
    let start = clock.now();
    let value = work();
    ((clock.now() - start).as_secs_f64(), value)
}
