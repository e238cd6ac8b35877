//! Demonstration photo
//!
//! Generates a photo of LUXFER_DEMO_EXEMPLAR_ROOM, as a camera would take it, and strokes on the photo, as a user would
//! paint them. Examples and tests pass both to a lighting transfer, so that they need no files.

use super::context::luxfer_context;
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::image::{Pixels, luxfer_image};
use super::job::luxfer_job;
use super::params::{self, versioned};
use super::pointer::Out;
use super::stage::Stage;
use super::status::luxfer_status;
use crate::demo::{self, photo};
use crate::error::{Error, check_range};
use crate::image::Image;
use std::sync::Arc;

/// A generator of the demonstration photo. See luxfer_demo_photo_create.
pub struct luxfer_demo_photo {
    _opaque: [u8; 0],
}

/// An image of the demonstration photo: a LUXFER_DEMO_PHOTO_ value.
pub type luxfer_demo_photo_image = i32;
/// The photo: linear RGB, 1 = display white; lamps are clipped to white.
pub const LUXFER_DEMO_PHOTO_PICTURE: luxfer_demo_photo_image = 0;
/// The strokes on the photo, as a drawing in the colours of luxfer_strokes_add_image.
pub const LUXFER_DEMO_PHOTO_STROKES: luxfer_demo_photo_image = 1;

/// Settings of the demonstration photo. Fill them with luxfer_demo_photo_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_demo_photo_params {
    /// sizeof(luxfer_demo_photo_params), set by luxfer_demo_photo_params_init.
    pub struct_size: u32,
    /// Width in pixels, in [16, 8192]; default 600.
    pub width: u32,
    /// Height in pixels, in [16, 8192]; default 400. The camera is designed for an aspect ratio of 3:2.
    pub height: u32,
    /// Paths per pixel, in [2, 1048576]; default 12, which leaves visible noise.
    pub samples: u32,
    /// Seed of the paths and of the sensor noise; default 1.
    pub seed: u64,
}

versioned!(luxfer_demo_photo_params, [24], {
    let d = photo::Params::default();
    Self { struct_size: 24, width: d.width as u32, height: d.height as u32, samples: d.samples, seed: d.seed }
});

/// The result of the generator: the photo and the drawing of its strokes.
pub(super) struct Output {
    picture: Image,
    strokes: Image,
}

impl Handle for luxfer_demo_photo {
    type Object = Stage<(), Output>;
    const TAG: u64 = tag(b"lux.demo");
    const NAME: &'static str = "luxfer_demo_photo";
}

/// Creates a generator of the demonstration photo. The caller releases *demo. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_demo_photo_create(
    context: *mut luxfer_context,
    demo: *mut *mut luxfer_demo_photo,
) -> luxfer_status {
    enter(context, |object| {
        Out::new(demo, "demo")?.set(handle::give(Stage::new(object.context(), ())));
        Ok(())
    })
}

/// Starts a job that renders the photo. params may be NULL for the defaults. The caller releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if a job is already running; LUXFER_INVALID_ARGUMENT if a setting is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_demo_photo_start(
    demo: *mut luxfer_demo_photo,
    params: *const luxfer_demo_photo_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(demo, |stage| {
        let p = params::read(params)?;
        let (width, height) = (
            check_range("demo.width", p.width, 16, 8192)? as usize,
            check_range("demo.height", p.height, 16, 8192)? as usize,
        );
        let samples = check_range("demo.samples", p.samples, 2, 1 << 20)?;
        let params = photo::Params { width, height, samples, seed: p.seed };
        stage.start(job, move |(), _, job| {
            let room = demo::exemplar_room()?;
            let strokes = demo::drawing(&demo::strokes(&room, width, height)?, width, height)?;
            let camera = room.scene.cameras[room.camera].clone();
            let (picture, _) = photo::photograph(Arc::new(room.scene), &camera, &params, job)?;
            Ok(Output { picture, strokes })
        })
    })
}

/// Gets the image that a LUXFER_DEMO_PHOTO_ value selects: the photo or its strokes. The caller releases *image. Any
/// thread.
/// LUXFER_NOT_READY before a job has succeeded; LUXFER_INVALID_ARGUMENT if kind is another value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_demo_photo_get_image(
    demo: *mut luxfer_demo_photo,
    kind: luxfer_demo_photo_image,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(demo, |stage| {
        let out = Out::new(image, "image")?;
        let pick: fn(&Output) -> &Image = match kind {
            LUXFER_DEMO_PHOTO_PICTURE => |t| &t.picture,
            LUXFER_DEMO_PHOTO_STROKES => |t| &t.strokes,
            _ => return Err(Error::argument(format!("kind is {kind}; it must be a LUXFER_DEMO_PHOTO_ value"))),
        };
        out.set(handle::give(Pixels::part(stage.context(), stage.output()?, pick)));
        Ok(())
    })
}
