//! The luminous faces of an opening as triangles, for renderings: rectangles, discs, and the sides of boxes, cylinders
//! and ellipsoids.
//!
//! A flat face has the same projected area as in [`Opening::projected_area`] in every direction. A polyhedron
//! approximates a curved face; it is scaled such that its projected area is correct on average over all directions.
//! Points are in the coordinates of the luminaire, as in [`super::opening`].

use super::opening::Opening;
use crate::maths;
use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Number of sides of the polygon that stands for a circle: its outline deviates from the circle by 0.1 % of the
/// radius. [convention]
const SIDES: usize = 64;
/// Number of neighbouring sides of a cylinder that form one patch. [convention]
const SIDES_PER_PATCH: usize = 8;
/// How often the triangles of an icosahedron are divided into four to approximate a ball. [convention]
const DIVISIONS: usize = 3;

/// A group of triangles with similar normals, from which a renderer samples points.
#[derive(Clone, Debug, PartialEq)]
pub struct FacePatch {
    pub triangles: Range<usize>,
    /// Whether the patch emits light; other patches only block light.
    pub is_luminous: bool,
}

/// The faces of an opening. All triangles are wound anticlockwise as seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faces {
    pub points: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    pub patches: Vec<FacePatch>,
}

/// The half-spaces into which a luminaire emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emits {
    /// Whether light goes to γ < 90°.
    pub forwards: bool,
    /// Whether light goes to γ > 90°.
    pub backwards: bool,
}

impl Faces {
    /// Returns the faces of an opening. Flat faces are moved outwards by `gap` metres, in front of a ceiling or a wall
    /// that lies in the same plane. An opening without height has a face only on the sides to which the luminaire
    /// emits; if the luminaire is dark, only the face towards γ = 0.
    pub fn new(opening: &Opening, emits: Emits, gap: f64) -> Self {
        let mut faces = Self::default();
        let is_luminous = |normal: DVec3| match normal.z {
            1.0 => emits.forwards,
            -1.0 => emits.backwards,
            _ => emits.forwards || emits.backwards,
        };
        // A flat opening has no face on a side to which the luminaire does not emit.
        let is_left_out = |normal: DVec3| match normal.z {
            1.0 => !emits.forwards && emits.backwards,
            -1.0 => !emits.backwards,
            _ => false,
        };
        match *opening {
            Opening::Box { size, heights } => {
                for normal in DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
                    if size.dot(normal.abs()) > 0.0 || !is_left_out(normal) {
                        faces.add_side(size, heights, normal, gap, is_luminous(normal));
                    }
                }
            }
            Opening::Cylinder { axis, length, diameters } => {
                let directions = [axis, (axis + 1) % 3, (axis + 2) % 3].map(|i| DVec3::AXES[i]);
                for sign in [1.0, -1.0] {
                    let normal = directions[0] * sign;
                    if length > 0.0 || !is_left_out(normal) {
                        let centre = normal * (length / 2.0 + gap);
                        faces.add_disc(centre, directions, diameters, sign > 0.0, is_luminous(normal));
                    }
                }
                if length > 0.0 {
                    faces.add_tube(length, directions, diameters, is_luminous(DVec3::X));
                }
            }
            Opening::Ellipsoid(diameters) => faces.add_ellipsoid(diameters, is_luminous(DVec3::X)),
        }
        faces
    }

    /// Returns the outward unit normal of a triangle times the triangle's area in m².
    pub fn area_vector(&self, triangle: usize) -> DVec3 {
        let [a, b, c] = self.triangles[triangle].map(|i| self.points[i as usize]);
        (b - a).cross(c - a) / 2.0
    }

    fn point(&mut self, point: DVec3) -> u32 {
        self.points.push(point);
        self.points.len() as u32 - 1
    }

    /// Adds the patch of the triangles from `first` to the last triangle so far.
    fn end_patch(&mut self, first: usize, is_luminous: bool) {
        self.patches.push(FacePatch { triangles: first..self.triangles.len(), is_luminous });
    }

    /// Adds the rectangle with these half-sides, unless it has no area. Its normal is `half[0]` × `half[1]`.
    fn add_rectangle(&mut self, centre: DVec3, half: [DVec3; 2], is_luminous: bool) {
        if half[0].cross(half[1]) == DVec3::ZERO {
            return;
        }
        let first = self.triangles.len();
        let corners = [-half[0] - half[1], half[0] - half[1], half[0] + half[1], half[1] - half[0]];
        let [a, b, c, d] = corners.map(|corner| self.point(centre + corner));
        self.triangles.extend([[a, b, c], [a, c, d]]);
        self.end_patch(first, is_luminous);
    }

    /// Adds the side of a box that faces along `normal`, a positive or negative coordinate axis. Of a vertical side,
    /// the strip next to the face towards γ = 0 is luminous if `is_luminous` is true; the strip's height is the side's
    /// entry in `heights`. The remaining part of the side is dark.
    fn add_side(&mut self, size: DVec3, heights: [f64; 4], normal: DVec3, gap: f64, is_luminous: bool) {
        let axis = (0..3).find(|&i| normal[i] != 0.0).unwrap_or(0);
        let [next, last] = [(axis + 1) % 3, (axis + 2) % 3].map(|i| DVec3::AXES[i]);
        let half = [next * size.dot(next) / 2.0, last * size.dot(last) / 2.0];
        let half = if normal[axis] > 0.0 { half } else { [half[1], half[0]] };
        let centre = normal * (size[axis] / 2.0 + gap);
        if axis == 2 {
            return self.add_rectangle(centre, half, is_luminous);
        }
        let luminous = heights[axis + if normal[axis] > 0.0 { 0 } else { 2 }];
        // The luminous strip begins at the face towards γ = 0, which is at the largest z.
        for (low, high, is_luminous) in [(size.z - luminous, size.z, is_luminous), (0.0, size.z - luminous, false)] {
            let share = if size.z > 0.0 { (high - low) / size.z } else { 0.0 };
            let part = half.map(|half| DVec3::new(half.x, half.y, half.z * share));
            let middle = DVec3::Z * ((low + high - size.z) / 2.0);
            self.add_rectangle(centre + middle, part, is_luminous);
        }
    }

    /// Adds a polygon that stands for an ellipse with the given diameters and has its area. `directions` are the normal
    /// and the directions of the diameters.
    fn add_disc(
        &mut self,
        centre: DVec3,
        directions: [DVec3; 3],
        diameters: [f64; 2],
        is_forwards: bool,
        is_luminous: bool,
    ) {
        // Enlarge the inscribed polygon to the area of the ellipse.
        let step = TAU / SIDES as f64;
        let ring = Ring { directions, diameters, scale: (step / maths::sin(step)).sqrt() };
        let first = self.triangles.len();
        let middle = self.point(centre);
        let corners: Vec<u32> = (0..SIDES).map(|i| self.point(centre + ring.corner(i))).collect();
        for i in 0..SIDES {
            let (a, b) = (corners[i], corners[(i + 1) % SIDES]);
            self.triangles.push(if is_forwards { [middle, a, b] } else { [middle, b, a] });
        }
        self.end_patch(first, is_luminous);
    }

    /// Adds the side of an elliptic cylinder.
    fn add_tube(&mut self, length: f64, directions: [DVec3; 3], diameters: [f64; 2], is_luminous: bool) {
        // Enlarge the inscribed polygon to the perimeter of the ellipse. Both then have the same mean width over all
        // directions, since the mean width of a convex curve is its perimeter / π (Cauchy).
        let half_step = PI / SIDES as f64;
        let ring = Ring { directions, diameters, scale: half_step / maths::sin(half_step) };
        let ends: Vec<[u32; 2]> = (0..SIDES)
            .map(|i| [-0.5, 0.5].map(|side| self.point(ring.corner(i) + directions[0] * (length * side))))
            .collect();
        for patch in 0..SIDES / SIDES_PER_PATCH {
            let first = self.triangles.len();
            for i in patch * SIDES_PER_PATCH..(patch + 1) * SIDES_PER_PATCH {
                let ([a, b], [c, d]) = (ends[i], ends[(i + 1) % SIDES]);
                self.triangles.extend([[a, c, d], [a, d, b]]);
            }
            self.end_patch(first, is_luminous);
        }
    }

    /// Adds an ellipsoid: a divided icosahedron, scaled to the surface area of a ball and then stretched along the
    /// axes.
    fn add_ellipsoid(&mut self, diameters: DVec3, is_luminous: bool) {
        let mut unit = Vec::new();
        for corners in icosahedron() {
            divide(corners, DIVISIONS, &mut unit);
        }
        let area: f64 = unit.iter().map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum();
        let scale = diameters / 2.0 * (4.0 * PI / area).sqrt();
        // Neighbouring triangles share their corners. Equal corners are found by their bits, so add 0, which turns -0
        // into +0.
        let mut known = BTreeMap::new();
        for patch in unit.chunks(1 << (2 * DIVISIONS)) {
            let first = self.triangles.len();
            for triangle in patch {
                let corners = triangle.map(|p| {
                    let key = (p + DVec3::ZERO).to_array().map(f64::to_bits);
                    *known.entry(key).or_insert_with(|| self.point(p * scale))
                });
                self.triangles.push(corners);
            }
            self.end_patch(first, is_luminous);
        }
    }
}

/// The polygon that stands for an ellipse.
struct Ring {
    /// The normal, and the directions of the two diameters.
    directions: [DVec3; 3],
    diameters: [f64; 2],
    scale: f64,
}

impl Ring {
    fn corner(&self, i: usize) -> DVec3 {
        let (sine, cosine) = maths::sin_cos(TAU * i as f64 / SIDES as f64);
        let [_, first, second] = self.directions;
        (first * (self.diameters[0] * cosine) + second * (self.diameters[1] * sine)) * (self.scale / 2.0)
    }
}

/// Returns the triangles of an icosahedron in the unit ball, wound anticlockwise as seen from outside.
fn icosahedron() -> Vec<[DVec3; 3]> {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let corners: Vec<DVec3> = (0..3)
        .flat_map(|axis| {
            [[1.0, golden], [1.0, -golden], [-1.0, golden], [-1.0, -golden]]
                .map(|[short, long]| (DVec3::AXES[axis] * short + DVec3::AXES[(axis + 1) % 3] * long).normalize())
        })
        .collect();
    // Two corners are joined by an edge if their distance is the smallest that occurs between corners.
    let edge = 4.0 / (1.0 + golden * golden);
    let is_edge = |a: DVec3, b: DVec3| a.distance_squared(b) < edge * 1.5;
    let mut triangles = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        for (j, &b) in corners.iter().enumerate().skip(i + 1).filter(|(_, b)| is_edge(a, **b)) {
            for &c in corners.iter().skip(j + 1).filter(|c| is_edge(a, **c) && is_edge(b, **c)) {
                let is_outwards = (b - a).cross(c - a).dot(a) > 0.0;
                triangles.push(if is_outwards { [a, b, c] } else { [a, c, b] });
            }
        }
    }
    triangles
}

/// Divides a triangle on the unit ball into 4^`times` triangles on the ball: each step divides every triangle into
/// four.
fn divide([a, b, c]: [DVec3; 3], times: usize, out: &mut Vec<[DVec3; 3]>) {
    if times == 0 {
        return out.push([a, b, c]);
    }
    let [ab, bc, ca] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
    for triangle in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
        divide(triangle, times - 1, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: Emits = Emits { forwards: true, backwards: true };

    /// Returns the area of the luminous faces as seen from a direction. The shapes are convex, so no face hides
    /// another.
    fn seen(faces: &Faces, direction: DVec3) -> f64 {
        let luminous = faces.patches.iter().filter(|patch| patch.is_luminous);
        luminous.flat_map(|patch| patch.triangles.clone()).map(|t| faces.area_vector(t).dot(direction).max(0.0)).sum()
    }

    fn directions() -> impl Iterator<Item = DVec3> {
        (0..2000).map(|i| {
            let z: f64 = 1.0 - (2.0 * f64::from(i) + 1.0) / 2000.0;
            let (sine, cosine) = (f64::from(i) * 2.399963).sin_cos();
            DVec3::new(cosine * (1.0 - z * z).sqrt(), sine * (1.0 - z * z).sqrt(), z)
        })
    }

    /// In every direction, flat faces have exactly the projected areas of the closed forms. Curved faces have them on
    /// average over all directions. In single directions they are off by at most the share (π / 64)² / 3 = 8.03e-4: a
    /// polygon of 64 sides is narrower by this share, in its narrowest direction, than a circle of equal mean width.
    #[test]
    fn faces_have_the_projected_areas_of_their_opening() {
        for (size, heights, tolerance) in [
            ([0.6, 0.6, 0.0], None, 1e-12),
            ([1.2, 0.3, 0.1], None, 1e-12),
            ([1.2, 0.3, 0.1], Some([0.0, 0.05, 0.1, 0.02]), 1e-12),
            ([0.0, 0.3, 0.1], None, 1e-12),
            ([-0.4, -0.4, 0.0], None, 1e-12),
            ([-0.4, -0.2, 0.0], None, 1e-12),
            ([-0.4, -0.4, 0.5], None, 8.1e-4),
            ([-0.4, -0.2, 0.5], None, 8.1e-4),
            ([1.2, -0.026, -0.026], None, 8.1e-4),
            ([-0.3, -0.3, -0.3], None, 8.1e-4),
            ([-0.3, -0.2, -0.5], None, 8.1e-4),
        ] {
            let opening = Opening::new(size, heights).unwrap();
            let faces = Faces::new(&opening, BOTH, 1e-4);
            let (mut sum, mut worst, mut count) = (0.0, 0.0f64, 0);
            for direction in directions() {
                let off = seen(&faces, direction) / opening.projected_area(direction) - 1.0;
                worst = worst.max(off.abs());
                (sum, count) = (sum + off, count + 1);
            }
            assert!(worst < tolerance && (sum / f64::from(count)).abs() < 2e-4, "{size:?}: {worst} {sum}");
            // The triangles face outwards.
            let is_outwards = |t: usize| faces.area_vector(t).dot(faces.points[faces.triangles[t][0] as usize]) > 0.0;
            assert!((0..faces.triangles.len()).all(is_outwards), "{size:?}");
            assert_eq!(faces.patches.last().unwrap().triangles.end, faces.triangles.len());
            assert!(faces.points.len() < 700);
        }
    }

    #[test]
    fn flat_openings_have_faces_where_they_emit() {
        let panel = Opening::new([0.6, 0.3, 0.0], None).unwrap();
        let disc = Opening::new([-0.6, -0.6, 0.0], None).unwrap();
        for (opening, [forwards, backwards], sides) in [
            (panel, [true, false], vec![1.0]),
            (panel, [false, true], vec![-1.0]),
            (panel, [true, true], vec![1.0, -1.0]),
            (panel, [false, false], vec![1.0]),
            (disc, [true, false], vec![1.0]),
            (disc, [false, true], vec![-1.0]),
        ] {
            let faces = Faces::new(&opening, Emits { forwards, backwards }, 1e-3);
            let of_patch = |p: &FacePatch| {
                let first = p.triangles.start;
                let height = faces.points[faces.triangles[first][0] as usize].z;
                assert!((height.abs() - 1e-3).abs() < 1e-12 && height * faces.area_vector(first).z > 0.0);
                assert_eq!(p.is_luminous, forwards || backwards);
                height.signum()
            };
            assert_eq!(faces.patches.iter().map(of_patch).collect::<Vec<_>>(), sides, "{opening:?}");
        }
        // The upper face of a box that emits downwards is dark, and so are the upper parts of its sides.
        let side = Opening::new([0.6, 0.3, 0.1], Some([0.04; 4])).unwrap();
        let faces = Faces::new(&side, Emits { forwards: true, backwards: false }, 0.0);
        assert_eq!((faces.patches.len(), faces.patches.iter().filter(|p| p.is_luminous).count()), (10, 5));
        let top = seen(&faces, -DVec3::Z);
        assert_eq!(top, 0.0);
    }
}
