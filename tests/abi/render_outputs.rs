//! Contract of the outputs of rendering at the C boundary: layers, their OpenEXR file, previews, and illuminance.

use crate::host::{context, made, message, scene, wait};
use luxfer::ffi::*;
use std::ffi::{CStr, CString, c_char};
use std::ptr::{null, null_mut};

fn pixels(image: *mut luxfer_image) -> (usize, Vec<f32>) {
    let (mut width, mut height, mut channels) = (0, 0, 0);
    unsafe {
        assert_eq!(luxfer_image_get_size(image, &mut width, &mut height, &mut channels), LUXFER_OK);
        let mut data = vec![0.0f32; (width * height * channels) as usize];
        let view = luxfer_image_view { channels, ..crate::host::view(width, height, &mut data) };
        assert_eq!(luxfer_image_read(image, 0, &view), LUXFER_OK);
        assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        (channels as usize, data)
    }
}

fn finish(job: *mut luxfer_job) -> luxfer_status {
    unsafe {
        let status = wait(job, -1, None, null_mut());
        assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
        status
    }
}

#[test]
fn layers_are_found_read_and_written() {
    let context = context(2);
    let scene = scene(context);
    let render = made(|out| unsafe { luxfer_render_create(context, out) });
    let add = |name: &CStr, expression: &CStr| unsafe {
        luxfer_render_add_expression(render, name.as_ptr(), expression.as_ptr())
    };
    let mut params = unsafe { std::mem::zeroed::<luxfer_render_params>() };
    let mut count = 7;
    unsafe {
        assert_eq!(luxfer_init(LUXFER_STRUCT_RENDER_PARAMS, (&raw mut params).cast(), size_of_val(&params)), LUXFER_OK);
        params = luxfer_render_params { width: 12, height: 8, samples: 8, ..params };
        assert_eq!(luxfer_render_set_scene(render, scene), LUXFER_OK);
        refuse_layers(context, render, &params);
        assert_eq!(add(c"LDE", c"LDE"), LUXFER_OK);
        assert_eq!(add(c"LDE", c"LSE"), LUXFER_INVALID_ARGUMENT);
        assert_eq!(add(c"Lampe \xc3\xbc", c"C.*<L.'Lamp'>"), LUXFER_OK);
        assert_eq!(luxfer_render_set_emitter_as(render, LUXFER_EMITTER_AS_BOTH), LUXFER_OK);
        let aovs = LUXFER_AOV_DEPTH | LUXFER_AOV_NORMAL | LUXFER_AOV_ALPHA;
        assert_eq!(luxfer_render_set_aovs(render, aovs), LUXFER_OK);
        assert_eq!(finish(made(|out| luxfer_render_start(render, &params, out))), LUXFER_OK);
        assert_eq!(luxfer_render_get_layer_count(render, &mut count), LUXFER_OK);
        assert_eq!(count, 5);
        let names = layer_names(render, count);
        assert_eq!(names, ["LDE", "Lampe ü", "Depth", "Normal", "Alpha"]);
        let mut image = null_mut();
        assert_eq!(luxfer_render_get_layer_name(render, 5, null_mut(), 0, null_mut()), LUXFER_NOT_FOUND);
        assert_eq!(luxfer_render_get_layer(render, c"LSE".as_ptr(), &mut image), LUXFER_NOT_FOUND);
        assert!(message(context).contains("Lampe ü"), "{}", message(context));
        compare_layers(render);
        write_layers(context, render);
        assert_eq!(luxfer_release(render.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

/// Checks that wrong expressions are refused with a message that says where the error is, and that an expression with
/// an unknown object label ends the job with an error.
fn refuse_layers(context: *mut luxfer_context, render: *mut luxfer_render, params: &luxfer_render_params) {
    let add = |name: &CStr, expression: &CStr| unsafe {
        luxfer_render_add_expression(render, name.as_ptr(), expression.as_ptr())
    };
    let mut count = 7;
    unsafe {
        assert_eq!(add(c"LDE", c"LDXE"), LUXFER_INVALID_ARGUMENT);
        assert!(message(context).contains("column 3"), "{}", message(context));
        assert_eq!(add(c"a.b", c"LDE"), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_render_add_expression(render, null(), c"LDE".as_ptr()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_render_add_expression(render, c"x".as_ptr(), null()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_render_set_aovs(render, 1024), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_render_set_emitter_as(render, 3), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_render_get_layer_count(render, &mut count), LUXFER_NOT_READY);
        assert_eq!(luxfer_render_write_exr(render, c"/tmp/never.exr".as_ptr()), LUXFER_NOT_READY);
        // A label that no object has ends the job with an error.
        assert_eq!(add(c"lost", c"C<RD'Nothing'>L"), LUXFER_OK);
        assert_eq!(finish(made(|out| luxfer_render_start(render, params, out))), LUXFER_NOT_FOUND);
        assert!(message(context).contains("'Lamp'"), "{}", message(context));
        assert_eq!(luxfer_render_clear_expressions(render), LUXFER_OK);
    }
}

/// Reads the names of the layers.
fn layer_names(render: *mut luxfer_render, count: u32) -> Vec<String> {
    unsafe {
        let mut names = Vec::new();
        for index in 0..count {
            let mut buffer = [0 as c_char; 32];
            assert_eq!(luxfer_render_get_layer_name(render, index, buffer.as_mut_ptr(), 32, null_mut()), LUXFER_OK);
            names.push(CStr::from_ptr(buffer.as_ptr()).to_str().unwrap().to_string());
        }
        names
    }
}

/// Compares the pixels of the layers with the image.
fn compare_layers(render: *mut luxfer_render) {
    unsafe {
        // The room is closed and its lamp is the only light, so the layer of the lamp's light equals the image.
        let beauty = pixels(made(|out| luxfer_render_get_image(render, LUXFER_RENDER_BEAUTY, out)));
        let by_lamp = pixels(made(|out| luxfer_render_get_layer(render, c"Lampe ü".as_ptr(), out)));
        assert!(beauty.1.iter().zip(&by_lamp.1).all(|(a, b)| (a - b).abs() <= 1e-5 * a));
        let direct = pixels(made(|out| luxfer_render_get_layer(render, c"LDE".as_ptr(), out)));
        assert!(direct.1.iter().zip(&beauty.1).all(|(d, b)| *d <= *b * 1.00001));
        let (channels, alpha) = pixels(made(|out| luxfer_render_get_layer(render, c"Alpha".as_ptr(), out)));
        assert!(channels == 1 && alpha.iter().all(|&a| a == 1.0));
        assert_eq!(pixels(made(|out| luxfer_render_get_layer(render, c"Normal".as_ptr(), out))).0, 3);
    }
}

/// Writes the layers and reads the file back.
fn write_layers(context: *mut luxfer_context, render: *mut luxfer_render) {
    unsafe {
        let beauty = pixels(made(|out| luxfer_render_get_image(render, LUXFER_RENDER_BEAUTY, out)));
        // Programs without layers find the image in the file's default channels.
        let path = CString::new(format!("{}/layers.exr", env!("CARGO_TARGET_TMPDIR"))).unwrap();
        assert_eq!(luxfer_render_write_exr(render, path.as_ptr()), LUXFER_OK, "{}", message(context));
        let read = pixels(made(|out| luxfer_image_load(context, path.as_ptr(), LUXFER_COLOUR_LINEAR, out)));
        assert_eq!(read.0, 4);
        assert!(read.1.chunks(4).zip(beauty.1.chunks(3)).all(|(r, b)| r[..3] == *b && r[3] == 1.0));
        let bytes = std::fs::read(path.to_str().unwrap()).unwrap();
        let holds = |text: &str| bytes.windows(text.len()).any(|w| w == text.as_bytes());
        for text in ["LDE.R", "Lampe ü.B", "Depth.Z", "Normal.X", "luxfer.lpe.LDE", "C.*<L.'Lamp'>"] {
            assert!(holds(text), "{text}");
        }
        assert!(!holds("Alpha.A"));
        let nowhere = c"/nonexistent/layers.exr".as_ptr();
        assert_eq!(luxfer_render_write_exr(render, nowhere), LUXFER_IO);
    }
}

#[test]
fn illuminance_comes_with_its_error() {
    let context = context(2);
    let scene = scene(context);
    let stage = made(|out| unsafe { luxfer_illuminance_create(context, out) });
    let mut grid = unsafe { std::mem::zeroed::<luxfer_illuminance_grid>() };
    let mut params = unsafe { std::mem::zeroed::<luxfer_illuminance_params>() };
    unsafe {
        assert_eq!(luxfer_init(LUXFER_STRUCT_ILLUMINANCE_GRID, (&raw mut grid).cast(), size_of_val(&grid)), LUXFER_OK);
        assert_eq!(
            luxfer_init(LUXFER_STRUCT_ILLUMINANCE_PARAMS, (&raw mut params).cast(), size_of_val(&params)),
            LUXFER_OK
        );
        params = luxfer_illuminance_params { columns: 4, rows: 3, samples: 256, ..params };
        let mut job = null_mut();
        assert_eq!(luxfer_illuminance_start_grid(stage, &grid, &params, &mut job), LUXFER_INVALID_OPERATION);
        assert!(message(context).contains("luxfer_illuminance_set_scene"));
        assert_eq!(luxfer_illuminance_set_scene(stage, scene), LUXFER_OK);
        // A work plane of 2 × 2 m at the height of the room's middle.
        let plane = luxfer_illuminance_grid {
            origin: [-1.0, 0.0, -1.0],
            across: [2.0, 0.0, 0.0],
            down: [0.0, 0.0, 2.0],
            ..grid
        };
        assert_eq!(finish(made(|out| luxfer_illuminance_start_grid(stage, &plane, &params, out))), LUXFER_OK);
        let lux = pixels(made(|out| luxfer_illuminance_get_image(stage, LUXFER_ILLUMINANCE_LUX, out)));
        let error = pixels(made(|out| luxfer_illuminance_get_image(stage, LUXFER_ILLUMINANCE_ERROR, out)));
        assert_eq!((lux.0, lux.1.len(), error.1.len()), (1, 12, 12));
        let mut report = std::mem::zeroed::<luxfer_illuminance_report>();
        assert_eq!(luxfer_illuminance_get_report(stage, &mut report, size_of_val(&report)), LUXFER_OK);
        let mean = lux.1.iter().map(|&v| f64::from(v)).sum::<f64>() / 12.0;
        assert!(report.points == 12 && (report.mean - mean).abs() < 1e-4 * mean && report.minimum > 0.0);
        assert!(report.mean_error > 0.0 && report.mean_error < 0.1 * mean);
        // Wrong grids are refused.
        let flat = luxfer_illuminance_grid { normal: [0.0; 3], ..plane };
        let refused = |job| assert_eq!(finish(job), LUXFER_INVALID_ARGUMENT);
        refused(made(|out| luxfer_illuminance_start_grid(stage, &flat, &params, out)));
        refused(made(|out| luxfer_illuminance_start_mesh(stage, 9, 0, &params, out)));
        refused(made(|out| luxfer_illuminance_start_mesh(stage, 0, 0, &params, out)));
        assert!(message(context).contains("texture coordinates"), "{}", message(context));
        assert_eq!(luxfer_illuminance_start_mesh(stage, 0, 2, &params, &mut job), LUXFER_INVALID_ARGUMENT);
        let mut image = null_mut();
        assert_eq!(luxfer_illuminance_get_image(stage, 2, &mut image), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_release(stage.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

fn rendered(render: *mut luxfer_render, params: &luxfer_render_params) -> (Vec<f32>, luxfer_render_report) {
    unsafe {
        assert_eq!(finish(made(|out| luxfer_render_start(render, params, out))), LUXFER_OK);
        let mut report = std::mem::zeroed::<luxfer_render_report>();
        assert_eq!(luxfer_render_get_report(render, &mut report, size_of_val(&report)), LUXFER_OK);
        (pixels(made(|out| luxfer_render_get_image(render, LUXFER_RENDER_BEAUTY, out))).1, report)
    }
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len() as f64
}

#[test]
fn previews_are_asked_for() {
    let context = context(2);
    let scene = scene(context);
    let render = made(|out| unsafe { luxfer_render_create(context, out) });
    let mut params = unsafe { std::mem::zeroed::<luxfer_render_params>() };
    unsafe {
        assert_eq!(luxfer_init(LUXFER_STRUCT_RENDER_PARAMS, (&raw mut params).cast(), size_of_val(&params)), LUXFER_OK);
        assert_eq!((params.preview, params.reserved), (0.0, 0));
        params = luxfer_render_params { width: 32, height: 24, samples: 16, ..params };
        assert_eq!(luxfer_render_set_scene(render, scene), LUXFER_OK);
        assert_eq!(luxfer_render_set_aovs(render, LUXFER_AOV_LUMINANCE), LUXFER_OK);
        let (beauty, report) = rendered(render, &params);
        let mut image = null_mut();
        assert_eq!((report.preview_bias, report.preview_error), (0.0, 0.0));
        assert_eq!(luxfer_render_get_image(render, LUXFER_RENDER_PREVIEW, &mut image), LUXFER_NOT_FOUND);
        assert_eq!(luxfer_render_get_image(render, LUXFER_RENDER_PREVIEW_INTERVAL, &mut image), LUXFER_NOT_FOUND);
        assert!(message(context).contains("luxfer_render_params.preview"));

        let (again, report) = rendered(render, &luxfer_render_params { preview: 1.0, ..params });
        assert_eq!(beauty, again, "the image does not change");
        assert!((0.0..0.2).contains(&report.preview_bias), "{}", report.preview_bias);
        assert!(report.preview_error > 0.0 && report.preview_error.is_finite(), "{}", report.preview_error);
        let interval = pixels(made(|out| luxfer_render_get_image(render, LUXFER_RENDER_PREVIEW_INTERVAL, out))).1;
        assert!(interval.len() == beauty.len() && interval.iter().all(|v| v.is_finite()));
        let preview = pixels(made(|out| luxfer_render_get_image(render, LUXFER_RENDER_PREVIEW, out))).1;
        assert!((mean(&preview) / mean(&beauty) - 1.0).abs() < 0.05 && preview != beauty);
        let mut count = 0;
        assert_eq!(luxfer_render_get_layer_count(render, &mut count), LUXFER_OK);
        assert_eq!(count, 1, "only what was asked for");

        // In a closed room with albedos up to 0.84, little light is left after a few tens of bounces.
        let mut needed = std::mem::zeroed::<luxfer_requirements>();
        assert_eq!(luxfer_scene_get_requirements(scene, 0.01, &mut needed, size_of_val(&needed)), LUXFER_OK);
        assert!((10..40).contains(&needed.bounces), "{}", needed.bounces);
        for wrong in [
            luxfer_render_params { reserved: 1, ..params },
            luxfer_render_params { preview: -1.0, ..params },
            luxfer_render_params { relative_error: f32::NAN, ..params },
        ] {
            let mut job = null_mut();
            let status = match luxfer_render_start(render, &wrong, &mut job) {
                LUXFER_OK => finish(job),
                status => status,
            };
            assert_eq!(status, LUXFER_INVALID_ARGUMENT);
        }
        assert_eq!(luxfer_release(render.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn an_environment_image_lights_a_scene_from_where_it_says() {
    let context = context(2);
    let scene = made(|out| unsafe { luxfer_scene_create(context, out) });
    let stage = made(|out| unsafe { luxfer_illuminance_create(context, out) });
    // An environment that is twice as bright above the horizon as below.
    let (width, height) = (16u32, 8u32);
    let mut sky: Vec<f32> =
        (0..width * height * 3).map(|i| if i < width * height * 3 / 2 { 2.0 } else { 1.0 }).collect();
    let sky = made(|out| unsafe { luxfer_image_create(context, &crate::host::view(width, height, &mut sky), out) });
    let below = crate::host::image(context, 4, 2, -1.0);
    let mut grid = unsafe { std::mem::zeroed::<luxfer_illuminance_grid>() };
    unsafe {
        assert_eq!(luxfer_scene_set_environment(scene, below, [1.0; 3].as_ptr()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_scene_set_environment(scene, sky, [1.0, -1.0, 1.0].as_ptr()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_scene_set_environment(scene, sky, [f32::MAX, 1.0, 1.0].as_ptr()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_scene_set_environment(scene, scene.cast(), [1.0; 3].as_ptr()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_scene_set_environment(scene, sky, [10.0; 3].as_ptr()), LUXFER_OK, "{}", message(context));
        let mut needed = std::mem::zeroed::<luxfer_requirements>();
        assert_eq!(luxfer_scene_get_requirements(scene, 0.0, &mut needed, size_of_val(&needed)), LUXFER_OK);
        assert_eq!(needed.lights, LUXFER_LIGHTS_ENVIRONMENT);
        assert_eq!(luxfer_init(LUXFER_STRUCT_ILLUMINANCE_GRID, (&raw mut grid).cast(), size_of_val(&grid)), LUXFER_OK);
        assert_eq!(luxfer_illuminance_set_scene(stage, scene), LUXFER_OK);
        for (up, luminance) in [(1.0f32, 20.0), (-1.0, 10.0)] {
            let grid = luxfer_illuminance_grid { normal: [0.0, up, 0.0], ..grid };
            assert_eq!(finish(made(|out| luxfer_illuminance_start_grid(stage, &grid, null(), out))), LUXFER_OK);
            let lux = pixels(made(|out| luxfer_illuminance_get_image(stage, LUXFER_ILLUMINANCE_LUX, out))).1;
            // Between the two rows at the horizon, radiance is interpolated; the small cosine there keeps the error
            // small.
            let expected = luminance * std::f64::consts::PI;
            assert!((mean(&lux) / expected - 1.0).abs() < 0.02, "{} lx, expected {expected}", mean(&lux));
        }
        assert_eq!(luxfer_release(stage.cast()), LUXFER_OK);
        for image in [sky, below] {
            assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        }
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}
