//! Exposures of one view
//!
//! Merges a bracket: photos of one view with different exposures. Photos of lit rooms clip at the lamps, so the colours
//! and luminances of the lamps are lost; the merged image takes them from the shorter exposures. Use the merged image
//! as the photo of a transfer.
//!
//! One of the photos is the reference. The merged image has its frame, its scale (the value 1 is its white) and its
//! metadata, so that luxfer_photo_metadata.white_luminance holds for the merged image too. Values above 1 are light
//! that the reference clips.
//!
//! Developed raw files and photos with the sRGB curve are linear once they are loaded. Where a camera applied another
//! tone curve, the ratio of two exposures depends on the brightness, and lamps would become too bright or too dark. If
//! the exposures are known, the library recovers this curve from the photos and undoes it; the report states the curve
//! and its error. If the exposures are unknown, the photos must be linear: they determine a curve only up to an
//! exponent.

use super::context::{Context, luxfer_context};
use super::guard::enter;
use super::handle::{self, Owned};
use super::image::{Pixels, luxfer_image};
use super::params::{self, Report, Versioned, flag, versioned};
use super::pointer::{Out, bytes};
use super::status::luxfer_status;
use crate::error::{Error, Result};
use crate::image::bracket::{self, CURVE_VALUES, MAX_PHOTOS, Params, Source, ToneCurve};
use crate::image::colour::srgb_to_linear;
use crate::image::photo::PhotoMetadata;
use std::sync::Arc;

/// Where the exposures of photos come from: a LUXFER_EXPOSURE_SOURCE_ value.
pub type luxfer_exposure_source = i32;
/// From the metadata and the pixels, weighted by their errors; where one of the two sources is missing, from the other
/// source alone. If the two contradict each other by more than a third of a stop, luxfer_image_merge_exposures returns
/// LUXFER_INVALID_ARGUMENT.
pub const LUXFER_EXPOSURE_SOURCE_BOTH: luxfer_exposure_source = 0;
/// From the exposure time, ISO speed and f-number in the files.
pub const LUXFER_EXPOSURE_SOURCE_METADATA: luxfer_exposure_source = 1;
/// From pixels that two neighbouring exposures both show well.
pub const LUXFER_EXPOSURE_SOURCE_PIXELS: luxfer_exposure_source = 2;

/// The tone curve with which photos were taken: a LUXFER_TONE_CURVE_ value.
pub type luxfer_tone_curve = i32;
/// That of sRGB, unless the exposures are known and the photos agree significantly better with another curve, which is
/// then undone. Exposures are known from the field exposures, or from the metadata.
pub const LUXFER_TONE_CURVE_RECOVERED: luxfer_tone_curve = 0;
/// That of sRGB: the photos are linear as they are.
pub const LUXFER_TONE_CURVE_SRGB: luxfer_tone_curve = 1;

/// Settings for merging exposures. Fill them with luxfer_merge_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_merge_params {
    /// sizeof(luxfer_merge_params), set by luxfer_merge_params_init.
    pub struct_size: u32,
    /// Where the exposures come from, unless the field exposures states them: a LUXFER_EXPOSURE_SOURCE_ value; default
    /// LUXFER_EXPOSURE_SOURCE_BOTH.
    pub source: luxfer_exposure_source,
    /// Index of the reference; -1, the default: the photo with the most pixels that are well exposed.
    pub reference: i32,
    /// Treatment of pixels at which the exposures differ by more than noise explains, because something moved. 0, the
    /// default: a pixel is averaged only over the exposures that agree with the reference or, where the reference is
    /// clipped, with the next shorter exposure that is not clipped. 1: all exposures are averaged.
    pub keep_moving: u32,
    /// Largest shift between photos that are neighbours in exposure, as a part of the longer side of a photo, in [0,
    /// 0.25]; default 0.03. 0: the photos are not aligned, as for a camera on a tripod.
    pub max_shift: f64,
    /// Value in [0.1, 1] from which on a channel counts as clipped; default 0.95. A photo with any value above 2 counts
    /// as a photo of high dynamic range, in which no pixel is clipped.
    pub saturation: f64,
    /// Exposure of each photo in any unit, such as seconds, in [1e-9, 1e9]; all 0, the default: see the field source.
    /// Elements beyond the number of photos must be 0.
    pub exposures: [f64; 16],
    /// Tone curve of the photos: a LUXFER_TONE_CURVE_ value; default LUXFER_TONE_CURVE_RECOVERED.
    pub tone_curve: luxfer_tone_curve,
    /// Reserved; always 0.
    pub reserved: u32,
}

versioned!(luxfer_merge_params, [168], {
    let d = Params::default();
    Self {
        struct_size: 168,
        source: LUXFER_EXPOSURE_SOURCE_BOTH,
        reference: -1,
        keep_moving: u32::from(d.keep_moving),
        max_shift: d.max_shift,
        saturation: d.saturation,
        exposures: [0.0; 16],
        tone_curve: LUXFER_TONE_CURVE_RECOVERED,
        reserved: 0,
    }
});

impl luxfer_merge_params {
    fn params(&self, count: usize) -> Result<Params> {
        let source = match self.source {
            LUXFER_EXPOSURE_SOURCE_BOTH => Source::Both,
            LUXFER_EXPOSURE_SOURCE_METADATA => Source::Metadata,
            LUXFER_EXPOSURE_SOURCE_PIXELS => Source::Pixels,
            other => {
                return Err(Error::argument(format!("source is {other}; it must be a LUXFER_EXPOSURE_SOURCE_ value")));
            }
        };
        let (given, beyond) = self.exposures.split_at(count.min(MAX_PHOTOS));
        if let Some(i) = beyond.iter().position(|&v| v != 0.0) {
            let (value, i) = (beyond[i], i + given.len());
            return Err(Error::argument(format!("exposures[{i}] is {value}; it must be 0 for {count} photos")));
        }
        if self.reference < -1 {
            return Err(Error::argument(format!(
                "reference is {}; it must be -1 or the index of one of the {count} photos",
                self.reference
            )));
        }
        let tone_curve = match self.tone_curve {
            LUXFER_TONE_CURVE_RECOVERED => ToneCurve::Recovered,
            LUXFER_TONE_CURVE_SRGB => ToneCurve::Srgb,
            other => {
                return Err(Error::argument(format!("tone_curve is {other}; it must be a LUXFER_TONE_CURVE_ value")));
            }
        };
        if self.reserved != 0 {
            return Err(Error::argument(format!("reserved is {}; it must be 0", self.reserved)));
        }
        let are_given = given.iter().any(|&v| v != 0.0);
        Ok(Params {
            source,
            exposures: if are_given { given.to_vec() } else { Vec::new() },
            reference: usize::try_from(self.reference).ok(),
            keep_moving: flag(self.keep_moving, "keep_moving")?,
            max_shift: self.max_shift,
            saturation: self.saturation,
            tone_curve,
        })
    }
}

/// The exposures and shifts that luxfer_image_merge_exposures found. Arrays have an element for each photo, in the
/// order of the photos; further elements are 0.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_merge_report {
    /// sizeof(luxfer_merge_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of photos.
    pub count: u32,
    /// Index of the reference.
    pub reference: u32,
    /// Reserved; always 0.
    pub reserved: u32,
    /// Part of the pixels that are clipped in every photo that shows them, in [0, 1]. Their values come from the
    /// shortest exposure and are lower bounds.
    pub clipped: f64,
    /// Part of the pixels at which neighbouring exposures differ by more than noise explains, in [0, 1]; 0 if
    /// keep_moving is 1.
    pub moved: f64,
    /// Exposure of each photo divided by the exposure of the reference: a ratio of amounts of light, not of stops;
    /// above 1 for a photo with more light, 1 for the reference.
    pub exposures: [f64; 16],
    /// Relative standard error of each exposure; 0 for exposures that luxfer_merge_params.exposures states.
    pub errors: [f64; 16],
    /// Exposure of each photo divided by the exposure of the reference, as the metadata state it; 0 = unknown.
    pub stated: [f64; 16],
    /// Column of each photo that shows the part of the view that column 0 of the reference shows; below 0 if the photo
    /// does not show that part.
    pub shift_x: [i32; 16],
    /// Row of each photo that shows the part of the view that row 0 of the reference shows; below 0 if the photo does
    /// not show that part.
    pub shift_y: [i32; 16],
    /// The tone curve that the photos were taken to have: LUXFER_TONE_CURVE_RECOVERED if another curve than that of
    /// sRGB was recovered and undone, else LUXFER_TONE_CURVE_SRGB.
    pub tone_curve: luxfer_tone_curve,
    /// 1 if the photos contradict the tone curve of sRGB and no other curve was recovered, because the exposures are
    /// unknown, the levels of the photos determine no curve, or the settings say so: the light of the merged image is
    /// then wrong by more than noise, and you should state the exposures. 0 otherwise.
    pub contradicts_srgb: u32,
    /// Largest error of the recovered curve, as a share of the light, over the codes that two photos show: of the light
    /// at a code, relative to the light at the brightest of these codes. For brighter codes, which one photo shows at
    /// most, the curve of sRGB is assumed. 0 without a recovered curve.
    pub tone_curve_error: f64,
    /// Light at the codes 0, 1/16, ... 1 of the photos' files, relative to white: of the recovered curve, or else of
    /// sRGB.
    pub tone_curve_light: [f64; 17],
}

versioned!(luxfer_merge_report, [544, 696], {
    Self {
        struct_size: 696,
        count: 0,
        reference: 0,
        reserved: 0,
        clipped: 0.0,
        moved: 0.0,
        exposures: [0.0; 16],
        errors: [0.0; 16],
        stated: [0.0; 16],
        shift_x: [0; 16],
        shift_y: [0; 16],
        tone_curve: LUXFER_TONE_CURVE_SRGB,
        contradicts_srgb: 0,
        tone_curve_error: 0.0,
        tone_curve_light: [0.0; 17],
    }
});

impl luxfer_merge_report {
    fn new(found: &bracket::Report) -> Self {
        let mut report = Self::defaults();
        (report.count, report.reference) = (found.photos.len() as u32, found.reference as u32);
        (report.clipped, report.moved) = (found.clipped, found.moved);
        report.tone_curve_light = match &found.curve {
            Some(curve) => curve.light,
            None => std::array::from_fn(|k| f64::from(srgb_to_linear(k as f32 / (CURVE_VALUES - 1) as f32))),
        };
        if let Some(curve) = &found.curve {
            (report.tone_curve, report.tone_curve_error) = (LUXFER_TONE_CURVE_RECOVERED, curve.error);
        }
        report.contradicts_srgb = u32::from(found.contradicts_srgb);
        for (i, photo) in found.photos.iter().enumerate().take(MAX_PHOTOS) {
            (report.exposures[i], report.errors[i], report.stated[i]) = (photo.exposure, photo.error, photo.stated);
            (report.shift_x[i], report.shift_y[i]) = (photo.shift[0] as i32, photo.shift[1] as i32);
        }
        report
    }
}

/// Merges count photos of one view, in [1, 16], in any order, into one image. The photos have one size and one number
/// of channels (1, 3 or 4; the result has the alpha of the reference). They may be shifted by whole pixels, as handheld
/// photos are. Where a photo is rotated against the reference, or something moves, fewer exposures are used. params may
/// be NULL for the defaults. size is sizeof *report; report may be NULL, then size does not matter. The call is
/// synchronous. The caller releases *image. Any thread.
///
/// The estimate of a pixel is the sum of its values divided by the sum of their exposures, which has the least noise
/// that photons allow. The weight of a value falls from 1 at 80 % of the clipping value to 0 at the clipping value. A
/// single photo is returned as it is.
/// LUXFER_INVALID_ARGUMENT if a setting or a photo is not as stated, if samples are NaN or infinite, or if metadata and
/// pixels contradict each other (the message states both); LUXFER_DEGENERATE if exposures are unknown and cannot be
/// measured, because too few pixels are well exposed in two neighbours; LUXFER_OUT_OF_MEMORY beyond the memory budget.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_image_merge_exposures(
    context: *mut luxfer_context,
    photos: *const *mut luxfer_image,
    count: usize,
    params: *const luxfer_merge_params,
    image: *mut *mut luxfer_image,
    report: *mut luxfer_merge_report,
    size: usize,
) -> luxfer_status {
    enter(context, |object| {
        let context = object.context();
        let out = Out::new(image, "image")?;
        let report = if report.is_null() { None } else { Some(Report::new(report, size)?) };
        let photos = handles(context, photos, count)?;
        let params = params::read(params)?.params(count)?;
        let images: Vec<_> = photos.iter().map(|photo| photo.image()).collect();
        let metadata: Vec<PhotoMetadata> = photos.iter().map(|photo| *photo.metadata()).collect();
        let mut found = bracket::Report::default();
        let first = images[0];
        let image = Pixels::photo(context, first.width, first.height, first.channels, || {
            let monitor = context.monitor();
            let (image, of_merge) = context.quick.run(|| bracket::merge(&images, &metadata, &params, monitor.job()))?;
            found = of_merge;
            Ok((image, metadata[found.reference]))
        })?;
        out.set(handle::give(image));
        if let Some(report) = report {
            report.set(luxfer_merge_report::new(&found));
        }
        Ok(())
    })
}

/// Reads the caller's array of photos.
fn handles(context: &Arc<Context>, photos: *const *mut luxfer_image, count: usize) -> Result<Vec<Arc<Pixels>>> {
    if !(1..=MAX_PHOTOS).contains(&count) {
        return Err(Error::argument(format!("count is {count}; a bracket has 1 to {MAX_PHOTOS} photos")));
    }
    let array = bytes(photos.cast(), count * size_of::<*mut luxfer_image>(), "photos")?;
    let handle = |i: usize| {
        // SAFETY: element `i` lies in `array`; it may be at any alignment.
        let handle = unsafe { array.as_ptr().cast::<*mut luxfer_image>().add(i).read_unaligned() };
        handle::borrow_in(context, handle, &format!("photos[{i}]"))
    };
    (0..count).map(handle).collect()
}
