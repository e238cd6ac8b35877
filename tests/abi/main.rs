//! Contract of the C boundary, one module for each part of the header. Tests that measure the whole process have
//! programs of their own: `abi_decoders`, `abi_fork`, `abi_jobs` and `abi_quick`.

mod contract;
mod glare;
#[path = "../host/mod.rs"]
mod host;
mod job_start;
mod pendants;
mod render_outputs;
mod scene_load;
mod scene_read;
#[cfg(feature = "stylize")]
mod stylize;
mod warnings;
