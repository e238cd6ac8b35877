//! Contract of the C boundary, checked through its functions: handles, versioned structs, image views, files, scenes
//! and messages. Jobs are in `abi_jobs.rs`.

use crate::host::{context, image, made, message, scene, view, wait};
use luxfer::ffi::*;
use std::ffi::{CStr, c_char, c_void};
use std::ptr::{null, null_mut};

#[test]
fn handles_that_are_none_are_errors() {
    let context = context(1);
    let image = image(context, 2, 2, 0.5);
    let garbage = [0xdead_beef_u64; 8];
    let unaligned = garbage.as_ptr().cast::<u8>().wrapping_add(1);
    unsafe {
        for bad in [null_mut(), garbage.as_ptr().cast_mut().cast(), unaligned.cast_mut().cast(), context.cast()] {
            let bad: *mut luxfer_image = bad;
            assert_eq!(luxfer_image_get_size(bad, null_mut(), null_mut(), null_mut()), LUXFER_INVALID_ARGUMENT);
            assert_eq!(luxfer_job_cancel(bad.cast()), LUXFER_INVALID_ARGUMENT);
            if bad != context.cast() {
                assert_eq!(luxfer_retain(bad.cast()), LUXFER_INVALID_ARGUMENT);
                let expected = if bad.is_null() { LUXFER_OK } else { LUXFER_INVALID_ARGUMENT };
                assert_eq!(luxfer_release(bad.cast()), expected);
            }
        }
        assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn objects_of_two_contexts_do_not_mix() {
    let (here, there) = (context(1), context(1));
    let (photo, features) = (image(there, 4, 4, 0.5), made(|out| unsafe { luxfer_features_create(here, out) }));
    unsafe {
        assert_eq!(luxfer_features_set_photo(features, photo), LUXFER_INVALID_ARGUMENT);
        assert!(message(here).contains("photo belongs to another context"), "{}", message(here));
        assert_eq!(message(there), "");
        assert_eq!(luxfer_features_set_photo(features, null_mut()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_release(photo.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(features.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(there.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(here.cast()), LUXFER_OK);
    }
}

#[test]
fn references_are_counted() {
    let context = context(1);
    let image = image(context, 2, 3, 0.25);
    let mut height = 0;
    unsafe {
        for _ in 0..3 {
            assert_eq!(luxfer_retain(image.cast()), LUXFER_OK);
        }
        for _ in 0..3 {
            assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
            assert_eq!(luxfer_image_get_size(image, null_mut(), &mut height, null_mut()), LUXFER_OK);
        }
        assert_eq!(height, 3);
        assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn views_of_every_size_and_stride_are_read_or_refused() {
    let context = context(1);
    let mut pixels = vec![0.5f32; 3 * 65_537];
    let create = |view: &luxfer_image_view| {
        let mut image = null_mut();
        let status = unsafe { luxfer_image_create(context, view, &mut image) };
        assert_eq!(status == LUXFER_OK, !image.is_null(), "outputs are written on success only");
        assert_eq!(unsafe { luxfer_release(image.cast()) }, LUXFER_OK);
        status
    };
    for (width, height, want) in [
        (0, 1, LUXFER_INVALID_ARGUMENT),
        (1, 0, LUXFER_INVALID_ARGUMENT),
        (1, 1, LUXFER_OK),
        (65_536, 1, LUXFER_OK),
        (1, 65_536, LUXFER_OK),
        (65_537, 1, LUXFER_INVALID_ARGUMENT),
        (1, 65_537, LUXFER_INVALID_ARGUMENT),
        (u32::MAX, u32::MAX, LUXFER_INVALID_ARGUMENT),
    ] {
        // Under Miri, test only the smallest valid image: the others would take half an hour.
        if cfg!(miri) && (width, height) != (1, 1) && want == LUXFER_OK {
            continue;
        }
        assert_eq!(create(&view(width, height, &mut pixels)), want, "{width} x {height}");
    }
    let good = view(5, 4, &mut pixels[..60]);
    for (bad, why) in [
        (luxfer_image_view { byte_size: 239, ..good }, "one byte short"),
        (luxfer_image_view { byte_size: usize::MAX, ..good }, "more than there can be"),
        (luxfer_image_view { data: null_mut(), ..good }, "no data"),
        (luxfer_image_view { pixel_stride: 11, ..good }, "pixels overlap"),
        (luxfer_image_view { row_stride: 59, ..good }, "rows overlap"),
        (luxfer_image_view { row_stride: usize::MAX, ..good }, "row stride overflows"),
        (luxfer_image_view { pixel_stride: usize::MAX, ..good }, "pixel stride overflows"),
        (luxfer_image_view { channels: 0, ..good }, "no channels"),
        (luxfer_image_view { channels: 5, ..good }, "five channels"),
        (luxfer_image_view { sample: 4, ..good }, "unknown sample"),
        (luxfer_image_view { sample: -1, ..good }, "negative sample"),
        (luxfer_image_view { colour_space: 2, ..good }, "unknown colour space"),
        (luxfer_image_view { flags: 2, ..good }, "unknown flag"),
        (luxfer_image_view { reserved: 1, ..good }, "reserved field"),
        (luxfer_image_view { struct_size: 0, ..good }, "no size"),
        (luxfer_image_view { struct_size: good.struct_size - 1, ..good }, "too small"),
        (luxfer_image_view { struct_size: u32::MAX, ..good }, "too large"),
    ] {
        assert_eq!(create(&bad), LUXFER_INVALID_ARGUMENT, "{why}");
        assert!(!message(context).is_empty(), "{why}");
    }
    let mut image = null_mut();
    assert_eq!(unsafe { luxfer_image_create(context, null(), &mut image) }, LUXFER_INVALID_ARGUMENT);
    assert_eq!(unsafe { luxfer_image_create(context, &good, null_mut()) }, LUXFER_INVALID_ARGUMENT);
    assert_eq!(unsafe { luxfer_release(context.cast()) }, LUXFER_OK);
}

#[test]
fn pixels_round_trip_through_strides_and_misalignment() {
    let context = context(1);
    let mut bytes = vec![0xffu8; 4096];
    let (width, height, row_stride) = (7u32, 5u32, 7 * 13 + 10);
    let offset = |x: usize, y: usize| 1 + y * row_stride + x * 13;
    for y in 0..5 {
        for x in 0..7 {
            for c in 0..3 {
                let at = offset(x, y) + 4 * c;
                bytes[at..at + 4].copy_from_slice(&((x * 100 + y * 10 + c) as f32).to_ne_bytes());
            }
        }
    }
    let mut strided = view(width, height, &mut []);
    strided.pixel_stride = 13;
    strided.row_stride = row_stride;
    strided.byte_size = bytes.len() - 1;
    strided.data = bytes.as_mut_ptr().wrapping_add(1).cast();
    strided.flags = LUXFER_VIEW_BOTTOM_UP;
    let image = made(|out| unsafe { luxfer_image_create(context, &strided, out) });

    let mut packed = vec![0.0f32; 105];
    assert_eq!(unsafe { luxfer_image_read(image, 0, &view(width, height, &mut packed)) }, LUXFER_OK);
    for (i, pixel) in packed.chunks(3).enumerate() {
        let (x, y) = (i % 7, 4 - i / 7);
        assert_eq!(pixel, [0, 1, 2].map(|c| (x * 100 + y * 10 + c) as f32));
    }
    // Write one of the three channels back into the strided memory; all other bytes stay unchanged.
    let before = bytes.clone();
    let one = luxfer_image_view { channels: 1, data: bytes.as_mut_ptr().wrapping_add(1).cast(), ..strided };
    assert_eq!(unsafe { luxfer_image_read(image, 2, &one) }, LUXFER_OK);
    let changed = (0..bytes.len()).filter(|&i| bytes[i] != before[i]);
    assert!(changed.into_iter().all(|i| (i - 1) % row_stride % 13 < 4));
    assert_eq!(unsafe { luxfer_image_read(image, 3, &one) }, LUXFER_INVALID_ARGUMENT);
    unsafe {
        luxfer_release(image.cast());
        luxfer_release(context.cast());
    }
}

#[test]
fn every_params_struct_takes_its_own_size_and_no_other() {
    macro_rules! check {
        ($($which:ident: $params:ident;)*) => {$(
            let mut room = [0xffu8; 4200];
            let own = size_of::<$params>();
            for size in 0..4200usize {
                let status = unsafe { luxfer_init($which, room.as_mut_ptr().cast(), size) };
                let want = if (own..=4096).contains(&size) { LUXFER_OK } else { LUXFER_INVALID_ARGUMENT };
                assert_eq!(status, want, "{} with {size} bytes", stringify!($which));
            }
            assert_eq!(unsafe { luxfer_init($which, null_mut(), own) }, LUXFER_INVALID_ARGUMENT);
        )*};
    }
    check! {
        LUXFER_STRUCT_CONTEXT_PARAMS: luxfer_context_params;
        LUXFER_STRUCT_IMAGE_VIEW: luxfer_image_view;
        LUXFER_STRUCT_SCENE_LOAD_PARAMS: luxfer_scene_load_params;
        LUXFER_STRUCT_MATERIAL_PARAMS: luxfer_material_params;
        LUXFER_STRUCT_MESH_PARAMS: luxfer_mesh_params;
        LUXFER_STRUCT_CAMERA_PARAMS: luxfer_camera_params;
        LUXFER_STRUCT_LIGHT_PARAMS: luxfer_light_params;
        LUXFER_STRUCT_LUMINAIRE_PARAMS: luxfer_luminaire_params;
        LUXFER_STRUCT_RENDER_PARAMS: luxfer_render_params;
        LUXFER_STRUCT_RECTIFY_PARAMS: luxfer_rectify_params;
        LUXFER_STRUCT_FEATURES_PARAMS: luxfer_features_params;
        LUXFER_STRUCT_SEGMENT_PARAMS: luxfer_segment_params;
        LUXFER_STRUCT_EMISSION_PARAMS: luxfer_emission_params;
        LUXFER_STRUCT_RELIGHT_PARAMS: luxfer_relight_params;
        LUXFER_STRUCT_PATTERN_PARAMS: luxfer_pattern_params;
        LUXFER_STRUCT_TRANSFER_PARAMS: luxfer_transfer_params;
        LUXFER_STRUCT_ILLUMINANCE_PARAMS: luxfer_illuminance_params;
        LUXFER_STRUCT_ILLUMINANCE_GRID: luxfer_illuminance_grid;
        LUXFER_STRUCT_LAMPS_PARAMS: luxfer_lamps_params;
        LUXFER_STRUCT_IMPORTANCE_PARAMS: luxfer_importance_params;
        LUXFER_STRUCT_PLACEMENT_PARAMS: luxfer_placement_params;
        LUXFER_STRUCT_FALSE_COLOUR_PARAMS: luxfer_false_colour_params;
        LUXFER_STRUCT_GUIDES_PARAMS: luxfer_guides_params;
        LUXFER_STRUCT_STYLIZE_PARAMS: luxfer_stylize_params;
        LUXFER_STRUCT_SHEET_PARAMS: luxfer_sheet_params;
        LUXFER_STRUCT_PLAN_PARAMS: luxfer_plan_params;
        LUXFER_STRUCT_RENDER_PART: luxfer_render_part;
        LUXFER_STRUCT_DEMO_PHOTO_PARAMS: luxfer_demo_photo_params;
        LUXFER_STRUCT_PENDANTS_PARAMS: luxfer_pendants_params;
        LUXFER_STRUCT_MERGE_PARAMS: luxfer_merge_params;
        LUXFER_STRUCT_GONIO_PARAMS: luxfer_gonio_params;
        LUXFER_STRUCT_GLARE_PARAMS: luxfer_glare_params;
        LUXFER_STRUCT_SUN_PARAMS: luxfer_sun_params;
        LUXFER_STRUCT_SKY_PARAMS: luxfer_sky_params;
    }
    let mut room = [0xffu8; 4200];
    for unknown in [-1, 34, i32::MAX] {
        assert_eq!(unsafe { luxfer_init(unknown, room.as_mut_ptr().cast(), 4096) }, LUXFER_INVALID_ARGUMENT);
    }
}

#[test]
fn a_newer_struct_is_taken_if_what_is_new_is_zero() {
    #[repr(C)]
    struct Newer {
        known: luxfer_context_params,
        unknown: [u32; 4],
    }
    let known = luxfer_context_params { struct_size: size_of::<Newer>() as u32, num_threads: 1, memory_budget_mib: 0 };
    let mut newer = Newer { known, unknown: [0; 4] };
    let context = made(|out| unsafe { luxfer_context_create((&raw const newer).cast(), out) });
    newer.unknown[3] = 1;
    let mut refused = null_mut();
    unsafe {
        let status = luxfer_context_create((&raw const newer).cast(), &mut refused);
        assert_eq!((status, refused.is_null()), (LUXFER_INVALID_ARGUMENT, true));
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
        let many = luxfer_context_params { struct_size: 16, num_threads: 1025, memory_budget_mib: 0 };
        assert_eq!(luxfer_context_create(&many, &mut refused), LUXFER_INVALID_ARGUMENT);
    }
}

#[test]
fn messages_are_kept_for_each_thread_and_cut_to_fit() {
    let context = context(1);
    let shared = context as usize;
    let fail = move |path: &CStr| unsafe {
        let mut image = null_mut();
        luxfer_image_load(shared as *mut luxfer_context, path.as_ptr(), LUXFER_COLOUR_SRGB, &mut image)
    };
    assert_eq!(message(context), "");
    assert_eq!(fail(c"/nonexistent/here.png"), LUXFER_IO);
    std::thread::spawn(move || {
        assert_eq!(message(shared as *mut luxfer_context), "");
        assert_eq!(fail(c"/nonexistent/there.png"), LUXFER_IO);
        assert!(message(shared as *mut luxfer_context).contains("there.png"));
    })
    .join()
    .unwrap();
    let whole = message(context);
    assert!(whole.contains("here.png"), "{whole}");

    let mut needed = 0;
    unsafe {
        assert_eq!(luxfer_context_get_last_error(context, null_mut(), 0, &mut needed), LUXFER_OK);
        assert_eq!(needed, whole.len() + 1);
        for capacity in 1..needed + 3 {
            let mut buffer = vec![0x7f as c_char; needed + 8];
            assert_eq!(luxfer_context_get_last_error(context, buffer.as_mut_ptr(), capacity, null_mut()), LUXFER_OK);
            let text = CStr::from_ptr(buffer.as_ptr()).to_str().unwrap();
            assert_eq!(text, &whole[..whole.len().min(capacity - 1)]);
            assert!(buffer[capacity.min(needed)..].iter().all(|&b| b == 0x7f));
        }
        assert_eq!(luxfer_context_get_last_error(context, null_mut(), 5, null_mut()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn the_memory_budget_holds_until_objects_are_released() {
    let params = luxfer_context_params { struct_size: 16, num_threads: 1, memory_budget_mib: 1 };
    let context = made(|out| unsafe { luxfer_context_create(&params, out) });
    let mut pixels = vec![0.0f32; 3 * 256 * 256];
    let view = view(256, 256, &mut pixels);
    unsafe {
        let first = made(|out| luxfer_image_create(context, &view, out));
        let mut second = null_mut();
        assert_eq!(luxfer_image_create(context, &view, &mut second), LUXFER_OUT_OF_MEMORY);
        assert!(message(context).contains("memory_budget_mib"), "{}", message(context));
        assert_eq!(luxfer_release(first.cast()), LUXFER_OK);
        assert_eq!(luxfer_image_create(context, &view, &mut second), LUXFER_OK);
        assert_eq!(luxfer_release(second.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn files_that_are_missing_damaged_or_misnamed_say_so() {
    let context = context(1);
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let path = |name: &str| std::ffi::CString::new(folder.join(name).to_str().unwrap()).unwrap();
    let image = image(context, 4, 3, 0.5);
    let mut other = null_mut();
    let mut scene = null_mut();
    unsafe {
        assert_eq!(luxfer_image_save(image, path("contract.png").as_ptr(), 1.0), LUXFER_OK);
        assert_eq!(luxfer_image_save(image, path("contract.EXR").as_ptr(), 0.0), LUXFER_OK);
        for (name, exposure) in [("contract.tif", 1.0), ("contract", 1.0), ("c.png", 0.0), ("c.png", f32::NAN)] {
            assert_eq!(luxfer_image_save(image, path(name).as_ptr(), exposure), LUXFER_INVALID_ARGUMENT);
        }
        assert_eq!(luxfer_image_save(image, c"/nonexistent/x.png".as_ptr(), 1.0), LUXFER_IO);
        let load = |path: *const c_char, space, out: &mut _| luxfer_image_load(context, path, space, out);
        assert_eq!(load(path("contract.png").as_ptr(), 7, &mut other), LUXFER_INVALID_ARGUMENT);
        assert_eq!(load(null(), LUXFER_COLOUR_SRGB, &mut other), LUXFER_INVALID_ARGUMENT);
        assert_eq!(load(c"\xff\xfe.png".as_ptr(), LUXFER_COLOUR_SRGB, &mut other), LUXFER_INVALID_ARGUMENT);
        assert_eq!(load(path("contract.png").as_ptr(), LUXFER_COLOUR_SRGB, &mut other), LUXFER_OK);
        assert_eq!(luxfer_release(other.cast()), LUXFER_OK);
        let junk = [7u8; 64];
        let junk = junk.as_ptr().cast();
        assert_eq!(luxfer_image_load_memory(context, junk, 64, LUXFER_COLOUR_SRGB, &mut other), LUXFER_FORMAT);
        assert_eq!(
            luxfer_image_load_memory(context, null(), 64, LUXFER_COLOUR_SRGB, &mut other),
            LUXFER_INVALID_ARGUMENT
        );
        assert_eq!(luxfer_scene_load_memory(context, junk, 64, null(), null(), &mut scene), LUXFER_FORMAT);
        assert_eq!(luxfer_scene_load(context, c"/nonexistent.glb".as_ptr(), null(), &mut scene), LUXFER_IO);
        assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn scenes_are_checked_as_they_are_described() {
    let context = context(1);
    let scene = scene(context);
    let positions = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, f32::NAN]];
    let (inside, outside) = ([[0u32, 1, 2]], [[0u32, 1, 3]]);
    unsafe {
        let mut mesh = std::mem::zeroed::<luxfer_mesh_params>();
        assert_eq!(luxfer_init(LUXFER_STRUCT_MESH_PARAMS, (&raw mut mesh).cast(), size_of_val(&mesh)), LUXFER_OK);
        (mesh.vertex_count, mesh.positions) = (3, positions.as_ptr().cast());
        (mesh.triangle_count, mesh.indices) = (1, outside.as_ptr().cast());
        let add = |mesh: &luxfer_mesh_params| luxfer_scene_add_mesh(scene, mesh, null_mut());
        assert_eq!(add(&mesh), LUXFER_INVALID_ARGUMENT);
        mesh.indices = inside.as_ptr().cast();
        assert_eq!(add(&mesh), LUXFER_INVALID_ARGUMENT);
        assert!(message(context).contains("mesh.positions"), "{}", message(context));
        assert_eq!(add(&luxfer_mesh_params { material: 9, ..mesh }), LUXFER_NOT_FOUND);
        assert_eq!(add(&luxfer_mesh_params { positions: null(), ..mesh }), LUXFER_INVALID_ARGUMENT);
        assert_eq!(add(&luxfer_mesh_params { position_stride: 8, ..mesh }), LUXFER_INVALID_ARGUMENT);
        assert_eq!(add(&luxfer_mesh_params { vertex_count: usize::MAX, ..mesh }), LUXFER_INVALID_ARGUMENT);
        assert_eq!(add(&luxfer_mesh_params { position_stride: usize::MAX, ..mesh }), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_scene_set_environment(scene, null_mut(), [-1.0, 0.0, 0.0].as_ptr()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_scene_set_environment(scene, null_mut(), null()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_scene_set_material(scene, 7, null()), LUXFER_NOT_FOUND);

        let mut counts = std::mem::zeroed::<luxfer_scene_counts>();
        assert_eq!(luxfer_scene_get_counts(scene, &mut counts, 0), LUXFER_INVALID_ARGUMENT);
        assert!(message(context).contains("sizeof(luxfer_scene_counts), 32 bytes"), "{}", message(context));
        assert_eq!(luxfer_scene_get_counts(scene, &mut counts, size_of_val(&counts)), LUXFER_OK);
        assert_eq!(counts.struct_size, 32);
        assert_eq!((counts.meshes, counts.materials, counts.cameras, counts.triangles), (2, 2, 1, 14));

        let mut surface = std::mem::zeroed::<luxfer_surface>();
        assert_eq!(
            luxfer_scene_find_surface(scene, c"Sky".as_ptr(), &mut surface, size_of_val(&surface)),
            LUXFER_NOT_FOUND
        );
        assert_eq!(luxfer_scene_find_surface(scene, c"Lamp".as_ptr(), &mut surface, size_of_val(&surface)), LUXFER_OK);
        assert!((surface.area - 1.0).abs() < 1e-5 && surface.triangles == 2);

        // Save the scene and load it again. An error that the caller's writing function returns ends the save.
        unsafe extern "C" fn collect(user: *mut c_void, data: *const c_void, size: usize) -> i32 {
            unsafe { (*user.cast::<Vec<u8>>()).extend(std::slice::from_raw_parts(data.cast::<u8>(), size)) };
            0
        }
        unsafe extern "C" fn give_up(_: *mut c_void, _: *const c_void, _: usize) -> i32 {
            1
        }
        let mut file: Vec<u8> = Vec::new();
        assert_eq!(luxfer_scene_export_memory(scene, Some(collect), (&raw mut file).cast()), LUXFER_OK);
        assert_eq!(luxfer_scene_export_memory(scene, Some(give_up), null_mut()), LUXFER_IO);
        assert_eq!(luxfer_scene_export_memory(scene, None, null_mut()), LUXFER_INVALID_ARGUMENT);
        let again =
            made(|out| luxfer_scene_load_memory(context, file.as_ptr().cast(), file.len(), null(), null(), out));
        assert_eq!(luxfer_scene_get_counts(again, &mut counts, size_of_val(&counts)), LUXFER_OK);
        assert_eq!(counts.struct_size, 32);
        assert_eq!((counts.meshes, counts.triangles), (2, 14));
        assert_eq!(luxfer_release(again.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn stages_say_what_they_lack() {
    let context = context(1);
    let mut job = null_mut();
    let mut image = null_mut();
    macro_rules! check {
        ($($create:ident $start:ident;)*) => {$(
            let stage = made(|out| unsafe { $create(context, out) });
            unsafe {
                assert_eq!($start(stage, null(), &mut job), LUXFER_INVALID_OPERATION, "{}", stringify!($start));
                assert!(message(context).contains("_set_"), "{}", message(context));
                assert_eq!(luxfer_release(stage.cast()), LUXFER_OK);
            }
        )*};
    }
    check! {
        luxfer_features_create luxfer_features_start;
        luxfer_segment_create luxfer_segment_start;
        luxfer_rectify_create luxfer_rectify_start;
        luxfer_emission_create luxfer_emission_start;
        luxfer_render_create luxfer_render_start;
        luxfer_relight_create luxfer_relight_start;
    }
    let transfer = made(|out| unsafe { luxfer_transfer_create(context, out) });
    unsafe {
        assert_eq!(luxfer_transfer_get_image(transfer, LUXFER_TRANSFER_RENDER, &mut image), LUXFER_NOT_READY);
        for (first, last) in [(-1, 7), (0, 8)] {
            assert_eq!(luxfer_transfer_start(transfer, first, last, null(), &mut job), LUXFER_INVALID_ARGUMENT);
        }
        assert_eq!(luxfer_transfer_start(transfer, 0, 7, null(), &mut job), LUXFER_INVALID_OPERATION);
        assert!(message(context).contains("photo"), "{}", message(context));
        assert_eq!(luxfer_release(transfer.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn settings_of_path_tracing_are_checked_at_the_start() {
    let context = context(1);
    let mut job = null_mut();
    let mut params = unsafe { std::mem::zeroed::<luxfer_relight_params>() };
    let mut of_map = unsafe { std::mem::zeroed::<luxfer_importance_params>() };
    let relight = made(|out| unsafe { luxfer_relight_create(context, out) });
    let importance = made(|out| unsafe { luxfer_importance_create(context, out) });
    unsafe {
        let size = size_of_val(&params);
        assert_eq!(luxfer_init(LUXFER_STRUCT_RELIGHT_PARAMS, (&raw mut params).cast(), size), LUXFER_OK);
        let size = size_of_val(&of_map);
        assert_eq!(luxfer_init(LUXFER_STRUCT_IMPORTANCE_PARAMS, (&raw mut of_map).cast(), size), LUXFER_OK);
    }
    let mut refuses = |paths: u32, target_error: f32, expected: &str| {
        let params = luxfer_relight_params { paths, target_error, ..params };
        let of_map = luxfer_importance_params { paths, target_error, ..of_map };
        assert_eq!(unsafe { luxfer_relight_start(relight, &params, &mut job) }, LUXFER_INVALID_ARGUMENT);
        assert!(message(context).contains(expected), "{}", message(context));
        assert_eq!(unsafe { luxfer_importance_start(importance, &of_map, &mut job) }, LUXFER_INVALID_ARGUMENT);
        assert!(message(context).contains(expected), "{}", message(context));
    };
    refuses(5, 0.01, "paths is 5; it must lie in [1024, 1073741824]");
    refuses(2048, 1.5, "target_error is 1.5; it must lie in [0, 1]");
    refuses(2048, f32::NAN, "target_error is NaN");
    unsafe {
        assert_eq!(luxfer_release(relight.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(importance.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

/// Wrong parameters of strokes, a drawing of another size than the photo, and malformed text are errors.
#[test]
fn wrong_strokes_are_refused() {
    let context = context(1);
    let large = image(context, 9, 6, 0.5);
    let strokes = made(|out| unsafe { luxfer_strokes_create(context, 8, 6, out) });
    let points = [1.0f32, 1.0, 6.0, 1.0];
    let add = |phase, count, radius, positive| unsafe {
        luxfer_strokes_add(strokes, phase, points.as_ptr(), count, radius, positive)
    };
    unsafe {
        let mut none = null_mut();
        for (width, height) in [(0, 6), (8, 0), (65_537, 6)] {
            assert_eq!(luxfer_strokes_create(context, width, height, &mut none), LUXFER_INVALID_ARGUMENT);
        }
        for (phase, count, radius, positive) in
            [(2, 2, 1.0, 1), (-1, 2, 1.0, 1), (0, 0, 1.0, 1), (0, 2, 0.0, 1), (0, 2, 1.0, 2)]
        {
            assert_eq!(add(phase, count, radius, positive), LUXFER_INVALID_ARGUMENT);
        }
        assert_eq!(luxfer_strokes_add_image(strokes, large), LUXFER_INVALID_ARGUMENT);
        assert!(message(context).contains("drawing has 9 x 6"), "{}", message(context));
        assert_eq!(luxfer_strokes_add_text(strokes, c"plane one".as_ptr()), LUXFER_FORMAT);
        for object in [strokes.cast(), large.cast(), context.cast()] {
            assert_eq!(luxfer_release(object), LUXFER_OK);
        }
    }
}

#[test]
fn a_stage_copies_strokes_of_its_size() {
    let context = context(1);
    let (small, large) = (image(context, 8, 6, 0.5), image(context, 9, 6, 0.5));
    let create = |width, height| made(|out| unsafe { luxfer_strokes_create(context, width, height, out) });
    let (strokes, transposed) = (create(8, 6), create(6, 8));
    let segment = made(|out| unsafe { luxfer_segment_create(context, out) });
    let start = || unsafe {
        let job = made(|out| luxfer_segment_start(segment, null(), out));
        let status = wait(job, -1, None, null_mut());
        assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
        status
    };
    unsafe {
        assert_eq!(luxfer_segment_set_features(segment, small), LUXFER_OK);
        assert_eq!(luxfer_segment_set_strokes(segment, LUXFER_PHASE_PLANE, transposed), LUXFER_INVALID_ARGUMENT);
        assert!(message(context).contains("strokes are for 6 x 8"), "{}", message(context));
        assert_eq!(luxfer_segment_set_strokes(segment, 2, strokes), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_segment_set_strokes(segment, LUXFER_PHASE_PLANE, small.cast()), LUXFER_INVALID_ARGUMENT);

        // The stage has a copy of the strokes, so it keeps them after the caller has released them.
        let points = [1.0f32, 1.0, 6.0, 1.0];
        assert_eq!(luxfer_strokes_add(strokes, LUXFER_PHASE_PLANE, points.as_ptr(), 2, 1.0, 1), LUXFER_OK);
        assert_eq!(luxfer_strokes_add_text(strokes, c"not-plane 1 1 5 6 5".as_ptr()), LUXFER_OK);
        assert_eq!(luxfer_segment_set_strokes(segment, LUXFER_PHASE_PLANE, strokes), LUXFER_OK);
        assert_eq!(luxfer_release(strokes.cast()), LUXFER_OK);
        let strokes = create(8, 6);
        assert_eq!(start(), LUXFER_OK);
        assert_eq!(luxfer_segment_set_strokes(segment, LUXFER_PHASE_PLANE, strokes), LUXFER_OK);
        assert_eq!(start(), LUXFER_DEGENERATE);

        // Setting a photo of another size, or NULL strokes, removes the stage's strokes.
        assert_eq!(luxfer_strokes_add_text(strokes, c"plane 1 1 1 6 1\nnot-plane 1 1 5 6 5".as_ptr()), LUXFER_OK);
        for is_larger in [true, false] {
            assert_eq!(luxfer_segment_set_features(segment, small), LUXFER_OK);
            assert_eq!(luxfer_segment_set_strokes(segment, LUXFER_PHASE_PLANE, strokes), LUXFER_OK);
            let status = match is_larger {
                true => luxfer_segment_set_features(segment, large),
                false => luxfer_segment_set_strokes(segment, LUXFER_PHASE_PLANE, null_mut()),
            };
            assert_eq!(status, LUXFER_OK);
            assert_eq!(start(), LUXFER_DEGENERATE);
        }
        for object in [strokes.cast(), transposed.cast(), small.cast(), large.cast(), segment.cast(), context.cast()] {
            assert_eq!(luxfer_release(object), LUXFER_OK);
        }
    }
}
