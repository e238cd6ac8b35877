//! Handles: a handle points to a `Shell`, which holds a tag for the kind of the object and a reference to the object.
//!
//! The shell counts the references of the host. The object inside counts the references of the library: a job keeps its
//! stage alive, and an image keeps its context alive. If the host releases an object once too often, only the handle
//! becomes invalid; the object stays alive as long as the library uses it.

use super::context::Context;
use crate::error::{Error, Result};
use std::ffi::c_void;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// An object behind a handle. It belongs to a context.
pub(super) trait Owned {
    /// Returns the context that the object belongs to.
    fn context(&self) -> &Arc<Context>;
}

/// The opaque C type of a handle, and the type of the object behind it.
pub(super) trait Handle {
    type Object: Owned;
    /// The tag of this kind of handle: the first eight bytes of the memory that the handle points to.
    const TAG: u64;
    /// Name of the C type.
    const NAME: &'static str;
}

/// Value that overwrites the tag when the last reference of the host is gone.
const RELEASED: u64 = tag(b"released");

/// Makes a tag of eight letters, which a memory dump shows as text.
pub(super) const fn tag(name: &[u8; 8]) -> u64 {
    u64::from_ne_bytes(*name)
}

#[repr(C)]
struct Shell<T> {
    tag: AtomicU64,
    object: Arc<T>,
}

impl<T> Drop for Shell<T> {
    fn drop(&mut self) {
        // The store is atomic, so that the compiler does not remove it as a store to memory about to be freed.
        self.tag.store(RELEASED, Ordering::Release);
    }
}

/// Creates a handle with one reference, which the host owns.
pub(super) fn give<H: Handle>(object: Arc<H::Object>) -> *mut H {
    let shell = Shell { tag: AtomicU64::new(H::TAG), object };
    Arc::into_raw(Arc::new(shell)).cast_mut().cast()
}

/// Reads the tag of a handle: the first eight bytes at the pointer. `None` if the pointer is null or misaligned.
pub(super) fn read_tag(handle: *const c_void) -> Option<u64> {
    let tag: *const AtomicU64 = handle.cast();
    // SAFETY: the tag of a valid handle is readable at any time. A pointer that is not a handle is the host's mistake;
    // reading one aligned word is the least harmful way to detect it.
    (!tag.is_null() && tag.is_aligned()).then(|| unsafe { (*tag).load(Ordering::Acquire) })
}

/// Returns the [`Shell`] that a handle points to; an error if its tag is not `H::TAG`.
fn shell<H: Handle>(handle: *const H, name: &str) -> Result<*const Shell<H::Object>> {
    if handle.is_null() {
        return Err(Error::argument(format!("{name} is NULL; it must be a {}", H::NAME)));
    }
    if read_tag(handle.cast()) == Some(H::TAG) {
        Ok(handle.cast())
    } else {
        Err(Error::argument(format!("{name} is not a live {}", H::NAME)))
    }
}

/// Returns the object behind a handle and keeps it alive for the length of the call. Returns an error in a forked
/// child of the process that created the object.
pub(super) fn borrow<H: Handle>(handle: *const H, name: &str) -> Result<Arc<H::Object>> {
    let shell = shell(handle, name)?;
    // SAFETY: the tag is right, so the shell is alive and holds an object.
    let object = unsafe { &(*shell).object };
    object.context().check_process()?;
    Ok(object.clone())
}

/// Whether a handle is live, but was created in the parent process before this process was forked.
pub(super) fn is_inherited<H: Handle>(handle: *const H) -> bool {
    // SAFETY: as in `borrow`.
    shell(handle, "the handle").is_ok_and(|shell| unsafe { (*shell).object.context().check_process().is_err() })
}

/// Returns the object behind `handle`, an argument of a call in `context`; an error if the object belongs to another
/// context.
pub(super) fn borrow_in<H: Handle>(context: &Arc<Context>, handle: *const H, name: &str) -> Result<Arc<H::Object>> {
    let object = borrow(handle, name)?;
    if Arc::ptr_eq(object.context(), context) {
        Ok(object)
    } else {
        Err(Error::argument(format!("{name} belongs to another context; objects of two contexts cannot be mixed")))
    }
}

/// Adds a reference that the host holds.
pub(super) fn retain<H: Handle>(handle: *mut H) -> Result<()> {
    let shell = shell(handle, "the handle")?;
    // SAFETY: the shell came from `Arc::into_raw` in `give` and is alive.
    unsafe {
        (*shell).object.context().check_process()?;
        Arc::increment_strong_count(shell);
    }
    Ok(())
}

/// Removes a reference that the host holds.
pub(super) fn release<H: Handle>(handle: *mut H) -> Result<()> {
    let shell = shell(handle, "the handle")?;
    // SAFETY: as in `retain`; this is the reference that the host gives back.
    unsafe {
        // In a forked child there are no threads to join, and a lock that another thread held during the fork stays
        // locked. So the object is not freed.
        if (*shell).object.context().check_process().is_ok() {
            drop(Arc::from_raw(shell));
        }
    }
    Ok(())
}
