//! Images: owned buffers of `f32`, strided views of the caller's memory, colour, resampling and picture files.
//!
//! Inside the library a colour is scene-linear Rec.709 RGB (D65 white). If an image is photometric, its luminance is
//! in cd/m². Only this module decodes and encodes sRGB. Pixel `(x, y)` covers `[x, x+1) × [y, y+1)`: the centre of the
//! top-left pixel is (0.5, 0.5), and rows run downwards.

pub mod bracket;
mod buffer;
pub mod colour;
mod comparison;
mod containers;
mod dilation;
#[cfg(feature = "exr")]
mod exr_memory;
pub mod file_colour;
mod file_header;
mod files;
mod format;
mod inks;
pub mod io;
mod limits;
mod memory;
#[cfg_attr(not(feature = "exr"), path = "absent/numbers.rs")]
pub mod numbers;
#[cfg_attr(not(feature = "exr"), path = "absent/openexr.rs")]
mod openexr;
mod orientation;
pub(crate) mod pages;
pub mod photo;
mod planes;
pub mod pyramid;
mod radiance;
mod raster;
pub mod regions;
#[cfg(feature = "exr")]
mod samples;
mod stated_space;
mod tiff;
pub mod view;
mod working_memory;

pub use buffer::{Image, MAX_SIDE, try_collect, try_push, try_vec, try_with_capacity};
pub(crate) use buffer::{no_memory, reserve_capacity};
pub use comparison::{Comparison, neighbourhood};
pub use dilation::dilate;
pub use memory::check as check_memory;
pub use planes::{deinterleave, deinterleave_of, interleave};
