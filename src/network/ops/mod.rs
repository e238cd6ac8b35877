//! The operators: parsing from a node, and dispatch. Their semantics follow the ONNX operator specification,
//! <https://onnx.ai/onnx/operators/>.

mod call;
mod conv;
mod elementwise;
mod gather;
mod matmul;
mod norm;
mod pool;
mod reduce;
mod resize;
mod shapes;

pub use call::Call;

use super::read::{NodeMessage, unsupported};
use super::tensor::Tensor;
use crate::error::{Error, Result};
use call::Settings;
use elementwise::{Binary, Unary};
pub use resize::cubic_planes as resize_cubic;

/// An operator with its attributes. An attribute is an `Option` if newer files give it as an input instead.
pub enum Op {
    Constant(Tensor),
    Unary(Unary),
    /// `min_inputs`: 1 for operators that ONNX defines for any number of inputs, else 2.
    Binary {
        op: Binary,
        min_inputs: usize,
    },
    Clip {
        low: Option<f32>,
        high: Option<f32>,
    },
    Where,
    Cast {
        to_float: bool,
        is_bool: bool,
    },
    Conv(conv::Conv),
    ConvTranspose(conv::Conv),
    MatMul,
    Gemm(matmul::Gemm),
    Pool(pool::Pool),
    GlobalAveragePool,
    BatchNorm {
        epsilon: f32,
    },
    InstanceNorm {
        epsilon: f32,
    },
    LayerNorm {
        axis: i64,
        epsilon: f32,
    },
    Softmax {
        axis: i64,
        flattens: bool,
    },
    Reduce(reduce::Reduce),
    Resize(resize::Resize),
    Pad {
        mode: gather::Pad,
        pads: Option<Vec<i64>>,
        value: f32,
    },
    Reshape {
        keeps_zero: bool,
    },
    Flatten {
        axis: i64,
    },
    Squeeze {
        axes: Option<Vec<i64>>,
    },
    Unsqueeze {
        axes: Option<Vec<i64>>,
    },
    Transpose {
        order: Vec<i64>,
    },
    Concat {
        axis: i64,
    },
    Split {
        axis: i64,
        sizes: Option<Vec<i64>>,
    },
    Slice {
        starts: Option<Vec<i64>>,
        ends: Option<Vec<i64>>,
        axes: Option<Vec<i64>>,
    },
    Gather {
        axis: i64,
    },
    Expand,
    Tile,
    Shape {
        start: i64,
        end: Option<i64>,
    },
    ConstantOfShape(Tensor),
    Range,
    DepthToSpace {
        block: usize,
        columns_first: bool,
    },
}

impl Op {
    /// Parses an operator and its attributes from a node. `constants` are the node's inputs, as far as they are known
    /// before the run.
    pub fn read(node: &NodeMessage, opset: i64, constants: &[Option<&Tensor>]) -> Result<Self> {
        let at = Settings(&node.attributes);
        if !matches!(node.domain, "" | "ai.onnx") {
            return Err(unsupported(format_args!("the operator {} of {}", node.kind, node.domain)));
        }
        if let Some(op) = Unary::read(node.kind, &at) {
            return Ok(Self::Unary(op));
        }
        if let Some(op) = Binary::read(node.kind, &at) {
            let min_inputs = if matches!(node.kind, "Sum" | "Min" | "Max") { 1 } else { 2 };
            return Ok(Self::Binary { op, min_inputs });
        }
        Ok(match node.kind {
            "Constant" => Self::Constant(constant(&at)?),
            "Clip" => Self::Clip {
                low: node.attributes.get("min").and_then(|a| a.float),
                high: node.attributes.get("max").and_then(|a| a.float),
            },
            "Where" => Self::Where,
            "Cast" => match at.integer("to", 1) {
                1 | 10 | 11 => Self::Cast { to_float: true, is_bool: false },
                to @ (2..=7 | 9) => Self::Cast { to_float: false, is_bool: to == 9 },
                to => return Err(unsupported(format_args!("a cast to type {to}"))),
            },
            "Conv" => Self::Conv(conv::Conv::read(&at)?),
            "ConvTranspose" => Self::ConvTranspose(conv::Conv::read(&at)?),
            "MatMul" => Self::MatMul,
            "Gemm" => Self::Gemm(matmul::Gemm::read(&at)),
            "MaxPool" => Self::Pool(pool::Pool::read(&at, true)?),
            "AveragePool" => Self::Pool(pool::Pool::read(&at, false)?),
            "GlobalAveragePool" => Self::GlobalAveragePool,
            "BatchNormalization" => {
                at.only("training_mode", 0)?;
                Self::BatchNorm { epsilon: at.float("epsilon", 1e-5) }
            }
            "InstanceNormalization" => Self::InstanceNorm { epsilon: at.float("epsilon", 1e-5) },
            "LayerNormalization" => {
                Self::LayerNorm { axis: at.integer("axis", -1), epsilon: at.float("epsilon", 1e-5) }
            }
            // Before opset 13, softmax normalises over `axis` and all axes after it.
            "Softmax" if opset < 13 => Self::Softmax { axis: at.integer("axis", 1), flattens: true },
            "Softmax" => Self::Softmax { axis: at.integer("axis", -1), flattens: false },
            "ReduceMean" | "ReduceSum" | "ReduceMax" | "ReduceMin" => {
                Self::Reduce(reduce::Reduce::read(node.kind, &at))
            }
            "Resize" | "Upsample" => Self::Resize(resize::Resize::read(node.kind, &at, opset, constants)?),
            _ => Self::read_rearranging(node, &at)?,
        })
    }

    /// Parses an operator that rearranges elements or computes shapes.
    fn read_rearranging(node: &NodeMessage, at: &Settings) -> Result<Self> {
        let axes = || at.integers("axes");
        Ok(match node.kind {
            "Pad" => Self::Pad {
                mode: gather::Pad::read(at.text("mode", "constant"))?,
                pads: at.integers("pads"),
                value: at.float("value", 0.0),
            },
            "Reshape" => Self::Reshape { keeps_zero: at.integer("allowzero", 0) == 1 },
            "Flatten" => Self::Flatten { axis: at.integer("axis", 1) },
            "Squeeze" => Self::Squeeze { axes: axes() },
            "Unsqueeze" => Self::Unsqueeze { axes: axes() },
            "Transpose" => Self::Transpose { order: at.integers("perm").unwrap_or_default() },
            "Concat" => Self::Concat { axis: at.integer("axis", 1) },
            "Split" => Self::Split { axis: at.integer("axis", 0), sizes: at.integers("split") },
            "Slice" => Self::Slice { starts: at.integers("starts"), ends: at.integers("ends"), axes: axes() },
            "Gather" => Self::Gather { axis: at.integer("axis", 0) },
            "Expand" => Self::Expand,
            "Tile" => Self::Tile,
            "Shape" => {
                Self::Shape { start: at.integer("start", 0), end: node.attributes.get("end").and_then(|a| a.integer) }
            }
            "ConstantOfShape" => {
                let value = at.tensor("value").cloned();
                Self::ConstantOfShape(value.unwrap_or_else(|| Tensor::floats(vec![1], vec![0.0])))
            }
            "Range" => Self::Range,
            "DepthToSpace" => {
                let [block] = [usize::try_from(at.integer("blocksize", 0)).unwrap_or(0)];
                if !(1..=256).contains(&block) {
                    return Err(Error::format(format!("blocksize is {block}; it must lie in [1, 256]")));
                }
                Self::DepthToSpace { block, columns_first: at.text("mode", "DCR") == "CRD" }
            }
            kind => return Err(unsupported(format_args!("the operator {kind}"))),
        })
    }

    /// Runs the operator and returns its outputs; the node may use only some of them.
    pub fn run(&self, call: &Call) -> Result<Vec<Tensor>> {
        let one = |tensor: Result<Tensor>| tensor.map(|tensor| vec![tensor]);
        match self {
            Self::Constant(tensor) => Ok(vec![tensor.clone()]),
            Self::Unary(unary) => one(elementwise::unary(*unary, call)),
            Self::Binary { op, min_inputs } => one(elementwise::binary(*op, *min_inputs, call)),
            Self::Clip { low, high } => one(elementwise::clip(*low, *high, call)),
            Self::Where => one(elementwise::select(call)),
            Self::Cast { to_float, is_bool } => one(elementwise::cast(*to_float, *is_bool, call)),
            Self::Conv(conv) => one(conv.run(call)),
            Self::ConvTranspose(conv) => one(conv.run_transposed(call)),
            Self::MatMul => one(matmul::run(call)),
            Self::Gemm(gemm) => one(gemm.run(call)),
            Self::Pool(pool) => one(pool.run(call)),
            Self::GlobalAveragePool => one(pool::global_average(call)),
            Self::BatchNorm { epsilon } => one(norm::batch(*epsilon, call)),
            Self::InstanceNorm { epsilon } => one(norm::instance(*epsilon, call)),
            Self::LayerNorm { axis, epsilon } => one(norm::layer(*axis, *epsilon, call)),
            Self::Softmax { axis, flattens } => one(norm::softmax(*axis, *flattens, call)),
            Self::Reduce(reduce) => one(reduce.run(call)),
            Self::Resize(resize) => one(resize.run(call)),
            Self::Pad { mode, pads, value } => one(gather::pad(*mode, pads.as_deref(), *value, call)),
            Self::Reshape { keeps_zero } => one(shapes::reshape(*keeps_zero, call)),
            Self::Flatten { axis } => one(shapes::flatten(*axis, call)),
            Self::Squeeze { axes } => one(shapes::squeeze(axes.as_deref(), call)),
            Self::Unsqueeze { axes } => one(shapes::unsqueeze(axes.as_deref(), call)),
            Self::Transpose { order } => one(gather::transpose(order, call)),
            Self::Concat { axis } => one(shapes::concat(*axis, call)),
            Self::Split { axis, sizes } => shapes::split(*axis, sizes.as_deref(), call),
            Self::Slice { starts, ends, axes } => {
                one(gather::slice(starts.as_deref(), ends.as_deref(), axes.as_deref(), call))
            }
            Self::Gather { axis } => one(gather::gather(*axis, call)),
            Self::Expand => one(gather::expand(call)),
            Self::Tile => one(gather::tile(call)),
            Self::Shape { start, end } => one(shapes::shape(*start, *end, call)),
            Self::ConstantOfShape(value) => one(shapes::filled(value, call)),
            Self::Range => one(shapes::range(call)),
            Self::DepthToSpace { block, columns_first } => one(gather::depth_to_space(*block, *columns_first, call)),
        }
    }
}

fn constant(at: &Settings) -> Result<Tensor> {
    if let Some(tensor) = at.tensor("value") {
        return Ok(tensor.clone());
    }
    let get = |name: &str| at.0.get(name);
    if let Some(v) = get("value_float").and_then(|a| a.float) {
        return Ok(Tensor::floats(Vec::new(), vec![v]));
    }
    if let Some(v) = get("value_int").and_then(|a| a.integer) {
        return Ok(Tensor::integers(Vec::new(), vec![v]));
    }
    if let Some(a) = get("value_floats") {
        return Ok(Tensor::floats(vec![a.floats.len()], a.floats.clone()));
    }
    if let Some(a) = get("value_ints") {
        return Ok(Tensor::integers(vec![a.integers.len()], a.integers.clone()));
    }
    Err(unsupported("a constant that is not numeric"))
}
