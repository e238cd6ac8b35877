//! Outputs of a rendering
//!
//! Additional images (layers) from the same paths as the main image: light that light path expressions select, and
//! properties of the visible surfaces (AOVs). Request layers before luxfer_render_start, and read them while the job
//! runs or afterwards. The layers of expressions come first, in the order in which they were added, then the AOVs in
//! the order of their flags. Layers do not change the main image by a single bit.
//!
//! AOVs describe the first surface that a path from the camera meets; clear panes and mirrors count as surfaces. Depth,
//! distance, position and normals are means over the samples of the pixel that meet a surface; a mean normal is scaled
//! to unit length. The comment of each LUXFER_AOV_ flag names the layer and its channels.
//!
//! A light path expression is a regular expression over the events of a path; the characters . [..] [^..] * + ? {n,m}
//! | ( ) have their usual meaning. It has one of two forms.
//!
//! The first form runs from a light (L) to the eye (E), for example "LDE", "LSE", "L.*DDE", "LD{1,2}E", "LS*DE". L is
//! any light, D is a diffuse event, S is every other scattering event.
//!
//! The second form runs from the camera (C) to a light, as in Open Shading Language, for example "C<RD>L",
//! "C[GS]+.*<L.'Lamp'>". An event has a type and a scattering mode: <RD> is a diffuse reflection. A letter alone, such
//! as G, matches any event with this type or mode. The types are R (reflection), T (transmission) and V (volume, never
//! occurs here). The modes are D (diffuse), G (glossy, also rough solid glass), S (mirror, clear pane or smooth solid
//! glass) and s (clear pane only). Lights are L, O and B; see luxfer_emitter_as.
//!
//! A label in quotes restricts an event to an object or a light. The label is the name of a mesh or of its material.
//! Name#0, Name#1, ... are the lamps (connected regions) in the emission texture of the mesh or material Name, numbered
//! as luxfer_lamps numbers them. light0, light1, ... are the scene's punctual lights in their order, and environment is
//! the scene's environment.
//!
//! Arnold's built-in names work too: beauty, direct, indirect, emission, background, and diffuse, specular,
//! transmission, each alone or with _direct or _indirect.

use super::guard::enter;
use super::handle::{self, Owned};
use super::image::{Pixels, luxfer_image};
use super::pointer::{Out, copy_text, text};
use super::render::luxfer_render;
use super::status::luxfer_status;
use crate::error::{Error, ErrorKind, Result};
use crate::image::io;
use crate::render::lpe::EmitterAs;
use crate::render::{Aov, Film, Layer};
use std::ffi::c_char;
use std::path::Path;

/// Distance of the surface from the camera along the viewing direction (depth z), in metres; infinite where there is no
/// surface. Layer Depth, channel Z.
pub const LUXFER_AOV_DEPTH: u32 = 1;
/// Distance of the surface from the camera along the pixel's ray, in metres; infinite where there is no surface. Layer
/// Distance, channel Z.
pub const LUXFER_AOV_DISTANCE: u32 = 2;
/// Position in world space, in metres; 0 where there is no surface. Layer Position, channels X Y Z.
pub const LUXFER_AOV_POSITION: u32 = 4;
/// Shading normal in world space, towards the camera; 0 where there is no surface. Layer Normal, channels X Y Z.
pub const LUXFER_AOV_NORMAL: u32 = 8;
/// Normal of the triangle in world space, towards the camera; 0 where there is no surface. Layer GeometricNormal,
/// channels X Y Z.
pub const LUXFER_AOV_GEOMETRIC_NORMAL: u32 = 16;
/// Reflectance plus transmittance at normal incidence: the mean over all samples of the pixel, where samples that meet
/// no surface count as 0. Layer Albedo, channels R G B.
pub const LUXFER_AOV_ALBEDO: u32 = 32;
/// 1 + index of the mesh on which more than half of the pixel's hits lie. Without such a majority: 1 + index of any
/// mesh that was hit. 0 where there is no surface. The luminous opening of the luminaire with index i among the
/// punctual lights has the value m + i + 1, where m is the number of meshes. Layer IndexOB, channel X.
pub const LUXFER_AOV_OBJECT: u32 = 64;
/// 1 + index of the material on which more than half of the pixel's hits lie. Without such a majority: 1 + index of any
/// material that was hit. 0 where there is no surface. The luminous openings of luminaires have the value n + 1, where
/// n is the number of materials. Layer IndexMA, channel X.
pub const LUXFER_AOV_MATERIAL: u32 = 128;
/// Share of the pixel that surfaces cover, in [0, 1]. Layer Alpha, channel A.
pub const LUXFER_AOV_ALPHA: u32 = 256;
/// Luminance of the main image, in cd/m². Layer Luminance, channel Y.
pub const LUXFER_AOV_LUMINANCE: u32 = 512;

/// Letters that match emissive surfaces and the environment in expressions that start at the camera: a
/// LUXFER_EMITTER_AS_ value. Punctual lights always match L.
pub type luxfer_emitter_as = i32;
/// Emissive surfaces match L and O, the environment matches L and B, so C<RD>L is all direct light that is reflected
/// diffusely. The default.
pub const LUXFER_EMITTER_AS_BOTH: luxfer_emitter_as = 0;
/// Emissive surfaces and the environment match L only.
pub const LUXFER_EMITTER_AS_LIGHT: luxfer_emitter_as = 1;
/// As in Open Shading Language: surfaces match O, the environment matches B.
pub const LUXFER_EMITTER_AS_OBJECT: luxfer_emitter_as = 2;

/// Adds a layer with the light that an expression selects. name is the name of the layer: 1 to 64 bytes in UTF-8,
/// without dots, quotes or control characters. It must differ from the names of the other layers and of all AOVs, and
/// from Combined and Variance. Any thread.
/// LUXFER_INVALID_ARGUMENT if the name is not valid, or if the expression is malformed: the message gives the column.
/// LUXFER_INVALID_OPERATION while a job runs. The rendering's job ends with LUXFER_NOT_FOUND if no object of the scene
/// has a label that the expression names, and with LUXFER_INVALID_ARGUMENT if no path can match the expression.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_add_expression(
    render: *mut luxfer_render,
    name: *const c_char,
    expression: *const c_char,
) -> luxfer_status {
    enter(render, |stage| {
        let (name, expression) = (text(name, "name")?, text(expression, "expression")?);
        stage.change(|inputs| inputs.outputs.add(name, expression))
    })
}

/// Removes all expressions. Any thread.
/// LUXFER_INVALID_OPERATION while a job runs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_clear_expressions(render: *mut luxfer_render) -> luxfer_status {
    enter(render, |stage| {
        stage.change(|inputs| {
            inputs.outputs.expressions.clear();
            Ok(())
        })
    })
}

/// Sets the letters that match emissive surfaces and the environment; emitter_as is a LUXFER_EMITTER_AS_ value. Any
/// thread.
/// LUXFER_INVALID_OPERATION while a job runs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_set_emitter_as(
    render: *mut luxfer_render,
    emitter_as: luxfer_emitter_as,
) -> luxfer_status {
    enter(render, |stage| {
        let emitter_as = match emitter_as {
            LUXFER_EMITTER_AS_BOTH => EmitterAs::Both,
            LUXFER_EMITTER_AS_LIGHT => EmitterAs::Light,
            LUXFER_EMITTER_AS_OBJECT => EmitterAs::Object,
            _ => {
                return Err(Error::argument(format!(
                    "emitter_as is {emitter_as}; it must be a LUXFER_EMITTER_AS_ value"
                )));
            }
        };
        stage.change(|inputs| {
            inputs.outputs.emitter_as = emitter_as;
            Ok(())
        })
    })
}

/// Sets which AOVs are rendered: LUXFER_AOV_ flags combined with |, or 0, the default, for no AOV. Any thread.
/// LUXFER_INVALID_ARGUMENT for unknown flags; LUXFER_INVALID_OPERATION while a job runs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_set_aovs(render: *mut luxfer_render, flags: u32) -> luxfer_status {
    enter(render, |stage| {
        if flags >> Aov::ALL.len() != 0 {
            return Err(Error::argument(format!("flags is {flags:#x}; only LUXFER_AOV_ flags may be set")));
        }
        let aovs = Aov::ALL.into_iter().enumerate().filter(|(bit, _)| flags >> bit & 1 == 1).map(|(_, aov)| aov);
        stage.change(|inputs| {
            inputs.outputs.aovs = aovs.collect();
            Ok(())
        })
    })
}

/// Gets the number of layers of the rendering. Any thread.
/// LUXFER_NOT_READY before the first pass of a job.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_get_layer_count(render: *mut luxfer_render, count: *mut u32) -> luxfer_status {
    enter(render, |stage| {
        let out = Out::new(count, "count")?;
        out.set(stage.output()?.layers.len() as u32);
        Ok(())
    })
}

/// Copies a layer's name into buffer as zero-terminated UTF-8, truncated to capacity bytes including the zero; index
/// starts at 0. *needed, unless NULL, receives the capacity that the whole name needs. buffer may be NULL if capacity
/// is 0. Any thread.
/// LUXFER_NOT_READY before the first pass of a job; LUXFER_NOT_FOUND if there is no such layer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_get_layer_name(
    render: *mut luxfer_render,
    index: u32,
    buffer: *mut c_char,
    capacity: usize,
    needed: *mut usize,
) -> luxfer_status {
    enter(render, |stage| {
        let output = stage.output()?;
        copy_text(&layer(&output, index)?.name, buffer, capacity, needed)
    })
}

/// Gets the layer with a name, in its current state: light in cd/m² with 3 channels, or an AOV with its channels. The
/// caller releases *image. Any thread.
/// LUXFER_NOT_READY before the first pass of a job; LUXFER_NOT_FOUND if no layer has that name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_get_layer(
    render: *mut luxfer_render,
    name: *const c_char,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(render, |stage| {
        let (name, out) = (text(name, "name")?, Out::new(image, "image")?);
        let output = stage.output()?;
        let index = output.layers.iter().position(|l| l.name == name).ok_or_else(|| {
            let names: Vec<&str> = output.layers.iter().map(|l| l.name.as_str()).collect();
            Error::new(ErrorKind::NotFound, format!("there is no layer {name:?}; there are {names:?}"))
        })?;
        let unseen_lights = output.unseen_lights;
        let pixels = Pixels::rendered(stage.context(), output, move |film| &film.layers[index].image, unseen_lights);
        out.set(handle::give(pixels));
        Ok(())
    })
}

/// Writes the image and all layers into one OpenEXR file of 32-bit floating-point channels; path is UTF-8. An existing
/// file is replaced only once the new one is complete. Any thread.
///
/// The image has the channels R, G, B, and A if LUXFER_AOV_ALPHA is set. The channels of each layer are named
/// layer.channel, as Blender and Nuke read them; the depth, Depth.Z, is also stored as Z. For each layer of light, the
/// attribute luxfer.lpe.NAME of the header holds its expression.
/// LUXFER_NOT_READY before the first pass of a job; LUXFER_IO if the file cannot be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_write_exr(render: *mut luxfer_render, path: *const c_char) -> luxfer_status {
    enter(render, |stage| {
        let path = text(path, "path")?;
        io::Target::new(Path::new(path))?.write(&encode(&*stage.output()?)?)
    })
}

fn layer(film: &Film, index: u32) -> Result<&Layer> {
    film.layers.get(index as usize).ok_or_else(|| {
        let count = film.layers.len();
        Error::new(ErrorKind::NotFound, format!("index is {index}; the rendering has {count} layers"))
    })
}

fn encode(film: &Film) -> Result<Vec<u8>> {
    let mut layers = vec![io::Layer { name: "", image: &film.beauty, channels: &["R", "G", "B"] }];
    let mut notes = vec![("luxfer.unit".to_string(), "cd/m^2".to_string())];
    for layer in &film.layers {
        // Programs without layers look for A and Z in the main image. So alpha goes into the main image instead of a
        // layer, and depth into both.
        if layer.name == Aov::Alpha.name() || layer.name == Aov::Depth.name() {
            layers.push(io::Layer { name: "", image: &layer.image, channels: layer.channels });
        }
        if layer.name != Aov::Alpha.name() {
            layers.push(io::Layer { name: &layer.name, image: &layer.image, channels: layer.channels });
        }
        if let Some(expression) = &layer.expression {
            notes.push((format!("luxfer.lpe.{}", layer.name), expression.clone()));
        }
    }
    io::encode_exr(&layers, &notes)
}
