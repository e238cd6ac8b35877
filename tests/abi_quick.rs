//! Tests that quick calls (calls that finish their work before they return) never wait for a running job, and that a
//! job can be cancelled while it waits for another job.

mod host;

use host::{context, image, made, message, scene, wait};
use luxfer::ffi::*;
use std::ffi::c_void;
use std::ptr::{null, null_mut};
use std::time::{Duration, Instant};

/// Maximum time by which a running job may delay a quick call.
const MAX_DELAY: Duration = Duration::from_millis(50);

/// Number of times the calls are timed; the fastest time counts, because other programs may occupy the processors.
const ROUNDS: usize = 5;

/// Starts a rendering of a new scene.
fn start_render(context: *mut luxfer_context, samples: u32) -> (*mut luxfer_render, *mut luxfer_job) {
    let (render, scene) = (made(|out| unsafe { luxfer_render_create(context, out) }), scene(context));
    let mut params = unsafe { std::mem::zeroed::<luxfer_render_params>() };
    unsafe {
        assert_eq!(luxfer_init(LUXFER_STRUCT_RENDER_PARAMS, (&raw mut params).cast(), size_of_val(&params)), LUXFER_OK);
        assert_eq!(luxfer_render_set_scene(render, scene), LUXFER_OK);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
    }
    let params = luxfer_render_params { width: 64, height: 64, samples, ..params };
    (render, made(|out| unsafe { luxfer_render_start(render, &params, out) }))
}

/// A job that lasts until it is cancelled.
struct Endless {
    render: *mut luxfer_render,
    job: *mut luxfer_job,
}

impl Endless {
    /// Starts the job and waits until it runs.
    fn start(context: *mut luxfer_context) -> Self {
        let (render, job) = start_render(context, 1 << 20);
        let mut fraction = 0.0;
        while fraction == 0.0 {
            assert_eq!(unsafe { luxfer_job_get_progress(job, &mut fraction) }, LUXFER_OK);
            std::thread::sleep(Duration::from_millis(1));
        }
        Self { render, job }
    }

    fn end(self) {
        unsafe {
            assert_eq!(luxfer_job_cancel(self.job), LUXFER_OK);
            assert_eq!(wait(self.job, -1, None, null_mut()), LUXFER_CANCELLED);
            assert_eq!(luxfer_release(self.job.cast()), LUXFER_OK);
            assert_eq!(luxfer_release(self.render.cast()), LUXFER_OK);
        }
    }
}

/// Objects that the quick calls use.
struct Objects {
    context: *mut luxfer_context,
    image: *mut luxfer_image,
    scene: *mut luxfer_scene,
    sheet: *mut luxfer_image,
    sheet_params: luxfer_sheet_params,
    render: *mut luxfer_render,
}

impl Objects {
    fn new(context: *mut luxfer_context) -> Self {
        let image = image(context, 32, 24, 0.5);
        let mut params = unsafe { std::mem::zeroed::<luxfer_sheet_params>() };
        assert_eq!(
            unsafe { luxfer_init(LUXFER_STRUCT_SHEET_PARAMS, (&raw mut params).cast(), size_of_val(&params)) },
            LUXFER_OK
        );
        let sheet_params = luxfer_sheet_params { paper_width: 100.0, paper_height: 80.0, dpi: 50.0, ..params };
        let sheet = made(|out| unsafe { luxfer_sheet_print(image, &sheet_params, out) });
        let (render, job) = start_render(context, 16);
        unsafe {
            assert_eq!(wait(job, -1, None, null_mut()), LUXFER_OK);
            assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
        }
        Self { context, image, scene: scene(context), sheet, sheet_params, render }
    }

    fn release(self) {
        unsafe {
            assert_eq!(luxfer_release(self.image.cast()), LUXFER_OK);
            assert_eq!(luxfer_release(self.sheet.cast()), LUXFER_OK);
            assert_eq!(luxfer_release(self.scene.cast()), LUXFER_OK);
            assert_eq!(luxfer_release(self.render.cast()), LUXFER_OK);
        }
    }
}

/// Traces `count` equal vertical rays from the middle height of the room; returns the distance to the ceiling.
fn trace(scene: *mut luxfer_scene, count: usize) -> f32 {
    let ray = luxfer_ray { origin: [1.0, 0.0, 1.0], direction: [0.0, 1.0, 0.0], t_max: f32::INFINITY };
    let mut hits = vec![luxfer_hit { t: 0.0, mesh: 0, triangle: 0, u: 0.0, v: 0.0 }; count];
    let rays = vec![ray; count];
    assert_eq!(unsafe { luxfer_scene_intersect(scene, rays.as_ptr(), count, 0, hits.as_mut_ptr(), 0) }, LUXFER_OK);
    assert!(hits.iter().all(|hit| hit.t == hits[0].t));
    hits[0].t
}

fn new_image(context: *mut luxfer_context, make: impl FnOnce(*mut *mut luxfer_image) -> luxfer_status) {
    let mut image = null_mut();
    assert_eq!(make(&mut image), LUXFER_OK, "{}", message(context));
    assert_eq!(unsafe { luxfer_release(image.cast()) }, LUXFER_OK);
}

fn requirements(scene: *mut luxfer_scene) {
    let mut found = unsafe { std::mem::zeroed::<luxfer_requirements>() };
    assert_eq!(unsafe { luxfer_scene_get_requirements(scene, 0.1, &mut found, size_of_val(&found)) }, LUXFER_OK);
}

/// Every quick call that works in parallel and needs no long preparation, with its name.
const CALLS: [(&str, fn(&Objects)); 11] = [
    ("luxfer_scene_intersect, 1 ray", |o| assert_eq!(trace(o.scene, 1), 2.0)),
    ("luxfer_scene_intersect, 10000 rays", |o| assert_eq!(trace(o.scene, 10_000), 2.0)),
    ("luxfer_scene_get_requirements", |o| requirements(o.scene)),
    ("luxfer_scene_get_requirements of a new scene", |o| {
        let scene = scene(o.context);
        requirements(scene);
        assert_eq!(unsafe { luxfer_release(scene.cast()) }, LUXFER_OK);
    }),
    ("luxfer_image_warp", |o| {
        let same = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        new_image(o.context, |out| unsafe { luxfer_image_warp(o.image, same.as_ptr(), 8, 8, out) });
    }),
    ("luxfer_image_merge_exposures", |o| {
        let (photos, mut params) = ([o.image; 2], unsafe { std::mem::zeroed::<luxfer_merge_params>() });
        let size = size_of_val(&params);
        assert_eq!(unsafe { luxfer_init(LUXFER_STRUCT_MERGE_PARAMS, (&raw mut params).cast(), size) }, LUXFER_OK);
        (params.exposures[0], params.exposures[1]) = (1.0, 2.0);
        new_image(o.context, |out| unsafe {
            luxfer_image_merge_exposures(o.context, photos.as_ptr(), 2, &params, out, null_mut(), 0)
        });
    }),
    ("luxfer_image_false_colour", |o| {
        new_image(o.context, |out| unsafe { luxfer_image_false_colour(o.image, null(), out) });
    }),
    ("luxfer_sheet_print", |o| {
        new_image(o.context, |out| unsafe { luxfer_sheet_print(o.image, &o.sheet_params, out) });
    }),
    ("luxfer_sheet_align", |o| {
        new_image(o.context, |out| unsafe { luxfer_sheet_align(o.sheet, 32, 24, &o.sheet_params, out, null_mut(), 0) });
    }),
    ("luxfer_scene_get_distribution", |o| {
        let (mut lamp, mut params) = (null_mut(), unsafe { std::mem::zeroed::<luxfer_gonio_params>() });
        let size = size_of_val(&params);
        assert_eq!(unsafe { luxfer_init(LUXFER_STRUCT_GONIO_PARAMS, (&raw mut params).cast(), size) }, LUXFER_OK);
        (params.planes, params.samples) = (1, 16);
        let status = unsafe { luxfer_scene_get_distribution(o.scene, &1, 1, &params, &mut lamp, null_mut(), 0) };
        assert_eq!(status, LUXFER_OK, "{}", message(o.context));
        assert_eq!(unsafe { luxfer_release(lamp.cast()) }, LUXFER_OK);
    }),
    ("luxfer_render_get_image", |o| {
        new_image(o.context, |out| unsafe { luxfer_render_get_image(o.render, LUXFER_RENDER_INTERVAL, out) });
    }),
];

fn time(work: impl FnOnce()) -> Duration {
    let clock = Instant::now();
    work();
    clock.elapsed()
}

#[test]
fn quick_calls_never_wait_for_a_job() {
    for num_threads in [1, 2] {
        let context = context(num_threads);
        let objects = Objects::new(context);
        let times = || CALLS.map(|(_, call)| time(|| call(&objects)));
        // The first calls start threads, so their times do not count.
        times();
        let idle = times();
        let endless = Endless::start(context);
        let slowest = (0..ROUNDS).map(|_| {
            let delays = times().into_iter().zip(idle).map(|(busy, idle)| busy.saturating_sub(idle));
            delays.zip(CALLS).map(|(delay, (name, _))| (delay, name)).max().unwrap()
        });
        let (delay, name) = slowest.min().unwrap();
        println!("{num_threads} threads: the slowest quick call, {name}, is {delay:?} later than without the job");
        assert!(delay <= MAX_DELAY, "{num_threads} threads: {name} is delayed by {delay:?}");
        endless.end();
        objects.release();
        assert_eq!(unsafe { luxfer_release(context.cast()) }, LUXFER_OK);
    }
}

#[test]
fn a_quick_call_never_waits_for_another() {
    let context = context(1);
    let objects = Objects::new(context);
    // Start a warp to many pixels, which takes a while, in another thread.
    let (image, of) = (objects.image as usize, context as usize);
    let other = std::thread::spawn(move || {
        let enlarge = [1e-3, 0.0, 0.0, 0.0, 1e-3, 0.0, 0.0, 0.0, 1.0];
        let (image, context) = (image as *mut luxfer_image, of as *mut luxfer_context);
        time(|| new_image(context, |out| unsafe { luxfer_image_warp(image, enlarge.as_ptr(), 6000, 6000, out) }))
    });
    let mut traced = Vec::new();
    while !other.is_finished() {
        traced.push(time(|| assert_eq!(trace(objects.scene, 10_000), 2.0)));
    }
    let (long, quickest) = (other.join().unwrap(), traced.iter().min().unwrap());
    assert!(traced.len() > 3 && *quickest < long / 4, "{} calls while another took {long:?}", traced.len());
    objects.release();
    assert_eq!(unsafe { luxfer_release(context.cast()) }, LUXFER_OK);
}

/// A progress callback that traces a ray.
unsafe extern "C" fn trace_one(scene: *mut c_void, _: f64) -> i32 {
    i32::from(trace(scene.cast(), 1) != 2.0)
}

#[test]
fn a_cancel_is_answered_while_a_progress_function_calls_the_library() {
    let context = context(1);
    let scene = scene(context);
    let quickest = (0..3).map(|_| {
        let endless = Endless::start(context);
        let job = endless.job as usize;
        let canceller = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(100));
            assert_eq!(unsafe { luxfer_job_cancel(job as *mut luxfer_job) }, LUXFER_OK);
            Instant::now()
        });
        let status = unsafe { wait(endless.job, -1, Some(trace_one), scene.cast()) };
        let answered = Instant::now();
        assert_eq!(status, LUXFER_CANCELLED);
        let late = answered - canceller.join().unwrap();
        endless.end();
        late
    });
    // Only the quickest answer counts, because other programs may occupy the processors for a while.
    let quickest = quickest.min().unwrap();
    assert!(quickest <= Duration::from_millis(100), "{quickest:?}");
    unsafe {
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}

#[test]
fn a_job_that_waits_for_another_is_cancelled_at_once() {
    let context = context(1);
    let endless = Endless::start(context);
    let (render, job) = start_render(context, 4);
    unsafe {
        assert_eq!(wait(job, 50, None, null_mut()), LUXFER_NOT_READY);
        assert_eq!(luxfer_job_cancel(job), LUXFER_OK);
        let clock = Instant::now();
        assert_eq!(wait(job, 2000, None, null_mut()), LUXFER_CANCELLED);
        assert!(clock.elapsed() < Duration::from_millis(500), "{:?}", clock.elapsed());
        // The renderer accepts the next job, which waits until the endless job has ended.
        assert_eq!(luxfer_release(job.cast()), LUXFER_OK);
        let next = made(|out| luxfer_render_start(render, null(), out));
        endless.end();
        assert_eq!(luxfer_job_cancel(next), LUXFER_OK);
        assert_eq!(luxfer_release(next.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(render.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
}
