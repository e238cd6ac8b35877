//! How far two exposures of one pixel may differ: measured on the photos themselves, at each level of light.

use super::ratio::{MAD_TO_SIGMA, Sample};
use crate::error::Result;
use crate::image::try_push;

/// Levels of light: halves of octaves from 2^-16 to 2^16. [convention]
const LEVELS: usize = 64;
const LOWEST: f32 = -16.0;
const PER_OCTAVE: f32 = 2.0;

/// A level is measured on at least this many pixels.
const MIN_PIXELS: usize = 32;

/// Limits of the measured deviation and spread, relative to the light, so that something that moves is not taken for
/// noise where it covers most pixels of a level. The deviation allows for tone curves that are not those of sRGB. The
/// spread is that of a camera that saturates at 500 electrons, as at high speeds, and a part of the light in addition.
/// [convention]
const MAX_DEVIATION: f32 = 0.2;
const MAX_SPREAD: f32 = 0.1;
const MAX_PHOTON_NOISE: f32 = 1.0 / 500.0;

/// The difference `long - ratio * short` of unmoved pixels, by level: its median and its robust standard deviation,
/// relative to the light.
pub struct Noise([[f32; 2]; LEVELS]);

impl Noise {
    pub fn measure(samples: &[Sample], ratio: f32) -> Result<Self> {
        let mut by_level: Vec<Vec<f32>> = vec![Vec::new(); LEVELS];
        for s in samples {
            let light = (s.short + s.long) * ratio / (1.0 + ratio);
            try_push(&mut by_level[level(light)], (s.long - ratio * s.short) / light)?;
        }
        let mut found = [None; LEVELS];
        for (out, values) in found.iter_mut().zip(&mut by_level) {
            *out = (values.len() >= MIN_PIXELS).then(|| {
                let middle = median(values);
                values.iter_mut().for_each(|v| *v = (*v - middle).abs());
                let spread = MAD_TO_SIGMA as f32 * median(values);
                [middle.clamp(-MAX_DEVIATION, MAX_DEVIATION), spread]
            });
        }
        Ok(Self(std::array::from_fn(|k| {
            let [deviation, spread] = nearest(&found, k);
            let light = (LOWEST + (k as f32 + 0.5) / PER_OCTAVE).exp2();
            [deviation, spread.min(MAX_SPREAD.hypot((MAX_PHOTON_NOISE / light).sqrt()))]
        })))
    }

    /// Returns median and standard deviation of the difference at a level of light in the long exposure.
    #[inline]
    pub fn at(&self, light: f32) -> [f32; 2] {
        self.0[level(light)].map(|v| v * light.max(0.0))
    }
}

/// The level to which a value of light belongs.
#[inline]
fn level(light: f32) -> usize {
    // The exponent and the fraction of the float approximate the logarithm closely enough for levels.
    let log = light.max(0.0).to_bits() as f32 * (1.0 / (1 << 23) as f32) - 127.0;
    (((log - LOWEST) * PER_OCTAVE).max(0.0) as usize).min(LEVELS - 1)
}

/// The values of a level, or else the spread of the nearest level that was measured, which grows towards darkness as
/// that of Poisson noise. Without any level, photos may differ by `MAX_SPREAD`.
fn nearest(found: &[Option<[f32; 2]>; LEVELS], level: usize) -> [f32; 2] {
    if let Some(values) = found[level] {
        return values;
    }
    let measured = (0..LEVELS).filter_map(|k| Some((k, found[k]?[1])));
    measured.min_by_key(|(k, _)| k.abs_diff(level)).map_or([0.0, MAX_SPREAD], |(k, spread)| {
        let octaves = (k as f32 - level as f32) / PER_OCTAVE;
        [0.0, spread * (0.5 * octaves.max(0.0)).exp2()]
    })
}

fn median(values: &mut [f32]) -> f32 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}
