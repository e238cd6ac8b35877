//! One lamp of a texture, as listed for lighting software.

use glam::{DVec2, Vec3};

/// One lamp of a texture, measured in texels.
#[derive(Clone, Debug, PartialEq)]
pub struct Luminaire {
    /// Centre in texels.
    pub centre: DVec2,
    /// Lengths along and across the axis at `orientation`, in texels, the long one first.
    pub size: DVec2,
    /// Angle, from x towards y, of the axis along which the points of the lamp have the largest variance. In radians,
    /// in (-π/2, π/2].
    pub orientation: f64,
    /// Area in texels, without the hole of a ring. A texel at the lamp's edge counts only with the share that light
    /// covers.
    pub area: f64,
    /// Mean linear RGB of the lamp's texels.
    pub colour: Vec3,
    /// Share of the luminous flux of all lamps in the texture, in `[0, 1]`.
    pub flux_share: f64,
    /// Corners of the outer outline in texels, in the order from x towards y. A texel centred on a point of the outline
    /// would be half covered by light.
    ///
    /// Accuracy: let u be the side of a texel or of an unwarped pixel, whichever is larger. The sides of the outline
    /// are exact to 0.25 u, and corners with an inner angle of at least 90 degrees to 0.71 u. This holds if the lamp is
    /// wider than two texels and the light mask has values between 0 and 1 at its edge. Otherwise the outline follows
    /// the sides of texels.
    pub outline: Vec<DVec2>,
    /// Number of the lamp's kind ([`super::kinds`]). Kind 1 has the most lamps, kind 2 the second most, and so on. A
    /// lamp that the texture's border cuts has 0.
    pub kind: u32,
}

impl Luminaire {
    /// Returns the lamp after it is moved by `shift` texels and then scaled by `factor` about the origin.
    pub fn moved(&self, shift: DVec2, factor: f64) -> Self {
        Self {
            centre: (self.centre + shift) * factor,
            size: self.size * factor,
            area: self.area * factor * factor,
            outline: self.outline.iter().map(|p| (*p + shift) * factor).collect(),
            ..self.clone()
        }
    }

    /// Whether the outline lies strictly inside a texture of the given size, so that the border does not cut the lamp.
    pub fn is_within(&self, size: DVec2) -> bool {
        self.outline.iter().all(|p| p.cmpgt(DVec2::ZERO).all() && p.cmplt(size).all())
    }
}
