//! Distances between a vanishing point and a line (§5.2). The points are homogeneous, so all distances are exact for
//! points at infinity. For such points, the paper's distance (Eq. 2) may be infinite; the other distances are finite.

use crate::geometry::Segment;
use glam::{DVec2, DVec3};

/// A segment prepared for distances to homogeneous points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Midpoint `C`.
    pub centre: DVec2,
    /// Unit direction.
    pub direction: DVec2,
    /// Half the length; `x` in the paper.
    pub half: f64,
    /// Homogeneous line with a unit normal: `line · (x, y, 1)` is the signed distance of a point.
    pub line: DVec3,
}

impl Line {
    /// `None` for a segment of zero length or with non-finite coordinates.
    pub fn new(segment: &Segment) -> Option<Self> {
        let length = segment.length();
        if !(length.is_finite() && length > 0.0) {
            return None;
        }
        let centre = segment.midpoint();
        let direction = (segment.b - segment.a) / length;
        let normal = direction.perp();
        let line = normal.extend(-normal.dot(centre));
        line.is_finite().then_some(Self { centre, direction, half: length / 2.0, line })
    }

    /// Sine of the angle between the segment and the line from its midpoint to `p`; 0 if `p` is the midpoint.
    pub fn sine(&self, p: DVec3) -> f64 {
        let away = p.truncate() - self.centre * p.z;
        let distance = away.length();
        if distance > 0.0 { (self.direction.perp_dot(away) / distance).abs() } else { 0.0 }
    }

    /// Distance of the segment's endpoints from the line through its midpoint and `p`; at most [`Self::half`].
    pub fn endpoint_distance(&self, p: DVec3) -> f64 {
        self.half * self.sine(p)
    }

    /// The paper's metric, Eq. 2: `min(d_naive, d_vanishing)`, with `d_vanishing = x / y * d_naive`. `d_naive` is the
    /// distance of `p` from the line, and `x` is half the length of the segment. `y` is the distance along the line
    /// from the segment's midpoint to the point nearest to `p`. The metric is 0 if `p` lies on the line.
    pub fn printed_distance(&self, p: DVec3) -> f64 {
        let away = p.truncate() - self.centre * p.z;
        let across = self.direction.perp_dot(away).abs();
        if across == 0.0 {
            return 0.0;
        }
        // If one denominator is zero, the division yields infinity and `min` selects the other distance. If both are
        // zero, the metric is infinite.
        (across / p.z.abs()).min(self.half * across / self.direction.dot(away).abs())
    }
}

/// Clips the line through a segment to the image: `s` in the paper. `None` if the line misses the image.
pub fn visible(segment: &Segment, width: f64, height: f64) -> Option<Segment> {
    let line = Line::new(segment)?;
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for (start, direction, size) in
        [(line.centre.x, line.direction.x, width), (line.centre.y, line.direction.y, height)]
    {
        if direction == 0.0 {
            if !(0.0..=size).contains(&start) {
                return None;
            }
            continue;
        }
        let (t0, t1) = (-start / direction, (size - start) / direction);
        (low, high) = (low.max(t0.min(t1)), high.min(t0.max(t1)));
    }
    let at = |t: f64| line.centre + line.direction * t;
    (low < high).then(|| Segment { a: at(low), b: at(high) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(a: [f64; 2], b: [f64; 2]) -> Line {
        Line::new(&Segment { a: a.into(), b: b.into() }).unwrap()
    }

    #[test]
    fn distances_meet_their_closed_forms() {
        let l = line([0.0, 0.0], [2.0, 0.0]);
        // The line from the midpoint C = (1, 0) to P = (4, 4) has the slope 4/3.
        let p = DVec3::new(4.0, 4.0, 1.0);
        assert!((l.sine(p) - 0.8).abs() < 1e-15);
        assert!((l.endpoint_distance(p) - 0.8).abs() < 1e-15);
        assert!((l.printed_distance(p) - 4.0 / 3.0).abs() < 1e-15);
        // Near the middle of the segment, the naive distance is the smaller.
        assert!((l.printed_distance(DVec3::new(1.1, 0.3, 1.0)) - 0.3).abs() < 1e-15);
        // The sine does not depend on the scale and sign of the homogeneous point.
        assert_eq!(l.sine(p), l.sine(p * -2.0));
    }

    #[test]
    fn points_at_infinity_and_on_the_midpoint_are_exact() {
        let l = line([0.0, 1.0], [2.0, 1.0]);
        assert_eq!(l.printed_distance(DVec3::X), 0.0);
        assert_eq!(l.endpoint_distance(DVec3::X), 0.0);
        assert_eq!(l.endpoint_distance(DVec3::Y), 1.0);
        assert_eq!(l.printed_distance(DVec3::Y), f64::INFINITY);
        assert_eq!(l.printed_distance(DVec3::new(1.0, 1.0, 1.0)), 0.0);
        assert_eq!(l.sine(DVec3::new(1.0, 1.0, 1.0)), 0.0);
        // A point 1e12 px away at a slope of 1e-6, seen from the midpoint of a segment of half-length 1.
        assert!((l.endpoint_distance(DVec3::new(1e12, 1e6, 1.0)) - 1e-6).abs() < 1e-12);
    }

    #[test]
    fn degenerate_segments_are_no_lines() {
        for (a, b) in [([1.0, 1.0], [1.0, 1.0]), ([f64::NAN, 0.0], [1.0, 0.0]), ([f64::INFINITY, 0.0], [0.0, 0.0])] {
            assert!(Line::new(&Segment { a: a.into(), b: b.into() }).is_none());
        }
    }

    #[test]
    fn the_visible_line_ends_at_the_border() {
        let s = visible(&Segment { a: DVec2::new(4.0, 4.0), b: DVec2::new(5.0, 5.0) }, 10.0, 8.0).unwrap();
        assert!(s.a.distance(DVec2::ZERO) < 1e-12 && s.b.distance(DVec2::splat(8.0)) < 1e-12);
        assert!(visible(&Segment { a: DVec2::new(-4.0, 4.0), b: DVec2::new(-4.0, 5.0) }, 10.0, 8.0).is_none());
    }
}
