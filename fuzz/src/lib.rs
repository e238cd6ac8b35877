//! What each target does with its bytes: the public C ABI and nothing else, as a host uses it. What loads is used.
//!
//! A status that says "a defect" fails, and so does every panic, also where the library would catch it: libFuzzer ends the process.

mod calls;

pub use calls::calls;

use luxfer::ffi::*;
use std::ffi::{CString, c_char, c_void};
use std::fs::File;
use std::io::{Seek, Write};
use std::os::fd::AsRawFd;
use std::ptr::{null, null_mut};
use std::sync::LazyLock;

/// For pixels, meshes and textures of an input, in MiB; tests/fuzz.sh allows single allocations of twice that.
const BUDGET: u64 = 64;

/// Whether a call succeeded; fails if it gave a status that no call may give.
fn check(name: &str, status: luxfer_status) -> bool {
    let is_known = (LUXFER_OK..=LUXFER_UNREACHABLE).contains(&status);
    assert!(is_known && status != LUXFER_INTERNAL && status != LUXFER_UNKNOWN, "{name} returned {status}");
    status == LUXFER_OK
}

/// Makes something with a function that puts its handle where its last argument says.
fn made<T>(name: &str, make: impl FnOnce(*mut *mut T) -> luxfer_status) -> Option<*mut T> {
    let mut thing = null_mut();
    let succeeded = check(name, make(&mut thing));
    assert_eq!(succeeded, !thing.is_null(), "{name}: its handle and its status");
    succeeded.then_some(thing)
}

/// A handle that all inputs share; any thread may use it.
struct Shared<T>(*mut T);
// SAFETY: so says the header.
unsafe impl<T> Send for Shared<T> {}
unsafe impl<T> Sync for Shared<T> {}

/// A context of one thread: what one input leaves behind, later ones see.
fn context() -> *mut luxfer_context {
    static CONTEXT: LazyLock<Shared<luxfer_context>> = LazyLock::new(|| {
        let params = luxfer_context_params { struct_size: 16, num_threads: 1, memory_budget_mib: BUDGET };
        // SAFETY: of every call here, and below: all pointers are to live memory of ours, or handles of the library.
        Shared(made("luxfer_context_create", |out| unsafe { luxfer_context_create(&params, out) }).expect("a context"))
    });
    CONTEXT.0
}

/// A scene to render, as seeds.py has it.
fn demo() -> *mut luxfer_scene {
    static SCENE: LazyLock<Shared<luxfer_scene>> = LazyLock::new(|| {
        let make = |out| unsafe { luxfer_demo_create_scene(context(), LUXFER_DEMO_SPHERE_ON_TABLE, out) };
        Shared(made("luxfer_demo_create_scene", make).expect("a scene"))
    });
    SCENE.0
}

/// Hands the bytes over as a file on the disk, for functions that take a path.
fn as_file<R>(data: &[u8], work: impl FnOnce(*const c_char) -> R) -> R {
    let path = std::env::temp_dir().join(format!("luxfer-fuzz-{}", std::process::id()));
    let mut file = File::create(&path).expect("a file");
    // Gone however the process ends; it is reached by its descriptor.
    std::fs::remove_file(&path).expect("just made");
    file.write_all(data).and_then(|()| file.rewind()).expect("room on the disk");
    work(CString::new(format!("/proc/self/fd/{}", file.as_raw_fd())).expect("no zero in it").as_ptr())
}

/// An image in any format.
pub fn image(data: &[u8]) {
    let load =
        |out| unsafe { luxfer_image_load_memory(context(), data.as_ptr().cast(), data.len(), LUXFER_COLOUR_SRGB, out) };
    if let Some(image) = made("luxfer_image_load_memory", load) {
        unsafe { luxfer_release(image.cast()) };
    }
}

/// A scene: loaded, traced, asked what it needs, written again.
pub fn scene(data: &[u8]) {
    extern "C" fn take(_: *mut c_void, _: *const c_void, _: usize) -> i32 {
        0
    }
    let load = |out| unsafe { luxfer_scene_load_memory(context(), data.as_ptr().cast(), data.len(), null(), null(), out) };
    let Some(scene) = made("luxfer_scene_load_memory", load) else { return };
    let rays = [[0.0, -1.0, 0.1], [0.1, 0.0, -1.0]].map(|direction| luxfer_ray {
        origin: [0.01, 0.5, 0.02],
        direction,
        t_max: 1e9,
    });
    unsafe {
        let mut hits: [luxfer_hit; 2] = std::mem::zeroed();
        check("luxfer_scene_intersect", luxfer_scene_intersect(scene, rays.as_ptr(), 2, 0, hits.as_mut_ptr(), 0));
        let mut needs: luxfer_requirements = std::mem::zeroed();
        check("luxfer_scene_get_requirements", luxfer_scene_get_requirements(scene, 0.01, &mut needs, size_of_val(&needs)));
        check("luxfer_scene_export_memory", luxfer_scene_export_memory(scene, Some(take), null_mut()));
        luxfer_release(scene.cast());
    }
}

/// The light of a luminaire, in a LUXFER_DISTRIBUTION_ format.
pub fn distribution(data: &[u8], format: luxfer_distribution_format) {
    let load =
        |out| unsafe { luxfer_distribution_load_memory(context(), data.as_ptr().cast(), data.len(), format, out) };
    let Some(lamp) = made("luxfer_distribution_load_memory", load) else { return };
    unsafe {
        let mut intensity = 0.0;
        check("luxfer_distribution_get_intensity", luxfer_distribution_get_intensity(lamp, 0.3, 0.7, &mut intensity));
        luxfer_release(lamp.cast());
    }
}

/// A neural network, run on a small photo for a while.
pub fn network(data: &[u8]) {
    unsafe {
        let stage = made("luxfer_features_create", |out| luxfer_features_create(context(), out)).expect("a stage");
        let set = |path| luxfer_features_set_network(stage, path, LUXFER_NORMALISATION_BY_SIZE);
        if check("luxfer_features_set_network", as_file(data, set)) {
            let photo = photo();
            check("luxfer_features_set_photo", luxfer_features_set_photo(stage, photo));
            wait(made("luxfer_features_start", |out| luxfer_features_start(stage, null(), out)));
            luxfer_release(photo.cast());
        }
        luxfer_release(stage.cast());
    }
}

/// A light path expression, and a small rendering by it.
pub fn expression(data: &[u8]) {
    let Ok(text) = CString::new(data) else { return };
    unsafe {
        let stage = made("luxfer_render_create", |out| luxfer_render_create(context(), out)).expect("a stage");
        if check("luxfer_render_add_expression", luxfer_render_add_expression(stage, c"layer".as_ptr(), text.as_ptr()))
        {
            check("luxfer_render_set_scene", luxfer_render_set_scene(stage, demo()));
            wait(made("luxfer_render_start", |out| luxfer_render_start(stage, &small(), out)));
        }
        luxfer_release(stage.cast());
    }
}

/// Strokes as a text.
pub fn strokes(data: &[u8]) {
    let Ok(text) = CString::new(data) else { return };
    unsafe {
        let strokes = made("luxfer_strokes_create", |out| luxfer_strokes_create(context(), 48, 32, out)).expect("strokes");
        check("luxfer_strokes_add_text", luxfer_strokes_add_text(strokes, text.as_ptr()));
        luxfer_release(strokes.cast());
    }
}

/// The whole of a small rendering as its only part.
pub fn part(data: &[u8]) {
    unsafe {
        let stage = made("luxfer_render_create", |out| luxfer_render_create(context(), out)).expect("a stage");
        check("luxfer_render_set_scene", luxfer_render_set_scene(stage, demo()));
        as_file(data, |path| {
            if check("luxfer_render_add_part", luxfer_render_add_part(stage, path)) {
                wait(made("luxfer_render_start_merge", |out| luxfer_render_start_merge(stage, &small(), out)));
            }
        });
        luxfer_release(stage.cast());
    }
}

/// Waits for a job for a second, then lets go of it; how it ended must be a status.
unsafe fn wait(job: Option<*mut luxfer_job>) {
    if let Some(job) = job {
        unsafe {
            check("luxfer_job_wait", luxfer_job_wait(job, 1000, None, null_mut()));
            luxfer_release(job.cast());
        }
    }
}

/// As seeds.py has it.
fn small() -> luxfer_render_params {
    unsafe {
        let mut params: luxfer_render_params = std::mem::zeroed();
        luxfer_init(LUXFER_STRUCT_RENDER_PARAMS, (&raw mut params).cast(), size_of::<luxfer_render_params>());
        luxfer_render_params { width: 9, height: 5, samples: 4, ..params }
    }
}

fn photo() -> *mut luxfer_image {
    let mut pixels: Vec<f32> = (0..64 * 64 * 3).map(|i| (i % 7) as f32 / 7.0).collect();
    unsafe {
        let mut view: luxfer_image_view = std::mem::zeroed();
        luxfer_init(LUXFER_STRUCT_IMAGE_VIEW, (&raw mut view).cast(), size_of::<luxfer_image_view>());
        let (byte_size, data) = (size_of_val(&pixels[..]), pixels.as_mut_ptr().cast());
        let view = luxfer_image_view { width: 64, height: 64, byte_size, data, ..view };
        made("luxfer_image_create", |out| luxfer_image_create(context(), &view, out)).expect("an image")
    }
}
