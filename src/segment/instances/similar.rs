//! Finds regions without a stroke that look like the painted lamps: as bright, of the same colour, as sharp against the
//! plane around them, of similar size and shape. Regions that almost meet these criteria are reported as doubtful.

use super::painted::MIN_AREA;
use super::regions::{Brightness, Regions};
use super::surroundings::{self, Bounds, Surroundings};
use super::tree::{Disjoint, Tree};
use crate::error::Result;
use crate::image::{Image, try_vec};
use crate::job::Job;
use std::ops::RangeInclusive;

/// Maximum difference in L* by which a lamp may be darker than the darkest painted lamp. [judged on 28 photos]
const DIMMER: f64 = 4.0;
/// Maximum distance in a* and b* from the nearest painted lamp. [judged on 28 photos]
const CHROMA: f64 = 12.0;
/// Minimum contrast along the contour, relative to the median of the painted lamps: distant lamps are small and
/// blurred. [judged on 28 photos]
const CONTOUR: f64 = 0.55;
/// Minimum contrast to the ring around a lamp, relative to the median of the painted lamps. [judged on 28 photos]
const RING: f64 = 0.5;
/// Minimum solidity, relative to the least solid painted lamp. [judged on 28 photos]
const SOLIDITY: f64 = 0.85;
/// Minimum area, relative to the smallest painted lamp: at three times the distance, a lamp in a ceiling is a third as
/// wide and, foreshortened, a ninth as high. [convention]
const SMALLER: f64 = 1.0 / 27.0;
/// Maximum area, relative to the largest painted lamp, if the room's size is not known. [judged on 28 photos]
const LARGER: f64 = 1.6;
/// Maximum factor between the area of a lamp on the plane and the areas of the painted lamps: bloom and blur enlarge
/// distant lamps. [judged on 44 photos]
const SURFACE: f64 = 4.0;
/// Maximum factors by which a lamp may be rounder or longer on the plane than the painted lamps: blur widens thin
/// lamps, and lengthens distant lamps along the line of sight. [bench photos:tune]
const ROUNDER: f64 = 4.0;
const LONGER: f64 = 2.5;
/// Minimum size of a painted lamp whose area and shape on the plane are used, as a share of the pixels of the largest
/// painted lamp. [judged on 44 photos]
const SHOWN: f64 = 0.01;
/// Maximum breadth, relative to the broadest painted lamp, if the room's size is not known. [judged on 28 photos]
const BROADER: f64 = 1.5;
/// Minimum area on the plane of a lamp that the photo's border cuts, as a share of the minimum area of a whole lamp.
/// [bench photos:tune]
const CUT: f64 = 0.06;
/// Minimum share of the ring around a lamp that must lie on the plane. [judged on 28 photos]
const ON_PLANE: f64 = 0.5;
/// Minimum share of a region that must lie on the face of the room that holds the lamps. [bench photos:tune]
const ON_FACE: f64 = 0.9;
/// Ranges of the ratios of a region's area and aspect to those of a lamp, within which a region off the plane is a lamp
/// too: blur enlarges distant lamps. [bench photos:tune]
const EQUAL_AREA: RangeInclusive<f64> = 0.7..=2.0;
const EQUAL_ASPECT: RangeInclusive<f64> = 0.7..=1.4;
/// Maximum offset of lamps across their row, as a share of a lamp's width. [bench photos:tune]
const IN_ROW: f64 = 0.25;
/// Maximum ratio of the axes of a round lamp: round lamps are often scattered, others lie in rows. [bench photos:tune]
const ROUND: f64 = 1.25;
/// Maximum difference in CIELAB between the ring of a region off the plane and the ring of a painted lamp, up to which
/// the region's surroundings count as plane. [bench photos:tune]
const EQUAL_RING: f64 = 8.0;
/// Exponent of the area in the order of candidates: of nested regions with almost equally sharp contours, the largest
/// comes first. [judged on 44 photos]
const AREA_POWER: f64 = 0.2;
/// Minimum likeness of a doubtful region, where 1 is the likeness that is required of a lamp. [judged on 28 photos]
const NEARLY: f64 = 0.7;

/// Variance of the blur of a photo together with the smoothing of the gradient, in square pixels. [judged on 44 photos]
const BLUR: f64 = 2.0;

/// Share of a lamp's contrast that blur leaves: the value at the centre of a disc of the lamp's area after a Gaussian
/// blur.
fn sharpness(area: f64) -> f64 {
    1.0 - (-area / (std::f64::consts::TAU * BLUR)).exp()
}

/// Regions without strokes.
#[derive(Default)]
pub struct Similar {
    pub found: Vec<u32>,
    /// Regions on the plane that are somewhat less like the painted lamps than is required of a lamp.
    pub doubtful: Vec<u32>,
    /// Regions beyond the plane that would be like the painted lamps if the plane continued there.
    pub beyond: Vec<u32>,
}

/// The properties required of a lamp, taken from the painted lamps.
struct Model {
    min_area: f64,
    max_area: f64,
    /// Present if the room was laid out.
    surface: Option<OnSurface>,
    max_breadth: f64,
    min_lightness: f64,
    min_solidity: f64,
    colours: Vec<[f64; 3]>,
    /// Colours of the rings around them.
    rings: Vec<[f64; 3]>,
    /// Minimum contrast along the contour and to the ring, for a lamp so large that blur does not matter.
    contour: f64,
    ring: f64,
}

impl Model {
    /// Whether a ring has the colour of a ring around a painted lamp.
    fn is_beside(&self, ring: &Surroundings) -> bool {
        let difference = |own: &[f64; 3]| (0..3).map(|c| (own[c] - ring.colour[c]).powi(2)).sum::<f64>().sqrt();
        self.rings.iter().any(|own| difference(own) <= EQUAL_RING)
    }
}

/// Ranges of the area and the aspect of lamps on the surface of the room.
struct OnSurface {
    area: [f64; 2],
    aspect: [f64; 2],
}

pub struct Search<'a> {
    pub tree: &'a Tree,
    pub regions: &'a Regions,
    pub photo: &'a Brightness,
    pub plane: Option<&'a Image>,
    /// Number of pixels under negative strokes in the region of each node.
    pub negatives: &'a [f64],
}

impl Search<'_> {
    /// Finds regions that are like the `painted` ones, without these.
    pub fn run(&self, painted: &[u32], job: Job) -> Result<Similar> {
        let Self { tree, regions, photo, .. } = *self;
        let mut taken = try_vec(tree.node_of.len(), false)?;
        for &node in painted {
            tree.pixels(node).iter().for_each(|&p| taken[p as usize] = true);
        }
        let Some(model) = self.model(painted)? else { return Ok(Similar::default()) };

        // Rate all nodes except those around or inside the painted ones.
        let mut chosen = Disjoint::new(tree)?;
        painted.iter().for_each(|&node| chosen.choose(node));
        let mut is_painted = try_vec(tree.len(), false)?;
        painted.iter().for_each(|&n| is_painted[n as usize] = true);
        let mut candidates = Vec::new();
        for node in 1..tree.len() {
            is_painted[node] |= is_painted[tree.parent[node] as usize];
            let likeness = match is_painted[node] || chosen.is_around(node as u32) {
                true => 0.0,
                false => self.likeness(&model, node),
            };
            if likeness >= NEARLY {
                candidates.push((node as u32, likeness, regions.contrast(node) * regions.area[node].powf(AREA_POWER)));
            }
        }

        // Take the sharpest contour first. Regions inside or around a region that was taken belong to it.
        candidates.sort_by(|a, b| b.2.total_cmp(&a.2).then(a.0.cmp(&b.0)));
        let mut similar = Similar::default();
        for (k, &(node, likeness, _)) in candidates.iter().enumerate() {
            if k % 256 == 0 {
                job.check()?;
            }
            if !chosen.admits(node) {
                continue;
            }
            let Some(ring) = surroundings::around(node, tree, photo, self.plane, &taken)? else { continue };
            let likeness = likeness.min(ring.contrast / (model.ring * sharpness(self.regions.area[node as usize])));
            let is_on_plane = ring.on_plane >= ON_PLANE;
            let lamps = || painted.iter().chain(&similar.found);
            let is_beside = likeness >= 1.0 && !is_on_plane && model.is_beside(&ring);
            let is_in_hole = is_beside && self.is_on_face(node as usize) && self.is_like_one(lamps(), node as usize);
            let is_in_row = is_beside && self.continues_row(lamps(), node as usize);
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
        Ok(similar)
    }

    fn model(&self, painted: &[u32]) -> Result<Option<Model>> {
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
        let least = |values: Vec<f64>| values.into_iter().fold(f64::INFINITY, f64::min);
        let most = |values: Vec<f64>| values.into_iter().fold(0.0, f64::max);
        Ok(Some(Model {
            min_area: (least(of(&|n| regions.area[n])) * SMALLER).max(MIN_AREA),
            max_area: most(of(&|n| regions.area[n])) * LARGER,
            surface: regions.surface.as_ref().map(|surface| {
                let min_shown = SHOWN * most(of(&|n| regions.area[n]));
                let shown: Vec<usize> =
                    painted.iter().map(|&n| n as usize).filter(|&n| regions.area[n] >= min_shown).collect();
                let range = |f: &dyn Fn(usize) -> f64| {
                    let values = shown.iter().map(|&n| f(n));
                    values.fold([f64::INFINITY, 0.0f64], |[low, high], v| [low.min(v), high.max(v)])
                };
                let ([min, max], [round, long]) = (range(&|n| surface.area[n]), range(&|n| surface.aspect(n)));
                OnSurface { area: [min / SURFACE, max * SURFACE], aspect: [round / ROUNDER, long * LONGER] }
            }),
            max_breadth: most(of(&|n| regions.axes(n)[1])) * BROADER,
            min_lightness: least(of(&|n| regions.colour(n)[0])) - DIMMER,
            min_solidity: least(of(&|n| regions.solidity(n))) * SOLIDITY,
            colours: painted.iter().map(|&n| regions.colour(n as usize)).collect(),
            rings: colours_around,
            contour: median(of(&|n| regions.contrast(n) / sharpness(regions.area[n]))) * CONTOUR,
            ring: (median(rings) * RING).max(f64::MIN_POSITIVE),
        }))
    }

    /// Whether a node has the size of a lamp. The size is measured on the plane if the room was laid out, else in the
    /// photo. A lamp that the border of the photo cuts may be much smaller.
    fn has_size(&self, model: &Model, node: usize) -> bool {
        let regions = self.regions;
        let area = regions.area[node];
        let Some((on_surface, surface)) = model.surface.as_ref().zip(regions.surface.as_ref()) else {
            return (model.min_area..=model.max_area).contains(&area) && regions.axes(node)[1] <= model.max_breadth;
        };
        let is_cut = || Bounds::of(self.tree.pixels(node as u32), self.photo, 0).touch_border(self.photo);
        if surface.area[node] > on_surface.area[1] {
            return false;
        }
        let is_whole = surface.area[node] >= on_surface.area[0]
            && (on_surface.aspect[0]..=on_surface.aspect[1]).contains(&surface.aspect(node));
        area >= model.min_area && (is_whole || surface.area[node] >= CUT * on_surface.area[0] && is_cut())
    }

    /// The lamps whose size and shape are nearly those of a node, both measured on the face of a room that was laid
    /// out.
    fn like_ones<'a>(&self, lamps: impl Iterator<Item = &'a u32>, node: usize) -> impl Iterator<Item = &'a u32> {
        let alike = self.regions.surface.as_ref();
        lamps.filter(move |&&lamp| {
            alike.is_some_and(|surface| {
                EQUAL_AREA.contains(&(surface.area[node] / surface.area[lamp as usize]))
                    && EQUAL_ASPECT.contains(&(surface.aspect(node) / surface.aspect(lamp as usize)))
            })
        })
    }

    /// Whether some lamp has nearly the size and shape of a node, and the node is round or lies in a row with that
    /// lamp: round lamps are often scattered, others lie in rows.
    fn is_like_one<'a>(&self, lamps: impl Iterator<Item = &'a u32>, node: usize) -> bool {
        let is_round = self.regions.surface.as_ref().is_some_and(|surface| surface.aspect(node) <= ROUND);
        self.like_ones(lamps, node).any(|&lamp| is_round || self.is_in_row(node, lamp))
    }

    /// Whether a node continues a row of lamps of its size and shape.
    fn continues_row<'a>(&self, lamps: impl Iterator<Item = &'a u32>, node: usize) -> bool {
        self.like_ones(lamps, node).any(|&lamp| self.is_in_row(node, lamp))
    }

    fn is_in_row(&self, node: usize, lamp: u32) -> bool {
        self.regions.surface.as_ref().is_some_and(|surface| surface.are_in_row(node, lamp as usize, IN_ROW))
    }

    /// Whether a node lies on the face of the room that holds the lamps.
    fn is_on_face(&self, node: usize) -> bool {
        let surface = self.regions.surface.as_ref();
        surface.is_some_and(|surface| surface.on_face[node] >= ON_FACE * self.regions.area[node])
    }

    /// How much a node is like the painted lamps, apart from its surroundings. The likeness is at least 1 if the node
    /// is like them in all respects. Below 1 it is the least of the likenesses in brightness, colour and contrast. It
    /// is 0 if size, shape or negative strokes rule the node out.
    fn likeness(&self, model: &Model, node: usize) -> f64 {
        let regions = self.regions;
        let area = regions.area[node];
        if !self.has_size(model, node) || self.negatives[node] > 0.0 {
            return 0.0;
        }
        let sharpness = sharpness(area);
        let contour = regions.contrast(node) / (model.contour * sharpness);
        if contour < NEARLY || regions.solidity(node) < model.min_solidity {
            return 0.0;
        }
        let [l, a, b] = regions.colour(node);
        let chroma = model.colours.iter().map(|c| (c[1] - a).hypot(c[2] - b)).fold(f64::INFINITY, f64::min);
        // Blur darkens small lamps.
        let min_lightness = model.min_lightness - (1.0 - sharpness) * model.ring / RING;
        let lightness = l / min_lightness.max(1.0);
        // A shortfall below the minimum lightness counts tenfold: L* is a narrow scale at its top.
        let lightness = if lightness < 1.0 { 1.0 - 10.0 * (1.0 - lightness) } else { lightness };
        contour.min(lightness).min(CHROMA / chroma.max(1e-3)).max(0.0)
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
