//! Fits the bounding rectangle of a planar patch, with axes that do not depend on how its triangles are stored.

use crate::geometry::polygon;
use glam::{DVec2, DVec3};

/// Cosine of 1°. If the axes of the smallest rectangle differ by less than this angle from the axes aligned with the
/// world, the aligned axes are used instead. [convention]
const COS_SNAP: f64 = 0.999_847_695;
/// A rotated rectangle replaces the aligned one only if its area is smaller by more than this share. For a surface that
/// is itself a rectangle, turned by an angle θ, the rotated rectangle is smaller than the aligned one by at least the
/// share sin 2θ / (1 + sin 2θ). This is 3.4 % at the 1° of `COS_SNAP`. So any value from 1e-5, above the rounding of
/// f32, to 0.03 gives the same result for such surfaces. [convention]
const MIN_SAVING: f64 = 1e-3;
/// A plane is a wall if the magnitude of the vertical component of its unit normal is below this value, the cosine of
/// 45°. [convention]
const WALL: f64 = std::f64::consts::FRAC_1_SQRT_2;

pub struct BoundingRectangle {
    /// The corner with u = v = 0.
    pub origin: DVec3,
    pub u: DVec3,
    pub v: DVec3,
    pub size: DVec2,
}

/// Fits a bounding rectangle to points in the plane through `centre`. The result is the smallest rectangle, unless the
/// rectangle aligned with the world axes is nearly parallel (`COS_SNAP`) or nearly as small (`MIN_SAVING`); then it is
/// the aligned one. The unit `normal` points at the viewer, to whom u runs right and v runs down.
pub fn fit(points: &[DVec3], centre: DVec3, normal: DVec3) -> BoundingRectangle {
    let upright = upright(normal);
    let turned = smallest(points, centre, upright, normal);
    let (aligned_rectangle, turned_rectangle) =
        (bound(points, centre, upright, normal), bound(points, centre, turned, normal));
    let aligned = turned.dot(upright) >= COS_SNAP
        || turned_rectangle.size.element_product() > (1.0 - MIN_SAVING) * aligned_rectangle.size.element_product();
    if aligned { aligned_rectangle } else { turned_rectangle }
}

/// Returns the u axis of the rectangle that is aligned with the world axes. It is horizontal on a wall, and the
/// projection of +x onto the plane otherwise.
fn upright(normal: DVec3) -> DVec3 {
    let candidate = if normal.y.abs() < WALL {
        // On a wall, v points down as far as possible, and u = normal × v.
        let down = DVec3::NEG_Y - normal * DVec3::NEG_Y.dot(normal);
        normal.cross(down)
    } else {
        DVec3::X - normal * normal.x
    };
    candidate.normalize_or(normal.any_orthonormal_vector())
}

/// Returns the v axis that corresponds to `u`: `u × v = -normal`.
fn down_of(u: DVec3, normal: DVec3) -> DVec3 {
    u.cross(normal)
}

/// Returns the bounding rectangle with sides along `u` and along the corresponding v axis.
pub fn bound(points: &[DVec3], centre: DVec3, u: DVec3, normal: DVec3) -> BoundingRectangle {
    let v = down_of(u, normal);
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for p in points {
        let at = DVec2::new((*p - centre).dot(u), (*p - centre).dot(v));
        low = low.min(at);
        high = high.max(at);
    }
    BoundingRectangle { origin: centre + u * low.x + v * low.y, u, v, size: high - low }
}

/// Returns the u axis of the bounding rectangle of minimum area. Of the four directions of the rectangle's sides, it is
/// the direction that differs from `upright` by at most 45°. A side of the rectangle lies along an edge of the convex
/// hull (Freeman and Shapira 1975).
fn smallest(points: &[DVec3], centre: DVec3, upright: DVec3, normal: DVec3) -> DVec3 {
    let v = down_of(upright, normal);
    let flat = points.iter().map(|p| DVec2::new((*p - centre).dot(upright), (*p - centre).dot(v)));
    let hull = polygon::convex_hull(flat.collect());
    let mut best = (f64::INFINITY, DVec2::X);
    for (i, a) in hull.iter().enumerate() {
        let Some(edge) = (hull[(i + 1) % hull.len()] - *a).try_normalize() else { continue };
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for p in &hull {
            let at = DVec2::new(p.dot(edge), p.perp_dot(edge));
            low = low.min(at);
            high = high.max(at);
        }
        let area = (high - low).element_product();
        if area < best.0 * (1.0 - 1e-9) {
            best = (area, edge);
        }
    }
    // Of the four directions along the sides of the rectangle, take the direction nearest to `upright`.
    let edge = best.1;
    let turns = [edge, edge.perp(), -edge, -edge.perp()];
    let nearest = turns.into_iter().fold(edge, |a, b| if b.x > a.x + 1e-12 { b } else { a });
    (upright * nearest.x + v * nearest.y).normalize_or(upright)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_rectangle_of_a_turned_one_is_itself() {
        for degrees in [0.0f64, 0.5, 10.0, 30.0, 44.0, 80.0] {
            let turn = DVec2::from_angle(degrees.to_radians());
            let points: Vec<DVec3> = [(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0), (1.0, 1.0)]
                .map(|(x, y)| DVec2::new(x, y).rotate(turn))
                .map(|p| DVec3::new(p.x, 2.5, p.y))
                .into();
            let rectangle = fit(&points, points[4], DVec3::NEG_Y);
            assert!((rectangle.u.cross(rectangle.v) - DVec3::Y).length() < 1e-12, "{degrees}");
            let slack = if degrees == 0.5 { 0.06 } else { 1e-9 };
            let (long, short) = (rectangle.size.max_element(), rectangle.size.min_element());
            assert!((long - 3.0).abs() < slack && (short - 2.0).abs() < slack, "{degrees}: {}", rectangle.size);
            // A rectangle rotated by half a degree snaps to the world axes; larger rotations do not.
            assert!((degrees > 1.0) != (rectangle.u == DVec3::X), "{degrees}: {}", rectangle.u);
            assert!(rectangle.u.x >= WALL - 1e-9);
        }
    }

    #[test]
    fn rectangles_are_oriented_as_seen_from_the_room() {
        let square = |u: DVec3, v: DVec3| [DVec3::ZERO, u, u + v, v];
        // Expected axes u and v for a ceiling, a floor and two walls.
        for (normal, u, v) in [
            (DVec3::NEG_Y, DVec3::X, DVec3::NEG_Z),
            (DVec3::Y, DVec3::X, DVec3::Z),
            (DVec3::Z, DVec3::X, DVec3::NEG_Y),
            (DVec3::X, DVec3::NEG_Z, DVec3::NEG_Y),
        ] {
            let rectangle = fit(&square(u, v), DVec3::ZERO, normal);
            assert!(
                (rectangle.u - u).length() < 1e-12 && (rectangle.v - v).length() < 1e-12,
                "{normal}: {} {}",
                rectangle.u,
                rectangle.v
            );
        }
    }
}
