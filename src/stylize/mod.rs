//! Stylisation guided by illumination: Fišer et al., "StyLit: Illumination-Guided Example-Based Stylization of 3D
//! Renderings" (SIGGRAPH 2016), §3.3-3.4.
//!
//! An exemplar scene was rendered as guides A and painted as artwork A′; a target scene is rendered as guides B. From
//! coarse to fine, patches of A′ are matched to positions in the target by current colour and guides (Eq. 1),
//! overlapping patches are averaged (Algorithm 1), and both steps are repeated. StyLit differs from earlier methods in
//! its matching. Each exemplar patch searches for its position in the target, not the other way round, so that no
//! patch is overused and texture does not wash out. An error budget limits these matches, so that no patch is forced
//! into an unsuitable position (`budget`, `retrieve`).
//!
//! The modules: `guides` normalises the guides, `level` quantises one pyramid level, `finder` searches for nearest
//! patches, `budget` finds the knee of the errors, `retrieve` matches under the budget, and `multires` runs from
//! coarse to fine. `border` joins new paint to a painted part. `updater` follows changes of the artwork, and `animate`
//! advances from frame to frame. `report` measures the result, `lack` finds light that the exemplar lacks, `exemplar`
//! finds defects of the exemplar, `directions` decides by its strokes whether the normals guide a run (not in the
//! paper), and `pilot` predicts time and energy from runs at low resolution.
//!
//! The final picture is a blend of the mean and of whole exemplar pixels, with as much fine detail as the exemplar
//! (`VoteMode::Adaptive`, not in the paper).
//!
//! Colours are compared and averaged as encoded for display (sRGB), which approximates how paint is perceived.
//!
//! The defaults depart from the paper where measurements favour it. `Params::paper` holds the paper's settings;
//! `docs/notes/stylize.md` records the measurements.
//!
//! Limitations. The target may show a brightness that the exemplar shows only in another context: a corner of the
//! target may be as dark as a cast shadow of the exemplar. The guides then select the paint of that other context. A
//! guide that distinguishes the two contexts (materials) or a lower `coarse_guides` helps. Paper around the painting
//! counts as paint; exclude it by a `source_mask`.
//!
//! Memory: with four guides of three channels, about 125 MiB per megapixel of the target, and the same for the
//! exemplar, in addition to the input. [bench stylit:sizes]
//!
//! Not modelled: rotation of strokes along the target's shapes; sequences as a whole (each frame knows the previous
//! one only).
//!
//! Covered by patents in the US (StyLit: US 9,881,413 and 10,176,624; patch usage: US 9,905,054; PatchMatch:
//! US 8,861,869, 8,571,328 and 8,625,927); hence the Cargo feature `stylize`, which a distributor can leave out.

mod animate;
mod border;
mod budget;
mod directions;
mod exemplar;
mod finder;
mod guide_record;
mod guides;
mod lack;
mod level;
mod multires;
mod output;
mod params;
mod pca;
mod picture;
mod pilot;
mod report;
mod retrieve;
mod updater;
mod warnings;

#[cfg(test)]
mod tests;

pub use budget::{Budget, Hyperbola, budget};
pub use directions::{Directions, NORMALS_WEIGHT, directions};
pub use exemplar::Doubts;
pub use guide_record::GuideRecord;
pub use guides::{Guide, MAX_CHANNELS, Range};
pub use lack::Lack;
pub use output::{IntermediateResult, Output, Publish};
pub use params::{Finder, Input, Params};
pub use pilot::{PilotRuns, Prediction};
pub use report::{LevelReport, Report, Usage};
pub use retrieve::PassReport;
pub use updater::Updater;
pub use warnings::{MAX_AMBIGUOUS, MAX_BLEMISH, MAX_DISAGREEMENT, MAX_LACK, motion_disagrees};

use crate::error::Result;
use crate::job::Job;

/// Stylises the target.
pub fn run(input: &Input, params: &Params, job: Job) -> Result<Output> {
    run_and_publish(input, params, &|_| (), job)
}

/// Stylises the target and publishes an intermediate result after each level except the finest.
pub fn run_and_publish(input: &Input, params: &Params, publish: Publish, job: Job) -> Result<Output> {
    params.check()?;
    let mut problem = level::Problem::new(input, params, job.part(0.0, 0.03))?;
    let guide_record = problem.guide_record.take();
    let output = multires::run(&problem, guide_record, input, params, publish, job.part(0.03, 1.0))?;
    job.report(1.0);
    Ok(output)
}
