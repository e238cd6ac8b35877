//! Reads the messages of an ONNX file (`onnx.proto3`), restricted to the fields that this library uses.

use super::protobuf::{Value, fields};
use super::tensor::{Data, Tensor, count};
use crate::error::{Error, ErrorKind, Result};
use crate::image::{try_collect, try_push};
use std::collections::HashMap;
use std::sync::Arc;

/// The contents of `ModelProto` and its `GraphProto`.
#[derive(Default)]
pub struct Model<'a> {
    pub opset: i64,
    pub nodes: Vec<NodeMessage<'a>>,
    pub constants: HashMap<&'a str, Tensor>,
    /// Name and shape of each input; `None` is a size that the file leaves open.
    pub inputs: Vec<(&'a str, Vec<Option<usize>>)>,
    pub outputs: Vec<&'a str>,
}

/// The contents of `NodeProto`.
#[derive(Default)]
pub struct NodeMessage<'a> {
    pub kind: &'a str,
    pub domain: &'a str,
    pub name: &'a str,
    pub inputs: Vec<&'a str>,
    pub outputs: Vec<&'a str>,
    pub attributes: HashMap<&'a str, Attribute<'a>>,
}

/// The contents of `AttributeProto`; only the fields that the file sets.
#[derive(Default)]
pub struct Attribute<'a> {
    pub float: Option<f32>,
    pub integer: Option<i64>,
    pub text: Option<&'a str>,
    pub tensor: Option<Tensor>,
    pub integers: Vec<i64>,
    pub floats: Vec<f32>,
}

pub fn model(bytes: &[u8]) -> Result<Model<'_>> {
    let mut model = Model::default();
    let mut found = None;
    fields(bytes, |number, value| {
        match number {
            7 => found = Some(value.bytes()?),
            8 => {
                let (mut domain, mut version) = ("", 0);
                fields(value.bytes()?, |number, value| {
                    match number {
                        1 => domain = value.text()?,
                        2 => version = value.integer()?,
                        _ => {}
                    }
                    Ok(())
                })?;
                if matches!(domain, "" | "ai.onnx") {
                    model.opset = version;
                }
            }
            _ => {}
        }
        Ok(())
    })?;
    let graph = found.ok_or_else(|| Error::format("the file has no graph: it is truncated, or not an ONNX file"))?;
    fields(graph, |number, value| {
        match number {
            1 => model.nodes.push(node(value.bytes()?)?),
            5 => {
                let (name, tensor) = tensor(value.bytes()?)?;
                model.constants.insert(name, tensor);
            }
            11 => model.inputs.push(value_info(value.bytes()?)?),
            12 => model.outputs.push(value_info(value.bytes()?)?.0),
            15 => return Err(unsupported("sparse weights")),
            _ => {}
        }
        Ok(())
    })?;
    Ok(model)
}

pub fn unsupported(what: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::Unsupported, format!("the network uses {what}, which this runtime does not support"))
}

fn node(bytes: &[u8]) -> Result<NodeMessage<'_>> {
    let mut node = NodeMessage::default();
    fields(bytes, |number, value| {
        match number {
            1 => node.inputs.push(value.text()?),
            2 => node.outputs.push(value.text()?),
            3 => node.name = value.text()?,
            4 => node.kind = value.text()?,
            5 => {
                let (name, attribute) = attribute(value.bytes()?)?;
                node.attributes.insert(name, attribute);
            }
            7 => node.domain = value.text()?,
            _ => {}
        }
        Ok(())
    })?;
    Ok(node)
}

fn attribute(bytes: &[u8]) -> Result<(&str, Attribute<'_>)> {
    let (mut name, mut attribute) = ("", Attribute::default());
    fields(bytes, |number, value| {
        match number {
            1 => name = value.text()?,
            2 => attribute.float = Some(value.float()?),
            3 => attribute.integer = Some(value.integer()?),
            4 => attribute.text = std::str::from_utf8(value.bytes()?).ok(),
            5 => attribute.tensor = Some(tensor(value.bytes()?)?.1),
            6 | 11 => return Err(unsupported("graphs inside a node")),
            7 => value.floats(&mut attribute.floats)?,
            8 => value.integers(&mut attribute.integers)?,
            _ => {}
        }
        Ok(())
    })?;
    Ok((name, attribute))
}

/// Reads a `ValueInfoProto`: the name and the shape of a value.
fn value_info(bytes: &[u8]) -> Result<(&str, Vec<Option<usize>>)> {
    let (mut name, mut shape) = ("", Vec::new());
    fields(bytes, |number, value| match number {
        1 => value.text().map(|text| name = text),
        // Visit the TypeProto, its tensor type, the shape of the tensor, and the axes of the shape.
        2 => nested(value, 1, |tensor| {
            nested(tensor, 2, |axes| {
                nested(axes, 1, |axis| {
                    let mut size = None;
                    fields(axis.bytes()?, |number, value| {
                        if number == 1 {
                            size = usize::try_from(value.integer()?).ok().filter(|&n| n > 0);
                        }
                        Ok(())
                    })?;
                    shape.push(size);
                    Ok(())
                })
            })
        }),
        _ => Ok(()),
    })?;
    Ok((name, shape))
}

/// Calls `work` for each field of a message whose field number is `wanted`.
fn nested<'a>(message: Value<'a>, wanted: u64, mut work: impl FnMut(Value<'a>) -> Result<()>) -> Result<()> {
    fields(message.bytes()?, |number, value| if number == wanted { work(value) } else { Ok(()) })
}

/// Reads a `TensorProto`: the name and the contents of a tensor.
fn tensor(bytes: &[u8]) -> Result<(&str, Tensor)> {
    let (mut name, mut kind, mut raw) = ("", 0, None);
    let (mut shape, mut floats, mut integers) = (Vec::new(), Vec::new(), Vec::new());
    let mut is_elsewhere = false;
    fields(bytes, |number, value| {
        match number {
            1 => value.integers(&mut shape)?,
            2 => kind = value.integer()?,
            4 => value.floats(&mut floats)?,
            5 | 7 | 11 => value.integers(&mut integers)?,
            8 => name = value.text()?,
            9 => raw = Some(value.bytes()?),
            10 => {
                for eight in value.bytes()?.chunks_exact(8) {
                    try_push(&mut floats, f64::from_le_bytes(std::array::from_fn(|i| eight[i])) as f32)?;
                }
            }
            13 => is_elsewhere = true,
            14 => is_elsewhere |= value.integer()? == 1,
            _ => {}
        }
        Ok(())
    })?;
    if is_elsewhere {
        return Err(unsupported("weights in a separate file"));
    }
    let shape: Vec<usize> = shape
        .into_iter()
        .map(|d| usize::try_from(d).map_err(|_| Error::format(format!("tensor {name} has a size of {d}"))))
        .collect::<Result<_>>()?;

    fn raw_items<const N: usize, T>(raw: &[u8], item: impl Fn([u8; N]) -> T) -> Result<Vec<T>> {
        try_collect(raw.as_chunks::<N>().0.iter().map(|bytes| item(*bytes)))
    }
    let half = |bits: u16| half::f16::from_bits(bits).to_f32();
    let data = match (kind, raw) {
        (1, Some(raw)) => floats_of(raw_items(raw, f32::from_le_bytes)?),
        (10, Some(raw)) => floats_of(raw_items(raw, |b| half(u16::from_le_bytes(b)))?),
        (11, Some(raw)) => floats_of(raw_items(raw, |b| f64::from_le_bytes(b) as f32)?),
        (2 | 9, Some(raw)) => integers_of(raw_items(raw, |[b]: [u8; 1]| i64::from(b))?),
        (3, Some(raw)) => integers_of(raw_items(raw, |b: [u8; 1]| i64::from(i8::from_le_bytes(b)))?),
        (6, Some(raw)) => integers_of(raw_items(raw, |b| i64::from(i32::from_le_bytes(b)))?),
        (7, Some(raw)) => integers_of(raw_items(raw, i64::from_le_bytes)?),
        (1 | 11, None) => floats_of(floats),
        (10, None) => floats_of(try_collect(integers.into_iter().map(|bits| half(bits as u16)))?),
        // Protocol Buffers encode negative 32-bit integers as 64-bit varints, so all integer types are already `i64`
        // here.
        (2 | 3 | 6 | 7 | 9, None) => integers_of(integers),
        _ => return Err(unsupported(format_args!("tensors of type {kind}"))),
    };
    let tensor = Tensor { shape, data };
    if count(&tensor.shape)? != tensor.len() {
        return Err(Error::format(format!(
            "tensor {name} has shape {:?} and {} values: the file is damaged",
            tensor.shape,
            tensor.len()
        )));
    }
    Ok((name, tensor))
}

fn floats_of(values: Vec<f32>) -> Data {
    Data::Floats(Arc::new(values))
}

fn integers_of(values: Vec<i64>) -> Data {
    Data::Integers(Arc::new(values))
}
