//! Polygons and point sets in the plane: extent, area, clipping and convex hull.

use glam::DVec2;

/// Returns the extent of a set of points along a unit direction.
pub fn extent(points: &[DVec2], axis: DVec2) -> f64 {
    let along = points.iter().map(|p| p.dot(axis));
    along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
}

/// Returns the signed area, positive if the corners turn from the x axis towards the y axis.
pub fn area(corners: &[DVec2]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>() / 2.0
}

/// Returns the part of a convex polygon in the half-plane `normal · p <= offset` (Sutherland and Hodgman 1974).
pub fn clip(corners: &[DVec2], normal: DVec2, offset: f64) -> Vec<DVec2> {
    let mut out = Vec::with_capacity(corners.len() + 1);
    for (i, &p) in corners.iter().enumerate() {
        let q = corners[(i + 1) % corners.len()];
        let (dp, dq) = (normal.dot(p) - offset, normal.dot(q) - offset);
        if dp <= 0.0 {
            out.push(p);
        }
        if (dp < 0.0 && dq > 0.0) || (dp > 0.0 && dq < 0.0) {
            out.push(p + (q - p) * (dp / (dp - dq)));
        }
    }
    out
}

/// Returns the convex hull of a set of points, counter-clockwise with y up (Andrew's monotone chain, 1979).
pub fn convex_hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let mut hull: Vec<DVec2> = Vec::new();
    let half = |hull: &mut Vec<DVec2>, start: usize, p: DVec2| {
        while hull.len() >= start + 2 {
            let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
            if (b - a).perp_dot(p - b) > 0.0 {
                break;
            }
            hull.pop();
        }
        hull.push(p);
    };
    for &p in &points {
        half(&mut hull, 0, p);
    }
    let start = hull.len().saturating_sub(1);
    for &p in points.iter().rev().skip(1) {
        half(&mut hull, start, p);
    }
    if hull.len() > 1 {
        hull.pop();
    }
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_square_has_half_its_area() {
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        assert_eq!(area(&square), 1.0);
        assert_eq!(area(&clip(&square, DVec2::X, 0.25)), 0.25);
        assert_eq!(area(&clip(&square, DVec2::ONE, 1.0)), 0.5);
        assert!(clip(&square, DVec2::X, -1.0).is_empty());
        assert_eq!(clip(&square, DVec2::X, 2.0), square);
    }
}
