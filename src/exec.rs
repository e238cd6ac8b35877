//! The library's own thread pool, and parallel loops whose results do not depend on the number of threads.
//!
//! rayon's global pool is never used, because it belongs to the host and cannot be shut down. When a rayon pool is
//! dropped, it only tells its threads to end and does not wait for them. [`Pool`] therefore keeps the handles of its
//! threads and joins them.

use crate::error::{Error, ErrorKind, Result};
use crate::job::Job;
use crate::quiet::{self, Quiet};
use crate::reserve;
use rayon::prelude::*;
use std::io;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::thread::{self, JoinHandle};
use std::time::Duration;

pub struct Pool {
    threads: Option<rayon::ThreadPool>,
    handles: Vec<JoinHandle<()>>,
}

impl Pool {
    /// Creates a pool of `num_threads` threads; 0 stands for one thread per core that is available to this process.
    pub fn new(num_threads: usize) -> Result<Self> {
        let cores = thread::available_parallelism().map_or(1, |n| n.get());
        let count = if num_threads == 0 { cores } else { num_threads };
        let handles = Mutex::new(Vec::new());
        let threads = rayon::ThreadPoolBuilder::new()
            .num_threads(count)
            .spawn_handler(|thread| {
                let handle = spawn(&format!("luxfer-{}", thread.index()), || thread.run())?;
                lock(&handles).push(handle);
                Ok(())
            })
            .build()
            .map_err(|e| Error::new(ErrorKind::OutOfMemory, format!("could not start {count} threads: {e}")))?;
        Ok(Self { threads: Some(threads), handles: handles.into_inner().unwrap_or_else(|e| e.into_inner()) })
    }

    /// Runs `work` on this pool: all parallel loops in `work` use the threads of this pool. Must not be called from a
    /// thread of the pool.
    pub fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.threads {
            Some(threads) => threads.install(work),
            None => work(),
        }
    }

    /// Like [`run`](Self::run), but can be cancelled while `work` waits for a free thread: if `is_cancelled` returns
    /// true during this wait, drops `work` and returns `None`. Once `work` has begun, it runs to its end. `work` must
    /// not panic.
    pub fn run_unless<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
        is_cancelled: impl Fn() -> bool,
    ) -> Option<T> {
        let Some(threads) = &self.threads else { return Some(work()) };
        let queued = Arc::new(Queued { state: Mutex::new(Progress::Waiting(work)), changed: Condvar::new() });
        let of_worker = queued.clone();
        threads.spawn(move || of_worker.run());
        queued.result(is_cancelled)
    }
}

/// A closure in the queue of a pool, and later its result.
struct Queued<W, T> {
    state: Mutex<Progress<W, T>>,
    changed: Condvar,
}

enum Progress<W, T> {
    Waiting(W),
    /// A worker has taken the closure and runs it, or `result` has dropped the closure.
    Begun,
    Finished(T),
}

impl<W: FnOnce() -> T, T> Queued<W, T> {
    /// Runs the closure, unless it was dropped.
    fn run(&self) {
        let begun = std::mem::replace(&mut *lock(&self.state), Progress::Begun);
        let Progress::Waiting(work) = begun else { return };
        let result = work();
        *lock(&self.state) = Progress::Finished(result);
        self.changed.notify_all();
    }

    /// Waits for the result. If `is_cancelled` returns true before a worker has begun the closure, drops the closure
    /// and returns `None`.
    fn result(&self, is_cancelled: impl Fn() -> bool) -> Option<T> {
        let mut state = lock(&self.state);
        loop {
            match std::mem::replace(&mut *state, Progress::Begun) {
                Progress::Finished(result) => return Some(result),
                Progress::Waiting(_) if is_cancelled() => return None,
                other => *state = other,
            }
            let time = if matches!(*state, Progress::Waiting(_)) { CANCEL_INTERVAL } else { Duration::MAX };
            let waited = self.changed.wait_timeout(state, time);
            state = waited.unwrap_or_else(|e| e.into_inner()).0;
        }
    }
}

/// Interval at which waiting work checks for cancellation. It is a fifth of 100 ms, the longest time within which a
/// cancel request must be answered.
const CANCEL_INTERVAL: Duration = Duration::from_millis(20);

/// Pools for short work that must not wait behind long work in the main pool. Each call of [`run`](Self::run) uses a
/// pool of `num_threads` threads that no other call uses at the same time.
pub struct ShortTaskPools {
    num_threads: usize,
    idle: Mutex<Vec<Pool>>,
}

/// Maximum number of idle pools to keep. It suffices for the few threads of a host that call the library at the same
/// time.
const MAX_IDLE: usize = 4;

impl ShortTaskPools {
    pub fn new(num_threads: usize) -> Self {
        Self { num_threads, idle: Mutex::default() }
    }

    /// Runs `work` on an idle pool, or on a new one. Must not be called from a thread of a pool.
    pub fn run<T: Send>(&self, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
        let idle = lock(&self.idle).pop();
        let pool = idle.map_or_else(|| Pool::new(self.num_threads), Ok)?;
        let result = pool.run(work);
        // Drop a surplus pool only after the lock is released, because dropping it waits for its threads.
        let mut surplus = Some(pool);
        let mut idle = lock(&self.idle);
        if idle.len() < MAX_IDLE {
            idle.extend(surplus.take());
        }
        drop(idle);
        result
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Starts a thread. The thread suppresses panic messages if the thread that starts it does. Returns the error
/// `OutOfMemory` if fewer than `THREAD_OVERHEAD` bytes are left.
pub fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<JoinHandle<()>> {
    if !reserve::can_allocate(THREAD_OVERHEAD) {
        return Err(io::ErrorKind::OutOfMemory.into());
    }
    let is_quiet = quiet::is_on();
    let work = move || {
        let _quiet = is_quiet.then(Quiet::enter);
        work();
    };
    thread::Builder::new().name(name.into()).stack_size(STACK).spawn(work)
}

/// Stack size of a thread (`STACK`), and an upper bound of the other memory that starting a thread takes
/// (`THREAD_OVERHEAD`), in bytes.
const STACK: usize = 4 << 20;
const THREAD_OVERHEAD: usize = 256 << 10;

impl Drop for Pool {
    fn drop(&mut self) {
        drop(self.threads.take());
        for handle in self.handles.drain(..) {
            let _ = handle.join();
        }
    }
}

// The parallel loops call their closures through `dyn`, so that rayon's code is compiled once for each type of item.
// With one copy for each closure, a sixth of the code that the compiler had to optimise was rayon's.

/// Calls `work(row, pixels)` for every row of an interleaved image, in parallel. Checks for cancellation before each
/// row.
pub fn for_rows<T: Send>(
    data: &mut [T],
    row_len: usize,
    job: Job,
    work: impl Fn(usize, &mut [T]) + Sync,
) -> Result<()> {
    if row_len == 0 || data.is_empty() {
        return job.check();
    }
    let rows = data.len() / row_len;
    let done = AtomicUsize::new(0);
    for_runs(&mut data[..rows * row_len], row_len, job, |first, row| {
        work(first / row_len, row);
        job.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / rows as f64);
    })
}

/// Divides `data` into runs of `length` consecutive items and calls `work(first, items)` for every run, in parallel.
/// `first` is the index of the run's first item; the last run may be shorter. Checks for cancellation before each run,
/// but reports no progress.
pub fn for_runs<T: Send>(data: &mut [T], length: usize, job: Job, work: impl Fn(usize, &mut [T]) + Sync) -> Result<()> {
    for_runs_dyn(data, length, job, &work)
}

fn for_runs_dyn<T: Send>(
    data: &mut [T],
    length: usize,
    job: Job,
    work: &(dyn Fn(usize, &mut [T]) + Sync),
) -> Result<()> {
    data.par_chunks_mut(length.max(1)).enumerate().try_for_each(|(run, items)| {
        job.check()?;
        work(run * length, items);
        Ok(())
    })
}

/// Like [`for_rows`], with scratch memory: calls `work(scratch, row, pixels)`. One thread computes several rows one
/// after the other with the same memory, which `new_scratch` allocates. `work` must therefore reset `scratch`.
pub fn for_rows_with<T: Send, S>(
    data: &mut [T],
    row_len: usize,
    job: Job,
    new_scratch: impl Fn() -> Result<S> + Sync,
    work: impl Fn(&mut S, usize, &mut [T]) + Sync,
) -> Result<()> {
    if row_len == 0 || data.is_empty() {
        return job.check();
    }
    let rows = data.len() / row_len;
    let done = AtomicUsize::new(0);
    data.par_chunks_exact_mut(row_len).enumerate().try_for_each_init(&new_scratch, |scratch, (y, row)| {
        job.check()?;
        work(scratch.as_mut().map_err(|error| error.clone())?, y, row);
        job.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / rows as f64);
        Ok(())
    })
}

/// Like [`for_rows`], for three images of equal size: calls `work(y, [a, b, c])`, where `a`, `b` and `c` are row `y` of
/// each image. A row has `row_len` items.
pub fn for_rows_of_three<T: Send>(
    images: [&mut [T]; 3],
    row_len: usize,
    job: Job,
    work: impl Fn(usize, [&mut [T]; 3]) + Sync,
) -> Result<()> {
    let [a, b, c] = images;
    if row_len == 0 || a.is_empty() {
        return job.check();
    }
    let rows = a.len() / row_len;
    let done = AtomicUsize::new(0);
    let rows_of = |image| <[T]>::par_chunks_exact_mut(image, row_len);
    rows_of(a).zip(rows_of(b)).zip(rows_of(c)).enumerate().try_for_each(|(y, ((a, b), c))| {
        job.check()?;
        work(y, [a, b, c]);
        job.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / rows as f64);
        Ok(())
    })
}

/// Computes `work(i)` for `i` in `0..count`, in parallel. The results are in the order of `i` for any number of
/// threads, so that a reduction over them is reproducible bit by bit.
pub fn map<T: Send>(count: usize, job: Job, work: impl Fn(usize) -> T + Sync) -> Result<Vec<T>> {
    map_dyn(count, job, &work)
}

fn map_dyn<T: Send>(count: usize, job: Job, work: &(dyn Fn(usize) -> T + Sync)) -> Result<Vec<T>> {
    let done = AtomicUsize::new(0);
    let mut places = list_with_capacity(count)?;
    places.resize_with(count, || None);
    places.par_iter_mut().enumerate().try_for_each(|(i, place)| {
        job.check()?;
        *place = Some(work(i));
        job.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / count as f64);
        Ok(())
    })?;
    let mut values = list_with_capacity(count)?;
    values.extend(places.into_iter().flatten());
    Ok(values)
}

/// Returns an empty list with memory for `count` items, or an error if there is no memory.
fn list_with_capacity<T>(count: usize) -> Result<Vec<T>> {
    let none = || Error::new(ErrorKind::OutOfMemory, format!("could not allocate {count} results"));
    reserve::list(count).ok_or_else(none)
}

/// Runs two closures, in parallel if a thread is free, and returns their results.
pub fn both<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(a, b)
}

/// Largest number of items to sort or to partition without a check for cancellation; sorting them takes a few
/// milliseconds.
const MAX_UNCHECKED_SORT: usize = 1 << 16;

/// Number of sampled items; their median is the pivot. The standard deviation of the pivot's rank is 0.5 / √1001 = 1.6
/// % of the number of items.
const SAMPLE: usize = 1001;

/// Sorts in parallel and checks for cancellation. After cancellation, the order is unspecified.
pub fn sort<T: Ord + Copy + Send>(data: &mut [T], job: Job) -> Result<()> {
    job.check()?;
    if data.len() <= MAX_UNCHECKED_SORT {
        data.sort_unstable();
        return Ok(());
    }
    let mut middle = partition(data, job)?;
    // If the pivot was far from the median, halve the data exactly instead, so that the recursion stays shallow.
    if middle.min(data.len() - middle) < data.len() / 16 {
        middle = data.len() / 2;
        data.select_nth_unstable(middle);
    }
    let (low, high) = data.split_at_mut(middle);
    let (low, high) = rayon::join(|| sort(low, job), || sort(high, job));
    low.and(high)
}

/// Moves the items below a pivot to the front and returns their number (Lomuto's partition without branches). The pivot
/// is the median of evenly spaced items.
fn partition<T: Ord + Copy>(data: &mut [T], job: Job) -> Result<usize> {
    let mut sample = [data[0]; SAMPLE];
    let step = data.len() / SAMPLE;
    sample.iter_mut().enumerate().for_each(|(i, item)| *item = data[i * step]);
    let (.., pivot, _) = sample.select_nth_unstable(SAMPLE / 2);
    let mut below = 0;
    for first in (0..data.len()).step_by(MAX_UNCHECKED_SORT) {
        job.check()?;
        for i in first..data.len().min(first + MAX_UNCHECKED_SORT) {
            let is_below = data[i] < *pivot;
            data.swap(i, below);
            below += usize::from(is_below);
        }
    }
    Ok(below)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;
    use std::sync::atomic::AtomicBool;

    #[test]
    fn the_pool_ends_with_its_owner_and_results_keep_their_order() {
        let monitor = Monitor::default();
        for threads in [1, 2, 7] {
            let pool = Pool::new(threads).unwrap();
            let squares = pool.run(|| map(1000, monitor.job(), |i| i * i)).unwrap();
            assert!(squares.iter().enumerate().all(|(i, &s)| s == i * i));
        }
    }

    #[test]
    fn queued_work_is_given_up_when_cancelled_and_dropped_by_its_owner() {
        let (pool, gate, token) = (Pool::new(1).unwrap(), Arc::new(Mutex::new(())), Arc::new(()));
        let closed = lock(&gate);
        let (begun, cancelled) = (Arc::new(std::sync::Barrier::new(2)), AtomicBool::new(false));
        thread::scope(|scope| {
            let (gate, at_begin, kept) = (gate.clone(), begun.clone(), token.clone());
            let blocked = move || {
                at_begin.wait();
                drop(lock(&gate));
            };
            let first = scope.spawn(|| pool.run_unless(blocked, || cancelled.load(Ordering::Relaxed)));
            begun.wait();
            cancelled.store(true, Ordering::Relaxed);
            assert_eq!(pool.run_unless(move || drop(kept), || true), None);
            assert_eq!(Arc::strong_count(&token), 1, "the work is gone with its captures");
            drop(closed);
            assert_eq!(first.join().unwrap(), Some(()), "work that has begun is finished");
        });
        assert_eq!(pool.run_unless(|| 7, || false), Some(7));
    }

    #[test]
    fn quick_runs_have_a_pool_each_and_few_pools_stay() {
        let pools = ShortTaskPools::new(2);
        let together = std::sync::Barrier::new(MAX_IDLE + 2);
        thread::scope(|scope| {
            let runs = [(); MAX_IDLE + 2].map(|()| {
                scope.spawn(|| {
                    pools.run(|| {
                        together.wait();
                        map(100, Monitor::default().job(), |i| i)
                    })
                })
            });
            runs.into_iter().for_each(|run| assert_eq!(run.join().unwrap().unwrap(), (0..100).collect::<Vec<_>>()));
        });
        assert_eq!(lock(&pools.idle).len(), MAX_IDLE);
    }

    #[test]
    fn rows_of_three_images_go_together() {
        let monitor = Monitor::default();
        let (mut a, mut b, mut c) = (vec![0; 12], vec![1; 12], vec![2; 12]);
        for_rows_of_three([&mut a, &mut b, &mut c], 4, monitor.job(), |y, rows| {
            rows.into_iter().for_each(|row| row.iter_mut().for_each(|v| *v += 10 * y));
        })
        .unwrap();
        for (image, start) in [(a, 0), (b, 1), (c, 2)] {
            assert!(image.iter().enumerate().all(|(i, &v)| v == start + 10 * (i / 4)));
        }
    }

    #[test]
    fn rows_share_scratch_memory_and_fail_without_it() {
        let (monitor, pool) = (Monitor::default(), Pool::new(2).unwrap());
        let mut data = vec![0; 4000];
        let mut run = |new_scratch: &(dyn Fn() -> Result<Vec<usize>> + Sync)| {
            pool.run(|| {
                for_rows_with(&mut data, 4, monitor.job(), new_scratch, |scratch, y, row| {
                    scratch.push(y);
                    row.fill(scratch.len());
                })
            })
        };
        let count = AtomicUsize::new(0);
        run(&|| {
            count.fetch_add(1, Ordering::Relaxed);
            Ok(Vec::new())
        })
        .unwrap();
        let none = run(&|| Err(Error::new(ErrorKind::OutOfMemory, "no memory"))).unwrap_err();
        assert_eq!(none.kind, ErrorKind::OutOfMemory);
        // Each row holds how often its scratch memory has been used. A row of ones is the first use of a scratch
        // memory, so there must be as many such rows as scratch memories.
        let (count, first) = (count.into_inner(), data.chunks(4).filter(|row| **row == [1; 4]).count());
        assert!(count == first && count < 500 && !data.contains(&0), "{count} {first}");
    }

    #[test]
    fn sorting_is_that_of_the_standard_library() {
        let count = 3 * MAX_UNCHECKED_SORT as u64;
        let random = |range: u64| (0..count).map(|i| crate::rng::mix(i) % range).collect::<Vec<_>>();
        // Every item that `partition` picks for its sample is 0. The pivot therefore is 0, and no item is below the
        // pivot.
        let unlike_its_sample =
            (0..count).map(|i| if i % (count / SAMPLE as u64) == 0 { 0 } else { count - i }).collect();
        for mut numbers in
            [random(100_000), random(2), vec![7; count as usize], (0..count).collect(), unlike_its_sample]
        {
            let mut sorted = numbers.clone();
            sorted.sort_unstable();
            Pool::new(2).unwrap().run(|| sort(&mut numbers, Monitor::default().job())).unwrap();
            assert!(numbers == sorted);
        }
    }

    #[test]
    fn a_cancelled_sort_stops_with_an_error() {
        let monitor = Monitor::default();
        monitor.cancel();
        assert_eq!(sort(&mut [2, 1], monitor.job()).unwrap_err().kind, ErrorKind::Cancelled);
    }

    #[test]
    fn a_cancelled_loop_stops_with_an_error() {
        let monitor = Monitor::default();
        let pool = Pool::new(2).unwrap();
        let result = pool.run(|| {
            map(1_000_000, monitor.job(), |i| {
                if i == 10 {
                    monitor.cancel();
                }
            })
        });
        assert_eq!(result.unwrap_err().kind, ErrorKind::Cancelled);
    }
}
