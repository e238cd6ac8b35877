//! Scene read-back
//!
//! Reads the meshes of a scene back. With luxfer_scene_get_counts and the functions that read materials, textures and
//! cameras, a host can copy these parts of a scene. Lights and the environment cannot be read back.

use super::guard::enter;
use super::params::{Report, Versioned, versioned};
use super::pointer::{bytes_mut, copy_text};
use super::query::LUXFER_NONE;
use super::scene::{luxfer_scene, missing};
use super::status::luxfer_status;
use crate::error::{Error, ErrorKind, Result};
use crate::scene::{Mesh, Scene};
use std::ffi::c_char;

/// An attribute of the vertices of a mesh: a LUXFER_VERTEX_ value.
pub type luxfer_vertex_attribute = i32;
/// Positions in metres, three floats per vertex.
pub const LUXFER_VERTEX_POSITION: luxfer_vertex_attribute = 0;
/// Normals, three floats per vertex.
pub const LUXFER_VERTEX_NORMAL: luxfer_vertex_attribute = 1;
/// The first set of texture coordinates, two floats per vertex; (0, 0) is the top-left corner of a texture.
pub const LUXFER_VERTEX_UV_0: luxfer_vertex_attribute = 2;
/// The second set of texture coordinates, two floats per vertex.
pub const LUXFER_VERTEX_UV_1: luxfer_vertex_attribute = 3;
/// Colours: linear red, green, blue and alpha, four floats per vertex.
pub const LUXFER_VERTEX_COLOUR: luxfer_vertex_attribute = 4;

/// Sizes and attributes of a mesh.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_mesh_info {
    /// sizeof(luxfer_mesh_info), set by the function that fills the struct.
    pub struct_size: u32,
    /// Index of the mesh's material.
    pub material: u32,
    /// Number of vertices.
    pub vertex_count: u64,
    /// Number of triangles.
    pub triangle_count: u64,
    /// 1 if each vertex has a normal, 0 if triangles are shaded flat.
    pub has_normals: u32,
    /// Bit 0 is set if the mesh has the first set of texture coordinates, bit 1 if it has the second set.
    pub uv_sets: u32,
    /// 1 if each vertex has a colour, else 0.
    pub has_colours: u32,
    /// Reserved; always 0.
    pub reserved: u32,
}

versioned!(luxfer_mesh_info, [40], {
    Self {
        struct_size: 40,
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
            vertex_count: mesh.positions.len() as u64,
            triangle_count: mesh.triangles.len() as u64,
            has_normals: u32::from(!mesh.normals.is_empty()),
            uv_sets: u32::from(!mesh.uvs[0].is_empty()) + 2 * u32::from(!mesh.uvs[1].is_empty()),
            has_colours: u32::from(!mesh.colours.is_empty()),
            ..luxfer_mesh_info::defaults()
        });
        Ok(())
    })
}

/// Copies the name of a mesh into buffer as zero-terminated UTF-8, truncated to capacity bytes including the zero.
/// *needed, unless NULL, receives the capacity that the whole name needs. buffer may be NULL if capacity is 0. Any
/// thread.
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

/// Copies an attribute of a mesh's vertices into the array values, a packed array of the caller with room for capacity
/// vertices. attribute is a LUXFER_VERTEX_ value. Any thread.
/// LUXFER_NOT_FOUND if there is no such mesh or it lacks the attribute; LUXFER_INVALID_ARGUMENT if the attribute is
/// unknown, the capacity is too small, or values is NULL though the mesh has vertices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_read_vertices(
    scene: *mut luxfer_scene,
    index: u32,
    attribute: luxfer_vertex_attribute,
    values: *mut f32,
    capacity: usize,
) -> luxfer_status {
    enter(scene, |object| {
        let scene = object.snapshot();
        let mesh = mesh(&scene, index)?;
        let uvs = |set: usize| mesh.uvs.get(set).map_or(&[][..], |set| bytemuck::cast_slice(set));
        let (data, numbers, name): (&[f32], usize, &str) = match attribute {
            LUXFER_VERTEX_POSITION => (bytemuck::cast_slice(&mesh.positions), 3, "positions"),
            LUXFER_VERTEX_NORMAL => (bytemuck::cast_slice(&mesh.normals), 3, "normals"),
            LUXFER_VERTEX_UV_0 => (uvs(0), 2, "texture coordinates of set 0"),
            LUXFER_VERTEX_UV_1 => (uvs(1), 2, "texture coordinates of set 1"),
            LUXFER_VERTEX_COLOUR => (bytemuck::cast_slice(&mesh.colours), 4, "colours"),
            other => {
                return Err(Error::argument(format!("attribute is {other}; it must be a LUXFER_VERTEX_ value")));
            }
        };
        if data.is_empty() && attribute != LUXFER_VERTEX_POSITION {
            return Err(Error::new(ErrorKind::NotFound, format!("mesh {index} has no {name}")));
        }
        copy(data, numbers, values, capacity, name)
    })
}

/// Copies the triangles of a mesh into the array indices, a packed array of the caller with room for capacity
/// triangles: three vertex indices per triangle. Any thread.
/// LUXFER_NOT_FOUND if there is no such mesh; LUXFER_INVALID_ARGUMENT if the capacity is too small, or indices is
/// NULL though the mesh has triangles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_read_triangles(
    scene: *mut luxfer_scene,
    index: u32,
    indices: *mut u32,
    capacity: usize,
) -> luxfer_status {
    enter(scene, |object| {
        let scene = object.snapshot();
        let indices_of_mesh: &[u32] = bytemuck::cast_slice(&mesh(&scene, index)?.triangles);
        copy(indices_of_mesh, 3, indices, capacity, "triangles")
    })
}

fn mesh(scene: &Scene, index: u32) -> Result<&Mesh> {
    scene.meshes.get(index as usize).ok_or_else(|| missing("mesh", index, scene.meshes.len()))
}

/// Copies `data` into the caller's array, which has room for `capacity` elements; an element has `numbers` values.
fn copy<T: bytemuck::NoUninit>(data: &[T], numbers: usize, place: *mut T, capacity: usize, name: &str) -> Result<()> {
    let needed = data.len() / numbers;
    if needed == 0 {
        return Ok(());
    }
    if place.is_null() {
        return Err(Error::argument(format!("the array for the {name} is NULL; it must have room for {needed}")));
    }
    if capacity < needed {
        return Err(Error::argument(format!("there is room for {capacity} {name}; {needed} are needed")));
    }
    let data: &[u8] = bytemuck::cast_slice(data);
    bytes_mut(place.cast(), data.len(), name)?.copy_from_slice(data);
    Ok(())
}
