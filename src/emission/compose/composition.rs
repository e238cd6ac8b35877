//! The composition of a texture: the positions of all lamps and patches, from which texels are rendered.
//!
//! A composition holds positions, but no texels. Any tile of the texture can be rendered from it, so rendering needs
//! the memory of one tile only, whatever the size of the texture. The colour of a texel does not depend on other
//! texels, so the bits of the texture do not depend on the tiles, their order or the number of threads.

use super::bands::Bands;
use super::draw;
use super::layer::Layer;
use super::render::{self, Blend, LightSelection};
use super::source::{self, TexelSource};
use super::tile::Tile;
use super::weights::{Style, Weights};
use crate::emission::analysis::{Analysis, Choice};
use crate::emission::exemplar::components::Components;
use crate::emission::lamps::{crumbs, instance, luminaires};
use crate::emission::lattice::law::Law;
use crate::emission::params::{Input, Params};
use crate::error::{Error, Result};
use crate::image::Image;
use crate::job::Job;
use glam::DVec2;

/// The composition of a texture of `width` × `height` texels: the positions of its lamps and patches.
pub struct Composition {
    pub width: usize,
    pub height: usize,
    /// One layer for each exemplar.
    pub(in crate::emission) layers: Vec<Layer>,
    /// For each layer, the lamps that may touch each band of rows of texels.
    pub(in crate::emission) bands: Vec<Bands>,
    pub(in crate::emission) weights: Weights,
    /// Area in texels below which a piece of light is a crumb: a fragment broken off a lamp by resampling, which is
    /// removed.
    pub(in crate::emission) crumb: f64,
}

impl Composition {
    /// Plans the first texture that [`crate::emission::blend`] makes; `blend` may then replace this texture by one with
    /// another law. Errors: as for `blend`.
    pub fn new(input: &Input, styles: &[Style], params: &Params, job: Job) -> Result<Self> {
        Self::of(None, input, styles, params, job)
    }

    /// Like [`Self::new`], but reuses an earlier analysis of the first exemplar ([`Analysis`]), if one is given and
    /// was made with the same settings.
    pub(in crate::emission) fn of(
        mut analysis: Option<Analysis>,
        input: &Input,
        styles: &[Style],
        params: &Params,
        job: Job,
    ) -> Result<Self> {
        params.check()?;
        let weights = Weights::new(styles)?;
        let count = (1 + styles.len()) as f64;
        let mut layers = Vec::new();
        for (k, (input, scale)) in exemplars(input, params.scale, styles).enumerate() {
            input.check()?;
            let params = Params { scale, ..params.clone() };
            params.check()?;
            let job = job.part(k as f64 / count, (k + 1) as f64 / count);
            let mut layer = Layer::new(analysis.take(), input, &params, job)?;
            if params.even_lamps {
                layer.even = Some(source::mean_colours(&layer, input, job)?);
            }
            layers.push(layer);
        }
        draw::draw(&mut layers, &weights, params);
        if params.tileable {
            let size = DVec2::new(params.width as f64, params.height as f64);
            for layer in &mut layers {
                layer.instances = instance::wrapped(&layer.instances, size * layer.scale);
            }
        }
        let bands = layers.iter().map(|layer| Bands::new(layer, params.width, params.height)).collect();
        let smallest = layers.iter().map(Layer::crumb).filter(|c| *c > 0.0);
        let crumb = smallest.reduce(f64::min).unwrap_or(0.0);
        Ok(Self { width: params.width, height: params.height, layers, bands, weights, crumb })
    }

    /// The number of lamps that are copied as a whole, in all layers. In a tileable texture, each lamp counts nine
    /// times: once in the texture, and once in each of its eight neighbouring copies.
    pub fn lamps(&self) -> usize {
        self.layers.iter().map(|layer| layer.instances.len()).sum()
    }

    /// The regularity of the first exemplar, as in [`crate::emission::Emission::regularity`].
    pub fn regularity(&self) -> f64 {
        self.layers.first().map_or(0.0, |layer| layer.regularity)
    }

    /// The law by which the lights of the first exemplar continue: a lattice, a row, repetition or no period. Also
    /// returns how well the law predicts the lamps, and the best alternative.
    pub fn law(&self) -> (Law, Choice) {
        let first = self.layers.first().map(|layer| (layer.law, layer.choice));
        first.unwrap_or((Law::Copy, Choice::only(Law::Copy)))
    }

    /// The number of lamps that the photos show completely, summed over all exemplars.
    pub fn exemplar_lamps(&self) -> usize {
        self.layers.iter().map(|layer| layer.exemplar.lamps().count()).sum()
    }

    /// Renders a tile of the texture, and its mask, from the exemplars of which the composition was made.
    ///
    /// Errors (`InvalidArgument`): the tile is empty or reaches beyond the texture; the number or the sizes of the
    /// exemplars have changed.
    pub fn tile(&self, input: &Input, styles: &[Style], tile: Tile, job: Job) -> Result<(Image, Image)> {
        self.check(tile)?;
        // To tell crumbs from larger pieces of light, render a margin around the tile as well. The margin is wider than
        // a crumb is long. So a piece that runs from the tile to the outer edge of the margin is no crumb.
        let margin = if self.has_crumbs() { crumbs::max_side(self.crumb) + 2 } else { 0 };
        let around = tile.widened(margin, self.width, self.height);
        let (mut texture, mut mask) = self.render(input, styles, around, job)?;
        if self.has_crumbs() {
            let mut found = luminaires::components(&mask)?;
            self.remove_crumbs(&mut texture, &mut mask, &mut found, around);
        }
        render::threshold(&mut mask);
        if around == tile {
            return Ok((texture, mask));
        }
        Ok((tile.cut(texture, around)?, tile.cut(mask, around)?))
    }

    /// Renders the whole texture and its coverage, and finds the connected lights of the coverage.
    pub(in crate::emission) fn all(
        &self,
        input: &Input,
        styles: &[Style],
        job: Job,
    ) -> Result<(Image, Image, Components)> {
        let (mut texture, mut coverage) = self.render(input, styles, self.whole(), job)?;
        let mut found = luminaires::components(&coverage)?;
        if self.has_crumbs() {
            self.remove_crumbs(&mut texture, &mut coverage, &mut found, self.whole());
        }
        Ok((texture, coverage, found))
    }

    /// Removes crumbs from a tile. `found` are the connected lights of `mask`. A small piece at the border of the
    /// texture is kept, because it may be the visible part of a lamp that the border cuts.
    fn remove_crumbs(&self, texture: &mut Image, mask: &mut Image, found: &mut Components, tile: Tile) {
        let is_cut = |min: [usize; 2], max: [usize; 2]| {
            let (low, high) = ([tile.x + min[0], tile.y + min[1]], [tile.x + max[0] + 1, tile.y + max[1] + 1]);
            low.contains(&0) || high[0] == self.width || high[1] == self.height
        };
        crumbs::remove(texture, mask, found, self.crumb, is_cut);
    }

    fn has_crumbs(&self) -> bool {
        self.crumb > 1.0
    }

    /// Renders a tile and its coverage without removing crumbs.
    fn render(&self, input: &Input, styles: &[Style], tile: Tile, job: Job) -> Result<(Image, Image)> {
        self.check_exemplars(input, styles)?;
        self.render_lights(input, styles, tile, LightSelection::All, job)
    }

    /// Renders a tile and its coverage: either all lights, or only the lights that are copied patch by patch.
    pub(in crate::emission) fn render_lights(
        &self,
        input: &Input,
        styles: &[Style],
        tile: Tile,
        lights: LightSelection,
        job: Job,
    ) -> Result<(Image, Image)> {
        let inputs = exemplars(input, 1.0, styles);
        let sources: Vec<TexelSource> =
            self.layers.iter().zip(inputs).map(|(layer, (input, _))| TexelSource { layer, input }).collect();
        let blend = Blend { width: self.width, height: self.height, weights: &self.weights };
        render::run(&blend, &sources, &self.bands, tile, lights, job)
    }

    /// Checks that the exemplars agree in number and sizes with the exemplars of which the composition was made.
    pub(in crate::emission) fn check_exemplars(&self, input: &Input, styles: &[Style]) -> Result<()> {
        if styles.len() + 1 != self.layers.len() {
            let (given, expected) = (styles.len() + 1, self.layers.len());
            return Err(Error::argument(format!(
                "there are {given} exemplars; the composition was made of {expected}"
            )));
        }
        for (layer, (input, _)) in self.layers.iter().zip(exemplars(input, 1.0, styles)) {
            input.check()?;
            let (size, expected) = ([input.unwarped.width, input.unwarped.height], &layer.exemplar);
            if size != [expected.width, expected.height] {
                return Err(Error::argument(format!(
                    "the unwarped image is {} x {}; the composition was made of one of {} x {}",
                    size[0], size[1], expected.width, expected.height
                )));
            }
        }
        Ok(())
    }

    /// The whole texture as a tile.
    pub fn whole(&self) -> Tile {
        Tile { x: 0, y: 0, width: self.width, height: self.height }
    }

    /// Checks that a tile is a part of the texture.
    pub fn check(&self, tile: Tile) -> Result<()> {
        let fits = |start: usize, side: usize, whole: usize| side > 0 && start < whole && side <= whole - start;
        if fits(tile.x, tile.width, self.width) && fits(tile.y, tile.height, self.height) {
            return Ok(());
        }
        Err(Error::argument(format!(
            "the tile of {} x {} texels at {}, {} must be a part of the texture, which has {} x {}",
            tile.width, tile.height, tile.x, tile.y, self.width, self.height
        )))
    }
}

/// Iterates over all exemplars, each with its number of unwarped pixels per texel.
pub fn exemplars<'a>(first: &'a Input, scale: f64, styles: &'a [Style]) -> impl Iterator<Item = (&'a Input<'a>, f64)> {
    std::iter::once((first, scale)).chain(styles.iter().map(|style| (&style.input, style.scale)))
}
