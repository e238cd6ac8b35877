//! Refines one vanishing point on the Gaussian sphere, and measures its agreement with lines and its covariance.
//!
//! The paper ("Lighting Style Transfer", §5.2) optimises `alpha = 1 - 1 / (rho + 1)` instead, where rho is the
//! distance of the point from the principal point. On the sphere, points at infinity are ordinary points, and the
//! coordinates are well conditioned at every point.

use super::biweight::Biweight;
use super::metric::Line;
use crate::geometry::{Segment, linear::symmetric_eigen};
use crate::maths;
use glam::{DMat3, DVec2, DVec3};

/// Limit of the distance `d` of a segment's endpoints from the line through its midpoint and a vanishing point. The
/// unit is half the image's longer side; the limit is about 2 pixels in an image of 640 × 480 pixels. A segment belongs
/// to a vanishing point if `(d / ENDPOINT_LIMIT)² + (s / SINE_LIMIT)² ≤ 1`. The AUC@10 that the bench prints (area
/// under the curve of recall up to an error of 10 degrees) is best for limits of 1 to 2 pixels. [bench vp]
const ENDPOINT_LIMIT: f64 = 0.006;
/// Limit of the sine `s` of the angle between a segment and the line from its midpoint to a vanishing point. It matters
/// for short segments, whose `d` is small at every angle. [bench vp:segments]
const SINE_LIMIT: f64 = 0.06;

/// A point coincides with the midpoint of a line, up to rounding, if their squared distance is at most this.
/// [rounding]
const COINCIDENT: f64 = 1e-18;

/// Prior of the endpoint noise. `PRIOR_NOISE`: its standard deviation in units of half the image's longer side.
/// `PRIOR_COUNT`: the number of segments to which the prior is equivalent. [bench vp:panoramas]
const PRIOR_NOISE: f64 = 0.001;
const PRIOR_COUNT: f64 = 2.0;

/// Number of segments that count as one independent observation. The errors of segments are correlated if the segments
/// are the two sides of a bar, pieces of one edge, or edges in a row of equal objects. This value and the values down
/// to [`STRAIGHTNESS`] are calibrated on photos with exactly known cameras. [bench vp]
const PER_OBSERVATION: f64 = 5.0;

/// Settings of the estimate of the endpoint noise. The biweight cuts off residuals beyond its limit, so the remaining
/// residuals show only a share of the noise variance, and this share depends on the noise itself. [bench vp]
///
/// - `NOISE_ROUNDS`: number of rounds, each of which estimates first the share and then the noise.
/// - `MIN_SHOWN`: a smaller share is replaced by this. The share is this small if the standard deviation of the noise
///   is 1.1 times the biweight's limit. If the noise is larger, the residuals within the limit hardly change with it,
///   so they cannot show its size.
/// - `MIN_SLOPE`: a smaller expected slope of the biweight is replaced by this. The slope is this small if the standard
///   deviation of the noise is half the limit. The covariance grows with the inverse square of the slope. If
///   `MIN_SLOPE` were lower, some correct vanishing points of the development sets would be rejected for their large
///   covariance: their short lines are more precise than their residuals suggest.
const NOISE_ROUNDS: usize = 5;
const MIN_SHOWN: f64 = 0.25;
const MIN_SLOPE: f64 = 0.3;

/// Standard deviation, in radians, of the error that all lines of a direction share: errors of the lens, of stitching
/// and of the room's construction. Averaging over more lines does not reduce it. [bench vp]
pub const STRAIGHTNESS: f64 = 0.0035;

/// Image coordinates relative to the principal point, in units of half the longer image side.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub principal: DVec2,
    pub scale: f64,
}

impl Frame {
    pub fn new(width: usize, height: usize, principal: DVec2) -> Self {
        Self { principal, scale: width.max(height) as f64 / 2.0 }
    }

    /// Converts segments to weighted lines in the coordinates of the frame, each with the index of its segment. Leaves
    /// out segments of zero length and segments that are not finite.
    pub fn weighted_lines(&self, segments: &[Segment]) -> Vec<(usize, WeightedLine)> {
        let to_frame = |p: DVec2| (p - self.principal) / self.scale;
        let prepare = |s: &Segment| Line::new(&Segment { a: to_frame(s.a), b: to_frame(s.b) });
        segments.iter().enumerate().filter_map(|(i, s)| prepare(s).map(|line| (i, WeightedLine::new(line)))).collect()
    }

    /// Converts a homogeneous point of the frame to homogeneous pixel coordinates, normalised to unit length.
    pub fn to_pixels(&self, p: DVec3) -> DVec3 {
        // Treat a third coordinate that is only rounding error as a point at infinity.
        let w = if p.z.abs() <= 1e-13 * p.truncate().length() { 0.0 } else { p.z };
        (p.truncate() * self.scale + self.principal * w).extend(w).normalize()
    }

    pub fn from_pixels(&self, p: DVec3) -> DVec3 {
        ((p.truncate() - self.principal * p.z) / self.scale).extend(p.z)
    }
}

/// A line in the frame, weighted by its length.
#[derive(Clone, Copy, Debug)]
pub struct WeightedLine {
    pub line: Line,
    pub weight: f64,
    /// Squared residual divided by the squared sine of the angle between the line and the direction from its midpoint
    /// to a vanishing point. A line belongs to the point if its squared residual is at most 1.
    pub stiffness: f64,
}

impl WeightedLine {
    fn new(line: Line) -> Self {
        let stiffness = maths::powi(line.half / ENDPOINT_LIMIT, 2) + maths::powi(SINE_LIMIT, -2);
        Self { line, weight: 2.0 * line.half, stiffness }
    }

    /// Returns the squared residual of the line for a vanishing point; the line does not belong to the point if the
    /// squared residual is above 1. A line whose midpoint coincides with the point has the residual 0.
    pub fn squared_residual(&self, p: DVec3) -> f64 {
        let away = p.truncate() - self.line.centre * p.z;
        let distance = away.length_squared();
        let across = self.line.direction.perp_dot(away);
        if distance > COINCIDENT { self.stiffness * across * across / distance } else { 0.0 }
    }

    /// Returns how well the line agrees with a vanishing point: `1 - residual²`, but at least 0. It is 0 if the line
    /// does not belong to the point.
    pub fn agreement(&self, p: DVec3) -> f64 {
        (1.0 - self.squared_residual(p)).max(0.0)
    }
}

/// Maps a camera-space direction to its vanishing point in homogeneous frame coordinates; [`unproject`] is the
/// inverse. `focal` is in frame units.
pub fn project(direction: DVec3, focal: f64) -> DVec3 {
    direction.truncate().extend(direction.z / focal)
}

pub fn unproject(p: DVec3, focal: f64) -> DVec3 {
    p.truncate().extend(p.z * focal).normalize()
}

/// A refined vanishing point.
#[derive(Clone, Copy, Debug)]
pub struct Refined {
    /// Unit direction in camera space.
    pub direction: DVec3,
    /// Covariance of `direction` in radians squared; its variance along `direction` is zero.
    pub covariance: DMat3,
}

impl Refined {
    /// Root mean square, in radians, of the angle to the true direction.
    pub fn error(&self) -> f64 {
        rms_angle(&self.covariance)
    }
}

/// Returns the square root of the trace of a direction's covariance, at most a right angle (in radians).
pub fn rms_angle(covariance: &DMat3) -> f64 {
    let trace = covariance.x_axis.x + covariance.y_axis.y + covariance.z_axis.z;
    trace.sqrt().min(std::f64::consts::FRAC_PI_2)
}

/// Returns the isotropic covariance of a direction whose angle to the true direction has the root mean square `error`,
/// in radians: `error² / 2` along each of two tangents.
pub fn round_covariance(direction: DVec3, error: f64) -> DMat3 {
    (DMat3::IDENTITY - outer(direction, direction)) * (0.5 * error * error)
}

/// The outer product `a bᵀ`.
pub fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// The prior that a direction is at a right angle to the direction `to`; `variance` is the variance of the angle.
#[derive(Clone, Copy, Debug)]
pub struct RightAngle {
    pub to: DVec3,
    pub variance: f64,
}

/// Finds the direction that fits the given lines best, from a nearby start, by iteratively reweighted least squares.
/// The residual of a line is the sine of the angle between the line and the direction from its midpoint to the
/// vanishing point. Tukey's biweight rejects lines beyond its limit. `None` if fewer than two distinct lines remain.
pub fn refine(lines: &[WeightedLine], start: DVec3, focal: f64) -> Option<Refined> {
    let direction = iterate(lines, start, focal, ZERO_MATRIX)?;
    Some(Refined { direction, covariance: covariance(lines, direction, focal)?.of_direction })
}

/// Like [`refine`], with priors on right angles. The weight of the lines relative to the priors follows from the
/// covariance that the lines give at the start.
pub fn refine_near(lines: &[WeightedLine], start: DVec3, focal: f64, expected: &[RightAngle]) -> Option<Refined> {
    let own = covariance(lines, start, focal)?;
    // Up to a factor, the normal matrix of the lines is the inverse of their covariance. Scale the priors by this
    // factor.
    let unit = maths::powi(rms_angle(&own.of_direction), 2) / own.inverse_trace;
    let mut prior = ZERO_MATRIX;
    for RightAngle { to, variance } in expected {
        add_square(&mut prior, *to, unit / variance);
    }
    let direction = iterate(lines, start, focal, prior)?;
    Some(Refined { direction, covariance: covariance(lines, direction, focal)?.of_direction })
}

fn iterate(lines: &[WeightedLine], start: DVec3, focal: f64, prior: [[f64; 3]; 3]) -> Option<DVec3> {
    let mut direction = start;
    for _ in 0..20 {
        let last = direction;
        direction = smallest_eigenvector(lines, direction, focal, prior)?;
        direction *= direction.dot(last).signum();
        if direction.distance_squared(last) < 1e-28 {
            break;
        }
    }
    Some(direction)
}

/// The zero matrix, for a least-squares problem without priors. [convention]
const ZERO_MATRIX: [[f64; 3]; 3] = [[0.0; 3]; 3];

fn add_square(matrix: &mut [[f64; 3]; 3], v: DVec3, weight: f64) {
    let v = v.to_array();
    for r in 0..3 {
        for c in 0..3 {
            matrix[r][c] += weight * v[r] * v[c];
        }
    }
}

/// One row of the least-squares problem, which belongs to one line.
struct Row {
    /// Derivative of `sine` with respect to the direction.
    gradient: DVec3,
    /// Weight of the line at zero residual (`base_weight`), and after multiplication by the biweight (`weight`).
    base_weight: f64,
    weight: f64,
    /// Variance of `sine` if the endpoints have noise of unit variance. It is the variance of the segment's
    /// direction plus the variance of the direction from the segment's midpoint to the vanishing point; the second
    /// term matters for segments near the point.
    variance: f64,
    /// Variance of the line's residual if the endpoints have noise of unit variance. Residuals are scaled such that
    /// lines with a residual above 1 are rejected.
    residual_variance: f64,
    /// Sine of the angle between the segment and the direction from its midpoint to the vanishing point.
    sine: f64,
}

fn row(weighted: &WeightedLine, direction: DVec3, focal: f64) -> Option<Row> {
    let p = project(direction, focal);
    let bisquare = maths::powi(weighted.agreement(p), 2);
    let distance = (p.truncate() - weighted.line.centre * p.z).length();
    if !(bisquare > 0.0 && distance > 1e-9) {
        return None;
    }
    let (l, half) = (weighted.line.line, weighted.line.half);
    let nearness = maths::powi(half * p.z / distance, 2);
    // The factor stiffness / (1 + nearness) is about the inverse variance of the sine, as if endpoint noise were the
    // only error. The factor √length favours long segments, because they are rarely false detections.
    let base_weight = weighted.weight.sqrt() * weighted.stiffness / (1.0 + nearness);
    let variance = (1.0 + nearness) / (half * half);
    Some(Row {
        gradient: DVec3::new(l.x, l.y, l.z / focal) / distance,
        base_weight,
        weight: bisquare * base_weight,
        variance,
        residual_variance: weighted.stiffness * variance,
        sine: weighted.line.sine(p),
    })
}

fn smallest_eigenvector(
    lines: &[WeightedLine],
    direction: DVec3,
    focal: f64,
    mut normal: [[f64; 3]; 3],
) -> Option<DVec3> {
    for Row { gradient, weight, .. } in lines.iter().filter_map(|e| row(e, direction, focal)) {
        add_square(&mut normal, gradient, weight);
    }
    let (values, vectors) = symmetric_eigen(normal);
    // Two coincident lines do not determine a point.
    (values[1] > values[2] * 1e-12 && values[2] > 0.0).then(|| DVec3::from_array(vectors[0]).normalize())
}

struct Covariance {
    /// Covariance of the direction, including correlation between lines and the common error [`STRAIGHTNESS`].
    of_direction: DMat3,
    /// Trace of the inverse of the lines' normal matrix in the tangent plane.
    inverse_trace: f64,
}

/// Estimates the variance of the endpoint noise from the residuals of the lines within the biweight's limit.
fn endpoint_noise(rows: &[Row]) -> f64 {
    let count = rows.len() as f64;
    let squares: f64 = rows.iter().map(|row| row.sine * row.sine / row.variance).sum();
    // The fit of a direction uses up two degrees of freedom, that is, two independent observations: subtract the
    // number of segments to which they correspond.
    let freedom = (count - 2.0 * PER_OBSERVATION).max(0.0) + PRIOR_COUNT;
    let seen = (squares + PRIOR_COUNT * PRIOR_NOISE * PRIOR_NOISE) / freedom;
    // Correct for the residuals that the biweight's limit cuts off.
    let mut noise = seen;
    for _ in 0..NOISE_ROUNDS {
        let shown =
            rows.iter().map(|row| Biweight::of_noise(noise * row.residual_variance).square).sum::<f64>() / count;
        noise = seen / shown.max(MIN_SHOWN);
    }
    noise
}

/// Computes the covariance by the sandwich formula `A⁻¹ B A⁻¹` of an M-estimator (Huber, "Robust Statistics", 1981,
/// §6.3), in the tangent plane: `A = Σ c ψ′ g gᵀ` and `B = Σ c² ψ² g gᵀ`, where `c` is a line's base weight, `g` its
/// gradient, and `ψ` the product of residual and biweight.
///
/// ψ′ and ψ² are replaced by their expectations under independent endpoint noise of the estimated size. Their sample
/// values would vary too much if there are few lines, and lines of large weight have small residuals merely because
/// they pull the estimate towards them.
fn covariance(lines: &[WeightedLine], direction: DVec3, focal: f64) -> Option<Covariance> {
    let (e1, e2) = direction.any_orthonormal_pair();
    let rows: Vec<Row> = lines.iter().filter_map(|e| row(e, direction, focal)).collect();
    if rows.len() < 2 {
        return None;
    }
    let noise = endpoint_noise(&rows);
    let (mut n, mut m) = ([0.0; 3], [0.0; 3]);
    for Row { gradient, base_weight, variance, residual_variance, .. } in &rows {
        let expected = Biweight::of_noise(noise * residual_variance);
        let (slope, square) =
            (base_weight * expected.slope.max(MIN_SLOPE), base_weight * base_weight * variance * expected.influence);
        let (u, v) = (gradient.dot(e1), gradient.dot(e2));
        for (i, product) in [u * u, u * v, v * v].into_iter().enumerate() {
            n[i] += slope * product;
            m[i] += square * product;
        }
    }
    let determinant = n[0] * n[2] - n[1] * n[1];
    if !(determinant > 1e-12 * n[0] * n[2]) {
        return None;
    }
    let inverse = [n[2] / determinant, -n[1] / determinant, n[0] / determinant];
    // Multiply A⁻¹ by B, where A is `n` and B is `m`. The statements below multiply by the second A⁻¹.
    let product = [
        inverse[0] * m[0] + inverse[1] * m[1],
        inverse[0] * m[1] + inverse[1] * m[2],
        inverse[1] * m[0] + inverse[2] * m[1],
        inverse[1] * m[1] + inverse[2] * m[2],
    ];
    let scale = PER_OBSERVATION * noise;
    let uu = scale * (product[0] * inverse[0] + product[1] * inverse[1]);
    let uv = scale * (product[0] * inverse[1] + product[1] * inverse[2]);
    let vv = scale * (product[2] * inverse[1] + product[3] * inverse[2]);
    let cross = outer(e1, e2) + outer(e2, e1);
    let of_lines = outer(e1, e1) * uu + outer(e2, e2) * vv + cross * uv;
    let of_direction = of_lines + round_covariance(direction, STRAIGHTNESS);
    Some(Covariance { of_direction, inverse_trace: inverse[0] + inverse[2] })
}
