//! Overlap of a rectangle of texels with a triangle: whether the triangle covers none, part or all of the rectangle,
//! the area of the overlap, and uniform sampling of points of the overlap.

use glam::{DVec2, Vec2};

/// A rectangle in texel coordinates.
#[derive(Clone, Copy)]
pub struct Rectangle {
    pub low: DVec2,
    pub high: DVec2,
}

/// How much of a rectangle a triangle covers.
#[derive(Clone, Copy, PartialEq)]
pub enum Overlap {
    None,
    /// The triangle does not cover the whole rectangle, and no edge of the triangle separates it from the rectangle.
    /// Only clipping can tell how large the overlap is; near a corner of the triangle, the overlap may be empty.
    Part,
    Whole,
}

impl Rectangle {
    pub fn area(&self) -> f64 {
        (self.high - self.low).element_product()
    }

    /// Classifies how much of the rectangle the triangle covers, by tests against the edges of the triangle.
    pub fn overlap(&self, triangle: &[DVec2; 3]) -> Overlap {
        let [a, b, c] = *triangle;
        let side = (b - a).perp_dot(c - a).signum();
        let (centre, half) = ((self.low + self.high) / 2.0, (self.high - self.low) / 2.0);
        let mut overlap = Overlap::Whole;
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let edge = q - p;
            let (middle, spread) = (edge.perp_dot(centre - p) * side, edge.abs().perp().abs().dot(half));
            if middle + spread <= 0.0 {
                return Overlap::None;
            }
            if middle - spread < 0.0 {
                overlap = Overlap::Part;
            }
        }
        overlap
    }
}

/// A triangle clipped to a rectangle. It has at most seven corners.
pub struct Polygon {
    corners: [DVec2; 8],
    len: usize,
}

impl Polygon {
    pub fn clipped(triangle: &[DVec2; 3], to: &Rectangle) -> Self {
        let mut polygon = Self { corners: [DVec2::ZERO; 8], len: 3 };
        polygon.corners[..3].copy_from_slice(triangle);
        polygon.clip(|p| p.x - to.low.x);
        polygon.clip(|p| to.high.x - p.x);
        polygon.clip(|p| p.y - to.low.y);
        polygon.clip(|p| to.high.y - p.y);
        polygon
    }

    pub fn corners(&self) -> &[DVec2] {
        &self.corners[..self.len]
    }

    /// Clips the polygon to the half-plane where `inside` is at least 0 (Sutherland and Hodgman 1974).
    fn clip(&mut self, inside: impl Fn(DVec2) -> f64) {
        let from = self.corners;
        let mut len = 0;
        for i in 0..self.len {
            let (p, q) = (from[i], from[(i + 1) % self.len]);
            let (dp, dq) = (inside(p), inside(q));
            if dp >= 0.0 && len < 8 {
                self.corners[len] = p;
                len += 1;
            }
            if dp * dq < 0.0 && len < 8 {
                self.corners[len] = p + (q - p) * (dp / (dp - dq));
                len += 1;
            }
        }
        self.len = len;
    }

    /// Returns twice the area of triangle `i` of the polygon's triangle fan.
    fn fan(&self, i: usize) -> f64 {
        let [a, b, c] = [self.corners[0], self.corners[i], self.corners[i + 1]];
        (b - a).perp_dot(c - a).abs()
    }

    pub fn area(&self) -> f64 {
        (1..self.len.saturating_sub(1)).map(|i| self.fan(i)).sum::<f64>() / 2.0
    }

    /// Samples a point uniformly by area: `u` selects a triangle of the polygon's fan. The remainder of `u`, rescaled
    /// to `[0, 1]`, and `v` select the point in this triangle. Returns `None` if the polygon has fewer than three
    /// corners.
    pub fn sample(&self, (u, v): (f64, f32)) -> Option<DVec2> {
        let mut target = u * 2.0 * self.area();
        let last = self.len.checked_sub(2).filter(|&l| l > 0)?;
        let mut chosen = last;
        for i in 1..last {
            let area = self.fan(i);
            if target < area {
                chosen = i;
                break;
            }
            target -= area;
        }
        let rest = (target / self.fan(chosen)).clamp(0.0, 1.0) as f32;
        let b = uniform_in_triangle(Vec2::new(rest, v)).as_dvec2();
        let [p, q, r] = [self.corners[0], self.corners[chosen], self.corners[chosen + 1]];
        Some(p + (q - p) * b.x + (r - p) * b.y)
    }
}

/// Maps the unit square to a triangle, uniformly by area. Returns the barycentric coordinates of corners 1 and 2.
pub fn uniform_in_triangle(v: Vec2) -> Vec2 {
    let root = v.x.sqrt();
    Vec2::new(root * (1.0 - v.y), root * v.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::tests::chi2::assert_follows;
    use crate::rng::Rng;

    #[test]
    fn sampling_a_triangle_and_its_inverse_are_the_identity() {
        for i in 1..256 * 256 {
            let v = Vec2::new((i % 256) as f32, (i / 256) as f32) / 256.0;
            let b = uniform_in_triangle(v);
            let along = b.x + b.y;
            let back = Vec2::new(along * along, if along > 0.0 { b.y / along } else { v.y });
            assert!(b.min_element() >= 0.0 && along <= 1.0 + 1e-6 && (back - v).abs().max_element() < 1e-6, "{v}: {b}");
        }
    }

    #[test]
    fn points_of_a_clipped_triangle_are_even_by_area() {
        let whole = Rectangle { low: DVec2::ZERO, high: DVec2::ONE };
        let triangles = [
            [DVec2::new(0.5, -0.3), DVec2::new(1.2, 1.1), DVec2::new(-0.3, 0.9)],
            [DVec2::new(0.1, 0.1), DVec2::new(0.2, 0.9), DVec2::new(0.9, 0.5)],
            [DVec2::new(-9.0, -8.0), DVec2::new(9.5, 0.3), DVec2::new(0.2, 7.0)],
        ];
        let mut rng = Rng::new(26, &[]);
        let (side, n) = (12, 50_000);
        for triangle in &triangles {
            let polygon = Polygon::clipped(triangle, &whole);
            // Each bin expects a count proportional to the area of the triangle clipped to the bin.
            let bin = |i: usize| DVec2::new((i % side) as f64, (i / side) as f64) / side as f64;
            let area = |i: usize| {
                Polygon::clipped(triangle, &Rectangle { low: bin(i), high: bin(i) + 1.0 / side as f64 }).area()
            };
            let share = f64::from(n) / polygon.area();
            let expected: Vec<f64> = (0..side * side).map(|i| area(i) * share).collect();
            let mut counts = vec![0.0; side * side];
            for _ in 0..n {
                let p = polygon.sample((rng.next_f64(), rng.next_f32())).unwrap();
                let at = |x: f64| ((x * side as f64) as usize).min(side - 1);
                counts[at(p.y) * side + at(p.x)] += 1.0;
            }
            assert_follows(&expected, &counts, triangles.len(), &format!("{triangle:?}"));
        }
    }
}
