//! Adapts the patch map to a stretched lattice. The result is used for lights that are copied patch by patch, not as
//! whole lamps.

use super::patch_map::{NONE, PatchMap, Shift, Shifts};
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::components::Component;
use crate::emission::lattice::basis::MAX_UNCHANGING_LENGTH;
use crate::error::Result;
use crate::image::try_vec;
use glam::{DMat2, DVec2};

/// Adapts a patch map that was made for the exemplar's lattice, with the periods `own`, to the lattice with the periods
/// `stretched`. In the texture, the origin of both lattices is at `offset`. Lengths are in unwarped pixels.
///
/// All pixels of a cell of the stretched lattice get the patch at the centre of the cell. Where this patch would show
/// an unusable pixel of the exemplar, the pixel of the texture keeps the patch that it has in `patch_map`. The sides of
/// the texture, given by `size`, are lattice vectors of the stretched lattice, so opposite sides match without a seam.
/// An axis along which the lights do not change is not divided into cells.
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
            // Find `at`, the centre of the cell that contains the pixel. `within` is `at` modulo the size of the
            // texture, so it lies inside the texture.
            let cells = to_cells * (place - start);
            let at = start + stretched * (cells.round() * has_cells + cells * (DVec2::ONE - has_cells));
            let within = at.rem_euclid(size);
            let pixel = within / working.pitch;
            let (u, v) = ((pixel.x as usize).min(patch_map.width - 1), (pixel.y as usize).min(patch_map.height - 1));
            // Let `steps` be the lattice steps from the exemplar's central lamp (`first`) to the cell of the exemplar
            // that the patch shows at `at`. Each step is longer by `stretched` - `own` on the stretched lattice. So add
            // `steps` times this difference to the patch's shift.
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
