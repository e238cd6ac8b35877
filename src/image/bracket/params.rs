//! The settings of a merge, and its report.

use crate::error::{Error, Result, check_range};

/// Largest number of photos in a bracket.
pub const MAX_PHOTOS: usize = 16;

/// Where the exposures of the photos come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// From metadata and pixels together; an error if they contradict each other.
    Both,
    Metadata,
    Pixels,
}

/// The tone curve with which the photos were taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToneCurve {
    /// The curve of sRGB, unless the photos show another one significantly better and their exposures are known.
    Recovered,
    /// The curve of sRGB: the photos are linear.
    Srgb,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    pub source: Source,
    /// Exposure of each photo, in any unit, in `[1e-9, 1e9]`. If the list is empty, the library finds the exposures.
    pub exposures: Vec<f64>,
    /// Index of the reference photo, which gives the result its scale and its pixel grid. `None`: the photo with the
    /// most well-exposed pixels.
    pub reference: Option<usize>,
    /// Whether to average all exposures also at pixels where they disagree.
    pub keep_moving: bool,
    /// Largest shift between neighbouring exposures, as a share of the photo's longer side, in `[0, 0.25]`. 0 turns the
    /// alignment off.
    pub max_shift: f64,
    /// Smallest value at which a channel counts as clipped, in `[0.1, 1]`.
    pub saturation: f64,
    pub tone_curve: ToneCurve,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            source: Source::Both,
            exposures: Vec::new(),
            reference: None,
            keep_moving: false,
            max_shift: 0.03,
            saturation: 0.95,
            tone_curve: ToneCurve::Recovered,
        }
    }
}

impl Params {
    /// Checks the settings for a bracket of `count` photos.
    pub(super) fn check(&self, count: usize) -> Result<()> {
        if !(1..=MAX_PHOTOS).contains(&count) {
            return Err(Error::argument(format!("count is {count}; a bracket has 1 to {MAX_PHOTOS} photos")));
        }
        if !self.exposures.is_empty() && self.exposures.len() != count {
            let given = self.exposures.len();
            return Err(Error::argument(format!(
                "exposures states {given} values for {count} photos; it must state one for each photo, or none"
            )));
        }
        for (i, &exposure) in self.exposures.iter().enumerate() {
            if !(1e-9..=1e9).contains(&exposure) {
                return Err(Error::argument(format!("exposures[{i}] is {exposure}; it must lie in [1e-9, 1e9]")));
            }
        }
        if let Some(reference) = self.reference.filter(|&r| r >= count) {
            return Err(Error::argument(format!(
                "reference is {reference}; it must be -1 or the index of one of the {count} photos"
            )));
        }
        check_range("max_shift", self.max_shift, 0.0, 0.25)?;
        check_range("saturation", self.saturation, 0.1, 1.0)?;
        Ok(())
    }
}

/// The report about a merge.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Index of the reference photo.
    pub reference: usize,
    /// A report about each photo, in the order of the input.
    pub photos: Vec<PhotoReport>,
    /// Share of the pixels that are clipped in every exposure that shows them, in `[0, 1]`.
    pub clipped: f64,
    /// Share of the pixels at which the exposures disagree, in `[0, 1]`; 0 with `keep_moving`.
    pub moved: f64,
    /// The tone curve that was recovered and undone; `None` if the photos were taken as linear.
    pub curve: Option<CurveReport>,
    /// Whether the photos contradict the tone curve of sRGB, and no other curve was recovered.
    pub contradicts_srgb: bool,
}

/// Number of values of [`CurveReport::light`].
pub const CURVE_VALUES: usize = 17;

/// A recovered tone curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveReport {
    /// Light of the sRGB codes 0, 1/16, … 1, relative to white.
    pub light: [f64; CURVE_VALUES],
    /// Largest standard error of the light relative to white, as a share of the light, over the codes that the photos
    /// show.
    pub error: f64,
}

/// The report about one photo of a merge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhotoReport {
    /// Exposure relative to the reference.
    pub exposure: f64,
    /// Standard error of the natural logarithm of the exposure: about its relative standard error.
    pub error: f64,
    /// Exposure relative to the reference according to the metadata; 0 if the metadata do not state it.
    pub stated: f64,
    /// Column and row of the pixel of this photo that shows the same point as pixel (0, 0) of the reference photo.
    pub shift: [isize; 2],
}
