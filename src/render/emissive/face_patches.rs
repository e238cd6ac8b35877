//! Patches of the faces of luminaires: groups of triangles, each of which is a piece for light sampling.

use super::polygon::uniform_in_triangle;
use crate::render::luminaires::FaceEmission;
use glam::{Vec2, Vec3};
use std::ops::Range;

/// The patches of all luminaires with faces.
#[derive(Default)]
pub struct FacePatches {
    patches: Vec<PatchEmitters>,
    luminaires: Vec<Luminaire>,
}

#[derive(Clone, Copy)]
struct PatchEmitters {
    luminaire: u32,
    /// Index of the first emitter of the patch, and number of its emitters.
    first: u32,
    count: u32,
}

struct Luminaire {
    /// Index of the luminaire among the lights of the scene.
    light: u32,
    emission: FaceEmission,
}

impl FacePatches {
    /// Adds a luminaire: its index among the lights of the scene, and the luminance of its faces.
    pub fn add_luminaire(&mut self, light: usize, emission: FaceEmission) {
        self.luminaires.push(Luminaire { light: light as u32, emission });
    }

    /// Adds a patch of the luminaire that will be added next, with the range of its emitters.
    pub fn add_patch(&mut self, emitters: Range<usize>) {
        let luminaire = self.luminaires.len() as u32;
        self.patches.push(PatchEmitters { luminaire, first: emitters.start as u32, count: emitters.len() as u32 });
    }

    /// Returns the number of patches.
    pub fn count(&self) -> u32 {
        self.patches.len() as u32
    }

    /// Samples a point of a patch. Returns the index of the emitter and the barycentric coordinates of the point.
    #[inline]
    pub fn sample(&self, patch: usize, (u, v): (f64, f32)) -> (usize, Vec2) {
        let PatchEmitters { first, count, .. } = self.patches[patch];
        // Select a triangle by `u`, and rescale the remainder to [0, 1).
        let scaled = u * f64::from(count);
        let triangle = (scaled as u32).min(count - 1);
        let rest = (scaled - f64::from(triangle)) as f32;
        ((first + triangle) as usize, uniform_in_triangle(Vec2::new(rest, v)))
    }

    /// Returns the probability with which each triangle of a patch is sampled.
    #[inline]
    pub fn share(&self, patch: usize) -> f32 {
        1.0 / self.patches[patch].count as f32
    }

    pub fn first_emitter(&self, patch: usize) -> usize {
        self.patches[patch].first as usize
    }

    /// Returns the luminance of a patch towards a viewer in a unit direction, in cd/m² per channel.
    #[inline]
    pub fn radiance(&self, patch: u32, direction: Vec3) -> Vec3 {
        self.of(patch).emission.radiance(direction)
    }

    /// Returns the index, among the lights of the scene, of the luminaire that a patch belongs to.
    #[inline]
    pub fn light(&self, patch: u32) -> u32 {
        self.of(patch).light
    }

    #[inline]
    fn of(&self, patch: u32) -> &Luminaire {
        &self.luminaires[self.patches[patch as usize].luminaire as usize]
    }
}
