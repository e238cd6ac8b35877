//! Lights of a scene
//!
//! Adds punctual lights to a scene: point lights, spot lights, directional lights (light from infinitely far away) and
//! luminaires with a measured intensity distribution. Area lights are surfaces whose material emits.

use super::distribution::luxfer_distribution;
use super::guard::enter;
use super::handle::{self, Owned};
use super::params::{self, versioned};
use super::pointer::set_optional;
use super::scene::{colour, luxfer_scene};
use super::scene_load::{LUXFER_LUMINAIRE_FACES, is_point, luxfer_luminaire_shape};
use super::status::luxfer_status;
use crate::error::{Error, Result, check_range};
use crate::image::colour::luminance;
use crate::scene::{PunctualLight, check_place};
use glam::Vec3;
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

/// A kind of punctual light: a LUXFER_LIGHT_ value.
pub type luxfer_light_kind = i32;
/// A point light: equal intensity in every direction.
pub const LUXFER_LIGHT_POINT: luxfer_light_kind = 0;
/// A spot light: it shines into a cone.
pub const LUXFER_LIGHT_SPOT: luxfer_light_kind = 1;
/// A directional light: it shines from infinitely far away, with parallel rays or as a disc.
pub const LUXFER_LIGHT_DIRECTIONAL: luxfer_light_kind = 2;

/// A punctual light. Fill it with luxfer_light_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_light_params {
    /// sizeof(luxfer_light_params), set by luxfer_light_params_init.
    pub struct_size: u32,
    /// Kind of the light: a LUXFER_LIGHT_ value; default LUXFER_LIGHT_POINT.
    pub kind: luxfer_light_kind,
    /// Position of a point or spot light, in metres, each coordinate in [-1e15, 1e15]; default (0, 0, 0).
    pub position: [f32; 3],
    /// Direction in which a spot or directional light shines; any length but 0; default (0, -1, 0).
    pub direction: [f32; 3],
    /// Strength of the light per channel, each in [0, 1e15]; default (1, 1, 1). For a point light it is the luminous
    /// intensity in cd; for a spot light, the luminous intensity in cd on its axis; for a directional light, the
    /// illuminance in lux on a surface that faces the light.
    pub intensity: [f32; 3],
    /// Half angle of the cone in which a spot light has its full intensity, in radians, in [0, outer_angle]; default
    /// 0.
    pub inner_angle: f32,
    /// Half angle of the whole cone of a spot light, in radians, in (0, pi / 2]; default pi / 4. From inner_angle to
    /// outer_angle, the intensity falls smoothly to 0, as in glTF.
    pub outer_angle: f32,
    /// Must be 0.
    pub reserved: u32,
    /// Angle in radians under which the disc of a directional light is seen, in [0, pi / 2]; for the sun it is 0.0093.
    /// The disc has uniform luminance; it casts soft shadows, and pictures and mirrors show it. 0, the default:
    /// parallel rays.
    pub angular_diameter: f32,
}

versioned!(luxfer_light_params, [60], {
    Self {
        struct_size: 60,
        kind: LUXFER_LIGHT_POINT,
        position: [0.0; 3],
        direction: [0.0, -1.0, 0.0],
        intensity: [1.0; 3],
        inner_angle: 0.0,
        outer_angle: std::f32::consts::FRAC_PI_4,
        reserved: 0,
        angular_diameter: 0.0,
    }
});

impl luxfer_light_params {
    fn light(&self) -> Result<PunctualLight> {
        let intensity = colour("light.intensity", self.intensity)?;
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
            LUXFER_LIGHT_DIRECTIONAL => {
                let angle = check_range("light.angular_diameter", self.angular_diameter, 0.0, FRAC_PI_2)?;
                Ok(PunctualLight::Directional { direction, illuminance: intensity, half_angle: angle / 2.0 })
            }
            other => Err(Error::argument(format!("light.kind is {other}; it must be a LUXFER_LIGHT_ value"))),
        }
    }
}

/// Adds a punctual light to a scene; *index, unless NULL, receives its index among the punctual lights. params may be
/// NULL for the defaults. Any thread.
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

/// Flux, position, orientation, colour and shape of a luminaire. Fill it with luxfer_luminaire_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_luminaire_params {
    /// sizeof(luxfer_luminaire_params), set by luxfer_luminaire_params_init.
    pub struct_size: u32,
    /// From where the luminaire shines: a LUXFER_LUMINAIRE_ value; default LUXFER_LUMINAIRE_FACES.
    pub shape: luxfer_luminaire_shape,
    /// Luminous flux in lumens, finite and >= 0; 0, the default: the flux of the distribution.
    pub flux: f64,
    /// Position of the centre of the luminous opening in metres, each coordinate in [-1e15, 1e15]; default (0, 0, 0).
    /// Flat faces are moved outwards by at least 0.2 mm, so that a ceiling in the same plane does not hide them.
    pub position: [f32; 3],
    /// Direction of the luminaire's axis, in which gamma is 0; any length but 0; default (0, -1, 0): it shines down.
    pub axis: [f32; 3],
    /// Direction of the half-plane C = 0; it must not be parallel to axis, and only its component perpendicular to
    /// axis counts. Default (1, 0, 0). For a luminaire that shines down, C grows anticlockwise as seen from above.
    pub c0: [f32; 3],
    /// Linear RGB colour of the light, each channel in [0, 1e15] and not all 0; only the ratio of the channels counts;
    /// default (1, 1, 1).
    pub colour: [f32; 3],
}

versioned!(luxfer_luminaire_params, [64], {
    Self {
        struct_size: 64,
        shape: LUXFER_LUMINAIRE_FACES,
        flux: 0.0,
        position: [0.0; 3],
        axis: [0.0, -1.0, 0.0],
        c0: [1.0, 0.0, 0.0],
        colour: [1.0; 3],
    }
});

impl luxfer_luminaire_params {
    /// Returns the luminaire as a punctual light. `rated` is the flux of its distribution in lumens, `distribution`
    /// the index of its distribution in the scene.
    fn light(&self, rated: f64, distribution: usize) -> Result<PunctualLight> {
        let is_point = is_point("luminaire.shape", self.shape)?;
        let position = Vec3::from_array(self.position);
        check_place(|| "luminaire.position", position)?;
        let flux = check_range("luminaire.flux", self.flux, 0.0, f64::from(f32::MAX))?;
        let [axis, c0] = axes("luminaire.", self.axis, self.c0)?;
        let colour = colour("luminaire.colour", self.colour)?;
        let factor = if flux > 0.0 { flux / rated } else { 1.0 };
        let colour = colour * (factor / f64::from(luminance(colour))) as f32;
        if colour.is_finite() {
            return Ok(PunctualLight::Luminaire { position, axis, c0, colour, distribution, is_point });
        }
        Err(Error::argument(format!(
            "luminaire.flux is {flux} and luminaire.colour {:?}; neither the colour nor the distribution, of {rated} lm, may \
             be dark",
            self.colour
        )))
    }
}

/// Returns the unit directions of the axis (γ = 0) and of C = 0, perpendicular to it. `place` precedes the names of the
/// fields in errors.
pub(super) fn axes(place: &str, axis: [f32; 3], c0: [f32; 3]) -> Result<[Vec3; 2]> {
    let unit = Vec3::from_array(axis)
        .try_normalize()
        .ok_or_else(|| Error::argument(format!("{place}axis is {axis:?}; it must be finite and not zero")))?;
    let across = Vec3::from_array(c0).try_normalize().and_then(|c0| {
        // Refuse a direction that is nearly parallel to the axis, as well as one that is exactly parallel.
        let across = c0 - unit * c0.dot(unit);
        across.try_normalize().filter(|_| across.length() > 1e-4)
    });
    let across = across
        .ok_or_else(|| Error::argument(format!("{place}c0 is {c0:?}; it must be finite and not along the axis")))?;
    Ok([unit, across])
}

/// Adds a luminaire to a scene: a light whose luminous intensity in each direction is given by the argument
/// distribution. *index, unless NULL, receives its index among the punctual lights. The luminaire shines from the faces
/// of its luminous opening. Faces that do not emit are black: they block light and do not reflect it. If the file of
/// the distribution states no size, or if params selects LUXFER_LUMINAIRE_POINT, the luminaire shines from a point
/// instead, and the scene gets the warning LUXFER_WARNING_NOT_IN_PICTURE (luxfer_get_warnings). params may be NULL for
/// the defaults. Any thread.
/// LUXFER_INVALID_ARGUMENT if a value is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_add_luminaire(
    scene: *mut luxfer_scene,
    distribution: *mut luxfer_distribution,
    params: *const luxfer_luminaire_params,
    index: *mut u32,
) -> luxfer_status {
    enter(scene, |object| {
        let params = params::read(params)?;
        let distribution = handle::borrow_in(object.context(), distribution, "distribution")?;
        let luminaire = distribution.luminaire();
        let added = object.change(0, |scene| {
            // Luminaires with one distribution share one entry in the scene's list of distributions.
            let known = scene.distributions.iter().position(|d| Arc::ptr_eq(d, luminaire));
            let light = params.light(luminaire.flux(), known.unwrap_or(scene.distributions.len()))?;
            if known.is_none() {
                scene.distributions.push(luminaire.clone());
            }
            scene.lights.push(light);
            Ok(scene.lights.len() as u32 - 1)
        })?;
        set_optional(index, added);
        Ok(())
    })
}
