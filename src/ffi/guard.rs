//! The guard of each entry point: it hides panics and their messages from the host, and turns every error into a
//! status.

pub(super) use super::entry::enter;
use super::float_mode::FloatMode;
use super::status::{LUXFER_OK, luxfer_status};
use crate::error::{Error, ErrorKind, Result};
use crate::quiet::Quiet;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, MutexGuard};

/// Runs the body of an entry point, and returns the status of its result. Entry points that take an object call it
/// through [`enter`].
pub(super) fn guard(work: impl FnOnce() -> Result<()>) -> luxfer_status {
    let (_mode, _quiet) = (FloatMode::enter(), Quiet::enter());
    match catch(work) {
        Ok(()) => LUXFER_OK,
        Err(error) => error.kind as luxfer_status,
    }
}

/// Turns a panic into an error. Data that a panic leaves half-written is never read, because results are stored only
/// after success.
pub(super) fn catch<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let message = format!("a defect in luxfer, please report it: {}", panic_text(&*panic));
        // Do not drop the payload: its destructor may panic.
        std::mem::forget(panic);
        Err(Error::new(ErrorKind::Internal, message))
    })
}

fn panic_text(panic: &(dyn Any + Send)) -> &str {
    match (panic.downcast_ref::<&str>(), panic.downcast_ref::<String>()) {
        (Some(text), _) => text,
        (_, Some(text)) => text,
        _ => "panic without a message",
    }
}

/// Locks a mutex, even if another thread panicked while it held the lock. No holder leaves the locked data inconsistent
/// when it panics.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ffi::status::{LUXFER_FORMAT, LUXFER_INTERNAL};
    use crate::job::Monitor;

    /// Causes panics on the calling thread, on a worker of a pool and on a job's thread, all of which the library
    /// catches. Then causes panics of the host, which must still print their messages.
    #[test]
    #[ignore = "a program of its own: a_defect_is_silent runs it and looks at its stderr"]
    fn has_defects() {
        assert_eq!(guard(|| panic!("a defect")), LUXFER_INTERNAL);
        let in_pool =
            || crate::exec::Pool::new(2)?.run(|| catch(|| crate::exec::map(4, Monitor::default().job(), worker)));
        assert_eq!(guard(|| in_pool().map(|_| ())), LUXFER_INTERNAL);
        let in_thread =
            || crate::exec::spawn("luxfer-job", || assert!(catch(|| worker(0)).is_err())).unwrap().join().unwrap();
        let of_thread = guard(|| {
            in_thread();
            Ok(())
        });
        assert_eq!(of_thread, LUXFER_OK);
        // Panics of the host's own code still print their message, even in a callback that the library calls.
        assert_eq!(guard(|| crate::quiet::outside(|| panic!("of the host, within"))), LUXFER_INTERNAL);
        assert!(catch_unwind(|| panic!("of the host, after")).is_err());
    }

    fn worker(_: usize) -> Result<()> {
        panic!("a defect of a worker")
    }

    #[test]
    #[cfg_attr(miri, ignore = "starts a process")]
    fn a_defect_is_silent() {
        let name = concat!(module_path!(), "::has_defects");
        let name = name.split_once("::").unwrap().1;
        let mut program = std::process::Command::new(std::env::current_exe().unwrap());
        let output = program.args([name, "--exact", "--ignored", "--nocapture"]).output().unwrap();
        let (out, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(output.status.success() && out.contains("1 passed"), "{out}{errors}");
        assert!(!errors.contains("a defect"), "{errors}");
        assert!(errors.contains("of the host, within") && errors.contains("of the host, after"), "{errors}");
    }

    #[test]
    fn panics_and_errors_become_statuses() {
        assert_eq!(guard(|| Ok(())), LUXFER_OK);
        assert_eq!(guard(|| Err(Error::format("broken"))), LUXFER_FORMAT);
        assert_eq!(guard(|| panic!("{}", 7)), LUXFER_INTERNAL);
        assert!(catch::<()>(|| panic!("code {}", 7)).unwrap_err().message.ends_with("code 7"));
    }
}
