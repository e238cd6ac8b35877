//! Designs: one size and one outline for all lamps of a kind.
//!
//! A photo shows lamps ever smaller and more blurred with their distance, and unwarping magnifies the blur: of equal
//! lamps the far ones come out larger and ragged. Lamps that are alike but for blur are of one kind. The shape
//! (rectangle or ellipse) and the size of a kind are estimated from all its lamps, each weighted by how finely the
//! photo shows it; bloom adds equally many photo pixels to every lamp, so it shows as a size that grows with
//! magnification, and is subtracted as far as the lamps show it. The outline is then exact at any resolution. Lamps of
//! another shape keep their own outline.
//!
//! Not modelled: rings, and lamps whose shapes are alike but turned.

use super::luminaire::Luminaire;
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::evidence::Evidence;
use crate::emission::exemplar::foreshortening::LocalMap;
use crate::emission::exemplar::roles::Role;
use crate::geometry::polygon;
use glam::{DMat2, DVec2};
use std::f64::consts::{FRAC_PI_2, PI};

/// Largest length of an ellipse, as a multiple of its width: blur makes discs long, but longer shapes are tubes with
/// round ends. And by how much better an ellipse must agree with the lamps than a rectangle, because blur rounds the
/// corners of a rectangle. [judged on 20 photos]
const MAX_ELLIPSE: f64 = 2.5;
const ROUNDER: f64 = 0.03;
/// Largest area of a lamp, in photo pixels, whose shape blur alone may explain; ratio of axes from which a lamp or its
/// blur counts as long; and the cosine of the largest angle between the long axes of both. [judged on 20 photos]
const MAX_SMEARED: f64 = 160.0;
const SMEAR: f64 = 1.25;
const ALONG: f64 = 0.9;
/// Lamps count as long in the same direction if the mean of their doubled directions is longer than this; its length is
/// 1 where all directions agree. Lamps that are each long along their own blur, in different directions, are discs,
/// whatever their size. [judged on 20 photos]
const SAME_WAY: f64 = 0.93;
/// Smallest area that lamp and shape have in common, as a share of the area that they cover together.
/// [judged on 20 photos]
const MIN_AGREEMENT: f64 = 0.72;
/// A side of a rectangle is measured within this share of its other side, about the middle. [judged on 20 photos]
const MIDDLE: f64 = 0.6;
/// Largest angle, in radians, at which lamps count as aligned with the axes of the plane. [judged on 20 photos]
const ALIGNED: f64 = 0.07;
/// Standard deviation of a side, and of the bloom at each edge, in pixels of the photo. [judged on 20 photos]
const SIDE_NOISE: f64 = 0.7;
const BLOOM: f64 = 0.5;
/// Standard deviation of the bloom where the lamps show bloom: where it explains at least the share `EXPLAINED` of the
/// differences of their sides, and there are at least `MIN_JUDGES` lamps. Lamps of several lengths, or hidden in part,
/// do not show it: their sides do not grow with magnification. [bench photos:tune, photos:real]
const SHOWN_BLOOM: f64 = 1.5;
const EXPLAINED: f64 = 0.5;
const MIN_JUDGES: usize = 4;
/// Corners of an ellipse's outline. [rounding]
const ELLIPSE_CORNERS: usize = 64;

/// The outline of a kind of lamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    Rectangle,
    Ellipse,
}

impl Shape {
    /// Ratio of a side to the standard deviation of the shape along it: a rectangle of side s has a deviation of s /
    /// √12, an ellipse of diameter d has a deviation of d / 4.
    fn sides_per_deviation(self) -> f64 {
        match self {
            Self::Rectangle => 12f64.sqrt(),
            Self::Ellipse => 4.0,
        }
    }
}

/// The shape and size of a kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    pub shape: Shape,
    /// Sides in unwarped pixels, along and across `axis`.
    pub size: DVec2,
    /// Unit vector.
    pub axis: DVec2,
}

/// A lamp of the exemplar that has a design.
#[derive(Clone, Copy, Debug)]
pub struct Fitted {
    pub kind: usize,
    pub centre: DVec2,
    /// The lamp's sides as the photo shows them, blur included.
    pub size: DVec2,
    /// Unwarped pixels along and across the axis that a pixel of the photo covers.
    pub photo_pixel: DVec2,
}

/// The designs of an exemplar's lamps.
#[derive(Default)]
pub struct Designs {
    pub kinds: Vec<Design>,
    /// The design of each component, if it has one.
    pub lamps: Vec<Option<Fitted>>,
}

impl Designs {
    /// Finds the kinds of the whole lamps, whose outlines are given, and the design of each.
    pub fn find(exemplar: &Exemplar, outlines: &[Luminaire]) -> Self {
        let mut designs = Self { kinds: Vec::new(), lamps: vec![None; outlines.len()] };
        for kind in Evidence::kinds(&exemplar.evidence(Role::is_whole)) {
            let members: Vec<Member> = kind.iter().filter_map(|lamp| Member::new(lamp, exemplar, outlines)).collect();
            if let Some((design, fitted)) = fit(&members, designs.kinds.len()) {
                designs.kinds.push(design);
                fitted.into_iter().for_each(|(component, fitted)| designs.lamps[component] = Some(fitted));
            }
        }
        designs
    }

    /// Total area of the lamps by their designs, over their total area in the unwarped photo.
    pub fn area_ratio(&self, exemplar: &Exemplar) -> f64 {
        let (mut designed, mut shown) = (0.0, 0.0);
        for (k, lamp) in exemplar.components.list.iter().enumerate() {
            if let Some((design, _)) = self.of(k) {
                designed += design.area();
                shown += lamp.area as f64;
            }
        }
        if shown > 0.0 { designed / shown } else { 1.0 }
    }

    /// The design of a component, and how the component fits it.
    pub fn of(&self, component: usize) -> Option<(&Design, &Fitted)> {
        let fitted = self.lamps.get(component)?.as_ref()?;
        Some((&self.kinds[fitted.kind], fitted))
    }
}

/// A lamp of a kind, and the moments of its outline.
struct Member {
    component: usize,
    outline: Vec<DVec2>,
    area: f64,
    centre: DVec2,
    /// Second moments over the area: variances and covariance.
    moments: DMat2,
    /// Angle of the smallest rectangle around the outline, in [0, π/2).
    angle: f64,
    weight: f64,
    blur: DVec2,
    /// Unwarped pixels per photo pixel, near the lamp.
    inverse_map: DMat2,
    is_clear: bool,
}

impl Member {
    fn new(lamp: &Evidence, exemplar: &Exemplar, outlines: &[Luminaire]) -> Option<Self> {
        let outline = &outlines[lamp.component].outline;
        let (area, centre, moments) = polygon_moments(outline)?;
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
        })
    }

    /// Whether the lamp and a photo pixel, seen in the unwarped image, are both long, and in the same direction.
    fn is_smeared(&self) -> bool {
        let [[short, x], [long, y]] = principal(self.moments);
        let [[least, u], [most, v]] = principal(self.inverse_map * self.inverse_map.transpose());
        let along = DVec2::new(x, y).dot(DVec2::new(u, v)).abs();
        long > SMEAR * short && most > SMEAR * least && along > ALONG
    }

    /// Standard deviations along and across an axis.
    fn deviations(&self, axis: DVec2) -> DVec2 {
        let along = |a: DVec2| a.dot(self.moments * a).max(0.0).sqrt();
        DVec2::new(along(axis), along(axis.perp()))
    }

    /// Sides along and across an axis, if the lamp has the given shape. A side of a rectangle is measured in the middle
    /// of its other side, because blur rounds the corners.
    fn sides(&self, axis: DVec2, shape: Shape) -> DVec2 {
        let sides = self.deviations(axis) * shape.sides_per_deviation();
        if shape == Shape::Ellipse {
            return sides;
        }
        let width = |across: DVec2, length: f64| {
            let (at, half) = (across.dot(self.centre), MIDDLE * length / 2.0);
            let above = polygon::clip(&self.outline, across, at + half);
            polygon::area(&polygon::clip(&above, -across, half - at)).abs() / (2.0 * half).max(f64::MIN_POSITIVE)
        };
        DVec2::new(width(axis.perp(), sides.y), width(axis, sides.x))
    }

    /// Unwarped pixels along and across an axis that a pixel of the photo covers.
    fn blur_along(&self, axis: DVec2) -> DVec2 {
        let along = |a: DVec2| (a.abs() * self.blur).length();
        DVec2::new(along(axis), along(axis.perp()))
    }
}

/// The design of a kind, and how each lamp fits it; `None` where no simple shape agrees with the lamps.
fn fit(members: &[Member], kind: usize) -> Option<(Design, Vec<(usize, Fitted)>)> {
    let mut judges: Vec<&Member> = members.iter().filter(|m| m.is_clear).collect();
    if judges.is_empty() {
        judges = members.iter().collect();
    }
    let total: f64 = judges.iter().map(|m| m.weight).sum();
    let axis = common_axis(&judges);
    let mean = |value: &dyn Fn(&Member) -> f64| judges.iter().map(|m| m.weight * value(m)).sum::<f64>() / total;
    let design = [Shape::Rectangle, Shape::Ellipse].map(|shape| {
        let sides = judges.iter().map(|m| (m.sides(axis, shape), m.blur_along(axis)));
        let side = |k: usize| common_side(sides.clone().map(|(size, blur)| (size[k], blur[k])));
        let design = Design { shape, size: DVec2::new(side(0)?, side(1)?), axis };
        let agreement = mean(&|m| {
            let own = Design { size: m.sides(axis, shape), ..design };
            own.agreement(&m.outline, m.area, m.centre)
        });
        Some((design, agreement))
    });
    let [Some(rectangle), Some(ellipse)] = design else { return None };
    let aspect = ellipse.0.size.max_element() / ellipse.0.size.min_element();
    let is_round = aspect <= MAX_ELLIPSE && ellipse.1 > rectangle.1 + ROUNDER;
    let (mut design, agreement) = if is_round { ellipse } else { rectangle };
    if agreement < MIN_AGREEMENT {
        return None;
    }
    if let Some(diameter) = smeared_disc(&judges) {
        design = Design { shape: Shape::Ellipse, size: DVec2::splat(diameter), axis: DVec2::X };
    }
    let Design { axis, shape, .. } = design;
    let fitted = |m: &Member| {
        let (size, photo_pixel) = (m.sides(axis, shape), m.blur_along(axis));
        (m.component, Fitted { kind, centre: m.centre, size, photo_pixel })
    };
    Some((design, members.iter().map(fitted).collect()))
}

/// The diameter of lamps that are discs made long by blur: most are long along the long axis of their blur, and they
/// are small in the photo or long in different directions. The diameter is read from the shorter axis. `None` for other
/// lamps.
fn smeared_disc(members: &[&Member]) -> Option<f64> {
    let total: f64 = members.iter().map(|m| m.weight).sum();
    let mean_area = members.iter().map(|m| m.weight * m.weight).sum::<f64>() / total;
    let smeared: f64 = members.iter().filter(|m| m.is_smeared()).map(|m| m.weight).sum();
    let turn = |m: &&Member| {
        let [[_, x], [_, y]] = principal(m.moments);
        DVec2::from_angle(2.0 * y.atan2(x)) * m.weight
    };
    let common_turn = members.iter().map(|m| turn(m)).sum::<DVec2>().length() / total;
    if smeared < 0.5 * total || (mean_area > MAX_SMEARED && common_turn > SAME_WAY) {
        return None;
    }
    common_side(members.iter().map(|m| {
        let [[short, x], [_, y]] = principal(m.moments);
        let across = DVec2::new(-y, x);
        (4.0 * short, (m.inverse_map.transpose() * across).length())
    }))
}

/// Deviations along the short and the long principal axis, and the unit vector of the long one: `[[short, x], [long,
/// y]]`.
fn principal(moments: DMat2) -> [[f64; 2]; 2] {
    let (xx, xy, yy) = (moments.x_axis.x, moments.x_axis.y, moments.y_axis.y);
    let (mean, spread) = ((xx + yy) / 2.0, ((xx - yy) / 2.0).hypot(xy));
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    let axis = DVec2::from_angle(angle);
    [[(mean - spread).max(0.0).sqrt(), axis.x], [(mean + spread).sqrt(), axis.y]]
}

/// The common axis of the rectangles around lamps: the mean of their angles modulo a right angle; the x axis where that
/// is nearly aligned.
fn common_axis(members: &[&Member]) -> DVec2 {
    let sum: DVec2 = members.iter().map(|m| DVec2::from_angle(4.0 * m.angle) * m.weight).sum();
    let angle = sum.to_angle() / 4.0;
    if angle.abs() <= ALIGNED { DVec2::X } else { DVec2::from_angle(angle) }
}

/// The side that lamps have in common. Each lamp gives a pair: its side, and the unwarped pixels that a photo pixel
/// covers there. Solves side = s + 2 bloom × photo pixel by least squares, with a prior on the bloom given by its
/// standard deviation.
fn common_side(sides: impl Iterator<Item = (f64, f64)> + Clone) -> Option<f64> {
    // Normal equations of s and bloom.
    let (mut gram, mut sums, mut square) = (DMat2::ZERO, DVec2::ZERO, 0.0);
    let (mut least, mut count) = (f64::INFINITY, 0);
    for (side, pixel) in sides {
        let weight = (SIDE_NOISE * pixel).powi(-2);
        let row = DVec2::new(1.0, 2.0 * pixel);
        gram += DMat2::from_cols(row * row.x, row * row.y) * weight;
        sums += row * side * weight;
        square += side * side * weight;
        (least, count) = (least.min(side), count + 1);
    }
    let mean = sums.x / gram.x_axis.x;
    let fit = |deviation: f64| (gram + DMat2::from_diagonal(DVec2::new(0.0, deviation.powi(-2)))).inverse() * sums;
    let shown = fit(SHOWN_BLOOM);
    // Sums of squared residuals of the fit and of the mean.
    let (left, all) = (square - 2.0 * shown.dot(sums) + shown.dot(gram * shown), square - mean * sums.x);
    let is_shown = count >= MIN_JUDGES && left < (1.0 - EXPLAINED) * all;
    let fitted = if is_shown { shown } else { fit(BLOOM) };
    let bloomless = if fitted.y > 0.0 && count > 1 { fitted.x } else { mean };
    Some(bloomless.max(0.5 * least)).filter(|s| s.is_finite() && *s > 0.0)
}

impl Design {
    /// Corners of the outline around a centre, from x towards y.
    pub fn outline(&self, centre: DVec2) -> Vec<DVec2> {
        let half = self.size / 2.0;
        let at = |p: DVec2| centre + self.axis * p.x + self.axis.perp() * p.y;
        match self.shape {
            Shape::Rectangle => {
                [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|p| at(half * DVec2::from(p))).to_vec()
            }
            Shape::Ellipse => (0..ELLIPSE_CORNERS)
                .map(|i| at(half * DVec2::from_angle(2.0 * PI * i as f64 / ELLIPSE_CORNERS as f64)))
                .collect(),
        }
    }

    pub fn area(&self) -> f64 {
        self.size.element_product() * if self.shape == Shape::Rectangle { 1.0 } else { PI / 4.0 }
    }

    /// Gives a luminaire this size and outline, around a centre.
    pub fn describe(&self, centre: DVec2, lamp: &mut Luminaire) {
        let along_is_long = self.size.x >= self.size.y;
        let axis = if along_is_long { self.axis } else { self.axis.perp() };
        let angle = axis.to_angle();
        lamp.centre = centre;
        lamp.size = if along_is_long { self.size } else { DVec2::new(self.size.y, self.size.x) };
        lamp.orientation = if angle > FRAC_PI_2 { angle - PI } else { angle };
        lamp.area = self.area();
        lamp.outline = self.outline(centre);
    }

    /// Half of the box around the outline.
    pub fn half_box(&self) -> DVec2 {
        let half = self.size / 2.0;
        let (a, b) = (self.axis * half.x, self.axis.perp() * half.y);
        match self.shape {
            Shape::Rectangle => a.abs() + b.abs(),
            Shape::Ellipse => (a * a + b * b).map(f64::sqrt),
        }
    }

    /// Share of a square that lies within the design. The square's middle lies at `p` from the design's centre.
    pub fn coverage(&self, p: DVec2, side: f64) -> f64 {
        let q = DVec2::new(p.dot(self.axis), p.dot(self.axis.perp()));
        let half = self.size / 2.0;
        match self.shape {
            // Exact where the square is aligned with the rectangle.
            Shape::Rectangle => {
                let along = |q: f64, half: f64| {
                    let (low, high) = ((q - side / 2.0).max(-half), (q + side / 2.0).min(half));
                    ((high - low) / side).max(0.0)
                };
                along(q.x, half.x) * along(q.y, half.y)
            }
            // From the signed distance to the ellipse, to first order.
            Shape::Ellipse => {
                let u = q / half;
                let r = u.length();
                let slope = (u / half).length() / r.max(f64::MIN_POSITIVE);
                let distance = if r > 1e-9 { (r - 1.0) / slope } else { -half.min_element() };
                (0.5 - distance / side).clamp(0.0, 1.0)
            }
        }
    }

    /// Area that a polygon and the design around `centre` have in common, over the area that they cover together.
    fn agreement(&self, polygon: &[DVec2], area: f64, centre: DVec2) -> f64 {
        let own = self.outline(centre);
        let common = own.iter().zip(own.iter().cycle().skip(1)).fold(polygon.to_vec(), |clipped, (p, q)| {
            let normal = (*q - *p).perp() * -1.0;
            polygon::clip(&clipped, normal, normal.dot(*p))
        });
        let common = polygon::area(&common).abs();
        common / (area + self.area() - common).max(f64::MIN_POSITIVE)
    }
}

/// Area, centroid and central second moments over the area of a polygon (Steger 1996); `None` where it encloses
/// nothing.
fn polygon_moments(corners: &[DVec2]) -> Option<(f64, DVec2, DMat2)> {
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

/// The angle in [0, π/2) of the smallest rectangle around corners (Freeman and Shapira 1975).
fn rectangle_angle(corners: &[DVec2]) -> f64 {
    let hull = polygon::convex_hull(corners.to_vec());
    let edges = hull.iter().zip(hull.iter().cycle().skip(1)).filter_map(|(a, b)| (*b - *a).try_normalize());
    let area = |axis: &DVec2| polygon::extent(corners, *axis) * polygon::extent(corners, axis.perp());
    let smallest = edges.min_by(|a, b| area(a).total_cmp(&area(b)));
    smallest.map_or(0.0, |axis| axis.to_angle().rem_euclid(FRAC_PI_2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_polygons_are_exact() {
        let design = Design { shape: Shape::Rectangle, size: DVec2::new(6.0, 2.0), axis: DVec2::from_angle(0.4) };
        let (area, centre, moments) = polygon_moments(&design.outline(DVec2::new(30.0, -7.0))).unwrap();
        assert!((area - 12.0).abs() < 1e-9 && (centre - DVec2::new(30.0, -7.0)).length() < 1e-9);
        let along = design.axis.dot(moments * design.axis);
        assert!((along - 3.0).abs() < 1e-9, "{along}");
    }

    #[test]
    fn bloom_that_grows_with_magnification_is_taken_off() {
        // Sides of 40 unwarped pixels, each edge blurred outwards by 0.8 photo pixels that cover ever more.
        let pixels = [1.0f64, 1.5, 2.5, 4.0, 6.0];
        let side = common_side(pixels.into_iter().map(|p| (40.0 + 1.6 * p, p))).unwrap();
        assert!((side - 40.0).abs() < 1.0, "{side}");
        // A lone lamp is what it is.
        assert!((common_side([(41.6, 1.0)].into_iter()).unwrap() - 41.6).abs() < 1e-9);
    }

    #[test]
    fn coverage_adds_up_to_the_area() {
        for shape in [Shape::Rectangle, Shape::Ellipse] {
            let design = Design { shape, size: DVec2::new(9.3, 5.7), axis: DVec2::X };
            let sum: f64 = (0..40 * 40)
                .map(|i| DVec2::new(f64::from(i % 40), f64::from(i / 40)) * 0.5 - DVec2::new(10.13, 9.9))
                .map(|p| design.coverage(p, 0.5) * 0.25)
                .sum();
            assert!((sum / design.area() - 1.0).abs() < 0.01, "{shape:?}: {sum}");
        }
    }
}
