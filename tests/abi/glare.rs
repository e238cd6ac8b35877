//! Glare of a room that a luminaire and an emissive lamp light: its picture shows the luminaire, or says that it lacks
//! it, and the scene rates both. The lamp of the room is measured as a distribution.

use crate::host::{context, made, message, scene, wait};
use luxfer::ffi::*;
use std::ffi::CStr;
use std::ptr::null_mut;

/// A panel of 0.6 m with cosine intensity: `1000 / 0.36` cd/m².
const PANEL: &[u8] = b"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 7 1 1 2 0.6 0.6 0\n1 1 30\n0 15 30 45 60 75 90\n0\n\
    1000 965.9258 866.0254 707.1068 500 258.819 0\n";

/// A closed room with a luminaire below its ceiling, which shines from its faces or from a point.
fn lit(context: *mut luxfer_context, shape: luxfer_luminaire_shape) -> *mut luxfer_scene {
    let scene = scene(context);
    unsafe {
        let panel = made(|out| {
            let (data, format) = (PANEL.as_ptr().cast(), LUXFER_DISTRIBUTION_IES);
            luxfer_distribution_load_memory(context, data, PANEL.len(), format, out)
        });
        let mut params = std::mem::zeroed::<luxfer_luminaire_params>();
        assert_eq!(
            luxfer_init(LUXFER_STRUCT_LUMINAIRE_PARAMS, (&raw mut params).cast(), size_of_val(&params)),
            LUXFER_OK
        );
        assert_eq!(params.shape, LUXFER_LUMINAIRE_FACES);
        params = luxfer_luminaire_params { position: [0.0, 1.5, -0.5], shape: 7, ..params };
        assert_eq!(luxfer_scene_add_luminaire(scene, panel, &params, null_mut()), LUXFER_INVALID_ARGUMENT);
        assert!(message(context).contains("luminaire.shape is 7"), "{}", message(context));
        params.shape = shape;
        assert_eq!(luxfer_scene_add_luminaire(scene, panel, &params, null_mut()), LUXFER_OK);
        assert_eq!(luxfer_release(panel.cast()), LUXFER_OK);
    }
    scene
}

fn rate(scene: *mut luxfer_scene, observers: &[luxfer_observer]) -> (luxfer_status, Vec<luxfer_observer_glare>) {
    let mut ratings = vec![unsafe { std::mem::zeroed::<luxfer_observer_glare>() }; observers.len()];
    let (count, out) = (observers.len(), ratings.as_mut_ptr());
    (unsafe { luxfer_scene_get_glare(scene, observers.as_ptr(), count, 0, 256, 1, out, 0) }, ratings)
}

/// Renders a small picture of a scene. Returns the render and its finished job.
fn rendered(context: *mut luxfer_context, scene: *mut luxfer_scene) -> (*mut luxfer_render, *mut luxfer_job) {
    unsafe {
        let render = made(|out| luxfer_render_create(context, out));
        assert_eq!(luxfer_render_set_scene(render, scene), LUXFER_OK);
        assert_eq!(luxfer_render_set_aovs(render, LUXFER_AOV_LUMINANCE), LUXFER_OK);
        let mut params = std::mem::zeroed::<luxfer_render_params>();
        assert_eq!(luxfer_init(LUXFER_STRUCT_RENDER_PARAMS, (&raw mut params).cast(), size_of_val(&params)), LUXFER_OK);
        params = luxfer_render_params { width: 16, height: 12, samples: 4, ..params };
        let job = made(|out| luxfer_render_start(render, &params, out));
        assert_eq!(wait(job, -1, None, null_mut()), LUXFER_OK, "{}", message(context));
        (render, job)
    }
}

/// The settings choose the projection and the vertical illuminance; their defaults are checked against `narrow`, a
/// report for an angle of view of 1 radian.
unsafe fn rates_by_settings(context: *mut luxfer_context, image: *mut luxfer_image, narrow: &luxfer_glare_report) {
    unsafe {
        let mut params = std::mem::zeroed::<luxfer_glare_params>();
        let size = size_of_val(&params);
        assert_eq!(luxfer_init(LUXFER_STRUCT_GLARE_PARAMS, (&raw mut params).cast(), size), LUXFER_OK);
        params.fov_y = 1.0;
        let mut report = std::mem::zeroed::<luxfer_glare_report>();
        let size = size_of_val(&report);
        assert_eq!(luxfer_image_rate_glare(image, &params, &mut report, size), LUXFER_OK, "{}", message(context));
        assert_eq!((report.ugr, report.dgp), (narrow.ugr, narrow.dgp));
        params.vertical_illuminance = 5000.0;
        params.projection = LUXFER_PROJECTION_ANGULAR;
        assert_eq!(luxfer_image_rate_glare(image, &params, &mut report, size), LUXFER_OK, "{}", message(context));
        assert_eq!(report.vertical_illuminance, 5000.0);
        assert!(report.dgp > 0.45 && report.dgp_low_light == report.dgp, "{}", report.dgp);
        params.projection = 2;
        assert_eq!(luxfer_image_rate_glare(image, &params, &mut report, size), LUXFER_INVALID_ARGUMENT);
        assert!(message(context).contains("projection is 2"), "{}", message(context));
        // The caller of an older version has a shorter report.
        params.projection = LUXFER_PROJECTION_PERSPECTIVE;
        report.dgp = -1.0;
        assert_eq!(luxfer_image_rate_glare(image, &params, &mut report, 40), LUXFER_OK, "{}", message(context));
        assert_eq!(report.dgp, -1.0);
    }
}

/// With its faces the luminaire is in the picture, and there is nothing to warn of.
#[test]
fn a_picture_shows_the_faces_of_the_luminaire() {
    let context = context(2);
    let scene = lit(context, LUXFER_LUMINAIRE_FACES);
    unsafe {
        let warnings = made(|out| luxfer_get_warnings(scene.cast(), out));
        let mut count = 7;
        assert_eq!(luxfer_warnings_get_count(warnings, &mut count), LUXFER_OK);
        assert_eq!(count, 0);
        let (render, job) = rendered(context, scene);
        let beauty = made(|out| luxfer_render_get_image(render, LUXFER_RENDER_BEAUTY, out));
        let mut report = std::mem::zeroed::<luxfer_glare_report>();
        let size = size_of_val(&report);
        assert_eq!(luxfer_image_get_glare(beauty, 1.0, 0.0, &mut report, size), LUXFER_OK, "{}", message(context));
        assert_eq!(report.unseen_lights, 0);
        rates_by_settings(context, beauty, &report);
        for handle in [beauty.cast(), job.cast(), render.cast(), warnings.cast(), scene.cast(), context.cast()] {
            assert_eq!(luxfer_release(handle), LUXFER_OK);
        }
    }
}

#[test]
fn a_picture_says_that_it_lacks_the_luminaire() {
    let context = context(2);
    let scene = lit(context, LUXFER_LUMINAIRE_POINT);
    unsafe {
        let warnings = made(|out| luxfer_get_warnings(scene.cast(), out));
        let (mut count, mut warning) = (0, std::mem::zeroed::<luxfer_warning>());
        assert_eq!(luxfer_warnings_get_count(warnings, &mut count), LUXFER_OK);
        assert_eq!(luxfer_warnings_get(warnings, count - 1, &mut warning, size_of_val(&warning)), LUXFER_OK);
        assert_eq!((warning.code, warning.severity), (LUXFER_WARNING_NOT_IN_PICTURE, 1.0));
        let text = CStr::from_ptr(warning.message).to_str().unwrap();
        assert!(text.contains("light 0, a luminaire at [0, 1.5, -0.5]"), "{text}");

        let (render, job) = rendered(context, scene);
        let beauty = made(|out| luxfer_render_get_image(render, LUXFER_RENDER_BEAUTY, out));
        let layer = made(|out| luxfer_render_get_layer(render, c"Luminance".as_ptr(), out));
        for (image, unseen) in [(beauty, 1), (layer, 1), (crate::host::image(context, 4, 4, 1.0), 0)] {
            let mut report = std::mem::zeroed::<luxfer_glare_report>();
            let size = size_of_val(&report);
            assert_eq!(luxfer_image_get_glare(image, 1.0, 0.0, &mut report, size), LUXFER_OK, "{}", message(context));
            assert_eq!(report.unseen_lights, unseen);
            assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        }
        for handle in [job.cast(), render.cast(), warnings.cast(), scene.cast(), context.cast()] {
            assert_eq!(luxfer_release(handle), LUXFER_OK);
        }
    }
}

#[test]
fn the_scene_rates_its_luminaires() {
    let context = context(2);
    let scene = lit(context, LUXFER_LUMINAIRE_FACES);
    let eye = luxfer_observer { position: [0.0, 1.0, 0.8], direction: [0.0, 0.0, -1.0] };
    let away = luxfer_observer { direction: [0.0, 0.0, 1.0], ..eye };
    let (status, ratings) = rate(scene, &[eye, away]);
    assert_eq!(status, LUXFER_OK, "{}", message(context));
    assert_eq!((ratings[0].sources, ratings[1].sources, ratings[1].ugr), (2, 0, f64::NEG_INFINITY));
    // The opening is seen at cos γ = 0.5 / r from r² = 0.5² + 1.3². The emissive lamp of the room is a source, too: its
    // edges lie 0.9 m above the eye, 0.3 to 1.3 m ahead of it and 0.5 m to each side.
    let squared = 0.25 + 1.69f64;
    let corner = |ahead: f64| (0.5 * ahead / (0.9 * (0.25 + ahead * ahead + 0.81).sqrt())).atan();
    let expected = 0.36 * 0.5 / squared.powf(1.5) + 2.0 * (corner(1.3) - corner(0.3));
    assert!((ratings[0].solid_angle / expected - 1.0).abs() < 2e-3, "{} {expected}", ratings[0].solid_angle);
    assert!(ratings[0].ugr > 10.0 && ratings[0].ugr < 50.0 && ratings[0].background > 0.0, "{}", ratings[0].ugr);
    assert_eq!(ratings[0].unrated_lux, 0.0);
    // A bad observer is named, and nothing is written.
    let (status, ratings) = rate(scene, &[eye, luxfer_observer { position: [0.1, 1.5, -0.5], ..eye }]);
    assert!(status == LUXFER_INVALID_ARGUMENT && message(context).contains("observer 1"), "{}", message(context));
    assert_eq!(ratings[0].ugr, 0.0);
    assert_eq!(rate(scene, &[]).0, LUXFER_OK);
    unsafe {
        let status = luxfer_scene_get_glare(scene, &eye, 1, 0, 256, 1, null_mut(), 0);
        assert_eq!(status, LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

/// The emissive lamp of the room, a square metre of 100 cd/m² on both sides, as a distribution.
#[test]
fn the_lamp_of_the_room_has_a_distribution() {
    let context = context(2);
    let scene = scene(context);
    unsafe {
        let mut params = std::mem::zeroed::<luxfer_gonio_params>();
        let size = size_of_val(&params);
        assert_eq!(luxfer_init(LUXFER_STRUCT_GONIO_PARAMS, (&raw mut params).cast(), size), LUXFER_OK);
        params = luxfer_gonio_params { planes: 4, angles: 73, samples: 64, ..params };
        let (mut lamp, mut report) = (null_mut(), std::mem::zeroed::<luxfer_gonio_report>());
        let size = size_of_val(&report);
        let status = luxfer_scene_get_distribution(scene, &1, 1, &params, &mut lamp, &mut report, size);
        assert_eq!(status, LUXFER_OK, "{}", message(context));
        // I = L A cos γ is exact, and interpolation between the angles changes the flux by less than 0.1 %.
        assert!((report.flux / (200.0 * std::f64::consts::PI) - 1.0).abs() < 1e-3, "{}", report.flux);
        assert!(report.flux_error < 1e-3 && report.intensity_error < 1e-3 && report.position == [0.0, 1.9, 0.0]);
        let mut candela = 0.0;
        assert_eq!(luxfer_distribution_get_intensity(lamp, 12.0, 60.0, &mut candela), LUXFER_OK);
        assert!((candela - 50.0).abs() < 1e-2, "{candela}");
        // The whole scene is a closed room, which lets out no light; the walls alone emit none.
        let refused = |meshes: *const u32, count, params: &luxfer_gonio_params| {
            let mut none = null_mut();
            let status = luxfer_scene_get_distribution(scene, meshes, count, params, &mut none, null_mut(), 0);
            (status, none.is_null(), message(context))
        };
        let (status, is_null, text) = refused(std::ptr::null(), 0, &params);
        assert!(status == LUXFER_DEGENERATE && is_null && text.contains("without its room"), "{text}");
        assert_eq!(refused(&0, 1, &params).0, LUXFER_DEGENERATE);
        assert_eq!(refused(std::ptr::null(), 1, &params).0, LUXFER_INVALID_ARGUMENT);
        let (status, _, text) = refused(&2, 1, &params);
        assert!(status == LUXFER_INVALID_ARGUMENT && text.contains("mesh is 2"), "{text}");
        let along = luxfer_gonio_params { c0: [0.0, 2.0, 0.0], ..params };
        let (status, _, text) = refused(&1, 1, &along);
        assert!(status == LUXFER_INVALID_ARGUMENT && text.contains("c0 is"), "{text}");
        for handle in [lamp.cast(), scene.cast(), context.cast()] {
            assert_eq!(luxfer_release(handle), LUXFER_OK);
        }
    }
}
