//! Scene requirements
//!
//! What the renderer finds out about a scene before the first ray: which ways of scattering and which lights can occur, and
//! how much light a bounce can leave. What cannot occur is left out of tracing, which changes no image. Nothing here has to
//! be called: it tells what is done anyway.

use super::guard::enter;
use super::handle::Owned;
use super::params::{Report, Versioned};
use super::pointer::copy_text;
use super::query::LUXFER_NONE;
use super::scene::{SceneObject, luxfer_scene};
use super::status::luxfer_status;
use crate::error::{Error, Result};
use crate::job::Monitor;
use crate::render::World;
use std::ffi::c_char;
use std::sync::Arc;

/// Some surface scatters diffusely.
pub const LUXFER_SCATTERING_DIFFUSE: u32 = 1;
/// Some surface has a rough reflecting layer.
pub const LUXFER_SCATTERING_GLOSSY: u32 = 2;
/// Some surface reflects as a mirror.
pub const LUXFER_SCATTERING_MIRROR: u32 = 4;
/// Some surface is a clear pane.
pub const LUXFER_SCATTERING_GLASS: u32 = 8;
/// Some surface is partly not there.
pub const LUXFER_SCATTERING_ALPHA: u32 = 16;

/// Some surface emits.
pub const LUXFER_LIGHTS_SURFACE: u32 = 1;
/// Some surface emits by a texture.
pub const LUXFER_LIGHTS_TEXTURE: u32 = 2;
/// There is a point light that shines.
pub const LUXFER_LIGHTS_POINT: u32 = 4;
/// There is a spot light that shines.
pub const LUXFER_LIGHTS_SPOT: u32 = 8;
/// There is a directional light that shines.
pub const LUXFER_LIGHTS_DIRECTIONAL: u32 = 16;
/// The environment shines.
pub const LUXFER_LIGHTS_ENVIRONMENT: u32 = 32;

/// What a scene requires of the renderer. Set struct_size before the call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_requirements {
    /// sizeof(luxfer_requirements), set by the caller.
    pub struct_size: u32,
    /// Ways of scattering that can occur: LUXFER_SCATTERING_ flags.
    pub scattering: u32,
    /// Lights that can shine: LUXFER_LIGHTS_ flags.
    pub lights: u32,
    /// Textures that vary what surfaces scatter, emit, or how they are bent.
    pub textures: u32,
    /// How many times light can scatter and still matter: light that was scattered more often is at most the share error,
    /// given in the call, of all light that surfaces scatter. 0 if albedos set no bound. Rendering ends paths there only if
    /// luxfer_render_params.bounce_error asks for it.
    pub bounces: u32,
    /// Index of the material that sends on most of the light it receives; LUXFER_NONE if there are no surfaces.
    pub brightest_material: u32,
    /// The most that any surface sends on, per channel, in [0, 1].
    pub albedo: [f32; 3],
    /// Triangles without an area, which are left out.
    pub flat_triangles: u32,
}

// SAFETY: plain numbers.
unsafe impl Versioned for luxfer_requirements {
    const NAME: &'static str = "luxfer_requirements";
    const SIZES: &'static [usize] = &[40];
    fn defaults() -> Self {
        Self {
            struct_size: 40,
            scattering: 0,
            lights: 0,
            textures: 0,
            bounces: 0,
            brightest_material: LUXFER_NONE,
            albedo: [0.0; 3],
            flat_triangles: 0,
        }
    }
}

/// Tells what a scene requires of the renderer; error, in [0, 1), is the share of light for *requirements' bounces. The
/// first call after a change of the scene makes it ready for tracing. Any thread.
/// LUXFER_INVALID_ARGUMENT if the scene is not valid or error is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_requirements(
    scene: *mut luxfer_scene,
    error: f32,
    requirements: *mut luxfer_requirements,
) -> luxfer_status {
    enter(scene, |object| {
        let out = Report::new(requirements)?;
        if !(0.0..1.0).contains(&error) {
            return Err(Error::argument(format!("error is {error}; it must lie in [0, 1)")));
        }
        let world = ready(object)?;
        let found = world.requirements();
        let flags = |bits: &[bool]| bits.iter().zip(0..).map(|(&bit, i)| u32::from(bit) << i).sum();
        out.set(luxfer_requirements {
            scattering: flags(&[found.diffuse, found.glossy, found.mirror, found.glass, found.alpha]),
            lights: flags(&[
                found.surfaces,
                found.textured_surfaces,
                found.points,
                found.spots,
                found.directional,
                found.environment,
            ]),
            textures: found.textures as u32,
            bounces: found.bounces(error).unwrap_or(0),
            brightest_material: found.brightest.map_or(LUXFER_NONE, |material| material as u32),
            albedo: found.albedo.to_array(),
            flat_triangles: u32::try_from(found.flat_triangles).unwrap_or(u32::MAX),
            ..luxfer_requirements::defaults()
        });
        Ok(())
    })
}

/// Tells in words what rendering a scene leaves out: one sentence per line, as UTF-8 that ends with a zero, cut if it does
/// not fit into capacity bytes. *needed, unless NULL, becomes the capacity for all of it. buffer may be NULL if capacity is
/// 0. Any thread.
/// LUXFER_INVALID_ARGUMENT if the scene is not valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_requirements_text(
    scene: *mut luxfer_scene,
    buffer: *mut c_char,
    capacity: usize,
    needed: *mut usize,
) -> luxfer_status {
    enter(scene, |object| copy_text(&ready(object)?.requirements().left_out().join("\n"), buffer, capacity, needed))
}

/// The scene as it is, ready for tracing.
fn ready(object: &SceneObject) -> Result<Arc<World>> {
    let (snapshot, monitor) = (object.snapshot(), Monitor::default());
    object.context().pool.run(|| object.world(&snapshot, monitor.job()))
}
