//! The classifier over the whole image: tiles of a row, one plane per feature, one quadratic form for each answer.

use super::Model;
use super::select::{Chosen, Ellipsoid};
use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::job::Job;
use crate::simd::widest;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Pixels worked on together: their planes stay in the first-level cache.
const TILE: usize = 64;

/// A feature of the pixels of a tile.
type Plane = [f32; TILE];

pub struct Classified {
    pub mask: Image,
    pub confidence: Image,
    pub unseen: Image,
    /// Mean of `unseen` over the pixels looked at.
    pub mean_unseen: f64,
    /// Feature values that are NaN or infinite.
    pub bad: usize,
}

/// The answers, still black: making room for them takes a while, which training can share.
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

/// Everything that answers for a tile.
struct Judge {
    mean: Vec<f32>,
    scale: Vec<f32>,
    logit: Form,
    /// The planes that the logit is of.
    columns: Vec<usize>,
    seen: Vec<Form>,
    /// All planes.
    all: Vec<usize>,
    /// Factors on logits where features are like those painted, and where not.
    calibration: [f32; 2],
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

    #[inline(always)]
    fn evaluate(&self, planes: &[Plane], columns: &[usize]) -> Plane {
        let mut sum = [self.c; TILE];
        let mut rest = self.a.as_slice();
        for (i, &column) in columns.iter().enumerate() {
            let x = &planes[column];
            // x_i (b_i + Σ_{j >= i} a_ij x_j)
            let mut factor = [self.b[i]; TILE];
            if !rest.is_empty() {
                let (row, after) = rest.split_at(columns.len() - i);
                rest = after;
                for (a, &column) in row.iter().zip(&columns[i..]) {
                    let y = &planes[column];
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

widest! {
    /// Probability and distance from what was seen of a tile whose planes hold raw features.
    fn judge(judge: &Judge, planes: &mut [Plane], probability: &mut Plane, beyond: &mut Plane) {
        for (plane, (mean, scale)) in planes.iter_mut().zip(judge.mean.iter().zip(&judge.scale)) {
            for v in plane {
                *v = (*v - mean) * scale;
            }
        }
        let mut nearest = [f32::INFINITY; TILE];
        for form in &judge.seen {
            let distance = form.evaluate(planes, &judge.all);
            for k in 0..TILE {
                nearest[k] = if distance[k] < nearest[k] { distance[k] } else { nearest[k] };
            }
            // Nothing is nearer than within.
            if nearest.iter().fold(true, |within, &v| within & (v <= 1.0)) {
                break;
            }
        }
        let logit = judge.logit.evaluate(planes, &judge.columns);
        let [familiar, unfamiliar] = judge.calibration;
        for k in 0..TILE {
            let distance = if nearest[k] > 1.0 { nearest[k].sqrt() } else { 1.0 };
            beyond[k] = 1.0 - exp(1.0 - distance);
            let calibration = familiar + (unfamiliar - familiar) * beyond[k];
            probability[k] = 1.0 / (1.0 + exp(-calibration * logit[k]));
        }
    }
}

/// Classifies every pixel by its features, of which `channels` are the samples' columns; outside `within` (above one half) all answers are 0.
pub fn run(
    features: &Image,
    within: Option<&Image>,
    channels: &[usize],
    chosen: &Chosen,
    blank: Blank,
    job: Job,
) -> Result<Classified> {
    let (width, height, d) = (features.width, features.height, channels.len());
    let single = |values: &[f64]| values.iter().map(|&v| v as f32).collect();
    let judges = Judge {
        mean: single(&chosen.standard.mean),
        scale: single(&chosen.standard.scale),
        logit: Form::of_model(chosen),
        columns: chosen.columns.clone(),
        all: (0..d).collect(),
        seen: chosen.seen.iter().map(Form::of_ellipsoid).collect(),
        calibration: [chosen.familiar.scale as f32, chosen.unfamiliar.scale as f32],
    };
    let Blank { mut mask, mut confidence, mut unseen } = blank;
    let bad = AtomicUsize::new(0);
    let images = [&mut mask, &mut confidence, &mut unseen].map(|image| image.data.as_mut_slice());
    exec::for_rows_of_three(images, width, job.part(0.0, 0.9), |y, [mask, confidence, unseen]| {
        let source = features.row(y);
        let bad_here = count_bad(source);
        if bad_here > 0 {
            bad.fetch_add(bad_here, Ordering::Relaxed);
        }
        let mut planes = vec![[0.0f32; TILE]; d];
        let (mut probability, mut beyond) = ([0.0; TILE], [0.0; TILE]);
        for x in (0..width).step_by(TILE) {
            let n = TILE.min(width - x);
            let pixels = source[x * features.channels..(x + n) * features.channels].chunks_exact(features.channels);
            for (k, pixel) in pixels.enumerate() {
                for (plane, &c) in planes.iter_mut().zip(channels) {
                    plane[k] = pixel[c];
                }
            }
            judge(&judges, &mut planes, &mut probability, &mut beyond);
            if let Some(within) = within {
                for (k, &w) in within.row(y)[x..x + n].iter().enumerate() {
                    if w.is_nan() || w <= 0.5 {
                        (probability[k], beyond[k]) = (0.0, 0.0);
                    }
                }
            }
            confidence[x..x + n].copy_from_slice(&probability[..n]);
            unseen[x..x + n].copy_from_slice(&beyond[..n]);
            mask[x..x + n].iter_mut().zip(&probability).for_each(|(m, &p)| *m = f32::from(p > 0.5));
        }
    })?;
    let sums = exec::map(height, job.part(0.9, 1.0), |y| unseen.row(y).iter().map(|&u| f64::from(u)).sum::<f64>())?;
    let looked_at = within.map_or(width * height, |w| w.data.iter().filter(|w| **w > 0.5).count());
    let mean_unseen = sums.iter().sum::<f64>() / looked_at.max(1) as f64;
    Ok(Classified { mask, confidence, unseen, mean_unseen, bad: bad.into_inner() })
}

widest! {
    /// The number of values that are NaN or infinite.
    pub fn count_bad(values: &[f32]) -> usize {
        values.iter().map(|v| u32::from(!v.is_finite())).sum::<u32>() as usize
    }
}

/// `eˣ` for x in `[-87, 88]`, beyond that its value at the end: within 3e-7 of it, and the same on all machines.
#[inline(always)]
fn exp(x: f32) -> f32 {
    const LN_2: [f32; 2] = [0.693_359_4, -2.121_944_4e-4];
    // Adding 1.5 × 2²³ rounds to a whole number, which then stands in the lowest bits.
    const ROUND: f32 = 12_582_912.0;
    let x = x.clamp(-87.0, 88.0);
    let shifted = x * std::f32::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = x - n * LN_2[0] - n * LN_2[1];
    let p = [1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0].into_iter().fold(1.0 / 720.0, |p, c| p * r + c);
    p * f32::from_bits(shifted.to_bits().wrapping_add(127) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_the_exponential() {
        for i in -8700..=8800 {
            let x = i as f32 / 100.0;
            let relative = f64::from(exp(x)) / f64::from(x).exp() - 1.0;
            assert!(relative.abs() < 3e-7, "{x}: {relative}");
        }
        assert_eq!(exp(0.0), 1.0);
        assert!(exp(-1e30) < 1e-37 && exp(1e30) > 1e38 && exp(f32::NEG_INFINITY) >= 0.0);
    }
}
