//! Demonstration
//!
//! Input that the library makes itself, for examples and tests: the same bits every time, nothing loaded from files.

use super::context::luxfer_context;
use super::guard::enter;
use super::handle::{self, Owned};
use super::pointer::Out;
use super::scene::{SceneObject, luxfer_scene};
use super::status::luxfer_status;
use crate::demo;
use crate::error::{Error, Result};
use crate::scene::Scene;
use std::sync::Arc;

/// A generated scene: a LUXFER_DEMO_ value.
pub type luxfer_demo = i32;
/// A furnished room without any light; its ceiling is the object "Ceiling".
pub const LUXFER_DEMO_TARGET_ROOM: luxfer_demo = 0;
/// An office under a grid of luminaires; camera 0 takes the photo.
pub const LUXFER_DEMO_EXEMPLAR_ROOM: luxfer_demo = 1;

/// Generates a scene; which is a LUXFER_DEMO_ value. The caller releases *scene. Any thread.
/// LUXFER_INVALID_ARGUMENT for another value; LUXFER_OUT_OF_MEMORY beyond the memory budget.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_demo_scene(
    context: *mut luxfer_context,
    which: luxfer_demo,
    scene: *mut *mut luxfer_scene,
) -> luxfer_status {
    enter(context, |object| {
        let out = Out::new(scene, "scene")?;
        out.set(handle::give(SceneObject::new(object.context(), Arc::new(generate(which)?))?));
        Ok(())
    })
}

fn generate(which: luxfer_demo) -> Result<Scene> {
    match which {
        LUXFER_DEMO_TARGET_ROOM => demo::target_room(),
        LUXFER_DEMO_EXEMPLAR_ROOM => Ok(demo::exemplar_room()?.scene),
        _ => Err(Error::argument(format!("which is {which}; it must be a LUXFER_DEMO_ value"))),
    }
}
