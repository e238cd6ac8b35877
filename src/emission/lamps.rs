//! From patches to lamps: which lamps of the exemplar the texture shows, each as one piece.
//!
//! The texture is black off the lights (Fig. 12c), so all that a patch contributes is its lamps. A seam that must pass a
//! lamp, because the lamp is wider than the overlap, would leave part of it; instead a lamp is shown whole where most of it
//! lies in patches of its own shift, and not at all where less does or where another lamp took the place.

use super::cells;
use super::exemplar::Exemplar;
use super::layout::Layout;
use crate::error::Result;
use crate::image::try_vec;
use crate::job::Job;
use crate::rng::Rng;
use glam::{DMat2, DVec2};
use std::collections::BTreeMap;

/// Share of a lamp that patches of its shift must show.
const LEAST_SHARE: f64 = 0.3;
/// Share of a lamp's pixels that others may hold on a lattice, where rounding is all that can make them meet.
const LATTICE_SLACK: f64 = 0.2;

/// By how much, relatively, lamps of a kind may differ in area, in both sides and in their ratio.
const LIKE: f64 = 0.25;
/// By how much more, in pixels of the photo: blur and glow make a lamp so much longer that the photo shows small. Beyond the last
/// of these no lamps are alike.
const BLUR: f64 = 2.0;
const LEAST_LIKE: f64 = 0.5;
/// A lamp is shown sharply if it covers this share of the photo pixels that the largest of its kind does.
const SHARP: f64 = 0.4;

/// A lamp of the exemplar in the texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Index of its component in the exemplar.
    pub component: usize,
    /// Where it is shown less where it is taken from, in unwarped pixels.
    pub shift: DVec2,
}

/// What lamps may do.
#[derive(Clone, Copy)]
pub struct Rules {
    /// They lie on a lattice: rounding alone can make them meet.
    pub is_lattice: bool,
    /// What leaves the texture on one side comes in on the other.
    pub wraps: bool,
}

/// The lamps shown by a layout, best supported first, each as the photo shows it or one like it best.
pub fn resolve(exemplar: &Exemplar, layout: &Layout, rules: Rules, seed: u64, job: Job) -> Result<Vec<Instance>> {
    let Rules { is_lattice, wraps } = rules;
    let footprints = footprints(exemplar);
    let working = &exemplar.working;

    // How many pixels of each lamp are shown at each shift.
    let rows = rows(&footprints, working.height);
    let mut shown: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for y in 0..layout.height {
        job.check()?;
        let mut start = 0;
        for &(end, label) in layout.row(y) {
            let run = std::mem::replace(&mut start, end as i32)..end as i32;
            let Some([dx, dy]) = layout.shifts.get(label as usize).map(|s| s.working) else { continue };
            let Some(row) = usize::try_from(y as i32 - dy).ok().and_then(|v| rows.get(v)) else { continue };
            let (low, high) = (run.start - dx, run.end - dx);
            for piece in row[row.partition_point(|p| p.end <= low)..].iter().take_while(|p| p.start < high) {
                let pixels = piece.end.min(high) - piece.start.max(low);
                *shown.entry((piece.lamp, label)).or_default() += pixels as usize;
            }
        }
    }

    // Against how many there are within the texture.
    let texel = move |x: i32, y: i32| {
        let side = |at: i32, side: usize| match wraps {
            true => Some(at.rem_euclid(side as i32) as usize),
            false => usize::try_from(at).ok().filter(|&at| at < side),
        };
        side(x, layout.width).zip(side(y, layout.height))
    };
    let place = |k: u32, label: u32| {
        let [dx, dy] = layout.shifts[label as usize].working;
        footprints[k as usize].iter().filter_map(move |&[x, y]| texel(x + dx, y + dy))
    };
    let mut claims: Vec<(f64, u32, u32)> =
        shown.iter().map(|(&(k, label), &n)| (n as f64 / place(k, label).count() as f64, k, label)).collect();
    claims.retain(|c| c.0 >= LEAST_SHARE);
    claims.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));

    // Best first; who comes late finds the place taken. Free lamps keep a pixel between them.
    let mut taken = Bits::new(layout.width * layout.height)?;
    let mut instances = Vec::new();
    let margin = i32::from(!is_lattice);
    for (_, k, label) in claims {
        let near = |x: usize, y: usize| {
            let around = |at: usize| at as i32 - margin..=at as i32 + margin;
            around(y).any(|v| around(x).filter_map(|u| texel(u, v)).any(|(u, v)| taken.get(v * layout.width + u)))
        };
        let clashes = place(k, label).filter(|&(x, y)| near(x, y)).count();
        let allowed = if is_lattice { LATTICE_SLACK * place(k, label).count() as f64 } else { 0.0 };
        if clashes as f64 <= allowed {
            place(k, label).for_each(|(x, y)| taken.set(y * layout.width + x));
            instances.push(Instance { component: k as usize, shift: layout.shifts[label as usize].exact });
        }
    }
    show_sharply(exemplar, &mut instances, seed);
    Ok(instances)
}

/// The lamps of an exemplar that repeats as a whole: all of them in each cell of the lattice that the texture shows a part of; where
/// it repeats itself, in each cell that begins in it.
pub fn repeat(exemplar: &Exemplar, [a, b]: [DVec2; 2], offset: DVec2, size: DVec2, wraps: bool) -> Vec<Instance> {
    let inverse = DMat2::from_cols(a, b).inverse();
    let point = |p: [usize; 2]| DVec2::new(p[0] as f64, p[1] as f64);
    let mut instances = Vec::new();
    for (component, lamp) in exemplar.pieces() {
        // The shifts that bring some of it into the texture, and the cells around those.
        let (low, high) = if wraps { (DVec2::ZERO, size) } else { (-point(lamp.max) - 1.0, size - point(lamp.min)) };
        for [i, j] in cells::between(inverse, low - offset, high - offset) {
            let shift = offset + a * i as f64 + b * j as f64;
            // A cell that begins on the far side is the one that begins on this.
            let slack = if wraps { DVec2::splat(1e-6) } else { DVec2::ZERO };
            if shift.cmpge(low - slack).all() && shift.cmplt(high - slack).all() {
                instances.push(Instance { component, shift });
            }
        }
    }
    instances
}

/// Working pixels of a row from `start` to before `end` that a lamp covers.
struct Piece {
    start: i32,
    end: i32,
    lamp: u32,
}

/// The lamps that each working row shows, from left to right. Of lamps that share a pixel, because both are smaller than it, the
/// last has it.
fn rows(footprints: &[Vec<[i32; 2]>], height: usize) -> Vec<Vec<Piece>> {
    let mut rows: Vec<BTreeMap<i32, u32>> = vec![BTreeMap::new(); height];
    for (k, pixels) in footprints.iter().enumerate() {
        for &[x, y] in pixels {
            rows[y as usize].insert(x, k as u32);
        }
    }
    let pieces = |row: BTreeMap<i32, u32>| {
        let mut pieces: Vec<Piece> = Vec::new();
        for (x, lamp) in row {
            match pieces.last_mut().filter(|p| p.end == x && p.lamp == lamp) {
                Some(piece) => piece.end += 1,
                None => pieces.push(Piece { start: x, end: x + 1, lamp }),
            }
        }
        pieces
    };
    rows.into_iter().map(pieces).collect()
}

/// A set of pixels, in the space of a bit each.
struct Bits(Vec<u64>);

impl Bits {
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

/// A texture that repeats, and its eight neighbours, in sides of it.
pub fn turns() -> impl Iterator<Item = DVec2> {
    (-1..=1).flat_map(|y| (-1..=1).map(move |x| DVec2::new(f64::from(x), f64::from(y))))
}

/// Every lamp again where it comes in when it leaves a texture of this size, in unwarped pixels.
pub fn wrapped(instances: &[Instance], size: DVec2) -> Vec<Instance> {
    instances.iter().flat_map(|i| turns().map(|t| Instance { shift: i.shift + t * size, ..*i })).collect()
}

/// Puts in the place of a lamp that the photo shows small one like it that it shows large. Which of several is drawn, so
/// that they keep their variety.
pub fn show_sharply(exemplar: &Exemplar, instances: &mut [Instance], seed: u64) {
    let lamps = &exemplar.components.list;
    let sharp = |k: usize| -> Vec<usize> {
        let like = (LIKE + BLUR / exemplar.photo_area[k].max(1.0).sqrt()).min(LEAST_LIKE);
        let is_like = |j: &usize| {
            let close = |a: usize, b: usize| (a as f64 - b as f64).abs() <= like * a.max(b) as f64;
            let (a, b) = (&lamps[k], &lamps[*j]);
            let ([w, h], [u, v]) = (a.size(), b.size());
            // As large and of the same proportions; and with nothing cut off.
            let is_alike = close(a.area, b.area) && close(w, u) && close(h, v) && close(w * v, u * h);
            exemplar.whole[*j] && !exemplar.touches[*j] && is_alike
        };
        let like: Vec<usize> = (0..lamps.len()).filter(is_like).collect();
        let most = like.iter().map(|&j| exemplar.photo_area[j]).fold(0.0, f64::max);
        like.into_iter().filter(|&j| exemplar.photo_area[j] >= SHARP * most).collect()
    };
    let mut choices: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (n, instance) in instances.iter_mut().enumerate() {
        let k = instance.component;
        let choice = choices.entry(k).or_insert_with(|| sharp(k));
        if !choice.is_empty() && !choice.contains(&k) {
            let j = choice[Rng::new(seed, &[0x6c61, n as u64]).below(choice.len())];
            *instance = Instance { component: j, shift: instance.shift + lamps[k].centre - lamps[j].centre };
        }
    }
}

/// The working pixels of each lamp that is a piece: those whose centre it covers, or at least that of its own centre.
fn footprints(exemplar: &Exemplar) -> Vec<Vec<[i32; 2]>> {
    let working = &exemplar.working;
    let mut footprints = vec![Vec::new(); exemplar.components.list.len()];
    for y in 0..working.height {
        for x in 0..working.width {
            let centre = (DVec2::new(x as f64, y as f64) + 0.5) * working.pitch;
            let label = exemplar.components.labels[centre.y as usize * exemplar.width + centre.x as usize] as usize;
            if label != 0 && exemplar.piece[label - 1] {
                footprints[label - 1].push([x as i32, y as i32]);
            }
        }
    }
    for ((pixels, lamp), &is_piece) in footprints.iter_mut().zip(&exemplar.components.list).zip(&exemplar.piece) {
        if is_piece && pixels.is_empty() {
            let p = lamp.centre / working.pitch;
            pixels.push([(p.x as i32).min(working.width as i32 - 1), (p.y as i32).min(working.height as i32 - 1)]);
        }
    }
    footprints
}
