//! Emission: an emissive texture of any size from the unwarped lights of a photo ("Lighting Style Transfer", §6).
//!
//! ```text
//! unwarped photo + light + valid ─▶ exemplar ─▶ period ─▶ metadata ─▶ patches (seam) ─▶ lamps ─▶ recover ─▶ luminaires
//! ```
//! 1. [`exemplar`]: what may be used, its lamps (connected [`components`]), and a reduced size to work at.
//! 2. [`period`]: the lattice the lamps lie on, from the autocorrelation of the mask ([`correlation`]), and its [`places`] that the
//!    border cuts.
//! 3. [`metadata`]: confidence and signed x and y distance to the nearest light.
//! 4. [`patches`]: quilting over colour and metadata with minimum-error [`seam`]s, held to the lattice, the light in [`balance`].
//! 5. [`lamps`]: every lamp that patches show becomes one piece again; no seam cuts it.
//! 6. [`recover`]: full detail from the [`photo`]. 7. [`luminaires`]: the lamps as a list with their [`outline`]s, by [`kinds`].
//! 8. [`statistics`]: how far the texture's are from the exemplar's, and how far by [`sampling`] alone; and by [`pairs`] of lamps.
//! 9. [`lamp_list`]: the lamps of a plan, whose texture is never there as a whole; [`mod@sweep`]: its lights that are none.
//!
//! A texture that fits inside the exemplar is a part of it, copied.
//!
//! Beyond the paper: the lattice, and lamps as pieces; image quilting alone lets regular patterns drift and cuts lamps; the
//! colour of lamps that the photo shows clipped ([`clipping`]); lamps kept off where they have no place ([`ground`]);
//! textures of any size, in tiles of a [`plan`]; and several exemplars in one ([`mod@blend`]).
//! Not modelled: lamps that are a mixture of two exemplars', a pattern that bends from one plane into another, and nets of crossing
//! lines in textures that repeat, whose edges may be off by the stretch of a few cells.

mod balance;
mod blend;
mod cells;
mod centre;
mod clipping;
mod components;
mod correlation;
mod exemplar;
mod ground;
mod guide;
mod kinds;
mod lamp_list;
mod lamps;
mod layout;
mod luminaires;
mod measure;
mod metadata;
mod outline;
pub mod pairs;
mod patches;
mod period;
mod photo;
mod places;
mod plan;
mod recover;
mod sampling;
mod seam;
pub mod statistics;
mod sweep;
#[cfg(test)]
mod tests;
mod warnings;
mod window;

pub use blend::Style;
pub use ground::Ground;
pub use lamp_list::LampList;
pub use measure::{Measure, measure};
pub use period::Continuation;
pub use plan::{Plan, Tile};

use crate::error::{Error, Result, check_range};
use crate::geometry::Homography;
use crate::image::Image;
use crate::job::Job;
use components::Components;
use exemplar::Exemplar;
use glam::{DVec2, Vec3};
use layout::Layout;
use plan::Layer;
use statistics::{Pattern, Statistics};

#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// Unwarped photo, linear RGB.
    pub unwarped: &'a Image,
    /// Unwarped confidence that a pixel is light, in `[0, 1]`.
    pub light: &'a Image,
    /// 1 where the two above show the plane.
    pub valid: &'a Image,
    /// The photo itself and the map from unwarped pixels into it, from which full detail is recovered; absent: the
    /// unwarped image is the finest there is.
    pub photo: Option<(&'a Image, Homography)>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Size of the texture in texels, each in `[1, 65536]`.
    pub width: usize,
    pub height: usize,
    /// Unwarped pixels per texel, > 0.
    pub scale: f64,
    /// Side of a patch in working pixels; 0 chooses it from the spacing of the lights.
    pub block: usize,
    /// Patches that are compared for each block, at most, where none is held to a lattice, in `[1, 65536]`.
    pub candidates: usize,
    /// Longest side of the exemplar during synthesis, in pixels, in `[16, 2048]`.
    pub working_side: usize,
    /// Weight of the metadata channels against colour, in `[0, 1e3]`; 0 is plain quilting.
    pub metadata_weight: f32,
    /// Where the pattern begins, in texels right of and below the texture's corner, each in `[-1e6, 1e6]`. Lights without a
    /// lattice begin nowhere: of these it shifts lamps of a texture that is tileable, and must be 0 in others.
    pub offset: DVec2,
    /// Correlation of the lights with themselves from which they are taken for regular, in `[0, 1]`: at 0 any repetition is
    /// held to exactly, at 1 none is, and patches go anywhere.
    pub least_regularity: f32,
    /// Shows every lamp as one piece; without, seams may cut lamps, as in the paper.
    pub whole_lamps: bool,
    /// Every lamp shines evenly, in its mean colour.
    pub even_lamps: bool,
    /// The texture may be repeated: what leaves it on one side comes in on the other. Lattices are stretched, by less than half
    /// a period over the whole, so that a whole number of periods fits. Needs `whole_lamps`; lights that run out of the
    /// exemplar are no lamps, and meet at the border on a lattice only.
    pub tileable: bool,
    /// A lattice lies evenly between the sides of the texture, shifted by the offset from there: a lamp or the middle between two
    /// in its middle, so that the border cuts as few lamps as it can.
    pub centred: bool,
    /// Channel value from which the photo is clipped, in `[0, 1]`; lamps there get the colour of their rims. 0: nothing is. Below
    /// the largest 8-bit values, at which a photo itself is clipped: unwarped pixels are means of clipped and other ones.
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
            whole_lamps: true,
            even_lamps: false,
            tileable: false,
            centred: false,
            clip_level: 0.95,
            seed: 1,
        }
    }
}

/// One lamp of the texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Luminaire {
    /// Centre in texels.
    pub centre: DVec2,
    /// Lengths of the principal axes in texels, long one first.
    pub size: DVec2,
    /// Angle of the long axis from x towards y, in radians, in (-π/2, π/2].
    pub orientation: f64,
    /// Area in texels, of those at the edge what is light.
    pub area: f64,
    /// Mean linear colour.
    pub colour: Vec3,
    /// Share of the light of the whole texture, in `[0, 1]`.
    pub flux_share: f64,
    /// Corners of the outline in texels, from x towards y: where half of a texel would be light. Where the confidence of the lights
    /// tells that between 0 and 1, and the lamp is wider than two texels, within a quarter of one or of an unwarped pixel,
    /// whichever is larger; its corners, where they are not sharper than a right angle, within 0.71 of that. Else it follows the
    /// sides of texels.
    pub outline: Vec<DVec2>,
    /// Number of its kind ([`kinds`]), from 1, those with most lamps first; 0 of a lamp that the border cuts.
    pub kind: u32,
}

impl Luminaire {
    /// The same shown elsewhere, and larger by a factor.
    fn moved(&self, shift: DVec2, factor: f64) -> Self {
        Self {
            centre: (self.centre + shift) * factor,
            size: self.size * factor,
            area: self.area * factor * factor,
            outline: self.outline.iter().map(|p| (*p + shift) * factor).collect(),
            ..self.clone()
        }
    }

    /// Whether nothing of it can lie beyond the border of a texture of a size.
    fn is_within(&self, size: DVec2) -> bool {
        self.outline.iter().all(|p| p.cmpgt(DVec2::ZERO).all() && p.cmplt(size).all())
    }
}

#[derive(Clone, Debug)]
pub struct Emission {
    /// Linear RGB, relative to the photo's white; 0 where there is no lamp.
    pub texture: Image,
    /// Light mask of the texture, 0 or 1.
    pub mask: Image,
    /// What synthesis worked with, at working size; empty where the caller gave the texture. Confidence, signed x and y distance to the nearest light.
    pub exemplar_metadata: Image,
    /// The same of its result.
    pub metadata: Image,
    pub luminaires: Vec<Luminaire>,
    /// How the texture goes on beyond the exemplar.
    pub continuation: Continuation,
    /// Correlation of the lights with themselves shifted by the lattice, the lower of both periods, in `[0, 1]`; 0 where no
    /// period was found.
    pub regularity: f64,
    /// Of the exemplar, in texels, and of the texture.
    pub statistics: [Statistics; 2],
    /// Largest relative difference between the two, their luminance aside. It weighs as much as the lamps that the exemplar shows
    /// whole, `exemplar_lamps`: of a few, what the border cuts off is a large part, and without any only light is compared.
    pub error: f64,
    /// By how much the exemplar's own statistics are off, as far as can be told: the root mean square of that difference between parts
    /// of the texture as large as the exemplar, and the whole. No method is expected to have a smaller error than that. 0 where the
    /// texture shows nothing that the exemplar does not, and of blended exemplars.
    pub sampling_error: f64,
    /// Number of lamps that the exemplars show whole.
    pub exemplar_lamps: usize,
}

impl Params {
    /// Checks that every setting is in its range.
    pub fn check(&self) -> Result<()> {
        check_range("emission.width", self.width, 1, 65_536)?;
        check_range("emission.height", self.height, 1, 65_536)?;
        check_range("emission.scale", self.scale, 1e-3, 1e3)?;
        check_range("emission.block", self.block, 0, 65_536)?;
        check_range("emission.candidates", self.candidates, 1, 65_536)?;
        check_range("emission.working_side", self.working_side, 16, 2048)?;
        check_range("emission.metadata_weight", self.metadata_weight, 0.0, 1e3)?;
        check_range("emission.offset.x", self.offset.x, -1e6, 1e6)?;
        check_range("emission.offset.y", self.offset.y, -1e6, 1e6)?;
        check_range("emission.least_regularity", self.least_regularity, 0.0, 1.0)?;
        check_range("emission.clip_level", self.clip_level, 0.0, 1.0)?;
        if self.tileable && !self.whole_lamps {
            return Err(Error::argument("emission.tileable is set; it needs emission.whole_lamps"));
        }
        Ok(())
    }
}

/// The emission of a texture the caller has made: what is brighter than nothing is light.
pub fn given(texture: &Image, job: Job) -> Result<Emission> {
    let texture = texture.to_rgb()?;
    if let Some(bad) = texture.data.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
        return Err(Error::argument(format!("the emissive texture holds {bad}; its values must be finite and >= 0")));
    }
    let mut mask = Image::new(texture.width, texture.height, 1)?;
    for (m, pixel) in mask.data.iter_mut().zip(texture.data.chunks_exact(3)) {
        *m = f32::from(pixel.iter().any(|&v| v > 0.0));
    }
    if !mask.data.contains(&1.0) {
        return Err(Error::degenerate("the emissive texture is black everywhere: nothing in it gives light"));
    }
    let components = luminaires::components(&mask)?;
    let luminaires = luminaires::find(&texture, &components, &|i| mask.data[i], job)?;
    let statistics = statistics_of(&texture, &components, [Some(f64::INFINITY); 2]);
    let exemplar_lamps = statistics.whole;
    Ok(Emission {
        texture,
        mask,
        exemplar_metadata: Image::default(),
        metadata: Image::default(),
        luminaires,
        continuation: Continuation::Copy,
        regularity: 0.0,
        statistics: [statistics; 2],
        error: 0.0,
        sampling_error: 0.0,
        exemplar_lamps,
    })
}

fn check_input(input: &Input) -> Result<()> {
    input.unwarped.check_same_size("unwarped", input.light, "light")?;
    input.unwarped.check_same_size("unwarped", input.valid, "valid")?;
    for (name, image) in [("light", input.light), ("valid", input.valid)] {
        if image.channels != 1 {
            return Err(Error::argument(format!("{name} has {} channels; it must have 1", image.channels)));
        }
    }
    if let Some((_, to_photo)) = input.photo
        && !to_photo.0.is_finite()
    {
        return Err(Error::argument("the map from the unwarped image to the photo is not finite"));
    }
    Ok(())
}

/// Makes an emissive texture of `params.width` × `params.height` texels that continues the lights of the unwarped photo.
///
/// Errors: a parameter out of range, images of different size; no valid pixel; no light (`Degenerate`).
pub fn run(input: &Input, params: &Params, job: Job) -> Result<Emission> {
    blend(input, &[], params, job)
}

/// The same with lights of further exemplars where their weights say so. What it tells beside the texture, its lamps and its
/// statistics is of the first. Errors: as for [`run`]; weights that are not in `[0, 1]`, or add up to more.
pub fn blend(input: &Input, styles: &[Style], params: &Params, job: Job) -> Result<Emission> {
    make(Plan::new(input, styles, params, job.part(0.0, 0.85))?, input, styles, params, job)
}

/// The same of a first exemplar that [`measure`] has read, which is not read again.
pub fn blend_measured(
    measured: Measure,
    input: &Input,
    styles: &[Style],
    params: &Params,
    job: Job,
) -> Result<Emission> {
    let plan = Plan::of(Some(measured.reading), input, styles, params, job.part(0.0, 0.85))?;
    make(plan, input, styles, params, job)
}

fn make(mut plan: Plan, input: &Input, styles: &[Style], params: &Params, job: Job) -> Result<Emission> {
    let (texture, mut coverage, components) = plan.all(input, styles, job.part(0.85, 0.95))?;
    let luminaires = luminaires::find(&texture, &components, &|i| coverage.data[i], job.part(0.95, 1.0))?;
    recover::threshold(&mut coverage);
    let mask = coverage;

    let inputs = std::iter::once(input).chain(styles.iter().map(|style| &style.input));
    let parts = plan.layers.iter().zip(inputs).enumerate().map(|(k, (layer, input))| {
        // What repeats as a whole is one period.
        let periods = match layer.continuation {
            Continuation::Tile(_) => [Some(f64::INFINITY); 2],
            other => other.periods(),
        };
        let own = layer.exemplar.statistics(input.unwarped, periods);
        (own.scaled(1.0 / layer.scale), plan.weights.mean(k))
    });
    let expected = Statistics::mixed(parts);
    let exemplar_lamps = plan.exemplar_lamps();
    let Layer { exemplar, continuation, regularity, metadata, layout, .. } = plan.layers.swap_remove(0);
    let periods = if styles.is_empty() { continuation.periods() } else { [None; 2] };
    let statistics = [expected, statistics_of(&texture, &components, periods.map(|p| p.map(|p| p / params.scale)))];
    let error = statistics[1].difference(&statistics[0]);
    let sampling_error = match continuation {
        Continuation::Lattice(_) | Continuation::Row(_) | Continuation::Free if styles.is_empty() => {
            let images = (&texture, &mask);
            sampling::error(&exemplar, images, &statistics[1], periods, params.scale, job.part(1.0, 1.0))?
                .unwrap_or(0.0)
        }
        _ => 0.0,
    };
    let shown = shown_metadata(&layout, &exemplar, &metadata)?;
    job.report(1.0);
    Ok(Emission {
        texture,
        mask,
        exemplar_metadata: metadata,
        metadata: shown,
        luminaires,
        continuation,
        regularity,
        statistics,
        error,
        sampling_error,
        exemplar_lamps,
    })
}

/// The statistics of a texture; lamps are whole that do not touch its border.
fn statistics_of(texture: &Image, components: &Components, periods: [Option<f64>; 2]) -> Statistics {
    let (width, height) = (texture.width, texture.height);
    let inside =
        |c: &components::Component| c.min.iter().all(|&low| low > 0) && c.max[0] + 1 < width && c.max[1] + 1 < height;
    let whole: Vec<bool> = components.list.iter().map(inside).collect();
    let colour = |i: usize| Some(Vec3::from_slice(&texture.data[3 * i..]));
    Statistics::of(&Pattern { width, height, components, whole: &whole, periods, colour })
}

/// The exemplar's metadata as the layout shows them; where it shows nothing, nothing is near.
fn shown_metadata(layout: &Layout, exemplar: &Exemplar, metadata: &Image) -> Result<Image> {
    let mut out = Image::new(layout.width, layout.height, 3)?;
    for (y, row) in out.data.chunks_exact_mut(3 * layout.width).enumerate() {
        for (x, (label, pixel)) in layout.labels(y).zip(row.chunks_exact_mut(3)).enumerate() {
            match layout.source(x, y, label, &exemplar.working) {
                Some(source) => pixel.copy_from_slice(&metadata.data[3 * source..3 * source + 3]),
                None => pixel.copy_from_slice(&[0.0, 1.0, 1.0]),
            }
        }
    }
    Ok(out)
}
