//! Inference of neural networks from ONNX files: a small interpreter of the operators that image-to-map networks such
//! as MiDaS and DPT use (Ranftl et al. 2020 and 2021).
//!
//! ```text
//! bytes ─▶ protobuf ─▶ graph (checked, only what the output needs) ─▶ run: node by node, parallel inside ─▶ output
//! ```
//!
//! Files are not trusted. Shapes are checked where they are used. The output of each node is checked against a
//! [`MemoryBudget`](tensor::MemoryBudget) before it is allocated, and a value is dropped after its last use.
//! [`MAX_BYTES`] limits the memory of all values during a run; the weights in the file and the temporary memory of a
//! node are additional.
//!
//! Work is divided independently of the number of threads, so equal input yields equal bits. A cancel request is
//! answered within the time that one row of the largest layer takes.
//!
//! Existing runtimes are not used because they do not suit a library inside another program's process. Each of them
//! has at least one of these faults: it never ends its own threads, prints to the console, aborts the process when
//! memory runs out, or cannot be cancelled.
//!
//! Computations are in `f32`. Doubles and halves in a file are converted to `f32`, all integers and booleans to `i64`.
//! Operator sets 7 to 21 of ONNX are known.
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
