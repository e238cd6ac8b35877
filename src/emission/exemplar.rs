//! The exemplar: what of the unwarped image may be used, its lamps, and its reduced size for the synthesis.

use super::Input;
use super::components::{self, Component, Components};
use super::statistics::{Pattern, Statistics};
use crate::error::{Error, Result};
use crate::geometry::Homography;
use crate::image::{Image, pyramid, try_collect, try_vec};
use crate::job::Job;
use glam::DVec2;

/// Confidence from which a pixel is light.
pub const LIT: f32 = 0.5;

/// Pixels of the photo that a lamp covers at least, unless no light covers more.
const LEAST_LAMP: f64 = 9.0;

/// A lamp cut off by the border is one like a whole lamp if it is at most this much longer and wider.
const CUT_LAMP_SLACK: f64 = 1.35;
/// A lamp may touch the border with this share of its width and be whole: masks fray. A border that cuts it off meets all of its
/// width; one that meets so much of it takes a twentieth of a round lamp.
const WHOLE_CONTACT: f64 = 0.6;
/// Share of what is shown along a line through a lamp that it must cover to run through.
const RUNS_THROUGH: f64 = 0.97;

pub struct Exemplar {
    pub width: usize,
    pub height: usize,
    /// Finite and on the plane.
    pub shown: Vec<bool>,
    pub components: Components,
    /// Which components are lamps that end inside the shown region.
    pub whole: Vec<bool>,
    /// Which components have pixels at the border of the image or of the shown region.
    pub touches: Vec<bool>,
    /// Which components are parts of such lamps that the border cuts off: these are not shown.
    pub cut: Vec<bool>,
    /// Which components move as one piece: the whole ones, and of others those that no whole one is like, as far as they are seen.
    pub piece: Vec<bool>,
    /// Pixels of the photo that show each component.
    pub photo_area: Vec<f64>,
    /// Share of the shown pixels that is lit.
    pub lit_share: f64,
    pub working: Working,
}

/// The exemplar at the size the synthesis works at.
pub struct Working {
    pub width: usize,
    pub height: usize,
    /// Unwarped pixels per working pixel, along x and y.
    pub pitch: DVec2,
    /// Linear RGB in lights, 0 elsewhere (Fig. 12c), relative to the brightest light.
    pub colour: Image,
    /// Confidence that a pixel is light.
    pub confidence: Vec<f32>,
    /// Share of a pixel that is light.
    pub coverage: Vec<f32>,
    /// May be used: shown, and not part of a lamp that the border cuts off while whole ones are there to take its place.
    pub usable: Vec<bool>,
    /// Shown, cut lamps and all, and the share that is light: what the pattern is read from.
    pub shown: Vec<bool>,
    pub shown_coverage: Vec<f32>,
}

impl Exemplar {
    pub fn new(input: &Input, working_side: f64, job: Job) -> Result<Self> {
        let Input { unwarped: image, light, valid, photo } = *input;
        let (width, height) = (image.width, image.height);

        // What is shown, and what of it is light.
        let mut shown = try_vec(width * height, false)?;
        let pixels = image.data.chunks_exact(image.channels).zip(&light.data).zip(&valid.data);
        for (out, ((colour, light), &valid)) in shown.iter_mut().zip(pixels) {
            *out = valid >= 0.5 && light.is_finite() && colour.iter().all(|c| c.is_finite());
        }
        let total = shown.iter().filter(|&&s| s).count();
        if total == 0 {
            return Err(Error::degenerate(
                "no pixel of the unwarped image is valid and finite: unwarp a part of the plane that the photo shows",
            ));
        }
        let mut components = components::find(width, height, |i| shown[i] && light.data[i] >= LIT)?;
        let mut photo_area = photo_areas(&components, photo.map(|p| p.1));
        if photo.is_some() {
            // What covers less of the photo than a lamp must: crumbs of the edges of others, or noise.
            let least = photo_area.iter().copied().fold(0.0, f64::max).min(LEAST_LAMP);
            components = components::find(width, height, |i| {
                components.labels[i].checked_sub(1).is_some_and(|k| photo_area[k as usize] >= least)
            })?;
            photo_area.retain(|&a| a >= least);
        }
        if components.list.is_empty() {
            return Err(Error::degenerate(
                "no light is marked: no valid pixel of `light` reaches 0.5; paint more of the lamps as light",
            ));
        }
        let lit = components.list.iter().map(|c| c.area).sum::<usize>();

        let contacts = contacts(&components, &shown, width, height);
        let touches = contacts.iter().map(|&n| n > 0).collect();
        let whole = find_whole(&components, &contacts);
        let cut = find_cut(&components, &whole);
        let piece = find_pieces(&components, &whole, &cut, &shown, width, height);
        let is_usable = |(&s, &l): (&bool, &u32)| s && (l == 0 || !cut[l as usize - 1]);
        let usable = try_collect(shown.iter().zip(&components.labels).map(is_usable))?;
        let sources = Sources { image, light, components: &components, usable: &usable, shown: &shown };
        let working = Working::new(&sources, working_side, job)?;
        let lit_share = lit as f64 / total as f64;
        Ok(Self { width, height, shown, components, whole, touches, cut, piece, photo_area, lit_share, working })
    }

    /// The statistics of the pattern of `unwarped`, in its pixels; `periods` as in [`Pattern`].
    pub fn statistics(&self, unwarped: &Image, periods: [Option<f64>; 2]) -> Statistics {
        // Lamps are what the texture may show as such.
        let Self { width, height, components, piece: whole, .. } = self;
        let colour = |i: usize| self.shown[i].then(|| unwarped.rgb(i % width, i / width));
        Statistics::of(&Pattern { width: *width, height: *height, components, whole, periods, colour })
    }

    /// How much of an unwarped pixel is light, as far as `light`, the confidence, tells: of components, and of what fades beside
    /// them. Nothing beyond the last pixel is.
    pub fn coverage(&self, light: &Image, pixel: usize) -> f32 {
        let is_light = self.components.labels.get(pixel).is_some_and(|label| *label != 0);
        match self.shown.get(pixel) {
            Some(true) if is_light || light.data[pixel] < LIT => light.data[pixel].clamp(0.0, 1.0),
            _ => 0.0,
        }
    }

    /// The lamps that are whole.
    pub fn lamps(&self) -> impl Iterator<Item = &Component> {
        self.components.list.iter().zip(&self.whole).filter(|(_, whole)| **whole).map(|(c, _)| c)
    }

    /// What moves as one piece.
    pub fn pieces(&self) -> impl Iterator<Item = (usize, &Component)> {
        self.components.list.iter().enumerate().filter(|(k, _)| self.piece[*k])
    }
}

/// The area of each component in the photo, to first order; without a photo, that in the unwarped image.
fn photo_areas(components: &Components, to_photo: Option<Homography>) -> Vec<f64> {
    let magnification = |at: DVec2| {
        to_photo.map_or(1.0, |h| {
            let p = |dx: f64, dy: f64| h.apply(at + DVec2::new(dx, dy));
            (p(0.5, 0.0) - p(-0.5, 0.0)).perp_dot(p(0.0, 0.5) - p(0.0, -0.5)).abs()
        })
    };
    components.list.iter().map(|c| c.area as f64 * magnification(c.centre)).collect()
}

/// How many pixels of each component lie at the border of the image or of the shown region.
pub fn contacts(components: &Components, shown: &[bool], width: usize, height: usize) -> Vec<usize> {
    let mut contacts = vec![0usize; components.list.len()];
    for (i, &label) in components.labels.iter().enumerate().filter(|(_, l)| **l != 0) {
        let (x, y) = (i % width, i / width);
        let inside = x > 0 && y > 0 && x + 1 < width && y + 1 < height;
        if !(inside && shown[i - 1] && shown[i + 1] && shown[i - width] && shown[i + width]) {
            contacts[label as usize - 1] += 1;
        }
    }
    contacts
}

/// A component is whole if hardly any of its pixels lies at a border.
pub fn find_whole(components: &Components, contacts: &[usize]) -> Vec<bool> {
    let is_whole = |(c, &n): (&Component, &usize)| {
        let [across, down] = c.size().map(|s| s as f64);
        n as f64 <= WHOLE_CONTACT * c.area as f64 / across.hypot(down)
    };
    components.list.iter().zip(contacts).map(is_whole).collect()
}

/// A component is part of a cut lamp if it is not whole, yet fits into one that is.
pub fn find_cut(components: &Components, whole: &[bool]) -> Vec<bool> {
    let sizes: Vec<[usize; 2]> =
        components.list.iter().zip(whole).filter(|(_, w)| **w).map(|(c, _)| c.size()).collect();
    let fits =
        |c: &Component| sizes.iter().any(|size| (0..2).all(|k| c.size()[k] as f64 <= size[k] as f64 * CUT_LAMP_SLACK));
    components.list.iter().zip(whole).map(|(c, &w)| !w && fits(c)).collect()
}

/// What is neither whole nor part of such a lamp is a piece as far as it is seen, unless it runs through all that is shown.
pub fn find_pieces(
    components: &Components,
    whole: &[bool],
    cut: &[bool],
    shown: &[bool],
    width: usize,
    height: usize,
) -> Vec<bool> {
    let runs_through = |c: &Component| {
        let (x, y) = ((c.centre.x as usize).min(width - 1), (c.centre.y as usize).min(height - 1));
        let row = (0..width).filter(|u| shown[y * width + u]).count();
        let column = (0..height).filter(|v| shown[v * width + x]).count();
        let [across, down] = c.size().map(|s| s as f64);
        across >= RUNS_THROUGH * row as f64 || down >= RUNS_THROUGH * column as f64
    };
    let is_piece = |((c, &whole), &cut): ((&Component, &bool), &bool)| whole || !cut && !runs_through(c);
    components.list.iter().zip(whole).zip(cut).map(is_piece).collect()
}

/// What the working size is made from.
struct Sources<'a> {
    image: &'a Image,
    light: &'a Image,
    components: &'a Components,
    usable: &'a [bool],
    shown: &'a [bool],
}

impl Working {
    fn new(sources: &Sources, side: f64, job: Job) -> Result<Self> {
        let &Sources { image, light, components, usable, shown } = sources;
        let longest = image.width.max(image.height) as f64;
        let reduce = |n: usize| ((n as f64 * (side / longest).min(1.0)).round() as usize).max(1);
        let (width, height) = (reduce(image.width), reduce(image.height));
        let pitch = DVec2::new(image.width as f64 / width as f64, image.height as f64 / height as f64);

        // Average colour, confidence, light and validity together; what is not usable counts for nothing.
        const CHANNELS: usize = 8;
        let mut full = Image::new(image.width, image.height, CHANNELS)?;
        let mut brightest = 0f32;
        for (i, pixel) in full.data.chunks_exact_mut(CHANNELS).enumerate().filter(|(i, _)| shown[*i]) {
            pixel[6] = 1.0;
            pixel[7] = f32::from(components.labels[i] != 0);
            if !usable[i] {
                continue;
            }
            let colour = image.rgb(i % image.width, i / image.width);
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

        // A working pixel is usable if all of it is. If that leaves none, only full size can show what there is.
        let all = |c: usize| try_collect(channel(c).map(|&v| v > 1.0 - 1e-4));
        let usable = all(5)?;
        if !usable.contains(&true) && side < longest {
            return Self::new(sources, longest, job);
        }
        let (shown, shown_coverage) = (all(6)?, try_collect(channel(7).copied())?);
        Ok(Self { width, height, pitch, colour, confidence, coverage, usable, shown, shown_coverage })
    }

    /// Whether half of a pixel is light.
    pub fn is_lit(&self, pixel: usize) -> bool {
        self.coverage[pixel] >= 0.5
    }

    /// The index of a pixel, if there is one.
    pub fn index(&self, x: i32, y: i32) -> Option<usize> {
        let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
        (x < self.width && y < self.height).then(|| y * self.width + x)
    }

    /// The smallest box `[x0, y0, x1, y1)` that holds every usable pixel.
    pub fn usable_box(&self) -> [usize; 4] {
        let mut bounds = [self.width, self.height, 0, 0];
        for (i, _) in self.usable.iter().enumerate().filter(|(_, u)| **u) {
            let (x, y) = (i % self.width, i / self.width);
            bounds = [bounds[0].min(x), bounds[1].min(y), bounds[2].max(x + 1), bounds[3].max(y + 1)];
        }
        bounds
    }
}

/// Sums over rectangles of a mask in constant time (Crow 1984).
pub struct AreaSums {
    width: usize,
    sums: Vec<u32>,
}

impl AreaSums {
    pub fn new(mask: impl Fn(usize) -> bool, width: usize, height: usize) -> Result<Self> {
        Self::of(|i| u32::from(mask(i)), width, height)
    }

    /// The same of whole numbers. Sums wrap, which does not matter where those of the rectangles asked for stay below 2³².
    pub fn of(value: impl Fn(usize) -> u32, width: usize, height: usize) -> Result<Self> {
        let stride = width + 1;
        let mut sums = try_vec(stride * (height + 1), 0u32)?;
        for y in 0..height {
            let mut row = 0u32;
            for x in 0..width {
                row = row.wrapping_add(value(y * width + x));
                sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1].wrapping_add(row);
            }
        }
        Ok(Self { width: stride, sums })
    }

    /// The number of set pixels, or the sum of the numbers, in `[x, x + w) × [y, y + h)`.
    pub fn count(&self, x: usize, y: usize, w: usize, h: usize) -> usize {
        let at = |x: usize, y: usize| self.sums[y * self.width + x];
        let rows = |x: usize| at(x, y + h).wrapping_sub(at(x, y));
        rows(x + w).wrapping_sub(rows(x)) as usize
    }
}
