//! Photo metadata
//!
//! The camera settings that the file of a loaded photo records in its EXIF tags (JPEG, PNG, WebP, TIFF), and how its
//! colours were interpreted. luxfer_image_load applies the orientation. luxfer_rectify and luxfer_transfer use the
//! focal length as a prior, unless the caller sets a focal length; the lines of the photo outweigh the prior where
//! they determine the focal length better. The library does not use white_luminance by itself: to apply it, copy it to
//! luxfer_transfer_params.white_luminance.

use super::guard::enter;
use super::image::luxfer_image;
use super::params::{Report, versioned};
use super::status::luxfer_status;
use crate::image::photo::PhotoMetadata;

/// How the colours of an image were interpreted: a LUXFER_FILE_COLOUR_ value. Values are never changed or reused; new
/// values may be added.
pub type luxfer_file_colour = i32;
/// The image was not loaded from a file.
pub const LUXFER_FILE_COLOUR_NONE: luxfer_file_colour = 0;
/// The file states no colour space. Integers were decoded as sRGB, and floating-point samples taken as linear Rec.709.
pub const LUXFER_FILE_COLOUR_ASSUMED: luxfer_file_colour = 1;
/// The file states sRGB (integers) or linear Rec.709 (floating point).
pub const LUXFER_FILE_COLOUR_STATED: luxfer_file_colour = 2;
/// The file states another colour space. The colours were converted to linear Rec.709.
pub const LUXFER_FILE_COLOUR_CONVERTED: luxfer_file_colour = 3;
/// The library cannot convert the colours of the file, for example because its profile is damaged, or because it is in
/// CMYK without a profile. The colours were read as if the file stated no colour space, so saturated colours may be
/// wrong. Warn the user, and ask for an export of the photo as sRGB.
pub const LUXFER_FILE_COLOUR_UNCONVERTED: luxfer_file_colour = 4;
/// The image was loaded with LUXFER_COLOUR_LINEAR. Its samples are unchanged.
pub const LUXFER_FILE_COLOUR_DATA: luxfer_file_colour = 5;

/// Metadata of the file of a loaded photo.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_photo_metadata {
    /// sizeof(luxfer_photo_metadata), set by the function that fills the struct.
    pub struct_size: u32,
    /// EXIF orientation of the stored photo, in [1, 8]; 1 = upright or not recorded. Loading has already applied it: 2
    /// mirrors left to right, 3 rotates by 180 degrees, 4 mirrors top to bottom, 6 rotates clockwise by 90 degrees, 8
    /// counter-clockwise, 5 mirrors about the diagonal from top left to bottom right, 7 about the other diagonal.
    pub orientation: u32,
    /// Focal length in pixels of the loaded photo; 0 if it is unknown, or if the aspect ratio shows that the photo was
    /// cropped.
    pub focal: f64,
    /// Standard deviation of the field focal, in pixels; 0 = unknown.
    pub focal_error: f64,
    /// F-number N of the aperture; 0 = unknown.
    pub f_number: f64,
    /// Exposure time t in seconds; 0 = unknown.
    pub exposure_time: f64,
    /// ISO speed S; 0 = unknown.
    pub iso: f64,
    /// Scene luminance in cd/m² that the camera recorded as white (value 1): 78 N² / (0.65 t S), from the definition of
    /// the saturation-based speed in ISO 12232. N, t and S are the three fields above. 0 = unknown. Valid only for the
    /// image that the camera wrote: an editor that changes the brightness keeps the tags, so the value is then wrong.
    pub white_luminance: f64,
    /// Lower bound of white_luminance: 0.71 times white_luminance. This is the value for a camera whose ISO speed is a
    /// standard output sensitivity (ISO 12232) instead of a saturation-based speed.
    pub white_luminance_low: f64,
    /// Upper bound of white_luminance: twice white_luminance. It allows for an ISO speed that is a recommended exposure
    /// index (ISO 12232), with which the manufacturer chooses the luminance at which the camera clips.
    pub white_luminance_high: f64,
    /// How the colours of the file were interpreted: a LUXFER_FILE_COLOUR_ value.
    pub colour: luxfer_file_colour,
    /// Reserved; always 0.
    pub reserved: u32,
}

const SIZE: usize = 8 + 8 * 8 + 8;

versioned!(luxfer_photo_metadata, [SIZE], { Self::new(&PhotoMetadata::default()) });

impl luxfer_photo_metadata {
    fn new(known: &PhotoMetadata) -> Self {
        let white = known.white_luminance();
        let [focal, focal_error] = known.expected_focal().unwrap_or_default();
        Self {
            struct_size: SIZE as u32,
            orientation: known.orientation.code().into(),
            focal,
            focal_error,
            f_number: known.f_number.unwrap_or(0.0),
            exposure_time: known.exposure_time.unwrap_or(0.0),
            iso: known.iso.unwrap_or(0.0),
            white_luminance: white.map_or(0.0, |w| w.expected),
            white_luminance_low: white.map_or(0.0, |w| w.low),
            white_luminance_high: white.map_or(0.0, |w| w.high),
            colour: known.colour as luxfer_file_colour,
            reserved: 0,
        }
    }
}

/// Gets the metadata of the file that an image was loaded from. All values are unknown if the image was not loaded
/// from a file, or if the file has no metadata. size is sizeof *metadata. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_image_get_metadata(
    image: *mut luxfer_image,
    metadata: *mut luxfer_photo_metadata,
    size: usize,
) -> luxfer_status {
    enter(image, |object| {
        Report::new(metadata, size)?.set(luxfer_photo_metadata::new(object.metadata()));
        Ok(())
    })
}
