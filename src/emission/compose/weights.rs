//! Weight maps, which blend several exemplars over a texture.

use crate::emission::params::Input;
use crate::error::{Error, Result};
use crate::image::Image;
use glam::DVec2;

/// Tolerance for rounding: the sum of the weights may exceed 1 by this amount. [rounding]
const ROUNDING: f32 = 1e-4;

/// A further exemplar, and the weight map by which its lights replace the lights of the first exemplar.
#[derive(Clone, Copy)]
pub struct Style<'a> {
    pub input: Input<'a>,
    /// Unwarped pixels of this exemplar per texel, in `[1e-3, 1e3]`.
    pub scale: f64,
    /// Weight of this exemplar in `[0, 1]`: an image of one channel, stretched over the texture. The first exemplar's
    /// weight is 1 minus the weights of all further exemplars.
    pub weights: &'a Image,
}

/// A weight map for each exemplar. A single exemplar has no map; its weight is 1.
pub struct Weights(Vec<Image>);

impl Weights {
    /// Builds the weight maps. Errors: maps of different sizes or of several channels; values outside [0, 1]; weights
    /// whose sum exceeds 1.
    pub fn new(styles: &[Style]) -> Result<Self> {
        let Some(map) = styles.first().map(|s| s.weights) else { return Ok(Self(Vec::new())) };
        let mut rest = Image::new(map.width, map.height, 1)?;
        rest.data.fill(1.0);
        let mut maps = vec![Image::default()];
        for Style { weights, .. } in styles {
            map.check_same_size("the first map of weights", weights, "another")?;
            if weights.channels != 1 {
                return Err(Error::argument(format!("weights has {} channels; it must have 1", weights.channels)));
            }
            if let Some(bad) = weights.data.iter().find(|w| !(0.0..=1.0).contains(*w)) {
                return Err(Error::argument(format!("weights holds {bad}; a weight must be in [0, 1]")));
            }
            rest.data.iter_mut().zip(&weights.data).for_each(|(r, w)| *r -= w);
            let mut copy = Image::new(map.width, map.height, 1)?;
            copy.data.copy_from_slice(&weights.data);
            maps.push(copy);
        }
        if let Some(over) = rest.data.iter().find(|r| **r < -ROUNDING) {
            return Err(Error::argument(format!(
                "the weights of the further exemplars add up to {}; together they must be at most 1",
                1.0 - over
            )));
        }
        rest.data.iter_mut().for_each(|r| *r = r.max(0.0));
        maps[0] = rest;
        Ok(Self(maps))
    }

    /// The weight of an exemplar at a point of the texture, interpolated bilinearly. The point's coordinates run from 0
    /// to 1 over the texture.
    pub fn at(&self, exemplar: usize, at: DVec2) -> f32 {
        let Some(map) = self.0.get(exemplar) else { return 1.0 };
        let last = DVec2::new(map.width as f64, map.height as f64) - 1.0;
        let p = (at * (last + 1.0) - 0.5).clamp(DVec2::ZERO, last);
        let (low, t) = (p.floor(), p.fract().as_vec2());
        let high = (low + 1.0).min(last);
        let value = |x: f64, y: f64| map.data[y as usize * map.width + x as usize];
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let top = mix(value(low.x, low.y), value(high.x, low.y), t.x);
        mix(top, mix(value(low.x, high.y), value(high.x, high.y), t.x), t.y)
    }

    /// The mean weight of an exemplar over the texture.
    pub fn mean(&self, exemplar: usize) -> f64 {
        self.0
            .get(exemplar)
            .map_or(1.0, |map| map.data.iter().map(|&w| f64::from(w)).sum::<f64>() / map.data.len() as f64)
    }
}
