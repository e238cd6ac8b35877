//! Corrects a view so that the plane of the lamps has the tilt that was estimated from the lamps.

use super::evidence::Evidence;
use super::lattice::Lattice;
use super::search::TiltEstimate;
use super::tilt::Tilt;
use crate::geometry::{FocalSource, Perspective, Segment};
use crate::maths;
use crate::rectify::sphere::{Frame, WeightedLine, project, refine, rms_angle, round_covariance};
use crate::rectify::{VanishingPoint, View, camera, manhattan};
use glam::{DMat3, DVec3};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

/// Limits for accepting the correction of a tilt by the lines. `MAX_LOSS`: maximum increase of the lamps' cost over
/// the cost with the uncorrected tilt. `MIN_EXPLAINED`: minimum score of the corrected axes; the score is about the
/// share of the lines that run along the axes. [bench photos:tune]
const MAX_LOSS: f64 = 2.0;
const MIN_EXPLAINED: f64 = 0.5;
/// Number of rotations about the normal that are tried within a right angle. [convention]
const ROTATIONS: usize = 360;
/// Minimum number of segments along a direction; with fewer segments, the rotation about the normal counts as unknown.
/// [convention]
const MIN_SUPPORT: usize = 3;

impl View {
    /// Returns the view whose plane has the tilt in `found`. The axes are rotated about the plane's normal so that
    /// most lines run along them.
    pub(super) fn retilted(&self, found: &TiltEstimate, lamps: &Evidence, [width, height]: [usize; 2]) -> View {
        let frame = Frame::new(width, height, self.perspective.principal);
        let (segments, lens): (Vec<Segment>, _) =
            (self.segments.iter().map(|s| s.0).collect(), self.perspective.lens());
        let straight: Vec<_> = segments.iter().map(|s| Segment { a: lens.ideal(s.a), b: lens.ideal(s.b) }).collect();
        let indexed = frame.weighted_lines(&straight);
        let lines: Vec<WeightedLine> = indexed.iter().map(|(_, line)| *line).collect();

        // Rotate the axes to run along the lines. Then let the lines correct the axes and the focal length, and keep
        // the correction only if enough lines and the lamps agree with it.
        let start = turned(&lines, found.tilt.normal, found.tilt.focal / frame.scale);
        let corrected = manhattan::polished(&lines, start, found.tilt.focal / frame.scale);
        let tilt = Tilt { normal: corrected.axes.col(0), focal: corrected.focal * frame.scale };
        let agrees = corrected.score > MIN_EXPLAINED && lamps.cost(&tilt) < lamps.cost(&found.tilt) + MAX_LOSS;
        let (directions, Tilt { normal, focal }) = if agrees { (corrected.axes, tilt) } else { (start, found.tilt) };
        let axes = named(directions);

        let is_known = found.focal_spread < self.expected_focal.spread * FRAC_1_SQRT_2;
        let focal_source = if is_known { FocalSource::Lamps } else { self.expected_focal.source };
        let perspective = Perspective { focal, focal_source, axes, ..self.perspective };
        let members = members(&indexed, &axes, focal / frame.scale, segments.len());
        let vanishing_points = [0, 1, 2].map(|axis| {
            let direction = axes.col(axis);
            let support = members.iter().filter(|member| **member == Some(axis)).count();
            let mut covariance = found.covariance;
            if direction.dot(normal).abs() < FRAC_1_SQRT_2 {
                // Covariance of a direction within the plane: the covariance of the normal plus the covariance of the
                // rotation about the normal. The lines along the direction determine this rotation.
                let own = (support >= MIN_SUPPORT).then(|| refine(&lines, direction, focal / frame.scale)).flatten();
                covariance += round_covariance(direction, own.map_or(camera::FREE_ERROR, |r| rms_angle(&r.covariance)));
            }
            let point = perspective.vanishing_point(axis).normalize();
            VanishingPoint { point, support, error: rms_angle(&covariance), covariance }
        });
        let segments = segments.into_iter().zip(members).collect();
        // The lamps and the prior determine the focal length at least as well as the prior alone.
        let focal_spread = found.focal_spread.min(self.expected_focal.spread);
        let lattice_lamps = lamps.lattice.as_ref().map_or(0, Lattice::count);
        View {
            segments,
            vanishing_points,
            perspective,
            focal_spread,
            squareness: [None; 3],
            lattice_lamps,
            ..self.clone()
        }
    }
}

/// Returns for each segment the axis along which it runs; `None` if it runs along no axis.
fn members(lines: &[(usize, WeightedLine)], axes: &DMat3, focal: f64, count: usize) -> Vec<Option<usize>> {
    let points = [0, 1, 2].map(|axis| project(axes.col(axis), focal));
    let mut members = vec![None; count];
    for (index, line) in lines {
        let agreements = points.iter().map(|&point| line.agreement(point)).enumerate();
        let best = agreements.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|best| best.1 > 0.0);
        members[*index] = best.map(|(axis, _)| axis);
    }
    members
}

/// Returns the normal, and the two orthogonal directions within its plane along which most of the lines run.
fn turned(lines: &[WeightedLine], normal: DVec3, focal: f64) -> DMat3 {
    let along = normal.any_orthonormal_vector();
    let directions = |k: usize| {
        let angle = k as f64 / ROTATIONS as f64 * FRAC_PI_2;
        let right = maths::rotation_about(normal, angle) * along;
        [right, normal.cross(right)]
    };
    let explained = |k: usize| -> f64 {
        let points = directions(k).map(|d| project(d, focal));
        lines.iter().map(|line| line.weight * points.iter().map(|&p| line.agreement(p)).fold(0.0, f64::max)).sum()
    };
    let best = (0..ROTATIONS).max_by(|&a, &b| explained(a).total_cmp(&explained(b))).unwrap_or(0);
    let [right, down] = directions(best);
    DMat3::from_cols(normal, right, down)
}

/// Orders and orients orthogonal directions as room axes. The direction nearest the image's vertical becomes the
/// vertical axis and points down. Of the two others, the direction nearest the viewing direction points ahead.
fn named(directions: DMat3) -> DMat3 {
    let mut directions = [0, 1, 2].map(|k| directions.col(k));
    directions.sort_by(|a, b| b.y.abs().total_cmp(&a.y.abs()));
    let [down, mut ahead, other] = directions;
    if other.z.abs() > ahead.z.abs() {
        ahead = other;
    }
    let down = if down.y < 0.0 { -down } else { down };
    let ahead = if ahead.z < 0.0 { -ahead } else { ahead };
    DMat3::from_cols(down.cross(ahead), down, ahead)
}
