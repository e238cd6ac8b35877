//! Metadata of a photo's file: orientation, focal length, exposure, and how its colours were interpreted.

mod exif;
#[cfg(test)]
mod tests;

pub use crate::image::orientation::Orientation;

use crate::image::file_colour::FileColour;
use crate::maths;
pub(super) use exif::{Exif, read};

/// Relative standard deviation of a focal length from EXIF. The focal length marked on a lens is accurate to about 5 %.
/// Besides, the 35 mm equivalent is rounded to a millimetre. Some cameras compute this equivalent for a film picture of
/// equal diagonal, others for one of equal width; the two results differ by 4 % at 4:3. [convention]
const FOCAL_ERROR: f64 = 0.05;

/// Diagonal in millimetres of film of 36 x 24 mm, to which equivalent focal lengths refer. [convention: CIPA DCG-001]
const FILM_DIAGONAL: f64 = 43.266_615_305_567_87;

/// Largest difference between the logarithms of two focal lengths that count as equal: twice [`FOCAL_ERROR`].
/// [convention]
const AGREEMENT: f64 = 0.1;

/// A photo counts as not cropped if the logarithms of its aspect ratio and of the recorded aspect ratio differ by less
/// than this value. It allows for the rounding of the sides when a photo is resized. [convention]
const SAME_SHAPE: f64 = 0.01;

/// An ISO speed based on saturation is this number in lx s, divided by the focal-plane exposure that just saturates
/// the sensor. [convention: ISO 12232:2019, 6.2]
const SATURATION: f64 = 78.0;

/// The factor q of the lens. A surface of luminance L gives the focal-plane exposure q L t / N², with the exposure
/// time t and the f-number N. The value holds for a lens of 90 % transmittance, 10° off its axis.
/// [convention: ISO 12232:2019, annex A]
const LENS: f64 = 0.65;

/// Range of the luminance of white, relative to its value if the ISO speed is saturation-based.
///
/// Lower limit: the speed may be a standard output sensitivity (ISO 12232:2019, 6.4), which is 10 lx s divided by the
/// exposure that becomes the sRGB code 118. The linear value of this code is 0.181, so white corresponds to 10 / 0.181
/// = 55 lx s instead of 78.
///
/// Upper limit: a recommended exposure index is any value that the manufacturer chooses. White is assumed to be at most
/// one stop (a factor of 2) brighter than with a saturation-based speed. [convention]
const WHITE_RANGE: [f64; 2] = [10.0 / 0.181 / SATURATION, 2.0];

/// The metadata of a photo, referred to the pixels of the photo as it was loaded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhotoMetadata {
    /// The orientation that the file states. The loaded photo has been turned upright.
    pub orientation: Orientation,
    /// Focal length in pixels of the loaded photo.
    pub focal: Option<f64>,
    pub f_number: Option<f64>,
    /// Exposure time in seconds.
    pub exposure_time: Option<f64>,
    pub iso: Option<f64>,
    /// How the colours of the file were interpreted.
    pub colour: FileColour,
}

/// A luminance in cd/m², with the range in which it may lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Luminance {
    pub low: f64,
    pub expected: f64,
    pub high: f64,
}

impl PhotoMetadata {
    /// Converts the metadata of a file to the metadata of its photo. `width` and `height` may be the size of the photo
    /// before or after it is turned upright: exchanging them does not change the focal length.
    pub(super) fn new(exif: &Exif, width: usize, height: usize, colour: FileColour) -> Self {
        Self {
            orientation: exif.orientation,
            focal: focal(exif, width as f64, height as f64),
            f_number: exif.f_number,
            exposure_time: exif.exposure_time,
            iso: exif.iso,
            colour,
        }
    }

    /// Returns the focal length in pixels and its standard deviation.
    pub fn expected_focal(&self) -> Option<[f64; 2]> {
        self.focal.map(|focal| [focal, FOCAL_ERROR * focal])
    }

    /// Returns the luminance that the photo shows as the pixel value 1: L = 78 N² / (q t S). At the ISO speed S, the
    /// f-number N and the exposure time t, this luminance just saturates the sensor. The constant `LENS` is q. `None`
    /// if N, t or S is unknown.
    pub fn white_luminance(&self) -> Option<Luminance> {
        let (n, t, s) = (self.f_number?, self.exposure_time?, self.iso?);
        let expected = SATURATION * n * n / (LENS * t * s);
        let [low, high] = WHITE_RANGE.map(|factor| factor * expected);
        Some(Luminance { low, expected, high })
    }
}

/// Returns the focal length in pixels, from the 35 mm equivalent, or from the focal length of the lens and the pixel
/// density of the sensor. `None` without these data, or if the photo was cropped to another aspect ratio than the
/// recorded one.
fn focal(exif: &Exif, width: f64, height: f64) -> Option<f64> {
    // Detect cropping: editors that crop a photo keep the recorded size. Editors that rotate it may exchange the
    // recorded sides.
    let shape = |width: f64, height: f64| width.max(height) / width.min(height);
    let is_whole = |[w, h]: [f64; 2]| maths::ln(shape(w, h) / shape(width, height)).abs() < SAME_SHAPE;
    if !exif.recorded.is_none_or(is_whole) {
        return None;
    }
    let diagonal = maths::hypot(width, height);
    let by_film = exif.focal_35.map(|focal| focal * diagonal / FILM_DIAGONAL);
    let scale = exif.recorded.map_or(1.0, |[w, h]| diagonal / maths::hypot(w, h));
    let by_sensor =
        exif.focal.zip(exif.pixels_per_millimetre).map(|(focal, per_millimetre)| focal * per_millimetre * scale);
    // The estimate from the sensor is more precise, but wrong in some cameras. Use it unless the 35 mm equivalent
    // contradicts it.
    match (by_film, by_sensor) {
        (Some(film), Some(sensor)) if maths::ln(sensor / film).abs() > AGREEMENT => Some(film),
        (_, Some(sensor)) => Some(sensor),
        (film, None) => film,
    }
}
