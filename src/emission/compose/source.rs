//! Computes the colour of a texel from its source: the photo or, without a photo, the unwarped image.

use super::layer::Layer;
use super::lit_blocks::LightSet;
use super::resample;
use crate::emission::exemplar::LIT;
use crate::emission::exemplar::roles::Role;
use crate::emission::params::Input;
use crate::error::Result;
use crate::job::Job;
use glam::{DVec2, DVec3, Vec3, Vec4};

/// Range of the number of samples along each side of a texel that is larger than an unwarped pixel. With fewer than
/// `MIN_SAMPLES`, an edge of the light could not be located to within an eighth of the texel's side. [rounding]
const MIN_SAMPLES: f64 = 4.0;
const MAX_SAMPLES: f64 = 16.0;
/// Samples are interpolated if their spacing is at most this number of unwarped pixels. The limit is below 1 by more
/// than rounding errors, so that samples at a spacing of exactly 1 are never interpolated. [rounding]
const MAX_MAGNIFIED_SPACING: f64 = 0.999;

/// Computes the mean colour of every component of the exemplar.
pub fn mean_colours(layer: &Layer, input: &Input, job: Job) -> Result<Vec<Vec3>> {
    let source = TexelSource { layer, input };
    let exemplar = &layer.exemplar;
    let mut sums = vec![DVec3::ZERO; exemplar.components.list.len()];
    for y in 0..exemplar.height {
        job.check()?;
        for x in 0..exemplar.width {
            let label = exemplar.components.labels[y * exemplar.width + x];
            if label != 0 {
                let centre = DVec2::new(x as f64, y as f64) + 0.5;
                let unwarped = || source.unclipped(label, input.unwarped.rgb(x, y));
                sums[label as usize - 1] += source.from_photo(centre, 1.0, label).unwrap_or_else(unwarped).as_dvec3();
            }
        }
    }
    Ok(sums.iter().zip(&exemplar.components.list).map(|(sum, lamp)| (*sum / lamp.area as f64).as_vec3()).collect())
}

/// The colours of a lamp that is drawn from a design come from the inner part of the lamp in the photo. The photo blurs
/// the rim of the lamp, so the rim is left out. `RIM`: width of the rim in photo pixels. `MIN_INNER`: minimum side of
/// the inner part, as a share of the lamp's side. [judged on 20 photos]
const RIM: f64 = 1.5;
const MIN_INNER: f64 = 0.5;

/// The contribution of one lamp, or of a group of lights, to a texel. The colour is already multiplied by the lit share
/// of the texel.
#[derive(Clone, Copy)]
pub struct Texel {
    pub colour: Vec3,
    /// `share` is the share of the texel's samples that are light; `coverage` is the mean confidence of the samples.
    /// Both measure the lit part of the texel; `coverage` has finer steps.
    pub share: f32,
    pub coverage: f32,
}

/// A layer, and the images from which its texels are taken.
#[derive(Clone, Copy)]
pub struct TexelSource<'a> {
    pub layer: &'a Layer,
    pub input: &'a Input<'a>,
}

impl TexelSource<'_> {
    /// The shift of the patch at a texel's centre: position in the texture minus position in the exemplar, in unwarped
    /// pixels. `None` if there is no patch.
    pub fn shift_at(&self, x: usize, y: usize) -> Option<DVec2> {
        let Layer { patch_map, exemplar, scale, .. } = self.layer;
        let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * *scale / exemplar.working.pitch;
        let (u, v) = ((p.x as usize).min(patch_map.width - 1), (p.y as usize).min(patch_map.height - 1));
        patch_map.shift(u, v).map(|s| s.exact)
    }

    /// Whether a light of the set may lie in the part of the exemplar that a texel shows. Always true if the layer has
    /// no map of the lit blocks.
    pub fn may_show(&self, set: LightSet, x: usize, y: usize, shift: DVec2) -> bool {
        let blocks = self.layer.lit_blocks.as_ref();
        blocks.is_none_or(|blocks| blocks.may_reach(set, self.corner(x, y, shift), self.layer.scale))
    }

    /// A texel shows a square of the exemplar. Returns the corner of this square with the smallest coordinates, in
    /// unwarped pixels.
    fn corner(&self, x: usize, y: usize, shift: DVec2) -> DVec2 {
        DVec2::new(x as f64, y as f64) * self.layer.scale - self.layer.rounded(shift)
    }

    /// The colour and coverage that the exemplar, moved by `shift`, gives to the texel (x, y), averaged over samples.
    /// Only components for whose label `is_shown` returns true count as light.
    pub fn texel(&self, x: usize, y: usize, shift: DVec2, is_shown: impl Fn(u32) -> bool) -> Texel {
        let scale = self.layer.scale;
        let n = if scale > 1.0 { scale.ceil().clamp(MIN_SAMPLES, MAX_SAMPLES) } else { 1.0 };
        let spacing = scale / n;
        let corner = self.corner(x, y, shift);
        let is_magnified = spacing <= MAX_MAGNIFIED_SPACING;
        let samples = (0..(n * n) as usize).map(|i| {
            let step = DVec2::new((i % n as usize) as f64 + 0.5, (i / n as usize) as f64 + 0.5);
            let p = corner + step * spacing;
            (p, self.taps(p, !is_magnified))
        });
        let is_light = |taps: &[(usize, f32); 4], light: f32| match is_magnified {
            true => light >= LIT,
            false => self.is_light(taps[0].0, &is_shown),
        };
        let light = |taps: &[(usize, f32); 4]| taps.iter().map(|&(pixel, w)| w * self.light(pixel, &is_shown)).sum();

        // Measure the lit share of the texel.
        let (mut inside, mut coverage) = (0, 0f32);
        for (_, taps) in samples.clone() {
            let light = light(&taps);
            coverage += light;
            inside += usize::from(is_light(&taps, light));
        }
        let count = (n * n) as f32;
        let (share, coverage) = (inside as f32 / count, coverage / count);

        // Average the colour over the texel. If all of the texel is light, read the colour of its whole square.
        // Otherwise average over the samples, and count unlit samples as black.
        let colour = |p: DVec2, side: f64, taps: [(usize, f32); 4]| {
            let lamp = taps.iter().map(|&(pixel, _)| self.label(pixel)).find(|&label| is_shown(label));
            match (&self.layer.even, lamp) {
                (Some(means), Some(label)) if label != 0 => means[label as usize - 1],
                _ => self.colour(p, side, &taps, lamp, &is_shown),
            }
        };
        let colour = if share == 1.0 {
            let centre = corner + scale / 2.0;
            colour(centre, scale, self.taps(centre, !is_magnified))
        } else {
            let lit = samples.filter(|(_, taps)| is_light(taps, light(taps)));
            lit.map(|(p, taps)| colour(p, spacing, taps)).sum::<Vec3>() / count
        };
        Texel { colour, share, coverage }
    }

    /// The colour and coverage of a texel of a lamp that is drawn from its design; `None` if the component has no
    /// design. `shift` is the lamp's position in the texture minus its position in the exemplar.
    pub fn designed_texel(&self, x: usize, y: usize, shift: DVec2, component: usize) -> Option<Texel> {
        let (design, fitted) = self.layer.designs.of(component)?;
        let scale = self.layer.scale;
        let at = (DVec2::new(x as f64, y as f64) + 0.5) * scale - self.layer.rounded(shift) - fitted.centre;
        let share = design.coverage(at, scale) as f32;
        if share <= 0.0 {
            return Some(Texel { colour: Vec3::ZERO, share: 0.0, coverage: 0.0 });
        }
        // Read the colour at the corresponding point of the lamp in the photo. The whole design is mapped onto the
        // inner part of the lamp in the photo, because bloom enlarges that lamp and blurs its rim. The band of a ring
        // is mapped onto its middle line, whose place bloom does not change.
        let axes = [design.axis, design.axis.perp()];
        let inner = (fitted.size - RIM * 2.0 * fitted.photo_pixel).max(fitted.size * MIN_INNER) / design.size;
        let half = design.size / 2.0;
        let local = DVec2::new(at.dot(axes[0]), at.dot(axes[1])).clamp(-half, half);
        let local = if design.hole == DVec2::ZERO { local * inner } else { design.middle_of_band(local) };
        let p = self.shown_point(component, fitted.centre + axes[0] * local.x + axes[1] * local.y);
        let label = component as u32 + 1;
        let colour = match &self.layer.even {
            Some(means) => means[component],
            None => self.colour(p, scale, &self.taps(p, true), Some(label), &|l| l == label),
        };
        Some(Texel { colour: colour * share, share, coverage: share })
    }

    /// The point of the exemplar at which the colour of a designed lamp is read in place of the point `p`. The result
    /// is `p`, unless the border of the photo cuts the lamp and hides `p`. In that case, the result is the first
    /// visible point of the lamp on the way from `p` to the centre of the visible part.
    fn shown_point(&self, component: usize, p: DVec2) -> DVec2 {
        let exemplar = &self.layer.exemplar;
        if exemplar.roles[component] != Role::Partial {
            return p;
        }
        let centre = exemplar.components.list[component].centre;
        let is_lamp = |q: &DVec2| self.label(self.taps(*q, true)[0].0) == component as u32 + 1;
        let steps = (centre - p).length().ceil().max(1.0);
        let way = (0..=steps as usize).map(|n| p.lerp(centre, n as f64 / steps));
        way.into_iter().find(is_lamp).unwrap_or(centre)
    }

    /// The mean colour of the light over a square with the centre `p`, from the photo. Where the photo does not show
    /// the square, the unwarped image is interpolated at `p` instead, between the pixels of `taps` whose label
    /// `is_shown` selects. `lamp` is the label of the component at `p`, whose clipped colours are replaced.
    fn colour(
        &self,
        p: DVec2,
        side: f64,
        taps: &[(usize, f32); 4],
        lamp: Option<u32>,
        is_shown: &impl Fn(u32) -> bool,
    ) -> Vec3 {
        let label = lamp.unwrap_or(0);
        self.from_photo(p, side, label).unwrap_or_else(|| {
            // Interpolate between lit pixels only, so that no dark pixel mixes with light.
            let unwarped = self.input.unwarped;
            let lit = taps.iter().filter(|t| t.1 > 0.0 && is_shown(self.label(t.0)));
            let sum: Vec4 =
                lit.map(|&(i, w)| (unwarped.rgb(i % unwarped.width, i / unwarped.width) * w).extend(w)).sum();
            self.unclipped(label, sum.truncate() / sum.w.max(f32::MIN_POSITIVE))
        })
    }

    /// Replaces clipped channels of `value`, a colour of the component with the given label, by channels of the colour
    /// of this component's rim. Returns `value` unchanged if the component has no rim colour.
    fn unclipped(&self, label: u32, value: Vec3) -> Vec3 {
        match (&self.layer.rim_colours, label.checked_sub(1)) {
            (Some(rim_colours), Some(component)) => rim_colours.undo(component as usize, value),
            _ => value,
        }
    }

    /// Label of an unwarped pixel; 0 for `usize::MAX`, which stands for no pixel.
    fn label(&self, pixel: usize) -> u32 {
        self.layer.exemplar.components.labels.get(pixel).copied().unwrap_or(0)
    }

    /// Whether an unwarped pixel belongs to a component for which `is_shown` is true.
    fn is_light(&self, pixel: usize, is_shown: &impl Fn(u32) -> bool) -> bool {
        let label = self.label(pixel);
        label != 0 && is_shown(label)
    }

    /// The share of an unwarped pixel that is covered by components for whose label `is_shown` returns true. Beside a
    /// lamp, the confidence fades out over pixels that belong to no component. These pixels count whatever `is_shown`
    /// selects.
    fn light(&self, pixel: usize, is_shown: &impl Fn(u32) -> bool) -> f32 {
        let label = self.label(pixel);
        if label != 0 && !is_shown(label) { 0.0 } else { self.layer.exemplar.coverage(self.input.light, pixel) }
    }

    /// Pixel indices and weights for bilinear interpolation at the point `p`. With `nearest`, only the pixel that
    /// contains `p`. The index `usize::MAX` stands for no pixel.
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

    /// The photo's mean colour over a square of the unwarped image, given by its centre `p` and side, with the clipped
    /// channels of component `label` replaced. `None` without a photo, and if the photo does not show the square.
    fn from_photo(&self, p: DVec2, side: f64, label: u32) -> Option<Vec3> {
        let (photo, to_photo) = self.input.photo?;
        let levels = resample::Levels { photo, smaller: &self.layer.smaller_photos };
        levels.mean(&to_photo, p, side, |colour| self.unclipped(label, colour))
    }
}
