//! Photo metadata
//!
//! What a photo's file says of its camera, in the EXIF notes of JPEG, PNG, WebP and TIFF. Loading puts a photo upright by it.
//! luxfer_rectify and luxfer_transfer expect its focal length where the caller gives none, and believe the lines where they are
//! surer. The luminance of white is offered only: it becomes luxfer_transfer_params.white_luminance if the caller says so.

use super::guard::enter;
use super::image::luxfer_image;
use super::params::{Report, Versioned};
use super::status::luxfer_status;
use crate::image::photo::PhotoMetadata;

/// What a photo's file says of its camera. Set struct_size before the call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_photo_metadata {
    /// sizeof(luxfer_photo_metadata), set by the caller.
    pub struct_size: u32,
    /// How the file stores the photo, a value of EXIF's tag Orientation in [1, 8]; 1 = upright, or not said. Loading has undone it:
    /// 2 by mirroring left to right, 3 by a half turn, 4 by both, 6 and 8 by a quarter turn clockwise and counter-clockwise, 5 and 7
    /// by these and mirroring.
    pub orientation: u32,
    /// Focal length in pixels of the loaded photo; 0 = unknown, also for photos whose sides show that they have been cropped.
    pub focal: f64,
    /// Its standard deviation; 0 where it is unknown.
    pub focal_error: f64,
    /// F-number N of the aperture; 0 = unknown.
    pub f_number: f64,
    /// Exposure time t in seconds; 0 = unknown.
    pub exposure_time: f64,
    /// ISO sensitivity S; 0 = unknown.
    pub iso: f64,
    /// Luminance in cd/m² that became the value 1, by the saturation-based speed of ISO 12232: 78 N² / (0.65 t S). 0 = unknown. It
    /// holds for the photo as the camera developed it: an editor that changes brightness does not change these notes.
    pub white_luminance: f64,
    /// Lower end of its range: the sensitivity may be a standard output sensitivity instead, which clips 0.71 times as high.
    pub white_luminance_low: f64,
    /// Upper end of its range: a recommended exposure index leaves the headroom to the maker, here one stop.
    pub white_luminance_high: f64,
}

const SIZE: usize = 8 + 8 * 8;

// SAFETY: plain numbers.
unsafe impl Versioned for luxfer_photo_metadata {
    const NAME: &'static str = "luxfer_photo_metadata";
    const SIZES: &'static [usize] = &[SIZE];
    fn defaults() -> Self {
        Self::new(&PhotoMetadata::default())
    }
}

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
        }
    }
}

/// Gets what the file of a loaded image says of the camera. Of images that were not loaded, and of files that say nothing,
/// everything is unknown. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_image_get_metadata(
    image: *mut luxfer_image,
    metadata: *mut luxfer_photo_metadata,
) -> luxfer_status {
    enter(image, |object| {
        Report::new(metadata)?.set(luxfer_photo_metadata::new(object.metadata()));
        Ok(())
    })
}
