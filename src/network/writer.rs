//! Writes ONNX files of networks, for tests.

use super::tensor::{Data, Tensor};

/// The bytes of a Protocol Buffers message, appended field by field.
#[derive(Default, Clone)]
pub struct Message(Vec<u8>);

impl Message {
    fn varint(&mut self, mut value: u64) {
        while value >= 128 {
            self.0.push(value as u8 | 128);
            value >>= 7;
        }
        self.0.push(value as u8);
    }

    pub fn integer(mut self, field: u64, value: i64) -> Self {
        self.varint(field << 3);
        self.varint(value as u64);
        self
    }

    pub fn float(mut self, field: u64, value: f32) -> Self {
        self.varint(field << 3 | 5);
        self.0.extend(value.to_le_bytes());
        self
    }

    pub fn bytes(mut self, field: u64, bytes: &[u8]) -> Self {
        self.varint(field << 3 | 2);
        self.varint(bytes.len() as u64);
        self.0.extend(bytes);
        self
    }

    pub fn message(self, field: u64, message: &Message) -> Self {
        self.bytes(field, &message.0)
    }
}

/// An attribute that a test gives to a node: its name and value.
pub enum Setting<'a> {
    I(&'a str, i64),
    F(&'a str, f32),
    S(&'a str, &'a str),
    Is(&'a str, &'a [i64]),
    T(&'a str, Tensor),
}

pub fn tensor(name: &str, tensor: &Tensor) -> Message {
    let mut message = tensor.shape.iter().fold(Message::default(), |message, &n| message.integer(1, n as i64));
    message = match &tensor.data {
        Data::Floats(v) => message.integer(2, 1).bytes(9, &v.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>()),
        Data::Integers(v) => {
            message.integer(2, 7).bytes(9, &v.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>())
        }
    };
    message.bytes(8, name.as_bytes())
}

/// A network under construction. Its input is named "x", its output "y".
pub struct Writer {
    graph: Message,
    opset: i64,
}

impl Writer {
    /// Starts a network with an input of the given shape; 0 stands for any size along an axis.
    pub fn new(opset: i64, shape: &[i64]) -> Self {
        Self { graph: Message::default().message(11, &value("x", shape)), opset }
    }

    pub fn constant(mut self, name: &str, value: &Tensor) -> Self {
        self.graph = self.graph.message(5, &tensor(name, value));
        self
    }

    pub fn floats(self, name: &str, shape: &[usize], values: &[f32]) -> Self {
        self.constant(name, &Tensor::floats(shape.to_vec(), values.to_vec()))
    }

    pub fn integers(self, name: &str, values: &[i64]) -> Self {
        self.constant(name, &Tensor::integers(vec![values.len()], values.to_vec()))
    }

    pub fn node(mut self, kind: &str, inputs: &[&str], output: &str, settings: &[Setting]) -> Self {
        let mut node = inputs.iter().fold(Message::default(), |node, name| node.bytes(1, name.as_bytes()));
        node = node.bytes(2, output.as_bytes()).bytes(4, kind.as_bytes());
        for setting in settings {
            let of = |name: &str| Message::default().bytes(1, name.as_bytes());
            node = node.message(
                5,
                &match setting {
                    Setting::I(name, v) => of(name).integer(3, *v),
                    Setting::F(name, v) => of(name).float(2, *v),
                    Setting::S(name, v) => of(name).bytes(4, v.as_bytes()),
                    Setting::Is(name, v) => v.iter().fold(of(name), |m, v| m.integer(8, *v)),
                    Setting::T(name, v) => of(name).message(5, &tensor("", v)),
                },
            );
        }
        self.graph = self.graph.message(1, &node);
        self
    }

    /// Returns the ONNX file, with the output "y".
    pub fn file(&self) -> Vec<u8> {
        let graph = self.graph.clone().message(12, &value("y", &[]));
        let opset = Message::default().integer(2, self.opset);
        Message::default().integer(1, 8).message(7, &graph).message(8, &opset).0
    }
}

fn value(name: &str, shape: &[i64]) -> Message {
    let axis = |&n: &i64| if n > 0 { Message::default().integer(1, n) } else { Message::default().bytes(2, b"n") };
    let axes = shape.iter().fold(Message::default(), |axes, n| axes.message(1, &axis(n)));
    let tensor = Message::default().integer(1, 1).message(2, &axes);
    Message::default().bytes(1, name.as_bytes()).message(2, &Message::default().message(1, &tensor))
}
