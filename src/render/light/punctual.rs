//! Punctual lights prepared for light sampling: points, spots, directional lights (`KHR_lights_punctual`) and measured
//! luminaires.

use super::disc::Disc;
use crate::maths;
use crate::photometry::Luminaire;
use crate::render::bounds::{Bounds, CONE_MARGIN};
use crate::render::contribution::mean_channel;
use crate::render::measured::Measured;
use crate::scene::PunctualLight;
use glam::{DVec3, Vec3};
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

/// A punctual light in the form that light sampling needs.
pub enum Punctual {
    Near {
        position: Vec3,
        intensity: Vec3,
        shape: IntensityDistribution,
    },
    /// A directional light, infinitely far away.
    Far(Disc),
}

/// How the intensity of a light depends on the direction.
pub enum IntensityDistribution {
    Isotropic,
    Cone(Cone),
    Measured(Measured),
}

/// The spot cone of glTF. Let c be the cosine of the angle to `axis`. The intensity is multiplied by x², where x is
/// `(c - outer) * scale`, clamped to [0, 1]. Here `outer` is cos(outer angle), and `scale` is
/// `1 / (cos(inner angle) - outer)`, at most 1e4.
pub struct Cone {
    axis: Vec3,
    outer: f32,
    scale: f32,
}

impl Punctual {
    /// Prepares a light; `distributions` are the luminous intensity distributions of the scene.
    pub fn new(light: &PunctualLight, distributions: &[Arc<Luminaire>]) -> Self {
        match *light {
            PunctualLight::Point { position, intensity } => {
                Self::Near { position, intensity, shape: IntensityDistribution::Isotropic }
            }
            PunctualLight::Spot { position, direction, intensity, inner_angle, outer_angle } => {
                let (inner, outer) = (maths::cos(inner_angle), maths::cos(outer_angle));
                let axis = direction.normalize_or_zero();
                Self::Near {
                    position,
                    intensity,
                    shape: IntensityDistribution::Cone(Cone { axis, outer, scale: 1.0 / (inner - outer).max(1e-4) }),
                }
            }
            PunctualLight::Directional { direction, illuminance, half_angle } => {
                Self::Far(Disc::new(-direction.normalize_or_zero(), illuminance, half_angle))
            }
            PunctualLight::Luminaire { position, axis, c0, colour, distribution, .. } => {
                let shape =
                    IntensityDistribution::Measured(Measured::new(axis, c0, distributions[distribution].clone()));
                Self::Near { position, intensity: colour, shape }
            }
        }
    }

    /// Returns the bounds of a light at a finite distance; `None` if the light is directional or dark, and for
    /// luminaires with faces, which are emitters ([`crate::render::emissive`]).
    pub fn bounds(light: &PunctualLight, distributions: &[Arc<Luminaire>]) -> Option<Bounds> {
        if light.opening(distributions).is_some() {
            return None;
        }
        let bounds = match *light {
            PunctualLight::Point { position, intensity } => {
                Bounds::of_point(position, mean_channel(intensity.max(Vec3::ZERO)))
            }
            PunctualLight::Spot { position, direction, intensity, outer_angle, .. } => {
                let axis = direction.normalize_or(Vec3::Y);
                let angle = outer_angle + CONE_MARGIN as f32;
                Bounds::of_cone(position, axis, angle, mean_channel(intensity.max(Vec3::ZERO)))
            }
            PunctualLight::Directional { .. } => return None,
            PunctualLight::Luminaire { position, axis, colour, distribution, .. } => {
                let luminaire = &*distributions[distribution];
                // Assume full intensity up to the widest angle at which the luminaire emits. The bounds have full
                // intensity up to `cone_angle` - 90°, so add 90°.
                let cone_angle = luminaire.max_gamma().to_radians() as f32 + FRAC_PI_2 + CONE_MARGIN as f32;
                let peak = luminaire.candela.iter().copied().fold(0.0, f64::max) as f32;
                Bounds::of_cone(position, axis, cone_angle, peak * mean_channel(colour.max(Vec3::ZERO)))
            }
        };
        (bounds.intensity > 0.0).then_some(bounds)
    }

    /// Returns the luminous flux in lumens, as an estimate from which selection probabilities are computed. A spot
    /// counts with its full intensity throughout the outer cone, a directional light with the flux through the
    /// cross-section of a sphere around the scene.
    pub fn flux(light: &PunctualLight, distributions: &[Arc<Luminaire>], radius: f32) -> f64 {
        let (solid_angle_or_area, strength) = match *light {
            PunctualLight::Point { intensity, .. } => (4.0 * std::f64::consts::PI, intensity),
            PunctualLight::Spot { intensity, outer_angle, .. } => {
                (std::f64::consts::TAU * (1.0 - maths::cos(f64::from(outer_angle))), intensity)
            }
            PunctualLight::Directional { illuminance, .. } => {
                (std::f64::consts::PI * maths::powi(f64::from(radius), 2).max(f64::MIN_POSITIVE), illuminance)
            }
            PunctualLight::Luminaire { colour, distribution, .. } => (distributions[distribution].flux(), colour),
        };
        solid_angle_or_area * f64::from(mean_channel(strength.max(Vec3::ZERO)))
    }
}

/// Returns the light with its position relative to `centre`.
pub fn relative(light: &PunctualLight, centre: DVec3) -> PunctualLight {
    let mut light = *light;
    match &mut light {
        PunctualLight::Point { position, .. }
        | PunctualLight::Spot { position, .. }
        | PunctualLight::Luminaire { position, .. } => {
            *position = (position.as_dvec3() - centre).as_vec3();
        }
        PunctualLight::Directional { .. } => {}
    }
    light
}

impl IntensityDistribution {
    /// Returns the factor on the intensity in a unit direction: a share in `[0, 1]`, or for a measured luminaire the
    /// intensity in candela.
    pub fn factor(&self, direction: Vec3) -> f32 {
        match self {
            Self::Isotropic => 1.0,
            Self::Cone(cone) => cone.share(direction),
            Self::Measured(measured) => measured.candela(measured.local(direction)) as f32,
        }
    }
}

impl Cone {
    /// Returns the intensity in a unit direction, relative to the intensity on the axis.
    pub fn share(&self, direction: Vec3) -> f32 {
        let x = ((direction.dot(self.axis) - self.outer) * self.scale).clamp(0.0, 1.0);
        x * x
    }
}
