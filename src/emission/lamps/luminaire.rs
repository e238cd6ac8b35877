//! One lamp of a texture.

use glam::{DVec2, Vec3};

/// One lamp of the texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Luminaire {
    /// Centre in texels.
    pub centre: DVec2,
    /// Lengths of the principal axes in texels, long one first.
    pub size: DVec2,
    /// Angle of the long axis from x towards y, in radians, in (-π/2, π/2].
    pub orientation: f64,
    /// Area in texels; of texels at the edge only the lit part counts.
    pub area: f64,
    /// Mean linear colour.
    pub colour: Vec3,
    /// Share of the luminous flux of all lamps of the texture, in `[0, 1]`.
    pub flux_share: f64,
    /// Corners of the outline in texels, from x towards y. The outline runs where half of a texel would be light. Where
    /// the confidence of the lights takes values between 0 and 1, and the lamp is wider than two texels, sides are
    /// exact to 0.25 of a texel or of an unwarped pixel, whichever is larger, and corners that are no sharper than a
    /// right angle to 0.71 of it. Otherwise the outline follows the sides of texels.
    pub outline: Vec<DVec2>,
    /// Number of the lamp's kind ([`super::kinds`]), from 1, kinds with most lamps first; 0 for a lamp that the border
    /// cuts.
    pub kind: u32,
}

impl Luminaire {
    /// The same lamp, first shifted, then scaled by a factor.
    pub fn moved(&self, shift: DVec2, factor: f64) -> Self {
        Self {
            centre: (self.centre + shift) * factor,
            size: self.size * factor,
            area: self.area * factor * factor,
            outline: self.outline.iter().map(|p| (*p + shift) * factor).collect(),
            ..self.clone()
        }
    }

    /// Whether the outline lies strictly inside a texture of the given size, so that the border cuts nothing off.
    pub fn is_within(&self, size: DVec2) -> bool {
        self.outline.iter().all(|p| p.cmpgt(DVec2::ZERO).all() && p.cmplt(size).all())
    }
}
