//! Light of the target that the exemplar lacks.
//!
//! The exemplar lacks the light of a place of the target if no place of the exemplar has similar values of the guides
//! of light. The paint of such a place is a guess. The guide error of a run is high at such a place, but it is also
//! high where a match was chosen for its colours. Therefore places with a high guide error are compared with a sample
//! of the whole exemplar.

use super::guides::{Channels, SIMILAR};
use crate::error::Result;
use crate::exec;
use crate::image::{Image, try_with_capacity};
use crate::job::Job;
use crate::maths;
use std::collections::BTreeSet;

/// Maximum number of samples along the longer side of an image; only these pixels are compared.
const SAMPLES: usize = 128;
/// Number of steps to which a channel is rounded, so that equal guides are compared only once. [rounding]
const STEPS: f32 = 32.0;
/// Maximum number of different rounded guide values of the exemplar with which the target is compared.
const MAX_CODES: usize = 2048;
/// Side, in samples, of the square blocks into which the target is divided. The place of the warning is the centre of
/// the block with the most samples whose light the exemplar lacks.
const BLOCK: usize = 8;

/// The part of the target whose light the exemplar lacks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lack {
    /// Number of pixels whose light the exemplar lacks, divided by the number of pixels to paint.
    pub share: f64,
    /// Centre, in pixels of the target, of the block with the most samples whose light the exemplar lacks; `None` if
    /// `share` is 0.
    pub place: Option<[usize; 2]>,
}

/// The guides of light at the samples of exemplar and target. They are taken before a preview compresses the guides,
/// which mixes the channels of light with the channels of data.
pub(super) struct LightSamples {
    codes: Codes,
    /// One pixel per sample of the target, with all channels of the guides.
    target: Image,
    /// Distance between the samples of the target in pixels.
    stride: usize,
}

impl LightSamples {
    /// Takes the samples; `None` if no guide of light has a weight above 0.
    pub fn of(guides: &Channels, source_mask: Option<&[bool]>) -> Result<Option<Self>> {
        let Some(codes) = codes(guides, source_mask)? else { return Ok(None) };
        let target = &guides.target;
        let stride = stride(target);
        let (columns, rows) = (target.width.div_ceil(stride), target.height.div_ceil(stride));
        let mut samples = Image::new(columns, rows, target.channels)?;
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            samples.pixel_mut(column, row).copy_from_slice(target.pixel(column * stride, row * stride));
        }
        Ok(Some(Self { codes, target: samples, stride }))
    }
}

/// Compares the target with the exemplar. `target_mask` marks the pixels to paint; `None` marks all pixels.
/// `guide_error` is the guide error of the finished run.
pub(super) fn lack(
    light: Option<&LightSamples>,
    target_mask: Option<&[bool]>,
    guide_error: &Image,
    job: Job,
) -> Result<Lack> {
    let Some(light) = light else { return Ok(Lack::default()) };
    let (columns, rows, stride) = (light.target.width, light.target.height, light.stride);
    let is_wanted = |x: usize, y: usize| target_mask.is_none_or(|mask| mask[y * guide_error.width + x]);
    // For each sample: whether it is to be painted, and whether the exemplar lacks its light.
    let samples = exec::map(rows, job, |row| {
        let y = row * stride;
        let sample = |column: usize| {
            let x = column * stride;
            let wanted = is_wanted(x, y);
            let lacks = wanted && guide_error.pixel(x, y)[0] > SIMILAR;
            (wanted, lacks && !light.codes.has_similar(light.target.pixel(column, row)))
        };
        (0..columns).map(sample).collect::<Vec<_>>()
    })?;
    let count = |pick: fn(&(bool, bool)) -> bool| samples.iter().flatten().filter(|s| pick(s)).count();
    let share = count(|s| s.1) as f64 / count(|s| s.0).max(1) as f64;
    let blocks = (0..rows).step_by(BLOCK).flat_map(|y| (0..columns).step_by(BLOCK).map(move |x| [x, y]));
    let lacking = |&[x, y]: &[usize; 2]| {
        let rows = samples[y..].iter().take(BLOCK);
        rows.flat_map(|row| row[x..].iter().take(BLOCK)).filter(|s| s.1).count()
    };
    let centre = |[x, y]: [usize; 2]| {
        let ends = [guide_error.width - 1, guide_error.height - 1];
        [((x + BLOCK / 2) * stride).min(ends[0]), ((y + BLOCK / 2) * stride).min(ends[1])]
    };
    let place = blocks.rev().max_by_key(lacking).filter(|_| share > 0.0).map(centre);
    Ok(Lack { share, place })
}

fn stride(image: &Image) -> usize {
    image.width.max(image.height).div_ceil(SAMPLES)
}

/// The distinct values of the exemplar's guides of light, rounded.
struct Codes {
    /// `values` holds the distinct values one after the other, each with all channels of the guides. `weights` holds
    /// the weight of each channel, 0 for channels of data.
    values: Vec<f32>,
    weights: Vec<f64>,
}

/// Collects the distinct values of the exemplar's guides of light, inside the mask, thinned to at most [`MAX_CODES`].
/// `None` if no guide of light has a weight above 0.
fn codes(guides: &Channels, source_mask: Option<&[bool]>) -> Result<Option<Codes>> {
    let source = &guides.source;
    let of_light = || guides.weights.iter().zip(&guides.is_light).map(|(w, &is_light)| if is_light { *w } else { 0.0 });
    let total: f64 = of_light().sum();
    if total <= 0.0 {
        return Ok(None);
    }
    let stride = stride(source);
    let mut different = BTreeSet::new();
    for y in (0..source.height).step_by(stride) {
        for x in (0..source.width).step_by(stride) {
            if source_mask.is_none_or(|mask| mask[y * source.width + x]) {
                let channels = source.pixel(x, y).iter().zip(&guides.is_light);
                let code = channels.map(|(v, &is_light)| if is_light { (v * STEPS + 0.5) as u8 } else { 0 });
                different.insert(code.collect::<Vec<u8>>());
            }
        }
    }
    let step = different.len().div_ceil(MAX_CODES).max(1);
    let mut values = try_with_capacity(different.len().div_ceil(step) * source.channels)?;
    values.extend(different.iter().step_by(step).flatten().map(|&v| f32::from(v) / STEPS));
    Ok(Some(Codes { values, weights: of_light().map(|weight| weight / total).collect() }))
}

impl Codes {
    fn has_similar(&self, guides: &[f32]) -> bool {
        let difference = |code: &[f32]| -> f64 {
            code.iter().zip(guides).zip(&self.weights).map(|((a, b), w)| w * maths::powi(f64::from(a - b), 2)).sum()
        };
        let limit = maths::powi(f64::from(SIMILAR), 2);
        self.values.chunks_exact(guides.len()).any(|code| difference(code) <= limit)
    }
}
