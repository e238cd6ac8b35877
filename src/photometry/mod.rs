//! Photometry for lighting design: colour temperature, glare, requirements of standards, and luminaire files.
//!
//! [`temperature`] converts between colours and correlated colour temperatures, and finds the blackbody light closest
//! to a target. [`glare`] rates the discomfort glare of a luminance image (UGR, CIE 117). [`luminaire`] holds a
//! measured luminous intensity distribution, read from and written to files of IES LM-63 ([`ies`]), EULUMDAT
//! ([`ldt`]), TM-33 ([`tm33`]) and GLDF ([`gldf`]). [`opening`] is the shape of a luminaire's luminous area, and
//! [`faces`] its triangles. [`presets`] lists requirements of EN 12464-1 for common rooms. [`false_colour`] shows
//! luminance and illuminance by a scale of colours.
//!
//! Three computations are elsewhere: `render::illuminance` computes illuminance, `render::glare` rates the glare that
//! the luminaires and emissive meshes of a scene cause for observers, and `render::gonio` measures the distribution of
//! emissive meshes.
//!
//! Not modelled: spectra and colour rendering; maintenance; bodies in luminaire files, and luminance that varies over a
//! luminous face.

#[cfg(feature = "xml-luminaires")]
mod clock;
pub mod faces;
pub mod false_colour;
mod format;
pub mod glare;
#[cfg(feature = "xml-luminaires")]
pub mod gldf;
mod glyphs;
pub mod ies;
pub mod ldt;
pub mod luminaire;
pub mod opening;
pub mod presets;
#[cfg(feature = "xml-luminaires")]
mod sum;
mod symmetry;
pub mod temperature;
pub mod text_lines;
#[cfg(feature = "xml-luminaires")]
pub mod tm33;
mod type_b;
#[cfg(feature = "xml-luminaires")]
mod xml;

pub use format::{Format, split_variant};
pub use luminaire::{File, Luminaire};

use crate::image::colour;
use glam::Vec3;
use std::f64::consts::PI;

/// Luminous flux `π L A` in lumens of a Lambertian emitter. `L` is the luminance of `radiance` (cd/m² per channel,
/// uniform), and `A` is `area` in m².
pub fn flux(radiance: Vec3, area: f64) -> f64 {
    PI * f64::from(colour::luminance(radiance)) * area
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flux_and_power_of_a_panel() {
        // A panel of 0.36 m² with 3000 cd/m² emits 3393 lm.
        let flux = flux(Vec3::splat(3000.0), 0.36);
        assert!((flux - 3392.92).abs() < 0.05, "{flux}");
    }
}
