//! Reads and writes GLDF containers (Global Lighting Data Format 1.0): ZIP archives with a description of the product,
//! `product.xml`, and files of photometry, geometry and pictures.
//!
//! A product has variants, and a variant has light emitters, each with a photometry in EULUMDAT, IES or TM-33. The
//! emitters of the chosen variant are added up. The description overrules the photometry file: an emitter's rated flux
//! scales the intensities, and the power, colour temperature and colour rendering come from its light source. A simple
//! geometry replaces the luminous opening of the photometry. If it states no luminous heights, the heights of the
//! photometry stay.
//!
//! Not read: models of the body (L3D and others), sensors, spectra, and emitters that shine only in an emergency.
//! Emitters turned about a horizontal axis are refused.

mod container;
mod emitters;
mod names;
mod product;
mod shape;
#[cfg(test)]
mod tests;
mod write;

pub use product::read;
pub use write::write;
