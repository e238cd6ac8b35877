//! Applies the classifier to the whole image. Each row is processed in tiles of up to 64 neighbouring pixels; within a
//! tile, the values of each feature are contiguous. Two kinds of quadratic forms of the features are evaluated: the
//! logit, and the squared distance of a pixel from the centre of each class ([`Ellipsoid`]).

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

/// Number of pixels that are classified together: their features stay in the first-level cache.
const TILE: usize = 64;

/// One feature of all pixels of a tile.
type ChannelPlane = [f32; TILE];

pub struct Classified {
    pub mask: Image,
    pub confidence: Image,
    pub unseen: Image,
    /// Mean of `unseen` (see [`super::Segmentation::unseen`]) over the pixels of the region to be segmented.
    pub mean_unseen: f64,
    /// Number of feature values that are NaN or infinite.
    pub bad: usize,
}

impl Classified {
    /// Filters the confidence so that it follows the edges of the photo, and thresholds it to a new mask.
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

/// The output images, filled with zeros. They are allocated in parallel with learning, because allocation takes a
/// while.
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

/// The parameters of the classifier, converted to `f32` for the tiles.
struct Classifier<'a> {
    /// The image channel of each column of the samples. A sample is a painted pixel from which the model was learnt;
    /// a column is one of the features that the samples store.
    channels: &'a [usize],
    /// Whether the image has [`CHANNELS`] channels and `channels` lists all of them.
    has_all_channels: bool,
    mean: Vec<f32>,
    scale: Vec<f32>,
    logit: QuadraticForm,
    /// Indices into `channels` of the features in the logit, in the order of its terms.
    deciding: Vec<usize>,
    /// For each class, a quadratic form of all `channels` that is at most 1 inside the ellipsoid around the class's
    /// samples, and larger outside.
    seen: [QuadraticForm; 2],
    /// Factors by which the logit is multiplied to give calibrated probabilities. The first applies where `unseen` is 0
    /// (pixels like the painted ones), the second where it is 1. Between these values, the factor is interpolated.
    calibration: [f32; 2],
}

impl Classifier<'_> {
    /// Deinterleaves and standardises the channels of a tile. It is inlined into `classify`, which is compiled once
    /// per instruction set.
    #[inline(always)]
    fn standardise(&self, pixels: &[f32], channel_count: usize, tile: &mut Tile) {
        if self.has_all_channels {
            // For the usual ten channels, standardise in the same pass as deinterleaving.
            let mean: [f32; CHANNELS] = std::array::from_fn(|c| self.mean[c]);
            let scale: [f32; CHANNELS] = std::array::from_fn(|c| self.scale[c]);
            if let Some(planes) = tile.all.first_chunk_mut::<CHANNELS>() {
                deinterleave_of(pixels, planes, |c, v| (v - mean[c]) * scale[c]);
            }
            return;
        }
        deinterleave(pixels, &mut tile.raw[..channel_count]);
        for (plane, (&channel, (mean, scale))) in
            tile.all.iter_mut().zip(self.channels.iter().zip(self.mean.iter().zip(&self.scale)))
        {
            for (to, v) in plane.iter_mut().zip(&tile.raw[channel]) {
                *to = (v - mean) * scale;
            }
        }
    }
}

/// The function `xᵀAx + bᵀx + c` of standardised features `x`, where `A` is an upper triangular matrix. `a` holds the
/// upper triangle of `A` row by row; it is empty if `A` is zero.
struct QuadraticForm {
    a: Vec<f32>,
    b: Vec<f32>,
    c: f32,
}

impl QuadraticForm {
    fn of_model(chosen: &Chosen) -> Self {
        let d = chosen.columns.len();
        let w: Vec<f32> = chosen.weights.iter().map(|&w| w as f32).collect();
        let a = if chosen.model == Model::Quadratic { w[d..w.len() - 1].to_vec() } else { Vec::new() };
        Self { a, b: w[..d].to_vec(), c: w[w.len() - 1] }
    }

    /// The function `(x - m)ᵀ E (x - m)` of an ellipsoid with centre `m` and matrix `E` ([`Ellipsoid::inverse`]): at
    /// most 1 inside the ellipsoid.
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

    /// Evaluates the form at all pixels of a tile; `planes` holds one plane per feature of the form.
    #[inline(always)]
    fn evaluate(&self, planes: &[ChannelPlane]) -> ChannelPlane {
        let mut sum = [self.c; TILE];
        let mut rest = self.a.as_slice();
        for (i, (x, &b)) in planes.iter().zip(&self.b).enumerate() {
            // Add the terms of x_i: x_i (b_i + Σ_{j >= i} a_ij x_j).
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

/// The results for the pixels of a tile.
struct Answer {
    mask: [f32; TILE],
    probability: [f32; TILE],
    /// How far the features lie outside the ellipsoids of both classes, in `[0, 1]`: 0 inside an ellipsoid, else
    /// `1 - e^(1 - d)`. The distance d is √q, where q is the smaller of the two forms [`Classifier::seen`]. On an
    /// ellipsoid, d is 1.
    unseen: [f32; TILE],
    /// Whether all distances are finite, which implies that all features in `channels` are finite.
    all_finite: bool,
}

/// The features of a tile, one plane per channel.
struct Tile {
    /// The channels as they are stored in the image.
    raw: [ChannelPlane; MAX_CHANNELS],
    /// `all`: the standardised features that the samples store, in the order of the samples' columns. `deciding`: the
    /// channels among them that the logit uses.
    all: [ChannelPlane; MAX_CHANNELS],
    deciding: [ChannelPlane; MAX_CHANNELS],
}

widest! {
    /// Classifies up to [`TILE`] pixels of `channel_count` channels each; results after the last pixel are undefined.
    /// `likely` is the index of the ellipsoid that contained all pixels of an earlier tile. This ellipsoid is tested
    /// first, which saves time and does not change the result.
    fn classify(
        classifier: &Classifier,
        pixels: &[f32],
        channel_count: usize,
        tile: &mut Tile,
        likely: &mut usize,
    ) -> Answer {
        classifier.standardise(pixels, channel_count, tile);
        let planes = &tile.all[..classifier.channels.len()];

        // For each pixel, find the smaller of the squared distances from the centres of the two ellipsoids. If the
        // first ellipsoid contains all pixels, `unseen` is 0 for all of them, and the second ellipsoid need not be
        // evaluated.
        let mut nearest = [f32::INFINITY; TILE];
        let mut all_within = false;
        for turn in 0..classifier.seen.len() {
            let ellipsoid = (*likely + turn) % classifier.seen.len();
            let distance = classifier.seen[ellipsoid].evaluate(planes);
            for k in 0..TILE {
                nearest[k] = nearest[k].min(distance[k]);
            }
            all_within = nearest.iter().fold(true, |within, &v| within & (v <= 1.0));
            if all_within {
                *likely = ellipsoid;
                break;
            }
        }
        let all_finite = nearest.iter().fold(true, |finite, &v| finite & (v < f32::INFINITY));
        let mut unseen = [0.0; TILE];
        if !all_within {
            for k in 0..TILE {
                let distance = if nearest[k] > 1.0 { nearest[k].sqrt() } else { 1.0 };
                unseen[k] = 1.0 - exp_f32(1.0 - distance);
            }
        }

        let logit = if classifier.deciding.len() == planes.len() {
            classifier.logit.evaluate(planes)
        } else {
            for (to, &column) in tile.deciding.iter_mut().zip(&classifier.deciding) {
                *to = planes[column];
            }
            classifier.logit.evaluate(&tile.deciding[..classifier.deciding.len()])
        };
        let [like_painted, unlike_painted] = classifier.calibration;
        let (mut mask, mut probability) = ([0.0; TILE], [0.0; TILE]);
        for k in 0..TILE {
            let calibration = like_painted + (unlike_painted - like_painted) * unseen[k];
            probability[k] = 1.0 / (1.0 + exp_f32(-calibration * logit[k]));
            mask[k] = if probability[k] > 0.5 { 1.0 } else { 0.0 };
        }
        Answer { mask, probability, unseen, all_finite }
    }
}

/// Classifies every pixel of `features`. The samples store some of the image's channels, one per column: `channels[i]`
/// is the image channel in column i. If `region` is given, the results are 0 where it is at most 0.5.
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
    let classifier = Classifier {
        channels,
        has_all_channels: features.channels == CHANNELS && channels.len() == CHANNELS,
        mean: single(&chosen.standard.mean),
        scale: single(&chosen.standard.scale),
        logit: QuadraticForm::of_model(chosen),
        deciding: chosen.columns.clone(),
        seen: chosen.seen.each_ref().map(QuadraticForm::of_ellipsoid),
        calibration: [chosen.held_out_parts.scale as f32, chosen.held_out_strokes.scale as f32],
    };
    let Blank { mut mask, mut confidence, mut unseen } = blank;
    let bad = AtomicUsize::new(0);
    let looks_at_all = channels.len() == features.channels;
    // The sum of `unseen` over each row, as the bits of an `f64`. Adding the sums in the order of rows gives the same
    // mean for any number of threads.
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
            let mut answer = classify(&classifier, pixels, features.channels, &mut tile, &mut likely);
            if !(answer.all_finite && looks_at_all) {
                bad.fetch_add(count_bad(pixels), Ordering::Relaxed);
            }
            if let Some(region) = region {
                for (k, &w) in region.row(y)[x..x + n].iter().enumerate() {
                    if w.is_nan() || w <= 0.5 {
                        (answer.mask[k], answer.probability[k], answer.unseen[k]) = (0.0, 0.0, 0.0);
                    }
                }
            }
            sum += f64::from(sum_of(&answer.unseen[..n]));
            mask[x..x + n].copy_from_slice(&answer.mask[..n]);
            confidence[x..x + n].copy_from_slice(&answer.probability[..n]);
            unseen[x..x + n].copy_from_slice(&answer.unseen[..n]);
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

/// Returns the sum of all values. It is computed as eight partial sums, which compilers vectorise.
fn sum_of(values: &[f32]) -> f32 {
    let (chunks, rest) = values.as_chunks::<8>();
    let mut sums = [0.0; 8];
    chunks.iter().for_each(|chunk| sums.iter_mut().zip(chunk).for_each(|(sum, v)| *sum += v));
    sums.iter().chain(rest).sum()
}
