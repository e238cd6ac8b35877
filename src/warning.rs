//! Warnings: reasons to doubt a result, with remedies.
//!
//! A warning arises when a number that describes a result (the severity) crosses a limit. A stage computes its warnings
//! from its result alone, and a scene computes its warnings from its contents. The limits are in the file `warnings.rs`
//! of the stage's or the scene's folder. Warnings are computed anew at each request and not stored.

use glam::DVec2;
use std::fmt;

/// The kind of a warning. The kinds have the values of `luxfer_warning_code`, so new kinds may only be appended.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Code {
    /// View: the vanishing points do not determine the focal length, which was assumed.
    FocalAssumed = 1,
    /// View: the estimated error of the room axes' directions is large.
    ViewUncertain = 2,
    /// View: the lens bends straight lines.
    LensDistortion = 3,
    /// View: the walls do not meet at right angles, or the pixels are not square.
    NotSquare = 4,
    /// Features: the shape of the room, found from lines in the photo, is uncertain, and there is no depth map.
    LayoutUncertain = 5,
    /// Mask: much of the mask resembles no stroke. For lamps: some regions outside the mask are almost like the painted
    /// lamps.
    Unseen = 6,
    /// Mask: strokes of both classes cover the same pixels.
    ContradictoryStrokes = 7,
    /// Mask: strokes lie outside the photo.
    OffImageStrokes = 8,
    /// Mask: the estimated error of the mask is large.
    UncertainMask = 9,
    /// Mask: it contains no pixel.
    EmptyMask = 10,
    /// Mask: it contradicts the strokes from which it was computed.
    MissedStrokes = 11,
    /// Mask of the lights: it covers a large share of the plane.
    AlmostAllLit = 12,
    /// Unwarping: much of the plane is magnified beyond the resolution of the photo.
    Magnified = 13,
    /// Unwarping: the camera sees the plane nearly edge-on.
    PlaneNearHorizon = 14,
    /// Emission: texture and photo differ in the statistics of their lamps.
    PatternUncertain = 15,
    /// Emission: the photo shows too few whole lamps to determine a pattern.
    FewLamps = 16,
    /// Emission: the lamps form no lattice, so the texture is continued patch by patch; and the texture differs much
    /// from the photo.
    NoLattice = 17,
    /// Relighting: a colour channel does not meet its target.
    Unreachable = 18,
    /// Relighting: the photo clips the target colour, which is therefore only a lower bound.
    TargetClipped = 19,
    /// Scene: it is so high, so wide or so small that its unit is probably not the metre.
    ImplausibleSize = 20,
    /// Scene: its file has a feature that is not rendered.
    NotRendered = 21,
    /// Mask of the lights: pixels painted as light are hardly brighter than pixels painted as plane.
    DimLamps = 22,
    /// Emission: the texture differs more from the photo than a texture without any light would.
    NoPattern = 23,
    /// Mask: it is only a proposal, because strokes that the segmentation needs were missing.
    Proposed = 24,
    /// Scene: it lies far from the origin of its coordinates.
    FarFromOrigin = 25,
    /// Scene: some of its luminaires are points. They light the scene, but pictures do not show the luminaires
    /// themselves.
    NotInPicture = 26,
    /// Guides: some objects of this frame do not exist in the previous frame of the sequence, so their motion is
    /// unknown.
    NoCounterpart = 27,
    /// Stylisation: the given motion contradicts the guides, because it leads pixels to another surface of the previous
    /// frame.
    MotionDisagrees = 28,
    /// Stylisation: the target shows illumination that does not occur in the exemplar, or not in the painted part of
    /// it.
    LightNotPainted = 29,
    /// Stylisation: in places of equal illumination, the exemplar is painted in two different ways.
    AmbiguousPaint = 30,
    /// Stylisation: a small area of the artwork, such as a stain, differs from all other areas of similar illumination.
    Blemish = 31,
    /// Unwarping: the sizes of the lamps in the photo contradict the perspective of the plane. The lamps do not lie on
    /// the plane, or the mask or the camera is wrong.
    OffPlane = 32,
}

impl Code {
    pub const ALL: [Self; 32] = [
        Self::FocalAssumed,
        Self::ViewUncertain,
        Self::LensDistortion,
        Self::NotSquare,
        Self::LayoutUncertain,
        Self::Unseen,
        Self::ContradictoryStrokes,
        Self::OffImageStrokes,
        Self::UncertainMask,
        Self::EmptyMask,
        Self::MissedStrokes,
        Self::AlmostAllLit,
        Self::Magnified,
        Self::PlaneNearHorizon,
        Self::PatternUncertain,
        Self::FewLamps,
        Self::NoLattice,
        Self::Unreachable,
        Self::TargetClipped,
        Self::ImplausibleSize,
        Self::NotRendered,
        Self::DimLamps,
        Self::NoPattern,
        Self::Proposed,
        Self::FarFromOrigin,
        Self::NotInPicture,
        Self::NoCounterpart,
        Self::MotionDisagrees,
        Self::LightNotPainted,
        Self::AmbiguousPaint,
        Self::Blemish,
        Self::OffPlane,
    ];
}

/// A reason to doubt a result, with its remedy.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    pub code: Code,
    /// The number that caused the warning.
    pub severity: f64,
    /// The limit that the severity has crossed.
    pub limit: f64,
    /// Describes the defect, with the severity.
    pub message: String,
    /// Describes the remedy.
    pub advice: String,
    /// Position of the defect, in pixels of the image that the warning is about: the photo, the frame of a sequence, or
    /// the exemplar or target of a stylisation.
    pub place: Option<DVec2>,
}

impl Warning {
    /// Returns a warning if `severity` lies above `limit` or is not a number.
    pub fn above(
        code: Code,
        severity: f64,
        limit: f64,
        message: impl FnOnce() -> String,
        advice: &str,
    ) -> Option<Self> {
        let is_good = severity <= limit;
        (!is_good).then(|| Self::new(code, severity, limit, message(), advice))
    }

    /// Returns a warning if `severity` lies below `limit` or is not a number.
    pub fn below(
        code: Code,
        severity: f64,
        limit: f64,
        message: impl FnOnce() -> String,
        advice: &str,
    ) -> Option<Self> {
        let is_good = severity >= limit;
        (!is_good).then(|| Self::new(code, severity, limit, message(), advice))
    }

    pub fn new(code: Code, severity: f64, limit: f64, message: String, advice: &str) -> Self {
        Self { code, severity, limit, message, advice: advice.into(), place: None }
    }

    /// Returns this warning with the position of its defect, in pixels. A position that is not finite is dropped.
    pub fn at(self, place: Option<DVec2>) -> Self {
        Self { place: place.filter(|p| p.is_finite()), ..self }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.message, self.advice)?;
        self.place.map_or(Ok(()), |place| write!(f, " (at {:.0}, {:.0})", place.x, place.y))
    }
}

/// Formats a share as a percentage, for messages.
pub fn percent(share: f64) -> String {
    if share.abs() < 0.0995 { format!("{:.1} %", 100.0 * share) } else { format!("{:.0} %", 100.0 * share) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_numbered_from_one_without_gaps() {
        let values: Vec<i32> = Code::ALL.iter().map(|code| *code as i32).collect();
        assert_eq!(values, (1..=Code::ALL.len() as i32).collect::<Vec<_>>());
    }

    #[test]
    fn a_figure_raises_a_warning_beyond_its_limit_and_where_it_is_no_number() {
        let above = |figure| Warning::above(Code::Unseen, figure, 0.5, String::new, "").is_some();
        let below = |figure| Warning::below(Code::Unseen, figure, 0.5, String::new, "").is_some();
        assert_eq!([0.4, 0.5, 0.6, f64::INFINITY, f64::NAN].map(above), [false, false, true, true, true]);
        assert_eq!([0.6, 0.5, 0.4, f64::NEG_INFINITY, f64::NAN].map(below), [false, false, true, true, true]);
    }

    #[test]
    fn a_warning_shows_its_place_if_it_has_one() {
        let warning = Warning::new(Code::Unseen, 1.0, 0.0, "a third of the mask is new".into(), "paint there");
        assert_eq!(warning.to_string(), "a third of the mask is new: paint there");
        let placed = warning.clone().at(Some(DVec2::new(12.2, 7.0)));
        assert_eq!(placed.to_string(), "a third of the mask is new: paint there (at 12, 7)");
        assert_eq!(warning.clone().at(Some(DVec2::NAN)), warning);
        assert_eq!([0.0123, 0.2549].map(percent), ["1.2 %", "25 %"]);
    }
}
