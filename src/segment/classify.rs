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
    let is_outside = |i: usize| within.is_some_and(|w| w.data[i].is_nan() || w.data[i] <= 0.5);
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
            let beyond: [f32; TILE] = std::array::from_fn(|k| 1.0 - exp(1.0 - nearest[k].max(1.0).sqrt()));
            let probability: [f32; TILE] = std::array::from_fn(|k| {
                let calibration = familiar + (unfamiliar - familiar) * beyond[k];
                1.0 / (1.0 + exp(-calibration * z[k]))
            });
            for (k, out) in out.chunks_exact_mut(2).enumerate() {
                let answer = [probability[k], beyond[k]];
                out.copy_from_slice(if is_outside(y * width + t * TILE + k) { &[0.0; 2] } else { &answer });
            }
        }
    })?;

    // Apart.
    let (mut confidence, mut unseen) = (Image::new(width, height, 1)?, Image::new(width, height, 1)?);
    let mut mask = Image::new(width, height, 1)?;
    let split = |image: &mut Image, value: &(dyn Fn([f32; 2]) -> f32 + Sync), job: Job| {
        exec::for_rows(&mut image.data, width, job, |y, row| {
            row.iter_mut().zip(both.row(y).chunks_exact(2)).for_each(|(out, v)| *out = value([v[0], v[1]]));
        })
    };
    split(&mut confidence, &|v| v[0], job.part(0.8, 0.85))?;
    split(&mut unseen, &|v| v[1], job.part(0.85, 0.9))?;
    split(&mut mask, &|v| f32::from(v[0] > 0.5), job.part(0.9, 0.95))?;
    let sums = exec::map(height, job.part(0.95, 1.0), |y| unseen.row(y).iter().map(|&u| f64::from(u)).sum::<f64>())?;
    let looked_at = within.map_or(width * height, |w| w.data.iter().filter(|w| **w > 0.5).count());
    let mean_unseen = sums.iter().sum::<f64>() / looked_at.max(1) as f64;
    Ok(Classified { mask, confidence, unseen, mean_unseen })
}

/// `eˣ` for x in `[-87, 88]`, beyond that its value at the end: within 3e-7 of it, and the same on all machines.
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
