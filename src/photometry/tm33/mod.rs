//! Reads and writes ANSI/IES TM-33 files, an XML format for luminaires: TM-33-18 (root `IESTM33`; UNI 11733 and ATLA
//! S001 have the same elements) and TM-33-23 (root `IESTM33-22`).
//!
//! The reader uses the header, the emission areas ([`areas`]), and of each emitter the luminous intensities in C
//! planes, symmetry, rated flux, power, colour temperature and colour rendering. Several emitters are added up. Files
//! with the root `LuminaireOpticalData`, which some tools write, are read as well. Their elements `IntensityData` lie
//! directly in `IntensityDistribution` or `LuminousData`, have the attributes `horz` and `vert`, and are in candela per
//! 1000 lumens.
//!
//! Lengths are in metres. The length lies along C = 90 and the width along C = 0. (This follows from the emission
//! areas: TM-33 states an area on the face towards C = 0 by a length and a height.)
//!
//! Not read: spectra, radiant and photon intensities, colours by angle, tilt factors, and the sizes of the housing.

mod areas;
mod intensities;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use read::{read, read_file};
pub use write::write;
