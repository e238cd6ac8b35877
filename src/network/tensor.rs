//! Tensors, numeric arrays with a shape, and the memory budget for them.

use crate::error::{Error, Result};
use crate::image::{no_memory, try_vec};
use std::sync::Arc;

/// A dense row-major array. Cloning and reshaping are cheap, because the numbers are shared.
#[derive(Clone, Debug)]
pub struct Tensor {
    pub shape: Vec<usize>,
    pub data: Data,
}

#[derive(Clone, Debug)]
pub enum Data {
    Floats(Arc<Vec<f32>>),
    /// Integers of any type, and booleans as 0 and 1.
    Integers(Arc<Vec<i64>>),
}

/// Returns the number of elements of a shape, or an error if no memory could hold them.
pub fn count(shape: &[usize]) -> Result<usize> {
    let all = shape.iter().try_fold(1usize, |n, &d| n.checked_mul(d));
    all.filter(|&n| n <= usize::MAX / 16)
        .ok_or_else(|| Error::format(format!("a tensor has shape {shape:?}; it is too large")))
}

impl Tensor {
    pub fn floats(shape: Vec<usize>, values: Vec<f32>) -> Self {
        debug_assert_eq!(shape.iter().product::<usize>(), values.len());
        Self { shape, data: Data::Floats(Arc::new(values)) }
    }

    pub fn integers(shape: Vec<usize>, values: Vec<i64>) -> Self {
        debug_assert_eq!(shape.iter().product::<usize>(), values.len());
        Self { shape, data: Data::Integers(Arc::new(values)) }
    }

    /// Returns a tensor with these numbers in another shape of equal size.
    pub fn reshaped(&self, shape: Vec<usize>) -> Result<Self> {
        if count(&shape)? != self.len() {
            return Err(Error::format(format!("a tensor of shape {:?} cannot be reshaped to {shape:?}", self.shape)));
        }
        Ok(Self { shape, data: self.data.clone() })
    }

    pub fn len(&self) -> usize {
        match &self.data {
            Data::Floats(values) => values.len(),
            Data::Integers(values) => values.len(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub fn bytes(&self) -> usize {
        match &self.data {
            Data::Floats(values) => 4 * values.len(),
            Data::Integers(values) => 8 * values.len(),
        }
    }

    pub fn as_floats(&self) -> Result<&[f32]> {
        match &self.data {
            Data::Floats(values) => Ok(values),
            Data::Integers(_) => Err(Error::format("integers where floats are needed")),
        }
    }

    pub fn as_integers(&self) -> Result<&[i64]> {
        match &self.data {
            Data::Integers(values) => Ok(values),
            Data::Floats(_) => Err(Error::format("floats where integers are needed")),
        }
    }

    /// Returns the shape as an array; an error unless it has `N` axes.
    pub fn shape_of<const N: usize>(&self) -> Result<[usize; N]> {
        self.shape
            .as_slice()
            .try_into()
            .map_err(|_| Error::format(format!("a tensor has shape {:?}; {N} axes are needed", self.shape)))
    }

    /// Returns the index of an axis. A negative `axis` counts from the last axis.
    pub fn axis(&self, axis: i64) -> Result<usize> {
        normal_axis(axis, self.shape.len())
    }
}

/// Returns the index of one of `rank` axes. A negative `axis` counts from the last axis.
pub fn normal_axis(axis: i64, rank: usize) -> Result<usize> {
    let from_front = if axis < 0 { axis.checked_add(rank as i64) } else { Some(axis) };
    let found = from_front.and_then(|a| usize::try_from(a).ok()).filter(|&a| a < rank);
    found.ok_or_else(|| Error::format(format!("axis is {axis}; the tensor has {rank}")))
}

/// Number of bytes that may still be allocated.
#[derive(Clone, Copy)]
pub(crate) struct MemoryBudget(pub usize);

impl MemoryBudget {
    fn check<T>(self, count: usize) -> Result<()> {
        if count <= self.0 / size_of::<T>() { Ok(()) } else { Err(no_memory::<T>(count)) }
    }

    /// Allocates a list of copies of `value`; an error if the budget does not allow it.
    pub fn vec<T: Clone>(self, count: usize, value: T) -> Result<Vec<T>> {
        self.check::<T>(count)?;
        try_vec(count, value)
    }

    /// Allocates zeros for a shape; an error if the budget does not allow it.
    pub fn zeros(self, shape: &[usize]) -> Result<Vec<f32>> {
        self.vec(count(shape)?, 0.0)
    }
}
