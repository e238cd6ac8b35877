//! Guides
//!
//! Renders the guide images of a stylisation: images of one scene, each of which shows one kind of its light, its
//! normals, its edges or its materials. A stylisation needs the guides of the exemplar scene and of the target scene.
//! Guides from another renderer do not need this object: see luxfer_stylize_add_guide.

use super::context::luxfer_context;
use super::guard::{enter, lock};
use super::handle::{self, Handle, Owned, tag};
use super::image::{Pixels, luxfer_image};
use super::job::luxfer_job;
use super::params::{self, versioned};
use super::pointer::Out;
use super::scene::{SceneObject, luxfer_scene, missing};
use super::stage::{Stage, need};
use super::status::luxfer_status;
use crate::error::Error;
use crate::guides::{self, Guides};
use crate::image::Image;
use crate::warning::Warning;
use std::ops::Deref;
use std::sync::{Arc, Mutex};

/// The guides of a scene. See luxfer_guides_create.
pub struct luxfer_guides {
    _opaque: [u8; 0],
}

/// A guide image: a LUXFER_GUIDES_ value. Guide images of light are linear RGB in cd/m². The expressions in parentheses
/// describe their light paths: L is a light, D a diffuse reflection, S a reflection or transmission at a glossy
/// surface, mirror or clear pane, E the camera.
pub type luxfer_guides_image = i32;
/// All light (L.*E): lights that are seen directly, and light that is reflected or transmitted any number of times.
pub const LUXFER_GUIDES_FULL: luxfer_guides_image = 0;
/// Light reflected once, by a diffuse surface (LDE).
pub const LUXFER_GUIDES_DIRECT: luxfer_guides_image = 1;
/// Light reflected or transmitted once, at a glossy surface, mirror or clear pane (LSE).
pub const LUXFER_GUIDES_SPECULAR: luxfer_guides_image = 2;
/// Light whose last two reflections were diffuse (L.*DDE): it shows colour bleeding.
pub const LUXFER_GUIDES_INDIRECT: luxfer_guides_image = 3;
/// Light reflected once or twice, by diffuse surfaces (LD{1,2}E): unlike direct light, it shows detail in shadows.
pub const LUXFER_GUIDES_TWO_BOUNCES: luxfer_guides_image = 4;
/// Unit normals in camera space: x right, y up, z towards the camera; 0 where there is no surface; 3 channels.
pub const LUXFER_GUIDES_NORMALS: luxfer_guides_image = 5;
/// Strength of the edges of shapes, in [0, 1]: changes of material, creases and jumps in depth; 1 on a clear edge, 0
/// away from edges; 1 channel.
pub const LUXFER_GUIDES_EDGES: luxfer_guides_image = 6;
/// A colour for each material, derived from its name, so that materials of equal name match in all scenes; black where
/// there is no surface; 3 channels.
pub const LUXFER_GUIDES_MATERIALS: luxfer_guides_image = 7;
/// Caustics: light that glossy surfaces, mirrors or clear panes (one or more of them) cast onto a diffuse surface,
/// which reflects it to the camera (LS+DE).
pub const LUXFER_GUIDES_CAUSTICS: luxfer_guides_image = 8;

/// Settings of the guides. Fill them with luxfer_guides_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_guides_params {
    /// sizeof(luxfer_guides_params), set by luxfer_guides_params_init.
    pub struct_size: u32,
    /// Width of the images in pixels, in [1, 32768]; default 800.
    pub width: u32,
    /// Height of the images in pixels, in [1, 32768]; default 608.
    pub height: u32,
    /// Paths per pixel, in [1, 1048576]; default 64.
    pub samples: u32,
    /// Index of the camera in the scene; default 0.
    pub camera: u32,
    /// 1, the default: smooth the light along surfaces, so that the stylisation does not match noise; 0: keep the
    /// noise.
    pub smooth: u32,
    /// Seed of the paths; default 1.
    pub seed: u64,
}

versioned!(luxfer_guides_params, [32], {
    let d = guides::Params::default();
    Self {
        struct_size: 32,
        width: d.width as u32,
        height: d.height as u32,
        samples: d.samples,
        camera: 0,
        smooth: u32::from(d.smooth),
        seed: d.seed,
    }
});

#[derive(Clone, Default)]
pub(super) struct Inputs {
    scene: Option<Arc<SceneObject>>,
}

/// The rendered guides, and the warnings about the latest motion that was computed from them.
pub(super) struct Rendered {
    guides: Guides,
    warnings: Mutex<Vec<Warning>>,
}

impl Deref for Rendered {
    type Target = Guides;

    fn deref(&self) -> &Guides {
        &self.guides
    }
}

impl Rendered {
    pub(super) fn motion_warnings(&self) -> Vec<Warning> {
        lock(&self.warnings).clone()
    }
}

impl Handle for luxfer_guides {
    type Object = Stage<Inputs, Rendered>;
    const TAG: u64 = tag(b"lux.guid");
    const NAME: &'static str = "luxfer_guides";
}

/// Creates an object that renders guides. It has no inputs yet. The caller releases *guides. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_guides_create(
    context: *mut luxfer_context,
    guides: *mut *mut luxfer_guides,
) -> luxfer_status {
    enter(context, |object| {
        Out::new(guides, "guides")?.set(handle::give(Stage::new(object.context(), Inputs::default())));
        Ok(())
    })
}

/// Sets the scene; each job renders the scene as it is when the job starts. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_guides_set_scene(
    guides: *mut luxfer_guides,
    scene: *mut luxfer_scene,
) -> luxfer_status {
    enter(guides, |stage| {
        let scene = handle::borrow_in(stage.context(), scene, "scene")?;
        stage.change(|inputs| {
            inputs.scene = Some(scene);
            Ok(())
        })
    })
}

/// Starts a job that renders the guides. params may be NULL for the defaults. The caller releases *job. Any thread.
/// LUXFER_INVALID_ARGUMENT if smooth is not 0 or 1; LUXFER_INVALID_OPERATION if the scene is missing or a job is
/// already running; LUXFER_NOT_FOUND if the scene has no such camera. The job checks the scene and the other settings,
/// and may end with LUXFER_INVALID_ARGUMENT.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_guides_start(
    guides: *mut luxfer_guides,
    params: *const luxfer_guides_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(guides, |stage| {
        let p = params::read(params)?;
        if p.smooth > 1 {
            return Err(Error::argument(format!("smooth is {}; it must be 0 or 1", p.smooth)));
        }
        let params = guides::Params {
            width: p.width as usize,
            height: p.height as usize,
            samples: p.samples,
            seed: p.seed,
            smooth: p.smooth == 1,
        };
        let object = need(&stage.inputs().scene, "luxfer_guides_set_scene")?.clone();
        let scene = object.snapshot();
        let camera = scene.cameras.get(p.camera as usize).cloned();
        let camera = camera.ok_or_else(|| missing("camera", p.camera, scene.cameras.len()))?;
        stage.start(job, move |_, _, job| {
            let world = object.world(&scene, job.part(0.0, 0.05))?;
            let guides = guides::run(&world, &camera, &params, job.part(0.05, 1.0))?;
            Ok(Rendered { guides, warnings: Mutex::default() })
        })
    })
}

/// Gets the guide image that a LUXFER_GUIDES_ value selects. The caller releases *image. Any thread.
/// LUXFER_NOT_READY before a job has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_guides_get_image(
    guides: *mut luxfer_guides,
    kind: luxfer_guides_image,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(guides, |stage| {
        let out = Out::new(image, "image")?;
        let pick: fn(&Rendered) -> &Image = match kind {
            LUXFER_GUIDES_FULL => |g| &g.light[0],
            LUXFER_GUIDES_DIRECT => |g| &g.light[1],
            LUXFER_GUIDES_SPECULAR => |g| &g.light[2],
            LUXFER_GUIDES_INDIRECT => |g| &g.light[3],
            LUXFER_GUIDES_TWO_BOUNCES => |g| &g.light[4],
            LUXFER_GUIDES_NORMALS => |g| &g.normals,
            LUXFER_GUIDES_EDGES => |g| &g.edges,
            LUXFER_GUIDES_MATERIALS => |g| &g.materials,
            LUXFER_GUIDES_CAUSTICS => |g| &g.light[5],
            _ => return Err(Error::argument(format!("kind is {kind}; it must be a LUXFER_GUIDES_ value"))),
        };
        out.set(handle::give(Pixels::part(stage.context(), stage.output()?, pick)));
        Ok(())
    })
}

/// Computes the motion between two frames of a sequence, for luxfer_stylize_set_motion. The parameter guides holds the
/// current frame, previous the frame before it. The image motion has 2 channels: for each pixel of the current frame,
/// the offset x (right) and y (down), in pixels, to the position of the pixel's surface point in the previous frame. It
/// is NaN where the previous frame does not show the point. The caller releases *motion. Any thread.
///
/// The frames may be rendered from different scenes. Camera, objects and single vertices may have moved. A mesh of the
/// current frame and a mesh of the previous frame are one object if they have equal names, numbers of vertices and
/// triangle indices. If several meshes of a frame are equal in all three, they correspond in their order, provided that
/// the other frame has as many of them. If an object has no counterpart in the previous frame, its motion is NaN, and
/// luxfer_get_warnings of guides has a warning. A pixel of a mirror or pane has the motion of the mirror or pane
/// itself, not of the objects that are seen in it.
/// LUXFER_NOT_READY before the guides of both frames are rendered; LUXFER_INVALID_ARGUMENT if their sizes differ.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_guides_get_motion(
    guides: *mut luxfer_guides,
    previous: *mut luxfer_guides,
    motion: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(guides, |stage| {
        let out = Out::new(motion, "motion")?;
        let (now, previous) = (stage.output()?, handle::borrow_in(stage.context(), previous, "previous")?.output()?);
        let (context, mut warnings) = (stage.context(), Vec::new());
        let image = Pixels::counted(context, now.surfaces.width, now.surfaces.height, 2, || {
            let monitor = context.monitor();
            let motion = context.quick.run(|| guides::motion(&now.surfaces, &previous.surfaces, monitor.job()))?;
            warnings = motion.warnings();
            Ok(motion.image)
        })?;
        *lock(&now.warnings) = warnings;
        out.set(handle::give(image));
        Ok(())
    })
}
