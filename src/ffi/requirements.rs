//! Scene requirements
//!
//! The renderer analyses a scene before the first ray: which kinds of scattering and which lights can occur, and how
//! much light can remain after a bounce. It skips the code for everything that cannot occur, which does not change any
//! image. You need not call these functions: they only report what the renderer does by itself.

use super::guard::enter;
use super::params::{Report, Versioned, versioned};
use super::pointer::copy_text;
use super::query::LUXFER_NONE;
use super::scene::luxfer_scene;
use super::status::luxfer_status;
use crate::error::Error;
use std::ffi::c_char;

/// At least one surface scatters diffusely.
pub const LUXFER_SCATTERING_DIFFUSE: u32 = 1;
/// At least one surface has a rough specular reflection.
pub const LUXFER_SCATTERING_GLOSSY: u32 = 2;
/// At least one surface is a mirror.
pub const LUXFER_SCATTERING_MIRROR: u32 = 4;
/// At least one surface is a clear pane of glass.
pub const LUXFER_SCATTERING_GLASS: u32 = 8;
/// At least one surface is partly transparent because of its alpha.
pub const LUXFER_SCATTERING_ALPHA: u32 = 16;
/// At least one body is solid glass, which refracts.
pub const LUXFER_SCATTERING_REFRACTION: u32 = 32;
/// At least one surface has a clear coat (KHR_materials_clearcoat).
pub const LUXFER_SCATTERING_CLEAR_COAT: u32 = 64;

/// At least one surface emits; the luminous openings of luminaires count.
pub const LUXFER_LIGHTS_SURFACE: u32 = 1;
/// At least one emitting surface has an emission texture.
pub const LUXFER_LIGHTS_TEXTURE: u32 = 2;
/// At least one point light, or luminaire that shines from a point, has an intensity above 0.
pub const LUXFER_LIGHTS_POINT: u32 = 4;
/// At least one spot light has an intensity above 0.
pub const LUXFER_LIGHTS_SPOT: u32 = 8;
/// At least one directional light has an illuminance above 0.
pub const LUXFER_LIGHTS_DIRECTIONAL: u32 = 16;
/// The environment emits.
pub const LUXFER_LIGHTS_ENVIRONMENT: u32 = 32;

/// Features that a scene requires of the renderer.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_requirements {
    /// sizeof(luxfer_requirements), set by the function that fills the struct.
    pub struct_size: u32,
    /// Kinds of scattering that can occur: LUXFER_SCATTERING_ flags.
    pub scattering: u32,
    /// Kinds of lights that emit: LUXFER_LIGHTS_ flags.
    pub lights: u32,
    /// Number of textures that change the scattering, the emission or the normals of surfaces.
    pub textures: u32,
    /// Number n of bounces that matter: the smallest positive integer with a^n <= error. Here a is the largest channel
    /// of the field albedo, and error is the argument of luxfer_scene_get_requirements. With error = 0.01, for example,
    /// light with more than n bounces is at most 1 % of all scattered light. 0 if there is no such n. For information
    /// only: no rendering ends paths at this number.
    pub bounces: u32,
    /// Index of the material with the largest albedo; LUXFER_NONE if there are no surfaces.
    pub brightest_material: u32,
    /// Upper bound of the albedo of all surfaces, per channel, in [0, 1]. The albedo is the share of the received light
    /// that a surface reflects or transmits.
    pub albedo: [f32; 3],
    /// Number of triangles with zero area, which are skipped.
    pub flat_triangles: u32,
}

versioned!(luxfer_requirements, [40], {
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
});

/// Gets the features that a scene requires of the renderer. error, in [0, 1), is the share of the scattered light that
/// the count of bounces (luxfer_requirements.bounces) may neglect. The first call after a change of the scene prepares
/// the scene for tracing. size is sizeof *requirements. Any thread.
/// LUXFER_INVALID_ARGUMENT if the scene is not valid or error is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_requirements(
    scene: *mut luxfer_scene,
    error: f32,
    requirements: *mut luxfer_requirements,
    size: usize,
) -> luxfer_status {
    enter(scene, |object| {
        let out = Report::new(requirements, size)?;
        if !(0.0..1.0).contains(&error) {
            return Err(Error::argument(format!("error is {error}; it must lie in [0, 1)")));
        }
        let world = object.ready_world()?;
        let found = world.requirements();
        let flags = |bits: &[bool]| bits.iter().zip(0..).map(|(&bit, i)| u32::from(bit) << i).sum();
        out.set(luxfer_requirements {
            scattering: flags(&[
                found.diffuse,
                found.glossy,
                found.mirror,
                found.glass,
                found.alpha,
                found.refraction,
                found.clear_coat,
            ]),
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

/// Describes in words what the renderer skips in a scene. It also names each extension and feature of the scene's file
/// that is not rendered, with the objects that have it. The text has one sentence per line and is zero-terminated
/// UTF-8, truncated to capacity bytes including the zero. *needed, unless NULL, receives the capacity that the whole
/// text needs. buffer may be NULL if capacity is 0. Any thread.
/// LUXFER_INVALID_ARGUMENT if the scene is not valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_requirements_text(
    scene: *mut luxfer_scene,
    buffer: *mut c_char,
    capacity: usize,
    needed: *mut usize,
) -> luxfer_status {
    enter(scene, |object| {
        let world = object.ready_world()?;
        let mut sentences = world.requirements().left_out();
        sentences.extend(world.scene().unrendered.iter().map(|unrendered| format!("{unrendered}.")));
        copy_text(&sentences.join("\n"), buffer, capacity, needed)
    })
}
