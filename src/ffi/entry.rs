//! Runs the entry points that take an object: checks the handle and keeps the message of an error.

use super::guard::{catch, guard};
use super::handle::{self, Handle, Owned};
use super::status::luxfer_status;
use crate::error::Result;
use std::sync::Arc;

/// Runs `work` on the object behind a handle. If `work` fails, the object's context keeps the message for the calling
/// thread.
pub(super) fn enter<H: Handle>(handle: *const H, work: impl FnOnce(&Arc<H::Object>) -> Result<()>) -> luxfer_status {
    guard(|| {
        let object = handle::borrow(handle, "the handle")?;
        let result = catch(|| work(&object));
        if let Err(error) = &result {
            object.context().remember(error);
        }
        result
    })
}
