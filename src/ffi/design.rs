//! Lighting design
//!
//! What luminaires can make of a light that was found: the drives of their LEDs, the blackbody that comes nearest; what it takes
//! in power; and what a standard asks for. These calls return when they are done.

use super::context::luxfer_context;
use super::geometry::{list, numbers};
use super::guard::enter;
use super::params::{Report, Versioned};
use super::pointer::{Out, bytes_mut, copy_text};
use super::scene::missing;
use super::status::luxfer_status;
use crate::error::{Error, Result, check_range};
use crate::photometry::presets::{PRESETS, Preset};
use crate::photometry::{power_density, temperature};
use crate::relight::{MAX_PRIMARIES, mix_primaries};
use glam::DVec3;
use std::ffi::c_char;

/// A light mixed from primaries. Set struct_size before the call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_mixture {
    /// sizeof(luxfer_mixture), set by the caller.
    pub struct_size: u32,
    /// 1 if it is the colour asked for; 0 if that is out of reach, and this the nearest.
    pub reached: u32,
    /// The linear colour it is.
    pub colour: [f64; 3],
    /// CIEDE2000 difference from the colour asked for, seen at the exposure that shows that as a middle grey.
    pub delta_e: f64,
}

// SAFETY: plain numbers.
unsafe impl Versioned for luxfer_mixture {
    const NAME: &'static str = "luxfer_mixture";
    const SIZES: &'static [usize] = &[40];
    fn defaults() -> Self {
        Self { struct_size: 40, reached: 0, colour: [0.0; 3], delta_e: 0.0 }
    }
}

/// The blackbody light that suits a target. Set struct_size before the call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_temperature_fit {
    /// sizeof(luxfer_temperature_fit), set by the caller.
    pub struct_size: u32,
    /// 0.
    pub reserved: u32,
    /// Correlated colour temperature, in [1000, 20000] kelvin.
    pub kelvin: f64,
    /// Luminance of the emission, >= 0, where responses are those to 1 cd/m² of white.
    pub luminance: f64,
    /// Mean radiance of the target under it and all other light, in cd/m².
    pub achieved: [f64; 3],
    /// CIEDE2000 difference of that from the target, seen at the exposure that shows the target as a middle grey.
    pub delta_e: f64,
}

// SAFETY: plain numbers.
unsafe impl Versioned for luxfer_temperature_fit {
    const NAME: &'static str = "luxfer_temperature_fit";
    const SIZES: &'static [usize] = &[56];
    fn defaults() -> Self {
        Self { struct_size: 56, reserved: 0, kelvin: 0.0, luminance: 0.0, achieved: [0.0; 3], delta_e: 0.0 }
    }
}

/// What EN 12464-1 asks of a place, as makers of luminaires quote it. The standard itself is what counts.
/// Set struct_size before the call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_preset {
    /// sizeof(luxfer_preset), set by the caller.
    pub struct_size: u32,
    /// Year of the edition of the standard.
    pub edition: u32,
    /// Least mean illuminance of the task area, in lux.
    pub illuminance: f64,
    /// Largest unified glare rating.
    pub glare: f64,
    /// Least uniformity U0 of the task area.
    pub uniformity: f64,
    /// Least colour rendering index.
    pub rendering: f64,
    /// Least mean illuminance of the walls, in lux; 0 where none is asked for.
    pub walls: f64,
    /// Least mean illuminance of the ceiling, in lux; 0 where none is asked for.
    pub ceiling: f64,
}

// SAFETY: plain numbers.
unsafe impl Versioned for luxfer_preset {
    const NAME: &'static str = "luxfer_preset";
    const SIZES: &'static [usize] = &[56];
    fn defaults() -> Self {
        let (illuminance, glare, uniformity, rendering) = (0.0, 0.0, 0.0, 0.0);
        Self { struct_size: 56, edition: 0, illuminance, glare, uniformity, rendering, walls: 0.0, ceiling: 0.0 }
    }
}

/// Mixes a linear RGB colour, three numbers that are finite and >= 0, from the LEDs of a luminaire: primaries holds the linear RGB
/// of each at a drive of 1, negative where it is out of gamut; count is in [1, 64]. drives receives count numbers in
/// [0, most]; most may be infinite. Of several mixtures it is the one of least squared drives. Any thread.
/// LUXFER_DEGENERATE if all primaries are black, LUXFER_INVALID_ARGUMENT if a number is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_mix_primaries(
    context: *mut luxfer_context,
    primaries: *const f64,
    count: u32,
    most: f64,
    colour: *const f64,
    drives: *mut f64,
    mixture: *mut luxfer_mixture,
) -> luxfer_status {
    enter(context, |_| {
        let out = Report::new(mixture)?;
        check_range("count", count as usize, 1, MAX_PRIMARIES)?;
        let primaries = list(primaries, 3 * count as usize, "primaries")?;
        let primaries: Vec<DVec3> = primaries.chunks_exact(3).map(DVec3::from_slice).collect();
        let places = bytes_mut(drives.cast(), count as usize * size_of::<f64>(), "drives")?;
        let mixed = mix_primaries(&primaries, most, DVec3::from_array(numbers(colour, "colour")?))?;
        for (place, drive) in places.chunks_exact_mut(size_of::<f64>()).zip(mixed.drives) {
            place.copy_from_slice(&drive.to_ne_bytes());
        }
        out.set(luxfer_mixture {
            reached: u32::from(mixed.reached),
            colour: mixed.colour.to_array(),
            delta_e: mixed.delta_e,
            ..luxfer_mixture::defaults()
        });
        Ok(())
    })
}

/// Finds the temperature and strength of blackbody light that bring a target nearest to a mean radiance. response, background
/// and target hold three channels each: what luxfer_relight_get_report or luxfer_importance_respond tell for a white
/// emission, what other lights bring, and what is wanted. Any thread.
/// LUXFER_UNREACHABLE if no channel responds, LUXFER_INVALID_ARGUMENT if a number is not finite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_fit_temperature(
    context: *mut luxfer_context,
    response: *const f64,
    background: *const f64,
    target: *const f64,
    fit: *mut luxfer_temperature_fit,
) -> luxfer_status {
    enter(context, |_| {
        let out = Report::new(fit)?;
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

/// Tells the electric power per floor area, in W/m², that a luminous flux takes: flux in lumens, >= 0, efficacy of the
/// luminaires in lumens per watt and area in m², both > 0. Any thread.
/// LUXFER_INVALID_ARGUMENT if a number is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_power_density(
    context: *mut luxfer_context,
    flux: f64,
    efficacy: f64,
    area: f64,
    density: *mut f64,
) -> luxfer_status {
    enter(context, |_| {
        let out = Out::new(density, "density")?;
        check_range("flux", flux, 0.0, f64::MAX)?;
        check_range("efficacy", efficacy, f64::MIN_POSITIVE, f64::MAX)?;
        check_range("area", area, f64::MIN_POSITIVE, f64::MAX)?;
        out.set(power_density(flux, efficacy, area));
        Ok(())
    })
}

/// Tells the number of presets. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_preset_count(context: *mut luxfer_context, count: *mut u32) -> luxfer_status {
    enter(context, |_| {
        Out::new(count, "count")?.set(PRESETS.len() as u32);
        Ok(())
    })
}

/// Tells what a preset asks for. Any thread.
/// LUXFER_NOT_FOUND if there is no such preset.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_preset_get(
    context: *mut luxfer_context,
    index: u32,
    preset: *mut luxfer_preset,
) -> luxfer_status {
    enter(context, |_| {
        let out = Report::new(preset)?;
        let p = find(index)?;
        out.set(luxfer_preset {
            edition: p.edition,
            illuminance: p.illuminance,
            glare: p.glare,
            uniformity: p.uniformity,
            rendering: p.rendering,
            walls: p.walls,
            ceiling: p.ceiling,
            ..luxfer_preset::defaults()
        });
        Ok(())
    })
}

/// Copies the name of a preset, such as "office: filing, copying", zero-terminated, into buffer of capacity bytes, cut if it is
/// longer. *needed, unless NULL, receives the capacity for all of it. Any thread.
/// LUXFER_NOT_FOUND if there is no such preset.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_preset_name(
    context: *mut luxfer_context,
    index: u32,
    buffer: *mut c_char,
    capacity: usize,
    needed: *mut usize,
) -> luxfer_status {
    enter(context, |_| copy_text(find(index)?.name, buffer, capacity, needed))
}

fn find(index: u32) -> Result<&'static Preset> {
    PRESETS.get(index as usize).ok_or_else(|| missing("preset", index, PRESETS.len()))
}
