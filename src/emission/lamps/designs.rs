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
//! The resulting outline is a geometric shape, so it is sharp at any resolution. If most lamps of a kind have a dark
//! hole in the middle, they are rings or frames: the width of the band around the hole is estimated like a side. Lamps
//! that are neither rectangles nor ellipses keep their own outline.
//!
//! Not modelled: lamps of equal shape but different orientation; holes that are not in the middle.

use super::bloom::common_side;
use super::design::{Design, Shape};
use super::discs;
use super::luminaire::Luminaire;
use super::member::{MAX_ALIGNED_ANGLE, Member};
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::measured_lamp::MeasuredLamp;
use crate::emission::exemplar::roles::Role;
use crate::maths;
use glam::DVec2;

/// An ellipse is chosen only if its length is at most `MAX_ELLIPSE` times its width; longer shapes are tubes with round
/// ends. Its agreement with the lamps ([`MIN_AGREEMENT`]) must exceed the agreement of a rectangle by
/// `MIN_ELLIPSE_GAIN`, because blur rounds the corners of rectangles. [judged on 20 photos]
const MAX_ELLIPSE: f64 = 2.5;
const MIN_ELLIPSE_GAIN: f64 = 0.03;
/// A kind of lamps gets a design only if the mean agreement of its lamps with the shape is at least this. A lamp is
/// compared with the shape that has the lamp's own sides. Agreement is the area of their intersection divided by the
/// area of their union. [judged on 20 photos]
const MIN_AGREEMENT: f64 = 0.72;

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
        let members = |kind: &Vec<MeasuredLamp>| {
            kind.iter().filter_map(|lamp| Member::new(lamp, exemplar, outlines)).collect::<Vec<_>>()
        };
        let lamps = exemplar.measured_lamps(Role::is_whole);
        let is_like = if exemplar.is_luminous_ceiling() { MeasuredLamp::is_like_pane } else { MeasuredLamp::is_like };
        let mut kinds: Vec<Vec<Member>> = MeasuredLamp::kinds(&lamps, is_like).iter().map(members).collect();
        let protruding = if exemplar.is_luminous_ceiling() { Vec::new() } else { discs::take_protruding(&mut kinds) };
        protruding.iter().for_each(|kind| designs.add(kind, discs::diameter(&judges(kind)).map(disc)));
        kinds.iter().for_each(|kind| designs.add(kind, fit(kind)));
        designs
    }

    /// Adds a kind of lamps, if it has a design.
    fn add(&mut self, lamps: &[Member], design: Option<Design>) {
        let Some(design) = design else { return };
        for m in lamps {
            let (size, photo_pixel) = (m.sides(design.axis, design.shape), m.blur_along(design.axis));
            let fitted = Fitted { kind: self.kinds.len(), centre: m.centre, size, photo_pixel };
            self.lamps[m.component] = Some(fitted);
        }
        self.kinds.push(design);
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

/// The disc with the given diameter.
fn disc(diameter: f64) -> Design {
    Design { shape: Shape::Ellipse, size: DVec2::splat(diameter), axis: DVec2::X, hole: DVec2::ZERO }
}

/// The lamps by which the design of their kind is judged: the lamps that the photo shows completely, or else all lamps.
fn judges(members: &[Member]) -> Vec<&Member> {
    let clear: Vec<&Member> = members.iter().filter(|m| m.is_clear).collect();
    if clear.is_empty() { members.iter().collect() } else { clear }
}

/// Fits a rectangle or an ellipse to the lamps of a kind; `None` if neither agrees with them. The design is a disc if
/// the lamps are discs that only look long ([`discs::disc`]).
pub fn fit(members: &[Member]) -> Option<Design> {
    let judges = judges(members);
    let total: f64 = judges.iter().map(|m| m.weight).sum();
    let axis = common_axis(&judges);
    let mean = |value: &dyn Fn(&Member) -> f64| judges.iter().map(|m| m.weight * value(m)).sum::<f64>() / total;
    let design = [Shape::Rectangle, Shape::Ellipse].map(|shape| {
        let sides = judges.iter().map(|m| (m.sides(axis, shape), m.blur_along(axis)));
        let side = |k: usize| common_side(sides.clone().map(|(size, blur)| (size[k], blur[k])));
        let design = Design { shape, size: DVec2::new(side(0)?, side(1)?), axis, hole: DVec2::ZERO };
        let agreement = mean(&|m| {
            let own = Design { size: m.sides(axis, shape), ..design };
            own.agreement(&m.outline, m.area, m.centre)
        });
        Some((design, agreement))
    });
    let [Some(rectangle), Some(ellipse)] = design else { return None };
    let aspect = ellipse.0.size.max_element() / ellipse.0.size.min_element();
    let is_round = aspect <= MAX_ELLIPSE && ellipse.1 > rectangle.1 + MIN_ELLIPSE_GAIN;
    let (design, agreement) = if is_round { ellipse } else { rectangle };
    if agreement < MIN_AGREEMENT {
        return None;
    }
    let design = discs::disc(&judges, is_round.then_some(aspect)).map_or(design, disc);
    Some(band(&judges, &design).map_or(design, |width| design.with_band(width)))
}

/// The width of the band around the holes of rings and frames; `None` if lamps with no more than half of the photo's
/// pixels have a hole. Blur fills the holes of small lamps.
fn band(judges: &[&Member], design: &Design) -> Option<f64> {
    let with_hole = || judges.iter().filter(|m| m.hole_share > 0.0);
    let weight = |m: &&Member| m.weight;
    if with_hole().copied().map(|m| m.weight).sum::<f64>() <= 0.5 * judges.iter().map(weight).sum::<f64>() {
        return None;
    }
    // A band of width w around a hole that has the share q of an area a b: (a - 2 w) (b - 2 w) = q a b.
    let width = |m: &Member| {
        let [a, b] = m.sides(design.axis, design.shape).to_array();
        (a + b - ((a - b) * (a - b) + 4.0 * m.hole_share * a * b).sqrt()) / 4.0
    };
    common_side(with_hole().map(|m| (width(m), m.blur_along(design.axis).element_sum() / 2.0)))
}

/// The common axis of lamps: the mean angle of their enclosing rectangles, modulo a right angle and weighted by photo
/// pixels. Returns the x axis if the mean is at most [`MAX_ALIGNED_ANGLE`] away from the x or the y axis.
fn common_axis(members: &[&Member]) -> DVec2 {
    let sum: DVec2 = members.iter().map(|m| maths::direction_at(4.0 * m.angle) * m.weight).sum();
    let angle = maths::angle_of(sum) / 4.0;
    if angle.abs() <= MAX_ALIGNED_ANGLE { DVec2::X } else { maths::direction_at(angle) }
}
