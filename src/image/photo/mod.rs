//! Metadata of a photo's file: orientation, focal length, exposure, and how its colours were understood.

mod exif;
mod orientation;
#[cfg(test)]
mod tests;

use crate::image::file_colour::FileColour;
pub(super) use exif::{Exif, read};
pub use orientation::Orientation;
pub(super) use orientation::Upright;

/// Standard deviation of a focal length from a camera's notes, as a share of it. [convention]: lenses are marked to
/// about 5 %, and the one for 35 mm film is rounded to a millimetre and taken along the diagonal or the width (4 %
/// apart at 4:3).
const FOCAL_ERROR: f64 = 0.05;

/// Diagonal of film of 36 x 24 mm, to which equivalent focal lengths refer [convention: CIPA DCG-001].
const FILM_DIAGONAL: f64 = 43.266_615_305_567_87;

/// Two ways to the focal length that differ by more than this contradict each other. [convention]: twice
/// [`FOCAL_ERROR`].
const AGREEMENT: f64 = 0.1;

/// A photo whose sides are in another proportion than the camera recorded has been cropped; they are whole numbers, and
/// resizing rounds them. [convention]
const SAME_SHAPE: f64 = 0.01;

/// Saturation-based speed is 78 lx s over the focal-plane exposure that just saturates [convention: ISO 12232:2019, 6.2].
const SATURATION: f64 = 78.0;

/// Focal-plane exposure is q L t / N², with q = 0.65 for a lens of 90 % transmittance, 10° off its axis
/// [convention: ISO 12232:2019, annex A].
const LENS: f64 = 0.65;

/// How far the luminance of white may lie from the saturation-based one, as factors. Below: the speed may be a
/// standard output sensitivity (ISO 12232:2019, 6.4), 10 lx s over the exposure that becomes sRGB code 118, whose
/// linear value is 0.181, so white is 55 lx s instead of 78. Above: a recommended exposure index leaves the headroom
/// to the maker; a stop of it. [convention]
const WHITE_RANGE: [f64; 2] = [10.0 / 0.181 / SATURATION, 2.0];

/// What a photo's file says of its camera, for the photo as it was loaded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhotoMetadata {
    /// As the file had it. It has been undone: the photo stands upright.
    pub orientation: Orientation,
    /// Focal length in pixels.
    pub focal: Option<f64>,
    pub f_number: Option<f64>,
    /// In seconds.
    pub exposure_time: Option<f64>,
    pub iso: Option<f64>,
    /// How its colours were understood.
    pub colour: FileColour,
}

/// A luminance in cd/m², and the range that it lies in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Luminance {
    pub low: f64,
    pub expected: f64,
    pub high: f64,
}

impl PhotoMetadata {
    /// For a photo with such sides, upright or not.
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

    /// Focal length in pixels and its standard deviation.
    pub fn expected_focal(&self) -> Option<[f64; 2]> {
        self.focal.map(|focal| [focal, FOCAL_ERROR * focal])
    }

    /// The luminance that became the value 1: L = 78 N² / (q t S), the exposure that just saturates.
    pub fn white_luminance(&self) -> Option<Luminance> {
        let (n, t, s) = (self.f_number?, self.exposure_time?, self.iso?);
        let expected = SATURATION * n * n / (LENS * t * s);
        let [low, high] = WHITE_RANGE.map(|factor| factor * expected);
        Some(Luminance { low, expected, high })
    }
}

/// The focal length in pixels, from the one for 35 mm film or from the lens and the density of the sensor's pixels.
fn focal(exif: &Exif, width: f64, height: f64) -> Option<f64> {
    // Editors that crop leave the recorded size; those that turn a photo may exchange its sides.
    let shape = |width: f64, height: f64| width.max(height) / width.min(height);
    let is_whole = |[w, h]: [f64; 2]| (shape(w, h) / shape(width, height)).ln().abs() < SAME_SHAPE;
    if !exif.recorded.is_none_or(is_whole) {
        return None;
    }
    let diagonal = width.hypot(height);
    let by_film = exif.focal_35.map(|focal| focal * diagonal / FILM_DIAGONAL);
    let scale = exif.recorded.map_or(1.0, |[w, h]| diagonal / w.hypot(h));
    let by_sensor = exif.focal.zip(exif.density).map(|(focal, density)| focal * density * scale);
    // The sensor's has more digits, but is wrong in some cameras: it counts where the other does not contradict it.
    match (by_film, by_sensor) {
        (Some(film), Some(sensor)) if (sensor / film).ln().abs() > AGREEMENT => Some(film),
        (_, Some(sensor)) => Some(sensor),
        (film, None) => film,
    }
}
