//! Which model, on which features, and how far to trust it: cross-validation, and calibration on what was held out.
//!
//! Two questions, two ways to hold out. Parts of strokes: how well does the model do on what the user has painted? Whole
//! strokes: how well does it carry on to what the user has not? Each has its own error and its own calibration, and
//! every pixel is given the mix of both that its distance from the strokes asks for.

use super::Model;
use super::logistic::{self, Problem};
use super::samples::{PARTS, Samples};
use super::standardise::{Standard, term_count, terms};
use crate::error::{Error, Result};
use crate::exec;
use crate::image::try_with_capacity;
use crate::job::Job;

/// Most folds; with more strokes than that some are held out together.
const FOLDS: usize = 8;
/// Samples of each class that cross-validation uses: enough to compare two models.
const CV_SAMPLES: usize = 250;
/// Calibration never multiplies logits by more or less than this: a handful of strokes cannot tell.
const CALIBRATION: [f64; 2] = [0.1, 2.0];
/// Gain in mean log loss below which a fit ends: of those that are compared, and of the one that is used.
const CV_PRECISION: f64 = 1e-5;
const PRECISION: f64 = 1e-9;

/// The classifier, in standardised features, and what is expected of it.
pub struct Chosen {
    pub model: Model,
    /// The samples' columns it looks at.
    pub columns: Vec<usize>,
    /// Of all columns.
    pub standard: Standard,
    /// Weights of the terms (see `standardise::terms`), not calibrated.
    pub weights: Vec<f64>,
    /// Where the features are like those of the strokes.
    pub familiar: Trust,
    /// Where they are not.
    pub unfamiliar: Trust,
    /// For each class the mean and the inverse covariance of its samples, in all standardised features, scaled so that
    /// 99 % of its samples are within distance 1.
    pub seen: Vec<Ellipsoid>,
}

pub struct Ellipsoid {
    pub centre: Vec<f64>,
    /// Row by row.
    pub inverse: Vec<f64>,
}

/// What a kind of cross-validation says.
#[derive(Clone, Copy)]
pub struct Trust {
    /// Share of held-out samples that were wrong, classes and strokes weighing the same.
    pub error: f64,
    /// The factor that calibrates logits.
    pub scale: f64,
    /// Mean log loss of the calibrated held-out samples.
    loss: f64,
}

/// What is asked of the choice.
pub struct Question<'a> {
    pub samples: &'a Samples,
    /// Subsets of the samples' columns to choose from.
    pub subsets: &'a [Vec<usize>],
    /// Features of pixels all over the place that is to be segmented, as `samples.values`.
    pub probe: &'a [f64],
    pub ridge: f64,
}

/// A family of models on a subset of the features: its terms at all samples.
struct Candidate {
    rows: Vec<f64>,
    dimension: usize,
}

/// Where classes and strokes are, and how samples are held out.
struct Trial<'a> {
    samples: &'a Samples,
    /// All features of all samples, standardised.
    x: Vec<f64>,
    positive: Vec<bool>,
    by_part: Vec<usize>,
    by_stroke: Vec<usize>,
    /// Weights of the samples that comparisons use.
    weights: Vec<f64>,
    ridge: f64,
}

/// Chooses the model and the features whose loss over the whole image is expected to be least: the loss on held-out parts
/// of strokes where pixels are like those painted, on whole held-out strokes where they are not, and Akaike's price of a
/// term, one sample's worth, which decides between equals for the simpler one.
pub fn choose(question: &Question, job: Job) -> Result<Chosen> {
    let samples = question.samples;
    let standard = Standard::of(samples);
    let positive: Vec<bool> = samples.origins.iter().map(|o| o.positive).collect();
    let trial = Trial {
        samples,
        x: standard.apply(&samples.values),
        by_part: folds_of_parts(samples),
        by_stroke: folds_of_strokes(samples),
        weights: balanced(&positive, |i| i % stride(samples, positive[i]) == 0),
        positive,
        ridge: question.ridge,
    };
    let mut order: Vec<(usize, Model, &Vec<usize>)> = (question.subsets.iter())
        .flat_map(|subset| {
            [Model::Linear, Model::Quadratic].map(|model| (term_count(model, subset.len()), model, subset))
        })
        .collect();
    order.sort_by_key(|candidate| candidate.0);

    let probe = standard.apply(question.probe);
    let mut best: Option<(f64, Chosen, Candidate)> = None;
    let rounds = order.len() as f64;
    for (k, (terms, model, subset)) in order.into_iter().enumerate() {
        // No loss is less than nothing: the price alone may rule a candidate out, and all after it.
        let price = terms as f64 / samples.origins.len() as f64;
        if best.as_ref().is_some_and(|(least, ..)| price >= *least) {
            break;
        }
        let job = job.part(0.9 * k as f64 / rounds, 0.9 * (k + 1) as f64 / rounds);
        let candidate = Candidate::new(model, subset, &trial)?;
        let weights = trial.fit(&candidate, &trial.weights, &vec![0.0; candidate.dimension], CV_PRECISION, job)?;
        let (familiar, unfamiliar) = exec::both(
            || validate(&trial, &candidate, &weights, &trial.by_part, job.part(0.1, 0.4)),
            || validate(&trial, &candidate, &weights, &trial.by_stroke, job.part(0.4, 1.0)),
        );
        let (familiar, unfamiliar) = (familiar?, unfamiliar?);
        let unseen = mean_unseen(&probe, samples.dimension, subset, &trial.ellipsoids(subset));
        let expected = familiar.loss * (1.0 - unseen) + unfamiliar.loss * unseen + price;
        if best.as_ref().is_none_or(|(least, ..)| expected < *least) {
            let (standard, columns) = (standard.clone(), subset.clone());
            let chosen = Chosen { model, columns, standard, weights, familiar, unfamiliar, seen: Vec::new() };
            best = Some((expected, chosen, candidate));
        }
    }
    let Some((_, mut chosen, candidate)) = best else {
        return Err(Error::argument("there is no subset of channels to choose from"));
    };
    let all = balanced(&trial.positive, |_| true);
    chosen.weights = trial.fit(&candidate, &all, &chosen.weights, PRECISION, job.part(0.9, 1.0))?;
    // What is unlike all strokes is so by any feature: also by those that the strokes so far did not need.
    chosen.seen = trial.ellipsoids(&(0..samples.dimension).collect::<Vec<_>>());
    Ok(chosen)
}

impl Candidate {
    fn new(model: Model, columns: &[usize], trial: &Trial) -> Result<Self> {
        let dimension = term_count(model, columns.len());
        let mut rows = try_with_capacity(trial.positive.len() * dimension)?;
        let mut x = vec![0.0; columns.len()];
        for all in trial.x.chunks_exact(trial.samples.dimension) {
            x.iter_mut().zip(columns).for_each(|(x, &c)| *x = all[c]);
            terms(model, &x, &mut rows);
        }
        Ok(Self { rows, dimension })
    }
}

impl Trial<'_> {
    fn fit(&self, of: &Candidate, weights: &[f64], start: &[f64], precision: f64, job: Job) -> Result<Vec<f64>> {
        let problem = Problem { rows: &of.rows, dimension: of.dimension, positive: &self.positive, weights };
        logistic::fit(&problem, self.ridge, start, precision, job)
    }

    /// The regions of the features in `columns` that the classes cover.
    fn ellipsoids(&self, columns: &[usize]) -> Vec<Ellipsoid> {
        let of_class = |class: bool| {
            let all = self.x.chunks_exact(self.samples.dimension).zip(&self.positive);
            let members = all.filter(|(_, positive)| **positive == class);
            ellipsoid(members.flat_map(|(x, _)| columns.iter().map(|&c| x[c])).collect(), columns.len())
        };
        [false, true].map(of_class).into()
    }
}

/// One in so many samples of a class is used to compare models.
fn stride(samples: &Samples, positive: bool) -> usize {
    samples.counts[usize::from(positive)].div_ceil(CV_SAMPLES)
}

/// The mean over some pixels of how far they are from all that was painted (see `classify`).
fn mean_unseen(probe: &[f64], dimension: usize, columns: &[usize], seen: &[Ellipsoid]) -> f64 {
    let mut x = vec![0.0; columns.len()];
    let mut sum = 0.0;
    for pixel in probe.chunks_exact(dimension) {
        x.iter_mut().zip(columns).for_each(|(x, &c)| *x = pixel[c]);
        let nearest = seen.iter().map(|e| e.squared_distance(&x)).fold(f64::INFINITY, f64::min);
        sum += 1.0 - (1.0 - nearest.max(1.0).sqrt()).exp();
    }
    sum / (probe.len() / dimension).max(1) as f64
}

/// Weights under which the classes weigh the same, whatever the number of samples that are `used` of each.
fn balanced(positive: &[bool], used: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut counts = [0usize; 2];
    (0..positive.len()).filter(|&i| used(i)).for_each(|i| counts[usize::from(positive[i])] += 1);
    let weight = |i: usize| if used(i) { 0.5 / counts[usize::from(positive[i])] as f64 } else { 0.0 };
    (0..positive.len()).map(weight).collect()
}

fn folds_of_parts(samples: &Samples) -> Vec<usize> {
    samples.origins.iter().map(|o| o.part).collect()
}

/// Strokes are dealt to folds in order, so that no fold holds all of a class; a lone stroke of its class is dealt by parts.
fn folds_of_strokes(samples: &Samples) -> Vec<usize> {
    let folds = (samples.strokes[0] + samples.strokes[1]).clamp(PARTS, FOLDS);
    let is_lone = |positive: bool| samples.strokes[usize::from(positive)] == 1;
    samples.origins.iter().map(|o| (o.stroke + if is_lone(o.positive) { o.part } else { 0 }) % folds).collect()
}

/// Judges a model by fits that each leave out one fold, beginning with the `start` of all folds.
fn validate(trial: &Trial, candidate: &Candidate, start: &[f64], fold_of: &[usize], job: Job) -> Result<Trust> {
    let Trial { samples, positive, .. } = trial;
    let Candidate { rows, dimension, .. } = candidate;
    let count = fold_of.iter().max().map_or(0, |last| last + 1);
    let mut size_of_stroke = vec![0usize; samples.strokes[0] + samples.strokes[1]];
    samples.origins.iter().for_each(|o| size_of_stroke[o.stroke] += 1);

    let held_out = exec::map(count, job, |fold| -> Result<Vec<(f64, bool, f64)>> {
        // A class that would be left without any sample keeps its own.
        let keeps = |class: bool| (0..positive.len()).all(|i| positive[i] != class || fold_of[i] == fold);
        let keeps = [keeps(false), keeps(true)];
        let used =
            |i: usize| (fold_of[i] != fold || keeps[usize::from(positive[i])]) && i % stride(samples, positive[i]) == 0;
        let without = trial.fit(candidate, &balanced(positive, used), start, CV_PRECISION, job)?;
        // Every stroke has the same say within its class, and the classes have the same.
        let tested = samples.origins.iter().enumerate().filter(|(i, _)| fold_of[*i] == fold);
        let result = tested.map(|(i, o)| {
            let share = 0.5 / (samples.strokes[usize::from(o.positive)] * size_of_stroke[o.stroke]) as f64;
            (logistic::dot(&without, &rows[i * dimension..(i + 1) * dimension]), o.positive, share)
        });
        Ok(result.collect())
    })?;
    let held_out: Vec<(f64, bool, f64)> = held_out.into_iter().collect::<Result<Vec<_>>>()?.concat();
    let wrong = held_out.iter().filter(|(z, p, _)| (*z > 0.0) != *p);
    let error = wrong.fold(0.0, |sum, (_, _, share)| sum + share).min(1.0);
    let (scale, loss) = calibrate(&held_out);
    Ok(Trust { error, scale, loss })
}

/// The factor on logits that gives held-out samples the least log loss (temperature scaling, Guo et al. 2017), and that
/// loss. One factor cannot move the mask, only how sure it is.
fn calibrate(held_out: &[(f64, bool, f64)]) -> (f64, f64) {
    // The loss is convex in the factor: where its slope changes sign, by Newton's method inside a shrinking bracket.
    let [mut low, mut high] = CALIBRATION;
    let mut scale = 1.0;
    for _ in 0..20 {
        let (mut slope, mut curvature) = (0.0, 0.0);
        for &(z, positive, share) in held_out {
            let p = logistic::sigmoid(scale * z);
            slope += share * z * (p - f64::from(positive));
            curvature += share * z * z * p * (1.0 - p);
        }
        if slope > 0.0 {
            high = scale
        } else {
            low = scale
        }
        let newton = scale - slope / curvature.max(1e-300);
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        let is_there = (next - scale).abs() < 1e-4 * scale;
        scale = next;
        if is_there {
            break;
        }
    }
    let loss = held_out.iter().map(|&(z, p, share)| share * logistic::log_loss(scale * z, p)).sum();
    (scale, loss)
}

/// The region of feature space that samples of `d` features each cover.
fn ellipsoid(members: Vec<f64>, d: usize) -> Ellipsoid {
    let members: Vec<&[f64]> = members.chunks_exact(d).collect();
    let n = members.len() as f64;
    let centre: Vec<f64> = (0..d).map(|i| members.iter().map(|x| x[i]).sum::<f64>() / n).collect();
    let mut covariance = vec![0.0; d * d];
    for x in &members {
        for i in 0..d {
            for j in 0..=i {
                covariance[i * d + j] += (x[i] - centre[i]) * (x[j] - centre[j]) / n;
            }
        }
    }
    // Standardised features have unit spread over both classes: a tenth of it is the least that counts as beyond.
    (0..d).for_each(|i| covariance[i * d + i] += 0.01);
    let mut inverse = vec![0.0; d * d];
    for j in 0..d {
        let unit: Vec<f64> = (0..d).map(|i| f64::from(i == j)).collect();
        if let Some(column) = logistic::cholesky_solve(&mut covariance.clone(), &unit) {
            (0..d).for_each(|i| inverse[i * d + j] = column[i]);
        }
    }
    let mut ellipsoid = Ellipsoid { centre, inverse };
    let mut distances: Vec<f64> = members.iter().map(|x| ellipsoid.squared_distance(x)).collect();
    distances.sort_by(f64::total_cmp);
    let reach = distances[(distances.len() - 1) * 99 / 100].max(1e-12);
    ellipsoid.inverse.iter_mut().for_each(|v| *v /= reach);
    ellipsoid
}

impl Ellipsoid {
    fn squared_distance(&self, x: &[f64]) -> f64 {
        let off = || x.iter().zip(&self.centre).map(|(x, c)| x - c);
        let rows = self.inverse.chunks_exact(x.len());
        rows.zip(off()).map(|(row, o)| o * row.iter().zip(off()).map(|(a, b)| a * b).sum::<f64>()).sum()
    }
}
