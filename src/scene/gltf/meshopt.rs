//! Reads buffer views in meshoptimizer's compression, decoded by the crate meshoptimizer-rs. The extensions
//! `EXT_meshopt_compression` and `KHR_meshopt_compression` have the same settings.

use super::features::MESHOPT;
use crate::error::{Error, ErrorKind, Result};
use gltf::json::Buffer;
use gltf::json::buffer::View;
use meshoptimizer_rs::codec::{BufferView, Filter, Mode};
use meshoptimizer_rs::{Limits, Workspace};
use serde_json::Value;

/// Maximum ratio of decoded to encoded bytes. A buffer view that states a larger ratio is refused before its memory is
/// allocated. The attribute codec reaches the ratio: it encodes a group of 64 equal bytes in one byte.
const MAX_RATIO: u64 = 64;

/// Number of decoded bytes that are allowed beyond `MAX_RATIO` times the encoded bytes: one block of the codec.
const BLOCK: u64 = 8192;

/// A compressed buffer view: the location of its encoded bytes, and how to decode them.
pub struct Packed {
    buffer: usize,
    start: u64,
    length: u64,
    view: BufferView,
}

impl Packed {
    /// Reads the compression settings of a buffer view; `None` if it is not compressed.
    pub fn of(view: &View) -> Option<Result<Self>> {
        let others = &view.extensions.as_ref()?.others;
        let (name, settings) = MESHOPT.iter().find_map(|name| Some((name, others.get(*name)?)))?;
        Some(Self::read(settings, view).map_err(|e| e.context(name)))
    }

    fn read(settings: &Value, parent: &View) -> Result<Self> {
        let number = |key: &str| settings.get(key).and_then(Value::as_u64);
        let required = |key: &str| number(key).ok_or_else(|| Error::format(format!("it has no {key}")));
        let text = |key: &str, default| settings.get(key).map_or(Some(default), Value::as_str).unwrap_or_default();
        let refused = |what: &str, e| Error::format(format!("its {what}: {e}"));
        let (mode, filter) = (text("mode", ""), text("filter", "NONE"));
        let mode = Mode::parse(mode).map_err(|_| Error::format(format!("its mode is {mode:?}")))?;
        // The Khronos extension adds a filter for colours, which the crate lacks.
        let kind = if filter == "COLOR" { ErrorKind::Unsupported } else { ErrorKind::Format };
        let filter = Filter::parse(filter).map_err(|_| Error::new(kind, format!("its filter is {filter:?}")))?;
        let size = |key: &str| required(key).map(|n| usize::try_from(n).unwrap_or(usize::MAX));
        let view =
            BufferView::new(mode, filter, size("count")?, size("byteStride")?).map_err(|e| refused("layout", e))?;
        let stride = parent.byte_stride.map(|stride| stride.0);
        let bytes = usize::try_from(parent.byte_length.0).unwrap_or(usize::MAX);
        view.validate_parent(bytes, stride).map_err(|e| refused("buffer view", e))?;
        let packed = Self {
            buffer: usize::try_from(required("buffer")?).unwrap_or(usize::MAX),
            start: number("byteOffset").unwrap_or(0),
            length: required("byteLength")?,
            view,
        };
        let max_bytes = packed.length.saturating_mul(MAX_RATIO).saturating_add(BLOCK);
        if packed.bytes() > max_bytes {
            let message = format!("{} bytes cannot be in a stream of {}", packed.bytes(), packed.length);
            return Err(Error::format(message));
        }
        Ok(packed)
    }

    /// The buffer of the encoded bytes, the position of the first of them in it, and their number.
    pub fn place(&self) -> (usize, u64, u64) {
        (self.buffer, self.start, self.length)
    }

    /// Size in bytes of the decoded data.
    pub fn bytes(&self) -> u64 {
        self.view.byte_length() as u64
    }

    pub fn decode(&self, stream: &[u8]) -> Result<Vec<u8>> {
        let limits = Limits { max_bytes: usize::MAX, max_work: u64::MAX };
        let decoded = self.view.decode(stream, &mut Workspace::new(limits));
        decoded.map_err(|e| {
            let kind = match e {
                meshoptimizer_rs::Error::AllocationFailed => ErrorKind::OutOfMemory,
                meshoptimizer_rs::Error::UnsupportedVersion => ErrorKind::Unsupported,
                _ => ErrorKind::Format,
            };
            Error::new(kind, format!("meshoptimizer: {e}"))
        })
    }
}

/// Whether a buffer is only the fallback for readers without this compression. A fallback need not have data.
pub fn is_fallback(buffer: &Buffer) -> bool {
    let is = |name: &&str| buffer.extensions.as_ref()?.others.get(*name)?.get("fallback")?.as_bool();
    MESHOPT.iter().any(|name| is(name) == Some(true))
}
