//! How far the lights of a texture agree with its exemplar's.

pub mod pairs;
pub mod sampling;
pub mod statistics;
