//! The boundary between two transparent media: smooth, by Fresnel's equations, or rough (Walter, Marschner, Li and
//! Torrance 2007, "Microfacet models for refraction through rough surfaces"), with microfacets by GGX.
//!
//! Directions are given in a frame whose z axis is the normal; the viewer, in direction `wo`, is above the surface.
//! Refracted light is radiance: a beam that enters a medium with an index of refraction n times as large narrows, and
//! its radiance grows by n² (Veach 1997, section 5.2). Along a path from the eye, the factor is `eta`², where `eta` is
//! the index on the side of the viewer divided by the index on the far side.
//!
//! Light that would meet a second microfacet is lost, as in `ggx`; masking and shadowing of refracted light are
//! independent (Walter et al., equation 23), those of reflected light are correlated by height.

use super::ggx::Lobe;
use crate::rng;
use glam::{Vec2, Vec3};

/// Returns the share of unpolarised light that a smooth boundary reflects, and the cosine of the angle between the
/// refracted light and the normal; (1, 0) for total internal reflection. `cosine` is the cosine of the angle between
/// the arriving light and the normal, and `eta` the index of refraction on its side divided by the other one.
pub fn fresnel(cosine: f32, eta: f32) -> (f32, f32) {
    if eta == 1.0 {
        return (0.0, cosine);
    }
    let refracted = 1.0 - eta * eta * ((1.0 - cosine) * (1.0 + cosine));
    if refracted <= 0.0 {
        return (1.0, 0.0);
    }
    let refracted = refracted.sqrt();
    let ratio = |a: f32, b: f32| (a - b) / (a + b);
    let (s, p) = (ratio(eta * cosine, refracted), ratio(cosine, eta * refracted));
    (0.5 * (s * s + p * p), refracted)
}

/// A boundary, seen from one direction.
pub struct Dielectric {
    wo: Vec3,
    /// Index of refraction on the side of the viewer, divided by the index on the far side.
    eta: f32,
    /// Share of the refracted light that remains, per channel.
    tint: Vec3,
    /// The microfacets; `None` if the boundary is smooth.
    lobe: Option<Lobe>,
}

/// A direction sampled from a [`Dielectric`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DielectricSample {
    /// Light reflected by a smooth boundary; `weight` is the BSDF × cosine / probability.
    Mirrored {
        direction: Vec3,
        weight: f32,
    },
    /// Light reflected by a microfacet, whose value and pdf [`Dielectric::eval`] returns.
    Reflected {
        direction: Vec3,
    },
    Refracted {
        direction: Vec3,
        weight: Vec3,
    },
}

impl Dielectric {
    /// `wo` must lie above the surface. `alpha` is the width of the GGX distribution; `None` for a smooth boundary.
    pub fn new(wo: Vec3, eta: f32, tint: Vec3, alpha: Option<f32>) -> Self {
        // Nothing tells two media with the same index of refraction apart: light goes straight on.
        let lobe = alpha.filter(|_| eta != 1.0).map(|alpha| Lobe::new(wo, alpha));
        Self { wo, eta, tint, lobe }
    }

    pub fn is_rough(&self) -> bool {
        self.lobe.is_some()
    }

    /// Returns the reflectance plus the transmittance at normal incidence.
    pub fn colour(&self) -> Vec3 {
        let (reflected, _) = fresnel(1.0, self.eta);
        self.tint * (1.0 - reflected) + reflected
    }

    /// Returns the reflectance of a facet and the cosine of the refracted light, as [`fresnel`], and the probability
    /// with which [`Dielectric::sample`] reflects. `cosine` is the cosine of the angle between the viewer and the
    /// facet's normal.
    fn split(&self, cosine: f32) -> (f32, f32, f32) {
        let (reflected, refracted) = fresnel(cosine, self.eta);
        let passed = (1.0 - reflected) * self.tint.max_element();
        let sum = reflected + passed;
        (reflected, refracted, if sum > 0.0 { reflected / sum } else { 1.0 })
    }

    /// Returns the BSDF for light reflected by microfacets, times the cosine of `wi`, and the solid-angle pdf of `wi`.
    /// Refracted light and mirrored light have no value here: only samples find them.
    pub fn eval(&self, wi: Vec3) -> (f32, f32) {
        let Some(lobe) = &self.lobe else { return (0.0, 0.0) };
        let h = (self.wo + wi).normalize_or(Vec3::Z);
        let (reflected, _, probability) = self.split(self.wo.dot(h));
        let (value, pdf) = lobe.eval(wi, h);
        (reflected * value, probability * pdf)
    }

    /// Samples a direction from `u`, a point of the unit square. Returns `None` for a sample that carries no light.
    pub fn sample(&self, u: Vec2) -> Option<DielectricSample> {
        // A microfacet takes both numbers. Whether it reflects or refracts, a hash of them decides, which is as good as
        // a third random number.
        let (h, choice) = match &self.lobe {
            None => (Vec3::Z, u.x),
            Some(lobe) => {
                let hash = rng::hash(u64::from(u.x.to_bits()), &[u64::from(u.y.to_bits())]);
                (lobe.sample_normal(u), (hash >> 40) as f32 / (1u32 << 24) as f32)
            }
        };
        let cosine = self.wo.dot(h);
        if !(cosine > 0.0) {
            return None;
        }
        let (reflected, refracted, probability) = self.split(cosine);
        if choice < probability {
            let direction = h * (2.0 * cosine) - self.wo;
            return match &self.lobe {
                _ if reflected == 0.0 => None,
                None => Some(DielectricSample::Mirrored { direction, weight: reflected / probability }),
                Some(_) => Some(DielectricSample::Reflected { direction }),
            };
        }
        let direction = h * (self.eta * cosine - refracted) - self.wo * self.eta;
        let visible = self.lobe.as_ref().map_or(1.0, |lobe| lobe.visibility(direction));
        let share = (1.0 - reflected) / (1.0 - probability) * (self.eta * self.eta) * visible;
        let weight = self.tint * share;
        (direction.z < 0.0 && weight != Vec3::ZERO).then_some(DielectricSample::Refracted { direction, weight })
    }
}

#[cfg(test)]
mod tests;
