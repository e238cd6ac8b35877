//! Cuts off what leaks out of painted lamps. Where a lamp touches a bright wall, or bloom joins it with one, the
//! contour with the highest gradient may run around both. The lamp is then larger than the other lamps under strokes,
//! and a brighter region inside it equals one of them.

use super::regions::Regions;
use super::similar::Search;
use super::tree::Tree;
use crate::error::Result;
use crate::image::try_vec;
use glam::DVec2;

/// A lamp may leak if its area is more than this many times the area of another lamp, both measured on the face of the
/// room. Up to this factor, bloom and blur explain the difference. [bench photos:tune]
const MIN_EXCESS: f64 = 1.3;
/// Maximum ratio of the areas, and of the aspects, of the region inside the lamp and of the lamp that it equals. The
/// region is bounded by a brighter contour, which lies up to a pixel farther inside. [bench photos:tune]
const EQUAL: f64 = 1.25;
/// The region inside the lamp must hold at least this share of the lamp's pixels. [convention]
const MIN_CORE: f64 = 0.5;

/// The lamp that a region inside another lamp equals must have at least this share of the region's pixels: the lamps
/// nearest to the camera are seen best. [convention]
const MIN_PIXELS: f64 = 0.9;

/// The part that is cut off must lie beside the region inside the lamp: its centre is at least this many standard
/// deviations of the region's pixels from their mean, where the ellipse with their second moments ends. Bloom makes a
/// rim all around, whose centre lies inside. [convention: exact]
const ELLIPSE: f64 = 2.0;

/// Replaces each lamp that leaks by the region inside it that equals another lamp. Lamps that the border of the photo
/// cuts show no size, so no region is compared with them. Does nothing without a layout of the room.
pub fn cut_off(search: &Search, painted: Vec<u32>) -> Result<Vec<u32>> {
    let Search { tree, regions, .. } = *search;
    let Some(surface) = &regions.surface else { return Ok(painted) };
    let exceeds = |lamp: u32, other: u32| surface.area[lamp as usize] > MIN_EXCESS * surface.area[other as usize];
    let whole: Vec<u32> = painted.iter().copied().filter(|&lamp| !search.is_cut(lamp)).collect();
    let smaller = |lamp: u32| whole.iter().copied().filter(move |&other| exceeds(lamp, other));
    if painted.iter().all(|&lamp| smaller(lamp).next().is_none()) {
        return Ok(painted);
    }
    let Some(model) = search.model(&painted)? else { return Ok(painted) };
    let largest_child = largest_children(tree, regions)?;
    let difference = |node: u32, other: u32| {
        let (node, other) = (node as usize, other as usize);
        let area = surface.area[node] / surface.area[other];
        let aspect = surface.aspect(node) / surface.aspect(other);
        area.max(1.0 / area).max(aspect.max(1.0 / aspect))
    };
    let is_seen_well = |other: u32, node: u32| regions.area[other as usize] >= MIN_PIXELS * regions.area[node as usize];
    let core = |lamp: u32| {
        let min_area = MIN_CORE * regions.area[lamp as usize];
        let inside = std::iter::successors(Some(lamp), |&node| Some(largest_child[node as usize]).filter(|&n| n != 0));
        let inside = inside.skip(1).take_while(|&node| regions.area[node as usize] >= min_area);
        let equals = inside.flat_map(|node| {
            let others = smaller(lamp).filter(move |&other| is_seen_well(other, node));
            others.map(move |other| (difference(node, other), node))
        });
        let (least, node) = equals.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let leaks = least <= EQUAL && is_beside(regions, lamp as usize, node as usize);
        (leaks && !search.is_soft(&model, node)).then_some(node)
    };
    Ok(painted.iter().map(|&lamp| core(lamp).unwrap_or(lamp)).collect())
}

/// Whether the part of a lamp outside a region inside it has its centre outside the region's ellipse ([`ELLIPSE`]).
fn is_beside(regions: &Regions, lamp: usize, inside: usize) -> bool {
    let moment = |node: usize| regions.area[node] * DVec2::from_array(regions.centre(node));
    let outside = (moment(lamp) - moment(inside)) / (regions.area[lamp] - regions.area[inside]);
    let off = outside - DVec2::from_array(regions.centre(inside));
    off.dot(regions.spot(inside).inverse * off) > ELLIPSE * ELLIPSE
}

/// For each node, its child with the most pixels; 0, the root, for nodes without children.
fn largest_children(tree: &Tree, regions: &Regions) -> Result<Vec<u32>> {
    let mut largest = try_vec(tree.len(), 0u32)?;
    for node in 1..tree.len() {
        let up = tree.parent[node] as usize;
        if largest[up] == 0 || regions.area[node] > regions.area[largest[up] as usize] {
            largest[up] = node as u32;
        }
    }
    Ok(largest)
}
