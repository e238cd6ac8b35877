//! Job
//!
//! Functions with _start in their names, and luxfer_stylize_update, start long work and return a job at once; the job
//! runs on threads of the library. The job works on the inputs as they are at its start: changing or releasing them
//! later does not affect the job. A function that sets an input makes only the checks that its comment names. The job
//! checks whether all inputs are valid and fit together, and otherwise ends with LUXFER_INVALID_ARGUMENT. While a job
//! runs, its object refuses changes and further jobs (LUXFER_INVALID_OPERATION). Read the results from the object after
//! the job has succeeded. Releasing the last reference to a running job cancels the job and waits until it has ended.
//!
//! Jobs of one context share its threads, so a job may have to wait until another job ends; a cancel request ends a
//! waiting job at once. Only two calls wait for a job: luxfer_job_wait, and luxfer_release of the last reference to a
//! running job.

use super::context::Context;
use super::guard::{catch, enter, lock};
use super::handle::{Handle, Owned, tag};
use super::pointer::Out;
use super::status::{LUXFER_NOT_READY, LUXFER_OK, luxfer_status};
use crate::error::{Error, ErrorKind, Result};
use crate::exec::spawn;
use crate::job::Monitor;
use crate::quiet;
use std::ffi::c_void;
use std::sync::{Arc, Condvar, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// A job: work in progress. See luxfer_job_wait.
pub struct luxfer_job {
    _opaque: [u8; 0],
}

/// Receives the progress of a job: fraction is in [0, 1] and never falls. It is 1 only in the last call, after the job
/// has succeeded. Return 0 to continue, any other value to cancel the job. luxfer_job_wait calls the function about 50
/// times a second, on the waiting thread and with no lock held, so it may call any luxfer function. The function must
/// not throw an exception or leave by longjmp.
pub type luxfer_progress_fn = Option<unsafe extern "C" fn(user: *mut c_void, fraction: f64) -> i32>;

/// Interval between two calls of the progress function by a waiting thread.
const REPORT_INTERVAL: Duration = Duration::from_millis(20);

/// The object behind a `luxfer_job` handle. It keeps the context alive until the job's thread has ended. Otherwise the
/// job's thread or a worker of the pool could drop the last reference to the pool. Dropping the pool joins its threads,
/// so the dropping thread would wait for itself.
pub(super) struct Job {
    context: Arc<Context>,
    shared: Arc<Shared>,
    thread: Mutex<Option<JoinHandle<()>>>,
}

/// State that the job's thread and the waiting threads share.
struct Shared {
    monitor: Arc<Monitor>,
    result: Mutex<Option<Result<()>>>,
    finished: Condvar,
}

impl Owned for Job {
    fn context(&self) -> &Arc<Context> {
        &self.context
    }
}

impl Handle for luxfer_job {
    type Object = Job;
    const TAG: u64 = tag(b"lux.jobs");
    const NAME: &'static str = "luxfer_job";
}

impl Job {
    /// Starts a thread that runs `work` in the context's pool. If the job is cancelled before the pool begins `work`,
    /// the job ends at once.
    pub(super) fn start(
        context: &Arc<Context>,
        work: impl FnOnce(crate::job::Job) -> Result<()> + Send + 'static,
    ) -> Result<Self> {
        Self::on_thread(context, |context, monitor| {
            let in_pool = monitor.clone();
            let work = move || catch(|| work(in_pool.job()));
            let result = context.pool.run_unless(work, || monitor.is_cancelled());
            result.unwrap_or_else(|| Err(Error::cancelled()))
        })
    }

    /// Starts a thread that runs `work` outside the pool. `work` must not panic.
    pub(super) fn on_thread(
        context: &Arc<Context>,
        work: impl FnOnce(&Arc<Context>, &Arc<Monitor>) -> Result<()> + Send + 'static,
    ) -> Result<Self> {
        let shared = Arc::new(Shared { monitor: Arc::default(), result: Mutex::new(None), finished: Condvar::new() });
        let run = {
            let (context, shared) = (context.clone(), shared.clone());
            move || {
                let result = work(&context, &shared.monitor);
                *lock(&shared.result) = Some(result);
                shared.finished.notify_all();
            }
        };
        let thread = spawn("luxfer-job", run)
            .map_err(|e| Error::new(ErrorKind::OutOfMemory, format!("could not start a thread for the job: {e}")))?;
        Ok(Self { context: context.clone(), shared, thread: Mutex::new(Some(thread)) })
    }

    /// Waits up to `time` and returns the result; `None` if the job has not ended by then.
    fn wait(&self, time: Duration) -> Option<Result<()>> {
        let result = lock(&self.shared.result);
        let waited = self.shared.finished.wait_timeout_while(result, time, |r| r.is_none());
        waited.unwrap_or_else(|poisoned| poisoned.into_inner()).0.clone()
    }
}

impl Drop for Job {
    fn drop(&mut self) {
        self.shared.monitor.cancel();
        // The function of luxfer_job_start may release its own job. This code then runs on the job's own thread, which
        // cannot wait for itself.
        let is_other = |thread: &JoinHandle<()>| thread.thread().id() != thread::current().id();
        if let Some(thread) = lock(&self.thread).take().filter(is_other) {
            // The thread catches all panics, so `join` returns no error.
            let _ = thread.join();
        }
    }
}

/// Waits until a job has ended or timeout_ms milliseconds have passed; a negative timeout_ms waits without limit, and 0
/// does not wait. During the wait, the call passes the progress and the pointer user to the function progress, which
/// may be NULL. Any thread; several threads may wait for one job.
///
/// *outcome receives the status of the work: LUXFER_OK if the job has succeeded, LUXFER_CANCELLED if a cancel request
/// came in time, LUXFER_NOT_READY if the job still runs, and otherwise the error with which the job has ended. For an
/// error, luxfer_context_get_last_error then gives the message of the job. The call itself returns LUXFER_OK for every
/// outcome. If the function of another job (luxfer_job_start) waits for this job, a cancel request to the other job
/// also cancels this job.
/// LUXFER_INVALID_ARGUMENT if outcome is NULL; LUXFER_INVALID_OPERATION if the function of a job waits for its own job.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_job_wait(
    job: *mut luxfer_job,
    timeout_ms: i32,
    progress: luxfer_progress_fn,
    user: *mut c_void,
    outcome: *mut luxfer_status,
) -> luxfer_status {
    enter(job, |job| {
        let out = Out::new(outcome, "outcome")?;
        let deadline = u64::try_from(timeout_ms).ok().map(|ms| Instant::now() + Duration::from_millis(ms));
        let mut progress = progress;
        let caller = job.context.calling_job();
        if timeout_ms != 0 && caller.as_ref().is_some_and(|caller| Arc::ptr_eq(caller, &job.shared.monitor)) {
            return Err(Error::new(ErrorKind::InvalidOperation, "the function of a job cannot wait for its own job"));
        }
        loop {
            if caller.as_ref().is_some_and(|caller| caller.is_cancelled()) {
                job.shared.monitor.cancel();
            }
            // Sleep until the job ends, the next report is due, or time is up.
            let left = deadline.map_or(Duration::MAX, |d| d.saturating_duration_since(Instant::now()));
            let result = job.wait(left.min(REPORT_INTERVAL));

            // Report the progress to the job whose function waits here, if any, and to the progress function. Only the
            // last report has the fraction 1.
            if let Some(caller) = &caller {
                caller.job().report(job.shared.monitor.progress());
            }
            let fraction = match &result {
                Some(Ok(())) => Some(1.0),
                Some(Err(_)) => None,
                None => Some(job.shared.monitor.progress().min(1.0 - f64::EPSILON)),
            };
            if let (Some(report), Some(fraction)) = (progress, fraction) {
                // SAFETY: the caller's function, with the caller's pointer.
                if quiet::outside(|| unsafe { report(user, fraction) }) != 0 {
                    job.shared.monitor.cancel();
                    progress = None;
                }
            }
            // The progress function may have forked the process: in the child there is no job to wait for.
            job.context.check_process()?;
            match result {
                Some(Ok(())) => out.set(LUXFER_OK),
                Some(Err(error)) => {
                    job.context.remember(&error);
                    out.set(error.kind as luxfer_status);
                }
                None if deadline.is_some_and(|d| Instant::now() >= d) => out.set(LUXFER_NOT_READY),
                None => continue,
            }
            return Ok(());
        }
    })
}

/// Gets the progress of a job without waiting, in [0, 1]; it is 1 only after success. The call succeeds whether the job
/// runs, has succeeded or has failed; luxfer_job_wait says which. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_job_get_progress(job: *mut luxfer_job, fraction: *mut f64) -> luxfer_status {
    enter(job, |job| {
        let out = Out::new(fraction, "fraction")?;
        let progress = job.shared.monitor.progress().min(1.0 - f64::EPSILON);
        out.set(if matches!(job.wait(Duration::ZERO), Some(Ok(()))) { 1.0 } else { progress });
        Ok(())
    })
}

/// Asks a job to end early and returns at once; the job ends within about 100 ms. A request cannot be withdrawn. A
/// request after the end of the job has no effect. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_job_cancel(job: *mut luxfer_job) -> luxfer_status {
    enter(job, |job| {
        job.shared.monitor.cancel();
        Ok(())
    })
}
