//! A host may fork: in the child, objects from before the fork refuse every call at once, and new ones work.

#![cfg(unix)]

mod host;

use host::{context, image, made, message, scene, view, wait};
use luxfer::ffi::*;
use std::ffi::c_void;
use std::fs;
use std::os::fd::AsRawFd;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Longest time for which a child may run, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Forks, runs `work` in the child, and returns everything that the child wrote to its stderr. Panics if `work` panics
/// in the child, or if the child does not end.
fn in_child(name: &str, work: impl FnOnce()) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()));
    let errors = fs::File::create(&path).unwrap();
    // SAFETY: the child runs C functions and ends by `_exit`.
    let child = unsafe { libc::fork() };
    assert!(child >= 0);
    if child == 0 {
        unsafe {
            libc::dup2(errors.as_raw_fd(), 2);
            libc::_exit(i32::from(catch_unwind(AssertUnwindSafe(work)).is_err()));
        }
    }
    let (begin, mut status) = (Instant::now(), 0);
    while unsafe { libc::waitpid(child, &mut status, libc::WNOHANG) } == 0 {
        if begin.elapsed() > PATIENCE {
            unsafe { libc::kill(child, libc::SIGKILL) };
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    let written = fs::read_to_string(&path).unwrap();
    fs::remove_file(path).unwrap();
    assert_eq!(status, 0, "the child failed: {written}");
    written
}

/// Starts a rendering that lasts until it is cancelled.
fn start_render(context: *mut luxfer_context, scene: *mut luxfer_scene) -> (*mut luxfer_render, *mut luxfer_job) {
    let render = made(|out| unsafe { luxfer_render_create(context, out) });
    let mut params = unsafe { std::mem::zeroed::<luxfer_render_params>() };
    unsafe {
        assert_eq!(luxfer_init(LUXFER_STRUCT_RENDER_PARAMS, (&raw mut params).cast(), size_of_val(&params)), LUXFER_OK);
        assert_eq!(luxfer_render_set_scene(render, scene), LUXFER_OK);
    }
    let params = luxfer_render_params { width: 64, height: 64, samples: 1 << 20, ..params };
    (render, made(|out| unsafe { luxfer_render_start(render, &params, out) }))
}

/// Traces a vertical ray from the middle height of the room up to its ceiling; returns the status and the distance.
fn trace(scene: *mut luxfer_scene) -> (luxfer_status, f32) {
    let ray = luxfer_ray { origin: [1.0, 0.0, 1.0], direction: [0.0, 1.0, 0.0], t_max: f32::INFINITY };
    let mut hit = luxfer_hit { t: 0.0, mesh: 0, triangle: 0, u: 0.0, v: 0.0 };
    (unsafe { luxfer_scene_intersect(scene, &ray, 1, 0, &mut hit, 0) }, hit.t)
}

/// Objects of one context, and a running job.
struct Objects {
    context: *mut luxfer_context,
    image: *mut luxfer_image,
    scene: *mut luxfer_scene,
    render: *mut luxfer_render,
    job: *mut luxfer_job,
}

impl Objects {
    fn new() -> Self {
        let context = context(2);
        let (image, scene) = (image(context, 4, 4, 0.5), scene(context));
        let (render, job) = start_render(context, scene);
        Self { context, image, scene, render, job }
    }

    /// Makes calls with each kind of object, and returns their statuses.
    fn call_all(&self) -> Vec<luxfer_status> {
        let (mut pixels, mut place) = ([0.5; 12], [null_mut::<c_void>(); 3]);
        let [made, job, other] = &mut place;
        let view = view(2, 2, &mut pixels);
        unsafe {
            vec![
                luxfer_retain(self.context.cast()),
                luxfer_image_create(self.context, &view, std::ptr::from_mut(made).cast()),
                luxfer_render_create(self.context, std::ptr::from_mut(other).cast()),
                luxfer_retain(self.image.cast()),
                luxfer_image_read(self.image, 0, &view),
                trace(self.scene).0,
                luxfer_render_set_scene(self.render, self.scene),
                luxfer_render_start(self.render, null(), std::ptr::from_mut(job).cast()),
                luxfer_job_get_progress(self.job, &mut 0.0),
                luxfer_job_cancel(self.job),
                luxfer_job_wait(self.job, -1, None, null_mut(), &mut 0),
                luxfer_retain(self.job.cast()),
            ]
        }
    }

    fn release(&self) -> [luxfer_status; 5] {
        unsafe {
            [
                luxfer_release(self.job.cast()),
                luxfer_release(self.render.cast()),
                luxfer_release(self.scene.cast()),
                luxfer_release(self.image.cast()),
                luxfer_release(self.context.cast()),
            ]
        }
    }

    /// Checks, in a child, objects made before the fork: calls fail at once with a message, and releases succeed even
    /// twice.
    fn check_inherited(&self) {
        let clock = Instant::now();
        assert_eq!(self.call_all(), vec![LUXFER_INVALID_OPERATION; 12]);
        assert!(message(self.context).contains("before the process was forked"), "{}", message(self.context));
        assert_eq!([self.release(), self.release()], [[LUXFER_OK; 5]; 2]);
        assert_eq!(self.call_all(), vec![LUXFER_INVALID_OPERATION; 12]);
        assert!(clock.elapsed() < Duration::from_secs(5), "{:?}", clock.elapsed());
    }
}

#[test]
fn a_child_cannot_use_the_objects_of_its_parent_and_has_its_own() {
    let objects = Objects::new();
    let written = in_child("child", || {
        objects.check_inherited();
        // A new context of the child renders, and refuses objects of the parent.
        let own = Objects::new();
        assert_eq!(trace(own.scene), (LUXFER_OK, 2.0));
        let spare = made(|out| unsafe { luxfer_render_create(own.context, out) });
        unsafe {
            assert_eq!(luxfer_render_set_scene(spare, objects.scene), LUXFER_INVALID_OPERATION);
            assert!(message(own.context).contains("before the process was forked"));
            assert_eq!(wait(own.job, 50, None, null_mut()), LUXFER_NOT_READY);
            assert_eq!(luxfer_job_cancel(own.job), LUXFER_OK);
            assert_eq!(wait(own.job, -1, None, null_mut()), LUXFER_CANCELLED);
            assert_eq!(luxfer_release(spare.cast()), LUXFER_OK);
        }
        assert_eq!(own.release(), [LUXFER_OK; 5]);
    });
    assert_eq!(written, "");
    // The parent continues to work.
    assert_eq!(trace(objects.scene), (LUXFER_OK, 2.0));
    unsafe {
        assert_eq!(luxfer_job_cancel(objects.job), LUXFER_OK);
        assert_eq!(wait(objects.job, -1, None, null_mut()), LUXFER_CANCELLED);
    }
    assert_eq!(objects.release(), [LUXFER_OK; 5]);
}

#[test]
fn a_fork_while_other_threads_are_in_the_library_leaves_no_lock_that_a_child_waits_for() {
    let objects = Objects::new();
    let (ends, context) = (AtomicBool::new(false), objects.context as usize);
    std::thread::scope(|scope| {
        // Another thread makes failing calls, which store messages under a lock, and creates images.
        scope.spawn(|| {
            let context = context as *mut luxfer_context;
            while !ends.load(Ordering::Relaxed) {
                assert_eq!(unsafe { luxfer_image_create(context, null(), null_mut()) }, LUXFER_INVALID_ARGUMENT);
                assert_eq!(unsafe { luxfer_release(image(context, 8, 8, 1.0).cast()) }, LUXFER_OK);
            }
        });
        let written: String = (0..20).map(|_| in_child("busy", || objects.check_inherited())).collect();
        ends.store(true, Ordering::Relaxed);
        assert_eq!(written, "");
    });
    assert_eq!(objects.release(), [LUXFER_OK; 5]);
}

/// A progress callback that forks once and lets the job continue.
unsafe extern "C" fn fork_within(forked: *mut c_void, _: f64) -> i32 {
    let forked = unsafe { &mut *forked.cast::<Option<libc::pid_t>>() };
    match *forked {
        None => *forked = Some(unsafe { libc::fork() }),
        Some(_) => return 1,
    }
    0
}

#[test]
fn a_wait_whose_progress_function_forks_ends_in_the_child() {
    let objects = Objects::new();
    let mut forked: Option<libc::pid_t> = None;
    let mut outcome = LUXFER_UNKNOWN;
    let status = unsafe { luxfer_job_wait(objects.job, -1, Some(fork_within), (&raw mut forked).cast(), &mut outcome) };
    let child = forked.unwrap();
    if child == 0 {
        unsafe { libc::_exit(status) };
    }
    assert_eq!((status, outcome), (LUXFER_OK, LUXFER_CANCELLED));
    let mut ended = 0;
    assert_eq!(unsafe { libc::waitpid(child, &mut ended, 0) }, child);
    assert_eq!((libc::WIFEXITED(ended), libc::WEXITSTATUS(ended)), (true, LUXFER_INVALID_OPERATION));
    assert_eq!(objects.release(), [LUXFER_OK; 5]);
}
