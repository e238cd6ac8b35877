//! The object behind a `luxfer_context` handle: the threads, error messages and memory budget.

use super::guard::lock;
use crate::error::{Error, ErrorKind, Result};
use crate::exec::{Pool, ShortTaskPools};
use crate::job::Monitor;
use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, ThreadId};

/// Maximum number of threads whose last error message a context keeps. If more threads fail, the oldest message is
/// dropped.
const MAX_MESSAGES: usize = 256;

/// The object behind a `luxfer_context` handle, shared by all objects that are created in it.
pub(super) struct Context {
    /// Threads that run the jobs.
    pub(super) pool: Pool,
    /// Threads of synchronous calls. `pool` has other threads, so that these calls never wait for a job.
    pub(super) quick: ShortTaskPools,
    budget: u64,
    used: AtomicU64,
    messages: Mutex<Messages>,
    /// The threads that run functions of the caller as jobs, each with the monitor of its job.
    callers: Mutex<Vec<(ThreadId, Arc<Monitor>)>>,
    /// Id of the process that created the context; a forked child has another id.
    process: u32,
}

/// The error message for a call in a forked child process on an object that the parent process created.
pub(super) const INHERITED: &str = "this object was created before the process was forked, and its threads did not come along; \
                         create a context and its objects in the child process";

/// The last error message of each thread, with a count that tells which thread failed last. A map is used because
/// thread-local storage would outlive the context and the library.
#[derive(Default)]
struct Messages {
    count: u64,
    by_thread: HashMap<ThreadId, (u64, String)>,
}

impl Context {
    /// Starts the threads that run jobs. A budget of 0 bytes stands for no limit.
    pub(super) fn new(num_threads: usize, budget: u64) -> Result<Self> {
        Ok(Self {
            pool: Pool::new(num_threads)?,
            quick: ShortTaskPools::new(num_threads),
            budget,
            used: AtomicU64::new(0),
            messages: Mutex::default(),
            callers: Mutex::default(),
            process: std::process::id(),
        })
    }

    /// Returns an error in a forked child of the process that created the context. Takes no lock: if another thread
    /// held the lock during the fork, that thread does not exist in the child and would never release the lock.
    pub(super) fn check_process(&self) -> Result<()> {
        if self.process == std::process::id() {
            Ok(())
        } else {
            Err(Error::new(ErrorKind::InvalidOperation, INHERITED))
        }
    }

    /// Stores the message of an error for the calling thread.
    pub(super) fn remember(&self, error: &Error) {
        let messages = &mut *lock(&self.messages);
        messages.count += 1;
        messages.by_thread.insert(thread::current().id(), (messages.count, error.message.clone()));
        if messages.by_thread.len() > MAX_MESSAGES
            && let Some(oldest) = messages.by_thread.iter().min_by_key(|(_, (count, _))| *count).map(|(id, _)| *id)
        {
            messages.by_thread.remove(&oldest);
        }
    }

    /// Calls `read` with the last message of the calling thread, or with an empty text if there is none.
    pub(super) fn last_message<T>(&self, read: impl FnOnce(&str) -> T) -> T {
        let messages = lock(&self.messages);
        read(messages.by_thread.get(&thread::current().id()).map_or("", |(_, text)| text.as_str()))
    }

    /// Makes all calls of the current thread report to `monitor` and obey its cancel requests, until the returned
    /// guard is dropped.
    pub(super) fn watch_thread(&self, monitor: Arc<Monitor>) -> WatchedThread<'_> {
        lock(&self.callers).push((thread::current().id(), monitor));
        WatchedThread(self)
    }

    /// Returns the monitor of the job whose function makes the current call; `None` outside such functions.
    pub(super) fn calling_job(&self) -> Option<Arc<Monitor>> {
        let id = thread::current().id();
        lock(&self.callers).iter().find(|(thread, _)| *thread == id).map(|(_, monitor)| monitor.clone())
    }

    /// Returns the monitor of a synchronous call: the monitor of the job whose function makes the call, or a new one.
    pub(super) fn monitor(&self) -> Arc<Monitor> {
        self.calling_job().unwrap_or_default()
    }

    /// Charges `bytes` to the memory budget until the returned charge is dropped.
    pub(super) fn charge(self: &Arc<Self>, bytes: u64) -> Result<Charge> {
        let take = |used: u64| used.checked_add(bytes).filter(|&sum| self.budget == 0 || sum <= self.budget);
        match self.used.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take) {
            Ok(_) => Ok(Charge { context: self.clone(), bytes }),
            Err(used) => {
                let mib = |bytes: u64| bytes as f64 / (1 << 20) as f64;
                Err(Error::new(
                    ErrorKind::OutOfMemory,
                    format!(
                        "{:.1} MiB are needed and {:.1} of the context's budget of {:.1} MiB are in use; release \
                         objects or raise luxfer_context_params.memory_budget_mib",
                        mib(bytes),
                        mib(used),
                        mib(self.budget)
                    ),
                ))
            }
        }
    }
}

/// Ends the effect of [`Context::watch_thread`] when it is dropped.
pub(super) struct WatchedThread<'a>(&'a Context);

impl Drop for WatchedThread<'_> {
    fn drop(&mut self) {
        let id = thread::current().id();
        lock(&self.0.callers).retain(|(thread, _)| *thread != id);
    }
}

/// Bytes that are charged to the memory budget until this value is dropped.
pub(super) struct Charge {
    context: Arc<Context>,
    bytes: u64,
}

impl Drop for Charge {
    fn drop(&mut self) {
        self.context.used.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}
