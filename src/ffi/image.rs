//! Image
//!
//! An image holds 32-bit floating-point samples: scene-linear Rec.709 colour (D65 white), or data. It has up to 64
//! channels; width and height are at most 65536 pixels. Rows run from top to bottom. Points of an image are in pixels,
//! x to the right and y down; the centre of the top-left pixel is (0.5, 0.5). An image never changes after its
//! creation, so results are shared and not copied. A view describes pixels in the caller's memory; the library never
//! keeps a pointer to them.

use super::context::{Charge, Context, luxfer_context};
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::params::{self, versioned};
use super::pointer::{Out, bytes, bytes_mut, set_optional, text};
use super::status::luxfer_status;
use crate::error::{Error, Result};
use crate::image::photo::PhotoMetadata;
use crate::image::view::{ColourSpace, PixelLayout, SampleFormat};
use crate::image::{Image, io, view};
use std::ffi::{c_char, c_void};
use std::path::Path;
use std::sync::Arc;

/// An image in the library's memory. See luxfer_image_create.
pub struct luxfer_image {
    _opaque: [u8; 0],
}

/// Storage type of a sample, in the machine's byte order: a LUXFER_SAMPLE_ value.
pub type luxfer_sample = i32;
/// 8-bit unsigned integer that stands for [0, 1].
pub const LUXFER_SAMPLE_U8: luxfer_sample = 0;
/// 16-bit unsigned integer that stands for [0, 1].
pub const LUXFER_SAMPLE_U16: luxfer_sample = 1;
/// 16-bit floating point (IEEE 754 half).
pub const LUXFER_SAMPLE_F16: luxfer_sample = 2;
/// 32-bit floating point.
pub const LUXFER_SAMPLE_F32: luxfer_sample = 3;

/// Encoding of the values: a LUXFER_COLOUR_ value.
pub type luxfer_colour_space = i32;
/// Scene-linear Rec.709, or data that is not colour.
pub const LUXFER_COLOUR_LINEAR: luxfer_colour_space = 0;
/// Colour with the sRGB curve; alpha, the second of two or the fourth of four channels, is linear.
pub const LUXFER_COLOUR_SRGB: luxfer_colour_space = 1;

/// Flag of a view: the first row in memory is the bottom row of the image.
pub const LUXFER_VIEW_BOTTOM_UP: u32 = 1;

/// An image in the caller's memory. Fill it with luxfer_image_view_init, then set width, height, sample, byte_size and
/// data.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_image_view {
    /// sizeof(luxfer_image_view), set by luxfer_image_view_init.
    pub struct_size: u32,
    /// Samples per pixel in [1, 4]; default 3.
    pub channels: u32,
    /// Storage type of the samples: a LUXFER_SAMPLE_ value; default LUXFER_SAMPLE_F32.
    pub sample: luxfer_sample,
    /// Encoding of the samples: a LUXFER_COLOUR_ value; default LUXFER_COLOUR_LINEAR.
    pub colour_space: luxfer_colour_space,
    /// Width in pixels, in [1, 65536]; default 0: the caller must set it.
    pub width: u32,
    /// Height in pixels, in [1, 65536]; default 0: the caller must set it.
    pub height: u32,
    /// LUXFER_VIEW_ flags, or 0, the default. Unknown flags give LUXFER_INVALID_ARGUMENT.
    pub flags: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Bytes from one pixel to the next, at least the size of a pixel; 0, the default: pixels are packed.
    pub pixel_stride: usize,
    /// Bytes from one row to the next, at least the size of a row; 0, the default: rows are packed.
    pub row_stride: usize,
    /// Size of the memory at data in bytes; default 0: the caller must set it. LUXFER_INVALID_ARGUMENT if the pixels
    /// and the strides need more.
    pub byte_size: usize,
    /// The pixels, at any alignment; default NULL: the caller must set it. The library neither reads nor writes the
    /// bytes between pixels or rows.
    pub data: *mut c_void,
}

const VIEW_SIZE: usize = 32 + 4 * size_of::<usize>();

versioned!(luxfer_image_view, [VIEW_SIZE], {
    Self {
        struct_size: VIEW_SIZE as u32,
        channels: 3,
        sample: LUXFER_SAMPLE_F32,
        colour_space: LUXFER_COLOUR_LINEAR,
        width: 0,
        height: 0,
        flags: 0,
        reserved: 0,
        pixel_stride: 0,
        row_stride: 0,
        byte_size: 0,
        data: std::ptr::null_mut(),
    }
});

impl luxfer_image_view {
    fn layout(&self) -> Result<PixelLayout> {
        let sample = match self.sample {
            LUXFER_SAMPLE_U8 => SampleFormat::U8,
            LUXFER_SAMPLE_U16 => SampleFormat::U16,
            LUXFER_SAMPLE_F16 => SampleFormat::F16,
            LUXFER_SAMPLE_F32 => SampleFormat::F32,
            other => return Err(Error::argument(format!("view.sample is {other}; it must be a LUXFER_SAMPLE_ value"))),
        };
        if self.flags & !LUXFER_VIEW_BOTTOM_UP != 0 || self.reserved != 0 {
            return Err(Error::argument(format!(
                "view.flags is {:#x} and view.reserved {}; only LUXFER_VIEW_ flags may be set",
                self.flags, self.reserved
            )));
        }
        let layout = PixelLayout {
            sample,
            channels: self.channels as usize,
            colour_space: colour_space("view.colour_space", self.colour_space)?,
            width: self.width as usize,
            height: self.height as usize,
            pixel_stride: self.pixel_stride,
            row_stride: self.row_stride,
            bottom_up: self.flags & LUXFER_VIEW_BOTTOM_UP != 0,
        };
        layout.checked(self.byte_size)
    }
}

fn colour_space(name: &str, value: luxfer_colour_space) -> Result<ColourSpace> {
    match value {
        LUXFER_COLOUR_LINEAR => Ok(ColourSpace::Linear),
        LUXFER_COLOUR_SRGB => Ok(ColourSpace::Srgb),
        other => Err(Error::argument(format!("{name} is {other}; it must be a LUXFER_COLOUR_ value"))),
    }
}

/// The object behind a `luxfer_image` handle.
pub(super) struct Pixels {
    context: Arc<Context>,
    source: Source,
    metadata: PhotoMetadata,
    /// Number of point lights, spot lights and luminaires without luminous opening in the rendered scene. They light
    /// the scene but are invisible in the image. 0 if the image is not a rendering.
    unseen_lights: usize,
}

/// Owner of the pixels: this object, or the result of a stage.
enum Source {
    Own(Arc<Image>, #[expect(dead_code, reason = "held until the image goes")] Charge),
    Result(Arc<dyn Holder>),
}

/// A stage's result, which contains an image.
trait Holder: Send + Sync {
    fn image(&self) -> &Image;
}

struct Part<O, P> {
    output: Arc<O>,
    pick: P,
}

impl<O: Send + Sync, P: Fn(&O) -> &Image + Send + Sync> Holder for Part<O, P> {
    fn image(&self) -> &Image {
        (self.pick)(&self.output)
    }
}

impl Pixels {
    pub(super) fn image(&self) -> &Image {
        match &self.source {
            Source::Own(image, _) => image,
            Source::Result(holder) => holder.image(),
        }
    }

    /// Returns width and height in pixels.
    pub(super) fn size(&self) -> (usize, usize) {
        (self.image().width, self.image().height)
    }

    /// Returns a shared pointer to the image. An image inside a stage's result is copied first, because the result owns
    /// it together with other data.
    pub(super) fn shared(&self) -> Result<Arc<Image>> {
        match &self.source {
            Source::Own(image, _) => Ok(image.clone()),
            Source::Result(holder) => {
                let image = holder.image();
                let mut copy = Image::new(image.width, image.height, image.channels)?;
                copy.data.copy_from_slice(&image.data);
                Ok(Arc::new(copy))
            }
        }
    }

    /// Returns the metadata of the file that the image was loaded from; defaults for other images.
    pub(super) fn metadata(&self) -> &PhotoMetadata {
        &self.metadata
    }

    /// Creates the object of an image that the caller will own; `charge` is its share of the memory budget.
    fn own(context: &Arc<Context>, image: Image, charge: Charge, metadata: PhotoMetadata) -> Arc<Self> {
        Arc::new(Self {
            context: context.clone(),
            source: Source::Own(Arc::new(image), charge),
            metadata,
            unseen_lights: 0,
        })
    }

    /// Creates an image at the caller's request. The image is charged to the memory budget before `make` makes it.
    pub(super) fn counted(
        context: &Arc<Context>,
        width: usize,
        height: usize,
        channels: usize,
        make: impl FnOnce() -> Result<Image>,
    ) -> Result<Arc<Self>> {
        Self::photo(context, width, height, channels, || Ok((make()?, PhotoMetadata::default())))
    }

    /// Like [`counted`](Self::counted), for an image with the metadata of a photo.
    pub(super) fn photo(
        context: &Arc<Context>,
        width: usize,
        height: usize,
        channels: usize,
        make: impl FnOnce() -> Result<(Image, PhotoMetadata)>,
    ) -> Result<Arc<Self>> {
        let charge = context.charge(cost(width, height, channels))?;
        let (image, metadata) = make()?;
        Ok(Self::own(context, image, charge, metadata))
    }

    /// Creates the object of an image that is part of a stage's result; the object and the result share the pixels.
    pub(super) fn part<O: Send + Sync + 'static>(
        context: &Arc<Context>,
        output: Arc<O>,
        pick: impl Fn(&O) -> &Image + Send + Sync + 'static,
    ) -> Arc<Self> {
        Self::rendered(context, output, pick, 0)
    }

    /// Creates the object of an image that is part of a rendering. `unseen_lights` is the number of lights of the
    /// scene that are invisible in renderings.
    pub(super) fn rendered<O: Send + Sync + 'static>(
        context: &Arc<Context>,
        output: Arc<O>,
        pick: impl Fn(&O) -> &Image + Send + Sync + 'static,
        unseen_lights: usize,
    ) -> Arc<Self> {
        let holder = Part { output, pick };
        let source = Source::Result(Arc::new(holder));
        Arc::new(Self { context: context.clone(), source, metadata: PhotoMetadata::default(), unseen_lights })
    }

    /// Returns the number of point lights, spot lights and luminaires without luminous opening in the rendered scene.
    /// They light the scene but are invisible in the image.
    pub(super) fn unseen_lights(&self) -> usize {
        self.unseen_lights
    }

    /// Returns the image behind a handle that the caller may leave out; `None` for NULL.
    pub(super) fn optional(context: &Arc<Context>, image: *mut luxfer_image, name: &str) -> Result<Option<Arc<Self>>> {
        if image.is_null() { Ok(None) } else { handle::borrow_in(context, image, name).map(Some) }
    }
}

impl Owned for Pixels {
    fn context(&self) -> &Arc<Context> {
        &self.context
    }
}

impl Handle for luxfer_image {
    type Object = Pixels;
    const TAG: u64 = tag(b"lux.imag");
    const NAME: &'static str = "luxfer_image";
}

/// Memory of an image's samples, in bytes.
fn cost(width: usize, height: usize, channels: usize) -> u64 {
    (width as u64) * (height as u64) * (channels as u64) * size_of::<f32>() as u64
}

/// Creates an image from a copy of the caller's pixels. Integers are mapped to [0, 1], and sRGB is decoded to linear
/// values; NaN and infinities are kept. The caller releases *image. Any thread.
/// LUXFER_INVALID_ARGUMENT if the view is inconsistent; LUXFER_OUT_OF_MEMORY beyond the context's memory budget.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_image_create(
    context: *mut luxfer_context,
    view: *const luxfer_image_view,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(context, |object| {
        let context = object.context();
        let out = Out::new(image, "image")?;
        let view = params::read_required(view)?;
        let layout = view.layout()?;
        let pixels = bytes(view.data.cast(), view.byte_size, "view.data")?;
        let charge = context.charge(cost(layout.width, layout.height, layout.channels))?;
        out.set(handle::give(Pixels::own(context, view::read(layout, pixels)?, charge, PhotoMetadata::default())));
        Ok(())
    })
}

/// Loads an image file and turns the picture upright by its EXIF orientation; path is UTF-8. The caller releases
/// *image. Any thread.
///
/// The formats are JPEG, PNG, WebP, TIFF, BMP, GIF (its first frame), Radiance HDR and OpenEXR (its display window).
/// Grey with alpha becomes RGBA; palettes and CMYK become RGB. Colours are not premultiplied by alpha, except in
/// OpenEXR files, whose samples stay as stored.
///
/// Load pictures with LUXFER_COLOUR_SRGB. Their colours are converted to linear Rec.709 from the colour space that the
/// file states (ICC profile; cICP, sRGB, gAMA and cHRM of PNG; EXIF; chromaticities of OpenEXR; PRIMARIES, EXPOSURE and
/// COLORCORR of Radiance). If the file states no colour space, integer samples are taken as sRGB and floating-point
/// samples as linear. luxfer_photo_metadata.colour tells which of these cases applied.
///
/// Load data such as masks and depth with LUXFER_COLOUR_LINEAR. Their samples are not converted.
/// LUXFER_IO if the file cannot be read; LUXFER_FORMAT if it is damaged or of no known format; LUXFER_OUT_OF_MEMORY
/// beyond the memory budget.
/// LUXFER_UNSUPPORTED if the picture is larger than 2^28 pixels or 65536 on a side, or if the library recognises the
/// format but does not read it. The message then names the format, such as AVIF, HEIC, JPEG XL, raw data of cameras,
/// TIFF with JPEG compression, deep or luminance-chroma OpenEXR, or an OpenEXR layer with neither R, G, B nor a single
/// channel.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_image_load(
    context: *mut luxfer_context,
    path: *const c_char,
    colour_space: luxfer_colour_space,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(context, |object| {
        let out = Out::new(image, "image")?;
        let path = text(path, "path")?;
        let encoding = encoding(colour_space)?;
        let bytes = io::read_file(Path::new(path))?;
        let decoded = decode(object.context(), &bytes, encoding).map_err(|e| e.context(path))?;
        out.set(handle::give(decoded));
        Ok(())
    })
}

/// Loads an image from a file in memory of size bytes at data. Formats, colours, ownership, threads and errors are as
/// for luxfer_image_load.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_image_load_memory(
    context: *mut luxfer_context,
    data: *const c_void,
    size: usize,
    colour_space: luxfer_colour_space,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(context, |object| {
        let out = Out::new(image, "image")?;
        let bytes = bytes(data.cast(), size, "data")?;
        out.set(handle::give(decode(object.context(), bytes, encoding(colour_space)?)?));
        Ok(())
    })
}

fn encoding(value: luxfer_colour_space) -> Result<io::Encoding> {
    Ok(match colour_space("colour_space", value)? {
        ColourSpace::Srgb => io::Encoding::Srgb,
        ColourSpace::Linear => io::Encoding::Linear,
    })
}

/// Decodes a file, after a check that the picture and the decoder's working memory fit into the memory budget.
fn decode(context: &Arc<Context>, bytes: &[u8], encoding: io::Encoding) -> Result<Arc<Pixels>> {
    let monitor = context.monitor();
    let _working = context.charge(io::working_bytes(bytes)?)?;
    let (width, height, channels) = io::probe(bytes)?;
    let charge = context.charge(cost(width, height, channels))?;
    monitor.job().check()?;
    let photo = io::decode_photo(bytes, encoding)?;
    monitor.job().check()?;
    Ok(Pixels::own(context, photo.image, charge, photo.metadata))
}

/// Saves an image to a file; path is UTF-8, and its extension chooses the format. Any thread.
/// - .png: 1, 3 or 4 channels. The colours are multiplied by exposure (> 0, finite; 1 shows the value 1 as white),
///   clamped to [0, 1] and encoded as 8-bit sRGB, which the file states. The fourth channel is alpha; it is only
///   clamped.
/// - .exr: up to 64 channels, unchanged, in 32-bit floating point, with the chromaticities of Rec.709. exposure is not
///   used.
///
/// All functions of this library write files as follows. An existing file is replaced only once the new one is
/// complete, and keeps its mode and owner. Symbolic links are followed. Devices, FIFOs, files with several hard links,
/// and files in folders that accept no new files are written in place.
/// LUXFER_INVALID_ARGUMENT if the file has another extension, the number of channels is not allowed, or exposure is out
/// of range for a .png; LUXFER_IO if the file cannot be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_image_save(
    image: *mut luxfer_image,
    path: *const c_char,
    exposure: f32,
) -> luxfer_status {
    enter(image, |object| {
        let path = Path::new(text(path, "path")?);
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
        let target = io::Target::new(path)?;
        let encoded = match extension.as_str() {
            "png" if exposure > 0.0 && exposure.is_finite() => io::encode_png(object.image(), exposure)?,
            "png" => return Err(Error::argument(format!("exposure is {exposure}; it must be positive and finite"))),
            "exr" => encode_exr(object.image())?,
            _ => return Err(Error::argument(format!("{} ends neither in .png nor in .exr", path.display()))),
        };
        target.write(&encoded)
    })
}

/// Encodes an image as OpenEXR. Images of 1, 3 or 4 channels get the names that other programs expect for colours; in
/// other images the channels are numbered.
fn encode_exr(image: &Image) -> Result<Vec<u8>> {
    let numbered: Vec<String> = (0..image.channels).map(|c| format!("C{c:02}")).collect();
    let names: Vec<&str> = match image.channels {
        1 => vec!["Y"],
        3 => vec!["R", "G", "B"],
        4 => vec!["R", "G", "B", "A"],
        _ => numbered.iter().map(String::as_str).collect(),
    };
    io::encode_exr(&[io::Layer { name: "", image, channels: &names }], &[])
}

/// Gets the width and height of an image in pixels and its number of channels; any of the three pointers may be NULL.
/// Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_image_get_size(
    image: *mut luxfer_image,
    width: *mut u32,
    height: *mut u32,
    channels: *mut u32,
) -> luxfer_status {
    enter(image, |object| {
        let image = object.image();
        set_optional(width, image.width as u32);
        set_optional(height, image.height as u32);
        set_optional(channels, image.channels as u32);
        Ok(())
    })
}

/// Copies an image into the caller's pixels. The view must have the image's width and height. It receives
/// view->channels channels of the image, starting at first_channel, counted from 0; with LUXFER_COLOUR_SRGB, the
/// library encodes them with the sRGB curve. For integer samples, values are clamped to [0, 1] and rounded, and NaN
/// becomes 0. Any thread.
/// LUXFER_INVALID_ARGUMENT if the view is inconsistent or does not fit the image.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_image_read(
    image: *mut luxfer_image,
    first_channel: u32,
    view: *const luxfer_image_view,
) -> luxfer_status {
    enter(image, |object| {
        let image = object.image();
        let view = params::read_required(view)?;
        let layout = view.layout()?;
        let (first, count) = (first_channel as usize, layout.channels);
        if first + count > image.channels {
            return Err(Error::argument(format!(
                "first_channel is {first} and the view has {count} channels; the image has only {}",
                image.channels
            )));
        }
        let pixels = bytes_mut(view.data.cast(), view.byte_size, "view.data")?;
        if count == image.channels {
            return view::write(image, layout, pixels);
        }
        let mut part = Image::new(image.width, image.height, count)?;
        for (to, from) in part.data.chunks_exact_mut(count).zip(image.data.chunks_exact(image.channels)) {
            to.copy_from_slice(&from[first..first + count]);
        }
        view::write(&part, layout, pixels)
    })
}
