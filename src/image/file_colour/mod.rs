//! Converts the samples of a picture file from the colour space that the file states to linear Rec.709.
//!
//! The table lists the statements that are read, by format. In OpenEXR and Radiance HDR files, all of them count
//! together. In files of the other formats, only the first one that can be used counts.
//!
//! | file | statements |
//! |---|---|
//! | PNG | `cICP`, `iCCP`, `sRGB`, `gAMA` with `cHRM` (PNG specification, third edition, 4.3) |
//! | JPEG, WebP, TIFF | ICC profile, then the EXIF colour space (sRGB, Adobe RGB); for inks the profile alone |
//! | GIF, BMP | ICC profile; for BMP the mark for sRGB |
//! | OpenEXR | `chromaticities`, `adoptedNeutral` |
//! | Radiance HDR | `PRIMARIES`, `EXPOSURE`, `COLORCORR`, `FORMAT` (RGB or XYZ) |
//!
//! Without a statement, integers are taken as sRGB and floating-point numbers as linear Rec.709. White stays white:
//! whites other than D65 are adapted with the Bradford matrix, as in ICC profiles.
//!
//! Not modelled: rendering intents other than relative colorimetric (unless a profile lacks it), gain maps, endpoints
//! and linked profiles of BMP files, black point compensation. If a file has statements but no usable statement, it is
//! read as if it had no statements, and [`FileColour`] says so.

mod chromaticities;
mod cicp;
mod conversion;
mod curve;
pub(super) mod icc;
mod inks;
pub(super) mod png;
mod space;
#[cfg(test)]
mod tests;

pub(super) use chromaticities::Chromaticities;
pub(super) use conversion::Conversion;
pub(super) use space::Space;
pub use space::{ExifColour, FileColour};
