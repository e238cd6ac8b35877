//! Correlated colour temperature of a colour: the temperature of the nearest blackbody, and the distance from it.
//!
//! The blackbody locus is Krystek's rational approximation in the CIE 1960 diagram ("An algorithm to calculate
//! correlated colour temperature", 1985). Its u and v are accurate to 8e-5 from 1000 K to 15000 K. Distances are
//! measured in that diagram, as the definition of the correlated colour temperature requires (CIE 15). The search steps
//! uniformly in mired (10⁶ / kelvin), because equal steps in mired look nearly equal.

use crate::image::colour;
use glam::{DMat3, DVec2, DVec3, Vec3};

/// Range of colour temperatures in kelvin, to which arguments and results are limited. \[convention\]
pub const MIN_KELVIN: f64 = 1000.0;
pub const MAX_KELVIN: f64 = 20_000.0;

/// Number of steps of the initial scan, all of the same size in mired. Within any two neighbouring steps, the distance
/// of a colour from the locus has a single minimum.
const SCAN: usize = 96;
/// Number of golden-section steps, after which the interval has shrunk to rounding error.
const SECTIONS: usize = 60;

/// A colour given by its correlated colour temperature and its distance from the blackbody locus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Temperature {
    /// Temperature in kelvin, in `[1000, 20000]`. A value at an end of this range means that the true temperature may
    /// lie beyond it.
    pub kelvin: f64,
    /// Distance from the blackbody locus in the CIE 1960 diagram (Duv): positive above the locus (greenish), negative
    /// below (pinkish). Beyond ±0.05 the temperature has little meaning.
    pub duv: f64,
}

/// Returns the CIE 1931 chromaticity of a linear RGB colour; `None` for black and invalid colours.
pub fn chromaticity(rgb: DVec3) -> Option<DVec2> {
    let xyz = to_xyz() * rgb;
    let sum = xyz.element_sum();
    (sum > 0.0 && sum.is_finite()).then(|| DVec2::new(xyz.x, xyz.y) / sum)
}

/// Returns the correlated colour temperature of a linear RGB colour; `None` for black and invalid colours.
pub fn of_rgb(rgb: DVec3) -> Option<Temperature> {
    chromaticity(rgb).map(of_chromaticity)
}

/// Returns the correlated colour temperature of a CIE 1931 chromaticity.
pub fn of_chromaticity(xy: DVec2) -> Temperature {
    let uv = to_1960(xy);
    let mired = search(|mired| locus(1e6 / mired).distance_squared(uv));
    let kelvin = 1e6 / mired;
    let nearest = locus(kelvin);
    // A colour lies above the locus if its v is larger than the v of the nearest blackbody.
    let side = if uv.y >= nearest.y { 1.0 } else { -1.0 };
    Temperature { kelvin, duv: side * uv.distance(nearest) }
}

/// Returns the CIE 1931 chromaticity of a temperature and a distance from the locus. The temperature is clamped to
/// `[MIN_KELVIN, MAX_KELVIN]`.
pub fn chromaticity_of(temperature: Temperature) -> DVec2 {
    let kelvin = temperature.kelvin.clamp(MIN_KELVIN, MAX_KELVIN);
    // Along the locus u falls as the temperature rises. Rotate the tangent to obtain the normal that points up.
    let (a, b) = (locus(kelvin * 0.9995), locus(kelvin * 1.0005));
    let tangent = (a - b).normalize();
    let normal = if tangent.x >= 0.0 { tangent.perp() } else { -tangent.perp() };
    from_1960(locus(kelvin) + normal * temperature.duv)
}

/// Returns the linear RGB colour of luminance 1 with this temperature and distance from the locus. A negative channel
/// means that the colour is out of gamut, as blackbodies are below about 1900 K.
pub fn to_rgb(temperature: Temperature) -> DVec3 {
    let xy = chromaticity_of(temperature);
    to_xyz().inverse() * DVec3::new(xy.x / xy.y, 1.0, (1.0 - xy.x - xy.y) / xy.y)
}

/// Returns the linear RGB colour of a blackbody, clipped to the gamut and scaled to luminance 1.
pub fn blackbody(kelvin: f64) -> DVec3 {
    let rgb = to_rgb(Temperature { kelvin, duv: 0.0 }).max(DVec3::ZERO);
    rgb / f64::from(colour::luminance(rgb.as_vec3()))
}

/// The blackbody light that brings a target's radiance closest to the wanted radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    pub kelvin: f64,
    /// Factor ≥ 0 by which to multiply the colour [`blackbody`] of this temperature. If the response is per 1 cd/m² of
    /// emission, this is the luminance of the emission in cd/m².
    pub luminance: f64,
    /// Mean radiance of the target under this light and the other lights, per channel.
    pub achieved: DVec3,
    /// CIEDE2000 difference between the achieved and the wanted radiance. Both are exposed so that the wanted radiance
    /// is a middle grey.
    pub delta_e: f64,
}

/// Finds the temperature and strength of the blackbody light that brings a target's mean radiance closest to `target`,
/// by least squares over the channels. The target receives `background` from other lights, and `response` per unit of
/// emission, all per channel. For each temperature the optimal strength has a closed form. `None` if no channel
/// responds or a value is not finite.
pub fn fit(response: DVec3, background: DVec3, target: DVec3) -> Option<Fit> {
    let wanted = target - background;
    let at = |kelvin: f64| {
        let light = response * blackbody(kelvin);
        let square = light.length_squared();
        let strength = if square > 0.0 { (light.dot(wanted) / square).max(0.0) } else { 0.0 };
        (strength, (light * strength - wanted).length_squared())
    };
    if !(response.max_element() > 0.0 && response.is_finite() && wanted.is_finite()) {
        return None;
    }
    let kelvin = 1e6 / search(|mired| at(1e6 / mired).1);
    let luminance = at(kelvin).0;
    let achieved = background + response * blackbody(kelvin) * luminance;
    Some(Fit { kelvin, luminance, achieved, delta_e: colour::delta_e_from(target, achieved) })
}

/// Returns the mired value that minimises `f`: scans the range, then searches by golden sections between the neighbours
/// of the best scanned value.
fn search(f: impl Fn(f64) -> f64) -> f64 {
    let (low, high) = (1e6 / MAX_KELVIN, 1e6 / MIN_KELVIN);
    let at = |i: usize| low + (high - low) * i as f64 / SCAN as f64;
    let best = (0..=SCAN).min_by(|&a, &b| f(at(a)).total_cmp(&f(at(b)))).unwrap_or(0);
    let (mut a, mut b) = (at(best.saturating_sub(1)), at((best + 1).min(SCAN)));
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    for _ in 0..SECTIONS {
        let (left, right) = (b - golden * (b - a), a + golden * (b - a));
        if f(left) <= f(right) { b = right } else { a = left }
    }
    0.5 * (a + b)
}

/// Returns the point of the blackbody locus in the CIE 1960 diagram at a temperature in kelvin.
fn locus(t: f64) -> DVec2 {
    let u = (0.860_117_757 + 1.541_182_54e-4 * t + 1.286_412_12e-7 * t * t)
        / (1.0 + 8.424_202_35e-4 * t + 7.081_451_63e-7 * t * t);
    let v = (0.317_398_726 + 4.228_062_45e-5 * t + 4.204_816_91e-8 * t * t)
        / (1.0 - 2.897_418_16e-5 * t + 1.614_560_53e-7 * t * t);
    DVec2::new(u, v)
}

fn to_1960(xy: DVec2) -> DVec2 {
    DVec2::new(4.0 * xy.x, 6.0 * xy.y) / (12.0 * xy.y - 2.0 * xy.x + 3.0)
}

fn from_1960(uv: DVec2) -> DVec2 {
    DVec2::new(3.0 * uv.x, 2.0 * uv.y) / (2.0 * uv.x - 8.0 * uv.y + 4.0)
}

fn to_xyz() -> DMat3 {
    DMat3::from_cols(colour::linear_to_xyz(Vec3::X), colour::linear_to_xyz(Vec3::Y), colour::linear_to_xyz(Vec3::Z))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published chromaticities of standard illuminants (CIE 15, table T.3) must yield the temperatures and Duv of
    /// these illuminants.
    #[test]
    fn standard_illuminants() {
        for (xy, kelvin, duv) in [
            ([0.44758, 0.40745], 2856.0, 0.0000),
            ([0.34567, 0.35850], 5003.0, 0.0032),
            ([0.33242, 0.34743], 5503.0, 0.0032),
            ([0.31272, 0.32903], 6504.0, 0.0032),
            ([0.29902, 0.31485], 7504.0, 0.0032),
        ] {
            let t = of_chromaticity(DVec2::from(xy));
            assert!((t.kelvin / kelvin - 1.0).abs() < 0.003, "{xy:?}: {t:?}, expected {kelvin}");
            assert!((t.duv - duv).abs() < 3e-4, "{xy:?}: {t:?}, expected {duv}");
        }
        let white = of_rgb(DVec3::splat(7.0)).unwrap();
        assert!((white.kelvin - 6504.0).abs() < 15.0, "{white:?}");
        assert_eq!(of_rgb(DVec3::ZERO), None);
        assert_eq!(of_rgb(DVec3::NAN), None);
    }

    #[test]
    fn there_and_back() {
        for kelvin in [1200.0, 2000.0, 2700.0, 4000.0, 6500.0, 10_000.0, 18_000.0] {
            for duv in [-0.01, 0.0, 0.006] {
                let again = of_chromaticity(chromaticity_of(Temperature { kelvin, duv }));
                assert!((again.kelvin / kelvin - 1.0).abs() < 1e-3, "{kelvin} {duv}: {again:?}");
                assert!((again.duv - duv).abs() < 1e-5, "{kelvin} {duv}: {again:?}");
            }
        }
        // Warm light is reddish, cold light is bluish, and the luminance of both is 1.
        let (warm, cold) = (blackbody(2700.0), blackbody(10_000.0));
        assert!(warm.x > 2.0 * warm.z && cold.z > cold.x);
        assert!((colour::luminance(warm.as_vec3()) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_blackbody_is_fitted_through_light_transport() {
        let (response, background) = (DVec3::new(0.3, 0.2, 0.1), DVec3::new(5.0, 4.0, 3.0));
        let target = background + response * blackbody(3500.0) * 800.0;
        let fit = fit(response, background, target).unwrap();
        assert!((fit.kelvin / 3500.0 - 1.0).abs() < 1e-6 && (fit.luminance / 800.0 - 1.0).abs() < 1e-6, "{fit:?}");
        assert!((fit.achieved - target).abs().max_element() < 1e-3 && fit.delta_e < 1e-3, "{fit:?}");
        // No blackbody is green: the fit returns the nearest colour and its difference.
        let green = super::fit(DVec3::ONE, DVec3::ZERO, DVec3::new(0.2, 1.0, 0.2)).unwrap();
        assert!(green.delta_e > 10.0 && green.luminance > 0.0, "{green:?}");
        // If other lights are already brighter than the target, the best strength is 0.
        assert_eq!(super::fit(response, background, DVec3::ZERO).unwrap().luminance, 0.0);
        assert_eq!(super::fit(DVec3::ZERO, background, target), None);
    }
}
