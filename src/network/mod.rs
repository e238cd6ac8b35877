//! Running neural networks from ONNX files: a small interpreter of the operators that networks of one image to one map,
//! such as MiDaS and DPT (Ranftl et al. 2020 and 2021), are exported with.
//!
//! ```text
//! bytes ─▶ protobuf ─▶ graph (checked, only what the output needs) ─▶ run: node by node, parallel inside ─▶ output
//! ```
//!
//! A file is anyone's: it is read without trust. Shapes are checked where they are used, what a node makes is asked of a
//! [`Room`] before it is allocated, and a value is dropped after its last use; a file cannot make a run take more memory than
//! [`MOST_BYTES`] beside its own weights. Every loop is in units that do not depend on the number of threads: equal input gives
//! equal bits. A cancel request is answered within a row of the largest layer.
//!
//! It is here because what there is does not fit into a host's process: runtimes that keep threads of their own for good, print,
//! end the process when memory runs out, or cannot be cancelled.
//!
//! Computes in `f32`; doubles and halves of a file become that, all integers and booleans `i64`. Opsets 7 to 21.
//!
//! Not modelled: training, control flow, recurrence, quantised and sparse tensors, strings, weights in files of their own.

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
pub use run::MOST_BYTES;
pub use tensor::{Data, Tensor};
