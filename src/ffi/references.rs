//! References
//!
//! Handles of every kind are reference counted: a create function returns one reference, luxfer_retain adds one,
//! luxfer_release removes one, and removing the last reference frees the object. Objects may be released in any order.

use super::candidates::luxfer_candidates;
use super::context::luxfer_context;
use super::demo_photo::luxfer_demo_photo;
use super::distribution::luxfer_distribution;
use super::emission::luxfer_emission;
use super::features::luxfer_features;
use super::guard::guard;
use super::guides::luxfer_guides;
use super::handle::{self, Handle};
use super::illuminance::luxfer_illuminance;
use super::image::luxfer_image;
use super::importance::luxfer_importance;
use super::job::luxfer_job;
use super::lamps::luxfer_lamps;
use super::plan::luxfer_plan;
use super::rectify::luxfer_rectify;
use super::relight::luxfer_relight;
use super::render::luxfer_render;
use super::scene::luxfer_scene;
use super::segment::luxfer_segment;
use super::status::luxfer_status;
use super::strokes::luxfer_strokes;
#[cfg(feature = "stylize")]
use super::stylize::luxfer_stylize;
use super::transfer::luxfer_transfer;
use super::warning::luxfer_warnings;
use crate::error::{Error, Result};
use std::ffi::c_void;

/// How to count the references of one kind of handle.
struct Kind {
    tag: u64,
    retain: fn(*mut c_void) -> Result<()>,
    release: fn(*mut c_void) -> Result<()>,
}

impl Kind {
    const fn of<H: Handle>() -> Self {
        Self {
            tag: H::TAG,
            retain: |handle| handle::retain::<H>(handle.cast()),
            release: |handle| handle::release::<H>(handle.cast()),
        }
    }

    /// The kind whose tag the handle shows.
    fn find(handle: *mut c_void) -> Result<&'static Self> {
        let tag = handle::read_tag(handle);
        KINDS
            .iter()
            .find(|kind| tag == Some(kind.tag))
            .ok_or_else(|| Error::argument("the handle is not a live object of luxfer"))
    }
}

/// All kinds of handles.
const KINDS: &[Kind] = &[
    Kind::of::<luxfer_candidates>(),
    Kind::of::<luxfer_context>(),
    Kind::of::<luxfer_demo_photo>(),
    Kind::of::<luxfer_distribution>(),
    Kind::of::<luxfer_emission>(),
    Kind::of::<luxfer_features>(),
    Kind::of::<luxfer_guides>(),
    Kind::of::<luxfer_illuminance>(),
    Kind::of::<luxfer_image>(),
    Kind::of::<luxfer_importance>(),
    Kind::of::<luxfer_job>(),
    Kind::of::<luxfer_lamps>(),
    Kind::of::<luxfer_plan>(),
    Kind::of::<luxfer_rectify>(),
    Kind::of::<luxfer_relight>(),
    Kind::of::<luxfer_render>(),
    Kind::of::<luxfer_scene>(),
    Kind::of::<luxfer_segment>(),
    Kind::of::<luxfer_strokes>(),
    #[cfg(feature = "stylize")]
    Kind::of::<luxfer_stylize>(),
    Kind::of::<luxfer_transfer>(),
    Kind::of::<luxfer_warnings>(),
];

/// Adds a reference to an object of any kind. Any thread.
/// LUXFER_INVALID_ARGUMENT if handle is NULL or not a live object; the failure leaves no message.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_retain(handle: *mut c_void) -> luxfer_status {
    guard(|| (Kind::find(handle)?.retain)(handle))
}

/// Removes a reference to an object of any kind; NULL does nothing. Any thread.
///
/// An object may outlive the caller's references: a context lives as long as the objects created in it, and a stage as
/// long as its job, which continues. Two releases take time. The last reference to a job cancels the job and waits
/// until it has ended; the last reference to a context and all objects created in it waits until the worker threads
/// have ended.
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

    /// A kind that is missing here could never be released.
    #[test]
    #[cfg(feature = "stylize")]
    #[cfg_attr(miri, ignore = "reads files")]
    fn every_kind_is_listed_once() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/ffi");
        let sources = folder.read_dir().unwrap().map(|file| std::fs::read_to_string(file.unwrap().path()).unwrap());
        let count: usize = sources.map(|source| source.matches("\nimpl Handle for ").count()).sum();
        assert_eq!(KINDS.len(), count);
        for (i, kind) in KINDS.iter().enumerate() {
            assert!(KINDS[..i].iter().all(|other| other.tag != kind.tag));
        }
    }

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
