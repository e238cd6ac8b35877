//! Photometry
//!
//! Photometric quantities of lighting design: the correlated colour temperature of a light, and the glare of a view.
//! These calls are synchronous: they do their work before they return.

use super::context::luxfer_context;
use super::geometry::numbers;
use super::guard::enter;
use super::image::{Pixels, luxfer_image};
use super::params::{self, Report, Versioned, versioned};
use super::pointer::Out;
use super::status::luxfer_status;
use crate::error::{Error, Result, check_range};
use crate::photometry::glare::{self, Projection};
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
    /// Daylight glare probability (Wienold and Christoffersen 2006), at most 1: 5.87e-5 E + 0.0918 log10(1 + sum of
    /// L² w / (E^1.87 p²)) + 0.16, with the vertical illuminance E in lux and the luminance L, solid angle w and
    /// position index p of each source. Below 0.35 glare is imperceptible; above 0.45 it is intolerable. The formula
    /// was found for values from 0.2 to 0.8 and E of at least 380 lux.
    pub dgp: f64,
    /// Illuminance in lux at the eye, on a plane across the line of sight, from which dgp was computed: the setting
    /// vertical_illuminance of luxfer_glare_params or, if that is 0, the illuminance from all pixels of the image. The
    /// latter is too low, and dgp wrong, if the image does not show the whole half-space ahead.
    pub vertical_illuminance: f64,
    /// The field dgp corrected for low light, as versions 1 and 2 of evalglare do: below 1000 lux, it is multiplied by
    /// 1 / (1 + exp(4 - 0.024 E)).
    pub dgp_low_light: f64,
}

versioned!(luxfer_glare_report, [40, 72], {
    Self {
        struct_size: 72,
        sources: 0,
        ugr: 0.0,
        background: 0.0,
        threshold: 0.0,
        solid_angle: 0.0,
        unseen_lights: 0,
        reserved: 0,
        dgp: 0.0,
        vertical_illuminance: 0.0,
        dgp_low_light: 0.0,
    }
});

/// The projection of an image: a LUXFER_PROJECTION_ value.
pub type luxfer_projection = i32;
/// Perspective: the image of a pinhole camera.
pub const LUXFER_PROJECTION_PERSPECTIVE: luxfer_projection = 0;
/// Angular (equidistant) fisheye: the distance of a pixel from the centre of the image is proportional to the angle
/// between its direction and the line of sight, as in Radiance's views of type a.
pub const LUXFER_PROJECTION_ANGULAR: luxfer_projection = 1;

/// Settings of the glare rating of an image. Fill them with luxfer_glare_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_glare_params {
    /// sizeof(luxfer_glare_params), set by luxfer_glare_params_init.
    pub struct_size: u32,
    /// Projection of the image: a LUXFER_PROJECTION_ value; default LUXFER_PROJECTION_PERSPECTIVE.
    pub projection: luxfer_projection,
    /// Vertical angle of view of the image in radians, in [0.001, pi - 0.001]; with LUXFER_PROJECTION_ANGULAR in
    /// [0.001, 2 pi]; default pi / 2. Pixels that are a right angle or more away from the line of sight do not count.
    pub fov_y: f64,
    /// Luminance in cd/m² from which on a pixel belongs to a glare source, in [0, 1e12]; 0, the default: five times the
    /// mean luminance of the image.
    pub threshold: f64,
    /// Illuminance in lux at the eye on a plane across the line of sight, in [0, 1e12], for an image that does not show
    /// the whole half-space ahead; 0, the default: the illuminance from all pixels of the image.
    pub vertical_illuminance: f64,
}

versioned!(luxfer_glare_params, [32], {
    Self {
        struct_size: 32,
        projection: LUXFER_PROJECTION_PERSPECTIVE,
        fov_y: std::f64::consts::FRAC_PI_2,
        threshold: 0.0,
        vertical_illuminance: 0.0,
    }
});

impl luxfer_glare_params {
    fn to_params(self) -> Result<glare::Params> {
        let projection = match self.projection {
            LUXFER_PROJECTION_PERSPECTIVE => Projection::Perspective,
            LUXFER_PROJECTION_ANGULAR => Projection::Angular,
            other => {
                return Err(Error::argument(format!("projection is {other}; it must be a LUXFER_PROJECTION_ value")));
            }
        };
        let Self { fov_y, threshold, vertical_illuminance, .. } = self;
        Ok(glare::Params { projection, fov_y, threshold, vertical_illuminance })
    }
}

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

/// Rates the discomfort glare of a luminance image in cd/m² (1 channel, or linear RGB), as luxfer_image_rate_glare
/// does. The image is the view of a level camera whose vertical angle of view is fov_y in radians, in [0.001, pi -
/// 0.001]. Glare sources are the connected regions of pixels with a luminance of at least threshold, in cd/m², in
/// [0, 1e12]. If threshold is 0, five times the mean luminance of the image is used. A wider angle of view gives a
/// better estimate of the background luminance. size is sizeof *report. Any thread.
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
        let params = glare::Params { fov_y, threshold, ..glare::Params::default() };
        rate(object, &params, Report::new(report, size)?)
    })
}

/// Rates the discomfort glare of a luminance image in cd/m² (1 channel, or linear RGB): the unified glare rating and
/// the daylight glare probability. The image is the view of a level camera. Glare sources are the connected regions of
/// pixels with a luminance of at least the threshold. For a daylight glare probability, give an angular image of the
/// half-space ahead, or the vertical illuminance. params NULL: the defaults. size is sizeof *report. Any thread.
/// LUXFER_INVALID_ARGUMENT if the image is not finite or a value is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_image_rate_glare(
    image: *mut luxfer_image,
    params: *const luxfer_glare_params,
    report: *mut luxfer_glare_report,
    size: usize,
) -> luxfer_status {
    enter(image, |object| rate(object, &params::read(params)?.to_params()?, Report::new(report, size)?))
}

fn rate(image: &Pixels, params: &glare::Params, out: Report<luxfer_glare_report>) -> Result<()> {
    let rating = glare::rate(image.image(), params)?;
    out.set(luxfer_glare_report {
        sources: rating.sources.len() as u32,
        ugr: rating.ugr,
        background: rating.background,
        threshold: rating.threshold,
        solid_angle: rating.sources.iter().map(|s| s.solid_angle).sum(),
        unseen_lights: image.unseen_lights() as u32,
        dgp: rating.dgp,
        vertical_illuminance: rating.vertical_illuminance,
        dgp_low_light: rating.dgp_low_light,
        ..luxfer_glare_report::defaults()
    });
    Ok(())
}
