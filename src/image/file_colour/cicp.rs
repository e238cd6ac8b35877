//! Colour spaces given by code points (Recommendation ITU-T H.273), as in the `cICP` chunk of a PNG.

use super::chromaticities::{Chromaticities, is_identity};
use super::conversion::Conversion;
use super::curve::{Curve, bt709, hlg, pq};
use super::space::Space;
use crate::error::Result;
use crate::image::colour::srgb_to_linear;
use crate::maths;

pub const PQ: u8 = 16;
pub const HLG: u8 = 18;

/// Reference white of high dynamic range, which becomes the linear value 1. For PQ it is a luminance in cd/m², for HLG
/// a code value in `[0, 1]`. [convention: Recommendation ITU-R BT.2408-7, table 1]
const PQ_WHITE: f64 = 203.0;
const HLG_WHITE: f64 = 0.75;

/// Returns the colour space with the given code points of primaries and transfer function; `None` if a code point is
/// unknown. `full` maps a stored code to `[0, 1]`: it keeps codes of full range, and stretches codes of video range.
pub fn space(primaries: u8, transfer: u8, full: impl Fn(f64) -> f64) -> Result<Option<Space>> {
    let function: fn(f64) -> f64 = match transfer {
        1 | 6 | 14 | 15 => bt709,
        4 => |code| maths::powf(code.max(0.0), 2.2),
        5 => |code| maths::powf(code.max(0.0), 2.8),
        8 => |code| code,
        13 => |code| f64::from(srgb_to_linear(code as f32)),
        PQ => |code| pq(code) / PQ_WHITE,
        HLG => |code| hlg(code) / hlg(HLG_WHITE),
        _ => return Ok(None),
    };
    let Some(matrix) = Chromaticities::of_code(primaries).and_then(Chromaticities::to_rec709) else { return Ok(None) };
    if transfer == 13 && is_identity(matrix) && full(0.0) == 0.0 {
        return Ok(Some(Space::Native));
    }
    let curve = Curve::new(|code| function(full(code)))?;
    Ok(Some(Space::Other(Conversion::new([curve.clone(), curve.clone(), curve], matrix))))
}
