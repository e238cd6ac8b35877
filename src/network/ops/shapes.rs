//! Operators on shapes: reshaping, querying, joining and splitting. Most of them move no data.

use super::super::tensor::{Data, Tensor, count, normal_axis};
use super::call::Call;
use super::gather::shape_from;
use crate::error::{Error, Result};

/// Reshapes a tensor. A size of 0 means the input's size along the same axis, unless `keeps_zero`. One size may be -1:
/// it is chosen such that the number of elements stays the same.
pub fn reshape(keeps_zero: bool, call: &Call) -> Result<Tensor> {
    let x = call.input(0)?;
    let wanted = call.input(1)?.as_integers()?;
    let wrong = || Error::format(format!("a tensor of shape {:?} cannot be reshaped to {wanted:?}", x.shape));
    let mut shape = Vec::with_capacity(wanted.len());
    let mut open = None;
    for (k, &size) in wanted.iter().enumerate() {
        shape.push(match size {
            -1 if open.is_none() => {
                open = Some(k);
                1
            }
            0 if !keeps_zero => *x.shape.get(k).ok_or_else(wrong)?,
            size => usize::try_from(size).map_err(|_| wrong())?,
        });
    }
    if let Some(k) = open {
        shape[k] = x.len().checked_div(count(&shape)?).ok_or_else(wrong)?;
    }
    x.reshaped(shape)
}

/// Flattens a tensor to two axes: the axes before `axis`, and the remaining axes.
pub fn flatten(axis: i64, call: &Call) -> Result<Tensor> {
    let x = call.input(0)?;
    let rank = x.shape.len() as i64;
    let axis = if axis == rank { x.shape.len() } else { x.axis(axis)? };
    x.reshaped(vec![count(&x.shape[..axis])?, count(&x.shape[axis..])?])
}

pub fn squeeze(axes: Option<&[i64]>, call: &Call) -> Result<Tensor> {
    let x = call.input(0)?;
    let mut goes: Vec<bool> = x.shape.iter().map(|&n| n == 1).collect();
    if let Some(axes) = call.integers(axes, 1)? {
        goes.fill(false);
        for axis in axes {
            goes[x.axis(axis)?] = true;
        }
    }
    let shape = x.shape.iter().zip(goes).filter(|(_, goes)| !goes).map(|(&n, _)| n).collect();
    x.reshaped(shape)
}

pub fn unsqueeze(axes: Option<&[i64]>, call: &Call) -> Result<Tensor> {
    let x = call.input(0)?;
    let axes = call.integers(axes, 1)?.ok_or_else(|| Error::format("axes are missing"))?;
    let rank = x.shape.len() + axes.len();
    let mut is_new = vec![false; rank];
    for &axis in &axes {
        is_new[normal_axis(axis, rank)?] = true;
    }
    let mut old = x.shape.iter();
    let sizes = is_new.iter().map(|&is_new| if is_new { Some(1) } else { old.next().copied() });
    let shape: Option<Vec<usize>> = sizes.collect();
    x.reshaped(shape.ok_or_else(|| Error::format(format!("axes are {axes:?}; no axis may occur twice")))?)
}

pub fn concat(axis: i64, call: &Call) -> Result<Tensor> {
    let first = call.input(0)?;
    let axis = first.axis(axis)?;
    let tensors: Vec<&Tensor> = (0..call.inputs.len()).map(|k| call.input(k)).collect::<Result<_>>()?;
    let mut shape = first.shape.clone();
    shape[axis] = 0;
    for tensor in &tensors {
        let fits =
            tensor.shape.len() == shape.len() && (0..shape.len()).all(|k| k == axis || tensor.shape[k] == shape[k]);
        if !fits {
            return Err(Error::format(format!("shapes {:?} and {:?} cannot be joined", first.shape, tensor.shape)));
        }
        shape[axis] += tensor.shape[axis];
    }
    let total = count(&shape)?;
    let outer = if total == 0 { 0 } else { count(&shape[..axis])? };

    fn joined<T: Copy>(parts: &[&[T]], outer: usize, out: &mut Vec<T>) {
        for k in 0..outer {
            for part in parts {
                let length = part.len() / outer;
                out.extend_from_slice(&part[k * length..(k + 1) * length]);
            }
        }
    }
    Ok(match &first.data {
        Data::Floats(_) => {
            let parts: Vec<&[f32]> = tensors.iter().map(|t| t.as_floats()).collect::<Result<_>>()?;
            let mut out = call.budget.vec(total, 0.0)?;
            out.clear();
            joined(&parts, outer, &mut out);
            Tensor::floats(shape, out)
        }
        Data::Integers(_) => {
            let parts: Vec<&[i64]> = tensors.iter().map(|t| t.as_integers()).collect::<Result<_>>()?;
            let mut out = call.budget.vec(total, 0)?;
            out.clear();
            joined(&parts, outer, &mut out);
            Tensor::integers(shape, out)
        }
    })
}

pub fn split(axis: i64, sizes: Option<&[i64]>, call: &Call) -> Result<Vec<Tensor>> {
    let x = call.input(0)?;
    let axis = x.axis(axis)?;
    let size = x.shape[axis];
    let sizes: Vec<usize> = match call.integers(sizes, 1)? {
        Some(sizes) => sizes.iter().filter_map(|&n| usize::try_from(n).ok()).collect(),
        // Give every output ⌈size / outputs⌉ elements along the axis; the last outputs may get fewer.
        None => {
            let even = size.div_ceil(call.outputs.max(1));
            (0..call.outputs).map(|k| even.min(size.saturating_sub(k * even))).collect()
        }
    };
    if sizes.iter().try_fold(0usize, |sum, &n| sum.checked_add(n)) != Some(size) {
        return Err(Error::format(format!("parts of {sizes:?} do not sum to an axis of {size}")));
    }
    let after: usize = x.shape[axis + 1..].iter().product();
    let mut parts = Vec::new();
    let mut start = 0;
    for part in sizes {
        let mut shape = x.shape.clone();
        shape[axis] = part;
        let stride = size * after;
        let range = start * after..(start + part) * after;
        parts.push(match &x.data {
            Data::Floats(values) => {
                let mut out = call.budget.vec(count(&shape)?, 0.0)?;
                out.clear();
                values.chunks_exact(stride.max(1)).for_each(|chunk| out.extend_from_slice(&chunk[range.clone()]));
                Tensor::floats(shape, out)
            }
            Data::Integers(values) => {
                let mut out = call.budget.vec(count(&shape)?, 0)?;
                out.clear();
                values.chunks_exact(stride.max(1)).for_each(|chunk| out.extend_from_slice(&chunk[range.clone()]));
                Tensor::integers(shape, out)
            }
        });
        start += part;
    }
    Ok(parts)
}

/// Returns the sizes of the axes from `start` up to, but excluding, `end`. Negative indices count from the end, and
/// without an `end` the last axis is included.
pub fn shape(start: i64, end: Option<i64>, call: &Call) -> Result<Tensor> {
    let x = call.input(0)?;
    let rank = x.shape.len() as i64;
    let at = |v: i64| (if v < 0 { v.saturating_add(rank) } else { v }).clamp(0, rank) as usize;
    let (start, end) = (at(start), at(end.unwrap_or(rank)));
    let sizes: Vec<i64> = x.shape[start..end.max(start)].iter().map(|&n| n as i64).collect();
    Ok(Tensor::integers(vec![sizes.len()], sizes))
}

pub fn filled(value: &Tensor, call: &Call) -> Result<Tensor> {
    let shape = shape_from(call.input(0)?)?;
    let total = count(&shape)?;
    Ok(match &value.data {
        Data::Floats(values) => {
            let value = values.first().copied().unwrap_or(0.0);
            Tensor::floats(shape, call.budget.vec(total, value)?)
        }
        Data::Integers(values) => {
            let value = values.first().copied().unwrap_or(0);
            Tensor::integers(shape, call.budget.vec(total, value)?)
        }
    })
}

/// Returns `start, start + delta, ...` up to, but excluding, the limit.
pub fn range(call: &Call) -> Result<Tensor> {
    let [start, limit, delta] = [call.input(0)?, call.input(1)?, call.input(2)?];
    let wrong = || Error::format("a range needs a start, a limit and a step that is not 0");
    if let Data::Floats(_) = &start.data {
        let of = |tensor: &Tensor| Ok(tensor.as_floats()?.first().copied().unwrap_or(0.0));
        let (start, limit, delta): (f32, f32, f32) = (of(start)?, of(limit)?, of(delta)?);
        let steps = ((limit - start) / delta).ceil().max(0.0);
        if !steps.is_finite() {
            return Err(wrong());
        }
        let mut out = call.budget.vec(steps as usize, start)?;
        out.iter_mut().enumerate().for_each(|(i, v)| *v += i as f32 * delta);
        return Ok(Tensor::floats(vec![out.len()], out));
    }
    let of = |tensor: &Tensor| Ok(tensor.as_integers()?.first().copied().unwrap_or(0));
    let (start, limit, delta): (i64, i64, i64) = (of(start)?, of(limit)?, of(delta)?);
    let span = i128::from(limit) - i128::from(start);
    if delta == 0 {
        return Err(wrong());
    }
    let delta = i128::from(delta);
    let steps = if (span > 0) == (delta > 0) { (span.abs() + delta.abs() - 1) / delta.abs() } else { 0 };
    let mut out = call.budget.vec(usize::try_from(steps).map_err(|_| wrong())?, start)?;
    out.iter_mut().enumerate().for_each(|(i, v)| *v = v.wrapping_add((i as i64).wrapping_mul(delta as i64)));
    Ok(Tensor::integers(vec![out.len()], out))
}
