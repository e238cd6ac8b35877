//! Transfer
//!
//! The lighting transfer from end to end: lights a scene as in a photo, from the photo and a few strokes. It runs its
//! stages one after the other. You can read every result as soon as its stage has ended, replace it by a result of
//! your own, and continue from any stage.
//!
//! stages.h and render.h declare the structs of single stages. Include them, or luxfer.h, to change the settings of a
//! stage (luxfer_transfer_params), to read luxfer_rectify_report or luxfer_relight_report, or to run a stage alone.

use super::context::luxfer_context;
use super::depth::{depth_kind, luxfer_depth_kind};
use super::emission::luxfer_emission_params;
use super::features::{luxfer_features, luxfer_features_params};
use super::geometry::list;
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::image::{Pixels, luxfer_image};
use super::job::luxfer_job;
use super::params::{self, versioned};
use super::pattern::luxfer_pattern_params;
use super::pointer::{Out, bytes, text};
use super::rectify::{luxfer_rectify, luxfer_rectify_params};
use super::relight::luxfer_relight_params;
use super::render::luxfer_render_params;
use super::scene::{SceneObject, luxfer_scene};
use super::scene_parts::luxfer_camera_params;
use super::segment::{luxfer_segment, luxfer_segment_params};
use super::stage::{Stage as Runner, claim_all};
use super::status::luxfer_status;
use super::strokes::{LUXFER_PHASE_LIGHTS, LUXFER_PHASE_PLANE, Painted, luxfer_phase, luxfer_strokes, unknown_phase};
use crate::error::{Error, Result};
use crate::features::DepthKind;
use crate::image::photo::PhotoMetadata;
use crate::scene::Camera;
use crate::segment::{self, Segmentation, StrokeSet};
use crate::transfer::{self, Results, STAGES, Stage, TargetColour, Transfer};
use glam::DVec4;
use std::ffi::c_char;
use std::sync::Arc;

/// A lighting transfer. See luxfer_transfer_create.
pub struct luxfer_transfer {
    _opaque: [u8; 0],
}

/// A stage of the transfer: a LUXFER_STAGE_ value. The stages run in the order of their values.
pub type luxfer_stage = i32;
/// No stage of a transfer, but a stylisation or its guides: occurs only in warnings.
pub const LUXFER_STAGE_STYLIZE: luxfer_stage = -2;
/// No stage, but a luxfer_scene: occurs only in warnings.
pub const LUXFER_STAGE_SCENE: luxfer_stage = -1;
/// Finds lines, vanishing points and the camera of the photo.
pub const LUXFER_STAGE_VIEW: luxfer_stage = 0;
/// Computes the ten feature channels of each pixel of the photo.
pub const LUXFER_STAGE_FEATURES: luxfer_stage = 1;
/// Segments the plane that carries the lights.
pub const LUXFER_STAGE_PLANE: luxfer_stage = 2;
/// Segments the lights on the plane.
pub const LUXFER_STAGE_LIGHTS: luxfer_stage = 3;
/// Unwarps the plane to a frontal view.
pub const LUXFER_STAGE_UNWARP: luxfer_stage = 4;
/// Synthesises the emissive texture and maps it onto the scene's surface.
pub const LUXFER_STAGE_EMISSION: luxfer_stage = 5;
/// Solves for the colour and intensity of the emission.
pub const LUXFER_STAGE_RELIGHT: luxfer_stage = 6;
/// Renders the scene in its new light.
pub const LUXFER_STAGE_RENDER: luxfer_stage = 7;

/// The part of the photo whose mean colour is matched: a LUXFER_TARGET_ value.
pub type luxfer_target = i32;
/// The plane that carries the lights, without the lights and their halo.
pub const LUXFER_TARGET_SURFACE: luxfer_target = 0;
/// The whole photo.
pub const LUXFER_TARGET_WHOLE_IMAGE: luxfer_target = 1;

/// Settings of a transfer. Fill them with luxfer_transfer_params_init. The library reads the structs to which the
/// pointers lead only during the call that gets the settings.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_transfer_params {
    /// sizeof(luxfer_transfer_params), set by luxfer_transfer_params_init.
    pub struct_size: u32,
    /// Maximum length of the longer side of the emissive texture in texels, in [1, 16384]; default 2048.
    pub max_texels: u32,
    /// Distance in metres of the photo's camera from the plane with the lights, in [0.01, 1e4]. With
    /// LUXFER_PATTERN_DISTANCE, it sets the scale of the pattern. 0, the default: estimated from the size of the lamps,
    /// which are mostly made to fit ceiling tiles. luxfer_transfer_report states the distance and its error.
    pub plane_distance: f64,
    /// Luminance in cd/m² of the photo's white (value 1), in [1e-6, 1e9]; default 100, the luminance of matt white
    /// paper in 314 lux. The strength of the lamps is proportional to it. A photo alone does not determine this
    /// luminance: see proposed_white of luxfer_transfer_report.
    pub white_luminance: f32,
    /// Part of the photo whose mean colour is matched: a LUXFER_TARGET_ value; default LUXFER_TARGET_SURFACE.
    pub target: luxfer_target,
    /// Settings of the stages VIEW and UNWARP; NULL, the default: the defaults of luxfer_rectify_params.
    pub rectify: *const luxfer_rectify_params,
    /// Settings of the stage FEATURES; NULL, the default: the defaults of luxfer_features_params.
    pub features: *const luxfer_features_params,
    /// Settings of the stage PLANE; NULL, the default: the defaults of luxfer_segment_params.
    pub plane: *const luxfer_segment_params,
    /// Settings of the stage LIGHTS; NULL, the default: the defaults of luxfer_segment_params, but channels = 7,
    /// colour only.
    pub lights: *const luxfer_segment_params,
    /// Settings of the stage EMISSION; NULL, the default: the defaults of luxfer_emission_params. The transfer sets
    /// width, height, scale and offset itself.
    pub emission: *const luxfer_emission_params,
    /// Settings of the stage RELIGHT; NULL, the default: the defaults of luxfer_relight_params.
    pub relight: *const luxfer_relight_params,
    /// Settings of the stage RENDER; NULL, the default: the defaults of luxfer_render_params.
    pub render: *const luxfer_render_params,
    /// Layout of the lights on the surface; NULL, the default: the defaults of luxfer_pattern_params.
    pub pattern: *const luxfer_pattern_params,
}

const PARAMS_SIZE: usize = 24 + 8 * size_of::<usize>();

versioned!(luxfer_transfer_params, [PARAMS_SIZE], {
    let d = transfer::Params::default();
    Self {
        struct_size: PARAMS_SIZE as u32,
        max_texels: d.max_texels as u32,
        plane_distance: d.plane_distance,
        white_luminance: d.white_luminance,
        target: LUXFER_TARGET_SURFACE,
        rectify: std::ptr::null(),
        features: std::ptr::null(),
        plane: std::ptr::null(),
        lights: std::ptr::null(),
        emission: std::ptr::null(),
        relight: std::ptr::null(),
        render: std::ptr::null(),
        pattern: std::ptr::null(),
    }
});

impl luxfer_transfer_params {
    fn params(&self) -> Result<transfer::Params> {
        let target = match self.target {
            LUXFER_TARGET_SURFACE => TargetColour::Surface,
            LUXFER_TARGET_WHOLE_IMAGE => TargetColour::WholeImage,
            other => return Err(Error::argument(format!("target is {other}; it must be a LUXFER_TARGET_ value"))),
        };
        let (rectify, unwarp) = params::read(self.rectify)?.params()?;
        Ok(transfer::Params {
            rectify,
            unwarp,
            features: params::read(self.features)?.params(),
            plane: params::read(self.plane)?.params()?,
            lights: if self.lights.is_null() {
                segment::Params::for_lights()
            } else {
                params::read_required(self.lights)?.params()?
            },
            emission: params::read(self.emission)?.params()?,
            pattern: params::read(self.pattern)?.pattern()?,
            plane_distance: self.plane_distance,
            max_texels: self.max_texels as usize,
            target,
            white_luminance: self.white_luminance,
            relight: params::read(self.relight)?.params()?,
            render: params::read(self.render)?.params()?,
        })
    }
}

#[derive(Clone, Default)]
pub(super) struct Inputs {
    photo: Option<Arc<Pixels>>,
    depth: Option<(Arc<Pixels>, DepthKind)>,
    strokes: Painted<StrokeSet>,
    texture: Option<Arc<Pixels>>,
    scene: Option<Arc<SceneObject>>,
    surface: String,
    triangles: Vec<(usize, usize)>,
    zones: Vec<DVec4>,
    camera: Option<Camera>,
}

impl Inputs {
    /// The metadata of the photo's file.
    pub(super) fn photo_metadata(&self) -> Option<&PhotoMetadata> {
        self.photo.as_ref().map(|photo| photo.metadata())
    }

    pub(super) fn strokes(&self) -> &StrokeSet {
        &self.strokes.taken
    }

    /// Returns the inputs in the form that the transfer takes.
    fn input(&self) -> Result<transfer::Input> {
        let depth = match &self.depth {
            Some((depth, kind)) => Some((depth.shared()?, *kind)),
            None => None,
        };
        Ok(transfer::Input {
            photo: self.photo.as_ref().map(|photo| photo.shared()).transpose()?,
            photo_focal: self.photo.as_ref().and_then(|photo| photo.metadata().expected_focal()),
            depth,
            strokes: self.strokes.taken.clone(),
            texture: self.texture.as_ref().map(|texture| texture.shared()).transpose()?,
            scene: self.scene.as_ref().map(|scene| scene.snapshot()),
            surface: self.surface.clone(),
            triangles: self.triangles.clone(),
            zones: self.zones.clone(),
            camera: self.camera.clone(),
        })
    }
}

impl Handle for luxfer_transfer {
    type Object = Runner<Inputs, Results>;
    const TAG: u64 = tag(b"lux.tran");
    const NAME: &'static str = "luxfer_transfer";
}

fn stage_of(name: &str, value: luxfer_stage) -> Result<Stage> {
    let found = usize::try_from(value).ok().and_then(|i| STAGES.get(i)).copied();
    found.ok_or_else(|| Error::argument(format!("{name} is {value}; it must be a LUXFER_STAGE_ value")))
}

/// Creates a transfer. It has no inputs yet. The caller releases *transfer. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_create(
    context: *mut luxfer_context,
    transfer: *mut *mut luxfer_transfer,
) -> luxfer_status {
    enter(context, |object| {
        Out::new(transfer, "transfer")?.set(handle::give(Runner::new(object.context(), Inputs::default())));
        Ok(())
    })
}

/// Sets the photo: linear RGB, 1 = display white. Strokes for a photo of another size are removed. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_set_photo(
    transfer: *mut luxfer_transfer,
    photo: *mut luxfer_image,
) -> luxfer_status {
    enter(transfer, |stage| {
        let photo = handle::borrow_in(stage.context(), photo, "photo")?;
        stage.change(|inputs| {
            inputs.strokes.keep_for(photo.size());
            inputs.photo = Some(photo);
            Ok(())
        })
    })
}

/// Sets a depth map of the photo; kind is a LUXFER_DEPTH_ value. depth may be NULL: no depth map. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_set_depth(
    transfer: *mut luxfer_transfer,
    depth: *mut luxfer_image,
    kind: luxfer_depth_kind,
) -> luxfer_status {
    enter(transfer, |stage| {
        let kind = depth_kind(kind)?;
        let depth = Pixels::optional(stage.context(), depth, "depth")?;
        stage.change(|inputs| {
            inputs.depth = depth.map(|depth| (depth, kind));
            Ok(())
        })
    })
}

/// Sets the scene to light, and the name (UTF-8) of the object or material whose surface receives the lights. The
/// transfer never changes the scene; each job uses the scene as it is when the job starts. Any thread.
///
/// If the object or material has triangles in several planes, the transfer takes the plane from which most of the room
/// is visible. The parts of this plane, for example between the beams of a ceiling, share one pattern that continues
/// from part to part. Triangles in other planes stay unchanged; light them by another transfer with its own pattern.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_set_scene(
    transfer: *mut luxfer_transfer,
    scene: *mut luxfer_scene,
    surface: *const c_char,
) -> luxfer_status {
    enter(transfer, |stage| {
        let scene = handle::borrow_in(stage.context(), scene, "scene")?;
        let surface = text(surface, "surface")?.to_string();
        stage.change(|inputs| {
            inputs.scene = Some(scene);
            inputs.surface = surface;
            inputs.triangles = Vec::new();
            Ok(())
        })
    })
}

/// Sets the triangles of the scene that receive the lights, instead of the named surface. The array triangles holds the
/// mesh index and the triangle index of each of count triangles. If the triangles lie in several planes, the transfer
/// takes the plane from which most of the room is visible, as for a named surface. These triangles replace the
/// triangles of an earlier call, and luxfer_transfer_set_scene removes them. If count is 0, triangles may be NULL, and
/// the named surface receives the lights again. Any thread.
/// A job ends with LUXFER_INVALID_ARGUMENT if the scene does not have these triangles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_set_triangles(
    transfer: *mut luxfer_transfer,
    triangles: *const u32,
    count: usize,
) -> luxfer_status {
    enter(transfer, |stage| {
        let size = count.saturating_mul(2 * size_of::<u32>());
        let raw = if count == 0 { &[] } else { bytes(triangles.cast(), size, "triangles")? };
        let index = |raw: &[u8]| u32::from_ne_bytes([raw[0], raw[1], raw[2], raw[3]]) as usize;
        let triangles = raw.chunks_exact(8).map(|pair| (index(&pair[..4]), index(&pair[4..]))).collect();
        stage.change(|inputs| {
            inputs.triangles = triangles;
            Ok(())
        })
    })
}

/// Sets an emissive texture: linear RGB, where 1 is the photo's white. The stage EMISSION then stretches it over the
/// surface instead of making a texture from the photo. Its values must be finite and >= 0, or else the job ends with
/// LUXFER_INVALID_ARGUMENT. texture may be NULL, the default: a texture is made from the photo. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_set_texture(
    transfer: *mut luxfer_transfer,
    texture: *mut luxfer_image,
) -> luxfer_status {
    enter(transfer, |stage| {
        let texture = Pixels::optional(stage.context(), texture, "texture")?;
        stage.change(|inputs| {
            inputs.texture = texture;
            Ok(())
        })
    })
}

/// Sets the camera of the rendered picture. camera may be NULL, the default: the first camera of the scene, or a camera
/// in a corner of the room if the scene has no camera. Any thread.
/// LUXFER_INVALID_ARGUMENT if a value of camera is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_set_camera(
    transfer: *mut luxfer_transfer,
    camera: *const luxfer_camera_params,
) -> luxfer_status {
    enter(transfer, |stage| {
        let camera = if camera.is_null() { None } else { Some(params::read_required(camera)?.camera()?) };
        stage.change(|inputs| {
            inputs.camera = camera;
            Ok(())
        })
    })
}

/// Sets the strokes on the photo, for the mask of the plane and the mask of the lights. Strokes on lights count as
/// strokes on the plane too. Strokes for the plane serve as negative strokes for the lights, except where they cross
/// lights. The call copies the strokes, which replace earlier strokes; strokes may be NULL: no strokes. Any thread.
/// LUXFER_INVALID_ARGUMENT if the strokes are for images of another size than the photo.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_set_strokes(
    transfer: *mut luxfer_transfer,
    strokes: *mut luxfer_strokes,
) -> luxfer_status {
    enter(transfer, |stage| {
        let strokes = Painted::copy(stage.context(), strokes, |set| Ok(set.clone()))?;
        stage.change(|inputs| {
            strokes.check_size(inputs.photo.as_ref().map(|photo| photo.size()), "the photo")?;
            inputs.strokes = strokes;
            Ok(())
        })
    })
}

/// Sets rectangles of the surface that stay without lamps, for example at ducts and sprinklers. The array zones holds
/// u0, v0, u1 and v1 of each of count rectangles, in metres from the surface's corner along its axes (luxfer_surface),
/// with u0 <= u1 and v0 <= v1. The rectangles replace earlier rectangles; zones may be NULL if count is 0. Any thread.
/// LUXFER_INVALID_ARGUMENT if a number is not finite, or u0 > u1 or v0 > v1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_set_zones(
    transfer: *mut luxfer_transfer,
    zones: *const f64,
    count: usize,
) -> luxfer_status {
    enter(transfer, |stage| {
        let numbers = if count == 0 { Vec::new() } else { list(zones, count.saturating_mul(4), "zones")? };
        let zones: Vec<DVec4> = numbers.chunks_exact(4).map(DVec4::from_slice).collect();
        transfer::check_zones(&zones)?;
        stage.change(|inputs| {
            inputs.zones = zones;
            Ok(())
        })
    })
}

/// Replaces the result of the stage VIEW by the lines and the camera of a luxfer_rectify. If that object has unwarped
/// a plane, this plane replaces the result of the stage UNWARP. The transfer then keeps this camera, even if the
/// photo's lamps suggest another camera. Any thread.
/// LUXFER_NOT_READY if rectify has no result yet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_use_rectify(
    transfer: *mut luxfer_transfer,
    rectify: *mut luxfer_rectify,
) -> luxfer_status {
    enter(transfer, |stage| {
        let found = handle::borrow_in(stage.context(), rectify, "rectify")?.output()?;
        stage.replace(|results| {
            results.view = Some(found.view.clone());
            (results.view_by_lines, results.view_is_given) = (None, true);
            if found.unwarped.is_some() {
                results.unwarped.clone_from(&found.unwarped);
            }
        })
    })
}

/// Replaces the result of the stage FEATURES by the result of a luxfer_features. Any thread.
/// LUXFER_NOT_READY if features has no result yet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_use_features(
    transfer: *mut luxfer_transfer,
    features: *mut luxfer_features,
) -> luxfer_status {
    enter(transfer, |stage| {
        let found = handle::borrow_in(stage.context(), features, "features")?.output()?.features.clone();
        stage.replace(|results| results.features = Some(found))
    })
}

/// Replaces the result of the stage PLANE or LIGHTS by the result of a luxfer_segment; phase, a LUXFER_PHASE_ value,
/// chooses the stage. Any thread.
/// LUXFER_NOT_READY if segment has no result yet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_use_segment(
    transfer: *mut luxfer_transfer,
    phase: luxfer_phase,
    segment: *mut luxfer_segment,
) -> luxfer_status {
    enter(transfer, |stage| {
        let found = handle::borrow_in(stage.context(), segment, "segment")?.output()?;
        use_segmentation(stage, phase, found)
    })
}

/// Replaces the result of the stage PLANE or LIGHTS by a mask of the photo's size, for example a mask drawn by hand;
/// phase, a LUXFER_PHASE_ value, chooses the stage. The mask has 1 channel, whose values are used as confidences in [0,
/// 1]. Any thread.
/// LUXFER_INVALID_ARGUMENT if the mask has more channels, or a value outside [0, 1].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_use_mask(
    transfer: *mut luxfer_transfer,
    phase: luxfer_phase,
    mask: *mut luxfer_image,
) -> luxfer_status {
    enter(transfer, |stage| {
        let mask = handle::borrow_in(stage.context(), mask, "mask")?;
        use_segmentation(stage, phase, Arc::new(Segmentation::from_confidence(mask.image())?))
    })
}

fn use_segmentation(
    stage: &Runner<Inputs, Results>,
    phase: luxfer_phase,
    segmentation: Arc<Segmentation>,
) -> Result<()> {
    match phase {
        LUXFER_PHASE_PLANE => stage.replace(|results| results.plane = Some(segmentation)),
        LUXFER_PHASE_LIGHTS => stage.replace(|results| results.lights = Some(segmentation)),
        _ => Err(unknown_phase(phase)),
    }
}

/// Starts a job that runs all stages from the stage first to the stage last, LUXFER_STAGE_ values, both included.
/// Results of earlier stages that these stages use must exist, from an earlier job or from a luxfer_transfer_use_
/// function. Stages that have ended keep their results even if the job fails. params may be NULL for the defaults. The
/// caller releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if a job is already running, or if an input or the result of an earlier stage is missing;
/// LUXFER_INVALID_ARGUMENT if a setting of a stage is out of range. The job may end with any status with which a stage
/// may end; the message names the stage. If EMISSION is one of the stages and the scene lacks the surface, the job ends
/// before the first stage.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_start(
    transfer: *mut luxfer_transfer,
    first: luxfer_stage,
    last: luxfer_stage,
    params: *const luxfer_transfer_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(transfer, |stage| {
        let (first, last) = (stage_of("first", first)?, stage_of("last", last)?);
        let mut transfer = snapshot(stage, params::read(params)?)?;
        transfer.check(first, last)?;
        stage.start(job, move |_, stage, job| {
            transfer.run(first, last, job, |results| stage.publish(results.clone()))?;
            Ok(transfer.results)
        })
    })
}

/// Starts a job that runs the stages first to last of several transfers, one for each plane with lights that the photo
/// shows, such as a ceiling and a wall with sconces, or two levels of a ceiling. transfers holds count handles, in [1,
/// 16], each at most once; params holds count pointers to settings, each of which may be NULL for the defaults, or is
/// NULL for the defaults of all. The transfers must have the same photo and the same scene; each has strokes, a
/// surface, and other inputs of its own. With one transfer, the job is that of luxfer_transfer_start. The results do
/// not depend on the order of the transfers. The caller releases *job. Any thread.
///
/// The stages VIEW and FEATURES run once for all transfers whose settings and inputs for them are equal, so that there
/// is one camera and one layout of the room: the layout with which the strokes of all planes agree best. Masks,
/// unwarped image, texture, warnings and reports are those of each transfer; seconds of luxfer_transfer_report is the
/// time that a stage took for all of them. The stage EMISSION places all textures in one scene, and the stage RELIGHT
/// solves for the light of all planes together, because the lamps of each plane also light the other planes. Each
/// transfer then has the same LUXFER_SCENE_LIT, with the light of all planes. In luxfer_transfer_get_solution,
/// background includes the light of the other planes; a plane that they alone make brighter than in the photo gets no
/// light, and a warning. The stage RENDER runs once for all transfers with equal cameras and settings.
///
/// Each plane must be parallel to two of the room's three axes: a ceiling, a floor or a wall (plane_axes of
/// luxfer_rectify_params). Sloped planes are not unwarped. For a sloped plane, make the texture by luxfer_image_warp
/// and a luxfer_emission, and set it by luxfer_transfer_set_texture; the transfer then needs only its masks.
///
/// As luxfer_transfer_start; also LUXFER_INVALID_ARGUMENT if photos or scenes differ, if two transfers are one, if
/// white_luminance or the settings of RELIGHT differ, or if several transfers ask for LUXFER_FIT_LEAST_SQUARES; the job
/// ends with it if two transfers light one triangle of the scene. LUXFER_INVALID_OPERATION if RELIGHT runs without
/// EMISSION on transfers whose textures were not placed by one job, or on some of the transfers of that job only, also
/// by luxfer_transfer_start. The message names the transfer by its index.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_start_all(
    context: *mut luxfer_context,
    transfers: *const *mut luxfer_transfer,
    count: usize,
    first: luxfer_stage,
    last: luxfer_stage,
    params: *const *const luxfer_transfer_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(context, |object| {
        let context = object.context();
        let (first, last) = (stage_of("first", first)?, stage_of("last", last)?);
        if !(1..=transfer::MAX_PLANES).contains(&count) {
            let most = transfer::MAX_PLANES;
            return Err(Error::argument(format!("count is {count}; it must be in 1 to {most}")));
        }
        let named = |k: usize, e: Error| e.context(format_args!("transfers[{k}]"));
        let stages = pointers(transfers.cast::<*const luxfer_transfer>(), count, "transfers")?.into_iter().enumerate();
        let stages: Vec<_> = stages
            .map(|(k, transfer)| handle::borrow_in(context, transfer, &format!("transfers[{k}]")))
            .collect::<Result<_>>()?;
        let settings =
            if params.is_null() { vec![std::ptr::null(); count] } else { pointers(params, count, "params")? };
        let claims = claim_all(&stages, "transfers")?;
        let mut all = Vec::with_capacity(count);
        for (k, (stage, settings)) in stages.iter().zip(settings).enumerate() {
            all.push(params::read(settings).and_then(|params| snapshot(stage, params)).map_err(|e| named(k, e))?);
        }
        transfer::check_together(&all, first, last)?;
        claims.start(context, job, move |publish, job| {
            transfer::run_together(&mut all, first, last, job, &mut |k, results| publish(k, results.clone()))
        })
    })
}

/// Reads the caller's array of pointers, which may be at any alignment.
fn pointers<T>(place: *const *const T, count: usize, name: &str) -> Result<Vec<*const T>> {
    let array = bytes(place.cast(), count.saturating_mul(size_of::<*const T>()), name)?;
    // SAFETY: element `i` lies in `array`, and every bit pattern of a pointer is valid.
    Ok((0..count).map(|i| unsafe { array.as_ptr().cast::<*const T>().add(i).read_unaligned() }).collect())
}

/// Returns a copy of the transfer's inputs and results, with the settings of `params`.
pub(super) fn snapshot(stage: &Runner<Inputs, Results>, params: luxfer_transfer_params) -> Result<Transfer> {
    let results = stage.output().map(|results| (*results).clone()).unwrap_or_default();
    Ok(Transfer { input: stage.inputs().input()?, params: params.params()?, results })
}
