//! The outline of a lamp at sub-texel precision: a texel centred on a point of the outline would be half covered by
//! light.
//!
//! The method is marching squares (Lorensen and Cline 1987) between the centres of texels. The outline passes between
//! each lit texel and each adjacent unlit one. Lit texels that have only a corner in common belong to one lamp.
//!
//! The coverages of the two texels determine where the outline crosses the line between their centres. If a straight
//! edge crosses only these two texels, the sum of both coverages gives the exact position. Linear interpolation of the
//! coverages to 0.5, as in common marching squares, would be off by up to 0.09 texels.
//!
//! Texels blunt the corners of a lamp. To restore a corner, its two sides are extended until they meet, if both are at
//! least two texels long.

use crate::emission::exemplar::components::Component;
use crate::geometry::polygon;
use glam::DVec2;

/// Simplification may move an outline by at most this distance, in texels. The value is for outlines that run between
/// the centres of texels. [rounding]
const TOLERANCE: f64 = 0.1;
/// Like `TOLERANCE`, but for outlines along the corners of texels. An oblique edge is a staircase in such an outline;
/// this tolerance turns the staircase into a straight line. Outlines run along the corners of texels for narrow lamps,
/// and if every texel is either fully lit or unlit. [rounding]
const STAIRCASE_TOLERANCE: f64 = 1.0;
/// Upper limit of `STAIRCASE_TOLERANCE` for narrow lamps, as a share of the lamp's width or height, whichever is
/// smaller. With a larger tolerance, simplification could remove a side of the lamp. [rounding]
const NARROW_TOLERANCE: f64 = 0.3;
/// An outline runs along the corners of texels if the lamp is at most this many texels wide. An outline between texel
/// centres would enclose only half of a single texel. [rounding]
const MAX_NARROW_WIDTH: f64 = 2.0;
/// Limits for restoring sharp corners; lengths are in texels. [rounding]
///
/// - `MIN_SIDE`: minimum length of a side whose direction is used. An end that is off by `TOLERANCE` turns a side of
///   this length by 3°, and a shorter side by more.
/// - `MAX_EXTENDED`: maximum length by which a side is extended. The outline is known only at its crossings with the
///   lines between texel centres. If the sides run along the rows and columns, a right-angled corner falsifies only the
///   crossings at the texel in which the corner lies. The last correct crossing of a side then lies on the centre line
///   of the next row or column, 0.5 to 1.5 texels away from the corner.
/// - `MAX_BLUNT`: maximum length of the blunt part between two sides. The blunt part runs from the last correct
///   crossing of one side to the first correct crossing of the next side, so it is rarely longer than two texels.
/// - `COS_CORNER`: cosine of 60°. At a corner, the outline must turn by at least 60° from one side to the next. A disc
///   gets no corners: its outline has sides of length `MIN_SIDE` only from a radius of 5 texels on. There,
///   `TOLERANCE` allows sides that span 23° each, so the outline turns by at most 46° from one side, over a blunt part,
///   to the next.
const MIN_SIDE: f64 = 2.0;
const MAX_BLUNT: f64 = 2.0;
const MAX_EXTENDED: f64 = 1.5;
const COS_CORNER: f64 = 0.5;
/// Tolerance, in texels, within which a restored corner may lie outside the texture because of rounding. [rounding]
const ROUNDING: f64 = 1e-6;

/// The outer boundary of a lamp, traversed along the edges of texels with the lamp on the right. Lengths are in texels.
/// Points are relative to `origin`, so that equal lamps have bit-identical outlines anywhere in the texture.
pub struct Ring {
    /// For each texel edge, the point at which the outline crosses the line between the centres of its two texels.
    crossings: Vec<DVec2>,
    /// For each texel edge, the texel corner at which it begins.
    corners: Vec<DVec2>,
    /// Whether any texel at the boundary is covered only in part.
    is_soft: bool,
    /// Width or height of the lamp, whichever is smaller.
    narrow: f64,
    /// First column and first row of the lamp.
    origin: DVec2,
}

impl Ring {
    /// Walks around a lamp and records its boundary. Both functions take the column and the row of a texel. `is_in`
    /// tells whether the texel belongs to the lamp. `coverage` gives the share of the texel that light covers: at least
    /// 0.5 for texels of the lamp, less for other texels, and `None` outside the texture, where the outline follows the
    /// border.
    pub fn walk(
        lamp: &Component,
        is_in: &dyn Fn([isize; 2]) -> bool,
        coverage: &dyn Fn([isize; 2]) -> Option<f64>,
    ) -> Self {
        // The first texel in reading order has its upper left corner on the outer boundary.
        let origin = lamp.min.map(|v| v as isize);
        let first = (lamp.min[0]..=lamp.max[0]).map(|x| [x as isize, origin[1]]).find(|&at| is_in(at));
        let start = first.unwrap_or(origin);
        let local = |at: [isize; 2]| DVec2::new((at[0] - origin[0]) as f64, (at[1] - origin[1]) as f64);

        // Begin in the direction of +x, with the lamp on the right. Only one texel of the lamp touches the start, so
        // the boundary passes through the start once, and the walk ends there. Where two lamp texels have only a corner
        // in common, turn left, from one texel to the other: both belong to the lamp.
        let (mut crossings, mut corners, mut is_soft) = (Vec::new(), Vec::new(), false);
        let (mut at, mut heading) = (start, [1isize, 0isize]);
        loop {
            let [inside, outside] = [1, -1].map(|side| beside(at, heading, side));
            let [light, beyond] = [coverage(inside).unwrap_or(1.0), coverage(outside).unwrap_or(f64::NAN)];
            is_soft |= light < 1.0 || beyond > 0.0;
            crossings.push(local(inside) + 0.5 + (local(outside) - local(inside)) * crossing(light, beyond));
            corners.push(local(at));
            at = [at[0] + heading[0], at[1] + heading[1]];
            if at == start {
                break;
            }
            heading = match [-1, 1].map(|side| is_in(beside(at, heading, side))) {
                [true, _] => [heading[1], -heading[0]],
                [false, true] => heading,
                [false, false] => [-heading[1], heading[0]],
            };
        }
        let narrow = lamp.size()[0].min(lamp.size()[1]) as f64;
        Self { crossings, corners, is_soft, narrow, origin: DVec2::new(origin[0] as f64, origin[1] as f64) }
    }

    /// Returns the corners of the outline in a texture of the given size, and the lamp's extents along and across
    /// `axis`. Both are in texels.
    pub fn outline(self, axis: DVec2, texture: DVec2) -> (Vec<DVec2>, DVec2) {
        let Self { mut crossings, corners, is_soft, narrow, origin } = self;
        let mut outline = if is_soft && narrow > MAX_NARROW_WIDTH {
            // Simplification depends on where the outline begins, and equal lamps should get equal outlines. So begin
            // at the point farthest from the centre, which is the same point of the lamp in every orientation.
            let middle = crossings.iter().sum::<DVec2>() / crossings.len() as f64;
            let first = farthest(&crossings, middle);
            crossings.rotate_left(first);
            let outline = with_corners(&simplified(crossings.clone(), TOLERANCE), [-origin, texture - origin]);
            crossings.extend(&outline);
            outline
        } else {
            simplified(corners, staircase(narrow))
        };
        let size = DVec2::new(polygon::extent(&crossings, axis), polygon::extent(&crossings, axis.perp()));
        outline.iter_mut().for_each(|p| *p += origin);
        (outline, size)
    }
}

/// Tolerance, in texels, for simplifying an outline along the corners of texels. `narrow` is the width or height of the
/// lamp in texels, whichever is smaller.
pub fn staircase(narrow: f64) -> f64 {
    STAIRCASE_TOLERANCE.min(NARROW_TOLERANCE * narrow)
}

/// The texel diagonally ahead of a walk that is at the texel corner `at` and moves in direction `heading`: the texel on
/// the right if `side` is 1, on the left if `side` is -1.
fn beside(at: [isize; 2], heading: [isize; 2], side: isize) -> [isize; 2] {
    [
        at[0] + (heading[0] - 1 - side * heading[1]).div_euclid(2),
        at[1] + (heading[1] - 1 + side * heading[0]).div_euclid(2),
    ]
}

/// The outline crosses the line from the centre of a lit texel to the centre of an adjacent unlit texel. Returns the
/// distance of the crossing from the lit centre, in texels. `light` and `beyond` are the coverages of the lit and the
/// unlit texel. `beyond` is NaN outside the texture, where the outline follows the border.
fn crossing(light: f64, beyond: f64) -> f64 {
    let step = light - beyond;
    match () {
        () if beyond.is_nan() => 0.5,
        // If a sharp straight edge crosses only these two texels, their lit areas add up to its distance from the far
        // side of the lit texel. If the edge is blurred over more texels, coverage falls linearly from `light` by
        // `step` per texel and reaches 0.5 at the edge. For a step of 0.5, both formulas agree.
        () if step > 0.5 => light + beyond - 0.5,
        () => ((light - 0.5) / step.max(f64::MIN_POSITIVE)).min(1.0),
    }
}

/// The index of the point farthest from a given point.
fn farthest(points: &[DVec2], from: DVec2) -> usize {
    let distance = |i: &usize| points[*i].distance_squared(from);
    (0..points.len()).max_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

/// Simplifies a closed outline (Douglas and Peucker 1973): drops points that are at most `tolerance` away from the line
/// between the kept points before and after them.
pub fn simplified(mut points: Vec<DVec2>, tolerance: f64) -> Vec<DVec2> {
    // Split the outline at the point farthest from the first, then simplify both halves.
    let far = points.first().map_or(0, |first| farthest(&points, *first));
    let mut kept = vec![false; points.len() + 1];
    (kept[0], kept[far]) = (true, true);
    points.push(points[0]);
    simplify(&points, 0, far, tolerance, &mut kept);
    simplify(&points, far, points.len() - 1, tolerance, &mut kept);
    points.iter().zip(&kept).take(points.len() - 1).filter(|(_, k)| **k).map(|(c, _)| *c).collect()
}

/// Marks in `kept` the points between the kept points `first` and `last` that simplification must keep. Takes the point
/// farthest from the line between `first` and `last`. If its distance exceeds `tolerance`, keeps the point, and repeats
/// this for the parts before and after it.
fn simplify(points: &[DVec2], first: usize, last: usize, tolerance: f64, kept: &mut [bool]) {
    let mut open = vec![(first, last)];
    while let Some((a, b)) = open.pop() {
        let along = (points[b] - points[a]).normalize_or_zero();
        let distance = |i: usize| {
            let d = points[i] - points[a];
            (d - along * d.dot(along)).length()
        };
        let worst = (a + 1..b).map(|i| (i, distance(i))).max_by(|p, q| p.1.total_cmp(&q.1));
        if let Some((i, _)) = worst.filter(|w| w.1 > tolerance) {
            kept[i] = true;
            open.extend([(a, i), (i, b)]);
        }
    }
}

/// Replaces the blunt corners of a closed outline by sharp ones, except where the sharp corner would lie outside the
/// texture. `first` and `last` are the upper left and the lower right corner of the texture.
fn with_corners(ring: &[DVec2], [first, last]: [DVec2; 2]) -> Vec<DVec2> {
    let n = ring.len();
    let point = |i: usize| ring[i % n];
    let is_side = |i: usize| point(i).distance(point(i + 1)) >= MIN_SIDE;
    let Some(begin) = (0..n).find(|&i| is_side(i)) else { return ring.to_vec() };
    let is_within = |corner: &DVec2| corner.distance(corner.clamp(first, last)) < ROUNDING;

    // Go around the outline once. In each step, replace the part between the end of one long side and the start of the
    // next long side by a corner, if possible.
    let mut out = Vec::new();
    let mut side = begin;
    while side < begin + n {
        let (end, mut next) = (side + 1, side + 1);
        while !is_side(next) {
            next += 1;
        }
        let between: Vec<DVec2> = (end..=next).map(point).collect();
        let corner = corner([point(side), point(end)], [point(next), point(next + 1)], &between);
        match corner.filter(is_within) {
            Some(corner) => out.push(corner.clamp(first, last)),
            None => out.extend(between),
        }
        side = next;
    }
    out
}

/// The sharp corner at which the side from `a` to `end` and the next side, from `start` to `b`, would meet. `between`
/// holds the points of the outline from `end` to `start`. `None` if the sides already meet, if they turn too little, or
/// if the blunt part or one of the two extensions is too long.
fn corner([a, end]: [DVec2; 2], [start, b]: [DVec2; 2], between: &[DVec2]) -> Option<DVec2> {
    let length: f64 = between.windows(2).map(|w| w[0].distance(w[1])).sum();
    let (u, v) = ((end - a).normalize(), (b - start).normalize());
    if length == 0.0 || length > MAX_BLUNT || u.dot(v) > COS_CORNER {
        return None;
    }
    // Extend the first side by s along its direction u, and the second side backwards by t along its direction v. They
    // meet where end + s u = start - t v.
    let (gap, cross) = (start - end, u.perp_dot(v));
    let (s, t) = (gap.perp_dot(v) / cross, u.perp_dot(gap) / cross);
    let is_near = |d: f64| (0.0..=MAX_EXTENDED).contains(&d);
    (is_near(s) && is_near(t)).then(|| end + u * s)
}
