//! Features to zero mean and unit spread, and the terms of the models.

use super::Model;
use super::samples::Samples;

/// The affine map that makes the samples' features comparable; features without spread become 0.
#[derive(Clone, Debug)]
pub struct Standard {
    pub mean: Vec<f64>,
    pub scale: Vec<f64>,
}

impl Standard {
    pub fn of(samples: &Samples) -> Self {
        let (n, d) = (samples.positive.len() as f64, samples.dimension);
        let mut mean = vec![0.0; d];
        let mut square = vec![0.0; d];
        for x in samples.values.chunks_exact(d) {
            x.iter().zip(&mut mean).for_each(|(x, m)| *m += x / n);
        }
        for x in samples.values.chunks_exact(d) {
            (0..d).for_each(|i| square[i] += (x[i] - mean[i]).powi(2) / n);
        }
        let scale = (0..d)
            .map(|i| {
                let spread = square[i].sqrt();
                // Below rounding of the features themselves there is nothing to learn.
                if spread > 1e-6 * mean[i].abs().max(1e-30) { 1.0 / spread } else { 0.0 }
            })
            .collect();
        Self { mean, scale }
    }

    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        (0..x.len()).map(|i| (x[i] - self.mean[i]) * self.scale[i]).collect()
    }
}

/// Number of terms of a model in `d` features, the constant last.
pub fn term_count(model: Model, d: usize) -> usize {
    match model {
        Model::Linear => d + 1,
        Model::Quadratic => d * (d + 1) / 2 + d + 1,
    }
}

/// The terms of a model at standardised features: the features, their products `i <= j`, and 1.
pub fn terms(model: Model, x: &[f64], out: &mut Vec<f64>) {
    out.extend_from_slice(x);
    if model == Model::Quadratic {
        for i in 0..x.len() {
            out.extend(x[i..].iter().map(|v| v * x[i]));
        }
    }
    out.push(1.0);
}
