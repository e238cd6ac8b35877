//! luxfer: transfers the lighting of a single photo to a 3D scene, and stylises images guided by illumination.
//!
//! ```text
//! photo ─▶ rectify::find_view ─▶ features ─▶ segment ─▶ rectify::unwarp ─▶ emission ─┐
//! scene ─▶ scene::surface ───────────────────────────────────────────────────────────┤
//!                                                       render ◀── lit scene ◀── relight
//!
//! exemplar guides + artwork, target guides ─▶ stylize ─▶ stylised image
//! ```
//!
//! [`transfer`] runs the first pipeline and passes data between its stages. The stages do not depend on each other.
//! [`plan`] chooses settings for a target error or time: the settings of `relight` and `render`, or the settings of
//! `stylize`. `ffi` is the C boundary, and the only module that deals with C. Both pipelines use these modules:
//! [`accel`] (ray queries), [`scene`] (description, glTF), [`render`] (light transport), `patch` (nearest-neighbour
//! fields), [`image`], [`geometry`], [`photometry`] (colour temperature, glare, luminaire files), [`daylight`]
//! (sun, skies, weather files), `network` (ONNX files). `tests/layering.rs` checks the dependencies between modules.
//!
//! Every stage has the same interface: `Params` with defaults, ranges and units; an input; an output with an estimate
//! of its own error; and a function that runs the stage. The function takes a [`job::Job`], which reports progress and
//! carries cancel requests. The stages that read the photo derive [`warning`]s from their results. All parallel work
//! goes through [`exec`], in units that do not depend on the number of threads. Equal input therefore gives results
//! that are equal bit by bit.
//!
//! Units: metres, radians, right-handed, Y up. Colours are scene-linear Rec.709 RGB; for photometric light their
//! luminance is in cd/m². Illuminance is in lux, flux in lumens. Images and rays use `f32`, geometry and solvers `f64`.
//!
//! References:
//! - Single-Exemplar Lighting Style Transfer via Emissive Texture Synthesis and Optimization. The last step of this
//!   paper is adjoint light tracing (Lipp et al. 2024); here a linear solve replaces it.
//! - Fišer et al. 2016: StyLit, illumination-guided example-based stylization of 3D renderings.
//! - Efros and Freeman 2001: Image quilting. Felzenszwalb and Huttenlocher 2012: Distance transforms of sampled
//!   functions.
//! - Hartley and Zisserman 2004: Multiple View Geometry. Heckbert 1989: Fundamentals of texture mapping.
//! - Veach 1997: Robust Monte Carlo methods. Heitz 2018: Sampling the GGX distribution of visible normals.
//! - Woop, Benthin and Wald 2013: Watertight ray/triangle intersection. Burley 2020: Practical hash-based Owen
//!   scrambling.

// Warn about calls that panic, exit, write to the console, or give other bits on other platforms (clippy.toml).
#![cfg_attr(
    not(test),
    warn(
        clippy::dbg_macro,
        clippy::disallowed_methods,
        clippy::disallowed_types,
        clippy::exit,
        clippy::get_unwrap,
        clippy::panic,
        clippy::print_stderr,
        clippy::print_stdout,
        clippy::todo,
        clippy::unimplemented,
        clippy::unwrap_used
    )
)]

pub mod accel;
pub mod daylight;
pub mod error;
pub mod exec;
pub mod geometry;
pub mod image;
pub mod job;
mod maths;
#[cfg(feature = "onnx")]
pub mod network;
pub mod photometry;
mod quiet;
mod reserve;
pub mod rng;
pub mod scene;
mod simd;
pub mod warning;

pub mod emission;
pub mod features;
pub mod pendant;
pub mod rectify;
pub mod relight;
pub mod render;
pub mod segment;

#[cfg(feature = "stylize")]
pub mod patch;
#[cfg(feature = "stylize")]
pub mod stylize;

pub mod demo;
pub mod guides;
pub mod schedule;
pub mod sheet;
pub mod transfer;

pub mod plan;

// The comments of `ffi` are copied into a C header, where `[...]` and `<...>` are plain text. Rustdoc must not warn
// about them as broken links or HTML tags.
#[allow(rustdoc::broken_intra_doc_links, rustdoc::invalid_html_tags)]
pub mod ffi;
