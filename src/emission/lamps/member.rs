//! The measured shape of a lamp: the moments of its outline, and the length of a photo pixel at the lamp.

use super::design::Shape;
use super::luminaire::Luminaire;
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::foreshortening::LocalMap;
use crate::emission::exemplar::measured_lamp::MeasuredLamp;
use crate::emission::exemplar::roles::Role;
use crate::geometry::polygon;
use crate::maths;
use glam::{DMat2, DVec2};
use std::f64::consts::{FRAC_PI_2, PI};

/// Two axes count as parallel if the angle between them is at most this, in radians. [judged on 20 photos]
pub const MAX_ALIGNED_ANGLE: f64 = 0.07;
/// Blur rounds the corners of a rectangle, so its sides are measured away from the corners. The length is a mean over
/// the middle part of the width, and the width is a mean over the middle part of the length. The middle part has this
/// share of the whole. [judged on 20 photos]
const MIDDLE_SHARE: f64 = 0.6;

/// Minimum share of the area inside the outline of a ring or a frame that is dark. [convention]
const MIN_HOLE: f64 = 0.05;
/// The darkness of a lamp is a hole in its middle if this share of the points at which a hole would be dark are dark,
/// and of the points at which the band around it would shine do shine. [convention]
const MIN_AS_HOLE: f64 = 0.9;
/// Number of directions in which these points lie. [rounding]
const DIRECTIONS: usize = 16;

/// A lamp of a kind, with its outline and the moments of the area inside the outline. Lengths are in unwarped pixels.
pub struct Member {
    /// Index of the lamp's component in the exemplar.
    pub component: usize,
    pub outline: Vec<DVec2>,
    pub area: f64,
    pub centre: DVec2,
    /// Covariance matrix of the points inside the outline.
    pub moments: DMat2,
    /// Angle from the x axis to a side of the smallest rectangle around the outline, in radians, from 0 to below π/2.
    pub angle: f64,
    /// Number of photo pixels that show the lamp.
    pub weight: f64,
    /// Length of a photo pixel at the lamp, along x and along y.
    pub blur: DVec2,
    /// Near the lamp, converts a step in photo pixels to a step in unwarped pixels.
    pub inverse_map: DMat2,
    /// Whether the photo shows the lamp completely, away from the border.
    pub is_clear: bool,
    /// Share of the area inside the outline that a dark hole in the middle of the lamp takes; 0 without such a hole.
    pub hole_share: f64,
}

impl Member {
    pub fn new(lamp: &MeasuredLamp, exemplar: &Exemplar, outlines: &[Luminaire]) -> Option<Self> {
        let outline = &outlines[lamp.component].outline;
        let (area, centre, moments) = polygon_moments(outline)?;
        let dark = 1.0 - outlines[lamp.component].area / area;
        let is_hole = dark >= MIN_HOLE && is_dark_in_the_middle(exemplar, lamp.component, centre, moments, dark);
        Some(Self {
            component: lamp.component,
            angle: rectangle_angle(outline),
            outline: outline.clone(),
            area,
            centre,
            moments,
            weight: lamp.weight,
            blur: lamp.blur,
            inverse_map: LocalMap::new(exemplar.to_photo, centre).inverse(),
            is_clear: exemplar.roles[lamp.component] == Role::Whole,
            hole_share: if is_hole { dark } else { 0.0 },
        })
    }

    /// Standard deviations of the points inside the outline, along and across an axis.
    pub fn deviations(&self, axis: DVec2) -> DVec2 {
        let along = |a: DVec2| a.dot(self.moments * a).max(0.0).sqrt();
        DVec2::new(along(axis), along(axis.perp()))
    }

    /// The lamp's sides along and across an axis, if it has the given shape. The sides of an ellipse follow from its
    /// standard deviations. The sides of a rectangle are measured away from its blurred corners ([`MIDDLE_SHARE`]).
    pub fn sides(&self, axis: DVec2, shape: Shape) -> DVec2 {
        let sides = self.deviations(axis) * shape.sides_per_deviation();
        if shape == Shape::Ellipse {
            return sides;
        }
        let width = |across: DVec2, length: f64| {
            let (at, half) = (across.dot(self.centre), MIDDLE_SHARE * length / 2.0);
            let above = polygon::clip(&self.outline, across, at + half);
            polygon::area(&polygon::clip(&above, -across, half - at)).abs() / (2.0 * half).max(f64::MIN_POSITIVE)
        };
        DVec2::new(width(axis.perp(), sides.y), width(axis, sides.x))
    }

    /// Length of a photo pixel near the lamp along a unit vector, in unwarped pixels.
    pub fn photo_pixel(&self, along: DVec2) -> f64 {
        (self.inverse_map.transpose() * along).length()
    }

    /// Length of a photo pixel near the lamp in unwarped pixels, along and across an axis.
    pub fn blur_along(&self, axis: DVec2) -> DVec2 {
        let along = |a: DVec2| (a.abs() * self.blur).length();
        DVec2::new(along(axis), along(axis.perp()))
    }
}

/// Whether the dark share of a lamp's area is a hole in its middle: dark half way to the rim of such a hole, and light
/// in the middle of the band around it. An ellipse with the lamp's moments stands for its shape.
fn is_dark_in_the_middle(exemplar: &Exemplar, component: usize, centre: DVec2, moments: DMat2, dark: f64) -> bool {
    let [[short, x], [long, y]] = principal(moments);
    let axis = DVec2::new(x, y);
    let hole = dark.sqrt();
    let shines = |angle: f64, radius: f64| {
        let p = maths::direction_at(angle) * 2.0 * radius;
        let at = centre + axis * p.x * long + axis.perp() * p.y * short;
        let [x, y] = at.to_array().map(|v| v.floor());
        x >= 0.0
            && y >= 0.0
            && x < exemplar.width as f64
            && y < exemplar.height as f64
            && exemplar.components.labels[y as usize * exemplar.width + x as usize] == component as u32 + 1
    };
    let as_hole = (0..DIRECTIONS).map(|k| {
        let angle = 2.0 * PI * k as f64 / DIRECTIONS as f64;
        usize::from(!shines(angle, 0.5 * hole)) + usize::from(shines(angle, 0.5 * (1.0 + hole)))
    });
    as_hole.sum::<usize>() as f64 >= MIN_AS_HOLE * (2 * DIRECTIONS) as f64
}

/// Returns `[[short, x], [long, y]]`: the standard deviations along the short and the long principal axis, and the
/// unit vector (x, y) of the long axis.
pub fn principal(moments: DMat2) -> [[f64; 2]; 2] {
    let (xx, xy, yy) = (moments.x_axis.x, moments.x_axis.y, moments.y_axis.y);
    let (mean, spread) = ((xx + yy) / 2.0, maths::hypot((xx - yy) / 2.0, xy));
    let angle = 0.5 * maths::atan2(2.0 * xy, xx - yy);
    let axis = maths::direction_at(angle);
    [[(mean - spread).max(0.0).sqrt(), axis.x], [(mean + spread).sqrt(), axis.y]]
}

/// Area, centroid and covariance matrix of the points inside a polygon (Steger 1996); `None` if the area is 0.
pub fn polygon_moments(corners: &[DVec2]) -> Option<(f64, DVec2, DMat2)> {
    let origin = *corners.first()?;
    let (mut area, mut first, mut xx, mut xy, mut yy) = (0.0, DVec2::ZERO, 0.0, 0.0, 0.0);
    for (p, q) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let (p, q) = (*p - origin, *q - origin);
        let cross = p.perp_dot(q);
        area += cross / 2.0;
        first += (p + q) * cross / 6.0;
        xx += (p.x * p.x + p.x * q.x + q.x * q.x) * cross / 12.0;
        yy += (p.y * p.y + p.y * q.y + q.y * q.y) * cross / 12.0;
        xy += (p.x * q.y + 2.0 * (p.x * p.y + q.x * q.y) + q.x * p.y) * cross / 24.0;
    }
    let mean = first / area;
    let central = |second: f64, a: f64, b: f64| second / area - a * b;
    let xy = central(xy, mean.x, mean.y);
    let moments =
        DMat2::from_cols(DVec2::new(central(xx, mean.x, mean.x), xy), DVec2::new(xy, central(yy, mean.y, mean.y)));
    (area.abs() > 0.0 && moments.is_finite()).then(|| (area.abs(), origin + mean, moments))
}

/// Angle from the x axis to a side of the smallest rectangle around the corners, in radians, from 0 to below π/2
/// (Freeman and Shapira 1975).
pub fn rectangle_angle(corners: &[DVec2]) -> f64 {
    let hull = polygon::convex_hull(corners.to_vec());
    let edges = hull.iter().zip(hull.iter().cycle().skip(1)).filter_map(|(a, b)| (*b - *a).try_normalize());
    let area = |axis: &DVec2| polygon::extent(corners, *axis) * polygon::extent(corners, axis.perp());
    let smallest = edges.min_by(|a, b| area(a).total_cmp(&area(b)));
    smallest.map_or(0.0, |axis| maths::angle_of(axis).rem_euclid(FRAC_PI_2))
}

#[cfg(test)]
mod tests {
    use super::super::design::Design;
    use super::*;

    #[test]
    fn moments_of_polygons_are_exact() {
        let design = Design {
            shape: Shape::Rectangle,
            size: DVec2::new(6.0, 2.0),
            axis: DVec2::from_angle(0.4),
            hole: DVec2::ZERO,
        };
        let (area, centre, moments) = polygon_moments(&design.outline(DVec2::new(30.0, -7.0))).unwrap();
        assert!((area - 12.0).abs() < 1e-9 && (centre - DVec2::new(30.0, -7.0)).length() < 1e-9);
        let along = design.axis.dot(moments * design.axis);
        assert!((along - 3.0).abs() < 1e-9, "{along}");
    }
}
