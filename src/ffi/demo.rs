//! Demonstration
//!
//! Scenes and artworks for examples and tests. The library generates them without any files. Repeated calls give
//! results that are equal to the bit.

use super::context::luxfer_context;
use super::guard::enter;
use super::guides::luxfer_guides;
use super::handle::{self, Owned};
use super::image::{Pixels, luxfer_image};
use super::pointer::Out;
use super::scene::{SceneObject, luxfer_scene};
use super::status::luxfer_status;
use crate::demo;
use crate::demo::artwork::{self, Style};
use crate::error::{Error, Result};
use crate::scene::Scene;
use std::sync::Arc;

/// A scene that the library generates: a LUXFER_DEMO_ value.
pub type luxfer_demo = i32;
/// A furnished room without lights; its ceiling is the object "Ceiling".
pub const LUXFER_DEMO_TARGET_ROOM: luxfer_demo = 0;
/// An office under a grid of luminaires; luxfer_demo_photo takes its photo with camera 0.
pub const LUXFER_DEMO_EXEMPLAR_ROOM: luxfer_demo = 1;
/// A glossy red ball on a white table: the exemplar scene of a stylisation, of which an artist would paint a picture.
pub const LUXFER_DEMO_SPHERE_ON_TABLE: luxfer_demo = 2;
/// A vase, a ring and two balls, on the table and under the lamp of LUXFER_DEMO_SPHERE_ON_TABLE: a target scene for a
/// stylisation.
pub const LUXFER_DEMO_STILL_LIFE: luxfer_demo = 3;

/// The style of a generated artwork: a LUXFER_ARTWORK_ value.
pub type luxfer_artwork = i32;
/// Pen: hatching in two inks.
pub const LUXFER_ARTWORK_PEN: luxfer_artwork = 0;
/// Stipple: dots of two inks.
pub const LUXFER_ARTWORK_STIPPLE: luxfer_artwork = 1;
/// Paint: oil on canvas.
pub const LUXFER_ARTWORK_PAINT: luxfer_artwork = 2;

/// Generates the scene that a LUXFER_DEMO_ value selects. The caller releases *scene. Any thread.
/// LUXFER_INVALID_ARGUMENT if kind is another value; LUXFER_OUT_OF_MEMORY beyond the memory budget.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_demo_create_scene(
    context: *mut luxfer_context,
    kind: luxfer_demo,
    scene: *mut *mut luxfer_scene,
) -> luxfer_status {
    enter(context, |object| {
        let out = Out::new(scene, "scene")?;
        out.set(handle::give(SceneObject::new(object.context(), Arc::new(generate(kind)?))?));
        Ok(())
    })
}

/// Generates a picture of a scene as an artist would paint it. The parameter guides holds the rendered guide images of
/// the scene; the artwork has their size and is aligned with them. The styles are designed for
/// LUXFER_DEMO_SPHERE_ON_TABLE. style is a LUXFER_ARTWORK_ value. The call takes up to a few seconds. The caller
/// releases *image. Any thread.
/// LUXFER_INVALID_ARGUMENT if style is another value; LUXFER_NOT_READY before the guides are rendered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_demo_create_artwork(
    guides: *mut luxfer_guides,
    style: luxfer_artwork,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(guides, |stage| {
        let out = Out::new(image, "image")?;
        let style = match style {
            LUXFER_ARTWORK_PEN => Style::Pen,
            LUXFER_ARTWORK_STIPPLE => Style::Stipple,
            LUXFER_ARTWORK_PAINT => Style::Paint,
            _ => return Err(Error::argument(format!("style is {style}; it must be a LUXFER_ARTWORK_ value"))),
        };
        let guides = stage.output()?;
        let full = &guides.light[0];
        let drawn = Pixels::counted(stage.context(), full.width, full.height, 3, || artwork::draw(style, &guides))?;
        out.set(handle::give(drawn));
        Ok(())
    })
}

fn generate(kind: luxfer_demo) -> Result<Scene> {
    match kind {
        LUXFER_DEMO_TARGET_ROOM => demo::target_room(),
        LUXFER_DEMO_EXEMPLAR_ROOM => Ok(demo::exemplar_room()?.scene),
        LUXFER_DEMO_SPHERE_ON_TABLE => demo::sphere_on_table(),
        LUXFER_DEMO_STILL_LIFE => demo::still_life(),
        _ => Err(Error::argument(format!("kind is {kind}; it must be a LUXFER_DEMO_ value"))),
    }
}
