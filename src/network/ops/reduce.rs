//! Reductions along axes: sums, means and extrema.

use super::super::tensor::{Tensor, count};
use super::call::{Call, Settings};
use crate::error::Result;

pub struct Reduce {
    kind: Kind,
    axes: Option<Vec<i64>>,
    keeps: bool,
    none_if_empty: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Mean,
    Sum,
    Max,
    Min,
}

impl Reduce {
    pub fn read(kind: &str, at: &Settings) -> Self {
        let kind = match kind {
            "ReduceMean" => Kind::Mean,
            "ReduceSum" => Kind::Sum,
            "ReduceMax" => Kind::Max,
            _ => Kind::Min,
        };
        let none_if_empty = at.integer("noop_with_empty_axes", 0) == 1;
        Self { kind, axes: at.integers("axes"), keeps: at.integer("keepdims", 1) == 1, none_if_empty }
    }

    pub fn run(&self, call: &Call) -> Result<Tensor> {
        let x = call.input(0)?;
        let axes = call.integers(self.axes.as_deref(), 1)?.unwrap_or_default();
        if axes.is_empty() && self.none_if_empty {
            return Ok(x.clone());
        }
        let mut is_reduced = vec![axes.is_empty(); x.shape.len()];
        for axis in axes {
            is_reduced[x.axis(axis)?] = true;
        }

        // Compute the output shape, and for each input axis the stride of the output: 0 along reduced axes.
        let kept: Vec<usize> = x.shape.iter().zip(&is_reduced).map(|(&n, &r)| if r { 1 } else { n }).collect();
        let mut strides = vec![0; kept.len()];
        let mut stride = 1;
        for (k, &n) in kept.iter().enumerate().rev() {
            strides[k] = if is_reduced[k] { 0 } else { stride };
            stride *= n;
        }
        let total = count(&kept)?;
        let start = match self.kind {
            Kind::Mean | Kind::Sum => 0.0,
            Kind::Max => f64::NEG_INFINITY,
            Kind::Min => f64::INFINITY,
        };
        let mut sums = call.budget.vec(total, start)?;
        let last = x.shape.last().copied().unwrap_or(1).max(1);
        let step = strides.last().copied().unwrap_or(0);
        for (row, values) in x.as_floats()?.chunks_exact(last).enumerate() {
            if row % 4096 == 0 {
                call.job.check()?;
            }
            let (mut rest, mut to) = (row, 0);
            for k in (0..x.shape.len().saturating_sub(1)).rev() {
                to += rest % x.shape[k] * strides[k];
                rest /= x.shape[k];
            }
            for (i, &v) in values.iter().enumerate() {
                let sum = &mut sums[to + i * step];
                *sum = match self.kind {
                    Kind::Mean | Kind::Sum => *sum + f64::from(v),
                    Kind::Max => sum.max(f64::from(v)),
                    Kind::Min => sum.min(f64::from(v)),
                };
            }
        }
        let scale = if self.kind == Kind::Mean { total as f64 / x.len().max(1) as f64 } else { 1.0 };
        let out: Vec<f32> = sums.into_iter().map(|sum| (sum * scale) as f32).collect();
        let shape = if self.keeps {
            kept
        } else {
            x.shape.iter().zip(&is_reduced).filter(|(_, r)| !**r).map(|(&n, _)| n).collect()
        };
        Ok(Tensor::floats(shape, out))
    }
}
