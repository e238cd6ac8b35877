//! Runs a network: executes its nodes in order, and drops each value after its last use.

use super::graph::Network;
use super::ops::Call;
use super::tensor::{MemoryBudget, Tensor};
use crate::error::{Error, Result};
use crate::job::Job;

/// Maximum number of bytes of all values that exist at the same time during a run, without the network's own weights.
/// The temporary memory of a node may take as much again.
pub const MAX_BYTES: usize = 1 << 30;

impl Network {
    /// Computes the network's first output. Errors: `Format` if shapes are inconsistent, `OutOfMemory` if the values
    /// exceed [`MAX_BYTES`].
    pub fn run(&self, input: Tensor, job: Job) -> Result<Tensor> {
        let mut values: Vec<Option<Tensor>> = vec![None; self.constants.len()];
        let mut used = input.bytes();
        values[self.input] = Some(input);
        for (k, node) in self.nodes.iter().enumerate() {
            let job = job.part(k as f64 / self.nodes.len() as f64, (k + 1) as f64 / self.nodes.len() as f64);
            job.check()?;
            let value = |&number: &usize| values[number].as_ref().or(self.constants[number].as_ref());
            let call = Call {
                inputs: node.inputs.iter().map(|number| number.as_ref().and_then(value)).collect(),
                budget: MemoryBudget(MAX_BYTES.saturating_sub(used)),
                outputs: node.outputs.len(),
                job,
            };
            let made = node.op.run(&call).map_err(|error| error.context(format_args!("node {}", node.name)))?;
            for (number, tensor) in node.outputs.iter().zip(made) {
                if let Some(number) = number {
                    used += tensor.bytes();
                    values[*number] = Some(tensor);
                }
            }
            for &number in &node.last_uses {
                used -= values[number].take().map_or(0, |tensor| tensor.bytes());
            }
            job.report(1.0);
        }
        let made = values[self.output].take().or_else(|| self.constants[self.output].clone());
        made.ok_or_else(|| Error::format("the network does not compute its output"))
    }
}
