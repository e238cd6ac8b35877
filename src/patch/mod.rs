//! Patch matching: the nearest-neighbour field between two multi-channel images, and what is built from it.
//!
//! The engine of Fišer et al., "StyLit: Illumination-Guided Example-Based Stylization of 3D Renderings", §3.3-3.4. It
//! knows nothing of light: a [`Features`] image holds colour and guide channels with their weights already inside, so
//! that Eq. 1 is one sum of squared integer differences, the same to the bit with and without SIMD. The search is
//! PatchMatch (Barnes et al. 2009) on a fixed grid of tiles whose borders are exchanged between sweeps, with random
//! numbers that depend on position only: the field does not depend on the number of threads. [`Table`] is a
//! search that is not PatchMatch.
//!
//! A patch is named by its top-left pixel and always lies inside its image, so an image of `W × H` pixels has
//! `(W - w + 1) × (H - w + 1)` patches of width `w`.
//!
//! What bounds it: on the real pair of `tests/real_stylize.rs` at 1200 × 912 with 16 channels, a third of the time goes into
//! distances, a quarter into choosing candidates, a seventh into voting, a twentieth into sorting errors; the images
//! take 32 bytes a pixel on each side and do not fit into a cache, but tiles do. A neighbour that continues the same
//! match is no candidate, so the more coherent a field, the cheaper a sweep.
//!
//! Not modelled: rotated, mirrored, scaled or recoloured patches.

mod domain;
mod features;
mod field;
mod kernel;
mod occurrence;
mod pyramid;
mod search;
mod table;
mod vote;

pub use domain::Domain;
pub use features::{Features, Quantiser};
pub use field::{Field, NONE, pack, unpack};
pub use kernel::{Kernel, Patch};
pub use occurrence::Occurrence;
pub use pyramid::{halve, halve_mask, level_count, level_size};
pub use search::{Search, Sweep};
pub use table::{Means, Table};
pub use vote::{Vote, origin, vote};

/// Longest side of an image that patches are matched in, in pixels: a position fits into half of a `u32`.
pub const MAX_SIDE: usize = 32_768;
