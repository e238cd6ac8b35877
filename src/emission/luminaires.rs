//! The lamps of the texture as a list: what lighting software wants besides pixels.

use super::components::{self, Component, Components};
use super::outline::Ring;
use super::{Luminaire, kinds};
use crate::error::Result;
use crate::image::colour::luminance;
use crate::image::{Image, try_vec};
use crate::job::Job;
use glam::{DVec2, DVec3, Vec3};

/// Steps to the texels around one.
const AROUND: [[isize; 2]; 8] = [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

/// How long a piece of light may be, in texels, to be a crumb of that area.
pub fn reach(crumb: f64) -> usize {
    (2.0 * crumb.sqrt()).ceil() as usize
}

/// Takes out every connected piece of light smaller than `crumb` texels, and compact: no longer than the [`reach`] of one. Those
/// that `is_cut` says of by their first and last texel are the rest of something larger.
pub fn sweep(
    texture: &mut Image,
    mask: &mut Image,
    found: &mut Components,
    crumb: f64,
    is_cut: impl Fn([usize; 2], [usize; 2]) -> bool,
) {
    let reach = reach(crumb);
    let is_crumb = |piece: &Component| {
        let is_small = (piece.area as f64) < crumb && piece.size().into_iter().all(|s| s <= reach);
        is_small && !is_cut(piece.min, piece.max)
    };
    let crumbs: Vec<bool> = found.list.iter().map(is_crumb).collect();
    if crumbs.contains(&true) {
        take_out(texture, mask, found, |k, _| crumbs[k]);
        found.remove(|k| crumbs[k]);
    }
}

/// Takes out the texels of lamps that `goes` names by lamp and texel, and rims whose lamps all go: texels less than half of
/// which is light, which the mask leaves out.
pub fn take_out(texture: &mut Image, mask: &mut Image, found: &Components, goes: impl Fn(usize, usize) -> bool) {
    let (width, height) = (mask.width, mask.height);
    let lamp = |i: usize| (found.labels[i] as usize).checked_sub(1);
    for i in 0..width * height {
        let is_out = match lamp(i) {
            Some(k) => goes(k, i),
            None if texture.data[3 * i..3 * i + 3] == [0.0; 3] => false,
            None => {
                let (x, y) = (i % width, i / width);
                let columns = x.saturating_sub(1)..(x + 2).min(width);
                let rows = y.saturating_sub(1)..(y + 2).min(height);
                let mut near =
                    rows.flat_map(|v| columns.clone().map(move |u| v * width + u)).filter_map(|j| Some((lamp(j)?, j)));
                let first = near.next();
                first.into_iter().chain(near).all(|(k, j)| goes(k, j)) && first.is_some()
            }
        };
        if is_out {
            texture.data[3 * i..3 * i + 3].fill(0.0);
            mask.data[i] = 0.0;
        }
    }
}

/// The connected components of a mask, or of what is at least half light.
pub fn components(mask: &Image) -> Result<Components> {
    components::find(mask.width, mask.height, |i| mask.data[i] >= 0.5)
}

/// How much of each texel is light: of lamps from 0.5 on, of others less.
pub type Coverage<'a> = &'a dyn Fn(usize) -> f32;

/// One luminaire for each connected component of the lights, in the order of their first texel.
pub fn find(texture: &Image, found: &Components, coverage: Coverage, job: Job) -> Result<Vec<Luminaire>> {
    let total = texture.data.chunks_exact(3).map(|p| f64::from(luminance(Vec3::from_slice(p)))).sum::<f64>();
    let lights = Lights::new(found, coverage, texture.width, texture.height)?;
    let lamps: Result<Vec<Luminaire>> = (1..)
        .zip(&found.list)
        .map(|(label, lamp)| {
            job.check()?;
            Ok(measure(label, lamp, texture, total, &lights))
        })
        .collect();
    let mut lamps = lamps?;
    tell_kinds(&mut lamps, texture);
    Ok(lamps)
}

/// Tells the kinds of the lamps of a texture.
pub fn tell_kinds(lamps: &mut [Luminaire], texture: &Image) {
    let size = DVec2::new(texture.width as f64, texture.height as f64);
    kinds::tell(lamps.iter_mut().map(|lamp| {
        let count = usize::from(lamp.is_within(size));
        (lamp, count)
    }));
}

/// Which texels are light, and how much of each.
pub struct Lights<'a> {
    width: usize,
    height: usize,
    /// 0 or the number of the lamp.
    labels: &'a [u32],
    coverage: Coverage<'a>,
    /// The most of each lamp by its number, which is taken for all of a texel: a confidence need not reach 1.
    full: Vec<f32>,
}

impl<'a> Lights<'a> {
    pub fn new(found: &'a Components, coverage: Coverage<'a>, width: usize, height: usize) -> Result<Self> {
        let mut full = try_vec(found.list.len() + 1, 0f32)?;
        for (i, &label) in found.labels.iter().enumerate().filter(|(_, label)| **label != 0) {
            full[label as usize] = full[label as usize].max(coverage(i));
        }
        Ok(Self { width, height, labels: &found.labels, coverage, full })
    }

    fn index(&self, [x, y]: [isize; 2]) -> Option<usize> {
        let inside = x >= 0 && y >= 0 && x < self.width as isize && y < self.height as isize;
        inside.then(|| y as usize * self.width + x as usize)
    }

    /// The number of a texel's lamp, or 0; nothing beyond the texture.
    fn label(&self, at: [isize; 2]) -> Option<u32> {
        self.index(at).map(|i| self.labels[i])
    }

    /// How much of a texel is light; nothing beyond the texture.
    fn coverage(&self, at: [isize; 2]) -> Option<f64> {
        let i = self.index(at)?;
        let around = AROUND.iter().filter_map(|[u, v]| self.label([at[0] + u, at[1] + v]));
        let full = match self.labels[i] {
            0 => around.map(|label| self.full[label as usize]).fold(0.0, f32::max),
            label => self.full[label as usize],
        };
        let share = f64::from((self.coverage)(i)) / f64::from(if full > 0.0 { full } else { 1.0 });
        Some(if self.labels[i] != 0 { share.clamp(0.5, 1.0) } else { share.clamp(0.0, 0.5) })
    }

    /// What a texel of a lamp adds to it, as steps from it and areas: itself, whole if it lies deep in the lamp; and at the edge its
    /// part of those around it that are less than half light.
    pub fn parts(&self, at: [isize; 2], mut add: impl FnMut([isize; 2], f64)) {
        let is_dark = |at: [isize; 2]| self.label(at) == Some(0);
        let step = |by: [isize; 2], from: [isize; 2]| [from[0] + by[0], from[1] + by[1]];
        if !AROUND.iter().any(|&by| is_dark(step(by, at))) {
            return add([0; 2], 1.0);
        }
        add([0; 2], self.sharpened(at));
        for by in AROUND {
            let rim = step(by, at);
            let share = if is_dark(rim) { self.sharpened(rim) } else { 0.0 };
            if share > 0.0 {
                let lit = AROUND.iter().filter(|&&by| self.label(step(by, rim)).is_some_and(|l| l != 0)).count();
                add(by, share / lit as f64);
            }
        }
    }

    /// How much of a texel at the edge is light. Where coverage takes more than two texels from none to all it is blurred: there it
    /// tells the distance from the edge.
    fn sharpened(&self, at: [isize; 2]) -> f64 {
        let coverage = self.coverage(at).unwrap_or(0.0);
        let is_lit = self.label(at) != Some(0);
        let beside = [[-1, 0], [1, 0], [0, -1], [0, 1]].map(|[u, v]| [at[0] + u, at[1] + v]);
        let across = beside.into_iter().filter(|&to| (self.label(to) != Some(0)) != is_lit);
        let steps = across.filter_map(|to| self.coverage(to)).map(|other| (coverage - other).abs());
        match steps.fold(0.0, f64::max) {
            step if step > 0.0 && step < 0.5 => (0.5 + (coverage - 0.5) / step).clamp(0.0, 1.0),
            _ => coverage,
        }
    }
}

fn measure(label: u32, lamp: &Component, texture: &Image, total: f64, lights: &Lights) -> Luminaire {
    let [low, high] = [lamp.min, lamp.max].map(|p| p.map(|v| v as isize));
    let is_in = |at: [isize; 2]| lights.label(at) == Some(label);

    // Area and moments of what is light, its edge included; from its own corner, so that they are the same everywhere.
    let (mut area, mut sum, mut squares, mut colour) = (0.0, DVec2::ZERO, DVec3::ZERO, DVec3::ZERO);
    for y in low[1]..=high[1] {
        for x in (low[0]..=high[0]).filter(|&x| is_in([x, y])) {
            lights.parts([x, y], |[u, v], part| {
                let p = DVec2::new((x + u - low[0]) as f64, (y + v - low[1]) as f64) + 0.5;
                area += part;
                sum += p * part;
                squares += DVec3::new(p.x * p.x, p.x * p.y, p.y * p.y) * part;
            });
            colour += texture.rgb(x as usize, y as usize).as_dvec3();
        }
    }
    let centre = sum / area;
    let moments = squares - DVec3::new(centre.x * centre.x, centre.x * centre.y, centre.y * centre.y) * area;
    let orientation = orientation(moments.to_array());
    colour /= lamp.area as f64;

    let ring = Ring::walk(lamp, &is_in, &|at| lights.coverage(at));
    let (outline, size) =
        ring.outline(DVec2::from_angle(orientation), DVec2::new(texture.width as f64, texture.height as f64));
    let flux = f64::from(luminance(colour.as_vec3())) * lamp.area as f64;
    Luminaire {
        centre: DVec2::new(low[0] as f64, low[1] as f64) + centre,
        size,
        orientation,
        area,
        colour: colour.as_vec3(),
        flux_share: if total > 0.0 { flux / total } else { 0.0 },
        outline,
        kind: 0,
    }
}

/// The direction of largest variance, in (-π/2, π/2], of second moments; a lamp that has none lies along x.
pub fn orientation([xx, xy, yy]: [f64; 3]) -> f64 {
    let (difference, cross) = (xx - yy, 2.0 * xy);
    let anisotropy = difference.hypot(cross);
    let angle = if anisotropy > 1e-6 * (xx + yy) { 0.5 * cross.atan2(difference) } else { 0.0 };
    // Rounding may not choose between the two ends.
    if angle <= -std::f64::consts::FRAC_PI_2 + 1e-12 { angle + std::f64::consts::PI } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::polygon;
    use crate::job::Monitor;

    fn lamps(width: usize, height: usize, inside: impl Fn(f64, f64) -> bool) -> Vec<Luminaire> {
        let on = |x: usize, y: usize| inside(x as f64 + 0.5, y as f64 + 0.5);
        let mask = Image::from_fn(width, height, |x, y| [f32::from(on(x, y))]).unwrap();
        let texture = Image::from_fn(width, height, |x, y| [2.0, 1.0, 0.5].map(|v| v * f32::from(on(x, y)))).unwrap();
        find(&texture, &components(&mask).unwrap(), &|i| mask.data[i], Monitor::default().job()).unwrap()
    }

    #[test]
    fn a_rectangle_is_measured_exactly() {
        let found = lamps(40, 30, |x, y| (5.0..25.0).contains(&x) && (8.0..18.0).contains(&y));
        assert_eq!(found.len(), 1);
        let lamp = &found[0];
        assert_eq!((lamp.centre, lamp.size, lamp.orientation), (DVec2::new(15.0, 13.0), DVec2::new(20.0, 10.0), 0.0));
        assert_eq!((lamp.area, lamp.colour), (200.0, Vec3::new(2.0, 1.0, 0.5)));
        assert!((lamp.flux_share - 1.0).abs() < 1e-6);
        assert_eq!(lamp.outline.len(), 4);
        assert_eq!(polygon::area(&lamp.outline), 200.0);
        let upright = lamps(30, 40, |x, y| (5.0..8.0).contains(&x) && (8.0..38.0).contains(&y));
        assert!((upright[0].orientation - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!((upright[0].size - DVec2::new(30.0, 3.0)).length() < 1e-9);
    }

    #[test]
    fn a_turned_ellipse_keeps_its_angle_axes_and_area() {
        let (angle, a, b) = (0.5f64, 60.0, 25.0);
        let found = lamps(160, 160, |x, y| {
            let d = DVec2::from_angle(-angle).rotate(DVec2::new(x - 80.0, y - 80.0));
            (d.x / a).powi(2) + (d.y / b).powi(2) <= 1.0
        });
        let lamp = &found[0];
        assert!((lamp.orientation - angle).abs() < 0.01, "{}", lamp.orientation);
        assert!((lamp.size - DVec2::new(2.0 * a, 2.0 * b)).abs().max_element() < 1.5, "{}", lamp.size);
        let area = std::f64::consts::PI * a * b;
        assert!((lamp.area / area - 1.0).abs() < 0.01);
        assert!((polygon::area(&lamp.outline) / area - 1.0).abs() < 0.02);
        assert!(lamp.outline.len() < 60);
    }

    #[test]
    fn outlines_close_around_single_texels_holes_and_corner_contacts() {
        let dot = lamps(3, 3, |x, y| x == 1.5 && y == 1.5);
        assert_eq!(polygon::area(&dot[0].outline), 1.0);
        let ring = lamps(9, 9, |x, y| (x - 4.5).abs().max((y - 4.5).abs()) > 2.0);
        assert_eq!((ring.len(), polygon::area(&ring[0].outline)), (1, 81.0));
        let pair = lamps(4, 4, |x, y| (x < 2.0) == (y < 2.0));
        assert_eq!((pair.len(), polygon::area(&pair[0].outline)), (1, 8.0));
    }
}
