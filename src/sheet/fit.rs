//! Identifies the marks among the candidates, and fits the map from the page to the photo.

use super::detect::{Candidate, refine};
use super::page::Page;
use crate::error::{Error, Result};
use crate::geometry::Homography;
use crate::geometry::linear::solve;
use crate::image::Image;
use crate::job::Job;
use crate::maths;
use glam::DVec2;

/// Minimum number of marks: fewer marks could agree by coincidence.
const MIN_MARKS: usize = 6;
/// Maximum distance between a candidate and the position that a map predicts for its mark, as a share of `extent` (the
/// larger distance between opposite corner marks). The first tolerance is for the map through four candidates, the
/// final one for the least-squares map. [bench constants:sheet]
const FIRST_TOLERANCE: f64 = 0.02;
const FINAL_TOLERANCE: f64 = 0.004;

/// Half-side of the square window in which a mark is refined: `WINDOW` times the mark's radius, but at least
/// `MIN_WINDOW` pixels. Any `WINDOW` up to 1/√2 = 0.7 serves, because the corners of the window then lie inside the
/// mark. [convention]
const WINDOW: f64 = 0.6;
const MIN_WINDOW: f64 = 2.0;

pub struct Fit {
    /// Maps pixels of the page to pixels of the photo.
    pub to_photo: Homography,
    /// Indices in [`Page::marks`] of the marks used.
    pub marks: Vec<usize>,
    /// Root mean square distance between marks and their predicted positions, in pixels of the photo.
    pub residual: f64,
    /// Photo pixels per page pixel, along the longer of the two diagonals between opposite corner marks in the photo.
    pub scale: f64,
}

pub fn fit(page: &Page, grey: &Image, candidates: &[Candidate], job: Job) -> Result<Fit> {
    let first = guess(page, candidates, job)?;
    let found = first.ok_or_else(|| too_few(candidates.len()))?;

    // Refine each mark to sub-pixel precision, in a window inside the mark.
    let mut pairs = Vec::new();
    for (mark, at) in found.pairs {
        let centre = page.marks[mark];
        let length_in_photo =
            |step: DVec2| found.map.apply(centre + step * page.radius).distance(found.map.apply(centre));
        let radius = (WINDOW * length_in_photo(DVec2::X).min(length_in_photo(DVec2::Y))).max(MIN_WINDOW);
        if let Some(at) = refine(grey, at, radius) {
            pairs.push((mark, at));
        }
    }
    let extent = extent(page, &found.map);
    let mut map = least_squares(page, found.map, &pairs);
    // Discard marks that lie farther than the final tolerance from their predicted positions.
    pairs.retain(|&(mark, at)| map.apply(page.marks[mark]).distance(at) < FINAL_TOLERANCE * extent);
    if pairs.len() < MIN_MARKS {
        return Err(too_few(pairs.len()));
    }
    map = least_squares(page, map, &pairs);
    let squares: f64 = pairs.iter().map(|&(m, at)| map.apply(page.marks[m]).distance_squared(at)).sum();
    let residual = (squares / pairs.len() as f64).sqrt();
    let scale = extent / page.marks[0].distance(page.marks[2]);
    Ok(Fit { to_photo: map, marks: pairs.iter().map(|p| p.0).collect(), residual, scale })
}

fn too_few(count: usize) -> Error {
    Error::degenerate(format!(
        "{count} places look like alignment marks, and no six of them are arranged as on the sheet; photograph the \
         whole sheet, flat and sharp, and give the paper size it was printed with"
    ))
}

/// Returns the larger of the two distances between opposite corner marks in the photo, in pixels.
fn extent(page: &Page, map: &Homography) -> f64 {
    let [a, b, c, d] = [0, 1, 2, 3].map(|m| map.apply(page.marks[m]));
    a.distance(c).max(b.distance(d))
}

struct Guess {
    map: Homography,
    pairs: Vec<(usize, DVec2)>,
    misfit: f64,
}

/// Finds the map from page to photo. Tries every quadruple of candidates as the four corner marks and as the four
/// midpoint marks, each in four rotations; if one mark is missing, the corners or the midpoints are still complete.
/// Returns the map under which most marks coincide with candidates; of maps with equal numbers, the map with the
/// smallest misfit. `None` if no map makes [`MIN_MARKS`] marks coincide.
fn guess(page: &Page, candidates: &[Candidate], job: Job) -> Result<Option<Guess>> {
    let n = candidates.len();
    let mut best: Option<Guess> = None;
    for a in 0..n {
        job.check()?;
        for b in a + 1..n {
            for c in b + 1..n {
                for d in c + 1..n {
                    let Some(quad) = around([a, b, c, d].map(|i| candidates[i].at)) else { continue };
                    for (first, turn) in (0..8).map(|k| (k / 4 * 4, k % 4)) {
                        let from = [0, 1, 2, 3].map(|i| page.marks[first + i]);
                        let to = [0, 1, 2, 3].map(|i| quad[(i + turn) % 4]);
                        let Ok(map) = Homography::from_corners(from, to) else { continue };
                        let guess = agreement(page, map, candidates);
                        let better = |b: &Guess| (guess.pairs.len(), -guess.misfit) > (b.pairs.len(), -b.misfit);
                        if guess.pairs.len() >= MIN_MARKS && best.as_ref().is_none_or(better) {
                            best = Some(guess);
                        }
                    }
                }
            }
        }
    }
    Ok(best)
}

/// Orders four points clockwise as seen in the photo (y down); `None` if they do not form a convex quadrilateral.
fn around(points: [DVec2; 4]) -> Option<[DVec2; 4]> {
    let centre = points.iter().sum::<DVec2>() / 4.0;
    let mut ordered = points;
    ordered.sort_by(|p, q| maths::angle_of(*p - centre).total_cmp(&maths::angle_of(*q - centre)));
    let turns = |i: usize| {
        let [p, q, r] = [0, 1, 2].map(|k| ordered[(i + k) % 4]);
        (q - p).perp_dot(r - q)
    };
    (0..4).all(|i| turns(i) > 1.0).then_some(ordered)
}

/// Returns the marks whose position, mapped to the photo by `map`, lies near a candidate. `misfit` is the sum of the
/// squared distances between these marks and their candidates.
fn agreement(page: &Page, map: Homography, candidates: &[Candidate]) -> Guess {
    let tolerance = FIRST_TOLERANCE * extent(page, &map);
    let (mut pairs, mut misfit) = (Vec::new(), 0.0);
    for (mark, place) in page.marks.iter().enumerate() {
        let at = map.apply(*place);
        let distance = |c: &&Candidate| c.at.distance(at);
        let nearest = candidates.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(c) = nearest.filter(|c| c.at.distance(at) < tolerance) {
            misfit += c.at.distance_squared(at);
            pairs.push((mark, c.at));
        }
    }
    Guess { map, pairs, misfit }
}

/// Finds the map that minimises the sum of squared distances between the marks and their predicted positions in the
/// photo, by Gauss-Newton steps from `start`.
fn least_squares(page: &Page, start: Homography, pairs: &[(usize, DVec2)]) -> Homography {
    // Scale page coordinates to about [-1, 1], so that the eight parameters have similar magnitude.
    let half = DVec2::new(page.width as f64, page.height as f64) / 2.0;
    let to_unit = glam::DMat3::from_scale(half.recip()) * glam::DMat3::from_translation(-half);
    let mut h = start.0 * to_unit.inverse();
    h *= 1.0 / h.z_axis.z;
    for _ in 0..10 {
        let (mut matrix, mut right) = ([[0.0; 8]; 8], [0.0; 8]);
        for &(mark, at) in pairs {
            let p = (page.marks[mark] - half) / half;
            let q = h * p.extend(1.0);
            let image = q.truncate() / q.z;
            for axis in 0..2 {
                let mut row = [0.0; 8];
                row[3 * axis..3 * axis + 3].copy_from_slice(&(p.extend(1.0) / q.z).to_array());
                row[6] = -image[axis] * p.x / q.z;
                row[7] = -image[axis] * p.y / q.z;
                for i in 0..8 {
                    right[i] += row[i] * (at[axis] - image[axis]);
                    (0..8).for_each(|j| matrix[i][j] += row[i] * row[j]);
                }
            }
        }
        let Some(step) = solve(matrix, right) else { break };
        // The step holds the entries of `h` row by row; the last entry of `h` is fixed to 1.
        for (i, s) in step.iter().enumerate() {
            h.col_mut(i % 3)[i / 3] += s;
        }
    }
    let map = Homography(h * to_unit).rescaled();
    if map.0.is_finite() { map } else { start }
}
