//! Stands in for `draco` in builds without the Cargo feature `mesh-compression`. Draco streams are still recognised, so
//! that the error names the feature.

use super::Budget;
use super::container::File;
use super::features::DRACO;
use super::meshopt::left_out;
use crate::error::Result;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::{Accessor, Index};

/// No value of this type exists.
pub enum Decoded {}

impl Decoded {
    pub fn read(_: &File, _: &dyn Budget, primitive: &Primitive) -> Result<Option<Self>> {
        match primitive.extensions.as_ref().and_then(|e| e.others.get(DRACO)) {
            Some(_) => Err(left_out().context(DRACO)),
            None => Ok(None),
        }
    }

    pub fn vectors<const N: usize>(&self, _: &File, _: &Semantic, _: Index<Accessor>) -> Option<Result<Vec<[f32; N]>>> {
        match *self {}
    }

    pub fn indices(&self) -> Result<Vec<u32>> {
        match *self {}
    }
}
