//! What an exemplar shows, for those who set the size of its pattern by its lamps.

use super::agreement::statistics;
use super::exemplar::Exemplar;
use super::lattice::{self, continuation::Continuation};
use super::params::{Input, Params, working_side};
use crate::error::Result;
use crate::job::Job;
use glam::DVec2;

/// What an exemplar shows, in unwarped pixels.
pub struct Measure {
    /// Median over its whole lamps of the longer side; 0 without one.
    pub lamp_length: f64,
    /// The shorter period of the lattice of the lamps; without one the median distance from a whole lamp to the nearest other, 0
    /// if there are less than two.
    pub spacing: f64,
    /// Width of what it shows.
    pub width: f64,
    pub(super) reading: Reading,
}

/// An exemplar that has been read: its lamps, and how they go on.
pub struct Reading {
    pub exemplar: Exemplar,
    pub continuation: Continuation,
    pub regularity: f64,
    /// What it was read with.
    working_side: f64,
    least_regularity: f32,
}

impl Reading {
    /// Whether a texture of such settings would read the exemplar in the same way.
    pub fn serves(&self, input: &Input, params: &Params) -> bool {
        let Exemplar { width, height, .. } = self.exemplar;
        [width, height] == [input.unwarped.width, input.unwarped.height]
            && self.working_side == working_side(input, params)
            && self.least_regularity == params.least_regularity
    }
}

/// Measures an exemplar. Errors as of [`super::run`].
pub fn measure(input: &Input, params: &Params, job: Job) -> Result<Measure> {
    params.check()?;
    input.check()?;
    let side = working_side(input, params);
    let exemplar = Exemplar::new(input, side, job.part(0.0, 0.5))?;
    let (continuation, regularity) = lattice::find(&exemplar, params.least_regularity, job.part(0.5, 1.0))?;
    let spacing = match continuation {
        Continuation::Lattice([a, b]) => a.length().min(b.length()),
        _ => {
            let centres: Vec<DVec2> = exemplar.lamps().map(|lamp| lamp.centre).collect();
            let mut nearest = statistics::nearest_distances(&centres);
            nearest.sort_by(f64::total_cmp);
            nearest.get(nearest.len() / 2).copied().filter(|d| d.is_finite()).unwrap_or(0.0)
        }
    };
    let mut lengths: Vec<usize> = exemplar.lamps().map(|lamp| lamp.size()[0].max(lamp.size()[1])).collect();
    lengths.sort_unstable();
    let columns = (0..exemplar.width).filter(|&x| (0..exemplar.height).any(|y| exemplar.shown[y * exemplar.width + x]));
    let (lamp_length, width) = (lengths.get(lengths.len() / 2).map_or(0.0, |&l| l as f64), columns.count() as f64);
    let least_regularity = params.least_regularity;
    let reading = Reading { exemplar, continuation, regularity, working_side: side, least_regularity };
    Ok(Measure { lamp_length, spacing, width, reading })
}
