//! Every light of a scene as one distribution: which light, which point of it, and with what density.
//!
//! Lights come in three groups, surfaces, punctual lights and the environment. Half of the choices go to the groups by
//! their power, half evenly: power says nothing about distance or walls, and no group may starve.

use super::LightSource;
use super::distribution::Distribution;
use super::emissive::{Emitters, mean_channel};
use super::environment::{self, EnvironmentSampler};
use super::sampler::Block;
use crate::error::Result;
use crate::scene::{PunctualLight, Scene};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::PI;

pub struct Lights {
    pub emitters: Emitters,
    punctual: Distribution,
    /// The scene's punctual lights, relative to the world's centre.
    punctual_lights: Vec<PunctualLight>,
    environment: Option<EnvironmentSampler>,
    /// Probabilities of the groups: surfaces, punctual, environment.
    groups: [f64; 3],
}

/// A light chosen for a point to be lit.
pub struct LightSample {
    pub source: LightSource,
    /// Unit direction from the point to the light.
    pub direction: Vec3,
    /// Where the light is, and the normal of its lit side and triangle if it has any; none where it is infinitely far.
    pub end: Option<LightEnd>,
    /// Radiance in cd/m², intensity in cd, or illuminance in lux, by the kind of light.
    pub emission: Vec3,
    /// What the emission is to be divided by for an estimate of the illuminance on a surface that faces it.
    pub density: f32,
    /// The density per steradian that competes with scattering; none for lights that only sampling can find.
    pub solid_angle_density: Option<f32>,
}

pub enum LightEnd {
    Point(Vec3),
    /// An emitter and the barycentric coordinates of the point on it.
    Emitter(usize, Vec2),
}

impl Lights {
    pub fn build(scene: &Scene, emitters: Emitters, centre: DVec3, radius: f32) -> Result<Self> {
        let punctual = Distribution::new(scene.lights.iter().map(|light| flux(light, radius)))?;
        let (environment, mean) = match scene.environment.as_ref().map(EnvironmentSampler::build).transpose()?.flatten()
        {
            Some((sampler, mean)) => (Some(sampler), mean),
            None => (None, 0.0),
        };
        // What enters a sphere around the scene.
        let r2 = f64::from(radius).powi(2).max(f64::MIN_POSITIVE);
        let powers = [emitters.power, punctual.total(), mean * PI * 4.0 * PI * r2];
        let present = powers.iter().filter(|&&p| p > 0.0).count().max(1) as f64;
        let total = powers.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let groups = powers.map(|p| if p > 0.0 { 0.5 / present + 0.5 * p / total } else { 0.0 });
        let punctual_lights = scene.lights.iter().map(|light| relative(light, centre)).collect();
        Ok(Self { emitters, punctual, punctual_lights, environment, groups })
    }

    /// Chooses a light for a point: the first dimension of `block` chooses which, the next two where on it.
    pub fn sample(&self, scene: &Scene, from: Vec3, block: &Block) -> Option<LightSample> {
        let [surfaces, punctual, environment] = self.groups;
        let u = block.fine(0);
        let within = |start: f64, share: f64| ((u - start) / share).clamp(0.0, 1.0 - f64::EPSILON);
        if u < surfaces {
            self.sample_surface(scene, from, within(0.0, surfaces), Vec2::new(block.get(1), block.get(2)))
        } else if u < surfaces + punctual {
            self.sample_punctual(from, within(surfaces, punctual))
        } else if environment > 0.0 {
            let direction_density = self.environment.as_ref()?.sample(block.fine(1), block.get(2));
            let (direction, density) = direction_density;
            let density = density * environment as f32;
            let emission = environment::radiance(scene.environment.as_ref()?, direction);
            Some(LightSample {
                source: LightSource::Environment,
                direction,
                end: None,
                emission,
                density,
                solid_angle_density: Some(density),
            })
        } else {
            None
        }
    }

    fn sample_surface(&self, scene: &Scene, from: Vec3, u: f64, v: Vec2) -> Option<LightSample> {
        let point = self.emitters.sample(scene, u, v)?;
        let emitter = &self.emitters.emitters[point.emitter];
        let offset = emitter.point(point.barycentric) - from;
        let distance = offset.length();
        let direction = offset / distance;
        let density = self.to_solid_angle(point.density, emitter.normal.dot(direction), distance);
        if !(distance > 0.0 && emitter.faces(direction) && density.is_finite() && density > 0.0) {
            return None;
        }
        let (emission, uv) = emitter.emission(scene, point.barycentric);
        Some(LightSample {
            source: LightSource::Surface { mesh: emitter.mesh, triangle: emitter.triangle, uv },
            direction,
            end: Some(LightEnd::Emitter(point.emitter, point.barycentric)),
            emission,
            density,
            solid_angle_density: Some(density),
        })
    }

    fn sample_punctual(&self, from: Vec3, u: f64) -> Option<LightSample> {
        let index = self.punctual.sample(u).0;
        let probability = (self.groups[1] * self.punctual.probability(index)) as f32;
        let source = LightSource::Punctual(index as u32);
        let sample = |direction, end, emission, density| LightSample {
            source,
            direction,
            end,
            emission,
            density,
            solid_angle_density: None,
        };
        let at = |position: Vec3, intensity: Vec3| {
            let offset = position - from;
            let distance = offset.length();
            let density = probability * distance * distance;
            (density > 0.0 && intensity != Vec3::ZERO)
                .then(|| sample(offset / distance, Some(LightEnd::Point(position)), intensity, density))
        };
        match self.punctual_lights[index] {
            PunctualLight::Point { position, intensity } => at(position, intensity),
            PunctualLight::Spot { position, direction, intensity, inner_angle, outer_angle } => {
                let cosine = (from - position).normalize_or_zero().dot(direction.normalize_or_zero());
                at(position, intensity * spot_falloff(cosine, inner_angle, outer_angle))
            }
            PunctualLight::Directional { direction, illuminance } => {
                let towards = -direction.normalize_or_zero();
                (towards != Vec3::ZERO).then(|| sample(towards, None, illuminance, probability))
            }
        }
    }

    /// Density per steradian with which [`Lights::sample`] chooses a point of an emitter seen along a unit direction.
    pub fn surface_density(&self, scene: &Scene, emitter: usize, b: Vec2, direction: Vec3, distance: f32) -> f32 {
        let cosine = self.emitters.emitters[emitter].normal.dot(direction);
        self.to_solid_angle(self.emitters.density(scene, emitter, b), cosine, distance)
    }

    /// Density per steradian with which [`Lights::sample`] chooses a direction of the environment.
    pub fn environment_density(&self, direction: Vec3) -> f32 {
        self.environment.as_ref().map_or(0.0, |e| e.density(direction) * self.groups[2] as f32)
    }

    fn to_solid_angle(&self, density: f32, cosine: f32, distance: f32) -> f32 {
        density * self.groups[0] as f32 * distance * distance / cosine.abs()
    }
}

/// What glTF prescribes for the light between the inner and the outer cone (`KHR_lights_punctual`).
fn spot_falloff(cosine: f32, inner: f32, outer: f32) -> f32 {
    let (cos_inner, cos_outer) = (inner.cos(), outer.cos());
    let scale = 1.0 / (cos_inner - cos_outer).max(1e-4);
    let x = (scale * (cosine - cos_outer)).clamp(0.0, 1.0);
    x * x
}

/// The light with its place relative to a centre.
fn relative(light: &PunctualLight, centre: DVec3) -> PunctualLight {
    let mut light = *light;
    match &mut light {
        PunctualLight::Point { position, .. } | PunctualLight::Spot { position, .. } => {
            *position = (position.as_dvec3() - centre).as_vec3();
        }
        PunctualLight::Directional { .. } => {}
    }
    light
}

/// Luminous flux in lumens, of directional lights that which enters a sphere around the scene.
fn flux(light: &PunctualLight, radius: f32) -> f64 {
    match *light {
        PunctualLight::Point { intensity, .. } => 4.0 * PI * f64::from(mean_channel(intensity.max(Vec3::ZERO))),
        PunctualLight::Spot { intensity, outer_angle, .. } => {
            let cone = 2.0 * PI * (1.0 - f64::from(outer_angle).cos());
            cone * f64::from(mean_channel(intensity.max(Vec3::ZERO)))
        }
        PunctualLight::Directional { illuminance, .. } => {
            let disc = PI * f64::from(radius).powi(2).max(f64::MIN_POSITIVE);
            disc * f64::from(mean_channel(illuminance.max(Vec3::ZERO)))
        }
    }
}
