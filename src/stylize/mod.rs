//! Stylisation guided by illumination: Fišer et al., "StyLit: Illumination-Guided Example-Based Stylization of 3D
//! Renderings" (SIGGRAPH 2016), §3.3-3.4.
//!
//! An exemplar scene was rendered as guides A and painted as artwork A′; a target scene is rendered as guides B. From
//! coarse to fine, patches of A′ are matched to positions in the target by current colour and guides (Eq. 1),
//! overlapping patches are averaged (Algorithm 1), and both steps are repeated. StyLit differs from earlier methods in
//! how matches are made. Each exemplar patch searches for its position in the target, not the other way round, so that
//! no patch is overused and texture does not wash out. An error budget limits these matches, so that no patch is
//! forced into an unsuitable position ([`budget`](self), [`retrieve`](self)).
//!
//! `guides` normalises, `level` quantises one resolution, `retrieve` matches under the budget, `budget` fits the knee,
//! `finder` searches, `multires` runs from coarse to fine, `study` follows changes of the artwork, `animate` advances
//! from frame to frame, `greedy` is Hertzmann's algorithm for comparison, `report` measures the result, `pilot`
//! predicts time and energy from runs at low resolution.
//!
//! Colours are compared and averaged as encoded for display (sRGB), which approximates how paint is perceived.
//!
//! The defaults depart from the paper where measurements favour it; `Params::paper` holds the paper's settings, and
//! `docs/notes/stylize.md` the measurements.
//!
//! Limitations. Where the target has light that the exemplar shows only in another context, such as a corner as dark
//! as a cast shadow, the guides select the paint of that context. A guide that distinguishes the two (materials) or a
//! lower `coarse_guides` is the remedy. Paper around the painting counts as paint; exclude it by a `source_mask`.
//!
//! Memory: with four guides of three channels, about 125 MiB per megapixel of the target, and the same for the
//! exemplar, in addition to the input [bench stylit:sizes].
//!
//! Not modelled: rotation of strokes along the target's shapes; sequences as a whole (each frame knows the previous
//! one only).
//!
//! Covered by patents in the US (StyLit: US 9,881,413 and 10,176,624; patch usage: US 9,905,054; PatchMatch:
//! US 8,861,869, 8,571,328 and 8,625,927); hence the Cargo feature `stylize`, which a distributor can leave out.

mod animate;
mod budget;
mod finder;
mod greedy;
mod guides;
mod level;
mod multires;
mod pca;
mod pilot;
mod report;
mod retrieve;
mod study;

#[cfg(test)]
mod tests;

pub use budget::{Budget, Hyperbola, budget};
pub use guides::{Guide, MAX_CHANNELS, Range};
pub use pilot::{PilotRuns, Prediction};
pub use report::{LevelReport, Report, Usage};
pub use retrieve::Pass;
pub use study::Study;

use crate::error::{Error, Result, check_range};
use crate::image::Image;
use crate::job::Job;
use crate::patch::{Field, MAX_SIDE, Vote};

/// The matching method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The paper's method: reversed retrieval under an error budget.
    Budget,
    /// Reversed retrieval without a budget: all exemplar patches are used equally often (Jamriška et al. 2015).
    Uniform,
    /// Each target patch takes its nearest exemplar patch (Wexler et al. 2007, Kwatra et al. 2005).
    Nearest,
    /// One pass in scan order, by best or by most coherent match (Hertzmann et al. 2001).
    Greedy,
    /// Each pixel takes the exemplar pixel with the nearest guides; with normals as the guide, the Lit Sphere (Sloan et
    /// al. 2001).
    LitSphere,
    /// Each target patch takes its nearest exemplar patch, with a penalty for frequently used ones (Kaspar et al.
    /// 2015): see `Params::occurrence`. Single-threaded, and with PatchMatch only.
    Occurrence,
}

/// The nearest-patch search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finder {
    /// PatchMatch.
    PatchMatch,
    /// A k-d tree over patch means, which is not PatchMatch.
    Table,
}

#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The artwork A′ in linear colour, aligned with the source side of the guides; 1, 3 or 4 channels.
    pub artwork: &'a Image,
    /// Pairs of A and B; at least one.
    pub guides: &'a [Guide<'a>],
    /// One channel; patches are taken only from pixels above 0.5. If absent, from everywhere.
    pub source_mask: Option<&'a Image>,
    /// One channel; only pixels above 0.5 are synthesised, the others are taken from `known`, or black. If absent, all
    /// pixels.
    pub target_mask: Option<&'a Image>,
    /// The target outside its mask: matched against, never changed. Same channels as the artwork.
    pub known: Option<&'a Image>,
    /// The field of an earlier result for a target of the same size, as initial matches.
    pub previous: Option<&'a Field>,
    /// Position of each target pixel in the frame of `previous`, relative to its position in this one, in pixels: two
    /// channels, NaN where it was not visible. Matches are advected along it, and the share `Params::coherence` of
    /// them is kept.
    pub motion: Option<&'a Image>,
}

impl<'a> Input<'a> {
    /// Uses the whole exemplar for the whole target.
    pub fn new(artwork: &'a Image, guides: &'a [Guide<'a>]) -> Self {
        Self { artwork, guides, source_mask: None, target_mask: None, known: None, previous: None, motion: None }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    pub mode: Mode,
    pub finder: Finder,
    /// Width of a patch in pixels, odd, in `[1, 33]`. Reduced if the images are smaller.
    pub patch: usize,
    /// Weight μ of all guides together relative to all of the artwork's colours together, in `[0, 1e6]`.
    pub guide_weight: f32,
    /// Factor on the weight of the guides on all levels except the finest, in `[0, 1000]`: guides determine the
    /// placement, colours the continuity. The paper has 1.
    pub coarse_guides: f32,
    /// Maximum number of resolution levels, each half of the next, in `[1, 16]`; fewer if the coarsest would be
    /// smaller than 5 patches.
    pub levels: usize,
    /// EM iterations on the second finest level, in `[1, 100]`.
    pub iterations: usize,
    /// EM iterations on each coarser level, in `[1, 100]`.
    pub coarse_iterations: usize,
    /// EM iterations on the finest level, in `[1, 100]`.
    pub finest_iterations: usize,
    /// Further EM iterations on the finest level in which each patch takes its nearest match (Wexler et al. 2007),
    /// starting from the result under the budget, in `[0, 100]`; the paper has 0. In other modes, further iterations
    /// of the mode itself.
    pub polish: usize,
    /// PatchMatch sweeps per retrieval, in `[1, 100]`.
    pub sweeps: usize,
    /// Share of the target to cover under the budget before the rest is matched without it, in `[0, 1]`.
    pub coverage: f32,
    /// Maximum number of retrieval passes per iteration, in `[1, 1000]`.
    pub passes: usize,
    /// Propagation sweeps after a retrieval, in `[0, 100]`: a target patch may continue its neighbour's match if that
    /// is closer. With 0 the paper's assignment is unchanged.
    pub settle: usize,
    /// Cost of a seam between two neighbouring patches during these sweeps, as a share of the mean error, in `[0,
    /// 100]`.
    pub seam: f32,
    pub vote: Vote,
    /// The vote that forms the final picture from the final field.
    pub final_vote: Vote,
    /// Share of the previous frame's matches that are kept where they fit, in `[0, 1]`; no effect without motion. Use
    /// a different `seed` for each frame, or the same blocks change every time.
    pub coherence: f32,
    /// Degree to which the exemplar's light is adapted to the brightness and contrast of the target's, in `[0, 1]`:
    /// for targets under different light than the exemplar (Fig. 16).
    pub match_appearance: f32,
    /// Weight λ of `Mode::Occurrence`, in `[0, 10]`: the penalty of a match to a patch of average usage, in the unit
    /// of Eq. 1 (the sum over a patch of squared differences of channels in `[0, 1]`). With 0 the result equals
    /// `Mode::Nearest` to the bit. Fišer et al. chose 0.1 for their picture (Fig. 10n).
    pub occurrence: f32,
    /// Half resolution, with guides compressed to their principal components: for interactive painting.
    pub preview: bool,
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            mode: Mode::Budget,
            finder: Finder::PatchMatch,
            patch: 5,
            guide_weight: 2.0,
            coarse_guides: 4.0,
            levels: 6,
            iterations: 6,
            coarse_iterations: 24,
            finest_iterations: 1,
            polish: 3,
            sweeps: 1,
            coverage: 0.9,
            passes: 6,
            settle: 2,
            seam: 0.2,
            vote: Vote::Weighted,
            final_vote: Vote::Majority,
            coherence: 1.0,
            match_appearance: 0.0,
            occurrence: 0.1,
            preview: false,
            seed: 1,
        }
    }
}

impl Params {
    /// The paper's settings: the budget's assignment unchanged, plain averages, six iterations and sweeps.
    pub fn paper() -> Self {
        Self {
            coarse_guides: 1.0,
            coarse_iterations: 6,
            finest_iterations: 6,
            polish: 0,
            sweeps: 6,
            coverage: 0.95,
            passes: 64,
            settle: 0,
            vote: Vote::Plain,
            final_vote: Vote::Plain,
            ..Self::default()
        }
    }

    /// Half the computation time of the default.
    pub fn fast() -> Self {
        Self { iterations: 3, coarse_iterations: 6, polish: 0, ..Self::default() }
    }

    /// For interactive painting.
    pub fn preview() -> Self {
        Self { preview: true, iterations: 2, coarse_iterations: 3, passes: 3, ..Self::fast() }
    }

    /// Checks that every setting is in its range.
    pub fn check(&self) -> Result<()> {
        check_range("patch", self.patch, 1, 33)?;
        if self.patch % 2 == 0 {
            return Err(Error::argument(format!("patch is {}; it must be odd", self.patch)));
        }
        check_range("guide_weight", self.guide_weight, 0.0, 1e6)?;
        check_range("levels", self.levels, 1, 16)?;
        check_range("coarse_guides", self.coarse_guides, 0.0, 1000.0)?;
        check_range("iterations", self.iterations, 1, 100)?;
        check_range("coarse_iterations", self.coarse_iterations, 1, 100)?;
        check_range("finest_iterations", self.finest_iterations, 1, 100)?;
        check_range("polish", self.polish, 0, 100)?;
        check_range("sweeps", self.sweeps, 1, 100)?;
        check_range("coverage", self.coverage, 0.0, 1.0)?;
        check_range("settle", self.settle, 0, 100)?;
        check_range("seam", self.seam, 0.0, 100.0)?;
        check_range("coherence", self.coherence, 0.0, 1.0)?;
        if self.mode == Mode::Occurrence && self.finder == Finder::Table {
            return Err(Error::argument(
                "mode is occurrence and search is table; with this mode it must be PatchMatch",
            ));
        }
        check_range("match_appearance", self.match_appearance, 0.0, 1.0)?;
        check_range("occurrence", self.occurrence, 0.0, 10.0)?;
        check_range("passes", self.passes, 1, 1000)?;
        Ok(())
    }
}

#[derive(Clone, Debug)]
pub struct Output {
    /// The stylised target, linear colour.
    pub image: Image,
    /// The exemplar patch of each target patch.
    pub field: Field,
    pub report: Report,
}

/// An intermediate result, published after each level except the last, coarsest first.
pub struct Glimpse<'a> {
    /// The current picture in linear colour, at the size of the level.
    pub picture: Image,
    /// Number of halvings (rounding down) from the target's size to the picture's.
    pub halvings: usize,
    /// Reports of the finished levels.
    pub levels: &'a [LevelReport],
}

/// Callback for intermediate results.
pub type Publish<'a> = &'a (dyn Fn(Glimpse) + Sync);

/// Stylises the target.
pub fn run(input: &Input, params: &Params, job: Job) -> Result<Output> {
    run_and_publish(input, params, &|_| (), job)
}

/// Stylises the target and publishes an intermediate result after each level.
pub fn run_and_publish(input: &Input, params: &Params, publish: Publish, job: Job) -> Result<Output> {
    params.check()?;
    let problem = level::Problem::new(input, params, job.part(0.0, 0.03))?;
    let output = multires::run(&problem, input, params, publish, job.part(0.03, 1.0))?;
    job.report(1.0);
    Ok(output)
}

/// Checks that an image is not larger than supported.
fn check_side(name: &str, image: &Image) -> Result<()> {
    check_range(&format!("{name}.width"), image.width, 1, MAX_SIDE)?;
    check_range(&format!("{name}.height"), image.height, 1, MAX_SIDE)?;
    Ok(())
}
