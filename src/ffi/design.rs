//! Lighting design
//!
//! Helps to realise a computed light with real luminaires. The functions find the drive levels at which LEDs mix a
//! given colour, and the blackbody light that brings a target nearest to a wanted radiance. They also list requirements
//! of the standard EN 12464-1. These calls are synchronous: they do their work before they return.

use super::context::luxfer_context;
use super::geometry::{list, numbers};
use super::guard::enter;
use super::params::{Report, Versioned, versioned};
use super::pointer::{Out, bytes_mut};
use super::scene::missing;
use super::status::luxfer_status;
use crate::error::{Error, Result, check_range};
use crate::photometry::presets::{PRESETS, Preset};
use crate::photometry::temperature;
use crate::relight::{MAX_PRIMARIES, mix_primaries};
use glam::DVec3;
use std::ffi::c_char;

/// A colour mixed from LED primaries: the result of luxfer_mix_primaries.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_mixture {
    /// sizeof(luxfer_mixture), set by the function that fills the struct.
    pub struct_size: u32,
    /// 1 if the mixture equals the requested colour; 0 if the primaries cannot reach it and this is the nearest
    /// mixture.
    pub in_gamut: u32,
    /// Linear RGB colour of the mixture, in the unit of the primaries.
    pub colour: [f64; 3],
    /// CIEDE2000 difference from the requested colour, at the exposure that shows the requested colour as middle grey.
    pub delta_e: f64,
}

versioned!(luxfer_mixture, [40], { Self { struct_size: 40, in_gamut: 0, colour: [0.0; 3], delta_e: 0.0 } });

/// The blackbody light that fits a target best: the result of luxfer_fit_temperature.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_temperature_fit {
    /// sizeof(luxfer_temperature_fit), set by the function that fills the struct.
    pub struct_size: u32,
    /// Reserved; always 0.
    pub reserved: u32,
    /// Correlated colour temperature, in [1000, 20000] kelvin.
    pub kelvin: f64,
    /// Luminance of the emission, >= 0. It is in cd/m² if the array response of luxfer_fit_temperature was measured
    /// for a white emission of 1 cd/m².
    pub luminance: f64,
    /// Mean radiance of the target from this light and all other lights together, in cd/m² per channel.
    pub achieved: [f64; 3],
    /// CIEDE2000 difference between the field achieved and the wanted radiance, at the exposure that shows the wanted
    /// radiance as middle grey.
    pub delta_e: f64,
}

versioned!(luxfer_temperature_fit, [56], {
    Self { struct_size: 56, reserved: 0, kelvin: 0.0, luminance: 0.0, achieved: [0.0; 3], delta_e: 0.0 }
});

/// Requirements of EN 12464-1 for one kind of room, as manufacturers of luminaires quote them. Only the standard
/// itself is binding.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_preset {
    /// sizeof(luxfer_preset), set by the function that fills the struct.
    pub struct_size: u32,
    /// Year of the edition of the standard.
    pub edition: u32,
    /// Minimum mean illuminance of the task area (maintained illuminance), in lux.
    pub illuminance: f64,
    /// Maximum unified glare rating.
    pub glare: f64,
    /// Minimum uniformity U0 (minimum / mean illuminance) of the task area.
    pub uniformity: f64,
    /// Minimum general colour rendering index Ra.
    pub rendering: f64,
    /// Minimum mean illuminance of the walls, in lux; 0 if there is no requirement.
    pub walls: f64,
    /// Minimum mean illuminance of the ceiling, in lux; 0 if there is no requirement.
    pub ceiling: f64,
    /// The name, such as "office: filing, copying", in UTF-8; valid as long as the library is loaded.
    pub name: *const c_char,
}

versioned!(luxfer_preset, [64], {
    let (illuminance, glare, uniformity, rendering) = (0.0, 0.0, 0.0, 0.0);
    let name = std::ptr::null();
    Self { struct_size: 64, edition: 0, illuminance, glare, uniformity, rendering, walls: 0.0, ceiling: 0.0, name }
});

/// Mixes rgb, a linear colour with channels that are finite and >= 0, from the LEDs of a luminaire. The array primaries
/// holds three numbers for each of count LEDs: the linear RGB of the LED at drive level 1. These numbers may be
/// negative, because the colours of most LEDs lie outside the gamut of Rec.709. count is in [1, 64].
///
/// The array drives receives the drive levels of the count LEDs, each in [0, max_drive]; max_drive is >= 0 and may be
/// infinite. If no mixture has the colour, the result is the mixture with the smallest squared difference in linear
/// RGB. If several mixtures have the colour, the result is the mixture with the smallest sum of squared drive levels.
/// size is sizeof *mixture. Any thread.
/// LUXFER_DEGENERATE if all primaries are black, LUXFER_INVALID_ARGUMENT if a number is out of range.
/// cbindgen:ptrs-as-arrays=[[rgb; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_mix_primaries(
    context: *mut luxfer_context,
    primaries: *const f64,
    count: usize,
    max_drive: f64,
    rgb: *const f64,
    drives: *mut f64,
    mixture: *mut luxfer_mixture,
    size: usize,
) -> luxfer_status {
    enter(context, |_| {
        let out = Report::new(mixture, size)?;
        check_range("count", count, 1, MAX_PRIMARIES)?;
        let primaries = list(primaries, 3 * count, "primaries")?;
        let primaries: Vec<DVec3> = primaries.chunks_exact(3).map(DVec3::from_slice).collect();
        let places = bytes_mut(drives.cast(), count * size_of::<f64>(), "drives")?;
        let mixed = mix_primaries(&primaries, max_drive, DVec3::from_array(numbers(rgb, "rgb")?))?;
        for (place, drive) in places.chunks_exact_mut(size_of::<f64>()).zip(mixed.drives) {
            place.copy_from_slice(&drive.to_ne_bytes());
        }
        out.set(luxfer_mixture {
            in_gamut: u32::from(mixed.reached),
            colour: mixed.colour.to_array(),
            delta_e: mixed.delta_e,
            ..luxfer_mixture::defaults()
        });
        Ok(())
    })
}

/// Finds the temperature and luminance of the blackbody light with which the mean radiance of a target comes nearest to
/// a wanted radiance, by least squares over the channels. Each array is a linear colour in cd/m² per channel. response
/// is the mean radiance of the target from a white emission of 1 cd/m², as in the field response of
/// luxfer_relight_report or luxfer_importance_report if the emission there is white and has 1 cd/m². background is the
/// mean radiance of the target from all other lights; target is the wanted radiance. size is sizeof *fit. Any thread.
/// LUXFER_UNREACHABLE if no channel of response is greater than 0, LUXFER_INVALID_ARGUMENT if a number is not finite.
/// cbindgen:ptrs-as-arrays=[[response; 3], [background; 3], [target; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_fit_temperature(
    context: *mut luxfer_context,
    response: *const f64,
    background: *const f64,
    target: *const f64,
    fit: *mut luxfer_temperature_fit,
    size: usize,
) -> luxfer_status {
    enter(context, |_| {
        let out = Report::new(fit, size)?;
        let vector = |place, name: &str| -> Result<DVec3> {
            let vector = DVec3::from_array(numbers(place, name)?);
            if vector.is_finite() {
                Ok(vector)
            } else {
                Err(Error::argument(format!("{name} is {vector}; it must be finite")))
            }
        };
        let (response, background) = (vector(response, "response")?, vector(background, "background")?);
        let found = temperature::fit(response, background, vector(target, "target")?).ok_or_else(|| {
            let reason = format!("response is {response}: no light of the emission finds its way to the target");
            Error::new(crate::error::ErrorKind::Unreachable, reason)
        })?;
        out.set(luxfer_temperature_fit {
            kelvin: found.kelvin,
            luminance: found.luminance,
            achieved: found.achieved.to_array(),
            delta_e: found.delta_e,
            ..luxfer_temperature_fit::defaults()
        });
        Ok(())
    })
}

/// Gets the number of presets. A preset holds the lighting requirements for one kind of room. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_preset_get_count(context: *mut luxfer_context, count: *mut u32) -> luxfer_status {
    enter(context, |_| {
        Out::new(count, "count")?.set(PRESETS.len() as u32);
        Ok(())
    })
}

/// Gets the requirements for one kind of room; index starts at 0. size is sizeof *preset. Any thread.
/// LUXFER_NOT_FOUND if index is beyond the last preset.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_preset_get(
    context: *mut luxfer_context,
    index: u32,
    preset: *mut luxfer_preset,
    size: usize,
) -> luxfer_status {
    enter(context, |_| {
        let out = Report::new(preset, size)?;
        let p = find(index)?;
        out.set(luxfer_preset {
            edition: p.edition,
            illuminance: p.illuminance,
            glare: p.glare,
            uniformity: p.uniformity,
            rendering: p.rendering,
            walls: p.walls,
            ceiling: p.ceiling,
            name: p.name.as_ptr(),
            ..luxfer_preset::defaults()
        });
        Ok(())
    })
}

fn find(index: u32) -> Result<&'static Preset> {
    PRESETS.get(index as usize).ok_or_else(|| missing("preset", index, PRESETS.len()))
}
