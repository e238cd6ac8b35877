//! Identifies the marks among the candidates, finds the dots, and fits the map from the page to the photo.

use super::detect::{Candidate, is_mark, refine};
use super::dots;
use super::model::{PageMap, Sighting, Units};
use super::page::Page;
use super::relief::{self, ReliefMap};
use super::select::{self, FittedMap};
use crate::error::{Error, Result};
use crate::geometry::Homography;
use crate::geometry::linear::solve;
use crate::geometry::robust::median;
use crate::image::Image;
use crate::job::Job;
use crate::maths;
use glam::DVec2;

/// Minimum number of marks: fewer marks could agree by coincidence.
const MIN_MARKS: usize = 6;
/// The first tolerance if no map agrees with enough candidates. Half of the dots must then be found, as marks may agree
/// by coincidence. [convention: marks of paper that is bent by 4 % of its width, seen from the side]
const BENT_TOLERANCE: f64 = 0.05;
/// With at least `BENT_MARKS` marks within the first tolerance, the sheet may be bent without limit. With one mark
/// less, half of the dots must be found too.
const BENT_MARKS: usize = 9;
/// A point is discarded if its distance from the place that the other points predict is more than this many standard
/// deviations, and more than `MIN_OUTLIER` pixels of the photo. [convention: beyond the reach of noise, also with few
/// points; below the displacement by paint that covers a part of a mark]
const OUTLIER: f64 = 6.0;
const MIN_OUTLIER: f64 = 0.3;
/// Median of the length of a vector of two normal deviates with standard deviation 1: √(2 ln 2). [convention: exact]
const MEDIAN: f64 = 1.177;
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

/// The map from pixels of the page to pixels of the photo.
pub struct Fit {
    map: ReliefMap,
    /// Indices in [`Page::marks`] of the marks used.
    pub marks: Vec<usize>,
    /// Number of dots used.
    pub dots: usize,
    /// Root mean square distance between marks and dots and the positions that the model without relief predicts, in
    /// pixels of the photo.
    pub residual: f64,
    /// Variance of the distance between true and estimated position, in square pixels of the photo, at each place.
    pub variance: Vec<f64>,
}

impl Fit {
    pub fn apply(&self, page: DVec2) -> DVec2 {
        self.map.apply(page)
    }
}

/// A mark or a dot in the photo, with its index on the page.
#[derive(Clone, Copy)]
enum Which {
    Mark(usize),
    Dot,
}

/// Fits the map. `places` are the points of the page whose errors are wanted.
pub fn fit(page: &Page, grey: &Image, candidates: &[Candidate], places: &[DVec2], job: Job) -> Result<Fit> {
    let (found, is_near) = match guess(page, candidates, FIRST_TOLERANCE, job.part(0.0, 0.2))? {
        Some(found) => (found, true),
        None => (
            guess(page, candidates, BENT_TOLERANCE, job.part(0.2, 0.5))?.ok_or_else(|| too_few(candidates.len()))?,
            false,
        ),
    };
    let pairs = refined(page, grey, &found);
    let job = job.part(0.5, 1.0);

    // A flat sheet: discard marks that lie farther than the final tolerance from their predicted positions.
    let tolerance = FINAL_TOLERANCE * extent(page, &found.map);
    let homography = |start: Homography, pairs: &[(usize, DVec2)]| {
        let pairs: Vec<_> = pairs.iter().map(|&(mark, at)| (page.marks[mark], at)).collect();
        least_squares(0.5 * DVec2::new(page.width as f64, page.height as f64), start, &pairs)
    };
    let flat = homography(found.map, &pairs);
    let mut near = pairs.clone();
    near.retain(|&(mark, at)| flat.apply(page.marks[mark]).distance(at) < tolerance);
    let is_flat = near.len() >= MIN_MARKS;
    let may_bend = pairs.len() + 1 >= BENT_MARKS || !is_near;
    let used = match (may_bend, is_flat) {
        (true, _) => &pairs,
        (false, true) => &near,
        (false, false) => return Err(too_few(near.len())),
    };
    let start = flat_model(page, grey, &homography(flat, used)).ok_or_else(|| too_few(used.len()))?;

    let mut points: Vec<(Which, Sighting)> =
        used.iter().map(|&(mark, at)| (Which::Mark(mark), Sighting { page: page.marks[mark], photo: at })).collect();
    let mut best = robust(&start, &mut points, places, job.part(0.0, 0.3))?;
    for round in 0..2 {
        if let Some(best) = best.first() {
            add_marks(page, grey, &best.model, &mut points);
            add_dots(page, grey, &best.model, &mut points);
        }
        best =
            robust(&start, &mut points, places, job.part(0.3 + 0.3 * f64::from(round), 0.6 + 0.3 * f64::from(round)))?;
    }
    finish(page, &points, &best, places, is_near.then_some(is_flat))
}

/// Refines each mark to sub-pixel precision, in a window inside the mark.
fn refined(page: &Page, grey: &Image, found: &Guess) -> Vec<(usize, DVec2)> {
    let refined = found.pairs.iter().filter_map(|&(mark, at)| {
        let centre = page.marks[mark];
        let length_in_photo =
            |step: DVec2| found.map.apply(centre + step * page.radius).distance(found.map.apply(centre));
        let radius = (WINDOW * length_in_photo(DVec2::X).min(length_in_photo(DVec2::Y))).max(MIN_WINDOW);
        refine(grey, at, radius).map(|at| (mark, at))
    });
    refined.collect()
}

fn flat_model(page: &Page, grey: &Image, map: &Homography) -> Option<PageMap> {
    let (page_size, photo_size) =
        (DVec2::new(page.width as f64, page.height as f64), DVec2::new(grey.width as f64, grey.height as f64));
    let units = Units {
        page_centre: 0.5 * page_size,
        page_unit: 0.5 * page_size.max_element(),
        photo_centre: 0.5 * photo_size,
        photo_unit: 0.5 * photo_size.length(),
    };
    PageMap::flat(units, &map.0)
}

/// Chooses and fits the models, and discards outliers, until there are none.
fn robust(start: &PageMap, points: &mut Vec<(Which, Sighting)>, places: &[DVec2], job: Job) -> Result<Vec<FittedMap>> {
    let fewest = points.len() - points.len() / 4;
    loop {
        let found = select::choose(start, &sightings(points), places, job)?;
        let count = points.len();
        if let Some(best) = found.first() {
            discard(&best.model, points, fewest);
        }
        if points.len() == count {
            return Ok(found);
        }
    }
}

/// Discards outliers, the farthest first, but leaves at least `fewest` points.
fn discard(model: &PageMap, points: &mut Vec<(Which, Sighting)>, fewest: usize) {
    let mut model = model.clone();
    while points.len() > fewest {
        let all = sightings(points);
        model = model.fit(&all).0;
        let Some(distances) = model.left_out(&all) else { return };
        // Unlike the mean, the median does not grow with the outliers.
        let limit = (OUTLIER * median(distances.clone()) / MEDIAN).max(MIN_OUTLIER);
        match distances.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)) {
            Some((farthest, distance)) if *distance > limit => points.remove(farthest),
            _ => return,
        };
    }
}

fn sightings(points: &[(Which, Sighting)]) -> Vec<Sighting> {
    points.iter().map(|p| p.1).collect()
}

/// Adds the marks that only the map of the bent sheet predicts well enough.
fn add_marks(page: &Page, grey: &Image, model: &PageMap, points: &mut Vec<(Which, Sighting)>) {
    let is_used = |mark: usize| points.iter().any(|p| matches!(p.0, Which::Mark(used) if used == mark));
    let missing: Vec<usize> = (0..page.marks.len()).filter(|&mark| !is_used(mark)).collect();
    for mark in missing {
        let place = page.marks[mark];
        let at = model.apply(place);
        let length = |step: DVec2| model.apply(place + page.radius * step).distance(at);
        let radius = length(DVec2::X).min(length(DVec2::Y));
        let size = DVec2::new(grey.width as f64, grey.height as f64);
        if !(at.cmpgt(DVec2::splat(radius)).all() && at.cmplt(size - radius).all()) {
            continue;
        }
        let found = refine(grey, at, (WINDOW * radius).max(MIN_WINDOW));
        if let Some(photo) = found.filter(|&photo| is_mark(grey, photo, radius)) {
            points.push((Which::Mark(mark), Sighting { page: place, photo }));
        }
    }
}

/// Searches all dots anew by the map. If fewer than a third are found, the sheet has none.
fn add_dots(page: &Page, grey: &Image, model: &PageMap, points: &mut Vec<(Which, Sighting)>) {
    points.retain(|p| matches!(p.0, Which::Mark(_)));
    let found: Vec<(Which, Sighting)> = page
        .dots
        .iter()
        .filter_map(|&dot| {
            let photo = dots::find(grey, page, dot, model)?;
            Some((Which::Dot, Sighting { page: dot, photo }))
        })
        .collect();
    if 3 * found.len() >= page.dots.len() {
        points.extend(found);
    }
}

/// Checks that the points suffice, and adds the relief. `is_flat` says whether the marks fit flat paper; `None` if they
/// are only where a bent sheet may have them.
fn finish(
    page: &Page,
    points: &[(Which, Sighting)],
    models: &[FittedMap],
    places: &[DVec2],
    is_flat: Option<bool>,
) -> Result<Fit> {
    let marks: Vec<usize> = points
        .iter()
        .filter_map(|p| match p.0 {
            Which::Mark(mark) => Some(mark),
            Which::Dot => None,
        })
        .collect();
    let dots = points.len() - marks.len();
    let are_dots_seen = !page.dots.is_empty() && 2 * dots >= page.dots.len();
    if marks.len() < MIN_MARKS
        || !(are_dots_seen || is_flat.is_some_and(|is_flat| is_flat || marks.len() >= BENT_MARKS))
    {
        return Err(too_few(marks.len()));
    }
    let (map, variance) = relief::estimate(models, &sightings(points), places).ok_or_else(|| too_few(marks.len()))?;
    let squares = models.first().map_or(0.0, |best| best.squares);
    let residual = (squares / points.len() as f64).sqrt();
    Ok(Fit { map, marks, dots, residual, variance })
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
fn guess(page: &Page, candidates: &[Candidate], tolerance: f64, job: Job) -> Result<Option<Guess>> {
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
                        let guess = agreement(page, map, candidates, tolerance);
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
fn agreement(page: &Page, map: Homography, candidates: &[Candidate], tolerance: f64) -> Guess {
    let tolerance = tolerance * extent(page, &map);
    let (mut pairs, mut misfit): (Vec<(usize, DVec2)>, f64) = (Vec::new(), 0.0);
    for (mark, place) in page.marks.iter().enumerate() {
        let at = map.apply(*place);
        let distance = |c: &&Candidate| c.at.distance(at);
        let nearest = candidates.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        // A map with its horizon on the page moves many marks to one candidate, which can be only one of them.
        let is_free = |c: &&Candidate| pairs.iter().all(|&(_, used)| used != c.at);
        if let Some(c) = nearest.filter(|c| c.at.distance(at) < tolerance).filter(is_free) {
            misfit += c.at.distance_squared(at);
            pairs.push((mark, c.at));
        }
    }
    Guess { map, pairs, misfit }
}

/// Finds the homography that minimises the sum of squared distances between mapped and given points, by Gauss-Newton
/// steps from `start`. `half` is half the size of the area in which the points lie.
pub fn least_squares(half: DVec2, start: Homography, pairs: &[(DVec2, DVec2)]) -> Homography {
    // Scale coordinates to about [-1, 1], so that the eight parameters have similar magnitude.
    let to_unit = glam::DMat3::from_scale(half.recip()) * glam::DMat3::from_translation(-half);
    let mut h = start.0 * to_unit.inverse();
    h *= 1.0 / h.z_axis.z;
    for _ in 0..10 {
        let (mut matrix, mut right) = ([[0.0; 8]; 8], [0.0; 8]);
        for &(from, at) in pairs {
            let p = (from - half) / half;
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
