//! Light sampling: selects one of a scene's lights, samples a point on it, and computes the pdf.
//!
//! A [`LightTree`] selects among the lights at a finite distance (pieces of emissive surfaces, points, spots and
//! luminaires) by their importance for the receiver. The directional lights form a second group, and the environment a
//! third. Half of the probability is divided among the groups in proportion to their power, and half is divided
//! equally. Power alone would ignore occlusion by walls and could leave a group with too few samples.

pub(super) mod bounds;
mod punctual;
mod tree;

pub use bounds::{Bounds, Receiver};

use super::contribution::LightSource;
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
    /// Selects among the lights at a finite distance. Their indices in the tree count first the pieces of the
    /// emitters, then the points, spots and luminaires.
    tree: LightTree,
    pieces: usize,
    /// For each point, spot and luminaire in the tree, its index among the punctual lights of the scene.
    near: Vec<u32>,
    /// Selects among the directional lights. It has an entry for every punctual light; lights that are not directional
    /// have zero weight.
    directional: Distribution,
    environment: Option<EnvironmentSampler>,
    /// Selection probabilities of the three groups: lights at a finite distance, directional lights, environment.
    groups: [f64; 3],
}

/// A sample of the light that reaches a receiver.
pub struct LightSample {
    pub source: LightSource,
    /// Unit direction from the receiver to the light.
    pub direction: Vec3,
    /// The sampled position; `None` if it is infinitely far away.
    pub end: Option<LightEnd>,
    /// Radiance in cd/m² of a surface or the environment, intensity in cd of a punctual light at a finite distance, or
    /// illuminance in lux of a directional light.
    pub emission: Vec3,
    /// The divisor of the light sample: `emission / pdf` estimates the illuminance on a surface perpendicular to
    /// `direction`. It is the solid-angle pdf for surfaces and the environment, pmf × squared distance for punctual
    /// lights at a finite distance, and the pmf for directional lights.
    pub pdf: f32,
    /// Solid-angle pdf for MIS against BSDF samples; `None` for punctual lights, which no BSDF sample can hit.
    pub mis_pdf: Option<f32>,
}

pub enum LightEnd {
    Point(Vec3),
    /// A point on an emissive triangle: index of the emitter, and barycentric coordinates.
    Emitter(usize, Vec2),
}

impl Lights {
    /// Builds the distribution over all lights. `pieces` are the bounds of the emitters' pieces. Positions are
    /// relative to `centre`; `radius` is the radius of the scene in metres.
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
        // Take the flux through the surface of a sphere around the scene as the environment's power.
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

    /// Returns the number of pieces of emissive surfaces.
    pub fn pieces(&self) -> usize {
        self.pieces
    }

    /// Samples a light for a receiver: `u` selects the light. The remainder of `u`, rescaled to `[0, 1)`, and `v`
    /// select the point on the light. Returns `None` if no light can be sampled or the sampled point faces away.
    #[inline]
    pub fn sample(&self, scene: &Scene, receiver: &Receiver, (u, v): (f64, f32)) -> Option<LightSample> {
        let [near, directional, environment] = self.groups;
        let rescaled = |start: f64, share: f64| ((u - start) / share).clamp(0.0, 1.0 - f64::EPSILON);
        if u < near {
            let (light, pmf, rest) = self.tree.sample(receiver, rescaled(0.0, near))?;
            let pmf = pmf * near as f32;
            match light.checked_sub(self.pieces) {
                None => self.sample_surface(scene, receiver, light, pmf, (rest, v)),
                Some(i) => self.sample_punctual(receiver, self.near[i], pmf),
            }
        } else if u < near + directional {
            let index = self.directional.sample(rescaled(near, directional)).0;
            let pmf = directional * self.directional.pmf(index);
            self.sample_punctual(receiver, index as u32, pmf as f32)
        } else if environment > 0.0 {
            let (direction, pdf) = self.environment.as_ref()?.sample(rescaled(near + directional, environment), v);
            let pdf = pdf * environment as f32;
            let emission = environment::radiance(scene.environment.as_ref()?, direction);
            Some(LightSample {
                source: LightSource::Environment,
                direction,
                end: None,
                emission,
                pdf,
                mis_pdf: Some(pdf),
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
        pmf: f32,
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
        let pdf = pmf * self.emitters.area_pdf(piece, mean_channel(emission));
        let pdf = to_solid_angle(pdf, emitter.normal.dot(direction), distance);
        if !(pdf.is_finite() && pdf > 0.0) {
            return None;
        }
        Some(LightSample {
            source: LightSource::Surface { mesh: emitter.mesh, triangle: emitter.triangle, uv },
            direction,
            end: Some(LightEnd::Emitter(index, barycentric)),
            emission,
            pdf,
            mis_pdf: Some(pdf),
        })
    }

    fn sample_punctual(&self, receiver: &Receiver, index: u32, pmf: f32) -> Option<LightSample> {
        let (direction, end, emission, pdf) = match &self.punctual[index as usize] {
            Punctual::Near { position, intensity, shape } => {
                let offset = position - receiver.position;
                let distance = offset.length();
                let direction = offset / distance;
                let factor = shape.factor(-direction);
                (direction, Some(LightEnd::Point(*position)), intensity * factor, pmf * distance * distance)
            }
            Punctual::Far { towards, illuminance } => (*towards, None, *illuminance, pmf),
        };
        let lights = pdf > 0.0 && direction.is_finite() && direction != Vec3::ZERO && emission != Vec3::ZERO;
        lights.then_some(LightSample {
            source: LightSource::Punctual(index),
            direction,
            end,
            emission,
            pdf,
            mis_pdf: None,
        })
    }

    /// Returns the solid-angle pdf with which [`Lights::sample`] draws a point of an emitter. The point lies along the
    /// unit vector `direction` at `distance`; its emission and texture coordinates are those that
    /// [`super::emissive::Emitter::emission`] returns.
    pub fn surface_pdf(
        &self,
        receiver: &Receiver,
        emitter: usize,
        (emission, uv): (Vec3, Vec2),
        direction: Vec3,
        distance: f32,
    ) -> f32 {
        let Some(piece) = self.emitters.piece_at(emitter, uv) else { return 0.0 };
        let pmf = self.tree.pmf(receiver, piece) * self.groups[0] as f32;
        let pdf = pmf * self.emitters.area_pdf(piece, mean_channel(emission));
        to_solid_angle(pdf, self.emitters.emitters[emitter].normal.dot(direction), distance)
    }

    /// Returns the solid-angle pdf with which [`Lights::sample`] draws a direction towards the environment.
    pub fn environment_pdf(&self, direction: Vec3) -> f32 {
        self.environment.as_ref().map_or(0.0, |e| e.pdf(direction) * self.groups[2] as f32)
    }
}

/// Converts an area pdf to a solid-angle pdf; `cosine` is the cosine at the light.
fn to_solid_angle(pdf: f32, cosine: f32, distance: f32) -> f32 {
    pdf * distance * distance / cosine.abs()
}

#[cfg(test)]
mod tests;
