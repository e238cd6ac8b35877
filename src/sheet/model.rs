//! The map from the page to the photo for paper that is flat or bent in one direction, through a lens with radial
//! distortion.
//!
//! Bent paper is a general cylinder: the page coordinate u across the generators runs along a curve in space, and the
//! page coordinate v runs along the straight generators. If the curve is a polynomial, then a pinhole camera sees the
//! point (u, v) at the homogeneous position `v g + Σ c_k u^k`, with vectors g and c_k of three numbers. For flat paper
//! the sum ends at k = 1, and the map is a homography. Pose, focal length, principal point and the curve with its
//! length of arc are all in these vectors, which are determined together.

use super::dense::{Cholesky, dot};
use crate::maths;
use glam::{DVec2, DVec3};

/// Step of the derivatives by differences, in units of the parameters, which are about 1. [rounding]
const STEP: f64 = 1e-5;
/// Maximum number of steps of the least-squares fit, and the relative decrease of the sum of squares at which it ends.
/// [rounding]
const MAX_STEPS: usize = 60;
const CONVERGED: f64 = 1e-7;
/// Damping of the fit at first, at least and at most, and the factor between two values of it. [convention: Levenberg
/// and Marquardt]
const DAMPING: [f64; 3] = [1e-4, 1e-9, 1e3];
const DAMPING_FACTOR: f64 = 10.0;
/// Smallest third coordinate of points in front of the camera; that of the page's centre is 1. [convention: a page that
/// is seen from one edge, with a ratio of distances of 20]
const NEAREST: f64 = 0.05;

/// Which terms the map has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapTerms {
    /// Degree of the curve of the paper; 1 is flat.
    pub degree: usize,
    /// Angle of the coordinate u against the page's x axis.
    pub angle: f64,
    /// Whether `angle` is fitted too.
    pub is_turned: bool,
    /// Number of coefficients of the radial distortion, 0 to 2.
    pub lens: usize,
}

impl MapTerms {
    pub const FLAT: Self = Self { degree: 1, angle: 0.0, is_turned: false, lens: 0 };

    /// Number of parameters of g and of the curve; one of them is fixed, because homogeneous vectors have no scale.
    fn linear(&self) -> usize {
        3 * (2 + self.degree) - 1
    }

    pub fn parameters(&self) -> usize {
        self.linear() + self.lens + usize::from(self.is_turned)
    }
}

/// The units of the page and of the photo.
#[derive(Clone, Copy, Debug)]
pub struct Units {
    pub page_centre: DVec2,
    /// Half the longer side of the page, in page pixels.
    pub page_unit: f64,
    pub photo_centre: DVec2,
    /// Half the diagonal of the photo, in pixels.
    pub photo_unit: f64,
}

/// A point of the page that was found in the photo.
#[derive(Clone, Copy, Debug)]
pub struct Sighting {
    pub page: DVec2,
    pub photo: DVec2,
}

#[derive(Clone, Debug)]
pub struct PageMap {
    pub terms: MapTerms,
    pub units: Units,
    /// g; c_0 without its third coordinate, which is 1; c_1 and so on; the coefficients of the lens; the change of the
    /// angle.
    pub values: Vec<f64>,
}

impl PageMap {
    /// The flat model with a homography from pixels of the page to pixels of the photo, given column by column.
    pub fn flat(units: Units, homography: &glam::DMat3) -> Option<Self> {
        let Units { page_centre, page_unit, photo_centre, photo_unit } = units;
        let from_unit = glam::DMat3::from_translation(page_centre) * glam::DMat3::from_scale(DVec2::splat(page_unit));
        let to_unit =
            glam::DMat3::from_scale(DVec2::splat(photo_unit.recip())) * glam::DMat3::from_translation(-photo_centre);
        let map = to_unit * *homography * from_unit;
        let [x, y, one] = [map.x_axis, map.y_axis, map.z_axis].map(|column| column / map.z_axis.z);
        let values = vec![y.x, y.y, y.z, one.x, one.y, x.x, x.y, x.z];
        values.iter().all(|v| v.is_finite()).then_some(Self { terms: MapTerms::FLAT, units, values })
    }

    /// The same map in a terms with more terms, which are 0. `self` must be flat.
    pub fn extended(&self, terms: MapTerms) -> Self {
        let (g, one, x) = self.flat_columns();
        let axis = maths::direction_at(terms.angle);
        let (u, v) = (axis.x * x + axis.y * g, axis.x * g - axis.y * x);
        let mut values = vec![v.x, v.y, v.z, one.x, one.y, u.x, u.y, u.z];
        values.resize(terms.parameters(), 0.0);
        Self { terms, units: self.units, values }
    }

    fn flat_columns(&self) -> (DVec3, DVec3, DVec3) {
        let v = &self.values;
        (DVec3::new(v[0], v[1], v[2]), DVec3::new(v[3], v[4], 1.0), DVec3::new(v[5], v[6], v[7]))
    }

    /// The same map with the angle that was fitted as one more parameter.
    pub fn turned(&self) -> Self {
        let terms = MapTerms { is_turned: true, ..self.terms };
        let mut values = self.values.clone();
        values.resize(terms.parameters(), 0.0);
        Self { terms, units: self.units, values }
    }

    /// Maps a pixel of the page to a pixel of the photo; NaN behind the camera.
    pub fn apply(&self, page: DVec2) -> DVec2 {
        self.apply_with(&self.values, page)
    }

    fn apply_with(&self, values: &[f64], page: DVec2) -> DVec2 {
        let MapTerms { degree, angle, is_turned, lens } = self.terms;
        let linear = self.terms.linear();
        let p = (page - self.units.page_centre) / self.units.page_unit;
        let turn = if is_turned { values[linear + lens] } else { 0.0 };
        let axis = maths::direction_at(angle + turn);
        let (u, v) = (axis.dot(p), axis.perp_dot(p));
        let vector = |k: usize| DVec3::from_slice(&values[k..k + 3]);
        let mut q = vector(linear - 3);
        for k in (1..degree).rev() {
            q = vector(5 + 3 * (k - 1)) + u * q;
        }
        let q = DVec3::new(values[3], values[4], 1.0) + u * q + v * vector(0);
        if !(q.z > NEAREST) {
            return DVec2::NAN;
        }
        let ideal = q.truncate() / q.z;
        self.units.photo_centre + self.units.photo_unit * shown(ideal, &values[linear..linear + lens])
    }

    /// Returns the derivatives of [`Self::apply`] by each parameter.
    pub fn derivatives(&self, page: DVec2) -> Vec<DVec2> {
        let mut values = self.values.clone();
        let by = |i: usize| {
            values[i] = self.values[i] + STEP;
            let above = self.apply_with(&values, page);
            values[i] = self.values[i] - STEP;
            let below = self.apply_with(&values, page);
            values[i] = self.values[i];
            (above - below) / (2.0 * STEP)
        };
        (0..self.values.len()).map(by).collect()
    }

    /// The sum of squared distances, in pixels of the photo, between points and their predicted positions.
    pub fn squares(&self, points: &[Sighting]) -> f64 {
        points.iter().map(|p| self.apply(p.page).distance_squared(p.photo)).sum()
    }

    /// Fits the values to points by least squares (Levenberg and Marquardt), and returns the sum of squares with them.
    pub fn fit(mut self, points: &[Sighting]) -> (Self, f64) {
        let mut squares = self.squares(points);
        let mut damping = DAMPING[0];
        for _ in 0..MAX_STEPS {
            let (matrix, right) = self.normal_equations(points);
            let Some((next, smaller)) = self.better(points, &matrix, &right, squares, &mut damping) else { break };
            let decrease = squares - smaller;
            (self.values, squares) = (next, smaller);
            if decrease < CONVERGED * squares {
                break;
            }
        }
        (self, squares)
    }

    fn normal_equations(&self, points: &[Sighting]) -> (Vec<f64>, Vec<f64>) {
        let n = self.values.len();
        let (mut matrix, mut right) = (vec![0.0; n * n], vec![0.0; n]);
        for point in points {
            let rows = self.derivatives(point.page);
            let off = point.photo - self.apply(point.page);
            for i in 0..n {
                right[i] += rows[i].dot(off);
                (0..n).for_each(|j| matrix[i * n + j] += rows[i].dot(rows[j]));
            }
        }
        (matrix, right)
    }

    /// Returns values with a smaller sum of squares; increases the damping until there are some. `None` if there are
    /// none.
    fn better(
        &self,
        points: &[Sighting],
        matrix: &[f64],
        right: &[f64],
        squares: f64,
        damping: &mut f64,
    ) -> Option<(Vec<f64>, f64)> {
        let n = right.len();
        while *damping < DAMPING[2] {
            let mut damped = matrix.to_vec();
            (0..n).for_each(|i| damped[i * (n + 1)] *= 1.0 + *damping);
            if let Some(factor) = Cholesky::new(n, damped) {
                let step = factor.solve(right);
                let values: Vec<f64> = self.values.iter().zip(&step).map(|(v, s)| v + s).collect();
                let next = Self { values, ..self.clone() };
                let found = next.squares(points);
                if found < squares {
                    *damping = (*damping / DAMPING_FACTOR).max(DAMPING[1]);
                    return Some((next.values, found));
                }
            }
            *damping *= DAMPING_FACTOR;
        }
        None
    }

    /// Returns the variance of the map at the places, as a multiple of the variance of the points, in the mean.
    pub fn gain(&self, points: &[Sighting], places: &[DVec2]) -> Option<f64> {
        let n = self.values.len();
        let factor = Cholesky::new(n, self.normal_equations(points).0)?;
        let at = |place: &DVec2| {
            let rows = self.derivatives(*place);
            let along = |axis: usize| factor.forward(&rows.iter().map(|r| r[axis]).collect::<Vec<f64>>());
            [along(0), along(1)].iter().map(|x| dot(x, x)).sum::<f64>()
        };
        Some(places.iter().map(at).sum::<f64>() / (2.0 * places.len() as f64))
    }

    /// Returns for each point the distance between its place and the place that a fit without this point predicts, and
    /// the variance of a coordinate that the other points then show.
    pub fn left_out(&self, points: &[Sighting], squares: f64) -> Option<Vec<(f64, f64)>> {
        let n = self.values.len();
        let (matrix, _) = self.normal_equations(points);
        let factor = Cholesky::new(n, matrix)?;
        let rest = (2 * points.len()).checked_sub(n + 2).filter(|&rest| rest > 0)? as f64;
        let of_point = |point: &Sighting| {
            let rows = self.derivatives(point.page);
            let [x, y] = [0, 1].map(|axis| factor.forward(&rows.iter().map(|r| r[axis]).collect::<Vec<f64>>()));
            let free = glam::DMat2::IDENTITY
                - glam::DMat2::from_cols_array(&[dot(&x, &x), dot(&x, &y), dot(&x, &y), dot(&y, &y)]);
            let off = point.photo - self.apply(point.page);
            let without = free.inverse() * off;
            (without.length(), (squares - off.dot(without)).max(0.0) / rest)
        };
        Some(points.iter().map(of_point).collect())
    }
}

/// Returns the point that a lens shows where an ideal lens shows `ideal`: the inverse of
/// `ideal = shown (1 - a |shown|² - b |shown|⁴)`. Coordinates are in units of half the photo's diagonal.
fn shown(ideal: DVec2, lens: &[f64]) -> DVec2 {
    /// Number of Newton steps, and the smallest slope, which only points beyond a fold have. [rounding]
    const STEPS: usize = 10;
    const MIN_SLOPE: f64 = 0.1;
    if lens.is_empty() {
        return ideal;
    }
    let second = lens.get(1).copied().unwrap_or(0.0);
    let squared = ideal.length_squared();
    let mut s = 1.0;
    for _ in 0..STEPS {
        let (a, b) = (lens[0] * squared * s * s, second * maths::powi(squared * s * s, 2));
        let step = (s * (1.0 - a - b) - 1.0) / (1.0 - 3.0 * a - 5.0 * b).max(MIN_SLOPE);
        s = (s - step).clamp(0.25, 4.0);
    }
    ideal * s
}
