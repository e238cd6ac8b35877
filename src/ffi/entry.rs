//! Entry points on an object.

use super::guard::{catch, guard};
use super::handle::{self, Handle, Owned};
use super::status::luxfer_status;
use crate::error::Result;
use std::sync::Arc;

/// Runs an entry point on an object. The context of the object keeps the message of an error for the calling thread.
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
