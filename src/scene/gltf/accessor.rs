//! Reads accessors: typed arrays in buffer views (glTF 2.0, section 3.6.2), including sparse ones.

use super::container::{File, missing};
use crate::error::{Error, ErrorKind, Result};
use crate::image::try_vec;
use gltf::json::accessor::{self, ComponentType, Type};
use gltf::json::validation::Checked;
use gltf::json::{Index, buffer};

/// Maximum number of elements of an accessor without a buffer view. Its elements are zeros, except where sparse values
/// replace them.
const MAX_UNBACKED: usize = 1 << 20;

/// The elements of an array, which lie `stride` bytes apart.
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
    kind: ComponentType,
    components: usize,
    normalized: bool,
}

impl<'a> Strided<'a> {
    /// Returns a view of `count` elements, starting `offset` bytes into a buffer view. Returns an error if the elements
    /// reach beyond the end of the buffer view.
    fn new(
        file: &'a File,
        view: Index<buffer::View>,
        offset: u64,
        kind: ComponentType,
        components: usize,
        count: usize,
    ) -> Result<Self> {
        let bytes = file.view(view)?;
        let size = kind.size() * components;
        let stride = match file.root.get(view).and_then(|v| v.byte_stride) {
            Some(stride) if stride.0 < size => {
                return Err(Error::format(format!(
                    "the stride {} is shorter than an element of {size} bytes",
                    stride.0
                )));
            }
            Some(stride) => stride.0,
            None => size,
        };
        let last = (count as u64).saturating_sub(1).checked_mul(stride as u64);
        let end = last.and_then(|l| l.checked_add(size as u64)).and_then(|l| l.checked_add(offset));
        if end.is_none_or(|end| end > bytes.len() as u64) {
            return Err(Error::format(format!(
                "{count} elements, {stride} bytes apart from byte {offset}, do not fit into the view's {} bytes",
                bytes.len()
            )));
        }
        Ok(Self { bytes: &bytes[offset as usize..], stride, kind, components, normalized: false })
    }

    fn component(&self, element: usize, component: usize) -> &[u8] {
        let at = element * self.stride + component * self.kind.size();
        &self.bytes[at..at + self.kind.size()]
    }

    fn float(&self, element: usize, component: usize) -> f32 {
        let b = self.component(element, component);
        let value = match self.kind {
            ComponentType::I8 => f32::from(b[0] as i8),
            ComponentType::U8 => f32::from(b[0]),
            ComponentType::I16 => f32::from(i16::from_le_bytes([b[0], b[1]])),
            ComponentType::U16 => f32::from(u16::from_le_bytes([b[0], b[1]])),
            ComponentType::U32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32,
            ComponentType::F32 => return f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        };
        if self.normalized { (value / largest_of(self.kind)).max(-1.0) } else { value }
    }

    fn unsigned(&self, element: usize) -> Result<u32> {
        let b = self.component(element, 0);
        match self.kind {
            ComponentType::U8 => Ok(b[0].into()),
            ComponentType::U16 => Ok(u16::from_le_bytes([b[0], b[1]]).into()),
            ComponentType::U32 => Ok(u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            _ => Err(Error::format("indices must be unsigned integers")),
        }
    }

    fn vector<const N: usize>(&self, element: usize) -> [f32; N] {
        std::array::from_fn(|c| if c < self.components { self.float(element, c) } else { 0.0 })
    }
}

/// Returns the integer by which a normalised integer of this type is divided; 1 for floats.
fn largest_of(kind: ComponentType) -> f32 {
    match kind {
        ComponentType::I8 => 127.0,
        ComponentType::U8 => 255.0,
        ComponentType::I16 => 32_767.0,
        ComponentType::U16 => 65_535.0,
        ComponentType::U32 => 4_294_967_295.0,
        ComponentType::F32 => 1.0,
    }
}

fn find<'a>(file: &'a File, index: Index<accessor::Accessor>) -> Result<&'a accessor::Accessor> {
    file.root.get(index).ok_or_else(|| missing("accessor", index.value(), file.root.accessors.len()))
}

/// Returns how an accessor stores an element: the type of its components, and their number.
fn storage(accessor: &accessor::Accessor) -> Result<(ComponentType, usize)> {
    match (&accessor.component_type, &accessor.type_) {
        (Checked::Valid(kind), Checked::Valid(shape)) => {
            let components = match shape {
                Type::Scalar => 1,
                Type::Vec2 => 2,
                Type::Vec3 => 3,
                Type::Vec4 => 4,
                Type::Mat4 => 16,
                Type::Mat2 | Type::Mat3 => return Err(Error::format("a matrix where a vector is expected")),
            };
            Ok((kind.0, components))
        }
        _ => Err(Error::format("its componentType or type is unknown")),
    }
}

/// Returns the number of elements that an accessor declares, without any check of its data.
pub fn count(file: &File, index: Index<accessor::Accessor>) -> Result<u64> {
    Ok(find(file, index)?.count.0)
}

/// Returns the number of components of an accessor's elements.
pub fn components(file: &File, index: Index<accessor::Accessor>) -> Result<usize> {
    Ok(storage(find(file, index)?)?.1)
}

/// Returns the integer that stands for the value 1 if an accessor holds normalised integers; `None` for other
/// accessors.
#[cfg(feature = "mesh-compression")]
pub fn largest(file: &File, index: Index<accessor::Accessor>) -> Result<Option<f32>> {
    let accessor = find(file, index)?;
    let (kind, _) = storage(accessor)?;
    Ok((accessor.normalized && kind != ComponentType::F32).then(|| largest_of(kind)))
}

/// Reads an accessor of vectors with `N` components (16 for 4 × 4 matrices, column by column). Normalised integers are
/// scaled: unsigned ones to `[0, 1]`, signed ones to `[-1, 1]`.
pub fn vectors<const N: usize>(file: &File, index: Index<accessor::Accessor>) -> Result<Vec<[f32; N]>> {
    read_vectors(file, index).map_err(|e| e.context(format_args!("accessor {}", index.value())))
}

fn read_vectors<const N: usize>(file: &File, index: Index<accessor::Accessor>) -> Result<Vec<[f32; N]>> {
    let accessor = find(file, index)?;
    let (kind, components) = storage(accessor)?;
    if components != N {
        return Err(Error::format(format!("it has {components} components where {N} are expected")));
    }
    let count = usize::try_from(accessor.count.0).map_err(|_| Error::format("its count exceeds all memory"))?;
    let strided = |view, offset, count| {
        Strided::new(file, view, offset, kind, components, count)
            .map(|strided| Strided { normalized: accessor.normalized, ..strided })
    };
    let mut out = match accessor.buffer_view {
        Some(view) => {
            let source = strided(view, accessor.byte_offset.map_or(0, |o| o.0), count)?;
            let mut out = try_vec(count, [0.0; N])?;
            for (i, o) in out.iter_mut().enumerate() {
                *o = source.vector(i);
            }
            out
        }
        None if count <= MAX_UNBACKED => try_vec(count, [0.0; N])?,
        None => {
            let message = format!("{count} elements without a buffer view; at most {MAX_UNBACKED} are read");
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
    };
    if let Some(sparse) = &accessor.sparse {
        let (positions, changes) = sparse_parts(file, sparse, strided)?;
        for i in 0..sparse.count.0 as usize {
            let at = positions.unsigned(i)? as usize;
            *out.get_mut(at).ok_or_else(|| Error::format(format!("a sparse index is {at}, beyond {count}")))? =
                changes.vector(i);
        }
    }
    Ok(out)
}

/// Returns the indices of the elements that a sparse accessor replaces, and the values that replace them.
fn sparse_parts<'a>(
    file: &'a File,
    sparse: &accessor::sparse::Sparse,
    strided: impl Fn(Index<buffer::View>, u64, usize) -> Result<Strided<'a>>,
) -> Result<(Strided<'a>, Strided<'a>)> {
    let Checked::Valid(kind) = &sparse.indices.component_type else {
        return Err(Error::format("the componentType of its sparse indices is unknown"));
    };
    let count = usize::try_from(sparse.count.0).map_err(|_| Error::format("its sparse count exceeds all memory"))?;
    let at = Strided::new(file, sparse.indices.buffer_view, sparse.indices.byte_offset.0, kind.0, 1, count)?;
    Ok((at, strided(sparse.values.buffer_view, sparse.values.byte_offset.0, count)?))
}

/// Reads an accessor of vertex indices.
pub fn indices(file: &File, index: Index<accessor::Accessor>) -> Result<Vec<u32>> {
    let read = || {
        let accessor = find(file, index)?;
        let (kind, components) = storage(accessor)?;
        let (Some(view), 1) = (accessor.buffer_view, components) else {
            return Err(Error::format("indices must be scalars in a buffer view"));
        };
        let count = usize::try_from(accessor.count.0).map_err(|_| Error::format("its count exceeds all memory"))?;
        let source = Strided::new(file, view, accessor.byte_offset.map_or(0, |o| o.0), kind, 1, count)?;
        let mut out = try_vec(count, 0)?;
        for (i, o) in out.iter_mut().enumerate() {
            *o = source.unsigned(i)?;
        }
        Ok(out)
    };
    read().map_err(|e: Error| e.context(format_args!("accessor {}", index.value())))
}
