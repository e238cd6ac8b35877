//! Finds regions without a stroke that look like the painted lamps, the regions under the user's positive strokes:
//! similar in brightness, colour, size, shape, and in sharpness against the plane around them. Regions that almost
//! meet these criteria are reported as doubtful.

use super::painted::MIN_AREA;
use super::regions::{self, Brightness, Regions, SOFT};
use super::surroundings::{self, Bounds, Surroundings};
use super::tree::{Disjoint, Tree};
use crate::error::Result;
use crate::geometry::robust::median;
use crate::image::{Image, try_collect, try_push, try_vec};
use crate::job::Job;
use crate::maths;
use std::ops::RangeInclusive;

/// Maximum amount by which a lamp may be darker than the darkest lamp under a stroke, in L*. [judged on 28 photos]
const DIMMER: f64 = 4.0;
/// Maximum amount by which a lamp may be darker than the darkest proposed lamp, in L*, if lamps are proposed. It is
/// larger than `DIMMER`: the brightest lamps are proposed first, while a user's strokes also lie on dimmer lamps.
/// [bench photos:nostrokes]
const DIMMER_PROPOSED: f64 = 8.0;
/// Maximum distance of a lamp's colour from the most similar colour of a lamp under a stroke, in a* and b*.
/// [judged on 28 photos]
pub const CHROMA: f64 = 12.0;
/// Minimum contour gradient of a lamp ([`Regions::contour_gradient`]), relative to the median contour gradient of the
/// lamps under the strokes. The gradient of each lamp is first divided by the lamp's [`sharpness`]. The limit is below
/// 1 because distant lamps are small and blurred. [judged on 28 photos]
const CONTOUR: f64 = 0.55;
/// At most this share of a lamp's contour is soft ([`SOFT`], relative to the median contour gradient of the lamps under
/// strokes). The light that a lamp throws on a wall or a beam has a sharp edge on one side only. In the test photos, at
/// most 0.23 of the contour of lamps is soft, and at least 0.26 of the contour of such light. [bench photos:tune,
/// photos:real]
const MAX_SOFT: f64 = 0.25;
/// Minimum contrast between a lamp and the ring of pixels around it, relative to the median contrast of the lamps under
/// the strokes. The contrast of each lamp is first divided by the lamp's [`sharpness`]. [judged on 28 photos]
const RING: f64 = 0.5;
/// Minimum ratio of a lamp's solidity (see `Regions::solidity`) to the least solidity of the lamps under the strokes.
/// [judged on 28 photos]
const SOLIDITY: f64 = 0.85;
/// Minimum ratio of a lamp's area in pixels to the area of the smallest lamp under a stroke. At three times the
/// distance, a lamp in a ceiling is a third as wide and, foreshortened, a ninth as high. [convention]
const MIN_AREA_RATIO: f64 = 1.0 / 27.0;
/// Maximum ratio of a lamp's area in pixels to the area of the largest lamp under a stroke. It applies only if the
/// room has no box layout. [judged on 28 photos]
const MAX_AREA_RATIO: f64 = 1.6;
/// The area of a lamp, measured on the plane, must lie in `[min / MAX_FACE_AREA_RATIO, max * MAX_FACE_AREA_RATIO]`,
/// where min and max are the smallest and the largest area of the lamps under the strokes. Bloom and blur enlarge
/// distant lamps. [judged on 44 photos]
const MAX_FACE_AREA_RATIO: f64 = 4.0;
/// The aspect (length over width) of a lamp on the plane must lie in `[min / ROUNDER, max * LONGER]`, where min and max
/// are the least and the largest aspect of the lamps under the strokes. Blur widens thin lamps, and lengthens distant
/// lamps along the line of sight. [bench photos:tune]
const ROUNDER: f64 = 4.0;
const LONGER: f64 = 2.5;
/// A lamp under a stroke counts in the limits of area and aspect on the plane only if it has at least this share of the
/// number of pixels of the largest lamp under a stroke. [judged on 44 photos]
const MIN_MEASURED_SHARE: f64 = 0.01;
/// Maximum ratio of a lamp's breadth (short axis of its ellipse, in pixels) to the breadth of the broadest lamp under a
/// stroke. It applies only if the room has no box layout. [judged on 28 photos]
const MAX_BREADTH_RATIO: f64 = 1.5;
/// Minimum area on the plane of a lamp that the photo's border cuts, relative to the minimum area of a whole lamp.
/// [bench photos:tune]
const MIN_CUT_AREA: f64 = 0.06;
/// A region lies on the plane if at least this share of the ring of pixels around it lies on the plane.
/// [judged on 28 photos]
const ON_PLANE: f64 = 0.5;
/// A region in a hole of the plane's mask must have at least this share of its pixels on the face of the room that
/// holds the lamps. [bench photos:tune]
const ON_FACE: f64 = 0.9;
/// A region is like a known lamp if its area divided by the lamp's area lies in `EQUAL_AREA`, and its aspect divided by
/// the lamp's aspect lies in `EQUAL_ASPECT`. Two kinds of regions must be like a known lamp: regions off the plane, and
/// regions that meet only the weaker limits [`ALIKE`]. The area may deviate more upwards than downwards, because blur
/// enlarges distant lamps. [bench photos:tune]
const EQUAL_AREA: RangeInclusive<f64> = 0.7..=2.0;
const EQUAL_ASPECT: RangeInclusive<f64> = 0.7..=1.4;
/// Maximum distance between the centres of two lamps of a row, measured across the row, as a share of the larger of
/// their extents across the row. [bench photos:tune]
const IN_ROW: f64 = 0.25;
/// The distances between the lamps of a regular row may differ from whole steps by this share of a step. [bench
/// photos:tune]
const REGULAR: f64 = 0.15;
/// Maximum aspect (length over width) of a round lamp. Round lamps are often scattered, other lamps lie in rows.
/// [bench photos:tune]
const ROUND: f64 = 1.25;
/// Maximum CIELAB difference between the median colours of two rings of pixels: around a region off the plane and off
/// the face of the room, and around a lamp under a stroke. If the rings differ less, the room may have been laid out
/// too small. [bench photos:tune]
const EQUAL_RING: f64 = 8.0;
/// If the lamps are proposed, lamps of one kind have areas that differ by at most the factor `KIND_AREA`, and aspects
/// that differ by at most `KIND_ASPECT`, both measured on the face of the room. Bloom changes distant lamps more than
/// near ones. [bench photos:nostrokes]
pub const KIND_AREA: f64 = 2.0;
const KIND_ASPECT: f64 = 1.6;
/// Candidates are tried in descending order of contour gradient × area ^ `AREA_POWER`. Of nested regions with almost
/// equally sharp contours, the largest is therefore tried first. [judged on 44 photos]
const AREA_POWER: f64 = 0.2;
/// Minimum likeness (see `Search::likeness`) of a doubtful region; a lamp must have a likeness of at least 1.
/// [judged on 28 photos]
const NEARLY: f64 = 0.7;

/// What a region must show to count as a lamp.
#[derive(Clone, Copy)]
pub struct Limits {
    /// Minimum contour gradient, and minimum contrast to the ring around the region, as a share of the minima in
    /// [`LampLimits`].
    pub contrast: f64,
    /// Maximum share of the region's pixels that may lie under negative strokes.
    pub negatives: f64,
    /// Minimum number of pixels of the region.
    pub pixels: f64,
    /// Factor of [`LampLimits::min_area`].
    pub area: f64,
    /// Amount of L* by which the region may be darker than the least L* of the model.
    pub dimmer: f64,
    /// Whether the region may have another size and shape than the lamps under the strokes.
    pub any_size: bool,
}

/// Limits for any region: the limits of [`LampLimits`] unchanged, no pixel under negative strokes, any number of
/// pixels. [convention]
const STRICT: Limits = Limits { contrast: 1.0, negatives: 0.0, pixels: 0.0, area: 1.0, dimmer: 0.0, any_size: false };
/// Limits for a region with the size and shape of a lamp that is found already. Bloom on a bright ceiling lowers the
/// contrast of lamps, and negative strokes painted in a hurry graze them. Regions of fewer than 30 pixels have no clear
/// shape. [bench photos:tune]
const ALIKE: Limits = Limits { contrast: 0.6, negatives: 0.005, pixels: 30.0, area: 1.0, dimmer: 0.0, any_size: false };
/// Limits for a region that continues a row of lamps of equal width. Louvres make lamps dimmer the flatter one looks at
/// them, so the far lamps of a row may be much darker than the near ones. [bench photos:nostrokes]
const IN_LINE: Limits =
    Limits { contrast: 1.0, negatives: 0.0, pixels: 30.0, area: 0.0, dimmer: 30.0, any_size: false };
/// Maximum difference of the widths of two lamps of a row, and maximum distance between their centres, both measured
/// across the row, as a share of the larger width. [bench photos:nostrokes]
const EQUAL_WIDTH: f64 = 0.15;

/// Variance, in square pixels, of the blur of the photo plus the blur before the gradient is computed.
/// [judged on 44 photos]
const BLUR: f64 = 2.0;

/// Share of a lamp's contrast that is left after a Gaussian blur of variance [`BLUR`]: the value at the centre of a
/// blurred disc that has the lamp's area and, before the blur, the value 1.
fn sharpness(area: f64) -> f64 {
    1.0 - maths::exp(-area / (std::f64::consts::TAU * BLUR))
}

/// Whether two lamps, each given by its area and its aspect on the face of the room, may be of one kind.
pub fn is_of_kind([area, aspect]: [f64; 2], [other_area, other_aspect]: [f64; 2]) -> bool {
    let within = |a: f64, b: f64, factor: f64| a <= b * factor && b <= a * factor;
    within(area, other_area, KIND_AREA) && within(aspect, other_aspect, KIND_ASPECT)
}

/// Regions that no stroke touches but that resemble the lamps under the strokes.
#[derive(Default)]
pub struct Similar {
    pub found: Vec<u32>,
    /// Regions on the plane whose likeness to the lamps under the strokes is just below the minimum for a lamp.
    pub doubtful: Vec<u32>,
    /// Regions off the plane that look like lamps and lie in a row with lamps of the same size and shape, or of the
    /// same width if the border of the photo cuts those lamps. They suggest that the plane continues there.
    pub beyond: Vec<u32>,
}

impl Similar {
    /// Moves the doubtful regions that `is_lamp` accepts to the lamps. `is_lamp` sees the lamps found so far.
    fn retry_doubtful(&mut self, is_lamp: impl Fn(&Self, u32) -> Result<bool>) -> Result<()> {
        for node in std::mem::take(&mut self.doubtful) {
            let list = if is_lamp(self, node)? { &mut self.found } else { &mut self.doubtful };
            list.push(node);
        }
        Ok(())
    }
}

/// The limits that a lamp must meet, derived from the lamps under the strokes.
pub struct LampLimits {
    min_area: f64,
    max_area: f64,
    /// Limits on the area and the aspect, measured on a face of the room; `None` if the room has no box layout.
    surface: Option<FaceLimits>,
    max_breadth: f64,
    min_lightness: f64,
    min_solidity: f64,
    colours: Vec<[f64; 3]>,
    /// Median colours of the rings of pixels around the lamps under the strokes.
    rings: Vec<[f64; 3]>,
    /// Minimum contour gradient, and minimum contrast to the ring, of lamps so large that blur does not reduce their
    /// contrast. For smaller lamps, these minima are multiplied by [`sharpness`].
    contour: f64,
    ring: f64,
}

impl LampLimits {
    /// Whether the ring of pixels around a region has about the colour of the ring around one of the lamps under the
    /// strokes.
    fn is_beside(&self, ring: &Surroundings) -> bool {
        let difference = |own: &[f64; 3]| (0..3).map(|c| maths::powi(own[c] - ring.colour[c], 2)).sum::<f64>().sqrt();
        self.rings.iter().any(|own| difference(own) <= EQUAL_RING)
    }
}

/// Limits of lamps, measured on a face of the room.
struct FaceLimits {
    /// Ranges `[min, max]` of the area and of the aspect.
    area: [f64; 2],
    aspect: [f64; 2],
    /// Maximum length of a lamp that the photo's border cuts. Its aspect may have any value, but a cut makes no lamp
    /// longer. The length of the longest lamp under a stroke is multiplied by the factor by which it grows if area and
    /// aspect grow by `MAX_FACE_AREA_RATIO` and `LONGER`.
    max_length: f64,
}

pub struct Search<'a> {
    pub tree: &'a Tree,
    pub regions: &'a Regions,
    pub photo: &'a Brightness,
    pub plane: Option<&'a Image>,
    /// For each node, the number of its pixels under negative strokes.
    pub negatives: &'a [f64],
    /// Whether no stroke lies on a lamp, so that the lamps are proposals.
    pub is_proposed: bool,
}

impl Search<'_> {
    /// Finds regions that are like the `painted` ones. The result does not include the painted regions themselves.
    pub fn run(&self, painted: &[u32], job: Job) -> Result<Similar> {
        let Self { tree, photo, .. } = *self;
        let mut taken = try_vec(tree.node_of.len(), false)?;
        for &node in painted {
            tree.pixels(node).iter().for_each(|&p| taken[p as usize] = true);
        }
        let Some(model) = self.model(painted)? else { return Ok(Similar::default()) };

        let mut chosen = Disjoint::new(tree)?;
        painted.iter().for_each(|&node| chosen.choose(node));
        let candidates = self.candidates(&model, painted, &chosen, STRICT)?;
        let mut similar = Similar::default();
        for (k, &(node, likeness)) in candidates.iter().enumerate() {
            if k % 256 == 0 {
                job.check()?;
            }
            if !chosen.admits(node) || self.is_unlike_proposed(painted, node as usize) || self.is_soft(&model, node) {
                continue;
            }
            let Some(ring) = surroundings::around(node, tree, photo, self.plane, &taken)? else { continue };
            let likeness = likeness.min(self.ring_likeness(&model, node as usize, &ring));
            let is_on_plane = ring.on_plane >= ON_PLANE;
            let lamps = || painted.iter().chain(&similar.found);
            let is_off_plane = likeness >= 1.0 && !is_on_plane;
            let is_in_hole =
                is_off_plane && self.is_on_face(node as usize) && self.resembles_known_lamp(lamps(), node as usize);
            let is_in_row = is_off_plane
                && (self.is_proposed || model.is_beside(&ring))
                && self.continues_row(lamps(), node as usize);
            if is_in_hole || (is_on_plane && likeness >= 1.0) {
                similar.found.push(node);
            }
            if is_in_row {
                similar.beyond.push(node);
            }
            if is_on_plane && (NEARLY..1.0).contains(&likeness) {
                similar.doubtful.push(node);
            }
            if is_in_hole || is_in_row || (is_on_plane && likeness >= NEARLY) {
                chosen.choose(node);
            }
        }
        if !self.is_proposed {
            self.add_further_kinds(&model, painted, &taken, &mut chosen, &mut similar, job)?;
        }
        self.add_alike(&model, painted, &taken, &mut chosen, &mut similar, job)?;
        self.add_on_lattice(&model, painted, &taken, &mut chosen, &mut similar, job)?;
        self.add_in_line(&model, painted, &taken, &mut chosen, &mut similar, job)?;
        Ok(similar)
    }

    /// If the lamps are proposed, adds further regions that meet the limits [`IN_LINE`] and continue a row of lamps.
    /// Such a region is as wide, across the row, as a lamp that was found before. It must also have the shape of this
    /// lamp, unless the photo's border cuts the lamp. Doubtful regions are tried first. Regions off the plane are added
    /// to `similar.beyond`; of these, only regions on the face of the room that holds the lamps also count as lamps.
    /// Regions that the photo's border cuts are left out.
    fn add_in_line(
        &self,
        model: &LampLimits,
        painted: &[u32],
        taken: &[bool],
        chosen: &mut Disjoint,
        similar: &mut Similar,
        job: Job,
    ) -> Result<()> {
        if !self.is_proposed {
            return Ok(());
        }
        similar.retry_doubtful(|similar, node| {
            let lamps = painted.iter().chain(&similar.found);
            Ok(self.place_in_line(model, lamps, taken, node)? == Some(true))
        })?;
        let candidates = self.candidates(model, painted, chosen, IN_LINE)?;
        for (k, &(node, _)) in candidates.iter().enumerate() {
            if k % 256 == 0 {
                job.check()?;
            }
            if !chosen.admits(node) {
                continue;
            }
            let lamps = painted.iter().chain(&similar.found);
            let Some(is_on_plane) = self.place_in_line(model, lamps, taken, node)? else { continue };
            if is_on_plane || self.is_on_face(node as usize) {
                similar.found.push(node);
            }
            if !is_on_plane {
                similar.beyond.push(node);
            }
            chosen.choose(node);
        }
        Ok(())
    }

    /// Whether a node that continues a row of `lamps` ([`Self::add_in_line`]) lies on the plane. `None` if the node
    /// continues no row, or does not meet the limits [`IN_LINE`].
    fn place_in_line<'a>(
        &self,
        model: &LampLimits,
        mut lamps: impl Iterator<Item = &'a u32>,
        taken: &[bool],
        node: u32,
    ) -> Result<Option<bool>> {
        let k = node as usize;
        let has_shape =
            |lamp: &u32| self.is_cut(*lamp) || self.lamps_of_equal_shape(std::iter::once(lamp), k).next().is_some();
        let is_in_line = |lamp: &u32| {
            let surface = self.regions.surface.as_ref();
            surface.is_some_and(|surface| surface.are_in_line(k, *lamp as usize, EQUAL_WIDTH)) && has_shape(lamp)
        };
        if self.likeness(model, k, IN_LINE) < 1.0 || self.is_cut(node) || !lamps.any(is_in_line) {
            return Ok(None);
        }
        let ring = surroundings::around(node, self.tree, self.photo, self.plane, taken)?;
        let ring = ring.filter(|ring| self.ring_likeness(model, k, ring) >= IN_LINE.contrast);
        Ok(ring.map(|ring| ring.on_plane >= ON_PLANE))
    }

    /// Adds the regions that meet the limits [`ALIKE`] and have the size and shape of a lamp under a stroke or of a
    /// lamp found before. Doubtful regions are tried first.
    fn add_alike(
        &self,
        model: &LampLimits,
        painted: &[u32],
        taken: &[bool],
        chosen: &mut Disjoint,
        similar: &mut Similar,
        job: Job,
    ) -> Result<()> {
        similar.retry_doubtful(|similar, node| {
            let is_alike = self.likeness(model, node as usize, ALIKE) >= 1.0;
            Ok(is_alike && self.is_alike(model, painted, similar, taken, node)?)
        })?;
        let candidates = self.candidates(model, painted, chosen, ALIKE)?;
        for (k, &(node, likeness)) in candidates.iter().enumerate() {
            if k % 256 == 0 {
                job.check()?;
            }
            let is_admitted = likeness >= 1.0 && chosen.admits(node) && !self.is_soft(model, node);
            if is_admitted && self.is_alike(model, painted, similar, taken, node)? {
                similar.found.push(node);
                chosen.choose(node);
            }
        }
        Ok(())
    }

    /// Whether a node has the size and shape of a lamp that a stroke marks or that was found before, lies on the plane
    /// or in a hole of the plane's mask, and has the contrast to its ring that [`ALIKE`] demands.
    fn is_alike(
        &self,
        model: &LampLimits,
        painted: &[u32],
        similar: &Similar,
        taken: &[bool],
        node: u32,
    ) -> Result<bool> {
        if !self.resembles_known_lamp(painted.iter().chain(&similar.found), node as usize) {
            return Ok(false);
        }
        self.stands_out(model, node, ALIKE, taken)
    }

    /// Whether a node lies on the plane or in a hole of the plane's mask, and has the contrast to its ring that the
    /// limits demand.
    pub fn stands_out(&self, model: &LampLimits, node: u32, limits: Limits, taken: &[bool]) -> Result<bool> {
        let Some(ring) = surroundings::around(node, self.tree, self.photo, self.plane, taken)? else {
            return Ok(false);
        };
        let has_contrast = self.ring_likeness(model, node as usize, &ring) >= limits.contrast;
        Ok(has_contrast && (ring.on_plane >= ON_PLANE || self.is_on_face(node as usize)))
    }

    /// Returns the nodes of the component tree that may be lamps, each with its likeness to the lamps under the
    /// strokes. For their order see [`AREA_POWER`]. Nodes that contain a chosen node, and nodes inside a lamp under a
    /// stroke, are left out.
    pub fn candidates(
        &self,
        model: &LampLimits,
        painted: &[u32],
        chosen: &Disjoint,
        limits: Limits,
    ) -> Result<Vec<(u32, f64)>> {
        let Self { tree, regions, .. } = *self;
        let mut is_painted = try_vec(tree.len(), false)?;
        painted.iter().for_each(|&n| is_painted[n as usize] = true);
        let mut candidates = Vec::new();
        for node in 1..tree.len() {
            is_painted[node] |= is_painted[tree.parent[node] as usize];
            if is_painted[node] || chosen.is_around(node as u32) {
                continue;
            }
            let likeness = self.likeness(model, node, limits);
            if likeness >= NEARLY {
                let rank = regions.contour_gradient(node) * maths::powf(regions.area[node], AREA_POWER);
                try_push(&mut candidates, (node as u32, likeness, rank))?;
            }
        }
        candidates.sort_by(|a, b| b.2.total_cmp(&a.2).then(a.0.cmp(&b.0)));
        try_collect(candidates.into_iter().map(|(node, likeness, _)| (node, likeness)))
    }

    /// Derives the limits for lamps from the lamps under the strokes; `None` if nothing surrounds any of them.
    pub fn model(&self, painted: &[u32]) -> Result<Option<LampLimits>> {
        let Self { tree, regions, photo, .. } = *self;
        let nobody = try_vec(tree.node_of.len(), false)?;
        let (mut rings, mut colours_around) = (Vec::new(), Vec::new());
        for &node in painted {
            let Some(ring) = surroundings::around(node, tree, photo, self.plane, &nobody)? else { continue };
            rings.push(ring.contrast / sharpness(regions.area[node as usize]));
            colours_around.push(ring.colour);
        }
        if rings.is_empty() {
            return Ok(None);
        }
        let of = |f: &dyn Fn(usize) -> f64| painted.iter().map(|&n| f(n as usize)).collect::<Vec<f64>>();
        let min_of = |values: Vec<f64>| values.into_iter().fold(f64::INFINITY, f64::min);
        let max_of = |values: Vec<f64>| values.into_iter().fold(0.0, f64::max);
        Ok(Some(LampLimits {
            min_area: (min_of(of(&|n| regions.area[n])) * MIN_AREA_RATIO).max(MIN_AREA),
            max_area: max_of(of(&|n| regions.area[n])) * MAX_AREA_RATIO,
            surface: regions.surface.as_ref().map(|surface| {
                let min_shown = MIN_MEASURED_SHARE * max_of(of(&|n| regions.area[n]));
                let shown: Vec<usize> =
                    painted.iter().map(|&n| n as usize).filter(|&n| regions.area[n] >= min_shown).collect();
                let range = |f: &dyn Fn(usize) -> f64| {
                    let values = shown.iter().map(|&n| f(n));
                    values.fold([f64::INFINITY, 0.0f64], |[low, high], v| [low.min(v), high.max(v)])
                };
                let ([min, max], [round, long]) = (range(&|n| surface.area[n]), range(&|n| surface.aspect(n)));
                let [_, longest] = range(&|n| surface.length(n));
                FaceLimits {
                    area: [min / MAX_FACE_AREA_RATIO, max * MAX_FACE_AREA_RATIO],
                    aspect: [round / ROUNDER, long * LONGER],
                    max_length: longest * (MAX_FACE_AREA_RATIO * LONGER).sqrt(),
                }
            }),
            max_breadth: max_of(of(&|n| regions.axes(n)[1])) * MAX_BREADTH_RATIO,
            min_lightness: min_of(of(&|n| regions.colour(n)[0]))
                - if self.is_proposed { DIMMER_PROPOSED } else { DIMMER },
            min_solidity: min_of(of(&|n| regions.solidity(n))) * SOLIDITY,
            colours: painted.iter().map(|&n| regions.colour(n as usize)).collect(),
            rings: colours_around,
            contour: median(of(&|n| regions.contour_gradient(n) / sharpness(regions.area[n]))) * CONTOUR,
            ring: (median(rings) * RING).max(f64::MIN_POSITIVE),
        }))
    }

    /// Whether a node has the size of a lamp. If the room has a box layout, area and aspect are measured on the plane;
    /// a lamp that the photo's border cuts may then have any aspect, a length up to `max_length`, and an area down to
    /// `MIN_CUT_AREA` times the minimum. Without a layout, area and breadth are measured in the photo. The minimum area
    /// in photo pixels always applies, multiplied by `limits.area`.
    fn has_size(&self, model: &LampLimits, limits: Limits, node: usize) -> bool {
        let min_area = limits.area * model.min_area;
        let regions = self.regions;
        let area = regions.area[node];
        let Some((on_surface, surface)) = model.surface.as_ref().zip(regions.surface.as_ref()) else {
            return (min_area..=model.max_area).contains(&area) && regions.axes(node)[1] <= model.max_breadth;
        };
        if surface.area[node] > on_surface.area[1] {
            return false;
        }
        let is_whole = surface.area[node] >= on_surface.area[0]
            && (on_surface.aspect[0]..=on_surface.aspect[1]).contains(&surface.aspect(node));
        let may_be_cut = || {
            surface.area[node] >= MIN_CUT_AREA * on_surface.area[0]
                && surface.length(node) <= on_surface.max_length
                && self.is_cut(node as u32)
        };
        area >= min_area && (is_whole || may_be_cut())
    }

    /// Returns the lamps whose area and aspect nearly equal the node's, measured on a face of the room; no lamps if
    /// the room has no box layout.
    pub fn lamps_of_equal_shape<'a>(
        &self,
        lamps: impl Iterator<Item = &'a u32>,
        node: usize,
    ) -> impl Iterator<Item = &'a u32> {
        let alike = self.regions.surface.as_ref();
        lamps.filter(move |&&lamp| {
            alike.is_some_and(|surface| {
                EQUAL_AREA.contains(&(surface.area[node] / surface.area[lamp as usize]))
                    && EQUAL_ASPECT.contains(&(surface.aspect(node) / surface.aspect(lamp as usize)))
            })
        })
    }

    /// Whether the lamps are proposed and a node is unlike each of them: it is not of the same kind ([`is_of_kind`]).
    /// False for a node that the photo's border cuts, because it may be of any kind. False also if the room has no box
    /// layout.
    fn is_unlike_proposed(&self, proposed: &[u32], node: usize) -> bool {
        let Some(surface) = self.regions.surface.as_ref().filter(|_| self.is_proposed) else { return false };
        let size = |node: usize| [surface.area[node], surface.aspect(node)];
        !proposed.iter().any(|&lamp| is_of_kind(size(lamp as usize), size(node))) && !self.is_cut(node as u32)
    }

    /// Whether a node touches the border of the photo, which may cut it.
    pub fn is_cut(&self, node: u32) -> bool {
        Bounds::of(self.tree.pixels(node), self.photo, 0).touch_border(self.photo)
    }

    /// Whether one of `lamps` has nearly the size and shape of a node, and the node is round or in a row with that
    /// lamp. Round lamps are often scattered, other lamps lie in rows.
    fn resembles_known_lamp<'a>(&self, lamps: impl Iterator<Item = &'a u32>, node: usize) -> bool {
        let is_round = self.regions.surface.as_ref().is_some_and(|surface| surface.aspect(node) <= ROUND);
        self.lamps_of_equal_shape(lamps, node).any(|&lamp| is_round || self.is_in_row(node, lamp))
    }

    /// Whether a node lies in a row with a lamp of nearly its size and shape.
    fn continues_row<'a>(&self, lamps: impl Iterator<Item = &'a u32>, node: usize) -> bool {
        self.lamps_of_equal_shape(lamps, node).any(|&lamp| self.is_in_row(node, lamp))
    }

    /// Whether a node continues a regular row of whole lamps of nearly its size and shape.
    pub fn is_in_regular_row<'a>(&self, lamps: impl Iterator<Item = &'a u32>, node: u32) -> bool {
        let others = lamps.filter(|lamp| **lamp != node && !self.is_cut(**lamp));
        let alike: Vec<usize> = self.lamps_of_equal_shape(others, node as usize).map(|&lamp| lamp as usize).collect();
        let surface = self.regions.surface.as_ref();
        surface.is_some_and(|surface| surface.continues_regular_row(node as usize, &alike, IN_ROW, REGULAR))
    }

    fn is_in_row(&self, node: usize, lamp: u32) -> bool {
        self.regions.surface.as_ref().is_some_and(|surface| surface.are_in_row(node, lamp as usize, IN_ROW))
    }

    /// Contrast of a node to its ring, relative to the minimum for a lamp of its size.
    pub fn ring_likeness(&self, model: &LampLimits, node: usize, ring: &Surroundings) -> f64 {
        ring.contrast / (model.ring * sharpness(self.regions.area[node]))
    }

    /// Whether a large part of a node's contour is soft ([`MAX_SOFT`]), as the contour of light on a wall is.
    pub fn is_soft(&self, model: &LampLimits, node: u32) -> bool {
        let median = model.contour / CONTOUR * sharpness(self.regions.area[node as usize]);
        regions::soft_share(node, self.tree, self.photo, SOFT * median) > MAX_SOFT
    }

    /// Whether at least [`ON_FACE`] of a node's pixels show the face of the room that holds the lamps.
    pub fn is_on_face(&self, node: usize) -> bool {
        let surface = self.regions.surface.as_ref();
        surface.is_some_and(|surface| surface.on_face[node] >= ON_FACE * self.regions.area[node])
    }

    /// Likeness of a node to the lamps under the strokes, apart from its surroundings: the least of its likenesses in
    /// brightness, colour and contour gradient. A value of at least 1 means that the node meets all limits. The
    /// likeness is 0 if size, shape or negative strokes rule the node out, or if the likeness in contour gradient is
    /// below [`NEARLY`].
    pub fn likeness(&self, model: &LampLimits, node: usize, limits: Limits) -> f64 {
        let regions = self.regions;
        let area = regions.area[node];
        let has_size = limits.any_size || self.has_size(model, limits, node);
        if !has_size || area < limits.pixels || self.negatives[node] > limits.negatives * area {
            return 0.0;
        }
        let sharpness = sharpness(area);
        let contour = regions.contour_gradient(node) / (limits.contrast * model.contour * sharpness);
        if contour < NEARLY || regions.solidity(node) < model.min_solidity {
            return 0.0;
        }
        let [l, a, b] = regions.colour(node);
        let chroma = model.colours.iter().map(|c| maths::hypot(c[1] - a, c[2] - b)).fold(f64::INFINITY, f64::min);
        // Lower the limit for small lamps: blur takes the share 1 - `sharpness` of their contrast. `model.ring / RING`
        // is the median contrast, in L*, that the lamps under the strokes would have without blur.
        let min_lightness = model.min_lightness - limits.dimmer - (1.0 - sharpness) * model.ring / RING;
        let lightness = l / min_lightness.max(1.0);
        // A relative shortfall below the minimum L* counts tenfold, because bright colours differ little in L*.
        let lightness = if lightness < 1.0 { 1.0 - 10.0 * (1.0 - lightness) } else { lightness };
        contour.min(lightness).min(CHROMA / chroma.max(1e-3)).max(0.0)
    }
}
