//! The film: sums of the paths of each pixel, their means and their errors.
//!
//! `eye` makes the camera paths. `tile` traces the paths of a tile of the `canvas`, `block` those of pixels that share
//! secondary vertices; `pixel` holds the sums of a pixel. Between passes, `statistics` gives the errors, `adaptive`
//! allocates the paths of the next `pass`, and `roulette` sets the weights for Russian roulette. `develop` assembles
//! the images of a film, `interval` and `pooling` give confidence intervals. A pass extends the paths of each pixel up
//! to a count, so that an interrupted pass leaves a valid image with fewer paths in some pixels. The counts follow
//! from the pixels of the pass before: they are the same for any number of threads.
//!
//! For renders in parts, `sums` adds up the paths of some pixels independently of all others, with roulette weights
//! from a `prepass` instead of previous passes. `pilot` predicts the cost and the error of an image from a few of its
//! tiles, which it selects by their `tile_moments`.

mod adaptive;
mod block;
mod canvas;
mod clock;
mod develop;
mod eye;
mod grid;
mod interval;
mod pass;
pub mod pilot;
mod pixel;
mod pooling;
mod prepass;
mod roulette;
mod statistics;
mod sums;
mod tile;
mod tile_moments;

pub use adaptive::AdaptiveSampler;
pub use canvas::Canvas;
pub use clock::Clock;
pub use grid::TILE;
pub use pooling::pooled;
pub use sums::Sums;
