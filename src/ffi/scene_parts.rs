//! Scene description
//!
//! Builds a scene from arrays of the host: add materials first, then the meshes that use them, then cameras. The calls
//! copy the arrays, which may have any alignment and stride.

use super::guard::enter;
use super::params::{self, Report, Versioned, versioned};
use super::pointer::{bytes, set_optional, strided, text};
use super::scene::{luxfer_scene, missing};
use super::status::luxfer_status;
use crate::error::{Error, Result, check_range};
use crate::image::try_vec;
use crate::scene::{Camera, Mesh, check_place};
use glam::{Vec2, Vec3};
use std::ffi::{c_char, c_void};

/// A triangle mesh in world space. Fill it with luxfer_mesh_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_mesh_params {
    /// sizeof(luxfer_mesh_params), set by luxfer_mesh_params_init.
    pub struct_size: u32,
    /// Index of the mesh's material, as luxfer_scene_add_material returns it; default 0.
    pub material: u32,
    /// Name in UTF-8, copied; luxfer_scene_find_surface finds surfaces by it. NULL, the default: no name.
    pub name: *const c_char,
    /// Number of vertices in [3, 2^32 - 1]; default 0: the caller must set it.
    pub vertex_count: usize,
    /// Positions: three floats per vertex, in metres, each in [-1e15, 1e15]; default NULL: the caller must set them.
    pub positions: *const c_void,
    /// Bytes from one position to the next; at least 12, or 0, the default: packed.
    pub position_stride: usize,
    /// Normals: three floats per vertex, finite; NULL, the default: triangles are shaded flat.
    pub normals: *const c_void,
    /// Bytes from one normal to the next; at least 12, or 0, the default: packed.
    pub normal_stride: usize,
    /// Texture coordinates: two floats per vertex, finite; (0, 0) is the top-left corner of a texture. NULL, the
    /// default: no texture coordinates.
    pub uvs: *const c_void,
    /// Bytes from one pair of texture coordinates to the next; at least 8, or 0, the default: packed.
    pub uv_stride: usize,
    /// Number of triangles, at least 1; default 0: the caller must set it.
    pub triangle_count: usize,
    /// Vertex indices: three uint32_t per triangle, each less than vertex_count, counter-clockwise seen from the
    /// front; default NULL: the caller must set them.
    pub indices: *const c_void,
    /// Bytes from one triangle to the next; at least 12, or 0, the default: packed.
    pub index_stride: usize,
    /// Colours of the vertices: red, green, blue and alpha as four floats per vertex, linear, each in [0, 1]. They
    /// multiply the material's base colour and alpha. NULL, the default: no colours.
    pub colours: *const c_void,
    /// Bytes from one colour to the next; at least 16, or 0, the default: packed.
    pub colour_stride: usize,
}

const MESH_SIZE: usize = 8 + 13 * size_of::<usize>();

versioned!(luxfer_mesh_params, [MESH_SIZE], {
    Self {
        struct_size: MESH_SIZE as u32,
        material: 0,
        name: std::ptr::null(),
        vertex_count: 0,
        positions: std::ptr::null(),
        position_stride: 0,
        normals: std::ptr::null(),
        normal_stride: 0,
        uvs: std::ptr::null(),
        uv_stride: 0,
        triangle_count: 0,
        indices: std::ptr::null(),
        index_stride: 0,
        colours: std::ptr::null(),
        colour_stride: 0,
    }
});

/// A pinhole camera. Fill it with luxfer_camera_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_camera_params {
    /// sizeof(luxfer_camera_params), set by luxfer_camera_params_init.
    pub struct_size: u32,
    /// Full vertical angle of view in radians, in [0.001, 3.1]; default 1.
    pub fov_y: f32,
    /// Position of the eye in metres, each coordinate in [-1e15, 1e15]; default (0, 0, 0).
    pub position: [f32; 3],
    /// Point that the camera looks at, in metres, each coordinate in [-1e15, 1e15], different from position; default
    /// (0, 0, -1).
    pub target: [f32; 3],
    /// Up direction of the image, finite and not parallel to the viewing direction; default (0, 1, 0).
    pub up: [f32; 3],
    /// Must be 0.
    pub reserved: u32,
}

versioned!(luxfer_camera_params, [48], {
    Self { struct_size: 48, fov_y: 1.0, position: [0.0; 3], target: [0.0, 0.0, -1.0], up: [0.0, 1.0, 0.0], reserved: 0 }
});

impl luxfer_camera_params {
    pub(super) fn camera(&self) -> Result<Camera> {
        let [position, target, up] = [self.position, self.target, self.up].map(Vec3::from_array);
        check_range("camera.fov_y", self.fov_y, 0.001, 3.1)?;
        check_place(|| "camera.position", position)?;
        check_place(|| "camera.target", target)?;
        if !up.is_finite() {
            return Err(Error::argument(format!("camera.up is {up}; it must be finite")));
        }
        let forward = (target - position).try_normalize();
        let side = forward.and_then(|f| f.cross(up).try_normalize());
        let (Some(forward), Some(side)) = (forward, side) else {
            return Err(Error::argument(format!(
                "camera.position is {position}, target {target}, up {up}; the target must be elsewhere and up not along the view"
            )));
        };
        Ok(Camera { name: String::new(), position, forward, up: side.cross(forward), fov_y: self.fov_y })
    }
}

/// Adds a mesh to a scene and copies its arrays; *index, unless NULL, receives its index. Any thread.
/// LUXFER_INVALID_ARGUMENT if an array is missing, a stride is too small, a number is not finite or an index is out of
/// range; LUXFER_NOT_FOUND if the scene has no such material; LUXFER_OUT_OF_MEMORY beyond the memory budget.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_add_mesh(
    scene: *mut luxfer_scene,
    params: *const luxfer_mesh_params,
    index: *mut u32,
) -> luxfer_status {
    enter(scene, |object| {
        let params = params::read_required(params)?;
        let vertices = u64::try_from(params.vertex_count).unwrap_or(u64::MAX);
        check_range("mesh.vertex_count", vertices, 3, u64::from(u32::MAX))?;
        let vertex = if params.colours.is_null() { 32 } else { 48 };
        let cost = vertices.saturating_mul(vertex).saturating_add((params.triangle_count as u64).saturating_mul(12));
        let added = object.change(cost, |scene| {
            if params.material as usize >= scene.materials.len() {
                return Err(missing("material", params.material, scene.materials.len()));
            }
            let mesh = mesh(&params)?;
            Ok(push(&mut scene.meshes, mesh))
        })?;
        set_optional(index, added);
        Ok(())
    })
}

fn mesh(params: &luxfer_mesh_params) -> Result<Mesh> {
    let count = params.vertex_count;
    let positions = array(params.positions, count, params.position_stride, "mesh.positions", f32::from_ne_bytes)?;
    let vectors = |data: *const c_void, stride, name| -> Result<Vec<Vec3>> {
        let rows = if data.is_null() { Vec::new() } else { array(data, count, stride, name, f32::from_ne_bytes)? };
        check_finite(rows, name)
    };
    let uvs = if params.uvs.is_null() {
        Vec::new()
    } else {
        array(params.uvs, count, params.uv_stride, "mesh.uvs", f32::from_ne_bytes)?
    };
    let colours = if params.colours.is_null() {
        Vec::new()
    } else {
        array(params.colours, count, params.colour_stride, "mesh.colours", f32::from_ne_bytes)?
    };
    if let Some(i) = colours.iter().position(|c: &[f32; 4]| c.iter().any(|v| !(0.0..=1.0).contains(v))) {
        let colour = colours[i];
        return Err(Error::argument(format!("element {i} of mesh.colours is {colour:?}; it must lie in [0, 1]")));
    }
    let triangles: Vec<[u32; 3]> =
        array(params.indices, params.triangle_count, params.index_stride, "mesh.indices", u32::from_ne_bytes)?;
    if let Some((i, bad)) = triangles.iter().enumerate().find(|(_, t)| t.iter().any(|&v| v as usize >= count)) {
        return Err(Error::argument(format!("triangle {i} of mesh.indices is {bad:?}; vertex_count is {count}")));
    }
    let positions: Vec<Vec3> = check_finite(positions, "mesh.positions")?;
    for (i, &position) in positions.iter().enumerate() {
        check_place(|| format!("element {i} of mesh.positions"), position)?;
    }
    Ok(Mesh {
        name: optional_text(params.name, "mesh.name")?,
        material: params.material as usize,
        positions,
        normals: vectors(params.normals, params.normal_stride, "mesh.normals")?,
        uvs: [check_finite::<2, Vec2>(uvs, "mesh.uvs")?, Vec::new()],
        colours: check_finite(colours, "mesh.colours")?,
        triangles,
    })
}

/// Reads `count` rows of `N` four-byte numbers that lie `stride` bytes apart.
fn array<const N: usize, T: Copy + Default>(
    data: *const c_void,
    count: usize,
    stride: usize,
    name: &str,
    decode: fn([u8; 4]) -> T,
) -> Result<Vec<[T; N]>> {
    if count == 0 {
        return Err(Error::argument(format!("{name} has no elements; it needs at least one")));
    }
    let (stride, size) = strided::<[T; N]>(count, stride, name)?;
    let bytes = bytes(data.cast(), size, name)?;
    let mut rows = try_vec(count, [T::default(); N])?;
    for (out, row) in rows.iter_mut().zip(bytes.chunks(stride)) {
        for (value, raw) in out.iter_mut().zip(row.chunks_exact(4)) {
            *value = decode([raw[0], raw[1], raw[2], raw[3]]);
        }
    }
    Ok(rows)
}

/// Converts rows of numbers to vectors; an error if a number is not finite.
fn check_finite<const N: usize, V: From<[f32; N]>>(rows: Vec<[f32; N]>, name: &str) -> Result<Vec<V>> {
    match rows.iter().position(|row| row.iter().any(|v| !v.is_finite())) {
        Some(i) => Err(Error::argument(format!("element {i} of {name} is {:?}; it must be finite", rows[i]))),
        None => Ok(rows.into_iter().map(V::from).collect()),
    }
}

/// Adds a camera to a scene; *index, unless NULL, receives its index. params may be NULL for the defaults. Any thread.
/// LUXFER_INVALID_ARGUMENT if a value is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_add_camera(
    scene: *mut luxfer_scene,
    params: *const luxfer_camera_params,
    index: *mut u32,
) -> luxfer_status {
    enter(scene, |object| {
        let camera = params::read(params)?.camera()?;
        let added = object.change(0, |scene| Ok(push(&mut scene.cameras, camera)))?;
        set_optional(index, added);
        Ok(())
    })
}

/// Replaces a camera of a scene; the camera keeps its name. params may be NULL for the defaults. Any thread.
/// LUXFER_NOT_FOUND if there is no such camera; LUXFER_INVALID_ARGUMENT if a value is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_set_camera(
    scene: *mut luxfer_scene,
    index: u32,
    params: *const luxfer_camera_params,
) -> luxfer_status {
    enter(scene, |object| {
        let camera = params::read(params)?.camera()?;
        object.change(0, |scene| {
            let count = scene.cameras.len();
            let place = scene.cameras.get_mut(index as usize).ok_or_else(|| missing("camera", index, count))?;
            *place = Camera { name: std::mem::take(&mut place.name), ..camera };
            Ok(())
        })
    })
}

/// Reads a camera of a scene; target becomes a point 1 m in front of the camera. size is sizeof *params. Any thread.
/// LUXFER_NOT_FOUND if there is no such camera.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_camera(
    scene: *mut luxfer_scene,
    index: u32,
    params: *mut luxfer_camera_params,
    size: usize,
) -> luxfer_status {
    enter(scene, |object| {
        let out = Report::new(params, size)?;
        let scene = object.snapshot();
        let camera = scene.cameras.get(index as usize).ok_or_else(|| missing("camera", index, scene.cameras.len()))?;
        out.set(luxfer_camera_params {
            fov_y: camera.fov_y,
            position: camera.position.to_array(),
            target: (camera.position + camera.forward).to_array(),
            up: camera.up.to_array(),
            ..luxfer_camera_params::defaults()
        });
        Ok(())
    })
}

/// Appends an item to a list of the scene and returns its index.
pub(super) fn push<T>(list: &mut Vec<T>, item: T) -> u32 {
    list.push(item);
    (list.len() - 1) as u32
}

pub(super) fn optional_text(pointer: *const c_char, name: &str) -> Result<String> {
    if pointer.is_null() { Ok(String::new()) } else { Ok(text(pointer, name)?.to_string()) }
}
