//! Assembles the texture: chooses the positions of lamps and patches (the composition), renders the texels, and lists
//! the lamps.

pub mod bands;
mod border_cuts;
pub mod composition;
mod cubic;
pub mod draw;
pub mod lamp_list;
pub mod layer;
mod lit_blocks;
pub mod patch_lights;
pub mod render;
pub mod resample;
pub mod source;
pub mod texel_zone;
pub mod tile;
pub mod weights;
pub mod window;
