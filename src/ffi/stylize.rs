//! Stylisation
//!
//! Paints a target scene in the style in which an artist has painted an exemplar scene (StyLit). Set the artwork, add
//! the guides (pairs of images that show the light in the exemplar and in the target) and start a job. Or set a
//! half-painted picture and let the library paint the rest. While the job runs, and after a cancel, the picture of the
//! finest finished resolution level can be read.
//!
//! Patents cover some of the methods in some countries, so a build of the library may leave stylisation out. Its
//! functions still exist in such a build, but luxfer_stylize_create returns LUXFER_UNSUPPORTED.

use super::context::luxfer_context;
use super::guard::enter;
use super::guides::luxfer_guides;
use super::handle::{self, Handle, Owned, tag};
use super::image::{Pixels, luxfer_image};
use super::job::luxfer_job;
use super::params;
use super::pointer::{Out, text};
use super::stage::{Stage, need};
use super::status::luxfer_status;
use super::stylize_output::Stylised;
use super::stylize_params::{choice, luxfer_stylize_params};
use crate::error::{Error, ErrorKind, Result, check_range};
use crate::guides::{self, Surfaces};
use crate::image::Image;
use crate::stylize::{self, Guide, MAX_CHANNELS, NORMALS_WEIGHT, Range};
use std::ffi::c_char;
use std::sync::{Arc, Mutex};

/// A stylisation. See luxfer_stylize_create.
pub struct luxfer_stylize {
    _opaque: [u8; 0],
}

/// How the values of a guide are compared: a LUXFER_GUIDE_ value.
pub type luxfer_guide_range = i32;
/// Linear light >= 0, such as a rendering. Its values are clipped at white (1) and compared in the sRGB encoding. If
/// the 99.9th percentile of source and target together exceeds 1, all values are divided by this percentile first.
pub const LUXFER_GUIDE_LIGHT: luxfer_guide_range = 0;
/// Data, such as normals, object codes and edges. The range of values that all channels of source and target have
/// together is scaled to [0, 1].
pub const LUXFER_GUIDE_DATA: luxfer_guide_range = 1;

/// Flag of luxfer_stylize_add_guides: add the normals. Without this flag, the normals are used only if the strokes of
/// the artwork follow the shapes.
pub const LUXFER_GUIDES_WITH_NORMALS: u32 = 1;
/// Flag of luxfer_stylize_add_guides: add the edges, for shapes finer than the brush strokes.
pub const LUXFER_GUIDES_WITH_EDGES: u32 = 2;
/// Flag of luxfer_stylize_add_guides: add the colour code of materials, so that objects of one material are painted
/// from objects of that material.
pub const LUXFER_GUIDES_WITH_MATERIALS: u32 = 4;
/// Flag of luxfer_stylize_add_guides: add a guide of the caustics, at the same exposure as the other guides of light.
/// Use it for scenes in which glossy objects reflect light onto others.
pub const LUXFER_GUIDES_WITH_CAUSTICS: u32 = 8;

#[derive(Clone, Default)]
pub(super) struct Inputs {
    artwork: Option<Arc<Pixels>>,
    guides: Vec<Pair>,
    /// The normals that luxfer_stylize_add_guides has added last; a guide with the name [`NORMALS`] replaces them.
    normals: Option<Pair>,
    source_mask: Option<Arc<Pixels>>,
    target: Target,
    motion: Option<Arc<Pixels>>,
    /// The surfaces of the target scene; known only if luxfer_stylize_add_guides has added the guides of this scene.
    surfaces: Option<Arc<Surfaces>>,
}

#[derive(Clone)]
struct Pair {
    name: String,
    source: Arc<Pixels>,
    target: Arc<Pixels>,
    weight: f32,
    range: Range,
}

impl Pair {
    fn guide(&self) -> Guide<'_> {
        let (source, target) = (self.source.image(), self.target.image());
        Guide { name: &self.name, source, target, weight: self.weight, range: self.range }
    }
}

/// The part of the target to paint: all pixels, or the pixels of a mask; an optional image gives the other pixels.
#[derive(Clone, Default)]
enum Target {
    #[default]
    All,
    Within(Arc<Pixels>, Option<Arc<Pixels>>),
}

impl Inputs {
    /// Checks that the required inputs are set.
    pub(super) fn check(&self) -> Result<()> {
        need(&self.artwork, "luxfer_stylize_set_artwork")?;
        need(&self.guides.first(), "luxfer_stylize_add_guide")?;
        Ok(())
    }

    /// Returns the weight of the normals if the caller has added them as a guide.
    fn given_normals(&self) -> Option<f32> {
        self.guides.iter().find(|g| g.name == NORMALS).map(|g| g.weight)
    }

    /// Calls `work` with the current inputs in the form that the stylisation takes, without a previous frame.
    pub(super) fn with_input<T>(&self, work: impl FnOnce(&stylize::Input) -> Result<T>) -> Result<T> {
        let guides: Vec<Guide> = self.guides.iter().map(Pair::guide).collect();
        let normals = self.normals.as_ref().filter(|_| self.given_normals().is_none()).map(Pair::guide);
        let artwork = need(&self.artwork, "luxfer_stylize_set_artwork")?.image();
        let (target_mask, known) = match &self.target {
            Target::All => (None, None),
            Target::Within(mask, known) => (Some(mask.image()), known.as_ref().map(|k| k.image())),
        };
        let source_mask = self.source_mask.as_ref().map(|m| m.image());
        let input = stylize::Input::new(artwork, &guides);
        work(&stylize::Input { normals, source_mask, target_mask, known, ..input })
    }
}

/// Name of the guide of normals.
const NORMALS: &str = "normals";

/// Adds a guide, or replaces the guide of the same name.
fn add(guides: &mut Vec<Pair>, pair: Pair) -> Result<()> {
    let others = guides.iter().filter(|g| g.name != pair.name);
    let channels = others.map(|g| g.source.image().channels).sum::<usize>() + pair.source.image().channels;
    if channels > MAX_CHANNELS {
        return Err(Error::argument(format!(
            "with guide {:?} there are {channels} channels; there may be {MAX_CHANNELS} in all",
            pair.name
        )));
    }
    match guides.iter_mut().find(|g| g.name == pair.name) {
        Some(same) => *same = pair,
        None => guides.push(pair),
    }
    Ok(())
}

impl Handle for luxfer_stylize {
    type Object = Stage<Inputs, Stylised>;
    const TAG: u64 = tag(b"lux.styl");
    const NAME: &'static str = "luxfer_stylize";
}

/// Creates a stylisation. It has no inputs yet. The caller releases *stylize. Any thread.
/// LUXFER_UNSUPPORTED if stylisation was left out of this build.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_create(
    context: *mut luxfer_context,
    stylize: *mut *mut luxfer_stylize,
) -> luxfer_status {
    enter(context, |object| {
        Out::new(stylize, "stylize")?.set(handle::give(Stage::new(object.context(), Inputs::default())));
        Ok(())
    })
}

/// Sets the artwork: the exemplar scene as painted by the artist. It is an image in linear colour with 1, 3 or 4
/// channels, of the size of the guides' sources and aligned with them. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_set_artwork(
    stylize: *mut luxfer_stylize,
    artwork: *mut luxfer_image,
) -> luxfer_status {
    enter(stylize, |stage| {
        let artwork = handle::borrow_in(stage.context(), artwork, "artwork")?;
        stage.change(|inputs| {
            inputs.artwork = Some(artwork);
            Ok(())
        })
    })
}

/// Adds a guide, or replaces the guide that has this name. The image source shows the exemplar scene, and the image
/// target shows the scene to paint; both have equal numbers of channels. If target is NULL, source serves as the target
/// too; use this for a picture of which one part is painted already (luxfer_stylize_set_painted). name is UTF-8.
/// weight, in [0, 1e6], is relative to the other guides; range is a LUXFER_GUIDE_ value. Any thread.
///
/// All sources must have one size, and all targets one size. All guides together have at most 60 channels. In a
/// target, values that are not finite count as 0; pixels of a source with such values are not used.
/// LUXFER_INVALID_ARGUMENT if the numbers of channels differ or are too large, or a value is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_add_guide(
    stylize: *mut luxfer_stylize,
    name: *const c_char,
    source: *mut luxfer_image,
    target: *mut luxfer_image,
    weight: f32,
    range: luxfer_guide_range,
) -> luxfer_status {
    enter(stylize, |stage| {
        let range = choice(&[Range::Light, Range::Data], range, "range", "LUXFER_GUIDE_")?;
        let source = handle::borrow_in(stage.context(), source, "source")?;
        let target = Pixels::optional(stage.context(), target, "target")?.unwrap_or_else(|| source.clone());
        let pair = Pair { name: text(name, "name")?.to_string(), source, target, weight, range };
        pair.guide().check_alone()?;
        stage.change(|inputs| add(&mut inputs.guides, pair))
    })
}

/// Adds the rendered guides of two scenes: source holds the guides of the exemplar scene, target the guides of the
/// scene to paint. Any thread.
///
/// The call adds the five guides of light, from LUXFER_GUIDES_FULL to LUXFER_GUIDES_TWO_BOUNCES, at a common exposure:
/// the 90th percentile of luminance over both scenes becomes 0.8. They have the names "full", "direct", "specular",
/// "indirect" and "two bounces", and each has weight 1. For each of the LUXFER_GUIDES_WITH_ flags in extras it adds the
/// guide "caustics", "normals", "edges" or "materials", each with weight extra_weight, in [0, 1e6].
///
/// If there is no guide of the name "normals", each job examines the artwork. If its strokes follow the shapes, the
/// normals guide the picture too, so that its strokes follow the shapes of the target; see the field normals_weight of
/// luxfer_stylize_report. In a sequence, the first frame decides. To overrule this, add the normals with a weight of
/// your own by LUXFER_GUIDES_WITH_NORMALS or luxfer_stylize_add_guide; with weight 0 they are not used.
/// LUXFER_NOT_READY before the guides of both scenes are rendered; LUXFER_INVALID_ARGUMENT if extras has unknown flags
/// or extra_weight is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_add_guides(
    stylize: *mut luxfer_stylize,
    source: *mut luxfer_guides,
    target: *mut luxfer_guides,
    extras: u32,
    extra_weight: f32,
) -> luxfer_status {
    enter(stylize, |stage| {
        let context = stage.context();
        let source = handle::borrow_in(context, source, "source")?.output()?;
        let target = handle::borrow_in(context, target, "target")?.output()?;
        let known = LUXFER_GUIDES_WITH_NORMALS
            | LUXFER_GUIDES_WITH_EDGES
            | LUXFER_GUIDES_WITH_MATERIALS
            | LUXFER_GUIDES_WITH_CAUSTICS;
        if extras & !known != 0 {
            return Err(Error::argument(format!("extras is {extras:#x}; only LUXFER_GUIDES_WITH_ flags may be set")));
        }
        check_range("extra_weight", extra_weight, 0.0, 1e6)?;
        let extras = guides::Extras {
            normals: extras & LUXFER_GUIDES_WITH_NORMALS != 0,
            edges: extras & LUXFER_GUIDES_WITH_EDGES != 0,
            materials: extras & LUXFER_GUIDES_WITH_MATERIALS != 0,
            caustics: extras & LUXFER_GUIDES_WITH_CAUSTICS != 0,
        };
        let own = |image: Image| Pixels::counted(context, image.width, image.height, image.channels, || Ok(image));
        let owned = |pair: guides::Pair, weight: f32| -> Result<Pair> {
            Ok(Pair {
                name: pair.name.to_string(),
                source: own(pair.source)?,
                target: own(pair.target)?,
                weight,
                range: if pair.is_light { Range::Light } else { Range::Data },
            })
        };
        let (mut added, mut normals) = (Vec::new(), None);
        for pair in guides::pairs(&source, &target, guides::Extras { normals: true, ..extras })? {
            if pair.name == NORMALS && !extras.normals {
                normals = Some(owned(pair, NORMALS_WEIGHT)?);
            } else {
                let weight = if pair.is_extra { extra_weight } else { 1.0 };
                added.push(owned(pair, weight)?);
            }
        }
        stage.change(|inputs| {
            let mut all = inputs.guides.clone();
            added.into_iter().try_for_each(|pair| add(&mut all, pair))?;
            inputs.guides = all;
            inputs.normals = normals;
            inputs.surfaces = Some(target.surfaces.clone());
            Ok(())
        })
    })
}

/// Removes all guides. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_clear_guides(stylize: *mut luxfer_stylize) -> luxfer_status {
    enter(stylize, |stage| {
        stage.change(|inputs| {
            inputs.guides.clear();
            inputs.normals = None;
            inputs.surfaces = None;
            Ok(())
        })
    })
}

/// Sets the pixels of the artwork that may be copied: the pixels where mask is above 0.5. mask has 1 channel and the
/// artwork's size; NULL stands for all pixels. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_set_source_mask(
    stylize: *mut luxfer_stylize,
    mask: *mut luxfer_image,
) -> luxfer_status {
    enter(stylize, |stage| {
        let mask = Pixels::optional(stage.context(), mask, "mask")?;
        stage.change(|inputs| {
            inputs.source_mask = mask;
            Ok(())
        })
    })
}

/// Sets the pixels of the target to paint: the pixels where mask is above 0.5. mask has 1 channel and the size of the
/// guides' targets; if it is NULL, all pixels are painted. known is an image that shows the other pixels, linear, with
/// the artwork's number of channels; the new paint is fitted to them. If known is NULL, the other pixels are black.
/// Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_set_target_mask(
    stylize: *mut luxfer_stylize,
    mask: *mut luxfer_image,
    known: *mut luxfer_image,
) -> luxfer_status {
    enter(stylize, |stage| {
        let mask = Pixels::optional(stage.context(), mask, "mask")?;
        let known = Pixels::optional(stage.context(), known, "known")?;
        stage.change(|inputs| {
            inputs.target = mask.map_or(Target::All, |mask| Target::Within(mask, known));
            Ok(())
        })
    })
}

/// Makes each job start from the previous result, for the frames of an animation. The paint of the previous frame moves
/// with the surfaces and stays where it fits; see luxfer_stylize_params.coherence. The paint is found anew where the
/// light has changed, at silhouettes that have moved, and on places that come into view. Any thread.
///
/// The image motion has 2 channels and the size of the guides' targets. For each pixel it holds the offset to the
/// position that the pixel's surface point had in the previous frame, x (right) and y (down) in pixels; NaN where the
/// point was not visible. luxfer_guides_get_motion computes it; a pass of motion vectors of another renderer serves
/// too. If motion is NULL, each job starts from nothing. If the motion contradicts the guides, luxfer_get_warnings of
/// stylize has a warning after the job.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_set_motion(
    stylize: *mut luxfer_stylize,
    motion: *mut luxfer_image,
) -> luxfer_status {
    enter(stylize, |stage| {
        let motion = Pixels::optional(stage.context(), motion, "motion")?;
        stage.change(|inputs| {
            inputs.motion = motion;
            Ok(())
        })
    })
}

/// Starts a job that paints the target. params may be NULL for the defaults. The caller releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if artwork or guides are missing or a job is already running; LUXFER_INVALID_ARGUMENT if a
/// setting is out of range; LUXFER_NOT_READY if motion is set and there is no previous result. The job may end with
/// LUXFER_INVALID_ARGUMENT if sizes differ or a side is above 32768 pixels, LUXFER_DEGENERATE if a mask is empty or
/// leaves no exemplar patch.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_start(
    stylize: *mut luxfer_stylize,
    params: *const luxfer_stylize_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(stylize, |stage| {
        let settings = params::read(params)?;
        let (params, keep) = (settings.params()?, params::flag(settings.keep_for_update, "keep_for_update")?);
        stage.inputs().check()?;
        let previous = match stage.inputs().motion {
            Some(motion) => Some((stage.output()?.frame()?, motion)),
            None => None,
        };
        stage.start(job, move |inputs, stage, job| {
            let publish = |intermediate: stylize::IntermediateResult| stage.publish(Stylised::unfinished(intermediate));
            let (before, motion) = (previous.as_ref().map(|p| &*p.0), previous.as_ref().map(|p| p.1.image()));
            let (surfaces, given_normals) = (inputs.surfaces.clone(), inputs.given_normals());
            // Compare the motion with the true motion, if the scenes of both frames are known.
            let deviation = match (motion, &surfaces, before.and_then(|b| b.surfaces.as_ref())) {
                (Some(motion), Some(now), Some(before)) => Some(guides::deviation(motion, now, before, job)?),
                _ => None,
            };
            inputs.with_input(|input| {
                let (field, guide_record) = (before.map(|b| &b.field), before.map(|b| &b.guide_record));
                let input = stylize::Input { previous: field, guide_record, motion, ..*input };
                let (updater, output) = if keep {
                    let (updater, output) = stylize::Updater::new(&input, &params, &publish, job)?;
                    (Some(updater), output)
                } else {
                    (None, stylize::run_and_publish(&input, &params, &publish, job)?)
                };
                let comparison = deviation.unwrap_or(output.report.agreement);
                let mut warnings = output.report.warnings(input.known.is_some());
                warnings.extend(stylize::motion_disagrees(comparison));
                let normals_weight = given_normals.unwrap_or(output.report.normals_weight);
                Ok(Stylised::finished(output, surfaces, warnings, normals_weight, updater))
            })
        })
    })
}

/// Starts a job that updates the picture after the artist has changed the artwork. artwork is the new artwork, with
/// the size and channels of the old one. changed_mask has 1 channel, above 0.5 where the new artwork differs from the
/// old artwork. The pixels of the picture that were painted from these places are painted again, in a fraction of the
/// time of luxfer_stylize_start. Pixels outside the target mask stay as luxfer_stylize_start has left them, even if the
/// artwork changes there. At the border of these pixels, luxfer_stylize_start continues strokes, and lets a step in
/// colour fade out into the new paint; an update only lets the step fade out. The caller releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if no job with keep_for_update = 1 has succeeded, or while a job runs. The job may end
/// with LUXFER_INVALID_ARGUMENT if sizes differ. If an update is cancelled, the next update does the remaining work
/// too.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_update(
    stylize: *mut luxfer_stylize,
    artwork: *mut luxfer_image,
    changed_mask: *mut luxfer_image,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(stylize, |stage| {
        let artwork = handle::borrow_in(stage.context(), artwork, "artwork")?;
        let changed_mask = handle::borrow_in(stage.context(), changed_mask, "changed_mask")?;
        let before = stage.output().ok();
        let updater: Option<Arc<Mutex<stylize::Updater>>> = before.as_ref().and_then(|b| b.updater());
        let (Some(before), Some(updater)) = (before, updater) else {
            return Err(Error::new(
                ErrorKind::InvalidOperation,
                "there is nothing to update; start with keep_for_update = 1 and wait for the job to succeed",
            ));
        };
        stage.start(job, move |_, _, job| {
            let updater = &mut *super::guard::lock(&updater);
            let picture = updater.repaint(artwork.image(), changed_mask.image(), job.part(0.0, 0.95))?;
            Ok(before.updated(picture, updater.sources(job.part(0.95, 1.0))?))
        })
    })
}

/// Lets the library paint the rest of a half-painted picture, which is the artwork. painted is a mask with 1 channel
/// and the artwork's size, above 0.5 where the picture is finished. Use guides whose sources show the scene of the
/// picture, and whose targets are NULL. Any thread.
///
/// The call sets three inputs at once that must fit together: the source mask to this mask, and the target mask to the
/// inverse mask with the artwork as the known picture. The painted pixels stay as they are. The new paint continues
/// strokes across the border of the painted part, and this border is hardly visible. To avoid visible copies, the
/// library hardly ever uses a patch of the artwork more than 100 times as often as the average patch. If the painted
/// part lacks light that the unpainted part shows, the result has the warning LUXFER_WARNING_LIGHT_NOT_PAINTED, with a
/// place where the artist should paint.
/// LUXFER_INVALID_OPERATION before the artwork is set; LUXFER_INVALID_ARGUMENT if painted does not have the artwork's
/// size or has more than 1 channel.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_set_painted(
    stylize: *mut luxfer_stylize,
    painted: *mut luxfer_image,
) -> luxfer_status {
    enter(stylize, |stage| {
        let painted = handle::borrow_in(stage.context(), painted, "painted")?;
        stage.change(|inputs| {
            let artwork = need(&inputs.artwork, "luxfer_stylize_set_artwork")?;
            let mask = painted.image();
            mask.check_same_size("painted", artwork.image(), "the artwork")?;
            if mask.channels != 1 {
                return Err(Error::argument(format!("painted has {} channels; it must have 1", mask.channels)));
            }
            let unpainted = Pixels::counted(stage.context(), mask.width, mask.height, mask.channels, || {
                let mut opposite = mask.try_clone()?;
                opposite.data.iter_mut().for_each(|v| *v = if *v > 0.5 { 0.0 } else { 1.0 });
                Ok(opposite)
            })?;
            inputs.target = Target::Within(unpainted, Some(artwork.clone()));
            inputs.source_mask = Some(painted);
            Ok(())
        })
    })
}
