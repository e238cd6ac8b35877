//! References
//!
//! Handles of every kind are reference counted: a create function returns one reference, luxfer_retain adds one,
//! luxfer_release removes one, and removing the last reference frees the object. Objects may be released in any order.
//! An object that is given an image, a scene or another object as an input holds a reference of its own, so the caller
//! may release the input at once.

use super::guard::guard;
use super::kinds::Kind;
use super::status::luxfer_status;
use std::ffi::c_void;

/// Adds a reference to an object of any kind. Any thread.
/// LUXFER_INVALID_ARGUMENT if handle is NULL or not a live object; the failure leaves no message.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_retain(handle: *mut c_void) -> luxfer_status {
    guard(|| (Kind::find(handle)?.retain)(handle))
}

/// Removes a reference to an object of any kind; NULL does nothing. Any thread.
///
/// An object may outlive the caller's references to it: a context lives until its last object is freed, and a stage
/// with a running job lives until the job has ended. Two kinds of release take time. Releasing the last reference to a
/// job cancels the job and waits until it has ended. The release that frees a context waits until the context's worker
/// threads have ended.
/// LUXFER_INVALID_ARGUMENT if handle is not a live object; the failure leaves no message.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_release(handle: *mut c_void) -> luxfer_status {
    guard(|| if handle.is_null() { Ok(()) } else { (Kind::find(handle)?.release)(handle) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ffi::status::{LUXFER_INVALID_ARGUMENT, LUXFER_OK};
    use std::ptr::null_mut;

    #[test]
    fn only_live_handles_are_counted() {
        let mut context = null_mut();
        let mut memory = [u64::MAX; 4];
        let stranger: *mut c_void = memory.as_mut_ptr().cast();
        // SAFETY: valid arguments, and memory that holds no handle.
        unsafe {
            assert_eq!(crate::ffi::luxfer_context_create(std::ptr::null(), &raw mut context), LUXFER_OK);
            let context = context.cast();
            assert_eq!(luxfer_retain(null_mut()), LUXFER_INVALID_ARGUMENT);
            assert_eq!(luxfer_release(null_mut()), LUXFER_OK);
            for bad in [stranger, stranger.byte_add(1)] {
                assert_eq!(luxfer_retain(bad), LUXFER_INVALID_ARGUMENT);
                assert_eq!(luxfer_release(bad), LUXFER_INVALID_ARGUMENT);
            }
            assert_eq!(luxfer_retain(context), LUXFER_OK);
            assert_eq!(luxfer_release(context), LUXFER_OK);
            assert_eq!(luxfer_release(context), LUXFER_OK);
        }
    }
}
