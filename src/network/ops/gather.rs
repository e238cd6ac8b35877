//! Operators that rearrange elements: along each axis, every output index maps to an input index, or to none.

use super::super::read::unsupported;
use super::super::tensor::{Data, Tensor, count};
use super::call::Call;
use crate::error::{Error, Result};
use crate::exec;

/// Returns a tensor of the given shape, with as many axes as `x`. The element at index `i` along an axis is the
/// element of `x` at index `index(axis, i)`, or `fill` if `index` is `None` for any axis.
fn picked(
    x: &Tensor,
    shape: Vec<usize>,
    fill: f32,
    call: &Call,
    index: impl Fn(usize, usize) -> Option<usize>,
) -> Result<Tensor> {
    let (total, rank) = (count(&shape)?, shape.len());
    // Allocate the output first: if its size is refused, the index maps, which are as long as the axes, need not be
    // computed.
    let data = match &x.data {
        Data::Floats(values) => GatherData::Floats(values, call.budget.vec(total, fill)?),
        Data::Integers(values) => GatherData::Integers(values, call.budget.vec(total, fill as i64)?),
    };
    let maps: Vec<Vec<Option<usize>>> = if total == 0 {
        Vec::new()
    } else {
        (0..rank)
            .map(|axis| (0..shape[axis]).map(|i| index(axis, i).filter(|&i| i < x.shape[axis])).collect())
            .collect()
    };
    let rows = Rows { from: &x.shape, to: &shape, maps: &maps };
    let data = match data {
        GatherData::Floats(values, mut out) => {
            rows.copy(values, &mut out, call)?;
            return Ok(Tensor::floats(shape, out));
        }
        GatherData::Integers(values, mut out) => {
            rows.copy(values, &mut out, call)?;
            out
        }
    };
    Ok(Tensor::integers(shape, data))
}

enum GatherData<'a> {
    Floats(&'a [f32], Vec<f32>),
    Integers(&'a [i64], Vec<i64>),
}

struct Rows<'a> {
    from: &'a [usize],
    to: &'a [usize],
    maps: &'a [Vec<Option<usize>>],
}

impl Rows<'_> {
    fn copy<T: Copy + Send + Sync>(&self, values: &[T], out: &mut [T], call: &Call) -> Result<()> {
        let outer = self.to.len().saturating_sub(1);
        let length = self.to.last().copied().unwrap_or(1);
        exec::for_rows(out, length, call.job, |row, out| {
            // Compute where the source of this row starts: add up the offsets along the outer axes, from the innermost
            // of them outwards. `None` if an index maps to no input.
            let (mut start, mut rest) = (Some(0), row);
            let mut stride = self.from.last().copied().unwrap_or(1);
            for axis in (0..outer).rev() {
                let i = self.maps[axis][rest % self.to[axis]];
                rest /= self.to[axis];
                start = start.zip(i).map(|(start, i)| start + i * stride);
                stride *= self.from[axis];
            }
            let Some(start) = start else { return };
            match self.maps.last() {
                None => out[0] = values[start],
                Some(last) => {
                    for (out, i) in out.iter_mut().zip(last) {
                        if let Some(i) = i {
                            *out = values[start + i];
                        }
                    }
                }
            }
        })
    }
}

/// How an image continues beyond its border.
#[derive(Clone, Copy, PartialEq)]
pub enum Pad {
    Constant,
    Edge,
    Reflect,
}

impl Pad {
    pub fn read(mode: &str) -> Result<Self> {
        match mode {
            "constant" => Ok(Self::Constant),
            "edge" => Ok(Self::Edge),
            "reflect" => Ok(Self::Reflect),
            other => Err(unsupported(format_args!("padding of mode {other}"))),
        }
    }
}

pub fn pad(mode: Pad, pads: Option<&[i64]>, value: f32, call: &Call) -> Result<Tensor> {
    let x = call.input(0)?;
    let rank = x.shape.len();
    let pads = call.integers(pads, 1)?.filter(|pads| pads.len() == 2 * rank && call.optional(3).is_none());
    let pads = pads.ok_or_else(|| unsupported("padding that does not name every axis"))?;
    let value = match call.optional(2) {
        Some(tensor) => match &tensor.data {
            Data::Floats(values) => values.first().copied().unwrap_or(0.0),
            Data::Integers(values) => values.first().copied().unwrap_or(0) as f32,
        },
        None => value,
    };
    let mut shape = Vec::new();
    for (axis, &size) in x.shape.iter().enumerate() {
        let padded = pads[axis].checked_add(pads[axis + rank]).and_then(|sum| sum.checked_add(size as i64));
        let padded = padded.and_then(|n| usize::try_from(n).ok()).filter(|_| size > 0);
        shape.push(padded.ok_or_else(|| Error::format(format!("pads are {pads:?} for shape {:?}", x.shape)))?);
    }
    picked(x, shape, value, call, |axis, i| {
        let (at, last) = (i as i64 - pads[axis], x.shape[axis] as i64 - 1);
        let at = match mode {
            Pad::Constant => at,
            Pad::Edge => at.clamp(0, last),
            // Indices 0 1 2 continue as 0 1 2 1 0 1 2 ...
            Pad::Reflect if last == 0 => 0,
            Pad::Reflect => last - (at.rem_euclid(2 * last) - last).abs(),
        };
        usize::try_from(at).ok()
    })
}

pub fn slice(starts: Option<&[i64]>, ends: Option<&[i64]>, axes: Option<&[i64]>, call: &Call) -> Result<Tensor> {
    let x = call.input(0)?;
    let missing = || Error::format("starts or ends are missing");
    let starts = call.integers(starts, 1)?.ok_or_else(missing)?;
    let ends = call.integers(ends, 2)?.ok_or_else(missing)?;
    let axes = call.integers(axes, 3)?.unwrap_or_else(|| (0..starts.len() as i64).collect());
    let steps = call.integers(None, 4)?.unwrap_or_else(|| vec![1; starts.len()]);
    if ends.len() != starts.len() || axes.len() != starts.len() || steps.len() != starts.len() {
        return Err(Error::format("starts, ends, axes and steps differ in length"));
    }
    let mut shape = x.shape.clone();
    let mut from = vec![(0, 1); shape.len()];
    for (((&start, &end), &axis), &step) in starts.iter().zip(&ends).zip(&axes).zip(&steps) {
        let axis = x.axis(axis)?;
        let size = x.shape[axis] as i64;
        let wrapped = |v: i64| if v < 0 { v.saturating_add(size) } else { v };
        // Clip to the valid range, as numpy does.
        let (start, end) = match step {
            0 => return Err(Error::format("a slice has a step of 0")),
            1.. => (wrapped(start).clamp(0, size), wrapped(end).clamp(0, size)),
            _ => (wrapped(start).clamp(-1, size - 1), wrapped(end).clamp(-1, size - 1)),
        };
        let length = if step > 0 { end - start } else { start - end };
        shape[axis] = if length <= 0 { 0 } else { (length as u64).div_ceil(step.unsigned_abs()) as usize };
        from[axis] = (start, step);
    }
    picked(x, shape, 0.0, call, |axis, i| {
        let (start, step) = from[axis];
        usize::try_from((i as i64).checked_mul(step)?.checked_add(start)?).ok()
    })
}

/// Selects elements along an axis. The second input holds their indices.
pub fn gather(axis: i64, call: &Call) -> Result<Tensor> {
    let (x, indices) = (call.input(0)?, call.input(1)?);
    let axis = x.axis(axis)?;
    let size = x.shape[axis] as i64;
    let numbers = indices.as_integers()?;
    if let Some(bad) = numbers.iter().find(|i| !(-size..size).contains(*i)) {
        return Err(Error::format(format!("index is {bad}; the axis has {size} items")));
    }
    let mut shape = x.shape.clone();
    shape[axis] = numbers.len();
    let taken = picked(x, shape, 0.0, call, |k, i| {
        if k != axis { Some(i) } else { usize::try_from(numbers[i].rem_euclid(size)).ok() }
    })?;
    let mut shape = x.shape.clone();
    shape.splice(axis..=axis, indices.shape.iter().copied());
    taken.reshaped(shape)
}

/// Reads a shape from a tensor of integers.
pub fn shape_from(tensor: &Tensor) -> Result<Vec<usize>> {
    let sizes = tensor.as_integers()?;
    let of = |&d: &i64| usize::try_from(d).map_err(|_| Error::format(format!("a shape holds {d}")));
    sizes.iter().map(of).collect()
}

/// Inserts axes of size 1 before the first axis until the tensor has `rank` axes.
fn of_rank(x: &Tensor, rank: usize) -> Tensor {
    let mut shape = vec![1; rank.saturating_sub(x.shape.len())];
    shape.extend(&x.shape);
    Tensor { shape, data: x.data.clone() }
}

pub fn expand(call: &Call) -> Result<Tensor> {
    let wanted = shape_from(call.input(1)?)?;
    let x = of_rank(call.input(0)?, wanted.len());
    let mut shape = x.shape.clone();
    let first = shape.len() - wanted.len();
    for (to, &size) in shape[first..].iter_mut().zip(&wanted) {
        if *to != size && *to != 1 && size != 1 {
            return Err(Error::format(format!("a tensor of shape {:?} cannot be broadcast to {wanted:?}", x.shape)));
        }
        *to = if *to == 1 { size } else { *to };
    }
    let from = x.shape.clone();
    picked(&x, shape, 0.0, call, |axis, i| Some(if from[axis] == 1 { 0 } else { i }))
}

pub fn tile(call: &Call) -> Result<Tensor> {
    let x = call.input(0)?;
    let repeats = shape_from(call.input(1)?)?;
    if repeats.len() != x.shape.len() {
        return Err(Error::format(format!("{} repeats for {} axes", repeats.len(), x.shape.len())));
    }
    let sizes = x.shape.iter().zip(&repeats).map(|(&n, &r)| n.checked_mul(r));
    let shape: Option<Vec<usize>> = sizes.collect();
    let shape = shape.ok_or_else(|| Error::format(format!("repeats are {repeats:?}")))?;
    picked(x, shape, 0.0, call, |axis, i| Some(i % x.shape[axis]))
}

/// Permutes the axes: output axis `k` is input axis `order[k]`. An empty order reverses all axes.
pub fn transpose(order: &[i64], call: &Call) -> Result<Tensor> {
    turned(call.input(0)?, order, call)
}

fn turned(x: &Tensor, order: &[i64], call: &Call) -> Result<Tensor> {
    let rank = x.shape.len();
    let reversed: Vec<i64>;
    let order = if order.is_empty() {
        reversed = (0..rank as i64).rev().collect();
        &reversed
    } else {
        order
    };
    let order: Vec<usize> = order.iter().map(|&axis| x.axis(axis)).collect::<Result<_>>()?;
    if order.len() != rank || (0..rank).any(|axis| !order.contains(&axis)) {
        return Err(Error::format(format!("perm is {order:?} for {rank} axes")));
    }
    let mut strides = vec![1; rank];
    for axis in (0..rank.saturating_sub(1)).rev() {
        strides[axis] = strides[axis + 1] * x.shape[axis + 1];
    }
    let shape: Vec<usize> = order.iter().map(|&axis| x.shape[axis]).collect();
    let strides: Vec<usize> = order.iter().map(|&axis| strides[axis]).collect();

    fn copy<T: Copy + Send + Sync>(
        values: &[T],
        out: &mut [T],
        shape: &[usize],
        strides: &[usize],
        call: &Call,
    ) -> Result<()> {
        let length = shape.last().copied().unwrap_or(1);
        let step = strides.last().copied().unwrap_or(1);
        exec::for_rows(out, length, call.job, |row, out| {
            let (mut rest, mut start) = (row, 0);
            for axis in (0..shape.len().saturating_sub(1)).rev() {
                start += rest % shape[axis] * strides[axis];
                rest /= shape[axis];
            }
            out.iter_mut().enumerate().for_each(|(i, out)| *out = values[start + i * step]);
        })
    }
    match &x.data {
        Data::Floats(values) => {
            let mut out = call.budget.zeros(&shape)?;
            copy(values, &mut out, &shape, &strides, call)?;
            Ok(Tensor::floats(shape, out))
        }
        Data::Integers(values) => {
            let mut out = call.budget.vec(values.len(), 0i64)?;
            copy(values, &mut out, &shape, &strides, call)?;
            Ok(Tensor::integers(shape, out))
        }
    }
}

/// Moves channels to pixels: `block²` channels become a block of `block × block` pixels. If `columns_first` (ONNX's
/// mode CRD), these are neighbouring channels; otherwise (mode DCR), they are `channels / block²` channels apart.
pub fn depth_to_space(block: usize, columns_first: bool, call: &Call) -> Result<Tensor> {
    let x = call.input(0)?;
    let [batch, channels, height, width] = x.shape_of()?;
    if channels % (block * block) != 0 {
        return Err(Error::format(format!("{channels} channels are not a multiple of {block} x {block}")));
    }
    let left = channels / (block * block);
    let (apart, order) = if columns_first {
        (vec![batch, left, block, block, height, width], [0, 1, 4, 2, 5, 3])
    } else {
        (vec![batch, block, block, left, height, width], [0, 3, 4, 1, 5, 2])
    };
    turned(&x.reshaped(apart)?, &order, call)?.reshaped(vec![batch, left, height * block, width * block])
}
