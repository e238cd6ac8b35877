//! Functions of the caller as jobs
//!
//! Synchronous calls, such as loading a file, warping an image or getting an image of a result, may take long for
//! large inputs. luxfer_job_start runs any sequence of calls as a job, so that a user interface can show its progress
//! and cancel it.

use super::context::luxfer_context;
use super::guard::{catch, enter};
use super::handle::{self, Owned};
use super::job::{Job, luxfer_job};
use super::pointer::Out;
use super::shared_context::Context;
use super::status::{LUXFER_OK, luxfer_status, luxfer_status_get_name};
use crate::error::{Error, ErrorKind};
use crate::quiet;
use std::ffi::{CStr, c_void};
use std::sync::Arc;

/// A function of the caller that runs as a job; it receives the pointer given to luxfer_job_start and returns the
/// status with which the job ends. It must not throw an exception or leave by longjmp.
pub type luxfer_work_fn = Option<unsafe extern "C" fn(user: *mut c_void) -> i32>;

/// A pointer of the caller that is handed to the caller's function on another thread.
struct User(*mut c_void);

// SAFETY: luxfer_job_start says that the function runs on another thread; what it does there is the caller's concern.
unsafe impl Send for User {}

/// Starts a job that runs work, a function of the caller, on a thread of its own with 4 MiB of stack. The function
/// receives the pointer user, and may call any function of the library. The job reports the progress of the calls that
/// the function makes in this context, and of the jobs that it waits for; the reported progress never falls. The caller
/// releases *job. Any thread.
///
/// A cancel request to this job also cancels the jobs that the function waits for, and makes the function's calls in
/// this context end with LUXFER_CANCELLED. A call that loads a file then ends before the next mesh or picture.
///
/// If the function returns an error, the job ends with this error. The message of the job is the message of the last
/// call that failed on the job's thread, or of the last job that failed while the function waited for it. The error
/// LUXFER_NOT_READY is replaced by LUXFER_INVALID_OPERATION, because LUXFER_NOT_READY is the outcome of a job that
/// still runs.
/// LUXFER_INVALID_ARGUMENT if work is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_job_start(
    context: *mut luxfer_context,
    work: luxfer_work_fn,
    user: *mut c_void,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(context, |object| {
        let out = Out::new(job, "job")?;
        let work =
            work.ok_or_else(|| Error::argument("work is NULL; it must be a function that returns a luxfer_status"))?;
        let user = User(user);
        let job = Job::on_thread(object.context(), move |context, monitor| {
            let user = user;
            let watched = context.watch_thread(monitor.clone());
            // SAFETY: the caller's function, with the caller's pointer.
            let status = catch(|| Ok(quiet::outside(|| unsafe { work(user.0) })));
            drop(watched);
            match status? {
                LUXFER_OK => Ok(()),
                _ if monitor.is_cancelled() => Err(Error::cancelled()),
                status => Err(error(context, status)),
            }
        })?;
        out.set(handle::give(Arc::new(job)));
        Ok(())
    })
}

/// Makes the error of a job from the status that the caller's function has returned.
fn error(context: &Context, status: luxfer_status) -> Error {
    let kind = match ErrorKind::from_value(status).unwrap_or(ErrorKind::Unknown) {
        // This status is the outcome of a job that still runs, so a caller would wait for ever.
        ErrorKind::NotReady => ErrorKind::InvalidOperation,
        kind => kind,
    };
    // SAFETY: the pointer leads to a static, zero-terminated string.
    let name = unsafe { CStr::from_ptr(luxfer_status_get_name(status)) }.to_string_lossy();
    let message = context.last_message(|message| match message {
        "" => format!("the function of the job returned {status} ({name})"),
        message => message.to_owned(),
    });
    Error::new(kind, message)
}
