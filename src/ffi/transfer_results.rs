//! Transfer results
//!
//! The results of a transfer. A result is available once its stage has ended; the rendering is available in its
//! current state while it runs.

use super::guard::enter;
use super::handle::{self, Owned};
use super::image::{Pixels, luxfer_image};
use super::params::{Report, Versioned, versioned};
use super::pointer::{Out, text};
use super::rectify::luxfer_rectify_report;
use super::relight::luxfer_relight_report;
use super::render::preview;
use super::scene::{SceneObject, luxfer_scene, missing};
use super::status::luxfer_status;
use super::transfer::luxfer_transfer;
use crate::error::{Error, ErrorKind, Result};
use crate::image::io;
use crate::image::photo::{Luminance, PhotoMetadata};
use crate::schedule::{to_csv, to_json};
use crate::transfer::Results;
use std::f64::consts::PI;
use std::ffi::c_char;
use std::path::Path;
use std::sync::Arc;

/// An image that a stage of the transfer has made: a LUXFER_TRANSFER_ value.
pub type luxfer_transfer_image = i32;
/// The ten channels of the features, as LUXFER_FEATURES_CHANNELS.
pub const LUXFER_TRANSFER_FEATURES: luxfer_transfer_image = 0;
/// The mask of the plane in the photo: 1 on the plane, else 0; 1 channel.
pub const LUXFER_TRANSFER_PLANE_MASK: luxfer_transfer_image = 1;
/// Probability that a pixel of the photo is on the plane, in [0, 1]; 1 channel.
pub const LUXFER_TRANSFER_PLANE_CONFIDENCE: luxfer_transfer_image = 2;
/// The mask of the lights in the photo: 1 on lights, else 0; 1 channel.
pub const LUXFER_TRANSFER_LIGHTS_MASK: luxfer_transfer_image = 3;
/// Confidence that a pixel of the photo is a light, in [0, 1], as LUXFER_SEGMENT_CONFIDENCE; 1 channel.
pub const LUXFER_TRANSFER_LIGHTS_CONFIDENCE: luxfer_transfer_image = 4;
/// The unwarped image: the plane in frontal view, linear RGB.
pub const LUXFER_TRANSFER_UNWARPED: luxfer_transfer_image = 5;
/// The mask of the plane in frontal view: 1 where the mask is set and the photo's values are finite, else 0; 1 channel.
pub const LUXFER_TRANSFER_UNWARPED_VALID: luxfer_transfer_image = 6;
/// The emissive texture: linear RGB, where 1 is the photo's white.
pub const LUXFER_TRANSFER_EMISSION: luxfer_transfer_image = 7;
/// The mask of the emissive texture: 1 on lamps, else 0; 1 channel.
pub const LUXFER_TRANSFER_EMISSION_MASK: luxfer_transfer_image = 8;
/// The scene in its new light: linear RGB in cd/m²; while the rendering runs, the picture so far.
pub const LUXFER_TRANSFER_RENDER: luxfer_transfer_image = 9;
/// Variance of the rendering, as LUXFER_RENDER_VARIANCE; 3 channels.
pub const LUXFER_TRANSFER_RENDER_VARIANCE: luxfer_transfer_image = 10;
/// The rendering after a noise filter, if the settings of the stage RENDER ask for a preview; see
/// LUXFER_RENDER_PREVIEW.
pub const LUXFER_TRANSFER_RENDER_PREVIEW: luxfer_transfer_image = 11;

/// A scene that the transfer has made: a LUXFER_SCENE_ value.
pub type luxfer_transfer_scene = i32;
/// The scene with the emission before the stage RELIGHT solves for its factor: the texture times white_luminance of
/// luxfer_transfer_params, as bright as the lamps in the photo.
pub const LUXFER_SCENE_UNSOLVED: luxfer_transfer_scene = 0;
/// The scene with the solved emission: the result.
pub const LUXFER_SCENE_LIT: luxfer_transfer_scene = 1;
/// As LUXFER_SCENE_LIT, but the emission is white, at unchanged luminance; for comparison.
pub const LUXFER_SCENE_WHITE: luxfer_transfer_scene = 2;

/// Time and error of each stage. The error of a stage without a result is NaN.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_transfer_report {
    /// sizeof(luxfer_transfer_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of fixtures (lamps of the lit scene); see luxfer_transfer_get_fixture. 0 before the stage RELIGHT has
    /// ended.
    pub fixtures: u32,
    /// Duration of each stage's last run in seconds, 0 without a run; the index is the LUXFER_STAGE_ value.
    pub seconds: [f64; 8],
    /// Largest standard deviation of the directions of the vanishing points, in radians.
    pub view_error: f64,
    /// Mean confidence of the depth in the features, in [0, 1].
    pub depth_confidence: f64,
    /// Expected share of wrong pixels in the mask of the plane, in [0, 1].
    pub plane_error: f64,
    /// Expected share of wrong pixels in the mask of the lights, in [0, 1].
    pub lights_error: f64,
    /// Largest expected error of a corner of the unwarped image, in unwarped pixels.
    pub unwarp_error: f64,
    /// luxfer_emission_report.error: largest relative difference between texture and photo in the lit share, the size
    /// or the spacing of their lamps.
    pub emission_error: f64,
    /// luxfer_relight_report.error: largest relative half-width of the solution's 95 % confidence intervals.
    pub relight_error: f64,
    /// luxfer_render_report.error: root mean square of the rendering's standard errors, divided by its mean.
    pub render_error: f64,
    /// Length of a texel's side on the surface, in metres.
    pub texel_size: f64,
    /// Mean colour that the surface should have: linear RGB, where 1 is the photo's white.
    pub target: [f32; 3],
    /// Reserved; always 0.
    pub reserved: u32,
    /// Distance in metres of the photo's camera from the plane with the lights. Seen from this distance, the lamps on
    /// the surface of the scene look as large as the lamps in the photo. NaN before the stage EMISSION has ended, and
    /// if the caller gave the texture.
    pub plane_distance: f64,
    /// Relative standard deviation of plane_distance. If the distance is estimated from the size of the lamps, it is
    /// about 0.25 for lamps of a usual size, and 0.6 if the lamps do not determine it. 0 if the settings determine the
    /// distance.
    pub plane_distance_error: f64,
    /// Value proposed for luxfer_transfer_params.white_luminance in cd/m²: the white_luminance of
    /// luxfer_photo_metadata if the photo's file states the exposure, else 159, the luminance of white paper in the
    /// 500 lux of an office.
    pub proposed_white: f64,
    /// Lower bound of proposed_white in cd/m²: white_luminance_low if the photo's file states the exposure, else 32,
    /// the luminance of white paper in the 100 lux of a corridor.
    pub proposed_white_low: f64,
    /// Upper bound of proposed_white in cd/m²: white_luminance_high if the photo's file states the exposure, else 318,
    /// the luminance of white paper in 1000 lux.
    pub proposed_white_high: f64,
    /// luxfer_render_report.preview_error: estimated error of LUXFER_TRANSFER_RENDER_PREVIEW, divided by the image's
    /// mean. NaN without this image.
    pub preview_error: f64,
}

const REPORT_SIZE: usize = 8 + 64 + 72 + 16 + 16 + 24 + 8;

/// Usual illuminances in lux: of corridors, of offices, and for fine work. [convention]: EN 12464-1
const USUAL_ILLUMINANCE: [f64; 3] = [100.0, 500.0, 1000.0];

versioned!(luxfer_transfer_report, [REPORT_SIZE - 8, REPORT_SIZE], {
    Self {
        struct_size: REPORT_SIZE as u32,
        fixtures: 0,
        seconds: [0.0; 8],
        view_error: f64::NAN,
        depth_confidence: f64::NAN,
        plane_error: f64::NAN,
        lights_error: f64::NAN,
        unwarp_error: f64::NAN,
        emission_error: f64::NAN,
        relight_error: f64::NAN,
        render_error: f64::NAN,
        texel_size: f64::NAN,
        target: [f32::NAN; 3],
        reserved: 0,
        plane_distance: f64::NAN,
        plane_distance_error: f64::NAN,
        proposed_white: f64::NAN,
        proposed_white_low: f64::NAN,
        proposed_white_high: f64::NAN,
        preview_error: f64::NAN,
    }
});

impl luxfer_transfer_report {
    fn new(results: &Results, photo: Option<&PhotoMetadata>) -> Self {
        let [low, usual, high] = USUAL_ILLUMINANCE.map(|lux| lux / PI);
        let white = photo.and_then(PhotoMetadata::white_luminance);
        let white = white.unwrap_or(Luminance { low, expected: usual, high });
        let or_nan = |error: Option<f64>| error.unwrap_or(f64::NAN);
        let largest = |errors: &[f64]| errors.iter().copied().fold(0.0, f64::max);
        let lit = results.lit.as_ref();
        Self {
            fixtures: match (lit, &results.emission) {
                (Some(_), Some(emission)) => u32::try_from(emission.luminaires.len()).unwrap_or(u32::MAX),
                _ => 0,
            },
            seconds: results.seconds,
            view_error: or_nan(results.view.as_ref().map(|v| largest(&[0, 1, 2].map(|i| v.vanishing_points[i].error)))),
            depth_confidence: or_nan(results.features.as_ref().map(|f| {
                let data = &f.depth_confidence.data;
                data.iter().map(|&c| f64::from(c)).sum::<f64>() / data.len() as f64
            })),
            plane_error: or_nan(results.plane.as_ref().map(|s| s.error)),
            lights_error: or_nan(results.lights.as_ref().map(|s| s.error)),
            unwarp_error: or_nan(results.unwarped.as_ref().map(|u| largest(&u.corner_error))),
            emission_error: or_nan(results.emission.as_ref().map(|e| e.error)),
            relight_error: or_nan(results.solution.as_ref().map(|s| s.error())),
            render_error: or_nan(results.film.as_ref().map(|f| f.error)),
            texel_size: or_nan(lit.or(results.unsolved.as_ref()).map(|l| l.texel_size)),
            target: results.target.map_or([f32::NAN; 3], |t| t.to_array()),
            plane_distance: or_nan(results.distance.map(|d| d.metres)),
            plane_distance_error: or_nan(results.distance.map(|d| d.error)),
            proposed_white: white.expected,
            proposed_white_low: white.low,
            proposed_white_high: white.high,
            preview_error: or_nan(results.film.as_ref().and_then(|f| f.preview.as_ref()).map(|p| p.error)),
            ..Self::defaults()
        }
    }
}

/// One lamp of the lit scene.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_fixture {
    /// sizeof(luxfer_fixture), set by the function that fills the struct.
    pub struct_size: u32,
    /// Centre of the lamp in metres.
    pub position: [f32; 3],
    /// Unit vector of the direction in which the lamp shines.
    pub normal: [f32; 3],
    /// Unit vector along the lamp's long axis.
    pub axis: [f32; 3],
    /// Mean emission of the lamp: linear RGB in cd/m².
    pub radiance: [f32; 3],
    /// Number of the lamp's kind, from 1, as in luxfer_luminaire.kind; 0 if the border of the texture cuts the lamp.
    pub kind: u32,
    /// Lengths of the lamp along its long axis and across it, in metres.
    pub size: [f64; 2],
    /// Area in m².
    pub area: f64,
    /// Luminous flux in lumens: pi * luminance * area, since the lamp is Lambertian.
    pub flux: f64,
    /// Correlated colour temperature of the light in kelvin; 0 for a lamp that is off.
    pub cct: f64,
    /// Signed distance of the light from the blackbody locus in the CIE 1960 diagram: positive for greenish light,
    /// negative for pinkish light.
    pub duv: f64,
}

versioned!(luxfer_fixture, [104], {
    Self {
        struct_size: 104,
        position: [0.0; 3],
        normal: [0.0; 3],
        axis: [0.0; 3],
        radiance: [0.0; 3],
        kind: 0,
        size: [0.0; 2],
        area: 0.0,
        flux: 0.0,
        cct: 0.0,
        duv: 0.0,
    }
});

/// Returns the result of a stage, or an error that names the stage if there is no result.
fn made<'a, T>(result: &'a Option<Arc<T>>, stage: &str) -> Result<&'a Arc<T>> {
    result.as_ref().ok_or_else(|| {
        Error::new(ErrorKind::NotReady, format!("there is no such result yet; LUXFER_STAGE_{stage} makes it"))
    })
}

/// Gets the image that kind, a LUXFER_TRANSFER_ value, selects; a stage has made it. The caller releases *image. Any
/// thread.
/// LUXFER_NOT_READY before the stage that makes the image has ended; LUXFER_NOT_FOUND for a preview if
/// luxfer_render_params.preview was 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_get_image(
    transfer: *mut luxfer_transfer,
    kind: luxfer_transfer_image,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(transfer, |stage| {
        let out = Out::new(image, "image")?;
        let (context, r) = (stage.context(), stage.output()?);
        let part = match kind {
            LUXFER_TRANSFER_FEATURES => Pixels::part(context, made(&r.features, "FEATURES")?.clone(), |f| &f.image),
            LUXFER_TRANSFER_PLANE_MASK => Pixels::part(context, made(&r.plane, "PLANE")?.clone(), |s| &s.mask),
            LUXFER_TRANSFER_PLANE_CONFIDENCE => {
                Pixels::part(context, made(&r.plane, "PLANE")?.clone(), |s| &s.confidence)
            }
            LUXFER_TRANSFER_LIGHTS_MASK => Pixels::part(context, made(&r.lights, "LIGHTS")?.clone(), |s| &s.mask),
            LUXFER_TRANSFER_LIGHTS_CONFIDENCE => {
                Pixels::part(context, made(&r.lights, "LIGHTS")?.clone(), |s| &s.confidence)
            }
            LUXFER_TRANSFER_UNWARPED => Pixels::part(context, made(&r.unwarped, "UNWARP")?.clone(), |u| &u.image),
            LUXFER_TRANSFER_UNWARPED_VALID => Pixels::part(context, made(&r.unwarped, "UNWARP")?.clone(), |u| &u.valid),
            LUXFER_TRANSFER_EMISSION => Pixels::part(context, made(&r.emission, "EMISSION")?.clone(), |e| &e.texture),
            LUXFER_TRANSFER_EMISSION_MASK => Pixels::part(context, made(&r.emission, "EMISSION")?.clone(), |e| &e.mask),
            LUXFER_TRANSFER_RENDER => Pixels::part(context, made(&r.film, "RENDER")?.clone(), |f| &f.beauty),
            LUXFER_TRANSFER_RENDER_PREVIEW => {
                let film = made(&r.film, "RENDER")?;
                Pixels::part(context, film.clone(), preview(film)?)
            }
            LUXFER_TRANSFER_RENDER_VARIANCE => Pixels::part(context, made(&r.film, "RENDER")?.clone(), |f| &f.variance),
            _ => return Err(Error::argument(format!("kind is {kind}; it must be a LUXFER_TRANSFER_ value"))),
        };
        out.set(handle::give(part));
        Ok(())
    })
}

/// Gets the scene that kind, a LUXFER_SCENE_ value, selects; the transfer has made it. The scene is independent of the
/// transfer. The caller releases *scene. Any thread.
/// LUXFER_NOT_READY if the stage that makes the scene has not ended: EMISSION for LUXFER_SCENE_UNSOLVED, RELIGHT for
/// the other scenes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_get_scene(
    transfer: *mut luxfer_transfer,
    kind: luxfer_transfer_scene,
    scene: *mut *mut luxfer_scene,
) -> luxfer_status {
    enter(transfer, |stage| {
        let out = Out::new(scene, "scene")?;
        let results = stage.output()?;
        let found = match kind {
            LUXFER_SCENE_UNSOLVED => made(&results.unsolved, "EMISSION")?.scene.clone(),
            LUXFER_SCENE_LIT => made(&results.lit, "RELIGHT")?.scene.clone(),
            LUXFER_SCENE_WHITE => made(&results.lit, "RELIGHT")?.in_white().scene,
            _ => return Err(Error::argument(format!("kind is {kind}; it must be a LUXFER_SCENE_ value"))),
        };
        out.set(handle::give(SceneObject::of_result(stage.context(), found)));
        Ok(())
    })
}

/// Gets the time and the error of each stage. size is sizeof *report. Any thread.
/// LUXFER_NOT_READY before the first stage has ended.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_get_report(
    transfer: *mut luxfer_transfer,
    report: *mut luxfer_transfer_report,
    size: usize,
) -> luxfer_status {
    enter(transfer, |stage| {
        let out = Report::new(report, size)?;
        out.set(luxfer_transfer_report::new(&*stage.output()?, stage.inputs().photo_metadata()));
        Ok(())
    })
}

/// Gets the camera of the photo, and the unwarping of the plane. The camera was found from the lines and the lamps of
/// the photo, or set by luxfer_transfer_use_rectify. If view->undone is not 0, view->to_photo leads to pixels of the
/// undistorted photo. To make this photo, run a luxfer_rectify with luxfer_rectify_params.distortion = view->undone,
/// then call luxfer_rectify_undistort.
/// size is sizeof *view. Any thread.
/// LUXFER_NOT_READY before the stage VIEW has ended.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_get_view(
    transfer: *mut luxfer_transfer,
    view: *mut luxfer_rectify_report,
    size: usize,
) -> luxfer_status {
    enter(transfer, |stage| {
        let out = Report::new(view, size)?;
        let results = stage.output()?;
        out.set(luxfer_rectify_report::new(made(&results.view, "VIEW")?, results.unwarped.as_deref()));
        Ok(())
    })
}

/// Gets the solved colour and intensity of the emission and their confidence. size is sizeof *solution. Any thread.
/// LUXFER_NOT_READY before the stage RELIGHT has ended.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_get_solution(
    transfer: *mut luxfer_transfer,
    solution: *mut luxfer_relight_report,
    size: usize,
) -> luxfer_status {
    enter(transfer, |stage| {
        let out = Report::new(solution, size)?;
        let results = stage.output()?;
        let solved = results.solution.as_ref().ok_or_else(|| {
            Error::new(ErrorKind::NotReady, "there is no solution yet; LUXFER_STAGE_RELIGHT makes it")
        })?;
        out.set(luxfer_relight_report::new(solved));
        Ok(())
    })
}

/// Describes a lamp of the lit scene; index starts at 0. size is sizeof *fixture. Any thread.
/// LUXFER_NOT_READY before the stage RELIGHT has ended; LUXFER_NOT_FOUND if there is no such fixture.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_get_fixture(
    transfer: *mut luxfer_transfer,
    index: u32,
    fixture: *mut luxfer_fixture,
    size: usize,
) -> luxfer_status {
    enter(transfer, |stage| {
        let out = Report::new(fixture, size)?;
        let fixtures = stage.output()?.fixtures()?;
        let lamp = fixtures.get(index as usize).ok_or_else(|| missing("fixture", index, fixtures.len()))?;
        out.set(luxfer_fixture {
            position: lamp.position.to_array(),
            normal: lamp.normal.to_array(),
            axis: lamp.axis.to_array(),
            radiance: lamp.radiance.to_array(),
            size: lamp.size.to_array(),
            area: lamp.area,
            flux: lamp.flux,
            cct: lamp.cct,
            duv: lamp.duv,
            kind: lamp.kind,
            ..luxfer_fixture::defaults()
        });
        Ok(())
    })
}

/// Writes a list of all lamps of the lit scene (luminaire schedule) to a .csv or .json file: position, normal, axis,
/// size, area, luminance, flux and colour temperature. The names of the columns contain the units. In .json,
/// "outline_m" holds the corners of each outline in metres. path is UTF-8. Any thread.
/// LUXFER_NOT_READY before the stage RELIGHT has ended; LUXFER_INVALID_ARGUMENT for another extension; LUXFER_IO if
/// the file cannot be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_transfer_save_fixtures(
    transfer: *mut luxfer_transfer,
    path: *const c_char,
) -> luxfer_status {
    enter(transfer, |stage| {
        let path = Path::new(text(path, "path")?);
        let encode = match path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase().as_str() {
            "csv" => to_csv,
            "json" => to_json,
            _ => return Err(Error::argument(format!("{} ends neither in .csv nor in .json", path.display()))),
        };
        io::Target::new(path)?.write(encode(&stage.output()?.fixtures()?).as_bytes())
    })
}
