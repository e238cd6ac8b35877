//! The exemplar at working size: the resolution of the synthesis ("Lighting Style Transfer", Fig. 12d).

use super::components::Components;
use crate::error::Result;
use crate::image::colour::luminance;
use crate::image::{Image, pyramid, try_collect};
use crate::job::Job;
use glam::DVec2;

/// The regions that [`Working::contrast`] compares for a given box. The inside is the box scaled by `INNER`, at least
/// one working pixel wide. The surroundings lie between the box and the box scaled by `OUTER`, after each of these two
/// is widened by one working pixel on each side. Of the surroundings, only dark pixels count: lights cover less than
/// the share `UNLIT` of them. [judged on 20 photos]
const INNER: f64 = 0.6;
const OUTER: f64 = 2.0;
const UNLIT: f32 = 0.05;

/// The exemplar, reduced to the working size of the synthesis.
pub struct Working {
    pub width: usize,
    pub height: usize,
    /// Unwarped pixels per working pixel, along x and y.
    pub pitch: DVec2,
    /// Linear RGB of lights relative to the brightest light; 0 elsewhere (Fig. 12c).
    pub colour: Image,
    /// Confidence of each pixel that it is light; 0 for cut lamps ([`super::roles::Role::Cut`]).
    pub confidence: Vec<f32>,
    /// Share of each pixel that lights cover; cut lamps are left out.
    pub coverage: Vec<f32>,
    /// Whether patches may copy a pixel: the photo shows all of it, and no part of it belongs to a cut lamp
    /// ([`super::roles::Role::Cut`]).
    pub usable: Vec<bool>,
    /// `shown`: whether the photo shows all of a pixel. `shown_coverage`: the share of the pixel that lights cover,
    /// including cut lamps. The lattice is found from both.
    pub shown: Vec<bool>,
    pub shown_coverage: Vec<f32>,
    /// Mean luminance of each pixel, lights included. Parts that the photo does not show count as 0.
    pub luminance: Vec<f32>,
}

/// The full-size images that are reduced to the working size.
pub struct Sources<'a> {
    pub image: &'a Image,
    pub light: &'a Image,
    pub components: &'a Components,
    pub usable: &'a [bool],
    pub shown: &'a [bool],
}

impl Working {
    pub fn new(sources: &Sources, side: f64, job: Job) -> Result<Self> {
        let &Sources { image, light, components, usable, shown } = sources;
        let longest = image.width.max(image.height) as f64;
        let reduce = |n: usize| ((n as f64 * (side / longest).min(1.0)).round() as usize).max(1);
        let (width, height) = (reduce(image.width), reduce(image.height));
        let pitch = DVec2::new(image.width as f64 / width as f64, image.height as f64 / height as f64);

        // Reduce nine channels together: colour (0 to 2), confidence, coverage, usable, shown, shown coverage and
        // luminance. Pixels that are not usable count as 0 in channels 0 to 5.
        const CHANNELS: usize = 9;
        let mut full = Image::new(image.width, image.height, CHANNELS)?;
        let mut brightest = 0f32;
        for (i, pixel) in full.data.chunks_exact_mut(CHANNELS).enumerate().filter(|(i, _)| shown[*i]) {
            pixel[6] = 1.0;
            pixel[7] = f32::from(components.labels[i] != 0);
            let colour = image.rgb(i % image.width, i / image.width);
            pixel[8] = luminance(colour);
            if !usable[i] {
                continue;
            }
            if components.labels[i] != 0 {
                pixel[..3].copy_from_slice(&colour.to_array());
                brightest = brightest.max(colour.max_element());
                pixel[4] = 1.0;
            }
            pixel[3] = light.data[i].clamp(0.0, 1.0);
            pixel[5] = 1.0;
        }
        let reduced = pyramid::resize(&full, width, height, job)?;
        let scale = if brightest > 0.0 { 1.0 / brightest } else { 0.0 };
        let mut colour = Image::new(width, height, 3)?;
        for (out, pixel) in colour.data.chunks_exact_mut(3).zip(reduced.data.chunks_exact(CHANNELS)) {
            out.iter_mut().zip(pixel).for_each(|(o, p)| *o = p * scale);
        }
        let channel = |c: usize| reduced.data.iter().skip(c).step_by(CHANNELS);
        let confidence = try_collect(channel(3).copied())?;
        let coverage = try_collect(channel(4).copied())?;

        // A working pixel is usable if all of its full-size pixels are. If none is usable, work at full size.
        let all = |c: usize| try_collect(channel(c).map(|&v| v > 1.0 - 1e-4));
        let usable = all(5)?;
        if !usable.contains(&true) && side < longest {
            return Self::new(sources, longest, job);
        }
        let (shown, shown_coverage) = (all(6)?, try_collect(channel(7).copied())?);
        let luminance = try_collect(channel(8).copied())?;
        Ok(Self { width, height, pitch, colour, confidence, coverage, usable, shown, shown_coverage, luminance })
    }

    /// Whether lamps cover at least half of a pixel.
    pub fn is_lit(&self, pixel: usize) -> bool {
        self.coverage[pixel] >= 0.5
    }

    /// Mean luminance of the inner part of a box minus the mean luminance of its unlit surroundings. The box is given
    /// by its centre and half its sides, in unwarped pixels. `None` if the photo shows no pixel of the inner part, or
    /// no unlit pixel of the surroundings.
    pub fn contrast(&self, centre: DVec2, half: DVec2) -> Option<f64> {
        let (inner, outer) = (half * INNER, half * OUTER + self.pitch);
        let mut sums = [(0.0, 0usize); 2];
        let low = ((centre - outer) / self.pitch).floor();
        let high = ((centre + outer) / self.pitch).ceil();
        for y in low.y as i32..high.y as i32 {
            for x in low.x as i32..high.x as i32 {
                let Some(i) = self.index(x, y).filter(|&i| self.shown[i]) else { continue };
                let off = ((DVec2::new(f64::from(x), f64::from(y)) + 0.5) * self.pitch - centre).abs();
                let is_inside = off.cmple(inner.max(self.pitch / 2.0)).all();
                let is_around = off.cmpgt(half + self.pitch).any() && self.shown_coverage[i] < UNLIT;
                if is_inside || is_around {
                    let (sum, count) = &mut sums[usize::from(!is_inside)];
                    (*sum, *count) = (*sum + f64::from(self.luminance[i]), *count + 1);
                }
            }
        }
        let [(inside, n), (around, m)] = sums;
        (n > 0 && m > 0).then(|| inside / n as f64 - around / m as f64)
    }

    /// The index of a pixel; `None` outside the image.
    pub fn index(&self, x: i32, y: i32) -> Option<usize> {
        let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
        (x < self.width && y < self.height).then(|| y * self.width + x)
    }

    /// The bounding box `[x0, y0, x1, y1)` of all usable pixels.
    pub fn usable_box(&self) -> [usize; 4] {
        let mut bounds = [self.width, self.height, 0, 0];
        for (i, _) in self.usable.iter().enumerate().filter(|(_, u)| **u) {
            let (x, y) = (i % self.width, i / self.width);
            bounds = [bounds[0].min(x), bounds[1].min(y), bounds[2].max(x + 1), bounds[3].max(y + 1)];
        }
        bounds
    }
}
