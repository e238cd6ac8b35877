//! Stands in for stylisation in builds without the Cargo feature `stylize`. Such a build exports the symbols of
//! stylisation too, so that a program made for the whole library still starts. No stylisation can be created, so all
//! other calls fail; releasing NULL is allowed as always.

use super::context::luxfer_context;
use super::guard::{enter, guard};
use super::status::luxfer_status;
use crate::error::{Error, Result};
use std::ffi::c_void;

pub(super) fn left_out() -> Result<()> {
    Err(Error::left_out("stylisation was", "stylize"))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_create(context: *mut luxfer_context, _: *mut *mut c_void) -> luxfer_status {
    enter(context, |_| left_out())
}

/// Defines functions that take no parameters, whereas the header declares some. This is safe: in the C calling
/// convention the caller removes the arguments, so a function may ignore them.
macro_rules! absent {
    ($($name:ident)*) => {$(
        #[unsafe(no_mangle)]
        pub extern "C" fn $name() -> luxfer_status {
            guard(left_out)
        }
    )*};
}

absent! {
    luxfer_stylize_get_preset luxfer_stylize_set_artwork luxfer_stylize_add_guide
    luxfer_stylize_add_guides luxfer_stylize_clear_guides luxfer_stylize_set_source_mask
    luxfer_stylize_set_target_mask luxfer_stylize_set_painted
    luxfer_stylize_set_motion
    luxfer_stylize_start luxfer_stylize_update luxfer_stylize_get_image luxfer_stylize_get_report
    luxfer_plan_start_stylize luxfer_plan_get_stylize_params
}
