//! Sorts light into bins by its source: one bin for the whole emission of each emitter, one per lamp, or one per cell
//! of the emissive surface.

use super::emission_lamps::EmissionLamps;
use crate::render::{LightSource, PathSink, World};
use glam::{DVec3, Vec2, Vec3};

pub(super) struct Bins<'a> {
    /// For each mesh, which of the emissive materials to solve for it has: its index in the list of emitters.
    emitter_of: Vec<Option<usize>>,
    emitters: usize,
    division: Partition<'a>,
}

pub(super) enum Partition<'a> {
    /// One bin per emitter, for all of its emission.
    Whole,
    /// One bin per lamp; light that comes from elsewhere counts as background.
    Lamps(&'a EmissionLamps),
    /// One bin per cell of a grid over the unit square of texture coordinates. The grid repeats outside the square.
    Cells { width: usize, height: usize },
}

impl<'a> Bins<'a> {
    pub fn new(world: &World, emitter: usize, division: Partition<'a>) -> Self {
        Self { division, ..Self::of_emitters(world, &[emitter]) }
    }

    /// Sorts the light of several emitters: one bin for each material of the list.
    pub fn of_emitters(world: &World, emitters: &[usize]) -> Self {
        let emitter = |material: usize| emitters.iter().position(|&e| e == material);
        let emitter_of = world.scene().meshes.iter().map(|m| emitter(m.material)).collect();
        Self { emitter_of, emitters: emitters.len(), division: Partition::Whole }
    }

    pub fn count(&self) -> usize {
        match &self.division {
            Partition::Whole => self.emitters,
            Partition::Lamps(lamps) => lamps.count(),
            Partition::Cells { width, height } => width * height,
        }
    }

    /// Returns the bin of a light source; `None` if the source counts as background.
    #[inline]
    fn find(&self, source: LightSource) -> Option<usize> {
        let (mesh, triangle, uv) = match (source, &self.division) {
            (LightSource::Surface { mesh, triangle, uv }, _) => (mesh, triangle, uv),
            (LightSource::Punctual(index), Partition::Lamps(lamps)) => return lamps.find_light(index),
            _ => return None,
        };
        let emitter = self.emitter_of[mesh as usize]?;
        match &self.division {
            Partition::Whole => Some(emitter),
            Partition::Lamps(lamps) => lamps.find(mesh, triangle, uv),
            Partition::Cells { width, height } => Some(cell(uv, *width, *height)),
        }
    }
}

/// Returns the index of the cell that contains the texture coordinates.
#[inline]
fn cell(uv: Vec2, width: usize, height: usize) -> usize {
    let at = |t: f32, n: usize| ((t.rem_euclid(1.0) * n as f32) as usize).min(n - 1);
    at(uv.y, height) * width + at(uv.x, width)
}

/// Adds the contributions of one path to the bins (`sums`). Light without a bin is added to `others`.
pub(super) struct Sorter<'a> {
    bins: &'a Bins<'a>,
    factor: Vec3,
    sums: &'a mut [DVec3],
    others: &'a mut DVec3,
}

impl<'a> Sorter<'a> {
    /// `factor` converts the irradiance at the target point to the radiance that is compared with the photo
    /// (`params::Quantity`).
    pub fn new(bins: &'a Bins<'a>, factor: Vec3, sums: &'a mut [DVec3], others: &'a mut DVec3) -> Self {
        Self { bins, factor, sums, others }
    }
}

impl PathSink for Sorter<'_> {
    #[inline]
    fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3) {
        let light = (self.factor * importance * emission).as_dvec3();
        match self.bins.find(source) {
            Some(bin) => self.sums[bin] += light,
            None => *self.others += light,
        }
    }
}
