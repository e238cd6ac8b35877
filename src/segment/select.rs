//! Which model, and how far to trust it: cross-validation over strokes, then calibration on what was held out.

use super::Model;
use super::logistic::{self, Problem};
use super::samples::Samples;
use super::standardise::{Standard, term_count, terms};
use crate::error::Result;
use crate::exec;
use crate::job::Job;

/// Most folds; with more groups of samples than that some are held out together.
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
    /// Weights of the terms (see `standardise::terms`), calibration included.
    pub weights: Vec<f64>,
    /// Share of held-out samples that were wrong, classes and strokes weighing the same.
    pub error: f64,
    /// For each class the mean and the inverse covariance of its samples, in standardised features, scaled so that
    /// 99 % of its samples are within distance 1.
    pub seen: Vec<Ellipsoid>,
}

pub struct Ellipsoid {
    pub centre: Vec<f64>,
    /// Row by row.
    pub inverse: Vec<f64>,
}

struct Validated {
    model: Model,
    weights: Vec<f64>,
    loss: f64,
    error: f64,
    scale: f64,
}

pub fn choose(samples: &Samples, ridge: f64, job: Job) -> Result<Chosen> {
    let standard = Standard::of(samples);
    let x: Vec<Vec<f64>> = samples.values.chunks_exact(samples.dimension).map(|v| standard.apply(v)).collect();

    let linear = validate(samples, &x, Model::Linear, ridge, job.part(0.0, 0.2))?;
    let quadratic = validate(samples, &x, Model::Quadratic, ridge, job.part(0.2, 1.0))?;
    let best = if quadratic.loss < PREFER_LINEAR * linear.loss { quadratic } else { linear };

    let seen = [false, true].iter().map(|&class| ellipsoid(samples, &x, class)).collect();
    let weights = best.weights.iter().map(|w| w * best.scale).collect();
    Ok(Chosen { model: best.model, standard, weights, error: best.error, seen })
}

/// Fits one model to all samples, and judges it by fits that each leave out some strokes.
fn validate(samples: &Samples, x: &[Vec<f64>], model: Model, ridge: f64, job: Job) -> Result<Validated> {
    let dimension = term_count(model, samples.dimension);
    let mut rows = Vec::with_capacity(x.len() * dimension);
    x.iter().for_each(|x| terms(model, x, &mut rows));

    // Classes weigh the same whatever the number of their samples.
    let class_weight = |positive: bool| 1.0 / samples.counts[usize::from(positive)] as f64;
    let weights: Vec<f64> = samples.positive.iter().map(|&p| class_weight(p)).collect();
    let problem = Problem { rows: &rows, dimension, positive: &samples.positive, weights: &weights };
    let all = logistic::fit(&problem, ridge, &vec![0.0; dimension], job.part(0.0, 0.3))?;

    // Groups are dealt to folds in order, so that no fold holds out all of a class unless the class is one group.
    let groups = &samples.groups;
    let folds = groups.len().min(FOLDS);
    let held_out = exec::map(folds, job.part(0.3, 1.0), |fold| -> Result<Vec<(f64, bool, f64)>> {
        let mut weights = weights.clone();
        let mut tested = Vec::new();
        for (g, group) in groups.iter().enumerate() {
            let of_class = groups.iter().filter(|o| o.positive == group.positive).count();
            let keep = (CV_SAMPLES / of_class).max(8);
            let stride = group.members.len().div_ceil(keep);
            let is_out = g % folds == fold && of_class > 1;
            for (k, &i) in group.members.iter().enumerate() {
                weights[i] = if is_out || k % stride != 0 { 0.0 } else { weights[i] * stride as f64 };
            }
            if g % folds == fold {
                // Every stroke has the same say within its class, and the classes have the same.
                let share = 0.5 / (of_class * group.members.len()) as f64;
                tested.extend(group.members.iter().map(|&i| (i, share)));
            }
        }
        let fitted = logistic::fit(&Problem { weights: &weights, ..problem }, ridge, &all, job)?;
        let logit = |i: usize| logistic::dot(&fitted, &rows[i * dimension..(i + 1) * dimension]);
        Ok(tested.into_iter().map(|(i, share)| (logit(i), samples.positive[i], share)).collect())
    })?;
    let held_out: Vec<(f64, bool, f64)> = held_out.into_iter().collect::<Result<Vec<_>>>()?.concat();

    let error = held_out.iter().filter(|(z, p, _)| (*z > 0.0) != *p).map(|(_, _, share)| share).sum::<f64>().min(1.0);
    let (scale, loss) = calibrate(&held_out);
    Ok(Validated { model, weights: all, loss, error, scale })
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
        x.iter().zip(&samples.positive).filter(|(_, p)| **p == class).map(|(x, _)| x).collect();
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
