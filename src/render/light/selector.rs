//! Selects one light out of all lights of a scene, or out of some of them.

use super::bounds::Bounds;
use super::tree::LightTree;
use crate::error::Result;
use crate::image::{try_collect, try_with_capacity};
use crate::render::distribution::Distribution;
use std::f64::consts::PI;

/// The lights of a scene, as the selectors need them. Lights have numbers: first the lights at a finite distance
/// (pieces of surfaces, then punctual lights), then all punctual lights again, of which only the directional lights are
/// meant, and last the environment.
pub struct Inventory {
    /// Bounds of the lights at a finite distance.
    pub bounds: Vec<Bounds>,
    pub pieces: usize,
    /// Flux of all pieces in lumens.
    pub piece_flux: f64,
    /// For each light at a finite distance after the pieces, its index among the punctual lights.
    pub near: Vec<u32>,
    /// Flux of each punctual light.
    pub flux: Vec<f64>,
    /// Whether each punctual light is directional.
    pub is_far: Vec<bool>,
    /// Flux of the environment through a sphere around the scene.
    pub environment: f64,
}

impl Inventory {
    /// The number of a directional light.
    pub fn directional(&self, index: usize) -> usize {
        self.bounds.len() + index
    }

    /// The number of the environment.
    pub fn environment(&self) -> usize {
        self.bounds.len() + self.flux.len()
    }

    /// Number of the numbers, some of which no light has.
    pub fn len(&self) -> usize {
        self.environment() + 1
    }

    /// Number of lights that can be selected.
    pub fn count(&self) -> usize {
        let far = self.is_far.iter().zip(&self.flux).filter(|&(&is_far, &flux)| is_far && flux > 0.0).count();
        self.bounds.len() + far + usize::from(self.environment > 0.0)
    }

    fn near_flux(&self, light: usize) -> f64 {
        match light.checked_sub(self.pieces) {
            None => PI * f64::from(self.bounds[light].intensity),
            Some(i) => self.flux[self.near[i] as usize],
        }
    }
}

/// Selects a light for a receiver: first a group, then a light of the group. Half of the selection probability of a
/// group is proportional to its power, and half is uniform.
pub struct Selector {
    /// Selects among the lights at a finite distance.
    pub tree: LightTree,
    /// For each light of the tree its number; empty if the tree has all lights at a finite distance, in order.
    members: Vec<u32>,
    /// Selects among the directional lights; all other punctual lights have zero weight.
    pub directional: Distribution,
    /// Selection probabilities of the groups: lights at a finite distance, directional lights, environment.
    pub groups: [f64; 3],
}

impl Selector {
    /// A selector of all lights.
    pub fn of_all(lights: &Inventory) -> Result<Self> {
        let near_power = lights.near.iter().fold(lights.piece_flux, |sum, &i| sum + lights.flux[i as usize]);
        let directional = Distribution::new(lights.flux.iter().zip(&lights.is_far).map(far_flux))?;
        let groups = probabilities([near_power, directional.total(), lights.environment]);
        Ok(Self { tree: LightTree::build(&lights.bounds)?, members: Vec::new(), directional, groups })
    }

    /// A selector of the lights with a positive weight. The weight of a light multiplies its importance.
    pub fn of_some(lights: &Inventory, weight: impl Fn(usize) -> f32) -> Result<Self> {
        let members = try_collect((0..lights.bounds.len()).filter(|&i| weight(i) > 0.0).map(|i| i as u32))?;
        let (mut bounds, mut near_power) = (try_with_capacity(members.len())?, 0.0);
        for &light in &members {
            let (light, weight) = (light as usize, weight(light as usize));
            let whole = lights.bounds[light];
            bounds.push(Bounds { intensity: whole.intensity * weight, ..whole });
            near_power += lights.near_flux(light) * f64::from(weight);
        }
        let flux = lights.flux.iter().zip(&lights.is_far).map(far_flux);
        let weighted = flux.enumerate().map(|(i, flux)| flux * f64::from(weight(lights.directional(i))));
        let directional = Distribution::new(try_collect(weighted)?.into_iter())?;
        let environment = lights.environment * f64::from(weight(lights.environment()));
        let groups = probabilities([near_power, directional.total(), environment]);
        Ok(Self { tree: LightTree::build(&bounds)?, members, directional, groups })
    }

    /// The number of a light of the tree.
    #[inline]
    pub fn number(&self, light: usize) -> usize {
        self.members.get(light).map_or(light, |&number| number as usize)
    }

    /// The numbers of the lights of the tree; empty if the tree has all.
    pub fn members(&self) -> &[u32] {
        &self.members
    }
}

fn far_flux((&flux, &is_far): (&f64, &bool)) -> f64 {
    if is_far { flux } else { 0.0 }
}

/// Selection probabilities of groups of these powers.
fn probabilities(powers: [f64; 3]) -> [f64; 3] {
    let present = powers.iter().filter(|&&p| p > 0.0).count().max(1) as f64;
    let total = powers.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    powers.map(|p| if p > 0.0 { 0.5 / present + 0.5 * p / total } else { 0.0 })
}
