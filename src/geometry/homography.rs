//! Homographies: projective maps between planes.

use super::linear;
use crate::error::{Error, Result};
use glam::{DMat3, DVec2, DVec3};

/// A projective map between planes, as a 3 × 3 matrix on homogeneous points, defined up to scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homography(pub DMat3);

impl Homography {
    /// Computes the homography that maps the four points `from` exactly to the four points `to` (Hartley and Zisserman
    /// 2004, 4.1, with the normalisation of 4.4). Returns an error if three points of `from` or three points of `to`
    /// are collinear.
    pub fn from_corners(from: [DVec2; 4], to: [DVec2; 4]) -> Result<Self> {
        let (nf, nt) = (normalisation(&from)?, normalisation(&to)?);
        let (f, t) = (from.map(|p| apply(nf, p)), to.map(|p| apply(nt, p)));
        for quad in [f, t] {
            let min_area = (0..4)
                .map(|i| doubled_area(quad[i], quad[(i + 1) % 4], quad[(i + 2) % 4]).abs())
                .fold(f64::MAX, f64::min);
            if min_area < 1e-12 {
                return Err(Error::degenerate(
                    "three of the four corners are collinear: no perspective maps them to a rectangle",
                ));
            }
        }
        // Set up two rows per point, fix the last entry of the matrix to 1, and solve for the other eight entries. If
        // the origin maps to infinity, the last entry is 0 and the system is singular: then fix another entry to 1.
        let mut a = [[0.0; 9]; 8];
        for i in 0..4 {
            let (x, y, u, v) = (f[i].x, f[i].y, t[i].x, t[i].y);
            a[2 * i] = [x, y, 1.0, 0.0, 0.0, 0.0, -u * x, -u * y, -u];
            a[2 * i + 1] = [0.0, 0.0, 0.0, x, y, 1.0, -v * x, -v * y, -v];
        }
        let h = [8, 6, 7, 0, 4]
            .iter()
            .find_map(|&fixed| {
                let columns: Vec<usize> = (0..9).filter(|&c| c != fixed).collect();
                let matrix: [[f64; 8]; 8] = std::array::from_fn(|r| std::array::from_fn(|c| a[r][columns[c]]));
                let solution = linear::solve(matrix, std::array::from_fn(|r| -a[r][fixed]))?;
                let mut h = [0.0; 9];
                h[fixed] = 1.0;
                columns.iter().zip(solution).for_each(|(&c, s)| h[c] = s);
                Some(h)
            })
            .ok_or_else(|| Error::degenerate("the four corners determine no perspective"))?;
        let normalised = DMat3::from_cols_array(&h).transpose();
        Ok(Self(nt.inverse() * normalised * nf).rescaled())
    }

    /// Scales the matrix to unit Frobenius norm, so that the entries of two matrices can be compared, and so that the
    /// determinant neither overflows nor underflows in an inversion. A zero matrix stays.
    pub fn rescaled(self) -> Self {
        let norm = self.0.to_cols_array().iter().map(|v| v * v).sum::<f64>().sqrt();
        Self(if norm > 0.0 { self.0 * (1.0 / norm) } else { self.0 })
    }

    pub fn inverse(self) -> Self {
        Self(self.rescaled().0.inverse()).rescaled()
    }

    /// Maps a point to homogeneous coordinates. The third coordinate changes sign across the line that maps to
    /// infinity.
    pub fn apply_homogeneous(&self, p: DVec2) -> DVec3 {
        self.0 * p.extend(1.0)
    }

    /// Maps a point. The result is infinite or NaN on the line that maps to infinity.
    pub fn apply(&self, p: DVec2) -> DVec2 {
        apply(self.0, p)
    }

    /// Returns the homography that applies `first`, then `self`.
    pub fn after(self, first: Self) -> Self {
        Self(self.0 * first.0).rescaled()
    }
}

fn apply(h: DMat3, p: DVec2) -> DVec2 {
    let q = h * p.extend(1.0);
    q.truncate() / q.z
}

fn doubled_area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Returns the similarity that moves the centroid of the points to the origin and makes their mean distance from the
/// origin √2.
fn normalisation(points: &[DVec2; 4]) -> Result<DMat3> {
    let centre = points.iter().sum::<DVec2>() / 4.0;
    let distance = points.iter().map(|p| p.distance(centre)).sum::<f64>() / 4.0;
    if !(distance.is_finite() && distance > 0.0) {
        return Err(Error::degenerate("the four corners coincide or are not finite"));
    }
    let s = std::f64::consts::SQRT_2 / distance;
    Ok(DMat3::from_scale(DVec2::splat(s)) * DMat3::from_translation(-centre))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn corners_map_onto_corners_and_a_known_map_is_recovered() {
        let mut rng = Rng::new(5, &[]);
        for scale in [1e-6, 1.0, 1e6] {
            for _ in 0..50 {
                let mut near = |x: f64, y: f64| DVec2::new(x + 0.3 * rng.next_f64(), y + 0.3 * rng.next_f64()) * scale;
                let from = [near(0.0, 0.0), near(1.0, 0.0), near(1.0, 1.0), near(0.0, 1.0)];
                let to =
                    [DVec2::new(3.0, 4.0), DVec2::new(700.0, 9.0), DVec2::new(650.0, 480.0), DVec2::new(-20.0, 500.0)];
                let h = Homography::from_corners(from, to).unwrap();
                for i in 0..4 {
                    assert!(h.apply(from[i]).distance(to[i]) < 1e-9 * 700.0);
                    assert!(h.inverse().apply(to[i]).distance(from[i]) < 1e-9 * scale);
                }
            }
        }
    }

    #[test]
    fn degenerate_corners_are_an_error() {
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        let line = [DVec2::ZERO, DVec2::X, DVec2::X * 2.0, DVec2::Y];
        for bad in [line, [DVec2::ONE; 4], [DVec2::NAN; 4], [DVec2::ZERO, DVec2::ZERO, DVec2::X, DVec2::Y]] {
            assert!(Homography::from_corners(bad, square).is_err());
            assert!(Homography::from_corners(square, bad).is_err());
        }
    }

    #[test]
    fn the_sign_identifies_corners_on_and_behind_the_horizon() {
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        let signs = |to: [DVec2; 4]| {
            let h = Homography::from_corners(square, to).unwrap();
            (0..4).for_each(|i| assert!(h.apply(square[i]).distance(to[i]) < 1e-9));
            square.map(|p| h.apply_homogeneous(p).z > 0.0)
        };
        let quad = [DVec2::ZERO, DVec2::new(3.0, 0.2), DVec2::new(2.0, 1.5), DVec2::new(-0.5, 1.2)];
        let [a, b, c, d] = quad;
        let one_side = |s: [bool; 4]| s.iter().all(|&v| v == s[0]);
        assert!(one_side(signs(quad)));
        // If the target quadrilateral intersects itself or is not convex, the corners of the square lie on both sides
        // of the horizon, the line that maps to infinity.
        let crossed = signs([a, b, d, c]);
        assert!(crossed[0] == crossed[1] && crossed[2] == crossed[3] && crossed[0] != crossed[2], "{crossed:?}");
        let dented = signs([a, b, DVec2::new(0.8, 0.3), d]);
        assert_eq!(dented.iter().filter(|&&v| v).count() % 2, 1, "{dented:?}");
        // A point on the horizon has no finite image.
        let h = Homography(
            DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::Z) + DMat3::from_cols(-DVec3::Z, DVec3::ZERO, DVec3::ZERO),
        );
        assert_eq!(h.apply_homogeneous(DVec2::X).z, 0.0);
        assert!(!h.apply(DVec2::ONE).is_finite());
    }
}
