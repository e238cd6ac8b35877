//! Acceleration structure over triangles: finds the nearest hit of a ray, or whether anything occludes it.
//!
//! The triangles are sorted along a space-filling curve (`leaves`) and clustered into a binary tree (`cluster`:
//! Benthin et al. 2024), whose node type comes from the crate obvhs. The tree is optimised by reinsertion (`reinsert`:
//! Meister and Bittner 2018) and collapsed into nodes of eight children (`costs`, `collapse`: Ylitie et al. 2017). The
//! leaves of these nodes are packets of up to eight triangles, which are tested together.
//!
//! The triangle test is watertight (Woop, Benthin and Wald 2013), and the box test is conservative enough to match it:
//! a ray never slips through a shared edge or vertex. The nearest hit depends on the triangles alone, because ties in
//! distance go to the lower triangle index. Neither the shape of the tree nor the processor's vector width affects it.
//!
//! Not modelled: motion, instancing, curves.

mod build;
mod cache_lines;
mod cluster;
mod collapse;
mod costs;
mod lanes;
mod leaves;
mod node;
mod packet;
mod pages;
mod part;
mod prepared_ray;
mod ray;
mod reinsert;
mod stack;
mod traverse;
mod tree;

pub use ray::{Hit, Ray};
pub use traverse::Accel;

#[cfg(test)]
mod tests;
