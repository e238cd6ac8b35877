//! Which model, and how far to trust it: cross-validation, then calibration on what was held out.
//!
//! Two questions, two ways to hold out. Parts of strokes: how well does the model do on what the user has painted? Whole
//! strokes: how well does it carry on to what the user has not? Each has its own error and its own calibration, and
//! every pixel is given the mix of both that its distance from the strokes asks for.

use super::Model;
use super::logistic::{self, Problem};
use super::samples::{PARTS, Samples};
use super::standardise::{Standard, term_count, terms};
use crate::error::Result;
use crate::exec;
use crate::image::try_with_capacity;
use crate::job::Job;

/// Most folds; with more strokes than that some are held out together.
const FOLDS: usize = 8;
/// Samples of each class that cross-validation uses: enough to compare two models.
const CV_SAMPLES: usize = 250;
/// Calibration never multiplies logits by more or less than this: a handful of strokes cannot tell.
const CALIBRATION: [f64; 2] = [0.1, 2.0];
/// The quadratic model must have this much less loss than the linear one, which carries on more safely, to be taken.
const PREFER_LINEAR: f64 = 0.97;

/// The classifier, in standardised features, and what is expected of it.
pub struct Chosen {
    pub model: Model,
    pub standard: Standard,
    /// Weights of the terms (see `standardise::terms`), not calibrated.
    pub weights: Vec<f64>,
    /// Where the features are like those of the strokes.
    pub familiar: Trust,
    /// Where they are not.
    pub unfamiliar: Trust,
    /// For each class the mean and the inverse covariance of its samples, in standardised features, scaled so that
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

/// One family's fit to all samples, and the terms it was fitted on.
struct Fitted {
    model: Model,
    rows: Vec<f64>,
    dimension: usize,
    weights: Vec<f64>,
}

pub fn choose(samples: &Samples, ridge: f64, job: Job) -> Result<Chosen> {
    let standard = Standard::of(samples);
    let x: Vec<Vec<f64>> = samples.values.chunks_exact(samples.dimension).map(|v| standard.apply(v)).collect();
    let positive: Vec<bool> = samples.origins.iter().map(|o| o.positive).collect();
    let (by_part, by_stroke) = (folds_of_parts(samples), folds_of_strokes(samples));

    let judge = |model: Model, job: Job| -> Result<(Fitted, Trust, Trust)> {
        let fitted = fit(samples, &x, &positive, model, ridge, job.part(0.0, 0.2))?;
        let familiar = validate(samples, &positive, &fitted, &by_part, ridge, job.part(0.2, 0.5))?;
        let unfamiliar = validate(samples, &positive, &fitted, &by_stroke, ridge, job.part(0.5, 1.0))?;
        Ok((fitted, familiar, unfamiliar))
    };
    let linear = judge(Model::Linear, job.part(0.0, 0.2))?;
    let quadratic = judge(Model::Quadratic, job.part(0.2, 1.0))?;
    let loss = |j: &(Fitted, Trust, Trust)| j.1.loss + j.2.loss;
    let is_quadratic = loss(&quadratic) < PREFER_LINEAR * loss(&linear);
    let (best, familiar, unfamiliar) = if is_quadratic { quadratic } else { linear };

    let seen = [false, true].iter().map(|&class| ellipsoid(samples, &x, class)).collect();
    Ok(Chosen { model: best.model, standard, weights: best.weights, familiar, unfamiliar, seen })
}

fn fit(samples: &Samples, x: &[Vec<f64>], positive: &[bool], model: Model, ridge: f64, job: Job) -> Result<Fitted> {
    let dimension = term_count(model, samples.dimension);
    let mut rows = try_with_capacity(x.len() * dimension)?;
    x.iter().for_each(|x| terms(model, x, &mut rows));
    let problem = Problem { rows: &rows, dimension, positive, weights: &balanced(positive, |_| true) };
    let weights = logistic::fit(&problem, ridge, &vec![0.0; dimension], job)?;
    Ok(Fitted { model, rows, dimension, weights })
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

/// Judges a model by fits that each leave out one fold.
fn validate(
    samples: &Samples,
    positive: &[bool],
    fitted: &Fitted,
    fold_of: &[usize],
    ridge: f64,
    job: Job,
) -> Result<Trust> {
    let Fitted { rows, dimension, .. } = fitted;
    let count = fold_of.iter().max().map_or(0, |last| last + 1);
    let stride = |i: usize| samples.counts[usize::from(positive[i])].div_ceil(CV_SAMPLES);
    let mut size_of_stroke = vec![0usize; samples.strokes[0] + samples.strokes[1]];
    samples.origins.iter().for_each(|o| size_of_stroke[o.stroke] += 1);

    let held_out = exec::map(count, job, |fold| -> Result<Vec<(f64, bool, f64)>> {
        // A class that would be left without any sample keeps its own.
        let keeps = |class: bool| (0..positive.len()).all(|i| positive[i] != class || fold_of[i] == fold);
        let keeps = [keeps(false), keeps(true)];
        let used = |i: usize| (fold_of[i] != fold || keeps[usize::from(positive[i])]) && i % stride(i) == 0;
        let weights = balanced(positive, used);
        let problem = Problem { rows, dimension: *dimension, positive, weights: &weights };
        let without = logistic::fit(&problem, ridge, &fitted.weights, job)?;
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
    let loss = |s: f64| held_out.iter().map(|&(z, p, share)| share * logistic::log_loss(s * z, p)).sum::<f64>();
    // The loss is convex in the factor: golden section over its logarithm.
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let (mut low, mut high) = (CALIBRATION[0].ln(), CALIBRATION[1].ln());
    for _ in 0..30 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if loss(a.exp()) <= loss(b.exp()) { high = b } else { low = a }
    }
    let scale = (0.5 * (low + high)).exp();
    (scale, loss(scale))
}

/// The region of feature space that a class's samples cover.
fn ellipsoid(samples: &Samples, x: &[Vec<f64>], class: bool) -> Ellipsoid {
    let d = samples.dimension;
    let members: Vec<&Vec<f64>> =
        x.iter().zip(&samples.origins).filter(|(_, o)| o.positive == class).map(|(x, _)| x).collect();
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
        let d = x.len();
        let off: Vec<f64> = x.iter().zip(&self.centre).map(|(x, c)| x - c).collect();
        (0..d).map(|i| off[i] * logistic::dot(&self.inverse[i * d..(i + 1) * d], &off)).sum()
    }
}
