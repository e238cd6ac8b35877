//! Guided segmentation: learns a classifier from the user's strokes on the photo, and computes a mask and a confidence
//! for every pixel ("Lighting Style Transfer", §4.2).
//!
//! ```text
//! strokes ─▶ samples ─▶ standardise ─▶ logistic models ─▶ cross-validation ─▶ the best model, calibrated
//!                                                                                   │
//! features ────────────────────────────────────────────────────────────▶ classify ◀─┘ ─▶ mask, confidence, unseen
//! ```
//! The three outputs are fields of [`Segmentation`].
//!
//! The paper does not name its classifier. Here it is logistic regression, with linear or with quadratic terms of the
//! features. Such a model cannot memorise single samples, so it also works on surfaces that no stroke touched. Trees
//! and kernel methods can memorise samples, and fail on such surfaces.
//!
//! Cross-validation decides which of the two models is used, on which channels, and by which factor its logits are
//! scaled (calibration). It holds out strokes and parts of strokes, not single pixels: a held-out pixel would be almost
//! equal to its neighbours in the training set.
//!
//! The paper's two phases are two runs. The first run finds the plane ([`StrokeSet::plane_examples`]). The second run
//! finds the lights within the plane's mask, by colour alone ([`Params::for_lights`]), because lights lie on the plane
//! and share its geometry.
//!
//! Known weakness: if the strokes lie on few surfaces, several subsets of channels do equally well on held-out strokes.
//! The smallest of these subsets is then chosen, and its probabilities are too confident.
//!
//! No state is kept between runs: after each additional stroke, the model is learnt and validated anew. The result
//! therefore depends on the strokes alone and not on earlier runs.
//!
//! Each pixel is classified on its own. An optional edge-aware filter ([`Params::refine_radius`]) then mixes each
//! pixel's probability with its neighbours' probabilities, mostly with neighbours of similar colour. The filter makes
//! masks follow the edges of the photo, and removes noise and small mistakes. It also removes lamps that are smaller
//! than the radius.
//!
//! Lamps are found as whole regions rather than pixel by pixel ([`instances`]), unless the caller asks for a surface
//! ([`Subject`]). The mask of a plane is restricted to the face of the room that its strokes lie on ([`face`]).
//!
//! Not modelled: dependence between neighbouring pixels while the classifier is learnt.

mod classify;
mod edges;
mod ellipsoid;
mod exponential;
mod face;
mod input;
mod instances;
mod logistic;
mod params;
mod refine;
mod rims;
mod samples;
mod segmentation;
mod select;
mod standardise;
pub mod strokes;
mod table;
#[cfg(test)]
mod tests;
mod warnings;

pub use edges::smooth_edges;
pub use input::Input;
pub use params::{Params, SUBSETS, Subject};
pub use rims::lamp_rims;
pub use segmentation::{Model, Segmentation};
pub use strokes::{Stroke, StrokeSet};
pub use warnings::{almost_all_lit, dim_lamps};

use crate::error::{Error, Result, check_range};
use crate::exec;
use crate::features::CHANNELS;
use crate::job::Job;
use classify::Classified;
use input::MAX_CHANNELS;
use samples::Samples;
use select::{Chosen, SelectionInput};

/// Bits of the feature channels 3 to 6: screen depth and position.
const POSITION: u32 = 0b111_1000;

/// Returns the subsets of channels to choose from, as bit masks. `count` is the number of feature channels; `wanted`
/// is [`Params::channels`], where 0 leaves the choice open.
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
/// If strokes are missing and the features have [`CHANNELS`] channels, the mask is a proposal. For a surface, this
/// requires that no region is given:
/// - without negative strokes, the face of the room that the positive strokes lie on;
/// - without positive strokes, the ceiling, minus the parts that resemble the negative strokes.
///
/// For lamps, it requires a region:
/// - without positive strokes, the regions most like lamps among the brightest parts of the region.
///
/// Errors (`Degenerate`): strokes are missing, and no mask can be proposed. Either one of these requirements is not
/// met, or no face, ceiling or lamp was found.
pub fn run(input: &Input, params: &Params, job: Job) -> Result<Segmentation> {
    let features = input.features;
    params.check()?;
    input.check()?;
    let mut subsets = subsets(features.channels, params.channels)?;

    let is_lamps = match params.subject {
        Subject::Auto => input.region.is_some() && features.channels == CHANNELS,
        Subject::Surface => false,
        Subject::Lamps => true,
    };
    if is_lamps {
        check_range("the number of feature channels where lamps are sought", features.channels, 3, MAX_CHANNELS)?;
        return instances::run(input, job);
    }

    if input.region.is_none()
        && features.channels == CHANNELS
        && let Some(proposed) = propose(input, params, job)?
    {
        return Ok(proposed);
    }
    if params.channels == 0 && input.region.is_none() && face::laid_out(input).is_some() {
        subsets.retain(|subset| subset & POSITION == 0);
    }
    let channels: Vec<usize> = (0..features.channels).filter(|c| subsets.iter().any(|s| s >> c & 1 == 1)).collect();
    // Allocating the output images takes a while, so allocate them in parallel with learning.
    let blank = || classify::Blank::new(features.width, features.height);
    let (learnt, blank) = exec::both(|| learn(input, params, &subsets, &channels, job.part(0.0, 0.4)), blank);
    let ((samples, chosen), blank) = (learnt?, blank?);

    let done = if params.refine_radius > 0 { 0.5 } else { 1.0 };
    let mut classified = classify::run(features, input.region, &channels, &chosen, blank, job.part(0.4, done))?;
    if classified.bad > 0 {
        return Err(not_finite(classified.bad));
    }
    if params.refine_radius > 0 {
        classified.refine(input, params, job.part(done, 1.0))?;
    }
    if input.region.is_none() && features.channels == CHANNELS {
        face::restrict(input, &mut classified)?;
    }
    Ok(result(classified, &samples, &chosen, &channels))
}

/// Builds the [`Segmentation`] from the classified pixels. `chosen.columns` holds indices into `channels`.
fn result(classified: Classified, samples: &Samples, chosen: &Chosen, channels: &[usize]) -> Segmentation {
    let unseen = classified.mean_unseen;
    Segmentation {
        mask: classified.mask,
        confidence: classified.confidence,
        unseen: classified.unseen,
        error: chosen.held_out_parts.error * (1.0 - unseen) + chosen.held_out_strokes.error * unseen,
        model: Some(chosen.model),
        channels: chosen.columns.iter().map(|&i| 1 << channels[i]).sum(),
        samples: samples.counts,
        contradictory: samples.contradictory,
        off_image: samples.off_image,
        is_of_lamps: false,
        is_proposed: false,
        beyond: Vec::new(),
    }
}

/// Proposes the mask of a plane if the strokes of a class are missing. Returns `None`
/// - if both classes have strokes in the image;
/// - if only positive strokes exist, and do not lie on a single face of a room laid out as a box.
///
/// Errors (`Degenerate`): positive strokes are missing, and no ceiling was found.
fn propose(input: &Input, params: &Params, job: Job) -> Result<Option<Segmentation>> {
    let count = input.features.width * input.features.height;
    let is_seen = |s: &Stroke| s.pixels.iter().any(|&p| (p as usize) < count);
    let has = |positive: bool| input.strokes.iter().any(|s| s.positive == positive && is_seen(s));
    match (has(true), has(false)) {
        (true, true) => Ok(None),
        (true, false) => face::of_strokes(input),
        (false, false) => face::of_ceiling(input).map(Some),
        // Add a positive stroke of ceiling pixels. The user's negative strokes follow it, because the later stroke
        // wins where two strokes overlap.
        (false, true) => {
            let mut strokes = vec![face::ceiling_example(input.features)?];
            strokes.extend(input.strokes.iter().cloned());
            let proposed = run(&Input { strokes: &strokes, ..*input }, params, job)?;
            Ok(Some(Segmentation { is_proposed: true, ..proposed }))
        }
    }
}

/// Draws samples of the given channels, then chooses the model and the subset of channels (see [`select::choose`]).
fn learn(input: &Input, params: &Params, subsets: &[u32], channels: &[usize], job: Job) -> Result<(Samples, Chosen)> {
    let features = input.features;
    let (samples, unlabelled) =
        exec::both(|| samples::draw(input, channels, params), || samples::unlabelled(input, channels));
    let samples = samples?;
    job.check()?;
    if !samples.values.iter().chain(&unlabelled).all(|v| v.is_finite()) {
        let bad = exec::map(features.height, job, |y| classify::count_bad(features.row(y)))?;
        return Err(not_finite(bad.iter().sum()));
    }
    let columns = |subset: &u32| (0..channels.len()).filter(|&i| subset >> channels[i] & 1 == 1).collect();
    let selection_input = SelectionInput {
        samples: &samples,
        subsets: &subsets.iter().map(columns).collect::<Vec<Vec<usize>>>(),
        unlabelled: &unlabelled,
        ridge: params.ridge,
    };
    let chosen = select::choose(&selection_input, job)?;
    Ok((samples, chosen))
}
