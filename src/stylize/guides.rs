//! Guides: pairs of exemplar and target channels. Each guide is normalised to `[0, 1]`, with one scale for exemplar and
//! target.

use crate::error::{Error, Result, check_range};
use crate::exec;
use crate::image::colour::linear_to_srgb;
use crate::image::{Image, try_vec};
use crate::job::Job;
use crate::patch::{halve, level_size};

/// The meaning of a guide's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// Linear light, ≥ 0: rendered buffers, compared as they appear on a display. If the 99.9th percentile of exemplar
    /// and target together exceeds white, all values are scaled so that this percentile becomes white. Then they are
    /// clipped and sRGB-encoded, so that a highlight of a million counts as white and does not dominate.
    Light,
    /// Linear data: normals, object codes, edge maps. The common range of all channels of both images is mapped to
    /// `[0, 1]`.
    Data,
}

/// One property of the scene, rendered for the exemplar and for the target.
#[derive(Clone, Copy)]
pub struct Guide<'a> {
    /// Name in error messages.
    pub name: &'a str,
    pub source: &'a Image,
    pub target: &'a Image,
    /// Weight relative to the other guides, in `[0, 1e6]`.
    pub weight: f32,
    pub range: Range,
}

/// Maximum number of channels of all guides together. With the up to four channels of an artwork, they fill the 64
/// channels of an image.
pub const MAX_CHANNELS: usize = 60;
/// A channel is flat if its values span at most this range. The contrast of a flat channel is left unchanged, because
/// the ratio of two small ranges is mostly noise. [convention: about 5 of 255 levels]
const FLAT_RANGE: f32 = 0.02;

/// Largest side of a patch of guides in pixels: the largest value of `Params::patch`.
pub(super) const MAX_PATCH: usize = 33;

/// Guides are similar if they differ by at most this much, as a weighted root mean square of channels in `[0, 1]`.
/// [bench stylit:autocomplete]
pub(super) const SIMILAR: f32 = 0.1;

/// All guides, with their channels interleaved in two images: one of the exemplar, one of the target.
pub(super) struct Channels {
    pub source: Image,
    pub target: Image,
    /// Weight of each channel: a guide's weight is divided among its channels, and all weights sum to 1, or to 0 if
    /// every guide has weight 0.
    pub weights: Vec<f64>,
    /// Whether each channel belongs to a guide that shows light, not normals, edges or materials. Empty for the
    /// components of a preview, which mix channels of both kinds.
    pub is_light: Vec<bool>,
    /// Per pixel: whether one of its samples is NaN or infinite.
    pub broken_source: Vec<bool>,
    pub broken_target: Vec<bool>,
}

impl Channels {
    /// Combines the guides. If `half`, halves their resolution, so that all further work handles a quarter of the
    /// pixels. `match_appearance`: see `Params::match_appearance`.
    pub fn new(guides: &[Guide], match_appearance: f32, half: bool, job: Job) -> Result<Self> {
        let first = guides.first().ok_or_else(no_guides)?;
        let count: usize = guides.iter().map(|g| g.source.channels).sum();
        if count > MAX_CHANNELS {
            return Err(Error::argument(format!(
                "the guides have {count} channels; there may be 1 to {MAX_CHANNELS} in all"
            )));
        }
        let new = |of: &Image| Image::new(level_size(of.width, half.into()), level_size(of.height, half.into()), count);
        let (mut source, mut target) = (new(first.source)?, new(first.target)?);
        let total: f64 = guides.iter().map(|g| f64::from(g.weight)).sum();
        let mut weights = Vec::with_capacity(count);
        for guide in guides {
            guide.check(first)?;
            let halved;
            let guide = if half {
                halved = (halve(guide.source, job)?, halve(guide.target, job)?);
                &Guide { source: &halved.0, target: &halved.1, ..*guide }
            } else {
                guide
            };
            let channels = guide.source.channels;
            let normalise = guide.normalisation(job)?;
            for (from, into) in [(guide.source, &mut source), (guide.target, &mut target)] {
                let offset = weights.len();
                exec::for_rows(&mut into.data, from.width * count, job, |y, row| {
                    for (o, v) in row.chunks_exact_mut(count).zip(from.row(y).chunks_exact(channels)) {
                        o[offset..offset + channels].iter_mut().zip(v).for_each(|(o, v)| *o = normalise.apply(*v));
                    }
                })?;
            }
            let weight = if total > 0.0 { f64::from(guide.weight) / total / channels as f64 } else { 0.0 };
            weights.extend(std::iter::repeat_n(weight, channels));
        }
        let light = guides.iter().flat_map(|g| std::iter::repeat_n(g.range == Range::Light, g.source.channels));
        let is_light: Vec<bool> = light.collect();
        let broken_source = clear_broken(&mut source, job)?;
        let broken_target = clear_broken(&mut target, job)?;
        if match_appearance > 0.0 {
            for channel in (0..count).filter(|&c| is_light[c]) {
                job.check()?;
                match_channel(&mut source, &target, channel, match_appearance);
            }
        }
        Ok(Self { source, target, weights, is_light, broken_source, broken_target })
    }
}

pub(super) fn no_guides() -> Error {
    Error::argument("guides is empty; give at least one pair")
}

/// Maps the range of a source channel onto the range of the same channel in the target. `strength` is the share of this
/// change that is applied. A range extends from the 5th to the 95th percentile.
fn match_channel(source: &mut Image, target: &Image, channel: usize, strength: f32) {
    let ends = |image: &Image| {
        let step = ((image.width * image.height) >> 18).max(1) * image.channels;
        let mut values: Vec<f32> = image.data.iter().skip(channel).step_by(step).copied().collect();
        values.sort_unstable_by(f32::total_cmp);
        let at = |percent: usize| values[(values.len() - 1) * percent / 100];
        (at(5), at(95) - at(5))
    };
    let ((low, range), (new_low, new_range)) = (ends(source), ends(target));
    // Leave the contrast of nearly flat channels unchanged.
    let gain = if range > FLAT_RANGE { new_range / range } else { 1.0 };
    let channels = source.channels;
    for v in source.data.iter_mut().skip(channel).step_by(channels) {
        let matched = ((*v - low) * gain + new_low).clamp(0.0, 1.0);
        *v += (matched - *v) * strength;
    }
}

/// Replaces non-finite samples by 0. Returns for each pixel whether it had a non-finite sample.
fn clear_broken(image: &mut Image, job: Job) -> Result<Vec<bool>> {
    let (channels, row_len) = (image.channels, image.row_len());
    let mut broken = try_vec(image.width * image.height, false)?;
    exec::for_rows(&mut broken, image.width, job, |y, row| {
        for (broken, pixel) in row.iter_mut().zip(image.row(y).chunks_exact(channels)) {
            *broken = pixel.iter().any(|v| !v.is_finite());
        }
    })?;
    if broken.contains(&true) {
        exec::for_rows(&mut image.data, row_len, job, |_, row| {
            row.iter_mut().filter(|v| !v.is_finite()).for_each(|v| *v = 0.0);
        })?;
    }
    Ok(broken)
}

/// Maps a value `v` to `(v - offset) * scale`, clamped to `[0, 1]`, and applies the sRGB curve if `curve` is true. NaN
/// and infinity stay unchanged, so that [`clear_broken`] finds them later.
struct Normalisation {
    offset: f32,
    scale: f32,
    curve: bool,
}

impl Normalisation {
    fn apply(&self, v: f32) -> f32 {
        if !v.is_finite() {
            return v;
        }
        let v = ((v - self.offset) * self.scale).clamp(0.0, 1.0);
        if self.curve { linear_to_srgb(v) } else { v }
    }
}

impl Guide<'_> {
    /// Returns the name of a part of the guide (`side`: its source, target or weight) for error messages.
    pub(super) fn side(&self, side: &str) -> String {
        format!("the {side} of guide {:?}", self.name)
    }

    /// Checks the guide without comparing it with other guides.
    pub fn check_alone(&self) -> Result<()> {
        check_range(&self.side("weight"), self.weight, 0.0, 1e6)?;
        if self.source.channels != self.target.channels {
            return Err(Error::argument(format!(
                "{} has {} channels and {} {}; they must have the same number",
                self.side("source"),
                self.source.channels,
                self.side("target"),
                self.target.channels
            )));
        }
        Ok(())
    }

    pub(super) fn check(&self, first: &Guide) -> Result<()> {
        self.check_alone()?;
        first.source.check_same_size(&first.side("source"), self.source, &self.side("source"))?;
        first.target.check_same_size(&first.side("target"), self.target, &self.side("target"))
    }

    fn normalisation(&self, job: Job) -> Result<Normalisation> {
        let finite = || self.source.data.iter().chain(&self.target.data).copied().filter(|v| v.is_finite());
        let (low, high) = [self.source, self.target].into_iter().try_fold((f32::MAX, f32::MIN), |ends, image| {
            let wider = |(l, h): (f32, f32), (low, high): (f32, f32)| (l.min(low), h.max(high));
            let row = |y| {
                let finite = image.row(y).iter().copied().filter(|v| v.is_finite());
                finite.fold((f32::MAX, f32::MIN), |ends, v| wider(ends, (v, v)))
            };
            Ok(exec::map(image.height, job, row)?.into_iter().fold(ends, wider))
        })?;
        Ok(match self.range {
            Range::Data if high > low => Normalisation { offset: low, scale: 1.0 / (high - low), curve: false },
            Range::Data => Normalisation { offset: 0.0, scale: 0.0, curve: false },
            Range::Light if high <= 1.0 => Normalisation { offset: 0.0, scale: 1.0, curve: true },
            Range::Light => {
                // Compute the percentile from at most a million samples. A maximum would depend on single bright
                // pixels.
                let step = ((self.source.data.len() + self.target.data.len()) >> 20).max(1);
                let mut values: Vec<f32> = finite().step_by(step).collect();
                let rank = (values.len() - 1) * 999 / 1000;
                let white = values.select_nth_unstable_by(rank, f32::total_cmp).1.max(1.0);
                Normalisation { offset: 0.0, scale: 1.0 / white, curve: true }
            }
        })
    }
}
