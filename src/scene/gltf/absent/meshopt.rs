//! Stands in for `meshopt` in builds without the Cargo feature `mesh-compression`. Compressed buffer views are still
//! recognised, so that the error names the feature.

use super::features::MESHOPT;
use crate::error::{Error, Result};
use gltf::json::Buffer;
use gltf::json::buffer::View;

pub fn left_out() -> Error {
    Error::left_out("compressed meshes were", "mesh-compression")
}

/// No value of this type exists.
pub enum Packed {}

impl Packed {
    pub fn of(view: &View) -> Option<Result<Self>> {
        let others = &view.extensions.as_ref()?.others;
        let name = MESHOPT.iter().find(|name| others.contains_key(**name))?;
        Some(Err(left_out().context(name)))
    }

    pub fn place(&self) -> (usize, u64, u64) {
        match *self {}
    }

    pub fn bytes(&self) -> u64 {
        match *self {}
    }

    pub fn decode(&self, _: &[u8]) -> Result<Vec<u8>> {
        match *self {}
    }
}

pub fn is_fallback(_: &Buffer) -> bool {
    false
}
