//! Reads and checks the tags that describe how a TIFF file stores the pixels of its first picture.

use super::ifd::{Directory, Field};
use crate::error::{Error, ErrorKind, Result};
use crate::image::limits::{MAX_COMPRESSION, check_size};

/// The tags that describe the layout of pixels (TIFF 6.0).
mod tag {
    pub const NEW_SUBFILE_TYPE: u16 = 254;
    pub const WIDTH: u16 = 256;
    pub const HEIGHT: u16 = 257;
    pub const BITS: u16 = 258;
    pub const COMPRESSION: u16 = 259;
    pub const PHOTOMETRIC: u16 = 262;
    pub const FILL_ORDER: u16 = 266;
    pub const STRIP_OFFSETS: u16 = 273;
    pub const SAMPLES: u16 = 277;
    pub const ROWS_PER_STRIP: u16 = 278;
    pub const STRIP_SIZES: u16 = 279;
    pub const PLANAR: u16 = 284;
    pub const PREDICTOR: u16 = 317;
    pub const COLOUR_MAP: u16 = 320;
    pub const TILE_WIDTH: u16 = 322;
    pub const TILE_HEIGHT: u16 = 323;
    pub const TILE_OFFSETS: u16 = 324;
    pub const TILE_SIZES: u16 = 325;
    pub const EXTRA_SAMPLES: u16 = 338;
    pub const SAMPLE_FORMAT: u16 = 339;
    pub const DNG_VERSION: u16 = 50_706;
}

/// Maximum number of stored samples per pixel, including samples that are not colours; no photo has more. [convention]
const MAX_SAMPLES: u64 = 16;

/// A tile wider than this many pixels is accepted only if the picture is at least as wide as the tile. [convention]
const MAX_TILE: usize = 4096;

/// The number format of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// 1, 2 or 4 bits. The first sample of a byte is in its highest bits.
    Bits(u8),
    U8,
    U16,
    U32,
    F16,
    F32,
    F64,
}

impl Depth {
    pub fn bits(self) -> usize {
        match self {
            Self::Bits(bits) => bits.into(),
            Self::U8 => 8,
            Self::U16 | Self::F16 => 16,
            Self::U32 | Self::F32 => 32,
            Self::F64 => 64,
        }
    }

    pub fn is_float(self) -> bool {
        matches!(self, Self::F16 | Self::F32 | Self::F64)
    }
}

#[derive(Clone, Copy)]
pub enum Photometric<'a> {
    Grey {
        is_inverted: bool,
    },
    Rgb,
    Cmyk,
    /// The colours of all codes: first the reds, then the greens, then the blues, with 16 bits each.
    Palette(Field<'a>),
}

/// Whether the colours have been multiplied by alpha (associated) or not (unassociated).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alpha {
    Associated,
    Unassociated,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compression {
    None,
    Lzw,
    Deflate,
    PackBits,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Predictor {
    None,
    Horizontal,
    Float,
}

/// A rectangle of pixels that the file stores separately: a strip or a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chunk {
    /// Index of this chunk in the list of chunks.
    pub index: usize,
    /// Index of the sample that the chunk holds if each sample has its own chunks; otherwise 0.
    pub plane: usize,
    /// Position of its top-left pixel in the picture.
    pub x: usize,
    pub y: usize,
    /// Size in pixels of the part of the chunk that lies within the picture.
    pub width: usize,
    pub height: usize,
}

#[derive(Clone, Copy)]
pub struct PixelTags<'a> {
    pub width: usize,
    pub height: usize,
    pub depth: Depth,
    pub colour: Photometric<'a>,
    pub alpha: Option<Alpha>,
    pub compression: Compression,
    pub predictor: Predictor,
    /// Number of samples per pixel in a chunk: all samples of the pixel, or 1 if the file stores each sample in chunks
    /// of its own (planar).
    pub samples: usize,
    planes: usize,
    /// Width and height in pixels of a chunk as stored.
    chunk: [usize; 2],
    offsets: Field<'a>,
    sizes: Field<'a>,
    directory: Directory<'a>,
}

impl<'a> PixelTags<'a> {
    /// Reads and checks the tags of a directory in a file of `file_bytes` bytes.
    pub fn new(directory: Directory<'a>, file_bytes: usize) -> Result<Self> {
        check_is_picture(&directory)?;
        let required = |tag, name| required(&directory, tag, name);
        let or = |tag, name, default| Ok::<u64, Error>(integer(&directory, tag, name)?.unwrap_or(default));
        let (width, height) = (required(tag::WIDTH, "ImageWidth")?, required(tag::HEIGHT, "ImageLength")?);
        check_size(width, height)?;
        let (width, height) = (width as usize, height as usize);

        let samples = or(tag::SAMPLES, "SamplesPerPixel", 1)?;
        if !(1..=MAX_SAMPLES).contains(&samples) {
            return Err(Error::format(format!(
                "the TIFF has {samples} samples per pixel; it must have 1 to {MAX_SAMPLES}"
            )));
        }
        let samples = samples as usize;
        let depth = depth(&directory, samples)?;
        let colour = colour(&directory, required(tag::PHOTOMETRIC, "PhotometricInterpretation")?, depth)?;
        let alpha = alpha(&directory, colour, samples)?;
        let compression = compression(or(tag::COMPRESSION, "Compression", 1)?)?;
        let predictor = predictor(or(tag::PREDICTOR, "Predictor", 1)?, depth)?;
        if or(tag::FILL_ORDER, "FillOrder", 1)? != 1 {
            return Err(unsupported("bytes whose lowest bit comes first (FillOrder 2)"));
        }
        let is_planar = samples > 1 && or(tag::PLANAR, "PlanarConfiguration", 1)? == 2;
        if is_planar && matches!(colour, Photometric::Cmyk) {
            return Err(unsupported("CMYK in separate planes"));
        }

        let Chunks { size, offsets, bytes } = Chunks::new(&directory, width, height)?;
        let tags = Self {
            width,
            height,
            depth,
            colour,
            alpha,
            compression,
            predictor,
            samples: if is_planar { 1 } else { samples },
            planes: if is_planar { samples } else { 1 },
            chunk: size,
            offsets: directory.field(offsets).ok_or_else(|| missing("StripOffsets"))?,
            sizes: directory.field(bytes).ok_or_else(|| missing("StripByteCounts"))?,
            directory,
        };
        tags.check_memory(file_bytes)?;
        Ok(tags)
    }

    /// Number of channels of the resulting image: grey with alpha becomes RGBA, palettes and CMYK become RGB.
    pub fn channels(&self) -> usize {
        match (self.colour, self.alpha) {
            (Photometric::Grey { .. }, None) => 1,
            (Photometric::Grey { .. } | Photometric::Rgb, Some(_)) => 4,
            (Photometric::Rgb | Photometric::Cmyk | Photometric::Palette(_), _) => 3,
        }
    }

    /// Number of samples that make up a colour.
    pub fn colours(&self) -> usize {
        match self.colour {
            Photometric::Grey { .. } | Photometric::Palette(_) => 1,
            Photometric::Rgb => 3,
            Photometric::Cmyk => 4,
        }
    }

    /// Bytes of one row of a decompressed chunk.
    pub fn row_bytes(&self) -> usize {
        (self.chunk[0] * self.samples * self.depth.bits()).div_ceil(8)
    }

    /// Maximum number of bytes of a decompressed chunk. A chunk is at most as high as the picture.
    pub fn chunk_bytes(&self) -> usize {
        self.row_bytes() * self.chunk[1]
    }

    fn grid(&self) -> [usize; 2] {
        [self.width.div_ceil(self.chunk[0]), self.height.div_ceil(self.chunk[1])]
    }

    /// Iterates over the chunks that hold colours or alpha. In a planar file, the chunks of other samples are left out.
    pub fn chunks(&self) -> impl Iterator<Item = Chunk> + use<> {
        let ([across, down], [width, height]) = (self.grid(), self.chunk);
        let (picture_width, picture_height) = (self.width, self.height);
        let used = self.planes.min(self.colours() + usize::from(self.alpha.is_some()));
        (0..used * across * down).map(move |index| {
            let (x, y) = (index % across * width, index / across % down * height);
            Chunk {
                index,
                plane: index / (across * down),
                x,
                y,
                width: width.min(picture_width - x),
                height: height.min(picture_height - y),
            }
        })
    }

    /// Returns the stored bytes of a chunk; an error if they lie outside the file.
    pub fn stored(&self, chunk: &Chunk) -> Result<&'a [u8]> {
        let (offset, size) = (self.offsets.integer(chunk.index), self.sizes.integer(chunk.index));
        offset
            .zip(size)
            .and_then(|(offset, size)| self.directory.ifds().slice(offset, size))
            .ok_or_else(|| Error::format(format!("piece {} of the TIFF's pixels lies outside the file", chunk.index)))
    }

    /// Refuses a size that a file of `file_bytes` bytes cannot contain, before memory is allocated for it.
    fn check_memory(&self, file_bytes: usize) -> Result<()> {
        let [across, down] = self.grid();
        let chunks = across * down * self.planes;
        if self.offsets.len() < chunks || self.sizes.len() < chunks {
            return Err(Error::format(format!(
                "the TIFF lists {} pieces with {} sizes; its picture has {chunks}",
                self.offsets.len(),
                self.sizes.len()
            )));
        }
        let densest = if self.compression == Compression::None { 1 } else { MAX_COMPRESSION };
        let pixel_bits = self.samples * self.planes * self.depth.bits();
        if self.width * self.height * pixel_bits / 8 > file_bytes.saturating_mul(densest) {
            return Err(Error::format("the TIFF header promises more than so short a file can hold"));
        }
        Ok(())
    }
}

fn missing(name: &str) -> Error {
    Error::format(format!("the TIFF has no {name}"))
}

pub fn unsupported(what: impl std::fmt::Display) -> Error {
    Error::new(
        ErrorKind::Unsupported,
        format!(
            "the TIFF has {what}, which is not read: save it as 8, 16 or 32-bit RGB without compression, or with LZW"
        ),
    )
}

/// How the pixels are divided into chunks: strips, which are as wide as the picture, or tiles.
struct Chunks {
    /// Width and height in pixels of a chunk as stored.
    size: [usize; 2],
    /// The tag that lists the offsets of the chunks (`offsets`), and the tag that lists their sizes in bytes (`bytes`).
    offsets: u16,
    bytes: u16,
}

impl Chunks {
    fn new(directory: &Directory, width: usize, height: usize) -> Result<Self> {
        let is_tiled = directory.field(tag::TILE_OFFSETS).is_some();
        let (size, offsets, bytes) = if is_tiled {
            let width = required(directory, tag::TILE_WIDTH, "TileWidth")?;
            ([width, required(directory, tag::TILE_HEIGHT, "TileLength")?], tag::TILE_OFFSETS, tag::TILE_SIZES)
        } else {
            let rows = integer(directory, tag::ROWS_PER_STRIP, "RowsPerStrip")?.unwrap_or(height as u64);
            ([width as u64, rows.min(height as u64)], tag::STRIP_OFFSETS, tag::STRIP_SIZES)
        };
        if size.contains(&0) || size[0] > width.max(MAX_TILE) as u64 {
            return Err(Error::format(format!(
                "the TIFF is stored in pieces of {} x {} pixels; they must not be empty, nor wider than the picture",
                size[0], size[1]
            )));
        }
        Ok(Self { size: [size[0] as usize, size[1].min(height as u64) as usize], offsets, bytes })
    }
}

/// Returns the first value of a tag; an error if the tag is absent.
fn required(directory: &Directory, tag: u16, name: &str) -> Result<u64> {
    integer(directory, tag, name)?.ok_or_else(|| missing(name))
}

/// Returns the first value of a tag; `None` if the tag is absent, an error if its value cannot be read.
fn integer(directory: &Directory, tag: u16, name: &str) -> Result<Option<u64>> {
    let unreadable = || Error::format(format!("the TIFF's {name} is not a whole number within the file"));
    directory.field(tag).map(|f| f.integer(0).ok_or_else(unreadable)).transpose()
}

/// Refuses the raw files of cameras, which are TIFF files whose first picture is only a thumbnail.
fn check_is_picture(directory: &Directory) -> Result<()> {
    let is_thumbnail = directory.integer(tag::NEW_SUBFILE_TYPE).unwrap_or(0) & 1 != 0;
    if is_thumbnail || directory.field(tag::DNG_VERSION).is_some() {
        return Err(Error::new(
            ErrorKind::Unsupported,
            "the file holds a camera's raw data, which is not read: develop it, and save it as TIFF, PNG or JPEG",
        ));
    }
    Ok(())
}

fn depth(directory: &Directory, samples: usize) -> Result<Depth> {
    // Returns the value that all samples share; an error if they differ. The file may state it once for all samples. If
    // the tag is absent, all samples have the value `default`.
    let all = |tag, name, default| -> Result<u64> {
        let Some(field) = directory.field(tag) else { return Ok(default) };
        let first = field.integer(0).ok_or_else(|| missing(name))?;
        let is_same = (0..field.len().min(samples)).all(|i| field.integer(i) == Some(first));
        if is_same { Ok(first) } else { Err(unsupported(format_args!("samples of unequal {name}"))) }
    };
    // Sample formats: 1 = unsigned, 2 = signed, 3 = floating point, 4 = undefined.
    let (bits, format) = (all(tag::BITS, "BitsPerSample", 1)?, all(tag::SAMPLE_FORMAT, "SampleFormat", 1)?);
    match (format, bits) {
        (1 | 4, 1 | 2 | 4) if samples == 1 => Ok(Depth::Bits(bits as u8)),
        (1 | 4, 8) => Ok(Depth::U8),
        (1 | 4, 16) => Ok(Depth::U16),
        (1 | 4, 32) => Ok(Depth::U32),
        (3, 16) => Ok(Depth::F16),
        (3, 32) => Ok(Depth::F32),
        (3, 64) => Ok(Depth::F64),
        _ => Err(unsupported(format_args!("{samples} samples of {bits} bits (SampleFormat {format})"))),
    }
}

fn colour<'a>(directory: &Directory<'a>, photometric: u64, depth: Depth) -> Result<Photometric<'a>> {
    match photometric {
        0 | 1 => Ok(Photometric::Grey { is_inverted: photometric == 0 && !depth.is_float() }),
        2 => Ok(Photometric::Rgb),
        3 if matches!(depth, Depth::Bits(_) | Depth::U8) => {
            let map = directory.field(tag::COLOUR_MAP).ok_or_else(|| missing("ColorMap"))?;
            let needed = 3 << depth.bits();
            match map.len() {
                len if len >= needed => Ok(Photometric::Palette(map)),
                len => Err(Error::format(format!("the TIFF's ColorMap has {len} values; it must have {needed}"))),
            }
        }
        5 => Ok(Photometric::Cmyk),
        other => {
            let name = match other {
                6 => "YCbCr".to_string(),
                8..=10 => "CIELAB".to_string(),
                32_803 | 34_892 => "a sensor's own".to_string(),
                other => format!("unknown (PhotometricInterpretation {other})"),
            };
            Err(unsupported(format_args!("colours that are {name}")))
        }
    }
}

/// Returns the kind of alpha if the first sample after the colours is alpha. The tag ExtraSamples states whether it is.
/// Without this tag, a sample after the colours counts as unassociated alpha. Palettes and CMYK never have alpha.
fn alpha(directory: &Directory, colour: Photometric, samples: usize) -> Result<Option<Alpha>> {
    let colours = match colour {
        Photometric::Grey { .. } | Photometric::Palette(_) => 1,
        Photometric::Rgb => 3,
        Photometric::Cmyk => 4,
    };
    if samples < colours {
        return Err(Error::format(format!("the TIFF has {samples} samples per pixel; its colours need {colours}")));
    }
    if samples == colours || matches!(colour, Photometric::Cmyk | Photometric::Palette(_)) {
        return Ok(None);
    }
    Ok(match directory.field(tag::EXTRA_SAMPLES).map(|f| f.integer(0)) {
        Some(Some(1)) => Some(Alpha::Associated),
        None | Some(Some(2)) => Some(Alpha::Unassociated),
        Some(_) => None,
    })
}

fn compression(code: u64) -> Result<Compression> {
    let name = match code {
        1 => return Ok(Compression::None),
        5 => return Ok(Compression::Lzw),
        8 | 32_946 => return Ok(Compression::Deflate),
        32_773 => return Ok(Compression::PackBits),
        2..=4 => "fax",
        6 | 7 => "JPEG",
        34_925 => "LZMA",
        50_000 => "Zstandard",
        50_001 => "WebP",
        _ => "unknown",
    };
    Err(unsupported(format_args!("{name} compression ({code})")))
}

fn predictor(code: u64, depth: Depth) -> Result<Predictor> {
    match code {
        1 => Ok(Predictor::None),
        2 if !matches!(depth, Depth::Bits(_)) => Ok(Predictor::Horizontal),
        3 if depth.is_float() => Ok(Predictor::Float),
        _ => Err(unsupported(format_args!("predictor {code} with samples of {} bits", depth.bits()))),
    }
}
