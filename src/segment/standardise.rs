//! Standardises features to zero mean and a standard deviation of at most 1, and computes the linear and quadratic
//! terms of the models.

use super::samples::Samples;
use super::segmentation::Model;
use super::table::Table;
use crate::error::Result;
use crate::maths;

/// Channels that form a vector: CIELAB colour, position and normal. The components of a vector have one unit, so they
/// share one scale: the scale of the component that varies most. With a scale per channel, a channel that hardly varies
/// would be amplified. Example: under strokes on white lamps and a white ceiling, a* and b* vary little. With scales of
/// their own they would outweigh brightness, and dark purple frames would be classified as lamps.
const VECTORS: [std::ops::Range<usize>; 3] = [0..3, 4..7, 7..10];

/// Standardisation of features, `(x - mean) * scale` per channel. The scale of a channel that does not vary is 0.
#[derive(Clone, Debug)]
pub struct Standard {
    pub mean: Vec<f64>,
    pub scale: Vec<f64>,
}

impl Standard {
    pub fn of(samples: &Samples) -> Self {
        let (n, d) = (samples.origins.len() as f64, samples.dimension);
        let mut mean = vec![0.0; d];
        let mut square = vec![0.0; d];
        for x in samples.values.chunks_exact(d) {
            x.iter().zip(&mut mean).for_each(|(x, m)| *m += x / n);
        }
        for x in samples.values.chunks_exact(d) {
            (0..d).for_each(|i| square[i] += maths::powi(x[i] - mean[i], 2) / n);
        }
        let spread: Vec<f64> = square.iter().map(|v| v.sqrt()).collect();
        let vector_of = |i: usize| VECTORS.iter().position(|v| v.contains(&samples.channels[i]));
        let scale = (0..d)
            .map(|i| {
                // A deviation at the level of rounding errors carries no information.
                if spread[i] <= 1e-6 * mean[i].abs().max(1e-30) {
                    return 0.0;
                }
                let partners = (0..d).filter(|&j| j == i || (vector_of(i).is_some() && vector_of(j) == vector_of(i)));
                1.0 / partners.map(|j| spread[j]).fold(0.0, f64::max)
            })
            .collect();
        Self { mean, scale }
    }

    /// Standardises features that are stored sample after sample.
    pub fn apply(&self, values: &[f64]) -> Result<Table> {
        let mut table = Table::of(values, self.mean.len())?;
        for (rows, block) in table.blocks_mut() {
            for (lanes, (mean, scale)) in block.iter_mut().zip(self.mean.iter().zip(&self.scale)) {
                lanes[..rows].iter_mut().for_each(|v| *v = (*v - mean) * scale);
            }
        }
        Ok(table)
    }
}

/// Number of terms of a model of `d` features, including the constant term.
pub fn term_count(model: Model, d: usize) -> usize {
    match model {
        Model::Linear => d + 1,
        Model::Quadratic => d * (d + 1) / 2 + d + 1,
    }
}

/// Computes the terms of a model on the given columns: the standardised features; for a quadratic model, also their
/// products `x_i x_j` with `i <= j`; and the constant 1.
pub fn terms(model: Model, features: &Table, columns: &[usize]) -> Result<Table> {
    let mut terms = Table::new(features.rows, term_count(model, columns.len()))?;
    for ((rows, x), (_, to)) in features.blocks().zip(terms.blocks_mut()) {
        let mut to = to.iter_mut();
        columns.iter().zip(&mut to).for_each(|(&c, to)| *to = x[c]);
        if model == Model::Quadratic {
            let pairs = (0..columns.len()).flat_map(|i| columns[i..].iter().map(move |&c| (columns[i], c)));
            for ((a, b), to) in pairs.zip(&mut to) {
                to.iter_mut().zip(x[a].iter().zip(&x[b])).for_each(|(to, (a, b))| *to = a * b);
            }
        }
        to.for_each(|constant| constant[..rows.len()].fill(1.0));
    }
    Ok(terms)
}
