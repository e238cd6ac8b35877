//! Contract of jobs at the C boundary: progress, cancellation, waiting, and release at any time in any order.

mod host;

use host::{context, image, made, message, scene, wait};
use luxfer::ffi::*;
use std::ffi::c_void;
use std::ptr::{null, null_mut};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Tests that count the threads of the process or start many threads run one at a time.
static ALONE: Mutex<()> = Mutex::new(());

fn render_params(side: u32, samples: u32) -> luxfer_render_params {
    let mut params = unsafe { std::mem::zeroed::<luxfer_render_params>() };
    assert_eq!(
        unsafe { luxfer_init(LUXFER_STRUCT_RENDER_PARAMS, (&raw mut params).cast(), size_of_val(&params)) },
        LUXFER_OK
    );
    luxfer_render_params { width: side, height: side, samples, ..params }
}

/// Creates a renderer for the box of `host::scene`.
fn renderer(context: *mut luxfer_context) -> *mut luxfer_render {
    let scene = scene(context);
    let render = made(|out| unsafe { luxfer_render_create(context, out) });
    unsafe {
        assert_eq!(luxfer_render_set_scene(render, scene), LUXFER_OK);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
    }
    render
}

fn start(render: *mut luxfer_render, params: &luxfer_render_params) -> *mut luxfer_job {
    made(|out| unsafe { luxfer_render_start(render, params, out) })
}

/// Samples per pixel of a job that does not end within the test.
const ENDLESS: u32 = 1 << 20;

fn threads() -> usize {
    std::fs::read_dir("/proc/self/task").unwrap().count()
}

#[test]
fn any_release_order_is_fine() {
    let _alone = ALONE.lock();
    let release = |objects: [*mut c_void; 4], order: [usize; 4]| {
        let status = order.map(|i| unsafe { luxfer_release(objects[i]) });
        assert_eq!(status, [LUXFER_OK; 4], "{order:?}");
    };
    for code in 0..256usize {
        let order = [code & 3, code >> 2 & 3, code >> 4 & 3, code >> 6];
        let is_permutation = (0..4).all(|i| order.contains(&i));
        if is_permutation {
            let context = context(1);
            let render = renderer(context);
            let job = start(render, &render_params(64, ENDLESS));
            release([context.cast(), image(context, 3, 3, 1.0).cast(), render.cast(), job.cast()], order);
        }
    }
}

/// User data of a progress callback: the fractions it has seen, and the fraction at which it cancels.
struct Watch {
    seen: Vec<f64>,
    thread: std::thread::ThreadId,
    cancel_at: f64,
    cancelled: Option<Instant>,
}

impl Watch {
    fn new(cancel_at: f64) -> Self {
        Self { seen: Vec::new(), thread: std::thread::current().id(), cancel_at, cancelled: None }
    }
}

fn outcome(job: *mut luxfer_job) -> luxfer_status {
    unsafe { wait(job, 0, None, null_mut()) }
}

unsafe extern "C" fn watch(user: *mut c_void, fraction: f64) -> i32 {
    let watch = unsafe { &mut *user.cast::<Watch>() };
    watch.seen.push(fraction);
    // A panic must not cross the C boundary, so an error is recorded as a fraction that is out of range.
    if std::thread::current().id() != watch.thread || watch.cancelled.is_some() {
        watch.seen.push(-1.0);
    }
    if fraction >= watch.cancel_at {
        watch.cancelled = Some(Instant::now());
    }
    i32::from(watch.cancelled.is_some())
}

#[test]
fn progress_rises_and_ends_at_one() {
    let context = context(2);
    let render = renderer(context);
    let job = start(render, &render_params(96, 64));
    let mut seen = Watch::new(f64::INFINITY);
    unsafe {
        assert_eq!(wait(job, -1, Some(watch), (&raw mut seen).cast()), LUXFER_OK, "{}", message(context));
        let (last, before) = seen.seen.split_last().unwrap();
        assert_eq!(*last, 1.0);
        assert!(before.iter().all(|f| (0.0..1.0).contains(f)) && before.is_sorted(), "{before:?}");
        let mut fraction = 0.0;
        assert_eq!(luxfer_job_get_progress(job, &mut fraction), LUXFER_OK);
        assert_eq!((fraction, outcome(job)), (1.0, LUXFER_OK));
        assert_eq!(luxfer_job_cancel(job), LUXFER_OK);
        assert_eq!(outcome(job), LUXFER_OK);
        let mut report = std::mem::zeroed::<luxfer_render_report>();
        assert_eq!(luxfer_render_get_report(render, &mut report, size_of_val(&report)), LUXFER_OK);
        assert_eq!(report.samples, 64);
        assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(render.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn a_cancel_is_answered_at_any_point() {
    let _alone = ALONE.lock();
    let context = context(2);
    let render = renderer(context);
    let delays = [0.0, 0.1, 0.5].map(|cancel_at| {
        let job = start(render, &render_params(48, 512));
        let mut seen = Watch::new(cancel_at);
        let status = unsafe { wait(job, -1, Some(watch), (&raw mut seen).cast()) };
        assert_eq!(status, LUXFER_CANCELLED, "at {cancel_at}: {:?}", seen.seen.last());
        let late = seen.cancelled.unwrap().elapsed();
        assert!(seen.seen.iter().all(|f| (0.0..1.0).contains(f)), "no call after the cancel, none from elsewhere");
        assert_eq!(outcome(job), LUXFER_CANCELLED);
        assert_eq!(unsafe { luxfer_release(job.cast()) }, LUXFER_OK);
        late
    });
    // Only the shortest delay counts, because other programs may occupy the processors for a while.
    assert!(*delays.iter().min().unwrap() <= Duration::from_millis(100), "{delays:?}");
    // Cancel from another thread while this one waits.
    let job = start(render, &render_params(64, ENDLESS));
    let shared = job as usize;
    let other = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(30));
        unsafe { luxfer_job_cancel(shared as *mut luxfer_job) }
    });
    unsafe {
        assert_eq!(wait(job, -1, None, null_mut()), LUXFER_CANCELLED);
        assert_eq!(other.join().unwrap(), LUXFER_OK);
        assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(render.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn waits_time_out_and_a_busy_object_refuses_changes() {
    let context = context(1);
    let render = renderer(context);
    let scene = scene(context);
    let job = start(render, &render_params(64, ENDLESS));
    let mut second = null_mut();
    unsafe {
        for timeout in [0, 1, 60] {
            let clock = Instant::now();
            assert_eq!(wait(job, timeout, None, null_mut()), LUXFER_NOT_READY);
            assert!(clock.elapsed() >= Duration::from_millis(timeout as u64));
        }
        assert_eq!(outcome(job), LUXFER_NOT_READY);
        assert_eq!(luxfer_render_start(render, null(), &mut second), LUXFER_INVALID_OPERATION);
        assert!(second.is_null());
        assert_eq!(luxfer_render_set_scene(render, scene), LUXFER_INVALID_OPERATION);
        // The running job blocks neither another renderer nor the scene.
        let other = renderer(context);
        let small = start(other, &render_params(8, 1));
        assert_eq!(luxfer_scene_set_environment(scene, null_mut(), [1.0; 3].as_ptr()), LUXFER_OK);
        assert_eq!(luxfer_job_cancel(job), LUXFER_OK);
        assert_eq!(wait(job, -1, None, null_mut()), LUXFER_CANCELLED);
        assert_eq!(wait(small, -1, None, null_mut()), LUXFER_OK);
        // The object is idle as soon as the wait ends.
        assert_eq!(luxfer_render_set_scene(render, scene), LUXFER_OK);
        for job in [job, small] {
            assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
        }
        assert_eq!(luxfer_release(other.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(render.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_thousand_contexts_and_jobs_leave_no_thread_behind() {
    let _alone = ALONE.lock();
    // Other tests start and end threads at the same time; a thousand leaked threads would still be noticed.
    let before = threads();
    for i in 0..1000 {
        let context = context(1);
        let image = image(context, 1, 1, 0.0);
        if i % 20 == 0 {
            let render = renderer(context);
            let job = start(render, &render_params(16, ENDLESS));
            unsafe {
                assert_eq!(luxfer_release(render.cast()), LUXFER_OK);
                assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
            }
        }
        unsafe {
            assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
            assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        }
    }
    assert!(threads() < before + 50, "{before} threads before, {} after", threads());
}

/// A job of several transfers names the one that is wrong, leaves all of them idle if it does not start, and keeps all
/// of them busy if it does.
#[test]
fn several_transfers_are_checked_before_their_job_starts() {
    let _alone = ALONE.lock();
    let (context, other_context) = (context(1), context(1));
    let transfer = |context| made(|out| unsafe { luxfer_transfer_create(context, out) });
    let [first, second, foreign] = [context, context, other_context].map(transfer);
    let mut job = null_mut();
    let photo = image(context, 12, 8, 0.5);
    let mut start = |transfers: &[*mut luxfer_transfer], first, last| unsafe {
        luxfer_transfer_start_all(context, transfers.as_ptr(), transfers.len(), first, last, null(), &mut job)
    };
    let refused = |status, expected, part: &str| {
        assert_eq!(status, expected, "{part}");
        assert!(message(context).contains(part), "{}, not {part}", message(context));
    };
    unsafe { assert_eq!(luxfer_transfer_set_photo(first, photo), LUXFER_OK) };
    refused(start(&[], 0, 0), LUXFER_INVALID_ARGUMENT, "count is 0");
    refused(start(&[first; 17], 0, 0), LUXFER_INVALID_ARGUMENT, "count is 17");
    refused(start(&[first, null_mut()], 0, 0), LUXFER_INVALID_ARGUMENT, "transfers[1]");
    refused(start(&[first, foreign], 0, 0), LUXFER_INVALID_ARGUMENT, "transfers[1] belongs to another context");
    refused(start(&[first, first], 0, 0), LUXFER_INVALID_ARGUMENT, "transfers[1] is transfers[0] too");
    refused(start(&[first], 0, 8), LUXFER_INVALID_ARGUMENT, "last is 8");
    refused(start(&[first, second], 1, 1), LUXFER_INVALID_OPERATION, "transfers[1]: stage Features: set the photo");
    unsafe {
        let size = size_of::<luxfer_transfer_params>();
        let mut params = std::mem::zeroed::<luxfer_transfer_params>();
        assert_eq!(luxfer_init(LUXFER_STRUCT_TRANSFER_PARAMS, (&raw mut params).cast(), size), LUXFER_OK);
        params.target = 9;
        assert_eq!(luxfer_transfer_set_photo(second, photo), LUXFER_OK);
        let (both, settings) = ([first, second], [null(), &raw const params]);
        let status = luxfer_transfer_start_all(context, both.as_ptr(), 2, 1, 1, settings.as_ptr(), &mut job);
        refused(status, LUXFER_INVALID_ARGUMENT, "transfers[1]: target is 9");
        let all = [first, second];
        refused(
            luxfer_transfer_start_all(context, null(), 2, 1, 1, null(), &mut job),
            LUXFER_INVALID_ARGUMENT,
            "transfers is NULL",
        );
        refused(
            luxfer_transfer_start_all(context, all.as_ptr(), 2, 1, 1, null(), null_mut()),
            LUXFER_INVALID_ARGUMENT,
            "job is NULL",
        );
        // None of the calls has left a transfer busy: the job starts, and its results are those of both.
        assert_eq!(luxfer_transfer_start_all(context, all.as_ptr(), 2, 1, 1, null(), &mut job), LUXFER_OK);
        let mut outcome = -1;
        assert_eq!(luxfer_job_wait(job, -1, None, null_mut(), &mut outcome), LUXFER_OK);
        assert_eq!(outcome, LUXFER_OK, "{}", message(context));
        assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
        for transfer in all {
            let mut features = null_mut();
            assert_eq!(luxfer_transfer_get_image(transfer, LUXFER_TRANSFER_FEATURES, &mut features), LUXFER_OK);
            assert_eq!(luxfer_release(features.cast()), LUXFER_OK);
        }
        for object in [first, second, foreign] {
            assert_eq!(luxfer_release(object.cast()), LUXFER_OK);
        }
        assert_eq!(luxfer_release(photo.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(other_context.cast()), LUXFER_OK);
    }
}
