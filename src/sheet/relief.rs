//! The part of the map from page to photo that the model cannot hold, such as waves and creases of the paper: a smooth
//! random field of displacements with unknown strength and length (universal kriging; Rasmussen and Williams 2006,
//! §2.7). Its strength and length are found from the residuals of the points; it corrects the map near the points, and
//! its standard deviation elsewhere is the error of the map.

use super::dense::{Cholesky, dot};
use super::model::{Linearised, PageMap, Sighting};
use super::select::{self, FittedMap, MARK_NOISE};
use crate::maths;
use glam::DVec2;

/// Lengths over which displacements are alike, in units of half the page's longer side, and standard deviations of the
/// field, in units of the noise of the points. Errors are means over all pairs and models, by their probability.
/// [convention: from the distance of neighbouring points to the page, and from nothing to paper that is crumpled hard]
const LENGTHS: [f64; 4] = [0.2, 0.4, 0.8, 1.6];
const STRENGTHS: [f64; 9] = [0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0];
/// Power of the probabilities. Real paper has not quite the covariance assumed, so a model that fits better by chance
/// gets too much probability. The bench prints photos other than those for which the value was chosen. [bench
/// constants:bent]
const TEMPER: f64 = 0.5;
/// Factor of the variance of the field away from the points: models with many terms follow a part of the field at the
/// points, which then looks weaker than it is. Without it, the error of paper that is crumpled hard is covered too
/// seldom. [bench constants:bent]
const UNSEEN: f64 = 2.0;
/// Pairs and models whose probability has a logarithm that is lower than that of the best by more than this are left
/// out: their share is below 1 in 20,000. [rounding]
const IMPROBABLE: f64 = 20.0;
/// The noise of the points is estimated as if this many more coordinates had been measured, with the noise
/// `MARK_NOISE`. [convention: few against the coordinates of ten marks]
const PRIOR_COUNT: f64 = 4.0;

/// (z² + 1) / 4 for the 97.5 % quantile z of the normal distribution. [convention: exact]
const QUANTILE: f64 = 1.21;

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
        if self.weights.is_empty() {
            return self.model.apply(page);
        }
        let here = self.model.linearised(page);
        let p = unit(page, &self.model);
        let near = self.at.iter().zip(&self.weights).map(|(at, w)| *w * likeness(p.distance(*at), self.length));
        let changed = here.derivatives().iter().zip(&self.changes).map(|(d, change)| *d * *change);
        here.at + near.sum::<DVec2>() + changed.sum::<DVec2>()
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

/// Estimates the field with each of the models. Returns the most probable map, and at each of `places`, in pixels of
/// the page, the variance of the distance between true and estimated position, in square pixels of the photo. `None` if
/// the points determine no model.
pub fn estimate(models: &[FittedMap], points: &[Sighting], places: &[DVec2]) -> Option<(ReliefMap, Vec<f64>)> {
    let model = &models.first()?.model;
    let in_units = |p: DVec2| unit(p, model);
    let at: Vec<DVec2> = points.iter().map(|p| in_units(p.page)).collect();
    let wanted: Vec<DVec2> = places.iter().map(|p| in_units(*p)).collect();
    let fields = fields(&at);
    let problems: Vec<Problem> = models.iter().filter_map(|f| Problem::new(&f.model, points, places)).collect();
    let all = problems.iter().flat_map(|problem| fields.iter().map(move |field| (problem, field)));
    let outcomes: Vec<Outcome> = all.filter_map(|(problem, field)| Outcome::new(problem, field)).collect();
    let best = outcomes.iter().max_by(|a, b| a.probability.total_cmp(&b.probability))?;
    let found = best.predict(&Near::new(best.field, &at, &wanted));

    let (mut variance, mut total) = (vec![0.0; places.len()], 0.0);
    for field in &fields {
        let is_probable = |o: &&Outcome| std::ptr::eq(o.field, field) && o.probability > best.probability - IMPROBABLE;
        let mut probable = outcomes.iter().filter(is_probable).peekable();
        let near = probable.peek().map(|_| Near::new(field, &at, &wanted));
        for (outcome, near) in probable.zip(near.iter().cycle()) {
            let share = maths::exp(TEMPER * (outcome.probability - best.probability));
            total += share;
            for ((sum, (mean, own)), (best, _)) in variance.iter_mut().zip(outcome.predict(near)).zip(&found) {
                *sum += share * (own + mean.distance_squared(*best));
            }
        }
    }
    // With few points the variance itself is uncertain. This is the ratio of the 97.5 % quantiles of Student's
    // distribution and of the normal distribution, to first order in 1 / freedom.
    let freedom = 2.0 * points.len() as f64 - best.problem.values() as f64 + PRIOR_COUNT;
    let wider = maths::powi(1.0 + QUANTILE / freedom, 2);
    variance.iter_mut().for_each(|v| *v *= wider / total);
    Some((best.map(at), variance))
}

/// The field with one length and strength.
struct Field {
    length: f64,
    /// Variance in units of the noise of the points.
    power: f64,
    /// Factor of the covariance of the points, in units of the noise.
    covariance: Cholesky,
}

/// Returns the fields of all lengths and strengths, for points at the given positions.
fn fields(at: &[DVec2]) -> Vec<Field> {
    let n = at.len();
    let mut fields = Vec::new();
    for length in LENGTHS {
        let alike: Vec<f64> = (0..n * n)
            .map(|k| if k % n > k / n { 0.0 } else { likeness(at[k / n].distance(at[k % n]), length) })
            .collect();
        // Without strength, all lengths are the same.
        for strength in STRENGTHS.into_iter().filter(|&strength| strength > 0.0 || length == LENGTHS[0]) {
            let power = strength * strength;
            let entry = |(k, alike): (usize, &f64)| power * alike + f64::from(k / n == k % n);
            if let Some(covariance) = Cholesky::new(n, alike.iter().enumerate().map(entry).collect()) {
                fields.push(Field { length, power, covariance });
            }
        }
    }
    fields
}

/// What the points tell of a field at the places.
struct Near {
    /// For each point a row with the covariances with the places, made independent.
    rows: Vec<f64>,
    /// The variance that is left at each place.
    rest: Vec<f64>,
}

impl Near {
    fn new(field: &Field, at: &[DVec2], places: &[DVec2]) -> Self {
        let covariance = |p: &DVec2, place: &DVec2| field.power * likeness(p.distance(*place), field.length);
        let mut rest = vec![field.power; places.len()];
        if field.power == 0.0 {
            return Self { rows: vec![0.0; at.len() * places.len()], rest };
        }
        let mut rows: Vec<f64> = at.iter().flat_map(|p| places.iter().map(move |place| covariance(p, place))).collect();
        field.covariance.forward_all(&mut rows);
        for row in rows.chunks_exact(places.len()) {
            rest.iter_mut().zip(row).for_each(|(rest, v)| *rest -= v * v);
        }
        Self { rows, rest }
    }
}

/// The points and places for a fitted model, linear in the changes of its values.
struct Problem<'a> {
    model: &'a PageMap,
    /// For each point a row: for each coordinate of the photo the derivatives by the values, then the residual.
    rows: Vec<f64>,
    /// The positions of the places in the photo by the model; and for each coordinate of the photo and each value a row
    /// with the derivatives at the places.
    mapped: Vec<DVec2>,
    at_places: [Vec<f64>; 2],
    /// Divisors of the values, which give all derivatives the same norm.
    scales: Vec<f64>,
    /// Logarithm of the root of the determinant of the normal equations without a field.
    information: f64,
}

impl<'a> Problem<'a> {
    /// `None` if the points do not determine the model.
    fn new(model: &'a PageMap, points: &[Sighting], places: &[DVec2]) -> Option<Self> {
        let at_points: Vec<Linearised> = points.iter().map(|p| model.linearised(p.page)).collect();
        let norm = |i: usize| at_points.iter().map(|l| l.derivatives()[i].length_squared()).sum::<f64>().sqrt();
        let scales: Vec<f64> = (0..model.values.len()).map(|i| norm(i).max(f64::MIN_POSITIVE)).collect();
        let mut rows = Vec::new();
        for (point, linearised) in points.iter().zip(&at_points) {
            for axis in 0..2 {
                rows.extend(linearised.derivatives().iter().zip(&scales).map(|(d, scale)| d[axis] / scale));
                rows.push(point.photo[axis] - linearised.at[axis]);
            }
        }
        let linearised: Vec<Linearised> = places.iter().map(|p| model.linearised(*p)).collect();
        let row = |axis: usize, i: usize| linearised.iter().map(move |l| l.derivatives()[i][axis]);
        let at_places = [0, 1].map(|axis: usize| {
            scales.iter().enumerate().flat_map(|(i, scale)| row(axis, i).map(move |d| d / scale)).collect()
        });
        let information = logarithm(&Equations::new(&rows, scales.len())?.normal);
        let mapped = linearised.iter().map(|l| l.at).collect();
        Some(Self { model, rows, mapped, at_places, scales, information })
    }

    /// Number of values.
    fn values(&self) -> usize {
        self.scales.len()
    }
}

/// The normal equations of a problem.
struct Equations {
    normal: Cholesky,
    right: Vec<f64>,
    /// Sum of the squared residuals without changes.
    squares: f64,
}

impl Equations {
    /// Adds up the normal equations from the `rows` of a [`Problem`]; `count` is the number of its values.
    fn new(rows: &[f64], count: usize) -> Option<Self> {
        let mut products = vec![0.0; (count + 1) * (count + 1)];
        for row in rows.chunks_exact(count + 1) {
            for (i, sums) in products.chunks_exact_mut(count + 1).enumerate() {
                sums.iter_mut().zip(row).for_each(|(sum, v)| *sum += row[i] * v);
            }
        }
        let squares = products.pop()?;
        let right = products.split_off(count * (count + 1));
        let matrix = products.chunks_exact(count + 1).flat_map(|row| &row[..count]).copied().collect();
        Some(Self { normal: Cholesky::new(count, matrix)?, right, squares })
    }
}

/// Returns the logarithm of the root of the determinant.
fn logarithm(factor: &Cholesky) -> f64 {
    factor.diagonal().map(maths::ln).sum()
}

/// The result for one model and field.
struct Outcome<'a> {
    problem: &'a Problem<'a>,
    field: &'a Field,
    /// Logarithm of the probability, up to a constant.
    probability: f64,
    /// Variance of the noise.
    noise: f64,
    /// The rows of the problem, made independent, and the factor of their normal equations.
    rows: Vec<f64>,
    normal: Cholesky,
    changes: Vec<f64>,
}

impl<'a> Outcome<'a> {
    /// Fits the changes of the values.
    fn new(problem: &'a Problem<'a>, field: &'a Field) -> Option<Self> {
        let (count, p) = (problem.rows.len() / (problem.values() + 1), problem.values());
        let mut rows = problem.rows.clone();
        if field.power > 0.0 {
            field.covariance.forward_all(&mut rows);
        }
        let Equations { normal, right, squares } = Equations::new(&rows, p)?;
        let solved = normal.forward(&right);
        let squares = (squares - dot(&solved, &solved)).max(0.0) + PRIOR_COUNT * MARK_NOISE * MARK_NOISE;
        // The values have the prior of unit information, with which the logarithm of the probability is Schwarz's
        // criterion, divided by -2, if the points are independent.
        let probability = -0.5 * (count as f64 + PRIOR_COUNT) * maths::ln(squares)
            - 2.0 * logarithm(&field.covariance)
            - logarithm(&normal)
            + problem.information
            - 0.5 * select::penalty(p, count);
        let noise = squares / (count as f64 - p as f64 + PRIOR_COUNT);
        let changes = normal.backward(&solved);
        probability.is_finite().then_some(Self { problem, field, probability, noise, rows, normal, changes })
    }

    /// Returns the residuals of one coordinate after the changes, made independent.
    fn rest(&self, axis: usize) -> impl Iterator<Item = f64> {
        let p = self.problem.values();
        self.rows.chunks_exact(p + 1).skip(axis).step_by(2).map(move |row| row[p] - dot(&row[..p], &self.changes))
    }

    /// Returns mean and variance of the position of each place in the photo.
    fn predict(&self, near: &Near) -> Vec<(DVec2, f64)> {
        let p = self.problem.values();
        let count = near.rest.len();
        let mut variance: Vec<f64> = near.rest.iter().map(|rest| 2.0 * UNSEEN * rest).collect();
        let mut mean = self.problem.mapped.clone();
        for axis in 0..2 {
            let at_places = &self.problem.at_places[axis];
            for (row, change) in at_places.chunks_exact(count).zip(&self.changes) {
                mean.iter_mut().zip(row).for_each(|(mean, d)| mean[axis] += change * d);
            }
            let mut open = at_places.clone();
            let rows = self.rows.chunks_exact(p + 1).skip(axis).step_by(2);
            for ((row, rest), near) in rows.zip(self.rest(axis)).zip(near.rows.chunks_exact(count)) {
                mean.iter_mut().zip(near).for_each(|(mean, v)| mean[axis] += rest * v);
                for (open, d) in open.chunks_exact_mut(count).zip(row) {
                    open.iter_mut().zip(near).for_each(|(open, v)| *open -= d * v);
                }
            }
            self.normal.forward_all(&mut open);
            for row in open.chunks_exact(count) {
                variance.iter_mut().zip(row).for_each(|(variance, v)| *variance += v * v);
            }
        }
        mean.into_iter().zip(variance).map(|(mean, v)| (mean, self.noise * v.max(0.0))).collect()
    }

    /// Returns the map for points at the given positions.
    fn map(&self, at: Vec<DVec2>) -> ReliefMap {
        let mut weights = Vec::new();
        if self.field.power > 0.0 {
            let [x, y] = [0, 1].map(|axis| self.field.covariance.backward(&self.rest(axis).collect::<Vec<f64>>()));
            weights.extend(x.iter().zip(&y).map(|(x, y)| self.field.power * DVec2::new(*x, *y)));
        }
        let changes = self.changes.iter().zip(&self.problem.scales).map(|(c, s)| c / s).collect();
        ReliefMap { model: self.problem.model.clone(), changes, weights, at, length: self.field.length }
    }
}
