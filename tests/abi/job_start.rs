//! Contract of `luxfer_job_start`, which runs a function of the caller as a job: result, message, progress,
//! cancellation, waits inside the function, and release.

use crate::host::{context, image, made, message, scene, wait};
use luxfer::ffi::*;
use std::ffi::c_void;
use std::ptr::null_mut;
use std::time::{Duration, Instant};

/// User data of a function that runs as a job.
struct Work {
    context: *mut luxfer_context,
    scene: *mut luxfer_scene,
    /// Sent once the function has begun its long call.
    begun: std::sync::mpsc::Sender<()>,
    job: *mut luxfer_job,
    statuses: Vec<luxfer_status>,
}

/// Runs `work` as a job. With `cancel_after`, cancels it this long after it has reported its beginning. Returns the
/// job's status, its message, the statuses that `work` recorded, and the time from the cancel request to the end.
fn run(
    work: unsafe extern "C" fn(*mut c_void) -> luxfer_status,
    cancel_after: Option<Duration>,
) -> (luxfer_status, String, Vec<luxfer_status>, Duration) {
    let context = context(1);
    let (begun, begins) = std::sync::mpsc::channel();
    let mut user = Box::new(Work { context, scene: scene(context), begun, job: null_mut(), statuses: Vec::new() });
    let pointer: *mut Work = &mut *user;
    let job = made(|out| unsafe { luxfer_job_start(context, Some(work), pointer.cast(), out) });
    let mut requested = Instant::now();
    if let Some(time) = cancel_after {
        begins.recv().unwrap();
        std::thread::sleep(time);
        requested = Instant::now();
        assert_eq!(unsafe { luxfer_job_cancel(job) }, LUXFER_OK);
    }
    let status = unsafe { wait(job, -1, None, null_mut()) };
    let (late, text) = (requested.elapsed(), message(context));
    unsafe {
        assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(user.scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
    (status, text, user.statuses, late)
}

/// Rates the glare of an observer in the box. The number of paths makes the call take minutes.
unsafe fn rate_for_minutes(scene: *mut luxfer_scene) -> luxfer_status {
    let observer = luxfer_observer { position: [1.0, 1.0, 1.0], direction: [1.0, 0.0, 0.0] };
    let mut rating = unsafe { std::mem::zeroed::<luxfer_observer_glare>() };
    unsafe { luxfer_scene_get_glare(scene, &observer, 1, 0, 1 << 24, 1, &mut rating, 0) }
}

unsafe extern "C" fn rate(user: *mut c_void) -> luxfer_status {
    let work = unsafe { &mut *user.cast::<Work>() };
    work.begun.send(()).unwrap();
    unsafe { rate_for_minutes(work.scene) }
}

/// Function of a job: starts an endless rendering and waits for it.
unsafe extern "C" fn render(user: *mut c_void) -> luxfer_status {
    let work = unsafe { &mut *user.cast::<Work>() };
    let render = made(|out| unsafe { luxfer_render_create(work.context, out) });
    let mut params = unsafe { std::mem::zeroed::<luxfer_render_params>() };
    unsafe {
        luxfer_init(LUXFER_STRUCT_RENDER_PARAMS, (&raw mut params).cast(), size_of_val(&params));
        luxfer_render_set_scene(render, work.scene);
        let params = luxfer_render_params { width: 64, height: 64, samples: 1 << 20, ..params };
        let job = made(|out| luxfer_render_start(render, &params, out));
        work.begun.send(()).unwrap();
        let status = wait(job, -1, None, null_mut());
        work.statuses.push(status);
        luxfer_release(job.cast());
        luxfer_release(render.cast());
        status
    }
}

#[test]
fn a_cancel_ends_the_calls_and_the_jobs_of_the_function() {
    for work in [rate as unsafe extern "C" fn(*mut c_void) -> luxfer_status, render] {
        let runs = [10, 50, 100].map(|ms| run(work, Some(Duration::from_millis(ms))));
        for (status, text, inside, _) in &runs {
            assert_eq!(*status, LUXFER_CANCELLED, "{text}");
            assert!(inside.iter().all(|status| *status == LUXFER_CANCELLED), "{inside:?}");
        }
        // Only the quickest run counts, because other programs may occupy the processors for a while.
        let quickest = runs.iter().map(|run| run.3).min().unwrap();
        assert!(quickest <= Duration::from_millis(100), "{quickest:?}");
    }
}

#[test]
fn the_job_has_the_result_and_the_message_of_the_function() {
    unsafe extern "C" fn succeed(user: *mut c_void) -> luxfer_status {
        let work = unsafe { &mut *user.cast::<Work>() };
        let small = image(work.context, 4, 3, 0.5);
        unsafe { luxfer_release(small.cast()) }
    }
    unsafe extern "C" fn fail_to_load(user: *mut c_void) -> luxfer_status {
        let work = unsafe { &mut *user.cast::<Work>() };
        let mut image = null_mut();
        unsafe { luxfer_image_load(work.context, c"/no/such/file.png".as_ptr(), LUXFER_COLOUR_SRGB, &mut image) }
    }
    unsafe extern "C" fn invent(_: *mut c_void) -> luxfer_status {
        4711
    }
    unsafe extern "C" fn wait_too_short(_: *mut c_void) -> luxfer_status {
        LUXFER_NOT_READY
    }
    assert_eq!(run(succeed, None).0, LUXFER_OK);
    let (status, text, ..) = run(fail_to_load, None);
    assert_eq!(status, LUXFER_IO);
    assert!(text.contains("/no/such/file.png"), "{text}");
    let (status, text, ..) = run(invent, None);
    assert_eq!((status, text.contains("4711")), (LUXFER_UNKNOWN, true), "{text}");
    // LUXFER_NOT_READY would say that the job still runs.
    let (status, text, ..) = run(wait_too_short, None);
    assert_eq!((status, text.contains("LUXFER_NOT_READY")), (LUXFER_INVALID_OPERATION, true), "{text}");

    let context = context(1);
    let mut job = null_mut();
    assert_eq!(unsafe { luxfer_job_start(context, None, null_mut(), &mut job) }, LUXFER_INVALID_ARGUMENT);
    assert_eq!(message(context), "work is NULL; it must be a function that returns a luxfer_status");
    assert_eq!(unsafe { luxfer_release(context.cast()) }, LUXFER_OK);
}

/// Function of a job: waits until the handle of its own job is stored, tries to wait for that job, releases it, and
/// continues.
unsafe extern "C" fn release_itself(user: *mut c_void) -> luxfer_status {
    let work = unsafe { &mut *user.cast::<Work>() };
    let job: *mut luxfer_job = loop {
        let job = unsafe { (&raw const work.job).read_volatile() };
        if !job.is_null() {
            break job;
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    unsafe {
        work.statuses.push(luxfer_job_wait(job, -1, None, null_mut(), &mut 0));
        assert_eq!(wait(job, 0, None, null_mut()), LUXFER_NOT_READY);
        work.statuses.push(luxfer_release(job.cast()));
        // Releasing its last reference has cancelled the job, so this call is cancelled too.
        work.statuses.push(rate_for_minutes(work.scene));
    }
    work.begun.send(()).unwrap();
    LUXFER_OK
}

#[test]
fn a_function_may_release_its_own_job_but_not_wait_for_it() {
    let context = context(1);
    let (begun, ends) = std::sync::mpsc::channel();
    let scene = scene(context);
    let work: *mut Work =
        Box::into_raw(Box::new(Work { context, scene, begun, job: null_mut(), statuses: Vec::new() }));
    unsafe {
        let job = made(|out| luxfer_job_start(context, Some(release_itself), work.cast(), out));
        (&raw mut (*work).job).write_volatile(job);
        ends.recv_timeout(Duration::from_secs(60)).unwrap();
        let work = Box::from_raw(work);
        assert_eq!(work.statuses, [LUXFER_INVALID_OPERATION, LUXFER_OK, LUXFER_CANCELLED]);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn progress_is_that_of_the_calls() {
    unsafe extern "C" fn note(user: *mut c_void, fraction: f64) -> i32 {
        unsafe { &mut *user.cast::<Vec<f64>>() }.push(fraction);
        0
    }
    unsafe extern "C" fn rate_shortly(user: *mut c_void) -> luxfer_status {
        let scene: *mut luxfer_scene = user.cast();
        let observer = luxfer_observer { position: [1.0, 1.0, 1.0], direction: [1.0, 0.0, 0.0] };
        let observers = [observer; 64];
        let mut ratings = [unsafe { std::mem::zeroed::<luxfer_observer_glare>() }; 64];
        unsafe { luxfer_scene_get_glare(scene, observers.as_ptr(), 64, 0, 1 << 14, 1, ratings.as_mut_ptr(), 0) }
    }
    let context = context(2);
    let scene = scene(context);
    let job = made(|out| unsafe { luxfer_job_start(context, Some(rate_shortly), scene.cast(), out) });
    let mut seen: Vec<f64> = Vec::new();
    unsafe {
        assert_eq!(wait(job, -1, Some(note), (&raw mut seen).cast()), LUXFER_OK, "{}", message(context));
        assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
    assert!(seen.is_sorted() && seen.last() == Some(&1.0), "{seen:?}");
    let between = seen.iter().filter(|&&fraction| fraction > 0.0 && fraction < 1.0).count();
    assert!(seen.len() < 4 || between > 0, "{seen:?}");
}
