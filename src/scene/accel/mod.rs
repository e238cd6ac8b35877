//! Acceleration structure over triangles: nearest hits and occlusion.
//!
//! Triangles are sorted along a space-filling curve (`leaves`) and clustered into a binary tree (`cluster`: Benthin et
//! al. 2024) with the nodes of obvhs. The tree is optimised by reinsertion (`reinsert`: Meister and Bittner 2018) and
//! collapsed into nodes of eight children (`costs`, `collapse`: Ylitie et al. 2017), whose leaves hold up to eight
//! triangles that are tested together.
//!
//! The triangle test is watertight (Woop, Benthin and Wald 2013), and the box test is conservative to match it: a ray
//! never slips through a shared edge or vertex. The nearest hit depends on the triangles alone: ties in distance are
//! resolved by the lower triangle index, so neither the shape of the tree nor the processor's vector width affects it.
//!
//! Not modelled: motion, instancing, curves.

mod aligned;
mod build;
mod cluster;
mod collapse;
mod costs;
mod lanes;
mod leaves;
mod lines;
mod node;
mod packet;
mod pages;
mod ray;
mod reinsert;
mod stack;
mod traverse;
mod tree;

pub use ray::{Hit, Ray};
pub use traverse::Accel;

#[cfg(test)]
mod tests;
