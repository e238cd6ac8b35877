//! Computes the confidence of a region. It is one half on the region's contour, which may run between pixels.

use super::rays;
use super::regions::Brightness;
use super::similar::Search;
use super::surroundings::Bounds;
use crate::error::Result;
use crate::image::{Image, try_collect, try_push, try_vec};
use crate::job::Job;

/// Distance from a region beyond which its confidence is 0, in pixels.
/// [convention: twice the radius of bilinear sampling]
const MAX_DISTANCE: u8 = 2;
/// Minimum confidence of pixels in a region, and maximum confidence of pixels around it, so that a threshold of one
/// half gives exactly the region. [rounding]
const INSIDE: f32 = 0.501;
const OUTSIDE: f32 = 0.499;

/// Holes of at most this share of their region are filled, because they are bars, screws or lead strips in front of a
/// lamp; the inside of a ring-shaped lamp is larger and stays open. [judged on 44 photos]
const HOLE: f64 = 0.05;

/// Writes the confidence of one region, given as a node of the component tree, to the image `confidence`. Where regions
/// overlap, the larger confidence remains. Across the contour, the confidence follows the brightness and rises from 0
/// to 1 within about one pixel. Outside the region, only pixels of the plane within `MAX_DISTANCE` get a confidence.
pub fn add(node: u32, search: &Search, confidence: &mut Image, job: Job) -> Result<()> {
    let Search { tree, regions, photo, plane, .. } = *search;
    let mut region = filled(tree.pixels(node), photo)?;
    if regions.solidity(node as usize) < rays::MAX_SOLIDITY {
        region = rays::remove(region, regions.axes(node as usize)[1], photo, job)?;
    }
    let pixels = region.as_slice();
    let bounds = Bounds::of(pixels, photo, MAX_DISTANCE.into());
    let distance = bounds.distance(pixels, photo.width)?;
    // The contour lies at the lightness of the region's dimmest pixel.
    let contour = contour_lightness(tree.pixels(node), photo);
    let slope = 1.0 / (regions.contour_gradient(node as usize) as f32).max(1.0);
    for (k, &d) in distance.iter().enumerate().filter(|(_, d)| **d <= MAX_DISTANCE) {
        let i = bounds.pixel(k, photo.width);
        if d > 0 && plane.is_some_and(|plane| plane.data[i] <= 0.5) {
            continue;
        }
        let p = 0.5 + slope * (photo.smooth.data[i] - contour);
        let p = if d == 0 { p.clamp(INSIDE, 1.0) } else { p.clamp(0.0, OUTSIDE) };
        confidence.data[i] = confidence.data[i].max(p);
    }
    Ok(())
}

fn contour_lightness(pixels: &[u32], photo: &Brightness) -> f32 {
    pixels.iter().map(|&p| photo.smooth.data[p as usize]).fold(f32::INFINITY, f32::min)
}

/// Returns the pixels of a region and of its small holes.
fn filled(pixels: &[u32], photo: &Brightness) -> Result<Vec<u32>> {
    let bounds = Bounds::of(pixels, photo, 1);
    let [across, down] = bounds.size();
    let mut label = try_vec(across * down, OPEN)?;
    pixels.iter().for_each(|&p| label[bounds.index(p, photo.width)] = REGION);
    let mut all = try_collect(pixels.iter().copied())?;
    let max_hole = (HOLE * pixels.len() as f64) as usize;
    let mut hole = Vec::new();
    for start in 0..label.len() {
        if label[start] != OPEN {
            continue;
        }
        // Flood one connected set of pixels outside the region. It is a hole unless it reaches the border of the
        // bounding box.
        hole.clear();
        try_push(&mut hole, start as u32)?;
        label[start] = WALKED;
        let (mut next, mut is_hole) = (0, true);
        while let Some(&k) = hole.get(next) {
            next += 1;
            let (x, y) = (k as usize % across, k as usize / across);
            is_hole &= x > 0 && y > 0 && x + 1 < across && y + 1 < down;
            for (dx, dy) in [(-1, 0), (1, 0), (0, -1), (0, 1)] {
                let (u, v) = (x.wrapping_add_signed(dx), y.wrapping_add_signed(dy));
                if u < across && v < down && label[v * across + u] == OPEN {
                    label[v * across + u] = WALKED;
                    try_push(&mut hole, (v * across + u) as u32)?;
                }
            }
        }
        if is_hole && hole.len() <= max_hole {
            for &k in &hole {
                try_push(&mut all, bounds.pixel(k as usize, photo.width) as u32)?;
            }
        }
    }
    Ok(all)
}

const OPEN: u8 = 0;
const REGION: u8 = 1;
const WALKED: u8 = 2;
