//! Renders the texels at full resolution: copies every lamp and every patch from the photo or, without a photo, from
//! the unwarped image ("Lighting Style Transfer", §6, Fig. 12h).
//!
//! The position of a texel in unwarped pixels, minus the shift of its lamp or patch, is a point of the unwarped image.
//! The homography maps that point into the photo, where the colour is averaged over the area that the texel covers.
//!
//! The unwarped light mask decides whether a texel is light. Its values are confidences: how surely a pixel is light,
//! in `[0, 1]`. If a texel is smaller than an unwarped pixel, the confidence is interpolated between pixels, so that
//! outlines show no staircase. If a texel is larger, it is light if at least half of its area is lit.

use super::bands::Bands;
use super::lit_blocks::LightSet;
use super::source::{Texel, TexelSource};
use super::tile::Tile;
use super::weights::Weights;
use crate::emission::lamps::instance::Instance;
use crate::error::Result;
use crate::image::{Image, try_vec};
use crate::job::Job;
use glam::DVec2;
use rayon::prelude::*;

/// A float slightly below one half. [rounding]
const BELOW_HALF: f32 = 0.5 - f32::EPSILON;

/// The lights of a composition that are rendered.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum LightSelection {
    All,
    /// Only lights that are copied patch by patch, and only if the texture is not a copied part of the exemplar.
    OfPatches,
}

/// The texture into which layers are rendered: its size in texels, and the weight of each layer.
pub struct Blend<'a> {
    pub width: usize,
    pub height: usize,
    pub weights: &'a Weights,
}

/// Renders a tile of the texture, and the coverage: the share of each texel that light covers. Coverage is at least
/// 0.5 for texels of the mask, and less than 0.5 for other texels.
pub fn run(
    blend: &Blend,
    sources: &[TexelSource],
    bands: &[Bands],
    tile: Tile,
    lights: LightSelection,
    job: Job,
) -> Result<(Image, Image)> {
    let Tile { width, height, .. } = tile;
    let mut texture = Image::new(width, height, 3)?;
    let mut mask = Image::new(width, height, 1)?;
    let rows = texture.data.par_chunks_exact_mut(3 * width).zip(mask.data.par_chunks_exact_mut(width)).enumerate();
    rows.try_for_each(|(row, (colours, coverage))| {
        job.check()?;
        let shares = try_vec(width, 0f32)?;
        let mut row = Row { y: tile.y + row, first: tile.x, colours, coverage, shares };
        for (k, (source, bands)) in sources.iter().zip(bands).enumerate() {
            if lights == LightSelection::All {
                row.add_lamps(source, bands);
            }
            let has_more = match lights {
                LightSelection::All => source.layer.any_copied_by_pixel(),
                LightSelection::OfPatches => source.layer.follows_patches(),
            };
            if has_more {
                row.add_patches(source, blend, k);
            }
        }
        row.clamp_coverage();
        Ok(())
    })?;
    job.report(1.0);
    Ok((texture, mask))
}

/// A row of texels that is being rendered.
struct Row<'a> {
    y: usize,
    /// Column of the first texel.
    first: usize,
    colours: &'a mut [f32],
    /// `coverage`: for each texel, the mean confidence that it is light. `shares`: share of the texel's samples that
    /// are light.
    coverage: &'a mut [f32],
    shares: Vec<f32>,
}

impl Row<'_> {
    fn add(&mut self, x: usize, shown: Texel) {
        let at = x - self.first;
        self.coverage[at] += shown.coverage;
        if shown.share > 0.0 {
            self.shares[at] += shown.share;
            let out = self.colours[3 * at..3 * at + 3].iter_mut();
            out.zip(shown.colour.to_array()).for_each(|(o, c)| *o += c);
        }
    }

    /// Adds to the row the lamps that are copied as a whole.
    fn add_lamps(&mut self, source: &TexelSource, bands: &Bands) {
        for &(i, range) in bands.of_row(self.y) {
            let [x0, y0, x1, y1] = range.map(|r| r as usize);
            if (y0..y1).contains(&self.y) {
                let Instance { component, shift } = source.layer.instances[i as usize];
                let columns = x0.max(self.first)..x1.min(self.first + self.coverage.len());
                let is_shown = |label: u32| label == component as u32 + 1;
                columns.for_each(|x| {
                    if let Some(designed) = source.designed_texel(x, self.y, shift, component) {
                        self.add(x, designed);
                    } else if source.may_show(LightSet::All, x, self.y, shift) {
                        self.add(x, source.texel(x, self.y, shift, is_shown));
                    }
                });
            }
        }
    }

    /// Adds to the row the lights of exemplar `k` that are copied patch by patch, multiplied by the weight of this
    /// exemplar in the blend. [`Self::add_lamps`] adds the lamps that are placed as a whole.
    fn add_patches(&mut self, source: &TexelSource, blend: &Blend, k: usize) {
        let size = DVec2::new(blend.width as f64, blend.height as f64);
        for x in self.first..self.first + self.coverage.len() {
            let at = (DVec2::new(x as f64, self.y as f64) + 0.5) / size;
            let weight = blend.weights.at(k, at);
            let shift = source.shift_at(x, self.y).filter(|_| weight > 0.0);
            if let Some(shift) = shift.filter(|&shift| source.may_show(LightSet::OfPatches, x, self.y, shift)) {
                let is_shown = |label: u32| label != 0 && source.layer.is_copied_by_pixel(label as usize - 1);
                let shown = source.texel(x, self.y, shift, is_shown);
                self.add(x, Texel { colour: shown.colour * weight, ..shown });
            }
        }
    }

    /// Clamps the coverage to agree with the share of lit samples: at least 0.5 if at least half of the samples are
    /// lit, less than 0.5 otherwise.
    fn clamp_coverage(&mut self) {
        for (coverage, &share) in self.coverage.iter_mut().zip(&self.shares) {
            *coverage = if share >= 0.5 { coverage.clamp(0.5, 1.0) } else { coverage.min(BELOW_HALF) };
        }
    }
}

/// Thresholds the coverage to a mask in place: 1 where light covers at least half of a texel, else 0.
pub fn threshold(coverage: &mut Image) {
    coverage.data.iter_mut().for_each(|c| *c = f32::from(*c >= 0.5));
}
