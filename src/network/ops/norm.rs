//! Normalisation operators and the softmax.

use super::super::tensor::Tensor;
use super::call::Call;
use crate::error::{Error, Result};
use crate::exec;
use crate::maths;

/// Computes `scale (x - mean) / √(variance + ε) + bias`. Inputs 1 to 4 hold scale, bias, mean and variance of each
/// channel.
pub fn batch(epsilon: f32, call: &Call) -> Result<Tensor> {
    let x = call.input(0)?;
    let channels = x.shape.get(1).copied().unwrap_or(1);
    let of_channel = |k: usize| channel_values(call.input(k)?, channels);
    let (scale, bias, mean, variance) = (of_channel(1)?, of_channel(2)?, of_channel(3)?, of_channel(4)?);
    let values = x.as_floats()?;
    let size: usize = x.shape.iter().skip(2).product();
    let mut out = call.budget.zeros(&x.shape)?;
    exec::for_rows(&mut out, size, call.job, |k, out| {
        let c = k % channels;
        let factor = scale[c] / (variance[c] + epsilon).sqrt();
        let offset = bias[c] - mean[c] * factor;
        out.iter_mut().zip(&values[k * size..]).for_each(|(out, v)| *out = v * factor + offset);
    })?;
    Ok(Tensor::floats(x.shape.clone(), out))
}

fn channel_values(tensor: &Tensor, channels: usize) -> Result<&[f32]> {
    let values = tensor.as_floats()?;
    if values.len() == channels {
        return Ok(values);
    }
    Err(Error::format(format!("{} values for {channels} channels", values.len())))
}

/// Normalises each channel of each image to zero mean and unit variance, then scales and shifts the channel.
pub fn instance(epsilon: f32, call: &Call) -> Result<Tensor> {
    let x = call.input(0)?;
    let channels = x.shape.get(1).copied().unwrap_or(1);
    let (scale, bias) = (channel_values(call.input(1)?, channels)?, channel_values(call.input(2)?, channels)?);
    let size: usize = x.shape.iter().skip(2).product();
    let values = x.as_floats()?;
    let mut out = call.budget.zeros(&x.shape)?;
    exec::for_rows(&mut out, size, call.job, |k, out| {
        let c = k % channels;
        standardise(&values[k * size..][..size], epsilon, out);
        out.iter_mut().for_each(|v| *v = *v * scale[c] + bias[c]);
    })?;
    Ok(Tensor::floats(x.shape.clone(), out))
}

/// Normalises to zero mean and unit variance over `axis` and all axes after it, then scales and shifts each element.
pub fn layer(axis: i64, epsilon: f32, call: &Call) -> Result<Tensor> {
    let x = call.input(0)?;
    let axis = x.axis(axis)?;
    let size: usize = x.shape[axis..].iter().product();
    let scale = channel_values(call.input(1)?, size)?;
    let bias = call.optional(2).map(|bias| channel_values(bias, size)).transpose()?;
    let values = x.as_floats()?;
    let mut out = call.budget.zeros(&x.shape)?;
    exec::for_rows(&mut out, size, call.job, |k, out| {
        standardise(&values[k * size..][..size], epsilon, out);
        out.iter_mut().zip(scale).for_each(|(v, s)| *v *= s);
        if let Some(bias) = bias {
            out.iter_mut().zip(bias).for_each(|(v, b)| *v += b);
        }
    })?;
    Ok(Tensor::floats(x.shape.clone(), out))
}

fn standardise(values: &[f32], epsilon: f32, out: &mut [f32]) {
    let n = values.len() as f64;
    let mean = values.iter().map(|&v| f64::from(v)).sum::<f64>() / n;
    let variance = values.iter().map(|&v| maths::powi(f64::from(v) - mean, 2)).sum::<f64>() / n;
    let factor = 1.0 / (variance + f64::from(epsilon)).sqrt();
    out.iter_mut().zip(values).for_each(|(out, &v)| *out = ((f64::from(v) - mean) * factor) as f32);
}

/// Computes `e^x / Σ e^x` along an axis or, if `flattens`, over this axis and all axes after it.
pub fn softmax(axis: i64, flattens: bool, call: &Call) -> Result<Tensor> {
    let x = call.input(0)?;
    let axis = x.axis(axis)?;
    let after: usize = if flattens { 1 } else { x.shape[axis + 1..].iter().product() };
    let size: usize = if flattens { x.shape[axis..].iter().product() } else { x.shape[axis] };
    let values = x.as_floats()?;
    let mut out = call.budget.zeros(&x.shape)?;
    exec::for_rows(&mut out, size * after, call.job, |k, out| {
        let values = &values[k * size * after..][..size * after];
        for i in 0..after {
            let items = || (i..size * after).step_by(after);
            let max = items().fold(f32::NEG_INFINITY, |max, j| max.max(values[j]));
            let mut sum = 0.0;
            for j in items() {
                out[j] = maths::exp(values[j] - max);
                sum += out[j];
            }
            items().for_each(|j| out[j] /= sum);
        }
    })?;
    Ok(Tensor::floats(x.shape.clone(), out))
}
