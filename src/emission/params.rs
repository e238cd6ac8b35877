//! What emission is given: the unwarped photo, and the settings.

use crate::error::{Error, Result, check_range};
use crate::geometry::Homography;
use crate::image::Image;
use glam::DVec2;
use std::ops::RangeInclusive;

/// Pixels of the unwarped photo that a texel may stand for. \[convention\]
pub const SCALES: RangeInclusive<f64> = 1e-3..=1e3;

/// The exemplar as it comes from unwarping.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// Unwarped photo, linear RGB.
    pub unwarped: &'a Image,
    /// Unwarped confidence that a pixel is light, in `[0, 1]`.
    pub light: &'a Image,
    /// 1 where `unwarped` and `light` show the plane.
    pub valid: &'a Image,
    /// The photo, from which full detail is recovered, and the map from unwarped pixels into the photo. If absent, the
    /// unwarped image is the finest source.
    pub photo: Option<(&'a Image, Homography)>,
}

/// How the lights of an exemplar go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// The law that predicts the lamps of the photo best. The law read from the correlation is kept unless another one
    /// scores clearly higher.
    Best,
    /// The law read from the correlation of the lights with themselves, with `least_regularity` as its threshold.
    Correlation,
    /// The lattice (for `Row`, the row) read from the correlation; if there is none, the best of all that are proposed.
    Lattice,
    Row,
    /// The exemplar repeats as a whole.
    Whole,
    /// Patches go anywhere.
    Free,
}

/// The settings of a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Size of the texture in texels, each in `[1, 65536]`.
    pub width: usize,
    pub height: usize,
    /// Unwarped pixels per texel, > 0.
    pub scale: f64,
    /// Side of a patch in working pixels; 0 chooses it from the spacing of the lights.
    pub block: usize,
    /// Most patches that are compared for each block where no lattice restricts them, in `[1, 65536]`.
    pub candidates: usize,
    /// Longest side of the exemplar during synthesis, in pixels, in `[16, 2048]`.
    pub working_side: usize,
    /// Weight of the metadata channels against colour, in `[0, 1e3]`; 0 is plain quilting.
    pub metadata_weight: f32,
    /// Where the pattern begins, in texels right of and below the texture's corner, each in `[-1e6, 1e6]`. A pattern
    /// without a lattice has no beginning: there the offset shifts the lamps of a tileable texture, and must be 0 in
    /// other textures.
    pub offset: DVec2,
    /// Smallest correlation of the lights with themselves at which they count as regular, in `[0, 1]`. At 0 any
    /// repetition is followed exactly; at 1 none is, and patches go anywhere.
    pub least_regularity: f32,
    /// How the lights go on.
    pub law: Law,
    /// Largest magnification at which the exemplar is used, in length and relative to its least magnified pixel. Parts
    /// that are magnified more count as not shown. In `[1, 1e6]`, or 0 to use the whole exemplar.
    pub max_magnification: f64,
    /// Shows every lamp as one piece. If false, seams may cut lamps, as in the paper.
    pub whole_lamps: bool,
    /// Every lamp shines evenly, in its mean colour.
    pub even_lamps: bool,
    /// All lamps of a kind get one size and an outline that is exact at any resolution, and lie at the sites of their
    /// lattice. Needs the photo and `whole_lamps`; otherwise each lamp keeps the outline of the mask.
    pub clean_lamps: bool,
    /// Makes a texture that can be repeated: a lamp that leaves it on one side comes in on the opposite side. Lattices
    /// are stretched, by less than half a period over the whole texture, so that a whole number of periods fits. Needs
    /// `whole_lamps`. Lights that the edge of the exemplar cuts do not count as whole lamps; they join across the
    /// border of the texture only if they lie on a lattice.
    pub tileable: bool,
    /// Lays a lattice out evenly between the sides of the texture: a lamp, or the middle between two lamps, lies at the
    /// texture's centre, so that the border cuts as few lamps as possible. The offset shifts the lattice from there.
    pub centred: bool,
    /// Channel value from which the unwarped photo counts as clipped, in `[0, 1]`; clipped parts of a lamp get the
    /// colour of its rim. 0: nothing counts as clipped. The level should lie below the largest 8-bit value, at which
    /// the photo itself is clipped, because an unwarped pixel is a mean of clipped and other pixels.
    pub clip_level: f32,
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            width: 1024,
            height: 1024,
            scale: 1.0,
            block: 0,
            candidates: 192,
            working_side: 256,
            metadata_weight: 1.0,
            offset: DVec2::ZERO,
            least_regularity: 0.6,
            law: Law::Best,
            max_magnification: 0.0,
            whole_lamps: true,
            even_lamps: false,
            clean_lamps: true,
            tileable: false,
            centred: false,
            clip_level: 0.95,
            seed: 1,
        }
    }
}

impl Params {
    /// Checks that every setting is in its range.
    pub fn check(&self) -> Result<()> {
        check_range("emission.width", self.width, 1, 65_536)?;
        check_range("emission.height", self.height, 1, 65_536)?;
        check_range("emission.scale", self.scale, *SCALES.start(), *SCALES.end())?;
        check_range("emission.block", self.block, 0, 65_536)?;
        check_range("emission.candidates", self.candidates, 1, 65_536)?;
        check_range("emission.working_side", self.working_side, 16, 2048)?;
        check_range("emission.metadata_weight", self.metadata_weight, 0.0, 1e3)?;
        check_range("emission.offset.x", self.offset.x, -1e6, 1e6)?;
        check_range("emission.offset.y", self.offset.y, -1e6, 1e6)?;
        check_range("emission.min_regularity", self.least_regularity, 0.0, 1.0)?;
        if self.max_magnification != 0.0 {
            check_range("emission.max_magnification", self.max_magnification, 1.0, 1e6)?;
        }
        check_range("emission.clip_level", self.clip_level, 0.0, 1.0)?;
        if self.tileable && !self.whole_lamps {
            return Err(Error::argument("emission.tileable is set; it needs emission.whole_lamps"));
        }
        Ok(())
    }
}

impl Input<'_> {
    /// Checks that the images agree in size and channels.
    pub fn check(&self) -> Result<()> {
        self.unwarped.check_same_size("unwarped", self.light, "light")?;
        self.unwarped.check_same_size("unwarped", self.valid, "valid")?;
        for (name, image) in [("light", self.light), ("valid", self.valid)] {
            if image.channels != 1 {
                return Err(Error::argument(format!("{name} has {} channels; it must have 1", image.channels)));
            }
        }
        if let Some((_, to_photo)) = self.photo
            && !to_photo.0.is_finite()
        {
            return Err(Error::argument("the map from the unwarped image to the photo is not finite"));
        }
        Ok(())
    }
}

/// Most working pixels of a texture; a larger texture is planned at a coarser working size.
const MAX_WORKING_PIXELS: f64 = (1 << 28) as f64;

impl Params {
    /// Width and height of the texture, in unwarped pixels.
    pub fn size(&self) -> DVec2 {
        DVec2::new(self.width as f64, self.height as f64) * self.scale
    }

    /// Width and height of a tileable texture, in texels; `None` for other textures.
    pub fn repeats(&self) -> Option<DVec2> {
        self.tileable.then(|| DVec2::new(self.width as f64, self.height as f64))
    }
}

/// Longest side of the exemplar at working size, in pixels. It is smaller than `params.working_side` where the texture
/// would otherwise have too many working pixels.
pub fn working_side(input: &Input, params: &Params) -> f64 {
    let longest = input.unwarped.width.max(input.unwarped.height) as f64;
    let side = longest.min(params.working_side as f64);
    let pixels = params.size().element_product() * (side / longest).powi(2);
    side * (MAX_WORKING_PIXELS / pixels).sqrt().min(1.0)
}
