//! Merges several exposures of one view, a bracket, into one linear image of high dynamic range.
//!
//! Photos of lit rooms clip at the lamps, whose colours and luminances are then lost. Shorter exposures show the lamps
//! unclipped. The steps: `exposures` orders the photos; `align` shifts them onto each other; `ratio` measures the
//! ratios of their exposures, which `exposures` compares with the metadata; `comparagram` and `curve` recover the tone
//! curve of the camera if the exposures are known and the curve is not that of sRGB; `noise` measures by how much
//! neighbouring exposures differ; `motion` finds the pixels at which they disagree beyond this noise; `combine`
//! averages the exposures that agree. The result has the pixel grid and the scale of one photo, the reference. Pixels
//! that the reference shows well keep their values, once the tone curve is undone; pixels that it clips get the larger
//! values that shorter exposures show.
//!
//! Not modelled: tone curves other than that of sRGB if the exposures are unknown, and curves that differ between
//! channels or photos; rotations and parallax between the photos; and lens flare, which differs between exposures only
//! if the light does.

mod align;
mod combine;
mod comparagram;
mod curve;
mod exposures;
mod frame;
mod motion;
mod noise;
mod params;
mod ratio;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_curve;

pub use params::{CURVE_VALUES, CurveReport, MAX_PHOTOS, Params, PhotoReport, Report, Source, ToneCurve};

use crate::error::{Error, Result};
use crate::exec;
use crate::image::Image;
use crate::image::photo::PhotoMetadata;
use crate::job::Job;
use crate::maths;
use combine::{Exposed, Stack};
use curve::{PairEvidence, RecoveredCurve};
use exposures::ExposurePair;
use frame::Frame;
use noise::Noise;
use ratio::Ratio;

/// A pixel is well exposed if its light is at least the first value (about 40 of 255 codes), and its largest channel is
/// at most the second value. [convention]
const WELL_EXPOSED: [f32; 2] = [0.02, 0.8];

/// Natural logarithm of the largest ratio of two exposures, 1e18. The values of a photo, divided by this ratio, still
/// fit into `f32`. [rounding]
const MAX_LOG_RATIO: f64 = 18.0 * std::f64::consts::LN_10 + 1e-9;

/// Merges photos of one view. `metadata[k]` belongs to `photos[k]`. Returns the merged image and a report.
pub fn merge(photos: &[&Image], metadata: &[PhotoMetadata], params: &Params, job: Job) -> Result<(Image, Report)> {
    check(photos, params, job)?;
    let [first, ..] = photos else { return Err(Error::argument("count is 0")) };
    if photos.len() == 1 {
        return Ok((first.try_clone()?, of_one(first, &metadata[0], params)));
    }
    let mut frames = exec::map(photos.len(), job.part(0.0, 0.0), |k| Frame::new(photos[k], params.saturation))?;
    let reference = params.reference.map_or_else(|| best_exposed(&frames, job), Ok)?;
    let order = exposures::order(&frames, metadata, params, job.part(0.0, 0.0))?;
    let max_shift = (params.max_shift * first.width.max(first.height) as f64).round() as usize;
    let shifts = align::shifts(&frames, &order, max_shift, job.part(0.0, 0.3))?;
    for (frame, shift) in frames.iter_mut().zip(&shifts) {
        frame.shift = [0, 1].map(|axis| shift[axis] - shifts[reference][axis]);
    }
    let (curve, contradicts_srgb) = tone_curve(&frames, metadata, &order, params, job.part(0.3, 0.35))?;
    let linear = match &curve {
        Some(curve) => linearised(&frames, curve, job.part(0.35, 0.4))?,
        None => Vec::new(),
    };
    for (frame, image) in frames.iter_mut().zip(&linear) {
        let clip = curve.as_ref().map_or(frame.clip, |curve| curve.light(frame.clip));
        *frame = Frame { image, clip, ..*frame };
    }
    let (ratios, disagreements) = compare(&frames, metadata, &order, params, job.part(0.4, 0.8))?;
    let relative = exposures::chain(&order, &ratios, reference);
    if let Some(k) = relative.iter().position(|ratio| !(ratio.log.abs() <= MAX_LOG_RATIO)) {
        return Err(Error::argument(format!(
            "the exposure of photos[{k}] is {:.2e} times that of the reference; it must lie in [1e-18, 1e18]",
            maths::exp(relative[k].log)
        )));
    }
    let exposed = |&k: &usize| Exposed { frame: frames[k], exposure: maths::exp(relative[k].log) as f32 };
    let stack = Stack {
        photos: order.iter().map(exposed).collect(),
        disagreements,
        reference: order.iter().position(|&k| k == reference).unwrap_or(0),
    };
    let merged = combine::combine(&stack, job.part(0.8, 1.0))?;
    let pixels = (first.width * first.height) as f64;
    let photo = |k: usize| PhotoReport {
        exposure: maths::exp(relative[k].log),
        error: relative[k].error,
        stated: exposures::stated_ratio(&metadata[reference], &metadata[k]).unwrap_or(0.0),
        shift: frames[k].shift,
    };
    let photos = (0..photos.len()).map(photo).collect();
    let (clipped, moved) = (merged.clipped as f64 / pixels, merged.moved as f64 / pixels);
    let curve = curve.as_ref().map(RecoveredCurve::report);
    Ok((merged.image, Report { reference, photos, clipped, moved, curve, contradicts_srgb }))
}

/// Recovers the tone curve of the photos, which are aligned. `None` if the settings say that it is that of sRGB, if no
/// two neighbours have known exposures, if a photo has a high dynamic range, or if the photos do not show another
/// curve. Without a curve, also returns whether the photos contradict that of sRGB.
fn tone_curve(
    frames: &[Frame],
    metadata: &[PhotoMetadata],
    order: &[usize],
    params: &Params,
    job: Job,
) -> Result<(Option<RecoveredCurve>, bool)> {
    if frames.iter().any(|frame| frame.clip.is_infinite()) {
        return Ok((None, false));
    }
    let size = [frames[0].image.width, frames[0].image.height];
    let (mut known, mut all) = (Vec::new(), Vec::new());
    for neighbours in order.windows(2) {
        let [s, l] = [neighbours[0], neighbours[1]];
        let pair = ExposurePair { short: s, long: l, stated: exposures::stated_ratio(&metadata[s], &metadata[l]) };
        let levels = comparagram::levels(&frames[s], &frames[l], size, job)?;
        if let Some(ratio) = pair.known(params) {
            known.push(PairEvidence { log_ratio: [ratio.log, ratio.error], levels: levels.clone() });
        }
        all.push(levels);
    }
    // The pixels must contradict the curve of sRGB whatever the ratios of the exposures are. A wrong ratio alone would
    // look like a curve that is a power of the true one.
    let contradicts_srgb = curve::contradicts_srgb(all);
    let is_wanted = contradicts_srgb && params.tone_curve == ToneCurve::Recovered;
    let curve = if is_wanted { curve::recover(&known) } else { None };
    let contradicts_srgb = contradicts_srgb && curve.is_none();
    Ok((curve, contradicts_srgb))
}

/// Returns the photos with their tone curve undone; alpha stays.
fn linearised(frames: &[Frame], curve: &RecoveredCurve, job: Job) -> Result<Vec<Image>> {
    let step = 1.0 / frames.len() as f64;
    let linear = |(k, frame): (usize, &Frame)| {
        let (image, part) = (frame.image, job.part(k as f64 * step, ((k + 1) as f64 * step).min(1.0)));
        let mut linear = Image::new(image.width, image.height, image.channels)?;
        exec::for_rows(&mut linear.data, image.row_len(), part, |y, row| {
            row.copy_from_slice(image.row(y));
            for pixel in row.chunks_exact_mut(image.channels) {
                pixel.iter_mut().take(3).for_each(|v| *v = curve.light(*v));
            }
        })?;
        Ok(linear)
    };
    frames.iter().enumerate().map(linear).collect()
}

/// Checks settings and photos.
fn check(photos: &[&Image], params: &Params, job: Job) -> Result<()> {
    params.check(photos.len())?;
    for (i, photo) in photos.iter().enumerate() {
        job.check()?;
        let name = format!("photos[{i}]");
        if !matches!(photo.channels, 1 | 3 | 4) {
            return Err(Error::argument(format!("{name} has {} channels; it must have 1, 3 or 4", photo.channels)));
        }
        if photo.channels != photos[0].channels {
            return Err(Error::argument(format!(
                "{name} has {} channels and photos[0] has {}; all photos must have the same number",
                photo.channels, photos[0].channels
            )));
        }
        photo.check_same_size(&name, photos[0], "photos[0]")?;
        let broken = photo.count_non_finite();
        if broken > 0 {
            return Err(Error::argument(format!(
                "{name} has {broken} samples that are NaN or infinite; all must be finite"
            )));
        }
    }
    Ok(())
}

/// The report about a single photo.
fn of_one(image: &Image, metadata: &PhotoMetadata, params: &Params) -> Report {
    let frame = Frame::new(image, params.saturation);
    let pixels = image.data.chunks_exact(image.channels);
    let clipped = pixels.filter(|pixel| frame::peak(pixel) >= frame.clip).count();
    let stated = exposures::stated_ratio(metadata, metadata).unwrap_or(0.0);
    let photo = PhotoReport { exposure: 1.0, stated, ..PhotoReport::default() };
    Report { photos: vec![photo], clipped: clipped as f64 / (image.width * image.height) as f64, ..Report::default() }
}

/// Returns the index of the photo with the most well-exposed pixels ([`WELL_EXPOSED`]).
fn best_exposed(frames: &[Frame], job: Job) -> Result<usize> {
    let counts = exec::map(frames.len(), job.part(0.0, 0.0), |k| {
        let pixels = frames[k].image.data.chunks_exact(frames[k].image.channels);
        let is_well_exposed = |pixel: &[f32]| {
            frame::light(pixel) >= WELL_EXPOSED[0]
                && (frames[k].clip.is_infinite() || frame::peak(pixel) <= WELL_EXPOSED[1])
        };
        pixels.filter(|pixel| is_well_exposed(pixel)).count()
    })?;
    Ok((0..counts.len()).rev().max_by_key(|&k| counts[k]).unwrap_or(0))
}

/// Compares each pair of neighbours in the order of exposure. For each pair, returns the ratio of the exposures, and
/// one flag per pixel: 1 where the two photos disagree. With `keep_moving`, the list of flags is empty.
fn compare(
    frames: &[Frame],
    metadata: &[PhotoMetadata],
    order: &[usize],
    params: &Params,
    job: Job,
) -> Result<(Vec<Ratio>, Vec<Vec<u8>>)> {
    let size = [frames[0].image.width, frames[0].image.height];
    let (mut ratios, mut disagreements) = (Vec::new(), Vec::new());
    let step = 1.0 / (order.len() - 1) as f64;
    for (k, neighbours) in order.windows(2).enumerate() {
        let job = job.part(k as f64 * step, ((k + 1) as f64 * step).min(1.0));
        let [s, l] = [neighbours[0], neighbours[1]];
        let (short, long) = (&frames[s], &frames[l]);
        let pair = ExposurePair { short: s, long: l, stated: exposures::stated_ratio(&metadata[s], &metadata[l]) };
        let samples = ratio::samples(short, long, size, job.part(0.0, 0.2))?;
        let ratio = pair.ratio(ratio::measure(&samples, long.clip)?, params)?;
        if !params.keep_moving {
            let factor = maths::exp(ratio.log) as f32;
            let noise = Noise::measure(&samples, factor)?;
            disagreements.push(motion::disagreement([short, long], factor, &noise, size, job.part(0.2, 1.0))?);
        }
        ratios.push(ratio);
    }
    Ok((ratios, disagreements))
}
