//! The classifier over the whole image: tiles of a row, one plane per feature, one quadratic form for each answer.

use super::Model;
use super::select::{Chosen, Ellipsoid};
use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::job::Job;

/// Pixels worked on together: their planes stay in the first-level cache.
const TILE: usize = 64;

pub struct Classified {
    pub mask: Image,
    pub confidence: Image,
    pub unseen: Image,
    /// Mean of `unseen` over the pixels looked at.
    pub mean_unseen: f64,
}

/// `xᵀAx + bᵀx + c` of standardised features; `a` holds the upper triangle row by row, empty if `A` is zero.
struct Form {
    a: Vec<f32>,
    b: Vec<f32>,
    c: f32,
}

impl Form {
    fn of_model(chosen: &Chosen, d: usize) -> Self {
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

    fn evaluate(&self, planes: &[[f32; TILE]]) -> [f32; TILE] {
        let mut sum = [self.c; TILE];
        let mut rest = self.a.as_slice();
        for (i, x) in planes.iter().enumerate() {
            // x_i (b_i + Σ_{j >= i} a_ij x_j)
            let mut factor = [self.b[i]; TILE];
            if !rest.is_empty() {
                let (row, after) = rest.split_at(planes.len() - i);
                rest = after;
                for (a, y) in row.iter().zip(&planes[i..]) {
                    factor.iter_mut().zip(y).for_each(|(f, y)| *f += a * y);
                }
            }
            for k in 0..TILE {
                sum[k] += factor[k] * x[k];
            }
        }
        sum
    }
}

pub fn run(
    features: &Image,
    within: Option<&Image>,
    channels: &[usize],
    chosen: &Chosen,
    job: Job,
) -> Result<Classified> {
    let (width, height, d) = (features.width, features.height, channels.len());
    let logit = Form::of_model(chosen, d);
    let seen: Vec<Form> = chosen.seen.iter().map(Form::of_ellipsoid).collect();
    let mean: Vec<f32> = chosen.standard.mean.iter().map(|&v| v as f32).collect();
    let scale: Vec<f32> = chosen.standard.scale.iter().map(|&v| v as f32).collect();

    let (familiar, unfamiliar) = (chosen.familiar.scale as f32, chosen.unfamiliar.scale as f32);

    // Confidence and unseen in one pass, interleaved.
    let mut both = Image::new(width, height, 2)?;
    exec::for_rows(&mut both.data, width * 2, job.part(0.0, 0.8), |y, row| {
        let source = features.row(y);
        let mut planes = vec![[0.0f32; TILE]; d];
        for (t, out) in row.chunks_mut(2 * TILE).enumerate() {
            let pixels = source[t * TILE * features.channels..].chunks_exact(features.channels).take(TILE);
            for (k, pixel) in pixels.enumerate() {
                for (i, &c) in channels.iter().enumerate() {
                    planes[i][k] = (pixel[c] - mean[i]) * scale[i];
                }
            }
            let z = logit.evaluate(&planes);
            let distance = seen.iter().map(|form| form.evaluate(&planes));
            let nearest = distance.fold([f32::INFINITY; TILE], |a, b| std::array::from_fn(|k| a[k].min(b[k])));
            for (k, out) in out.chunks_exact_mut(2).enumerate() {
                let beyond = 1.0 - (1.0 - nearest[k].max(1.0).sqrt()).exp();
                let calibration = familiar + (unfamiliar - familiar) * beyond;
                out[0] = 1.0 / (1.0 + (-calibration * z[k]).exp());
                out[1] = beyond;
            }
        }
    })?;

    let (mut confidence, mut unseen) = (both.channel(0)?, both.channel(1)?);
    if let Some(within) = within {
        for (i, _) in within.data.iter().enumerate().filter(|(_, w)| w.is_nan() || **w <= 0.5) {
            confidence.data[i] = 0.0;
            unseen.data[i] = 0.0;
        }
    }
    let looked_at = within.map_or(width * height, |w| w.data.iter().filter(|w| **w > 0.5).count());
    let mean_unseen = unseen.data.iter().map(|&u| f64::from(u)).sum::<f64>() / looked_at.max(1) as f64;
    let mut mask = Image::new(width, height, 1)?;
    mask.data.iter_mut().zip(&confidence.data).for_each(|(m, &c)| *m = f32::from(c > 0.5));
    job.report(1.0);
    Ok(Classified { mask, confidence, unseen, mean_unseen })
}
