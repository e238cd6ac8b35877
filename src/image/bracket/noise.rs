//! Measures by how much two exposures of an unmoved pixel differ, on the photos themselves, at each level of light.

use super::ratio::{MAD_TO_SIGMA, Sample};
use crate::error::Result;
use crate::image::try_push;
use crate::maths;

/// Levels of light: `LEVELS` intervals of half an octave each, from 2^-16 to 2^16 (`LOWEST` is the exponent of the
/// first). [convention]
const LEVELS: usize = 64;
const LOWEST: f32 = -16.0;
const PER_OCTAVE: f32 = 2.0;

/// The noise of a level is measured only if at least this many pixels belong to the level.
const MIN_PIXELS: usize = 32;

/// Limits of the measured median difference (`MAX_DEVIATION`) and of its standard deviation, as shares of the light.
/// Without limits, a moving object that covers most pixels of a level would be taken for noise. `MAX_DEVIATION` allows
/// for tone curves other than the sRGB curve. The standard deviation may be as large as for two noises together: the
/// share `MAX_SPREAD` of the light, and the photon noise of a camera that saturates at 500 electrons, as at high ISO
/// speeds. [convention]
const MAX_DEVIATION: f32 = 0.2;
const MAX_SPREAD: f32 = 0.1;
const MAX_PHOTON_NOISE: f32 = 1.0 / 500.0;

/// The difference `long - ratio * short` of unmoved pixels: for each level of light, its median and its robust standard
/// deviation, both divided by the light.
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
            let light = maths::exp2(LOWEST + (k as f32 + 0.5) / PER_OCTAVE);
            [deviation, spread.min(maths::hypot(MAX_SPREAD, (MAX_PHOTON_NOISE / light).sqrt()))]
        })))
    }

    /// Returns the median and the standard deviation of the difference of two exposures. `light` is the pixel's light
    /// in the long exposure.
    #[inline]
    pub fn at(&self, light: f32) -> [f32; 2] {
        self.0[level(light)].map(|v| v * light.max(0.0))
    }
}

/// Returns the index of the level to which a value of light belongs.
#[inline]
fn level(light: f32) -> usize {
    // The bits of the float (exponent and fraction) give an approximate logarithm, which is accurate enough for levels.
    let log = light.max(0.0).to_bits() as f32 * (1.0 / (1 << 23) as f32) - 127.0;
    (((log - LOWEST) * PER_OCTAVE).max(0.0) as usize).min(LEVELS - 1)
}

/// Returns the median and the standard deviation of a level. If the level was not measured, the median is 0, and the
/// standard deviation is taken from the nearest measured level; towards darker levels it grows as for Poisson noise. If
/// no level was measured, the standard deviation is `MAX_SPREAD`.
fn nearest(found: &[Option<[f32; 2]>; LEVELS], level: usize) -> [f32; 2] {
    if let Some(values) = found[level] {
        return values;
    }
    let measured = (0..LEVELS).filter_map(|k| Some((k, found[k]?[1])));
    measured.min_by_key(|(k, _)| k.abs_diff(level)).map_or([0.0, MAX_SPREAD], |(k, spread)| {
        let octaves = (k as f32 - level as f32) / PER_OCTAVE;
        [0.0, spread * maths::exp2(0.5 * octaves.max(0.0))]
    })
}

fn median(values: &mut [f32]) -> f32 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}
