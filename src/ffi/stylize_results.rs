//! Results of a stylisation
//!
//! The picture, the place in the artwork from which each pixel was painted, and the error of the guides.

use super::guard::enter;
use super::handle::{self, Owned};
use super::image::{Pixels, luxfer_image};
use super::params::{Report, Versioned, versioned};
use super::pointer::Out;
use super::status::luxfer_status;
use super::stylize::luxfer_stylize;
use super::stylize_output::{Finished, Stylised};
use super::transfer::{LUXFER_STAGE_STYLIZE, luxfer_stage};
use super::warning::HasWarnings;
use crate::error::{Error, Result};
use crate::image::Image;
use crate::warning::Warning;
use std::sync::Arc;

/// An image of a stylisation: a LUXFER_STYLIZE_IMAGE_ value.
pub type luxfer_stylize_image = i32;
/// The stylised target, linear, with the artwork's channels. Before the last level, in preview and after a cancel it
/// is smaller than the target: the target's sides are halved luxfer_stylize_report.halvings times, rounded down.
pub const LUXFER_STYLIZE_IMAGE_PICTURE: luxfer_stylize_image = 0;
/// Weighted root mean square difference, in [0, 1], between the guides at a pixel and the guides at the place in the
/// exemplar from which the pixel was painted; 1 channel. It is high where nothing in the exemplar fits.
pub const LUXFER_STYLIZE_IMAGE_GUIDE_ERROR: luxfer_stylize_image = 1;
/// Position in the artwork from which each pixel was painted, x and y in pixels of the artwork, (0.5, 0.5) for the
/// top-left pixel; -1 where nothing was painted; 2 channels.
pub const LUXFER_STYLIZE_IMAGE_SOURCES: luxfer_stylize_image = 2;

/// Quality of a stylisation.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_stylize_report {
    /// sizeof(luxfer_stylize_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// 1 if the run is complete; 0 if only some levels are finished: then all fields but levels, halvings and energy
    /// are 0.
    pub is_complete: u32,
    /// Number of finished resolution levels.
    pub levels: u32,
    /// Number of times that the target's sides were halved to get the size of the picture.
    pub halvings: u32,
    /// Width of the patches, in pixels.
    pub patch: u32,
    /// Number of uses of the exemplar patch that was used most often.
    pub max_uses: u32,
    /// Mean squared difference of matched patches after the last round (Fiser et al. 2016, Eq. 3), with channels in [0,
    /// 1]. All channels of the artwork together have the weight 1. All guides together have the weight guide_weight;
    /// before the finest level is finished, they have guide_weight * coarse_guides.
    pub energy: f64,
    /// Share of the exemplar patches that were used, in [0, 1].
    pub used: f64,
    /// Entropy of the usage of exemplar patches, in bits.
    pub entropy: f64,
    /// Root mean square of LUXFER_STYLIZE_IMAGE_GUIDE_ERROR.
    pub guide_error: f64,
    /// Number of exemplar pixels that were not used because a value is not finite.
    pub broken_source: u64,
    /// Number of target pixels with a guide value that is not finite and was taken as 0.
    pub broken_target: u64,
    /// Share of the painted pixels that are unchanged copies of artwork pixels, in [0, 1]; the other painted pixels are
    /// blends of several artwork pixels. LUXFER_STYLIZE_VOTE_ADAPTIVE gives rough paint a larger share than smooth
    /// paint. luxfer_stylize_update leaves this value as the last full run has set it.
    pub unblended_share: f64,
    /// Weight of the normals as a guide, where each guide of light has 1; 0: the normals are not used. Unless the
    /// caller has given this weight, it is above 0 only if the strokes of the artwork follow the shapes; see
    /// luxfer_stylize_add_guides.
    pub normals_weight: f64,
}

versioned!(luxfer_stylize_report, [72, 80, 88], {
    Self {
        struct_size: 88,
        is_complete: 0,
        levels: 0,
        halvings: 0,
        patch: 0,
        max_uses: 0,
        energy: 0.0,
        used: 0.0,
        entropy: 0.0,
        guide_error: 0.0,
        broken_source: 0,
        broken_target: 0,
        unblended_share: 0.0,
        normals_weight: 0.0,
    }
});

impl luxfer_stylize_report {
    /// Returns a report with the fields that only a finished run has; the other fields have their defaults.
    fn of(finished: &Finished) -> Self {
        Self {
            is_complete: 1,
            patch: finished.patch as u32,
            max_uses: finished.usage.max_uses,
            used: finished.usage.used,
            entropy: finished.usage.entropy,
            guide_error: finished.guide_rms,
            broken_source: finished.broken[0] as u64,
            broken_target: finished.broken[1] as u64,
            unblended_share: finished.unblended_share,
            normals_weight: f64::from(finished.normals_weight),
            ..Self::defaults()
        }
    }
}

impl HasWarnings for luxfer_stylize {
    fn list(stage: &Self::Object) -> Result<Vec<(luxfer_stage, Warning)>> {
        let output = stage.output()?;
        let list = output.finished.as_ref().map_or(&[][..], |finished| &finished.warnings);
        Ok(list.iter().map(|warning| (LUXFER_STAGE_STYLIZE, warning.clone())).collect())
    }
}

/// Gets the image of the result that kind, a LUXFER_STYLIZE_IMAGE_ value, selects, for example the picture.
/// luxfer_stylize_update changes the picture and the sources only; the guide error stays as the last full run has left
/// it. The caller releases *image. Any thread.
/// LUXFER_NOT_READY before the first level of a job is finished; for images other than the picture, before the last
/// level is finished.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_get_image(
    stylize: *mut luxfer_stylize,
    kind: luxfer_stylize_image,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(stylize, |stage| {
        let out = Out::new(image, "image")?;
        let pick: fn(&Stylised) -> Result<&Arc<Image>> = match kind {
            LUXFER_STYLIZE_IMAGE_PICTURE => |s| Ok(&s.picture),
            LUXFER_STYLIZE_IMAGE_GUIDE_ERROR => |s| Ok(&s.need_finished()?.guide_error),
            LUXFER_STYLIZE_IMAGE_SOURCES => |s| Ok(&s.need_finished()?.sources),
            _ => return Err(Error::argument(format!("kind is {kind}; it must be a LUXFER_STYLIZE_IMAGE_ value"))),
        };
        let image = pick(&*stage.output()?)?.clone();
        out.set(handle::give(Pixels::part(stage.context(), image, |i| i)));
        Ok(())
    })
}

/// Gets the current quality of the result. size is sizeof *report. Any thread.
/// LUXFER_NOT_READY before the first level of a job is finished.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_get_report(
    stylize: *mut luxfer_stylize,
    report: *mut luxfer_stylize_report,
    size: usize,
) -> luxfer_status {
    enter(stylize, |stage| {
        let out = Report::new(report, size)?;
        let output = stage.output()?;
        let finished = output.finished.as_ref().map_or_else(luxfer_stylize_report::defaults, luxfer_stylize_report::of);
        out.set(luxfer_stylize_report {
            levels: output.levels.len() as u32,
            halvings: output.halvings as u32,
            energy: output.levels.last().and_then(|l| l.energy.last().copied()).unwrap_or(0.0),
            ..finished
        });
        Ok(())
    })
}
