//! Designs: one size and one outline for all lamps of a kind, estimated from the photo.
//!
//! In a photo, distant lamps are small and blurred, and unwarping magnifies the blur. In the unwarped photo, distant
//! lamps therefore look larger and more ragged than equal lamps nearby.
//!
//! 1. Lamps that are equal apart from blur form a kind.
//! 2. The shape (rectangle or ellipse) and the size of a kind are estimated from all its lamps, weighted by their
//!    number of photo pixels.
//! 3. Bloom adds a constant number of photo pixels to every side. Where unwarping magnifies more, a side therefore
//!    becomes longer in unwarped pixels. This growth is estimated from the lamps and subtracted.
//!
//! The resulting outline is a geometric shape, so it is sharp at any resolution. Lamps that are neither rectangles nor
//! ellipses keep their own outline.
//!
//! Not modelled: ring-shaped lamps; lamps of equal shape but different orientation.

use super::luminaire::Luminaire;
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::foreshortening::LocalMap;
use crate::emission::exemplar::measured_lamp::MeasuredLamp;
use crate::emission::exemplar::roles::Role;
use crate::geometry::polygon;
use glam::{DMat2, DVec2};
use std::f64::consts::{FRAC_PI_2, PI};

/// An ellipse is chosen only if its length is at most `MAX_ELLIPSE` times its width; longer shapes are tubes with round
/// ends. Its agreement with the lamps ([`MIN_AGREEMENT`]) must exceed that of a rectangle by `MIN_ELLIPSE_GAIN`,
/// because blur rounds the corners of rectangles. [judged on 20 photos]
const MAX_ELLIPSE: f64 = 2.5;
const MIN_ELLIPSE_GAIN: f64 = 0.03;
/// Limits for discs that blur has elongated. [judged on 20 photos]
/// - `MAX_SMEARED`: lamps with a larger mean area, in photo pixels, need other evidence ([`disc`]).
/// - `MIN_SMEAR`: the long axis must exceed the short axis by this factor, both for the lamp and for a photo pixel in
///   the unwarped photo.
/// - `MIN_COS_ALONG`: minimum cosine of the angle between the long axes of the lamp and of the photo pixel.
const MAX_SMEARED: f64 = 160.0;
const MIN_SMEAR: f64 = 1.25;
const MIN_COS_ALONG: f64 = 0.9;
/// Let α be the angle of a lamp's long axis. Lamps count as elongated in one common direction if the mean of their unit
/// vectors at the angles 2α is longer than this. The mean has length 1 if all axes are parallel. Lamps that are
/// elongated along their own blur, but not in a common direction, are discs, whatever their size. [judged on 20 photos]
const MIN_COMMON_DIRECTION: f64 = 0.93;
/// A kind of lamps gets a design only if the mean agreement of its lamps with the shape is at least this. A lamp is
/// compared with the shape that has the lamp's own sides. Agreement is the area of their intersection divided by the
/// area of their union. [judged on 20 photos]
const MIN_AGREEMENT: f64 = 0.72;
/// Blur rounds the corners of a rectangle, so its sides are measured away from the corners. The length is a mean over
/// the middle part of the width, and the width is a mean over the middle part of the length. The middle part has this
/// share of the whole. [judged on 20 photos]
const MIDDLE_SHARE: f64 = 0.6;
/// Lamps count as aligned with the axes of the unwarped photo if their angle to an axis is at most this, in radians.
/// [judged on 20 photos]
const MAX_ALIGNED_ANGLE: f64 = 0.07;
/// `SIDE_NOISE`: standard deviation of the error of a measured side, in photo pixels. Bloom moves each edge outwards by
/// some photo pixels; `BLOOM` is the standard deviation of its prior, with mean 0. [judged on 20 photos]
const SIDE_NOISE: f64 = 0.7;
const BLOOM: f64 = 0.5;
/// The wider prior `SHOWN_BLOOM`, in photo pixels, replaces `BLOOM` if the lamps show their bloom, which means:
///
/// - There are at least `MIN_BLOOM_LAMPS` lamps.
/// - The estimated bloom is between 0 and `MAX_BLOOM` photo pixels.
/// - The bloom explains more than the share `MIN_EXPLAINED` of the variation of the sides. Lamps of several lengths and
///   partly hidden lamps fail this condition, because their sides do not grow with magnification.
///
/// `MIN_SIDE`: minimum side without bloom, as a share of the shortest measured side. [bench photos:tune, photos:real]
const SHOWN_BLOOM: f64 = 6.0;
const MAX_BLOOM: f64 = 10.0;
const MIN_EXPLAINED: f64 = 0.5;
const MIN_BLOOM_LAMPS: usize = 4;
const MIN_SIDE: f64 = 0.35;
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
    fn sides_per_deviation(self) -> f64 {
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
}

/// The fit of a lamp of the exemplar to a design. Lengths are in unwarped pixels.
#[derive(Clone, Copy, Debug)]
pub struct Fitted {
    /// Index of the design in [`Designs::kinds`].
    pub kind: usize,
    pub centre: DVec2,
    /// The lamp's sides in the unwarped photo, along and across the design's axis. They include blur and bloom.
    pub size: DVec2,
    /// Length of a photo pixel near the lamp, along and across the design's axis.
    pub photo_pixel: DVec2,
}

/// The designs of an exemplar's lamps.
#[derive(Default)]
pub struct Designs {
    pub kinds: Vec<Design>,
    /// For each component, its fit to a design; `None` if it has no design.
    pub lamps: Vec<Option<Fitted>>,
}

impl Designs {
    /// Finds the kinds among the whole lamps, and the design of each kind. `outlines` holds the outline of every
    /// component.
    pub fn find(exemplar: &Exemplar, outlines: &[Luminaire]) -> Self {
        let mut designs = Self { kinds: Vec::new(), lamps: vec![None; outlines.len()] };
        for kind in MeasuredLamp::kinds(&exemplar.measured_lamps(Role::is_whole)) {
            let members: Vec<Member> = kind.iter().filter_map(|lamp| Member::new(lamp, exemplar, outlines)).collect();
            if let Some((design, fitted)) = fit(&members, designs.kinds.len()) {
                designs.kinds.push(design);
                fitted.into_iter().for_each(|(component, fitted)| designs.lamps[component] = Some(fitted));
            }
        }
        designs
    }

    /// Total area of the designs of all lamps that have one, divided by the total area that these lamps cover in the
    /// unwarped photo. 1 if no lamp has a design.
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

    /// The design of a component, and how the component fits it; `None` if the component has no design.
    pub fn of(&self, component: usize) -> Option<(&Design, &Fitted)> {
        let fitted = self.lamps.get(component)?.as_ref()?;
        Some((&self.kinds[fitted.kind], fitted))
    }
}

/// A lamp of a kind, with the moments of its outline. Lengths are in unwarped pixels.
struct Member {
    /// Index of the lamp's component in the exemplar.
    component: usize,
    outline: Vec<DVec2>,
    area: f64,
    centre: DVec2,
    /// Covariance matrix of the points inside the outline.
    moments: DMat2,
    /// Angle of the smallest enclosing rectangle of the outline, in radians, from 0 to below π/2.
    angle: f64,
    /// Number of photo pixels that show the lamp.
    weight: f64,
    /// Length of a photo pixel at the lamp, along x and along y.
    blur: DVec2,
    /// Near the lamp, converts a step in photo pixels to a step in unwarped pixels.
    inverse_map: DMat2,
    /// Whether the photo shows the lamp completely, away from the border.
    is_clear: bool,
}

impl Member {
    fn new(lamp: &MeasuredLamp, exemplar: &Exemplar, outlines: &[Luminaire]) -> Option<Self> {
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

    /// Whether blur may have elongated the lamp: the lamp is elongated in the unwarped photo, a photo pixel is too, and
    /// both have about the same direction.
    fn is_smeared(&self) -> bool {
        let [[short, x], [long, y]] = principal(self.moments);
        let [[minor, u], [major, v]] = principal(self.inverse_map * self.inverse_map.transpose());
        let along = DVec2::new(x, y).dot(DVec2::new(u, v)).abs();
        long > MIN_SMEAR * short && major > MIN_SMEAR * minor && along > MIN_COS_ALONG
    }

    /// Standard deviations of the points inside the outline, along and across an axis.
    fn deviations(&self, axis: DVec2) -> DVec2 {
        let along = |a: DVec2| a.dot(self.moments * a).max(0.0).sqrt();
        DVec2::new(along(axis), along(axis.perp()))
    }

    /// The lamp's sides along and across an axis, if it has the given shape. The sides of an ellipse follow from its
    /// standard deviations. The sides of a rectangle are measured away from its blurred corners ([`MIDDLE_SHARE`]).
    fn sides(&self, axis: DVec2, shape: Shape) -> DVec2 {
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

    /// Length of a photo pixel near the lamp in unwarped pixels, along and across an axis.
    fn blur_along(&self, axis: DVec2) -> DVec2 {
        let along = |a: DVec2| (a.abs() * self.blur).length();
        DVec2::new(along(axis), along(axis.perp()))
    }
}

/// Fits a rectangle or an ellipse to the lamps of a kind. Returns the design, and the component and the fit of each
/// lamp; `None` if neither shape agrees. `kind` is the index that the design will get.
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
    let is_round = aspect <= MAX_ELLIPSE && ellipse.1 > rectangle.1 + MIN_ELLIPSE_GAIN;
    let (mut design, agreement) = if is_round { ellipse } else { rectangle };
    if agreement < MIN_AGREEMENT {
        return None;
    }
    if let Some(diameter) = disc(&judges, is_round) {
        design = Design { shape: Shape::Ellipse, size: DVec2::splat(diameter), axis: DVec2::X };
    }
    let Design { axis, shape, .. } = design;
    let fitted = |m: &Member| {
        let (size, photo_pixel) = (m.sides(axis, shape), m.blur_along(axis));
        (m.component, Fitted { kind, centre: m.centre, size, photo_pixel })
    };
    Some((design, members.iter().map(fitted).collect()))
}

/// Decides whether lamps are discs. Returns their diameter without bloom, in unwarped pixels; `None` if they are not
/// discs. `are_round` states that an ellipse fits the lamps better than a rectangle.
///
/// In the unwarped photo, bloom elongates a disc along the direction in which unwarping magnifies more. At least
/// [`MIN_BLOOM_LAMPS`] round lamps are discs if bloom explains their long and short sides ([`BloomFit::shown`]).
/// Otherwise, lamps are discs if at least half of them, by weight, are elongated along their blur, and if one of these
/// conditions holds as well:
///
/// - They are round. Lamps are rarely oval, but a disc looks oval if it blooms, or if its cover protrudes from the
///   ceiling.
/// - They are small in the photo.
/// - They are not all elongated in one common direction.
///
/// The diameter of these lamps follows from their short sides if bloom does not explain the sides.
fn disc(members: &[&Member], are_round: bool) -> Option<f64> {
    let pixel = |m: &Member, x: f64, y: f64| (m.inverse_map.transpose() * DVec2::new(x, y)).length();
    let sides = |m: &&Member| {
        let [[short, x], [long, y]] = principal(m.moments);
        [(4.0 * short, pixel(m, -y, x)), (4.0 * long, pixel(m, x, y))]
    };
    let are_enough = members.len() >= MIN_BLOOM_LAMPS;
    let shown = are_enough.then(|| BloomFit::new(members.iter().flat_map(sides)).shown()).flatten();
    if are_round && shown.is_some() {
        return shown;
    }
    let total: f64 = members.iter().map(|m| m.weight).sum();
    let mean_area = members.iter().map(|m| m.weight * m.weight).sum::<f64>() / total;
    let smeared: f64 = members.iter().filter(|m| m.is_smeared()).map(|m| m.weight).sum();
    let turn = |m: &&Member| {
        let [[_, x], [_, y]] = principal(m.moments);
        DVec2::from_angle(2.0 * y.atan2(x)) * m.weight
    };
    let common_turn = members.iter().map(turn).sum::<DVec2>().length() / total;
    let are_unlike_ovals = are_round || mean_area <= MAX_SMEARED || common_turn <= MIN_COMMON_DIRECTION;
    if smeared < 0.5 * total || !are_unlike_ovals {
        return None;
    }
    shown.or_else(|| common_side(members.iter().map(|m| sides(m)[0])))
}

/// Returns `[[short, x], [long, y]]`: the standard deviations along the short and the long principal axis, and the
/// unit vector (x, y) of the long axis.
fn principal(moments: DMat2) -> [[f64; 2]; 2] {
    let (xx, xy, yy) = (moments.x_axis.x, moments.x_axis.y, moments.y_axis.y);
    let (mean, spread) = ((xx + yy) / 2.0, ((xx - yy) / 2.0).hypot(xy));
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    let axis = DVec2::from_angle(angle);
    [[(mean - spread).max(0.0).sqrt(), axis.x], [(mean + spread).sqrt(), axis.y]]
}

/// The common axis of lamps: the mean angle of their enclosing rectangles, modulo a right angle and weighted by photo
/// pixels. Returns the x axis if the mean is at most [`MAX_ALIGNED_ANGLE`] away from the x or the y axis.
fn common_axis(members: &[&Member]) -> DVec2 {
    let sum: DVec2 = members.iter().map(|m| DVec2::from_angle(4.0 * m.angle) * m.weight).sum();
    let angle = sum.to_angle() / 4.0;
    if angle.abs() <= MAX_ALIGNED_ANGLE { DVec2::X } else { DVec2::from_angle(angle) }
}

/// The common side of lamps without bloom, in unwarped pixels. Each item of `sides` holds the measured side of a lamp
/// and the length of a photo pixel at the lamp, both in unwarped pixels.
///
/// - If at least [`MIN_BLOOM_LAMPS`] lamps show their bloom ([`BloomFit::shown`]), the bloom is estimated with the wide
///   prior [`SHOWN_BLOOM`].
/// - Otherwise it is estimated with the narrow prior [`BLOOM`]. If this estimate is not above 0, or if there is only
///   one lamp, the result is the mean measured side.
fn common_side(sides: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let fit = BloomFit::new(sides);
    let shown = if fit.count >= MIN_BLOOM_LAMPS { fit.shown() } else { None };
    shown.or_else(|| {
        let [side, bloom] = fit.solve(BLOOM).to_array();
        fit.limited(if bloom > 0.0 && fit.count > 1 { side } else { fit.mean() })
    })
}

/// A weighted least-squares fit of the line `side = s + 2 b p` to the measured sides of lamps. `p` is the length of a
/// photo pixel at a lamp in unwarped pixels. The unknowns are the side `s` without bloom, in unwarped pixels, and the
/// bloom `b` at each edge, in photo pixels.
struct BloomFit {
    /// The normal equations are `gram` (s, b) = `sums`.
    gram: DMat2,
    sums: DVec2,
    /// Weighted sum of the squared measured sides.
    square: f64,
    shortest: f64,
    count: usize,
}

impl BloomFit {
    fn new(sides: impl Iterator<Item = (f64, f64)>) -> Self {
        let mut fit = Self { gram: DMat2::ZERO, sums: DVec2::ZERO, square: 0.0, shortest: f64::INFINITY, count: 0 };
        for (side, pixel) in sides {
            let weight = (SIDE_NOISE * pixel).powi(-2);
            let row = DVec2::new(1.0, 2.0 * pixel);
            fit.gram += DMat2::from_cols(row * row.x, row * row.y) * weight;
            fit.sums += row * side * weight;
            fit.square += side * side * weight;
            (fit.shortest, fit.count) = (fit.shortest.min(side), fit.count + 1);
        }
        fit
    }

    /// Solves for (s, b), the side in unwarped pixels and the bloom in photo pixels. The prior of the bloom is normal,
    /// with mean 0 and the given standard deviation in photo pixels.
    fn solve(&self, deviation: f64) -> DVec2 {
        (self.gram + DMat2::from_diagonal(DVec2::new(0.0, deviation.powi(-2)))).inverse() * self.sums
    }

    /// The weighted mean of the measured sides.
    fn mean(&self) -> f64 {
        self.sums.x / self.gram.x_axis.x
    }

    /// The side without bloom. `None` if the bloom is below 0 or above [`MAX_BLOOM`], or if it does not explain more
    /// than the share [`MIN_EXPLAINED`] of the variation of the measured sides.
    fn shown(&self) -> Option<f64> {
        let solution = self.solve(SHOWN_BLOOM);
        // Weighted sums of squared residuals of two models: a side with bloom (`left`), and a constant side (`all`).
        let left = self.square - 2.0 * solution.dot(self.sums) + solution.dot(self.gram * solution);
        let all = self.square - self.mean() * self.sums.x;
        let is_shown = (0.0..=MAX_BLOOM).contains(&solution.y) && left < (1.0 - MIN_EXPLAINED) * all;
        is_shown.then_some(solution.x).and_then(|side| self.limited(side))
    }

    /// Returns the larger of `side` and [`MIN_SIDE`] times the shortest measured side; `None` unless this is positive
    /// and finite.
    fn limited(&self, side: f64) -> Option<f64> {
        Some(side.max(MIN_SIDE * self.shortest)).filter(|s| s.is_finite() && *s > 0.0)
    }
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
                .map(|i| at(half * DVec2::from_angle(2.0 * PI * i as f64 / ELLIPSE_CORNERS as f64)))
                .collect(),
        }
    }

    pub fn area(&self) -> f64 {
        self.size.element_product() * if self.shape == Shape::Rectangle { 1.0 } else { PI / 4.0 }
    }

    /// Sets the centre, size, orientation, area and outline of a luminaire from this design.
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
        let half = self.size / 2.0;
        match self.shape {
            // Exact if the rectangle's axis is parallel to x or y. Otherwise an approximation: the square is rotated
            // about its centre until its sides are parallel to those of the rectangle.
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

    /// Agreement of a polygon of the given area with the design around `centre`: the area of their intersection divided
    /// by the area of their union.
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

/// Area, centroid and covariance matrix of the points inside a polygon (Steger 1996); `None` if the area is 0.
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

/// Angle of the smallest rectangle around the corners, in radians, from 0 to below π/2 (Freeman and Shapira 1975).
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
    use glam::Vec2Swizzles;

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
        // Sides of 40 unwarped pixels. Bloom moves each edge by 0.8 photo pixels. A photo pixel is 1 to 6 unwarped
        // pixels long.
        let pixels = [1.0f64, 1.5, 2.5, 4.0, 6.0];
        let side = common_side(pixels.into_iter().map(|p| (40.0 + 1.6 * p, p))).unwrap();
        assert!((side - 40.0).abs() < 1.0, "{side}");
        // A single lamp keeps its measured side.
        assert!((common_side([(41.6, 1.0)].into_iter()).unwrap() - 41.6).abs() < 1e-9);
    }

    const DIAMETER: f64 = 20.0;
    const DISC_BLOOM: f64 = 4.0;

    /// A disc of [`DIAMETER`] that unwarping magnifies by `pixel` along y. Bloom of [`DISC_BLOOM`] photo pixels at each
    /// edge makes it an ellipse.
    fn bloomed_disc(component: usize, pixel: f64) -> Member {
        let size = DVec2::new(DIAMETER + 2.0 * DISC_BLOOM, DIAMETER + 2.0 * DISC_BLOOM * pixel);
        let outline = Design { shape: Shape::Ellipse, size, axis: DVec2::X }.outline(DVec2::new(100.0, 0.0));
        let (area, centre, moments) = polygon_moments(&outline).unwrap();
        Member {
            component,
            angle: rectangle_angle(&outline),
            outline,
            area,
            centre,
            moments,
            weight: 1000.0,
            blur: DVec2::new(1.0, pixel),
            inverse_map: DMat2::from_diagonal(DVec2::new(1.0, pixel)),
            is_clear: true,
        }
    }

    /// A lamp of the same outline in a photo that unwarping magnifies along x instead of y.
    fn with_blur_across(lamp: Member) -> Member {
        Member { blur: lamp.blur.yx(), inverse_map: DMat2::from_diagonal(lamp.blur.yx()), ..lamp }
    }

    #[test]
    fn discs_that_bloom_has_elongated_are_round_again() {
        let lamps: Vec<Member> =
            [1.2, 1.5, 1.9, 2.4].into_iter().enumerate().map(|(k, p)| bloomed_disc(k, p)).collect();
        let (design, _) = fit(&lamps, 0).unwrap();
        assert_eq!(design.shape, Shape::Ellipse);
        assert!((design.size - DIAMETER).abs().max_element() < 0.5, "{}", design.size);
        // Ellipses that are elongated across the direction of their blur are not discs.
        let turned: Vec<Member> = lamps.into_iter().map(with_blur_across).collect();
        let (design, _) = fit(&turned, 0).unwrap();
        assert!(design.size.y > 1.15 * design.size.x, "{}", design.size);
    }

    #[test]
    fn a_few_ovals_that_are_long_along_their_blur_are_discs() {
        // Two lamps are too few to show their bloom, so the diameter of the discs is the short side of the ovals.
        let lamps = || [2.5, 2.6].into_iter().enumerate().map(|(k, pixel)| bloomed_disc(k, pixel));
        let (design, _) = fit(&lamps().collect::<Vec<_>>(), 0).unwrap();
        assert_eq!((design.shape, design.size.x), (Shape::Ellipse, design.size.y));
        assert!((design.size.x / (DIAMETER + 2.0 * DISC_BLOOM) - 1.0).abs() < 0.1, "{}", design.size);
        let (design, _) = fit(&lamps().map(with_blur_across).collect::<Vec<_>>(), 0).unwrap();
        assert!(design.size.y > 1.3 * design.size.x, "{}", design.size);
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
