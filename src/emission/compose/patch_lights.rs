//! Finds the lights that are copied patch by patch. Such a light may be as long as the texture, but the texture is
//! never held in memory as a whole.
//!
//! The texture is rendered in bands from top to bottom. Each connected light keeps running sums, and the first and the
//! last texel in each row. Its outline encloses everything between these two texels, in steps of whole texels.

use super::composition::Composition;
use super::render::LightSelection;
use super::tile::Tile;
use super::weights::Style;
use crate::emission::lamps::coverage;
use crate::emission::lamps::luminaire::Luminaire;
use crate::emission::lamps::luminaires::{components, orientation};
use crate::emission::lamps::outline::{simplified, staircase};
use crate::emission::params::Input;
use crate::error::Result;
use crate::geometry::polygon;
use crate::image::try_vec;
use crate::job::Job;
use crate::maths;
use glam::{DVec2, DVec3, Vec3};

/// `BAND`: number of rows of texels in a band. `MARGIN_ROWS`: number of further rows that are rendered above and below
/// the band, because the lit part of a texel depends on the texels around it.
const BAND: usize = 64;
const MARGIN_ROWS: usize = 2;
/// Value of a texel without light, in place of the index of its light.
const NONE: u32 = u32::MAX;

/// Finds all lights of a composition that are copied patch by patch, in the order of their first texel. Leaves out
/// crumbs. The field `flux_share` is left at 0.
pub fn find(composition: &Composition, input: &Input, styles: &[Style], job: Job) -> Result<Vec<Luminaire>> {
    if !composition.layers.iter().any(|layer| layer.follows_patches()) {
        return Ok(Vec::new());
    }
    let mut lights = ConnectedLights::default();
    let mut above = try_vec(composition.width, NONE)?;
    for y in (0..composition.height).step_by(BAND) {
        let (top, rows) = (y.saturating_sub(MARGIN_ROWS), BAND.min(composition.height - y));
        let tile = Tile {
            x: 0,
            y: top,
            width: composition.width,
            height: (y + rows + MARGIN_ROWS).min(composition.height) - top,
        };
        let (texture, coverage) =
            composition.render_lights(input, styles, tile, LightSelection::OfPatches, job.part(0.0, 0.0))?;
        let found = components(&coverage)?;
        let first = lights.add(found.list.len());
        let (own, start) = ((y - top) * composition.width, y - top);
        let light = |i: usize| found.labels[own + i].checked_sub(1).map(|k| first + k);
        let coverage = |i: usize| coverage.data[i];
        let shown = coverage::LampCoverage::new(&found, &coverage, composition.width, tile.height)?;
        for i in 0..rows * composition.width {
            if let Some(k) = light(i) {
                let (u, v) = (i % composition.width, i / composition.width);
                let part = &mut lights.parts[k as usize];
                part.push([u, y + v], texture.rgb(u, start + v));
                shown.parts([u as isize, (start + v) as isize], |step, area| part.cover([u, y + v], step, area));
            }
        }
        for x in 0..composition.width {
            let near = &above[x.saturating_sub(1)..(x + 2).min(composition.width)];
            if let Some(below) = light(x) {
                near.iter().filter(|k| **k != NONE).for_each(|&k| lights.join(k, below));
            }
        }
        let last = (rows - 1) * composition.width;
        above.iter_mut().enumerate().for_each(|(x, k)| *k = light(last + x).unwrap_or(NONE));
    }
    let size = [composition.width as u32, composition.height as u32];
    Ok(lights
        .parts
        .iter()
        .filter(|l| l.area > 0.0 && !l.is_crumb(composition.crumb, size))
        .map(Light::measured)
        .collect())
}

/// The lights found so far. If a further band shows that two lights are connected, they are merged (union-find).
#[derive(Default)]
struct ConnectedLights {
    parts: Vec<Light>,
    /// For each light, the index of the light into which it was merged, or its own index.
    into: Vec<u32>,
}

impl ConnectedLights {
    /// Adds `count` empty lights and returns the index of the first one.
    fn add(&mut self, count: usize) -> u32 {
        let first = self.parts.len();
        self.parts.resize_with(first + count, Light::default);
        self.into.extend((first..first + count).map(|k| k as u32));
        first as u32
    }

    fn whole(&self, mut k: u32) -> u32 {
        while self.into[k as usize] != k {
            k = self.into[k as usize];
        }
        k
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.whole(a), self.whole(b));
        if a != b {
            let (low, high) = (a.min(b), a.max(b));
            let part = std::mem::take(&mut self.parts[high as usize]);
            self.parts[low as usize].merge(&part);
            self.into[high as usize] = low;
        }
    }
}

/// The texels from column `left` up to, but not including, `right` in `rows` consecutive rows.
#[derive(Clone, Copy)]
struct Span {
    row: u32,
    rows: u32,
    left: u32,
    right: u32,
}

/// The area, moments and colour of a light, and its extent in each row.
#[derive(Default)]
struct Light {
    /// Number of texels.
    texels: f64,
    /// `area`, `centres` and `squares` are sums over the lit parts of texels: area, first moments and second moments.
    /// Positions are relative to `origin`, the centre of the first texel. `colours` is the sum of the colours of all
    /// texels.
    area: f64,
    origin: DVec2,
    centres: DVec2,
    squares: DVec3,
    colours: DVec3,
    /// The spans from top to bottom; adjacent rows with equal ends share one span.
    spans: Vec<Span>,
}

impl Light {
    /// Adds an area of light, in texels, to the sums. The area lies in the texel `[x + u, y + v]`. `[x, y]` is a texel
    /// of this light. `[u, v]` is 0, or the step to an adjacent texel of which light covers less than half.
    fn cover(&mut self, [x, y]: [usize; 2], [u, v]: [isize; 2], area: f64) {
        let p = DVec2::new(x as f64 + u as f64, y as f64 + v as f64) + 0.5 - self.origin;
        self.area += area;
        self.centres += p * area;
        self.squares += DVec3::new(p.x * p.x, p.x * p.y, p.y * p.y) * area;
    }

    /// Adds a texel to the light; texels must come row by row.
    fn push(&mut self, [x, y]: [usize; 2], colour: Vec3) {
        if self.texels == 0.0 {
            self.origin = DVec2::new(x as f64, y as f64) + 0.5;
        }
        self.texels += 1.0;
        self.colours += colour.as_dvec3();
        let (x, y) = (x as u32, y as u32);
        match self.spans.last_mut() {
            Some(span) if span.row == y && span.rows == 1 => {
                (span.left, span.right) = (span.left.min(x), span.right.max(x + 1));
            }
            _ => {
                self.close();
                self.spans.push(Span { row: y, rows: 1, left: x, right: x + 1 });
            }
        }
    }

    /// If the last two spans cover the same columns, and the last one lies directly below the other, merges them.
    fn close(&mut self) {
        if let [.., before, last] = &mut self.spans[..]
            && (before.left, before.right, before.row + before.rows) == (last.left, last.right, last.row)
        {
            before.rows += last.rows;
            self.spans.pop();
        }
    }

    /// Merges another light into this one. The first row of `other` must not lie above the first row of this light.
    fn merge(&mut self, other: &Self) {
        let by = other.origin - self.origin;
        let Self { area, centres: c, squares: s, .. } = *other;
        self.squares += s
            + DVec3::new(2.0 * c.x * by.x, c.x * by.y + c.y * by.x, 2.0 * c.y * by.y)
            + DVec3::new(by.x * by.x, by.x * by.y, by.y * by.y) * area;
        self.centres += c + by * area;
        self.area += area;
        self.texels += other.texels;
        self.colours += other.colours;
        let rows = |spans: &[Span]| -> Vec<Span> {
            spans.iter().flat_map(|s| (0..s.rows).map(|i| Span { row: s.row + i, rows: 1, ..*s })).collect()
        };
        let mut all = rows(&self.spans);
        all.extend(rows(&other.spans));
        all.sort_by_key(|span| span.row);
        self.spans.clear();
        for span in all {
            match self.spans.last_mut() {
                Some(last) if last.row == span.row && last.rows == 1 => {
                    (last.left, last.right) = (last.left.min(span.left), last.right.max(span.right));
                }
                _ => {
                    self.close();
                    self.spans.push(span);
                }
            }
        }
    }

    /// Whether the light's area is below `crumb` and the light does not touch the border of a texture of the given
    /// size.
    fn is_crumb(&self, crumb: f64, [width, height]: [u32; 2]) -> bool {
        let touches = |s: &Span| s.row == 0 || s.row + s.rows == height || s.left == 0 || s.right == width;
        self.area < crumb && !self.spans.iter().any(touches)
    }

    fn measured(&self) -> Luminaire {
        let mean = self.centres / self.area;
        let [xx, xy, yy] =
            (self.squares - DVec3::new(mean.x * mean.x, mean.x * mean.y, mean.y * mean.y) * self.area).to_array();
        let orientation = orientation([xx, xy, yy]);
        // The outline runs from top to bottom along the left ends of the spans, then back along their right ends.
        let corner = |x: u32, y: u32| DVec2::new(f64::from(x), f64::from(y));
        let down = self.spans.iter().flat_map(|s| [corner(s.left, s.row), corner(s.left, s.row + s.rows)]);
        let up = self.spans.iter().rev().flat_map(|s| [corner(s.right, s.row + s.rows), corner(s.right, s.row)]);
        let ring: Vec<DVec2> = down.chain(up).collect();
        let extent = |axis: DVec2| polygon::extent(&ring, axis);
        let axis = maths::direction_at(orientation);
        let size = DVec2::new(extent(axis), extent(axis.perp()));
        Luminaire {
            centre: self.origin + mean,
            size,
            orientation,
            area: self.area,
            colour: (self.colours / self.texels).as_vec3(),
            flux_share: 0.0,
            outline: simplified(ring, staircase(size.min_element())),
            kind: 0,
        }
    }
}
