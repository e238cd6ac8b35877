//! Finds the regions under the strokes: for each stroke, the disjoint nodes of the component tree that cover the
//! stroke and have the sharpest contours.

use super::regions::{self, Brightness, Regions, SOFT};
use super::tree::Tree;
use crate::error::Result;
use crate::image::try_vec;
use crate::maths;

/// Maximum share of the image that a lamp may cover; a larger region is a wall or a ceiling. [judged on 28 photos]
const MAX_AREA: f64 = 0.3;
/// Minimum number of pixels of a lamp; smaller regions are noise. [judged on 28 photos]
pub const MIN_AREA: f64 = 6.0;
/// A region under a stroke must hold at least this share of the stroke's pixels. A region with less is touched by the
/// stroke's edge only. [judged on 28 photos]
const MIN_COVER: f64 = 0.03;
/// A region whose length is this many times the length of its stroke has half the gain that it would have if it were
/// short (see `of_stroke`). [judged on 28 photos]
const USUAL_EXTENT: f64 = 4.0;
/// Exponent of the cover in the gain of a region (see `of_stroke`). The cover is the share of the stroke's pixels that
/// the region holds. The exponent is above 1 to favour whole regions: at equal contour gradient, one region with a
/// cover of 0.8 has a larger gain than two regions with a cover of 0.4 each. [judged on 44 photos]
const COVER_POWER: f64 = 1.1;
/// Exponent of the purity in the gain of a region (see `of_stroke`). The purity is the share of positive pixels among
/// the painted pixels of the region. The exponent all but rules out regions with many negative pixels.
/// [judged on 28 photos]
const PURITY_POWER: i32 = 4;
/// Minimum contour gradient of a region, as a share of the highest contour gradient among the regions chosen for the
/// same stroke. Chosen regions with a lower gradient are fragments and are dropped. [judged on 28 photos]
const MIN_CONTOUR_GRADIENT: f64 = 0.4;
/// Of the regions chosen for one stroke, regions with a larger soft share of their contour ([`SOFT`], relative to the
/// highest contour gradient among them) are dropped, unless all are soft. They are the light of a lamp on the ceiling
/// beside it, which a stroke painted in a hurry grazes. [convention: a third]
const MAX_SOFT: f64 = 1.0 / 3.0;

/// The positive strokes as pixels, and the negative strokes as counts per node of the component tree. `width` is the
/// width of the photo. A pixel under several strokes belongs to the last of them.
pub struct Paint<'a> {
    pub width: usize,
    /// Pixels of each positive stroke.
    pub positive: &'a [Vec<u32>],
    /// For each node, the number of its pixels under negative strokes.
    pub negatives: &'a [f64],
}

/// Finds the nodes of the component tree under the positive strokes, in ascending order, without nodes that lie inside
/// other found nodes.
pub fn find(tree: &Tree, regions: &Regions, photo: &Brightness, paint: &Paint) -> Result<Vec<u32>> {
    let mut is_chosen = try_vec(tree.len(), false)?;
    let mut covered = try_vec(tree.len(), 0f64)?;
    for stroke in paint.positive.iter().filter(|s| !s.is_empty()) {
        let mut nodes = of_stroke(tree, regions, paint, stroke, &mut covered);
        drop_soft(&mut nodes, tree, regions, photo);
        nodes.into_iter().for_each(|node| is_chosen[node as usize] = true);
    }
    Ok((1..tree.len() as u32).filter(|&n| is_chosen[n as usize] && is_outermost(tree, &is_chosen, n)).collect())
}

/// Whether no ancestor of the given node is chosen.
pub fn is_outermost(tree: &Tree, is_chosen: &[bool], node: u32) -> bool {
    !tree.ancestors(node).skip(1).any(|n| is_chosen[n as usize])
}

/// Finds the disjoint nodes under a stroke with the largest sum of gains. The gain is the score by which the nodes
/// compete: contour gradient × cover ^ `COVER_POWER` × purity ^ `PURITY_POWER` / (1 + (l / (`USUAL_EXTENT` × s))²).
/// The cover is the share of the stroke's pixels that lie in the node, the purity is the share of positive pixels among
/// the painted pixels in the node, l is the long axis of the node's ellipse ([`Regions::axes`]), and s is the diagonal
/// of the stroke's bounding box.
/// `covered` holds zeros before and after the call.
fn of_stroke(tree: &Tree, regions: &Regions, paint: &Paint, stroke: &[u32], covered: &mut [f64]) -> Vec<u32> {
    // Collect the nodes that hold pixels of the stroke, parents first, and count these pixels in `covered`.
    let mut nodes = Vec::new();
    for &p in stroke {
        for node in tree.ancestors(tree.node_of[p as usize]) {
            if covered[node as usize] == 0.0 {
                nodes.push(node);
            }
            covered[node as usize] += 1.0;
        }
    }
    nodes.sort_unstable();
    let length = extent(stroke, paint.width);
    let image_area = tree.node_of.len() as f64;
    let gain = |node: u32, covered: &[f64]| {
        let n = node as usize;
        let (cover, area) = (covered[n] / stroke.len() as f64, regions.area[n]);
        if cover < MIN_COVER || !(MIN_AREA..=MAX_AREA * image_area).contains(&area) {
            return 0.0;
        }
        let purity = covered[n] / (covered[n] + paint.negatives[n]);
        let excess = regions.axes(n)[0] / (USUAL_EXTENT * length);
        regions.contour_gradient(n) * maths::powf(cover, COVER_POWER) * maths::powi(purity, PURITY_POWER)
            / (1.0 + excess * excess)
    };

    // From the leaves to the root, test whether a node gains at least as much as the best disjoint nodes inside it.
    let mut best = vec![0.0; nodes.len()];
    let mut inside = vec![0.0; nodes.len()];
    let mut is_better = vec![false; nodes.len()];
    for k in (0..nodes.len()).rev() {
        let own = gain(nodes[k], covered);
        is_better[k] = own > 0.0 && own >= inside[k];
        best[k] = own.max(inside[k]);
        if let Ok(up) = nodes.binary_search(&tree.parent[nodes[k] as usize]) {
            inside[up] += best[k];
        }
    }
    nodes.iter().for_each(|&n| covered[n as usize] = 0.0);

    // From the root to the leaves, choose on each path the first node that gains at least as much as the best disjoint
    // nodes inside it.
    let mut chosen = Vec::new();
    let mut is_within = vec![false; nodes.len()];
    for (k, &node) in nodes.iter().enumerate() {
        let up = nodes.binary_search(&tree.parent[node as usize]);
        is_within[k] = up.is_ok_and(|up| is_within[up]);
        if !is_within[k] && is_better[k] {
            is_within[k] = true;
            chosen.push(node);
        }
    }
    let sharpest = chosen.iter().map(|&n| regions.contour_gradient(n as usize)).fold(0.0, f64::max);
    chosen.retain(|&n| regions.contour_gradient(n as usize) >= MIN_CONTOUR_GRADIENT * sharpest);
    chosen
}

/// Drops the nodes of a stroke whose contour is soft ([`MAX_SOFT`]), if others are not.
fn drop_soft(nodes: &mut Vec<u32>, tree: &Tree, regions: &Regions, photo: &Brightness) {
    if nodes.len() < 2 {
        return;
    }
    let sharpest = nodes.iter().map(|&n| regions.contour_gradient(n as usize)).fold(0.0, f64::max);
    let is_sharp = |&node: &u32| regions::soft_share(node, tree, photo, SOFT * sharpest) <= MAX_SOFT;
    let sharp: Vec<u32> = nodes.iter().copied().filter(is_sharp).collect();
    if !sharp.is_empty() {
        *nodes = sharp;
    }
}

/// The diagonal of a stroke's bounding box, in pixels.
fn extent(stroke: &[u32], width: usize) -> f64 {
    let side = |f: fn(usize, usize) -> usize| {
        let values = || stroke.iter().map(|&p| f(p as usize, width));
        (values().max().unwrap_or(0) - values().min().unwrap_or(0) + 1) as f64
    };
    maths::hypot(side(|p, width| p % width), side(|p, width| p / width))
}
