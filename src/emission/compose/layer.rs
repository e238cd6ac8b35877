//! The layer of one exemplar: the positions of its lamps and patches over the whole texture.

use super::lit_blocks::LitBlocks;
use super::resample;
use super::window::{self, Window};
use crate::emission::agreement::statistics::Statistics;
use crate::emission::analysis::sites::Sites;
use crate::emission::analysis::{Analysis, Choice};
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::measured_lamp::MeasuredLamp;
use crate::emission::exemplar::roles::Role;
use crate::emission::lamps::designs::Designs;
use crate::emission::lamps::instance::Instance;
use crate::emission::lamps::instances::{self, Rules};
use crate::emission::lamps::luminaire::Luminaire;
use crate::emission::lamps::rim_colour::RimColours;
use crate::emission::lamps::{cut, lattice_fill, luminaires, sharpest, spacing, stretched};
use crate::emission::lattice::law::Law;
use crate::emission::lattice::{basis, border_sites, centring, extent};
use crate::emission::params::{Centring, Input, Params, working_side};
use crate::emission::quilt;
use crate::emission::quilt::guide::Guide;
use crate::emission::quilt::metadata;
use crate::emission::quilt::patch_map::PatchMap;
use crate::error::{Error, Result};
use crate::geometry::robust::weighted_median;
use crate::image::Image;
use crate::job::Job;
use crate::maths;
use glam::{DVec2, Vec3};

/// A piece of light is a crumb if its area is below this share of the smallest lamp's area. Crumbs are broken off
/// edges by resampling. [judged on 5 photos]
const MAX_CRUMB: f64 = 0.02;
/// Minimum side of a patch, in working pixels (pixels of the exemplar at the reduced size of the synthesis).
/// [bench emission:knobs]
const MIN_BLOCK: f64 = 16.0;
/// Side of a patch on a lattice, as a multiple of the lattice's longer period. [bench emission:knobs]
const BLOCK_PERIODS: f64 = 1.5;

/// How one exemplar fills the texture: which part of the exemplar each place of the texture shows, and how its lamps
/// are drawn.
pub struct Layer {
    pub exemplar: Exemplar,
    pub law: Law,
    pub regularity: f64,
    pub choice: Choice,
    /// Metadata of the exemplar at working size (the reduced size of the synthesis): the confidence, and the x and y
    /// offset to the nearest light, in units of `PatternPlacement::cap`, clamped to `[-1, 1]`.
    pub metadata: Image,
    pub patch_map: PatchMap,
    /// Lamps that are copied as a whole, each with its shift from the exemplar to the texture.
    pub instances: Vec<Instance>,
    /// Whether lamps are copied as a whole. If not, all lights are copied patch by patch.
    pub has_pieces: bool,
    /// Colours for the clipped parts of lamps, read from their rims; `None` if the photo shows nothing clipped.
    pub rim_colours: Option<RimColours>,
    /// The designs (one size and one outline per kind of lamp) from which lamps are drawn; empty if lamps keep the
    /// outlines of the photo.
    pub designs: Designs,
    /// The sites of the lattice at which lamps are placed exactly; `None` if lamps stay where copied patches show them.
    sites: Option<Sites>,
    /// Copies of the photo at 1/2, 1/4, 1/8, … of its size. Texels that cover many photo pixels are read from them;
    /// there are only as many copies as these texels need.
    pub smaller_photos: Vec<Image>,
    /// The blocks of the exemplar that have light; `None` if the renderer does not need them.
    pub lit_blocks: Option<LitBlocks>,
    /// The mean colour of each component, if each lamp is drawn in its mean colour ([`Params::even_lamps`]); else
    /// `None`.
    pub even: Option<Vec<Vec3>>,
    /// Unwarped pixels per texel.
    pub scale: f64,
}

/// The settings by which an exemplar's pattern is placed on the texture.
struct PatternPlacement<'a> {
    params: &'a Params,
    /// `found`: the law found in the exemplar. `law`: the law that the texture uses. They differ only if the texture is
    /// tileable, because its lattice is then stretched.
    found: Law,
    law: Law,
    /// Position of the lattice's origin in the texture, in unwarped pixels.
    offset: DVec2,
    /// Size of the texture in working pixels (pixels at the reduced size of the synthesis).
    canvas: (usize, usize),
    /// `block`: side of a patch. `cap`: distance to the nearest light, along x or y, at which the distances in the
    /// metadata saturate at 1. Both in working pixels.
    block: usize,
    cap: f64,
}

impl Layer {
    pub fn new(analysis: Option<Analysis>, input: &Input, params: &Params, job: Job) -> Result<Self> {
        let (window, source) = source(analysis, input, params, job)?;
        let LayerExemplar { exemplar, found, regularity, choice, is_ragged } = source;
        let inside = window.as_ref().filter(|w| w.is_shown).map(|w| w.corner);
        let placement = PatternPlacement::new(&exemplar, found, window, params)?;

        // Compute the metadata of the exemplar: the confidence, and the signed x and y distance to the nearest light.
        // Patches are compared by colour and metadata. Then place patches and lamps.
        let working = &exemplar.working;
        let is_lit = |pixel: usize| working.is_lit(pixel);
        let (width, height, job_part) = (working.width, working.height, job.part(0.25, 0.3));
        let metadata = metadata::compute(&working.confidence, is_lit, width, height, placement.cap, job_part)?;
        let patch_map = match inside {
            Some(corner) => window::copy(corner, placement.canvas, working.pitch),
            None => placement.place_patches(&exemplar, &metadata, job.part(0.3, 0.9))?,
        };
        // A copied part of the exemplar keeps its outlines, unless these are ragged and can be replaced by designs.
        let may_have_pieces = params.whole_lamps && (inside.is_none() || is_ragged);
        let designs = match may_have_pieces && params.clean_lamps && input.photo.is_some() {
            true => {
                let outlines = outlines(&exemplar, input, job.part(0.9, 0.92))?;
                cut::complete(Designs::find(&exemplar, &outlines), &exemplar)
            }
            false => Designs::default(),
        };
        let has_pieces = may_have_pieces && (inside.is_none() || !designs.kinds.is_empty());
        let by_patches = !has_pieces || exemplar.roles.contains(&Role::Through);
        let sites = placement.sites(&exemplar, &designs).filter(|_| has_pieces);
        let instances = match has_pieces {
            true => {
                let at = (sites.as_ref(), &patch_map);
                placement.place_lamps(&exemplar, &designs, at, by_patches, job.part(0.92, 1.0))?
            }
            false => Vec::new(),
        };
        let patch_map = match placement.stretch().filter(|_| by_patches) {
            Some(lattices) => {
                quilt::stretched::stretch(&exemplar, &patch_map, lattices, placement.offset, params.size())?
            }
            None => patch_map,
        };
        let rim_colours = RimColours::find(input.unwarped, &exemplar.shown, &exemplar.components, params.clip_level);
        let (law, scale) = (placement.law, params.scale);
        let smaller_photos = smaller_photos(input, &exemplar, scale, job)?;
        let mut layer = Self {
            exemplar,
            law,
            regularity,
            choice,
            metadata,
            patch_map,
            instances,
            has_pieces,
            rim_colours,
            designs,
            sites,
            smaller_photos,
            lit_blocks: None,
            even: None,
            scale,
        };
        if layer.any_copied_by_pixel() || layer.any_without_design() {
            layer.lit_blocks = Some(LitBlocks::new(&layer.exemplar, input.light, |i| layer.is_copied_by_pixel(i))?);
        }
        Ok(layer)
    }

    /// The statistics that the texture should have, with lengths in unwarped pixels. They are measured in the exemplar.
    /// If the exemplar shows where its pattern ends, the part beyond the end is left out. If lamps are drawn from
    /// designs, the areas of the designs replace the measured areas.
    pub fn statistics(&self, unwarped: &Image) -> Statistics {
        // If the exemplar repeats as a whole, the exemplar itself is one period. An infinite period stands for this.
        let periods = match self.law {
            Law::Whole(_) => [Some(f64::INFINITY); 2],
            other => other.periods(),
        };
        let shown = match self.sites.as_ref().and_then(|sites| lattice_fill::end(sites, &self.exemplar)) {
            Some(has_ended) => self.exemplar.statistics(unwarped, periods, has_ended),
            None => self.exemplar.statistics(unwarped, periods, |_| false),
        };
        // A lamp drawn from its design lacks the bloom of the photo, so correct the expected area.
        if self.is_clean() { shown.with_area(self.designs.area_ratio(&self.exemplar)) } else { shown }
    }

    /// Whether lamps are drawn from designs, one size and one outline for all lamps of a kind.
    pub fn is_clean(&self) -> bool {
        !self.designs.kinds.is_empty()
    }

    /// Whether a component is copied patch by patch (each pixel with the shift of its patch) rather than as a whole.
    pub fn is_copied_by_pixel(&self, component: usize) -> bool {
        !self.has_pieces || self.exemplar.roles[component] == Role::Through
    }

    /// Whether any component is copied patch by patch (each pixel with the shift of its patch) rather than as a whole.
    pub fn any_copied_by_pixel(&self) -> bool {
        !self.has_pieces || self.exemplar.roles.contains(&Role::Through)
    }

    /// Whether any lamp that is copied as a whole keeps its outline from the photo, because it has no design.
    fn any_without_design(&self) -> bool {
        self.instances.iter().any(|instance| self.designs.of(instance.component).is_none())
    }

    /// Whether the texture is a copied part of the exemplar, with the outlines of the photo.
    pub fn is_plain_copy(&self) -> bool {
        self.law == Law::Copy && !self.has_pieces
    }

    /// Whether some lights are copied patch by patch, and the texture is not just a copied part of the exemplar.
    pub fn follows_patches(&self) -> bool {
        self.any_copied_by_pixel() && !self.is_plain_copy()
    }

    /// If a texel is one unwarped pixel, rounds a shift to whole pixels, so that copies are exact.
    pub fn rounded(&self, shift: DVec2) -> DVec2 {
        if self.scale == 1.0 { shift.round() } else { shift }
    }

    /// Area in texels below which a piece of light is a crumb (a fragment broken off by resampling) and is removed; 0
    /// if no lamps are copied as a whole.
    pub fn crumb(&self) -> f64 {
        let smallest = self.exemplar.pieces().map(|(_, l)| l.area as f64).fold(f64::INFINITY, f64::min);
        if self.instances.is_empty() { 0.0 } else { MAX_CRUMB * smallest / maths::powi(self.scale, 2) }
    }
}

/// Number of points along each axis of the exemplar at which the size of a texel in the photo is measured.
const MEASURED: usize = 16;

/// Makes copies of the photo at 1/2, 1/4, … of its size, as many as the texels need. `scale` is the number of unwarped
/// pixels per texel.
fn smaller_photos(input: &Input, exemplar: &Exemplar, scale: f64, job: Job) -> Result<Vec<Image>> {
    let Some((photo, to_photo)) = input.photo else { return Ok(Vec::new()) };
    let (width, height) = (exemplar.width, exemplar.height);
    let at = |i: usize, side: usize| (2 * i + 1) * side / (2 * MEASURED);
    let points = (0..MEASURED * MEASURED).map(|i| (at(i % MEASURED, width), at(i / MEASURED, height)));
    let shown = points.filter(|&(x, y)| exemplar.shown[y * width + x]);
    let centres = shown.map(|(x, y)| DVec2::new(x as f64, y as f64) + 0.5);
    resample::smaller(photo, &to_photo, centres, scale, job)
}

/// Minimum score of a lattice ([`Choice`]: how well it predicts the lamps, from 0 to 1) at which lamps are drawn anew,
/// at the sites of the lattice, in a texture that fits inside the exemplar. At a lower score, the texture shows the
/// lamps of a part of the photo. [bench photos:tune]
const MIN_CLEAN_SCORE: f64 = 0.6;

/// A light counts as a line if it is more than this many times as long as wide. [judged on 50 photos]
const MIN_LINE_ASPECT: f64 = 3.0;

/// Outlines count as ragged if a photo pixel is at least this many unwarped pixels long, because they then show the
/// steps between photo pixels. [convention]
const MIN_RAGGED_PIXEL: f64 = 2.0;

/// The exemplar from which a texture is made, and how its pattern continues: on a lattice, in a row, by repetition or
/// without a period.
struct LayerExemplar {
    exemplar: Exemplar,
    /// The law found in the exemplar, or `Copy` if the texture is a copied part of the exemplar.
    found: Law,
    regularity: f64,
    choice: Choice,
    /// Whether the outlines of the lamps are ragged ([`is_ragged`]), and lamps may be drawn from designs instead.
    is_ragged: bool,
}

/// Analyses the exemplar. If the texture fits into the exemplar, and is neither tileable nor centred, also finds the
/// part of the exemplar that the texture copies.
fn source(
    analysis: Option<Analysis>,
    input: &Input,
    params: &Params,
    job: Job,
) -> Result<(Option<Window>, LayerExemplar)> {
    let (exemplar, read) = match analysis.filter(|r| r.is_reusable_for(input, params)) {
        Some(Analysis { exemplar, law, regularity, choice, .. }) => (exemplar, Some((law, regularity, choice))),
        None => {
            let side = working_side(input, params);
            (Exemplar::new(input, side, params.max_magnification, job.part(0.0, 0.15))?, None)
        }
    };
    let is_copy = !params.tileable && params.centring != Centring::Always;
    let mut window = if is_copy { Window::find(&exemplar, params)? } else { None };
    let is_inside = window.as_ref().is_some_and(|w| w.is_shown);
    // If a photo pixel spans several unwarped pixels, outlines are ragged. Lamps with ragged outlines are drawn anew.
    let may_be_redrawn = params.clean_lamps && params.whole_lamps && input.photo.is_some();
    let copied_part = window.as_ref().filter(|w| w.is_shown && may_be_redrawn);
    let is_ragged = copied_part.is_some_and(|w| is_ragged(&exemplar, w.corner, params.size()));
    let copied = || (Law::Copy, 0.0, Choice::only(Law::Copy));
    let (mut exemplar, (mut found, mut regularity, mut choice)) = match read {
        Some(read) => (exemplar, read),
        None if is_inside && !is_ragged => (exemplar, copied()),
        None => {
            let analysis = Analysis::of(exemplar, input, params, job.part(0.15, 0.25))?;
            (analysis.exemplar, (analysis.law, analysis.regularity, analysis.choice))
        }
    };
    if let Some(window) = window.as_mut().filter(|w| w.is_shown) {
        if is_ragged && matches!(found, Law::Lattice(_)) && choice.score >= MIN_CLEAN_SCORE {
            window.is_shown = false;
        } else {
            (found, regularity, choice) = copied();
        }
    }
    continue_lines(&mut exemplar, found);
    if let Law::Lattice(basis) = found {
        border_sites::exclude(&mut exemplar, basis)?;
    }
    Ok((window, LayerExemplar { exemplar, found, regularity, choice, is_ragged }))
}

/// Gives pieces of a line of light the role `Through` (running through the exemplar). A basis vector of at most
/// [`basis::MAX_UNCHANGING_LENGTH`] is no period: the pattern does not change along it. Lights that are long in this
/// direction are pieces of one line, which joints or the border interrupt.
fn continue_lines(exemplar: &mut Exemplar, law: Law) {
    let periods = law.lattice().into_iter().flatten();
    for axis in periods.filter(|period| period.length() <= basis::MAX_UNCHANGING_LENGTH) {
        let (along, across) = if axis.x.abs() > axis.y.abs() { (0, 1) } else { (1, 0) };
        for (lamp, role) in exemplar.components.list.iter().zip(&mut exemplar.roles) {
            if lamp.size()[along] as f64 > MIN_LINE_ASPECT * lamp.size()[across] as f64 {
                *role = Role::Through;
            }
        }
    }
}

/// Whether outlines are ragged in a part of the exemplar, given by its upper left corner and its size: at the whole
/// lamps that lie at least partly in it, the median length of a photo pixel is at least [`MIN_RAGGED_PIXEL`] unwarped
/// pixels. The median is weighted by the photo pixels of the lamps.
fn is_ragged(exemplar: &Exemplar, corner: DVec2, size: DVec2) -> bool {
    let lamps = exemplar.measured_lamps(Role::is_whole);
    let is_within = |lamp: &&MeasuredLamp| {
        let off = (lamp.centre - corner - size / 2.0).abs();
        off.cmplt((size + lamp.size) / 2.0).all()
    };
    let pixels = lamps.iter().filter(is_within).map(|lamp| (lamp.blur.max_element(), lamp.weight));
    weighted_median(pixels.collect()).is_some_and(|pixel| pixel >= MIN_RAGGED_PIXEL)
}

/// Whether the law is a row that ends on both sides within the exemplar, so that the texture repeats it as a whole.
fn ends(exemplar: &Exemplar, law: Law) -> bool {
    match law {
        Law::Row([along, _]) => extent::repeat_of_row(exemplar, along).is_some(),
        _ => false,
    }
}

impl<'a> PatternPlacement<'a> {
    fn new(exemplar: &Exemplar, found: Law, window: Option<Window>, params: &'a Params) -> Result<Self> {
        let working = &exemplar.working;
        let law = if params.tileable { found.fitted(params.size())? } else { found };
        let block = if params.block > 0 { params.block } else { default_block(exemplar, law) };
        let half_period = law
            .lattice()
            .map_or(f64::INFINITY, |[a, b]| (a / working.pitch).length().max((b / working.pitch).length()) / 2.0);
        let cap = half_period.min(block as f64).max(1.0);
        let canvas = (params.size() / working.pitch).ceil();
        let canvas = (canvas.x as usize, canvas.y as usize);
        let is_centred = match params.centring {
            Centring::Never => false,
            Centring::Always => true,
            Centring::BeyondPhoto => window.is_none() && !params.tileable && !ends(exemplar, law),
        };
        // Whole pixels keep what is copied as sharp as it is.
        let centring = if is_centred { centring::shift(exemplar, law, params.size()) } else { None };
        let offset = params.offset * params.scale + centring.map_or(DVec2::ZERO, |shift| shift.round());
        let offset = window.map_or(offset, |w| -w.corner);
        Ok(Self { params, found, law, offset, canvas, block, cap })
    }

    /// Two lattices of a tileable texture: the lattice found in the exemplar, and the same lattice stretched so that a
    /// whole number of periods fits into the texture. `None` for other textures, and without a lattice.
    fn stretch(&self) -> Option<[[DVec2; 2]; 2]> {
        let lattices = self.found.lattice().zip(self.law.lattice());
        lattices.filter(|_| self.params.tileable).map(|(a, b)| [a, b])
    }

    /// Quilts the texture: finds the part of the exemplar that each part of the texture shows.
    fn place_patches(&self, exemplar: &Exemplar, metadata: &Image, job: Job) -> Result<PatchMap> {
        let &Self { params, law, canvas, .. } = self;
        let Params { guide_weight, candidates, .. } = *params;
        let working = &exemplar.working;
        let lamps = &exemplar.components.list;
        let lit = lamps.iter().map(|lamp| lamp.area).sum::<usize>() as f64;
        let lamp = lit / lamps.len() as f64 / working.pitch.element_product();
        let guide = Guide { working, metadata, guide_weight, cap: self.cap, lamp, candidates };

        // For a row of lamps, quilt one strip along the row, as wide as the exemplar. Then repeat the strip side by
        // side over the texture, because the exemplar does not show what lies beside the strip.
        let row = match law {
            Law::Row([_, across]) => {
                let period = across.abs() / working.pitch;
                let side = |period: f64, all: usize| if period > 0.0 { all.min(period.ceil() as usize) } else { all };
                Some((across, (side(period.x, canvas.0), side(period.y, canvas.1))))
            }
            _ => None,
        };
        let size = row.map_or(canvas, |r| r.1);
        // If the exemplar shows that the row ends on both sides, the texture repeats the row as a whole, including the
        // free space at its ends.
        let laid = match law {
            Law::Row([along, across]) if !params.tileable => {
                Law::Row([extent::repeat_of_row(exemplar, along).unwrap_or(along), across])
            }
            _ => law,
        };
        let made = quilt::place(&guide, laid, self.offset, size, self.block, params.seed, job)?;
        Ok(match row {
            Some((across, size)) if size != canvas => made.repeated(canvas, across.abs(), working.pitch),
            _ => made,
        })
    }

    /// The sites of the lattice at which lamps are placed exactly. `None` in three cases: the law has no sites; it is a
    /// row that ends within the exemplar; or no lamp has a design. Panes of a luminous ceiling need no design if
    /// `params.clean_lamps` is set and the exemplar has a photo.
    fn sites(&self, exemplar: &Exemplar, designs: &Designs) -> Option<Sites> {
        let are_panes = self.params.clean_lamps && exemplar.to_photo.is_some() && exemplar.is_luminous_ceiling();
        if ends(exemplar, self.law) || (designs.kinds.is_empty() && !are_panes) {
            return None;
        }
        Sites::new(exemplar, &exemplar.measured_lamps(Role::is_whole), self.law)
    }

    /// Places the lamps that are copied into the texture as a whole, not assembled from patches.
    fn place_lamps(
        &self,
        exemplar: &Exemplar,
        designs: &Designs,
        (sites, patch_map): (Option<&Sites>, &PatchMap),
        by_patches: bool,
        job: Job,
    ) -> Result<Vec<Instance>> {
        let &Self { params, law, offset, .. } = self;
        let rules = Rules { is_lattice: law.lattice().is_some(), wraps: params.tileable };
        let stretched = self
            .stretch()
            .and_then(|lattices| stretched::place(exemplar, patch_map, lattices, offset, params.size(), params.seed));
        let instances = match law {
            Law::Lattice(_) | Law::Row(_) if stretched.is_some() => stretched.unwrap_or_default(),
            Law::Whole(basis) => instances::repeat(exemplar, basis, offset, params.size(), params.tileable),
            Law::Copy => instances::copy(exemplar, offset, params.size(), params.seed),
            _ => {
                let shown = instances::resolve(exemplar, patch_map, rules, params.seed, job)?;
                let area = (offset, params.size());
                match sites {
                    Some(sites) => lattice_fill::place(exemplar, designs, sites, law, shown, area, params.seed),
                    None => shown,
                }
            }
        };
        let mut instances = match law {
            Law::Whole(_) | Law::Copy => instances,
            _ => spacing::keep_apart(exemplar, designs, law, instances),
        };
        sharpest::show_designed(exemplar, designs, &mut instances, params.seed);
        match law {
            Law::Free => shifted(instances, by_patches, params),
            _ => Ok(instances),
        }
    }
}

/// The outlines of the components of an exemplar, in unwarped pixels.
pub fn outlines(exemplar: &Exemplar, input: &Input, job: Job) -> Result<Vec<Luminaire>> {
    let coverage = |pixel: usize| exemplar.coverage(input.light, pixel);
    luminaires::find(&input.unwarped.to_rgb()?, &exemplar.components, &coverage, job)
}

/// Shifts the lamps of a pattern without a lattice by `params.offset`. `by_patches` tells whether some lights are
/// copied patch by patch.
///
/// Errors: an offset other than 0, because such a pattern has no origin. The exception is a tileable texture in which
/// no light is copied patch by patch: its lamps can all be shifted.
fn shifted(mut lamps: Vec<Instance>, by_patches: bool, params: &Params) -> Result<Vec<Instance>> {
    if params.offset == DVec2::ZERO {
        return Ok(lamps);
    }
    if !params.tileable || by_patches {
        return Err(Error::argument(format!(
            "emission.offset is {} texels (of a transfer: pattern.offset in metres); the lights lie on no lattice that \
             it could shift: set it to 0, or lower emission.min_regularity",
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

/// Default side of a patch in working pixels, large enough for a lamp and parts of its neighbours. On a lattice, it is
/// one and a half times the longer period; otherwise a quarter of the exemplar's shorter side. It is at most half of
/// the exemplar's shorter side, but never below [`MIN_BLOCK`].
fn default_block(exemplar: &Exemplar, law: Law) -> usize {
    let working = &exemplar.working;
    let quarter = working.width.min(working.height) as f64 / 4.0;
    let side = match law {
        Law::Lattice([a, b]) => BLOCK_PERIODS * (a / working.pitch).length().max((b / working.pitch).length()),
        _ => quarter,
    };
    side.clamp(MIN_BLOCK, (2.0 * quarter).max(MIN_BLOCK)).round() as usize
}
