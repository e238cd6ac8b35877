//! Transfer functions, which convert the code values of a file to linear light.

use crate::error::Result;
use crate::image::colour::{linear_to_srgb, srgb_to_linear};
use crate::image::try_collect;
use crate::maths;
use std::sync::Arc;

/// Number of nodes of a sampled curve: one for each 16-bit code value. The 8-bit codes fall on every 257th node.
const NODES: usize = 65_536;

/// A curve counts as sRGB if it differs from the sRGB curve by less than this, in encoded values. Profiles store the
/// curve in tables of 1024 values of 16 bits, with errors of 1e-4 near black. [rounding]
const SAME: f32 = 4e-4;

/// A transfer curve sampled on `[0, 1]`. Above 1 the curve continues linearly. The value of a negative code -v is
/// minus the value of v.
#[derive(Clone)]
pub struct Curve(Arc<Vec<f32>>);

impl Curve {
    /// Samples `function` on `[0, 1]`.
    pub fn new(function: impl Fn(f64) -> f64) -> Result<Self> {
        let nodes = (0..NODES).map(|code| function(code as f64 / (NODES - 1) as f64) as f32);
        Ok(Self(Arc::new(try_collect(nodes)?)))
    }

    pub fn srgb() -> Result<Self> {
        Self::new(|v| f64::from(srgb_to_linear(v as f32)))
    }

    /// Returns the linear value of a code value.
    #[inline]
    pub fn at(&self, code: f32) -> f32 {
        let position = code.abs() * (NODES - 1) as f32;
        let left = (position as usize).min(NODES - 2);
        let (a, b) = (self.0[left], self.0[left + 1]);
        (a + (b - a) * (position - left as f32)).copysign(code)
    }
}

/// Whether a function equals the sRGB curve at all 8-bit codes, within the precision of files.
pub fn is_srgb(function: impl Fn(f64) -> f64) -> bool {
    (0..=255).all(|code| {
        let code = code as f32 / 255.0;
        (linear_to_srgb(function(code.into()) as f32) - code).abs() < SAME
    })
}

/// The perceptual quantiser: luminance of the display in cd/m² for a code value in `[0, 1]` (Recommendation ITU-R
/// BT.2100-2, table 4).
pub fn pq(code: f64) -> f64 {
    let (m1, m2) = (2610.0 / 16_384.0, 2523.0 / 4096.0 * 128.0);
    let (c1, c2, c3) = (3424.0 / 4096.0, 2413.0 / 4096.0 * 32.0, 2392.0 / 4096.0 * 32.0);
    let root = maths::powf(code.max(0.0), 1.0 / m2);
    10_000.0 * maths::powf((root - c1).max(0.0) / (c2 - c3 * root), 1.0 / m1)
}

/// Hybrid log-gamma: relative scene light, with a peak of 1, for a code value in `[0, 1]` (Recommendation ITU-R
/// BT.2100-2, table 5).
pub fn hlg(code: f64) -> f64 {
    let (a, b, c) = (0.178_832_77, 0.284_668_92, 0.559_910_73);
    if code <= 0.5 { code * code / 3.0 } else { (maths::exp((code - c) / a) + b) / 12.0 }
}

/// The inverse of the camera curve of Rec.709: relative scene light for a code value in `[0, 1]` (Recommendation ITU-R
/// BT.709-6, 1.2).
pub fn bt709(code: f64) -> f64 {
    let (alpha, beta) = (1.099_296_826_809_44, 0.018_053_968_510_807);
    if code < 4.5 * beta { code / 4.5 } else { maths::powf((code + alpha - 1.0) / alpha, 1.0 / 0.45) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_meet_their_standards() {
        // Reference white (203 cd/m²) is the code value 0.58 in PQ and 0.75 in HLG (Recommendation ITU-R BT.2408-7,
        // table 1).
        assert!((pq(0.580_69) - 203.0).abs() < 0.05 && (pq(1.0) - 10_000.0).abs() < 1e-6 && pq(0.0) == 0.0);
        assert!((hlg(0.75) - 0.264_96).abs() < 1e-5 && (hlg(1.0) - 1.0).abs() < 1e-6);
        assert!((hlg(0.5) - 1.0 / 12.0).abs() < 1e-6 && (hlg(0.500_001) - 1.0 / 12.0).abs() < 1e-5);
        assert!((bt709(1.0) - 1.0).abs() < 1e-9 && (bt709(0.081) - 0.018).abs() < 1e-6);
    }

    #[test]
    fn every_code_of_8_and_16_bits_is_exact() {
        let curve = Curve::srgb().unwrap();
        for (code, max) in (0..256).map(|c| (c, 255)).chain((0..65_536).map(|c| (c, 65_535))) {
            let code = code as f32 / max as f32;
            assert!((curve.at(code) - srgb_to_linear(code)).abs() < 1e-6, "{code}");
        }
        let straight = Curve::new(|v| 2.0 * v).unwrap();
        assert!((straight.at(3.0) - 6.0).abs() < 1e-3 && (straight.at(-0.25) + 0.5).abs() < 1e-6);
        assert!(straight.at(f32::NAN).is_nan() && straight.at(f32::INFINITY) == f32::INFINITY);
    }

    #[test]
    fn only_srgb_is_srgb() {
        assert!(is_srgb(|v| f64::from(srgb_to_linear(v as f32))));
        assert!(!is_srgb(|v| v.powf(2.2)) && !is_srgb(bt709));
    }
}
