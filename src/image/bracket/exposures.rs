//! The relative exposures of a bracket, from the caller, the metadata and the pixels.

use super::frame::{Frame, light};
use super::params::{Params, Source};
use super::ratio::Ratio;
use crate::error::{Error, Result};
use crate::exec;
use crate::image::photo::PhotoMetadata;
use crate::job::Job;
use crate::maths;

/// Standard deviation of the logarithm of a ratio that metadata state: shutter times, f-numbers and speeds are rounded
/// to the names of the series, such as 1/15 s for 1/16 s and f/5.6 for f/5.66. [convention: ISO 516, ISO 12232]
const ROUNDING: f64 = 0.05;

/// Smallest standard error of a measured ratio, so that photos without noise have a finite weight. [rounding]
const MIN_ERROR: f64 = 1e-6;

/// Metadata and pixels contradict each other if the logarithms of their ratios differ by more than both limits.
/// `MAX_CONTRADICTION` is a third of a stop, the finest step of most cameras. `SIGNIFICANT` is in standard errors of
/// the measured logarithm. [convention]
const MAX_CONTRADICTION: f64 = std::f64::consts::LN_2 / 3.0;
const SIGNIFICANT: f64 = 3.0;

/// Returns the ratio of the exposures `b` / `a` that metadata state. An exposure is t S / N², with the exposure time t,
/// the ISO speed S and the f-number N. If S or N is missing in both photos, it counts as equal (adapted lenses record
/// no N). `None` if a time is missing, or if only one photo lacks S or N.
pub fn stated_ratio(a: &PhotoMetadata, b: &PhotoMetadata) -> Option<f64> {
    let ratio = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (Some(a), Some(b)) => Some(b / a),
        (None, None) => Some(1.0),
        _ => None,
    };
    let time = b.exposure_time? / a.exposure_time?;
    Some(time * ratio(a.iso, b.iso)? / maths::powi(ratio(a.f_number, b.f_number)?, 2))
}

/// Returns the indices of the photos in the order of their exposures, the shortest first: by the caller's exposures, by
/// the metadata, or else by brightness.
pub fn order(frames: &[Frame], metadata: &[PhotoMetadata], params: &Params, job: Job) -> Result<Vec<usize>> {
    let stated = || -> Option<Vec<f64>> { metadata.iter().map(|m| stated_ratio(&metadata[0], m)).collect() };
    let keys = if !params.exposures.is_empty() {
        params.exposures.clone()
    } else {
        let stated = if params.source == Source::Pixels { None } else { stated() };
        match stated {
            Some(stated) => stated,
            None => exec::map(frames.len(), job, |k| brightness(&frames[k]))?,
        }
    };
    let mut order: Vec<usize> = (0..frames.len()).collect();
    order.sort_by(|&a, &b| keys[a].total_cmp(&keys[b]));
    Ok(order)
}

/// Returns a measure of a photo's brightness: the sum of the light of its pixels, each clipped at 1, divided by the
/// number of samples. It compares photos with equal numbers of channels.
fn brightness(frame: &Frame) -> f64 {
    let pixels = frame.image.data.chunks_exact(frame.image.channels);
    pixels.map(|pixel| f64::from(light(pixel).min(1.0))).sum::<f64>() / (frame.image.data.len() as f64)
}

/// Two photos that are neighbours in the order of exposure. `short` and `long` are their indices. `stated` is the ratio
/// long / short of their exposures that the metadata state.
pub struct ExposurePair {
    pub short: usize,
    pub long: usize,
    pub stated: Option<f64>,
}

impl ExposurePair {
    /// Returns the ratio long / short that the caller or the metadata state; `None` if it is unknown, or to be taken
    /// from the pixels.
    pub fn known(&self, params: &Params) -> Option<Ratio> {
        if !params.exposures.is_empty() {
            return Some(self.given(params));
        }
        let stated = self.stated.filter(|_| params.source != Source::Pixels)?;
        Some(Ratio { log: maths::ln(stated), error: ROUNDING })
    }

    /// Returns the ratio of the exposures that the caller gives.
    fn given(&self, params: &Params) -> Ratio {
        let log = maths::ln(params.exposures[self.long] / params.exposures[self.short]);
        Ratio { log, error: 0.0 }
    }

    /// Returns the ratio long / short of the exposures. The caller's exposures have precedence; otherwise
    /// `params.source` says whether metadata, pixels or both determine the ratio. Returns an error if they do not state
    /// or show it.
    pub fn ratio(&self, measured: Option<Ratio>, params: &Params) -> Result<Ratio> {
        if !params.exposures.is_empty() {
            return Ok(self.given(params));
        }
        let stated = self.stated.map(|ratio| Ratio { log: maths::ln(ratio), error: ROUNDING });
        match (params.source, stated, measured) {
            (Source::Metadata, Some(ratio), _) | (Source::Both, Some(ratio), None) => Ok(ratio),
            (Source::Pixels, _, Some(ratio)) | (Source::Both, None, Some(ratio)) => Ok(ratio),
            (Source::Both, Some(stated), Some(measured)) => self.combined(stated, measured),
            (Source::Metadata, None, _) => Err(Error::argument(format!(
                "source is LUXFER_EXPOSURE_SOURCE_METADATA, but the files of photos[{}] and photos[{}] do not state \
                 their exposure times; set params.exposures, or take LUXFER_EXPOSURE_SOURCE_PIXELS",
                self.short, self.long
            ))),
            (Source::Pixels, _, None) | (Source::Both, None, None) => Err(Error::degenerate(format!(
                "the exposures of photos[{}] and photos[{}] are unknown, and too few of their pixels are well exposed in \
                 both to measure them; set params.exposures, or add a photo with an exposure in between",
                self.short, self.long
            ))),
        }
    }

    /// Returns the mean of a stated and a measured ratio (of their logarithms), weighted by their reciprocal variances.
    /// Returns an error if the two ratios contradict each other ([`MAX_CONTRADICTION`]).
    fn combined(&self, stated: Ratio, measured: Ratio) -> Result<Ratio> {
        let off = (measured.log - stated.log).abs();
        if off > MAX_CONTRADICTION && off > SIGNIFICANT * measured.error {
            return Err(Error::argument(format!(
                "the files of photos[{}] and photos[{}] state that the exposures have the ratio {:.4}, but the pixels \
                 show {:.4} (standard error {:.2} %): a program changed the brightness, the light changed, or the photos \
                 are not linear after sRGB decoding. Set params.source to LUXFER_EXPOSURE_SOURCE_PIXELS or \
                 LUXFER_EXPOSURE_SOURCE_METADATA, or set params.exposures",
                self.short,
                self.long,
                maths::exp(stated.log),
                maths::exp(measured.log),
                100.0 * measured.error
            )));
        }
        let weights = [stated, measured].map(|r| maths::powi(r.error.max(MIN_ERROR), -2));
        let total = weights[0] + weights[1];
        let log = (weights[0] * stated.log + weights[1] * measured.log) / total;
        Ok(Ratio { log, error: maths::powf(total, -0.5) })
    }
}

/// Multiplies the ratios of neighbours to obtain the exposure of each photo relative to the photo `reference`. `order`
/// lists the photos by exposure; `ratios[k]` is the ratio of the exposures `order[k + 1]` / `order[k]`. The result is
/// indexed like the photos.
pub fn chain(order: &[usize], ratios: &[Ratio], reference: usize) -> Vec<Ratio> {
    let mut out = vec![Ratio { log: 0.0, error: 0.0 }; order.len()];
    let start = order.iter().position(|&photo| photo == reference).unwrap_or(0);
    for k in start..ratios.len() {
        let before = out[order[k]];
        out[order[k + 1]] =
            Ratio { log: before.log + ratios[k].log, error: maths::hypot(before.error, ratios[k].error) };
    }
    for k in (0..start).rev() {
        let after = out[order[k + 1]];
        out[order[k]] = Ratio { log: after.log - ratios[k].log, error: maths::hypot(after.error, ratios[k].error) };
    }
    out
}
