//! Reads the vertex attributes of a primitive, from accessors or from a Draco stream.

use super::container::File;
use super::draco::Decoded;
use super::{Budget, accessor};
use crate::error::{Error, Result};
use crate::image::try_collect;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Accessor, Index};

pub struct Vertices<'a> {
    file: &'a File<'a>,
    primitive: &'a Primitive,
    decoded: Option<Decoded>,
}

impl<'a> Vertices<'a> {
    pub fn new(file: &'a File<'a>, budget: &dyn Budget, primitive: &'a Primitive) -> Result<Self> {
        Ok(Self { file, primitive, decoded: Decoded::read(file, budget, primitive)? })
    }

    fn accessor(&self, semantic: &Semantic) -> Option<Index<Accessor>> {
        self.primitive.attributes.get(&Checked::Valid(semantic.clone())).copied()
    }

    /// Returns the values of an attribute, with normalised integers scaled to floats; `None` if the primitive lacks
    /// the attribute.
    pub fn vectors<const N: usize>(&self, semantic: &Semantic) -> Result<Option<Vec<[f32; N]>>> {
        let Some(index) = self.accessor(semantic) else { return Ok(None) };
        if let Some(values) = self.decoded.as_ref().and_then(|decoded| decoded.vectors(self.file, semantic, index)) {
            return values.map(Some);
        }
        accessor::vectors(self.file, index).map(Some)
    }

    /// Like `vectors`, but returns an error unless there is one value for each of the `count` vertices.
    pub fn checked<const N: usize>(&self, semantic: &Semantic, count: usize) -> Result<Option<Vec<[f32; N]>>> {
        let values = self.vectors(semantic)?;
        match values.as_ref().map(Vec::len) {
            Some(len) if len != count => {
                let name = semantic.to_string();
                Err(Error::format(format!("{count} positions, but {len} values of {name}")))
            }
            _ => Ok(values),
        }
    }

    /// Returns the colours of the vertices as RGBA, with an alpha of 1 if the file has no alpha; `None` if the
    /// primitive has no colours.
    pub fn colours(&self, count: usize) -> Result<Option<Vec<[f32; 4]>>> {
        let semantic = Semantic::Colors(0);
        let Some(index) = self.accessor(&semantic) else { return Ok(None) };
        if accessor::components(self.file, index)? != 3 {
            return self.checked(&semantic, count);
        }
        let colours = self.checked(&semantic, count)?;
        colours.map(|colours| try_collect(colours.into_iter().map(|[r, g, b]| [r, g, b, 1.0]))).transpose()
    }

    /// Returns the vertex indices, and the primitive mode by which they form triangles. A primitive without indices
    /// uses its vertices in order.
    pub fn indices(&self, mode: Mode, count: usize) -> Result<(Mode, Vec<u32>)> {
        match (&self.decoded, self.primitive.indices) {
            // A Draco stream always holds separate triangles, whatever the mode of the primitive.
            (Some(decoded), _) => Ok((Mode::Triangles, decoded.indices()?)),
            (None, Some(index)) => Ok((mode, accessor::indices(self.file, index)?)),
            (None, None) => Ok((mode, try_collect(0..count as u32)?)),
        }
    }
}
