//! Segmentation
//!
//! Computes a mask, with a confidence for each pixel, from a few strokes on a photo. A lighting transfer needs two
//! masks: the plane that carries the lights, then the lights on it. You may add strokes after a result and start
//! again.

use super::context::luxfer_context;
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::image::{Pixels, luxfer_image};
use super::job::luxfer_job;
use super::params::{self, Report, Versioned, versioned};
use super::pointer::Out;
use super::stage::{Stage, need};
use super::status::luxfer_status;
use super::strokes::{Painted, luxfer_phase, luxfer_strokes, of_phase};
use crate::error::{Error, Result};
use crate::image::Image;
use crate::segment::{self, Segmentation, Stroke, Subject};
use std::sync::Arc;

/// A segmentation by strokes. See luxfer_segment_create.
pub struct luxfer_segment {
    _opaque: [u8; 0],
}

/// An image of a segmentation: a LUXFER_SEGMENT_ value.
pub type luxfer_segment_image = i32;
/// The mask: 1 where the confidence is above one half, else 0; 1 channel.
pub const LUXFER_SEGMENT_MASK: luxfer_segment_image = 0;
/// The confidence that a pixel is of the positive class, in [0, 1]; 1 channel. For a surface: the probability. For
/// lamps: 1 inside a lamp, 0 outside, 0.5 on its contour; it changes from 1 to 0 within about two pixels.
pub const LUXFER_SEGMENT_CONFIDENCE: luxfer_segment_image = 1;
/// How much a pixel differs from all pixels under strokes, in [0, 1]; 1 channel. For lamps: 1 in regions that resemble
/// the painted lamps but not closely enough for the mask, else 0. Another stroke helps where the value is high.
pub const LUXFER_SEGMENT_UNSEEN: luxfer_segment_image = 2;

/// The subject of a segmentation: a LUXFER_SUBJECT_ value.
pub type luxfer_subject = i32;
/// Chooses the subject: lamps if luxfer_segment_set_region gave a mask and the features have ten channels, as
/// luxfer_features makes them; else a surface.
pub const LUXFER_SUBJECT_AUTO: luxfer_subject = 0;
/// A surface, such as the plane that carries the lamps: each pixel is classified by its features. With the ten channels
/// of luxfer_features and without luxfer_segment_set_region, the mask is then restricted to the wall, the floor or the
/// ceiling that the positive strokes lie on. If the positive strokes lie on several of these surfaces, the mask keeps
/// only its connected parts that positive strokes touch.
pub const LUXFER_SUBJECT_SURFACE: luxfer_subject = 1;
/// Lamps: compact regions with a sharp contour, brighter than their surroundings. Each positive stroke marks one lamp
/// or more. Regions without a stroke that resemble the marked lamps and lie in the mask of luxfer_segment_set_region
/// count as lamps too. Negative strokes are not needed. The first three channels of the features must be CIELAB.
pub const LUXFER_SUBJECT_LAMPS: luxfer_subject = 2;

/// Settings of a segmentation. Fill them with luxfer_segment_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_segment_params {
    /// sizeof(luxfer_segment_params), set by luxfer_segment_params_init.
    pub struct_size: u32,
    /// Maximum number of pixels that are drawn as samples from the strokes of each class, in [1, 1000000]; default
    /// 1000.
    pub samples_per_class: u32,
    /// Channels of the features to use, bit i for channel i; default 0. With the ten channels of luxfer_features, 0
    /// tries four sets (colour; colour and position; colour and normal; all channels) and uses the set with the
    /// smallest error on held-out strokes. Sets with position are left out if the mask will be restricted to a wall,
    /// floor or ceiling of a room that was fitted as a box. With another number of channels, 0 uses all channels. If
    /// you segment lights as LUXFER_SUBJECT_SURFACE, use 7 (colour only), since lights and their plane have the same
    /// geometry.
    pub channels: u32,
    /// Half-width in pixels of the windows of an edge-aware refinement, in [0, 1024]; 0, the default: no refinement.
    /// The refinement makes the mask follow the edges of the photo: it is a guided filter with the first three
    /// channels of the features as guide.
    pub refine_radius: u32,
    /// Strength of the prior that keeps the weights of the classifier small (ridge regression), in [1e-9, 1e3];
    /// default 1e-3.
    pub ridge: f64,
    /// Seed of the samples that are drawn; default 1.
    pub seed: u64,
    /// Smallest contrast that the refinement by refine_radius follows. In windows in which the standard deviation of
    /// the first three channels is below this value, the refinement smooths the mask; in other windows, the mask
    /// follows the edges. In the unit of these channels (CIELAB units for colour), in [1e-3, 1e6]; default 8. No effect
    /// if refine_radius is 0.
    pub refine_tolerance: f64,
    /// Kind of object that the positive strokes mark: a LUXFER_SUBJECT_ value; default LUXFER_SUBJECT_AUTO. If the
    /// subject is lamps, the settings above have no effect.
    pub subject: luxfer_subject,
    /// Must be 0.
    pub reserved: u32,
}

versioned!(luxfer_segment_params, [48], {
    let defaults = segment::Params::default();
    Self {
        struct_size: 48,
        samples_per_class: defaults.samples_per_class as u32,
        channels: defaults.channels,
        refine_radius: defaults.refine_radius as u32,
        ridge: defaults.ridge,
        seed: defaults.seed,
        refine_tolerance: defaults.refine_tolerance,
        subject: LUXFER_SUBJECT_AUTO,
        reserved: 0,
    }
});

impl luxfer_segment_params {
    pub(super) fn params(&self) -> Result<segment::Params> {
        if self.reserved != 0 {
            return Err(Error::argument(format!("segment.reserved is {}; it must be 0", self.reserved)));
        }
        Ok(segment::Params {
            samples_per_class: self.samples_per_class as usize,
            channels: self.channels,
            ridge: self.ridge,
            seed: self.seed,
            refine_radius: self.refine_radius as usize,
            refine_tolerance: self.refine_tolerance,
            subject: subject(self.subject)?,
        })
    }
}

fn subject(value: luxfer_subject) -> Result<Subject> {
    match value {
        LUXFER_SUBJECT_AUTO => Ok(Subject::Auto),
        LUXFER_SUBJECT_SURFACE => Ok(Subject::Surface),
        LUXFER_SUBJECT_LAMPS => Ok(Subject::Lamps),
        _ => Err(Error::argument(format!("segment.subject is {value}; it must be a LUXFER_SUBJECT_ value"))),
    }
}

/// Quality of a segmentation.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_segment_report {
    /// sizeof(luxfer_segment_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Channels of the features that the segmentation has used, bit i for channel i.
    pub channels: u32,
    /// Expected share of wrong pixels, in [0, 1]. For a surface, it is estimated on strokes held out of the training.
    /// For lamps, it is the area of the lamps, times the share of wrong pixels that is usual in such lamps, divided by
    /// the area of the mask of luxfer_segment_set_region or, without this mask, of the photo.
    pub error: f64,
    /// Number of samples of the negative class.
    pub negative_samples: u64,
    /// Number of samples of the positive class.
    pub positive_samples: u64,
    /// Number of pixels that strokes of both classes cover. Such a pixel belongs to the later stroke.
    pub contradictory_pixels: u64,
}

versioned!(luxfer_segment_report, [40], {
    Self { struct_size: 40, channels: 0, error: 0.0, negative_samples: 0, positive_samples: 0, contradictory_pixels: 0 }
});

#[derive(Clone, Default)]
pub(super) struct Inputs {
    pub(super) features: Option<Arc<Pixels>>,
    pub(super) region: Option<Arc<Pixels>>,
    pub(super) strokes: Painted<Vec<Stroke>>,
}

impl Handle for luxfer_segment {
    type Object = Stage<Inputs, Segmentation>;
    const TAG: u64 = tag(b"lux.segm");
    const NAME: &'static str = "luxfer_segment";
}

/// Creates a segmentation. It has no inputs yet. The caller releases *segment. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_segment_create(
    context: *mut luxfer_context,
    segment: *mut *mut luxfer_segment,
) -> luxfer_status {
    enter(context, |object| {
        Out::new(segment, "segment")?.set(handle::give(Stage::new(object.context(), Inputs::default())));
        Ok(())
    })
}

/// Sets the features of each pixel: the image LUXFER_FEATURES_CHANNELS, or any image of 1 to 16 channels. Strokes for
/// images of another size are removed. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_segment_set_features(
    segment: *mut luxfer_segment,
    features: *mut luxfer_image,
) -> luxfer_status {
    enter(segment, |stage| {
        let features = handle::borrow_in(stage.context(), features, "features")?;
        stage.change(|inputs| {
            inputs.strokes.keep_for(features.size());
            inputs.features = Some(features);
            Ok(())
        })
    })
}

/// Restricts the segmentation to the pixels where region is 1. region is a mask with 1 channel, values of 0 and 1, and
/// the size of the features; for a segmentation of lights, it is the mask of the plane. NULL: no restriction. Any
/// thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_segment_set_region(
    segment: *mut luxfer_segment,
    region: *mut luxfer_image,
) -> luxfer_status {
    enter(segment, |stage| {
        let region = Pixels::optional(stage.context(), region, "region")?;
        stage.change(|inputs| {
            inputs.region = region;
            Ok(())
        })
    })
}

/// Sets the strokes from which the mask is made. The call copies the strokes for phase, a LUXFER_PHASE_ value; they
/// replace all earlier strokes. strokes may be NULL: no strokes. Any thread.
/// LUXFER_INVALID_ARGUMENT if the strokes are for images of another size than the features.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_segment_set_strokes(
    segment: *mut luxfer_segment,
    phase: luxfer_phase,
    strokes: *mut luxfer_strokes,
) -> luxfer_status {
    enter(segment, |stage| {
        let strokes = Painted::copy(stage.context(), strokes, |set| of_phase(set, phase))?;
        stage.change(|inputs| {
            strokes.check_size(inputs.features.as_ref().map(|features| features.size()), "the image of features")?;
            inputs.strokes = strokes;
            Ok(())
        })
    })
}

/// Starts a job that computes the mask. If strokes are missing and the features come from luxfer_features, the job
/// proposes a mask, with LUXFER_WARNING_PROPOSED. For a surface it proposes the wall, the floor or the ceiling under
/// the positive strokes; without positive strokes it proposes the ceiling. For lamps it proposes lamps among the
/// brightest regions of the mask of luxfer_segment_set_region. params may be NULL for the defaults. The caller
/// releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if the features are missing or a job is already running. The job may end with
/// LUXFER_DEGENERATE if strokes are missing and there is nothing to propose, LUXFER_INVALID_ARGUMENT if sizes differ,
/// a feature is not finite or a setting is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_segment_start(
    segment: *mut luxfer_segment,
    params: *const luxfer_segment_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(segment, |stage| {
        let params = params::read(params)?.params()?;
        need(&stage.inputs().features, "luxfer_segment_set_features")?;
        stage.start(job, move |inputs, _, job| {
            let input = segment::Input {
                features: need(&inputs.features, "luxfer_segment_set_features")?.image(),
                strokes: &inputs.strokes.taken,
                region: inputs.region.as_ref().map(|w| w.image()),
            };
            segment::run(&input, &params, job)
        })
    })
}

/// Gets the image of the result that kind, a LUXFER_SEGMENT_ value, selects, for example the mask. The caller releases
/// *image. Any thread.
/// LUXFER_NOT_READY before a job has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_segment_get_image(
    segment: *mut luxfer_segment,
    kind: luxfer_segment_image,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(segment, |stage| {
        let out = Out::new(image, "image")?;
        let pick: fn(&Segmentation) -> &Image = match kind {
            LUXFER_SEGMENT_MASK => |s| &s.mask,
            LUXFER_SEGMENT_CONFIDENCE => |s| &s.confidence,
            LUXFER_SEGMENT_UNSEEN => |s| &s.unseen,
            _ => return Err(Error::argument(format!("kind is {kind}; it must be a LUXFER_SEGMENT_ value"))),
        };
        out.set(handle::give(Pixels::part(stage.context(), stage.output()?, pick)));
        Ok(())
    })
}

/// Gets the quality of the segmentation. size is sizeof *report. Any thread.
/// LUXFER_NOT_READY before a job has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_segment_get_report(
    segment: *mut luxfer_segment,
    report: *mut luxfer_segment_report,
    size: usize,
) -> luxfer_status {
    enter(segment, |stage| {
        let out = Report::new(report, size)?;
        let output = stage.output()?;
        out.set(luxfer_segment_report {
            channels: output.channels,
            error: output.error,
            negative_samples: output.samples[0] as u64,
            positive_samples: output.samples[1] as u64,
            contradictory_pixels: output.contradictory as u64,
            ..luxfer_segment_report::defaults()
        });
        Ok(())
    })
}
