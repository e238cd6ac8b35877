//! The functions of the fuzz targets. They call only the public C ABI, as a host does. What they load,
//! they also use.
//!
//! A target fails if a call returns LUXFER_INTERNAL or LUXFER_UNKNOWN, or if anything panics: libFuzzer ends the
//! process even where the library would catch the panic.

mod calls;

pub use calls::calls;

use luxfer::ffi::*;
use std::ffi::{CString, c_char, c_void};
use std::fs::File;
use std::io::{Seek, Write};
use std::os::fd::AsRawFd;
use std::ptr::{null, null_mut};
use std::sync::LazyLock;

/// Memory budget of the context, for pixels, meshes and textures of an input, in MiB. tests/fuzz.sh allows single
/// allocations of twice this size.
const BUDGET: u64 = 64;

/// Returns whether a call succeeded. Panics if it returned a status that no call may return.
fn check(name: &str, status: luxfer_status) -> bool {
    let is_known = (LUXFER_OK..=LUXFER_UNREACHABLE).contains(&status);
    assert!(is_known && status != LUXFER_INTERNAL && status != LUXFER_UNKNOWN, "{name} returned {status}");
    status == LUXFER_OK
}

/// Creates an object by `make`, which writes the handle to its argument. Panics unless the handle is non-null exactly
/// if the call succeeds.
fn made<T>(name: &str, make: impl FnOnce(*mut *mut T) -> luxfer_status) -> Option<*mut T> {
    let mut thing = null_mut();
    let succeeded = check(name, make(&mut thing));
    assert_eq!(succeeded, !thing.is_null(), "{name}: its handle and its status");
    succeeded.then_some(thing)
}

/// A handle that all inputs share; any thread may use it.
struct Shared<T>(*mut T);
// SAFETY: the header allows handles to be used on any thread.
unsafe impl<T> Send for Shared<T> {}
unsafe impl<T> Sync for Shared<T> {}

/// The context of all inputs, with one thread. It is shared so that an input can reveal damage done by an earlier one.
fn context() -> *mut luxfer_context {
    static CONTEXT: LazyLock<Shared<luxfer_context>> = LazyLock::new(|| {
        let params = luxfer_context_params { struct_size: 16, num_threads: 1, memory_budget_mib: BUDGET };
        // SAFETY (here and in all calls below): every pointer is to live memory of this program or a valid handle.
        Shared(made("luxfer_context_create", |out| unsafe { luxfer_context_create(&params, out) }).expect("a context"))
    });
    CONTEXT.0
}

/// The scene to render; seeds.py uses the same one.
fn demo() -> *mut luxfer_scene {
    static SCENE: LazyLock<Shared<luxfer_scene>> = LazyLock::new(|| {
        let make = |out| unsafe { luxfer_demo_create_scene(context(), LUXFER_DEMO_SPHERE_ON_TABLE, out) };
        Shared(made("luxfer_demo_create_scene", make).expect("a scene"))
    });
    SCENE.0
}

/// Writes the bytes to a file and calls `work` with its path.
fn as_file<R>(data: &[u8], work: impl FnOnce(*const c_char) -> R) -> R {
    let path = std::env::temp_dir().join(format!("luxfer-fuzz-{}", std::process::id()));
    let mut file = File::create(&path).expect("a file");
    // Remove the file's name at once, so that no file is left however the process ends. /proc still leads to it.
    std::fs::remove_file(&path).expect("just made");
    file.write_all(data).and_then(|()| file.rewind()).expect("room on the disk");
    work(CString::new(format!("/proc/self/fd/{}", file.as_raw_fd())).expect("no zero in it").as_ptr())
}

/// Loads an image in any format.
pub fn image(data: &[u8]) {
    let load =
        |out| unsafe { luxfer_image_load_memory(context(), data.as_ptr().cast(), data.len(), LUXFER_COLOUR_SRGB, out) };
    if let Some(image) = made("luxfer_image_load_memory", load) {
        unsafe { luxfer_release(image.cast()) };
    }
}

/// Loads a scene, traces rays in it, computes its requirements, and exports it.
pub fn scene(data: &[u8]) {
    extern "C" fn take(_: *mut c_void, _: *const c_void, _: usize) -> i32 {
        0
    }
    let load =
        |out| unsafe { luxfer_scene_load_memory(context(), data.as_ptr().cast(), data.len(), null(), null(), out) };
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
        check(
            "luxfer_scene_get_requirements",
            luxfer_scene_get_requirements(scene, 0.01, &mut needs, size_of_val(&needs)),
        );
        check("luxfer_scene_export_memory", luxfer_scene_export_memory(scene, Some(take), null_mut()));
        luxfer_release(scene.cast());
    }
}

/// Loads the light distribution of a luminaire; `format` is a LUXFER_DISTRIBUTION_ constant.
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

/// Loads a neural network and runs it on a small photo for at most a second.
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

/// Parses a light path expression and renders a small layer with it.
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

/// Parses strokes from a text.
pub fn strokes(data: &[u8]) {
    let Ok(text) = CString::new(data) else { return };
    unsafe {
        let strokes =
            made("luxfer_strokes_create", |out| luxfer_strokes_create(context(), 48, 32, out)).expect("strokes");
        check("luxfer_strokes_add_text", luxfer_strokes_add_text(strokes, text.as_ptr()));
        luxfer_release(strokes.cast());
    }
}

/// Merges a rendering from a file that claims to be its only part.
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

/// Waits for a job for at most a second, checks its outcome, and releases the job.
unsafe fn wait(job: Option<*mut luxfer_job>) {
    if let Some(job) = job {
        unsafe {
            let mut outcome = 0;
            check("luxfer_job_wait", luxfer_job_wait(job, 1000, None, null_mut(), &mut outcome));
            check("the job", outcome);
            luxfer_release(job.cast());
        }
    }
}

/// Settings of a small rendering; seeds.py uses the same ones.
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
