//! The kinds of handles, and for each kind the functions behind luxfer_retain, luxfer_release and luxfer_get_warnings.

use super::candidates::luxfer_candidates;
use super::context::luxfer_context;
use super::demo_photo::luxfer_demo_photo;
use super::distribution::luxfer_distribution;
use super::emission::luxfer_emission;
use super::features::luxfer_features;
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
use super::warning::{self, HasWarnings, luxfer_warnings};
use crate::error::{Error, Result};
use std::ffi::c_void;

/// A function that creates the list of warnings of an object; there is one for each kind with warnings.
type CreateWarnings = fn(*mut c_void, *mut *mut luxfer_warnings) -> luxfer_status;

/// One kind of handle, with the functions that serve it.
pub(super) struct Kind {
    tag: u64,
    pub retain: fn(*mut c_void) -> Result<()>,
    pub release: fn(*mut c_void) -> Result<()>,
    /// `None` for kinds that have no warnings.
    pub create_warnings: Option<CreateWarnings>,
}

impl Kind {
    const fn of<H: Handle>() -> Self {
        Self {
            tag: H::TAG,
            retain: |handle| handle::retain::<H>(handle.cast()),
            release: |handle| handle::release::<H>(handle.cast()),
            create_warnings: None,
        }
    }

    const fn with_warnings<H: HasWarnings>() -> Self {
        Self { create_warnings: Some(warning::create::<H>), ..Self::of::<H>() }
    }

    /// Finds the kind of a handle by its tag; an error if no kind has this tag.
    pub fn find(handle: *mut c_void) -> Result<&'static Self> {
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
    Kind::with_warnings::<luxfer_emission>(),
    Kind::with_warnings::<luxfer_features>(),
    Kind::with_warnings::<luxfer_guides>(),
    Kind::of::<luxfer_illuminance>(),
    Kind::of::<luxfer_image>(),
    Kind::of::<luxfer_importance>(),
    Kind::of::<luxfer_job>(),
    Kind::of::<luxfer_lamps>(),
    Kind::of::<luxfer_plan>(),
    Kind::with_warnings::<luxfer_rectify>(),
    Kind::with_warnings::<luxfer_relight>(),
    Kind::of::<luxfer_render>(),
    Kind::with_warnings::<luxfer_scene>(),
    Kind::with_warnings::<luxfer_segment>(),
    Kind::of::<luxfer_strokes>(),
    #[cfg(feature = "stylize")]
    Kind::with_warnings::<luxfer_stylize>(),
    Kind::with_warnings::<luxfer_transfer>(),
    Kind::of::<luxfer_warnings>(),
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares `KINDS` with the sources: a handle of a kind that is missing could never be released.
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
}
