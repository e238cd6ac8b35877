//! Selects one light at random, from all lights of a scene or from a subset of them.

use super::tree::LightTree;
use crate::error::Result;
use crate::image::{try_collect, try_with_capacity};
use crate::render::bounds::Bounds;
use crate::render::distribution::Distribution;
use std::f64::consts::PI;

/// The data of a scene's lights from which selectors are built. It numbers the lights in this order:
///
/// 1. The pieces of emissive surfaces: triangles, tiles of textured triangles, and patches of luminaires' faces.
/// 2. The punctual lights at a finite distance.
/// 3. One number for every punctual light of the scene. Only the numbers of directional lights are used.
/// 4. The environment.
pub struct Inventory {
    /// Bounds of the lights at a finite distance.
    pub bounds: Vec<Bounds>,
    /// Number of pieces of emissive surfaces (triangles, tiles of textured triangles, and patches of luminaires'
    /// faces).
    pub pieces: usize,
    /// Flux of all pieces together, in lumens.
    pub piece_flux: f64,
    /// For each punctual light at a finite distance, its index in the scene's list of punctual lights.
    pub near: Vec<u32>,
    /// Flux of each punctual light of the scene, in lumens.
    pub flux: Vec<f64>,
    /// For each punctual light of the scene, whether it is directional.
    pub is_far: Vec<bool>,
    /// Flux of the environment through a sphere around the scene, in lumens; 0 without an environment.
    pub environment: f64,
}

impl Inventory {
    /// Returns the inventory's number for the directional light that has this index in the scene's list of punctual
    /// lights.
    pub fn directional(&self, index: usize) -> usize {
        self.bounds.len() + index
    }

    /// Returns the inventory's number for the environment, which is the largest one.
    pub fn environment(&self) -> usize {
        self.bounds.len() + self.flux.len()
    }

    /// Returns the length of an array indexed by the inventory's numbers. It exceeds the count of lights, because some
    /// numbers are unused.
    pub fn len(&self) -> usize {
        self.environment() + 1
    }

    /// Returns how many lights can be selected; directional lights and environments without flux cannot.
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

/// Selects a light for a receiver: first one of three groups, then a light of the group. Half of the selection
/// probability is divided among the groups in proportion to their power, and half is divided equally.
pub struct Selector {
    /// Selects among the lights at a finite distance.
    pub tree: LightTree,
    /// For each light of the tree, its number in the [`Inventory`]. Empty in the selector of all lights: there, the
    /// index of a light in the tree equals its number in the inventory.
    members: Vec<u32>,
    /// Selects among the directional lights. It has an entry for each punctual light of the scene; the entries of
    /// lights that are not directional have zero weight.
    pub directional: Distribution,
    /// Selection probabilities of the groups: lights at a finite distance, directional lights, environment.
    pub groups: [f64; 3],
}

impl Selector {
    /// Builds the selector that selects among all lights.
    pub fn of_all(lights: &Inventory) -> Result<Self> {
        let near_power = lights.near.iter().fold(lights.piece_flux, |sum, &i| sum + lights.flux[i as usize]);
        let directional = Distribution::new(lights.flux.iter().zip(&lights.is_far).map(far_flux))?;
        let groups = probabilities([near_power, directional.total(), lights.environment]);
        Ok(Self { tree: LightTree::build(&lights.bounds)?, members: Vec::new(), directional, groups })
    }

    /// Builds a selector that selects only among the lights with a positive weight. `weight` maps a light's number in
    /// the [`Inventory`] to the factor on the light's importance.
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

    /// Converts an index in the tree to the light's number in the [`Inventory`].
    #[inline]
    pub fn number(&self, light: usize) -> usize {
        self.members.get(light).map_or(light, |&number| number as usize)
    }

    /// Returns, for each light of the tree, its number in the [`Inventory`]. Empty for [`Selector::of_all`].
    pub fn members(&self) -> &[u32] {
        &self.members
    }
}

fn far_flux((&flux, &is_far): (&f64, &bool)) -> f64 {
    if is_far { flux } else { 0.0 }
}

/// Returns the selection probabilities of groups with the given powers; 0 for a group without power.
fn probabilities(powers: [f64; 3]) -> [f64; 3] {
    let present = powers.iter().filter(|&&p| p > 0.0).count().max(1) as f64;
    let total = powers.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    powers.map(|p| if p > 0.0 { 0.5 / present + 0.5 * p / total } else { 0.0 })
}
