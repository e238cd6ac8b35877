//! The part of the map from page to photo that the model cannot hold, such as waves and creases of the
//! paper: a smooth random field of displacements with unknown strength and length (universal kriging; Rasmussen and
//! Williams 2006, §2.7). Its strength and length are found from the residuals of the points; it corrects the map near
//! the points, and its standard deviation elsewhere is the error of the map.

use super::dense::{Cholesky, dot};
use super::model::{PageMap, Sighting};
use super::select::{self, FittedMap, MARK_NOISE};
use crate::maths;
use glam::DVec2;

/// Lengths over which displacements are alike, in units of half the page's longer side, and standard deviations of the
/// field, in units of the noise of the points. Errors are means over all pairs and models, by their probability.
/// [convention: from the distance of neighbouring points to the page, and from nothing to paper that is crumpled hard]
const LENGTHS: [f64; 4] = [0.2, 0.4, 0.8, 1.6];
const STRENGTHS: [f64; 9] = [0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0];
/// Power of the probabilities. Real paper has not quite the covariance assumed, so a model that fits better by chance
/// gets too much probability. [bench constants:bent]
const TEMPER: f64 = 0.5;
/// Factor of the variance of the field away from the points: models with many terms follow a part of the field at the
/// points, which then looks weaker than it is. [bench constants:bent]
const UNSEEN: f64 = 2.0;
/// Pairs and models whose probability has a logarithm that is lower than that of the best by more than this are left
/// out: their share is below 1 in 20,000. [rounding]
const IMPROBABLE: f64 = 20.0;
/// The noise of the points is estimated as if this many more coordinates had been measured, with the noise
/// `MARK_NOISE`. [convention: few against the coordinates of ten marks]
const PRIOR_COUNT: f64 = 4.0;

/// A model with the smooth field of displacements in the photo.
pub struct ReliefMap {
    model: PageMap,
    /// Changes of the values of the model, which is linear in them, and weights of the points; empty if the field is 0.
    changes: Vec<f64>,
    weights: Vec<DVec2>,
    at: Vec<DVec2>,
    length: f64,
}

impl ReliefMap {
    /// Maps a pixel of the page to a pixel of the photo.
    pub fn apply(&self, page: DVec2) -> DVec2 {
        let at = self.model.apply(page);
        if self.weights.is_empty() {
            return at;
        }
        let p = unit(page, &self.model);
        let near = self.at.iter().zip(&self.weights).map(|(at, w)| *w * likeness(p.distance(*at), self.length));
        let changed = self.model.derivatives(page).into_iter().zip(&self.changes).map(|(d, change)| d * *change);
        at + near.sum::<DVec2>() + changed.sum::<DVec2>()
    }
}

fn unit(page: DVec2, model: &PageMap) -> DVec2 {
    (page - model.units.page_centre) / model.units.page_unit
}

/// Correlation of the displacements of two places (Matérn, with ν = 5/2: fields that can be differentiated twice).
fn likeness(distance: f64, length: f64) -> f64 {
    let a = 5.0f64.sqrt() * distance / length;
    (1.0 + a + a * a / 3.0) * maths::exp(-a)
}

/// The points and places for a fitted model, linear in the changes of its values.
struct Problem {
    at: Vec<DVec2>,
    /// For each coordinate of the photo: the residuals of the points; and for each value the derivatives of the points.
    residuals: [Vec<f64>; 2],
    derivatives: [Vec<Vec<f64>>; 2],
    /// The places, their positions in the photo by the model, and the derivatives there.
    places: Vec<DVec2>,
    mapped: Vec<DVec2>,
    at_places: Vec<Vec<DVec2>>,
    /// Divisors of the values, which give all derivatives the same norm.
    scales: Vec<f64>,
}

/// The result for one model, length and strength.
struct Outcome {
    /// Index of the model.
    model: usize,
    length: f64,
    power: f64,
    /// Logarithm of the probability, up to a constant.
    probability: f64,
    /// Variance of the noise.
    noise: f64,
    changes: Vec<f64>,
    /// For each coordinate of the photo: the residuals after the changes, and the derivatives, both made independent.
    rest: [Vec<f64>; 2],
    derivatives: [Vec<Vec<f64>>; 2],
    /// Factors of the covariance of the points, in units of the noise, and of the normal equations of the changes.
    covariance: Cholesky,
    normal: Cholesky,
}

/// Estimates the field with each of the models. Returns the most probable map, and at each of `places`, in pixels of
/// the page, the variance of the distance between true and estimated position, in square pixels of the photo. `None` if
/// the points determine no model.
pub fn estimate(models: &[FittedMap], points: &[Sighting], places: &[DVec2]) -> Option<(ReliefMap, Vec<f64>)> {
    let problems: Vec<Problem> = models.iter().map(|fitted| Problem::new(&fitted.model, points, places)).collect();
    let mut outcomes: Vec<Outcome> = Vec::new();
    for (model, problem) in problems.iter().enumerate() {
        let pairs = LENGTHS.iter().flat_map(|&length| STRENGTHS.iter().map(move |&strength| (length, strength)));
        // Without strength, all lengths are the same.
        let pairs = pairs.filter(|&(length, strength)| strength > 0.0 || length == LENGTHS[0]);
        outcomes.extend(pairs.filter_map(|(length, strength)| problem.solve(model, length, strength * strength)));
    }
    let best = outcomes.iter().max_by(|a, b| a.probability.total_cmp(&b.probability))?;
    let (problem, model) = (&problems[best.model], &models[best.model].model);
    let found: Vec<(DVec2, f64)> = (0..places.len()).map(|i| problem.predict(best, i)).collect();
    let (mut variance, mut total) = (vec![0.0; places.len()], 0.0);
    for outcome in outcomes.iter().filter(|o| o.probability > best.probability - IMPROBABLE) {
        let share = maths::exp(TEMPER * (outcome.probability - best.probability));
        total += share;
        for (i, sum) in variance.iter_mut().enumerate() {
            let (mean, own) = problems[outcome.model].predict(outcome, i);
            *sum += share * (own + mean.distance_squared(found[i].0));
        }
    }
    // With few points the variance itself is uncertain. This is the ratio of the 97.5 % quantiles of Student's
    // distribution and of the normal distribution, to first order in 1 / freedom.
    let freedom = 2.0 * points.len() as f64 - model.values.len() as f64 + PRIOR_COUNT;
    let wider = maths::powi(1.0 + QUANTILE / freedom, 2);
    variance.iter_mut().for_each(|v| *v *= wider / total);
    let mut weights = Vec::new();
    if best.power > 0.0 {
        let [x, y] = [0, 1].map(|axis: usize| best.covariance.backward(&best.rest[axis]));
        weights.extend(x.iter().zip(&y).map(|(x, y)| best.power * DVec2::new(*x, *y)));
    }
    let changes = best.changes.iter().zip(&problem.scales).map(|(c, s)| c / s).collect();
    let map = ReliefMap { model: model.clone(), changes, weights, at: problem.at.clone(), length: best.length };
    Some((map, variance))
}

/// (z² + 1) / 4 for the 97.5 % quantile z of the normal distribution. [convention: exact]
const QUANTILE: f64 = 1.21;

impl Problem {
    fn new(model: &PageMap, points: &[Sighting], places: &[DVec2]) -> Self {
        let off: Vec<DVec2> = points.iter().map(|p| p.photo - model.apply(p.page)).collect();
        let rows: Vec<Vec<DVec2>> = points.iter().map(|p| model.derivatives(p.page)).collect();
        let count = model.values.len();
        let norm = |i: usize| rows.iter().map(|row| row[i].length_squared()).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        let scales: Vec<f64> = (0..count).map(norm).collect();
        let column = |axis: usize, i: usize| rows.iter().map(|row| row[i][axis] / scales[i]).collect();
        Self {
            at: points.iter().map(|p| unit(p.page, model)).collect(),
            residuals: [0, 1].map(|axis| off.iter().map(|o| o[axis]).collect()),
            derivatives: [0, 1].map(|axis| (0..count).map(|i| column(axis, i)).collect()),
            places: places.iter().map(|p| unit(*p, model)).collect(),
            mapped: places.iter().map(|p| model.apply(*p)).collect(),
            at_places: places
                .iter()
                .map(|p| model.derivatives(*p).iter().zip(&scales).map(|(d, s)| *d / *s).collect())
                .collect(),
            scales,
        }
    }

    /// Fits the changes of the values with the given length, and variance of the field relative to the noise.
    fn solve(&self, model: usize, length: f64, power: f64) -> Option<Outcome> {
        let (n, p) = (self.at.len(), self.scales.len());
        let entry =
            |k: usize| power * likeness(self.at[k / n].distance(self.at[k % n]), length) + f64::from(k / n == k % n);
        let covariance = Cholesky::new(n, (0..n * n).map(entry).collect())?;
        let white = |rows: &[Vec<f64>]| rows.iter().map(|row| covariance.forward(row)).collect::<Vec<_>>();
        let derivatives = [0, 1].map(|axis: usize| white(&self.derivatives[axis]));
        let residuals = [0, 1].map(|axis: usize| covariance.forward(&self.residuals[axis]));
        let normal = products(&derivatives)?;
        let right: Vec<f64> = (0..p).map(|i| (0..2).map(|c| dot(&derivatives[c][i], &residuals[c])).sum()).collect();
        let changes = normal.solve(&right);
        let rest = [0, 1].map(|axis: usize| {
            let mut rest = residuals[axis].clone();
            for (row, change) in derivatives[axis].iter().zip(&changes) {
                rest.iter_mut().zip(row).for_each(|(r, d)| *r -= d * change);
            }
            rest
        });
        let squares = dot(&rest[0], &rest[0]) + dot(&rest[1], &rest[1]) + PRIOR_COUNT * MARK_NOISE * MARK_NOISE;
        let logarithms = |factor: &Cholesky| factor.diagonal().map(maths::ln).sum::<f64>();
        // The values have the prior of unit information, with which the logarithm of the probability is Schwarz's
        // criterion, divided by -2, if the points are independent.
        let probability = -0.5 * (2.0 * n as f64 + PRIOR_COUNT) * maths::ln(squares)
            - 2.0 * logarithms(&covariance)
            - logarithms(&normal)
            + logarithms(&products(&self.derivatives)?)
            - 0.5 * select::penalty(p, 2 * n);
        let noise = squares / (2.0 * n as f64 - p as f64 + PRIOR_COUNT);
        let outcome =
            Outcome { model, length, power, probability, noise, changes, rest, derivatives, covariance, normal };
        probability.is_finite().then_some(outcome)
    }

    /// Returns mean and variance of the position of a place in the photo.
    fn predict(&self, from: &Outcome, place: usize) -> (DVec2, f64) {
        let (at, rows) = (self.places[place], &self.at_places[place]);
        let near: Vec<f64> = self.at.iter().map(|p| from.power * likeness(at.distance(*p), from.length)).collect();
        let near = from.covariance.forward(&near);
        let (mut mean, mut variance) = (self.mapped[place], 2.0 * UNSEEN * (from.power - dot(&near, &near)));
        for axis in 0..2 {
            let open: Vec<f64> =
                rows.iter().zip(&from.derivatives[axis]).map(|(row, d)| row[axis] - dot(d, &near)).collect();
            let open = from.normal.forward(&open);
            variance += dot(&open, &open);
            let changes = rows.iter().zip(&from.changes).map(|(row, change)| row[axis] * change);
            mean[axis] += dot(&near, &from.rest[axis]) + changes.sum::<f64>();
        }
        (mean, from.noise * variance.max(0.0))
    }
}

/// Factorises the matrix of the products of the rows, summed over both coordinates.
fn products(rows: &[Vec<Vec<f64>>; 2]) -> Option<Cholesky> {
    let p = rows[0].len();
    let product = |k: usize| (0..2).map(|c| dot(&rows[c][k / p], &rows[c][k % p])).sum();
    Cholesky::new(p, (0..p * p).map(product).collect())
}
