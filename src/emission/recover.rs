//! Full detail: every lamp and every patch is copied again from the finest source there is ("Lighting Style Transfer", §6, Fig. 12h).
//!
//! A texel looks up its shift, undoes it, and arrives in the unwarped image; from there the homography leads into the photo,
//! where the area the texel covers is averaged. What is light is decided in the unwarped image: where it is magnified, by its
//! confidence between pixels, so that outlines are no staircases; where it is reduced, by share of area.

use super::Input;
use super::exemplar::LIT;
use super::lamps::Instance;
use super::period::Continuation;
use super::photo;
use super::plan::{Layer, Plan, Tile};
use crate::error::Result;
use crate::image::{Image, try_vec};
use crate::job::Job;
use glam::{DVec2, DVec3, Vec3, Vec4};
use rayon::prelude::*;

/// Least and most samples along each side of a texel that is larger than an unwarped pixel. Fewer would not tell where half of it is
/// light to an eighth of its side.
const LEAST_SAMPLES: f64 = 4.0;
const MOST_SAMPLES: f64 = 16.0;
/// The most that is not half.
const LESS_THAN_HALF: f32 = 0.5 - f32::EPSILON;
/// Rows of texels that share one list of lamps.
const BAND: usize = 16;

/// Which lamps may touch each band of rows, and their texels: index, then `[x0, y0, x1, y1)`.
#[derive(Default)]
pub struct Bands(Vec<Vec<(u32, [u32; 4])>>);

impl Bands {
    pub fn new(layer: &Layer, width: usize, height: usize) -> Self {
        let mut bands = vec![Vec::new(); height.div_ceil(BAND)];
        for (i, instance) in layer.instances.iter().enumerate() {
            if let Some(range) = texels(layer, instance, width, height) {
                let rows = range[1] / BAND..=(range[3] - 1) / BAND;
                bands[rows].iter_mut().for_each(|b: &mut Vec<_>| b.push((i as u32, range.map(|r| r as u32))));
            }
        }
        Self(bands)
    }
}

/// Which lights of a plan are rendered.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Lights {
    All,
    /// Those that follow the patches pixel by pixel, where the texture is no copy of a part of the exemplar.
    OfPatches,
}

/// A tile of the texture, and how much of each texel is light: of its mask from 0.5 on, of others less.
pub fn run(plan: &Plan, sources: &[Source], tile: Tile, lights: Lights, job: Job) -> Result<(Image, Image)> {
    let Tile { width, height, .. } = tile;
    let mut texture = Image::new(width, height, 3)?;
    let mut mask = Image::new(width, height, 1)?;
    let rows = texture.data.par_chunks_exact_mut(3 * width).zip(mask.data.par_chunks_exact_mut(width)).enumerate();
    rows.try_for_each(|(row, (colours, coverage))| {
        job.check()?;
        let y = tile.y + row;
        let mut shares = try_vec(width, 0f32)?;
        let mut add = |x: usize, shown: Texel| {
            let at = x - tile.x;
            coverage[at] += shown.coverage;
            if shown.share > 0.0 {
                shares[at] += shown.share;
                colours[3 * at..3 * at + 3].iter_mut().zip(shown.colour.to_array()).for_each(|(o, c)| *o += c);
            }
        };
        for (k, source) in sources.iter().enumerate() {
            let layer = source.layer;
            for &(i, range) in layer.bands.0[y / BAND].iter().filter(|_| lights == Lights::All) {
                let [x0, y0, x1, y1] = range.map(|r| r as usize);
                if (y0..y1).contains(&y) {
                    let Instance { component, shift } = layer.instances[i as usize];
                    let columns = x0.max(tile.x)..x1.min(tile.x + width);
                    columns.for_each(|x| add(x, source.texel(x, y, shift, |label| label == component as u32 + 1)));
                }
            }
            let has_more = match lights {
                Lights::All => layer.by_pixel.contains(&true),
                Lights::OfPatches => layer.follows_patches(),
            };
            if !has_more {
                continue;
            }
            for x in tile.x..tile.x + width {
                let at = (DVec2::new(x as f64, y as f64) + 0.5) / DVec2::new(plan.width as f64, plan.height as f64);
                let weight = plan.weights.at(k, at);
                if let Some(shift) = source.shift_at(x, y).filter(|_| weight > 0.0) {
                    let is_shown = |label: u32| label != 0 && layer.by_pixel[label as usize - 1];
                    let shown = source.texel(x, y, shift, is_shown);
                    add(x, Texel { colour: shown.colour * weight, ..shown });
                }
            }
        }
        for (coverage, share) in coverage.iter_mut().zip(shares) {
            *coverage = if share >= 0.5 { coverage.clamp(0.5, 1.0) } else { coverage.min(LESS_THAN_HALF) };
        }
        Ok(())
    })?;
    job.report(1.0);
    Ok((texture, mask))
}

/// The mask of what is at least half light, in its place.
pub fn threshold(coverage: &mut Image) {
    coverage.data.iter_mut().for_each(|c| *c = f32::from(*c >= 0.5));
}

/// The mean colour of every component of the exemplar.
pub fn mean_colours(layer: &Layer, input: &Input, job: Job) -> Result<Vec<Vec3>> {
    let source = Source { layer, input };
    let exemplar = &layer.exemplar;
    let mut sums = vec![DVec3::ZERO; exemplar.components.list.len()];
    for y in 0..exemplar.height {
        job.check()?;
        for x in 0..exemplar.width {
            let label = exemplar.components.labels[y * exemplar.width + x];
            if label != 0 {
                let centre = DVec2::new(x as f64, y as f64) + 0.5;
                let value = source.from_photo(centre, 1.0).unwrap_or_else(|| input.unwarped.rgb(x, y));
                sums[label as usize - 1] += source.unclipped(label, value).as_dvec3();
            }
        }
    }
    Ok(sums.iter().zip(&exemplar.components.list).map(|(sum, lamp)| (*sum / lamp.area as f64).as_vec3()).collect())
}

/// The texels `[x0, y0, x1, y1)` a lamp may touch.
fn texels(layer: &Layer, instance: &Instance, width: usize, height: usize) -> Option<[usize; 4]> {
    let lamp = &layer.exemplar.components.list[instance.component];
    let shift = layer.rounded(instance.shift);
    let point = |p: [usize; 2]| DVec2::new(p[0] as f64, p[1] as f64);
    let low = ((point(lamp.min) + shift) / layer.scale).floor() - 1.0;
    let high = ((point(lamp.max) + 1.0 + shift) / layer.scale).ceil() + 1.0;
    let low = low.max(DVec2::ZERO);
    let high = high.min(point([width, height]));
    (low.x < high.x && low.y < high.y).then(|| [low.x as usize, low.y as usize, high.x as usize, high.y as usize])
}

impl Layer {
    /// Whether some of its lights are shown as the patches have them, in another order than the exemplar's.
    pub fn follows_patches(&self) -> bool {
        self.by_pixel.contains(&true) && self.continuation != Continuation::Copy
    }

    /// Shifts become whole pixels where pixels are copied one to one, so that copies are exact.
    pub fn rounded(&self, shift: DVec2) -> DVec2 {
        if self.scale == 1.0 { shift.round() } else { shift }
    }
}

/// What a texel shows of some lights.
#[derive(Clone, Copy)]
struct Texel {
    colour: Vec3,
    /// Share of its samples that are light, and mean confidence that they are: the same but for the finer steps of this.
    share: f32,
    coverage: f32,
}

/// What is shown, and the images it is taken from.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    pub layer: &'a Layer,
    pub input: &'a Input<'a>,
}

impl Source<'_> {
    /// The shift of the patch that shows a texel's centre.
    fn shift_at(&self, x: usize, y: usize) -> Option<DVec2> {
        let Layer { layout, exemplar, scale, .. } = self.layer;
        let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * *scale / exemplar.working.pitch;
        let (u, v) = ((p.x as usize).min(layout.width - 1), (p.y as usize).min(layout.height - 1));
        layout.shift(u, v).map(|s| s.exact)
    }

    /// The light of the components that `is_shown` names by label, averaged over a texel.
    fn texel(&self, x: usize, y: usize, shift: DVec2, is_shown: impl Fn(u32) -> bool) -> Texel {
        let scale = self.layer.scale;
        let n = if scale > 1.0 { scale.ceil().clamp(LEAST_SAMPLES, MOST_SAMPLES) } else { 1.0 };
        let spacing = scale / n;
        let corner = DVec2::new(x as f64, y as f64) * scale - self.layer.rounded(shift);
        let (mut colour, mut inside, mut coverage) = (Vec3::ZERO, 0u32, 0f32);
        for i in 0..(n * n) as usize {
            let step = DVec2::new((i % n as usize) as f64 + 0.5, (i / n as usize) as f64 + 0.5);
            let p = corner + step * spacing;
            let is_magnified = spacing <= 0.999;
            let taps = self.taps(p, !is_magnified);
            let light: f32 = taps.iter().map(|&(pixel, w)| w * self.light(pixel, &is_shown)).sum();
            coverage += light;
            let is_light = if is_magnified { light >= LIT } else { self.is_light(taps[0].0, &is_shown) };
            if is_light {
                inside += 1;
                let lamp = taps.iter().map(|&(pixel, _)| self.label(pixel)).find(|&label| is_shown(label));
                colour += match (&self.layer.even, lamp) {
                    (Some(means), Some(label)) if label != 0 => means[label as usize - 1],
                    _ => self.colour(p, spacing, &taps, lamp, &is_shown),
                };
            }
        }
        let samples = (n * n) as f32;
        Texel { colour: colour / samples, share: inside as f32 / samples, coverage: coverage / samples }
    }

    /// The light at a point, from the finest source there is.
    fn colour(
        &self,
        p: DVec2,
        side: f64,
        taps: &[(usize, f32); 4],
        lamp: Option<u32>,
        is_shown: &impl Fn(u32) -> bool,
    ) -> Vec3 {
        let value = self.from_photo(p, side).unwrap_or_else(|| {
            // Only light mixes with light.
            let unwarped = self.input.unwarped;
            let lit = taps.iter().filter(|t| t.1 > 0.0 && is_shown(self.label(t.0)));
            let sum: Vec4 =
                lit.map(|&(i, w)| (unwarped.rgb(i % unwarped.width, i / unwarped.width) * w).extend(w)).sum();
            sum.truncate() / sum.w.max(f32::MIN_POSITIVE)
        });
        self.unclipped(lamp.unwrap_or(0), value)
    }

    /// The light of a component where the photo shows `value`.
    fn unclipped(&self, label: u32, value: Vec3) -> Vec3 {
        match (&self.layer.clipping, label.checked_sub(1)) {
            (Some(clipping), Some(component)) => clipping.undo(component as usize, value),
            _ => value,
        }
    }

    /// Label of an unwarped pixel; `usize::MAX` is none.
    fn label(&self, pixel: usize) -> u32 {
        self.layer.exemplar.components.labels.get(pixel).copied().unwrap_or(0)
    }

    /// Whether an unwarped pixel is of the light that is shown.
    fn is_light(&self, pixel: usize, is_shown: &impl Fn(u32) -> bool) -> bool {
        let label = self.label(pixel);
        label != 0 && is_shown(label)
    }

    /// How much an unwarped pixel is. Beside a lamp confidence fades away; where it is none of a lamp's, it is nobody's.
    fn light(&self, pixel: usize, is_shown: &impl Fn(u32) -> bool) -> f32 {
        let label = self.label(pixel);
        if label != 0 && !is_shown(label) { 0.0 } else { self.layer.exemplar.coverage(self.input.light, pixel) }
    }

    /// Pixels and weights of a bilinear look-up, or of the pixel a point lies in.
    fn taps(&self, p: DVec2, nearest: bool) -> [(usize, f32); 4] {
        let (width, height) = (self.layer.exemplar.width, self.layer.exemplar.height);
        let at = |x: f64, y: f64| {
            let inside = x >= 0.0 && y >= 0.0 && x < width as f64 && y < height as f64;
            if inside { y as usize * width + x as usize } else { usize::MAX }
        };
        if nearest {
            return [(at(p.x, p.y), 1.0), (usize::MAX, 0.0), (usize::MAX, 0.0), (usize::MAX, 0.0)];
        }
        let low = (p - 0.5).floor();
        let t = (p - 0.5 - low).as_vec2();
        [
            (at(low.x, low.y), (1.0 - t.x) * (1.0 - t.y)),
            (at(low.x + 1.0, low.y), t.x * (1.0 - t.y)),
            (at(low.x, low.y + 1.0), (1.0 - t.x) * t.y),
            (at(low.x + 1.0, low.y + 1.0), t.x * t.y),
        ]
    }

    /// The photo's colour at a point of the unwarped image, averaged over a square of the given side there.
    fn from_photo(&self, p: DVec2, side: f64) -> Option<Vec3> {
        let (photo, to_photo) = self.input.photo?;
        photo::mean(photo, &to_photo, p, side)
    }
}
