//! The form that the CIE general skies and the Perez sky share: a gradation from the zenith to the horizon times an
//! indicatrix, which depends on the angle from the sun.

use crate::maths;

/// Smallest cosine of the zenith angle for which the gradation is computed: 89.4° from the zenith. Where the gradation
/// has b < 0, exp(b / cosine) is constant to 1 % of its own small value below it. It avoids a division by 0, as in
/// Radiance's perezlum.cal. [convention]
const MIN_COSINE: f64 = 0.01;

/// Relative luminance (1 + a exp(b / cos ζ)) (1 + c (exp(d χ) - exp(d π / 2)) + e cos² χ), in which ζ is the angle from
/// the zenith and χ the angle from the sun in radians. In the formula of Perez et al., the second exponential is
/// missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LuminanceShape {
    pub a: f64,
    pub b: f64,
    pub c: f64,
    pub d: f64,
    pub e: f64,
    /// The value of exp(d π / 2), or 0.
    pub offset: f64,
}

impl LuminanceShape {
    /// Returns the relative luminance, at least 0, for the cosines of ζ and χ.
    pub fn luminance(&self, cos_zenith: f64, cos_sun: f64) -> f64 {
        self.gradation(cos_zenith) * self.indicatrix(cos_sun)
    }

    /// Returns the factor that depends on the angle from the zenith, at least 0.
    pub fn gradation(&self, cos_zenith: f64) -> f64 {
        (1.0 + self.a * maths::exp(self.b / cos_zenith.max(MIN_COSINE))).max(0.0)
    }

    /// Returns the factor that depends on the angle from the sun, at least 0.
    pub fn indicatrix(&self, cos_sun: f64) -> f64 {
        let cosine = cos_sun.clamp(-1.0, 1.0);
        let glow = if self.c == 0.0 { 0.0 } else { self.c * (maths::exp(self.d * maths::acos(cosine)) - self.offset) };
        (1.0 + glow + self.e * cosine * cosine).max(0.0)
    }
}
