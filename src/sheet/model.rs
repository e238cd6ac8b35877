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
use glam::{DMat2, DMat3, DVec2, DVec3};

/// Highest degree of the curve of the paper, and largest number of coefficients of the distortion of the lens.
pub const MAX_DEGREE: usize = 4;
pub const MAX_LENS: usize = 2;
/// Largest number of parameters.
const MAX_PARAMETERS: usize = 3 * (2 + MAX_DEGREE) - 1 + MAX_LENS + 1;
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
    /// Direction of the coordinate u on the page.
    axis: DVec2,
}

/// The photo's pixel of a point of the page, and its derivatives by the values.
pub struct Linearised {
    pub at: DVec2,
    by: [DVec2; MAX_PARAMETERS],
    count: usize,
}

impl Linearised {
    pub fn derivatives(&self) -> &[DVec2] {
        &self.by[..self.count]
    }
}

impl PageMap {
    fn new(terms: MapTerms, units: Units, values: Vec<f64>) -> Self {
        let turn = if terms.is_turned { values[terms.linear() + terms.lens] } else { 0.0 };
        let axis = maths::direction_at(terms.angle + turn);
        Self { terms, units, values, axis }
    }

    /// The flat model with a homography from pixels of the page to pixels of the photo, given column by column.
    pub fn flat(units: Units, homography: &DMat3) -> Option<Self> {
        let Units { page_centre, page_unit, photo_centre, photo_unit } = units;
        let from_unit = DMat3::from_translation(page_centre) * DMat3::from_scale(DVec2::splat(page_unit));
        let to_unit = DMat3::from_scale(DVec2::splat(photo_unit.recip())) * DMat3::from_translation(-photo_centre);
        let map = to_unit * *homography * from_unit;
        let [x, y, one] = [map.x_axis, map.y_axis, map.z_axis].map(|column| column / map.z_axis.z);
        let values = vec![y.x, y.y, y.z, one.x, one.y, x.x, x.y, x.z];
        values.iter().all(|v| v.is_finite()).then(|| Self::new(MapTerms::FLAT, units, values))
    }

    /// The same map with more terms, which are 0. `self` must be flat.
    pub fn extended(&self, terms: MapTerms) -> Self {
        let (g, x) = (self.vector(0), self.vector(5));
        let axis = maths::direction_at(terms.angle);
        let (u, v) = (axis.x * x + axis.y * g, axis.x * g - axis.y * x);
        let mut values = vec![v.x, v.y, v.z, self.values[3], self.values[4], u.x, u.y, u.z];
        values.resize(terms.parameters(), 0.0);
        Self::new(terms, self.units, values)
    }

    /// The same map with the angle that was fitted as one more parameter.
    pub fn turned(&self) -> Self {
        let terms = MapTerms { is_turned: true, ..self.terms };
        let mut values = self.values.clone();
        values.resize(terms.parameters(), 0.0);
        Self::new(terms, self.units, values)
    }

    fn vector(&self, first: usize) -> DVec3 {
        DVec3::from_slice(&self.values[first..first + 3])
    }

    fn lens(&self) -> &[f64] {
        let linear = self.terms.linear();
        &self.values[linear..linear + self.terms.lens]
    }

    /// Returns the coordinates u and v of a pixel of the page, its homogeneous position, and the derivative of the
    /// latter by u.
    fn homogeneous(&self, page: DVec2) -> (DVec2, DVec3, DVec3) {
        let p = (page - self.units.page_centre) / self.units.page_unit;
        let (u, v) = (self.axis.dot(p), self.axis.perp_dot(p));
        let (mut curve, mut along) = (DVec3::ZERO, DVec3::ZERO);
        for k in (1..=self.terms.degree).rev() {
            curve = self.vector(5 + 3 * (k - 1)) + u * curve;
            along = curve + u * along;
        }
        (DVec2::new(u, v), DVec3::new(self.values[3], self.values[4], 1.0) + u * curve + v * self.vector(0), along)
    }

    /// Maps a pixel of the page to a pixel of the photo; NaN behind the camera.
    pub fn apply(&self, page: DVec2) -> DVec2 {
        let (_, q, _) = self.homogeneous(page);
        if !(q.z > NEAREST) {
            return DVec2::NAN;
        }
        let ideal = q.truncate() / q.z;
        self.units.photo_centre + self.units.photo_unit * magnification(ideal, self.lens()).0 * ideal
    }

    /// Like [`Self::apply`], with the derivatives by the values.
    pub fn linearised(&self, page: DVec2) -> Linearised {
        let (uv, q, along) = self.homogeneous(page);
        let (count, mut by) = (self.values.len(), [DVec2::ZERO; MAX_PARAMETERS]);
        if !(q.z > NEAREST) {
            return Linearised { at: DVec2::NAN, by: [DVec2::NAN; MAX_PARAMETERS], count };
        }
        let ideal = q.truncate() / q.z;
        let (magnified, by_squared, by_lens) = magnification(ideal, self.lens());
        // The derivatives by the homogeneous position.
        let shown = |d: DVec2| self.units.photo_unit * (magnified * d + 2.0 * by_squared * ideal.dot(d) * ideal);
        let by_q = [DVec2::X, DVec2::Y, -ideal].map(|d| shown(d / q.z));
        for (i, d) in by_q.into_iter().enumerate() {
            by[i] = uv.y * d;
            let mut power = uv.x;
            for k in 0..self.terms.degree {
                by[5 + 3 * k + i] = power * d;
                power *= uv.x;
            }
        }
        (by[3], by[4]) = (by_q[0], by_q[1]);
        let linear = self.terms.linear();
        for (i, d) in by_lens.into_iter().take(self.terms.lens).enumerate() {
            by[linear + i] = self.units.photo_unit * d * ideal;
        }
        if self.terms.is_turned {
            let turned = uv.y * along - uv.x * self.vector(0);
            by[count - 1] = turned.x * by_q[0] + turned.y * by_q[1] + turned.z * by_q[2];
        }
        Linearised { at: self.units.photo_centre + self.units.photo_unit * magnified * ideal, by, count }
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
            (self, squares) = (next, smaller);
            if decrease < CONVERGED * squares {
                break;
            }
        }
        (self, squares)
    }

    /// Returns the lower triangle of the matrix of the normal equations, and their right side.
    fn normal_equations(&self, points: &[Sighting]) -> (Vec<f64>, Vec<f64>) {
        let n = self.values.len();
        let (mut matrix, mut right) = (vec![0.0; n * n], vec![0.0; n]);
        for point in points {
            let linearised = self.linearised(point.page);
            let (rows, off) = (linearised.derivatives(), point.photo - linearised.at);
            for (i, row) in rows.iter().enumerate() {
                right[i] += row.dot(off);
                matrix[i * n..].iter_mut().zip(&rows[..=i]).for_each(|(sum, other)| *sum += row.dot(*other));
            }
        }
        (matrix, right)
    }

    /// Returns the sum of squares after a fit, as far as the map is linear in its values. It is NaN if the points do
    /// not determine the values.
    pub fn expected_squares(&self, points: &[Sighting]) -> f64 {
        let (matrix, right) = self.normal_equations(points);
        let factor = Cholesky::new(right.len(), matrix);
        let decrease = factor.map_or(f64::NAN, |factor| factor.forward(&right).iter().map(|v| v * v).sum());
        (self.squares(points) - decrease).max(0.0)
    }

    /// Returns a map with a smaller sum of squares; increases the damping until there are some. `None` if there are
    /// none.
    fn better(
        &self,
        points: &[Sighting],
        matrix: &[f64],
        right: &[f64],
        squares: f64,
        damping: &mut f64,
    ) -> Option<(Self, f64)> {
        let n = right.len();
        while *damping < DAMPING[2] {
            let mut damped = matrix.to_vec();
            (0..n).for_each(|i| damped[i * (n + 1)] *= 1.0 + *damping);
            if let Some(factor) = Cholesky::new(n, damped) {
                let step = factor.solve(right);
                let values: Vec<f64> = self.values.iter().zip(&step).map(|(v, s)| v + s).collect();
                let next = Self::new(self.terms, self.units, values);
                let found = next.squares(points);
                if found < squares {
                    *damping = (*damping / DAMPING_FACTOR).max(DAMPING[1]);
                    return Some((next, found));
                }
            }
            *damping *= DAMPING_FACTOR;
        }
        None
    }

    /// Returns the variance of the map at the places, as a multiple of the variance of the points, in the mean.
    pub fn gain(&self, points: &[Sighting], places: &[DVec2]) -> Option<f64> {
        let factor = Cholesky::new(self.values.len(), self.normal_equations(points).0)?;
        let at = |place: &DVec2| {
            let open = open(&factor, &self.linearised(*place));
            open.x_axis.x + open.y_axis.y
        };
        Some(places.iter().map(at).sum::<f64>() / (2.0 * places.len() as f64))
    }

    /// Returns for each point the distance between its place and the place that a fit without this point predicts.
    pub fn left_out(&self, points: &[Sighting]) -> Option<Vec<f64>> {
        let factor = Cholesky::new(self.values.len(), self.normal_equations(points).0)?;
        let of_point = |point: &Sighting| {
            let linearised = self.linearised(point.page);
            let free = DMat2::IDENTITY - open(&factor, &linearised);
            (free.inverse() * (point.photo - linearised.at)).length()
        };
        Some(points.iter().map(of_point).collect())
    }
}

/// Returns the covariance of a place of the map, in units of the variance of the points. `factor` is that of the normal
/// equations.
fn open(factor: &Cholesky, place: &Linearised) -> DMat2 {
    let along = |axis: usize| place.derivatives().iter().map(|d| d[axis]).collect::<Vec<f64>>();
    let [x, y] = [0, 1].map(|axis| factor.forward(&along(axis)));
    DMat2::from_cols_array(&[dot(&x, &x), dot(&x, &y), dot(&x, &y), dot(&y, &y)])
}

/// Returns by how much a lens moves the point `ideal` away from the centre: the factor s that solves
/// `s (1 - a s² r² - b s⁴ r⁴) = 1`, in which r is the length of `ideal`, in units of half the photo's diagonal. Also
/// returns the derivative of s by r², and the derivatives by the coefficients a and b.
fn magnification(ideal: DVec2, lens: &[f64]) -> (f64, f64, [f64; MAX_LENS]) {
    /// Maximum number of Newton steps, the step that ends them, and the smallest slope, which only points beyond a fold
    /// have. [rounding]
    const STEPS: usize = 10;
    const LAST_STEP: f64 = 1e-15;
    const MIN_SLOPE: f64 = 0.1;
    if lens.is_empty() {
        return (1.0, 0.0, [0.0; MAX_LENS]);
    }
    let (first, second) = (lens[0], lens.get(1).copied().unwrap_or(0.0));
    let squared = ideal.length_squared();
    let slope = |s: f64| (1.0 - squared * s * s * (3.0 * first + 5.0 * second * squared * s * s)).max(MIN_SLOPE);
    let mut s = 1.0;
    for _ in 0..STEPS {
        let step = (s * (1.0 - squared * s * s * (first + second * squared * s * s)) - 1.0) / slope(s);
        s = (s - step).clamp(0.25, 4.0);
        if step.abs() < LAST_STEP {
            break;
        }
    }
    let (slope, cube) = (slope(s), s * s * s);
    let by_squared = (first + 2.0 * second * squared * s * s) * cube / slope;
    (s, by_squared, [squared * cube / slope, maths::powi(squared, 2) * cube * s * s / slope])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_map() {
        let units = Units {
            page_centre: DVec2::new(400.0, 300.0),
            page_unit: 400.0,
            photo_centre: DVec2::new(650.0, 500.0),
            photo_unit: 820.0,
        };
        let homography = DMat3::from_cols_array(&[1.1, 0.1, 1e-4, -0.2, 1.0, 2e-4, 150.0, 90.0, 1.0]);
        let flat = PageMap::flat(units, &homography).unwrap();
        for (degree, lens, is_turned) in [(1, 0, false), (1, 2, false), (2, 1, true), (4, 2, true), (3, 0, false)] {
            let mut map = flat.extended(MapTerms { degree, angle: 0.4, is_turned, lens });
            for (i, value) in map.values.iter_mut().enumerate() {
                *value += 0.02 * (i as f64 - 9.0) / 9.0;
            }
            let map = PageMap::new(map.terms, units, map.values);
            for page in [DVec2::new(100.0, 50.0), DVec2::new(730.0, 580.0), units.page_centre] {
                let found = map.linearised(page);
                assert!(found.at.distance(map.apply(page)) < 1e-9);
                for (i, derivative) in found.derivatives().iter().enumerate() {
                    let moved = |step: f64| {
                        let mut values = map.values.clone();
                        values[i] += step;
                        PageMap::new(map.terms, units, values).apply(page)
                    };
                    let expected = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                    assert!(derivative.distance(expected) < 1e-4, "{degree} {lens} {i}: {derivative} {expected}");
                }
            }
        }
    }
}
