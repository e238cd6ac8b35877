//! Contract of stylisation at the C boundary: inputs in any order and of any size, pictures that are read while the
//! job runs, updates of the artwork, partly painted exemplars, and errors that name their cause.

use crate::host::{context, image, made, message, view, wait};
use luxfer::ffi::*;
use std::ffi::c_void;
use std::ptr::{null, null_mut};

/// Creates an image whose channel c of pixel (x, y) is `value(x, y, c)`.
fn drawn(
    context: *mut luxfer_context,
    (width, height, channels): (u32, u32, u32),
    value: impl Fn(u32, u32, u32) -> f32,
) -> *mut luxfer_image {
    let mut pixels: Vec<f32> = (0..width * height * channels)
        .map(|i| value(i / channels % width, i / channels / width, i % channels))
        .collect();
    let view = luxfer_image_view { channels, ..view(width, height, &mut pixels) };
    made(|out| unsafe { luxfer_image_create(context, &view, out) })
}

fn pixels(image: *mut luxfer_image) -> (u32, u32, Vec<f32>) {
    let (mut width, mut height, mut channels) = (0, 0, 0);
    unsafe {
        assert_eq!(luxfer_image_get_size(image, &mut width, &mut height, &mut channels), LUXFER_OK);
        let mut data = vec![0.0f32; (width * height * channels) as usize];
        let view = luxfer_image_view { channels, ..view(width, height, &mut data) };
        assert_eq!(luxfer_image_read(image, 0, &view), LUXFER_OK);
        (width, height, data)
    }
}

/// A guide that shows a lit disc with its centre at x = `cx`.
fn guide(context: *mut luxfer_context, width: u32, height: u32, cx: f32) -> *mut luxfer_image {
    drawn(context, (width, height, 3), |x, y, c| {
        let (dx, dy) = ((x as f32 - cx) / 14.0, (y as f32 - 20.0) / 14.0);
        let inside = (1.0 - dx * dx - dy * dy).max(0.0);
        if c == 2 { inside.ceil() } else { (0.7 * inside.sqrt() - 0.3 * dx + 0.2).max(0.0) }
    })
}

fn artwork(context: *mut luxfer_context, width: u32, height: u32) -> *mut luxfer_image {
    drawn(context, (width, height, 3), |x, y, c| ((x * 7 + y * 13 + c * 5) % 23) as f32 / 22.0)
}

fn params() -> luxfer_stylize_params {
    let mut params = unsafe { std::mem::zeroed::<luxfer_stylize_params>() };
    assert_eq!(
        unsafe { luxfer_init(LUXFER_STRUCT_STYLIZE_PARAMS, (&raw mut params).cast(), size_of_val(&params)) },
        LUXFER_OK
    );
    params
}

fn report(stylize: *mut luxfer_stylize) -> luxfer_stylize_report {
    let mut report = unsafe { std::mem::zeroed::<luxfer_stylize_report>() };
    assert_eq!(unsafe { luxfer_stylize_get_report(stylize, &mut report, size_of_val(&report)) }, LUXFER_OK);
    report
}

fn get(stylize: *mut luxfer_stylize, which: luxfer_stylize_image) -> *mut luxfer_image {
    made(|out| unsafe { luxfer_stylize_get_image(stylize, which, out) })
}

/// Starts a job, waits for it and releases it.
fn run(stylize: *mut luxfer_stylize, params: &luxfer_stylize_params) -> luxfer_status {
    let job = made(|out| unsafe { luxfer_stylize_start(stylize, params, out) });
    unsafe {
        let status = wait(job, -1, None, null_mut());
        assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
        status
    }
}

/// A stylisation whose inputs are set and released: in the target, the disc of the exemplar has moved to another
/// place.
fn ready(context: *mut luxfer_context, width: u32) -> *mut luxfer_stylize {
    let stylize = made(|out| unsafe { luxfer_stylize_create(context, out) });
    let images = [artwork(context, 60, 44), guide(context, 60, 44, 30.0), guide(context, width, 50, 40.0)];
    unsafe {
        assert_eq!(luxfer_stylize_set_artwork(stylize, images[0]), LUXFER_OK);
        let (name, light) = (c"light".as_ptr(), LUXFER_GUIDE_LIGHT);
        assert_eq!(luxfer_stylize_add_guide(stylize, name, images[1], images[2], 1.0, light), LUXFER_OK);
        for image in images {
            assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        }
    }
    stylize
}

#[test]
fn a_target_is_stylised_and_reported_level_by_level() {
    let context = context(2);
    let stylize = ready(context, 70);
    unsafe {
        assert_eq!(luxfer_stylize_get_image(stylize, 0, &mut null_mut()), LUXFER_NOT_READY);
        assert_eq!(run(stylize, &params()), LUXFER_OK, "{}", message(context));
        let all = report(stylize);
        assert!(all.is_complete == 1 && all.levels == 1 && all.halvings == 0 && all.patch == 5 && all.max_uses > 0);
        assert!(all.energy > 0.0 && all.used > 0.1 && all.entropy > 5.0 && all.guide_error < 0.3);
        assert!(all.unblended_share > 0.0 && all.unblended_share <= 1.0);

        // The whole pixels are copied from the artwork, and the image `sources` states from which place.
        let art = artwork(context, 60, 44);
        let (_, _, paint) = pixels(art);
        let images = [get(stylize, LUXFER_STYLIZE_IMAGE_PICTURE), get(stylize, LUXFER_STYLIZE_IMAGE_SOURCES)];
        let [(w, h, picture), (_, _, sources)] = images.map(pixels);
        assert_eq!((w, h), (70, 50));
        let colour = |p: &[f32]| [0, 1, 2].map(|c| (p[c] * 1e4).round() as u32);
        let palette: std::collections::HashSet<[u32; 3]> = paint.chunks_exact(3).map(colour).collect();
        let copied = |picture: &[f32]| {
            let count = picture.chunks_exact(3).filter(|p| palette.contains(&colour(p))).count();
            count as f64 / (picture.len() / 3) as f64
        };
        assert!(copied(&picture) >= all.unblended_share, "{} {}", copied(&picture), all.unblended_share);
        assert!(sources.chunks_exact(2).all(|s| s[0] > 0.0 && s[0] < 60.0 && s[1] > 0.0 && s[1] < 44.0));

        // The vote for most makes no blends.
        let most = luxfer_stylize_params { final_vote: LUXFER_STYLIZE_VOTE_MAJORITY, ..params() };
        assert_eq!(run(stylize, &most), LUXFER_OK);
        let unblended = get(stylize, LUXFER_STYLIZE_IMAGE_PICTURE);
        assert_eq!((report(stylize).unblended_share, copied(&pixels(unblended).2)), (1.0, 1.0));
        assert_eq!(luxfer_release(unblended.cast()), LUXFER_OK);

        // The preview preset makes a picture of half the size.
        let mut preview = params();
        assert_eq!(luxfer_stylize_get_preset(LUXFER_STYLIZE_PREVIEW, &mut preview, 104), LUXFER_OK);
        assert_eq!(luxfer_stylize_get_preset(4, &mut preview, 104), LUXFER_INVALID_ARGUMENT);
        assert_eq!(run(stylize, &preview), LUXFER_OK);
        let half = get(stylize, LUXFER_STYLIZE_IMAGE_PICTURE);
        assert_eq!(pixels(half).0, 35);
        assert_eq!(report(stylize).halvings, 1);
        for image in images.into_iter().chain([half, art]) {
            assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        }
        assert_eq!(luxfer_release(stylize.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

/// A progress callback that cancels the job as soon as a picture can be read.
unsafe extern "C" fn cancel_at_first_picture(user: *mut c_void, _: f64) -> i32 {
    let mut image = null_mut();
    let status = unsafe { luxfer_stylize_get_image(user.cast(), LUXFER_STYLIZE_IMAGE_PICTURE, &mut image) };
    unsafe { luxfer_release(image.cast()) };
    i32::from(status == LUXFER_OK)
}

#[test]
fn a_cancelled_run_keeps_the_picture_of_its_last_level() {
    let context = context(1);
    let stylize = ready(context, 2000);
    // Four levels, with a hundred rounds on the finest, so that the cancel comes before the end.
    let params = luxfer_stylize_params { patch: 3, finest_iterations: 100, iterations: 1, ..params() };
    unsafe {
        let job = made(|out| luxfer_stylize_start(stylize, &params, out));
        assert_eq!(luxfer_stylize_clear_guides(stylize), LUXFER_INVALID_OPERATION, "a job runs");
        assert_eq!(wait(job, -1, Some(cancel_at_first_picture), stylize.cast()), LUXFER_CANCELLED);
        assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
        let so_far = report(stylize);
        assert!(so_far.is_complete == 0 && so_far.levels >= 1 && so_far.halvings >= 1 && so_far.energy > 0.0);
        let picture = get(stylize, LUXFER_STYLIZE_IMAGE_PICTURE);
        assert_eq!(pixels(picture).0, 2000 >> so_far.halvings);
        assert_eq!(luxfer_release(picture.cast()), LUXFER_OK);
        let mut image = null_mut();
        assert_eq!(luxfer_stylize_get_image(stylize, LUXFER_STYLIZE_IMAGE_SOURCES, &mut image), LUXFER_NOT_READY);
        assert_eq!(luxfer_stylize_update(stylize, null_mut(), null_mut(), null_mut()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_release(stylize.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn new_paint_is_followed_where_it_is() {
    let context = context(2);
    let stylize = ready(context, 70);
    let art = artwork(context, 60, 44);
    let red = drawn(context, (60, 44, 3), |_, _, c| if c == 0 { 1.0 } else { 0.0 });
    // The paint changes at the pixels of the exemplar's disc.
    let changed = drawn(context, (60, 44, 1), |x, y, _| f32::from((x as f32 - 30.0).hypot(y as f32 - 20.0) < 14.0));
    let update = |artwork, changed| {
        let job = made(|out| unsafe { luxfer_stylize_update(stylize, artwork, changed, out) });
        unsafe {
            let status = wait(job, -1, None, null_mut());
            assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
            status
        }
    };
    unsafe {
        let mut job = null_mut();
        assert_eq!(run(stylize, &params()), LUXFER_OK);
        assert_eq!(luxfer_stylize_update(stylize, red, changed, &mut job), LUXFER_INVALID_OPERATION, "nothing is kept");
        assert!(message(context).contains("keep_for_update"), "{}", message(context));
        assert_eq!(run(stylize, &luxfer_stylize_params { keep_for_update: 1, ..params() }), LUXFER_OK);
        assert_eq!(update(changed, changed), LUXFER_INVALID_ARGUMENT, "one channel is not three");
        assert_eq!(update(red, changed), LUXFER_OK);
        let picture = get(stylize, LUXFER_STYLIZE_IMAGE_PICTURE);
        let (width, _, data) = pixels(picture);
        let at = |x: usize, y: usize| &data[3 * (y * width as usize + x)..][..3];
        assert_eq!(at(40, 20), [1.0, 0.0, 0.0], "the disc is red");
        assert_ne!(at(3, 45), [1.0, 0.0, 0.0], "the ground is not");
        for image in [art, red, changed, picture] {
            assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        }
        assert_eq!(luxfer_release(stylize.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn the_rest_of_a_half_painted_picture_is_painted() {
    let context = context(2);
    let (stylize, art) = (made(|out| unsafe { luxfer_stylize_create(context, out) }), artwork(context, 60, 44));
    // The left and the right half of the scene are equal; only the left half is painted.
    let scene = drawn(context, (60, 44, 3), |x, y, c| ((x % 30) as f32 / 30.0 + y as f32 / 44.0 + c as f32) / 4.0);
    let painted = drawn(context, (60, 44, 1), |x, _, _| f32::from(x < 30));
    unsafe {
        assert_eq!(luxfer_stylize_set_painted(stylize, painted), LUXFER_INVALID_OPERATION, "no artwork yet");
        assert_eq!(luxfer_stylize_set_artwork(stylize, art), LUXFER_OK);
        assert_eq!(luxfer_stylize_add_guide(stylize, c"scene".as_ptr(), scene, null_mut(), 1.0, 0), LUXFER_OK);
        assert_eq!(luxfer_stylize_set_painted(stylize, painted), LUXFER_OK);
        assert_eq!(run(stylize, &params()), LUXFER_OK, "{}", message(context));
        let images = [get(stylize, LUXFER_STYLIZE_IMAGE_PICTURE), get(stylize, LUXFER_STYLIZE_IMAGE_SOURCES)];
        let [(_, _, picture), (_, _, sources)] = images.map(pixels);
        let (_, _, paint) = pixels(art);
        for i in 0..60 * 44 {
            if i % 60 < 30 {
                assert_eq!(picture[3 * i..3 * i + 3], paint[3 * i..3 * i + 3], "what is painted stays");
            }
        }
        let right = || sources.chunks_exact(2).enumerate().filter(|(i, _)| i % 60 >= 32);
        assert!(right().all(|(_, s)| s[0] < 30.0), "paint comes from what is painted");
        for image in images.into_iter().chain([scene, painted, art]) {
            assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        }
        assert_eq!(luxfer_release(stylize.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn handles_and_settings_that_are_wrong_are_refused() {
    let (context, other) = (context(1), context(1));
    let stylize = ready(context, 70);
    let (garbage, foreign) = ([0xdead_beef_u64; 8], image(other, 60, 44, 0.5));
    let two = drawn(context, (60, 44, 2), |_, _, _| 0.5);
    let three = drawn(context, (60, 44, 3), |_, _, _| 0.5);
    let mut job = null_mut();
    unsafe {
        for bad in [null_mut(), garbage.as_ptr().cast_mut().cast(), context.cast(), three.cast()] {
            let bad: *mut luxfer_stylize = bad;
            assert_eq!(luxfer_stylize_set_artwork(bad, three), LUXFER_INVALID_ARGUMENT);
            assert_eq!(luxfer_stylize_start(bad, null(), &mut job), LUXFER_INVALID_ARGUMENT);
            assert_eq!(luxfer_stylize_set_artwork(stylize, bad.cast()) == LUXFER_OK, bad == three.cast());
        }
        assert_eq!(luxfer_release(null_mut()), LUXFER_OK);
        assert_eq!(luxfer_stylize_set_artwork(stylize, foreign), LUXFER_INVALID_ARGUMENT);
        refuse_guides(stylize, three, two, foreign);
        refuse_settings(context, stylize);
        let good = params();
        assert_eq!(luxfer_stylize_start(stylize, &good, null_mut()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_stylize_clear_guides(stylize), LUXFER_OK);
        assert_eq!(luxfer_stylize_start(stylize, &good, &mut job), LUXFER_INVALID_OPERATION, "no guides");
        assert!(message(context).contains("luxfer_stylize_add_guide"));
        for image in [two, three, foreign] {
            assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        }
        assert_eq!(luxfer_release(stylize.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(other.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

/// Checks that each wrong argument of a guide is refused. `two` and `three` are images with two and three channels,
/// and `foreign` belongs to another context.
fn refuse_guides(
    stylize: *mut luxfer_stylize,
    three: *mut luxfer_image,
    two: *mut luxfer_image,
    foreign: *mut luxfer_image,
) {
    unsafe {
        let add = |name, a, b, weight, range| luxfer_stylize_add_guide(stylize, name, a, b, weight, range);
        for (name, a, b, weight, range, why) in [
            (null(), three, three, 1.0, 0, "no name"),
            (c"g".as_ptr(), null_mut(), three, 1.0, 0, "no source"),
            (c"g".as_ptr(), three, two, 1.0, 0, "channels differ"),
            (c"g".as_ptr(), three, three, -1.0, 0, "negative weight"),
            (c"g".as_ptr(), three, three, f32::NAN, 0, "no weight"),
            (c"g".as_ptr(), three, three, 1.0, 2, "no such range"),
            (c"g".as_ptr(), three, foreign, 1.0, 0, "another context"),
        ] {
            assert_eq!(add(name, a, b, weight, range), LUXFER_INVALID_ARGUMENT, "{why}");
        }
    }
}

/// Checks that each setting that is out of range is refused with a message.
fn refuse_settings(context: *mut luxfer_context, stylize: *mut luxfer_stylize) {
    let (good, mut job) = (params(), null_mut());
    unsafe {
        for bad in [
            luxfer_stylize_params { search: 2, ..good },
            luxfer_stylize_params { search: -1, ..good },
            luxfer_stylize_params { patch: 4, ..good },
            luxfer_stylize_params { patch: 0, ..good },
            luxfer_stylize_params { patch: u32::MAX, ..good },
            luxfer_stylize_params { guide_weight: f32::NAN, ..good },
            luxfer_stylize_params { levels: 17, ..good },
            luxfer_stylize_params { iterations: 0, ..good },
            luxfer_stylize_params { coverage: 1.5, ..good },
            luxfer_stylize_params { vote: 5, ..good },
            luxfer_stylize_params { final_vote: 5, ..good },
            luxfer_stylize_params { preview: 2, ..good },
            luxfer_stylize_params { keep_for_update: 7, ..good },
            luxfer_stylize_params { reserved: 1, ..good },
            luxfer_stylize_params { struct_size: 71, ..good },
        ] {
            assert_eq!(luxfer_stylize_start(stylize, &bad, &mut job), LUXFER_INVALID_ARGUMENT);
            assert!(job.is_null() && !message(context).is_empty());
        }
    }
}

/// Stylises a target of size `size` after an exemplar of size `from`, with `channels` channels of guides in which
/// `broken`, if given, replaces every seventh value. Checks the properties that every result must have; returns the
/// job's status.
fn extreme(from: (u32, u32), size: (u32, u32), channels: u32, weight: f32, broken: Option<f32>) -> luxfer_status {
    let context = context(1);
    let stylize = made(|out| unsafe { luxfer_stylize_create(context, out) });
    let art = artwork(context, from.0, from.1);
    let value = |x: u32, y: u32, c: u32| match broken {
        Some(value) if (x + y).is_multiple_of(7) => value,
        _ => ((x * 3 + y * 5 + c) % 17) as f32 / 16.0,
    };
    unsafe {
        assert_eq!(luxfer_stylize_set_artwork(stylize, art), LUXFER_OK);
        for first in (0..channels).step_by(4) {
            let count = (channels - first).min(4);
            let (a, b) =
                (drawn(context, (from.0, from.1, count), value), drawn(context, (size.0, size.1, count), value));
            let name = std::ffi::CString::new(format!("{first}")).unwrap();
            assert_eq!(luxfer_stylize_add_guide(stylize, name.as_ptr(), a, b, weight, 0), LUXFER_OK);
            assert_eq!(luxfer_release(a.cast()), LUXFER_OK);
            assert_eq!(luxfer_release(b.cast()), LUXFER_OK);
        }
        let status = run(stylize, &params());
        if status == LUXFER_OK {
            let picture = get(stylize, LUXFER_STYLIZE_IMAGE_PICTURE);
            let (width, height, data) = pixels(picture);
            assert_eq!((width, height), size);
            assert!(data.iter().all(|v| (0.0..=1.0).contains(v)), "every pixel is one of the artwork's");
            assert_eq!(report(stylize).broken_source > 0, broken.is_some_and(|b| !b.is_finite()));
            assert_eq!(luxfer_release(picture.cast()), LUXFER_OK);
        } else {
            assert!(!message(context).is_empty());
        }
        assert_eq!(luxfer_release(art.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(stylize.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
        status
    }
}

#[test]
fn extremes_have_an_answer_or_a_message() {
    for (from, size, channels, weight, broken) in [
        ((1, 1), (1, 1), 1, 1.0, None),
        ((3, 2), (40, 30), 3, 1.0, None),
        ((40, 30), (1, 1), 3, 1.0, None),
        ((40, 30), (50, 2), 3, 1.0, None),
        ((40, 30), (50, 20), 40, 1.0, None),
        ((40, 30), (50, 20), 60, 1.0, None),
        ((40, 30), (50, 20), 3, 0.0, None),
        ((40, 30), (50, 20), 3, 1e6, None),
        ((40, 30), (50, 20), 3, 1.0, Some(f32::NAN)),
        ((40, 30), (50, 20), 3, 1.0, Some(f32::INFINITY)),
        ((40, 30), (50, 20), 3, 1.0, Some(1e6)),
        ((40, 30), (50, 20), 3, 1.0, Some(-1e6)),
    ] {
        assert_eq!(
            extreme(from, size, channels, weight, broken),
            LUXFER_OK,
            "{from:?} {size:?} {channels} {weight} {broken:?}"
        );
    }
}

#[test]
fn images_that_do_not_fit_each_other_end_the_job_with_a_message() {
    let context = context(1);
    let stylize = ready(context, 70);
    let small = drawn(context, (10, 10, 3), |_, _, _| 0.5);
    let (none, wide) = (drawn(context, (60, 44, 1), |_, _, _| 0.0), drawn(context, (60, 44, 3), |_, _, _| 1.0));
    let broken = drawn(context, (60, 44, 3), |_, _, _| f32::NAN);
    let art = artwork(context, 60, 44);
    unsafe {
        let set = |mask| assert_eq!(luxfer_stylize_set_source_mask(stylize, mask), LUXFER_OK);
        set(none);
        assert_eq!(run(stylize, &params()), LUXFER_DEGENERATE, "nothing may be copied");
        set(wide);
        assert_eq!(run(stylize, &params()), LUXFER_INVALID_ARGUMENT, "a mask has one channel");
        set(null_mut());
        assert_eq!(luxfer_stylize_set_target_mask(stylize, none, null_mut()), LUXFER_OK);
        assert_eq!(run(stylize, &params()), LUXFER_INVALID_ARGUMENT, "the mask is not of the target's size");
        assert_eq!(luxfer_stylize_set_target_mask(stylize, null_mut(), null_mut()), LUXFER_OK);
        assert_eq!(luxfer_stylize_set_artwork(stylize, small), LUXFER_OK);
        assert_eq!(run(stylize, &params()), LUXFER_INVALID_ARGUMENT, "the artwork is not of the guides' size");
        assert!(message(context).is_empty() || message(context).contains("artwork"), "{}", message(context));
        assert_eq!(luxfer_stylize_set_artwork(stylize, broken), LUXFER_OK);
        assert_eq!(run(stylize, &params()), LUXFER_DEGENERATE, "no exemplar pixel is a number");
        assert_eq!(luxfer_stylize_set_artwork(stylize, art), LUXFER_OK);
        let mut status = LUXFER_OK;
        for i in 0..16 {
            let name = std::ffi::CString::new(format!("{i}")).unwrap();
            let four = drawn(context, (60, 44, 4), |_, _, _| 0.5);
            status = luxfer_stylize_add_guide(stylize, name.as_ptr(), four, four, 1.0, LUXFER_GUIDE_DATA);
            assert_eq!(luxfer_release(four.cast()), LUXFER_OK);
        }
        assert_eq!(status, LUXFER_INVALID_ARGUMENT, "more than 60 channels");
        for image in [small, none, wide, broken, art] {
            assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        }
        assert_eq!(luxfer_release(stylize.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

/// Guides of a demonstration scene.
fn rendered(context: *mut luxfer_context, kind: luxfer_demo) -> *mut luxfer_guides {
    let guides = made(|out| unsafe { luxfer_guides_create(context, out) });
    let mut params = unsafe { std::mem::zeroed::<luxfer_guides_params>() };
    unsafe {
        let size = size_of_val(&params);
        assert_eq!(luxfer_init(LUXFER_STRUCT_GUIDES_PARAMS, (&raw mut params).cast(), size), LUXFER_OK);
        (params.width, params.height, params.samples) = (400, 304, 8);
        let scene = made(|out| luxfer_demo_create_scene(context, kind, out));
        assert_eq!(luxfer_guides_set_scene(guides, scene), LUXFER_OK);
        let job = made(|out| luxfer_guides_start(guides, &params, out));
        assert_eq!(wait(job, -1, None, null_mut()), LUXFER_OK, "{}", message(context));
        assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
    }
    guides
}

#[test]
fn the_artwork_switches_the_normals_on_and_the_caller_overrules_it() {
    let context = context(2);
    let (ball, still) = (rendered(context, LUXFER_DEMO_SPHERE_ON_TABLE), rendered(context, LUXFER_DEMO_STILL_LIFE));
    let params = luxfer_stylize_params { levels: 1, polish: 0, ..params() };
    let painted = |style, extras, weight| {
        let stylize = made(|out| unsafe { luxfer_stylize_create(context, out) });
        let artwork = made(|out| unsafe { luxfer_demo_create_artwork(ball, style, out) });
        unsafe {
            assert_eq!(luxfer_stylize_set_artwork(stylize, artwork), LUXFER_OK);
            assert_eq!(luxfer_stylize_add_guides(stylize, ball, still, extras, weight), LUXFER_OK);
            assert_eq!(run(stylize, &params), LUXFER_OK, "{}", message(context));
            let (used, picture) = (report(stylize).normals_weight, get(stylize, LUXFER_STYLIZE_IMAGE_PICTURE));
            let colours = pixels(picture).2;
            for object in [stylize.cast::<c_void>(), artwork.cast(), picture.cast()] {
                assert_eq!(luxfer_release(object), LUXFER_OK);
            }
            (used, colours)
        }
    };
    let (decided, by_normals) = painted(LUXFER_ARTWORK_PEN, 0, 1.0);
    assert!(decided > 0.0);
    // The caller's weight counts, and the weight that the library has chosen gives the same picture.
    let (given, same) = painted(LUXFER_ARTWORK_PEN, LUXFER_GUIDES_WITH_NORMALS, decided as f32);
    assert!(given == decided && same == by_normals);
    let (off, by_light) = painted(LUXFER_ARTWORK_PEN, LUXFER_GUIDES_WITH_NORMALS, 0.0);
    assert!(off == 0.0 && by_light != by_normals);
    // Dots have no direction.
    assert_eq!(painted(LUXFER_ARTWORK_STIPPLE, 0, 1.0).0, 0.0);
    unsafe {
        for guides in [ball, still] {
            assert_eq!(luxfer_release(guides.cast()), LUXFER_OK);
        }
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}
