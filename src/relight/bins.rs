//! Sorts light into bins by its source: one bin for the whole emission, one per lamp, or one per cell of the emissive
//! surface.

use super::emission_lamps::EmissionLamps;
use crate::render::{LightSource, PathSink, World};
use glam::{DVec3, Vec2, Vec3};

pub(super) struct Bins<'a> {
    /// For each mesh, whether it has the emissive material to solve for.
    of_emitter: Vec<bool>,
    division: Partition<'a>,
}

pub(super) enum Partition<'a> {
    /// One bin for all of the emission.
    Whole,
    /// One bin per lamp; light that comes from elsewhere counts as background.
    Lamps(&'a EmissionLamps),
    /// One bin per cell of a grid over the unit square of texture coordinates. The grid repeats outside the square.
    Cells { width: usize, height: usize },
}

impl<'a> Bins<'a> {
    pub fn new(world: &World, emitter: usize, division: Partition<'a>) -> Self {
        Self { of_emitter: world.scene().meshes.iter().map(|m| m.material == emitter).collect(), division }
    }

    pub fn count(&self) -> usize {
        match &self.division {
            Partition::Whole => 1,
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
        if !self.of_emitter[mesh as usize] {
            return None;
        }
        match &self.division {
            Partition::Whole => Some(0),
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
