//! Emission areas: the luminous parts of the faces of a box, which TM-33 states by their sizes and by the offsets of
//! their centres from the luminaire's centre.
//!
//! Each face is read as one area, the rectangle that bounds its areas of all emitters. A face whose areas are all
//! circular is an ellipse: circular faces below or above make a vertical cylinder or a disc, a circular face towards
//! C = 0 or 90 makes a horizontal cylinder, and three circular faces make an ellipsoid.

use super::super::luminaire::Luminaire;
use super::super::opening::Opening;
use super::super::xml::{Element, Writer};
use crate::error::Result;

/// Largest length in metres. [convention]
const MAX_LENGTH: f64 = 1e4;

/// A face of TM-33: the names of its element and of the elements for its areas, and its two directions.
struct FaceElement {
    name: &'static str,
    area: &'static str,
    count: &'static str,
    sides: [&'static str; 2],
}

const fn face(name: &'static str, area: &'static str, count: &'static str, sides: [&'static str; 2]) -> FaceElement {
    FaceElement { name, area, count, sides }
}

/// The faces in the order of the file.
const FACES: [FaceElement; 6] = [
    face("TopFace", "TopArea", "NumberTop", ["Length", "Width"]),
    face("BottomFace", "BottomArea", "NumberBottom", ["Length", "Width"]),
    face("C0Face", "C0Area", "NumberC0", ["Length", "Height"]),
    face("C90Face", "C90Area", "NumberC90", ["Width", "Height"]),
    face("C180Face", "C180Area", "NumberC180", ["Length", "Height"]),
    face("C270Face", "C270Area", "NumberC270", ["Width", "Height"]),
];
const TOP: usize = 0;
const BOTTOM: usize = 1;
const C0: usize = 2;
const C90: usize = 3;

/// The rectangle or ellipse on a face: its sizes along the two directions of the face.
#[derive(Clone, Copy)]
struct Area {
    sizes: [f64; 2],
    is_round: bool,
}

/// Reads the emission areas of emitters into the size of the luminaire's opening.
pub fn read(emitters: &[Element], luminaire: &mut Luminaire) -> Result<()> {
    let mut found = [None; 6];
    for (slot, face) in found.iter_mut().zip(&FACES) {
        *slot = bounds(emitters, face)?;
    }
    if found.iter().all(Option::is_none) {
        return Ok(());
    }
    let largest = |values: [Option<f64>; 4]| values.into_iter().flatten().fold(0.0, f64::max);
    let size_of = |i: usize, side: usize| found[i].map(|area| area.sizes[side]);
    let width = largest([size_of(TOP, 1), size_of(BOTTOM, 1), size_of(C90, 0), size_of(C90 + 2, 0)]);
    let length = largest([size_of(TOP, 0), size_of(BOTTOM, 0), size_of(C0, 0), size_of(C0 + 2, 0)]);
    let heights: [f64; 4] = std::array::from_fn(|i| size_of(C0 + i, 1).unwrap_or(0.0));
    let height = heights.into_iter().fold(0.0, f64::max);
    let is_round = |faces: [usize; 2]| faces.iter().any(|&i| found[i].is_some_and(|area| area.is_round));
    let round = [is_round([TOP, BOTTOM]), is_round([C0, C0 + 2]), is_round([C90, C90 + 2])];
    let signs = match round {
        [true, true, _] | [true, _, true] => [-1.0, -1.0, -1.0],
        [true, false, false] => [-1.0, -1.0, 1.0],
        [false, true, _] => [1.0, -1.0, -1.0],
        [false, false, true] => [-1.0, 1.0, -1.0],
        [false, false, false] => [1.0; 3],
    };
    luminaire.size = [width * signs[0], length * signs[1], height * signs[2]];
    // A side that has no width has no height of its own.
    let differs = |i: usize| heights[i] != height && [length, width][i % 2] > 0.0;
    luminaire.side_heights = (round == [false; 3] && (0..4).any(differs)).then_some(heights);
    Ok(())
}

/// Returns the bounds of the areas on a face; `None` if it has none.
fn bounds(emitters: &[Element], face: &FaceElement) -> Result<Option<Area>> {
    let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    let mut is_round = true;
    let faces = emitters.iter().filter_map(|emitter| emitter.find("EmissionAreas")?.find(face.name));
    for area in faces.flat_map(|element| element.all(face.area)) {
        for (side, [low, high]) in face.sides.iter().zip(&mut range) {
            let size = area.number_at(side, 0.0, MAX_LENGTH)?.unwrap_or(0.0);
            let offset = area.number_at(&format!("{side}Offset"), -MAX_LENGTH, MAX_LENGTH)?.unwrap_or(0.0);
            *low = low.min(offset - size / 2.0);
            *high = high.max(offset + size / 2.0);
        }
        is_round &= matches!(area.text_at("Circular").to_ascii_lowercase().as_str(), "true" | "1");
    }
    let sizes = range.map(|[low, high]| high - low);
    Ok(sizes.iter().all(|size| size.is_finite()).then_some(Area { sizes, is_round }))
}

/// Writes the opening of a luminaire; nothing if it is a point.
pub fn write(luminaire: &Luminaire, out: &mut Writer) {
    let Some(opening) = luminaire.opening() else { return };
    let [width, length, height] = luminaire.bounds();
    // Which faces are round: those below and above, towards C = 0, and towards C = 90.
    let (round, heights) = match opening {
        Opening::Box { heights, .. } => ([false; 3], heights),
        Opening::Cylinder { axis, .. } => ([axis == 2, axis == 0, axis == 1], [height; 4]),
        Opening::Ellipsoid(_) => ([true; 3], [height; 4]),
    };
    let is_up = luminaire.max_gamma() > 90.0;
    let is_down = luminaire.min_gamma() < 90.0 || !is_up;
    out.begin("EmissionAreas", "");
    for (i, face) in FACES.iter().enumerate() {
        let (sizes, is_round) = match i {
            TOP => ([length, width], round[0]),
            BOTTOM => ([length, width], round[0]),
            _ if i % 2 == C0 % 2 => ([length, heights[i - C0]], round[1]),
            _ => ([width, heights[i - C0]], round[2]),
        };
        // A box has a luminous face below, whatever its distribution: its sides are measured from there.
        let is_lit = match i {
            TOP => is_up,
            BOTTOM => is_down || height > 0.0,
            _ => true,
        };
        if !is_lit || sizes.iter().any(|size| *size <= 0.0) {
            continue;
        }
        out.begin(face.name, "");
        out.leaf(face.count, "", 1);
        out.begin(face.area, "");
        face.sides.iter().zip(sizes).for_each(|(side, size)| out.leaf(side, "", size));
        // The strips on the sides begin at the face below; heights count upwards from the centre.
        let raised = if i < C0 { 0.0 } else { (sizes[1] - height) / 2.0 };
        out.leaf(&format!("{}Offset", face.sides[0]), "", 0);
        out.leaf(&format!("{}Offset", face.sides[1]), "", raised);
        if is_round {
            out.leaf("Circular", "", true);
        }
        out.end();
        out.end();
    }
    out.end();
}
