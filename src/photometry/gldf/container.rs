//! The ZIP archive of a GLDF container, held in memory: finds, unpacks and checks its files. Names are only compared;
//! nothing is written to a disk.

use crate::error::{Error, ErrorKind, Result};
use crate::image::{try_vec, try_with_capacity};
use miniz_oxide::inflate::decompress_slice_iter_to_slice;
use rawzip::{CompressionMethod, ZipArchive, ZipArchiveEntryWayfinder, ZipSliceArchive};

/// Maximum number of files in a container. [convention]
const MAX_FILES: u64 = 4096;

/// A file of the container: its name as bytes, and its place in the archive.
struct Entry {
    name: Vec<u8>,
    method: CompressionMethod,
    is_encrypted: bool,
    place: ZipArchiveEntryWayfinder,
}

pub struct Container<'a> {
    archive: ZipSliceArchive<&'a [u8]>,
    entries: Vec<Entry>,
}

fn damaged(error: impl std::fmt::Display) -> Error {
    Error::format(format!("the ZIP archive is damaged: {error}"))
}

impl<'a> Container<'a> {
    /// Reads the list of files.
    ///
    /// # Errors
    /// `Format` if the archive is damaged, has too many files, or has two files of one name.
    pub fn new(bytes: &'a [u8]) -> Result<Self> {
        let archive = ZipArchive::from_slice(bytes).map_err(damaged)?;
        let stated = archive.entries_hint();
        if stated > MAX_FILES {
            return Err(Error::format(format!("the ZIP archive has {stated} files; at most {MAX_FILES} are read")));
        }
        let mut entries: Vec<Entry> = try_with_capacity(stated as usize)?;
        let mut list = archive.entries();
        while let Some(record) = list.next_entry().map_err(damaged)? {
            if entries.len() as u64 == stated {
                return Err(damaged("it has more files than it states"));
            }
            entries.push(Entry {
                name: record.file_path().as_bytes().to_ascii_lowercase(),
                method: record.compression_method(),
                is_encrypted: record.flags().is_encrypted(),
                place: record.wayfinder(),
            });
        }
        if entries.len() as u64 != stated {
            return Err(damaged(format_args!("it states {stated} files and has {}", entries.len())));
        }
        let mut names: Vec<&[u8]> = entries.iter().map(|entry| entry.name.as_slice()).collect();
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            let name = String::from_utf8_lossy(pair[0]);
            return Err(Error::format(format!("the ZIP archive has two files with the name {name:?}")));
        }
        Ok(Self { archive, entries })
    }

    /// Unpacks the file with the given name, whose unpacked size must be at most `limit` bytes. Upper and lower case of
    /// ASCII letters are not distinguished.
    ///
    /// # Errors
    /// `NotFound` if no file has the name; `Format` if the file is damaged or too large; `Unsupported` if it is
    /// encrypted or compressed by another method than DEFLATE.
    pub fn file(&self, name: &str, limit: usize) -> Result<Vec<u8>> {
        self.unpack(name, limit).map_err(|e| e.context(name))
    }

    fn unpack(&self, name: &str, limit: usize) -> Result<Vec<u8>> {
        let lower = name.to_ascii_lowercase();
        let entry = self.entries.iter().find(|entry| entry.name == lower.as_bytes());
        // If no name is equal to `name`, take the only file whose name can be `name` in a code page: old programs write
        // names with one byte for each character.
        let alike = || {
            let mut alike = self.entries.iter().filter(|entry| is_alike(&lower, &entry.name));
            alike.next().filter(|_| alike.next().is_none())
        };
        let Some(entry) = entry.or_else(alike) else {
            return Err(Error::new(ErrorKind::NotFound, "the container has no such file"));
        };
        let unsupported = |message: &str| Err(Error::new(ErrorKind::Unsupported, message));
        if entry.is_encrypted {
            return unsupported("the file is encrypted");
        }
        let packed = self.archive.get_entry(entry.place).map_err(damaged)?;
        let claim = packed.claim_verifier();
        let (size, data) = (claim.uncompressed_size, packed.data());
        if size > limit as u64 {
            return Err(Error::format(format!("the file has {size} bytes; at most {limit} are read")));
        }
        let mut out = try_vec(size as usize, 0)?;
        match entry.method {
            CompressionMethod::STORE if data.len() as u64 == size => out.copy_from_slice(data),
            CompressionMethod::STORE => return Err(damaged(format_args!("{} bytes are not {size}", data.len()))),
            CompressionMethod::DEFLATE => {
                let found = decompress_slice_iter_to_slice(&mut out, std::iter::once(data), false, false);
                if found != Ok(size as usize) {
                    return Err(damaged(format_args!("its data do not unpack to {size} bytes")));
                }
            }
            _ => return unsupported("the file is compressed by another method than DEFLATE"),
        }
        if rawzip::crc32(&out) != claim.crc {
            return Err(damaged("its checksum is wrong"));
        }
        Ok(out)
    }
}

/// Whether `bytes` can be `name` in an unknown code page: the ASCII characters are equal, and each other character is
/// one byte. False for a `name` of ASCII characters alone.
fn is_alike(name: &str, bytes: &[u8]) -> bool {
    !name.is_ascii()
        && name.chars().count() == bytes.len()
        && name.chars().zip(bytes).all(|(c, b)| if c.is_ascii() { c as u8 == *b } else { !b.is_ascii() })
}
