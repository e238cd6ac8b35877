//! The design of a kind of lamps: a rectangle or an ellipse, which is sharp at any resolution. Rings and frames have a
//! hole of the same shape in the middle.

use super::luminaire::Luminaire;
use crate::geometry::polygon;
use crate::maths;
use glam::DVec2;
use std::f64::consts::{FRAC_PI_2, PI};

/// Number of corners of an ellipse's outline. [rounding]
const ELLIPSE_CORNERS: usize = 64;

/// The shape of the outline of a kind of lamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    Rectangle,
    Ellipse,
}

impl Shape {
    /// Ratio of a side to the standard deviation of the shape's points along this side. The deviation is s / √12 for a
    /// rectangle with side s, and d / 4 for an ellipse with diameter d.
    pub fn sides_per_deviation(self) -> f64 {
        match self {
            Self::Rectangle => 12f64.sqrt(),
            Self::Ellipse => 4.0,
        }
    }
}

/// The shape and the size of a kind of lamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    pub shape: Shape,
    /// Sides in unwarped pixels, along and across `axis`.
    pub size: DVec2,
    /// Direction of the first side, a unit vector.
    pub axis: DVec2,
    /// Sides of the dark hole in the middle, along and across `axis`; 0 without a hole.
    pub hole: DVec2,
}

impl Design {
    /// Corners of the outline around a centre, in the order of increasing angle from x towards y.
    pub fn outline(&self, centre: DVec2) -> Vec<DVec2> {
        let half = self.size / 2.0;
        let at = |p: DVec2| centre + self.axis * p.x + self.axis.perp() * p.y;
        match self.shape {
            Shape::Rectangle => {
                [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|p| at(half * DVec2::from(p))).to_vec()
            }
            Shape::Ellipse => (0..ELLIPSE_CORNERS)
                .map(|i| at(half * maths::direction_at(2.0 * PI * i as f64 / ELLIPSE_CORNERS as f64)))
                .collect(),
        }
    }

    /// Area without the hole.
    pub fn area(&self) -> f64 {
        self.area_within(self.size) - self.area_within(self.hole)
    }

    /// Area of the design's shape with other sides.
    fn area_within(&self, sides: DVec2) -> f64 {
        sides.element_product() * if self.shape == Shape::Rectangle { 1.0 } else { PI / 4.0 }
    }

    /// The design with a hole that leaves a band of the given width; without a hole if the band fills the shape.
    pub fn with_band(self, width: f64) -> Self {
        let hole = self.size - 2.0 * width;
        Self { hole: if hole.min_element() > 0.0 { hole } else { DVec2::ZERO }, ..self }
    }

    /// The point on the middle line of the band around the hole, in the direction of `p` from the centre. `p` and the
    /// result are relative to the centre, along and across the axis.
    pub fn middle_of_band(&self, p: DVec2) -> DVec2 {
        let u = 2.0 * p / self.size;
        let length = if self.shape == Shape::Rectangle { u.abs().max_element() } else { u.length() };
        u / length.max(f64::MIN_POSITIVE) * (self.size + self.hole) / 4.0
    }

    /// Sets the centre, size, orientation, area and outline of a luminaire from this design.
    pub fn describe(&self, centre: DVec2, lamp: &mut Luminaire) {
        let along_is_long = self.size.x >= self.size.y;
        let axis = if along_is_long { self.axis } else { self.axis.perp() };
        let angle = maths::angle_of(axis);
        lamp.centre = centre;
        lamp.size = if along_is_long { self.size } else { DVec2::new(self.size.y, self.size.x) };
        lamp.orientation = if angle > FRAC_PI_2 { angle - PI } else { angle };
        lamp.area = self.area();
        lamp.outline = self.outline(centre);
    }

    /// Half-extents of the outline's axis-aligned bounding box.
    pub fn half_box(&self) -> DVec2 {
        let half = self.size / 2.0;
        let (a, b) = (self.axis * half.x, self.axis.perp() * half.y);
        match self.shape {
            Shape::Rectangle => a.abs() + b.abs(),
            Shape::Ellipse => (a * a + b * b).map(f64::sqrt),
        }
    }

    /// Share of an axis-aligned square that lies within the design. `p` is the square's centre relative to the design's
    /// centre, and `side` the length of its sides.
    pub fn coverage(&self, p: DVec2, side: f64) -> f64 {
        let q = DVec2::new(p.dot(self.axis), p.dot(self.axis.perp()));
        let hole = if self.hole == DVec2::ZERO { 0.0 } else { self.coverage_within(self.hole / 2.0, q, side) };
        (self.coverage_within(self.size / 2.0, q, side) - hole).max(0.0)
    }

    /// The coverage by the design's shape with other half sides. `q` is given along and across the axis.
    fn coverage_within(&self, half: DVec2, q: DVec2, side: f64) -> f64 {
        match self.shape {
            // Exact if the rectangle's axis is parallel to x or y. Otherwise an approximation: the square is rotated
            // about its centre until its sides are parallel to the sides of the rectangle.
            Shape::Rectangle => {
                let along = |q: f64, half: f64| {
                    let (low, high) = ((q - side / 2.0).max(-half), (q + side / 2.0).min(half));
                    ((high - low) / side).max(0.0)
                };
                along(q.x, half.x) * along(q.y, half.y)
            }
            // Let f = |(x / a, y / b)| - 1 for an ellipse with half-axes a and b. To first order, the signed distance
            // to the ellipse is f divided by the length of its gradient.
            Shape::Ellipse => {
                let u = q / half;
                let r = u.length();
                let slope = (u / half).length() / r.max(f64::MIN_POSITIVE);
                let distance = if r > 1e-9 { (r - 1.0) / slope } else { -half.min_element() };
                (0.5 - distance / side).clamp(0.0, 1.0)
            }
        }
    }

    /// Agreement of a polygon of the given area with the outline of the design around `centre`: the area of their
    /// intersection divided by the area of their union.
    pub fn agreement(&self, polygon: &[DVec2], area: f64, centre: DVec2) -> f64 {
        let own = self.outline(centre);
        let common = own.iter().zip(own.iter().cycle().skip(1)).fold(polygon.to_vec(), |clipped, (p, q)| {
            let normal = (*q - *p).perp() * -1.0;
            polygon::clip(&clipped, normal, normal.dot(*p))
        });
        let common = polygon::area(&common).abs();
        common / (area + self.area_within(self.size) - common).max(f64::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_adds_up_to_the_area() {
        let holes = [DVec2::ZERO, DVec2::new(6.1, 2.5)];
        for (shape, hole) in [Shape::Rectangle, Shape::Ellipse].into_iter().flat_map(|s| holes.map(|hole| (s, hole))) {
            let design = Design { shape, size: DVec2::new(9.3, 5.7), axis: DVec2::X, hole };
            let sum: f64 = (0..40 * 40)
                .map(|i| DVec2::new(f64::from(i % 40), f64::from(i / 40)) * 0.5 - DVec2::new(10.13, 9.9))
                .map(|p| design.coverage(p, 0.5) * 0.25)
                .sum();
            assert!((sum / design.area() - 1.0).abs() < 0.01, "{shape:?} with a hole of {hole}: {sum}");
        }
    }
}
