//! Small measurements of parts that no other bench reaches, on made-up data whose truth is known. With
//! `benches/sensitivity.py`, they show how results depend on constants (docs/notes/constants.md). Each section takes
//! seconds. Arguments select sections.
//!
//! - `sheet`: photos of printed sheets, by lenses with and without distortion, beside a chequered cloth.
//! - `bent`: photos of bent and crumpled sheets, and by lenses with distortion.
//! - `surface`: the ceiling of a storey, below another storey or below the sky.
//! - `colour`: the colour of a clipped plane, and of a plane with glare around its lamps.
//! - `types`: lamps of one and of two sizes on a grid of texels.
//! - `map`: responses to textures whose stripes the cells of a map cut.
//! - `lamps`: lamps of two kinds that are blended, also with different lattices.
//! - `rims`: the colours of clipped lamps, read from their rims.
//! - `lens`: the distortion of drawings.
//! - `guides`: light with few paths against light with many, and the edges of a still life.
//! - `motion`: the points of a frame that the frame before hides.
//! - `paint`: a picture painted by the guides of light, or by all guides, against the same picture by the artist.

#[path = "constants/bent.rs"]
mod bent;
#[path = "constants/colour.rs"]
mod colour;
#[path = "constants/guides.rs"]
mod guides;
mod harness;
#[path = "constants/lamps.rs"]
mod lamps;
#[path = "../src/sheet/tests/paper.rs"]
mod paper;
#[path = "constants/sheet.rs"]
mod sheet;
#[path = "constants/surface.rs"]
mod surface;

use luxfer::exec::Pool;

fn main() {
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let sections: [(&str, fn()); 12] = [
        ("sheet", sheet::sheet),
        ("bent", bent::bent),
        ("surface", surface::surface),
        ("colour", colour::colour),
        ("types", lamps::types),
        ("map", surface::map),
        ("lamps", lamps::blended),
        ("rims", colour::rims),
        ("lens", sheet::lens),
        ("guides", guides::light_and_edges),
        ("motion", guides::motion),
        ("paint", guides::paint),
    ];
    let pool = Pool::new(2).expect("two threads");
    for (name, section) in sections {
        if chosen.is_empty() || chosen.iter().any(|c| c == name) {
            pool.run(section);
        }
    }
}
