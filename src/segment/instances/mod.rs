//! Finds lamps as compact regions of the photo with a sharp contour, brighter than the plane around them. The paper's
//! classifier of single pixels (§4.2) cannot distinguish a lamp from a bright wall. The contour, size and surroundings
//! of a whole region can.
//!
//! ```text
//! features ─▶ brightness ─▶ component tree ─▶ regions ─▶ painted ─▶ similar ─▶ mask, confidence, doubtful places
//! strokes ──────────────────────────────────────────────────┘
//! ```
//! 1. [`tree`] builds the component tree: the connected regions above every level of brightness, nested in each other.
//! 2. [`regions`] measures them: size in the photo and on the plane ([`footprint`]), shape, colour, and the mean
//!    gradient across the contour.
//! 3. [`painted`] chooses, for each positive stroke, the regions with the sharpest contours that cover it, and
//!    [`leaks`] cuts off bright surfaces that touch them. Without positive strokes, [`proposed`] chooses the regions
//!    most like lamps and like each other.
//! 4. [`similar`] adds regions without a stroke that look like the painted ones and lie on the plane, and
//!    [`further_kinds`] lamps of other kinds if they form a lattice.
//! 5. [`soft`] computes the confidence. It is one half on the contour of each region, which may run between pixels.
//!
//! Not modelled: lamps darker than the plane that they light, such as the housing of an uplight; lamps behind a grid.

mod footprint;
mod further_kinds;
mod leaks;
mod on_lattice;
mod painted;
mod proposed;
mod rays;
mod regions;
mod similar;
mod soft;
mod surroundings;
#[cfg(test)]
mod tests;
mod tree;

use super::face;
use super::input::Input;
use super::samples::{self, Ownership};
use super::segmentation::{Beyond, Segmentation};
use super::strokes::Stroke;
use crate::error::{Error, Result};
use crate::features::CHANNELS;
use crate::image::{Image, try_collect, try_push, try_vec};
use crate::job::Job;
use footprint::Footprint;
use painted::Paint;
use regions::{Brightness, Regions, level};
use similar::{Search, Similar};
use tree::Tree;

/// Share of the pixels under the strokes, the darkest ones, that are ignored when the least brightness of the lamps is
/// determined: hurried strokes run over the edges of lamps. [judged on 28 photos]
const STROKE_EDGE: f64 = 0.1;
/// White is this quantile of L* over the pixels under the positive strokes. [judged on 44 photos]
const WHITE: f64 = 0.9;
/// Lower bound of the L* that is taken for white. It corresponds to a luminance of 1e-5 relative to display white.
/// Strokes with a lower L* lie on black and mark no lamp. [convention]
const MIN_WHITE: f32 = 0.01;
/// Contours are sought at values of L* down to `1 - DEPTH` times the least L* of the lamps. [judged on 28 photos]
const DEPTH: f32 = 0.4;

/// Minimum contrast in L* between a region and the ring of pixels around it. A region with less contrast is taken for
/// noise. [judged on 44 photos]
const MIN_CONTRAST: f64 = 3.0;

/// Expected share of wrong pixels in a lamp under a stroke, and in a lamp without a stroke. [judged on 28 photos]
const ERRORS: [f64; 2] = [0.03, 0.1];

/// Finds the lamps under the positive strokes, and regions that look like them. If no positive stroke covers a pixel,
/// proposes lamps ([`proposed`]). The first three channels of the features are CIELAB.
///
/// Errors (`Degenerate`): no positive stroke covers a pixel, and `input.region` is missing or the number of channels is
/// not [`CHANNELS`].
pub fn run(input: &Input, job: Job) -> Result<Segmentation> {
    let (width, height) = (input.features.width, input.features.height);
    let paint = samples::ownership(input)?;
    let is_proposed = paint.positive.iter().all(Vec::is_empty);
    let can_propose = input.features.channels == CHANNELS && input.region.is_some();
    if is_proposed && !can_propose {
        return Err(Error::degenerate(format!(
            "no positive stroke covers any pixel of the {width} x {height} image ({} strokes, {} of their pixels off the image, {} painted \
             over by the other class): paint at least one stroke on a lamp",
            input.strokes.len(),
            paint.off_image,
            paint.contradictory
        )));
    }

    if let Some(bad) =
        input.features.data.chunks_exact(input.features.channels).find(|p| !p[..3].iter().all(|v| v.is_finite()))
    {
        return Err(Error::argument(format!("features holds a colour of {:?}; all must be finite", &bad[..3])));
    }
    // Take the brightness of lamps from the pixels under the strokes or, without strokes, from the brightest pixels of
    // the plane.
    let unpainted = input.region.filter(|_| is_proposed);
    let brightest = unpainted.map(|plane| proposed::brightest(input.features, plane)).transpose()?;
    let examples = brightest.as_ref().map_or(&paint.positive[..], std::slice::from_ref);
    let photo = Brightness::new(input.features, white(input.features, examples)?, job.part(0.0, 0.2))?;
    let floor = floor(&photo, examples);
    let tree = Tree::new(&photo.levels, floor, width, job.part(0.2, 0.6))?;
    // If the room was laid out as a box, measure the regions not only in pixels, but also on the face that holds the
    // lamps.
    let normal = match unpainted {
        Some(plane) => face::laid_out_under(input.features, plane),
        None => face::laid_out(input),
    };
    let footprint = match normal {
        Some(normal) => {
            let face = (normal, face::offset(input.features, normal));
            Some(Footprint::new(input.features, face, job.part(0.6, 0.65))?)
        }
        None => None,
    };
    let regions = Regions::new(&tree, &photo, footprint.as_ref(), job.part(0.65, 0.8))?;
    let mut negatives = try_vec(tree.len(), 0f64)?;
    paint.negative.iter().for_each(|&p| negatives[tree.node_of[p as usize] as usize] += 1.0);
    tree.accumulate(&mut negatives);

    let search = Search {
        tree: &tree,
        regions: &regions,
        photo: &photo,
        plane: input.region,
        negatives: &negatives,
        is_proposed,
    };
    let painted = match is_proposed {
        true => proposed::find(&search)?,
        false => {
            let paint = Paint { width, positive: &paint.positive, negatives: &negatives };
            let found = brighter_than_around(&search, painted::find(&tree, &regions, &photo, &paint)?)?;
            leaks::cut_off(&search, found)?
        }
    };
    let similar = search.run(&painted, job.part(0.8, 0.95))?;
    let found = segmentation(&search, &painted, &similar, &paint, job.part(0.95, 1.0))?;
    Ok(Segmentation { is_proposed, ..found })
}

/// Keeps the nodes of the component tree that are brighter than the ring of pixels around them by at least
/// [`MIN_CONTRAST`]; the other nodes are taken for noise on a surface.
fn brighter_than_around(search: &Search, nodes: Vec<u32>) -> Result<Vec<u32>> {
    let nobody = try_vec(search.tree.node_of.len(), false)?;
    let mut kept = Vec::new();
    for node in nodes {
        let ring = surroundings::around(node, search.tree, search.photo, None, &nobody)?;
        if ring.is_some_and(|ring| ring.contrast >= MIN_CONTRAST) {
            try_push(&mut kept, node)?;
        }
    }
    Ok(kept)
}

/// The L* that is taken for white: a high quantile of L* over the pixels of `examples`, which lie on lamps. Unlike the
/// maximum, it does not depend on a few highlights.
fn white(features: &Image, examples: &[Vec<u32>]) -> Result<f32> {
    let pixels = examples.iter().flatten();
    let mut lightness = try_collect(pixels.map(|&p| features.data[p as usize * features.channels]))?;
    let bright = (lightness.len() - 1) as f64 * WHITE;
    let (_, white, _) = lightness.select_nth_unstable_by(bright as usize, f32::total_cmp);
    Ok(white.max(MIN_WHITE))
}

/// Returns the brightness level below which no contour is sought.
fn floor(photo: &Brightness, examples: &[Vec<u32>]) -> u16 {
    let mut lightness: Vec<f32> = Vec::new();
    for stroke in examples {
        lightness.extend(stroke.iter().map(|&p| photo.smooth.data[p as usize]));
    }
    let edge = (lightness.len() as f64 * STROKE_EDGE) as usize;
    let (_, dim, _) = lightness.select_nth_unstable_by(edge, f32::total_cmp);
    level(*dim * (1.0 - DEPTH)) as u16
}

fn segmentation(
    search: &Search,
    painted: &[u32],
    similar: &Similar,
    paint: &Ownership,
    job: Job,
) -> Result<Segmentation> {
    let Search { tree, regions, photo, plane, .. } = *search;
    let (width, height) = (photo.width, photo.height);
    let mut confidence = Image::new(width, height, 1)?;
    for &node in painted.iter().chain(&similar.found) {
        soft::add(node, search, &mut confidence, job)?;
    }
    let mut unseen = Image::new(width, height, 1)?;
    for &node in &similar.doubtful {
        tree.pixels(node).iter().for_each(|&p| unseen.data[p as usize] = 1.0);
    }
    let beyond = similar.beyond.iter().map(|&node| {
        let pixels = try_collect(tree.pixels(node).iter().copied())?;
        let is_in_regular_row =
            search.is_in_regular_row(painted.iter().chain(&similar.found).chain(&similar.beyond), node);
        Ok(Beyond { region: Stroke { pixels, positive: true }, is_in_regular_row })
    });
    let beyond = beyond.collect::<Result<Vec<Beyond>>>()?;
    let mut mask = Image::new(width, height, 1)?;
    mask.data.iter_mut().zip(&confidence.data).for_each(|(m, &c)| *m = f32::from(c > 0.5));

    // The error is the expected number of wrong pixels, divided by the number of pixels of the plane or, without a
    // plane, of the photo. In doubtful regions, half of the pixels are expected to be wrong.
    let area = |nodes: &[u32]| nodes.iter().map(|&n| regions.area[n as usize]).sum::<f64>();
    let wrong = ERRORS[0] * area(painted) + ERRORS[1] * area(&similar.found) + 0.5 * area(&similar.doubtful);
    let looked_at = plane.map_or(mask.data.len(), |p| p.data.iter().filter(|v| **v > 0.5).count());
    let samples = [paint.negative.len(), paint.positive.iter().map(Vec::len).sum()];
    Ok(Segmentation {
        mask,
        confidence,
        unseen,
        error: (wrong / looked_at.max(1) as f64).min(1.0),
        model: None,
        channels: 0b111,
        samples,
        contradictory: paint.contradictory,
        off_image: paint.off_image,
        is_of_lamps: true,
        is_proposed: false,
        beyond,
    })
}
