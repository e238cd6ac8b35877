//! Punctual lights: points, spots, directional lights (`KHR_lights_punctual`) and measured luminaires.

use super::bounds::Bounds;
use crate::photometry::Luminaire;
use crate::render::emissive::mean_channel;
use crate::scene::{PunctualLight, c90};
use glam::{DVec3, Vec3};
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

/// A punctual light prepared for sampling.
pub enum Punctual {
    Near {
        position: Vec3,
        intensity: Vec3,
        shape: Shape,
    },
    /// Infinitely far away; `towards` is the unit direction to the light.
    Far {
        towards: Vec3,
        illuminance: Vec3,
    },
}

/// Dependence of the intensity on the direction.
pub enum Shape {
    Isotropic,
    Cone(Cone),
    Measured(Measured),
}

/// A measured luminous intensity distribution with its axes.
pub struct Measured {
    axis: Vec3,
    c0: Vec3,
    c90: Vec3,
    luminaire: Arc<Luminaire>,
}

/// glTF's spot cone: the square of `(cosine - outer) * scale`, clamped to [0, 1].
pub struct Cone {
    axis: Vec3,
    outer: f32,
    scale: f32,
}

impl Punctual {
    /// `distributions` are those of the scene.
    pub fn new(light: &PunctualLight, distributions: &[Arc<Luminaire>]) -> Self {
        match *light {
            PunctualLight::Point { position, intensity } => Self::Near { position, intensity, shape: Shape::Isotropic },
            PunctualLight::Spot { position, direction, intensity, inner_angle, outer_angle } => {
                let (inner, outer) = (inner_angle.cos(), outer_angle.cos());
                let axis = direction.normalize_or_zero();
                Self::Near {
                    position,
                    intensity,
                    shape: Shape::Cone(Cone { axis, outer, scale: 1.0 / (inner - outer).max(1e-4) }),
                }
            }
            PunctualLight::Directional { direction, illuminance } => {
                Self::Far { towards: -direction.normalize_or_zero(), illuminance }
            }
            PunctualLight::Luminaire { position, axis, c0, colour, distribution } => {
                let luminaire = distributions[distribution].clone();
                let shape = Shape::Measured(Measured { axis, c0, c90: c90(axis, c0), luminaire });
                Self::Near { position, intensity: colour, shape }
            }
        }
    }

    /// Bounds of an emissive light at a finite distance; `None` for others.
    pub fn bounds(light: &PunctualLight, distributions: &[Arc<Luminaire>]) -> Option<Bounds> {
        let bounds = match *light {
            PunctualLight::Point { position, intensity } => {
                Bounds::of_point(position, mean_channel(intensity.max(Vec3::ZERO)))
            }
            PunctualLight::Spot { position, direction, intensity, outer_angle, .. } => {
                let axis = direction.normalize_or(Vec3::Y);
                // Widen the cone slightly, against rounding.
                Bounds::of_cone(position, axis, outer_angle + 0.01, mean_channel(intensity.max(Vec3::ZERO)))
            }
            PunctualLight::Directional { .. } => return None,
            PunctualLight::Luminaire { position, axis, colour, distribution, .. } => {
                let luminaire = &*distributions[distribution];
                // Assume full intensity up to the widest angle at which the luminaire emits, plus a margin for
                // rounding. Bounds have full intensity up to 90° less than the cone angle, so 90° are added.
                let cone_angle = luminaire.widest().to_radians() as f32 + FRAC_PI_2 + 0.01;
                let peak = luminaire.candela.iter().copied().fold(0.0, f64::max) as f32;
                Bounds::of_cone(position, axis, cone_angle, peak * mean_channel(colour.max(Vec3::ZERO)))
            }
        };
        (bounds.intensity > 0.0).then_some(bounds)
    }

    /// Luminous flux in lumens; for directional lights the flux through a sphere around the scene.
    pub fn flux(light: &PunctualLight, distributions: &[Arc<Luminaire>], radius: f32) -> f64 {
        let (solid_angle_or_area, strength) = match *light {
            PunctualLight::Point { intensity, .. } => (4.0 * std::f64::consts::PI, intensity),
            PunctualLight::Spot { intensity, outer_angle, .. } => {
                (std::f64::consts::TAU * (1.0 - f64::from(outer_angle).cos()), intensity)
            }
            PunctualLight::Directional { illuminance, .. } => {
                (std::f64::consts::PI * f64::from(radius).powi(2).max(f64::MIN_POSITIVE), illuminance)
            }
            PunctualLight::Luminaire { colour, distribution, .. } => (distributions[distribution].flux(), colour),
        };
        solid_angle_or_area * f64::from(mean_channel(strength.max(Vec3::ZERO)))
    }
}

/// The light with its position relative to a centre.
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

impl Shape {
    /// Factor on the intensity in a unit direction: a share, or the candelas of a measured luminaire.
    pub fn factor(&self, direction: Vec3) -> f32 {
        match self {
            Self::Isotropic => 1.0,
            Self::Cone(cone) => cone.share(direction),
            Self::Measured(measured) => measured.candela(direction),
        }
    }
}

impl Measured {
    fn candela(&self, direction: Vec3) -> f32 {
        let along = |axis: Vec3| f64::from(direction.dot(axis));
        let (x, y, z) = (along(self.c0), along(self.c90), along(self.axis));
        let gamma = x.hypot(y).atan2(z);
        self.luminaire.intensity(y.atan2(x).to_degrees(), gamma.to_degrees()) as f32
    }
}

impl Cone {
    /// Intensity in a unit direction relative to the intensity on the axis.
    pub fn share(&self, direction: Vec3) -> f32 {
        let x = ((direction.dot(self.axis) - self.outer) * self.scale).clamp(0.0, 1.0);
        x * x
    }
}
