//! The inputs and the settings of a stylisation.

use super::guide_record::GuideRecord;
use super::guides::{Guide, MAX_PATCH};
use crate::error::{Error, Result, check_range};
use crate::image::Image;
use crate::patch::{Field, MAX_SIDE, VoteMode};

/// The algorithm that searches for nearest patches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finder {
    /// PatchMatch (Barnes et al. 2009).
    PatchMatch,
    /// A k-d tree over patch means, an alternative to PatchMatch.
    KdTree,
}

#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The artwork A′ in linear colour, aligned with the source side of the guides; 1, 3 or 4 channels.
    pub artwork: &'a Image,
    /// The guides, each a pair of images: one aligned with the artwork (A), one with the target (B). At least one.
    pub guides: &'a [Guide<'a>],
    /// Normals as a guide that is used only if the strokes of the artwork follow the shapes
    /// ([`Directions::follow_shapes`](super::Directions::follow_shapes)); they then have the weight of this guide. In a
    /// sequence, the first frame decides: see `guide_record`.
    pub normals: Option<Guide<'a>>,
    /// Mask of the artwork, one channel: patches are taken only from pixels above 0.5. If absent, from all pixels.
    pub source_mask: Option<&'a Image>,
    /// Mask of the target, one channel: only pixels above 0.5 are synthesised; the others are taken from `known`, or
    /// are black. If absent, all pixels are synthesised.
    pub target_mask: Option<&'a Image>,
    /// The given picture of the target outside `target_mask`, in linear colour, with as many channels as the artwork.
    /// Its pixels never change, but patches are compared with them.
    pub known: Option<&'a Image>,
    /// The field of an earlier result for a target of the same size, as initial matches.
    pub previous: Option<&'a Field>,
    /// Displacement in pixels from each target pixel to the position of the same surface point in the frame of
    /// `previous`: two channels, NaN where the point was not visible. The motion at the centre of a target patch leads
    /// to a patch of the previous frame, whose match the target patch takes over. The share `Params::coherence` of
    /// these matches is kept.
    pub motion: Option<&'a Image>,
    /// The record of the guides of the frame of `previous`. With it, paint follows changes of light, and the report
    /// says how the motion agrees with the guides.
    pub guide_record: Option<&'a GuideRecord>,
}

impl<'a> Input<'a> {
    /// Uses the whole exemplar for the whole target.
    pub fn new(artwork: &'a Image, guides: &'a [Guide<'a>]) -> Self {
        Self {
            artwork,
            guides,
            normals: None,
            source_mask: None,
            target_mask: None,
            known: None,
            previous: None,
            motion: None,
            guide_record: None,
        }
    }
}

/// The settings of a stylisation. The tags state the origin of the defaults.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    pub finder: Finder,
    /// Width of a patch in pixels, odd, in `[1, 33]`. Reduced if the images are smaller. \[paper §3.4\]
    pub patch: usize,
    /// Weight μ of all guides together relative to all of the artwork's colours together, in `[0, 1e6]`. \[paper §3.4\]
    pub guide_weight: f32,
    /// Factor on the weight of the guides on all levels except the finest, in `[0, 1000]`. Guides determine where
    /// paint is placed, and colours determine how it continues. The paper uses 1. \[bench stylit:knobs\]
    pub coarse_guides: f32,
    /// Maximum number of pyramid levels, in `[1, 16]`; each has half the resolution of the next finer one. There are
    /// fewer levels if the shortest side of the coarsest would be less than 5 patch widths. \[paper §3.4\]
    pub levels: usize,
    /// EM iterations (matching, then voting) on the second finest level, in `[1, 100]`. \[paper §3.4\]
    pub iterations: usize,
    /// EM iterations on each coarser level, in `[1, 100]`. \[bench stylit:knobs\]
    pub coarse_iterations: usize,
    /// EM iterations on the finest level, in `[1, 100]`. \[bench stylit:knobs\]
    pub finest_iterations: usize,
    /// Further EM iterations on the finest level, in `[0, 100]`; the paper has none. They start from the result
    /// under the budget and let each target patch take its nearest exemplar patch (Wexler et al. 2007).
    /// \[bench stylit:presets\]
    pub polish: usize,
    /// PatchMatch iterations per search for nearest patches, in `[1, 100]`. \[bench stylit:knobs\]
    pub search_iterations: usize,
    /// Share of the target patches that are matched under the budget, in `[0, 1]`. All other target patches are then
    /// matched without the budget. With 0 here and in `settle`, every target patch takes its nearest exemplar patch
    /// (plain EM: Wexler et al. 2007). \[bench stylit:knobs\]
    pub coverage: f32,
    /// Maximum number of retrieval passes per iteration, in `[1, 1000]`. \[bench stylit:knobs\]
    pub passes: usize,
    /// Propagation iterations after a retrieval, in `[0, 100]`: a target patch may continue a neighbour's match if the
    /// continued match is closer than the patch's own match. With 0, the paper's assignment is unchanged.
    /// \[bench stylit:knobs\]
    pub settle: usize,
    /// Cost of a seam in the iterations of `settle`, as a share of the mean error, in `[0, 100]`. A seam lies between
    /// two neighbouring target patches whose matches are not neighbours in the exemplar. Values up to 3 change the
    /// guide error by less than another `seed` does (docs/notes/stylize.md). \[bench stylit\]
    pub seam: f32,
    pub vote: VoteMode,
    /// The vote that forms the final picture from the final field.
    pub final_vote: VoteMode,
    /// Share of the previous frame's matches that are kept where they fit, in `[0, 1]`; no effect without motion. Use
    /// a different `seed` for each frame; otherwise the same blocks change in every frame. By default all are kept.
    /// \[convention\]
    pub coherence: f32,
    /// Degree to which the exemplar is adapted, in brightness and contrast, to the target, in `[0, 1]`, in all guides
    /// whose range is `Range::Light`. Use it for targets under different light than the exemplar (StyLit, Fig. 16). By
    /// default they are not adapted. \[convention\]
    pub match_appearance: f32,
    /// Whether to work at half the resolution, with guides compressed to their principal components: for interactive
    /// painting.
    pub preview: bool,
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            finder: Finder::PatchMatch,
            patch: 5,
            guide_weight: 2.0,
            coarse_guides: 4.0,
            levels: 6,
            iterations: 6,
            coarse_iterations: 24,
            finest_iterations: 1,
            polish: 3,
            search_iterations: 1,
            coverage: 0.9,
            passes: 6,
            settle: 2,
            seam: 0.2,
            vote: VoteMode::Weighted,
            final_vote: VoteMode::Adaptive,
            coherence: 1.0,
            match_appearance: 0.0,
            preview: false,
            seed: 1,
        }
    }
}

impl Params {
    /// The paper's settings: six iterations and search iterations, plain averages, and no propagation after the
    /// assignment under the budget (`settle` = 0).
    pub fn paper() -> Self {
        Self {
            coarse_guides: 1.0,
            coarse_iterations: 6,
            finest_iterations: 6,
            polish: 0,
            search_iterations: 6,
            coverage: 0.95,
            passes: 64,
            settle: 0,
            vote: VoteMode::Plain,
            final_vote: VoteMode::Plain,
            ..Self::default()
        }
    }

    /// Settings that take half the computation time of the default.
    pub fn fast() -> Self {
        Self { iterations: 3, coarse_iterations: 6, polish: 0, ..Self::default() }
    }

    /// Settings for interactive painting.
    pub fn preview() -> Self {
        Self { preview: true, iterations: 2, coarse_iterations: 3, passes: 3, ..Self::fast() }
    }

    /// Checks that every setting is in its range.
    pub fn check(&self) -> Result<()> {
        check_range("patch", self.patch, 1, MAX_PATCH)?;
        if self.patch.is_multiple_of(2) {
            return Err(Error::argument(format!("patch is {}; it must be odd", self.patch)));
        }
        check_range("guide_weight", self.guide_weight, 0.0, 1e6)?;
        check_range("levels", self.levels, 1, 16)?;
        check_range("coarse_guides", self.coarse_guides, 0.0, 1000.0)?;
        check_range("iterations", self.iterations, 1, 100)?;
        check_range("coarse_iterations", self.coarse_iterations, 1, 100)?;
        check_range("finest_iterations", self.finest_iterations, 1, 100)?;
        check_range("polish", self.polish, 0, 100)?;
        check_range("search_iterations", self.search_iterations, 1, 100)?;
        check_range("coverage", self.coverage, 0.0, 1.0)?;
        check_range("settle", self.settle, 0, 100)?;
        check_range("seam", self.seam, 0.0, 100.0)?;
        check_range("coherence", self.coherence, 0.0, 1.0)?;
        check_range("match_appearance", self.match_appearance, 0.0, 1.0)?;
        check_range("passes", self.passes, 1, 1000)?;
        Ok(())
    }
}

/// Checks that an image is neither empty nor larger than supported.
pub(super) fn check_side(name: &str, image: &Image) -> Result<()> {
    check_range(&format!("{name}.width"), image.width, 1, MAX_SIDE)?;
    check_range(&format!("{name}.height"), image.height, 1, MAX_SIDE)?;
    Ok(())
}
