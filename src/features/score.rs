//! What makes a box room good: segments lie on faces that contain their direction (a vertical edge cannot be drawn on
//! the ceiling), and the seams between faces are where segments along them are.

use super::RoomView;
use super::layout::faces;
use crate::geometry::perspective::{HORIZONTAL_A, VERTICAL};
use glam::{DMat3, DVec2, DVec3};

/// The longest segments that are heard; more cannot change a layout.
pub const MAX_SEGMENTS: usize = 160;
/// Points tested along each segment, as shares of its length.
const POINTS: [f64; 3] = [0.15, 0.5, 0.85];
/// A segment on a face that cannot hold it counts this much against the box.
const IMPOSSIBLE: f64 = 1.5;
/// A segment on a seam counts this much more than one on a face.
const SEAM: f64 = 2.0;
/// Relative difference of the distances to two faces at which a segment is off their seam.
const SEAM_WIDTH: f64 = 0.03;

struct Witness {
    axis: usize,
    /// Rays, in room axes, to the points on the segment.
    rays: [DVec3; 3],
    /// Share of the length of all segments, in angle.
    weight: f64,
}

/// The classified segments of a view, as rays in room axes.
pub struct Evidence(Vec<Witness>);

impl Evidence {
    pub fn gather(room: &RoomView, axes: &DMat3, size: DVec2) -> Self {
        let to_room = axes.transpose();
        let camera = room.perspective;
        // One very long segment must not outvote the rest.
        let longest = 0.25 * size.length();
        let mut witnesses: Vec<Witness> = room
            .segments
            .iter()
            .filter_map(|(segment, axis)| {
                let axis = axis.filter(|&a| a < 3)?;
                let rays = POINTS.map(|t| to_room * camera.ray(segment.a.lerp(segment.b, t)));
                let weight = segment.length().min(longest);
                (weight > 0.0 && rays.iter().all(|r| r.is_finite())).then_some(Witness { axis, rays, weight })
            })
            .collect();
        witnesses.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        witnesses.truncate(MAX_SEGMENTS);
        let total: f64 = witnesses.iter().map(|w| w.weight).sum();
        witnesses.iter_mut().for_each(|w| w.weight /= total);
        Self(witnesses)
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Agreement of the segments with a box, at most 1 if none lies on a seam and `1 + SEAM` if all do.
    pub fn score(&self, sides: &[f64; 4]) -> f64 {
        let mut score = 0.0;
        for witness in &self.0 {
            let mut agreement = 0.0;
            for &ray in &witness.rays {
                let [(first, a), (second, b)] = faces(sides, ray);
                agreement += if first.axis() == witness.axis { -IMPOSSIBLE } else { 1.0 };
                // On a seam the two nearest faces are hit together, and the seam runs along the third axis.
                if first.axis() != witness.axis && second.axis() != witness.axis {
                    let off = (a - b) / (a * SEAM_WIDTH);
                    agreement += SEAM * (1.0 - off * off).max(0.0);
                }
            }
            score += witness.weight * agreement / POINTS.len() as f64;
        }
        score
    }

    /// Values of one side (left, right, ceiling, floor) at which segments could be the back wall's edge, the best
    /// supported first.
    pub fn candidates(&self, side: usize, count: usize) -> Vec<f64> {
        // The edge at a side wall is vertical, the one at ceiling or floor runs along the horizontal axis of the back wall.
        let (edge_axis, across) = if side < 2 { (VERTICAL, 0) } else { (HORIZONTAL_A, 1) };
        let sign = if side % 2 == 0 { -1.0 } else { 1.0 };
        let mut values: Vec<(f64, f64)> = (self.0.iter())
            .filter(|w| w.axis == edge_axis)
            .filter_map(|w| {
                let ray = w.rays[1];
                let value = sign * ray[across] / ray.z;
                (ray.z > 0.0 && (0.02..20.0).contains(&value)).then_some((value, w.weight))
            })
            .collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Support of each value: all within 4 %. The best is taken, its neighbours dropped, and so on.
        let support = |v: f64| values.iter().filter(|(u, _)| (u / v).ln().abs() < 0.04).map(|(_, w)| w).sum::<f64>();
        let mut ranked: Vec<(f64, f64)> = values.iter().map(|&(v, _)| (v, support(v))).collect();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut chosen: Vec<f64> = Vec::new();
        for (value, _) in ranked {
            if chosen.len() < count && chosen.iter().all(|c| (c / value).ln().abs() > 0.04) {
                chosen.push(value);
            }
        }
        chosen
    }
}
