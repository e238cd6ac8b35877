//! Estimates the camera from vanishing points: focal length and orthonormal room axes, given the principal point.

use super::axes::{Axes, Focal, Prior, direction, focal_length};
use super::focal::FocalPrior;
use super::params::Params;
use super::sphere::{Refined, round_covariance};
use super::squareness::{self, Squareness};
use super::vanishing::{Vanishing, VanishingPoint};
use crate::geometry::linear::symmetric_eigen;
use crate::geometry::perspective::{HORIZONTAL_A, HORIZONTAL_B, VERTICAL};
use crate::geometry::{FocalSource, Perspective};
use crate::maths;
use glam::{DMat3, DVec3};

/// Standard deviation, in radians, of an axis that no line determines and only a convention fixes (for instance, that
/// the camera is upright). [convention]
pub const FREE_ERROR: f64 = 0.5;

/// The estimated camera, with the vanishing point of each room axis.
pub struct EstimatedCamera {
    pub perspective: Perspective,
    /// Standard deviation of the logarithm of the focal length; 0 if the caller gave the focal length.
    pub focal_spread: f64,
    pub vanishing_points: [VanishingPoint; 3],
    pub squareness: [Option<Squareness>; 3],
    /// The prior of the focal length.
    pub expected: FocalPrior,
    /// For each input vanishing point, the index of the room axis to which it was assigned; `None` if it was not
    /// assigned.
    pub axis_of: Vec<Option<usize>>,
}

/// Assigns the vanishing points to room axes, estimates the focal length and makes the axes orthonormal.
pub fn orient(found: &Vanishing, width: usize, height: usize, params: &Params) -> EstimatedCamera {
    let principal = params.principal(width, height);
    let expected = FocalPrior::new(params, width);
    let orthogonal = &found.points[..found.points.len().min(3)];
    let prior = Prior { principal, given: params.focal, expected, longer_side: width.max(height) as f64 };
    let Axes { points: chosen, focal, .. } = prior.axes(orthogonal);
    let Focal { focal, spread: focal_spread, source } = focal;
    let ray = |p: &VanishingPoint| direction(p.point, principal, focal);

    // Name the axes: the direction nearest the image's vertical becomes the vertical axis. Of the other two, the
    // direction nearest the viewing direction becomes the second horizontal axis. With fewer than three directions, the
    // vertical axis needs a direction within 45 degrees of the image's vertical. A single horizontal direction becomes
    // the second horizontal axis if it is within 45 degrees of the viewing direction, else the first.
    let mut named: [Option<usize>; 3] = [None; 3];
    let take = |from: &mut Vec<usize>, value: &dyn Fn(DVec3) -> f64| {
        let best = (0..from.len())
            .max_by(|&a, &b| value(ray(&orthogonal[from[a]])).total_cmp(&value(ray(&orthogonal[from[b]]))));
        best.map(|b| from.remove(b))
    };
    let mut rest = chosen.clone();
    let is_vertical = |d: DVec3| d.y.abs() > std::f64::consts::FRAC_1_SQRT_2;
    if chosen.len() == 3 || chosen.iter().any(|&c| is_vertical(ray(&orthogonal[c]))) {
        named[VERTICAL] = take(&mut rest, &|d| d.y.abs());
    }
    let looks_along = |d: DVec3| d.z.abs() > std::f64::consts::FRAC_1_SQRT_2;
    if rest.len() == 2 || rest.first().is_some_and(|&c| looks_along(ray(&orthogonal[c]))) {
        named[HORIZONTAL_B] = take(&mut rest, &|d| d.z.abs());
    }
    named[HORIZONTAL_A] = rest.pop();

    let axes = orthonormal(named.map(|n| n.map(|k| (ray(&orthogonal[k]), orthogonal[k].error))));
    let perspective = Perspective { focal, focal_source: source, principal, bend: 0.0, axes };
    let vanishing_points = std::array::from_fn(|axis| match named[axis] {
        Some(k) => orthogonal[k].clone(),
        None => {
            let error = named.iter().flatten().map(|&k| maths::powi(orthogonal[k].error, 2)).sum::<f64>().sqrt();
            let error = if named.iter().flatten().count() == 2 { error } else { FREE_ERROR };
            VanishingPoint {
                point: perspective.vanishing_point(axis).normalize(),
                support: 0,
                error,
                covariance: round_covariance(axes.col(axis), error),
            }
        }
    });
    let as_axis = |r: &Refined, axis: usize| {
        let turned = if r.direction.dot(axes.col(axis)) < 0.0 { -r.direction } else { r.direction };
        Refined { direction: turned, ..*r }
    };
    let free = [0, 1, 2].map(|axis| named[axis].map(|k| as_axis(&found.free[k], axis)));
    let squareness = squareness::measure(&free, found.focal, params.focal.is_some(), expected);
    let axis_of = (0..found.points.len()).map(|k| named.iter().position(|&n| n == Some(k))).collect();
    EstimatedCamera { perspective, focal_spread, vanishing_points, squareness, expected, axis_of }
}

/// Re-estimates the camera from the vanishing points of its axes, ignoring points that no segment supports.
pub fn reestimate(camera: &Perspective, points: &[VanishingPoint; 3], expected: FocalPrior) -> Perspective {
    let known: Vec<VanishingPoint> = points.iter().filter(|v| v.support > 0).cloned().collect();
    let given = (camera.focal_source == FocalSource::Given).then_some(camera.focal);
    let Focal { focal, .. } = focal_length(&known, camera.principal, given, expected);
    let axes = orthonormal(
        points.each_ref().map(|p| (p.support > 0).then(|| (direction(p.point, camera.principal, focal), p.error))),
    );
    Perspective { focal, axes, ..*camera }
}

/// Returns the rotation nearest to the given directions, each weighted by its certainty (Wahba's problem, solved by
/// polar decomposition). Missing directions follow from orthogonality, then from the assumption of an upright camera.
fn orthonormal(directions: [Option<(DVec3, f64)>; 3]) -> DMat3 {
    let [a, down, ahead] = directions;
    let down = down.map(|(d, e)| (if d.y < 0.0 { -d } else { d }, e));
    let ahead = ahead.map(|(d, e)| (if d.z < 0.0 { -d } else { d }, e));
    let across = |from: DVec3, d: DVec3| (d - from * from.dot(d)).normalize_or(from.any_orthonormal_vector());
    let free = |d: DVec3| (d, FREE_ERROR);
    let upright = |d: DVec3| if d.y < 0.0 { -d } else { d };
    let (down, ahead) = match (a, down, ahead) {
        (_, Some(down), Some(ahead)) => (down, ahead),
        (Some((a, _)), Some(down), None) => {
            let ahead = across(down.0, down.0.cross(a).normalize_or(DVec3::Z));
            (down, free(if ahead.z < 0.0 { -ahead } else { ahead }))
        }
        (Some((a, _)), None, Some(ahead)) => (free(upright(across(ahead.0, ahead.0.cross(a)))), ahead),
        (None, Some(down), None) => (down, free(across(down.0, DVec3::Z))),
        (None, None, Some(ahead)) => (free(upright(across(ahead.0, DVec3::Y))), ahead),
        (Some((a, _)), None, None) => {
            let down = upright(across(a, DVec3::Y));
            let ahead = a.cross(down);
            (free(down), free(if ahead.z < 0.0 { -ahead } else { ahead }))
        }
        (None, None, None) => (free(DVec3::Y), free(DVec3::Z)),
    };
    let right = down.0.cross(ahead.0);
    let a = a.map_or((right, FREE_ERROR), |(d, e)| (if d.dot(right) < 0.0 { -d } else { d }, e));
    polar([a, down, ahead])
}

/// Returns the rotation `M (Mᵀ M)^(-1/2)`. The columns of `M` are the given directions, each divided by its error.
fn polar(columns: [(DVec3, f64); 3]) -> DMat3 {
    // Limit the ratio of weights to 1e4: a larger ratio would only lose precision.
    let min_error = columns.iter().map(|c| c.1).fold(f64::INFINITY, f64::min).max(1e-12);
    let scaled = columns.map(|(d, e)| d * (min_error / e.max(min_error)).max(1e-4));
    let gram = std::array::from_fn(|r| std::array::from_fn(|c| scaled[r].dot(scaled[c])));
    let (values, vectors) = symmetric_eigen::<3>(gram);
    let mut inverse_root = DMat3::ZERO;
    for (value, vector) in values.iter().zip(vectors) {
        let v = DVec3::from_array(vector);
        inverse_root += DMat3::from_cols(v * v.x, v * v.y, v * v.z) * (1.0 / value.max(1e-300).sqrt());
    }
    let rotation = DMat3::from_cols(scaled[0], scaled[1], scaled[2]) * inverse_root;
    // Remove the rounding error that unequal weights leave.
    let ahead = rotation.z_axis.normalize();
    let down = (rotation.y_axis - ahead * ahead.dot(rotation.y_axis)).normalize();
    DMat3::from_cols(down.cross(ahead), down, ahead)
}
