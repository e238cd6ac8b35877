//! Daylight: the sun's position, standard skies, and weather files.
//!
//! [`sun`] computes where the sun stands at a place and a time. [`cie`] has the relative luminance of the skies of ISO
//! 15469:2004 / CIE S 011 (15 types, and the traditional overcast sky). [`perez`] has that of the all-weather sky of
//! Perez et al. (1993) and the luminous efficacies of Perez et al. (1990), which convert irradiance to illuminance.
//! [`sky`] scales either of them to the wanted illuminance and draws it as an environment image; the sun itself becomes
//! a directional light with the size of its disc. [`epw`] reads weather files of EnergyPlus.
//!
//! Azimuths count clockwise as seen from above, from north over east. Altitudes count up from the horizon. Both are in
//! radians; latitude and longitude are in degrees, positive to the north and to the east, as weather files have them.
//!
//! Not modelled: refraction, which raises the sun by half a degree at the horizon and by less than 0.1° from 10° on;
//! the darkening of the sun's limb; the colours of the sky's parts, which have one white; clouds with outlines.

pub mod cie;
pub mod epw;
pub mod perez;
mod shape;
pub mod sky;
pub mod sun;

pub use sky::{Conditions, LightUnit, Sky, SkyModel};
pub use sun::{PlaceAndTime, SunPosition};

#[cfg(test)]
mod tests;
