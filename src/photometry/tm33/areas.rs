//! Emission areas: the luminous parts of the faces of a box, which TM-33 states by their sizes and by the offsets of
//! their centres from the luminaire's centre.
//!
//! Each face is read as one area: the rectangle that bounds the emission areas of all emitters on this face. If all
//! areas of a face are circular, the face is an ellipse. A circular face below or above makes a vertical cylinder or a
//! disc. A circular face towards C = 0 or 90 makes a horizontal cylinder. Three circular faces make an ellipsoid.

use super::super::luminaire::Luminaire;
use super::super::opening::Opening;
use super::super::xml::{Element, Writer};
use crate::error::Result;

/// Largest length in metres. [convention]
const MAX_LENGTH: f64 = 1e4;

/// The names by which TM-33 states a face: of the face's element, of the element of an area, of the element that counts
/// the areas, and of the two directions of the face.
struct FaceElement {
    name: &'static str,
    area: &'static str,
    count: &'static str,
    sides: [&'static str; 2],
}

const fn face(name: &'static str, area: &'static str, count: &'static str, sides: [&'static str; 2]) -> FaceElement {
    FaceElement { name, area, count, sides }
}

/// The faces, in the order in which a file states them.
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

/// The rectangle or ellipse on a face, with its sizes in metres along the two directions of the face.
#[derive(Clone, Copy)]
struct Area {
    sizes: [f64; 2],
    is_round: bool,
}

/// Sets the size of a luminaire's opening, and the heights of its sides, from the emission areas of the emitters.
/// Without emission areas, the luminaire stays unchanged.
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
    // The height of a side without width has no meaning, so it does not count as different.
    let differs = |i: usize| heights[i] != height && [length, width][i % 2] > 0.0;
    luminaire.side_heights = (round == [false; 3] && (0..4).any(differs)).then_some(heights);
    Ok(())
}

/// Returns the rectangle that bounds all areas on a face; `None` if the face has no areas.
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

/// Writes the opening of a luminaire as emission areas; writes nothing if the luminaire is a point.
pub fn write(luminaire: &Luminaire, out: &mut Writer) {
    let Some(opening) = luminaire.opening() else { return };
    let [width, length, height] = luminaire.bounds();
    // For three pairs of opposite faces, whether they are round: below and above, towards C = 0 and 180, and towards
    // C = 90 and 270.
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
        // If the opening has a height, always write its lower face, even if no light goes down: the luminous heights of
        // the sides are measured from this face.
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
        // The luminous strip on a side begins at the lower face; the offset is the height of the strip's centre above
        // the luminaire's centre.
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
