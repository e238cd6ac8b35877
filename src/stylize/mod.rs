//! Stylisation guided by illumination: Fišer et al., "StyLit: Illumination-Guided Example-Based Stylization of 3D
//! Renderings" (SIGGRAPH 2016), §3.3-3.4.
//!
//! An exemplar scene was rendered as guides A and painted as artwork A′; a target scene is rendered as guides B. From
//! coarse to fine, patches of A′ are matched to places in the target by colour so far and by guides (Eq. 1), overlapping
//! patches are averaged (Algorithm 1), and so on. What sets StyLit apart is how matches are made: each exemplar patch
//! looks for its place in the target, not the other way round, so that no patch is overused and texture does not wash
//! out; and it does so under an error budget, so that none is forced into a place where it does not belong
//! ([`budget`](self), [`retrieve`](self)).
//!
//! `guides` normalises, `level` quantises one resolution, `retrieve` matches under the budget, `budget` fits the knee,
//! `finder` searches, `schedule` goes from coarse to fine, `study` follows changes of the artwork, `animate` goes from frame to
//! frame, `greedy` is Hertzmann's algorithm for comparison, `report` measures, `probe` foretells.
//!
//! Colours are compared and averaged as they are encoded for display (sRGB), which is how paint is looked at.
//!
//! Where the defaults leave the paper, it is because measuring said so (`benches/stylit.rs` draws the curves; `Params::paper`
//! has the paper's own). On the golem at 600 × 456 letting patches settle after a retrieval brings Eq. 3 from 6.3e-3 to
//! 2.4e-3, near the 2.0e-3 of plain EM, and choosing one vote at the end instead of the mean brings texture power from 0.85
//! to 0.93 of the exemplar's (plain EM: 0.78). At 1200 × 912 one iteration under the budget and three of ordinary matching
//! after it (`Params::polish`), all with one sweep, bring Eq. 3 to 1.58e-3 in half the time in which two iterations under the
//! budget with two sweeps bring it to 1.56e-3 (plain EM: 1.48e-3), and follow the guides more closely. More of either brings
//! Eq. 3 further down and washes out: it prefers smooth patches.
//!
//! Where things are is settled on the coarse levels, which cost little: twice as many iterations there bring Eq. 3 to
//! 1.52e-3, and guides that weigh four times as much there (`Params::coarse_guides`) to 1.42e-3, for a quarter more time; the
//! guide error of `stylit_judge.py` falls from 861 to 831 with the latter, and the shading of the target's forms becomes
//! clearer. Eight times as much brings it to 801, in smaller pieces whose strokes break off. A greater weight on the finest
//! level too makes more seams, for less. Twice as many iterations again (24) bring the judge's guide error from 830 to 806,
//! the mean of three seeds, each of which gained, and Eq. 3 down by a hundredth, for about a tenth more time; 48 bring no more.
//! Twelve rounds of polish in place of three bring it down by another 13 (three seeds: 18, 10 and 9) and coherence by 1.5, for a
//! third more time.
//! Beside single settings mind the seeds: each moves that guide error by 10 to 15.
//!
//! What is left of that error is not the matches: where they lead, the guides differ by 35 (squared 8-bit steps, of 831). The
//! judge looks patches up by appearance. Three quarters of them the artwork contains to the bit, and they have 530; the quarter
//! over seams between pieces, most of them where the target's shapes have edges, has 1736, against 1327 for the patches it was
//! made of. Larger pieces (`Params::seam` up to 3), seams cut along pixels that agree (as Kwatra et al. 2003), more sweeps and
//! more rounds at the end moved it by less than the seeds do; a coverage of 99 % by 21, for half more time and 4 % more of
//! Eq. 3. Where the target has light that the exemplar has only in another place,
//! such as a corner as dark as a cast shadow, the guides ask for that place's paint, and on the coarse levels they are heard: a
//! guide that tells the two apart (materials) or a lower `coarse_guides` is the remedy. Paper around the painting is paint
//! to the engine; a `source_mask` leaves it out.
//!
//! Leaving the last tenth of the target to ordinary retrieval saves a tenth of the time, and costs nothing.
//!
//! Memory: with four guides of three channels about 125 MiB for each megapixel of the target, and as much for the exemplar,
//! beside the input (`benches/stylit.rs`, section `sizes`).
//!
//! Not modelled: rotation of strokes along the target's shapes, and sequences as a whole: each frame knows the one before.
//!
//! Covered by patents in the US (StyLit: US 9,881,413 and 10,176,624; patch usage: US 9,905,054; PatchMatch:
//! US 8,861,869, 8,571,328 and 8,625,927); hence the Cargo feature `stylize`, which a distributor can leave out.

mod animate;
mod budget;
mod finder;
mod greedy;
mod guides;
mod level;
mod pca;
mod probe;
mod report;
mod retrieve;
mod schedule;
mod study;

#[cfg(test)]
mod tests;

pub use budget::{Budget, Hyperbola, budget};
pub use guides::{Guide, MAX_CHANNELS, Range};
pub use probe::{Probe, Trial};
pub use report::{LevelReport, Report, Usage};
pub use retrieve::Pass;
pub use study::Study;

use crate::error::{Error, Result, check_range};
use crate::image::Image;
use crate::job::Job;
use crate::patch::{Field, MAX_SIDE, Vote};

/// How matches are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The paper's: reversed retrieval under an error budget.
    Budget,
    /// Reversed retrieval without a budget: every exemplar patch is used equally often (Jamriška et al. 2015).
    Uniform,
    /// Each target patch takes its nearest exemplar patch (Wexler et al. 2007, Kwatra et al. 2005).
    Nearest,
    /// One pass in scan order, by best or by most coherent match (Hertzmann et al. 2001).
    Greedy,
    /// Each pixel takes the exemplar pixel with the nearest guides; with normals as the guide, the Lit Sphere (Sloan et
    /// al. 2001).
    LitSphere,
    /// Each target patch takes its nearest exemplar patch, where those that are used often count as farther (Kaspar et al.
    /// 2015): see `Params::occurrence`. On one thread, and by PatchMatch only.
    Occurrence,
}

/// How nearest patches are searched for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finder {
    /// PatchMatch.
    PatchMatch,
    /// A k-d tree over patch means: not PatchMatch.
    Table,
}

#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The artwork A′, linear colour, aligned with the source side of the guides; 1, 3 or 4 channels.
    pub artwork: &'a Image,
    /// Pairs of A and B; at least one.
    pub guides: &'a [Guide<'a>],
    /// One channel; patches are only taken from where it is above 0.5. Absent: from everywhere.
    pub source_mask: Option<&'a Image>,
    /// One channel; only pixels above 0.5 are made, the others are taken from `known`, or black. Absent: all.
    pub target_mask: Option<&'a Image>,
    /// What the target shows outside its mask: matched against, never changed. Same channels as the artwork.
    pub known: Option<&'a Image>,
    /// A field of an earlier result for targets of the same size, to start from instead of from nothing.
    pub previous: Option<&'a Field>,
    /// Where each target pixel was in the frame that `previous` belongs to, relative to where it is, in pixels: two channels,
    /// NaN where it was not to be seen. Its matches move along, and as many are kept as `Params::coherence` says.
    pub motion: Option<&'a Image>,
}

impl<'a> Input<'a> {
    /// The whole exemplar for the whole target.
    pub fn new(artwork: &'a Image, guides: &'a [Guide<'a>]) -> Self {
        Self { artwork, guides, source_mask: None, target_mask: None, known: None, previous: None, motion: None }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    pub mode: Mode,
    pub finder: Finder,
    /// Width of a patch in pixels, odd, in `[1, 33]`. Shrinks to the images where they are smaller.
    pub patch: usize,
    /// Weight μ of all guides together against the artwork's colours together, in `[0, 1e6]`.
    pub guide_weight: f32,
    /// How many times as much the guides weigh on all levels but the finest, in `[0, 1000]`: they say where things are, and
    /// colours how they join. 1 is the paper's.
    pub coarse_guides: f32,
    /// Most resolution levels, each half of the next, in `[1, 16]`; fewer where the coarsest would be below 5 patches.
    pub levels: usize,
    /// EM iterations on the level before the finest, in `[1, 100]`.
    pub iterations: usize,
    /// EM iterations on each level coarser than that, in `[1, 100]`.
    pub coarse_iterations: usize,
    /// EM iterations on the finest level, in `[1, 100]`.
    pub finest_iterations: usize,
    /// EM iterations after those in which each patch takes its nearest match (Wexler et al. 2007), starting from what the
    /// budget made, in `[0, 100]`; 0 is the paper's. In other modes as many more of their own.
    pub polish: usize,
    /// PatchMatch sweeps in a retrieval, in `[1, 100]`.
    pub sweeps: usize,
    /// Share of the target to cover under the budget before the rest is matched without, in `[0, 1]`.
    pub coverage: f32,
    /// Most retrieval passes in an iteration, in `[1, 1000]`.
    pub passes: usize,
    /// Sweeps of propagation after a retrieval, in `[0, 100]`: a target patch may continue its neighbour's match where that
    /// is closer. 0 is the paper's assignment as it is.
    pub settle: usize,
    /// What a seam between two neighbouring patches costs while they settle, as a share of the mean error, in `[0, 100]`.
    pub seam: f32,
    pub vote: Vote,
    /// How the last picture is made from the last field.
    pub final_vote: Vote,
    /// Share of the matches of the frame before that are kept where they fit, in `[0, 1]`; without motion it has no effect. Give
    /// each frame its own `seed`, or the same places boil.
    pub coherence: f32,
    /// How far the exemplar's light is changed to the brightness and contrast of the target's, in `[0, 1]`: for targets under
    /// another light than the exemplar (Fig. 16).
    pub match_appearance: f32,
    /// Weight λ of `Mode::Occurrence`, in `[0, 10]`: what a match to a patch that is used as often as all on average costs
    /// beside its distance, in the unit of Eq. 1, the sum over a patch of squared differences of channels in `[0, 1]`. 0 is
    /// `Mode::Nearest` to the bit. 0.1 is what Fišer et al. found best (Fig. 10n), by hand for their picture.
    pub occurrence: f32,
    /// Half resolution, guides compressed to their principal components: for watching while painting.
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
            final_vote: Vote::Most,
            coherence: 1.0,
            match_appearance: 0.0,
            occurrence: 0.1,
            preview: false,
            seed: 1,
        }
    }
}

impl Params {
    /// The paper's own settings: the budget's assignment as it is, plain averages, six of everything.
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

    /// Half the time of the default.
    pub fn fast() -> Self {
        Self { iterations: 3, coarse_iterations: 6, polish: 0, ..Self::default() }
    }

    /// For watching while painting.
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

/// How far a run is: shown after each level but the last, coarsest first.
pub struct Glimpse<'a> {
    /// The picture so far, linear colour, of the size of the level.
    pub picture: Image,
    /// How often that size is half the target's, rounded down.
    pub halvings: usize,
    /// The levels done.
    pub levels: &'a [LevelReport],
}

/// What is called with each glimpse.
pub type Publish<'a> = &'a (dyn Fn(Glimpse) + Sync);

/// Stylises the target.
pub fn run(input: &Input, params: &Params, job: Job) -> Result<Output> {
    run_and_publish(input, params, &|_| (), job)
}

/// Stylises the target and shows a picture after each level.
pub fn run_and_publish(input: &Input, params: &Params, publish: Publish, job: Job) -> Result<Output> {
    params.check()?;
    let problem = level::Problem::new(input, params, job.part(0.0, 0.03))?;
    let output = schedule::run(&problem, input, params, publish, job.part(0.03, 1.0))?;
    job.report(1.0);
    Ok(output)
}

/// Largest accepted side.
fn check_side(name: &str, image: &Image) -> Result<()> {
    check_range(&format!("{name}.width"), image.width, 1, MAX_SIDE)?;
    check_range(&format!("{name}.height"), image.height, 1, MAX_SIDE)?;
    Ok(())
}
