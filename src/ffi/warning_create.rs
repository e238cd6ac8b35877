//! Warnings of an object
//!
//! Gets the warnings of stages, transfers and scenes.

use super::guard::guard;
use super::kinds::Kind;
use super::status::{LUXFER_INVALID_ARGUMENT, LUXFER_OK, luxfer_status};
use super::warning::luxfer_warnings;
use crate::error::Error;
use std::ffi::c_void;

/// Gets the warnings about the result of an object. handle is one of:
/// - a luxfer_transfer: an implausible size of its scene, then the warnings of all stages that have a result, in their
///   order;
/// - a luxfer_rectify: about the camera, and about the plane if it has been unwarped;
/// - a luxfer_features;
/// - a luxfer_segment: its mask, compared with the strokes and with the region as they are now;
/// - a luxfer_emission: about the texture; no warnings if luxfer_emission_start_composition has only composed a
///   texture;
/// - a luxfer_relight;
/// - a luxfer_guides: about the latest motion that luxfer_guides_get_motion has computed for it;
/// - a luxfer_stylize: about the exemplar, the light and the motion of its latest result;
/// - a luxfer_scene: an implausible size, a place far from the origin, luminaires that are invisible in renderings,
///   and features of its file that are not rendered.
///
/// The caller releases *warnings. Any thread.
/// LUXFER_NOT_READY before a job has succeeded (of a transfer: before the first stage has ended);
/// LUXFER_INVALID_ARGUMENT if handle is of another kind.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_get_warnings(
    handle: *mut c_void,
    warnings: *mut *mut luxfer_warnings,
) -> luxfer_status {
    let mut list = LUXFER_INVALID_ARGUMENT;
    let status = guard(|| {
        let create = Kind::find(handle)?.create_warnings;
        let create = create.ok_or_else(|| Error::argument("the handle is of a kind of object that has no warnings"))?;
        list = create(handle, warnings);
        Ok(())
    });
    if status == LUXFER_OK { list } else { status }
}
