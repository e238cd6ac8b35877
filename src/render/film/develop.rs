//! Assembles the film (images, errors and counts) from the sums of an accumulator.

use super::accumulator::Accumulator;
use crate::error::Result;
use crate::job::Job;
use crate::render::output::Film;
use std::sync::atomic::Ordering;

impl Accumulator<'_> {
    /// Returns the film computed from all paths so far.
    pub fn film(&self, job: Job) -> Result<Film> {
        let beauty = self.image(3, job, |x, y, out| {
            let (x, y) = self.nearest(x, y);
            self.pixel(x, y).mean().as_vec3().write_to_slice(out);
        })?;
        let paths = self.image(1, job, |x, y, out| out[0] = self.pixel(x, y).count() as f32)?;
        let layers = self.layers.as_ref().map_or(Ok(Vec::new()), |l| l.images(&beauty, &self.places(job)?, job))?;
        let total = self.total(job)?;
        let lamp_visibility = self.learning.lamp_visibility()?;
        let mut requirements = self.world.requirements().left_out();
        requirements.extend(self.world.scene().unrendered.iter().map(|unrendered| format!("{unrendered}.")));
        // Lamps that no light sample reaches may still shine through solid glass.
        let is_certain = !self.world.requirements().refraction;
        requirements.extend(lamp_visibility.filter(|seen| seen.hidden > 0 && is_certain).map(|seen| seen.sentence()));
        Ok(Film {
            beauty,
            layers,
            variance: self.variance(job)?,
            paths,
            samples: (total.paths / (self.grid.width * self.grid.height) as u64) as u32,
            error: total.error(),
            relative_error: self.relative_total(job)?.error(),
            discarded: self.discarded.load(Ordering::Relaxed),
            unseen_lights: self.world.scene().unseen_lights(),
            lamp_visibility,
            requirements,
            preview: None,
        })
    }
}
