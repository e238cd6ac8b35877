//! The attributes of a primitive's vertices: from accessors, or from the stream of a compressed primitive.

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

    /// The values of an attribute; `None` if the primitive lacks it. Normalised integers are scaled.
    pub fn vectors<const N: usize>(&self, semantic: &Semantic) -> Result<Option<Vec<[f32; N]>>> {
        let Some(index) = self.accessor(semantic) else { return Ok(None) };
        if let Some(values) = self.decoded.as_ref().and_then(|decoded| decoded.vectors(self.file, semantic, index)) {
            return values.map(Some);
        }
        accessor::vectors(self.file, index).map(Some)
    }

    /// As `vectors`, with an error if the number of values is not the number of vertices.
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

    /// The colours of the vertices; alpha is 1 where the file has none.
    pub fn colours(&self, count: usize) -> Result<Option<Vec<[f32; 4]>>> {
        let semantic = Semantic::Colors(0);
        let Some(index) = self.accessor(&semantic) else { return Ok(None) };
        if accessor::components(self.file, index)? != 3 {
            return self.checked(&semantic, count);
        }
        let colours = self.checked(&semantic, count)?;
        colours.map(|colours| try_collect(colours.into_iter().map(|[r, g, b]| [r, g, b, 1.0]))).transpose()
    }

    /// The indices, and the mode in which they form triangles.
    pub fn indices(&self, mode: Mode, count: usize) -> Result<(Mode, Vec<u32>)> {
        match (&self.decoded, self.primitive.indices) {
            // A stream has whole triangles, whatever the mode.
            (Some(decoded), _) => Ok((Mode::Triangles, decoded.indices()?)),
            (None, Some(index)) => Ok((mode, accessor::indices(self.file, index)?)),
            (None, None) => Ok((mode, try_collect(0..count as u32)?)),
        }
    }
}
