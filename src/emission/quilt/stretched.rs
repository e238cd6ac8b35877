//! Adapts the patch map to a stretched lattice, for the lights that are copied patch by patch.

use super::patch_map::{NONE, PatchMap, Shift, Shifts};
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::components::Component;
use crate::emission::lattice::basis::MAX_UNCHANGING_LENGTH;
use crate::error::Result;
use crate::image::try_vec;
use glam::{DMat2, DVec2};

/// Adapts the patch map to the lattice `stretched` in place of the exemplar's lattice `own`; both begin at `offset` in
/// the texture. Each cell of the stretched lattice shows the patch at its centre. Where the exemplar has no usable
/// pixel for this, a pixel of the texture keeps its own patch. The texture, of `size` unwarped pixels, holds a whole
/// number of cells, so opposite sides match without a seam. An axis along which the lights do not change is not
/// divided into cells.
pub fn stretch(
    exemplar: &Exemplar,
    patch_map: &PatchMap,
    [own, stretched]: [[DVec2; 2]; 2],
    offset: DVec2,
    size: DVec2,
) -> Result<PatchMap> {
    let has_cells = DVec2::from(own.map(|period| f64::from(u8::from(period.length() > MAX_UNCHANGING_LENGTH))));
    let [own, stretched] = [own, stretched].map(|[a, b]| DMat2::from_cols(a, b));
    let to_cells = stretched.inverse();
    let working = &exemplar.working;
    let middle = DVec2::new(exemplar.width as f64, exemplar.height as f64) / 2.0;
    let from_middle = |lamp: &&Component| lamp.centre.distance_squared(middle);
    let lamps = exemplar.components.list.iter();
    let first = lamps.min_by(|p, q| from_middle(p).total_cmp(&from_middle(q))).map_or(middle, |lamp| lamp.centre);
    let start = first + offset;

    let mut out = PatchMap::new(patch_map.width, patch_map.height);
    let mut shifts = Shifts::default();
    let mut row = try_vec(patch_map.width, NONE)?;
    for y in 0..patch_map.height {
        for (x, label) in row.iter_mut().enumerate() {
            let place = (DVec2::new(x as f64, y as f64) + 0.5) * working.pitch;
            // Find the centre of the pixel's cell, and wrap it into the texture.
            let cells = to_cells * (place - start);
            let at = start + stretched * (cells.round() * has_cells + cells * (DVec2::ONE - has_cells));
            let within = at.rem_euclid(size);
            let pixel = within / working.pitch;
            let (u, v) = ((pixel.x as usize).min(patch_map.width - 1), (pixel.y as usize).min(patch_map.height - 1));
            // The cells of the stretched lattice and of the exemplar's lattice differ in size. Add this difference to
            // the patch's shift for every cell from the patch's origin to `at`.
            let moved = |patch: &Shift, at: DVec2| {
                let steps = to_cells * (at - start) - to_cells * (patch.exact - offset);
                patch.exact + (stretched - own) * (steps.round() * has_cells)
            };
            let shows = |shift: &DVec2| {
                let shift = (*shift / working.pitch).round();
                working.index(x as i32 - shift.x as i32, y as i32 - shift.y as i32).is_some_and(|i| working.usable[i])
            };
            let of_middle = patch_map.shift(u, v).map(|patch| moved(patch, within) + at - within).filter(shows);
            let own_patch = patch_map.shift(x, y);
            let shift = of_middle
                .or_else(|| own_patch.map(|patch| moved(patch, at)).filter(shows))
                .or_else(|| own_patch.map(|patch| patch.exact));
            *label = shift.map_or(NONE, |shift| shifts.label(shift, working.pitch));
        }
        out.push(&row);
    }
    out.shifts = shifts.list;
    Ok(out)
}
