//! Warnings
//!
//! Reasons to doubt the result of a job that has succeeded, or a scene that was loaded. A warning names the defect, a
//! measure of it (the severity) with the limit that it has passed, the place in the photo, and the remedy. Each stage
//! that has warnings has a list of them, a transfer has the lists of all its stages, and a scene has a list. A list is
//! a copy: it does not change when the stage is started again. An empty list does not prove that a result is right.

use super::context::Context;
use super::emission::luxfer_emission;
use super::features::luxfer_features;
use super::guard::enter;
use super::guides::luxfer_guides;
use super::handle::{self, Handle, Owned, tag};
use super::params::{Report, Versioned, versioned};
use super::pointer::{Out, c_string};
use super::rectify::luxfer_rectify;
use super::relight::luxfer_relight;
use super::scene::{luxfer_scene, missing};
use super::segment::luxfer_segment;
use super::status::luxfer_status;
use super::transfer::{LUXFER_STAGE_SCENE, LUXFER_STAGE_STYLIZE, luxfer_stage, luxfer_transfer};
use crate::error::Result;
use crate::segment;
use crate::transfer::Stage;
use crate::warning::Warning;
use std::ffi::{CString, c_char, c_void};
use std::sync::Arc;

/// A list of warnings. See luxfer_get_warnings.
pub struct luxfer_warnings {
    _opaque: [u8; 0],
}

/// The code of a warning: a LUXFER_WARNING_ value. Values are never changed or reused; new values may be added.
pub type luxfer_warning_code = i32;
/// The vanishing points determine the focal length poorly, so it was mainly assumed; the severity is the relative
/// standard deviation of the focal length, or the limit if the limit is larger.
pub const LUXFER_WARNING_FOCAL_ASSUMED: luxfer_warning_code = 1;
/// The directions of the room axes are uncertain; the severity is the largest standard deviation in radians.
pub const LUXFER_WARNING_VIEW_UNCERTAIN: luxfer_warning_code = 2;
/// The lens bends straight lines; the severity is the distortion of luxfer_rectify_report without its sign.
pub const LUXFER_WARNING_LENS_DISTORTION: luxfer_warning_code = 3;
/// The walls do not meet at right angles, or the pixels are not square; the severity is the largest deviation of an
/// angle between two room axes from a right angle, in radians.
pub const LUXFER_WARNING_NOT_SQUARE: luxfer_warning_code = 4;
/// There is no depth map, and the room that was fitted to the lines of the photo is uncertain. The severity is the
/// confidence of the fit, in [0, 1], which is below the limit; 0 if no room could be fitted.
pub const LUXFER_WARNING_LAYOUT_UNCERTAIN: luxfer_warning_code = 5;
/// Much of the mask of a surface is unlike every stroke, or the mask of lamps leaves out regions that partly resemble
/// the painted or proposed lamps. The severity is the area of these doubtful pixels, divided by the area of the mask
/// and the doubtful pixels together. The warning points to the pixel where one more stroke helps most.
pub const LUXFER_WARNING_UNSEEN: luxfer_warning_code = 6;
/// Positive and negative strokes cover the same pixels, where the later strokes count. The severity is the number of
/// these pixels, divided by the number of painted pixels that the segmentation learns from.
pub const LUXFER_WARNING_CONTRADICTORY_STROKES: luxfer_warning_code = 7;
/// Pixels of strokes lie outside the photo and are ignored. The severity is the number of these pixels, divided by the
/// number of painted pixels that the segmentation learns from.
pub const LUXFER_WARNING_OFF_IMAGE_STROKES: luxfer_warning_code = 8;
/// A mask is uncertain; the severity is the expected share of wrong pixels.
pub const LUXFER_WARNING_UNCERTAIN_MASK: luxfer_warning_code = 9;
/// A mask has no pixel; the severity is 0, which is below the limit.
pub const LUXFER_WARNING_EMPTY_MASK: luxfer_warning_code = 10;
/// A mask contradicts the strokes that it was made from; the severity is the share of the painted pixels that it
/// contradicts. The warning points to one of these pixels.
pub const LUXFER_WARNING_MISSED_STROKES: luxfer_warning_code = 11;
/// Lights cover much of their plane; the severity is the share of the plane that they cover.
pub const LUXFER_WARNING_ALMOST_ALL_LIT: luxfer_warning_code = 12;
/// Much of the unwarped plane is magnified more than 4 times from the photo; the severity is the share of the plane
/// that is magnified so much. The warning points to the point with the largest magnification.
pub const LUXFER_WARNING_MAGNIFIED: luxfer_warning_code = 13;
/// The camera sees the plane nearly edge-on. The severity is the median, over the plane, of the sine of the angle
/// between the plane and the viewing ray; it is below the limit. The warning points to the point with the smallest
/// angle.
pub const LUXFER_WARNING_PLANE_NEAR_HORIZON: luxfer_warning_code = 14;
/// The texture and the photo differ in the statistics of their lamps; the severity is luxfer_emission_report.error.
pub const LUXFER_WARNING_PATTERN_UNCERTAIN: luxfer_warning_code = 15;
/// The photo shows too few whole lamps for a pattern; the severity is the number of whole lamps, which is below the
/// limit.
pub const LUXFER_WARNING_FEW_LAMPS: luxfer_warning_code = 16;
/// No lattice was found on which the lamps lie, and the texture differs from the photo; the severity is
/// luxfer_emission_report.error.
pub const LUXFER_WARNING_NO_LATTICE: luxfer_warning_code = 17;
/// Colour channels do not meet their target; the severity is the number of these channels.
pub const LUXFER_WARNING_UNREACHABLE: luxfer_warning_code = 18;
/// Channels of the target colour are only lower bounds (LUXFER_CONSTRAINT_AT_LEAST). A transfer sets such a bound if
/// the photo clips the channel in most pixels that the target colour is computed from. The severity is the number of
/// these channels.
pub const LUXFER_WARNING_TARGET_CLIPPED: luxfer_warning_code = 19;
/// A scene is so high, so wide or so small that its unit is probably not the metre. The severity is the implausible
/// height or width in metres. For a scene that is too small, it is the larger of height and width, and is below the
/// limit. The message names the likely unit.
pub const LUXFER_WARNING_IMPLAUSIBLE_SIZE: luxfer_warning_code = 20;
/// The file of a scene has a feature or an extension that is not rendered. The message names the feature and the first
/// objects that have it; the severity is the number of these objects.
pub const LUXFER_WARNING_NOT_RENDERED: luxfer_warning_code = 21;
/// The painted lamps are hardly brighter than the plane: they are off, or face away. The severity is the probability
/// that a pixel painted as light is brighter than a pixel painted as plane; it is below the limit. The warning points
/// to the darkest lamp.
pub const LUXFER_WARNING_DIM_LAMPS: luxfer_warning_code = 22;
/// A texture without any light would differ less from the photo than the texture that was synthesised first. The
/// severity is the error of that first texture. If LUXFER_LAW_BEST has then found a better texture by another law,
/// luxfer_emission_report.error is smaller than the severity. This warning replaces LUXFER_WARNING_PATTERN_UNCERTAIN.
pub const LUXFER_WARNING_NO_PATTERN: luxfer_warning_code = 23;
/// A mask is only a proposal, because strokes are missing: for the plane, positive or negative strokes, or both; for
/// the lights, positive strokes. The severity is the expected share of wrong pixels.
pub const LUXFER_WARNING_PROPOSED: luxfer_warning_code = 24;
/// A scene lies far from the origin. There are two cases. If luxfer_scene_get_origin is not 0, positions are relative
/// to that origin; the severity is its distance from the origin of the file in metres, and the limit is 0. Otherwise
/// coordinates of vertices are so large that floats round them; the severity is the step of the rounding in metres.
pub const LUXFER_WARNING_FAR_FROM_ORIGIN: luxfer_warning_code = 25;
/// A scene has luminaires that shine from points: they are invisible in renderings, and luxfer_image_get_glare does not
/// rate them. The severity is the number of these luminaires; the message lists the first few with their positions.
pub const LUXFER_WARNING_NOT_IN_PICTURE: luxfer_warning_code = 26;
/// Objects that this frame of a sequence shows are missing in the previous frame, or have other triangles there. Their
/// motion is unknown and therefore NaN. The severity is the share of the picture that shows these objects; the message
/// names them. The warning points to a pixel of the largest of these objects.
pub const LUXFER_WARNING_NO_COUNTERPART: luxfer_warning_code = 27;
/// The motion of a stylisation contradicts the guides: at the end of a pixel's motion, the previous frame shows another
/// surface. If the targets of both frames come from luxfer_stylize_add_guides, the motion is compared with the exact
/// motion of their scenes. Otherwise the LUXFER_GUIDE_DATA guides, such as object codes or normals, of the pixel and of
/// the end of its motion are compared. Previews, and stylisations without such guides, skip this comparison of guides.
/// If nothing was compared, the warning does not occur. The severity is the share of pixels with wrong motion among the
/// pixels that were compared. The warning points to the pixel with the largest error.
pub const LUXFER_WARNING_MOTION_DISAGREES: luxfer_warning_code = 28;
/// The target of a stylisation shows light that no usable place of the exemplar shows, for example a cast shadow if the
/// painted part of a half-painted picture has no shadow. The new paint there is a guess. The severity is the share of
/// such pixels among the pixels to paint; LUXFER_STYLIZE_IMAGE_GUIDE_ERROR shows them. The warning points to the place
/// of the target where most of them lie.
pub const LUXFER_WARNING_LIGHT_NOT_PAINTED: luxfer_warning_code = 29;
/// Places of the exemplar with equal guides are painted in two ways, which a stylisation mixes. The severity is the
/// share of the exemplar that such places cover. The warning points to one of them in the artwork.
pub const LUXFER_WARNING_AMBIGUOUS_PAINT: luxfer_warning_code = 30;
/// A small place of the artwork, such as a stain, is painted unlike all places with similar guides. The severity is the
/// difference in paint from this place that all but 5 % of the places with similar guides exceed, divided by the
/// typical difference in paint between places with equal guides. The warning points to the place in the artwork.
pub const LUXFER_WARNING_BLEMISH: luxfer_warning_code = 31;
/// The sizes of the lamps in the photo contradict the perspective of the plane: the lamps hang or lie on several
/// planes, the mask of the lights shows other things, or the camera is wrong. Where the photo shows the plane k times
/// as large, it would show lamps on the plane k times as large, but shows these lamps k^severity times as large. Only
/// luxfer_transfer compares them, because luxfer_rectify does not know the lamps.
pub const LUXFER_WARNING_OFF_PLANE: luxfer_warning_code = 32;

/// A warning: a reason to doubt a result.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_warning {
    /// sizeof(luxfer_warning), set by the function that fills the struct.
    pub struct_size: u32,
    /// Kind of the warning: a LUXFER_WARNING_ value.
    pub code: luxfer_warning_code,
    /// The stage whose result is in doubt: a LUXFER_STAGE_ value. For a luxfer_segment it is LUXFER_STAGE_LIGHTS if
    /// luxfer_segment_set_region gave a mask, else LUXFER_STAGE_PLANE; for a luxfer_scene, and for the scene of a
    /// luxfer_transfer, it is LUXFER_STAGE_SCENE; for a luxfer_guides or a luxfer_stylize it is LUXFER_STAGE_STYLIZE.
    pub stage: luxfer_stage,
    /// 1 if the warning points to a place, else 0.
    pub has_place: u32,
    /// The number that caused the warning; the comment of the LUXFER_WARNING_ value in the field code says what this
    /// number measures.
    pub severity: f64,
    /// The limit that the severity has passed: an upper limit, unless the comment of the LUXFER_WARNING_ value says
    /// that the severity is below the limit.
    pub limit: f64,
    /// The place, x and y in pixels of the photo; for a luxfer_guides or a luxfer_stylize, in pixels of the target or,
    /// where the comment of the LUXFER_WARNING_ value says so, of the artwork. 0 if the warning has no place.
    pub place: [f64; 2],
    /// The defect: an English sentence, which for most warnings states the value of severity, in zero-terminated UTF-8.
    /// The string lives as long as the luxfer_warnings.
    pub message: *const c_char,
    /// The remedy: an English sentence in zero-terminated UTF-8. The string lives as long as the luxfer_warnings.
    pub advice: *const c_char,
}

versioned!(luxfer_warning, [64], {
    Self {
        struct_size: 64,
        code: 0,
        stage: 0,
        has_place: 0,
        severity: 0.0,
        limit: 0.0,
        place: [0.0; 2],
        message: std::ptr::null(),
        advice: std::ptr::null(),
    }
});

/// The object behind a `luxfer_warnings` handle: a list of warnings, each with its stage.
pub(super) struct Warnings {
    context: Arc<Context>,
    list: Vec<WarningEntry>,
}

/// A warning with its stage, and its texts as C strings.
struct WarningEntry {
    stage: luxfer_stage,
    warning: Warning,
    message: CString,
    advice: CString,
}

impl WarningEntry {
    fn new(stage: luxfer_stage, warning: Warning) -> Self {
        let (message, advice) = (c_string(&warning.message), c_string(&warning.advice));
        Self { stage, warning, message, advice }
    }
}

impl Owned for Warnings {
    fn context(&self) -> &Arc<Context> {
        &self.context
    }
}

impl Handle for luxfer_warnings {
    type Object = Warnings;
    const TAG: u64 = tag(b"lux.warn");
    const NAME: &'static str = "luxfer_warnings";
}

impl Warnings {
    fn get(&self, index: u32) -> Result<&WarningEntry> {
        self.list.get(index as usize).ok_or_else(|| missing("warning", index, self.list.len()))
    }
}

/// Pairs each warning of `list` with `stage`.
fn of(stage: Stage, list: Vec<Warning>) -> impl Iterator<Item = (luxfer_stage, Warning)> {
    list.into_iter().map(move |warning| (stage as luxfer_stage, warning))
}

/// A handle whose object has warnings.
pub(super) trait HasWarnings: Handle {
    fn list(object: &Self::Object) -> Result<Vec<(luxfer_stage, Warning)>>;
}

/// Creates the list of an object's warnings.
pub(super) fn create<H: HasWarnings>(handle: *mut c_void, warnings: *mut *mut luxfer_warnings) -> luxfer_status {
    enter(handle.cast::<H>(), |object| {
        let out = Out::new(warnings, "warnings")?;
        let list = H::list(object)?.into_iter().map(|(stage, warning)| WarningEntry::new(stage, warning)).collect();
        out.set(handle::give(Arc::new(Warnings { context: object.context().clone(), list })));
        Ok(())
    })
}

impl HasWarnings for luxfer_transfer {
    fn list(stage: &Self::Object) -> Result<Vec<(luxfer_stage, Warning)>> {
        let list = stage.output()?.warnings(stage.inputs().strokes());
        let number = |stage: Option<Stage>| stage.map_or(LUXFER_STAGE_SCENE, |stage| stage as luxfer_stage);
        Ok(list.into_iter().map(|(stage, warning)| (number(stage), warning)).collect())
    }
}

impl HasWarnings for luxfer_rectify {
    fn list(stage: &Self::Object) -> Result<Vec<(luxfer_stage, Warning)>> {
        let output = stage.output()?;
        let unwarped = output.unwarped.as_ref().map_or(Vec::new(), |unwarped| unwarped.warnings());
        Ok(of(Stage::View, output.view.warnings()).chain(of(Stage::Unwarp, unwarped)).collect())
    }
}

impl HasWarnings for luxfer_features {
    fn list(stage: &Self::Object) -> Result<Vec<(luxfer_stage, Warning)>> {
        Ok(of(Stage::Features, stage.output()?.features.warnings()).collect())
    }
}

impl HasWarnings for luxfer_segment {
    fn list(stage: &Self::Object) -> Result<Vec<(luxfer_stage, Warning)>> {
        let (made, inputs) = (stage.output()?, stage.inputs());
        let lit = inputs.region.as_ref().and_then(|region| segment::almost_all_lit(&made.mask, region.image()));
        let dim = inputs.features.as_ref().filter(|_| inputs.region.is_some());
        let dim = dim.and_then(|features| segment::dim_lamps(features.image(), &[], &inputs.strokes.taken));
        let missed = made.missed(inputs.strokes.taken.iter());
        let list = made.warnings().into_iter().chain(missed).chain(lit).chain(dim).collect();
        let phase = if inputs.region.is_some() { Stage::Lights } else { Stage::Plane };
        Ok(of(phase, list).collect())
    }
}

impl HasWarnings for luxfer_emission {
    fn list(stage: &Self::Object) -> Result<Vec<(luxfer_stage, Warning)>> {
        let list = stage.output()?.texture.as_ref().map_or(Vec::new(), |texture| texture.warnings());
        Ok(of(Stage::Emission, list).collect())
    }
}

impl HasWarnings for luxfer_relight {
    fn list(stage: &Self::Object) -> Result<Vec<(luxfer_stage, Warning)>> {
        Ok(of(Stage::Relight, stage.output()?.warnings()).collect())
    }
}

impl HasWarnings for luxfer_scene {
    fn list(scene: &Self::Object) -> Result<Vec<(luxfer_stage, Warning)>> {
        let list = scene.snapshot().warnings();
        Ok(list.into_iter().map(|warning| (LUXFER_STAGE_SCENE, warning)).collect())
    }
}

impl HasWarnings for luxfer_guides {
    fn list(stage: &Self::Object) -> Result<Vec<(luxfer_stage, Warning)>> {
        let list = stage.output()?.motion_warnings();
        Ok(list.into_iter().map(|warning| (LUXFER_STAGE_STYLIZE, warning)).collect())
    }
}

/// Gets the number of warnings in a list. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_warnings_get_count(warnings: *mut luxfer_warnings, count: *mut u32) -> luxfer_status {
    enter(warnings, |object| {
        Out::new(count, "count")?.set(object.list.len() as u32);
        Ok(())
    })
}

/// Gets one warning of a list; index starts at 0. size is sizeof *warning. Any thread.
/// LUXFER_NOT_FOUND if index is beyond the end of the list.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_warnings_get(
    warnings: *mut luxfer_warnings,
    index: u32,
    warning: *mut luxfer_warning,
    size: usize,
) -> luxfer_status {
    enter(warnings, |object| {
        let out = Report::new(warning, size)?;
        let entry = object.get(index)?;
        let found = &entry.warning;
        out.set(luxfer_warning {
            code: found.code as luxfer_warning_code,
            stage: entry.stage,
            has_place: u32::from(found.place.is_some()),
            severity: found.severity,
            limit: found.limit,
            place: found.place.unwrap_or_default().to_array(),
            message: entry.message.as_ptr(),
            advice: entry.advice.as_ptr(),
            ..luxfer_warning::defaults()
        });
        Ok(())
    })
}

/// Returns the name of a warning's code, such as "LUXFER_WARNING_UNSEEN"; "LUXFER_WARNING_UNKNOWN" for another number.
/// The string is static: never free it. Any thread.
#[unsafe(no_mangle)]
pub extern "C" fn luxfer_warning_get_name(code: luxfer_warning_code) -> *const c_char {
    let name = match code {
        LUXFER_WARNING_FOCAL_ASSUMED => c"LUXFER_WARNING_FOCAL_ASSUMED",
        LUXFER_WARNING_VIEW_UNCERTAIN => c"LUXFER_WARNING_VIEW_UNCERTAIN",
        LUXFER_WARNING_LENS_DISTORTION => c"LUXFER_WARNING_LENS_DISTORTION",
        LUXFER_WARNING_NOT_SQUARE => c"LUXFER_WARNING_NOT_SQUARE",
        LUXFER_WARNING_LAYOUT_UNCERTAIN => c"LUXFER_WARNING_LAYOUT_UNCERTAIN",
        LUXFER_WARNING_UNSEEN => c"LUXFER_WARNING_UNSEEN",
        LUXFER_WARNING_CONTRADICTORY_STROKES => c"LUXFER_WARNING_CONTRADICTORY_STROKES",
        LUXFER_WARNING_OFF_IMAGE_STROKES => c"LUXFER_WARNING_OFF_IMAGE_STROKES",
        LUXFER_WARNING_UNCERTAIN_MASK => c"LUXFER_WARNING_UNCERTAIN_MASK",
        LUXFER_WARNING_EMPTY_MASK => c"LUXFER_WARNING_EMPTY_MASK",
        LUXFER_WARNING_MISSED_STROKES => c"LUXFER_WARNING_MISSED_STROKES",
        LUXFER_WARNING_ALMOST_ALL_LIT => c"LUXFER_WARNING_ALMOST_ALL_LIT",
        LUXFER_WARNING_MAGNIFIED => c"LUXFER_WARNING_MAGNIFIED",
        LUXFER_WARNING_PLANE_NEAR_HORIZON => c"LUXFER_WARNING_PLANE_NEAR_HORIZON",
        LUXFER_WARNING_PATTERN_UNCERTAIN => c"LUXFER_WARNING_PATTERN_UNCERTAIN",
        LUXFER_WARNING_FEW_LAMPS => c"LUXFER_WARNING_FEW_LAMPS",
        LUXFER_WARNING_NO_LATTICE => c"LUXFER_WARNING_NO_LATTICE",
        LUXFER_WARNING_UNREACHABLE => c"LUXFER_WARNING_UNREACHABLE",
        LUXFER_WARNING_TARGET_CLIPPED => c"LUXFER_WARNING_TARGET_CLIPPED",
        LUXFER_WARNING_IMPLAUSIBLE_SIZE => c"LUXFER_WARNING_IMPLAUSIBLE_SIZE",
        LUXFER_WARNING_NOT_RENDERED => c"LUXFER_WARNING_NOT_RENDERED",
        LUXFER_WARNING_DIM_LAMPS => c"LUXFER_WARNING_DIM_LAMPS",
        LUXFER_WARNING_NO_PATTERN => c"LUXFER_WARNING_NO_PATTERN",
        LUXFER_WARNING_PROPOSED => c"LUXFER_WARNING_PROPOSED",
        LUXFER_WARNING_FAR_FROM_ORIGIN => c"LUXFER_WARNING_FAR_FROM_ORIGIN",
        LUXFER_WARNING_NOT_IN_PICTURE => c"LUXFER_WARNING_NOT_IN_PICTURE",
        LUXFER_WARNING_NO_COUNTERPART => c"LUXFER_WARNING_NO_COUNTERPART",
        LUXFER_WARNING_MOTION_DISAGREES => c"LUXFER_WARNING_MOTION_DISAGREES",
        LUXFER_WARNING_LIGHT_NOT_PAINTED => c"LUXFER_WARNING_LIGHT_NOT_PAINTED",
        LUXFER_WARNING_AMBIGUOUS_PAINT => c"LUXFER_WARNING_AMBIGUOUS_PAINT",
        LUXFER_WARNING_BLEMISH => c"LUXFER_WARNING_BLEMISH",
        LUXFER_WARNING_OFF_PLANE => c"LUXFER_WARNING_OFF_PLANE",
        _ => c"LUXFER_WARNING_UNKNOWN",
    };
    name.as_ptr()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warning::Code;
    use std::ffi::CStr;

    #[test]
    fn every_code_has_its_constant_and_name() {
        for code in Code::ALL {
            // SAFETY: a static string.
            let name = unsafe { CStr::from_ptr(luxfer_warning_get_name(code as i32)) }.to_str().unwrap();
            let expected = format!("LUXFER_WARNING_{code:?}").replace('_', "").to_uppercase();
            assert_eq!(name.replace('_', ""), expected);
        }
        assert_eq!(luxfer_warning_get_name(0), luxfer_warning_get_name(Code::ALL.len() as i32 + 1));
    }
}
