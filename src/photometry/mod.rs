//! Photometry for lighting design: what a solved light is called, what a standard asks for, and luminaires in files.
//!
//! [`temperature`] names a colour by its correlated temperature and back, and finds the blackbody light that comes nearest
//! to a target. [`glare`] rates the discomfort glare of a luminance image (UGR, CIE 117). [`luminaire`] is a measured
//! luminous intensity distribution, read from and written to IES LM-63 ([`ies`]) and EULUMDAT ([`ldt`]). [`presets`] has
//! what EN 12464-1 asks of common rooms. [`false_colour`] shows luminance and illuminance by colours with a scale.
//!
//! Illuminance itself is calculated by `render::illuminance`. Not modelled: spectra and colour rendering, maintenance.

pub mod false_colour;
pub mod glare;
mod glyphs;
pub mod ies;
pub mod ldt;
mod lines;
pub mod luminaire;
pub mod presets;
pub mod temperature;

pub use luminaire::Luminaire;

use crate::image::colour;
use glam::Vec3;
use std::f64::consts::PI;

/// Luminous flux in lumens of a matt emitter of one luminance (cd/m² per channel) and area (m²).
pub fn flux(radiance: Vec3, area: f64) -> f64 {
    PI * f64::from(colour::luminance(radiance)) * area
}

/// Electric power per floor area in W/m² that a flux takes: lumens, lumens per watt, m².
pub fn power_density(flux: f64, efficacy: f64, floor_area: f64) -> f64 {
    flux / efficacy / floor_area
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flux_and_power_of_a_panel() {
        // 0.36 m² at 3000 cd/m²: 3393 lm; at 120 lm/W in 10 m² that is 2.83 W/m².
        let flux = flux(Vec3::splat(3000.0), 0.36);
        assert!((flux - 3392.92).abs() < 0.05, "{flux}");
        assert!((power_density(flux, 120.0, 10.0) - 2.8274).abs() < 1e-3);
    }
}
