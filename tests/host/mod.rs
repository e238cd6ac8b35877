//! Common calls of a host: creates a context, images and a scene through the C functions.

#![allow(dead_code, reason = "each test program uses a part")]

use luxfer::ffi::*;
use std::ffi::{CStr, c_char};
use std::ptr::{null, null_mut};

/// Calls a function that creates an object; returns the handle.
pub fn made<T>(create: impl FnOnce(*mut *mut T) -> luxfer_status) -> *mut T {
    let mut handle = null_mut();
    assert_eq!(create(&mut handle), LUXFER_OK);
    assert!(!handle.is_null());
    handle
}

pub fn context(num_threads: u32) -> *mut luxfer_context {
    let params = luxfer_context_params { struct_size: 16, num_threads, memory_budget_mib: 0 };
    made(|out| unsafe { luxfer_context_create(&params, out) })
}

pub fn message(context: *mut luxfer_context) -> String {
    let mut buffer = [0 as c_char; 1024];
    unsafe {
        assert_eq!(luxfer_context_get_last_error(context, buffer.as_mut_ptr(), buffer.len(), null_mut()), LUXFER_OK);
        CStr::from_ptr(buffer.as_ptr()).to_str().unwrap().to_string()
    }
}

pub fn view(width: u32, height: u32, pixels: &mut [f32]) -> luxfer_image_view {
    let mut view = unsafe { std::mem::zeroed::<luxfer_image_view>() };
    assert_eq!(unsafe { luxfer_init(LUXFER_STRUCT_IMAGE_VIEW, (&raw mut view).cast(), size_of_val(&view)) }, LUXFER_OK);
    luxfer_image_view { width, height, byte_size: size_of_val(pixels), data: pixels.as_mut_ptr().cast(), ..view }
}

pub fn image(context: *mut luxfer_context, width: u32, height: u32, value: f32) -> *mut luxfer_image {
    let mut pixels = vec![value; (width * height * 3) as usize];
    let view = view(width, height, &mut pixels);
    made(|out| unsafe { luxfer_image_create(context, &view, out) })
}

/// A closed grey box with a small bright lamp under its ceiling and a camera: enough to keep a renderer busy.
pub fn scene(context: *mut luxfer_context) -> *mut luxfer_scene {
    let scene = made(|out| unsafe { luxfer_scene_create(context, out) });
    let mut material = unsafe { std::mem::zeroed::<luxfer_material_params>() };
    let mut mesh = unsafe { std::mem::zeroed::<luxfer_mesh_params>() };
    unsafe {
        assert_eq!(
            luxfer_init(LUXFER_STRUCT_MATERIAL_PARAMS, (&raw mut material).cast(), size_of_val(&material)),
            LUXFER_OK
        );
        assert_eq!(luxfer_init(LUXFER_STRUCT_MESH_PARAMS, (&raw mut mesh).cast(), size_of_val(&mesh)), LUXFER_OK);
        assert_eq!(luxfer_scene_add_material(scene, &material, null_mut()), LUXFER_OK);
        material.emission = [100.0; 3];
        assert_eq!(luxfer_scene_add_material(scene, &material, null_mut()), LUXFER_OK);
    }
    // The corners of a cube, its six sides, and the lamp as a smaller side.
    let corner = |i: u32| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 2.0f32 } else { -2.0 });
    let room: Vec<[f32; 3]> = (0..8).map(corner).collect();
    let sides: [[u32; 4]; 6] = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let triangles: Vec<[u32; 3]> = sides.iter().flat_map(|s| [[s[0], s[1], s[2]], [s[0], s[2], s[3]]]).collect();
    let lamp = [[-0.5f32, 1.9, -0.5], [0.5, 1.9, -0.5], [0.5, 1.9, 0.5], [-0.5, 1.9, 0.5]];
    let lamp_triangles = [[0u32, 1, 2], [0, 2, 3]];
    let mut add = |material, name: &CStr, positions: &[[f32; 3]], triangles: &[[u32; 3]]| {
        mesh.material = material;
        mesh.name = name.as_ptr();
        (mesh.vertex_count, mesh.positions) = (positions.len(), positions.as_ptr().cast());
        (mesh.triangle_count, mesh.indices) = (triangles.len(), triangles.as_ptr().cast());
        assert_eq!(unsafe { luxfer_scene_add_mesh(scene, &mesh, null_mut()) }, LUXFER_OK, "{}", message(context));
    };
    add(0, c"Room", &room, &triangles);
    add(1, c"Lamp", &lamp, &lamp_triangles);
    assert_eq!(unsafe { luxfer_scene_add_camera(scene, null(), null_mut()) }, LUXFER_OK);
    scene
}

/// Waits for a job; returns its outcome.
pub unsafe fn wait(
    job: *mut luxfer_job,
    timeout_ms: i32,
    progress: luxfer_progress_fn,
    user: *mut std::ffi::c_void,
) -> luxfer_status {
    let mut outcome = LUXFER_UNKNOWN;
    assert_eq!(unsafe { luxfer_job_wait(job, timeout_ms, progress, user, &mut outcome) }, LUXFER_OK);
    outcome
}
