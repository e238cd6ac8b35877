//! The confidence of a region: one half on its contour, which so lies between pixels.

use super::regions::{Brightness, Regions};
use super::surroundings::Bounds;
use super::tree::Tree;
use crate::error::Result;
use crate::image::Image;

/// Pixels around a region over which confidence falls to 0. [convention: the reach of bilinear sampling, twice]
const REACH: u8 = 2;
/// Confidence that pixels of a region have at least, and pixels around it at most: the mask is the region. [rounding]
const INSIDE: f32 = 0.501;
const OUTSIDE: f32 = 0.499;

/// Adds the confidence of a node: it rises across the contour as the brightness does, by about one over a pixel.
pub fn add(node: u32, tree: &Tree, regions: &Regions, photo: &Brightness, confidence: &mut Image) -> Result<()> {
    let pixels = tree.pixels(node);
    let bounds = Bounds::of(pixels, photo, REACH.into());
    let distance = bounds.distance(pixels, photo.width)?;
    // The lightness halfway between the region's dimmest level and the next one below.
    let contour = contour_lightness(pixels, photo);
    let slope = 1.0 / (regions.contrast(node as usize) as f32).max(1.0);
    for (k, &d) in distance.iter().enumerate().filter(|(_, d)| **d <= REACH) {
        let i = bounds.pixel(k, photo.width);
        let p = 0.5 + slope * (photo.smooth.data[i] - contour);
        let p = if d == 0 { p.clamp(INSIDE, 1.0) } else { p.clamp(0.0, OUTSIDE) };
        confidence.data[i] = confidence.data[i].max(p);
    }
    Ok(())
}

fn contour_lightness(pixels: &[u32], photo: &Brightness) -> f32 {
    pixels.iter().map(|&p| photo.smooth.data[p as usize]).fold(f32::INFINITY, f32::min)
}
