//! Photometry
//!
//! Photometric quantities of lighting design: the correlated colour temperature of a light, and the glare of a view.
//! These calls are synchronous: they do their work before they return.

use super::context::luxfer_context;
use super::geometry::numbers;
use super::guard::enter;
use super::image::luxfer_image;
use super::params::{Report, Versioned, versioned};
use super::pointer::Out;
use super::status::luxfer_status;
use crate::error::{Error, check_range};
use crate::photometry::glare;
use crate::photometry::temperature::{self, MAX_KELVIN, MIN_KELVIN, Temperature};
use glam::DVec3;

/// The glare of a view: the result of luxfer_image_get_glare.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_glare_report {
    /// sizeof(luxfer_glare_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of glare sources.
    pub sources: u32,
    /// Unified glare rating (CIE 117): below 10 the glare causes no discomfort; 19 is the limit for offices; -infinity
    /// without sources.
    pub ugr: f64,
    /// Background luminance of the rating in cd/m²: the mean over the pixels that are not glare sources, weighted by
    /// their contribution to the illuminance at the eye.
    pub background: f64,
    /// The threshold that was used: pixels of at least this luminance in cd/m² counted as glare sources.
    pub threshold: f64,
    /// Solid angle of all sources in steradians.
    pub solid_angle: f64,
    /// Number of lights of the rendered scene that shine from points: point lights, spot lights, and luminaires without
    /// luminous opening. They are invisible in the image, and ugr leaves them out. Known only for images of
    /// luxfer_render_get_image and luxfer_render_get_layer; 0 for other images. If these lights include luminaires, the
    /// scene has LUXFER_WARNING_NOT_IN_PICTURE.
    pub unseen_lights: u32,
    /// Reserved; always 0.
    pub reserved: u32,
}

versioned!(luxfer_glare_report, [40, 48], {
    Self {
        struct_size: 48,
        sources: 0,
        ugr: 0.0,
        background: 0.0,
        threshold: 0.0,
        solid_angle: 0.0,
        unseen_lights: 0,
        reserved: 0,
    }
});

/// Gets the correlated colour temperature of rgb, a linear colour. *kelvin receives the temperature of the nearest
/// blackbody, in [1000, 20000]; *duv receives the signed distance from this blackbody in the CIE 1960 diagram, positive
/// for greenish and negative for pinkish colours. Any thread.
/// LUXFER_DEGENERATE if the colour is black or not finite.
/// cbindgen:ptrs-as-arrays=[[rgb; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_colour_to_temperature(
    context: *mut luxfer_context,
    rgb: *const f64,
    kelvin: *mut f64,
    duv: *mut f64,
) -> luxfer_status {
    enter(context, |_| {
        let (kelvin, duv) = (Out::new(kelvin, "kelvin")?, Out::new(duv, "duv")?);
        let [red, green, blue] = numbers(rgb, "rgb")?;
        let found = temperature::of_rgb(DVec3::new(red, green, blue));
        let found = found.ok_or_else(|| {
            Error::degenerate(format!("the colour ({red}, {green}, {blue}) is no light, and has no temperature"))
        })?;
        kelvin.set(found.kelvin);
        duv.set(found.duv);
        Ok(())
    })
}

/// Computes the linear colour, with luminance 1, of a colour temperature; rgb receives the colour. kelvin is in [1000,
/// 20000]. duv, in [-0.05, 0.05], is the signed distance from the blackbody locus in the CIE 1960 diagram, positive
/// towards green. A channel of rgb is negative if the colour is out of gamut. Any thread.
/// LUXFER_INVALID_ARGUMENT if a value is out of range.
/// cbindgen:ptrs-as-arrays=[[rgb; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_temperature_to_colour(
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

/// Rates the discomfort glare of a luminance image in cd/m² (1 channel, or linear RGB). The image is the view of a
/// level camera whose vertical angle of view is fov_y in radians, in [0.001, pi - 0.001]. Glare sources are the
/// connected regions of pixels with a luminance of at least threshold, in cd/m², in [0, 1e12]. If threshold is 0, five
/// times the mean luminance of the image is used. A wider angle of view gives a better estimate of the background
/// luminance. size is sizeof *report. Any thread.
/// LUXFER_INVALID_ARGUMENT if the image is not finite or a value is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_image_get_glare(
    image: *mut luxfer_image,
    fov_y: f64,
    threshold: f64,
    report: *mut luxfer_glare_report,
    size: usize,
) -> luxfer_status {
    enter(image, |object| {
        let out = Report::new(report, size)?;
        let rating = glare::rate(object.image(), &glare::Params { fov_y, threshold })?;
        out.set(luxfer_glare_report {
            sources: rating.sources.len() as u32,
            ugr: rating.ugr,
            background: rating.background,
            threshold: rating.threshold,
            solid_angle: rating.sources.iter().map(|s| s.solid_angle).sum(),
            unseen_lights: object.unseen_lights() as u32,
            ..luxfer_glare_report::defaults()
        });
        Ok(())
    })
}
