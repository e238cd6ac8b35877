//! The C boundary: the only place with `extern "C"` and raw pointers. Each kind of handle has a file of its own. These
//! files only check and convert arguments and results; the other modules of the library do the computations.
//!
//! The parts from which the entry points are built:
//! - [`guard`] turns panics and errors into a status and keeps the message for the calling thread;
//! - [`handle`] checks the tag behind every pointer that should be a handle, and counts references;
//! - [`params`] copies the caller's versioned structs, old or new, after a check of their size;
//! - [`stage`] is the base of all stages: it holds the inputs, allows one job at a time, and stores the result of a
//!   job that has succeeded.
//!
//! The comments of the exported items, and the module comments of their files, become `include/luxfer/*.h`; the test
//! `abi_header` generates these headers. No macro may make an exported item, because cbindgen would not
//! see it; only `absent!` (`stylize_absent`) does, in builds without stylisation, from which no header is made.

// Exported types have C names. The comment of an exported function is its safety contract and becomes its comment in
// the header.
#![allow(non_camel_case_types, clippy::missing_safety_doc)]

#[cfg(panic = "abort")]
compile_error!("luxfer reports panics to its host as LUXFER_INTERNAL: build it with panic = \"unwind\"");

mod entry;
mod float_mode;
mod guard;
mod handle;
mod params;
mod pointer;
mod shared_context;
mod stage;

mod candidates;
mod context;
mod daylight;
mod demo;
mod demo_photo;
mod depth;
mod design;
mod distribution;
mod emission;
mod emission_law;
mod emission_tiles;
mod exposures;
mod false_colour;
mod features;
mod geometry;
mod glare;
mod gonio;
mod guides;
mod illuminance;
mod image;
mod importance;
mod init;
mod job;
mod job_start;
mod kinds;
mod lamps;
mod lamps_goals;
mod lamps_results;
mod pattern;
mod pendants;
mod photo;
mod photometry;
mod placement;
mod plan;
#[cfg(feature = "stylize")]
mod plan_stylize;
mod query;
mod rectify;
mod references;
mod relight;
mod render;
mod render_outputs;
mod render_parts;
mod requirements;
mod scene;
mod scene_lights;
mod scene_load;
mod scene_materials;
mod scene_parts;
mod scene_read;
mod segment;
mod sheet;
mod status;
mod stored_goal;
mod strokes;
#[cfg(feature = "stylize")]
mod stylize;
#[cfg(not(feature = "stylize"))]
mod stylize_absent;
#[cfg(feature = "stylize")]
mod stylize_output;
#[cfg(feature = "stylize")]
mod stylize_params;
#[cfg(feature = "stylize")]
mod stylize_results;
mod transfer;
mod transfer_results;
mod version;
mod warning;
mod warning_create;
mod weather;

pub use candidates::*;
pub use context::*;
pub use daylight::*;
pub use demo::*;
pub use demo_photo::*;
pub use depth::*;
pub use design::*;
pub use distribution::*;
pub use emission::*;
pub use emission_law::*;
pub use emission_tiles::*;
pub use exposures::*;
pub use false_colour::*;
pub use features::*;
pub use geometry::*;
pub use glare::*;
pub use gonio::*;
pub use guides::*;
pub use illuminance::*;
pub use image::*;
pub use importance::*;
pub use init::*;
pub use job::*;
pub use job_start::*;
pub use lamps::*;
pub use lamps_goals::*;
pub use lamps_results::*;
pub use pattern::*;
pub use pendants::*;
pub use photo::*;
pub use photometry::*;
pub use placement::*;
pub use plan::*;
#[cfg(feature = "stylize")]
pub use plan_stylize::*;
pub use query::*;
pub use rectify::*;
pub use references::*;
pub use relight::*;
pub use render::*;
pub use render_outputs::*;
pub use render_parts::*;
pub use requirements::*;
pub use scene::*;
pub use scene_lights::*;
pub use scene_load::*;
pub use scene_materials::*;
pub use scene_parts::*;
pub use scene_read::*;
pub use segment::*;
pub use sheet::*;
pub use status::*;
pub use strokes::*;
#[cfg(feature = "stylize")]
pub use stylize::*;
#[cfg(not(feature = "stylize"))]
pub use stylize_absent::*;
#[cfg(feature = "stylize")]
pub use stylize_params::*;
#[cfg(feature = "stylize")]
pub use stylize_results::*;
pub use transfer::*;
pub use transfer_results::*;
pub use version::*;
pub use warning::*;
pub use warning_create::*;
pub use weather::*;
