//! Lights of a scene
//!
//! Lights without a surface: points, spots, and the parallel light of something far away. Lights with a surface are
//! materials that emit.

use super::guard::{enter, guard};
use super::params::{self, Versioned};
use super::pointer::set_optional;
use super::scene::{colour, luxfer_scene};
use super::status::luxfer_status;
use crate::error::{Error, Result, check_range};
use crate::scene::{PunctualLight, check_place};
use glam::Vec3;
use std::f32::consts::FRAC_PI_2;

/// A kind of light: a LUXFER_LIGHT_ value.
pub type luxfer_light_kind = i32;
/// Shines the same in every direction.
pub const LUXFER_LIGHT_POINT: luxfer_light_kind = 0;
/// Shines in a cone.
pub const LUXFER_LIGHT_SPOT: luxfer_light_kind = 1;
/// Shines from infinitely far away.
pub const LUXFER_LIGHT_DIRECTIONAL: luxfer_light_kind = 2;

/// A light without a surface. Fill it with luxfer_light_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_light_params {
    /// sizeof(luxfer_light_params), set by luxfer_light_params_init.
    pub struct_size: u32,
    /// LUXFER_LIGHT_ value; default LUXFER_LIGHT_POINT.
    pub kind: luxfer_light_kind,
    /// Where a point or a spot stands, in metres, in [-1e15, 1e15]; default (0, 0, 0).
    pub position: [f32; 3],
    /// Where a spot or a directional light shines; any length but 0; default (0, -1, 0).
    pub direction: [f32; 3],
    /// Luminous intensity per channel in cd, on the axis of a spot; of a directional light the illuminance in lux on a
    /// surface that faces it. Each >= 0; default (1, 1, 1).
    pub intensity: [f32; 3],
    /// Half the angle of a spot's cone of full intensity, in radians, in [0, outer_angle]; default 0.
    pub inner_angle: f32,
    /// Half the angle of a spot's whole cone, in radians, in (0, pi / 2]; default pi / 4.
    pub outer_angle: f32,
    /// Must be 0.
    pub reserved: u32,
}

// SAFETY: plain numbers.
unsafe impl Versioned for luxfer_light_params {
    const NAME: &'static str = "luxfer_light_params";
    const SIZES: &'static [usize] = &[56];
    fn defaults() -> Self {
        Self {
            struct_size: 56,
            kind: LUXFER_LIGHT_POINT,
            position: [0.0; 3],
            direction: [0.0, -1.0, 0.0],
            intensity: [1.0; 3],
            inner_angle: 0.0,
            outer_angle: std::f32::consts::FRAC_PI_4,
            reserved: 0,
        }
    }
}

impl luxfer_light_params {
    fn light(&self) -> Result<PunctualLight> {
        let [red, green, blue] = self.intensity;
        let intensity = colour("light.intensity", red, green, blue)?;
        let position = Vec3::from_array(self.position);
        let direction = Vec3::from_array(self.direction).try_normalize();
        let direction = direction.ok_or_else(|| {
            Error::argument(format!("light.direction is {:?}; it must be finite and not zero", self.direction))
        })?;
        check_place(|| "light.position", position)?;
        match self.kind {
            LUXFER_LIGHT_POINT => Ok(PunctualLight::Point { position, intensity }),
            LUXFER_LIGHT_SPOT => {
                let outer_angle = check_range("light.outer_angle", self.outer_angle, f32::MIN_POSITIVE, FRAC_PI_2)?;
                let inner_angle = check_range("light.inner_angle", self.inner_angle, 0.0, outer_angle)?;
                Ok(PunctualLight::Spot { position, direction, intensity, inner_angle, outer_angle })
            }
            LUXFER_LIGHT_DIRECTIONAL => Ok(PunctualLight::Directional { direction, illuminance: intensity }),
            other => Err(Error::argument(format!("light.kind is {other}; it must be a LUXFER_LIGHT_ value"))),
        }
    }
}

/// Fills *params with the defaults; size is sizeof *params. LUXFER_INVALID_ARGUMENT if params is NULL or size is wrong.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_light_params_init(params: *mut luxfer_light_params, size: usize) -> luxfer_status {
    guard(|| params::init(params, size))
}

/// Adds a light; *index, unless NULL, becomes its index. params may be NULL for the defaults. Any thread.
/// LUXFER_INVALID_ARGUMENT if a value is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_add_light(
    scene: *mut luxfer_scene,
    params: *const luxfer_light_params,
    index: *mut u32,
) -> luxfer_status {
    enter(scene, |object| {
        let light = params::read(params)?.light()?;
        let added = object.change(0, |scene| {
            scene.lights.push(light);
            Ok(scene.lights.len() as u32 - 1)
        })?;
        set_optional(index, added);
        Ok(())
    })
}
