//! A network ready to run: its nodes in the order of execution, with validated operators.

use super::ops::Op;
use super::read::{self, NodeMessage, unsupported};
use super::tensor::Tensor;
use crate::error::{Error, Result};
use std::collections::HashMap;

/// A network with one input, an image. Only the first of its outputs is computed.
pub struct Network {
    pub(super) nodes: Vec<Node>,
    /// For each value passed between nodes, its contents if they are known before the run, such as weights; otherwise
    /// `None`.
    pub(super) constants: Vec<Option<Tensor>>,
    pub(super) input: usize,
    pub(super) output: usize,
    input_shape: Vec<Option<usize>>,
}

pub(super) struct Node {
    pub name: String,
    pub op: Op,
    /// Indices of the values that this node reads; `None` for optional inputs that are absent.
    pub inputs: Vec<Option<usize>>,
    pub outputs: Vec<Option<usize>>,
    /// Indices of the inputs and outputs that no later node reads. They are dropped after this node. Constants are not
    /// listed.
    pub last_uses: Vec<usize>,
}

/// Maximum number of nodes in a network. For comparison, the largest DPT has about 3,000.
const MAX_NODES: usize = 100_000;

impl Network {
    /// Parses an ONNX file held in memory. Errors: `Format` if the file is damaged or inconsistent, `Unsupported` for
    /// operators and types that are not implemented. Both errors name the place in the network.
    pub fn parse(bytes: &[u8]) -> Result<Self> {
        let model = read::model(bytes)?;
        if !(7..=21).contains(&model.opset) {
            return Err(unsupported(format_args!("version {} of the operators (7 to 21 are known)", model.opset)));
        }
        if model.nodes.len() > MAX_NODES {
            return Err(unsupported(format_args!("{} nodes (at most {MAX_NODES} are allowed)", model.nodes.len())));
        }
        // Files of older versions list their weights among the inputs: skip the inputs that are constants.
        let mut inputs = model.inputs.into_iter().filter(|(name, _)| !model.constants.contains_key(name));
        let (input_name, input_shape) = inputs.next().ok_or_else(|| Error::format("the network has no input"))?;
        if let Some((second, _)) = inputs.next() {
            return Err(unsupported(format_args!("a second input, {second}")));
        }
        let output_name = *model.outputs.first().ok_or_else(|| Error::format("the network has no output"))?;

        let mut values = ValueTable { numbers: HashMap::new(), constants: Vec::new() };
        let input = values.define(input_name, None)?;
        for (name, tensor) in model.constants {
            values.define(name, Some(tensor))?;
        }
        let mut nodes = Vec::new();
        for message in &model.nodes {
            let place = |error: Error| error.context(format_args!("node {} ({})", message.name, message.kind));
            let known = |name: &&str| values.numbers.get(name).and_then(|&n| values.constants[n].as_ref());
            let constants: Vec<Option<&Tensor>> = message.inputs.iter().map(known).collect();
            let op = Op::read(message, model.opset, &constants).map_err(place)?;
            nodes.push(values.node(message, op).map_err(place)?);
        }
        let output = values.find(output_name)?;

        let mut network = Self { nodes, constants: values.constants, input, output, input_shape };
        network.drop_unused_nodes();
        Ok(network)
    }

    /// Returns the size that the input must have along each axis; `None` allows any size. Empty if the file states no
    /// shape.
    pub fn input_shape(&self) -> &[Option<usize>] {
        &self.input_shape
    }

    /// Drops nodes on which the output does not depend, and records the last use of each value.
    fn drop_unused_nodes(&mut self) {
        let mut is_needed = vec![false; self.constants.len()];
        is_needed[self.output] = true;
        let mut kept = Vec::new();
        for mut node in std::mem::take(&mut self.nodes).into_iter().rev() {
            if node.outputs.iter().flatten().any(|&v| is_needed[v]) {
                // An output that no later node reads is dropped at once.
                node.last_uses.extend(node.outputs.iter().flatten().copied().filter(|&v| !is_needed[v]));
                for &v in node.inputs.iter().flatten() {
                    if !is_needed[v] && self.constants[v].is_none() {
                        node.last_uses.push(v);
                    }
                    is_needed[v] = true;
                }
                kept.push(node);
            }
        }
        kept.reverse();
        self.nodes = kept;
    }
}

/// Assigns an index to each named value of a graph while the nodes of the graph are read.
struct ValueTable<'a> {
    numbers: HashMap<&'a str, usize>,
    constants: Vec<Option<Tensor>>,
}

impl<'a> ValueTable<'a> {
    fn define(&mut self, name: &'a str, constant: Option<Tensor>) -> Result<usize> {
        let number = self.constants.len();
        if self.numbers.insert(name, number).is_some() {
            return Err(Error::format(format!("two values of the network have the name {name}")));
        }
        self.constants.push(constant);
        Ok(number)
    }

    fn find(&self, name: &str) -> Result<usize> {
        let missing = || Error::format(format!("no earlier node computes the value {name}"));
        self.numbers.get(name).copied().ok_or_else(missing)
    }

    fn node(&mut self, message: &NodeMessage<'a>, op: Op) -> Result<Node> {
        let given = |name: &&&str| !name.is_empty();
        let inputs = message.inputs.iter().map(|name| given(&name).then(|| self.find(name)).transpose());
        let inputs = inputs.collect::<Result<_>>()?;
        let mut outputs = Vec::new();
        for name in &message.outputs {
            // The output of a `Constant` node is known before the run.
            let constant = if let Op::Constant(tensor) = &op { Some(tensor.clone()) } else { None };
            outputs.push(given(&name).then(|| self.define(name, constant)).transpose()?);
        }
        Ok(Node { name: format!("{} ({})", message.name, message.kind), op, inputs, outputs, last_uses: Vec::new() })
    }
}
