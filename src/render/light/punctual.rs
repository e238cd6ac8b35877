//! Lights without a surface: points, spots and directions (`KHR_lights_punctual`).

use super::bounds::Bounds;
use crate::render::emissive::mean_channel;
use crate::scene::PunctualLight;
use glam::{DVec3, Vec3};

/// A light as it is sampled, what does not change worked out.
pub enum Punctual {
    Near {
        position: Vec3,
        intensity: Vec3,
        cone: Option<Cone>,
    },
    /// From infinitely far away, towards the light.
    Far {
        towards: Vec3,
        illuminance: Vec3,
    },
}

/// glTF's cone: the square of `(cosine - outer) * scale`, clamped to 1.
pub struct Cone {
    axis: Vec3,
    outer: f32,
    scale: f32,
}

impl Punctual {
    pub fn new(light: &PunctualLight) -> Self {
        match *light {
            PunctualLight::Point { position, intensity } => Self::Near { position, intensity, cone: None },
            PunctualLight::Spot { position, direction, intensity, inner_angle, outer_angle } => {
                let (inner, outer) = (inner_angle.cos(), outer_angle.cos());
                let axis = direction.normalize_or_zero();
                Self::Near {
                    position,
                    intensity,
                    cone: Some(Cone { axis, outer, scale: 1.0 / (inner - outer).max(1e-4) }),
                }
            }
            PunctualLight::Directional { direction, illuminance } => {
                Self::Far { towards: -direction.normalize_or_zero(), illuminance }
            }
        }
    }

    /// Bounds of a light at a place that emits; none for others.
    pub fn bounds(light: &PunctualLight) -> Option<Bounds> {
        let bounds = match *light {
            PunctualLight::Point { position, intensity } => {
                Bounds::of_point(position, mean_channel(intensity.max(Vec3::ZERO)))
            }
            PunctualLight::Spot { position, direction, intensity, outer_angle, .. } => {
                let axis = direction.normalize_or(Vec3::Y);
                // A little wider, for rounding.
                Bounds::of_cone(position, axis, outer_angle + 0.01, mean_channel(intensity.max(Vec3::ZERO)))
            }
            PunctualLight::Directional { .. } => return None,
        };
        (bounds.intensity > 0.0).then_some(bounds)
    }

    /// Luminous flux in lumens, of directional lights that which enters a sphere around the scene.
    pub fn flux(light: &PunctualLight, radius: f32) -> f64 {
        let (solid_angle_or_area, strength) = match *light {
            PunctualLight::Point { intensity, .. } => (4.0 * std::f64::consts::PI, intensity),
            PunctualLight::Spot { intensity, outer_angle, .. } => {
                (std::f64::consts::TAU * (1.0 - f64::from(outer_angle).cos()), intensity)
            }
            PunctualLight::Directional { illuminance, .. } => {
                (std::f64::consts::PI * f64::from(radius).powi(2).max(f64::MIN_POSITIVE), illuminance)
            }
        };
        solid_angle_or_area * f64::from(mean_channel(strength.max(Vec3::ZERO)))
    }
}

/// The light with its place relative to a centre.
pub fn relative(light: &PunctualLight, centre: DVec3) -> PunctualLight {
    let mut light = *light;
    match &mut light {
        PunctualLight::Point { position, .. } | PunctualLight::Spot { position, .. } => {
            *position = (position.as_dvec3() - centre).as_vec3();
        }
        PunctualLight::Directional { .. } => {}
    }
    light
}

impl Cone {
    /// Share of the intensity on the axis that goes along a unit direction.
    pub fn share(&self, direction: Vec3) -> f32 {
        let x = ((direction.dot(self.axis) - self.outer) * self.scale).clamp(0.0, 1.0);
        x * x
    }
}
