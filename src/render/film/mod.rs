//! The film: the sums of the paths of each pixel, and the images, means and errors computed from them.
//!
//! - `camera_rays` generates and traces the camera paths. `tile` traces the paths of one tile of the `accumulator`;
//!   `block` traces the paths of pixels that share secondary vertices. `pixel` holds the sums of a pixel.
//! - Between passes, `statistics` computes the errors, `adaptive` chooses the next `pass`, and `roulette` computes the
//!   survival weights of Russian roulette.
//! - `develop` assembles the images of a film; `interval` and `pooling` compute confidence intervals.
//!
//! A pass adds paths to each pixel until the pixel has a given number of paths. If a pass is interrupted, some pixels
//! have fewer paths, but the image is valid. The numbers of paths that a pass asks for depend only on the results of
//! the previous pass, so they are the same for any number of threads.
//!
//! For renders in parts, `sums` adds up the paths of one part of the image. A part has no previous passes and does not
//! know the other parts, so the weights of Russian roulette come from a `prepass`. `pilot` predicts the cost and the
//! error of an image from a few of its tiles, which it selects by their `tile_moments`.

mod accumulator;
mod adaptive;
mod block;
mod camera_rays;
mod clock;
mod develop;
mod grid;
mod interval;
mod part;
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

pub use accumulator::Accumulator;
pub use adaptive::AdaptiveSampler;
pub use clock::Clock;
pub use part::Part;
pub use sums::Sums;
