//! Status
//!
//! Every function that can fail returns a luxfer_status. Values are never changed or reused; new values may be added.
//! A function writes its outputs only if it returns LUXFER_OK. luxfer_context_get_last_error describes a failure in
//! words. The comment of a function lists its errors. Some errors hold for every function, even if its comment does not
//! name them: LUXFER_INVALID_ARGUMENT for a NULL pointer unless the comment allows NULL, and for an argument whose type
//! has constants and whose value is not one of them; LUXFER_OUT_OF_MEMORY if the memory budget of the context, or the
//! machine, is used up.

use std::ffi::c_char;

/// The result of a call: LUXFER_OK, or the reason for the failure.
pub type luxfer_status = i32;

/// Success.
pub const LUXFER_OK: luxfer_status = 0;
/// An error that has no status value of its own.
pub const LUXFER_UNKNOWN: luxfer_status = 1;
/// A parameter is NULL, out of range, of the wrong kind or from another context, or contradicts another parameter.
pub const LUXFER_INVALID_ARGUMENT: luxfer_status = 2;
/// The call is not allowed in the object's present state: a job is still running on it, or an input is missing.
pub const LUXFER_INVALID_OPERATION: luxfer_status = 3;
/// The memory budget of the context, or the machine, is used up.
pub const LUXFER_OUT_OF_MEMORY: luxfer_status = 4;
/// The file or the request is valid, but uses a feature that this library does not support.
pub const LUXFER_UNSUPPORTED: luxfer_status = 5;
/// The job was cancelled by the caller.
pub const LUXFER_CANCELLED: luxfer_status = 6;
/// The operating system could not read or write a file, or the caller's write function returned an error.
pub const LUXFER_IO: luxfer_status = 7;
/// A file is truncated or corrupt, or does not have the format that it claims.
pub const LUXFER_FORMAT: luxfer_status = 8;
/// A result was requested before its job has succeeded, or a wait timed out.
pub const LUXFER_NOT_READY: luxfer_status = 9;
/// A bug in this library: please report it.
pub const LUXFER_INTERNAL: luxfer_status = 10;
/// The input is well formed but has no answer: for example a photo without lines, a plane seen edge-on, or strokes of
/// one class only.
pub const LUXFER_DEGENERATE: luxfer_status = 11;
/// No surface, image or entry has the given name or index.
pub const LUXFER_NOT_FOUND: luxfer_status = 12;
/// No solution exists: no emitted light reaches the target, or the other lights alone exceed the wanted value.
pub const LUXFER_UNREACHABLE: luxfer_status = 13;

/// Returns the name of a status, such as "LUXFER_FORMAT"; "LUXFER_UNKNOWN" for a number that is not a status. The
/// string is static: never free it. Any thread.
#[unsafe(no_mangle)]
pub extern "C" fn luxfer_status_get_name(status: luxfer_status) -> *const c_char {
    let name = match status {
        LUXFER_OK => c"LUXFER_OK",
        LUXFER_INVALID_ARGUMENT => c"LUXFER_INVALID_ARGUMENT",
        LUXFER_INVALID_OPERATION => c"LUXFER_INVALID_OPERATION",
        LUXFER_OUT_OF_MEMORY => c"LUXFER_OUT_OF_MEMORY",
        LUXFER_UNSUPPORTED => c"LUXFER_UNSUPPORTED",
        LUXFER_CANCELLED => c"LUXFER_CANCELLED",
        LUXFER_IO => c"LUXFER_IO",
        LUXFER_FORMAT => c"LUXFER_FORMAT",
        LUXFER_NOT_READY => c"LUXFER_NOT_READY",
        LUXFER_INTERNAL => c"LUXFER_INTERNAL",
        LUXFER_DEGENERATE => c"LUXFER_DEGENERATE",
        LUXFER_NOT_FOUND => c"LUXFER_NOT_FOUND",
        LUXFER_UNREACHABLE => c"LUXFER_UNREACHABLE",
        _ => c"LUXFER_UNKNOWN",
    };
    name.as_ptr()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;
    use std::ffi::CStr;

    #[test]
    fn statuses_are_the_error_kinds_and_have_names() {
        for (status, kind) in [
            (LUXFER_UNKNOWN, ErrorKind::Unknown),
            (LUXFER_INVALID_ARGUMENT, ErrorKind::InvalidArgument),
            (LUXFER_INVALID_OPERATION, ErrorKind::InvalidOperation),
            (LUXFER_OUT_OF_MEMORY, ErrorKind::OutOfMemory),
            (LUXFER_UNSUPPORTED, ErrorKind::Unsupported),
            (LUXFER_CANCELLED, ErrorKind::Cancelled),
            (LUXFER_IO, ErrorKind::Io),
            (LUXFER_FORMAT, ErrorKind::Format),
            (LUXFER_NOT_READY, ErrorKind::NotReady),
            (LUXFER_INTERNAL, ErrorKind::Internal),
            (LUXFER_DEGENERATE, ErrorKind::Degenerate),
            (LUXFER_NOT_FOUND, ErrorKind::NotFound),
            (LUXFER_UNREACHABLE, ErrorKind::Unreachable),
        ] {
            assert_eq!(ErrorKind::from_value(status), Some(kind));
            // SAFETY: a static string.
            let name = unsafe { CStr::from_ptr(luxfer_status_get_name(status)) }.to_str().unwrap();
            let kind = format!("LUXFER_{kind:?}").replace('_', "").to_uppercase();
            assert_eq!(name.replace('_', ""), kind);
        }
    }
}
