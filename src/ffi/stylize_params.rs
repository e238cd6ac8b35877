//! Settings of a stylisation
//!
//! Presets and settings. StyLit is the paper of Fiser et al. 2016, "StyLit: Illumination-Guided Example-Based
//! Stylization of 3D Renderings". As in StyLit, exemplar patches are matched with target patches in several passes. In
//! each pass, every exemplar patch finds the nearest target patch that has no match yet. The pairs are accepted,
//! smallest error first, until the sum of their errors reaches the error budget, which the library computes from the
//! errors of the pass. This prevents a few patches from being used everywhere, and bad matches from being forced. The
//! defaults were chosen from the curves of quality against time that benches/stylit.rs draws.

use super::guard::guard;
use super::params::{self, versioned};
use super::status::luxfer_status;
use crate::error::{Error, Result};
use crate::patch::VoteMode;
use crate::stylize::{self, Finder};

/// A preset of the settings, which trades quality for speed: a LUXFER_STYLIZE_ preset, that is, LUXFER_STYLIZE_FULL,
/// LUXFER_STYLIZE_FAST, LUXFER_STYLIZE_PREVIEW or LUXFER_STYLIZE_PAPER.
pub type luxfer_stylize_preset = i32;
/// Full quality, the default.
pub const LUXFER_STYLIZE_FULL: luxfer_stylize_preset = 0;
/// Nearly the quality of LUXFER_STYLIZE_FULL in half the time.
pub const LUXFER_STYLIZE_FAST: luxfer_stylize_preset = 1;
/// Half resolution with compressed guides (see luxfer_stylize_params.preview), for feedback while painting.
pub const LUXFER_STYLIZE_PREVIEW: luxfer_stylize_preset = 2;
/// The settings of StyLit (Fiser et al. 2016), for comparison.
pub const LUXFER_STYLIZE_PAPER: luxfer_stylize_preset = 3;

/// The search for nearest patches: a LUXFER_STYLIZE_SEARCH_ value.
pub type luxfer_stylize_search = i32;
/// PatchMatch (Barnes et al. 2009), the default.
pub const LUXFER_STYLIZE_SEARCH_PATCHMATCH: luxfer_stylize_search = 0;
/// A k-d tree over the mean colours and guides of patches.
pub const LUXFER_STYLIZE_SEARCH_KD_TREE: luxfer_stylize_search = 1;

/// How a pixel is computed from overlapping patches: a LUXFER_STYLIZE_VOTE_ value.
pub type luxfer_stylize_vote = i32;
/// The mean of the colours that the overlapping patches have at the pixel.
pub const LUXFER_STYLIZE_VOTE_PLAIN: luxfer_stylize_vote = 0;
/// The mean of the colours that the overlapping patches have at the pixel, weighted so that closer matches count more.
pub const LUXFER_STYLIZE_VOTE_WEIGHTED: luxfer_stylize_vote = 1;
/// Of the overlapping patches' colours, the colour that is nearest to their mean, so that every colour occurs in the
/// artwork.
pub const LUXFER_STYLIZE_VOTE_NEAREST: luxfer_stylize_vote = 2;
/// The artwork pixel that the largest number of overlapping patches put at this pixel. Where two pieces of the artwork
/// meet, each stays whole up to the seam.
pub const LUXFER_STYLIZE_VOTE_MAJORITY: luxfer_stylize_vote = 3;
/// A blend of LUXFER_STYLIZE_VOTE_PLAIN and LUXFER_STYLIZE_VOTE_MAJORITY. The proportion varies, so that each place of
/// the picture has as much fine detail as the place of the artwork from which it was painted. The blend thus copies
/// pixels of the artwork unchanged in rough paint, has soft transitions in smooth paint, and has edges as sharp as in
/// the artwork. luxfer_stylize_report.unblended_share is the share of unchanged pixels.
pub const LUXFER_STYLIZE_VOTE_ADAPTIVE: luxfer_stylize_vote = 4;

/// Settings of a stylisation. Fill them with luxfer_stylize_params_init or luxfer_stylize_get_preset. The defaults
/// stated here belong to LUXFER_STYLIZE_FULL.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_stylize_params {
    /// sizeof(luxfer_stylize_params), set by luxfer_stylize_params_init.
    pub struct_size: u32,
    /// Search for nearest patches: a LUXFER_STYLIZE_SEARCH_ value; default LUXFER_STYLIZE_SEARCH_PATCHMATCH.
    pub search: luxfer_stylize_search,
    /// Width of a patch in pixels, odd, in [1, 33]; default 5. Patches are smaller if an image is smaller than one
    /// patch.
    pub patch: u32,
    /// Weight of all guides together, relative to the weight of all colour channels of the artwork together, in [0,
    /// 1e6]; default 2.
    pub guide_weight: f32,
    /// Factor for guide_weight on all levels but the finest, in [0, 1000]; default 4; StyLit has 1. With a larger
    /// factor the picture follows the guides more closely, with smaller connected pieces of the artwork.
    pub coarse_guides: f32,
    /// Maximum number of resolution levels, each half as wide and high as the next finer one, in [1, 16]; default 6.
    /// The coarsest level is at least 5 patches wide and high.
    pub levels: u32,
    /// Rounds on the second finest level, in [1, 100]; default 6. A round is an EM iteration: matching, then voting.
    pub iterations: u32,
    /// Rounds (EM iterations) on each level coarser than the second finest, in [1, 100]; default 24; StyLit has 6.
    pub coarse_iterations: u32,
    /// Rounds (EM iterations) on the finest level, in [1, 100]; default 1.
    pub finest_iterations: u32,
    /// Additional rounds (EM iterations) on the finest level, in [0, 100]; default 3; StyLit has 0. In these rounds
    /// each target patch takes its nearest exemplar patch, without the error budget.
    pub polish: u32,
    /// Number of PatchMatch iterations in one search for nearest patches, in [1, 100]; default 1.
    pub search_iterations: u32,
    /// The passes under the error budget end once they have matched this share of the target patches, in [0, 1];
    /// default 0.9. Each remaining target patch then takes its nearest exemplar patch.
    pub coverage: f32,
    /// Maximum number of matching passes under the error budget in one round (EM iteration), in [1, 1000]; default 6.
    pub passes: u32,
    /// Number of iterations after each matching, in [0, 100]; default 2; StyLit has 0. In such an iteration, a target
    /// patch may take the exemplar patch that continues the match of its neighbour, which leaves fewer seams.
    pub settle: u32,
    /// Cost of a seam, as a share of the mean error of a match, in [0, 100]; default 0.2. A seam lies between two
    /// neighbouring target patches whose matches are not neighbours in the exemplar. The cost applies to the iterations
    /// after each matching; see settle.
    pub seam: f32,
    /// How a pixel is computed from overlapping patches in all rounds but the last: a LUXFER_STYLIZE_VOTE_ value;
    /// default LUXFER_STYLIZE_VOTE_WEIGHTED.
    pub vote: luxfer_stylize_vote,
    /// How a pixel of the final picture, after the last round, is computed from overlapping patches: a
    /// LUXFER_STYLIZE_VOTE_ value; default LUXFER_STYLIZE_VOTE_ADAPTIVE.
    pub final_vote: luxfer_stylize_vote,
    /// 1: work at half resolution, which makes the picture half as wide and high, with compressed guides: the few
    /// principal components of all guides instead of the guides themselves. 0, the default: full resolution.
    pub preview: u32,
    /// 1: keep the data that luxfer_stylize_update needs, about as much memory as all guides; 0, the default: free it.
    pub keep_for_update: u32,
    /// Share of the previous frame's paint that is kept where it fits, in [0, 1]; default 1. Below 1 the paint changes
    /// from frame to frame ("boils"), as in hand-painted animation, if each frame has its own seed. No effect without
    /// luxfer_stylize_set_motion.
    pub coherence: f32,
    /// Degree to which the exemplar's light guides are adapted, in brightness and contrast, to the target's light
    /// guides, in [0, 1]; 0, the default: not at all.
    pub match_appearance: f32,
    /// Must be 0.
    pub reserved: u32,
    /// Seed of the search; default 1.
    pub seed: u64,
}

versioned!(luxfer_stylize_params, [96], { Self::of(&stylize::Params::default()) });

const SEARCHES: [Finder; 2] = [Finder::PatchMatch, Finder::KdTree];
const VOTES: [VoteMode; 5] =
    [VoteMode::Plain, VoteMode::Weighted, VoteMode::Nearest, VoteMode::Majority, VoteMode::Adaptive];

/// Returns the setting at `index`, an integer of the C interface, in `values`; an error if `index` is out of range.
pub(super) fn choice<T: Copy>(values: &[T], index: i32, name: &str, prefix: &str) -> Result<T> {
    let value = usize::try_from(index).ok().and_then(|i| values.get(i));
    value.copied().ok_or_else(|| Error::argument(format!("{name} is {index}; it must be a {prefix} value")))
}

impl luxfer_stylize_params {
    pub(super) fn of(p: &stylize::Params) -> Self {
        Self {
            struct_size: 96,
            search: p.finder as i32,
            patch: p.patch as u32,
            guide_weight: p.guide_weight,
            coarse_guides: p.coarse_guides,
            levels: p.levels as u32,
            iterations: p.iterations as u32,
            coarse_iterations: p.coarse_iterations as u32,
            finest_iterations: p.finest_iterations as u32,
            polish: p.polish as u32,
            search_iterations: p.search_iterations as u32,
            coverage: p.coverage,
            passes: p.passes as u32,
            settle: p.settle as u32,
            seam: p.seam,
            vote: p.vote as i32,
            final_vote: p.final_vote as i32,
            preview: u32::from(p.preview),
            keep_for_update: 0,
            coherence: p.coherence,
            match_appearance: p.match_appearance,
            reserved: 0,
            seed: p.seed,
        }
    }

    pub(super) fn params(&self) -> Result<stylize::Params> {
        if self.reserved != 0 {
            return Err(Error::argument(format!("reserved is {}; it must be 0", self.reserved)));
        }
        let params = stylize::Params {
            finder: choice(&SEARCHES, self.search, "search", "LUXFER_STYLIZE_SEARCH_")?,
            patch: self.patch as usize,
            guide_weight: self.guide_weight,
            coarse_guides: self.coarse_guides,
            levels: self.levels as usize,
            iterations: self.iterations as usize,
            coarse_iterations: self.coarse_iterations as usize,
            finest_iterations: self.finest_iterations as usize,
            polish: self.polish as usize,
            search_iterations: self.search_iterations as usize,
            coverage: self.coverage,
            passes: self.passes as usize,
            settle: self.settle as usize,
            seam: self.seam,
            vote: choice(&VOTES, self.vote, "vote", "LUXFER_STYLIZE_VOTE_")?,
            final_vote: choice(&VOTES, self.final_vote, "final_vote", "LUXFER_STYLIZE_VOTE_")?,
            preview: params::flag(self.preview, "preview")?,
            coherence: self.coherence,
            match_appearance: self.match_appearance,
            seed: self.seed,
        };
        params.check()?;
        Ok(params)
    }
}

/// Fills *params with a preset: LUXFER_STYLIZE_FULL, LUXFER_STYLIZE_FAST, LUXFER_STYLIZE_PREVIEW or
/// LUXFER_STYLIZE_PAPER. size is sizeof *params. Any thread.
/// LUXFER_INVALID_ARGUMENT if preset is another value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_stylize_get_preset(
    preset: luxfer_stylize_preset,
    params: *mut luxfer_stylize_params,
    size: usize,
) -> luxfer_status {
    guard(|| {
        let place = params::Report::new(params, size)?;
        let preset = match preset {
            LUXFER_STYLIZE_FULL => stylize::Params::default(),
            LUXFER_STYLIZE_FAST => stylize::Params::fast(),
            LUXFER_STYLIZE_PREVIEW => stylize::Params::preview(),
            LUXFER_STYLIZE_PAPER => stylize::Params::paper(),
            _ => return Err(Error::argument(format!("preset is {preset}; it must be a LUXFER_STYLIZE_ preset"))),
        };
        place.set(luxfer_stylize_params::of(&preset));
        Ok(())
    })
}
