//! Contract of scenes at the C boundary: reading back meshes, materials and textures, and tracing rays.

use crate::host::{context, image, made, message, scene};
use luxfer::ffi::*;
use std::ptr::{null, null_mut};

fn zeroed<T>() -> T {
    // SAFETY: used only for structs of numbers and pointers.
    unsafe { std::mem::zeroed() }
}

#[test]
fn a_mesh_comes_back_as_it_was_described() {
    let context = context(1);
    let scene = scene(context);
    unsafe {
        let mut info = std::mem::zeroed::<luxfer_mesh_info>();
        assert_eq!(luxfer_scene_get_mesh(scene, 1, &mut info, size_of_val(&info)), LUXFER_OK);
        assert_eq!((info.material, info.vertex_count, info.triangle_count), (1, 4, 2));
        assert_eq!((info.has_normals, info.uv_sets), (0, 0));
        let (mut positions, mut indices) = ([0.0f32; 12], [0u32; 6]);
        let read = |attribute, capacity, values| luxfer_scene_read_vertices(scene, 1, attribute, values, capacity);
        assert_eq!(read(LUXFER_VERTEX_POSITION, 4, positions.as_mut_ptr()), LUXFER_OK);
        assert_eq!(luxfer_scene_read_triangles(scene, 1, indices.as_mut_ptr(), 2), LUXFER_OK);
        assert_eq!(positions, [-0.5, 1.9, -0.5, 0.5, 1.9, -0.5, 0.5, 1.9, 0.5, -0.5, 1.9, 0.5]);
        assert_eq!(indices, [0, 1, 2, 0, 2, 3]);
        // Nothing is written if the array is too small.
        let (mut positions, mut indices) = ([7.0f32; 12], [7u32; 6]);
        assert_eq!(luxfer_scene_read_triangles(scene, 1, indices.as_mut_ptr(), 1), LUXFER_INVALID_ARGUMENT);
        assert!(message(context).contains("room for 1 triangles; 2"), "{}", message(context));
        assert_eq!(read(LUXFER_VERTEX_POSITION, 3, positions.as_mut_ptr()), LUXFER_INVALID_ARGUMENT);
        assert_eq!((positions, indices), ([7.0; 12], [7; 6]));
        assert_eq!(read(LUXFER_VERTEX_POSITION, 4, null_mut()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_scene_read_triangles(scene, 1, null_mut(), 2), LUXFER_INVALID_ARGUMENT);
        for lacking in [LUXFER_VERTEX_NORMAL, LUXFER_VERTEX_UV_0, LUXFER_VERTEX_UV_1, LUXFER_VERTEX_COLOUR] {
            assert_eq!(read(lacking, 4, positions.as_mut_ptr()), LUXFER_NOT_FOUND);
        }
        for unknown in [-1, 5, i32::MAX] {
            assert_eq!(read(unknown, 4, positions.as_mut_ptr()), LUXFER_INVALID_ARGUMENT);
        }
        let (mut name, mut needed) = ([0u8; 8], 0);
        assert_eq!(luxfer_scene_get_mesh_name(scene, 1, name.as_mut_ptr().cast(), 8, &mut needed), LUXFER_OK);
        assert_eq!((&name[..needed], needed), (&b"Lamp\0"[..], 5));
        assert_eq!(luxfer_scene_get_mesh(scene, 2, &mut info, size_of_val(&info)), LUXFER_NOT_FOUND);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn materials_and_textures_come_back() {
    let context = context(1);
    let scene = scene(context);
    let light = image(context, 5, 3, 2.0);
    unsafe {
        let (mut mesh, mut index) = (0, 0);
        let name = c"Lamp".as_ptr();
        let status = luxfer_scene_place_emission(scene, name, light, [1.0, 2.0, 3.0].as_ptr(), &mut mesh, &mut index);
        assert_eq!(status, LUXFER_OK, "{}", message(context));
        let mut material: luxfer_material_params = zeroed();
        assert_eq!(luxfer_scene_get_material(scene, index, &mut material, size_of_val(&material)), LUXFER_OK);
        assert_eq!((material.emission, material.double_sided, material.ior), ([1.0, 2.0, 3.0], 0, 1.5));
        assert!(material.name.is_null());

        let mut used = std::mem::zeroed::<luxfer_texture_use>();
        let mut role =
            |role| (luxfer_scene_get_material_texture(scene, index, role, &mut used, size_of_val(&used)), used.texture);
        assert_eq!(role(LUXFER_TEXTURE_BASE_COLOR), (LUXFER_OK, LUXFER_NONE));
        assert_eq!(role(LUXFER_TEXTURE_NORMAL), (LUXFER_OK, LUXFER_NONE));
        assert_eq!(role(4).0, LUXFER_INVALID_ARGUMENT);
        assert_eq!(role(LUXFER_TEXTURE_EMISSION), (LUXFER_OK, 0));
        assert_eq!((used.uv_set, used.wrap_u, used.wrap_v), (1, LUXFER_WRAP_CLAMP, LUXFER_WRAP_CLAMP));
        assert_eq!(used.transform, [1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let texture = made(|out| luxfer_scene_get_texture(scene, used.texture, out));
        assert_eq!(luxfer_scene_get_texture(scene, 1, &mut null_mut()), LUXFER_NOT_FOUND);
        assert_eq!(luxfer_scene_get_material(scene, 3, &mut material, size_of_val(&material)), LUXFER_NOT_FOUND);

        // A texture outlives its scene.
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        let (mut width, mut height) = (0, 0);
        assert_eq!(luxfer_image_get_size(texture, &mut width, &mut height, null_mut()), LUXFER_OK);
        assert_eq!((width, height), (5, 3));
        assert_eq!(luxfer_release(texture.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(light.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn rays_hit_what_they_should_after_every_change() {
    let context = context(2);
    let scene = scene(context);
    let up = luxfer_ray { origin: [0.1, 0.0, 0.2], direction: [0.0, 2.0, 0.0], t_max: f32::INFINITY };
    let rays = [
        up,
        luxfer_ray { t_max: 0.9, ..up },
        luxfer_ray { direction: [0.0; 3], ..up },
        luxfer_ray { origin: [f32::NAN; 3], ..up },
        luxfer_ray { direction: [0.0, -2.0, 0.0], ..up },
    ];
    let none = luxfer_hit { t: -1.0, mesh: 7, triangle: 7, u: -1.0, v: -1.0 };
    unsafe {
        let mut hits = [none; 5];
        assert_eq!(luxfer_scene_intersect(scene, rays.as_ptr(), 5, 0, hits.as_mut_ptr(), 0), LUXFER_OK);
        assert_eq!(hits.map(|h| h.mesh), [1, LUXFER_NONE, LUXFER_NONE, LUXFER_NONE, 0]);
        assert_eq!(hits.map(|h| h.t), [0.95, f32::INFINITY, f32::INFINITY, f32::INFINITY, 1.0]);
        // The ray hits the lamp at (0.6, 0.7) of its square: in the second triangle, whose corners are 0, 2 and 3.
        assert_eq!(hits[0].triangle, 1);
        assert!((hits[0].u - 0.6).abs() < 1e-5 && (hits[0].v - 0.1).abs() < 1e-5, "{} {}", hits[0].u, hits[0].v);

        // A ray and its hit may be fields of one struct.
        let mut pairs = rays.map(|ray| (ray, none));
        let (first, stride) = (pairs.as_mut_ptr(), size_of_val(&pairs[0]));
        let (ray, hit) = (&raw const (*first).0, &raw mut (*first).1);
        assert_eq!(luxfer_scene_intersect(scene, ray, 5, stride, hit, stride), LUXFER_OK);
        assert_eq!(pairs.map(|pair| pair.1.t), hits.map(|hit| hit.t));
        assert_eq!(pairs.map(|pair| pair.0.direction[1]), rays.map(|ray| ray.direction[1]));
        assert_eq!(luxfer_scene_intersect(scene, ray, 5, 24, hit, stride), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_scene_intersect(scene, ray, 5, stride, hit, 16), LUXFER_INVALID_ARGUMENT);

        // Change the scene: add a triangle that covers the lamp.
        let positions = [[-1.0f32, 1.5, -1.0], [1.0, 1.5, -1.0], [0.0, 1.5, 2.0]];
        let mut mesh: luxfer_mesh_params = zeroed();
        assert_eq!(luxfer_init(LUXFER_STRUCT_MESH_PARAMS, (&raw mut mesh).cast(), size_of_val(&mesh)), LUXFER_OK);
        (mesh.vertex_count, mesh.positions) = (3, positions.as_ptr().cast());
        (mesh.triangle_count, mesh.indices) = (1, [0u32, 1, 2].as_ptr().cast());
        assert_eq!(luxfer_scene_add_mesh(scene, &mesh, null_mut()), LUXFER_OK);
        assert_eq!(luxfer_scene_intersect(scene, rays.as_ptr(), 1, 0, hits.as_mut_ptr(), 0), LUXFER_OK);
        assert_eq!((hits[0].mesh, hits[0].t), (2, 0.75));

        assert_eq!(luxfer_scene_intersect(scene, null(), 0, 0, null_mut(), 0), LUXFER_OK);
        assert_eq!(luxfer_scene_intersect(scene, null(), 1, 0, hits.as_mut_ptr(), 0), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_scene_intersect(scene, rays.as_ptr(), 1, 0, null_mut(), 0), LUXFER_INVALID_ARGUMENT);
        let too_many = luxfer_scene_intersect(scene, rays.as_ptr(), usize::MAX / 2, 0, hits.as_mut_ptr(), 0);
        assert_eq!(too_many, LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn generated_scenes_and_warps_refuse_what_makes_no_sense() {
    let context = context(1);
    unsafe {
        let mut scene = null_mut();
        for which in [-1, 4, i32::MAX] {
            assert_eq!(luxfer_demo_create_scene(context, which, &mut scene), LUXFER_INVALID_ARGUMENT);
        }
        let source = image(context, 4, 4, 0.5);
        let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let warp = |map: &[f64; 9], width, height| {
            let mut out = null_mut();
            let status = luxfer_image_warp(source, map.as_ptr(), width, height, &mut out);
            assert_eq!(status == LUXFER_OK, !out.is_null());
            assert_eq!(luxfer_release(out.cast()), LUXFER_OK);
            status
        };
        assert_eq!(warp(&identity, 4, 4), LUXFER_OK);
        assert_eq!(warp(&identity, 0, 4), LUXFER_INVALID_ARGUMENT);
        assert_eq!(warp(&identity, 4, 65537), LUXFER_INVALID_ARGUMENT);
        assert_eq!(warp(&[f64::NAN; 9], 4, 4), LUXFER_INVALID_ARGUMENT);
        assert_eq!(warp(&[0.0; 9], 4, 4), LUXFER_OK, "a map to nowhere shows nothing");
        assert_eq!(luxfer_release(source.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn materials_are_replaced_and_keep_their_textures() {
    let context = context(1);
    let scene = scene(context);
    let mut pixels = [0.5f32; 2 * 2 * 4];
    let view = luxfer_image_view { channels: 4, ..crate::host::view(2, 2, &mut pixels) };
    let picture = made(|out| unsafe { luxfer_image_create(context, &view, out) });
    let dark = image(context, 2, 2, -1.0);
    unsafe {
        let (mut texture, mut negative) = (9, 9);
        let add = |image, wrap, index: *mut u32| luxfer_scene_add_texture(scene, image, wrap, LUXFER_WRAP_CLAMP, index);
        assert_eq!(add(picture, 3, &mut texture), LUXFER_INVALID_ARGUMENT);
        assert_eq!(add(null_mut(), LUXFER_WRAP_MIRROR, &mut texture), LUXFER_INVALID_ARGUMENT);
        assert_eq!(add(picture, LUXFER_WRAP_MIRROR, &mut texture), LUXFER_OK, "{}", message(context));
        assert_eq!(add(dark, LUXFER_WRAP_REPEAT, &mut negative), LUXFER_OK);
        assert_eq!((texture, negative), (0, 1));
        let set = |material, role, texture, uv_set, transform: *const f32| {
            luxfer_scene_set_material_texture(scene, material, role, texture, uv_set, transform)
        };
        let transform = [2.0f32, 0.0, 0.25, 0.0, 3.0, 0.5];
        assert_eq!(set(2, LUXFER_TEXTURE_BASE_COLOR, 0, 0, null()), LUXFER_NOT_FOUND);
        assert_eq!(set(0, LUXFER_TEXTURE_BASE_COLOR, 2, 0, null()), LUXFER_NOT_FOUND);
        assert_eq!(set(0, 4, 0, 0, null()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(set(0, LUXFER_TEXTURE_BASE_COLOR, 0, 2, null()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(set(0, LUXFER_TEXTURE_BASE_COLOR, 0, 0, [f32::NAN; 6].as_ptr()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(set(0, LUXFER_TEXTURE_EMISSION, negative, 0, null()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(set(0, LUXFER_TEXTURE_BASE_COLOR, texture, 1, transform.as_ptr()), LUXFER_OK);
        assert_eq!(set(0, LUXFER_TEXTURE_NORMAL, texture, 0, null()), LUXFER_OK);
        assert_eq!(set(0, LUXFER_TEXTURE_NORMAL, LUXFER_NONE, 0, null()), LUXFER_OK);

        replace_material(scene);
        let mut used = std::mem::zeroed::<luxfer_texture_use>();
        let role = LUXFER_TEXTURE_BASE_COLOR;
        assert_eq!(luxfer_scene_get_material_texture(scene, 0, role, &mut used, size_of_val(&used)), LUXFER_OK);
        assert_eq!((used.texture, used.uv_set, used.transform), (0, 1, transform));
        assert_eq!((used.wrap_u, used.wrap_v), (LUXFER_WRAP_MIRROR, LUXFER_WRAP_CLAMP));
        assert_eq!(
            luxfer_scene_get_material_texture(scene, 0, LUXFER_TEXTURE_NORMAL, &mut used, size_of_val(&used)),
            LUXFER_OK
        );
        assert_eq!(used.texture, LUXFER_NONE);
        for image in [picture, dark] {
            assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        }
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

/// Replaces material 0, and checks that all values are read back as they were set and that a refused call changes
/// none.
fn replace_material(scene: *mut luxfer_scene) {
    unsafe {
        let mut given: luxfer_material_params = zeroed();
        assert_eq!(luxfer_init(LUXFER_STRUCT_MATERIAL_PARAMS, (&raw mut given).cast(), size_of_val(&given)), LUXFER_OK);
        given = luxfer_material_params {
            base_color: [0.1, 0.2, 0.3],
            metallic: 0.4,
            roughness: 0.5,
            emission: [6.0, 7.0, 8.0],
            transmission: 0.9,
            ior: 1.1,
            alpha: 0.6,
            alpha_mode: LUXFER_ALPHA_MASK,
            alpha_cutoff: 0.7,
            normal_scale: -2.0,
            thickness: 0.01,
            attenuation_color: [0.9, 0.8, 0.0],
            attenuation_distance: 0.25,
            double_sided: 0,
            ..given
        };
        assert_eq!(luxfer_scene_set_material(scene, 0, &given), LUXFER_OK);
        for wrong in [
            luxfer_material_params { alpha_mode: 3, ..given },
            luxfer_material_params { alpha: 1.1, ..given },
            luxfer_material_params { alpha_cutoff: f32::NAN, ..given },
            luxfer_material_params { normal_scale: f32::INFINITY, ..given },
            luxfer_material_params { thickness: f32::INFINITY, ..given },
            luxfer_material_params { attenuation_color: [0.5, 1.1, 0.5], ..given },
            luxfer_material_params { attenuation_distance: 0.0, ..given },
            luxfer_material_params { attenuation_distance: f32::NAN, ..given },
            luxfer_material_params { reserved: 1, ..given },
        ] {
            assert_eq!(luxfer_scene_set_material(scene, 0, &wrong), LUXFER_INVALID_ARGUMENT);
        }
        assert_eq!(luxfer_scene_set_material(scene, 2, &given), LUXFER_NOT_FOUND);
        let mut back: luxfer_material_params = zeroed();
        assert_eq!(luxfer_scene_get_material(scene, 0, &mut back, size_of_val(&back)), LUXFER_OK);
        let numbers = |m: &luxfer_material_params| {
            let colours = [m.base_color, m.emission, m.attenuation_color];
            let rest = [m.metallic, m.roughness, m.transmission, m.ior, m.alpha, m.alpha_cutoff, m.normal_scale];
            (colours, rest, [m.thickness, m.attenuation_distance], m.alpha_mode, m.double_sided)
        };
        assert_eq!(numbers(&back), numbers(&given));
    }
}
