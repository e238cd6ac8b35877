//! The luminous opening of a luminaire: its shape, which LM-63 encodes in the signs of the dimensions, and its
//! projected area `A_p`, by which an intensity is divided to obtain a luminance (CIE 117: `L = I / A_p`).
//!
//! Points are in the luminaire's own coordinates, in metres from the centre of the opening: x along C = 0, y along C =
//! 90, z along the axis towards γ = 0.

use crate::maths;
use glam::DVec3;
use std::f64::consts::FRAC_PI_4;

/// A point within this distance in metres of an opening counts as inside it; no eye is closer to a lamp. [convention]
const CONTACT: f64 = 1e-3;

/// An opening counts as a point if its projected area (m²) along each axis is at most this. The chip of an LED is
/// larger. [convention]
const MIN_AREA: f64 = 1e-6;

/// The shape of a luminous opening, with sizes in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Opening {
    /// A box with these sides along x, y and z; a rectangle if one side is 0. `heights` are the heights of the
    /// luminous strips on the four sides that face along x, y, -x and -y (C = 0, 90, 180, 270). The strips begin at the
    /// face towards γ = 0.
    Box { size: DVec3, heights: [f64; 4] },
    /// A cylinder along the coordinate axis with index `axis`. Its ends are ellipses with their diameters along the
    /// axes with indices `axis + 1` and `axis + 2`, modulo 3. If `length` is 0, it is a flat ellipse.
    Cylinder { axis: usize, length: f64, diameters: [f64; 2] },
    /// An ellipsoid with these diameters along x, y and z.
    Ellipsoid(DVec3),
}

/// A flat face, a parallelogram or an ellipse, that stands for a luminous part of an opening. It looks like that part
/// from one viewing direction only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    pub centre: DVec3,
    /// The sides of the parallelogram, or the diameters of the ellipse.
    pub sides: [DVec3; 2],
    pub is_round: bool,
}

impl Face {
    /// Returns the projected area of the face in m², as seen from far away along the unit vector `direction`.
    pub fn projected_area(&self, direction: DVec3) -> f64 {
        let share = if self.is_round { FRAC_PI_4 } else { 1.0 };
        self.sides[0].cross(self.sides[1]).dot(direction).abs() * share
    }

    /// Maps the unit square to the face. Regions of equal area have images of equal area; for an ellipse, the map
    /// follows Shirley and Chiu (1997).
    pub fn point(&self, [u, v]: [f64; 2]) -> DVec3 {
        let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        let (x, y) = match self.is_round {
            false => (x, y),
            true if x == 0.0 && y == 0.0 => (0.0, 0.0),
            true if x.abs() > y.abs() => (x * maths::cos(FRAC_PI_4 * y / x), x * maths::sin(FRAC_PI_4 * y / x)),
            true => (y * maths::sin(FRAC_PI_4 * x / y), y * maths::cos(FRAC_PI_4 * x / y)),
        };
        self.centre + (self.sides[0] * x + self.sides[1] * y) / 2.0
    }
}

impl Opening {
    /// Returns the opening with the given dimensions in metres along C = 0, along C = 90 and along the axis. A negative
    /// dimension is a diameter. `side_heights` are the luminous heights of a box's sides towards C = 0, 90, 180 and
    /// 270; without them, each side is luminous over the full height of the box. Returns `None` for a luminaire without
    /// area, which is a point, or with infinite area.
    pub fn new([x, y, z]: [f64; 3], side_heights: Option<[f64; 4]>) -> Option<Self> {
        // If a round opening states only one diameter, it has this diameter along both axes.
        let (x, y) = match (x, y) {
            (0.0, d) if d < 0.0 => (d, d),
            (d, 0.0) if d < 0.0 => (d, d),
            sides => sides,
        };
        let [a, b, c] = [x.abs(), y.abs(), z.abs()];
        let heights = side_heights.map_or([c; 4], |heights| heights.map(|h| h.clamp(0.0, c)));
        let opening = match (x < 0.0, y < 0.0, z < 0.0) {
            // LM-63-1995 states a horizontal tube by its length and a negative height.
            (false, false, true) if b == 0.0 => Self::Cylinder { axis: 0, length: a, diameters: [c, c] },
            (false, false, true) if a == 0.0 => Self::Cylinder { axis: 1, length: b, diameters: [c, c] },
            (false, false, _) => Self::Box { size: DVec3::new(a, b, c), heights },
            (true, true, true) => Self::Ellipsoid(DVec3::new(a, b, c)),
            (false, true, true) => Self::Cylinder { axis: 0, length: a, diameters: [b, c] },
            (true, false, true) => Self::Cylinder { axis: 1, length: b, diameters: [c, a] },
            (_, _, false) => Self::Cylinder { axis: 2, length: c, diameters: [a, b] },
        };
        let sides = [a * b, a * c, b * c];
        let is_finite = sides.iter().all(|s| s.is_finite());
        (is_finite && opening.largest_area() > MIN_AREA).then_some(opening)
    }

    /// Returns flat faces that look like the opening to an observer far away; `direction` is the unit vector towards
    /// the observer. The projected areas of the faces add up to the projected area of the opening.
    pub fn faces(&self, direction: DVec3) -> Vec<Face> {
        match *self {
            Self::Box { size, heights } => box_faces(size, heights, direction),
            Self::Cylinder { axis, length, diameters } => cylinder(axis, length, diameters, direction),
            Self::Ellipsoid(diameters) => {
                // Scaling by the diameters maps a ball to the ellipsoid. Undo this scaling for the direction. Seen
                // along the resulting direction, the outline of the ball is a circle. Scale two perpendicular diameters
                // of this circle: they become conjugate diameters of the ellipsoid's outline.
                let of_ball = (direction / diameters).normalize_or(DVec3::Z).any_orthonormal_pair();
                let sides = [of_ball.0 * diameters, of_ball.1 * diameters];
                vec![Face { centre: DVec3::ZERO, sides, is_round: true }]
            }
        }
    }

    /// Returns the projected luminous area in m², as seen from far away along the unit vector `direction`. Dark parts
    /// of a box's sides are left out.
    pub fn projected_area(&self, direction: DVec3) -> f64 {
        let u = direction.abs();
        match *self {
            Self::Box { size, heights: [right, front, left, back] } => {
                let along_x = if direction.x >= 0.0 { right } else { left };
                let along_y = if direction.y >= 0.0 { front } else { back };
                size.x * size.y * u.z + along_x * size.y * u.x + along_y * size.x * u.y
            }
            Self::Cylinder { axis, length, diameters: [a, b] } => {
                let width = maths::hypot(a * u[(axis + 2) % 3], b * u[(axis + 1) % 3]);
                FRAC_PI_4 * a * b * u[axis] + length * width
            }
            Self::Ellipsoid(d) => FRAC_PI_4 * DVec3::new(d.y * d.z * u.x, d.z * d.x * u.y, d.x * d.y * u.z).length(),
        }
    }

    /// Returns the largest projected luminous area in m², as seen from ±x, ±y and ±z.
    pub fn largest_area(&self) -> f64 {
        DVec3::AXES.iter().flat_map(|&axis| [axis, -axis]).map(|u| self.projected_area(u)).fold(0.0, f64::max)
    }

    /// Whether a point lies inside the opening or within `CONTACT` of it.
    pub fn contains(&self, point: DVec3) -> bool {
        let within = |p: f64, size: f64| p.abs() <= size / 2.0 + CONTACT;
        match *self {
            Self::Box { size, .. } => (0..3).all(|axis| within(point[axis], size[axis])),
            Self::Cylinder { axis, length, diameters: [a, b] } => {
                let [p, q] = [point[(axis + 1) % 3], point[(axis + 2) % 3]];
                let [a, b] = [a / 2.0 + CONTACT, b / 2.0 + CONTACT];
                within(point[axis], length) && maths::powi(p / a, 2) + maths::powi(q / b, 2) <= 1.0
            }
            Self::Ellipsoid(diameters) => (point / (diameters / 2.0 + CONTACT)).length() <= 1.0,
        }
    }
}

/// Returns the luminous faces of a box that are seen from `direction`.
fn box_faces(size: DVec3, heights: [f64; 4], direction: DVec3) -> Vec<Face> {
    let face = |axis: usize| {
        let towards = DVec3::AXES[axis] * direction[axis].signum();
        let [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
        let mut extent = size;
        let mut centre = towards * size[axis] / 2.0;
        if axis < 2 {
            // The luminous part of a side begins at the face towards γ = 0.
            extent.z = heights[axis + if direction[axis] < 0.0 { 2 } else { 0 }];
            centre.z = (size.z - extent.z) / 2.0;
        }
        let sides = [DVec3::AXES[next] * extent[next], DVec3::AXES[last] * extent[last]];
        Face { centre, sides, is_round: false }
    };
    (0..3).map(face).filter(|face| face.projected_area(direction) > 0.0).collect()
}

/// Returns two faces that stand for a cylinder seen from `direction`: the end that faces the observer, and a rectangle
/// with the same projected area as the cylinder's side. A face without projected area is left out.
fn cylinder(axis: usize, length: f64, [a, b]: [f64; 2], direction: DVec3) -> Vec<Face> {
    let [along, first, second] = [axis, (axis + 1) % 3, (axis + 2) % 3].map(|i| DVec3::AXES[i]);
    let end = along * (length / 2.0 * direction[axis].signum());
    let mut faces = vec![Face { centre: end, sides: [first * a, second * b], is_round: true }];
    let (u, v) = (direction.dot(first), direction.dot(second));
    let across = maths::hypot(u, v);
    if length > 0.0 && across > 0.0 {
        // Compute the width of the elliptic cross section as seen along `direction`, and the point of the ellipse
        // nearest to the observer.
        let (u, v) = (u / across, v / across);
        let width = maths::hypot(a * v, b * u);
        let depth = maths::hypot(a * u, b * v).max(f64::MIN_POSITIVE);
        let nearest = (first * (a * a * u) + second * (b * b * v)) / (2.0 * depth);
        let tangent = second * u - first * v;
        // Place a rectangle of this width, parallel to the axis, on the near side of the cylinder.
        let centre = (first * u + second * v) * nearest.dot(first * u + second * v);
        faces.push(Face { centre, sides: [tangent * width, along * length], is_round: false });
    }
    faces.retain(|face| face.projected_area(direction) > 0.0);
    faces
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(size: [f64; 3], c: f64, gamma: f64) -> f64 {
        let (c, gamma) = (c.to_radians(), gamma.to_radians());
        let direction = DVec3::new(gamma.sin() * c.cos(), gamma.sin() * c.sin(), gamma.cos());
        let opening = Opening::new(size, None).unwrap();
        let of_faces: f64 = opening.faces(direction).iter().map(|face| face.projected_area(direction)).sum();
        near(opening.projected_area(direction), of_faces);
        of_faces
    }

    fn disc(diameter: f64) -> f64 {
        FRAC_PI_4 * diameter * diameter
    }

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }

    #[test]
    fn projected_areas_are_closed_forms() {
        near(seen([1.2, 0.3, 0.0], 30.0, 60.0), 0.36 * 0.5);
        // A box seen from the side along C = 0 shows its face of width times height.
        near(seen([1.2, 0.3, 0.1], 0.0, 90.0), 0.3 * 0.1);
        near(seen([1.2, 0.3, 0.1], 90.0, 90.0), 1.2 * 0.1);
        near(seen([-0.4, -0.4, 0.0], 77.0, 60.0), disc(0.4) * 0.5);
        near(seen([0.0, -0.4, 0.0], 77.0, 0.0), disc(0.4));
        near(seen([-0.4, -0.4, 0.5], 77.0, 90.0), 0.4 * 0.5);
        near(seen([-0.4, -0.4, -0.4], 12.0, 34.0), disc(0.4));
        // From C = 0, a tube that runs along C = 0 shows its end. From C = 90 and from below it shows its side.
        near(seen([1.2, -0.026, -0.026], 0.0, 90.0), disc(0.026));
        near(seen([1.2, -0.026, -0.026], 90.0, 90.0), 1.2 * 0.026);
        near(seen([1.2, -0.026, -0.026], 90.0, 0.0), 1.2 * 0.026);
        near(seen([1.2, 0.0, -0.026], 0.0, 90.0), disc(0.026));
        near(seen([0.0, 1.2, -0.026], 0.0, 90.0), 1.2 * 0.026);
        near(seen([-0.6, 0.2, 0.0], 0.0, 0.0), FRAC_PI_4 * 0.6 * 0.2);
        // Seen along one of its axes, an ellipsoid is an ellipse.
        near(seen([-0.6, -0.2, -0.3], 0.0, 0.0), FRAC_PI_4 * 0.6 * 0.2);
        near(seen([-0.6, -0.2, -0.3], 90.0, 90.0), FRAC_PI_4 * 0.6 * 0.3);
        seen([-0.6, -0.2, -0.3], 25.0, 70.0);
    }

    /// A box of 1.2 × 0.3 × 0.1 m of which one long side is luminous on half of its height, and one short side is dark.
    #[test]
    fn sides_of_a_box_have_heights_of_their_own() {
        let opening = Opening::new([1.2, 0.3, 0.1], Some([0.0, 0.05, 0.1, 0.1])).unwrap();
        for (direction, area) in [
            (DVec3::X, 0.0),
            (DVec3::Y, 1.2 * 0.05),
            (-DVec3::X, 0.3 * 0.1),
            (-DVec3::Y, 1.2 * 0.1),
            (DVec3::new(0.6, 0.48, 0.64), 0.48 * 1.2 * 0.05 + 0.64 * 0.36),
        ] {
            let of_faces: f64 = opening.faces(direction).iter().map(|face| face.projected_area(direction)).sum();
            near(opening.projected_area(direction), area);
            near(of_faces, area);
        }
        let [side] = opening.faces(DVec3::Y)[..] else { panic!("one side is seen") };
        assert_eq!((side.centre.y, side.centre.z), (0.15, 0.025));
    }

    #[test]
    fn luminaires_without_area_are_points() {
        for size in [[0.0; 3], [0.0, 0.0, 0.3], [1.2, 0.0, 0.0], [f64::NAN, 1.0, 0.0], [5e-4; 3], [-1e-3, -1e-3, 0.0]] {
            assert_eq!(Opening::new(size, None), None, "{size:?}");
        }
    }

    #[test]
    fn points_of_faces_lie_on_their_opening() {
        let direction = DVec3::new(0.3, -0.5, 0.8).normalize();
        for size in [[1.2, 0.3, 0.1], [-0.4, -0.4, 0.0], [-0.4, -0.4, 0.5]] {
            let opening = Opening::new(size, None).unwrap();
            for face in opening.faces(direction) {
                for uv in [[0.5, 0.5], [0.01, 0.02], [0.99, 0.4], [0.3, 0.98]] {
                    assert!(size[2] > 0.0 || opening.contains(face.point(uv)), "{size:?} {face:?} {uv:?}");
                }
            }
            assert!(opening.contains(DVec3::ZERO) && !opening.contains(DVec3::splat(1.0)));
        }
        let disc = Opening::new([-2.0, -2.0, 0.0], None).unwrap();
        assert!(disc.contains(DVec3::new(0.7, 0.7, 5e-4)) && !disc.contains(DVec3::new(0.8, 0.8, 0.0)));
    }
}
