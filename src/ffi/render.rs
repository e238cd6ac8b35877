//! Rendering
//!
//! A path tracer that renders a scene in cd/m². The image improves pass by pass. While the job runs, and after a
//! cancel, the current image can be read with an estimate of its error.

use super::context::luxfer_context;
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::image::{Pixels, luxfer_image};
use super::job::luxfer_job;
use super::params::{self, Report, Versioned, versioned};
use super::pointer::{Out, copy_text};
use super::scene::{SceneObject, luxfer_scene, missing};
use super::scene_parts::luxfer_camera_params;
use super::stage::{Stage, need};
use super::status::luxfer_status;
use crate::error::{Error, ErrorKind, Result, check_range};
use crate::image::Image;
use crate::job::Job;
use crate::render::{self, Film, Outputs, World, parts};
use crate::scene::{Camera, Scene};
use std::ffi::c_char;
use std::sync::Arc;

/// A rendering of a scene. See luxfer_render_create.
pub struct luxfer_render {
    _opaque: [u8; 0],
}

/// An image of a rendering: a LUXFER_RENDER_ value.
pub type luxfer_render_image = i32;
/// Mean radiance of each pixel, linear RGB in cd/m².
pub const LUXFER_RENDER_BEAUTY: luxfer_render_image = 0;
/// Variance of the mean radiance of each pixel; 3 channels, in (cd/m²)². Infinite where a pixel has fewer than two
/// paths. Blocks of eight neighbouring pixels share parts of their paths, so the errors of these pixels are correlated:
/// the variance of a sum over pixels is up to eight times the sum of their variances.
pub const LUXFER_RENDER_VARIANCE: luxfer_render_image = 1;
/// Number of paths of each pixel; 1 channel.
pub const LUXFER_RENDER_PATHS: luxfer_render_image = 2;
/// Half the width of the 95 % confidence interval of each pixel's radiance, in cd/m²; 3 channels; infinite where a
/// pixel has fewer than two paths.
pub const LUXFER_RENDER_INTERVAL: luxfer_render_image = 3;
/// The beauty image after a noise filter that follows the edges of the visible surfaces. The filter averages a pixel
/// with neighbours that differ from it by no more than the noise. A pixel keeps its unfiltered value if this value is
/// estimated to be more accurate than the filtered value. The filter never changes a pixel by more than three standard
/// errors. Details that come from the light alone, such as soft shadows, can be blurred;
/// luxfer_render_report.preview_error estimates the remaining error. The image exists only if
/// luxfer_render_params.preview is not 0.
pub const LUXFER_RENDER_PREVIEW: luxfer_render_image = 4;
/// Half the width of the 95 % interval of each pixel of the preview, in cd/m²; 3 channels. The interval includes the
/// bias of the filter. It is infinite where a pixel has fewer than four paths. Measured in rooms with 4 to 256 paths
/// per pixel, the intervals contain the true value of 93 % to 98 % of the pixels; along edges of surfaces, they contain
/// it less often. The image exists only if luxfer_render_params.preview is not 0.
pub const LUXFER_RENDER_PREVIEW_INTERVAL: luxfer_render_image = 5;

/// Settings of a rendering. Fill them with luxfer_render_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_render_params {
    /// sizeof(luxfer_render_params), set by luxfer_render_params_init.
    pub struct_size: u32,
    /// Width of the image in pixels, in [1, 65536]; default 1280.
    pub width: u32,
    /// Height of the image in pixels, in [1, 65536]; default 720.
    pub height: u32,
    /// Paths per pixel, in [1, 1048576]; default 64. With a target error, rendering stops at the latest when the mean
    /// number of paths per pixel reaches this value.
    pub samples: u32,
    /// Stop when luxfer_render_report.error is at most this value, >= 0. With this target, paths go to the pixels
    /// where they reduce the error most. Default 0: no target.
    pub target_error: f32,
    /// Stop after this number of milliseconds; default 0: no limit.
    pub time_budget_ms: u32,
    /// Seed of the paths; default 1.
    pub seed: u64,
    /// Stop when the relative error of every block of 8 x 8 pixels is at most this value, >= 0; 0.1 means within 10 %
    /// of the value, 19 times out of 20. Default 0: no target. A block receives at most 64 * samples paths per pixel
    /// (the field samples), even if it then misses the target.
    ///
    /// The relative error of a pixel is e / max(Y, m / 10). Here e is half the width of the 95 % confidence interval of
    /// the pixel's luminance Y, and m is the mean of the image. The relative error of a block is the root mean square
    /// over its pixels.
    pub pixel_error: f32,
    /// Must be 0.
    pub reserved: u32,
    /// Strength of the noise filter for LUXFER_RENDER_PREVIEW, in [0, 10]; 1 is usual, larger values blur more.
    /// Default 0: no preview, as for final images. The preview does not change the other images. After a cancel, a
    /// rendering with a preview keeps all images of the last preview, because one more preview would take too long.
    pub preview: f32,
    /// Stop when luxfer_render_report.relative_error is at most this value, >= 0. With this target, paths go to the
    /// pixels where they reduce this error most. In this error, noise in dark areas counts as much as noise in bright
    /// areas, as for the eye. Default 0: no target. With several targets, rendering stops when all targets are reached.
    pub relative_error: f32,
}

versioned!(luxfer_render_params, [48], { Self::of(&render::Params::default()) });

impl luxfer_render_params {
    pub(super) fn of(d: &render::Params) -> Self {
        Self {
            struct_size: 48,
            width: d.width as u32,
            height: d.height as u32,
            samples: d.samples,
            target_error: d.target_error,
            time_budget_ms: d.time_budget_ms,
            seed: d.seed,
            pixel_error: d.pixel_error,
            reserved: 0,
            preview: d.preview,
            relative_error: d.relative_error,
        }
    }

    pub(super) fn params(&self) -> Result<render::Params> {
        check_range("reserved", self.reserved, 0, 0)?;
        Ok(render::Params {
            width: self.width as usize,
            height: self.height as usize,
            samples: self.samples,
            target_error: self.target_error,
            pixel_error: self.pixel_error,
            time_budget_ms: self.time_budget_ms,
            preview: self.preview,
            relative_error: self.relative_error,
            seed: self.seed,
            ..render::Params::default()
        })
    }
}

/// Quality of a rendering.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_render_report {
    /// sizeof(luxfer_render_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Mean number of paths per pixel so far.
    pub samples: u32,
    /// Root mean square of the standard errors of all pixels, divided by the image's mean; infinite while a pixel has
    /// fewer than two paths.
    pub error: f64,
    /// Number of paths that were discarded because their radiance was not finite.
    pub discarded: u64,
    /// Estimated bias of the preview. The bias of a block of 8 x 8 pixels is the expected value of the block's mean
    /// minus its true mean. This field is the root mean square of the bias over all blocks, divided by the image's
    /// mean. 0 without a preview.
    pub preview_bias: f64,
    /// Root mean square, over all pixels, of the standard error divided by the pixel's value. The value is the mean of
    /// the pixel's channels, but at least a hundredth of the image's mean. Infinite while a pixel has fewer than two
    /// paths. With few paths this estimate is too high: with 8 paths by about a quarter.
    pub relative_error: f64,
    /// Estimated error of the preview, remaining noise and bias together: root mean square over pixels and channels,
    /// divided by the image's mean. Compare it with the field error, the error of the unfiltered image. Infinite
    /// while a pixel has fewer than four paths; 0 without a preview.
    pub preview_error: f64,
}

versioned!(luxfer_render_report, [40, 48], {
    Self {
        struct_size: 48,
        samples: 0,
        error: 0.0,
        discarded: 0,
        preview_bias: 0.0,
        relative_error: 0.0,
        preview_error: 0.0,
    }
});

#[derive(Clone, Default)]
pub(super) struct Inputs {
    scene: Option<Arc<SceneObject>>,
    /// Camera that the caller has set; `None`: the first camera of the scene.
    camera: Option<Camera>,
    pub(super) outputs: Outputs,
    /// Files with parts of this rendering, which the caller has added for a merge.
    pub(super) parts: Vec<parts::File>,
}

impl Inputs {
    /// Returns the scene object, a snapshot of the scene as it is now, and the camera.
    pub(super) fn view(&self) -> Result<(Arc<SceneObject>, Arc<Scene>, Camera)> {
        let object = need(&self.scene, "luxfer_render_set_scene")?.clone();
        let scene = object.snapshot();
        let camera = match &self.camera {
            Some(camera) => camera.clone(),
            None => scene.cameras.first().cloned().ok_or_else(|| missing("camera", 0, 0))?,
        };
        Ok((object, scene, camera))
    }

    /// Returns a snapshot of a rendering's inputs: scene, camera and settings. `params` may be NULL for the defaults.
    pub(super) fn snapshot(&self, params: *const luxfer_render_params) -> Result<RenderSnapshot> {
        let (object, scene, camera) = self.view()?;
        let params = render::Params { outputs: self.outputs.clone(), ..params::read(params)?.params()? };
        Ok(RenderSnapshot { object, scene, camera, params })
    }
}

/// The inputs of a rendering as they are at the start of its job; later changes do not affect them.
pub(super) struct RenderSnapshot {
    object: Arc<SceneObject>,
    scene: Arc<Scene>,
    pub(super) camera: Camera,
    pub(super) params: render::Params,
}

impl RenderSnapshot {
    /// Returns the scene prepared for tracing.
    pub(super) fn world(&self, job: Job) -> Result<Arc<World>> {
        self.object.world(&self.scene, job)
    }
}

impl Handle for luxfer_render {
    type Object = Stage<Inputs, Film>;
    const TAG: u64 = tag(b"lux.rend");
    const NAME: &'static str = "luxfer_render";
}

/// Creates a rendering. It has no inputs yet. The caller releases *render. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_create(
    context: *mut luxfer_context,
    render: *mut *mut luxfer_render,
) -> luxfer_status {
    enter(context, |object| {
        Out::new(render, "render")?.set(handle::give(Stage::new(object.context(), Inputs::default())));
        Ok(())
    })
}

/// Sets the scene; each job renders the scene as it is when the job starts. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_set_scene(
    render: *mut luxfer_render,
    scene: *mut luxfer_scene,
) -> luxfer_status {
    enter(render, |stage| {
        let scene = handle::borrow_in(stage.context(), scene, "scene")?;
        stage.change(|inputs| {
            inputs.scene = Some(scene);
            Ok(())
        })
    })
}

/// Sets the camera. camera may be a struct that luxfer_scene_get_camera has filled, or NULL, the default: the first
/// camera of the scene. Any thread.
/// LUXFER_INVALID_ARGUMENT if a value of camera is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_set_camera(
    render: *mut luxfer_render,
    camera: *const luxfer_camera_params,
) -> luxfer_status {
    enter(render, |stage| {
        let camera = if camera.is_null() { None } else { Some(params::read_required(camera)?.camera()?) };
        stage.change(|inputs| {
            inputs.camera = camera;
            Ok(())
        })
    })
}

/// Starts a job that renders the scene. params may be NULL for the defaults. The caller releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if the scene is missing or a job is already running; LUXFER_NOT_FOUND if no camera is set
/// and the scene has no camera. The job may end with LUXFER_INVALID_ARGUMENT if the scene is not valid or a setting is
/// out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_start(
    render: *mut luxfer_render,
    params: *const luxfer_render_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(render, |stage| {
        let snapshot = stage.inputs().snapshot(params)?;
        stage.start(job, move |_, stage, job| {
            let world = snapshot.world(job.part(0.0, 0.05))?;
            render::run(&world, &snapshot.camera, &snapshot.params, job.part(0.05, 1.0), &mut |film| {
                // If memory is short, the job skips this intermediate image.
                if let Ok(copy) = film.try_clone() {
                    stage.publish(copy);
                }
            })
        })
    })
}

/// Returns the function that picks the preview from a film; an error if the rendering has no preview.
pub(super) fn preview(film: &Film) -> Result<fn(&Film) -> &Image> {
    if film.preview.is_none() {
        let message = "the rendering has no preview: start it with luxfer_render_params.preview above 0";
        return Err(Error::new(ErrorKind::NotFound, message));
    }
    Ok(|film| film.preview.as_ref().map_or(&film.beauty, |preview| &preview.image))
}

/// Gets the image of the rendering that kind, a LUXFER_RENDER_ value, selects, in its current state. The caller
/// releases *image. Any thread.
/// LUXFER_NOT_READY before the first pass of a job; LUXFER_NOT_FOUND for a preview if luxfer_render_params.preview was
/// 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_get_image(
    render: *mut luxfer_render,
    kind: luxfer_render_image,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(render, |stage| {
        let out = Out::new(image, "image")?;
        let pick: fn(&Film) -> &Image = match kind {
            LUXFER_RENDER_BEAUTY => |f| &f.beauty,
            LUXFER_RENDER_VARIANCE => |f| &f.variance,
            LUXFER_RENDER_PATHS => |f| &f.paths,
            LUXFER_RENDER_PREVIEW => preview(&*stage.output()?)?,
            LUXFER_RENDER_PREVIEW_INTERVAL => {
                preview(&*stage.output()?)?;
                |f| f.preview.as_ref().map_or(&f.variance, |preview| &preview.interval)
            }
            LUXFER_RENDER_INTERVAL => {
                let (context, film) = (stage.context(), stage.output()?);
                let (width, height) = (film.beauty.width, film.beauty.height);
                let monitor = context.monitor();
                let make = || context.quick.run(|| film.interval(monitor.job()));
                out.set(handle::give(Pixels::counted(context, width, height, 3, make)?));
                return Ok(());
            }
            _ => return Err(Error::argument(format!("kind is {kind}; it must be a LUXFER_RENDER_ value"))),
        };
        let film = stage.output()?;
        let unseen_lights = film.unseen_lights;
        out.set(handle::give(Pixels::rendered(stage.context(), film, pick, unseen_lights)));
        Ok(())
    })
}

/// Describes in words what the rendering skips in its scene. In addition to the contents of
/// luxfer_scene_get_requirements_text, the text tells how many lamps of the scene are hidden, for example by walls,
/// from all surfaces that the paths of the image reach. The rendering learns from its first paths which lamps are
/// hidden. Later paths hardly ever sample these lamps, which does not change the expected image. Any thread.
///
/// The text has one sentence per line and is zero-terminated UTF-8, truncated to capacity bytes including the zero.
/// *needed, unless NULL, receives the capacity that the whole text needs. buffer may be NULL if capacity is 0.
/// LUXFER_NOT_READY before the first pass of a job.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_get_requirements_text(
    render: *mut luxfer_render,
    buffer: *mut c_char,
    capacity: usize,
    needed: *mut usize,
) -> luxfer_status {
    enter(render, |stage| {
        let output = stage.output()?;
        copy_text(&output.requirements.join("\n"), buffer, capacity, needed)
    })
}

/// Gets the current quality of the rendering. size is sizeof *report. Any thread.
/// LUXFER_NOT_READY before the first pass of a job.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_render_get_report(
    render: *mut luxfer_render,
    report: *mut luxfer_render_report,
    size: usize,
) -> luxfer_status {
    enter(render, |stage| {
        let out = Report::new(report, size)?;
        let output = stage.output()?;
        out.set(luxfer_render_report {
            samples: output.samples,
            error: output.error,
            discarded: output.discarded,
            preview_bias: output.preview.as_ref().map_or(0.0, |p| p.bias),
            relative_error: output.relative_error,
            preview_error: output.preview.as_ref().map_or(0.0, |p| p.error),
            ..luxfer_render_report::defaults()
        });
        Ok(())
    })
}
