//! The surroundings of the vertices of a render's paths: a small acceleration structure that answers most rays.
//!
//! In a building, most paths stay in a few rooms, but their rays descend through an acceleration structure of the whole
//! building. The first passes therefore record where vertices lie ([`PositionReservoir`]), and the render builds a
//! second structure of the triangles that meet the box around these positions. This second structure answers rays that
//! stay within the box. Its answers are exact: the box is convex, so a segment between two points of the box stays
//! within the box, and every triangle that the segment hits meets the box. Both structures therefore find the same
//! hits, to the last bit. The structure of the whole scene answers all other rays.

use crate::accel::{Accel, Hit, Ray};
use crate::error::Result;
use crate::image::{try_collect, try_with_capacity};
use crate::job::Monitor;
use glam::Vec3;
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of positions that are recorded. [convention]
const CAPACITY: usize = 1024;
/// Minimum number of recorded positions from which a box is computed. [convention]
const MIN_POSITIONS: usize = 128;
/// Share of the recorded positions that may lie beyond each side of the box. [judged on 3 scenes]
const BEYOND: f64 = 1.0 / 128.0;
/// The box is computed again if, on any axis, more than this share of the recorded coordinates lies outside the box.
/// [judged on 3 scenes]
const MAX_OUTSIDE: f64 = 1.0 / 16.0;
/// Triangles count as near if their distance from the box is at most this share of the largest coordinate of the scene.
/// The share is larger than the relative rounding error of a hit, which is the constant `MARGIN` of `accel/node.rs`.
/// [rounding]
const MARGIN: f32 = 1.0 / (1 << 16) as f32;
/// The structure is built only if it has at most `1 / MIN_RATIO` of the triangles of the scene, because a larger
/// structure saves little time. [judged on 3 scenes]
const MIN_RATIO: usize = 4;

/// A random sample of the positions of vertices, to which all threads of a render add. The sample does not depend on
/// the order of the additions: each position has a random entry and a random priority. For each axis separately, an
/// entry keeps the coordinate with the highest priority.
pub struct PositionReservoir {
    /// For each axis of each entry, the priority (upper 32 bits) and the bits of the f32 coordinate (lower 32 bits); 0
    /// if empty.
    entries: Vec<[AtomicU64; 3]>,
}

impl PositionReservoir {
    pub fn new() -> Result<Self> {
        let mut entries = try_with_capacity(CAPACITY)?;
        entries.resize_with(CAPACITY, Default::default);
        Ok(Self { entries })
    }

    /// Adds a position. `u` is uniform in `[0, 1)`, with 32 random bits.
    #[inline]
    pub fn add(&self, position: Vec3, u: f64) {
        let random = ((u * 4_294_967_296.0) as u32).rotate_left(CAPACITY.ilog2());
        // The 10 highest bits of `u` choose the entry; the lower bits are the priority.
        let entry = &self.entries[random as usize % CAPACITY];
        for (entry, x) in entry.iter().zip(position.to_array()) {
            let candidate = u64::from(random / CAPACITY as u32 + 1) << 32 | u64::from(x.to_bits());
            if candidate > entry.load(Ordering::Relaxed) {
                entry.fetch_max(candidate, Ordering::Relaxed);
            }
        }
    }

    /// Returns the recorded coordinates of each axis in ascending order.
    fn sorted(&self) -> Result<[Vec<f32>; 3]> {
        let of_axis = |axis: usize| {
            let all = self.entries.iter().map(|entry| entry[axis].load(Ordering::Relaxed)).filter(|&bits| bits != 0);
            let mut values = try_collect(all.map(|bits| f32::from_bits(bits as u32)))?;
            values.sort_unstable_by(f32::total_cmp);
            Ok(values)
        };
        Ok([of_axis(0)?, of_axis(1)?, of_axis(2)?])
    }
}

/// An acceleration structure of the triangles that meet a box, and the corners of the box.
pub struct Vicinity {
    accel: Accel,
    low: Vec3,
    high: Vec3,
}

impl Vicinity {
    /// Builds the structure of the triangles around the given positions. `all` is the structure of the scene, which has
    /// `count` triangles. Returns `None` if there are too few positions, if no triangle meets the box around them, or
    /// if more than `max` or more than `count / MIN_RATIO` triangles meet it.
    pub fn new(all: &Accel, count: usize, positions: &PositionReservoir, max: usize) -> Result<Option<Self>> {
        let sorted = positions.sorted()?;
        let Some(few) = sorted.iter().map(Vec::len).min().filter(|&n| n >= MIN_POSITIONS) else { return Ok(None) };
        let skipped = (few as f64 * BEYOND) as usize;
        let low = Vec3::from_array(sorted.each_ref().map(|values| values[skipped]));
        let high = Vec3::from_array(sorted.each_ref().map(|values| values[values.len() - 1 - skipped]));
        let (lowest, highest) = all.bounds();
        let largest = [low, high, lowest, highest].into_iter().fold(0.0, |max: f32, p| max.max(p.abs().max_element()));
        // Move the sides of the box outwards. In a room, the sides coincide with the walls, and vertices on the walls
        // must count as inside in spite of rounding.
        let margin = largest * MARGIN;
        let (low, high) = (low - margin, high + margin);
        let max = max.min(count / MIN_RATIO);
        let accel = all.part([low - margin, high + margin], max, Monitor::default().job())?;
        Ok(accel.map(|accel| Self { accel, low, high }))
    }

    /// Whether the box still fits the positions: at most the share `MAX_OUTSIDE` of the coordinates of each axis lies
    /// outside.
    pub fn fits(&self, positions: &PositionReservoir) -> Result<bool> {
        let sorted = positions.sorted()?;
        let outside = sorted.iter().zip(self.low.to_array()).zip(self.high.to_array()).map(|((values, low), high)| {
            let inside = values.partition_point(|&x| x <= high) - values.partition_point(|&x| x < low);
            1.0 - inside as f64 / values.len().max(1) as f64
        });
        Ok(outside.fold(0.0, f64::max) <= MAX_OUTSIDE)
    }

    #[inline]
    pub fn contains(&self, p: Vec3) -> bool {
        (p.cmpge(self.low) & p.cmple(self.high)).all()
    }

    /// Returns the nearest hit of a ray, if the ray starts in the box and the hit lies in the box. `None` means that
    /// only the structure of the whole scene can tell the nearest hit.
    #[inline]
    pub fn closest(&self, ray: &Ray, accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        if !self.contains(ray.origin) {
            return None;
        }
        self.accel.closest(ray, accept).filter(|hit| self.contains(ray.at(hit.t)))
    }

    /// Whether both ends of a segment are in the box.
    #[inline]
    pub fn contains_segment(&self, ray: &Ray) -> bool {
        self.contains(ray.origin) && self.contains(ray.at(ray.t_max))
    }

    pub fn accel(&self) -> &Accel {
        &self.accel
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    fn within(rng: &mut Rng, low: Vec3, high: Vec3) -> Vec3 {
        low + (high - low) * Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32())
    }

    /// Walls, floors and ceilings of 8 × 8 rooms of 4 × 3 × 4 m, as triangles, with a screen in the middle of each
    /// room. Walls between rooms end 5 cm below the ceiling.
    fn rooms() -> Vec<[Vec3; 3]> {
        let mut triangles = Vec::new();
        for (i, j) in (0..8).flat_map(|i| (0..8).map(move |j| (i, j))) {
            let at = Vec3::new(i as f32, 0.0, j as f32) * 4.0 - 16.0;
            let (x, y, z) = (Vec3::X * 4.0, Vec3::Y * 2.95, Vec3::Z * 4.0);
            let screen = at + Vec3::new(2.0, 0.0, 1.0);
            for (corner, u, v) in
                [(at, z, x), (at + Vec3::Y * 3.0, x, z), (at, x, y), (at, y, z), (screen, y * 0.7, z * 0.5)]
            {
                triangles.extend([[corner, corner + u, corner + u + v], [corner, corner + u + v, corner + v]]);
            }
        }
        triangles
    }

    #[test]
    fn hits_are_those_of_the_whole_scene() {
        let triangles = rooms();
        let all = Accel::build(&triangles, Monitor::default().job()).unwrap();
        let (low, high) = (Vec3::new(0.0, -16.0, 4.0), Vec3::new(4.0, -13.0, 8.0));
        let (mut rng, positions) = (Rng::new(3, &[]), PositionReservoir::new().unwrap());
        let is_none = |max| Vicinity::new(&all, triangles.len(), &positions, max).unwrap().is_none();
        assert!(is_none(usize::MAX));
        for _ in 0..5000 {
            // Most paths have their vertices on the walls of one room, a few go elsewhere.
            let p = within(&mut rng, low - 1.0, high + 1.0).clamp(low, high);
            let far = within(&mut rng, Vec3::splat(-16.0), Vec3::splat(16.0));
            positions.add(if rng.next_f32() < 0.002 { far } else { p }, f64::from(rng.next_f32()));
        }
        assert!(is_none(10));
        let near = Vicinity::new(&all, triangles.len(), &positions, usize::MAX).unwrap().unwrap();
        assert!((near.low - low).abs().max_element() < 1e-3 && (near.high - high).abs().max_element() < 1e-3);
        assert!(near.accel.bytes() * 4 < all.bytes(), "{} {}", near.accel.bytes(), all.bytes());
        let [mut answered, mut clear, mut blocked] = [0; 3];
        for _ in 0..5000 {
            let (from, to) = (within(&mut rng, low - 0.3, high + 0.3), within(&mut rng, low, high));
            let ray = Ray::new(from, to - from);
            if let Some(hit) = near.closest(&ray, |_| true) {
                assert_eq!(Some(hit), all.closest(&ray, |_| true));
                answered += 1;
            }
            let segment = Ray { t_max: 1.0, ..ray };
            if near.contains_segment(&segment) {
                let is_blocked = near.accel().occluded(&segment, |_| true);
                assert_eq!(is_blocked, all.occluded(&segment, |_| true));
                *if is_blocked { &mut blocked } else { &mut clear } += 1;
            }
        }
        assert!(answered > 2500 && clear > 1000 && blocked > 300, "{answered} {clear} {blocked}");
        // The box fits until many of the recorded positions lie outside.
        assert!(near.fits(&positions).unwrap());
        (0..5000).for_each(|_| positions.add(low + Vec3::X * 9.0, f64::from(rng.next_f32())));
        assert!(!near.fits(&positions).unwrap());
    }

    #[test]
    fn positions_do_not_depend_on_the_order_in_which_they_are_added() {
        let mut rng = Rng::new(4, &[]);
        let mut added: Vec<(Vec3, f64)> = Vec::new();
        for _ in 0..4000 {
            added.push((within(&mut rng, Vec3::splat(-5.0), Vec3::splat(5.0)), f64::from(rng.next_f32())));
        }
        let sorted = |added: &[(Vec3, f64)]| {
            let positions = PositionReservoir::new().unwrap();
            added.iter().for_each(|&(position, u)| positions.add(position, u));
            positions.sorted().unwrap()
        };
        let forwards = sorted(&added);
        added.reverse();
        assert!(forwards == sorted(&added) && forwards[0].len() > CAPACITY * 9 / 10);
        // The sample is uniform: the deciles of each axis are 1 m apart, with a standard error below 2 dm.
        for values in &forwards {
            for tenth in 1..10 {
                assert!((values[values.len() * tenth / 10] - (tenth as f32 - 5.0)).abs() < 0.8);
            }
        }
    }
}
