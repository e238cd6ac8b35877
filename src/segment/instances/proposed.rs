//! Proposes lamps if no positive stroke lies on one: chooses the regions of the plane that are most like lamps.
//!
//! Lamps are compact regions with sharp contours among the brightest regions on their plane. Regions with these
//! properties are ranked by score, which is the contour gradient times a small power of the area. The region of highest
//! score is taken for a lamp, and so are regions of nearly equal score.

use super::painted::MIN_AREA;
use super::similar::Search;
use super::surroundings;
use super::tree::Disjoint;
use crate::error::{Error, Result};
use crate::image::{Image, try_collect, try_vec};

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
    let Search { tree, regions, photo, plane, negatives } = *search;
    let plane_area = plane.map_or(tree.node_of.len(), |p| p.data.iter().filter(|v| **v > 0.5).count()) as f64;
    let share = |node: usize| match &regions.surface {
        Some(surface) => surface.area[node] / surface.shown.max(f64::MIN_POSITIVE),
        None => regions.area[node] / plane_area,
    };
    let score = |node: usize| regions.contour_gradient(node) * regions.area[node].powf(AREA_POWER);
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
    let mut lamps: Vec<u32> = Vec::new();
    let mut best = 0.0;
    for (node, score) in candidates {
        if score < NEARLY_BEST * best {
            break;
        }
        if !chosen.admits(node) {
            continue;
        }
        let Some(ring) = surroundings::around(node, tree, photo, plane, &nobody)? else { continue };
        if ring.contrast < MIN_RING || ring.on_plane < ON_PLANE {
            continue;
        }
        best = score.max(best);
        chosen.choose(node);
        lamps.push(node);
    }
    if lamps.is_empty() {
        return Err(Error::degenerate(
            "no stroke is on a lamp, and nothing on the plane looks like one: paint at least one stroke on a lamp",
        ));
    }
    lamps.sort_unstable();
    Ok(lamps)
}
