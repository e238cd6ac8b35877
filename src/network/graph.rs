//! A network ready to run: its nodes in order, with validated operators.

use super::ops::Op;
use super::read::{self, NodeMessage, unsupported};
use super::tensor::Tensor;
use crate::error::{Error, Result};
use std::collections::HashMap;

/// A network with one input image. Of its outputs, only the first is computed.
pub struct Network {
    pub(super) nodes: Vec<Node>,
    /// For each value passed between nodes, its contents if known before the run.
    pub(super) constants: Vec<Option<Tensor>>,
    pub(super) input: usize,
    pub(super) output: usize,
    input_shape: Vec<Option<usize>>,
}

pub(super) struct Node {
    pub name: String,
    pub op: Op,
    /// Indices of the input values; optional ones may be absent.
    pub inputs: Vec<Option<usize>>,
    pub outputs: Vec<Option<usize>>,
    /// Values that no later node needs.
    pub last_uses: Vec<usize>,
}

/// Maximum number of nodes: the largest DPT has about 3,000.
const MAX_NODES: usize = 100_000;

impl Network {
    /// Parses the bytes of an ONNX file. Errors: `Format` if they are damaged or inconsistent, `Unsupported` for
    /// operators and types that are not implemented; both name the place.
    pub fn parse(bytes: &[u8]) -> Result<Self> {
        let model = read::model(bytes)?;
        if !(7..=21).contains(&model.opset) {
            return Err(unsupported(format_args!("version {} of the operators (7 to 21 are known)", model.opset)));
        }
        if model.nodes.len() > MAX_NODES {
            return Err(unsupported(format_args!("{} nodes (at most {MAX_NODES} are allowed)", model.nodes.len())));
        }
        // Old files list their weights among the inputs.
        let mut inputs = model.inputs.into_iter().filter(|(name, _)| !model.constants.contains_key(name));
        let (input_name, input_shape) = inputs.next().ok_or_else(|| Error::format("the network has no input"))?;
        if let Some((second, _)) = inputs.next() {
            return Err(unsupported(format_args!("a second input, {second}")));
        }
        let output_name = *model.outputs.first().ok_or_else(|| Error::format("the network has no output"))?;

        let mut values = Values { numbers: HashMap::new(), constants: Vec::new() };
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

    /// The sizes that the input must have; `None` for any size. Empty if the file does not declare them.
    pub fn input_shape(&self) -> &[Option<usize>] {
        &self.input_shape
    }

    /// Drops nodes that the output does not depend on, and records the last use of each value.
    fn drop_unused_nodes(&mut self) {
        let mut is_needed = vec![false; self.constants.len()];
        is_needed[self.output] = true;
        let mut kept = Vec::new();
        for mut node in std::mem::take(&mut self.nodes).into_iter().rev() {
            if node.outputs.iter().flatten().any(|&v| is_needed[v]) {
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

/// The values of a graph by name.
struct Values<'a> {
    numbers: HashMap<&'a str, usize>,
    constants: Vec<Option<Tensor>>,
}

impl<'a> Values<'a> {
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
            // The output of a node without inputs is constant.
            let constant = if let Op::Constant(tensor) = &op { Some(tensor.clone()) } else { None };
            outputs.push(given(&name).then(|| self.define(name, constant)).transpose()?);
        }
        Ok(Node { name: format!("{} ({})", message.name, message.kind), op, inputs, outputs, last_uses: Vec::new() })
    }
}
