//! Places lamps on a stretched lattice, cell by cell.
//!
//! A tileable texture may need a stretched lattice, so that a whole number of periods fits its sides. Lamps that are
//! copied with their patch keep the distances that they have in the exemplar. On a stretched lattice, these distances
//! are slightly wrong within a patch, and the error shows as a jump at the seams. Therefore lamps are placed by cells
//! instead: each cell of the stretched lattice gets all lamps of one complete cell of the exemplar. This is the cell
//! that the patch there shows or, if that cell is incomplete, a random one.

use super::instance::Instance;
use super::sharpest;
use crate::emission::exemplar::Exemplar;
use crate::emission::exemplar::components::Component;
use crate::emission::exemplar::roles::Role;
use crate::emission::lattice::cells::{self, Cell};
use crate::emission::quilt::patch_map::PatchMap;
use crate::rng::Rng;
use glam::{DMat2, DVec2};
use std::collections::{BTreeMap, BTreeSet};

/// Places the lamps of the exemplar, whose lattice has the periods `own`, in a texture whose lattice has the periods
/// `stretched`. The origin of the exemplar moves to `offset`. `size` is the size of the texture. Lengths are in
/// unwarped pixels. `None` if the exemplar has no lamp or no complete cell.
pub fn place(
    exemplar: &Exemplar,
    patch_map: &PatchMap,
    [own, stretched]: [[DVec2; 2]; 2],
    offset: DVec2,
    size: DVec2,
    seed: u64,
) -> Option<Vec<Instance>> {
    let [own, stretched] = [own, stretched].map(|[a, b]| DMat2::from_cols(a, b));
    let (to_own, to_stretched) = (own.inverse(), stretched.inverse());

    // Centre cell (0, 0) on the lamp nearest to the exemplar's centre.
    let middle = DVec2::new(exemplar.width as f64, exemplar.height as f64) / 2.0;
    let first = exemplar
        .pieces()
        .min_by(|p, q| p.1.centre.distance_squared(middle).total_cmp(&q.1.centre.distance_squared(middle)))?
        .1;
    let cell_of = |at: DVec2| (to_own * (at - first.centre)).round().to_array().map(|c| c as i64);
    let step = |[i, j]: Cell| DVec2::new(i as f64, j as f64);

    // Collect the lamps of each cell in `lamps`, and the complete cells in `whole`. A cell is complete if it has no cut
    // lamp, and if the photo would show all of the first lamp (the lamp of cell (0, 0)) at the centre of the cell.
    let mut lamps: BTreeMap<Cell, Vec<usize>> = BTreeMap::new();
    exemplar.pieces().for_each(|(k, lamp)| lamps.entry(cell_of(lamp.centre)).or_default().push(k));
    let components = exemplar.components.list.iter().zip(&exemplar.roles);
    let spoilt: BTreeSet<Cell> =
        components.filter(|(_, role)| **role == Role::Cut).map(|(lamp, _)| cell_of(lamp.centre)).collect();
    let whole: Vec<Cell> = cells::between(to_own, DVec2::ZERO - first.centre, middle * 2.0 - first.centre)
        .filter(|cell| !spoilt.contains(cell) && shows(exemplar, first, first.centre + own * step(*cell)))
        .collect();
    if whole.is_empty() {
        return None;
    }
    let known: BTreeSet<Cell> = whole.iter().copied().collect();

    // Fill the cells whose centre lies in the texture with the lamps of a complete cell: the cell that the patch there
    // shows, or a random one if that cell is not complete. Lamps that cross the border re-enter on the opposite side.
    let start = first.centre + offset;
    let mut instances = Vec::new();
    for cell in cells::between(to_stretched, DVec2::ZERO - start, size - start) {
        let at = start + stretched * step(cell);
        if !(at.cmpge(DVec2::splat(-1e-6)).all() && at.cmplt(size - 1e-6).all()) {
            continue;
        }
        let pixel = at.max(DVec2::ZERO) / exemplar.working.pitch;
        let (u, v) = ((pixel.x as usize).min(patch_map.width - 1), (pixel.y as usize).min(patch_map.height - 1));
        let shown = patch_map.shift(u, v).map(|shift| cell_of(at - shift.exact)).filter(|cell| known.contains(cell));
        let source = shown.unwrap_or_else(|| {
            let mut rng = Rng::new(seed, &[0x6365, cell[0] as u64, cell[1] as u64]);
            whole[rng.below(whole.len())]
        });
        let shift = at - first.centre - own * step(source);
        instances.extend(lamps.get(&source).into_iter().flatten().map(|&component| Instance { component, shift }));
    }
    sharpest::show_sharpest(exemplar, &mut instances, seed);
    Some(instances)
}

/// Whether the photo would show all corners of the lamp's bounding box if the lamp were at `centre`.
fn shows(exemplar: &Exemplar, lamp: &Component, centre: DVec2) -> bool {
    // Take slightly less than half of the box, so that the right and lower corners lie within the last pixels of the
    // lamp.
    let half = DVec2::new(lamp.size()[0] as f64, lamp.size()[1] as f64) * (0.5 - 1e-9);
    let corners = [-half, DVec2::new(half.x, -half.y), DVec2::new(-half.x, half.y), half];
    corners.into_iter().all(|corner| {
        let at = centre + corner;
        let inside = at.cmpge(DVec2::ZERO).all() && at.x < exemplar.width as f64 && at.y < exemplar.height as f64;
        inside && exemplar.shown[at.y as usize * exemplar.width + at.x as usize]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emission::params::Input;
    use crate::image::Image;
    use crate::job::Monitor;

    #[test]
    fn a_lamp_is_shown_up_to_each_border_and_no_further() {
        let image = |value: f32| Image::from_fn(40, 30, |_, _| [value; 3]).unwrap();
        let (unwarped, valid) = (image(1.0), image(1.0).channel(0).unwrap());
        for (x0, y0) in [(0, 10), (34, 10), (16, 0), (16, 22)] {
            let mut light = Image::new(40, 30, 1).unwrap();
            (y0..y0 + 8).for_each(|y| (x0..x0 + 6).for_each(|x| light.data[y * 40 + x] = 1.0));
            let input = Input { unwarped: &unwarped, light: &light, valid: &valid, photo: None };
            let exemplar = Exemplar::new(&input, 40.0, 0.0, Monitor::default().job()).unwrap();
            let lamp = &exemplar.components.list[0];
            assert!(shows(&exemplar, lamp, lamp.centre), "{x0} {y0}");
            let outwards = (lamp.centre - DVec2::new(20.0, 15.0)).signum();
            assert!(!shows(&exemplar, lamp, lamp.centre + outwards * DVec2::new(15.0, 12.0)), "{x0} {y0}");
        }
    }
}
