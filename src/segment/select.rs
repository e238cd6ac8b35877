//! Chooses the model and its feature channels by cross-validation, and calibrates its probabilities on held-out
//! samples.
//!
//! Two kinds of cross-validation are run. Holding out parts of strokes measures how well the model does on surfaces
//! that the user has painted. Holding out whole strokes measures how well it extrapolates to other surfaces. Each kind
//! gives an error and a calibration factor. The calibration factor of a pixel is interpolated between these two
//! factors, by the distance of the pixel's features from the features of the strokes.

use super::ellipsoid::{self, Ellipsoid, Spread};
use super::logistic::{self, Objective, Problem};
use super::samples::{Origin, PARTS, Samples};
use super::segmentation::Model;
use super::standardise::{Standard, term_count, terms};
use super::table::Table;
use crate::error::{Error, Result};
use crate::exec;
use crate::job::Job;

/// Maximum number of folds of cross-validation. If there are more strokes than this, a fold holds several strokes.
const FOLDS: usize = 8;
/// Approximate maximum number of samples per class in the fits of cross-validation. This number is enough to tell which
/// of two models is better.
const CV_SAMPLES: usize = 250;
/// Range of the calibration factor on logits. A handful of strokes does not justify a larger correction.
/// [bench segment:masks]
const CALIBRATION: [f64; 2] = [0.1, 2.0];
/// A fit ends with the first Newton step whose expected decrease of the objective (see `logistic::fit`) is below a
/// limit. `CV_PRECISION` is the limit in fits that only compare models. With the default number of samples, the price
/// of a term is 1 / 2000 (see [`choose`]), which is 50 times `CV_PRECISION`. `PRECISION` is the limit in the final fit.
/// Newton's method converges quadratically: after a step that lowers the objective by d, a further decrease of the
/// order of d² remains. Any `PRECISION` from 1e-12 to 1e-7 therefore gives the same fit. [convention]
const CV_PRECISION: f64 = 1e-5;
const PRECISION: f64 = 1e-9;

/// The chosen classifier of standardised features, with its expected errors.
pub struct Chosen {
    pub model: Model,
    /// The columns of the samples that the classifier uses.
    pub columns: Vec<usize>,
    /// Mean and scale of every column of the samples.
    pub standard: Standard,
    /// Weights of the terms (see `standardise::terms`), before calibration.
    pub weights: Vec<f64>,
    /// Result of cross-validation that holds out parts of strokes. It applies to pixels whose features are like the
    /// features under the strokes.
    pub held_out_parts: Validation,
    /// Result of cross-validation that holds out whole strokes. It applies to pixels whose features are unlike the
    /// features under the strokes.
    pub held_out_strokes: Validation,
    /// For each class, the ellipsoid around its samples in the space of all standardised features.
    pub seen: [Ellipsoid; 2],
}

/// The result of one kind of cross-validation.
#[derive(Clone, Copy)]
pub struct Validation {
    /// Weighted share of held-out samples that were classified wrongly. Both classes have equal weight, and so have
    /// all strokes of a class.
    pub error: f64,
    /// The calibration factor by which logits are multiplied.
    pub scale: f64,
    /// Mean log loss of the held-out samples after calibration, with the weights of `error`.
    loss: f64,
}

/// The input of [`choose`].
pub struct SelectionInput<'a> {
    pub samples: &'a Samples,
    /// Subsets of the features to choose from, as column indices of the samples.
    pub subsets: &'a [Vec<usize>],
    /// Features of pixels spread over the region to be segmented, laid out as `samples.values`.
    pub unlabelled: &'a [f64],
    pub ridge: f64,
}

/// A candidate classifier: the linear or the quadratic model on a subset of the features.
struct Candidate {
    model: Model,
    columns: Vec<usize>,
    /// Values of the model's terms at all samples.
    terms: Table,
    /// Weights fitted to the samples in `Trial::few`.
    weights: Vec<f64>,
    held_out_parts: Validation,
    held_out_strokes: Validation,
}

/// The samples with their classes, and their folds for cross-validation.
struct Trial<'a> {
    samples: &'a Samples,
    /// All features of all samples, standardised.
    x: Table,
    positive: Vec<bool>,
    /// Fold of each sample, if parts of strokes are held out.
    by_part: Vec<usize>,
    /// Fold of each sample, if whole strokes are held out.
    by_stroke: Vec<usize>,
    /// Indices of the subset of samples to which all candidates are fitted.
    few: Vec<usize>,
    ridge: f64,
}

/// Chooses the model and the features with the lowest sum `(1 - u) loss_parts + u loss_strokes + price`.
///
/// The first two terms are the expected loss over the whole image. `u` is the share of pixels unlike the painted ones.
/// `loss_parts` is the log loss on held-out parts of strokes, and applies to pixels like the painted ones.
/// `loss_strokes` is the log loss on held-out whole strokes, and applies to all other pixels. The price is number of
/// terms / number of samples (Akaike's criterion). The simpler of two equally good models therefore wins.
pub fn choose(input: &SelectionInput, job: Job) -> Result<Chosen> {
    let SelectionInput { samples, subsets, .. } = *input;
    let standard = Standard::of(samples);
    let positive: Vec<bool> = samples.origins.iter().map(|o| o.positive).collect();
    let trial = Trial {
        samples,
        x: standard.apply(&samples.values)?,
        by_part: folds_of_parts(samples),
        by_stroke: folds_of_strokes(samples),
        few: (0..positive.len()).filter(|&i| i % stride(samples, positive[i]) == 0).collect(),
        positive,
        ridge: input.ridge,
    };

    // For each subset of the features, compute how far the image's pixels lie outside the samples' ellipsoids.
    let unlabelled = standard.apply(input.unlabelled)?;
    let spread = |class: bool| Spread::of(&trial.x, |i| trial.positive[i] == class);
    let (negative, positive) = exec::both(|| spread(false), || spread(true));
    let spreads = [negative, positive];
    let unseen = exec::map(subsets.len(), job.part(0.0, 0.1), |k| {
        let columns = &subsets[k];
        ellipsoid::mean_unseen(&unlabelled, columns, &spreads.each_ref().map(|spread| spread.ellipsoid(columns)))
    })?;

    let candidate = cheapest(&trial, subsets, &unseen, job.part(0.1, 0.9))?;
    let Candidate { model, columns, terms, weights, held_out_parts, held_out_strokes } = candidate;
    let all = balanced(&trial.positive, |_| true);
    let problem = Problem { terms: &terms, positive: &trial.positive, weights: &all };
    let weights = logistic::fit(&problem, trial.ridge, &weights, PRECISION, job.part(0.9, 1.0))?;
    // The ellipsoids use all features: a pixel may be unlike all strokes in a feature that the chosen model does not
    // use.
    let seen = spreads.map(|spread| spread.ellipsoid(&(0..samples.dimension).collect::<Vec<_>>()));
    Ok(Chosen { model, columns, standard, weights, held_out_parts, held_out_strokes, seen })
}

/// Finds the candidate with the smallest sum of expected loss over the image and price of its terms. `unseen` holds
/// for each subset the share of the image that is unlike the painted pixels.
fn cheapest(trial: &Trial, subsets: &[Vec<usize>], unseen: &[f64], job: Job) -> Result<Candidate> {
    let mut order: Vec<(usize, Model, usize)> = (0..subsets.len())
        .flat_map(|k| [Model::Linear, Model::Quadratic].map(|model| (term_count(model, subsets[k].len()), model, k)))
        .collect();
    order.sort_by_key(|candidate| candidate.0);
    let price = |terms: usize| terms as f64 / trial.positive.len() as f64;
    let mut best: Option<(f64, Candidate)> = None;
    let mut rest = order.as_slice();
    // Candidates are ranked by their loss plus their price, and losses are not negative. Once the price of the next
    // candidate reaches the best sum so far, neither that candidate nor a larger one can win.
    while let Some((terms, ..)) =
        rest.first().filter(|(t, ..)| best.as_ref().is_none_or(|(min_loss, _)| price(*t) < *min_loss))
    {
        // Evaluate in parallel all candidates that have at most twice as many terms as the smallest remaining one.
        let (batch, larger) = rest.split_at(rest.partition_point(|candidate| candidate.0 <= 2 * terms));
        let done = |left: &[_]| 1.0 - left.len() as f64 / order.len() as f64;
        let candidates = exec::map(batch.len(), job.part(done(rest), done(larger)), |i| {
            Candidate::weigh(batch[i].1, &subsets[batch[i].2], trial, job.part(0.0, 0.0))
        })?;
        for (candidate, (terms, _, subset)) in candidates.into_iter().zip(batch) {
            let candidate = candidate?;
            let (held_out_parts, held_out_strokes) = (candidate.held_out_parts.loss, candidate.held_out_strokes.loss);
            let expected =
                held_out_parts * (1.0 - unseen[*subset]) + held_out_strokes * unseen[*subset] + price(*terms);
            if best.as_ref().is_none_or(|(min_loss, _)| expected < *min_loss) {
                best = Some((expected, candidate));
            }
        }
        rest = larger;
    }
    best.map(|(_, candidate)| candidate).ok_or_else(|| Error::argument("there is no subset of channels to choose from"))
}

impl Candidate {
    fn weigh(model: Model, columns: &[usize], trial: &Trial, job: Job) -> Result<Self> {
        let terms = terms(model, &trial.x, columns)?;
        let few = Table::of_rows(&terms, &trial.few)?;
        let weights = trial.fit_few(&few, |_| true, &vec![0.0; terms.columns], job)?;
        let held_out = |fold_of| validate(trial, &terms, &few, &weights, fold_of, job);
        let (held_out_parts, held_out_strokes) = exec::both(|| held_out(&trial.by_part), || held_out(&trial.by_stroke));
        let (held_out_parts, held_out_strokes) = (held_out_parts?, held_out_strokes?);
        Ok(Self { model, columns: columns.to_vec(), terms, weights, held_out_parts, held_out_strokes })
    }
}

impl Trial<'_> {
    /// Fits a model to the samples in `Trial::few` for which `used` returns true. `terms` holds the terms of all
    /// samples in `Trial::few`; `start` holds the initial weights.
    fn fit_few(&self, terms: &Table, used: impl Fn(usize) -> bool, start: &[f64], job: Job) -> Result<Vec<f64>> {
        let positive: Vec<bool> = self.few.iter().map(|&i| self.positive[i]).collect();
        let weights = balanced(&positive, |k| used(self.few[k]));
        let problem = Problem { terms, positive: &positive, weights: &weights };
        logistic::fit(&problem, self.ridge, start, CV_PRECISION, job)
    }
}

/// `Trial::few` holds every n-th sample of a class; returns n.
fn stride(samples: &Samples, positive: bool) -> usize {
    samples.counts[usize::from(positive)].div_ceil(CV_SAMPLES)
}

/// Returns a weight for each sample. The weights of the `used` samples sum to 0.5 in each class, whatever their number.
/// The weights of unused samples are 0.
fn balanced(positive: &[bool], used: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut counts = [0usize; 2];
    (0..positive.len()).filter(|&i| used(i)).for_each(|i| counts[usize::from(positive[i])] += 1);
    let weight = |i: usize| if used(i) { 0.5 / counts[usize::from(positive[i])] as f64 } else { 0.0 };
    (0..positive.len()).map(weight).collect()
}

fn folds_of_parts(samples: &Samples) -> Vec<usize> {
    samples.origins.iter().map(|o| o.part).collect()
}

/// Returns the fold of each sample. Strokes are assigned to folds in turn. If a class has only one stroke, the four
/// parts of the stroke go to different folds, so that no fold holds the whole class.
fn folds_of_strokes(samples: &Samples) -> Vec<usize> {
    let folds = (samples.strokes[0] + samples.strokes[1]).clamp(PARTS, FOLDS);
    let is_lone = |positive: bool| samples.strokes[usize::from(positive)] == 1;
    samples.origins.iter().map(|o| (o.stroke + if is_lone(o.positive) { o.part } else { 0 }) % folds).collect()
}

/// Cross-validates a model. `all` holds the terms of all samples, `few` the terms of the samples in the subset
/// `Trial::few`. For each fold, fits the model to the samples of the subset that lie outside the fold, and applies it
/// to all samples in the fold. Each fit begins with the weights `start`, which were fitted to the whole subset.
fn validate(trial: &Trial, all: &Table, few: &Table, start: &[f64], fold_of: &[usize], job: Job) -> Result<Validation> {
    let Trial { samples, positive, .. } = trial;
    let count = fold_of.iter().max().map_or(0, |last| last + 1);
    let held_out = exec::map(count, job, |fold| -> Result<Vec<(usize, f64)>> {
        // If a fold holds all samples of a class, train with them nevertheless.
        let keeps = |class: bool| (0..positive.len()).all(|i| positive[i] != class || fold_of[i] == fold);
        let keeps = [keeps(false), keeps(true)];
        let used = |i: usize| fold_of[i] != fold || keeps[usize::from(positive[i])];
        let without = trial.fit_few(few, used, start, job)?;
        Ok(logistic::logits(all, &without, |i| fold_of[i] == fold))
    })?;
    let mut logits = vec![0.0; positive.len()];
    for fold in held_out {
        fold?.into_iter().for_each(|(i, z)| logits[i] = z);
    }

    // Weigh the samples: both classes have equal weight, and so have all strokes of a class.
    let mut size_of_stroke = vec![0usize; samples.strokes[0] + samples.strokes[1]];
    samples.origins.iter().for_each(|o| size_of_stroke[o.stroke] += 1);
    let share = |o: &Origin| 0.5 / (samples.strokes[usize::from(o.positive)] * size_of_stroke[o.stroke]) as f64;
    let shares: Vec<f64> = samples.origins.iter().map(share).collect();
    let wrong = (0..positive.len()).filter(|&i| (logits[i] > 0.0) != positive[i]);
    let error = wrong.fold(0.0, |sum, i| sum + shares[i]).min(1.0);
    let problem = Problem { terms: &Table::of(&logits, 1)?, positive, weights: &shares };
    let (scale, loss) = calibrate(&problem);
    Ok(Validation { error, scale, loss })
}

/// Finds the factor on logits that minimises the log loss of held-out samples (temperature scaling, Guo et al. 2017).
/// Returns the factor and the loss. The factor changes the confidence but not the mask, because it keeps the signs of
/// the logits.
fn calibrate(held_out: &Problem) -> (f64, f64) {
    // The loss is convex in the factor. Find the zero of its slope by Newton's method, safeguarded by bisection.
    let [mut low, mut high] = CALIBRATION;
    let loss_at = |scale: f64| Objective::at(held_out, 0.0, &[scale]);
    let mut scale = 1.0;
    for _ in 0..20 {
        let loss = loss_at(scale);
        let (slope, curvature) = (loss.gradient[0], loss.hessian[0]);
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
    (scale, loss_at(scale).value)
}
