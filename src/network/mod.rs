//! Inference of neural networks from ONNX files: a small interpreter of the operators used by image-to-map networks
//! such as MiDaS and DPT (Ranftl et al. 2020 and 2021).
//!
//! ```text
//! bytes ─▶ protobuf ─▶ graph (checked, only what the output needs) ─▶ run: node by node, parallel inside ─▶ output
//! ```
//!
//! Files are not trusted. Shapes are checked where they are used. The output of a node is checked against a
//! [`MemoryBudget`](tensor::MemoryBudget) before it is allocated, and a value is dropped after its last use.
//! [`MAX_BYTES`] limits the memory that a file can make a run take, in addition to the file's own weights and to the
//! temporary memory of a node. All loops work in units that do not depend on the number of threads, so equal input
//! yields equal bits. A cancel request is answered within one row of the largest layer.
//!
//! Existing runtimes are not used because they are unsuitable for a library in another program's process: they never
//! end their own threads, print to the console, abort the process when memory runs out, or cannot be cancelled.
//!
//! Computes in `f32`; doubles and halves in a file are converted to it, all integers and booleans to `i64`. Opsets 7
//! to 21.
//!
//! Not modelled: training, control flow, recurrence, quantised and sparse tensors, strings, weights in separate files.

mod graph;
mod ops;
mod protobuf;
mod read;
mod run;
mod tensor;
#[cfg(test)]
mod tests;
#[cfg(test)]
pub mod writer;

pub use graph::Network;
pub use ops::resize_cubic;
pub use run::MAX_BYTES;
pub use tensor::{Data, Tensor};
