//! False colour
//!
//! Shows a luminance or illuminance image in false colours, with a scale bar. The colours become lighter as the value
//! rises.

use super::guard::enter;
use super::handle::{self, Owned};
use super::image::{Pixels, luxfer_image};
use super::params::{self, versioned};
use super::pointer::Out;
use super::status::luxfer_status;
use crate::error::{Error, Result};
use crate::photometry::false_colour::{self, Params, Scale, Unit};

/// The scale that maps values to colours: a LUXFER_SCALE_ value.
pub type luxfer_scale = i32;
/// Linear: equal differences of the value take equal lengths of the scale bar.
pub const LUXFER_SCALE_LINEAR: luxfer_scale = 0;
/// Logarithmic: each factor of ten takes an equal length of the scale bar.
pub const LUXFER_SCALE_LOGARITHMIC: luxfer_scale = 1;

/// The quantity of an image's values: a LUXFER_UNIT_ value.
pub type luxfer_unit = i32;
/// Luminance in cd/m².
pub const LUXFER_UNIT_LUMINANCE: luxfer_unit = 0;
/// Illuminance in lux.
pub const LUXFER_UNIT_ILLUMINANCE: luxfer_unit = 1;

/// Settings of a false colour image. Fill them with luxfer_false_colour_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_false_colour_params {
    /// sizeof(luxfer_false_colour_params), set by luxfer_false_colour_params_init.
    pub struct_size: u32,
    /// Scale that maps values to colours: a LUXFER_SCALE_ value; default LUXFER_SCALE_LINEAR.
    pub scale: luxfer_scale,
    /// Quantity of the values, whose unit is written above the bar: a LUXFER_UNIT_ value; default
    /// LUXFER_UNIT_LUMINANCE.
    pub unit: luxfer_unit,
    /// 1, the default: draw a scale bar beside the image, which makes it wider; 0: no bar.
    pub bar: u32,
    /// Value that gets the darkest colour, >= 0; default 0. On a logarithmic scale, 0 stands for a thousandth of the
    /// value that gets the lightest colour.
    pub minimum: f64,
    /// Value that gets the lightest colour, greater than minimum; 0, the default: the largest finite value of the
    /// image.
    pub maximum: f64,
}

versioned!(luxfer_false_colour_params, [32], {
    let d = Params::default();
    Self {
        struct_size: 32,
        scale: LUXFER_SCALE_LINEAR,
        unit: LUXFER_UNIT_LUMINANCE,
        bar: u32::from(d.bar),
        minimum: d.minimum,
        maximum: d.maximum,
    }
});

impl luxfer_false_colour_params {
    fn params(&self) -> Result<Params> {
        let scale = match self.scale {
            LUXFER_SCALE_LINEAR => Scale::Linear,
            LUXFER_SCALE_LOGARITHMIC => Scale::Logarithmic,
            other => return Err(Error::argument(format!("scale is {other}; it must be a LUXFER_SCALE_ value"))),
        };
        let unit = match self.unit {
            LUXFER_UNIT_LUMINANCE => Unit::Luminance,
            LUXFER_UNIT_ILLUMINANCE => Unit::Illuminance,
            other => return Err(Error::argument(format!("unit is {other}; it must be a LUXFER_UNIT_ value"))),
        };
        if self.bar > 1 {
            return Err(Error::argument(format!("bar is {}; it must be 0 or 1", self.bar)));
        }
        Ok(Params { scale, unit, minimum: self.minimum, maximum: self.maximum, bar: self.bar == 1 })
    }
}

/// Shows image in false colours: *shown receives a linear RGB image. An image of 1 channel is shown by its values, a
/// linear RGB image by its luminance. Values below minimum get the darkest colour, values above maximum the lightest;
/// NaN becomes grey. params may be NULL for the defaults. The call takes a few milliseconds per megapixel. The caller
/// releases *shown. Any thread.
/// LUXFER_INVALID_ARGUMENT if the range is empty: maximum is not greater than minimum, or maximum is 0 and the image is
/// black; LUXFER_OUT_OF_MEMORY beyond the memory budget.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_image_false_colour(
    image: *mut luxfer_image,
    params: *const luxfer_false_colour_params,
    shown: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(image, |object| {
        let out = Out::new(shown, "shown")?;
        let params = params::read(params)?.params()?;
        let source = object.image();
        let width = source.width + false_colour::bar_width(source, &params)?;
        let shown = Pixels::counted(object.context(), width, source.height, 3, || {
            object.context().quick.run(|| false_colour::render(source, &params))
        })?;
        out.set(handle::give(shown));
        Ok(())
    })
}
