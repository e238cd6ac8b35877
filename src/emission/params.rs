//! The input of emission (the unwarped photo), and its settings.

use crate::error::{Error, Result, check_range};
use crate::geometry::PhotoMap;
use crate::image::Image;
use crate::maths;
use glam::DVec2;
use std::ops::RangeInclusive;

/// Range of the scale: unwarped pixels per texel. \[convention\]
pub const SCALES: RangeInclusive<f64> = 1e-3..=1e3;

/// The exemplar: a plane of the photo after unwarping, with its light mask.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// Unwarped photo, linear RGB.
    pub unwarped: &'a Image,
    /// Confidence of each unwarped pixel that it is light, in `[0, 1]`.
    pub light: &'a Image,
    /// 1 where `unwarped` and `light` show the plane, else 0.
    pub valid: &'a Image,
    /// The photo, which has full resolution, and the map from unwarped pixels to photo pixels. If absent, the
    /// unwarped image is the finest source.
    pub photo: Option<(&'a Image, PhotoMap)>,
}

/// How the law of a texture is chosen (see [`Law`](super::Law)): by comparison, by the autocorrelation alone, or by
/// the caller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LawMode {
    /// The law that best predicts the lamps of the photo. The law found by autocorrelation is kept unless another law
    /// scores clearly higher.
    Best,
    /// The law that the autocorrelation of the lights finds with the threshold `min_regularity`.
    Correlation,
    /// `Lattice`: a lattice. `Row`: a row of lamps. If the autocorrelation finds a law of this type, this law is taken;
    /// otherwise the best of several proposals of this type.
    Lattice,
    Row,
    /// The exemplar repeats as a whole.
    Whole,
    /// Patches are placed without a lattice.
    Free,
}

/// Which textures centre their lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Centring {
    /// None: lamps keep their positions relative to the upper left corner of the exemplar.
    Never,
    /// All, so none is a copied part of the exemplar.
    Always,
    /// Those that continue beyond the photo, because there nothing but the texture gives the lamps their positions. A
    /// texture that fits inside the exemplar, a tileable texture, and a row whose two ends the photo shows, are not
    /// centred.
    BeyondPhoto,
}

/// The settings of a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Size of the texture in texels, each in `[1, 65536]`.
    pub width: usize,
    pub height: usize,
    /// Unwarped pixels per texel, in [`SCALES`].
    pub scale: f64,
    /// Side of a patch in pixels of the working size (see `working_side`), in `[0, 65536]`. If 0, the side is chosen
    /// from the period of the lights or, without a lattice, from the size of the exemplar.
    pub block: usize,
    /// Number of random patches that are compared for each block of the texture, besides the patches that continue
    /// neighbouring blocks; only for patterns without a lattice. In `[1, 65536]`.
    pub candidates: usize,
    /// Longest side, in pixels, of the exemplar at the reduced size at which patches are compared, in `[16, 2048]`.
    pub working_side: usize,
    /// Weight, in `[0, 1e3]`, of the metadata channels (confidence, x and y distance to the nearest light) relative to
    /// colour; 0 is plain quilting.
    pub guide_weight: f32,
    /// Displacement of the pattern in the texture, to the right and down, in texels. Each coordinate is in
    /// `[-1e6, 1e6]`. If patches are placed without a lattice, the offset must be 0. The exception is a tileable
    /// texture of whole lamps: there, the offset shifts the lamps.
    pub offset: DVec2,
    /// Minimum autocorrelation, in `[0, 1]`, of a shift that counts as a period of the lights. At 0, even a poor
    /// repetition gives a lattice; at 1, patches are placed without a lattice whatever the repetition.
    pub min_regularity: f32,
    /// How the lights continue beyond the exemplar: on a lattice, in a row, by repetition or without a lattice.
    pub law: LawMode,
    /// Parts of the exemplar that unwarping magnifies more than this are not used. Magnification is a ratio of
    /// lengths, relative to the least magnified pixel. In `[1, 1e6]`, or 0 to use the whole exemplar.
    pub max_magnification: f64,
    /// Copies every lamp as a whole. If false, seams may cut lamps, as in the paper.
    pub whole_lamps: bool,
    /// Gives every lamp one uniform colour: its mean colour.
    pub even_lamps: bool,
    /// Gives all lamps of a kind one size and one outline that is exact at any resolution, and places them exactly on
    /// their lattice. Rings and frames keep the hole in their middle. Needs the photo and `whole_lamps`; otherwise each
    /// lamp keeps the outline of the light mask.
    pub clean_lamps: bool,
    /// Makes a tileable texture: a lamp that leaves it on one side re-enters on the opposite side. Needs
    /// `whole_lamps`. A lattice is stretched, by less than half a period over the whole texture, so that a whole
    /// number of periods fits. Lights that run through the exemplar are copied patch by patch, not as whole lamps: they
    /// meet across the border of the texture only if the pattern has a lattice.
    pub tileable: bool,
    /// Which textures centre their lattice: a lamp, or the middle between two lamps, then lies at the texture's centre,
    /// so that the border cuts as few lamps as possible. `offset` shifts the centred lattice.
    pub centring: Centring,
    /// Channel value, in `[0, 1]`, at or above which a pixel of the unwarped photo counts as clipped; 0 if no pixel is
    /// to count as clipped. Clipped parts of a lamp get the colour of its rim. The level should lie below 1, the
    /// largest value of an 8-bit photo, because an unwarped pixel is a mean of clipped and unclipped photo pixels.
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
            guide_weight: 1.0,
            offset: DVec2::ZERO,
            min_regularity: 0.6,
            law: LawMode::Best,
            max_magnification: 0.0,
            whole_lamps: true,
            even_lamps: false,
            clean_lamps: true,
            tileable: false,
            centring: Centring::BeyondPhoto,
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
        check_range("emission.guide_weight", self.guide_weight, 0.0, 1e3)?;
        check_range("emission.offset.x", self.offset.x, -1e6, 1e6)?;
        check_range("emission.offset.y", self.offset.y, -1e6, 1e6)?;
        check_range("emission.min_regularity", self.min_regularity, 0.0, 1.0)?;
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
    /// Checks that the three unwarped images have one size, that `light` and `valid` have one channel, and that the map
    /// into the photo (homography and lens distortion) is finite.
    pub fn check(&self) -> Result<()> {
        self.unwarped.check_same_size("unwarped", self.light, "light")?;
        self.unwarped.check_same_size("unwarped", self.valid, "valid")?;
        for (name, image) in [("light", self.light), ("valid", self.valid)] {
            if image.channels != 1 {
                return Err(Error::argument(format!("{name} has {} channels; it must have 1", image.channels)));
            }
        }
        if let Some((_, to_photo)) = self.photo
            && !(to_photo.homography.0.is_finite()
                && to_photo.lens.centre.is_finite()
                && to_photo.lens.bend.is_finite())
        {
            return Err(Error::argument("the map from the unwarped image to the photo is not finite"));
        }
        Ok(())
    }
}

/// Maximum number of pixels at which the composition of a texture (its lamps and patches) is computed. The composition
/// of a larger texture is computed at a lower resolution. [convention]
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

/// Longest side, in pixels, of the exemplar at the reduced size of the synthesis: `params.working_side`, but at most
/// the longest side of the unwarped image. It is smaller still if the composition of the texture would otherwise have
/// more than `MAX_WORKING_PIXELS` pixels.
pub fn working_side(input: &Input, params: &Params) -> f64 {
    let longest = input.unwarped.width.max(input.unwarped.height) as f64;
    let side = longest.min(params.working_side as f64);
    let pixels = params.size().element_product() * maths::powi(side / longest, 2);
    side * (MAX_WORKING_PIXELS / pixels).sqrt().min(1.0)
}
