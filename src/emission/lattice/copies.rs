//! Keeps the lamps of adjacent copies apart where an exemplar repeats as a whole.
//!
//! The lamps of a copy may lie close to the lamps of the next copy, although all lamps in the photo are far apart.
//! Copies of another width, with the same or a slightly larger area, then keep the distances between lamps.

use crate::emission::agreement::statistics::nearest_distances;
use crate::emission::exemplar::Exemplar;
use crate::maths;
use glam::DVec2;

/// Exemplars with more lamps keep their periods. A repetition as a whole has more lamps only if they form one group,
/// with free space around it. [convention]
const MAX_LAMPS: usize = 64;
/// Copies whose lamps come nearer than in the photo by less than this share of the distance stay as they are.
/// [convention]
const MAX_SHORTFALL: f64 = 0.02;
/// Areas of a copy that are tried, as multiples of the area that has the lit share of the photo. [convention]
const AREAS: [f64; 4] = [1.0, 1.1, 1.2, 1.35];
/// Widths that are tried for each area: `WIDTHS` widths, from 1 / `MAX_STRETCH` to `MAX_STRETCH` times the width
/// without this correction. [convention]
const WIDTHS: i32 = 41;
const MAX_STRETCH: f64 = 1.6;
/// Cost of a larger area, and cost of another width, relative to the shortfall: factors of the logarithm of the ratio.
/// [bench photos:tune]
const AREA_COST: f64 = 0.3;
const WIDTH_COST: f64 = 0.02;

/// Returns periods along x and y at which lamps of adjacent copies are about as far apart as lamps in the photo are.
/// `cell` holds the periods without this correction, in unwarped pixels, and `min_cell` the shortest periods allowed.
pub fn keep_distances(exemplar: &Exemplar, cell: DVec2, min_cell: DVec2) -> DVec2 {
    let copied: Vec<DVec2> = exemplar.pieces().map(|(_, lamp)| lamp.centre).collect();
    if copied.len() < 2 || copied.len() > MAX_LAMPS {
        return cell;
    }
    let all: Vec<DVec2> = exemplar.components.list.iter().map(|lamp| lamp.centre).collect();
    let in_photo: Vec<f64> = nearest_distances(&all)
        .into_iter()
        .zip(&exemplar.roles)
        .filter(|(_, r)| r.is_piece())
        .map(|(d, _)| d)
        .collect();
    let shortfall = |cell: DVec2| shortfall(&copied, &in_photo, cell);
    let now = shortfall(cell);
    if now <= MAX_SHORTFALL {
        return cell;
    }
    let step = 2.0 * maths::ln(MAX_STRETCH) / f64::from(WIDTHS - 1);
    let cells = AREAS.into_iter().flat_map(|area| {
        (0..WIDTHS).map(move |k| {
            let stretch = step * f64::from(k - WIDTHS / 2);
            let cost = AREA_COST * maths::ln(area) + WIDTH_COST * stretch.abs();
            (cell * DVec2::new(maths::exp(stretch), area * maths::exp(-stretch)), cost)
        })
    });
    let allowed = cells.filter(|(cell, _)| cell.cmpge(min_cell).all());
    let costs = allowed.map(|(cell, cost)| (cell, shortfall(cell) + cost));
    costs.fold((cell, now), |best, other| if other.1 < best.1 { other } else { best }).0
}

/// How much nearer lamps come to each other where copies adjoin: the mean, over the copied lamps, of the share by which
/// the distance to the nearest lamp falls short of the distance `in_photo`.
fn shortfall(copied: &[DVec2], in_photo: &[f64], cell: DVec2) -> f64 {
    let around = [-1.0, 0.0, 1.0].map(|y| [-1.0, 0.0, 1.0].map(|x| DVec2::new(x, y) * cell));
    let neighbours = around.into_iter().flatten().filter(|shift| *shift != DVec2::ZERO);
    let copies = neighbours.flat_map(|shift| copied.iter().map(move |lamp| *lamp + shift));
    // The distances of the unshifted lamps, which come first, are compared.
    let nearest = nearest_distances(&copied.iter().copied().chain(copies).collect::<Vec<_>>());
    let lost = in_photo.iter().zip(nearest).map(|(there, here)| (1.0 - here / there).max(0.0));
    lost.sum::<f64>() / copied.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_between_copies_count() {
        let lamps = [DVec2::new(10.0, 10.0), DVec2::new(60.0, 10.0)];
        let near = |cell| shortfall(&lamps, &[50.0, 50.0], cell);
        assert_eq!(near(DVec2::new(100.0, 50.0)), 0.0);
        assert!((near(DVec2::new(75.0, 50.0)) - 0.5).abs() < 1e-12);
        assert!((near(DVec2::new(100.0, 40.0)) - 0.2).abs() < 1e-12);
    }
}
