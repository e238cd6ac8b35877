//! The plan of a texture: which lamp and which patch goes where, and no texel yet.
//!
//! A plan holds positions only. Any tile of the texture is rendered from it alone, so a texture of any size needs the memory
//! of a tile; and since a texel depends on nothing but its place, the bits are the same whatever the tiles, their order and
//! the number of threads.

use super::blend::{self, Style, Weights};
use super::cells;
use super::centre;
use super::clipping::Clipping;
use super::components::Components;
use super::exemplar::Exemplar;
use super::guide::Guide;
use super::lamps::{self, Instance, Rules};
use super::layout::Layout;
use super::measure::Reading;
use super::patches;
use super::period::{self, Continuation};
use super::places;
use super::recover::{self, Bands, Lights, Source};
use super::window::{self, Window};
use super::{Input, Params, luminaires, metadata};
use crate::error::{Error, Result};
use crate::image::Image;
use crate::job::Job;
use glam::{DVec2, Vec3};

/// Most working pixels of a result; larger ones are planned at a coarser size.
const MOST_WORKING_PIXELS: f64 = (1 << 28) as f64;

/// Share of the smallest lamp's area up to which a piece of light is none: a crumb of an edge that resampling broke off.
const CRUMB: f64 = 0.02;

/// A part of a texture, in texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    pub x: usize,
    pub y: usize,
    pub width: usize,
    pub height: usize,
}

/// What a texture of `width` × `height` texels shows, and where.
pub struct Plan {
    pub width: usize,
    pub height: usize,
    /// One of each exemplar.
    pub(super) layers: Vec<Layer>,
    pub(super) weights: Weights,
    /// Area in texels below which a piece of light is a crumb.
    pub(super) crumb: f64,
}

/// Where the texture shows what of an exemplar.
pub(super) struct Layer {
    pub exemplar: Exemplar,
    pub continuation: Continuation,
    pub regularity: f64,
    /// Of the exemplar, at working size.
    pub metadata: Image,
    pub layout: Layout,
    /// Lamps copied as a whole.
    pub instances: Vec<Instance>,
    pub bands: Bands,
    /// Which components of the exemplar follow the patches pixel by pixel instead.
    pub by_pixel: Vec<bool>,
    /// Where the photo is clipped, the colours of the lamps it shows.
    pub clipping: Option<Clipping>,
    /// The mean colour of each component, where lamps shine evenly.
    pub even: Option<Vec<Vec3>>,
    /// Unwarped pixels per texel.
    pub scale: f64,
}

impl Plan {
    /// Plans the texture that [`super::blend`] makes. Errors as there.
    pub fn new(input: &Input, styles: &[Style], params: &Params, job: Job) -> Result<Self> {
        Self::of(None, input, styles, params, job)
    }

    /// The same where the first exemplar has been read.
    pub(super) fn of(
        mut reading: Option<Reading>,
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
            super::check_input(input)?;
            let params = Params { scale, ..params.clone() };
            params.check()?;
            let job = job.part(k as f64 / count, (k + 1) as f64 / count);
            layers.push(Layer::new(reading.take(), input, &params, job)?);
        }
        blend::draw(&mut layers, &weights, params);
        for layer in &mut layers {
            if params.tileable {
                let size = DVec2::new(params.width as f64, params.height as f64) * layer.scale;
                layer.instances = lamps::wrapped(&layer.instances, size);
            }
            layer.bands = Bands::new(layer, params.width, params.height);
        }
        let crumbs = layers.iter().map(Layer::crumb).filter(|c| *c > 0.0);
        let crumb = crumbs.reduce(f64::min).unwrap_or(0.0);
        Ok(Self { width: params.width, height: params.height, layers, weights, crumb })
    }

    /// The number of lamps that are copied as a whole.
    pub fn lamps(&self) -> usize {
        self.layers.iter().map(|layer| layer.instances.len()).sum()
    }

    /// How regular the lights of the first exemplar are, as in [`super::Emission::regularity`].
    pub fn regularity(&self) -> f64 {
        self.layers.first().map_or(0.0, |layer| layer.regularity)
    }

    /// The number of lamps that the exemplars show whole.
    pub fn exemplar_lamps(&self) -> usize {
        self.layers.iter().map(|layer| layer.exemplar.lamps().count()).sum()
    }

    /// Renders a tile of the texture, and its mask, from the exemplars that the plan was made of.
    ///
    /// Errors: `InvalidArgument` for a tile that is empty or reaches beyond the texture, or exemplars of another number or size.
    pub fn tile(&self, input: &Input, styles: &[Style], tile: Tile, job: Job) -> Result<(Image, Image)> {
        self.check(tile)?;
        // A crumb, and whatever joins a piece to something larger, lies within its reach of the tile.
        let margin = if self.has_crumbs() { luminaires::reach(self.crumb) + 2 } else { 0 };
        let around = tile.widened(margin, self.width, self.height);
        let (mut texture, mut mask) = self.render(input, styles, around, job)?;
        if self.has_crumbs() {
            let mut found = luminaires::components(&mask)?;
            self.sweep(&mut texture, &mut mask, &mut found, around);
        }
        recover::threshold(&mut mask);
        if around == tile {
            return Ok((texture, mask));
        }
        Ok((tile.cut(&texture, around)?, tile.cut(&mask, around)?))
    }

    /// The whole texture, its coverage, and the lamps of that.
    pub(super) fn all(&self, input: &Input, styles: &[Style], job: Job) -> Result<(Image, Image, Components)> {
        let (mut texture, mut coverage) = self.render(input, styles, self.whole(), job)?;
        let mut found = luminaires::components(&coverage)?;
        if self.has_crumbs() {
            self.sweep(&mut texture, &mut coverage, &mut found, self.whole());
        }
        Ok((texture, coverage, found))
    }

    /// Takes the crumbs out of a tile. What the border of the texture leaves of a lamp is none.
    fn sweep(&self, texture: &mut Image, mask: &mut Image, found: &mut Components, tile: Tile) {
        let is_cut = |min: [usize; 2], max: [usize; 2]| {
            let (low, high) = ([tile.x + min[0], tile.y + min[1]], [tile.x + max[0] + 1, tile.y + max[1] + 1]);
            low.contains(&0) || high[0] == self.width || high[1] == self.height
        };
        luminaires::sweep(texture, mask, found, self.crumb, is_cut);
    }

    fn has_crumbs(&self) -> bool {
        self.crumb > 1.0
    }

    /// A tile and its coverage, crumbs and all.
    fn render(&self, input: &Input, styles: &[Style], tile: Tile, job: Job) -> Result<(Image, Image)> {
        self.check_exemplars(input, styles)?;
        self.render_lights(input, styles, tile, Lights::All, job)
    }

    /// Some lights of a tile, and their coverage.
    pub(super) fn render_lights(
        &self,
        input: &Input,
        styles: &[Style],
        tile: Tile,
        lights: Lights,
        job: Job,
    ) -> Result<(Image, Image)> {
        let inputs = exemplars(input, 1.0, styles);
        let sources: Vec<Source> =
            self.layers.iter().zip(inputs).map(|(layer, (input, _))| Source { layer, input }).collect();
        recover::run(self, &sources, tile, lights, job)
    }

    /// Checks that exemplars are those, or as large as those, that the plan was made of.
    pub(super) fn check_exemplars(&self, input: &Input, styles: &[Style]) -> Result<()> {
        if styles.len() + 1 != self.layers.len() {
            let (given, planned) = (styles.len() + 1, self.layers.len());
            return Err(Error::argument(format!("there are {given} exemplars; the plan was made of {planned}")));
        }
        for (layer, (input, _)) in self.layers.iter().zip(exemplars(input, 1.0, styles)) {
            super::check_input(input)?;
            let (size, planned) = ([input.unwarped.width, input.unwarped.height], &layer.exemplar);
            if size != [planned.width, planned.height] {
                return Err(Error::argument(format!(
                    "the unwarped image is {} x {}; the plan was made of one of {} x {}",
                    size[0], size[1], planned.width, planned.height
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

impl Tile {
    fn widened(self, by: usize, width: usize, height: usize) -> Self {
        let (x, y) = (self.x.saturating_sub(by), self.y.saturating_sub(by));
        let end = |start: usize, side: usize, whole: usize| start.saturating_add(side).saturating_add(by).min(whole);
        Self { x, y, width: end(self.x, self.width, width) - x, height: end(self.y, self.height, height) - y }
    }

    /// Its part of an image of the tile `around` it.
    fn cut(self, image: &Image, around: Self) -> Result<Image> {
        let mut out = Image::new(self.width, self.height, image.channels)?;
        let (dx, dy) = (self.x - around.x, self.y - around.y);
        for (y, row) in out.data.chunks_exact_mut(self.width * image.channels).enumerate() {
            let start = ((y + dy) * image.width + dx) * image.channels;
            row.copy_from_slice(&image.data[start..start + row.len()]);
        }
        Ok(out)
    }
}

impl Layer {
    fn new(reading: Option<Reading>, input: &Input, params: &Params, job: Job) -> Result<Self> {
        let (mut exemplar, read) = match reading.filter(|r| r.serves(input, params)) {
            Some(reading) => (reading.exemplar, Some((reading.continuation, reading.regularity))),
            None => (Exemplar::new(input, working_side(input, params), job.part(0.0, 0.15))?, None),
        };

        // How the pattern goes on, the size of a patch, and the metadata at that scale.
        let stays = params.tileable || params.centred;
        let window = if stays { None } else { Window::find(&exemplar, params)? };
        let inside = window.as_ref().filter(|w| w.is_shown).map(|w| w.corner);
        let (found, regularity) = match inside {
            Some(_) => (Continuation::Copy, 0.0),
            None => match read {
                Some(read) => read,
                None => period::find(&exemplar, params.least_regularity, job.part(0.15, 0.25))?,
            },
        };
        if let Continuation::Lattice(basis) = found {
            places::leave_out(&mut exemplar, basis)?;
        }
        let working = &exemplar.working;
        let continuation = if params.tileable { found.fitted(params.size())? } else { found };
        let block = if params.block > 0 { params.block } else { default_block(&exemplar, continuation) };
        let reach = continuation
            .lattice()
            .map_or(f64::INFINITY, |[a, b]| (a / working.pitch).length().max((b / working.pitch).length()) / 2.0);
        let cap = reach.min(block as f64).max(1.0);
        let metadata = metadata::compute(
            &working.confidence,
            |pixel| working.is_lit(pixel),
            working.width,
            working.height,
            cap,
            job.part(0.25, 0.3),
        )?;

        // Which part of the exemplar each part of the texture shows.
        let canvas = (params.size() / working.pitch).ceil();
        let canvas = (canvas.x as usize, canvas.y as usize);
        let centred = if params.centred { centre::shift(&exemplar, continuation, params.size()) } else { None };
        let offset = params.offset * params.scale + centred.unwrap_or(DVec2::ZERO);
        let offset = window.map_or(offset, |w| -w.corner);
        let layout = match inside {
            Some(corner) => window::copy(corner, canvas, working.pitch),
            None => {
                let Params { metadata_weight, candidates, .. } = *params;
                let lamps = &exemplar.components.list;
                let lit = lamps.iter().map(|lamp| lamp.area).sum::<usize>() as f64;
                let lamp = lit / lamps.len() as f64 / working.pitch.element_product();
                let guide = Guide { working, metadata: &metadata, metadata_weight, cap, lamp, candidates };
                // One row is made, and repeated beside itself: that is all that the exemplar tells.
                let row = match continuation {
                    Continuation::Row([_, across]) => {
                        let period = across.abs() / working.pitch;
                        let side =
                            |period: f64, all: usize| if period > 0.0 { all.min(period.ceil() as usize) } else { all };
                        Some((across, (side(period.x, canvas.0), side(period.y, canvas.1))))
                    }
                    _ => None,
                };
                let size = row.map_or(canvas, |r| r.1);
                // A row that ends in the exemplar ends in the texture, and begins again at the same distance each time.
                let laid = match continuation {
                    Continuation::Row([along, across]) if !params.tileable => {
                        Continuation::Row([period::repeat_of_row(&exemplar, along).unwrap_or(along), across])
                    }
                    _ => continuation,
                };
                let made = patches::place(&guide, laid, offset, size, block, params.seed, job.part(0.3, 0.9))?;
                match row {
                    Some((across, size)) if size != canvas => made.repeated(canvas, across.abs(), working.pitch),
                    _ => made,
                }
            }
        };

        // Whole lamps as pieces, the rest as the patches have it.
        let laid = found.lattice().zip(continuation.lattice()).filter(|_| params.tileable).map(|(a, b)| [a, b]);
        let (instances, by_pixel): (_, Vec<bool>) = match inside {
            None if params.whole_lamps => {
                let rules = Rules { is_lattice: continuation.lattice().is_some(), wraps: params.tileable };
                let stretched = laid.and_then(|lattices| {
                    cells::place(&exemplar, &layout, lattices, offset, params.size(), params.seed)
                });
                let instances = match continuation {
                    Continuation::Lattice(_) | Continuation::Row(_) if stretched.is_some() => {
                        stretched.unwrap_or_default()
                    }
                    Continuation::Tile(basis) => {
                        lamps::repeat(&exemplar, basis, offset, params.size(), params.tileable)
                    }
                    _ => lamps::resolve(&exemplar, &layout, rules, params.seed, job.part(0.9, 1.0))?,
                };
                (instances, exemplar.piece.iter().zip(&exemplar.cut).map(|(piece, cut)| !piece && !cut).collect())
            }
            _ => (Vec::new(), vec![true; exemplar.whole.len()]),
        };
        let layout = match laid.filter(|_| by_pixel.contains(&true)) {
            Some(lattices) => cells::stretch(&exemplar, &layout, lattices, offset, params.size())?,
            None => layout,
        };
        let instances = match continuation {
            Continuation::Free => shifted(instances, &by_pixel, params)?,
            _ => instances,
        };
        let clipping = Clipping::find(input.unwarped, &exemplar.shown, &exemplar.components, params.clip_level);
        let mut layer = Self {
            exemplar,
            continuation,
            regularity,
            metadata,
            layout,
            instances,
            bands: Bands::default(),
            by_pixel,
            clipping,
            even: None,
            scale: params.scale,
        };
        if params.even_lamps {
            layer.even = Some(recover::mean_colours(&layer, input, job)?);
        }
        Ok(layer)
    }

    /// Area in texels below which a piece of light is a crumb; 0 where no lamp says what is small.
    fn crumb(&self) -> f64 {
        let smallest = self.exemplar.pieces().map(|(_, l)| l.area as f64).fold(f64::INFINITY, f64::min);
        if self.instances.is_empty() { 0.0 } else { CRUMB * smallest / self.scale.powi(2) }
    }
}

/// All exemplars and their unwarped pixels per texel.
pub(super) fn exemplars<'a>(
    first: &'a Input,
    scale: f64,
    styles: &'a [Style],
) -> impl Iterator<Item = (&'a Input<'a>, f64)> {
    std::iter::once((first, scale)).chain(styles.iter().map(|style| (&style.input, style.scale)))
}

/// Lamps of free patches, shifted by the offset. They begin nowhere; only where they repeat there is something to shift.
fn shifted(mut lamps: Vec<Instance>, by_pixel: &[bool], params: &Params) -> Result<Vec<Instance>> {
    if params.offset == DVec2::ZERO {
        return Ok(lamps);
    }
    if !params.tileable || by_pixel.contains(&true) {
        return Err(Error::argument(format!(
            "emission.offset is {}; the lights lie on no lattice that it could shift: set it to 0, or lower \
             emission.least_regularity",
            params.offset
        )));
    }
    let size = params.size();
    let offset = (params.offset * params.scale).rem_euclid(size);
    for lamp in &mut lamps {
        lamp.shift += offset;
    }
    Ok(lamps)
}

/// Longest side of the exemplar at work: coarser than asked for where the result would have too many working pixels.
pub(super) fn working_side(input: &Input, params: &Params) -> f64 {
    let longest = input.unwarped.width.max(input.unwarped.height) as f64;
    let side = longest.min(params.working_side as f64);
    let pixels = params.size().element_product() * (side / longest).powi(2);
    side * (MOST_WORKING_PIXELS / pixels).sqrt().min(1.0)
}

/// A patch that holds more than one lamp and its neighbours: one and a half times the longer period; without one, a quarter
/// of the exemplar.
fn default_block(exemplar: &Exemplar, continuation: Continuation) -> usize {
    let working = &exemplar.working;
    let quarter = working.width.min(working.height) as f64 / 4.0;
    let side = match continuation {
        Continuation::Lattice([a, b]) => 1.5 * (a / working.pitch).length().max((b / working.pitch).length()),
        _ => quarter,
    };
    side.clamp(16.0, (2.0 * quarter).max(16.0)).round() as usize
}

impl Params {
    /// What the texture covers, in unwarped pixels.
    pub(super) fn size(&self) -> DVec2 {
        DVec2::new(self.width as f64, self.height as f64) * self.scale
    }

    /// The sides of a texture that repeats, in texels.
    pub(super) fn repeats(&self) -> Option<DVec2> {
        self.tileable.then(|| DVec2::new(self.width as f64, self.height as f64))
    }
}
