//! Lamps of a texture: chooses and places them as whole pieces, and measures their outlines, kinds and colours.

pub mod bloom;
pub mod coverage;
pub mod crumbs;
pub mod cut;
pub mod design;
pub mod designs;
pub mod discs;
pub mod instance;
pub mod instances;
pub mod kinds;
pub mod lattice_fill;
pub mod lines;
pub mod luminaire;
pub mod luminaires;
pub mod member;
pub mod outline;
pub mod rim_colour;
pub mod sharpest;
pub mod spacing;
pub mod stretched;
