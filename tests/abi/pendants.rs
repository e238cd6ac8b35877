//! Bodies of hanging lamps through the C functions: bad input, and rendered lamps whose bodies are known.

#[path = "../../benches/pendants/bodies.rs"]
#[allow(dead_code)]
mod bodies;
#[path = "../../benches/pendants/rendered.rs"]
mod rendered;

use crate::host::{context, image, made, message, scene, view};
use bodies::BODIES;
use luxfer::ffi::*;
use luxfer::image::Image;
use rendered::{Photo, Setup, photograph};
use std::ptr::{null, null_mut};

/// Width and height of a drawn photo.
const SIDE: u32 = 96;
const SIZE: usize = size_of::<luxfer_pendant>();

fn settings() -> luxfer_pendants_params {
    let mut params = unsafe { std::mem::zeroed::<luxfer_pendants_params>() };
    let size = size_of_val(&params);
    assert_eq!(unsafe { luxfer_init(LUXFER_STRUCT_PENDANTS_PARAMS, (&raw mut params).cast(), size) }, LUXFER_OK);
    luxfer_pendants_params { focal: 200.0, known: LUXFER_KNOWN_DIAMETER, known_length: 0.4, ..params }
}

/// An image of one channel, drawn by a function of the pixel.
fn drawn(context: *mut luxfer_context, value: impl Fn(f32, f32) -> f32) -> *mut luxfer_image {
    let at = |i: u32| value((i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5);
    let mut pixels: Vec<f32> = (0..SIDE * SIDE).map(at).collect();
    let view = luxfer_image_view { channels: 1, ..view(SIDE, SIDE, &mut pixels) };
    made(|out| unsafe { luxfer_image_create(context, &view, out) })
}

/// A disc, which is the level view of a globe.
fn globe(context: *mut luxfer_context, x: f32, y: f32) -> *mut luxfer_image {
    drawn(context, move |px, py| f32::from((px - x).hypot(py - y) < 24.0))
}

/// Finds up to `N` lamps in a photo that is its own mask; returns them and their number.
fn find<const N: usize>(
    context: *mut luxfer_context,
    mask: *mut luxfer_image,
    params: &luxfer_pendants_params,
) -> Result<([luxfer_pendant; N], usize), luxfer_status> {
    let mut lamps = [unsafe { std::mem::zeroed::<luxfer_pendant>() }; N];
    let (out, mut count, capacity) = (lamps.as_mut_ptr(), 99, N);
    let none = null_mut();
    let status =
        unsafe { luxfer_pendants_find(context, mask, mask, none, null(), 0, params, out, SIZE, capacity, &mut count) };
    if status == LUXFER_OK { Ok((lamps, count)) } else { Err(status) }
}

fn find_one(context: *mut luxfer_context, mask: *mut luxfer_image, params: &luxfer_pendants_params) -> luxfer_pendant {
    let ([lamp], count) = find::<1>(context, mask, params).unwrap_or_else(|_| panic!("{}", message(context)));
    assert_eq!((count, lamp.struct_size as usize), (1, SIZE));
    lamp
}

fn release<T>(handles: impl IntoIterator<Item = *mut T>) {
    handles.into_iter().for_each(|handle| assert_eq!(unsafe { luxfer_release(handle.cast()) }, LUXFER_OK));
}

#[test]
fn null_pointers_and_other_objects_are_refused() {
    let context = context(1);
    let (mask, params) = (globe(context, 48.0, 48.0), settings());
    let bad = LUXFER_INVALID_ARGUMENT;
    unsafe {
        let mut lamp = std::mem::zeroed::<luxfer_pendant>();
        let (none, out, mut n) = (null_mut(), &raw mut lamp, 99);
        let (c, m, p, no) = (context, mask, &raw const params, null());
        assert_eq!(luxfer_pendants_find(null_mut(), m, m, none, no, 0, p, out, SIZE, 1, &mut n), bad);
        assert_eq!(luxfer_pendants_find(c, null_mut(), m, none, no, 0, p, out, SIZE, 1, &mut n), bad);
        assert_eq!(luxfer_pendants_find(c, m, null_mut(), none, no, 0, p, out, SIZE, 1, &mut n), bad);
        assert_eq!(luxfer_pendants_find(c, m, m, m.cast(), no, 0, p, out, SIZE, 1, &mut n), bad);
        assert_eq!(luxfer_pendants_find(c, m, m, none, no, 1, p, out, SIZE, 1, &mut n), bad);
        assert_eq!(luxfer_pendants_find(c, m, m, none, [0.0].as_ptr(), 17, p, out, SIZE, 1, &mut n), bad);
        assert_eq!(luxfer_pendants_find(c, m, m, none, no, 0, p, null_mut(), SIZE, 1, &mut n), bad);
        assert_eq!(luxfer_pendants_find(c, m, m, none, no, 0, p, out, SIZE - 4, 1, &mut n), bad);
        assert_eq!(luxfer_pendants_find(c, m, m, none, no, 0, p, out, SIZE, 1, null_mut()), bad);
        // The defaults have no focal length.
        assert_eq!(luxfer_pendants_find(c, m, m, none, no, 0, null(), out, SIZE, 1, &mut n), bad);
        assert!(message(context).contains("focal is 0"), "{}", message(context));
        let rectify = made(|out| luxfer_rectify_create(context, out));
        assert_eq!(luxfer_pendants_find(c, m, m, rectify, no, 0, p, out, SIZE, 1, &mut n), LUXFER_NOT_READY);
        assert_eq!((lamp.struct_size, n), (0, 99), "nothing is written on failure");
        // The structs of a newer caller are longer; the rest of each becomes 0.
        let longer = SIZE + 8;
        let mut bytes = vec![0xffu8; 3 * longer];
        let place = bytes.as_mut_ptr().cast();
        assert_eq!(luxfer_pendants_find(c, m, m, none, no, 0, p, place, longer, 3, &mut n), LUXFER_OK);
        assert_eq!((n, &bytes[SIZE..longer]), (1, &[0; 8][..]));
        assert!(bytes[longer..].iter().all(|byte| *byte == 0xff), "only the lamp that exists is written");
        release([rectify]);
    }
    release([mask]);
    release([context]);
}

/// Two lamps in one mask, in reading order; a short array receives the first ones.
#[test]
fn lamps_are_numbered_from_the_top() {
    let context = context(1);
    let disc = |px: f32, py: f32, x: f32, y: f32| (px - x).hypot(py - y) < 14.0;
    let mask = drawn(context, |x, y| f32::from(disc(x, y, 70.0, 24.0) || disc(x, y, 24.0, 70.0)));
    let (both, count) = find::<3>(context, mask, &settings()).unwrap();
    assert_eq!((count, both[2].struct_size), (2, 0));
    let mean = |lamp: &luxfer_pendant| lamp.contour.iter().map(|p| p[1]).sum::<f32>() / 180.0;
    assert!((mean(&both[0]) - 24.0).abs() < 1.0 && (mean(&both[1]) - 70.0).abs() < 1.0);
    let ([first], count) = find::<1>(context, mask, &settings()).unwrap();
    assert_eq!((count, first.contour), (2, both[0].contour));
    release([mask]);
    release([context]);
}

#[test]
fn settings_out_of_range_are_refused() {
    let context = context(1);
    let (mask, good) = (globe(context, 48.0, 48.0), settings());
    let oblique = [[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let cases = [
        (luxfer_pendants_params { struct_size: 140, ..good }, "struct_size is 140"),
        (luxfer_pendants_params { alike: 2, ..good }, "alike is 2"),
        (luxfer_pendants_params { alike: 0, level: 1, ..good }, "level is 1"),
        (luxfer_pendants_params { refine: 7, ..good }, "refine is 7"),
        (luxfer_pendants_params { reserved: 1, ..good }, "reserved is 1"),
        (luxfer_pendants_params { known: 4, ..good }, "known is 4"),
        (luxfer_pendants_params { known: LUXFER_KNOWN_NOTHING, ..good }, "known_length is 0.4"),
        (luxfer_pendants_params { known_length: f64::NAN, ..good }, "known length is NaN"),
        (luxfer_pendants_params { known: LUXFER_KNOWN_DROP, known_length: 1.0, ..good }, "drop is 1"),
        (luxfer_pendants_params { known: LUXFER_KNOWN_SPACING, known_length: -1.0, ..good }, "known length is -1"),
        (luxfer_pendants_params { ceiling: f64::NAN, ..good }, "distance is NaN"),
        (luxfer_pendants_params { suspension_error: 0.0, ..good }, "suspension_error is 0"),
        (luxfer_pendants_params { focal: f64::NAN, ..good }, "focal is NaN"),
        (luxfer_pendants_params { focal: f64::INFINITY, ..good }, "focal length inf"),
        (luxfer_pendants_params { principal: [f64::NAN, 3.0], ..good }, "principal point [NaN, 3]"),
        (luxfer_pendants_params { axes: oblique, ..good }, "orthogonal unit axes"),
    ];
    for (params, words) in &cases {
        assert_eq!(find::<1>(context, mask, params).err(), Some(LUXFER_INVALID_ARGUMENT), "{words}");
        assert!(message(context).contains(words), "{words}: {}", message(context));
    }
    unsafe {
        let mut lamp = std::mem::zeroed::<luxfer_pendant>();
        let (none, out, mut n, hook) = (null_mut(), &raw mut lamp, 0, [f64::NAN, 0.0]);
        let status = luxfer_pendants_find(context, mask, mask, none, hook.as_ptr(), 1, &good, out, SIZE, 1, &mut n);
        assert_eq!(status, LUXFER_INVALID_ARGUMENT);
        let small = image(context, 40, 40, 1.0);
        let status = luxfer_pendants_find(context, small, mask, none, null(), 0, &good, out, SIZE, 1, &mut n);
        assert_eq!(status, LUXFER_INVALID_ARGUMENT);
        release([small]);
    }
    release([mask]);
    release([context]);
}

/// What cannot be a lamp is an error that says what to paint; a lamp that the border cuts a little is in doubt.
#[test]
fn masks_without_a_whole_lamp_say_what_to_paint() {
    let context = context(1);
    let masks = [
        (drawn(context, |_, _| 0.0), "empty"),
        (drawn(context, |_, _| f32::NAN), "empty"),
        (drawn(context, |_, _| 1.0), "border"),
        (globe(context, 48.0, 0.0), "border"),
        (drawn(context, |x, y| f32::from(x < 5.0 && y < 5.0)), "5 x 5"),
    ];
    for (mask, word) in masks {
        assert_eq!(find::<1>(context, mask, &settings()).err(), Some(LUXFER_DEGENERATE), "{word}");
        assert!(message(context).contains(word) && message(context).contains("paint"), "{}", message(context));
        release([mask]);
    }
    let mask = globe(context, 48.0, 19.0);
    let found = find_one(context, mask, &settings());
    assert!(found.doubts & LUXFER_DOUBT_CUT != 0 && found.cut > 0.05 && found.cut < 0.3, "{}", found.cut);
    assert!((found.diameter[0] - 0.4).abs() < 0.01, "{:?}", found.diameter);
    release([mask]);
    release([context]);
}

/// Adds lamps to a scene. Returns the status, the first mesh and the material.
fn add_lamps(
    scene: *mut luxfer_scene,
    lamp: &luxfer_pendant,
    places: &[f64],
    count: usize,
    diameter: f32,
    luminance: f32,
) -> (luxfer_status, u32, u32) {
    let (mut mesh, mut material) = (99, 99);
    let places = if places.is_empty() { null() } else { places.as_ptr() };
    let out = (&raw mut mesh, &raw mut material);
    let status = unsafe { luxfer_scene_add_pendants(scene, lamp, places, count, diameter, luminance, out.0, out.1) };
    (status, mesh, material)
}

/// Lamps of unknown size, wrong lamps and wrong places are refused, and nothing is written.
fn refuse_wrong_lamps(
    context: *mut luxfer_context,
    scene: *mut luxfer_scene,
    open: &luxfer_pendant,
    sized: &luxfer_pendant,
    places: &[f64],
) {
    let add = |lamp: &luxfer_pendant, places: &[f64], count, diameter, luminance| {
        add_lamps(scene, lamp, places, count, diameter, luminance)
    };
    let bad = LUXFER_INVALID_ARGUMENT;
    let nowhere = [0.0, f64::NAN, 0.0];
    let [mut short, mut falling, mut dark, mut thin] = [*sized; 4];
    (short.struct_size, falling.profile[3][1], dark.radiance[5][1]) = (8, -0.1, f32::NAN);
    thin.profile_count = 66;
    let refused = [
        (add(open, places, 2, 0.0, 100.0), bad),
        (add(sized, &[], 2, 0.0, 100.0), bad),
        (add(sized, places, 0, 0.0, 100.0), bad),
        (add(sized, &nowhere, 1, 0.0, 100.0), bad),
        (add(sized, places, 2, f32::NAN, 100.0), bad),
        (add(sized, places, 2, 0.0, -1.0), bad),
        (add(&short, places, 2, 0.0, 100.0), bad),
        (add(&falling, places, 2, 0.0, 100.0), bad),
        (add(&dark, places, 2, 0.0, 100.0), bad),
        (add(&thin, places, 2, 0.0, 100.0), bad),
        (add(&unsafe { std::mem::zeroed() }, places, 2, 0.4, 100.0), bad),
    ];
    for (i, ((status, mesh, _), expected)) in refused.into_iter().enumerate() {
        assert_eq!((status, mesh), (expected, 99), "{i}: {}", message(context));
    }
}

/// The bodies stand in the scene with their upper ends at the places, and the same input gives the same bits.
#[test]
fn lamps_are_added_to_a_scene() {
    let context = context(2);
    let (mask, scene) = (globe(context, 48.0, 48.0), scene(context));
    let params = luxfer_pendants_params { known: LUXFER_KNOWN_NOTHING, known_length: 0.0, ..settings() };
    let [open, sized] = [params, settings()].map(|params| find_one(context, mask, &params));
    let places = [0.0, 1.0, 0.5, 1.0, 1.5, 0.5];
    let counts = || {
        let mut counts = unsafe { std::mem::zeroed::<luxfer_scene_counts>() };
        let size = size_of_val(&counts);
        assert_eq!(unsafe { luxfer_scene_get_counts(scene, &mut counts, size) }, LUXFER_OK);
        (counts.meshes, counts.materials)
    };
    let before = counts();
    assert!(open.doubts & LUXFER_DOUBT_SIZE != 0 && open.diameter[0].is_nan() && open.diameter[1] == 0.0);
    refuse_wrong_lamps(context, scene, &open, &sized, &places);
    assert_eq!(counts(), before);
    let (status, mesh, material) = add_lamps(scene, &sized, &places, 2, 0.0, 100.0);
    assert_eq!((status, mesh, material), (LUXFER_OK, before.0, before.1), "{}", message(context));
    assert_eq!(counts(), (before.0 + 2, before.1 + 1));
    let mut info = unsafe { std::mem::zeroed::<luxfer_mesh_info>() };
    let size = size_of_val(&info);
    unsafe {
        assert_eq!(luxfer_scene_get_mesh(scene, mesh + 1, &mut info, size), LUXFER_OK);
        let capacity = info.vertex_count as usize;
        let mut positions = vec![0f32; 3 * capacity];
        let first = positions.as_mut_ptr();
        let status = luxfer_scene_read_vertices(scene, mesh + 1, LUXFER_VERTEX_POSITION, first, capacity);
        assert_eq!(status, LUXFER_OK, "{}", message(context));
        let top = positions.iter().skip(1).step_by(3).fold(f32::MIN, |top, y| top.max(*y));
        assert!((top - 1.5).abs() < 1e-4, "{top}");
    }
    let again = find_one(context, mask, &settings());
    assert_eq!((again.diameter, again.contour), (sized.diameter, sized.contour));
    release([mask]);
    release([scene]);
    release([context]);
}

/// Copies an image to the library.
fn given(context: *mut luxfer_context, image: &Image) -> *mut luxfer_image {
    let mut pixels = image.data.clone();
    let view = view(image.width as u32, image.height as u32, &mut pixels);
    let view = luxfer_image_view { channels: image.channels as u32, ..view };
    made(|out| unsafe { luxfer_image_create(context, &view, out) })
}

fn found_in(context: *mut luxfer_context, shot: &Photo) -> luxfer_pendant {
    let [photo, mask] = [&shot.photo, &shot.mask].map(|image| given(context, image));
    let params = luxfer_pendants_params {
        known: LUXFER_KNOWN_NOTHING,
        known_length: 0.0,
        ceiling: shot.ceiling,
        focal: shot.camera.focal,
        axes: shot.camera.axes.to_cols_array_2d(),
        ..settings()
    };
    let hook = shot.hook.to_array();
    let mut lamp = unsafe { std::mem::zeroed::<luxfer_pendant>() };
    let (none, out, mut count) = (null_mut(), &raw mut lamp, 0);
    let status = unsafe {
        luxfer_pendants_find(context, photo, mask, none, hook.as_ptr(), 1, &params, out, SIZE, 1, &mut count)
    };
    assert_eq!((status, count), (LUXFER_OK, 1), "{}", message(context));
    release([photo, mask]);
    lamp
}

/// Of a rendered photo and the mask of the lamp's pixels, the body, its size and its drop come out. A photo that is
/// blurred and clips the lamp does not enlarge it, and says that it is clipped.
#[test]
fn rendered_lamps_have_their_bodies() {
    let context = context(2);
    let exact = Setup { distance: 2.0, drop: 0.8, luminance: 60.0, white: 100.0, blur: 0.0 };
    let clipped = Setup { luminance: 1000.0, blur: 1.0, ..exact };
    for name in ["globe", "drum", "cone"] {
        let body = BODIES.iter().find(|b| b.name == name).unwrap();
        let diameter = 2.0 * body.profile().iter().map(|v| v.x).fold(0.0, f64::max);
        for setup in [exact, clipped] {
            let found = found_in(context, &photograph(body, &setup));
            let is_clipped = setup.luminance > setup.white;
            assert_eq!(found.doubts & LUXFER_DOUBT_CLIPPED != 0, is_clipped, "{name}: {}", found.clipped);
            for (what, [value, low, high], truth, share) in [
                ("diameter", found.diameter, diameter, 0.01),
                ("height", found.height, body.height, 0.05),
                ("drop", found.drop, 0.8, 0.01),
            ] {
                assert!((value / truth - 1.0).abs() < share, "{name}, {what}: {value} instead of {truth}");
                assert!(low < truth && truth < high, "{name}, {what}: {low} to {high} instead of {truth}");
            }
            if found.doubts & LUXFER_DOUBT_KIND == 0 {
                let kinds = [("globe", LUXFER_BODY_GLOBE), ("drum", LUXFER_BODY_DRUM), ("cone", LUXFER_BODY_CONE)];
                assert!(kinds.contains(&(name, found.kind)), "{name}: {}", found.kind);
            }
        }
    }
    release([context]);
}
