//! Scene read-back
//!
//! Reads the meshes of a scene. With luxfer_scene_get_counts and the functions that read materials, textures and
//! cameras, a host can copy a whole scene.

use super::guard::enter;
use super::params::{Report, Versioned, versioned};
use super::pointer::{bytes_mut, copy_text};
use super::query::LUXFER_NONE;
use super::scene::{luxfer_scene, missing};
use super::status::luxfer_status;
use crate::error::{Error, ErrorKind, Result};
use crate::scene::{Mesh, Scene};
use std::ffi::c_char;

/// A mesh of a scene.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_mesh_info {
    /// sizeof(luxfer_mesh_info), set by the function that fills the struct.
    pub struct_size: u32,
    /// Index of the mesh's material.
    pub material: u32,
    /// Number of vertices.
    pub vertex_count: usize,
    /// Number of triangles.
    pub triangle_count: usize,
    /// 1 if each vertex has a normal, 0 if the faces are flat.
    pub has_normals: u32,
    /// Bit 0 is set if the mesh has the first set of texture coordinates, bit 1 if it has the second.
    pub uv_sets: u32,
    /// 1 if each vertex has a colour, else 0.
    pub has_colours: u32,
    /// 0.
    pub reserved: u32,
}

const MESH_INFO_SIZE: usize = 24 + 2 * size_of::<usize>();

versioned!(luxfer_mesh_info, [MESH_INFO_SIZE], {
    let struct_size = MESH_INFO_SIZE as u32;
    Self {
        struct_size,
        material: 0,
        vertex_count: 0,
        triangle_count: 0,
        has_normals: 0,
        uv_sets: 0,
        has_colours: 0,
        reserved: 0,
    }
});

/// Gets the sizes and attributes of a mesh. size is sizeof *info. Any thread.
/// LUXFER_NOT_FOUND if there is no such mesh.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_mesh(
    scene: *mut luxfer_scene,
    index: u32,
    info: *mut luxfer_mesh_info,
    size: usize,
) -> luxfer_status {
    enter(scene, |object| {
        let out = Report::new(info, size)?;
        let scene = object.snapshot();
        let mesh = mesh(&scene, index)?;
        out.set(luxfer_mesh_info {
            material: u32::try_from(mesh.material).unwrap_or(LUXFER_NONE),
            vertex_count: mesh.positions.len(),
            triangle_count: mesh.triangles.len(),
            has_normals: u32::from(!mesh.normals.is_empty()),
            uv_sets: u32::from(!mesh.uvs[0].is_empty()) + 2 * u32::from(!mesh.uvs[1].is_empty()),
            has_colours: u32::from(!mesh.colours.is_empty()),
            ..luxfer_mesh_info::defaults()
        });
        Ok(())
    })
}

/// Copies the name of a mesh into buffer, as luxfer_context_get_last_error copies a message. Any thread.
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

/// Copies a mesh into packed arrays of the caller: positions and normals with three floats per vertex, and indices with
/// three per triangle. Any of the arrays may be NULL. The capacities are numbers of vertices and of triangles. Any
/// thread.
/// LUXFER_NOT_FOUND if there is no such mesh, or if normals is given and the mesh has none; LUXFER_INVALID_ARGUMENT if
/// a capacity is too small.
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

/// Copies set uv_set, 0 or 1, of a mesh's texture coordinates into a packed array of the caller, two floats per vertex;
/// capacity is a number of vertices. Any thread.
/// LUXFER_NOT_FOUND if there is no such mesh or it has no such set; LUXFER_INVALID_ARGUMENT if the capacity is too
/// small.
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

/// Copies the colours of a mesh's vertices into a packed array of the caller, four floats per vertex; capacity is a
/// number of vertices. Any thread.
/// LUXFER_NOT_FOUND if there is no such mesh or it has no colours; LUXFER_INVALID_ARGUMENT if the capacity is too
/// small.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_read_mesh_colours(
    scene: *mut luxfer_scene,
    index: u32,
    capacity: usize,
    colours: *mut f32,
) -> luxfer_status {
    enter(scene, |object| {
        let scene = object.snapshot();
        let mesh = mesh(&scene, index)?;
        if mesh.colours.is_empty() {
            return Err(lacks(index, "colours"));
        }
        let Some((place, data)) = place(colours.cast(), &mesh.colours, capacity, "colours")? else {
            return Err(Error::argument("colours is NULL; it must point to four floats for each vertex"));
        };
        place.copy_from_slice(data);
        Ok(())
    })
}

fn mesh(scene: &Scene, index: u32) -> Result<&Mesh> {
    scene.meshes.get(index as usize).ok_or_else(|| missing("mesh", index, scene.meshes.len()))
}

fn lacks(mesh: u32, what: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::NotFound, format!("mesh {mesh} has no {what}"))
}

/// The caller's array and the bytes to copy there; `None` if the caller passed null.
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
