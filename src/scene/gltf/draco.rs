//! Reads primitives in Draco's compression (`KHR_draco_mesh_compression`), decoded by the crate draco-core.

use super::container::{File, missing};
use super::features::DRACO;
use super::{Budget, accessor};
use crate::error::{Error, Result};
use crate::image::{check_memory, try_collect, try_vec};
use draco_core::{DecodeLimits, DecoderBuffer, FaceIndex, Mesh, MeshDecoder};
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Accessor, Index, buffer};
use serde_json::Value;

/// Upper bounds of the bytes that the decoder allocates per vertex and per triangle for corner tables, traversal and
/// symbols, in addition to the attribute values.
const VERTEX_BYTES: u64 = 256;
const TRIANGLE_BYTES: u64 = 256;

/// Bytes of memory that decoding takes per attribute component: for the decoded integer, and for the value computed
/// from this integer.
const COMPONENT_BYTES: u64 = 16;

/// A decoded primitive.
pub struct Decoded {
    mesh: Mesh,
    /// The names of the attributes (such as `POSITION`), each with its number in the Draco stream.
    numbers: Vec<(String, u32)>,
}

impl Decoded {
    /// Decodes a primitive. `None` if it has no Draco stream, or if its file also holds the vertex positions
    /// uncompressed.
    pub fn read(file: &File, budget: &dyn Budget, primitive: &Primitive) -> Result<Option<Self>> {
        let Some(settings) = primitive.extensions.as_ref().and_then(|e| e.others.get(DRACO)) else { return Ok(None) };
        let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
        let has_data = |index: &Index<Accessor>| file.root.get(*index).is_some_and(|a| a.buffer_view.is_some());
        if positions.is_some_and(has_data) {
            return Ok(None);
        }
        decode(file, budget, primitive, settings).map(Some).map_err(|e| e.context(DRACO))
    }

    /// Number of vertices.
    pub fn count(&self) -> usize {
        self.mesh.num_points()
    }

    /// Returns the values of an attribute, with integers normalised if the accessor `index` says so. `None` if the
    /// stream lacks the attribute.
    pub fn vectors<const N: usize>(
        &self,
        file: &File,
        semantic: &Semantic,
        index: Index<Accessor>,
    ) -> Option<Result<Vec<[f32; N]>>> {
        let name = semantic.to_string();
        let number = self.numbers.iter().find(|(known, _)| *known == name)?.1;
        Some(self.values(file, number, index).map_err(|e| e.context(format_args!("{DRACO}: {name}"))))
    }

    fn values<const N: usize>(&self, file: &File, number: u32, index: Index<Accessor>) -> Result<Vec<[f32; N]>> {
        let attribute = self.mesh.attribute_by_unique_id(number);
        let attribute = attribute.ok_or_else(|| Error::format(format!("the stream has no attribute {number}")))?;
        if attribute.num_components() as usize != N {
            let found = attribute.num_components();
            return Err(Error::format(format!("it has {found} components where {N} are expected")));
        }
        let largest = accessor::largest(file, index)?;
        let values = attribute.read_f32s(self.count(), N);
        let mut out = try_vec(self.count(), [0.0; N])?;
        for (o, value) in out.iter_mut().zip(values.chunks_exact(N)) {
            *o = std::array::from_fn(|c| largest.map_or(value[c], |largest| (value[c] / largest).max(-1.0)));
        }
        Ok(out)
    }

    /// Returns the vertex indices of all triangles, three per triangle.
    pub fn indices(&self) -> Result<Vec<u32>> {
        let face = |i: usize| self.mesh.face(FaceIndex(i as u32)).map(|point| point.0);
        try_collect((0..self.mesh.num_faces()).flat_map(face))
    }
}

fn decode(file: &File, budget: &dyn Budget, primitive: &Primitive, settings: &Value) -> Result<Decoded> {
    let view = settings.get("bufferView").and_then(Value::as_u64).and_then(|n| u32::try_from(n).ok());
    let view = view.ok_or_else(|| Error::format("it names no buffer view"))?;
    let stream = file.view(Index::<buffer::View>::new(view))?;
    let named = settings.get("attributes").and_then(Value::as_object);
    let named = named.ok_or_else(|| Error::format("it names no attributes"))?;
    let number = |(name, value): (&String, &Value)| {
        let number = value.as_u64().and_then(|n| u32::try_from(n).ok());
        Ok((name.clone(), number.ok_or_else(|| Error::format(format!("attribute {name} has no number")))?))
    };
    let numbers = named.iter().map(number).collect::<Result<Vec<_>>>()?;

    // The accessors state the sizes of the decoded data. Limit the decoder to these sizes, so that a malicious stream
    // cannot take more memory.
    let count = |index| accessor::count(file, index);
    let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions)).copied();
    let vertices = count(positions.ok_or_else(|| Error::format("a primitive has no POSITION"))?)?;
    let corners = count(primitive.indices.ok_or_else(|| Error::format("a primitive has no indices"))?)?;
    let triangles = corners.div_ceil(3);
    let components = primitive.attributes.values().map(|index| accessor::components(file, *index));
    let components = components.sum::<Result<usize>>()? as u64;
    let values = vertices.saturating_mul(components).saturating_mul(COMPONENT_BYTES);
    let sizes = vertices.saturating_mul(VERTEX_BYTES).saturating_add(triangles.saturating_mul(TRIANGLE_BYTES));
    let needed = values.saturating_add(sizes);

    let limits = DecodeLimits::default();
    let limits = limits.with_max_points(vertices).with_max_faces(triangles).with_max_decoded_bytes(values);
    let mut mesh = Mesh::new();
    budget.lend(needed, &mut || {
        check_memory(usize::try_from(needed).unwrap_or(usize::MAX))?;
        let mut buffer = DecoderBuffer::new(stream).with_limits(limits);
        MeshDecoder::new().decode(&mut buffer, &mut mesh).map_err(|e| Error::format(e.to_string()))
    })?;
    if mesh.num_points() as u64 != vertices {
        let found = mesh.num_points();
        return Err(Error::format(format!("the stream has {found} vertices, but POSITION has a count of {vertices}")));
    }
    if mesh.num_faces() as u64 > triangles {
        let found = mesh.num_faces();
        return Err(Error::format(format!("the stream has {found} triangles, but there are {corners} indices")));
    }
    if let Some((_, number)) = numbers.iter().find(|(_, number)| mesh.attribute_by_unique_id(*number).is_none()) {
        return Err(missing("attribute", *number as usize, mesh.num_attributes().max(0) as usize));
    }
    Ok(Decoded { mesh, numbers })
}
