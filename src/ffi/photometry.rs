//! Photometry
//!
//! What lighting design calls a light: its correlated colour temperature, and the glare of a view. These calls return when
//! they are done.

use super::context::luxfer_context;
use super::guard::enter;
use super::image::luxfer_image;
use super::params::{Report, Versioned};
use super::pointer::Out;
use super::status::luxfer_status;
use crate::error::{Error, check_range};
use crate::photometry::glare;
use crate::photometry::temperature::{self, MAX_KELVIN, MIN_KELVIN, Temperature};
use glam::DVec3;

/// The glare of a view. Set struct_size before the call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_glare_report {
    /// sizeof(luxfer_glare_report), set by the caller.
    pub struct_size: u32,
    /// Sources of glare.
    pub sources: u32,
    /// Unified glare rating (CIE 117): below 10 means none, 19 is what offices may have; -infinity without sources.
    pub ugr: f64,
    /// Luminance of the background in cd/m².
    pub background: f64,
    /// Luminance from which on a pixel counted as glare, in cd/m².
    pub threshold: f64,
    /// Solid angle of all sources in steradian.
    pub solid_angle: f64,
}

// SAFETY: plain numbers.
unsafe impl Versioned for luxfer_glare_report {
    const NAME: &'static str = "luxfer_glare_report";
    const SIZES: &'static [usize] = &[40];
    fn defaults() -> Self {
        Self { struct_size: 40, sources: 0, ugr: 0.0, background: 0.0, threshold: 0.0, solid_angle: 0.0 }
    }
}

/// Names a linear colour by the blackbody nearest to it: *kelvin receives the correlated colour temperature, in [1000, 20000],
/// *duv the distance from it in the CIE 1960 diagram, positive where it is greenish. Any thread.
/// LUXFER_DEGENERATE if the colour is black or not finite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_colour_temperature(
    context: *mut luxfer_context,
    red: f64,
    green: f64,
    blue: f64,
    kelvin: *mut f64,
    duv: *mut f64,
) -> luxfer_status {
    enter(context, |_| {
        let (kelvin, duv) = (Out::new(kelvin, "kelvin")?, Out::new(duv, "duv")?);
        let found = temperature::of_rgb(DVec3::new(red, green, blue));
        let found = found.ok_or_else(|| {
            Error::degenerate(format!("the colour ({red}, {green}, {blue}) is no light, and has no temperature"))
        })?;
        kelvin.set(found.kelvin);
        duv.set(found.duv);
        Ok(())
    })
}

/// Fills rgb, three numbers, with the linear colour of luminance 1 of a temperature in [1000, 20000] kelvin, at a distance
/// duv, in [-0.05, 0.05], from the blackbody; a channel is negative where the colour is out of gamut. Any thread.
/// LUXFER_INVALID_ARGUMENT if a value is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_colour_of_temperature(
    context: *mut luxfer_context,
    kelvin: f64,
    duv: f64,
    rgb: *mut f64,
) -> luxfer_status {
    enter(context, |_| {
        let out = Out::new(rgb.cast::<[f64; 3]>(), "rgb")?;
        check_range("kelvin", kelvin, MIN_KELVIN, MAX_KELVIN)?;
        check_range("duv", duv, -0.05, 0.05)?;
        out.set(temperature::to_rgb(Temperature { kelvin, duv }).to_array());
        Ok(())
    })
}

/// Rates the discomfort glare of a luminance image in cd/m² (1 channel, or linear RGB): what a level view sees whose vertical
/// angle is fov_y, in radians. Sources are the connected patches from a luminance of threshold on; 0 = five times the mean.
/// The wider the image, the truer its background. Any thread.
/// LUXFER_INVALID_ARGUMENT if the image is not finite or a value is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_image_glare(
    image: *mut luxfer_image,
    fov_y: f64,
    threshold: f64,
    report: *mut luxfer_glare_report,
) -> luxfer_status {
    enter(image, |object| {
        let out = Report::new(report)?;
        let rating = glare::rate(object.image(), &glare::Params { fov_y, threshold })?;
        out.set(luxfer_glare_report {
            sources: rating.sources.len() as u32,
            ugr: rating.ugr,
            background: rating.background,
            threshold: rating.threshold,
            solid_angle: rating.sources.iter().map(|s| s.solid_angle).sum(),
            ..luxfer_glare_report::defaults()
        });
        Ok(())
    })
}
