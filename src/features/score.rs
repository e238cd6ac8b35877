//! Rates a box room. Segments must lie on faces that can contain their direction (a vertical edge cannot lie on the
//! ceiling); seams between faces should coincide with segments along them; the strokes of a plane should lie on a
//! single face.

use super::box_room::Face;
use super::grow::Surfaces;
use super::input::RoomView;
use super::strokes;
use crate::error::Result;
use crate::geometry::perspective::{HORIZONTAL_A, HORIZONTAL_B, VERTICAL};
use crate::image::try_collect;
use crate::job::Job;
use crate::maths;
use crate::simd::widest;
use glam::{DMat3, DVec2, DVec3};

/// Only this number of the longest segments is used; the other segments are ignored.
pub const MAX_SEGMENTS: usize = 160;
/// The weight of a segment grows with its length only up to this share of the photo's diagonal, so that a few long
/// segments do not outweigh all others. [bench features:layouts]
const MAX_LENGTH: f64 = 0.25;
/// Segments propose distances of a side of the box. Only distances within this range count, in units of the distance to
/// the back wall. The range is far wider than the range of the sides of rooms in photos (see `MIN_SIDE` of the search).
/// It excludes segments near the vanishing point and segments near a right angle to the view. [convention]
const PROPOSED_SIDES: std::ops::Range<f64> = 0.02..20.0;
/// Two segments propose the same distance of a side if the logarithms of their distances differ by less than this.
/// [bench features:layouts]
const SAME_SIDE: f64 = 0.04;
/// Sample points along each segment, as shares of its length. [bench features:layouts]
const POINTS: [f64; 3] = [0.15, 0.5, 0.85];
/// Penalty of a segment on a face that cannot contain it, relative to the segment's weight. [bench features:layouts]
const IMPOSSIBLE_PENALTY: f64 = 1.5;
/// Additional reward of a segment on a seam, relative to the reward of a segment on a face. [bench features:layouts]
const SEAM: f64 = 2.0;
/// A segment lies on the seam of two faces if the distances to both faces along its rays differ by less than this
/// share. [bench features:layouts]
const SEAM_WIDTH: f64 = 0.03;
/// `ON_PLANE`: reward if all positive strokes lie on one face of the box. `ELSEWHERE`: penalty if all negative strokes
/// lie on this face too. The agreement of two boxes with the segments usually differs by less than these values. So if
/// strokes and segments disagree, the strokes usually decide. [bench features:layouts]
const ON_PLANE: f64 = 2.0;
const ELSEWHERE: f64 = 1.0;
/// Weight of the surfaces over which strokes have grown, relative to the strokes. [bench photos:masks]
const GROWN: f64 = 0.5;
/// Number of partial sums that are computed in parallel. It is fixed, so that the order of additions does not depend
/// on the processor.
const LANES: usize = 8;

/// A segment and the room axis that it runs along, which decides which faces can contain it.
struct RoomSegment {
    axis: usize,
    /// Ray through the segment's midpoint, in room axes.
    middle: DVec3,
    /// Weight: the segment's share of the length of all used segments. A segment longer than `MAX_LENGTH` times the
    /// photo's diagonal counts with this length.
    weight: f64,
}

/// Sample points of the segments that run along one room axis. Each point has a ray. `own` holds the absolute value of
/// the ray's coordinate along this axis, `p` and `q` the coordinates along the two other axes ([`OTHERS`]). `weight`
/// holds the weights of the points.
#[derive(Default)]
struct Points {
    own: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
    weight: Vec<f64>,
}

/// The part of the view in which the rays' x and y have given signs in room axes, such as x < 0 (left) and y < 0 (up).
/// Its rays can hit only three faces of the box: one side wall, either the ceiling or the floor, and the back wall. The
/// distance of the back wall is always 1, so the score of a quadrant depends only on the distances of the two other
/// faces.
#[derive(Default)]
pub struct Quadrant {
    /// For each room axis, the sample points of the segments that run along it.
    points: [Points; 3],
    /// For each stroke sample: the absolute values of its ray's coordinates, and its weight in the score of the face
    /// that the ray hits. Samples of negative strokes have negative weights.
    stroke_samples: Vec<(DVec3, f64)>,
}

/// The evidence of a view about its box: the segments with their axes, and the strokes.
pub struct Evidence {
    segments: Vec<RoomSegment>,
    /// The quadrants of the view: left and up, right and up, left and down, right and down.
    pub quadrants: [Quadrant; 4],
    /// Whether the user marked a plane, that is, whether any stroke is positive.
    pub has_plane: bool,
}

/// For each axis, the two other axes.
const OTHERS: [[usize; 2]; 3] = [[VERTICAL, HORIZONTAL_B], [HORIZONTAL_A, HORIZONTAL_B], [HORIZONTAL_A, VERTICAL]];

impl Evidence {
    /// Collects the segments and strokes of a view; `axes` are the room's axes, with z along the viewing direction.
    pub fn gather(
        room: &RoomView,
        surfaces: Option<&Surfaces>,
        axes: &DMat3,
        [width, height]: [usize; 2],
        job: Job,
    ) -> Result<Self> {
        let to_room = axes.transpose();
        let ray = |p: DVec2| to_room * room.perspective.ray(p);
        let longest = MAX_LENGTH * DVec2::new(width as f64, height as f64).length();
        let mut used: Vec<(f64, usize, [DVec3; 3])> =
            try_collect(room.segments.iter().filter_map(|(segment, axis)| {
                let axis = axis.filter(|&a| a < 3)?;
                let rays = POINTS.map(|t| ray(segment.a.lerp(segment.b, t)));
                let length = segment.length();
                (length > 0.0 && rays.iter().all(|r| r.is_finite())).then_some((length, axis, rays))
            }))?;
        used.sort_by(|a, b| b.0.total_cmp(&a.0));
        used.truncate(MAX_SEGMENTS);
        let total: f64 = used.iter().map(|(length, ..)| length.min(longest)).sum();

        let mut quadrants: [Quadrant; 4] = Default::default();
        let mut segments = Vec::with_capacity(used.len());
        for (length, axis, rays) in used {
            let weight = length.min(longest) / total;
            segments.push(RoomSegment { axis, middle: rays[1], weight });
            for ray in rays {
                let (quadrant, size) = quadrant(ray);
                let [p, q] = OTHERS[axis];
                quadrants[quadrant].points[axis].push([size[axis], size[p], size[q]], weight / POINTS.len() as f64);
            }
        }
        quadrants.iter_mut().flat_map(|q| &mut q.points).for_each(Points::fill_up);

        // Negative strokes, which lie off the plane, are uninformative without a stroke on the plane.
        let stroke_samples = strokes::stroke_samples(room, &to_room, [width, height], job)?;
        let has_plane = stroke_samples.iter().any(|s| s.positive);
        let grown = surfaces.map(|s| strokes::surface_samples(s, room, &to_room, [width, height])).transpose()?;
        let grown = grown.iter().flatten().map(|sample| (sample, GROWN));
        let all = stroke_samples.iter().map(|sample| (sample, 1.0)).chain(grown);
        for (sample, share) in all.filter(|_| has_plane) {
            let (quadrant, size) = quadrant(sample.ray);
            let weight = if sample.positive { ON_PLANE } else { -ELSEWHERE };
            quadrants[quadrant].stroke_samples.push((size, share * weight * sample.weight));
        }
        Ok(Self { segments, quadrants, has_plane })
    }

    pub fn len(&self) -> usize {
        self.segments.len()
    }

    /// Returns the agreement of the segments with a box. It is at most 1 if no segment lies on a seam, and at most 1 +
    /// `SEAM` otherwise.
    pub fn score(&self, sides: &[f64; 4]) -> f64 {
        let agreement = |(i, quadrant): (usize, &Quadrant)| quadrant.lines(1.0 / sides[i % 2], 1.0 / sides[2 + i / 2]);
        self.quadrants.iter().enumerate().map(agreement).sum()
    }

    /// Returns the score of the strokes on the face on which it is highest, as if this face were their plane.
    pub fn strokes_on_best_face(&self, sides: &[f64; 4]) -> f64 {
        let mut counts = [0.0; Face::COUNT];
        for (i, quadrant) in self.quadrants.iter().enumerate() {
            let (wall, level) = (i % 2, 2 + i / 2);
            let [on_wall, on_level, on_back] = quadrant.strokes(1.0 / sides[wall], 1.0 / sides[level]);
            counts[wall] += on_wall;
            counts[level] += on_level;
            counts[Face::Back as usize] += on_back;
        }
        counts.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns up to `count` candidate distances of one side (left, right, ceiling or floor). If the side is at a
    /// candidate distance, its edge with the back wall coincides with a segment. Candidates with which more segments
    /// agree come first; segments count by their weights.
    pub fn candidates(&self, side: usize, count: usize) -> Vec<f64> {
        // The back wall's edge at a side wall is vertical; its edge at the ceiling or floor runs along the horizontal
        // axis of the back wall.
        let (edge_axis, across) = if side < 2 { (VERTICAL, 0) } else { (HORIZONTAL_A, 1) };
        let sign = if side.is_multiple_of(2) { -1.0 } else { 1.0 };
        let mut values: Vec<(f64, f64)> = (self.segments.iter())
            .filter(|w| w.axis == edge_axis)
            .filter_map(|w| {
                let value = sign * w.middle[across] / w.middle.z;
                (w.middle.z > 0.0 && PROPOSED_SIDES.contains(&value)).then_some((value, w.weight))
            })
            .collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        // The support of a value is the total weight of all values within `SAME_SIDE` of it. Take the best value, drop
        // the values within `SAME_SIDE` of it, and repeat.
        let support =
            |v: f64| values.iter().filter(|(u, _)| maths::ln(u / v).abs() < SAME_SIDE).map(|(_, w)| w).sum::<f64>();
        let mut ranked: Vec<(f64, f64)> = values.iter().map(|&(v, _)| (v, support(v))).collect();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut chosen: Vec<f64> = Vec::new();
        for (value, _) in ranked {
            if chosen.len() < count && chosen.iter().all(|c| maths::ln(c / value).abs() > SAME_SIDE) {
                chosen.push(value);
            }
        }
        chosen
    }
}

/// Returns the index of the quadrant to which a ray points, and the vector (|x|, |y|, z) of the ray's coordinates x, y
/// and z; a negative z becomes 0.
fn quadrant(ray: DVec3) -> (usize, DVec3) {
    let index = usize::from(ray.x >= 0.0) + 2 * usize::from(ray.y >= 0.0);
    (index, DVec3::new(ray.x.abs(), ray.y.abs(), ray.z.max(0.0)))
}

impl Quadrant {
    /// Returns the agreement of the segments with a box whose side wall is at the inverse distance `wall`, and whose
    /// ceiling or floor is at the inverse distance `level`.
    pub fn lines(&self, wall: f64, level: f64) -> f64 {
        let inverse = [wall, level, 1.0];
        let agreement = self.points.iter().zip(OTHERS).enumerate().map(|(axis, (points, [p, q]))| {
            agreement(&points.own, &points.p, &points.q, &points.weight, [inverse[axis], inverse[p], inverse[q]])
        });
        agreement.sum()
    }

    /// Returns the total weight of the stroke samples on each of the three faces of the quadrant: the side wall, the
    /// ceiling or floor, and the back wall. Samples of strokes on the user's plane count positively, samples of other
    /// strokes negatively.
    pub fn strokes(&self, wall: f64, level: f64) -> [f64; 3] {
        let mut counts = [0.0; 3];
        for (size, weight) in &self.stroke_samples {
            let inverse = [size.x * wall, size.y * level, size.z];
            let first = (1..3).fold(0, |first, i| if inverse[i] > inverse[first] { i } else { first });
            counts[first] += weight;
        }
        counts
    }
}

impl Points {
    fn push(&mut self, [own, p, q]: [f64; 3], weight: f64) {
        self.own.push(own);
        self.p.push(p);
        self.q.push(q);
        self.weight.push(weight);
    }

    /// Adds points of zero weight until the number of points is a multiple of `LANES`.
    fn fill_up(&mut self) {
        while !self.weight.len().is_multiple_of(LANES) {
            self.push([0.0, 1.0, 1.0], 0.0);
        }
    }
}

widest! {
/// Returns the weighted agreement of the sample points of the segments that run along one axis. `inverse` holds the
/// inverse distances of the faces perpendicular to this axis and to the two other axes. A ray hits the face for which
/// the product of coordinate and inverse distance is largest.
fn agreement(own: &[f64], p: &[f64], q: &[f64], weight: &[f64], inverse: [f64; 3]) -> f64 {
    let mut sums = [0.0; LANES];
    let others = p.chunks_exact(LANES).zip(q.chunks_exact(LANES));
    for ((own, (p, q)), weight) in own.chunks_exact(LANES).zip(others).zip(weight.chunks_exact(LANES)) {
        for lane in 0..LANES {
            let (own, p, q) = (own[lane] * inverse[0], p[lane] * inverse[1], q[lane] * inverse[2]);
            let (first, second) = if p > q { (p, q) } else { (q, p) };
            // A ray to a seam meets two faces at nearly the same distance. If these are the faces perpendicular to the
            // axes of `p` and `q`, the seam runs along the axis of the segments (`own`): add a bonus.
            let off = (first - second) / (first * SEAM_WIDTH);
            let near = 1.0 - off * off;
            let seam = if second >= own && near > 0.0 { SEAM * near } else { 0.0 };
            sums[lane] += weight[lane] * if own > first { -IMPOSSIBLE_PENALTY } else { 1.0 + seam };
        }
    }
    sums.iter().sum()
}
}
