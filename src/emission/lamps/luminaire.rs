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
    /// Area in texels, of those at the edge what is light.
    pub area: f64,
    /// Mean linear colour.
    pub colour: Vec3,
    /// Share of the light of the whole texture, in `[0, 1]`.
    pub flux_share: f64,
    /// Corners of the outline in texels, from x towards y: where half of a texel would be light. Where the confidence
    /// of the lights tells that between 0 and 1, and the lamp is wider than two texels, within a quarter of one or of
    /// an unwarped pixel, whichever is larger; its corners, where they are not sharper than a right angle, within 0.71
    /// of that. Else it follows the sides of texels.
    pub outline: Vec<DVec2>,
    /// Number of its kind ([`super::kinds`]), from 1, those with most lamps first; 0 of a lamp that the border cuts.
    pub kind: u32,
}

impl Luminaire {
    /// The same shown elsewhere, and larger by a factor.
    pub fn moved(&self, shift: DVec2, factor: f64) -> Self {
        Self {
            centre: (self.centre + shift) * factor,
            size: self.size * factor,
            area: self.area * factor * factor,
            outline: self.outline.iter().map(|p| (*p + shift) * factor).collect(),
            ..self.clone()
        }
    }

    /// Whether nothing of it can lie beyond the border of a texture of a size.
    pub fn is_within(&self, size: DVec2) -> bool {
        self.outline.iter().all(|p| p.cmpgt(DVec2::ZERO).all() && p.cmplt(size).all())
    }
}
