//! Context
//!
//! A context owns the worker threads, a memory budget and the error messages. All other objects are created in a
//! context and keep it alive, so objects may be released in any order. Objects of two contexts cannot be mixed
//! (LUXFER_INVALID_ARGUMENT).
//!
//! Structs: a function that fills a struct of the caller takes sizeof the struct as an argument, and stores it in the
//! first field, struct_size. Leave this field unchanged. It tells the library with which version of the header the
//! program was built. A program that was built with an older header therefore works with a newer library: settings that
//! its header lacks keep their defaults.
//!
//! Handles: each call checks its handles. NULL and a handle of another kind give LUXFER_INVALID_ARGUMENT. So does a
//! released handle, as long as its memory has not been reused; afterwards, the library cannot detect the mistake.
//!
//! Threads: "Any thread" in a comment means that any thread may call the function, at any time. Different threads may
//! use different objects at the same time, and also the same object: calls that change an object wait for each other.
//! Only the release of the last reference must not overlap with another use of the object.
//!
//! The library prints nothing, not even the message of a defect (LUXFER_INTERNAL). It reads no environment variables,
//! does not end the process on an error and installs no signal handlers. All state belongs to a context, except for
//! three things that exist once per process: tables of constants, a hook that suppresses the messages of panics inside
//! the library, and an emergency reserve of memory. The library uses the reserve for small allocations when the system
//! has no memory left; all running jobs of the process then end with LUXFER_OUT_OF_MEMORY.
//!
//! Fork: a child process does not have the threads of its parent. In the child, each call on an object that was created
//! before the fork returns LUXFER_INVALID_OPERATION at once, luxfer_context_get_last_error gives the reason, and
//! luxfer_release returns LUXFER_OK and frees nothing. A child may create contexts of its own.
//!
//! Stack: a thread of the host needs 128 KiB of stack for calls that load files or do other work before they return.
//!
//! Reproducibility: on one machine, equal inputs, parameters and seeds give results that are equal to the bit, for any
//! number of threads and any floating-point mode (rounding, flush to zero) of the host. A call sets the standard mode
//! on entry and restores the mode of the host on return. Callbacks run in the standard mode.

pub(super) use super::shared_context::{Charge, Context};

use super::guard::{enter, guard};
use super::handle::{self, Handle, Owned, tag};
use super::params::{self, versioned};
use super::pointer::{Out, copy_text};
use super::shared_context::INHERITED;
use super::status::luxfer_status;
use std::ffi::c_char;
use std::sync::Arc;

/// A context: threads, memory budget and error messages. See luxfer_context_create.
pub struct luxfer_context {
    _opaque: [u8; 0],
}

/// Settings of a context. Fill them with luxfer_context_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_context_params {
    /// sizeof(luxfer_context_params), set by luxfer_context_params_init.
    pub struct_size: u32,
    /// Number of worker threads, in [0, 1024]; 0, the default: one for each core that the process may use. All jobs
    /// share these threads. Synchronous calls, which do their work before they return, do not use them, and so never
    /// wait for a job. A synchronous call runs on the calling thread, or on a set of num_threads other threads, which
    /// it shares with no other call. The context keeps up to four idle sets for later calls.
    pub num_threads: u32,
    /// Limit in MiB on the memory of all pixels, meshes and textures that the caller creates in this context; 0, the
    /// default: no limit. A call that would exceed the limit returns LUXFER_OUT_OF_MEMORY. While a picture file is
    /// read, the memory of its decoder counts too. The working memory and the results of jobs do not count.
    pub memory_budget_mib: u64,
}

versioned!(luxfer_context_params, [16], { Self { struct_size: 16, num_threads: 0, memory_budget_mib: 0 } });

/// The object behind a `luxfer_context` handle. It holds one of the references to the context; the objects that are
/// created in the context hold the others.
pub(super) struct ContextObject(Arc<Context>);

impl Owned for ContextObject {
    fn context(&self) -> &Arc<Context> {
        &self.0
    }
}

impl Handle for luxfer_context {
    type Object = ContextObject;
    const TAG: u64 = tag(b"lux.ctxt");
    const NAME: &'static str = "luxfer_context";
}

/// Creates a context and its threads; params may be NULL for the defaults. The caller releases *context. Any thread.
/// LUXFER_INVALID_ARGUMENT if context is NULL, struct_size is wrong or num_threads exceeds 1024; LUXFER_OUT_OF_MEMORY
/// if the threads cannot be started.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_context_create(
    params: *const luxfer_context_params,
    context: *mut *mut luxfer_context,
) -> luxfer_status {
    guard(|| {
        let out = Out::new(context, "context")?;
        let params = params::read(params)?;
        crate::error::check_range("num_threads", params.num_threads, 0, 1024)?;
        let budget = params.memory_budget_mib.saturating_mul(1 << 20);
        let context = Arc::new(Context::new(params.num_threads as usize, budget)?);
        out.set(handle::give(Arc::new(ContextObject(context))));
        Ok(())
    })
}

/// Gets the message of the calling thread's latest failed call in this context: copies it into buffer as
/// zero-terminated UTF-8, truncated to capacity bytes including the zero. *needed, unless NULL, receives the capacity
/// that the whole message needs. buffer may be NULL if capacity is 0. Any thread.
///
/// If no call of this thread has failed, the message is empty. A message stays until the thread's next failure; the
/// context keeps the messages of the 256 threads that failed last. A call that fails because its first handle is not
/// valid leaves no message.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_context_get_last_error(
    context: *mut luxfer_context,
    buffer: *mut c_char,
    capacity: usize,
    needed: *mut usize,
) -> luxfer_status {
    if handle::is_inherited(context) {
        return guard(|| copy_text(INHERITED, buffer, capacity, needed));
    }
    enter(context, |object| object.context().last_message(|message| copy_text(message, buffer, capacity, needed)))
}
