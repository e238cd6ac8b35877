//! Decides between the passes of a render which lights are sampled apart, by the samples counted so far (see
//! [`super::reach`]).

use super::Lights;
use super::lamps::Lamps;
use super::reach::{Reach, Split, unlikely_share, weights};
use super::survey::{ENOUGH, Progress, Survey};
use crate::error::Result;
use std::sync::Arc;

/// Unlikely lights are sampled apart if they took at least this share of the samples, so that rooms with a single
/// hidden light keep the bits of their images. Buildings waste 70 % and more. [judged on 3 scenes]
const MIN_GAIN: f64 = 0.6;
/// The first decision needs this number of samples. [convention]
const FIRST_DECISION: u64 = 256;
/// Largest number of samples between two decisions in scenes of few lights. [convention]
const DECISION: u64 = 4096;

impl Lights {
    /// The lights at the start of a render that learns which of them reach the surfaces in view.
    pub fn learning(&self) -> Result<Self> {
        let mut lights = Self { split: None, survey: None, progress: Progress::default(), ..self.clone() };
        if self.learns && self.inventory.count() > 1 {
            lights.survey = Some(Arc::new(Survey::new(self.inventory.len())?));
            lights.progress.next = FIRST_DECISION.max(self.inventory.count() as u64 / 2);
        }
        Ok(lights)
    }

    /// The lights for the next pass, if the samples so far suggest a change. Call it between passes: the result depends
    /// on the samples of all paths so far, but not on their order.
    pub fn learned(&self) -> Result<Option<Self>> {
        let Some(survey) = &self.survey else { return Ok(None) };
        let evidence = survey.evidence()?;
        let counted: u64 = evidence.iter().map(|e| e.drawn).sum();
        if counted < self.progress.next {
            return Ok(None);
        }
        let weights = weights(&self.inventory, &self.all.tree, &evidence)?;
        let unlikely = evidence.iter().zip(&weights).filter(|&(_, &w)| w == 0.0).map(|(e, _)| e.drawn).sum::<u64>();
        let later = (2 * counted).min(counted + DECISION.max(self.inventory.count() as u64 / 2));
        let mut lights = Self { progress: Progress { counted, next: later }, ..self.clone() };
        match &self.split {
            Some(split) if split.is_same(&weights) && counted > ENOUGH => return Ok(Some(lights)),
            Some(_) => {}
            // Stop counting when there is nothing to gain.
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

    /// The lights as learned so far, for paths that learn no more.
    pub fn settled(self) -> Self {
        Self { survey: None, ..self }
    }

    /// Which lamps reach the surfaces in view; `None` if the render has not learned it.
    pub fn reach(&self) -> Result<Option<Reach>> {
        let Some(split) = &self.split else { return Ok(None) };
        let own;
        let lamps = match self.lamps.get() {
            Some(lamps) => lamps,
            None => {
                own = Lamps::new(&self.emitters, self.inventory.pieces)?;
                self.lamps.get_or_init(|| own)
            }
        };
        let [lamps, hidden] = lamps.count(&self.inventory, |light| split.weights[light] == 0.0)?;
        Ok(Some(Reach { lamps, hidden, samples: self.progress.counted }))
    }
}
