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

        // Reduce three channels at a time, because images of full size need much memory. Parts that the photo does not
        // show count as 0, and so do pixels that are not usable, except in `seen`.
        let reduced = |[from, to]: [f64; 2], value: &dyn Fn(usize) -> [f32; 3]| {
            let mut full = Image::new(image.width, image.height, 3)?;
            for (i, pixel) in full.data.chunks_exact_mut(3).enumerate().filter(|(i, _)| shown[*i]) {
                pixel.copy_from_slice(&value(i));
            }
            pyramid::resize(&full, width, height, job.part(from, to))
        };
        let pixel = |i: usize| image.rgb(i % image.width, i / image.width);
        let is_lit = |i: usize| components.labels[i] != 0;
        let is_source = |i: usize| shown[i] && usable[i] && is_lit(i);
        let lit = (0..shown.len()).filter(|&i| is_source(i));
        let brightest = lit.map(|i| pixel(i).max_element()).fold(0.0, f32::max);
        let scale = if brightest > 0.0 { 1.0 / brightest } else { 0.0 };

        // The last channel of `light` is the share of a working pixel that is usable. The first channel of `seen` is
        // the share that the photo shows. A working pixel is usable if all of its full-size pixels are usable. If no
        // working pixel is usable, work at full size.
        let light = reduced([0.0, 0.3], &|i| match usable[i] {
            true => [light.data[i].clamp(0.0, 1.0), f32::from(is_lit(i)), 1.0],
            false => [0.0; 3],
        })?;
        let channel = |of: &Image, c: usize| try_collect(of.data.iter().skip(c).step_by(3).copied());
        let all = |of: &Image, c: usize| try_collect(of.data.iter().skip(c).step_by(3).map(|&v| v > 1.0 - 1e-4));
        let usable = all(&light, 2)?;
        if !usable.contains(&true) && side < longest {
            return Self::new(sources, longest, job);
        }
        let (confidence, coverage) = (channel(&light, 0)?, channel(&light, 1)?);
        let seen = reduced([0.3, 0.6], &|i| [1.0, f32::from(is_lit(i)), luminance(pixel(i))])?;
        let (shown_coverage, luminance) = (channel(&seen, 1)?, channel(&seen, 2)?);
        let mut colour = reduced([0.6, 1.0], &|i| if is_source(i) { pixel(i).to_array() } else { [0.0; 3] })?;
        colour.data.iter_mut().for_each(|v| *v *= scale);
        let shown = all(&seen, 0)?;
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
