//! The outer layers of a glTF file: the chunks of a GLB, and buffers and images that are embedded in the file, in
//! `data:` URIs, or in separate files.

use super::document::{self, Document};
use super::meshopt::{self, Packed};
use crate::error::{Error, ErrorKind, Result};
use crate::image::io::read_file;
use crate::image::try_with_capacity;
use crate::scene::Unrendered;
use glam::DVec3;
use gltf::json::{Index, Root, buffer};
use std::borrow::Cow;
use std::path::{Component, Path, PathBuf};

const MAGIC: &[u8] = b"glTF";
const JSON_CHUNK: &[u8] = b"JSON";
const BINARY_CHUNK: &[u8] = b"BIN\0";

/// The location of the external files to which a glTF file refers.
#[derive(Clone, Copy)]
pub struct Folder<'a> {
    /// The folder to which external paths are relative; `None` for a glTF file held in memory without a folder.
    pub path: Option<&'a Path>,
    /// Whether external paths may lead out of the folder.
    pub is_open: bool,
}

/// A parsed glTF file with the contents of all its buffers.
pub struct File<'a> {
    pub root: Root,
    /// The features that are not rendered and can be recognised from the JSON alone.
    pub unrendered: Vec<Unrendered>,
    /// The translation of each node in f64.
    pub translations: Vec<DVec3>,
    /// The bytes of each buffer. `None` for a buffer without data, which is unused or is the fallback of compressed
    /// buffer views.
    buffers: Vec<Option<Cow<'a, [u8]>>>,
    /// The decoded bytes of each compressed buffer view, with the index of the view, sorted by index.
    unpacked: Vec<(usize, Vec<u8>)>,
    folder: Folder<'a>,
}

impl<'a> File<'a> {
    pub fn parse(bytes: &'a [u8], folder: Folder<'a>) -> Result<Self> {
        let (json, blob) = split(bytes)?;
        let Document { root, unrendered, translations } = document::parse(json)?;
        let mut file = Self { root, unrendered, translations, buffers: Vec::new(), unpacked: Vec::new(), folder };
        for (i, buffer) in file.root.buffers.iter().enumerate() {
            let bytes = file.buffer(i, buffer, blob).map_err(|e| e.context(format_args!("buffer {i}")))?;
            file.buffers.push(bytes);
        }
        Ok(file)
    }

    fn buffer(&self, index: usize, buffer: &buffer::Buffer, blob: Option<&'a [u8]>) -> Result<Option<Cow<'a, [u8]>>> {
        let bytes = match (&buffer.uri, blob) {
            (Some(uri), _) => Cow::Owned(self.resolve(uri)?),
            (None, Some(blob)) if index == 0 && !meshopt::is_fallback(buffer) => Cow::Borrowed(blob),
            _ => return Ok(None),
        };
        if (bytes.len() as u64) < buffer.byte_length.0 {
            let (has, says) = (bytes.len(), buffer.byte_length.0);
            return Err(Error::format(format!("its byteLength is {says}, but only {has} bytes are there")));
        }
        Ok(Some(bytes))
    }

    /// Returns the bytes of a buffer view, decoded if they are compressed.
    pub fn view(&self, index: Index<buffer::View>) -> Result<&[u8]> {
        let number = index.value();
        let view = self.root.get(index).ok_or_else(|| missing("buffer view", number, self.root.buffer_views.len()))?;
        if let Ok(at) = self.unpacked.binary_search_by_key(&number, |(number, _)| *number) {
            return Ok(&self.unpacked[at].1);
        }
        let start = view.byte_offset.map_or(0, |o| o.0);
        self.part(view.buffer.value(), start, view.byte_length.0)
            .map_err(|e| e.context(format_args!("buffer view {number}")))
    }

    /// Returns `length` bytes of a buffer, starting at `start`.
    fn part(&self, buffer: usize, start: u64, length: u64) -> Result<&[u8]> {
        let whole = self.buffers.get(buffer).ok_or_else(|| missing("buffer", buffer, self.buffers.len()))?;
        let Some(whole) = whole else {
            // A buffer without data is valid in glTF: a vendor's extension may supply its contents. The error is
            // therefore `Unsupported` instead of `Format`.
            let message = format!("buffer {buffer} has no URI, and the file has no binary chunk for it");
            return Err(Error::new(ErrorKind::Unsupported, message));
        };
        let end = start.checked_add(length).filter(|&end| end <= whole.len() as u64);
        match end {
            Some(end) => Ok(&whole[start as usize..end as usize]),
            None => {
                let has = whole.len();
                Err(Error::format(format!("it covers {length} bytes from {start}, but its buffer has {has}")))
            }
        }
    }

    /// Iterates over the compressed buffer views, each with its index.
    fn packed(&self) -> impl Iterator<Item = (usize, Result<Packed>)> {
        self.root.buffer_views.iter().enumerate().filter_map(|(i, view)| {
            let packed = Packed::of(view)?;
            Some((i, packed.map_err(|e| e.context(format_args!("buffer view {i}")))))
        })
    }

    /// Total size in bytes of the compressed buffer views after decoding.
    pub fn packed_bytes(&self) -> Result<u64> {
        self.packed().try_fold(0u64, |sum, (_, packed)| Ok(sum.saturating_add(packed?.bytes())))
    }

    /// Decodes all compressed buffer views, so that [`File::view`] finds their bytes.
    pub fn unpack(&mut self) -> Result<()> {
        let mut unpacked = Vec::new();
        for (i, packed) in self.packed() {
            let packed = packed?;
            let (buffer, start, length) = packed.place();
            let decoded = self
                .part(buffer, start, length)
                .and_then(|stream| packed.decode(stream))
                .map_err(|e| e.context(format_args!("buffer view {i}")))?;
            unpacked.push((i, decoded));
        }
        self.unpacked = unpacked;
        Ok(())
    }

    /// Returns the bytes to which a URI refers: embedded in a `data:` URI, or read from a file.
    pub fn resolve(&self, uri: &str) -> Result<Vec<u8>> {
        if let Some(data) = uri.strip_prefix("data:") {
            let (kind, payload) = data.split_once(',').ok_or_else(|| Error::format("a data: URI without a comma"))?;
            if !kind.ends_with(";base64") {
                return Err(Error::new(ErrorKind::Unsupported, "a data: URI that is not base64"));
            }
            return decode_base64(payload);
        }
        let relative = relative_path(uri, self.folder.is_open)?;
        let base = self.folder.path.ok_or_else(|| {
            Error::argument(format!(
                "the file refers to {uri:?} beside it: give the folder of that file, or load by path"
            ))
        })?;
        let path = base.join(relative);
        read_file(&path)
    }
}

pub fn missing(kind: &str, index: usize, count: usize) -> Error {
    Error::format(format!("the file refers to {kind} {index}, but has {count}"))
}

/// Splits a GLB into its JSON chunk and its binary chunk. Other input is returned whole as JSON.
fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>)> {
    if !bytes.starts_with(MAGIC) {
        return Ok((bytes, None));
    }
    let word = |at: usize| -> Option<u32> { Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?)) };
    let truncated = || Error::format("the GLB file is truncated");
    let (version, length) = (word(4).ok_or_else(truncated)?, word(8).ok_or_else(truncated)? as usize);
    if version != 2 {
        return Err(Error::new(ErrorKind::Unsupported, format!("GLB version {version}; only version 2 is read")));
    }
    if length > bytes.len() {
        return Err(Error::format(format!("the GLB header says {length} bytes, but the file has {}", bytes.len())));
    }
    let (mut json, mut binary) = (None, None);
    let mut at = 12;
    while at + 8 <= length {
        let size = word(at).ok_or_else(truncated)? as usize;
        let (kind, start) = (&bytes[at + 4..at + 8], at + 8);
        let end = start.checked_add(size).filter(|&end| end <= length).ok_or_else(truncated)?;
        // Skip chunks of unknown type, as the specification requires.
        match kind {
            JSON_CHUNK if json.is_none() => json = Some(&bytes[start..end]),
            BINARY_CHUNK if binary.is_none() => binary = Some(&bytes[start..end]),
            _ => {}
        }
        at = end;
    }
    json.map(|json| (json, binary)).ok_or_else(|| Error::format("the GLB file has no JSON chunk"))
}

/// Decodes a URI to the path of a file. A path that leads out of the folder, such as an absolute path, is an error
/// unless `is_open` is true.
fn relative_path(uri: &str, is_open: bool) -> Result<PathBuf> {
    let broken = |why: &str| Error::format(format!("the external file {uri:?} {why}"));
    let refused = |why: &str| Error::new(ErrorKind::Unsupported, format!("the external file {uri:?} {why}"));
    let bytes = decode_percent(uri).ok_or_else(|| broken("is not validly percent-encoded"))?;
    let name = String::from_utf8(bytes).map_err(|_| broken("is not valid UTF-8"))?;
    if name.contains('\0') {
        return Err(broken("has a zero in its name"));
    }
    if name.contains(['\\', ':']) {
        return Err(refused("is not a relative path with /: only files are read, no other resources"));
    }
    let path = PathBuf::from(name);
    if path.file_name().is_none() {
        return Err(broken("is no file"));
    }
    let is_inside = path.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    if !is_inside && !is_open {
        return Err(refused(
            "lies outside the folder of the scene; allow this by luxfer_scene_load_params.allow_external_files",
        ));
    }
    Ok(path)
}

fn decode_percent(text: &str) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        if first == b'%' {
            let digit = |b: u8| (b as char).to_digit(16);
            let (high, low) = (digit(*tail.first()?)?, digit(*tail.get(1)?)?);
            out.push((high * 16 + low) as u8);
            rest = &tail[2..];
        } else {
            out.push(first);
            rest = tail;
        }
    }
    Some(out)
}

/// Decodes base64 (RFC 4648, section 4). The padding is optional.
fn decode_base64(text: &str) -> Result<Vec<u8>> {
    let digits = text.trim_end_matches('=');
    let mut out = try_with_capacity(digits.len() / 4 * 3 + 3)?;
    let (mut bits, mut count) = (0u32, 0);
    for byte in digits.bytes() {
        let value = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return Err(Error::format(format!("byte 0x{byte:02x} in a data: URI is not base64"))),
        };
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            out.push((bits >> count) as u8);
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_meets_the_vectors_of_rfc_4648() {
        for (text, want) in
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg", "foob"), ("Zm9vYmFy", "foobar")]
        {
            assert_eq!(decode_base64(text).unwrap(), want.as_bytes());
        }
        assert_eq!(decode_base64("Zm9v*").unwrap_err().kind, ErrorKind::Format);
    }

    #[test]
    fn paths_leave_their_folder_only_where_they_may() {
        for is_open in [false, true] {
            assert_eq!(relative_path("a%20b/c.png", is_open).unwrap(), PathBuf::from("a b/c.png"));
            for bad in ["", "..", "%zz", "%2", "a%00b"] {
                assert_eq!(relative_path(bad, is_open).unwrap_err().kind, ErrorKind::Format, "{bad}");
            }
            for other in ["http://host/x", "a\\..\\x", "C:/x"] {
                assert_eq!(relative_path(other, is_open).unwrap_err().kind, ErrorKind::Unsupported, "{other}");
            }
        }
        for outside in ["../x", "a/../../x", "/etc/passwd", "%2e%2e/x"] {
            assert_eq!(relative_path(outside, false).unwrap_err().kind, ErrorKind::Unsupported, "{outside}");
            assert!(relative_path(outside, true).is_ok(), "{outside}");
        }
    }
}
