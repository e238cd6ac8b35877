//! Compares the lights of a texture with the lights of its exemplar.

mod of_exemplar;
pub mod pairs;
pub mod sampling;
pub mod statistics;
