//! Light sampling: selects one of a scene's lights, samples a point on it, and computes the pdf.
//!
//! The lights form three groups:
//!
//! 1. The lights at a finite distance: pieces of emissive surfaces and of the faces of luminaires, points, spots, and
//!    luminaires without faces. A [`LightTree`] selects among them by their importance for the receiver.
//! 2. The directional lights.
//! 3. The environment.
//!
//! Half of the probability is divided among the groups in proportion to their power, and half is divided equally.
//! Power alone would ignore occlusion by walls and could leave a group with too few samples.

mod disc;
mod lamp_visibility;
mod learning;
mod luminous_surfaces;
mod punctual;
mod selector;
mod survey;
mod tree;

pub use lamp_visibility::LampVisibility;
pub use luminous_surfaces::connected;

use super::bounds::{Bounds, Receiver};
use super::contribution::{LightSource, mean_channel};
use super::emissive::Emitters;
use super::environment::{self, EnvironmentSampler};
use crate::error::Result;
use crate::maths;
use crate::scene::{PunctualLight, Scene};
use disc::Disc;
use glam::{DVec3, Vec2, Vec3};
use lamp_visibility::Split;
use luminous_surfaces::LuminousSurfaces;
use punctual::Punctual;
use selector::{Inventory, Selector};
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};
use survey::{Progress, Survey, UNCOUNTED};

/// The lights of a scene. A clone is cheap, because it shares the data. Each render uses a clone of its own, and
/// stores in it what it learns about which lights reach the surfaces in view: `split`, `survey` and `progress`.
#[derive(Clone)]
pub struct Lights {
    pub emitters: Arc<Emitters>,
    punctual: Arc<Vec<Punctual>>,
    /// Indices of the directional lights that are seen as discs, in the scene's list of punctual lights.
    discs: Arc<[u32]>,
    environment: Option<Arc<EnvironmentSampler>>,
    inventory: Arc<Inventory>,
    /// Selects among all lights.
    all: Arc<Selector>,
    /// Separate selectors for the lights that are likely and unlikely to reach the surfaces in view, which replace
    /// `all`; `None` until a render has learned which lights these are.
    split: Option<Arc<Split>>,
    /// Counts how many samples of each light were drawn and how many were not occluded; `None` if the render does not
    /// learn, or has stopped learning.
    survey: Option<Arc<Survey>>,
    progress: Progress,
    /// Whether renders may learn which lights reach the surfaces in view.
    pub learns: bool,
    /// The surfaces of the scene grouped into lamps; computed when a render first reports its [`LampVisibility`].
    lamps: Arc<OnceLock<LuminousSurfaces>>,
}

/// A sample of the light that reaches a receiver.
pub struct LightSample {
    pub source: LightSource,
    /// The light's number in the [`Inventory`], under which [`Lights::count_arrived`] counts the sample; [`UNCOUNTED`]
    /// if the sample is not counted.
    surveyed: u32,
    /// Unit direction from the receiver to the light.
    pub direction: Vec3,
    /// The sampled point on the light; `None` if the light is infinitely far away.
    pub end: Option<LightEnd>,
    /// Radiance in cd/m² of a surface or the environment, intensity in cd of a punctual light at a finite distance, or
    /// illuminance in lux of a directional light.
    pub emission: Vec3,
    /// The divisor of the light sample: `emission / pdf` estimates the illuminance on a surface perpendicular to
    /// `direction`. It is the solid-angle pdf for surfaces and the environment, pmf × squared distance for punctual
    /// lights at a finite distance, and for directional lights the pmf × cosine of the angle to the disc's centre.
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
    /// Builds the distribution over all lights. `pieces` are the bounds of the pieces into which the emissive surfaces
    /// are divided. The positions of the punctual lights are made relative to `centre`, the origin of world
    /// coordinates. `radius` is the radius of the scene in metres.
    pub fn build(scene: &Scene, emitters: Emitters, pieces: Vec<Bounds>, centre: DVec3, radius: f32) -> Result<Self> {
        let count = pieces.len();
        let mut bounds = pieces;
        let (mut near, mut flux, mut is_far) = (Vec::new(), Vec::new(), Vec::new());
        let lights: Vec<PunctualLight> = scene.lights.iter().map(|light| punctual::relative(light, centre)).collect();
        for (light, index) in lights.iter().zip(0..) {
            flux.push(Punctual::flux(light, &scene.distributions, radius));
            if let Some(b) = Punctual::bounds(light, &scene.distributions) {
                bounds.push(b);
                near.push(index);
            }
            is_far.push(matches!(light, PunctualLight::Directional { .. }));
        }
        let (environment, mean) = match scene.environment.as_ref().map(EnvironmentSampler::build).transpose()?.flatten()
        {
            Some((sampler, mean)) => (Some(Arc::new(sampler)), mean),
            None => (None, 0.0),
        };
        // The power of the environment is its flux into a sphere of radius r around the scene: π L × 4 π r², with the
        // mean luminance L.
        let r2 = maths::powi(f64::from(radius), 2).max(f64::MIN_POSITIVE);
        let power = mean * PI * 4.0 * PI * r2;
        let piece_flux = emitters.power;
        let inventory = Inventory { bounds, pieces: count, piece_flux, near, flux, is_far, environment: power };
        let punctual: Vec<_> = lights.iter().map(|light| Punctual::new(light, &scene.distributions)).collect();
        let is_disc = |light: &Punctual| matches!(light, Punctual::Far(disc) if disc.is_visible());
        let discs = (0..).zip(&punctual).filter(|(_, light)| is_disc(light)).map(|(index, _)| index).collect();
        Ok(Self {
            emitters: Arc::new(emitters),
            punctual: Arc::new(punctual),
            discs,
            environment,
            all: Arc::new(Selector::of_all(&inventory)?),
            inventory: Arc::new(inventory),
            split: None,
            survey: None,
            progress: Progress::default(),
            learns: true,
            lamps: Arc::default(),
        })
    }

    /// Returns the number of pieces of emissive surfaces.
    pub fn pieces(&self) -> usize {
        self.inventory.pieces
    }

    /// Returns the corners of the pieces' bounding boxes, in world coordinates. A box encloses the part of its piece
    /// that emits.
    pub fn piece_corners(&self) -> impl Iterator<Item = Vec3> {
        let of_box = |b: &Bounds| [b.low.to_array(), b.high.to_array()];
        let boxes = self.inventory.bounds[..self.inventory.pieces].iter().map(of_box);
        boxes.flat_map(|ends| (0..8).map(move |i| Vec3::from_array([0, 1, 2].map(|axis| ends[(i >> axis) & 1][axis]))))
    }

    /// Samples a light for a receiver: `u` selects the light. The remainder of `u`, rescaled to `[0, 1)`, and `v`
    /// select the point on the light. Returns `None` if no light can be sampled or the sampled point faces away.
    #[inline]
    pub fn sample(&self, scene: &Scene, receiver: &Receiver, (u, v): (f64, f32)) -> Option<LightSample> {
        if let Some(survey) = self.survey.as_deref().filter(|_| self.progress.counts_likely()) {
            survey.positions.add(receiver.position, u);
        }
        let Some(split) = self.split.as_deref() else {
            return self.sample_from(&self.all, 1.0, true, scene, receiver, (u, v));
        };
        let [likely, unlikely] = split.shares;
        if u < likely {
            let u = (u / likely).min(1.0 - f64::EPSILON);
            self.sample_from(&split.likely, likely, self.progress.counts_likely(), scene, receiver, (u, v))
        } else {
            let u = ((u - likely) / unlikely).clamp(0.0, 1.0 - f64::EPSILON);
            self.sample_from(&split.unlikely, unlikely, true, scene, receiver, (u, v))
        }
    }

    /// Samples a light with a selector that was itself chosen with probability `chosen`. If `counts` is true, counts
    /// the sample in the survey.
    #[inline]
    fn sample_from(
        &self,
        selector: &Selector,
        chosen: f64,
        counts: bool,
        scene: &Scene,
        receiver: &Receiver,
        (u, v): (f64, f32),
    ) -> Option<LightSample> {
        let [near, directional, environment] = selector.groups;
        let rescaled = |start: f64, share: f64| ((u - start) / share).clamp(0.0, 1.0 - f64::EPSILON);
        if u < near {
            let (light, pmf, rest) = selector.tree.sample(receiver, rescaled(0.0, near))?;
            let light = selector.number(light);
            let pmf = pmf * (near * chosen) as f32;
            let surveyed = self.count_drawn(counts, light);
            match light.checked_sub(self.inventory.pieces) {
                None => self.sample_surface(scene, receiver, (light, surveyed), pmf, (rest, v)),
                Some(i) => self.sample_punctual(receiver, (self.inventory.near[i], surveyed), pmf, (rest, v)),
            }
        } else if u < near + directional {
            let (index, rest) = selector.directional.sample(rescaled(near, directional));
            let pmf = chosen * directional * selector.directional.pmf(index);
            let surveyed = self.count_drawn(counts, self.inventory.directional(index));
            self.sample_punctual(receiver, (index as u32, surveyed), pmf as f32, (rest, v))
        } else if environment > 0.0 {
            let surveyed = self.count_drawn(counts, self.inventory.environment());
            let (direction, pdf) = self.environment.as_ref()?.sample(rescaled(near + directional, environment), v);
            let pdf = pdf * (environment * chosen) as f32;
            let emission = environment::radiance(scene.environment.as_ref()?, direction);
            Some(LightSample {
                source: LightSource::Environment,
                surveyed,
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

    /// Counts a sample of the light with number `light`, if there is a survey and `counts` is true. Returns the value
    /// for [`LightSample::surveyed`].
    #[inline]
    fn count_drawn(&self, counts: bool, light: usize) -> u32 {
        match &self.survey {
            Some(survey) if counts => {
                survey.count_drawn(light);
                light as u32
            }
            _ => UNCOUNTED,
        }
    }

    /// Counts in the survey that a light sample was not occluded.
    #[inline]
    pub fn count_arrived(&self, light: &LightSample) {
        if light.surveyed != UNCOUNTED
            && let Some(survey) = &self.survey
        {
            survey.count_arrived(light.surveyed);
        }
    }

    fn sample_surface(
        &self,
        scene: &Scene,
        receiver: &Receiver,
        (piece, surveyed): (usize, u32),
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
        let (emission, uv) = self.emitters.emission(scene, index, barycentric, -direction);
        let pdf = pmf * self.emitters.area_pdf(piece, index, mean_channel(emission));
        let pdf = to_solid_angle(pdf, emitter.normal.dot(direction), distance);
        if !(pdf.is_finite() && pdf > 0.0) {
            return None;
        }
        Some(LightSample {
            source: self.emitters.source(index, uv),
            surveyed,
            direction,
            end: Some(LightEnd::Emitter(index, barycentric)),
            emission,
            pdf,
            mis_pdf: Some(pdf),
        })
    }

    fn sample_punctual(
        &self,
        receiver: &Receiver,
        (index, surveyed): (u32, u32),
        pmf: f32,
        at: (f64, f32),
    ) -> Option<LightSample> {
        let (direction, end, emission, pdf) = match &self.punctual[index as usize] {
            Punctual::Near { position, intensity, shape } => {
                let offset = position - receiver.position;
                let distance = offset.length();
                let direction = offset / distance;
                let factor = shape.factor(-direction);
                (direction, Some(LightEnd::Point(*position)), intensity * factor, pmf * distance * distance)
            }
            Punctual::Far(disc) => {
                let (direction, cosine) = disc.sample(at);
                (direction, None, disc.illuminance, pmf * cosine)
            }
        };
        let lights = pdf > 0.0 && direction.is_finite() && direction != Vec3::ZERO && emission != Vec3::ZERO;
        lights.then_some(LightSample {
            source: LightSource::Punctual(index),
            surveyed,
            direction,
            end,
            emission,
            pdf,
            mis_pdf: None,
        })
    }

    /// Returns the solid-angle pdf with which [`Lights::sample`] draws a point of an emitter; 0 if no piece contains
    /// the point. The point lies at `distance` from the receiver, along the unit vector `direction`. `emission` and
    /// `uv` are the emission and the texture coordinates that [`Emitters::emission`] returns for the point.
    pub fn surface_pdf(
        &self,
        receiver: &Receiver,
        emitter: usize,
        (emission, uv): (Vec3, Vec2),
        direction: Vec3,
        distance: f32,
    ) -> f32 {
        let Some(piece) = self.emitters.piece_at(emitter, uv) else { return 0.0 };
        let pmf = match self.split.as_deref() {
            None => self.all.tree.pmf(receiver, piece) * self.all.groups[0] as f32,
            Some(split) => split.pmf(receiver, piece),
        };
        let pdf = pmf * self.emitters.area_pdf(piece, emitter, mean_channel(emission));
        to_solid_angle(pdf, self.emitters.emitters[emitter].normal.dot(direction), distance)
    }

    /// Returns the directional lights that are seen as discs, with their indices in the scene's list of punctual
    /// lights. No BSDF sample of a non-specular surface needs them, because light samples find all of their light.
    pub fn discs(&self) -> impl Iterator<Item = (u32, &Disc)> {
        self.discs.iter().filter_map(|&index| match &self.punctual[index as usize] {
            Punctual::Far(disc) => Some((index, disc)),
            Punctual::Near { .. } => None,
        })
    }

    /// Returns the solid-angle pdf with which [`Lights::sample`] draws a direction towards the environment.
    pub fn environment_pdf(&self, direction: Vec3) -> f32 {
        let share = self.split.as_deref().map_or(self.all.groups[2], Split::environment);
        self.environment.as_ref().map_or(0.0, |e| e.pdf(direction) * share as f32)
    }
}

/// Converts an area pdf to a solid-angle pdf. `cosine` is the cosine of the angle between the light's normal and the
/// direction; `distance` is the distance from the receiver to the point on the light.
fn to_solid_angle(pdf: f32, cosine: f32, distance: f32) -> f32 {
    pdf * distance * distance / cosine.abs()
}

#[cfg(test)]
mod tests;
