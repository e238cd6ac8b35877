//! Stands in for the modules `draco` and `meshopt` in builds without the Cargo feature `mesh-compression`. Compressed
//! meshes are still recognised, so that the error names the feature.

use super::Budget;
use super::container::File;
use super::features::{DRACO, MESHOPT};
use crate::error::{Error, Result};
use gltf::json::Index;
use gltf::json::accessor::Accessor;
use gltf::json::buffer::{Buffer, View};
use gltf::json::mesh::{Primitive, Semantic};

fn left_out() -> Error {
    Error::left_out("compressed meshes were", "mesh-compression")
}

pub mod draco {
    use super::{Accessor, Budget, DRACO, File, Index, Primitive, Result, Semantic, left_out};

    /// No value of this type exists.
    pub enum Decoded {}

    impl Decoded {
        pub fn read(_: &File, _: &dyn Budget, primitive: &Primitive) -> Result<Option<Self>> {
            match primitive.extensions.as_ref().and_then(|e| e.others.get(DRACO)) {
                Some(_) => Err(left_out().context(DRACO)),
                None => Ok(None),
            }
        }

        pub fn count(&self) -> usize {
            match *self {}
        }

        pub fn vectors<const N: usize>(
            &self,
            _: &File,
            _: &Semantic,
            _: Index<Accessor>,
        ) -> Option<Result<Vec<[f32; N]>>> {
            match *self {}
        }

        pub fn indices(&self) -> Result<Vec<u32>> {
            match *self {}
        }
    }
}

pub mod meshopt {
    use super::{Buffer, MESHOPT, Result, View, left_out};

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
}
