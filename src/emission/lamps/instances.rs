//! Finds the lamps of the exemplar that a quilted texture shows, and places each as a whole.
//!
//! The texture is black outside the lights (Fig. 12c of the paper), so a patch contributes nothing but its lamps. A
//! seam between patches may cut a lamp and leave only a part of it. Therefore each lamp is drawn whole or not at all:
//!
//! - A lamp is placed as a whole if patches with one common shift show enough of it. A shift is the position in the
//!   texture minus the position in the exemplar.
//! - A lamp is left out if such patches show less of it, or if another lamp occupies its place.

use super::instance::Instance;
use super::sharpest;
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::roles::Role;
use crate::emission::lattice::cells;
use crate::emission::quilt::patch_map::PatchMap;
use crate::error::Result;
use crate::image::try_vec;
use crate::job::Job;
use glam::{DMat2, DVec2};
use std::collections::BTreeMap;

/// A lamp is placed only if patches that have the same shift copy at least this share of it. [bench constants:lamps]
const MIN_SHARE: f64 = 0.3;
/// On a lattice, a lamp is placed if other lamps occupy at most this share of its pixels. Lattice lamps overlap only
/// through rounding: shifts are rounded by up to half a pixel, so two lamps overlap by at most one row or column. This
/// is 0.2 of a lamp that is five pixels wide. A lamp that is placed twice overlaps almost completely. [rounding]
const MAX_LATTICE_OVERLAP: f64 = 0.2;

/// How lamps are placed in a texture.
#[derive(Clone, Copy)]
pub struct Rules {
    /// Whether the lamps lie on a lattice, where only rounding can make them overlap.
    pub is_lattice: bool,
    /// Whether the texture is tileable: a lamp that leaves it on one side re-enters on the opposite side.
    pub wraps: bool,
}

/// Places the lamps of which a patch map copies at least the share [`MIN_SHARE`]. Lamps with a larger copied share are
/// placed first: a lamp that is placed later must not overlap them. Afterwards replaces each lamp that few photo pixels
/// show by a similar lamp that many photo pixels show.
pub fn resolve(exemplar: &Exemplar, patch_map: &PatchMap, rules: Rules, seed: u64, job: Job) -> Result<Vec<Instance>> {
    let canvas = PatchLamps { patch_map, footprints: footprints(exemplar), wraps: rules.wraps };
    let claims = canvas.claims(exemplar.working.height, job)?;
    let mut instances = canvas.settle(&claims, rules.is_lattice)?;
    sharpest::show_sharpest(exemplar, &mut instances, seed);
    Ok(instances)
}

/// A patch map, and the pixels that each lamp covers at the reduced size of the synthesis (working pixels).
struct PatchLamps<'a> {
    patch_map: &'a PatchMap,
    footprints: Vec<Vec<[i32; 2]>>,
    wraps: bool,
}

impl PatchLamps<'_> {
    /// The working pixel of the texture at column `x` and row `y`. Beyond its border, a tileable texture repeats; for
    /// any other texture, the result is `None` there.
    fn texel(&self, x: i32, y: i32) -> Option<(usize, usize)> {
        let side = |at: i32, side: usize| match self.wraps {
            true => Some(at.rem_euclid(side as i32) as usize),
            false => usize::try_from(at).ok().filter(|&at| at < side),
        };
        side(x, self.patch_map.width).zip(side(y, self.patch_map.height))
    }

    /// The working pixels of the texture that lamp `k` covers after it is moved by shift number `label` of the patch
    /// map.
    fn place(&self, k: u32, label: u32) -> impl Iterator<Item = (usize, usize)> {
        let [dx, dy] = self.patch_map.shifts[label as usize].working;
        self.footprints[k as usize].iter().filter_map(move |&[x, y]| self.texel(x + dx, y + dy))
    }

    /// Finds the pairs of a lamp and a shift such that the patch map copies at least the share `MIN_SHARE` of the lamp
    /// with this shift. If the texture's border cuts the shifted lamp, the share is relative to the part within the
    /// texture. Each entry holds the copied share, the index of the lamp, and the label of the shift. The largest share
    /// comes first.
    fn claims(&self, exemplar_height: usize, job: Job) -> Result<Vec<(f64, u32, u32)>> {
        let rows = rows(&self.footprints, exemplar_height);
        let mut shown: BTreeMap<(u32, u32), usize> = BTreeMap::new();
        for y in 0..self.patch_map.height {
            job.check()?;
            let mut start = 0;
            for &(end, label) in self.patch_map.row(y) {
                let run = std::mem::replace(&mut start, end as i32)..end as i32;
                let Some([dx, dy]) = self.patch_map.shifts.get(label as usize).map(|s| s.working) else { continue };
                let Some(row) = usize::try_from(y as i32 - dy).ok().and_then(|v| rows.get(v)) else { continue };
                let (low, high) = (run.start - dx, run.end - dx);
                for piece in row[row.partition_point(|p| p.end <= low)..].iter().take_while(|p| p.start < high) {
                    let pixels = piece.end.min(high) - piece.start.max(low);
                    *shown.entry((piece.lamp, label)).or_default() += pixels as usize;
                }
            }
        }
        let share =
            |(&(k, label), &n): (&(u32, u32), &usize)| (n as f64 / self.place(k, label).count() as f64, k, label);
        let mut claims: Vec<(f64, u32, u32)> = shown.iter().map(share).collect();
        claims.retain(|c| c.0 >= MIN_SHARE);
        claims.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        Ok(claims)
    }

    /// Places the lamps in the order of `claims`, the list from [`Self::claims`]. Skips a lamp whose place is taken by
    /// lamps that are already placed:
    ///
    /// - On a lattice, if they cover more than the share [`MAX_LATTICE_OVERLAP`] of its pixels.
    /// - Without a lattice, if they cover or touch any of its pixels.
    fn settle(&self, claims: &[(f64, u32, u32)], is_lattice: bool) -> Result<Vec<Instance>> {
        let PatchMap { width, height, ref shifts, .. } = *self.patch_map;
        let mut taken = BitSet::new(width * height)?;
        let mut instances = Vec::new();
        let margin = i32::from(!is_lattice);
        for &(_, k, label) in claims {
            let near = |x: usize, y: usize| {
                let around = |at: usize| at as i32 - margin..=at as i32 + margin;
                around(y).any(|v| around(x).filter_map(|u| self.texel(u, v)).any(|(u, v)| taken.get(v * width + u)))
            };
            let clashes = self.place(k, label).filter(|&(x, y)| near(x, y)).count();
            let allowed = if is_lattice { MAX_LATTICE_OVERLAP * self.place(k, label).count() as f64 } else { 0.0 };
            if clashes as f64 <= allowed {
                self.place(k, label).for_each(|(x, y)| taken.set(y * width + x));
                instances.push(Instance { component: k as usize, shift: shifts[label as usize].exact });
            }
        }
        Ok(instances)
    }
}

/// Places the lamps of an exemplar that repeats as a whole, with the periods `a` and `b`, in a texture of the given
/// size. A repetition moves the exemplar's upper left corner to `offset` + i a + j b, with integers i and j. Lengths
/// are in unwarped pixels.
///
/// - A texture that is not tileable gets every copy of a lamp that lies at least partly in it.
/// - A tileable texture (`wraps`) gets all lamps of each repetition whose corner lies in the texture.
pub fn repeat(exemplar: &Exemplar, [a, b]: [DVec2; 2], offset: DVec2, size: DVec2, wraps: bool) -> Vec<Instance> {
    let inverse = DMat2::from_cols(a, b).inverse();
    let mut instances = Vec::new();
    for (component, lamp) in exemplar.pieces() {
        // Find the range of shifts with which the lamp lies at least partly in the texture. In a tileable texture, find
        // instead the range of shifts with which the repetition begins in the texture. Then find the lattice positions
        // in this range.
        let (first, last) = lamp.bounds();
        let (low, high) = if wraps { (DVec2::ZERO, size) } else { (-last, size - first) };
        for [i, j] in cells::between(inverse, low - offset, high - offset) {
            let shift = offset + a * i as f64 + b * j as f64;
            // In a tileable texture, a repetition that begins on the right or lower border equals the repetition that
            // begins on the left or upper border. Both test limits are lowered by a slack, so that rounding cannot
            // count such a repetition twice or not at all.
            let slack = if wraps { DVec2::splat(1e-6) } else { DVec2::ZERO };
            if shift.cmpge(low - slack).all() && shift.cmplt(high - slack).all() {
                instances.push(Instance { component, shift });
            }
        }
    }
    instances
}

/// Places the lamps of a part of the exemplar in a texture that shows this part, with `size` in unwarped pixels.
/// `offset` is the shift of the part's upper left corner to the origin. Afterwards replaces each lamp that few photo
/// pixels show by a similar lamp that many photo pixels show.
pub fn copy(exemplar: &Exemplar, offset: DVec2, size: DVec2, seed: u64) -> Vec<Instance> {
    let lamps = exemplar.components.list.iter().zip(&exemplar.roles).enumerate();
    let is_within =
        |(low, high): (DVec2, DVec2)| (high + offset).cmpgt(DVec2::ZERO).all() && (low + offset).cmplt(size).all();
    let shown = lamps.filter(|(_, (lamp, role))| **role != Role::Through && is_within(lamp.bounds()));
    let mut instances = shown.map(|(component, _)| Instance { component, shift: offset }).collect::<Vec<_>>();
    sharpest::show_sharpest(exemplar, &mut instances, seed);
    instances
}

/// Adjacent pixels that a lamp covers in one row of the exemplar at working size: the columns from `start` to
/// `end` - 1.
struct PixelRun {
    start: i32,
    end: i32,
    lamp: u32,
}

/// Lists the runs of lamp pixels in each row of the exemplar at working size, from left to right. If several small
/// lamps lie in one pixel, the pixel belongs to the last of these lamps.
fn rows(footprints: &[Vec<[i32; 2]>], height: usize) -> Vec<Vec<PixelRun>> {
    let mut rows: Vec<BTreeMap<i32, u32>> = vec![BTreeMap::new(); height];
    for (k, pixels) in footprints.iter().enumerate() {
        for &[x, y] in pixels {
            rows[y as usize].insert(x, k as u32);
        }
    }
    let pieces = |row: BTreeMap<i32, u32>| {
        let mut pieces: Vec<PixelRun> = Vec::new();
        for (x, lamp) in row {
            match pieces.last_mut().filter(|p| p.end == x && p.lamp == lamp) {
                Some(piece) => piece.end += 1,
                None => pieces.push(PixelRun { start: x, end: x + 1, lamp }),
            }
        }
        pieces
    };
    rows.into_iter().map(pieces).collect()
}

/// A set of pixels, stored with one bit per pixel.
struct BitSet(Vec<u64>);

impl BitSet {
    fn new(count: usize) -> Result<Self> {
        Ok(Self(try_vec(count.div_ceil(64), 0)?))
    }

    fn get(&self, i: usize) -> bool {
        self.0[i / 64] >> (i % 64) & 1 != 0
    }

    fn set(&mut self, i: usize) {
        self.0[i / 64] |= 1 << (i % 64);
    }
}

/// For each lamp that is copied as one piece, the working pixels whose centre the lamp covers. A lamp that covers no
/// pixel centre gets the pixel that contains the lamp's centre. Other components get an empty list.
fn footprints(exemplar: &Exemplar) -> Vec<Vec<[i32; 2]>> {
    let working = &exemplar.working;
    let mut footprints = vec![Vec::new(); exemplar.components.list.len()];
    for y in 0..working.height {
        for x in 0..working.width {
            let centre = (DVec2::new(x as f64, y as f64) + 0.5) * working.pitch;
            let label = exemplar.label_at(centre) as usize;
            if label != 0 && exemplar.roles[label - 1].is_piece() {
                footprints[label - 1].push([x as i32, y as i32]);
            }
        }
    }
    for ((pixels, lamp), role) in footprints.iter_mut().zip(&exemplar.components.list).zip(&exemplar.roles) {
        if role.is_piece() && pixels.is_empty() {
            let p = lamp.centre / working.pitch;
            pixels.push([(p.x as i32).min(working.width as i32 - 1), (p.y as i32).min(working.height as i32 - 1)]);
        }
    }
    footprints
}
