//! What the leaves of the binary tree hold: triangles with area, in pairs where two make one whole.
//!
//! Meshes list the two halves of a square one after the other. They lie in almost the same box, so no ray is saved by
//! telling them apart; as one leaf they halve the work of the builder.

use super::{Job, pages};
use crate::error::Result;
use crate::rng;
use glam::{DVec3, Vec3};
use obvhs::aabb::Aabb;
use rayon::prelude::*;

/// One triangle, or two.
#[derive(Clone, Copy)]
pub(super) struct Unit {
    first: u32,
    second: u32,
}

const NONE: u32 = u32::MAX;
/// Triangles looked at by one piece of parallel work.
const CHUNK: usize = 4096;

impl Unit {
    pub fn ids(self) -> impl Iterator<Item = u32> {
        [self.first, self.second].into_iter().filter(|&id| id != NONE)
    }
}

pub(super) struct Units {
    pub list: Vec<Unit>,
    /// Bounds of all of them.
    pub low: Vec3,
    pub high: Vec3,
    /// Triangles of no area, left out.
    pub dropped: usize,
}

/// Sorts the triangles into units.
pub(super) fn gather(triangles: &[[Vec3; 3]], job: Job) -> Result<Units> {
    let chunks: Vec<Units> = triangles
        .par_chunks(CHUNK)
        .enumerate()
        .map(|(i, chunk)| {
            job.check()?;
            gather_chunk(chunk, (i * CHUNK) as u32)
        })
        .collect::<Result<_>>()?;
    let mut all = Units { list: Vec::new(), low: Vec3::INFINITY, high: Vec3::NEG_INFINITY, dropped: 0 };
    all.list = pages::reserve(chunks.iter().map(|chunk| chunk.list.len()).sum())?;
    for chunk in chunks {
        all.list.extend(chunk.list);
        all.low = all.low.min(chunk.low);
        all.high = all.high.max(chunk.high);
        all.dropped += chunk.dropped;
    }
    Ok(all)
}

fn gather_chunk(triangles: &[[Vec3; 3]], first: u32) -> Result<Units> {
    let mut units =
        Units { list: pages::reserve(triangles.len())?, low: Vec3::INFINITY, high: Vec3::NEG_INFINITY, dropped: 0 };
    // The triangle before, its box and that box's area, if it is still alone.
    let mut alone: Option<(Vec3, Vec3, f32)> = None;
    for (i, corners) in triangles.iter().enumerate() {
        if !has_area(corners) {
            units.dropped += 1;
            alone = None;
            continue;
        }
        let id = first + i as u32;
        let (low, high) = bounds(corners);
        units.low = units.low.min(low);
        units.high = units.high.max(high);
        let area = half_area(high - low);
        // Tested together a pair costs what its common box is met; apart, what each box is.
        if let Some((l, h, a)) = alone.take()
            && half_area(high.max(h) - low.min(l)) < 0.75 * (area + a)
            && let Some(unit) = units.list.last_mut()
        {
            unit.second = id;
        } else {
            units.list.push(Unit { first: id, second: NONE });
            alone = Some((low, high, area));
        }
    }
    Ok(units)
}

fn has_area(corners: &[Vec3; 3]) -> bool {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let doubled = (b - a).cross(c - a).length_squared();
    doubled.is_finite() && doubled > 0.0
}

fn bounds(corners: &[Vec3; 3]) -> (Vec3, Vec3) {
    (corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]))
}

fn half_area(d: Vec3) -> f32 {
    d.x * d.y + d.y * d.z + d.z * d.x
}

impl Units {
    /// The boxes that the builder sees: those of the units within a scene of unit size about the origin, each enlarged by
    /// a random amount of up to 1/1000 of its extent.
    ///
    /// On regular grids, which the walls of rooms are, all merges of neighbours cost the same. The builder merges two
    /// boxes if each is the other's best neighbour, and takes the last of equals: then hardly any two choose each other,
    /// and those that do lie anywhere, which makes trees that are 6 to 20 times slower to traverse. Unequal boxes leave no
    /// ties. The boxes of the finished tree are tight.
    ///
    /// Boxes that are one point there, as those of a small thing in a huge scene are, would have none to grow by, and ties
    /// without end make the builder take time in the square of their number: they grow by 2^-12 of their distance.
    pub fn boxes(&self, triangles: &[[Vec3; 3]]) -> Result<Vec<Aabb>> {
        let (low, high) = (self.low.as_dvec3(), self.high.as_dvec3());
        let centre = (low + high) / 2.0;
        let scale = DVec3::splat(1.0 / (high - low).max_element().max(f64::MIN_POSITIVE));
        let unit_box = |unit: &Unit| {
            let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            for corner in unit.ids().flat_map(|id| triangles[id as usize]) {
                (low, high) = (low.min(corner), high.max(corner));
            }
            let [low, high] = [low, high].map(|p| ((p.as_dvec3() - centre) * scale).as_vec3());
            let amount = (rng::mix(u64::from(unit.first) + 1) >> 40) as f32 / (1 << 24) as f32;
            let (extent, distance) = ((high - low).max_element(), low.abs().max(high.abs()).max_element());
            let is_point = extent <= distance * f32::EPSILON;
            let grow = Vec3::splat(amount * if is_point { distance / 4096.0 } else { extent * 1e-3 });
            Aabb::new((low - grow).into(), (high + grow).into())
        };
        let mut boxes = pages::reserve(self.list.len())?;
        self.list.par_iter().with_min_len(CHUNK / 4).map(unit_box).collect_into_vec(&mut boxes);
        Ok(boxes)
    }
}
