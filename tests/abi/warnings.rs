//! Contract of warnings at the C boundary: a list of warnings never changes, its texts live as long as the list, and
//! wrong arguments are errors.

use crate::host::{context, made, message, view, wait};
use luxfer::ffi::*;
use std::ffi::{CStr, c_char, c_void};
use std::ptr::null_mut;

/// A segmentation that must warn, because its features are noise that does not separate the strokes.
fn doubtful(context: *mut luxfer_context) -> *mut luxfer_segment {
    let (width, height) = (64u32, 48u32);
    let mut pixels: Vec<f32> = (0..width * height * 3).map(|i| ((i * 7919) % 101) as f32).collect();
    let features = view(width, height, &mut pixels);
    let features = made(|out| unsafe { luxfer_image_create(context, &features, out) });
    let segment = made(|out| unsafe { luxfer_segment_create(context, out) });
    unsafe {
        assert_eq!(luxfer_segment_set_features(segment, features), LUXFER_OK);
        let strokes = made(|out| luxfer_strokes_create(context, width, height, out));
        for (y, positive) in [(8.0f32, 1), (16.0, 0), (32.0, 1), (40.0, 0)] {
            let points = [4.0f32, y, 60.0, y];
            let status = luxfer_strokes_add(strokes, LUXFER_PHASE_PLANE, points.as_ptr(), 2, 2.0, positive);
            assert_eq!(status, LUXFER_OK);
        }
        assert_eq!(luxfer_segment_set_strokes(segment, LUXFER_PHASE_PLANE, strokes), LUXFER_OK);
        assert_eq!(luxfer_release(strokes.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(features.cast()), LUXFER_OK);
    }
    segment
}

fn run(segment: *mut luxfer_segment) {
    let job = made(|out| unsafe { luxfer_segment_start(segment, std::ptr::null(), out) });
    unsafe {
        assert_eq!(wait(job, -1, None, null_mut()), LUXFER_OK);
        assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
    }
}

fn empty() -> luxfer_warning {
    unsafe { std::mem::zeroed() }
}

fn list(warnings: *mut luxfer_warnings) -> Vec<luxfer_warning> {
    let mut count = u32::MAX;
    assert_eq!(unsafe { luxfer_warnings_get_count(warnings, &mut count) }, LUXFER_OK);
    let read = |index| {
        let mut warning = empty();
        assert_eq!(unsafe { luxfer_warnings_get(warnings, index, &mut warning, size_of_val(&warning)) }, LUXFER_OK);
        warning
    };
    (0..count).map(read).collect()
}

/// Views a text of a list of warnings, which must still be alive.
fn text(text: *const c_char) -> &'static str {
    unsafe { CStr::from_ptr(text) }.to_str().unwrap()
}

#[test]
fn a_doubtful_mask_says_so_with_figure_limit_place_and_advice() {
    let context = context(1);
    let segment = doubtful(context);
    let mut none: *mut luxfer_warnings = null_mut();
    assert_eq!(unsafe { luxfer_get_warnings(segment.cast(), &mut none) }, LUXFER_NOT_READY);
    assert!(none.is_null());
    run(segment);
    let warnings = made(|out| unsafe { luxfer_get_warnings(segment.cast(), out) });
    let found = list(warnings);
    assert!(
        found.iter().any(|w| w.code == LUXFER_WARNING_UNCERTAIN_MASK),
        "{:?}",
        found.iter().map(|w| w.code).collect::<Vec<_>>()
    );
    for warning in &found {
        assert_eq!(warning.stage, LUXFER_STAGE_PLANE);
        assert_eq!(warning.severity > warning.limit, warning.code != LUXFER_WARNING_EMPTY_MASK);
        assert_eq!(warning.has_place == 0, warning.place == [0.0; 2]);
        let (what, advice) = (text(warning.message), text(warning.advice));
        assert!(what.len() > 10 && advice.len() > 10 && what != advice, "{what}; {advice}");
    }

    // Missed strokes have a place in the photo.
    let missed = found.iter().find(|w| w.code == LUXFER_WARNING_MISSED_STROKES).expect("the strokes are missed");
    assert_eq!(missed.has_place, 1);
    assert!(missed.place[0] > 0.0 && missed.place[0] < 64.0 && missed.place[1] > 0.0 && missed.place[1] < 48.0);

    // With a mask of the plane as its region, the segmentation looks for lights, and its warnings say so.
    let mut ones = vec![1.0f32; 64 * 48];
    let within = luxfer_image_view { channels: 1, byte_size: 64 * 48 * 4, ..view(64, 48, &mut ones) };
    let within = made(|out| unsafe { luxfer_image_create(context, &within, out) });
    assert_eq!(unsafe { luxfer_segment_set_region(segment, within) }, LUXFER_OK);
    run(segment);
    let lights = made(|out| unsafe { luxfer_get_warnings(segment.cast(), out) });
    assert!(list(lights).iter().all(|w| w.stage == LUXFER_STAGE_LIGHTS));

    // The first list stays unchanged after everything else is released.
    unsafe {
        assert_eq!(luxfer_release(lights.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(within.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(segment.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
    let again = list(warnings);
    assert!(again.iter().zip(&found).all(|(a, b)| text(a.message) == text(b.message)));
    assert_eq!(again.iter().map(|w| w.code).collect::<Vec<_>>(), found.iter().map(|w| w.code).collect::<Vec<_>>());
    unsafe {
        assert_eq!(luxfer_retain(warnings.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(warnings.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(warnings.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(null_mut()), LUXFER_OK);
    }
}

#[test]
fn wrong_arguments_are_errors() {
    let context = context(1);
    let segment = doubtful(context);
    run(segment);
    let warnings = made(|out| unsafe { luxfer_get_warnings(segment.cast(), out) });
    let count = list(warnings).len() as u32;
    let mut warning = empty();
    unsafe {
        assert_eq!(luxfer_warnings_get(warnings, count, &mut warning, size_of_val(&warning)), LUXFER_NOT_FOUND);
        assert!(message(context).contains("warning"), "{}", message(context));
        assert_eq!(luxfer_warnings_get(warnings, u32::MAX, &mut warning, size_of_val(&warning)), LUXFER_NOT_FOUND);
        assert_eq!(luxfer_warnings_get(warnings, 0, &mut warning, 20), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_warnings_get(warnings, 0, null_mut(), 0), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_warnings_get_count(warnings, null_mut()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_warnings_get_count(segment.cast(), null_mut()), LUXFER_INVALID_ARGUMENT);
        assert_eq!(luxfer_get_warnings(segment.cast(), null_mut()), LUXFER_INVALID_ARGUMENT);

        // Only stages and scenes have warnings.
        let mut none = null_mut();
        for bad in [null_mut(), context.cast(), warnings.cast::<c_void>()] {
            assert_eq!(luxfer_get_warnings(bad, &mut none), LUXFER_INVALID_ARGUMENT);
        }
        assert!(none.is_null());
        assert_eq!(luxfer_release(warnings.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(segment.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn stages_without_a_result_have_no_list() {
    let context = context(1);
    let mut list: *mut luxfer_warnings = null_mut();
    unsafe {
        let transfer = made(|out| luxfer_transfer_create(context, out));
        let rectify = made(|out| luxfer_rectify_create(context, out));
        let features = made(|out| luxfer_features_create(context, out));
        let emission = made(|out| luxfer_emission_create(context, out));
        let relight = made(|out| luxfer_relight_create(context, out));
        assert_eq!(luxfer_get_warnings(transfer.cast(), &mut list), LUXFER_NOT_READY);
        assert_eq!(luxfer_get_warnings(rectify.cast(), &mut list), LUXFER_NOT_READY);
        assert_eq!(luxfer_get_warnings(features.cast(), &mut list), LUXFER_NOT_READY);
        assert_eq!(luxfer_get_warnings(emission.cast(), &mut list), LUXFER_NOT_READY);
        assert_eq!(luxfer_get_warnings(relight.cast(), &mut list), LUXFER_NOT_READY);
        assert!(list.is_null());
        assert_eq!(luxfer_release(relight.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(emission.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(features.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(rectify.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(transfer.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}
