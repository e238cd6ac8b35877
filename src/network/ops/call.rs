//! The arguments with which an operator runs: the inputs of its node, and the node's attributes.

use super::super::read::{Attribute, unsupported};
use super::super::tensor::{MemoryBudget, Tensor};
use crate::error::{Error, Result};
use crate::job::Job;
use std::collections::HashMap;

/// The arguments with which a node is executed.
pub struct Call<'a> {
    pub inputs: Vec<Option<&'a Tensor>>,
    pub budget: MemoryBudget,
    /// Number of outputs of the node.
    pub outputs: usize,
    pub job: Job<'a>,
}

impl<'a> Call<'a> {
    /// Returns input `k`; an error if it is missing.
    pub fn input(&self, k: usize) -> Result<&'a Tensor> {
        self.optional(k).ok_or_else(|| Error::format(format!("input {k} is missing")))
    }

    pub fn optional(&self, k: usize) -> Option<&'a Tensor> {
        self.inputs.get(k).copied().flatten()
    }

    /// Returns the integers of the attribute `setting` if it is present, else the integers of the optional input `k`,
    /// which replaces the attribute in newer files. `None` if both are absent.
    pub fn integers(&self, setting: Option<&[i64]>, k: usize) -> Result<Option<Vec<i64>>> {
        match (setting, self.optional(k)) {
            (Some(values), _) => Ok(Some(values.to_vec())),
            (None, Some(tensor)) => tensor.as_integers().map(|values| Some(values.to_vec())),
            (None, None) => Ok(None),
        }
    }
}

/// The attributes of a node by name.
pub struct Settings<'a, 'b>(pub &'b HashMap<&'a str, Attribute<'a>>);

impl<'a> Settings<'a, '_> {
    pub fn integer(&self, name: &str, default: i64) -> i64 {
        self.0.get(name).and_then(|a| a.integer).unwrap_or(default)
    }

    pub fn float(&self, name: &str, default: f32) -> f32 {
        self.0.get(name).and_then(|a| a.float).unwrap_or(default)
    }

    pub fn text(&self, name: &str, default: &'a str) -> &'a str {
        self.0.get(name).and_then(|a| a.text).unwrap_or(default)
    }

    pub fn integers(&self, name: &str) -> Option<Vec<i64>> {
        self.0.get(name).map(|a| a.integers.clone())
    }

    /// Reads an attribute of exactly `N` integers from 0 to 65536. If the attribute is absent, all of them are
    /// `default`.
    pub fn sizes<const N: usize>(&self, name: &str, default: usize) -> Result<[usize; N]> {
        let Some(values) = self.integers(name).filter(|values| !values.is_empty()) else { return Ok([default; N]) };
        let wrong = || Error::format(format!("{name} is {values:?}; {N} numbers from 0 to 65536 are needed"));
        let sizes: Vec<usize> =
            values.iter().filter_map(|&v| usize::try_from(v).ok().filter(|v| *v <= 65536)).collect();
        sizes.try_into().map_err(|_| wrong())
    }

    /// Returns an error if an attribute is present and differs from `value`, the only value that is supported.
    pub fn only(&self, name: &str, value: i64) -> Result<()> {
        match self.integer(name, value) {
            found if found == value => Ok(()),
            found => Err(unsupported(format_args!("{name} = {found}"))),
        }
    }

    pub fn tensor(&self, name: &str) -> Option<&Tensor> {
        self.0.get(name).and_then(|a| a.tensor.as_ref())
    }
}
