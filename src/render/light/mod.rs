//! Every light of a scene as one distribution: which light, which point of it, and with what density.
//!
//! Lights that are somewhere (pieces of surfaces, points and spots) are chosen by what they can mean to the receiver, by way
//! of a [`LightTree`]. Those infinitely far away (directional lights, the environment) are groups of their own: half of
//! the choices go to the groups by their power, half evenly, for power says nothing about walls, and no group may starve.

mod bounds;
mod punctual;
mod tree;

pub use bounds::{Bounds, Receiver};

use super::LightSource;
use super::distribution::Distribution;
use super::emissive::{Emitters, mean_channel};
use super::environment::{self, EnvironmentSampler};
use crate::error::Result;
use crate::scene::{PunctualLight, Scene};
use glam::{DVec3, Vec2, Vec3};
use punctual::Punctual;
use std::f64::consts::PI;
use tree::LightTree;

pub struct Lights {
    pub emitters: Emitters,
    punctual: Vec<Punctual>,
    /// Over the pieces of emitters, then the near punctual lights.
    tree: LightTree,
    pieces: usize,
    /// Which of the punctual lights the leaves after the pieces are.
    near: Vec<u32>,
    /// Over all punctual lights, of weight 0 where they are near.
    directional: Distribution,
    environment: Option<EnvironmentSampler>,
    /// Probabilities of the groups: near, directional, environment.
    groups: [f64; 3],
}

/// A light chosen for a point to be lit.
pub struct LightSample {
    pub source: LightSource,
    /// Unit direction from the point to the light.
    pub direction: Vec3,
    /// Where the light is; none where it is infinitely far.
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
    /// `pieces` are the bounds of the emitters' pieces; positions are relative to `centre`; `radius` is that of the scene.
    pub fn build(scene: &Scene, emitters: Emitters, pieces: Vec<Bounds>, centre: DVec3, radius: f32) -> Result<Self> {
        let count = pieces.len();
        let mut bounds = pieces;
        let mut near = Vec::new();
        let (mut near_power, mut far_powers) = (emitters.power, Vec::new());
        let lights: Vec<PunctualLight> = scene.lights.iter().map(|light| punctual::relative(light, centre)).collect();
        for (light, index) in lights.iter().zip(0..) {
            let power = Punctual::flux(light, &scene.distributions, radius);
            if let Some(b) = Punctual::bounds(light, &scene.distributions) {
                bounds.push(b);
                near.push(index);
                near_power += power;
            }
            let is_far = matches!(light, PunctualLight::Directional { .. });
            far_powers.push(if is_far { power } else { 0.0 });
        }
        let directional = Distribution::new(far_powers.into_iter())?;
        let (environment, mean) = match scene.environment.as_ref().map(EnvironmentSampler::build).transpose()?.flatten()
        {
            Some((sampler, mean)) => (Some(sampler), mean),
            None => (None, 0.0),
        };
        // What enters a sphere around the scene.
        let r2 = f64::from(radius).powi(2).max(f64::MIN_POSITIVE);
        let powers = [near_power, directional.total(), mean * PI * 4.0 * PI * r2];
        let present = powers.iter().filter(|&&p| p > 0.0).count().max(1) as f64;
        let total = powers.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let groups = powers.map(|p| if p > 0.0 { 0.5 / present + 0.5 * p / total } else { 0.0 });
        Ok(Self {
            emitters,
            punctual: lights.iter().map(|light| Punctual::new(light, &scene.distributions)).collect(),
            tree: LightTree::build(&bounds)?,
            pieces: count,
            near,
            directional,
            environment,
            groups,
        })
    }

    /// Chooses a light for a point by a point of the unit square: `u` chooses which, and what is left of it, with `v`,
    /// where on it.
    #[inline]
    pub fn sample(&self, scene: &Scene, receiver: &Receiver, (u, v): (f64, f32)) -> Option<LightSample> {
        let [near, directional, environment] = self.groups;
        let within = |start: f64, share: f64| ((u - start) / share).clamp(0.0, 1.0 - f64::EPSILON);
        if u < near {
            let (light, probability, rest) = self.tree.sample(receiver, within(0.0, near))?;
            let probability = probability * near as f32;
            match light.checked_sub(self.pieces) {
                None => self.sample_surface(scene, receiver, light, probability, (rest, v)),
                Some(i) => self.sample_punctual(receiver, self.near[i], probability),
            }
        } else if u < near + directional {
            let index = self.directional.sample(within(near, directional)).0;
            let probability = directional * self.directional.probability(index);
            self.sample_punctual(receiver, index as u32, probability as f32)
        } else if environment > 0.0 {
            let (direction, density) = self.environment.as_ref()?.sample(within(near + directional, environment), v);
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

    fn sample_surface(
        &self,
        scene: &Scene,
        receiver: &Receiver,
        piece: usize,
        probability: f32,
        at: (f64, f32),
    ) -> Option<LightSample> {
        let (index, barycentric) = self.emitters.sample(piece, at)?;
        let emitter = &self.emitters.emitters[index];
        let offset = emitter.point(barycentric) - receiver.position;
        let distance = offset.length();
        let direction = offset / distance;
        if !(receiver.normal.dot(direction) > 0.0 && emitter.faces(direction)) {
            return None;
        }
        let (emission, uv) = emitter.emission(scene, barycentric);
        let density = probability * self.emitters.density(piece, mean_channel(emission));
        let density = to_solid_angle(density, emitter.normal.dot(direction), distance);
        if !(density.is_finite() && density > 0.0) {
            return None;
        }
        Some(LightSample {
            source: LightSource::Surface { mesh: emitter.mesh, triangle: emitter.triangle, uv },
            direction,
            end: Some(LightEnd::Emitter(index, barycentric)),
            emission,
            density,
            solid_angle_density: Some(density),
        })
    }

    fn sample_punctual(&self, receiver: &Receiver, index: u32, probability: f32) -> Option<LightSample> {
        let (direction, end, emission, density) = match &self.punctual[index as usize] {
            Punctual::Near { position, intensity, shape } => {
                let offset = position - receiver.position;
                let distance = offset.length();
                let direction = offset / distance;
                let factor = shape.factor(-direction);
                (direction, Some(LightEnd::Point(*position)), intensity * factor, probability * distance * distance)
            }
            Punctual::Far { towards, illuminance } => (*towards, None, *illuminance, probability),
        };
        let lights = density > 0.0 && direction.is_finite() && direction != Vec3::ZERO && emission != Vec3::ZERO;
        lights.then_some(LightSample {
            source: LightSource::Punctual(index),
            direction,
            end,
            emission,
            density,
            solid_angle_density: None,
        })
    }

    /// Density per steradian with which [`Lights::sample`] chooses a point of an emitter seen along a unit direction, its
    /// emission and its texture coordinates being what [`super::emissive::Emitter::emission`] gives.
    pub fn surface_density(
        &self,
        receiver: &Receiver,
        emitter: usize,
        (emission, uv): (Vec3, Vec2),
        direction: Vec3,
        distance: f32,
    ) -> f32 {
        let Some(piece) = self.emitters.piece_at(emitter, uv) else { return 0.0 };
        let probability = self.tree.probability(receiver, piece) * self.groups[0] as f32;
        let density = probability * self.emitters.density(piece, mean_channel(emission));
        to_solid_angle(density, self.emitters.emitters[emitter].normal.dot(direction), distance)
    }

    /// Density per steradian with which [`Lights::sample`] chooses a direction of the environment.
    pub fn environment_density(&self, direction: Vec3) -> f32 {
        self.environment.as_ref().map_or(0.0, |e| e.density(direction) * self.groups[2] as f32)
    }
}

/// From a density per m² to one per steradian.
fn to_solid_angle(density: f32, cosine: f32, distance: f32) -> f32 {
    density * distance * distance / cosine.abs()
}

#[cfg(test)]
mod tests;
