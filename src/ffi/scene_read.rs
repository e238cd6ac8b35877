//! Scene read-back
//!
//! What a scene holds, element by element: meshes, materials and the textures they use. Together with the counts of
//! luxfer_scene_get_counts a host can copy a whole scene.

use super::guard::enter;
use super::handle::{self, Owned};
use super::image::{Pixels, luxfer_image};
use super::params::{Report, Versioned};
use super::pointer::{Out, bytes_mut, copy_text};
use super::query::LUXFER_NONE;
use super::scene::{luxfer_scene, missing};
use super::scene_parts::luxfer_material_params;
use super::status::luxfer_status;
use crate::error::{Error, ErrorKind, Result};
use crate::scene::{Material, Mesh, Scene, TextureRef, Wrap};
use std::ffi::c_char;
use std::sync::Arc;

/// What a material uses a texture for: a LUXFER_TEXTURE_ value.
pub type luxfer_texture_role = i32;
/// Multiplies the base colour.
pub const LUXFER_TEXTURE_BASE_COLOR: luxfer_texture_role = 0;
/// Green multiplies the roughness, blue the metallic share.
pub const LUXFER_TEXTURE_METALLIC_ROUGHNESS: luxfer_texture_role = 1;
/// Normals in tangent space.
pub const LUXFER_TEXTURE_NORMAL: luxfer_texture_role = 2;
/// Multiplies the emission; looked up without interpolation.
pub const LUXFER_TEXTURE_EMISSION: luxfer_texture_role = 3;

/// How a texture continues beyond its edges: a LUXFER_WRAP_ value.
pub type luxfer_wrap = i32;
/// It repeats.
pub const LUXFER_WRAP_REPEAT: luxfer_wrap = 0;
/// Its border goes on.
pub const LUXFER_WRAP_CLAMP: luxfer_wrap = 1;
/// It repeats, every other one mirrored.
pub const LUXFER_WRAP_MIRROR: luxfer_wrap = 2;

/// A mesh of a scene. Set struct_size before the call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_mesh_info {
    /// sizeof(luxfer_mesh_info), set by the caller.
    pub struct_size: u32,
    /// Index of its material.
    pub material: u32,
    /// Number of vertices.
    pub vertex_count: usize,
    /// Number of triangles.
    pub triangle_count: usize,
    /// 1 if it has a normal for each vertex, 0 if its faces are flat.
    pub has_normals: u32,
    /// Sum of 1 if it has the first set of texture coordinates and 2 if it has the second.
    pub uv_sets: u32,
}

const MESH_INFO_SIZE: usize = 16 + 2 * size_of::<usize>();

// SAFETY: plain integers.
unsafe impl Versioned for luxfer_mesh_info {
    const NAME: &'static str = "luxfer_mesh_info";
    const SIZES: &'static [usize] = &[MESH_INFO_SIZE];
    fn defaults() -> Self {
        let struct_size = MESH_INFO_SIZE as u32;
        Self { struct_size, material: 0, vertex_count: 0, triangle_count: 0, has_normals: 0, uv_sets: 0 }
    }
}

/// A texture as a material uses it. Set struct_size before the call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_texture_use {
    /// sizeof(luxfer_texture_use), set by the caller.
    pub struct_size: u32,
    /// Index of the texture; LUXFER_NONE if there is none, and what follows is 0.
    pub texture: u32,
    /// Which of the mesh's sets of texture coordinates it is looked up with, 0 or 1.
    pub uv_set: u32,
    /// LUXFER_WRAP_ value, along u.
    pub wrap_u: luxfer_wrap,
    /// LUXFER_WRAP_ value, along v.
    pub wrap_v: luxfer_wrap,
    /// Two rows of three, applied to (u, v, 1) before the look-up.
    pub transform: [f32; 6],
}

// SAFETY: plain numbers.
unsafe impl Versioned for luxfer_texture_use {
    const NAME: &'static str = "luxfer_texture_use";
    const SIZES: &'static [usize] = &[44];
    fn defaults() -> Self {
        Self { struct_size: 44, texture: LUXFER_NONE, uv_set: 0, wrap_u: 0, wrap_v: 0, transform: [0.0; 6] }
    }
}

/// Tells what a mesh has. Any thread.
/// LUXFER_NOT_FOUND if there is no such mesh.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_mesh(
    scene: *mut luxfer_scene,
    index: u32,
    info: *mut luxfer_mesh_info,
) -> luxfer_status {
    enter(scene, |object| {
        let out = Report::new(info)?;
        let scene = object.snapshot();
        let mesh = mesh(&scene, index)?;
        out.set(luxfer_mesh_info {
            material: u32::try_from(mesh.material).unwrap_or(LUXFER_NONE),
            vertex_count: mesh.positions.len(),
            triangle_count: mesh.triangles.len(),
            has_normals: u32::from(!mesh.normals.is_empty()),
            uv_sets: u32::from(!mesh.uvs[0].is_empty()) + 2 * u32::from(!mesh.uvs[1].is_empty()),
            ..luxfer_mesh_info::defaults()
        });
        Ok(())
    })
}

/// Copies the name of a mesh into buffer, as luxfer_context_last_error does a message. Any thread.
/// LUXFER_NOT_FOUND if there is no such mesh.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_mesh_name(
    scene: *mut luxfer_scene,
    index: u32,
    buffer: *mut c_char,
    capacity: usize,
    needed: *mut usize,
) -> luxfer_status {
    enter(scene, |object| copy_text(&mesh(&object.snapshot(), index)?.name, buffer, capacity, needed))
}

/// Copies a mesh into the caller's packed arrays, of which any may be NULL: positions and normals, three floats for each
/// vertex, and indices, three for each triangle. The capacities are in vertices and triangles. Any thread.
/// LUXFER_NOT_FOUND if there is no such mesh, or it has no normals where they are asked for; LUXFER_INVALID_ARGUMENT if a
/// capacity is too small.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_read_mesh(
    scene: *mut luxfer_scene,
    index: u32,
    vertex_capacity: usize,
    positions: *mut f32,
    normals: *mut f32,
    triangle_capacity: usize,
    indices: *mut u32,
) -> luxfer_status {
    enter(scene, |object| {
        let scene = object.snapshot();
        let mesh = mesh(&scene, index)?;
        if !normals.is_null() && mesh.normals.is_empty() {
            return Err(lacks(index, "normals; its faces are flat"));
        }
        let positions = place(positions.cast(), &mesh.positions, vertex_capacity, "positions")?;
        let normals = place(normals.cast(), &mesh.normals, vertex_capacity, "normals")?;
        let indices = place(indices.cast(), &mesh.triangles, triangle_capacity, "indices")?;
        for (place, data) in [positions, normals, indices].into_iter().flatten() {
            place.copy_from_slice(data);
        }
        Ok(())
    })
}

/// Copies a set of texture coordinates, 0 or 1, into the caller's packed array of two floats for each vertex; capacity is
/// in vertices. Any thread.
/// LUXFER_NOT_FOUND if there is no such mesh or it has no such set; LUXFER_INVALID_ARGUMENT if the capacity is too small.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_read_mesh_uvs(
    scene: *mut luxfer_scene,
    index: u32,
    uv_set: u32,
    capacity: usize,
    uvs: *mut f32,
) -> luxfer_status {
    enter(scene, |object| {
        let scene = object.snapshot();
        let set = mesh(&scene, index)?.uvs.get(uv_set as usize).filter(|set| !set.is_empty());
        let set = set.ok_or_else(|| lacks(index, format_args!("set {uv_set} of texture coordinates")))?;
        let Some((place, data)) = place(uvs.cast(), set, capacity, "uvs")? else {
            return Err(Error::argument("uvs is NULL; it must point to two floats for each vertex"));
        };
        place.copy_from_slice(data);
        Ok(())
    })
}

/// Reads a material; set params->struct_size before the call. Its name becomes NULL. Any thread.
/// LUXFER_NOT_FOUND if there is no such material.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_material(
    scene: *mut luxfer_scene,
    index: u32,
    params: *mut luxfer_material_params,
) -> luxfer_status {
    enter(scene, |object| {
        let out = Report::new(params)?;
        let scene = object.snapshot();
        let material = material(&scene, index)?;
        out.set(luxfer_material_params {
            double_sided: u32::from(material.double_sided),
            base_color: material.base_color.to_array(),
            metallic: material.metallic,
            roughness: material.roughness,
            emission: material.emission.to_array(),
            transmission: material.transmission,
            ior: material.ior,
            ..luxfer_material_params::defaults()
        });
        Ok(())
    })
}

/// Tells which texture a material uses for a purpose, and how; role is a LUXFER_TEXTURE_ value. Any thread.
/// LUXFER_NOT_FOUND if there is no such material; LUXFER_INVALID_ARGUMENT for another role.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_material_texture(
    scene: *mut luxfer_scene,
    material_index: u32,
    role: luxfer_texture_role,
    texture_use: *mut luxfer_texture_use,
) -> luxfer_status {
    enter(scene, |object| {
        let out = Report::new(texture_use)?;
        let scene = object.snapshot();
        let material = material(&scene, material_index)?;
        let used = match role {
            LUXFER_TEXTURE_BASE_COLOR => &material.base_color_texture,
            LUXFER_TEXTURE_METALLIC_ROUGHNESS => &material.metallic_roughness_texture,
            LUXFER_TEXTURE_NORMAL => &material.normal_texture,
            LUXFER_TEXTURE_EMISSION => &material.emission_texture,
            _ => return Err(Error::argument(format!("role is {role}; it must be a LUXFER_TEXTURE_ value"))),
        };
        out.set(used.as_ref().map_or_else(luxfer_texture_use::defaults, |used| described(&scene, used)));
        Ok(())
    })
}

/// Gets a texture as an image, linear. The caller releases *image. Any thread.
/// LUXFER_NOT_FOUND if there is no such texture.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_texture(
    scene: *mut luxfer_scene,
    index: u32,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    struct TextureOf(Arc<Scene>, usize);
    enter(scene, |object| {
        let out = Out::new(image, "image")?;
        let scene = object.snapshot();
        if index as usize >= scene.textures.len() {
            return Err(missing("texture", index, scene.textures.len()));
        }
        let texture = Arc::new(TextureOf(scene, index as usize));
        out.set(handle::give(Pixels::part(object.context(), texture, |t| &t.0.textures[t.1].image)));
        Ok(())
    })
}

fn mesh(scene: &Scene, index: u32) -> Result<&Mesh> {
    scene.meshes.get(index as usize).ok_or_else(|| missing("mesh", index, scene.meshes.len()))
}

fn material(scene: &Scene, index: u32) -> Result<&Material> {
    scene.materials.get(index as usize).ok_or_else(|| missing("material", index, scene.materials.len()))
}

fn lacks(mesh: u32, what: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::NotFound, format!("mesh {mesh} has no {what}"))
}

fn described(scene: &Scene, used: &TextureRef) -> luxfer_texture_use {
    let wrap = scene.textures.get(used.texture).map_or([Wrap::Repeat; 2], |t| t.wrap).map(|wrap| match wrap {
        Wrap::Repeat => LUXFER_WRAP_REPEAT,
        Wrap::Clamp => LUXFER_WRAP_CLAMP,
        Wrap::Mirror => LUXFER_WRAP_MIRROR,
    });
    let [a, b, _, c, d, _, e, f, _] = used.transform.to_cols_array();
    luxfer_texture_use {
        texture: u32::try_from(used.texture).unwrap_or(LUXFER_NONE),
        uv_set: used.uv_set as u32,
        wrap_u: wrap[0],
        wrap_v: wrap[1],
        transform: [a, c, e, b, d, f],
        ..luxfer_texture_use::defaults()
    }
}

/// The caller's array and the bytes that go there; nothing where the caller wants nothing.
fn place<'a, T: bytemuck::NoUninit>(
    place: *mut u8,
    data: &'a [T],
    capacity: usize,
    name: &str,
) -> Result<Option<(&'a mut [u8], &'a [u8])>> {
    if place.is_null() {
        return Ok(None);
    }
    if capacity < data.len() {
        return Err(Error::argument(format!("there is room for {capacity} {name}; {} are needed", data.len())));
    }
    let data: &[u8] = bytemuck::cast_slice(data);
    Ok(Some((bytes_mut(place, data.len(), name)?, data)))
}
