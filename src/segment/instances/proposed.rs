//! Proposes lamps if no positive stroke lies on one: chooses the regions of the plane that are most like lamps.
//!
//! Lamps are compact regions with sharp contours among the brightest regions on their plane. Regions with these
//! properties are ranked by score, which is the contour gradient times a small power of the area. The region of highest
//! score may be a lamp, and so may regions of nearly equal score. Of these, the regions that are alike on the face of
//! the room are proposed: lamps are of a few kinds, but windows, reflections and ornaments differ from lamps and from
//! each other. If no kind stands out, nothing is proposed.

use super::painted::MIN_AREA;
use super::similar::{CHROMA, KIND_AREA, Search, is_of_kind};
use super::surroundings;
use super::tree::Disjoint;
use crate::error::{Error, Result};
use crate::image::{Image, try_collect, try_push, try_vec};
use crate::maths;

/// Share of the plane's pixels that count as the brightest ones. [bench photos:nostrokes]
const BRIGHTEST: f64 = 0.002;
/// Minimum mean L* of a lamp, on a scale where the plane's brightest pixels have an L* of 100.
/// [bench photos:nostrokes]
const MIN_LIGHTNESS: f64 = 80.0;
/// Minimum contrast between a lamp and the ring of pixels around it, in L*. [bench photos:nostrokes]
const MIN_RING: f64 = 10.0;
/// Minimum solidity of a lamp (see `Regions::solidity`). [bench photos:nostrokes]
const MIN_SOLIDITY: f64 = 0.75;
/// Maximum share of the plane that a lamp may cover. If the room has a box layout, the share is measured in areas on
/// the room's face: a lamp close above the camera covers much of the plane in the photo, but little on the face itself.
/// [bench photos:nostrokes]
const MAX_SHARE: f64 = 0.25;
/// At least this share of the ring of pixels around a lamp must lie on the plane. [bench photos:nostrokes]
const ON_PLANE: f64 = 0.6;
/// Minimum score of a lamp (contour gradient times a power of its area), relative to the lamp of highest score.
/// [bench photos:nostrokes]
const NEARLY_BEST: f64 = 0.4;
/// Exponent of a region's area in its score. [bench photos:nostrokes]
const AREA_POWER: f64 = 0.25;
/// Maximum width in pixels of a lamp's edge. The width is the contrast between the lamp and the ring of pixels around
/// it, divided by the lamp's contour gradient. The light that a lamp throws on its ceiling has wider edges.
/// [bench photos:nostrokes]
const MAX_EDGE: f64 = 5.5;
/// A further kind of lamps is accepted if it has at least two lamps, and their total score is at least this share of
/// the total score of the first kind. [bench photos:nostrokes]
const FURTHER_KIND: f64 = 0.3;
/// Nothing is proposed if the lamps of the first kind have less than this share of the total score of all regions: the
/// regions are then too unlike each other. [bench photos:nostrokes]
const MIN_SHARE: f64 = 0.35;

/// Only this number of regions with the highest scores are compared with each other, because photos of noise have very
/// many regions. [convention]
const MAX_COMPARED: usize = 1000;

/// Returns the brightest pixels of a plane, at least one. Errors: the plane has no pixel (`Degenerate`).
pub fn brightest(features: &Image, plane: &Image) -> Result<Vec<u32>> {
    let mut pixels = try_collect((0..plane.data.len() as u32).filter(|&p| plane.data[p as usize] > 0.5))?;
    if pixels.is_empty() {
        return Err(Error::degenerate("no stroke is on a lamp, and the plane to look on is empty: paint the lamps"));
    }
    let count = (BRIGHTEST * pixels.len() as f64).ceil() as usize;
    let lightness = |p: &u32| features.data[*p as usize * features.channels];
    pixels.select_nth_unstable_by(count - 1, |p, q| lightness(q).total_cmp(&lightness(p)));
    pixels.truncate(count);
    Ok(pixels)
}

/// Finds the regions that are most like lamps; none lies inside another. Errors: there is no such region
/// (`Degenerate`).
pub fn find(search: &Search) -> Result<Vec<u32>> {
    let Search { tree, regions, photo, plane, negatives, .. } = *search;
    let plane_area = plane.map_or(tree.node_of.len(), |p| p.data.iter().filter(|v| **v > 0.5).count()) as f64;
    let share = |node: usize| match &regions.surface {
        Some(surface) => surface.area[node] / surface.shown.max(f64::MIN_POSITIVE),
        None => regions.area[node] / plane_area,
    };
    let score = |node: usize| regions.contour_gradient(node) * maths::powf(regions.area[node], AREA_POWER);
    let is_compact = |node: &usize| {
        regions.area[*node] >= MIN_AREA
            && share(*node) <= MAX_SHARE
            && negatives[*node] == 0.0
            && regions.colour(*node)[0] >= MIN_LIGHTNESS
            && regions.solidity(*node) >= MIN_SOLIDITY
    };
    let mut candidates: Vec<(u32, f64)> =
        (1..tree.len()).filter(is_compact).map(|node| (node as u32, score(node))).collect();
    candidates.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));

    // Take candidates in the order of score. A region inside or around a chosen region counts as the same lamp, so skip
    // it.
    let nobody = try_vec(tree.node_of.len(), false)?;
    let mut chosen = Disjoint::new(tree)?;
    let mut lamps: Vec<(u32, f64)> = Vec::new();
    let mut best = 0.0;
    for (node, score) in candidates {
        if score < NEARLY_BEST * best || lamps.len() == MAX_COMPARED {
            break;
        }
        if !chosen.admits(node) {
            continue;
        }
        let Some(ring) = surroundings::around(node, tree, photo, plane, &nobody)? else { continue };
        let is_sharp = ring.contrast <= MAX_EDGE * regions.contour_gradient(node as usize);
        if ring.contrast < MIN_RING || ring.on_plane < ON_PLANE || !is_sharp {
            continue;
        }
        best = score.max(best);
        chosen.choose(node);
        lamps.push((node, score));
    }
    let mut lamps = alike(search, &lamps)?;
    if lamps.is_empty() {
        return Err(Error::degenerate(
            "no stroke is on a lamp, and nothing on the plane looks like one: paint at least one stroke on a lamp",
        ));
    }
    lamps.sort_unstable();
    Ok(lamps)
}

/// Chooses the lamps of one or more kinds: the kind with the largest total score, and further kinds of at least two
/// lamps. `lamps` holds nodes with their scores. A lamp that the border of the photo cuts belongs to each
/// kind of which it may be a part. Returns no lamp if most regions are unlike the lamps of the first kind, and all
/// lamps if the room has no box layout.
fn alike(search: &Search, lamps: &[(u32, f64)]) -> Result<Vec<u32>> {
    let Some(surface) = &search.regions.surface else { return try_collect(lamps.iter().map(|lamp| lamp.0)) };
    let all = try_collect(lamps.iter().map(|&(node, score)| Shape {
        node,
        score,
        area: surface.area[node as usize],
        aspect: surface.aspect(node as usize),
        colour: search.regions.colour(node as usize),
        is_cut: search.is_cut(node),
    }))?;
    kinds(all)
}

/// A region of the photo that may be a lamp.
#[derive(Clone, Copy)]
struct Shape {
    node: u32,
    score: f64,
    /// Area and aspect, measured on the face of the room.
    area: f64,
    aspect: f64,
    /// Mean L*, a* and b*.
    colour: [f64; 3],
    /// Whether the border of the photo cuts the region.
    is_cut: bool,
}

impl Shape {
    /// Whether another region is of this region's kind: similar in area, aspect, a* and b*. If the photo's border cuts
    /// the other region but not this one, the aspect is not compared, and the other region may be of any smaller area.
    fn is_like(&self, other: &Self) -> bool {
        let [_, a, b] = [0, 1, 2].map(|c| self.colour[c] - other.colour[c]);
        let has_size = match other.is_cut && !self.is_cut {
            true => other.area <= self.area * KIND_AREA,
            false => is_of_kind([self.area, self.aspect], [other.area, other.aspect]),
        };
        has_size && maths::hypot(a, b) <= CHROMA
    }
}

/// Returns the nodes of the regions that belong to accepted kinds; see [`alike`].
fn kinds(mut free: Vec<Shape>) -> Result<Vec<u32>> {
    let all = free.iter().map(|lamp| lamp.score).sum::<f64>();
    let (mut chosen, mut first) = (Vec::new(), None);
    loop {
        let total = |seed: &Shape| free.iter().filter(|lamp| seed.is_like(lamp)).map(|lamp| lamp.score).sum::<f64>();
        let totals = free.iter().enumerate().map(|(seed, lamp)| (seed, total(lamp)));
        let Some((seed, score)) = totals.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        let seed = free[seed];
        let (kind, others): (Vec<Shape>, Vec<Shape>) = free.into_iter().partition(|lamp| seed.is_like(lamp));
        free = others;
        let is_accepted = match first {
            None => score >= MIN_SHARE * all,
            Some(first) => kind.len() > 1 && score >= FURTHER_KIND * first,
        };
        if !is_accepted {
            break;
        }
        first = first.or(Some(score));
        for lamp in kind {
            try_push(&mut chosen, lamp.node)?;
        }
    }
    Ok(chosen)
}
