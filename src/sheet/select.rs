//! Chooses which terms the map from page to photo has: as few as the points need.

use super::model::{MAX_DEGREE, MAX_LENS, MapTerms, PageMap, Sighting};
use crate::error::Result;
use crate::job::Job;
use crate::maths;
use glam::DVec2;
use std::f64::consts::FRAC_PI_8;

/// Number of angles of the generators that are tried, from 0 to π. From the best of them, the angle is fitted.
const ANGLES: usize = 8;
/// Number of maps whose angle is fitted.
const TURNED: usize = 4;
/// A set of terms is only considered if the coordinates of the points are at least this many more than its parameters.
const MIN_REST: usize = 5;
/// The points determine a set of terms if the variance of its map, in the mean over the places, is at most this many
/// times the variance of a point. [convention: flat paper with ten marks has about 8 / 20; the value of a set that the
/// marks do not determine has no bound]
const MAX_GAIN: f64 = 4.0;
/// A set of terms is fitted if its criterion is expected to exceed that of flat paper by less than this: a set that
/// exceeds it by more has a share below 1 in 1,000 of the probability of flat paper. [convention: 2 ln 1000]
const MAX_EXCESS: f64 = 14.0;
/// Standard deviation, in pixels of the photo, below which errors of marks are not told from zero: marks blurred by
/// lens and paper are not located better than this. [convention: a fiftieth of a pixel]
pub const MARK_NOISE: f64 = 0.02;

/// A fitted map.
#[derive(Clone, Debug)]
pub struct FittedMap {
    pub model: PageMap,
    /// Sum of squared distances between points and predicted positions, in square pixels of the photo.
    pub squares: f64,
    /// Bayesian information criterion (Schwarz 1978), with the correction for few points of Hurvich and Tsai 1989.
    pub criterion: f64,
}

/// Fits maps with all sets of terms that the points can determine. Returns the best one of each degree and number of
/// coefficients of the lens, the one with the smallest criterion first. `flat` is the start of the fits, and `places`
/// are the points of the page for which the map is wanted.
pub fn choose(flat: &PageMap, points: &[Sighting], places: &[DVec2], job: Job) -> Result<Vec<FittedMap>> {
    let coordinates = 2 * points.len();
    let is_determined = |terms: &MapTerms| terms.parameters() + MIN_REST <= coordinates;
    let fit = |model: PageMap| {
        let (model, squares) = model.fit(points);
        let criterion = criterion(&model.terms, squares, coordinates);
        FittedMap { model, squares, criterion }
    };
    let flat = fit(flat.clone());
    let mut all = Vec::new();
    for terms in sets().filter(is_determined) {
        job.check()?;
        let start = flat.model.extended(terms);
        if criterion(&terms, start.expected_squares(points), coordinates) < flat.criterion + MAX_EXCESS {
            all.push(fit(start));
        }
    }
    all.push(flat);
    let mut chosen = distinct(all, points, places);
    for k in 0..TURNED.min(chosen.len()) {
        job.check()?;
        let turned = chosen[k].model.turned();
        if turned.terms.degree > 1 && is_determined(&turned.terms) {
            chosen.push(fit(turned));
        }
    }
    Ok(distinct(chosen, points, places))
}

/// Sorts the maps, the best one first. Leaves out maps that the points do not determine. Of several maps of equal
/// degree and equal number of lens coefficients, keeps the best.
fn distinct(mut all: Vec<FittedMap>, points: &[Sighting], places: &[DVec2]) -> Vec<FittedMap> {
    all.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
    let key = |f: &FittedMap| (f.model.terms.degree, f.model.terms.lens);
    let mut chosen: Vec<FittedMap> = Vec::new();
    for fitted in all {
        let is_new = || chosen.iter().all(|f| key(f) != key(&fitted));
        let is_stable = || fitted.model.gain(points, places).is_some_and(|gain| gain <= MAX_GAIN);
        if is_new() && (fitted.model.terms == MapTerms::FLAT || fitted.criterion.is_finite() && is_stable()) {
            chosen.push(fitted);
        }
    }
    chosen
}

/// All sets of terms except those of flat paper without distortion, at fixed angles.
fn sets() -> impl Iterator<Item = MapTerms> {
    let flat = (1..=MAX_LENS).map(|lens| MapTerms { lens, ..MapTerms::FLAT });
    let bent = (0..ANGLES * (MAX_DEGREE - 1) * (MAX_LENS + 1)).map(|k| MapTerms {
        degree: 2 + k / ANGLES % (MAX_DEGREE - 1),
        angle: FRAC_PI_8 * (k % ANGLES) as f64,
        is_turned: false,
        lens: k / ANGLES / (MAX_DEGREE - 1),
    });
    flat.chain(bent)
}

/// The criterion of a fit; infinite if the fit failed.
fn criterion(terms: &MapTerms, squares: f64, coordinates: usize) -> f64 {
    let n = coordinates as f64;
    let criterion = n * maths::ln(squares / n + MARK_NOISE * MARK_NOISE) + penalty(terms.parameters(), coordinates);
    if criterion.is_finite() { criterion } else { f64::INFINITY }
}

/// The part of the criterion that grows with the number of parameters.
pub fn penalty(parameters: usize, coordinates: usize) -> f64 {
    let (n, p) = (coordinates as f64, parameters as f64);
    p * maths::ln(n) + 2.0 * p * (p + 1.0) / (n - p - 1.0).max(1.0)
}
