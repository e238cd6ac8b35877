//! Applies the classifier to the whole image, in tiles along the rows. Each feature of a tile is a plane, and each
//! result is a quadratic form of the features.

use super::ellipsoid::Ellipsoid;
use super::exponential::exp_f32;
use super::input::{Input, MAX_CHANNELS};
use super::params::Params;
use super::refine::{self, Refinement};
use super::segmentation::Model;
use super::select::Chosen;
use crate::error::Result;
use crate::exec;
use crate::features::CHANNELS;
use crate::image::{Image, deinterleave, deinterleave_of};
use crate::job::Job;
use crate::simd::widest;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// Pixels processed together: their planes stay in the first-level cache.
const TILE: usize = 64;

/// One feature of all pixels of a tile.
type Plane = [f32; TILE];

pub struct Classified {
    pub mask: Image,
    pub confidence: Image,
    pub unseen: Image,
    /// Mean of `unseen` over the pixels of the region.
    pub mean_unseen: f64,
    /// Feature values that are NaN or infinite.
    pub bad: usize,
}

impl Classified {
    /// Makes mask and confidence follow the edges of the photo.
    pub fn refine(&mut self, input: &Input, params: &Params, job: Job) -> Result<()> {
        let refinement = Refinement {
            features: input.features,
            confidence: &self.confidence,
            region: input.region,
            radius: params.refine_radius,
            tolerance: params.refine_tolerance,
        };
        self.confidence = refine::run(&refinement, job)?;
        let is_in = |probability: &f32| f32::from(*probability > 0.5);
        self.mask.data.iter_mut().zip(&self.confidence.data).for_each(|(mask, p)| *mask = is_in(p));
        Ok(())
    }
}

/// The output images, still black. Allocating them takes a while, so it is done while the model is trained.
pub struct Blank {
    mask: Image,
    confidence: Image,
    unseen: Image,
}

impl Blank {
    pub fn new(width: usize, height: usize) -> Result<Self> {
        let black = || Image::new(width, height, 1);
        Ok(Self { mask: black()?, confidence: black()?, unseen: black()? })
    }
}

/// All that is needed to classify a tile.
struct Judge<'a> {
    /// The channels of the samples' columns.
    channels: &'a [usize],
    /// Whether `channels` are all channels of an image with [`CHANNELS`] channels.
    is_usual: bool,
    mean: Vec<f32>,
    scale: Vec<f32>,
    logit: Form,
    /// Indices in `channels` of the features that the logit uses, in its order.
    deciding: Vec<usize>,
    /// For each class, the squared distance from the centre of the region that its samples cover, over all of
    /// `channels`.
    seen: [Form; 2],
    /// Factors on logits where features are like the painted ones, and where they are not.
    calibration: [f32; 2],
}

impl Judge<'_> {
    /// Standardises the channels of a tile. Inlined into the function for each instruction set.
    #[inline(always)]
    fn standardise(&self, pixels: &[f32], count: usize, tile: &mut Tile) {
        if self.is_usual {
            // With all of the usual channels, standardise them while they are deinterleaved.
            let mean: [f32; CHANNELS] = std::array::from_fn(|c| self.mean[c]);
            let scale: [f32; CHANNELS] = std::array::from_fn(|c| self.scale[c]);
            if let Some(planes) = tile.all.first_chunk_mut::<CHANNELS>() {
                deinterleave_of(pixels, planes, |c, v| (v - mean[c]) * scale[c]);
            }
            return;
        }
        deinterleave(pixels, &mut tile.raw[..count]);
        for (plane, (&channel, (mean, scale))) in
            tile.all.iter_mut().zip(self.channels.iter().zip(self.mean.iter().zip(&self.scale)))
        {
            for (to, v) in plane.iter_mut().zip(&tile.raw[channel]) {
                *to = (v - mean) * scale;
            }
        }
    }
}

/// `xᵀAx + bᵀx + c` of standardised features; `a` holds the upper triangle row by row, empty if `A` is zero.
struct Form {
    a: Vec<f32>,
    b: Vec<f32>,
    c: f32,
}

impl Form {
    fn of_model(chosen: &Chosen) -> Self {
        let d = chosen.columns.len();
        let w: Vec<f32> = chosen.weights.iter().map(|&w| w as f32).collect();
        let a = if chosen.model == Model::Quadratic { w[d..w.len() - 1].to_vec() } else { Vec::new() };
        Self { a, b: w[..d].to_vec(), c: w[w.len() - 1] }
    }

    /// The squared distance from an ellipsoid's centre.
    fn of_ellipsoid(e: &Ellipsoid) -> Self {
        let d = e.centre.len();
        let at = |i: usize, j: usize| e.inverse[i * d + j];
        let pull: Vec<f64> = (0..d).map(|i| (0..d).map(|j| at(i, j) * e.centre[j]).sum()).collect();
        let mut a = Vec::new();
        for i in 0..d {
            a.extend((i..d).map(|j| (if i == j { at(i, i) } else { at(i, j) + at(j, i) }) as f32));
        }
        let c: f64 = pull.iter().zip(&e.centre).map(|(p, c)| p * c).sum();
        Self { a, b: pull.iter().map(|p| -2.0 * *p as f32).collect(), c: c as f32 }
    }

    /// Evaluates the form; `planes` are in the order of its features.
    #[inline(always)]
    fn evaluate(&self, planes: &[Plane]) -> Plane {
        let mut sum = [self.c; TILE];
        let mut rest = self.a.as_slice();
        for (i, (x, &b)) in planes.iter().zip(&self.b).enumerate() {
            // x_i (b_i + Σ_{j >= i} a_ij x_j)
            let mut factor = [b; TILE];
            if !rest.is_empty() {
                let (row, after) = rest.split_at(planes.len() - i);
                rest = after;
                for (a, y) in row.iter().zip(&planes[i..]) {
                    for k in 0..TILE {
                        factor[k] += a * y[k];
                    }
                }
            }
            for k in 0..TILE {
                sum[k] += factor[k] * x[k];
            }
        }
        sum
    }
}

/// The results for a tile.
struct Answer {
    mask: [f32; TILE],
    probability: [f32; TILE],
    /// How far the features lie beyond the regions of both classes, in `[0, 1]`.
    beyond: [f32; TILE],
    /// Whether all distances are finite, and with them all of the samples' columns.
    all_finite: bool,
}

/// The features of a tile.
struct Tile {
    /// The channels as they are in the image.
    raw: [Plane; MAX_CHANNELS],
    /// The samples' columns, standardised (`all`), and those of them that the logit uses (`deciding`).
    all: [Plane; MAX_CHANNELS],
    deciding: [Plane; MAX_CHANNELS],
}

widest! {
    /// Classifies up to [`TILE`] pixels; results beyond the last pixel mean nothing. `likely` is the index of the
    /// region of feature space that contained an earlier tile. It is tested first, which saves time and does not
    /// change the result.
    fn judge(judge: &Judge, pixels: &[f32], count: usize, tile: &mut Tile, likely: &mut usize) -> Answer {
        judge.standardise(pixels, count, tile);
        let planes = &tile.all[..judge.channels.len()];

        // If one region contains all pixels, none lies beyond it: the other region need not be evaluated.
        let mut nearest = [f32::INFINITY; TILE];
        let mut all_within = false;
        for turn in 0..judge.seen.len() {
            let region = (*likely + turn) % judge.seen.len();
            let distance = judge.seen[region].evaluate(planes);
            for k in 0..TILE {
                nearest[k] = nearest[k].min(distance[k]);
            }
            all_within = nearest.iter().fold(true, |within, &v| within & (v <= 1.0));
            if all_within {
                *likely = region;
                break;
            }
        }
        let all_finite = nearest.iter().fold(true, |finite, &v| finite & (v < f32::INFINITY));
        let mut beyond = [0.0; TILE];
        if !all_within {
            for k in 0..TILE {
                let distance = if nearest[k] > 1.0 { nearest[k].sqrt() } else { 1.0 };
                beyond[k] = 1.0 - exp_f32(1.0 - distance);
            }
        }

        let logit = if judge.deciding.len() == planes.len() {
            judge.logit.evaluate(planes)
        } else {
            for (to, &column) in tile.deciding.iter_mut().zip(&judge.deciding) {
                *to = planes[column];
            }
            judge.logit.evaluate(&tile.deciding[..judge.deciding.len()])
        };
        let [familiar, unfamiliar] = judge.calibration;
        let (mut mask, mut probability) = ([0.0; TILE], [0.0; TILE]);
        for k in 0..TILE {
            let calibration = familiar + (unfamiliar - familiar) * beyond[k];
            probability[k] = 1.0 / (1.0 + exp_f32(-calibration * logit[k]));
            mask[k] = if probability[k] > 0.5 { 1.0 } else { 0.0 };
        }
        Answer { mask, probability, beyond, all_finite }
    }
}

/// Classifies every pixel by its features; `channels` are the channels of the samples' columns. Outside the region,
/// where `region` is at most one half, all results are 0.
pub fn run(
    features: &Image,
    region: Option<&Image>,
    channels: &[usize],
    chosen: &Chosen,
    blank: Blank,
    job: Job,
) -> Result<Classified> {
    let (width, height) = (features.width, features.height);
    let single = |values: &[f64]| values.iter().map(|&v| v as f32).collect();
    let judges = Judge {
        channels,
        is_usual: features.channels == CHANNELS && channels.len() == CHANNELS,
        mean: single(&chosen.standard.mean),
        scale: single(&chosen.standard.scale),
        logit: Form::of_model(chosen),
        deciding: chosen.columns.clone(),
        seen: chosen.seen.each_ref().map(Form::of_ellipsoid),
        calibration: [chosen.familiar.scale as f32, chosen.unfamiliar.scale as f32],
    };
    let Blank { mut mask, mut confidence, mut unseen } = blank;
    let bad = AtomicUsize::new(0);
    let looks_at_all = channels.len() == features.channels;
    // The sum of each row, as bits. Adding them in order gives the same mean for any number of threads.
    let sums: Vec<AtomicU64> = (0..height).map(|_| AtomicU64::new(0)).collect();
    let images = [&mut mask, &mut confidence, &mut unseen].map(|image| image.data.as_mut_slice());
    exec::for_rows_of_three(images, width, job, |y, [mask, confidence, unseen]| {
        let source = features.row(y);
        let black = [[0.0; TILE]; MAX_CHANNELS];
        let mut tile = Tile { raw: black, all: black, deciding: black };
        let (mut likely, mut sum) = (0, 0.0);
        for x in (0..width).step_by(TILE) {
            let n = TILE.min(width - x);
            let pixels = &source[x * features.channels..(x + n) * features.channels];
            let mut answer = judge(&judges, pixels, features.channels, &mut tile, &mut likely);
            if !(answer.all_finite && looks_at_all) {
                bad.fetch_add(count_bad(pixels), Ordering::Relaxed);
            }
            if let Some(region) = region {
                for (k, &w) in region.row(y)[x..x + n].iter().enumerate() {
                    if w.is_nan() || w <= 0.5 {
                        (answer.mask[k], answer.probability[k], answer.beyond[k]) = (0.0, 0.0, 0.0);
                    }
                }
            }
            sum += f64::from(sum_of(&answer.beyond[..n]));
            mask[x..x + n].copy_from_slice(&answer.mask[..n]);
            confidence[x..x + n].copy_from_slice(&answer.probability[..n]);
            unseen[x..x + n].copy_from_slice(&answer.beyond[..n]);
        }
        sums[y].store(sum.to_bits(), Ordering::Relaxed);
    })?;
    let sum: f64 = sums.iter().map(|sum| f64::from_bits(sum.load(Ordering::Relaxed))).sum();
    let looked_at = region.map_or(width * height, |w| w.data.iter().filter(|w| **w > 0.5).count());
    let mean_unseen = sum / looked_at.max(1) as f64;
    Ok(Classified { mask, confidence, unseen, mean_unseen, bad: bad.into_inner() })
}

widest! {
    /// The number of values that are NaN or infinite.
    pub fn count_bad(values: &[f32]) -> usize {
        values.iter().map(|v| u32::from(!v.is_finite())).sum::<u32>() as usize
    }
}

/// The sum of all values, by eight partial sums.
fn sum_of(values: &[f32]) -> f32 {
    let (chunks, rest) = values.as_chunks::<8>();
    let mut sums = [0.0; 8];
    chunks.iter().for_each(|chunk| sums.iter_mut().zip(chunk).for_each(|(sum, v)| *sum += v));
    sums.iter().chain(rest).sum()
}
