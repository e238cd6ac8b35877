//! Guided segmentation: strokes on the photo to a mask with per-pixel confidence ("Lighting Style Transfer", §4.2).
//!
//! ```text
//! strokes ─▶ samples ─▶ standardise ─▶ logistic models ─▶ cross-validation over strokes ─▶ the better one, calibrated
//!                                                                                            │
//! features ─────────────────────────────────────────────────────────────────────▶ classify ◀─┘ ─▶ mask, confidence, unseen
//! ```
//!
//! The paper does not name its classifier. Here it is logistic regression, with linear or with quadratic terms of the
//! features: models without memory of single samples carry on to surfaces no stroke touched, where trees and kernels
//! do not. Which of the two, and how far to trust its probabilities, is decided on strokes and parts of strokes held out of
//! the training: neighbouring pixels are too alike to test each other.
//!
//! The paper's two phases are two runs: the plane first ([`StrokeSet::plane_examples`]), then the lights `within` its
//! mask, by colour alone ([`Params::for_lights`]), because lights lie on the plane and share its geometry.
//!
//! Known weaknesses, by `benches/segment.rs` on synthetic rooms. Where colours differ little, a support vector machine with
//! an RBF kernel, and normals and colours alone, separate better than these models do with all channels; and with
//! strokes on one wall only, probabilities between 0.6 and 0.9 are up to twice too sure.
//!
//! Not modelled: neighbourhood. Every pixel is judged alone.

mod classify;
mod distance;
mod logistic;
mod samples;
mod select;
mod standardise;
pub mod strokes;
#[cfg(test)]
mod tests;

pub use distance::dilate;
pub use strokes::{Stroke, StrokeSet};

use crate::error::{Error, Result, check_range};
use crate::exec;
use crate::features::CHANNELS;
use crate::image::Image;
use crate::job::Job;

#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// 1 to 16 channels of the photo's size; finite everywhere.
    pub features: &'a Image,
    pub strokes: &'a [Stroke],
    /// Where to look (1) and where not (0): the plane's mask in the second phase. Outside it the confidence is 0.
    /// Strokes outside it still count as examples.
    pub within: Option<&'a Image>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Samples drawn from the strokes of each class, in `[1, 1e6]`.
    pub samples_per_class: usize,
    /// Which feature channels to use; bit `i` is channel `i`.
    pub channels: u32,
    /// Strength of the prior that keeps weights small, relative to the data, in `[1e-9, 1e3]`.
    pub ridge: f64,
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self { samples_per_class: 1000, channels: (1 << CHANNELS) - 1, ridge: 1e-3, seed: 1 }
    }
}

impl Params {
    /// Checks that every setting is in its range.
    pub fn check(&self) -> Result<()> {
        check_range("samples_per_class", self.samples_per_class, 1, 1_000_000)?;
        check_range("ridge", self.ridge, 1e-9, 1e3)?;
        Ok(())
    }

    /// For the second phase: colour only.
    pub fn for_lights() -> Self {
        Self { channels: 0b111, ..Self::default() }
    }
}

/// The two families of classifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// `bᵀx + c`.
    Linear,
    /// `xᵀAx + bᵀx + c`.
    Quadratic,
}

#[derive(Clone, Debug)]
pub struct Segmentation {
    /// 1 where the confidence is above one half, else 0.
    pub mask: Image,
    /// Probability that a pixel belongs to the positive class, in `[0, 1]`, calibrated on held-out strokes.
    pub confidence: Image,
    /// How far a pixel's features lie beyond those of all strokes, in `[0, 1]`: where it is high, one more stroke helps.
    pub unseen: Image,
    /// Expected share of wrong pixels, in `[0, 1]`, by cross-validation: the error on held-out parts of strokes where
    /// pixels are like those painted, the error on wholly held-out strokes where they are `unseen`.
    pub error: f64,
    pub model: Model,
    /// Samples used of the negative and the positive class.
    pub samples: [usize; 2],
    /// Pixels that strokes of both classes cover; the later stroke won.
    pub contradictory: usize,
    /// Stroke pixels outside the image; they were ignored.
    pub off_image: usize,
}

impl Segmentation {
    /// A caller's own: one channel of probabilities in `[0, 1]`, or a mask.
    pub fn from_confidence(confidence: &Image) -> Result<Self> {
        check_range("the number of channels of the mask", confidence.channels, 1, 1)?;
        let bad = confidence.data.iter().find(|v| !(0.0..=1.0).contains(*v));
        if let Some(bad) = bad {
            return Err(Error::argument(format!("the mask has a value of {bad}; all must lie in [0, 1]")));
        }
        let mut mask = Image::new(confidence.width, confidence.height, 1)?;
        for (m, &c) in mask.data.iter_mut().zip(&confidence.data) {
            *m = f32::from(c > 0.5);
        }
        Ok(Self {
            mask,
            confidence: confidence.clone(),
            unseen: Image::new(confidence.width, confidence.height, 1)?,
            error: 0.0,
            model: Model::Linear,
            samples: [0, 0],
            contradictory: 0,
            off_image: 0,
        })
    }
}

/// Segments an image by examples. Fails where either class has no pixel in the image.
pub fn run(input: &Input, params: &Params, job: Job) -> Result<Segmentation> {
    let features = input.features;
    params.check()?;
    check_range("the number of feature channels", features.channels, 1, 16)?;
    let channels: Vec<usize> = (0..features.channels).filter(|c| params.channels >> c & 1 == 1).collect();
    if channels.is_empty() {
        return Err(Error::argument(format!(
            "channels is {:#b}; at least one of the lowest {} bits must be set",
            params.channels, features.channels
        )));
    }
    if let Some(within) = input.within {
        features.check_same_size("features", within, "within")?;
        check_range("the number of channels of within", within.channels, 1, 1)?;
    }
    let bad =
        exec::map(features.height, job.part(0.0, 0.05), |y| features.row(y).iter().filter(|v| !v.is_finite()).count())?;
    let bad: usize = bad.iter().sum();
    if bad > 0 {
        return Err(Error::argument(format!("features has {bad} values that are NaN or infinite; all must be finite")));
    }

    // Examples.
    let samples = samples::draw(input, &channels, params)?;
    job.check()?;

    // The model that does best on strokes it has not seen.
    let chosen = select::choose(&samples, params.ridge, job.part(0.05, 0.4))?;

    // Every pixel.
    let classified = classify::run(features, input.within, &channels, &chosen, job.part(0.4, 1.0))?;
    let unseen = classified.mean_unseen;
    let error = chosen.familiar.error * (1.0 - unseen) + chosen.unfamiliar.error * unseen;
    Ok(Segmentation {
        mask: classified.mask,
        confidence: classified.confidence,
        unseen: classified.unseen,
        error,
        model: chosen.model,
        samples: samples.counts,
        contradictory: samples.contradictory,
        off_image: samples.off_image,
    })
}
