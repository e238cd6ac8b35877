//! Inference of neural networks from ONNX files: a small interpreter of the operators used by image-to-map networks
//! such as MiDaS and DPT (Ranftl et al. 2020 and 2021).
//!
//! ```text
//! bytes ─▶ protobuf ─▶ graph (checked, only what the output needs) ─▶ run: node by node, parallel inside ─▶ output
//! ```
//!
//! Files are not trusted. Shapes are checked where they are used, the output of a node is charged to a
//! [`MemoryBudget`](tensor::MemoryBudget) before it is allocated, and a value is dropped after its last use; a file
//! cannot make a run take more memory than [`MAX_BYTES`] in addition to its own weights. All loops work in units that
//! do not depend on the number of threads: equal input yields equal bits. A cancel request is answered within one row
//! of the largest layer.
//!
//! Existing runtimes are not used because they are unsuitable for a host's process: they keep threads of their own for
//! good, print, abort the process when memory runs out, or cannot be cancelled.
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
