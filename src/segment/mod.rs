//! Guided segmentation: strokes on the photo to a mask with per-pixel confidence ("Lighting Style Transfer", §4.2).
//!
//! ```text
//! strokes ─▶ samples ─▶ standardise ─▶ logistic models ─▶ cross-validation over strokes ─▶ the best one, calibrated
//!                                                                                            │
//! features ─────────────────────────────────────────────────────────────────────▶ classify ◀─┘ ─▶ mask, confidence, unseen
//! ```
//!
//! The paper does not name its classifier. Here it is logistic regression, with linear or with quadratic terms of the
//! features: models without memory of single samples carry on to surfaces no stroke touched, where trees and kernels
//! do not. Which of the two, on which channels, and how far to trust its probabilities, is decided on strokes and parts of
//! strokes held out of the training: neighbouring pixels are too alike to test each other.
//!
//! The paper's two phases are two runs: the plane first ([`StrokeSet::plane_examples`]), then the lights `within` its
//! mask, by colour alone ([`Params::for_lights`]), because lights lie on the plane and share its geometry.
//!
//! Known weakness: with strokes on few surfaces nothing held out tells channels apart, and the simplest that separate what
//! was painted are taken; probabilities there are too sure.
//!
//! Nothing is kept from one run to the next: with one stroke more everything is learnt and judged anew, so that an answer
//! depends on the strokes alone and not on the order in which they came to be seen.
//!
//! Every pixel is judged alone. As an option ([`Params::refine_radius`]) its neighbours then have a say, those of its
//! own colour most: masks follow the edges of the photo, and noise and small mistakes go, small lamps with them if the
//! radius is larger than they are.
//!
//! Lamps are found as things rather than pixel by pixel ([`instances`]), unless the caller wants a surface ([`Subject`]). A plane
//! stays on the face of the room that its strokes lie on ([`face`]).
//!
//! Not modelled: neighbourhood in the learning itself.

mod classify;
mod distance;
mod edges;
mod ellipsoid;
mod exponential;
mod face;
mod instances;
mod logistic;
mod refine;
mod samples;
mod select;
mod standardise;
pub mod strokes;
mod table;
#[cfg(test)]
mod tests;
mod warnings;

pub use distance::dilate;
pub use edges::smooth_edges;
pub use strokes::{Stroke, StrokeSet};
pub use warnings::{almost_all_lit, dim_lamps};

use crate::error::{Error, Result, check_range};
use crate::exec;
use crate::features::CHANNELS;
use crate::image::Image;
use crate::job::Job;
use samples::Samples;
use select::{Chosen, Question};

#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// 1 to 16 channels of the photo's size; finite everywhere.
    pub features: &'a Image,
    pub strokes: &'a [Stroke],
    /// Where to look (1) and where not (0): the plane's mask in the second phase. Outside it the confidence is 0,
    /// but for lamps with a stroke. Strokes outside it still count as examples.
    pub within: Option<&'a Image>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Samples drawn from the strokes of each class, in `[1, 1e6]`.
    pub samples_per_class: usize,
    /// Which feature channels to use; bit `i` is channel `i`. 0: of [`CHANNELS`] channels those of [`SUBSETS`] that do best on
    /// strokes they have not seen, of any other number all.
    pub channels: u32,
    /// Strength of the prior that keeps weights small, relative to the data, in `[1e-9, 1e3]`.
    pub ridge: f64,
    pub seed: u64,
    /// Half-width of the windows of the edge-aware refinement, in pixels, in `[0, 1024]`; 0: none. The first three channels
    /// of the features guide it.
    pub refine_radius: usize,
    /// Differences of the guide, in its own units (for colour those of CIELAB), below which neighbours are of one surface,
    /// in `[1e-3, 1e6]`.
    pub refine_tolerance: f64,
    /// What the positive strokes lie on.
    pub subject: Subject,
}

/// What is segmented: "stuff", which has a look but no shape, or "things", which have both (Kirillov et al. 2019, "Panoptic
/// Segmentation").
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Subject {
    /// Lamps where `within` is given and the features are [`CHANNELS`], else a surface.
    #[default]
    Auto,
    /// A surface: every pixel is judged by its features, and must lie on the face of the room that the strokes lie on.
    Surface,
    /// Lamps: compact regions with a sharp contour, brighter than their surroundings ([`instances`]).
    Lamps,
}

/// What is chosen from where the caller does not: colour; colour and position; colour and normal; everything. More is not
/// better: what does not tell the classes apart still leads astray where no stroke is.
pub const SUBSETS: [u32; 4] = [0b111, 0b111_0_111, 0b111_000_0_111, (1 << CHANNELS) - 1];

/// The channels of depth and position.
const POSITION: u32 = 0b111_1000;

impl Default for Params {
    fn default() -> Self {
        Self {
            samples_per_class: 1000,
            channels: 0,
            ridge: 1e-3,
            seed: 1,
            refine_radius: 0,
            refine_tolerance: 8.0,
            subject: Subject::Auto,
        }
    }
}

impl Params {
    /// Checks that every setting is in its range.
    pub fn check(&self) -> Result<()> {
        check_range("samples_per_class", self.samples_per_class, 1, 1_000_000)?;
        check_range("ridge", self.ridge, 1e-9, 1e3)?;
        check_range("refine_radius", self.refine_radius, 0, 1024)?;
        check_range("refine_tolerance", self.refine_tolerance, 1e-3, 1e6)?;
        Ok(())
    }

    /// For the second phase: colour only.
    pub fn for_lights() -> Self {
        Self { channels: 0b111, ..Self::default() }
    }
}

/// Most channels that features may have.
const MOST_CHANNELS: usize = 16;

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
    /// The classifier; of lamps and of a caller's own mask there is none.
    pub model: Option<Model>,
    /// The channels it looks at; bit `i` is channel `i`.
    pub channels: u32,
    /// Samples used of the negative and the positive class.
    pub samples: [usize; 2],
    /// Pixels that strokes of both classes cover; the later stroke won.
    pub contradictory: usize,
    /// Stroke pixels outside the image; they were ignored.
    pub off_image: usize,
    /// Whether the mask was proposed because strokes were missing: of the plane strokes of one class, of lamps positive
    /// strokes.
    pub is_proposed: bool,
    /// Regions outside the given mask that have the size and the shape of a lamp if the plane goes on there: then the
    /// room is larger than it was laid out. Of lamps only.
    pub beyond: Vec<Stroke>,
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
            model: None,
            channels: 0,
            samples: [0, 0],
            contradictory: 0,
            off_image: 0,
            is_proposed: false,
            beyond: Vec::new(),
        })
    }
}

/// The subsets of an image's channels to choose from.
fn subsets(count: usize, wanted: u32) -> Result<Vec<u32>> {
    let all = (1 << count) - 1;
    match wanted {
        0 if count == CHANNELS => Ok(SUBSETS.to_vec()),
        0 => Ok(vec![all]),
        _ if wanted & all == 0 => Err(Error::argument(format!(
            "channels is {wanted:#b}; at least one of the lowest {count} bits must be set, or none at all to leave the choice open"
        ))),
        _ => Ok(vec![wanted & all]),
    }
}

fn not_finite(bad: usize) -> Error {
    Error::argument(format!("features has {bad} values that are NaN or infinite; all must be finite"))
}

/// Segments an image by examples.
///
/// With the [`CHANNELS`] of the features, a mask whose examples are missing is proposed: without negative strokes the
/// face of the room that the positive ones lie on; without positive ones the ceiling, less the parts that resemble the
/// negative ones; lamps without positive strokes, among the brightest things within the given mask. Errors: with other
/// features, either class has no pixel in the image; strokes are missing, and no ceiling or no lamp was found
/// (`Degenerate`).
pub fn run(input: &Input, params: &Params, job: Job) -> Result<Segmentation> {
    let features = input.features;
    params.check()?;
    check_range("the number of feature channels", features.channels, 1, MOST_CHANNELS)?;
    let mut subsets = subsets(features.channels, params.channels)?;
    if let Some(within) = input.within {
        features.check_same_size("features", within, "within")?;
        check_range("the number of channels of within", within.channels, 1, 1)?;
    }

    let is_lamps = match params.subject {
        Subject::Auto => input.within.is_some() && features.channels == CHANNELS,
        Subject::Surface => false,
        Subject::Lamps => true,
    };
    if is_lamps {
        check_range("the number of feature channels where lamps are sought", features.channels, 3, MOST_CHANNELS)?;
        return instances::run(input, job);
    }

    if input.within.is_none()
        && features.channels == CHANNELS
        && let Some(proposed) = propose(input, params, job)?
    {
        return Ok(proposed);
    }
    if params.channels == 0 && input.within.is_none() && face::laid_out(input).is_some() {
        subsets.retain(|subset| subset & POSITION == 0);
    }
    let channels: Vec<usize> = (0..features.channels).filter(|c| subsets.iter().any(|s| s >> c & 1 == 1)).collect();
    // Making room for the answers takes a while, which learning can share.
    let blank = || classify::Blank::new(features.width, features.height);
    let (learnt, blank) = exec::both(|| learn(input, params, &subsets, &channels, job.part(0.0, 0.4)), blank);
    let ((samples, chosen), blank) = (learnt?, blank?);

    // Every pixel.
    let done = if params.refine_radius > 0 { 0.5 } else { 1.0 };
    let mut classified = classify::run(features, input.within, &channels, &chosen, blank, job.part(0.4, done))?;
    if classified.bad > 0 {
        return Err(not_finite(classified.bad));
    }
    if params.refine_radius > 0 {
        classified.refine(input, params, job.part(done, 1.0))?;
    }
    if input.within.is_none() && features.channels == CHANNELS {
        face::restrict(input, &mut classified)?;
    }
    let unseen = classified.mean_unseen;
    let error = chosen.familiar.error * (1.0 - unseen) + chosen.unfamiliar.error * unseen;
    Ok(Segmentation {
        mask: classified.mask,
        confidence: classified.confidence,
        unseen: classified.unseen,
        error,
        model: Some(chosen.model),
        channels: chosen.columns.iter().map(|&i| 1 << channels[i]).sum(),
        samples: samples.counts,
        contradictory: samples.contradictory,
        off_image: samples.off_image,
        is_proposed: false,
        beyond: Vec::new(),
    })
}

/// The mask of a plane whose examples are missing in part; `None` where both classes have some, or the strokes agree on
/// no face.
fn propose(input: &Input, params: &Params, job: Job) -> Result<Option<Segmentation>> {
    let count = input.features.width * input.features.height;
    let is_seen = |s: &Stroke| s.pixels.iter().any(|&p| (p as usize) < count);
    let has = |positive: bool| input.strokes.iter().any(|s| s.positive == positive && is_seen(s));
    match (has(true), has(false)) {
        (true, true) => Ok(None),
        (true, false) => face::of_strokes(input),
        (false, false) => face::of_ceiling(input).map(Some),
        // Pixels of the ceiling stand for the positive strokes. The negative ones come later, and count where both are.
        (false, true) => {
            let mut strokes = vec![face::ceiling_example(input.features)?];
            strokes.extend(input.strokes.iter().cloned());
            let proposed = run(&Input { strokes: &strokes, ..*input }, params, job)?;
            Ok(Some(Segmentation { is_proposed: true, ..proposed }))
        }
    }
}

/// Draws examples of the given channels, and finds the model and the subset of channels that do best on strokes they have
/// not seen.
fn learn(input: &Input, params: &Params, subsets: &[u32], channels: &[usize], job: Job) -> Result<(Samples, Chosen)> {
    let features = input.features;
    let (samples, probe) = exec::both(|| samples::draw(input, channels, params), || samples::probe(input, channels));
    let samples = samples?;
    job.check()?;
    if !samples.values.iter().chain(&probe).all(|v| v.is_finite()) {
        let bad = exec::map(features.height, job, |y| classify::count_bad(features.row(y)))?;
        return Err(not_finite(bad.iter().sum()));
    }
    let columns = |subset: &u32| (0..channels.len()).filter(|&i| subset >> channels[i] & 1 == 1).collect();
    let question = Question {
        samples: &samples,
        subsets: &subsets.iter().map(columns).collect::<Vec<Vec<usize>>>(),
        probe: &probe,
        ridge: params.ridge,
    };
    let chosen = select::choose(&question, job)?;
    Ok((samples, chosen))
}
