//! Searches for the tilt of a plane at which the lamps on the plane, once unwarped, agree best in size and form and lie
//! best on a lattice.

use super::evidence::Evidence;
use super::tilt::Tilt;
use crate::error::Result;
use crate::exec;
use crate::geometry::linear;
use crate::job::Job;
use crate::maths;
use crate::rectify::camera::FREE_ERROR;
use crate::rectify::focal::FocalPrior;
use crate::rectify::sphere::{STRAIGHTNESS, outer, round_covariance};
use crate::rectify::warnings::MAX_DIRECTION_ERROR;
use glam::{DMat3, DVec3};

/// Number of plane normals tried, spread over the sphere about 6 degrees apart. [convention]
const DIRECTIONS: usize = 1000;
/// `FOCALS`: number of focal lengths tried on either side of the expected focal length. `FOCAL_STEP`: logarithm of the
/// ratio between neighbouring focal lengths. [convention]
const FOCALS: i32 = 2;
const FOCAL_STEP: f64 = 0.4;
/// A focal length counts as known if the standard deviation of its logarithm is below this; it is then not refined.
/// [bench photos:tune]
const KNOWN_FOCAL: f64 = 0.1;
/// Step of the finite differences that measure the curvature of the cost at its minimum, in radians and in the
/// logarithm of the focal length. A wide step smooths the kinks of the cost, which its medians and its clamped terms
/// cause. [bench photos:tune]
const WIDTH: f64 = 0.02;
/// Number of tilts of the coarse search that are refined. [bench photos:tune]
const STARTS: usize = 12;
/// Step of the refinement at its start and at its end, in radians. The steps of the logarithm of the focal length are
/// twice as large. [convention]
const FIRST_STEP: f64 = 0.05;
const LAST_STEP: f64 = 1e-4;
/// The cost of a normal is its squared deviation from the normal that the lines imply, divided by the variance. The
/// cost is limited to this value, because the lines may be entirely wrong. [bench photos:tune]
const MAX_LINES_COST: f64 = 9.0;
/// Most photographers hold the camera upright. A roll of the camera therefore costs `(roll / ROLL_ERROR)²`, but at most
/// `MAX_ROLL_COST`. `ROLL_ERROR` is in radians. [bench photos:tune]
const ROLL_ERROR: f64 = 0.15;
const MAX_ROLL_COST: f64 = 9.0;
/// A tilt is rejected if the cosine of the angle between its normal and the normal that the lines imply is below this.
/// The test is loose: it allows angles up to 78 degrees. It rejects every tilt that puts the plane on the other side of
/// the camera, such as a floor instead of a ceiling. A lattice of lamps itself shows on which side its plane lies; no
/// tilt is then rejected. If the lines are certain, the limit is [`MIN_CERTAIN_COSINE`], 45 degrees: rows of small
/// lamps seen at a low angle are alike on many tilts. [bench photos:tune, photos:real]
const MIN_COSINE: f64 = 0.2;
const MIN_CERTAIN_COSINE: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// A tilt and its uncertainty.
#[derive(Clone, Copy, Debug)]
pub struct TiltEstimate {
    pub tilt: Tilt,
    /// Covariance of the normal in radians squared, and standard deviation of the logarithm of the focal length
    /// (`focal_spread`).
    pub covariance: DMat3,
    pub focal_spread: f64,
}

/// The total cost of a tilt: the cost of the lamps, plus the deviations from the lines, from the expected focal length
/// and from an upright camera.
struct TotalCost<'a> {
    lamps: &'a Evidence,
    /// The normal that the lines imply, and its standard deviation in radians.
    lines: DVec3,
    lines_error: f64,
    expected: FocalPrior,
}

/// A function that computes the cost of the lamps from the tilt of their plane.
type Cost = fn(&Evidence, &Tilt) -> f64;

impl TotalCost<'_> {
    fn of(&self, tilt: &Tilt) -> f64 {
        self.by(Evidence::cost, tilt)
    }

    fn by(&self, cost: Cost, tilt: &Tilt) -> f64 {
        let cosine = tilt.normal.dot(self.lines);
        let min_cosine = if self.lines_error <= MAX_DIRECTION_ERROR { MIN_CERTAIN_COSINE } else { MIN_COSINE };
        if cosine < min_cosine && self.lamps.lattice.is_none() {
            return f64::INFINITY;
        }
        let by_focal = maths::powi(maths::ln(tilt.focal / self.expected.focal) / self.expected.spread, 2);
        let by_lines = maths::powi(maths::acos(cosine.clamp(-1.0, 1.0)) / self.lines_error, 2).min(MAX_LINES_COST);
        // Compute the roll from the normal, but only for floors and ceilings. Roll does not change the normal of a
        // wall ahead of the camera, and this formula does not hold for side walls.
        let roll = maths::atan2(tilt.normal.x, tilt.normal.y.abs());
        let is_level = self.lines.y.abs() > self.lines.x.abs().max(self.lines.z.abs());
        let by_roll = if is_level { maths::powi(roll / ROLL_ERROR, 2).min(MAX_ROLL_COST) } else { 0.0 };
        cost(self.lamps, tilt) + by_focal + by_lines + by_roll
    }
}

/// Finds the tilt with the least cost, given the normal and focal length that the lines imply. `None` if the cost of
/// every tilt tried is infinite.
pub fn find(
    lamps: &Evidence,
    (by_lines, error): (Tilt, f64),
    expected: FocalPrior,
    job: Job,
) -> Result<Option<TiltEstimate>> {
    let total = TotalCost { lamps, lines: by_lines.normal, lines_error: error, expected };
    let is_known = expected.spread < KNOWN_FOCAL;
    let steps = if is_known { 0 } else { FOCALS };
    let focals = (-steps..=steps).map(|k| expected.focal * maths::exp(FOCAL_STEP * f64::from(k)));
    let focals: Vec<f64> = focals.chain([by_lines.focal]).collect();

    // Find the best focal length for every direction, then refine the tilts with the least cost. Refining a single
    // tilt is not enough: if all shapes are elongated in the same direction, the cost has several minima.
    let rough = exec::map(DIRECTIONS, job.part(0.0, 0.8), |k| {
        let normal = direction(k);
        let tilts = focals.iter().map(|&focal| Tilt { normal, focal });
        tilts.map(|tilt| (total.by(Evidence::rough_cost, &tilt), tilt)).min_by(|a, b| a.0.total_cmp(&b.0))
    })?;
    let of_lattice = lamps.tilts(expected.focal, is_known).map(|tilt| (total.of(&tilt), tilt));
    let all = rough.into_iter().flatten().chain(of_lattice);
    let mut starts: Vec<(f64, Tilt)> = all.filter(|start| start.0.is_finite()).collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    starts.truncate(STARTS);
    let refined = exec::map(starts.len(), job.part(0.8, 1.0), |k| refine(&total, starts[k].1, is_known))?;
    let Some((_, tilt)) = refined.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)) else { return Ok(None) };
    let (covariance, focal_spread) = covariance(&total, &tilt, is_known);
    Ok(Some(TiltEstimate { tilt, covariance, focal_spread }))
}

/// Returns the k-th of [`DIRECTIONS`] directions spread evenly over the sphere (a Fibonacci lattice).
fn direction(k: usize) -> DVec3 {
    let z = (2 * k + 1) as f64 / DIRECTIONS as f64 - 1.0;
    let golden_angle = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let (sin, cos) = maths::sin_cos(golden_angle * k as f64);
    let radius = (1.0 - z * z).sqrt();
    DVec3::new(radius * cos, radius * sin, z)
}

/// Returns the tilt after a step of the normal along two tangents and a step of the logarithm of the focal length.
fn moved(tilt: &Tilt, [right, down, focal]: [f64; 3]) -> Tilt {
    let (a, b) = tilt.normal.any_orthonormal_pair();
    Tilt { normal: (tilt.normal + a * right + b * down).normalize(), focal: tilt.focal * maths::exp(focal) }
}

/// Refines a tilt by a pattern search over two tangents of the normal and, unless `is_known`, the logarithm of the
/// focal length. Takes the best of the steps along one tangent, along the focal length, or along both. Halves the step
/// if none decreases the cost. Returns the final cost and tilt.
fn refine(total: &TotalCost, mut tilt: Tilt, is_known: bool) -> (f64, Tilt) {
    let mut min_cost = total.of(&tilt);
    let focal_moves: &[f64] = if is_known { &[0.0] } else { &[0.0, 2.0, -2.0] };
    let around = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [0.0, 0.0]];
    let mut step = FIRST_STEP;
    while step > LAST_STEP {
        let moves = around.iter().flat_map(|[x, y]| focal_moves.iter().map(move |f| [x * step, y * step, f * step]));
        let tilts = moves.map(|by| moved(&tilt, by)).map(|tilt| (total.of(&tilt), tilt));
        match tilts.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|next| next.0 < min_cost) {
            Some(next) => (min_cost, tilt) = next,
            None => step *= 0.5,
        }
    }
    (min_cost, tilt)
}

/// Computes the covariance of the normal, and the standard deviation of the logarithm of the focal length, from the
/// curvature of the cost. As the cost is minus twice a log-likelihood, the covariance is twice the inverse of its
/// Hessian.
fn covariance(total: &TotalCost, tilt: &Tilt, is_known: bool) -> (DMat3, f64) {
    let at = |by: [f64; 3]| total.of(&moved(tilt, by));
    let unit = |k: usize, size: f64| std::array::from_fn(|i| if i == k { size } else { 0.0 });
    let middle = at([0.0; 3]);
    let mut hessian = [[0.0; 3]; 3];
    for i in 0..3 {
        hessian[i][i] = (at(unit(i, WIDTH)) + at(unit(i, -WIDTH)) - 2.0 * middle) / (WIDTH * WIDTH);
        for j in 0..i {
            let corner = |a: f64, b: f64| {
                at(std::array::from_fn(|k| {
                    if k == i {
                        a
                    } else if k == j {
                        b
                    } else {
                        0.0
                    }
                }))
            };
            let mixed = corner(WIDTH, WIDTH) + corner(-WIDTH, -WIDTH) - corner(WIDTH, -WIDTH) - corner(-WIDTH, WIDTH);
            hessian[i][j] = mixed / (4.0 * WIDTH * WIDTH);
            hessian[j][i] = hessian[i][j];
        }
    }
    if is_known {
        hessian[2] = [0.0, 0.0, 2.0 / (total.expected.spread * total.expected.spread)];
        (hessian[0][2], hessian[1][2]) = (0.0, 0.0);
    }
    let columns = [0, 1, 2].map(|k| linear::solve(hessian, unit(k, 2.0)));
    let free = (round_covariance(tilt.normal, FREE_ERROR), total.expected.spread);
    let [Some(x), Some(y), Some(f)] = columns else { return free };
    let is_minimum = x[0] > 0.0 && y[1] > 0.0 && f[2] > 0.0 && x.iter().chain(&y).all(|v| v.is_finite());
    if !is_minimum {
        return free;
    }
    let (a, b) = tilt.normal.any_orthonormal_pair();
    let of_shapes = outer(a, a) * x[0] + outer(b, b) * y[1] + (outer(a, b) + outer(b, a)) * x[1];
    (of_shapes + round_covariance(tilt.normal, STRAIGHTNESS), f[2].sqrt())
}
