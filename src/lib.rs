//! luxfer: lighting from one photo onto a 3D scene, and stylisation guided by illumination.

#![warn(unsafe_op_in_unsafe_fn)]

pub mod error;
pub mod exec;
pub mod geometry;
pub mod image;
pub mod job;
pub mod rng;
pub mod scene;

pub mod emission;
pub mod features;
pub mod rectify;
pub mod relight;
pub mod render;
pub mod segment;

#[cfg(feature = "stylize")]
pub mod patch;
#[cfg(feature = "stylize")]
pub mod stylize;

pub mod demo;
pub mod transfer;

pub mod ffi;
