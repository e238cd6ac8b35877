//! Between the passes of a render, decides which lights are unlikely to reach the surfaces in view. These lights get a
//! selector of their own with few samples. Decisions follow from the samples counted so far (see
//! [`super::lamp_visibility`]).

use super::Lights;
use super::lamp_visibility::{LampVisibility, Split, unlikely_share, weights};
use super::luminous_surfaces::LuminousSurfaces;
use super::survey::{ENOUGH, Progress, SampleCounts, Survey};
use crate::error::Result;
use crate::render::vicinity::PositionReservoir;
use std::sync::Arc;

/// Unlikely lights get a selector of their own only if at least this share of all light samples so far went to unlikely
/// lights. Below this share, the selector would save hardly any samples, because unlikely lights would still get 3 to
/// 10 % of the samples (`lamp_visibility::UNLIKELY_SHARES`). The render then keeps one selector for all lights, and its
/// image equals, to the last bit, the image without learning. [bench buildings]
const MIN_GAIN: f64 = 0.2;
/// The first decision is made after max(`FIRST_DECISION`, number of lights / 2) light samples. [convention]
const FIRST_DECISION: u64 = 256;
/// After a decision at n light samples, the next one is made at min(2 n, n + max(`DECISION`, number of lights / 2))
/// samples. [convention]
const DECISION: u64 = 4096;
/// A scene counts as closed if at most this share of the samples of directional lights and of the environment arrives
/// unoccluded. [convention]
const MAX_OPEN: f64 = 0.25;

impl Lights {
    /// Returns the lights for the start of a render. The render learns which lights reach the surfaces in view if
    /// `self.learns` is true and the scene has at least two lights.
    pub fn learning(&self) -> Result<Self> {
        let mut lights = Self { split: None, survey: None, progress: Progress::default(), ..self.clone() };
        if self.learns && self.inventory.count() > 1 {
            lights.survey = Some(Arc::new(Survey::new(self.inventory.len())?));
            lights.progress.next = FIRST_DECISION.max(self.inventory.count() as u64 / 2);
        }
        Ok(lights)
    }

    /// Returns the lights for the next pass; `None` if the present lights stay in use, because the render does not
    /// learn or has too few new samples for a decision. Call it between passes: the result depends on the samples of
    /// all paths so far, but not on their order.
    pub fn learned(&self) -> Result<Option<Self>> {
        let Some(survey) = &self.survey else { return Ok(None) };
        let sample_counts = survey.sample_counts()?;
        let counted: u64 = sample_counts.iter().map(|e| e.drawn).sum();
        if counted < self.progress.next {
            return Ok(None);
        }
        let weights = weights(&self.inventory, &self.all.tree, &sample_counts)?;
        let unlikely =
            sample_counts.iter().zip(&weights).filter(|&(_, &w)| w == 0.0).map(|(e, _)| e.drawn).sum::<u64>();
        let later = (2 * counted).min(counted + DECISION.max(self.inventory.count() as u64 / 2));
        let mut lights = Self { progress: Progress { counted, next: later }, ..self.clone() };
        match &self.split {
            Some(split) if split.is_same(&weights) && counted > ENOUGH => return Ok(Some(lights)),
            Some(_) => {}
            // Too few samples went to unlikely lights: keep one selector for all lights. After `ENOUGH` samples, stop
            // counting as well.
            None if (unlikely as f64) < MIN_GAIN * counted as f64 => {
                lights.survey = lights.survey.filter(|_| counted < ENOUGH);
                return Ok(Some(lights));
            }
            None => {}
        }
        if let Some(split) = Split::new(&self.inventory, weights, unlikely_share(unlikely))? {
            lights.split = Some(Arc::new(split));
        }
        Ok(Some(lights))
    }

    /// Returns the recorded positions of receivers, and the number of light samples that were counted up to the last
    /// decision. Returns `None` if no positions are recorded any more. Also returns `None` if the scene is open, which
    /// means that many rays leave the surroundings of these positions: more than [`MAX_OPEN`] of the samples of
    /// directional lights and of the environment arrive.
    pub fn positions(&self) -> Result<Option<(&PositionReservoir, u64)>> {
        let Some(survey) = self.survey.as_deref().filter(|_| self.progress.counts_likely()) else { return Ok(None) };
        let mut far = SampleCounts::default();
        survey.sample_counts()?[self.inventory.bounds.len()..].iter().for_each(|&e| far += e);
        let is_open = far.arrived as f64 > MAX_OPEN * far.drawn as f64;
        Ok((!is_open).then_some((&survey.positions, self.progress.counted)))
    }

    /// Ends the learning: keeps the selectors learned so far, and counts no further samples.
    pub fn settled(self) -> Self {
        Self { survey: None, ..self }
    }

    /// Counts the lamps of the scene, and the lamps that do not reach the surfaces in view. Returns `None` if the
    /// render still has one selector for all lights, because it found too few such lamps or did not learn.
    pub fn lamp_visibility(&self) -> Result<Option<LampVisibility>> {
        let Some(split) = &self.split else { return Ok(None) };
        let own;
        let lamps = match self.lamps.get() {
            Some(lamps) => lamps,
            None => {
                own = LuminousSurfaces::new(&self.emitters, self.inventory.pieces)?;
                self.lamps.get_or_init(|| own)
            }
        };
        let [lamps, hidden] = lamps.count(&self.inventory, |light| split.weights[light] == 0.0)?;
        Ok(Some(LampVisibility { lamps, hidden, samples: self.progress.counted }))
    }
}
