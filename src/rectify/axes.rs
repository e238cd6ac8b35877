//! Which of the vanishing points found are axes of the room, and the focal length that they imply.

use super::focal::FocalPrior;
use super::vanishing::VanishingPoint;
use crate::geometry::FocalSource;
use crate::maths;
use glam::{DVec2, DVec3};

/// Maximum cosine of the angle between two room axes before they are made orthogonal: they agree within 12 degrees, as
/// the walls of most rooms do. [convention]
const MAX_COSINE: f64 = 0.2;
/// Minimum focal length, as a share of the longer image side, that two vanishing points imply: a lens of 12 mm on film
/// 36 mm wide. [convention]
const MIN_FOCAL: f64 = 1.0 / 3.0;
/// Costs, on the scale of a chi-square, by which sets of vanishing points are compared: `MAX_UNUSUAL` bounds the cost
/// of a focal length far from the expected one, and is the cost of one that stays unknown; `LEFT_OUT_COST` is the cost
/// if all points are left out, each weighed by its number of lines over its error. [bench photos:tune]
const MAX_UNUSUAL: f64 = 3.0;
const LEFT_OUT_COST: f64 = 10.0;
/// Range of the ratio of the estimated focal length to its start value. An estimate outside this range is discarded:
/// the directions then do not determine the focal length. [convention: a factor of ten]
const FOCAL_CHANGE: std::ops::Range<f64> = 0.1..10.0;
/// Sets of points, given by their indices, that may be the axes.
const SETS: [&[usize]; 5] = [&[0, 1, 2], &[0, 1], &[0, 2], &[1, 2], &[0]];

/// A set of vanishing points that may be the axes, and the focal length that they imply.
pub struct Axes {
    pub points: Vec<usize>,
    pub focal: Focal,
    cost: f64,
}

/// The principal point, the given or expected focal length, and the size of the image, all in pixels.
pub struct Prior {
    pub principal: DVec2,
    pub given: Option<f64>,
    pub expected: FocalPrior,
    pub longer_side: f64,
}

impl Prior {
    /// Returns the vanishing points that are axes of the room, of at most three. A wrong point must not take part in
    /// the estimate of the focal length, on which the directions of the other points depend. So of all sets whose
    /// points are perpendicular at the focal length that they imply, this takes the one that leaves out little and
    /// implies a usual focal length.
    pub fn axes(&self, points: &[VanishingPoint]) -> Axes {
        let sets = SETS.iter().filter(|set| set.iter().all(|k| *k < points.len()));
        let best = sets.filter_map(|set| self.judge(points, set)).min_by(|a, b| a.cost.total_cmp(&b.cost));
        best.unwrap_or_else(|| Axes { points: Vec::new(), focal: self.focal_of(&[]), cost: 0.0 })
    }

    fn focal_of(&self, points: &[VanishingPoint]) -> Focal {
        focal_length(points, self.principal, self.given, self.expected)
    }

    /// The set of points with its cost; `None` if the points cannot all be axes. Two points imply some focal length
    /// even if one of them is no axis, so it must be plausible. Three points that agree confirm each other, and cost
    /// nothing.
    fn judge(&self, all: &[VanishingPoint], set: &[usize]) -> Option<Axes> {
        let points: Vec<VanishingPoint> = set.iter().map(|&k| all[k].clone()).collect();
        let focal = self.focal_of(&points);
        let rays: Vec<DVec3> = points.iter().map(|p| direction(p.point, self.principal, focal.focal)).collect();
        let are_perpendicular = (0..rays.len()).all(|i| rays[..i].iter().all(|r| r.dot(rays[i]).abs() < MAX_COSINE));
        let is_plausible = set.len() != 2 || self.given.is_some() || focal.focal >= MIN_FOCAL * self.longer_side;
        if !are_perpendicular || !is_plausible {
            return None;
        }
        let certainty = |points: &[VanishingPoint]| -> f64 {
            points.iter().map(|p| p.support as f64 / p.error.max(f64::EPSILON)).sum()
        };
        let deviations = maths::ln(focal.focal / self.expected.focal) / self.expected.spread;
        let unusual = match set.len() {
            3 => 0.0,
            _ if self.given.is_some() => 0.0,
            2 => (deviations * deviations).min(MAX_UNUSUAL),
            _ => MAX_UNUSUAL,
        };
        let left_out = LEFT_OUT_COST * (1.0 - certainty(&points) / certainty(all));
        Some(Axes { points: set.to_vec(), focal, cost: unusual + left_out })
    }
}

/// A focal length in pixels, the standard deviation of its logarithm, and its source.
pub struct Focal {
    pub focal: f64,
    pub spread: f64,
    pub source: FocalSource,
}

/// Returns the given focal length, or else an estimate from the vanishing points and the prior.
pub fn focal_length(points: &[VanishingPoint], principal: DVec2, given: Option<f64>, expected: FocalPrior) -> Focal {
    match (given, focal_from_points(points, principal, expected.focal)) {
        (Some(focal), _) => Focal { focal, spread: 0.0, source: FocalSource::Given },
        (None, Some((log_focal, spread))) => {
            // Combine the estimate with the prior, both weighted by inverse variance. The prior thus decides only
            // where the points constrain the focal length weakly.
            let (a, b) = (maths::powi(spread, -2), maths::powi(expected.spread, -2));
            let focal = maths::exp((log_focal * a + maths::ln(expected.focal) * b) / (a + b));
            let source = if a > b { FocalSource::VanishingPoints } else { expected.source };
            Focal { focal, spread: (a + b).sqrt().recip(), source }
        }
        (None, None) => Focal { focal: expected.focal, spread: expected.spread, source: expected.source },
    }
}

/// Estimates the logarithm of the focal length in pixels, and the standard deviation of this logarithm. `start` is a
/// first guess of the focal length in pixels. `None` if the points do not determine the focal length, or if the
/// estimate differs from `start` by more than a factor of 10.
///
/// The directions of two points `(v1, w1)` and `(v2, w2)` (homogeneous pixels) are orthogonal if
/// `(v1 - w1 c) · (v2 - w2 c) + f² w1 w2 = 0`, where `c` is the principal point. Each pair gives one such equation,
/// which is linear in f². Its weight is the inverse variance of the angle between the two directions. The iteration is
/// needed because the weights depend on f.
fn focal_from_points(points: &[VanishingPoint], principal: DVec2, start: f64) -> Option<(f64, f64)> {
    let mut square = start * start;
    let mut deviation = f64::INFINITY;
    for _ in 0..20 {
        let (mut information, mut right) = (0.0, 0.0);
        for (i, p) in points.iter().enumerate() {
            for q in &points[..i] {
                let (a, b) = (p.point.truncate() - principal * p.point.z, q.point.truncate() - principal * q.point.z);
                let focal = square.sqrt();
                let norm = a.extend(p.point.z * focal).length() * b.extend(q.point.z * focal).length();
                let (g, k) = (a.dot(b) / norm, p.point.z * q.point.z / norm);
                let weight = 1.0 / (p.error * p.error + q.error * q.error).max(1e-24);
                information += weight * k * k;
                right -= weight * g * k;
            }
        }
        let next = right / information;
        if !(next.is_finite() && next > 0.0) {
            return None;
        }
        deviation = (1.0 / information).sqrt() / (2.0 * next);
        let converged = (next / square - 1.0).abs() < 1e-12;
        square = next;
        if converged {
            break;
        }
    }
    (deviation.is_finite() && FOCAL_CHANGE.contains(&(square.sqrt() / start)))
        .then(|| (maths::ln(square) / 2.0, deviation.max(1e-9)))
}

/// Returns the unit direction in camera space whose vanishing point is the given homogeneous pixel.
pub fn direction(point: DVec3, principal: DVec2, focal: f64) -> DVec3 {
    (point.truncate() - principal * point.z).extend(point.z * focal).normalize()
}
