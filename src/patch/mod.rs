//! Patch matching: the nearest-neighbour field between two multi-channel images, and operations on it.
//!
//! This is the engine of Fišer et al., "StyLit: Illumination-Guided Example-Based Stylization of 3D Renderings",
//! §3.3-3.4. It is independent of the meaning of the channels: a [`QuantisedImage`] holds colour and guide channels
//! multiplied by the square roots of their weights, so that Eq. 1 is a single sum of squared integer differences,
//! identical to the bit with and without SIMD. The search is PatchMatch (Barnes et al. 2009) on a fixed grid of tiles
//! that exchange their borders between iterations. Its random numbers depend on position only, so the field does not
//! depend on the number of threads. [`KdTree`] is an alternative search, a k-d tree.
//!
//! A patch is identified by its top-left pixel and always lies inside its image: an image of `W × H` pixels has
//! `(W - w + 1) × (H - w + 1)` patches of width `w`.
//!
//! Profile, on the real pair of `tests/real/stylize.rs` at 1200 × 912 with 16 channels: a third of the time is spent
//! on distances, a quarter on choosing candidates, a seventh on voting, a twentieth on sorting errors. The images of
//! exemplar and target take 32 bytes per pixel each. Both images are larger than the caches, but a tile of them fits.
//! If a neighbour's match and a patch's own match continue each other, the neighbour offers no new candidate, so
//! iterations become faster as a field becomes more coherent.
//!
//! Not modelled: rotated, mirrored, scaled or recoloured patches.

mod adaptive;
mod ballot;
mod domain;
mod field;
mod kd_tree;
mod kernel;
mod position;
mod pyramid;
mod quantised;
mod search;
mod vote;

pub use domain::Domain;
pub use field::Field;
pub use kd_tree::{KdTree, Means};
pub use kernel::{Kernel, Patch};
pub use position::{NONE, pack, unpack};
pub use pyramid::{halve, halve_mask, level_count, level_size};
pub use quantised::{QuantisedImage, Quantiser};
pub use search::{Search, SearchIteration};
pub use vote::{VoteMode, origin, vote, whole_share};

/// Maximum side in pixels of an image in which patches are matched: a coordinate fits into half of a `u32`.
pub const MAX_SIDE: usize = 32_768;
